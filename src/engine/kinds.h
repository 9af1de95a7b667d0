/* The kinds of elements (struct kind of tables.h) and the deck's reaction, worked out from the config. */
#ifndef DM2_ENGINE_KINDS_H
#define DM2_ENGINE_KINDS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/deck/config.h"
#include "tables.h"

/* Mass of an element, g: rho0 times the area of its hexagonal cell, sqrt(3)/2 (2R)^2, times h = 1 cm, or the
 * material's own mass. `radius` is R in cm. */
double kind_mass(const struct material_config *material, double radius);

/* `value`, or `otherwise` where the deck does not give the value (NaN). */
double kind_given(double value, double otherwise);

/* Can an element that the deck makes of this material be of this kind at some time? Needs m->reaction. */
bool kind_may_become(const struct model *m, int material, size_t kind);

/* Fills m->kinds[0 .. m->n_kinds), which the caller allocated, m->growth, m->has_phases and m->has_kinds, and
 * turns m->radius_max from the largest radius of the deck into the largest of any element at any time. */
void kinds_build(struct model *m);

/* Fills m->reaction, all but mass_scale. Needs the kinds and radius_max of kinds_build; sets m->has_heat
 * where the deck has a reaction. */
void kinds_build_reaction(struct model *m);

#endif
