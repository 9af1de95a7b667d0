/* One element and one pair as records, the form in which elements and pairs are generated, sent and stored.
 * The engine itself keeps arrays (src/engine/particles.h). */
#ifndef DM2_ENGINE_ELEMENT_H
#define DM2_ENGINE_ELEMENT_H

#include <stddef.h>
#include <stdint.h>

enum element_flag {
    ELEMENT_FIXED_MOTION = 1 /* the element's velocity is prescribed; forces do not move the element */
};

/* The largest number of times that an element may go round the domain; a run in which an element goes round
 * more often ends. */
enum { IMAGE_MOST = 1 << 30 };

/* The state of one element: every value that the next step reads. */
struct element {
    uint32_t id;    /* global, from 0, in the generator's order */
    uint32_t grain; /* global number */
    uint16_t body;
    uint16_t kind;   /* index of its (material, phase) in the model */
    uint16_t was;    /* kind before the last move; differs only until the next force evaluation */
    uint8_t flags;   /* enum element_flag */
    uint8_t probes;  /* bit p: the element belongs to the p-th probe of a region */
    double radius;   /* cm */
    double mass;     /* g */
    double r[2];     /* position at the whole step, cm */
    double v[2];     /* velocity at the half step before, cm/us */
    double w;        /* angular velocity at the half step before, 1/us */
    double heat;     /* thermal energy above the material's T0, g cm2/us2 */
    double p;        /* pressure of the last force evaluation, Mbar */
    double share[2]; /* mass fractions of the reactants; the rest is product; 0 without a reaction */
    /* Only the owner has the following values; of a mirrored element they are 0. */
    double work;      /* work of the body force or the prescribed motion since the start, g cm2/us2 */
    double strain[3]; /* xx, yy, xy, accumulated since the start; 0 in a deck that asks for no strain */
    double moved;     /* energy that changes of kind took out of bonds and spin since the start, g cm2/us2 */
    int32_t image[2]; /* sizes of the domain that wrapping took off r since the start; 0 where not periodic */
    double damped;    /* energy that local damping took since the start, g cm2/us2; 0 without it */
    double home[2]; /* place against the centroid of its body when the body's load began, cm; 0 where the body
                       follows no table and does not turn */
    uint16_t bonds; /* links at the start */
};

/* The memory of one pair that is linked or in contact; id_a < id_b. */
struct pair_record {
    uint32_t id_a, id_b;
    uint32_t linked; /* 0 or 1 */
    double stretch;  /* residual normal stretch e, cm */
    double spring;   /* tangential spring s, cm */
};

/* The measures of one element at the last force evaluation that measured. */
struct element_measure {
    double stress[3];   /* xx, yy, xy, Mbar; tension positive */
    double velocity[2]; /* mean of the two half steps, cm/us */
    double temperature; /* K */
    uint32_t links;     /* linked pairs */
    uint32_t contacts;  /* pairs in contact */
};

/* The force of a pair that touches or is linked, at the last force evaluation that measured, Mbar cm2. */
struct pair_measure {
    double force[2]; /* x, y on element id_a, -force on id_b; a whole multiple of the sums' quantum */
    double normal, tangential; /* along n and t = (-n_y, n_x), n from id_b to id_a; normal > 0 pushes apart */
};

/* The index of the element with this id among n elements in id order; n where no element has the id. */
size_t element_find(const struct element *elements, size_t n, uint32_t id);

#endif
