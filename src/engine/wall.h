/* The contacts of elements with walls: one pass over the owned elements near a wall, after the pairs of an
 * evaluation. The pass adds to the same sums of an element as the pairs do. */
#ifndef DM2_ENGINE_WALL_H
#define DM2_ENGINE_WALL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/rebuild.h"
#include "dm2/engine/section.h"
#include "dm2/engine/wall_sums.h"
#include "force.h"
#include "particles.h"
#include "wall_shape.h"

/* A wall at a step. */
struct wall_pose {
    double d[2];            /* displacement since the start, cm */
    double v[2], next_v[2]; /* velocity of the half steps before and behind, cm/us */
    double spin, next_spin; /* likewise, 1/us */
    double angle;           /* turned since the start, radians */
    double cosine, sine;    /* of the angle */
    double temperature;     /* K; NaN: no conduction */
};

/* An element near a feature, and the memory of their contact. */
struct wall_entry {
    uint32_t feature;
    int32_t base[2]; /* the image of the element that is near: its turns plus this, in sizes of the domain */
    int32_t sign;    /* of the contact at the last evaluation; 0: none */
    double spring;   /* tangential spring, cm; 0 without contact */
};

struct wall_carried {
    uint32_t slot, feature;
    int32_t sign;
    double spring;
};

/* The elements near walls, of one subdomain; zeroed at the start. */
struct walls {
    size_t n_rows, row_cap, start_cap, work_cap;
    uint32_t *slot;  /* [n_rows] ascending: owned elements with entries */
    uint32_t *start; /* [n_rows + 1] into entry */
    double *work;    /* [n_rows] energy that the walls put in by the last evaluation's kick, g cm2/us2 */
    struct wall_entry *entry, *next; /* by row and feature; next: room for the longest row */
    size_t n_entries, entry_cap, next_cap;
    struct wall_carried *carried; /* memory on its way through a rebuild */
    size_t n_carried, carried_cap;
    struct wall_pose *pose, *anchor; /* [n_walls] at the last evaluation, at the last rebuild */
    struct wall_sums *sums;          /* [n_walls] of the last evaluation, over owned elements */
    struct section_array forces;     /* of SECTION_WFOR, of the last evaluation where `note` was true */
};

/* Room for the walls of *m. DM2_MEMORY. */
enum dm2_status walls_start(struct walls *ws, const struct model *m, struct dm2_error *err);
void walls_free(struct walls *ws);
size_t walls_bytes(const struct walls *ws, const struct model *m); /* memory held */

/* The wall at a step: the present one or, after the kick of *l, the next one; l as in loading_motion. */
struct loading;
void wall_pose_at(const struct model *m, const struct loading *l, const struct wall *w, int64_t step,
                  struct wall_pose *out);

/* Takes the walls of `step`, whose kick is done, for the evaluation of this step. */
void walls_place(struct walls *ws, const struct model *m, const struct loading *l, int64_t step);

/* The place of r, cm, of the image `turns`, in the frame in which the vertices of the wall rest. */
void wall_place(const struct model *m, const struct wall *w, const struct wall_pose *pose, const double r[2],
                const int32_t turns[2], double out[2]);

/* An element and a feature. */
struct wall_meeting {
    int sign;        /* by place alone, whether they touch or not; 0: the feature does not count */
    double d;        /* distance of the centre from the foot, cm */
    double n[2];     /* from the foot to the centre */
    double lever[2]; /* of the foot, from the present centre of the wall, cm */
};

/* Finds *out for slot i and an entry of the wall. */
void wall_meet(const struct model *m, const struct wall *w, const struct wall_pose *pose,
               const struct particles *p, size_t i, const struct wall_entry *entry, struct wall_meeting *out);

/* Velocity of the wall at the foot, cm/us; `next`: of the half step behind. */
static inline void wall_velocity(const struct wall_pose *pose, const double lever[2], bool next, double v[2])
{
    double spin = next ? pose->next_spin : pose->spin;
    const double *of = next ? pose->next_v : pose->v;
    v[0] = of[0] - spin * lever[1];
    v[1] = of[1] + spin * lever[0];
}

/* Do forces move neither the wall nor slot i? Then no force acts between the two. */
static inline bool wall_holds(const struct model *m, const struct wall *w, const struct particles *p,
                              size_t i)
{
    return (p->flags[i] & (ELEMENT_FIXED_MOTION | ELEMENT_FORCED)) == ELEMENT_FIXED_MOTION &&
           (m->forced_of == NULL || m->forced_of[w->mover] == 0);
}

/* After walls_place: adds the forces, torques and heats of all walls to the pair sums of the owned elements,
 * and updates the memory; with totals (else NULL) also their energies and counts, and the virials of the
 * elements; with `note` keeps the force of each contact. dt_kick and dt_path as in law.h. Errors, with id,
 * wall and place: DM2_DECK at step 0, else DM2_NUMERIC: an element is deeper in a wall than half its radius,
 * or moves against it by more than a quarter of its radius in a step; DM2_NUMERIC: a force or a heat is out
 * of range. DM2_MEMORY. */
enum dm2_status walls_evaluate(struct walls *ws, const struct model *m, const struct particles *p,
                               int64_t step, double dt_kick, double dt_path, struct pair_totals *totals,
                               bool note, struct dm2_error *err);

/* After walls_place and before phase_account, which clears the marks: books what the changes of kind take
 * from the contacts with walls, all of it in p->moved of the element. DM2_NUMERIC: an energy is out of range.
 */
enum dm2_status walls_account(const struct walls *ws, const struct model *m, const struct particles *p,
                              int64_t step, double dt_path, struct dm2_error *err);

/* Adds `share` of the work of the last evaluation to the work of the elements. */
void walls_add_work(const struct walls *ws, const struct particles *p, double share);

/* --- wall_index.c --- */

/* Raises *dmax to the largest displacement of a point of any wall in the step that begins at `step`, whose
 * kick is done, cm. DM2_NUMERIC: a wall would move further than a cell edge, as no element may. */
enum dm2_status walls_move(const struct model *m, const struct loading *l, int64_t step, double *dmax,
                           struct dm2_error *err);

/* Adds the displacements of the walls since the last rebuild to *out. */
void walls_survey(const struct walls *ws, const struct model *m, const struct loading *l, int64_t step,
                  struct spread *out);

/* Keeps a memory for the lists to be built. 0, or -1 without memory. */
int walls_carry(struct walls *ws, uint32_t slot, uint32_t feature, int32_t sign, double spring);

/* Gives the memory that was carried to the entries. */
void walls_give_memory(struct walls *ws, const struct model *m, const struct particles *p);

/* Finds the features near each owned element at `step`, and gives them the memory that was carried.
 * DM2_MEMORY. */
struct cells;
enum dm2_status walls_build(struct walls *ws, const struct model *m, const struct loading *l,
                            const struct particles *p, const struct cells *cells, int64_t step,
                            struct dm2_error *err);

#endif
