/* One evaluation in progress, shared by the pair loops of far.c, force.c and near_wide.c. */
#ifndef DM2_ENGINE_PAIR_PASS_H
#define DM2_ENGINE_PAIR_PASS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "force.h"
#include "periodic.h"

/* Largest magnitude of near effects and energies in fixed point: the sums of 64 pairs of one element still
 * fit. */
#define FIXED_RANGE 0x1p57

/* 2^FABRIC_SHIFT */
#define FABRIC_SCALE 0x1p40

/* Nearest integer of a scaled double, halves to even; |scaled| < FIXED_RANGE. An odd function, so action and
 * reaction cancel; one instruction on most machines. */
static inline int64_t to_fixed(double scaled)
{
    return llrint(scaled);
}

struct pass {
    const struct model *m;
    struct particles *p;
    struct period period;
    double dt_kick, dt_path;
    struct pair_totals *totals;
    struct exact_sum potential, elastic;
    enum list_part part;   /* the rows being evaluated */
    uint32_t bad_i, bad_j; /* a pair out of range, if any */
    bool bad, no_memory;
    bool ahead;     /* PART_INSIDE has been evaluated */
    bool far_plain; /* measured far pairs have left the range of lanes: start again with the plain loop */
    bool plain;     /* plain loops only: the check of the debug flavour */
    struct force_check *check; /* of the debug flavour */
};

/* Notes the pair as out of range, unless an earlier pair was. */
static inline void note_bad(struct pass *pass, uint32_t i, uint32_t j)
{
    if (!pass->bad) {
        pass->bad = true;
        pass->bad_i = i;
        pass->bad_j = j;
    }
}

/* A pair's energies and counts belong to one server: the owner of the element with the lower id. */
static inline bool counts_here(const struct particles *p, uint32_t i, uint32_t j)
{
    return j < p->n_own || p->id[i] < p->id[j];
}

/* Can a force move one of the two elements? */
static inline bool has_free_element(const struct particles *p, size_t i, size_t j)
{
    return (p->flags[i] & p->flags[j] & ELEMENT_FIXED_MOTION) == 0;
}

/* Adds r (x) f of a pair to the virials of both elements; dx, dy in cm, fx, fy in Mbar cm2. */
static inline void add_virial(const struct pass *pass, uint32_t i, uint32_t j, double dx, double dy,
                              double fx, double fy)
{
    double s = pass->m->fixed.virial;
    int64_t xx = to_fixed(dx * fx * s), yy = to_fixed(dy * fy * s),
            xy = to_fixed(0.5 * (dx * fy + dy * fx) * s);
    int64_t *vi = pass->p->virial + VIRIAL_COUNT * (size_t)i,
            *vj = pass->p->virial + VIRIAL_COUNT * (size_t)j;
    vi[0] += xx;
    vi[1] += yy;
    vi[2] += xy;
    vj[0] += xx;
    vj[1] += yy;
    vj[2] += xy;
}

/* Adds the potentials of scope `all` over the far pairs of pass->part to far_sum; with totals also virial and
 * energy. Sets bad, no_memory or far_plain of the pass where the evaluation did not succeed. */
void far_evaluate(struct pass *pass, struct lists *lists);

/* Evaluates entry k of the near row of i by the plain path. */
typedef void take_single(struct pass *pass, struct lists *lists, uint32_t i, uint32_t k);

/* Evaluates the quads of lists->links[pass->part], which link_list_prepare has sorted; `single` evaluates the
 * links that need the plain path. */
void near_wide(struct pass *pass, struct lists *lists, take_single *single);

#endif
