/* The homes of elements in states: the section HOME. */
#ifndef DM2_ENGINE_HOMES_H
#define DM2_ENGINE_HOMES_H

#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/section.h"
#include "loading_parts.h"
#include "particles.h"

/* Appends the homes of the owned elements of bodies that are placed, in id order. DM2_MEMORY. */
enum dm2_status homes_collect(const struct model *m, const struct particles *p, struct section_array *out,
                              struct dm2_error *err);

/* A copy of the records in id order; the caller frees out->records. DM2_MEMORY; DM2_PROTOCOL: two of one
 * element. */
enum dm2_status homes_sorted(const struct section_array *homes, struct section_array *out,
                             struct dm2_error *err);

/* Sets the home of an owned element of a body that is placed, from records in id order. DM2_PROTOCOL: the
 * element has none, or its place at `step` is not where its home puts the element. loading: the bodies under
 * force at this step, or NULL. */
enum dm2_status homes_find(const struct model *m, const struct section_array *homes, int64_t step,
                           const struct loading *loading, struct element *e, struct dm2_error *err);

#endif
