/* Condensed phases: the phase of an element at its pressure and temperature, and the effect of a change on
 * the element and its bonds. A change is instantaneous; an element has at most one change per step. Source:
 * paper, section 2.3; equations: docs/physics.md, section 9.
 *
 * The owner changes the kind of an element (also where a reaction has turned the element into product) after
 * the move and marks the change in particles.was. The next force evaluation begins with phase_account, which
 * books the change of the bonds' energies and clears the marks. */
#ifndef DM2_ENGINE_PHASE_H
#define DM2_ENGINE_PHASE_H

#include "dm2/base/status.h"
#include "law.h"
#include "lists.h"
#include "particles.h"
#include "tables.h"

/* The kind that an element of `kind` changes to at pressure p (Mbar) and temperature t (K): the first phase,
 * in deck order, that forms from `kind` and has its line below (p, t); else, for a reversible phase whose own
 * line is above (p, t) by more than the hysteresis, the kind that it forms from; else `kind`. */
size_t phase_of(const struct model *m, size_t kind, double p, double t);

/* Radius after a change from kind `was` to `kind`, cm: scaled where both are phases of one material, else
 * unchanged. */
double phase_radius(const struct model *m, double radius, size_t was, size_t kind);

/* Turns owned slot i into `kind`: sets heat, radius, spin (the angular momentum stays) and temperature, and
 * books the energy in p->moved. */
void phase_become(const struct model *m, struct particles *p, size_t i, size_t kind);

/* Gives mirrored slot i the change of its owner: kind, was and radius. */
void phase_follow(const struct model *m, struct particles *p, size_t i, size_t was, size_t kind);

/* Changes the phases of all owned elements by the pressure of the last evaluation and the present
 * temperature. */
void phase_apply(const struct model *m, struct particles *p);

/* What the book of a bond holds, with the kinds and radii of one side of a change: u + f v_n dt/2 of the
 * potential and the same of the spring, so that the difference of two is the sum of law_freed and
 * law_spring_freed (law.h). v: of the pair but for the sizes; the status is from before the evaluation. */
double phase_bond_book(const struct pair_law *law, const struct pair_view *v, bool linked, double stretch,
                       double spring, double dt_path);

/* Books what the changes of kind take from the bonds (law_freed) in p->moved, half to each element, and
 * clears all marks. step: the step whose forces come next. DM2_MEMORY; DM2_NUMERIC: the energy of a bond is
 * out of range, with ids and step. */
enum dm2_status phase_account(const struct model *m, struct particles *p, const struct lists *lists,
                              int64_t step, struct dm2_error *err);

#endif
