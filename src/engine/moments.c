/* Exact sums of mass and of mass times place. */
#include "moments.h"

#include <math.h>

void moments_start(struct moments *m, const struct config *c, double mass)
{
    int mass_bits, length_bits;
    (void)frexp(mass, &mass_bits);
    (void)frexp(c->size[0] + c->size[1] + fabs(c->origin[0]) + fabs(c->origin[1]), &length_bits);
    *m = (struct moments){.shift = {78 - mass_bits, 78 - mass_bits - length_bits}};
}

void moments_add(struct moments *m, double mass, const double r[2])
{
    (void)exact_add(&m->mass, mass, m->shift[0]);
    for (int a = 0; a < 2; a++)
        (void)exact_add(&m->moment[a], mass * r[a], m->shift[1]);
}

void moments_centroid(const struct moments *m, double out[2])
{
    for (int a = 0; a < 2; a++)
        out[a] = exact_value(&m->moment[a], m->shift[1]) / exact_value(&m->mass, m->shift[0]);
}

double moments_mass(const struct moments *m)
{
    return exact_value(&m->mass, m->shift[0]);
}
