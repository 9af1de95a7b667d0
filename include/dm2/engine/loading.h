/* The motion of the bodies that move by forces. The client and every server hold the states of all of them,
 * and advance them from the same totals, so that no position of a body travels.
 *
 * Kick n takes the totals of evaluation n-2: a server that sends its sums of n-1 with STEP n may kick n
 * before it has the sums of the others. */
#ifndef DM2_ENGINE_LOADING_H
#define DM2_ENGINE_LOADING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/load_totals.h"
#include "dm2/engine/model.h"
#include "dm2/engine/section.h"

/* The number of bodies that move by forces, at most FORCED_MAX. */
size_t model_forced(const struct model *model);

/* What `--check` tells of body i that moves by forces, along axis 0 or 1. False: no force acts there. */
struct forced_check {
    const char *load, *body; /* names */
    double mass;             /* g */
    double share;            /* omega dt */
    double damping;          /* c, Mbar us cm */
    double fastest;          /* max_velocity, cm/us */
};
bool model_forced_check(const struct model *model, size_t i, int axis, struct forced_check *out);

struct loading;

/* The states at `step`, as at the start of a run. *out stays NULL for a model whose bodies do not move by
 * forces; it is the caller's, to be freed by loading_free. DM2_MEMORY. */
enum dm2_status loading_open(const struct model *model, int64_t step, struct loading **out,
                             struct dm2_error *err);
void loading_free(struct loading *l); /* NULL is fine */

/* The kick of the present step, which takes effect with loading_take. DM2_NUMERIC: a body would get further
 * beyond the domain than the domain is long. */
enum dm2_status loading_kick(struct loading *l, struct dm2_error *err);

/* Moves the bodies to the next step; totals[model_forced] are those of the evaluation at the present one,
 * which count two kicks later. */
void loading_take(struct loading *l, const struct load_totals *totals);

/* Takes the records of a state at the step of loading_open. DM2_PROTOCOL: a body that moves by forces has no
 * record. */
enum dm2_status loading_restore(struct loading *l, const struct section_array *bodies, struct dm2_error *err);

/* Appends a struct body_record for each body. False without memory. */
bool loading_collect(const struct loading *l, struct section_array *out);

enum { LOADING_LINE = 300 };
/* True once for each body that has moved ten diameters without touching anything; `line` says so. */
bool loading_warns(struct loading *l, char line[LOADING_LINE]);

#endif
