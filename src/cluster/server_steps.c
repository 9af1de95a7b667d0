/* The time steps of a session.
 *
 * A step: forces, move, pack, one STEP message out, one NEXT message in, take. Between the two messages the
 * server begins the forces of the next step, for all pairs that need nothing from NEXT. The NEXT of the step
 * before decides whether the segments are updates or the parcels of a rebuild; with `redo` the client asks
 * for a rebuild after all, and the server sends the same step again. */
#include "server_parts.h"

#include <sched.h>
#include <stdlib.h>

#include "dm2/base/clock.h"
#include "dm2/base/mem.h"
#include "dm2/cluster/wire.h"
#include "dm2/deck/schedule.h"
#include "dm2/output/state_hash.h"
#include "state_parts.h"

/* --- states and profiles --- */

/* Starts or ends the counting of processor seconds in s->times.cpu; returns whether they were counted before.
 * Computing, packing and unpacking count; sending, receiving and waiting do not, because their calls cost
 * processor seconds of the system. */
static bool count_cpu(struct session *s, bool on)
{
    double now = clock_cpu();
    bool before = s->cpu_on;
    if (before)
        s->times.cpu += now - s->cpu_since;
    s->cpu_on = on;
    s->cpu_since = now;
    return before;
}

/* Sends the state of the subdomain in STATE messages. DM2_MEMORY. */
static enum dm2_status send_state(struct session *s, enum state_purpose purpose, struct dm2_error *err)
{
    double start = clock_now();
    server_beat(s);
    bool counted = count_cpu(s, false);
    size_t n = subdomain_owned(s->sd);
    struct state_parts parts = {.head = {.step = subdomain_step(s->sd), .purpose = purpose},
                                .state = {.n_elements = n}};
    struct element *elements = mem_alloc(n, sizeof *elements);
    struct element_measure *measured = purpose == STATE_SNAPSHOT ? mem_alloc(n, sizeof *measured) : NULL;
    struct pair_record *pairs = NULL;
    struct pair_measure *forces = NULL;
    enum dm2_status status = DM2_OK;
    if (elements == NULL || (purpose == STATE_SNAPSHOT && measured == NULL))
        status = dm2_fail(err, DM2_MEMORY, "no memory to send a state of %zu elements", n);
    if (status == DM2_OK)
        status = subdomain_collect(s->sd, elements, measured, err);
    server_beat(s);
    if (status == DM2_OK)
        status = purpose == STATE_SNAPSHOT
                     ? subdomain_collect_acting(s->sd, &pairs, &forces, &parts.state.n_pairs, err)
                     : subdomain_collect_pairs(s->sd, &pairs, &parts.state.n_pairs, err);
    if (status == DM2_OK && purpose != STATE_SNAPSHOT)
        status = subdomain_collect_sections(s->sd, parts.state.sections, err);
    else if (status == DM2_OK)
        status = subdomain_collect_wall_forces(s->sd, &parts.state.sections[SECTION_WFOR], err);
    server_beat(s);
    parts.state.elements = elements;
    parts.measured = measured;
    parts.state.pairs = pairs;
    parts.forces = forces;
    while (status == DM2_OK && state_parts_next(&parts, &s->out))
        status = server_send(s, MESSAGE_STATE, err);
    section_free(parts.state.sections);
    free(elements);
    free(measured);
    free(pairs);
    free(forces);
    s->times.output += clock_now() - start;
    (void)count_cpu(s, counted);
    return status;
}

/* The profiles that are due, one message each. */
static enum dm2_status send_profiles(struct session *s, struct dm2_error *err)
{
    if (s->config.n_profiles == 0)
        return DM2_OK;
    double start = clock_now();
    int64_t step = subdomain_step(s->sd);
    bool counted = count_cpu(s, false);
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < s->config.n_profiles && status == DM2_OK; k++) {
        struct profile_message m = {.step = step, .which = k, .n_bins = (size_t)s->config.profiles[k].bins};
        if (!schedule_profile(&s->config, k, step))
            continue;
        struct profile_bin *bins = mem_zalloc(m.n_bins, sizeof *bins);
        if (bins == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for a profile of %zu bins", m.n_bins);
        status = subdomain_profile(s->sd, k, bins, err);
        bytes_clear(&s->out);
        message_put_profile(&s->out, &m);
        for (size_t b = 0; b < m.n_bins; b++)
            wire_put_bin(&s->out, &bins[b]);
        free(bins);
        if (status == DM2_OK)
            status = server_send(s, MESSAGE_PROFILE, err);
    }
    s->times.output += clock_now() - start;
    (void)count_cpu(s, counted);
    return status;
}

/* --- steps --- */

/* Adds the engine's times since the last call to s->times; returns the seconds of rebuilds among them. */
static double add_engine_times(struct session *s)
{
    struct subdomain_times t;
    subdomain_take_times(s->sd, &t);
    s->times.forces += t.forces;
    s->times.integrate += t.integrate;
    s->times.rebuild += t.rebuild;
    s->times.rebuilds += t.rebuilds;
    return t.rebuild;
}

/* Packs and sends one STEP message. Packing determines counts that the head holds: the head is written
 * before, for its length, and again afterwards. */
static enum dm2_status send_step(struct session *s, struct step_message *m, struct dm2_error *err)
{
    enum dm2_status status;
    double start = clock_now();
    (void)add_engine_times(s);
    bytes_clear(&s->out);
    message_put_step(&s->out, m);
    size_t head = s->out.length;
    m->owned = subdomain_owned(s->sd);
    m->migrants = 0;
    if (m->rebuild)
        status = exchange_pack_rebuild(&s->exchange, s->sd, &s->out, &m->n_segments, &m->migrants, err);
    else
        status = exchange_pack_update(&s->exchange, s->sd, &s->out, &m->n_segments, err);
    if (status != DM2_OK)
        return status;
    double rebuild = add_engine_times(s), now = clock_now();
    m->busy = now - s->heard + s->ahead;
    s->ahead = 0.0;
    s->times.pack += now - start - rebuild;
    s->times.migrants += m->migrants;
    size_t length = s->out.length;
    s->out.length = 0;
    message_put_step(&s->out, m);
    if (s->out.length != head)
        return dm2_fail(err, DM2_PROTOCOL, "the head of a step message changed its length");
    s->out.length = length;
    (void)count_cpu(s, false);
    return server_send(s, MESSAGE_STEP, err);
}

/* Waits for the NEXT of this step; *r is left at its segments. */
static enum dm2_status get_next(struct session *s, int64_t step, struct next_message *next,
                                struct bytes_reader *r, struct dm2_error *err)
{
    double start = clock_now();
    enum dm2_status status = server_expect(s, MESSAGE_NEXT, LIMIT_STEP, server_deadline(s), r, err);
    s->heard = clock_now();
    s->times.wait += s->heard - start;
    (void)count_cpu(s, true);
    if (status != DM2_OK)
        return status;
    message_get_next(r, next);
    if (r->failed)
        return server_not_decoded("NEXT", err);
    if (next->step != step)
        return dm2_fail(err, DM2_PROTOCOL, "the client sent NEXT for step %lld where %lld is due",
                        (long long)next->step, (long long)step);
    if (next->n_loads != (next->redo ? 0 : model_forced(s->model)))
        return dm2_fail(err, DM2_PROTOCOL, "the client sent the totals of %zu bodies with NEXT, %zu are due",
                        next->n_loads, model_forced(s->model));
    return DM2_OK;
}

/* Computes the forces of the next step that need nothing from other ranks, while NEXT is on the way.
 * sched_yield comes first, because a client on the same processor could not read STEP before this work is
 * done. */
static void start_next_forces(struct session *s, int64_t step)
{
    if (step == s->config.steps)
        return; /* server_send_done sends the final state before the last forces */
    (void)sched_yield();
    double start = clock_now();
    (void)count_cpu(s, true);
    subdomain_forces_ahead(s->sd, schedule_measure(&s->config, step));
    (void)count_cpu(s, false);
    s->ahead = clock_now() - start;
    s->times.ahead += s->ahead;
}

/* The exchange after a step. *asked holds the NEXT of the step before on entry, the NEXT of this step on
 * return. */
static enum dm2_status swap_segments(struct session *s, struct step_message *m, struct next_message *asked,
                                     struct dm2_error *err)
{
    struct next_message next;
    struct bytes_reader r;
    m->rebuild = asked->rebuild_next;
    enum dm2_status status = send_step(s, m, err);
    if (status == DM2_OK && !m->rebuild)
        start_next_forces(s, m->step);
    if (status == DM2_OK)
        status = get_next(s, m->step, &next, &r, err);
    if (status == DM2_OK && next.redo) {
        if (m->rebuild)
            return dm2_fail(err, DM2_PROTOCOL, "the client asks for a rebuild of step %lld, which was one",
                            (long long)m->step);
        m->rebuild = true;
        m->measured = m->hashed = m->surveyed = false;
        m->cracks = (struct crack_part){0};
        m->n_loads = 0;
        status = send_step(s, m, err);
        if (status == DM2_OK)
            status = get_next(s, m->step, &next, &r, err);
        if (status == DM2_OK && next.redo)
            return dm2_fail(err, DM2_PROTOCOL, "the client asks twice for a rebuild of step %lld",
                            (long long)m->step);
    }
    if (status != DM2_OK)
        return status;
    double start = clock_now();
    subdomain_take_totals(s->sd, next.loads);
    if (m->rebuild)
        status = exchange_take_rebuild(&s->exchange, s->sd, &r, next.n_segments, err);
    else
        status = exchange_take_update(&s->exchange, s->sd, &r, next.n_segments, err);
    s->times.unpack += clock_now() - start - add_engine_times(s);
    if (next.ends && next.step + 2 < s->config.steps)
        s->config.steps = next.step + 2; /* the schedule of results follows */
    *asked = next;
    return status;
}

/* The links that broke in the last evaluation of forces. */
static struct crack_part cracks_of(struct subdomain *sd)
{
    const struct crack_list *list = subdomain_cracks(sd);
    return (struct crack_part){.n = list->n, .items = list->items};
}

static enum dm2_status run_step(struct session *s, int64_t n, struct next_message *asked,
                                struct dm2_error *err)
{
    bool snapshot = schedule_snapshot(&s->config, n), measure = schedule_measure(&s->config, n);
    struct step_message m; /* its measures are large, and set where they are due */
    m.step = n + 1;
    m.rebuild = m.hashed = false;
    m.measured = measure;
    m.owned = m.migrants = m.hash = 0;
    m.busy = 0.0;
    m.n_segments = 0;
    int64_t every = s->assign.hash_every;
    enum dm2_status status = subdomain_forces(s->sd, measure, err);
    if (status == DM2_OK && snapshot)
        status = send_state(s, STATE_SNAPSHOT, err);
    if (status == DM2_OK)
        status = send_profiles(s, err);
    if (status == DM2_OK)
        status = subdomain_move(s->sd, &m.dmax, measure ? &m.measures : NULL, err);
    m.surveyed = asked->survey_next;
    if (status == DM2_OK && m.surveyed)
        subdomain_survey(s->sd, &m.spread);
    m.n_loads = model_forced(s->model);
    for (size_t i = 0; i < m.n_loads; i++)
        m.loads[i] = subdomain_load_totals(s->sd)[i];
    m.hashed = every > 0 && (m.step % every == 0 || m.step == s->config.steps);
    m.cracks = cracks_of(s->sd);
    server_beat(s);
    if (status == DM2_OK && m.hashed)
        status = state_hash_subdomain(s->sd, &m.hash, err);
    if (status == DM2_OK && asked->copy_next)
        status = send_state(s, STATE_COPY, err);
    if (status == DM2_OK)
        status = swap_segments(s, &m, asked, err);
    s->times.steps++;
    s->times.mirrored += subdomain_mirrored(s->sd);
    s->summary->steps = m.step;
    return status;
}

enum dm2_status server_run_steps(struct session *s, struct dm2_error *err)
{
    struct next_message asked = {.rebuild_next = s->assign.rebuild_first, .copy_next = s->assign.copy_first};
    enum dm2_status status = DM2_OK;
    (void)count_cpu(s, true);
    s->heard = clock_now();
    for (int64_t n = subdomain_step(s->sd); n < s->config.steps && status == DM2_OK; n++)
        status = run_step(s, n, &asked, err);
    (void)count_cpu(s, false);
    return status;
}

enum dm2_status server_send_done(struct session *s, struct dm2_error *err)
{
    struct done_message done = {0};
    (void)add_engine_times(s);
    enum dm2_status status = send_state(s, STATE_FINAL, err);
    if (status == DM2_OK)
        status = subdomain_forces(s->sd, true, err);
    if (status == DM2_OK && schedule_snapshot(&s->config, s->config.steps))
        status = send_state(s, STATE_SNAPSHOT, err);
    if (status == DM2_OK)
        status = send_profiles(s, err);
    if (status == DM2_OK)
        status = subdomain_measure_last(s->sd, &done.measures, err);
    if (status != DM2_OK)
        return status;
    done.cracks = cracks_of(s->sd);
    done.times = s->times;
    done.times.messages_in = s->channel.frames_in;
    done.times.messages_out = s->channel.frames_out;
    done.times.bytes_in = s->channel.bytes_in;
    done.times.bytes_out = s->channel.bytes_out;
    bytes_clear(&s->out);
    message_put_done(&s->out, &done);
    return server_send(s, MESSAGE_DONE, err);
}
