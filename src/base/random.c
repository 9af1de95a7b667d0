/* Counter-based random numbers: the finalizer of splitmix64 (Steele, Lea, Flood, "Fast splittable
 * pseudorandom number generators", OOPSLA 2014), applied once per input. */
#include "dm2/base/random.h"

static uint64_t mix(uint64_t z)
{
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

uint64_t random_bits(uint64_t seed, uint64_t id, uint64_t purpose)
{
    return mix(mix(mix(seed) ^ id) ^ purpose);
}

double random_uniform(uint64_t seed, uint64_t id, uint64_t purpose)
{
    return (double)(random_bits(seed, id, purpose) >> 11) * 0x1p-53;
}
