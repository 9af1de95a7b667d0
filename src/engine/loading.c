/* States of the bodies under force. A kick leaves the present states as they are until loading_take, because
 * the gap on which a stress acts may lie between two of the bodies. */
#include "dm2/engine/loading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "drive.h"
#include "loading_parts.h"

static const double warned_after = 10.0; /* diameters without touching anything */

size_t model_forced(const struct model *m)
{
    return m->n_forced;
}

bool model_forced_check(const struct model *m, size_t i, int axis, struct forced_check *out)
{
    const struct forced_axis *at = &m->forced[i].axis[axis];
    if (at->load == NULL)
        return false;
    const struct control_constants *c = &at->control;
    double contacts = c->mass * (at->share / c->dt) * (at->share / c->dt) / c->stiffness;
    *out = (struct forced_check){.load = at->load->name,
                                 .body = config_mover_name(m->config, m->forced[i].mover),
                                 .mass = c->mass,
                                 .share = at->share,
                                 .damping = control_damping(c, contacts),
                                 .fastest = c->fastest};
    return true;
}

/* --- states --- */

enum dm2_status loading_open(const struct model *m, int64_t step, struct loading **out, struct dm2_error *err)
{
    *out = NULL;
    if (m->n_forced == 0)
        return DM2_OK;
    struct loading *l = mem_zalloc(1, sizeof *l);
    if (l == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the loads of %zu bodies", m->n_forced);
    l->model = m;
    l->step = step;
    for (size_t i = 0; i < m->n_forced; i++)
        for (int a = 0; a < 2; a++)
            if (m->forced[i].axis[a].load != NULL)
                l->body[i].axis[a].velocity = config_velocity(m->config, m->forced[i].mover)[a];
    *out = l;
    return DM2_OK;
}

enum dm2_status loading_restore(struct loading *l, const struct section_array *bodies, struct dm2_error *err)
{
    const struct model *m = l->model;
    for (size_t i = 0; i < m->n_forced; i++) {
        const struct body_record *r = NULL;
        struct body_state *s = &l->body[i];
        for (size_t k = 0; k < bodies->n && r == NULL; k++) {
            r = section_record(SECTION_BODY, bodies, k);
            r = r->mover == m->forced[i].mover ? r : NULL;
        }
        if (r == NULL)
            return dm2_fail(err, DM2_PROTOCOL,
                            "section BODY: the state has no record of %s, which moves by a force",
                            config_mover_name(m->config, m->forced[i].mover));
        for (int a = 0; a < 2; a++) {
            s->axis[a] = (struct control_state){
                .shift = r->displacement[a], .velocity = r->velocity[a], .offset = r->integral[a]};
            for (int n = 0; n < 2; n++) {
                struct load_totals *t = n == 0 ? &s->last : &s->before;
                t->force[a] = r->force[n][a];
                t->speed[a] = r->touched[n][a];
                t->contacts = r->contacts[n];
            }
        }
    }
    return DM2_OK;
}

void loading_free(struct loading *l)
{
    free(l);
}

bool loading_collect(const struct loading *l, struct section_array *out)
{
    for (size_t i = 0; i < l->model->n_forced; i++) {
        const struct body_state *s = &l->body[i];
        size_t mover = l->model->forced[i].mover;
        struct body_record r = {.mover = (uint16_t)mover};
        for (int a = 0; a < 2; a++) {
            r.centroid[a] =
                mover < l->model->config->n_bodies ? l->model->centroids[2 * mover + (size_t)a] : 0.0;
            r.displacement[a] = s->axis[a].shift;
            r.velocity[a] = s->axis[a].velocity;
            r.integral[a] = s->axis[a].offset;
            for (int n = 0; n < 2; n++) {
                const struct load_totals *t = n == 0 ? &s->last : &s->before;
                r.force[n][a] = t->force[a];
                r.touched[n][a] = t->speed[a];
                r.contacts[n] = t->contacts;
            }
        }
        if (!section_append(SECTION_BODY, out, &r, 1))
            return false;
    }
    return true;
}

/* --- a step --- */

/* The displacement of a mover along an axis since the start of the run, cm, at the present step. */
static double find_shift(const struct loading *l, size_t mover, int axis)
{
    struct rigid_motion at;
    loading_motion(l, l->model, mover, l->step, &at);
    return axis == 0 ? at.dx : at.dy;
}

/* The load of body i along an axis at the present step, Mbar cm2. */
static double find_load(const struct loading *l, size_t i, int axis)
{
    const struct forced_axis *at = &l->model->forced[i].axis[axis];
    double gap = at->length;
    if (at->facing[0] != MOVER_NONE)
        gap += find_shift(l, at->facing[1], 1 - axis) - find_shift(l, at->facing[0], 1 - axis);
    return forced_load(l->model, at, l->step, gap > 0.0 ? gap : 0.0);
}

/* The response of the sample to body i along an axis, in the evaluation before the last. */
static struct control_response find_response(const struct loading *l, size_t i, int axis)
{
    const struct load_totals *t = &l->body[i].before;
    struct control_response r = {.contacts = (double)t->contacts,
                                 .force = exact_value(&t->force[axis], 0) * l->model->fixed.over_force};
    if (t->contacts > 0)
        r.speed = exact_value(&t->speed[axis], l->model->scales.velocity) / r.contacts;
    return r;
}

/* DM2_NUMERIC where body i would be further beyond the domain along the axis than the domain is long. */
static enum dm2_status check_place(const struct loading *l, size_t i, int axis, struct dm2_error *err)
{
    const struct config *c = l->model->config;
    const struct forced_body *body = &l->model->forced[i];
    double shift = l->body[i].next[axis].shift, low = c->origin[axis], size = c->size[axis];
    if (body->axis[axis].load == NULL || c->periodic[axis] ||
        (body->low[axis] + shift < low + 2.0 * size && body->high[axis] + shift > low - size))
        return DM2_OK;
    return dm2_fail(
        err, DM2_NUMERIC,
        "step %lld: load '%s' has moved '%s' by %g cm along %c, further beyond the domain than the "
        "domain is long: the body meets nothing that bears the load",
        (long long)l->step, body->axis[axis].load->name, config_mover_name(c, body->mover), shift,
        axis == 0 ? 'x' : 'y');
}

/* The kick of body i along an axis. */
static void kick_axis(struct loading *l, size_t i, int axis)
{
    const struct forced_axis *at = &l->model->forced[i].axis[axis];
    struct control_state *next = &l->body[i].next[axis];
    *next = l->body[i].axis[axis];
    if (at->load == NULL)
        return;
    if (l->step - l->model->config->n_start >= 2) { /* before, there are no totals */
        const struct control_response response = find_response(l, i, axis);
        control_kick(&at->control, find_load(l, i, axis), at->weight, &response, next);
    }
    control_drift(&at->control, next);
}

enum dm2_status loading_kick(struct loading *l, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t i = 0; i < l->model->n_forced; i++) {
        for (int a = 0; a < 2; a++) {
            kick_axis(l, i, a);
            if (status == DM2_OK)
                status = check_place(l, i, a, err);
        }
    }
    return status;
}

void loading_take(struct loading *l, const struct load_totals *totals)
{
    for (size_t i = 0; i < l->model->n_forced; i++) {
        struct body_state *s = &l->body[i];
        double path2 = 0.0;
        for (int a = 0; a < 2; a++) {
            s->axis[a] = s->next[a];
            path2 += s->axis[a].velocity * s->axis[a].velocity;
        }
        s->path = totals[i].contacts > 0 ? 0.0 : s->path + sqrt(path2) * l->model->config->dt;
        s->before = s->last;
        s->last = totals[i];
    }
    l->step++;
}

void loading_drive(const struct loading *l, struct body_drive *drives)
{
    for (size_t i = 0; i < l->model->n_forced; i++) {
        const struct forced_body *body = &l->model->forced[i];
        for (int a = 0; a < 2; a++) {
            if (body->axis[a].load == NULL || body->mover >= l->model->config->n_bodies)
                continue;
            drives[body->mover].to[a] += l->body[i].next[a].shift;
            drives[body->mover].v[a] += l->body[i].next[a].velocity;
        }
    }
}

void loading_add_shift(const struct loading *l, size_t body, double r[2])
{
    if (l == NULL || l->model->forced_of[body] == 0)
        return;
    for (int a = 0; a < 2; a++)
        r[a] += l->body[l->model->forced_of[body] - 1].axis[a].shift;
}

void loading_motion(const struct loading *l, const struct model *m, size_t mover, int64_t step,
                    struct rigid_motion *out)
{
    motion_at(m, mover, step, out);
    if (l == NULL || m->forced_of[mover] == 0)
        return;
    const struct forced_body *body = &m->forced[m->forced_of[mover] - 1];
    const struct body_state *s = &l->body[m->forced_of[mover] - 1];
    const struct control_state *at = step > l->step ? s->next : s->axis;
    if (body->axis[0].load != NULL) {
        out->dx = at[0].shift;
        out->vx = at[0].velocity;
    }
    if (body->axis[1].load != NULL) {
        out->dy = at[1].shift;
        out->vy = at[1].velocity;
    }
}

bool loading_warns(struct loading *l, char line[LOADING_LINE])
{
    const struct model *m = l->model;
    for (size_t i = 0; i < m->n_forced; i++) {
        const struct forced_body *body = &m->forced[i];
        struct body_state *s = &l->body[i];
        const struct load_config *load = body->axis[body->axis[0].load == NULL].load;
        if (s->warned || !(s->path > warned_after * 2.0 * body->radius))
            continue;
        s->warned = true;
        (void)snprintf(
            line, LOADING_LINE,
            "warning: step %lld: load '%s' has moved '%s' by %.3g cm, and it touches nothing: is there "
            "a sample in its way?",
            (long long)l->step, load->name, config_mover_name(m->config, body->mover), s->path);
        return true;
    }
    return false;
}
