/* How the elements of bodies follow the loads of a step. The drives of a step say for each body where its
 * elements are at n + 1, what accelerates them at n; leapfrog.c applies the drives element by element.
 *
 * An element of a body that follows a table, or turns, has a home: its place against the centroid when the
 * load began. It is at centroid + D + home turned by the angle; its velocity of a half step is its own path
 * over dt. All that depends on the body alone is worked out once per step. */
#ifndef DM2_ENGINE_DRIVE_H
#define DM2_ENGINE_DRIVE_H

#include <stdbool.h>
#include <stdint.h>

#include "motion.h"
#include "particles.h"

struct body_drive {
    bool placed;         /* elements follow their homes */
    bool pushed;         /* elements have the acceleration `a`, cm/us2, at n */
    double to[2];        /* the centroid at n + 1, cm */
    double v[2];         /* its velocity of the half step n + 1/2, cm/us */
    double cosine, sine; /* of the angle at n + 1 */
    double turn[2];      /* changes of cosine and sine from n to n + 1, over dt, 1/us */
    double w;            /* spin of the half step n + 1/2, 1/us */
    double a[2];
};

/* The owned slots of bodies on which a drive acts, so that a step works out drives for these alone. Slots
 * come in runs, in turn without a drive, from slot 0 on, and with one; a run may be empty at the start alone.
 */
struct drive_runs {
    uint32_t *edge; /* [n] where the next run begins */
    size_t n, cap;
};

/* Finds the runs in slots that a rebuild has arranged. 0, or -1 without memory; the caller frees runs->edge.
 */
int drive_find_runs(struct drive_runs *runs, const struct model *m, const struct particles *p);

/* Does some load of the deck, or a spin, act on elements at every step? */
bool drive_is_needed(const struct model *m);

/* Fills drives[n_bodies] for the move of `step`. */
void drive_set(const struct model *m, int64_t step, struct body_drive *drives);

/* Sets the heat of the owned elements whose temperature is held to that of `step`, and adds the heat that
 * this takes to their work. */
void drive_hold_heat(const struct model *m, struct particles *p, int64_t step);

/* The drive of one body that is placed, for the move of `step`. */
void drive_set_place(const struct model *m, size_t body, int64_t step, struct body_drive *d);

/* The place of an element with this home at n + 1, not wrapped, cm. */
static inline void drive_place(const struct body_drive *d, const double home[2], double r[2])
{
    r[0] = d->to[0] + (d->cosine * home[0] - d->sine * home[1]);
    r[1] = d->to[1] + (d->sine * home[0] + d->cosine * home[1]);
}

/* Its velocity of the half step n + 1/2, cm/us. */
static inline void drive_velocity(const struct body_drive *d, const double home[2], double v[2])
{
    v[0] = d->v[0] + (d->turn[0] * home[0] - d->turn[1] * home[1]);
    v[1] = d->v[1] + (d->turn[1] * home[0] + d->turn[0] * home[1]);
}

#endif
