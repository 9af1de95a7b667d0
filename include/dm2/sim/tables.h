/* The inside of struct model, for the engine's own files; other layers use dm2/sim/model.h. */
#ifndef DM2_SIM_TABLES_H
#define DM2_SIM_TABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/sim/config.h"
#include "dm2/sim/grid.h"
#include "dm2/sim/law.h"
#include "dm2/sim/model.h"

/* A kind of element: a material (and later its phase). */
struct kind {
    int material;
    double t0, tm, softening; /* tm infinite: never softens */
    double cp;                /* infinite: the temperature stays at t0 */
};

/* Fixed-point scales: a double times the scale, rounded, is what the 64-bit sums add. Powers of two. */
struct fixed_scales {
    double over_far_force, over_force, over_torque, over_heat; /* reciprocals, exact */
    double far_force, force, torque, heat, virial, around, energy;
    int energy_left; /* measure_scales.energy = log2(energy) + energy_left */
};

struct model {
    const struct config *config;
    struct grid grid;
    size_t n_kinds;
    struct kind *kinds;
    struct pair_law *laws; /* [kind i][kind j][relation] */
    bool has_far;          /* some law has scope all */
    bool has_near;         /* some law needs contact status */
    bool has_spin;         /* some law is tangential: elements rotate */
    bool has_damping;      /* some law damps: velocities of mirrored elements matter */
    bool has_heat;         /* temperature changes something: softening, conduction, damping's a_t */
    bool has_pressure;     /* some damping depends on pressure */
    bool has_strain;       /* the deck asks for strain: velocities of mirrored elements matter */
    bool uniform_far;      /* one kind, one far law */
    bool wide_far;         /* and that law is a plain Lennard-Jones potential: rows of the far list are padded to fours */
    bool wide_near;        /* the commonest laws allow near pairs to be taken four at a time */
    double far_cutoff;     /* largest cutoff of scope all, cm; 0 without */
    double radius_max;     /* largest radius of an element, cm */
    double link_form_max;
    double dt_stable;
    const char *dt_mode;
    size_t n_elements;
    struct fixed_scales fixed;
    struct measure_scales scales;
};

static inline const struct pair_law *model_law(const struct model *m, size_t a, size_t b, enum relation relation)
{
    return &m->laws[(a * m->n_kinds + b) * RELATION_COUNT + (size_t)relation];
}

/* How two elements stand to each other. */
static inline enum relation relation_of(uint16_t body_i, uint32_t grain_i, uint16_t body_j, uint32_t grain_j)
{
    return body_i != body_j ? RELATION_OTHER_BODY : grain_i != grain_j ? RELATION_OTHER_GRAIN : RELATION_SAME_GRAIN;
}

#endif
