/* A time step of the client has five parts:
 *
 *     gather   STEP from every rank; STATE parts and PROFILE sums come before STEP where they are due
 *     decide   from counts, dmax and surveys: is this exchange redone, of which kind is the next one
 *     route    segments to their destinations, out of the buffers that received them
 *     send     NEXT to every rank
 *     write    history, profiles, snapshots, copies, while the servers compute */
#include "client_parts.h"

#include <stdio.h>
#include <string.h>

#include "dm2/base/bytes.h"
#include "dm2/base/clock.h"
#include "dm2/cluster/wire.h"
#include "dm2/deck/schedule.h"
#include "dm2/output/results.h"

/* Adds the broken links that came from a server to c->cracks. */
static enum dm2_status take_cracks(struct client *c, int rank, const struct crack_part *part,
                                   struct dm2_error *err)
{
    struct bytes_reader r = bytes_reader_of(part->bytes, part->n * WIRE_CRACK);
    for (size_t k = 0; k < part->n; k++) {
        struct crack crack;
        wire_get_crack(&r, model_ids(c->job->model), &crack);
        if (r.failed)
            return conversation_not_decoded(&c->talk, rank, "list of broken links", err);
        if (crack_list_add(&c->cracks, &crack) != 0)
            return dm2_fail(err, DM2_MEMORY, "no memory for %zu broken links", part->n);
    }
    return DM2_OK;
}

static enum dm2_status take_step(void *context, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct client *c = context;
    struct server_answers *a = &c->answers[rank];
    message_get_step(r, &a->step);
    if (r->failed)
        return conversation_not_decoded(&c->talk, rank, "STEP", err);
    a->segments = (struct relay_source){
        .segments = r->data + r->at, .length = bytes_remaining(r), .count = a->step.n_segments};
    return take_cracks(c, rank, &a->step.cracks, err);
}

/* The STEP messages of all ranks together. */
struct step_sum {
    double dmax;   /* cm, the maximum */
    double busy;   /* seconds of work, the maximum, */
    int slowest;   /* by this rank */
    uint64_t hash; /* the sum */
    struct spread spread;
    struct measures measures;
    struct load_totals loads[FORCED_MAX]; /* the sums */
};

static const char not_its_probes[] = "its measures have other probes than the deck";

/* Adds the totals of the bodies under force in the STEP message of one rank; a repeated STEP has none. */
static enum dm2_status sum_loads(struct client *c, int rank, bool again, struct load_totals *loads,
                                 struct dm2_error *err)
{
    const struct step_message *m = &c->answers[rank].step;
    if (m->n_loads != (again ? 0 : model_forced(c->job->model)))
        return conversation_failed(
            &c->talk, rank, DM2_PROTOCOL,
            "its STEP message has the totals of other bodies than the deck moves by forces", err);
    for (size_t i = 0; i < m->n_loads; i++)
        load_totals_merge(&loads[i], &m->loads[i]);
    return DM2_OK;
}

/* Checks that the STEP message of every rank is the requested one, and combines all of them in *sum. again:
 * the step is repeated as a rebuild. */
static enum dm2_status sum_steps(struct client *c, bool rebuild, bool measured, bool hashed, bool surveyed,
                                 bool again, struct step_sum *sum, struct dm2_error *err)
{
    uint64_t elements = 0;
    sum->dmax = sum->busy = 0.0;
    sum->slowest = 0;
    sum->hash = 0;
    sum->spread = spread_none();
    memset(sum->loads, 0, sizeof sum->loads);
    measures_clear(&sum->measures);
    for (int k = 0; k < c->ranks; k++) {
        const struct step_message *m = &c->answers[k].step;
        if (m->step != c->talk.at || m->rebuild != rebuild || m->measured != measured ||
            m->hashed != hashed || m->surveyed != surveyed) {
            char text[160];
            (void)snprintf(
                text, sizeof text,
                "its STEP message is of step %lld (rebuild %d, measures %d, hash %d, survey %d), not as "
                "asked for (%d, %d, %d, %d)",
                (long long)m->step, m->rebuild, m->measured, m->hashed, m->surveyed, rebuild, measured,
                hashed, surveyed);
            return conversation_failed(&c->talk, k, DM2_PROTOCOL, text, err);
        }
        if (measured && !measures_match(&m->measures, c->job->config))
            return conversation_failed(&c->talk, k, DM2_PROTOCOL, not_its_probes, err);
        enum dm2_status status = sum_loads(c, k, again, sum->loads, err);
        if (status != DM2_OK)
            return status;
        elements += m->owned;
        sum->dmax = m->dmax > sum->dmax ? m->dmax : sum->dmax;
        if (m->busy > sum->busy || k == 0) {
            sum->busy = m->busy;
            sum->slowest = k;
        }
        if (surveyed)
            spread_merge(&sum->spread, &m->spread);
        sum->hash += m->hash;
        if (measured)
            measures_merge(&sum->measures, &m->measures);
    }
    if (elements != model_elements(c->job->model))
        return dm2_fail(err, DM2_NUMERIC, "step %lld: the servers hold %llu elements together instead of %zu",
                        (long long)c->talk.at, (unsigned long long)elements, model_elements(c->job->model));
    return DM2_OK;
}

/* Sends NEXT to every rank, with its segments or with none; m.n_segments is set here. */
static enum dm2_status send_next(struct client *c, struct next_message m, bool segments,
                                 struct dm2_error *err)
{
    int culprit = -1;
    struct dm2_error why = {0};
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks && segments; k++)
        c->sources[k] = c->answers[k].segments;
    if (segments)
        status = relay_run(&c->relay, c->sources, &culprit, &why);
    if (status != DM2_OK)
        return culprit >= 0 ? conversation_failed(&c->talk, culprit, status, why.text, err)
                            : dm2_fail(err, status, "%s", why.text);
    for (int k = 0; k < c->ranks; k++) {
        struct iovec bare[RELAY_SPARE], *iov = segments ? c->relay.route[k].iov : bare;
        m.n_segments = segments ? c->relay.route[k].count : 0;
        bytes_clear(&c->talk.out);
        message_put_next(&c->talk.out, &m);
        if (c->talk.out.failed)
            return dm2_fail(err, DM2_MEMORY, "no memory for a message");
        iov[1] = (struct iovec){.iov_base = c->talk.out.data, .iov_len = c->talk.out.length};
        status = conversation_send_parts(&c->talk, k, MESSAGE_NEXT, iov,
                                         segments ? c->relay.route[k].n_iov : RELAY_SPARE, err);
        if (status != DM2_OK)
            return status;
    }
    return DM2_OK;
}

/* Decides, routes and sends, which ends one step and starts the next. *rebuild: this exchange was requested
 * as a rebuild; on return: the next exchange is. ends: a block `stop` held at the row of this step, so that
 * NEXT tells the end of the run. */
static enum dm2_status exchange_step(struct client *c, bool *rebuild, const struct step_sum *sum, bool ends,
                                     struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    bool last = c->talk.at == c->job->config->steps;
    if (rebuild_plan_step(&c->plan, sum->dmax, c->survey ? &sum->spread : NULL) && !*rebuild) {
        struct step_sum again;
        *rebuild = true;
        c->course->report.redone++;
        status = send_next(c, (struct next_message){.step = c->talk.at, .redo = true}, false, err);
        if (status == DM2_OK)
            status = conversation_gather(&c->talk, MESSAGE_STEP, LIMIT_STEP, take_step, false, err);
        if (status == DM2_OK)
            status = sum_steps(c, true, false, false, false, true, &again, err);
        if (status != DM2_OK)
            return status;
    }
    if (*rebuild) {
        rebuild_plan_done(&c->plan);
        c->course->report.rebuilds++;
    }
    *rebuild = !last && rebuild_plan_expected(&c->plan);
    c->survey = !last && rebuild_plan_survey(&c->plan);
    double start = clock_now();
    c->copy_due = course_wants_copy(c->course, c->job, c->talk.at + 1);
    struct next_message next = {.step = c->talk.at,
                                .rebuild_next = *rebuild,
                                .copy_next = c->copy_due,
                                .survey_next = c->survey,
                                .ends = ends,
                                .n_loads = model_forced(c->job->model)};
    for (size_t i = 0; i < next.n_loads; i++)
        next.loads[i] = sum->loads[i];
    status = send_next(c, next, true, err);
    c->course->report.relay += clock_now() - start;
    return status;
}

/* Writes a row of the history, and tells the warning that follows from the row. */
static enum dm2_status write_row(struct client *c, int64_t n, const struct measures *m, struct dm2_error *err)
{
    char line[RESULTS_LINE];
    enum dm2_status status = results_history(c->job->results, n, m, err);
    if (status == DM2_OK && results_warns(c->job->results, line))
        course_tell_user(c->options, line);
    return status;
}

/* Writes the row of step n where the deck has blocks `stop`. *ends: the row has ended the run, whose last
 * step is now that of the config. */
static enum dm2_status watch_row(struct client *c, int64_t n, const struct measures *m, bool *ends,
                                 struct dm2_error *err)
{
    int64_t end;
    struct config *config = c->job->config;
    enum dm2_status status = write_row(c, n, m, err);
    *ends = status == DM2_OK && results_stopped(c->job->results, &end) && end < config->steps;
    if (*ends)
        config->steps = end;
    return status;
}

/* Moves the bodies under force as the servers do, and tells of a body that meets nothing. */
static enum dm2_status move_loaded(struct client *c, const struct load_totals *totals, struct dm2_error *err)
{
    char line[LOADING_LINE];
    if (c->loading == NULL)
        return DM2_OK;
    enum dm2_status status = loading_kick(c->loading, err);
    if (status == DM2_OK)
        loading_take(c->loading, totals);
    while (status == DM2_OK && loading_warns(c->loading, line))
        course_tell_user(c->options, line);
    return status;
}

/* Runs the step from state n to state n + 1 and writes the results of state n. */
static enum dm2_status run_step(struct client *c, int64_t n, bool *rebuild, struct dm2_error *err)
{
    const struct config *config = c->job->config;
    const struct client_events *events = &c->options->events;
    bool history = schedule_history(config, n), snapshot = schedule_snapshot(config, n);
    int64_t every = c->options->hash_every;
    bool hashed = every > 0 && ((n + 1) % every == 0 || n + 1 == config->steps);
    struct step_sum sum;
    double start = clock_now();
    bool copy = c->copy_due;
    c->talk.at = n + 1;
    c->cracks.n = 0;
    collection_expect(&c->collection, STATE_SNAPSHOT, snapshot, n);
    collection_expect(&c->collection, STATE_COPY, copy, n + 1);
    collection_expect_profiles(&c->collection, n);
    enum dm2_status status = conversation_gather(&c->talk, MESSAGE_STEP, LIMIT_STEP, take_step, false, err);
    if (status == DM2_OK)
        status = sum_steps(c, *rebuild, schedule_measure(config, n), hashed, c->survey, false, &sum, err);
    if (status == DM2_OK && n == config->n_start)
        status = model_check_start(c->job->model, &sum.measures, err);
    bool ends = false, watched = history && config->n_stops > 0;
    if (status == DM2_OK && watched)
        status = watch_row(c, n, &sum.measures, &ends, err);
    if (status == DM2_OK && snapshot)
        status = collection_place_walls(&c->collection, err);
    if (status == DM2_OK)
        status = move_loaded(c, sum.loads, err);
    if (status == DM2_OK)
        status = exchange_step(c, rebuild, &sum, ends, err);
    if (status != DM2_OK)
        return status;
    double sent = clock_now();
    if (!snapshot && !copy) { /* the time of sending a state is no part of a time step */
        c->course->report.stepping += sent - start;
        c->course->report.timed++;
    }
    if (history && !watched)
        status = write_row(c, n, &sum.measures, err);
    if (status == DM2_OK)
        status = results_cracks(c->job->results, n, &c->cracks, err);
    if (status == DM2_OK)
        status = collection_write_profiles(&c->collection, err);
    if (snapshot && status == DM2_OK)
        status = collection_write(&c->collection, STATE_SNAPSHOT, err);
    c->course->report.output += clock_now() - sent;
    if (copy && status == DM2_OK)
        status = collection_write(&c->collection, STATE_COPY, err);
    course_note_copy(c->course, c->job, c->talk.at, copy && status == DM2_OK, snapshot, clock_now() - start);
    c->course->report.steps = c->talk.at;
    if (hashed && status == DM2_OK)
        course_tell_hash(c->course, c->options, c->talk.at, sum.hash);
    if (events->step != NULL && status == DM2_OK)
        events->step(events->context, c->talk.at,
                     c->ranks > 1 ? c->talk.peers[sum.slowest].channel.name : NULL, sum.busy);
    if (copy && c->course->stopping && status == DM2_OK)
        status = dm2_fail(err, DM2_INTERRUPTED, "the run was interrupted by a signal at step %lld",
                          (long long)c->talk.at);
    return status;
}

enum dm2_status client_run_steps(struct client *c, struct dm2_error *err)
{
    bool rebuild = rebuild_plan_expected(&c->plan); /* as ASSIGN said */
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks; k++)
        c->talk.peers[k].awaited = true; /* the servers start the first step without a message */
    c->talk.stopping = &c->course->stopping;
    c->talk.again = c->course->stepping = true;
    for (int64_t n = course_step(c->course, c->job); n < c->job->config->steps && status == DM2_OK; n++)
        status = run_step(c, n, &rebuild, err);
    return status;
}

/* --- the end --- */

static enum dm2_status take_done(void *context, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct client *c = context;
    struct server_answers *a = &c->answers[rank];
    message_get_done(r, &a->done);
    if (r->failed)
        return conversation_not_decoded(&c->talk, rank, "DONE", err);
    enum dm2_status status = take_cracks(c, rank, &a->done.cracks, err);
    if (status != DM2_OK)
        return status;
    struct server_report *s = &c->course->report.servers[rank];
    (void)snprintf(s->name, sizeof s->name, "%s", c->talk.peers[rank].channel.name);
    s->cells = decomposition_cells(c->decomposition, rank);
    s->owned = a->ready.owned;
    s->mirrored = a->ready.mirrored;
    s->bytes = a->ready.bytes;
    s->times = a->done.times;
    return DM2_OK;
}

enum dm2_status client_finish(struct client *c, struct dm2_error *err)
{
    const struct config *config = c->job->config;
    struct measures sum;
    double start = clock_now();
    bool snapshot = schedule_snapshot(config, config->steps);
    collection_expect(&c->collection, STATE_FINAL, true, config->steps);
    collection_expect(&c->collection, STATE_SNAPSHOT, snapshot, config->steps);
    collection_expect_profiles(&c->collection, config->steps);
    c->cracks.n = 0;
    for (int k = 0; k < c->ranks; k++)
        c->talk.peers[k].awaited = true; /* DONE comes without a message to the servers */
    enum dm2_status status = conversation_gather(&c->talk, MESSAGE_DONE, LIMIT_STEP, take_done, false, err);
    measures_clear(&sum);
    for (int k = 0; k < c->ranks && status == DM2_OK; k++) {
        const struct measures *part = &c->answers[k].done.measures;
        if (!measures_match(part, config))
            return conversation_failed(&c->talk, k, DM2_PROTOCOL, not_its_probes, err);
        measures_merge(&sum, part);
    }
    if (status == DM2_OK && schedule_history(config, config->steps))
        status = write_row(c, config->steps, &sum, err);
    if (status == DM2_OK)
        status = results_cracks(c->job->results, config->steps, &c->cracks, err);
    if (status == DM2_OK)
        status = collection_write_profiles(&c->collection, err);
    if (status == DM2_OK && snapshot)
        status = collection_place_walls(&c->collection, err);
    if (status == DM2_OK && snapshot)
        status = collection_write(&c->collection, STATE_SNAPSHOT, err);
    if (status == DM2_OK)
        status = collection_write(&c->collection, STATE_FINAL, err);
    c->course->report.output += clock_now() - start;
    return status;
}
