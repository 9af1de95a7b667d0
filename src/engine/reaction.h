/* The reaction of two materials, A + B -> product, between contacting elements (docs/physics.md, section 9;
 * paper, section 2.3). Elements keep their mass and size; what changes is their composition: mass fractions
 * of A, B and, the rest, product. */
#ifndef DM2_ENGINE_REACTION_H
#define DM2_ENGINE_REACTION_H

#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"
#include "tables.h"

enum { REACTION_A, REACTION_B, REACTION_HEAT, REACTION_SUMS };

/* What one evaluation found for each element, in fixed point. */
struct reaction_sums {
    int64_t *item; /* [n][REACTION_SUMS] */
    size_t cap;
};

/* One side of a contact. */
struct reaction_side {
    double mass;     /* of the element, g */
    double fraction; /* of it that is the reactant in question */
};

/* Masses of A (of side a) and of B (of side b) that react in dt, g:
 *   dm = k0 exp(-Ea/(R T)) x_A x_B A dt of product,
 * split by the masses of the deck (stoichiometric) or by what the two hold; each at most `limit` of what its
 * side holds. T in K, area of contact in cm2, dt in us. */
void reaction_rate(const struct reaction_table *x, struct reaction_side a, struct reaction_side b,
                   double temperature, double area, double dt, double reacted[2]);

/* Rates of all contacting pairs at the present positions, over dt_kick, into *sums. DM2_MEMORY; DM2_NUMERIC:
 * a heat out of range, with id and step. */
enum dm2_status reaction_evaluate(const struct model *m, const struct particles *p, const struct lists *lists,
                                  double dt_kick, int64_t step, struct reaction_sums *sums,
                                  struct dm2_error *err);

/* Takes them: composition and heat of the owned elements; one that holds less of its reactants than the
 * threshold becomes the product material. DM2_NUMERIC: more partners took of an element than it held, with id
 * and step. */
enum dm2_status reaction_apply(const struct model *m, struct particles *p, const struct reaction_sums *sums,
                               int64_t step, struct dm2_error *err);

#endif
