/* One element and one pair as records: how they travel, are stored and are generated. The engine itself
 * keeps arrays (engine/particles.h); these are what comes in and goes out. */
#ifndef DM2_ENGINE_ELEMENT_H
#define DM2_ENGINE_ELEMENT_H

#include <stddef.h>
#include <stdint.h>

enum element_flag {
    ELEMENT_FIXED_MOTION = 1 /* its velocity is prescribed; forces do not move it */
};

/* The state of one element: all that the next step reads of it. */
struct element {
    uint32_t id;    /* global, from 0, in the generator's order */
    uint32_t grain; /* global */
    uint16_t body;
    uint16_t kind;   /* index of its (material, phase) in the model */
    uint16_t was;    /* kind before the last move; differs only until the next force evaluation */
    uint8_t flags;   /* enum element_flag */
    uint8_t probes;  /* bit p: it belongs to probe p */
    double radius;   /* cm */
    double mass;     /* g */
    double r[2];     /* position at the whole step, cm */
    double v[2];     /* velocity at the half step before, cm/us */
    double w;        /* angular velocity there, 1/us */
    double heat;     /* thermal energy above its material's T0, g cm2/us2 */
    double p;        /* pressure of the last force evaluation, Mbar */
    double share[2]; /* mass fractions of the reaction's reactants; the rest is product; 0 where nothing
                        reacts */
    /* What only its owner knows; of a mirrored element it is 0. */
    double work;      /* put in so far by the body force or by its drive, g cm2/us2 */
    double strain[3]; /* xx, yy, xy, accumulated since the start where the deck asks for it; else 0 */
    double moved;     /* energy that changes of kind took out of its bonds and spin so far, g cm2/us2 */
    uint16_t bonds;   /* links that it started with */
};

/* The memory of one pair that is linked or in contact. Key: id_a < id_b. */
struct pair_record {
    uint32_t id_a, id_b;
    uint32_t linked; /* 0 or 1 */
    double stretch;  /* residual normal stretch e, cm */
    double spring;   /* tangential spring s, cm */
};

/* What was measured of one element at the last force evaluation that measured. */
struct element_measure {
    double stress[3];   /* xx, yy, xy, Mbar; tension positive */
    double velocity[2]; /* mean of the two half steps */
    double temperature; /* K */
    uint32_t links;     /* linked pairs */
    uint32_t contacts;
};

/* A whole state, or a part of one, for a reader; everything borrowed. Elements in id order, pairs in (id_a,
 * id_b) order. Where `elements` is NULL, the two functions give the records. */
struct state_view {
    const uint8_t *digest; /* of the deck, 32 bytes */
    int64_t step;
    const struct element *elements;
    size_t n_elements;
    const struct pair_record *pairs;
    size_t n_pairs;
    const void *records;
    void (*element)(const void *records, size_t k, struct element *out);
    void (*pair)(const void *records, size_t k, struct pair_record *out);
};

/* The index of the element with this id among n elements in id order; n where there is none. */
size_t element_find(const struct element *elements, size_t n, uint32_t id);

#endif
