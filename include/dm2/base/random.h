/* Random numbers as hashes: a number depends on (seed, id, purpose), not on the order of calls. */
#ifndef DM2_BASE_RANDOM_H
#define DM2_BASE_RANDOM_H

#include <stdint.h>

/* The purpose of a number; numbers for different purposes are independent. */
enum random_purpose {
    RANDOM_MIX = 1,
    RANDOM_VELOCITY_X,
    RANDOM_VELOCITY_Y,
    RANDOM_GRAIN_X,
    RANDOM_GRAIN_Y,
    RANDOM_GRAIN_SIZE,
    RANDOM_GRAIN_ANGLE,
    RANDOM_GRAIN_CORNERS,
    RANDOM_GRAIN_CORNER,
    RANDOM_LINK
};

/* 64 well-mixed bits (splitmix64's finalizer over the three inputs). */
uint64_t random_bits(uint64_t seed, uint64_t id, uint64_t purpose);

/* Uniform in [0, 1), a multiple of 2^-53. */
double random_uniform(uint64_t seed, uint64_t id, uint64_t purpose);

#endif
