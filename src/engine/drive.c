/* Loads of bodies, step by step; see drive.h. */
#include "drive.h"

#include <math.h>

#include "dm2/base/mem.h"
#include "dm2/base/real.h"
#include "tables.h"

bool drive_is_needed(const struct model *m)
{
    for (size_t b = 0; b < m->config->n_bodies; b++)
        if (m->driven[b])
            return true;
    return false;
}

int drive_find_runs(struct drive_runs *runs, const struct model *m, const struct particles *p)
{
    bool inside = false;
    runs->n = 0;
    for (size_t i = 0; i < p->n_own; i++) {
        if (m->driven[p->body[i]] == inside)
            continue;
        uint32_t *edge = mem_grown(runs->edge, &runs->cap, runs->n, runs->n + 1, sizeof *edge);
        if (edge == NULL)
            return -1;
        runs->edge = edge;
        edge[runs->n++] = (uint32_t)i;
        inside = !inside;
    }
    return 0;
}

/* A body that does not turn has cosine 1 and sine 0, exactly. */
void drive_set_place(const struct model *m, size_t body, int64_t step, struct body_drive *d)
{
    const double *centroid = &m->centroids[2 * body], dt = m->config->dt;
    struct rigid_motion now, next;
    motion_at(m, body, step, &now);
    motion_at(m, body, step + 1, &next);
    double cosine = real_cos(now.angle), sine = real_sin(now.angle);
    d->to[0] = centroid[0] + next.dx;
    d->to[1] = centroid[1] + next.dy;
    d->v[0] = next.vx;
    d->v[1] = next.vy;
    d->w = next.spin;
    d->cosine = real_cos(next.angle);
    d->sine = real_sin(next.angle);
    d->turn[0] = (d->cosine - cosine) / dt;
    d->turn[1] = (d->sine - sine) / dt;
}

void drive_set(const struct model *m, int64_t step, struct body_drive *drives)
{
    const struct config *c = m->config;
    for (size_t b = 0; b < c->n_bodies; b++) {
        drives[b] = (struct body_drive){.placed = m->placed[b]};
        if (drives[b].placed)
            drive_set_place(m, b, step, &drives[b]);
    }
    for (size_t i = 0; i < c->n_loads; i++) {
        enum load_quantity q = c->loads[i].quantity;
        if ((q != LOAD_ACCELERATION_X && q != LOAD_ACCELERATION_Y) || c->loads[i].mover >= c->n_bodies)
            continue;
        drives[c->loads[i].mover].pushed = true;
        drives[c->loads[i].mover].a[q - LOAD_ACCELERATION_X] = motion_load(m, i, step);
    }
}

void drive_hold_heat(const struct model *m, struct particles *p, int64_t step)
{
    const struct config *c = m->config;
    for (size_t k = 0; k < c->n_loads; k++) {
        if (c->loads[k].quantity != LOAD_TEMPERATURE || c->loads[k].mover >= c->n_bodies)
            continue;
        double temperature = motion_load(m, k, step);
        for (size_t i = 0; i < p->n_own; i++) {
            if (p->body[i] != c->loads[k].mover)
                continue;
            const struct kind *kind = &m->kinds[p->kind[i]];
            double cp = particles_heat_capacity(p, m, i);
            if (!isfinite(cp))
                continue;
            double heat = p->mass[i] * cp * (temperature - kind->t0);
            p->work[i] += heat - p->heat[i];
            p->heat[i] = heat;
            particles_warm(p, m, i, 1.0 / p->mass[i]);
        }
    }
}
