/* The fields of struct model, for the engine's own files; other layers use dm2/engine/model.h. */
#ifndef DM2_ENGINE_TABLES_H
#define DM2_ENGINE_TABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/grid.h"
#include "dm2/deck/config.h"
#include "dm2/engine/model.h"
#include "forced.h"
#include "law.h"
#include "motion.h"

/* A kind of element: a material in one of its phases. Kind i is material i in its first phase for i <
 * n_materials; the phases of the deck follow. */
struct kind {
    int material;
    const struct material_config *state; /* its constants; belongs to the config */
    const struct phase_config *phase;    /* how the phase forms; NULL: a first phase */
    size_t from;                         /* the kind from which this kind forms */
    double size;       /* radius over the radius in the first phase, sqrt(rho0 of the first phase / rho0) */
    double energy;     /* per mass, above the first phase at t0, cm2/us2 (docs/physics.md, section 9) */
    double hysteresis; /* Mbar or K, according to phase->transition */
    double t0, tm, softening; /* tm infinite: never softens */
    double over_range;        /* 1/(tm - t0), 1/K; 0 where tm is infinite */
    double cp, over_cp;       /* infinite and 0: the temperature stays at t0 */
};

/* Fixed-point scales, powers of two: the 64-bit sums add the rounded product of a value and its scale. */
struct fixed_scales {
    double over_far_force, over_force, over_torque, over_heat; /* reciprocals, exact */
    double far_force, force, torque, heat, virial, around, energy;
    double stiffness;
    int energy_left; /* measure_scales.energy = log2(energy) + energy_left, and so for `force` */
};

/* The deck's reaction in numbers (reaction.h). */
struct reaction_table {
    bool any;
    int reactant[2], product; /* materials */
    bool stoichiometric;
    double share[2];  /* mass fraction of each reactant in the product */
    double k0, theta; /* g/cm2/us; Ea/R, K */
    double heat;      /* per mass of product, cm2/us2 */
    double threshold;
    double limit;      /* largest fraction of an element's reactant that one pair may consume in a step */
    double mass_scale; /* fixed-point scale of masses */
};

/* The probes of the deck, for the loop over the elements of a row (probes.h). */
struct probe_table {
    size_t n;
    uint32_t needs[PROBE_MAX];     /* probe_needs */
    uint8_t of_region[REGION_MAX]; /* the probe of each bit of element.probes */
    uint64_t *of_body;             /* [n_bodies] bit p: probe p is of this body */
    uint64_t porous;               /* bit p: probe p reports porosity */
};
/* Ids first .. end - 1. */
struct id_range {
    uint32_t first, end;
};

struct wall; /* wall_shape.h */

struct model {
    const struct config *config;
    struct pulse pulse; /* beats in all long work */
    struct grid grid;
    size_t n_kinds;
    struct kind *kinds;
    struct pair_law *laws; /* [kind i][kind j][relation] */
    bool has_far;          /* some law has scope all */
    bool has_near;         /* some law needs contact status: velocities of mirrored elements matter */
    bool has_spin;         /* some law is tangential: elements rotate */
    bool has_heat;         /* temperature changes something: softening, conduction, damping's a_t */
    bool has_pressure;     /* some law's damping depends on pressure */
    bool has_phases;       /* the deck has phases: pressure is needed at every step */
    bool has_kinds;        /* elements may change their kind, by phase or reaction */
    struct reaction_table reaction;
    double growth;    /* largest factor by which the radius of an element may grow; 1 without phases */
    bool has_strain;  /* the deck asks for strain */
    bool has_damping; /* the deck has local damping */
    bool uniform_far; /* one kind, one far law */
    bool wide_far;    /* uniform_far, and the law is a plain Lennard-Jones potential: the rows of the far list
                         are    padded to multiples of four */
    bool wide_near;   /* some law allows its linked pairs to be taken four at a time */
    double far_cutoff; /* largest cutoff of a law of scope all, cm; 0 without such laws */
    double far_place;  /* x and y of the slot that pads the lists, cm: beyond every cutoff, and near enough
                          that no  force is a subnormal number, because arithmetic with subnormals is slow */
    double radius_max; /* largest radius of any element at any time, cm */
    struct margins margins;
    double dt_stable;            /* us */
    const char *dt_mode;         /* the mode that limits dt_stable */
    size_t dt_kinds[2];          /* the kinds of the pair that limits dt_stable */
    size_t n_elements, n_grains; /* grains: that the deck makes, from config.start.next_grain on */
    size_t n_forced;             /* bodies that move by forces */
    struct forced_body *forced;  /* [n_forced]; NULL where there are none */
    uint8_t *forced_of;          /* [movers] index in `forced` plus 1; 0: moves by no force; NULL likewise */
    size_t n_ids;                /* all ids are below; more than n_elements where a stage left bodies out */
    struct id_range *bodies;     /* [n_bodies] ids of the elements of each body */
    uint32_t *grain_first;       /* [n_grains + 1] id of the first element of each grain; last n_ids */
    struct fixed_scales fixed;
    struct measure_scales scales;
    struct motion_table *load_tables; /* [n_loads] */
    struct mover_path *paths;         /* [n_movers] */
    bool *placed;                     /* [n_bodies] config_is_placed */
    bool *driven;                     /* [n_bodies] placed, or under an acceleration */
    bool has_drives;   /* some load, or a spin of a driven body, acts on elements at every step (drive.h) */
    bool has_held;     /* some load holds a temperature */
    double *centroids; /* [n_bodies][2] centres of mass at the start, not wrapped, cm; of bodies with
                          motion_needs_centroid; NULL while elements are counted */
    struct probe_table probes;
    size_t n_walls;
    struct wall *walls;     /* [n_walls] */
    size_t n_wall_features; /* of all walls */
};

/* The law of an ordered pair of kinds. */
static inline const struct pair_law *model_law(const struct model *m, size_t a, size_t b,
                                               enum relation relation)
{
    return &m->laws[(a * m->n_kinds + b) * RELATION_COUNT + (size_t)relation];
}

/* The relation of two elements, from their bodies and grains. */
static inline enum relation relation_of(uint16_t body_i, uint32_t grain_i, uint16_t body_j, uint32_t grain_j)
{
    return body_i != body_j     ? RELATION_OTHER_BODY
           : grain_i != grain_j ? RELATION_OTHER_GRAIN
                                : RELATION_SAME_GRAIN;
}

#endif
