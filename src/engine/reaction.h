/* The reaction of two materials, A + B -> product, between elements that are linked
 * or touch. Elements keep their mass and
 * size; the reaction changes their composition, the mass fractions of A and B; the rest is product. Source:
 * paper, section 2.3; equations: docs/physics.md, section 9. */
#ifndef DM2_ENGINE_REACTION_H
#define DM2_ENGINE_REACTION_H

#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"
#include "tables.h"

enum { REACTION_A, REACTION_B, REACTION_HEAT, REACTION_SUMS };

/* Masses of A and B that react and heat freed in one evaluation, for each element, in fixed point. */
struct reaction_sums {
    int64_t *item; /* [n][REACTION_SUMS] */
    size_t cap;
};

/* One side of a contact. */
struct reaction_side {
    double mass;     /* of the element, g */
    double fraction; /* mass fraction of the reactant of this side */
};

/* Sets reacted[0] and [1], g, the masses of A (of side a) and B (of side b) that react in dt:
 *   dm = k0 exp(-Ea/(R T)) x_A x_B A dt of product,
 * split by the masses of the deck (stoichiometric) or by the masses of reactant in the two sides; each at
 * most `limit` of the reactant in its side. temperature T in K, area A of the contact in cm2, dt in us. */
void reaction_rate(const struct reaction_table *x, struct reaction_side a, struct reaction_side b,
                   double temperature, double area, double dt, double reacted[2]);

/* Sets *sums to the reactions of all pairs that are linked or touch, at the present positions over dt_kick,
 * us. DM2_MEMORY; DM2_NUMERIC: a heat out of range, with ids and step. The caller frees sums->item. */
enum dm2_status reaction_evaluate(const struct model *m, const struct particles *p, const struct lists *lists,
                                  double dt_kick, int64_t step, struct reaction_sums *sums,
                                  struct dm2_error *err);

/* Applies the sums to composition and heat of the owned elements; an element with less than the threshold of
 * reactants becomes the product material. DM2_NUMERIC: the partners of an element took more of its reactant
 * than it had, with id and step. */
enum dm2_status reaction_apply(const struct model *m, struct particles *p, const struct reaction_sums *sums,
                               int64_t step, struct dm2_error *err);

#endif
