/* Changes of kind beside walls: what the energy of a contact changes by when its element takes another law
 * and another size. The wall keeps its kind. As in phase.c the step across the change uses the forces after
 * it. */
#include <math.h>

#include "phase.h"
#include "wall.h"

/* The contact of slot i, of this radius and spin, as its law sees it; v: velocity against the wall. */
static struct pair_view view_contact(const struct wall_meeting *at, const double v[2], double radius,
                                     double w)
{
    double r = at->d + radius;
    return (struct pair_view){.r = r,
                              .over_r = 1.0 / r,
                              .radius_i = at->d * (2.0 * radius) / r,
                              .radius_j = 2.0 * radius - at->d * (2.0 * radius) / r,
                              .vn = v[0] * at->n[0] + v[1] * at->n[1],
                              .vt = v[1] * at->n[0] - v[0] * at->n[1],
                              .w_i = w};
}

/* What the book of the contact holds with one law. The potential counts with the sign of the feature at its
 * place, the spring with the sign that the last evaluation gave it. */
static double find_book(const struct pair_law *law, const struct wall_entry *entry,
                        const struct wall_meeting *at, const double v[2], double radius, double w,
                        double dt_path)
{
    const struct pair_view view = view_contact(at, v, radius, w);
    const struct bond bond = law_bond(law, 2.0 * radius);
    struct pair_effect arms;
    double held = law_spring_freed(law->kt_contact, entry->spring, law_sliding(&bond, &view, &arms), dt_path);
    return at->sign * phase_bond_book(law, &view, false, 0.0, 0.0, dt_path) + entry->sign * held;
}

/* The energy that the change of slot i adds to a contact. */
static double find_change(const struct walls *ws, const struct model *m, const struct particles *p, size_t i,
                          const struct wall_entry *entry, double dt_path)
{
    const struct wall *w = walls_of_feature(m, entry->feature);
    const struct wall_pose *pose = &ws->pose[w - m->walls];
    double now = p->radius[i], was = phase_radius(m, now, p->kind[i], p->was[i]), v[2];
    double spun = p->w[i] * ((now * now) / (was * was)); /* as phase_become */
    struct wall_meeting at;
    if (wall_holds(m, w, p, i))
        return 0.0;
    wall_meet(m, w, pose, p, i, entry, &at);
    wall_velocity(pose, at.lever, false, v);
    for (size_t a = 0; a < 2; a++)
        v[a] = p->v[2 * i + a] - v[a];
    return find_book(&w->laws[p->kind[i]], entry, &at, v, now, p->w[i], dt_path) -
           find_book(&w->laws[p->was[i]], entry, &at, v, was, spun, dt_path);
}

enum dm2_status walls_account(const struct walls *ws, const struct model *m, const struct particles *p,
                              int64_t step, double dt_path, struct dm2_error *err)
{
    double scale = m->fixed.energy;
    for (size_t row = 0; row < ws->n_rows; row++) {
        size_t i = ws->slot[row];
        int64_t moved = 0;
        for (uint32_t k = ws->start[row]; p->was[i] != p->kind[i] && k < ws->start[row + 1]; k++) {
            double change = find_change(ws, m, p, i, &ws->entry[k], dt_path) * scale;
            if (!(fabs(change) < 0x1p57))
                return dm2_fail(err, DM2_NUMERIC,
                                "step %lld: the change of phase of element %u, at (%g, %g) cm on the wall "
                                "'%s', moves more energy than sums can hold: check the densities and "
                                "stiffnesses of the phases",
                                (long long)step, p->id[i], p->r[2 * i], p->r[2 * i + 1],
                                walls_of_feature(m, ws->entry[k].feature)->config->name);
            moved += (int64_t)(change + copysign(0.5, change));
        }
        p->moved[i] -= (double)moved / scale;
    }
    return DM2_OK;
}
