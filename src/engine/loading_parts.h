/* The inside of struct loading, for the files of the engine. */
#ifndef DM2_ENGINE_LOADING_PARTS_H
#define DM2_ENGINE_LOADING_PARTS_H

#include "dm2/engine/loading.h"
#include "force_control.h"
#include "tables.h"

/* One body under force. */
struct body_state {
    struct control_state axis[2];
    struct control_state next[2];    /* after the kick of the present step */
    struct load_totals last, before; /* of the evaluations one and two steps ago */
    double path; /* since the body last touched anything, cm; begins at 0 in each session */
    bool warned;
};

struct loading {
    const struct model *model;
    int64_t step; /* of the next kick */
    struct body_state body[FORCED_MAX];
};

struct body_drive;
struct rigid_motion;

/* Adds the motion of the bodies under force by the kick of the present step to the drives of this step
 * (drive.h), which are those of a body without forces. */
void loading_drive(const struct loading *l, struct body_drive *drives);

/* Adds what forces have moved the body by at the present step to r[2], cm; l NULL: nothing. */
void loading_add_shift(const struct loading *l, size_t body, double r[2]);

/* motion_at, with what forces do to the mover. `step`: the present one of *l or, after the kick, the next
 * one. l NULL: nothing moves by forces. */
void loading_motion(const struct loading *l, const struct model *m, size_t mover, int64_t step,
                    struct rigid_motion *out);

#endif
