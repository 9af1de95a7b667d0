/* A pair's integers are those that the loops add to the elements: the same operations on the same numbers. */
#include "pair_forces.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "pair_pass.h"

int pair_forces_hold(struct lists *l, size_t n_own)
{
    size_t n = l->near.start != NULL ? l->near.start[n_own] : 0;
    pair_forces_drop(l);
    l->forces = mem_zalloc(n, sizeof *l->forces);
    l->n_forces = l->forces != NULL ? n : 0;
    return l->forces != NULL ? 0 : -1;
}

void pair_forces_drop(struct lists *l)
{
    free(l->forces);
    l->forces = NULL;
    l->n_forces = 0;
}

void pair_forces_note(struct lists *l, size_t entry, double scale, double nx, double ny, double fn, double ft)
{
    double sx = nx * scale, sy = ny * scale;
    l->forces[entry] = (struct entry_force){.f = {to_fixed(fn * sx - ft * sy), to_fixed(fn * sy + ft * sx)},
                                            .normal = fn,
                                            .tangential = ft,
                                            .acts = 1};
}
