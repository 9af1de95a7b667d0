/* Condensed phases: which phase an element is in at its pressure and temperature, and what a change does to
 * it and to its bonds (docs/physics.md, section 9; paper, section 2.3). Instantaneous; at most one change per
 * element and step.
 *
 * A change of kind (also that of an element that a reaction has turned into product) is made by its owner
 * after the move, with particles.was as the mark; the next force evaluation begins with phase_account, which
 * books what the changed constants did to the energies of the bonds and takes the marks away. */
#ifndef DM2_ENGINE_PHASE_H
#define DM2_ENGINE_PHASE_H

#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"
#include "tables.h"

/* The kind that an element of `kind` changes to at pressure p (Mbar) and temperature t (K): the first phase,
 * in deck order, that forms from it and whose line it is above; else, where it is reversible, the one it
 * formed from, if it is below its own line by more than the hysteresis; else `kind`. */
size_t phase_of(const struct model *m, size_t kind, double p, double t);

/* Radius after a change of kind: scaled where both are phases of one material, else kept, cm. */
double phase_radius(const struct model *m, double radius, size_t was, size_t kind);

/* Owned slot i becomes `kind`: heat, radius, spin (angular momentum stays), temperature; the energy moved is
 * booked. */
void phase_become(const struct model *m, struct particles *p, size_t i, size_t kind);

/* A mirrored slot follows its owner: kind, was and radius. */
void phase_follow(const struct model *m, struct particles *p, size_t i, size_t was, size_t kind);

/* Phase changes of all owned elements, by the pressure of the last evaluation and the temperature of now. */
void phase_apply(const struct model *m, struct particles *p);

/* Books the change of the bonds' energies, half to each element, and clears all marks. DM2_MEMORY;
 * DM2_NUMERIC: a bond's energy is out of range, with id and step. */
enum dm2_status phase_account(const struct model *m, struct particles *p, const struct lists *lists,
                              int64_t step, struct dm2_error *err);

#endif
