/* The bodies and walls that move by forces (loads force_x to stress_yy), as the model holds them: which load
 * acts along each axis, and the constants of its equation of motion. "Body" means either here. */
#ifndef DM2_ENGINE_FORCED_H
#define DM2_ENGINE_FORCED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "force_control.h"

struct model;

/* One axis of a body under force. */
struct forced_axis {
    const struct load_config *load; /* belongs to the config; NULL: the axis moves as the body block says */
    bool stress;                    /* the load is a stress on `length`, else a force */
    double side;      /* of a stress: 1 where the body is beyond the middle of the domain, else -1 */
    double length;    /* of a stress, cm; with `between` the gap at the start */
    size_t facing[2]; /* with `between`: the movers at the low and the high end of the gap; else MOVER_NONE */
    double weight;    /* of the elements, Mbar cm2; 0 under a stress, and of a wall */
    struct control_constants control;
    double share; /* omega dt with as many contacts as diameters on the length */
};

struct forced_body {
    size_t mover;
    double low[2], high[2]; /* what its elements or points cover at the start, cm */
    double radius;          /* smallest of the deck, cm */
    struct forced_axis axis[2];
};

/* Fills m->forced and m->forced_of from the deck's loads; nothing where no load is a force. Needs kinds,
 * laws, grid and walls. DM2_DECK, with the load's place in the deck: more than FORCED_MAX bodies, a `between`
 * whose bodies are not two others that leave a gap, no `max_velocity` where none follows from the load,
 * potentials of scope all, a `mass` below the least one. DM2_MEMORY. */
enum dm2_status forced_build(struct model *m, struct dm2_error *err);

/* The load P on the body along the axis at a step, Mbar cm2; `gap`: of `between` at this step, cm. */
double forced_load(const struct model *m, const struct forced_axis *axis, int64_t step, double gap);

#endif
