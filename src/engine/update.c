/* The update between two rebuilds: one row of doubles per mirrored element, with the fields that change in a
 * step. */
#include "dm2/engine/subdomain.h"

#include <math.h>

#include "kinds.h"
#include "particles.h"
#include "periodic.h"
#include "phase.h"
#include "subdomain_parts.h"

/* Are the velocities of mirrored elements read? Every near law reads them: for damping, and for what a bond
 * that breaks or yields frees (law_freed). The measurement of strain needs near laws. */
static bool needs_velocity(const struct model *m)
{
    return m->has_near;
}

unsigned subdomain_update_fields(const struct model *m)
{
    return (needs_velocity(m) ? UPDATE_VELOCITY : 0u) | (m->has_spin ? UPDATE_SPIN : 0u) |
           (m->has_heat ? UPDATE_HEAT : 0u) | (m->has_pressure ? UPDATE_PRESSURE : 0u) |
           (m->has_kinds ? UPDATE_KIND : 0u) | (m->reaction.any ? UPDATE_COMPOSITION : 0u);
}

size_t subdomain_update_width(const struct model *m)
{
    return 2u + (needs_velocity(m) ? 2u : 0u) + (m->has_spin ? 1u : 0u) + (m->has_heat ? 1u : 0u) +
           (m->has_pressure ? 1u : 0u) + (m->has_kinds ? 1u : 0u) + (m->reaction.any ? 2u : 0u);
}

size_t subdomain_send_count(const struct subdomain *sd, int dest)
{
    return sd->neighbours[dest].send.n;
}

size_t subdomain_receive_count(const struct subdomain *sd, int src)
{
    return sd->neighbours[src].mirror_end - sd->neighbours[src].mirror_begin;
}

void subdomain_pack_update(const struct subdomain *sd, int dest, double *out)
{
    const struct particles *p = &sd->p;
    const struct model *m = sd->model;
    const struct slot_array *send = &sd->neighbours[dest].send;
    for (size_t k = 0; k < send->n; k++) {
        size_t i = send->item[k];
        *out++ = p->r[2 * i];
        *out++ = p->r[2 * i + 1];
        if (needs_velocity(m)) {
            *out++ = p->v[2 * i];
            *out++ = p->v[2 * i + 1];
        }
        if (m->has_spin)
            *out++ = p->w[i];
        if (m->has_heat)
            *out++ = p->heat[i];
        if (m->has_pressure)
            *out++ = p->p[i];
        if (m->has_kinds)
            *out++ = (double)p->kind[i] + 65536.0 * (double)p->was[i];
        for (size_t a = 0; a < 2 && m->reaction.any; a++)
            *out++ = p->share[2 * i + a];
    }
}

/* Sets kind and previous kind of slot i from their one number in an update. False: the deck has no such
 * kinds. */
static bool take_kind(const struct model *m, struct particles *p, size_t i, double packed)
{
    double was = floor(packed / 65536.0), kind = packed - 65536.0 * was, most = (double)m->n_kinds;
    if (!(was >= 0.0 && was < most && kind < most && kind == floor(kind)))
        return false;
    const struct kind *before = &m->kinds[p->kind[i]], *from = &m->kinds[(size_t)was];
    if (!kind_may_become(m, before->material, (size_t)kind) ||
        !kind_may_become(m, from->material, (size_t)kind))
        return false;
    phase_follow(m, p, i, (size_t)was, (size_t)kind);
    return true;
}

/* Is an element within two cell edges of its position before? No element moves further than one cell edge in
 * a step (leapfrog_move); the second leaves room for rounding. */
static bool is_near(const struct grid *g, const struct period *period, const double now[2],
                    const double before[2])
{
    double edge = g->lx < g->ly ? g->lx : g->ly, d[2];
    for (size_t a = 0; a < 2; a++)
        d[a] = period_nearest(now[a] - before[a], period->size[a], period->half[a]);
    return d[0] * d[0] + d[1] * d[1] <= 4.0 * edge * edge;
}

/* Is the place in the half-open domain along the periodic directions? */
static bool is_in_domain(const struct grid *g, const double r[2])
{
    for (size_t a = 0; a < 2; a++)
        if (g->periodic[a] && !(r[a] >= g->origin[a] && r[a] < g->origin[a] + g->size[a]))
            return false;
    return true;
}

/* Fails because of `what` in the update of the mirror in slot i, before its position changes. */
static enum dm2_status refuse_update(const struct subdomain *sd, size_t i, int src, const char *what,
                                     struct dm2_error *err)
{
    const double *r = &sd->p.r[2 * i];
    return dm2_fail(err, DM2_NUMERIC,
                    "step %lld: the update of element %u from server %d, last at (%g, %g) cm, %s",
                    (long long)sd->step, sd->p.id[i], src, r[0], r[1], what);
}

enum dm2_status subdomain_take_update(struct subdomain *sd, int src, const double *in, struct dm2_error *err)
{
    struct particles *p = &sd->p;
    const struct model *m = sd->model;
    const struct period period = period_of(&m->grid);
    size_t width = subdomain_update_width(m);
    for (size_t i = sd->neighbours[src].mirror_begin; i < sd->neighbours[src].mirror_end; i++, in += width) {
        double check = 0.0;
        for (size_t k = 0; k < width; k++)
            check += in[k] * 0.0; /* NaN where a value is not finite */
        if (check != 0.0 || check != check)
            return refuse_update(sd, i, src, "is not finite", err);
        if (!is_near(&m->grid, &period, in, &p->r[2 * i]))
            return refuse_update(sd, i, src, "puts it further than a cell edge away", err);
        if (!is_in_domain(&m->grid, in))
            return refuse_update(sd, i, src, "puts it outside the periodic domain", err);
        size_t k = 2;
        p->r[2 * i] = in[0];
        p->r[2 * i + 1] = in[1];
        if (needs_velocity(m)) {
            p->v[2 * i] = in[k++];
            p->v[2 * i + 1] = in[k++];
        }
        if (m->has_spin)
            p->w[i] = in[k++];
        if (m->has_heat)
            p->heat[i] = in[k++];
        if (m->has_pressure)
            p->p[i] = in[k++];
        if (m->has_kinds && !take_kind(m, p, i, in[k++]))
            return refuse_update(sd, i, src, "names a kind that the element cannot become", err);
        for (size_t a = 0; a < 2 && m->reaction.any; a++, k++) {
            if (!(in[k] >= 0.0 && in[k] <= p->share[2 * i + a]))
                return refuse_update(sd, i, src, "has a share of a reactant that is negative or has grown",
                                     err);
            p->share[2 * i + a] = in[k];
        }
        if (m->has_heat || m->has_kinds)
            particles_warm(p, m, i, 1.0 / p->mass[i]);
    }
    return DM2_OK;
}
