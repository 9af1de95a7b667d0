/* A server's part of a state is whole after the message with state_message.last; a later STATE message of
 * that server for the same state is a failure. */
#include "collection.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/bytes.h"
#include "dm2/base/mem.h"
#include "dm2/cluster/wire.h"
#include "dm2/deck/schedule.h"
#include "dm2/output/results.h"

static struct compilation *find_state(struct collection *c, enum state_purpose purpose)
{
    return purpose == STATE_FINAL ? &c->final : purpose == STATE_COPY ? &c->copy : &c->snapshot;
}

/* --- opening, closing --- */

static enum dm2_status open_state(struct collection *c, enum state_purpose purpose, struct dm2_error *err)
{
    struct compilation *state = find_state(c, purpose);
    struct record_limits limits = record_limits_of(c->job->model);
    if (purpose == STATE_SNAPSHOT)
        limits.sections = section_in_snapshot(c->job->config);
    state_merge_open(&state->merge, limits);
    state->whole = mem_zalloc((size_t)c->talk->ranks, sizeof *state->whole);
    return state->whole != NULL ? DM2_OK
                                : dm2_fail(err, DM2_MEMORY, "no memory for %d servers", c->talk->ranks);
}

static void close_state(struct compilation *state)
{
    state_merge_free(&state->merge);
    free(state->whole);
}

static enum dm2_status open_profiles(struct collection *c, struct dm2_error *err)
{
    const struct config *config = c->job->config;
    c->profiles = mem_zalloc(config->n_profiles, sizeof *c->profiles);
    for (size_t k = 0; k < config->n_profiles && c->profiles != NULL; k++) {
        struct profile_part *p = &c->profiles[k];
        p->bins = mem_zalloc((size_t)config->profiles[k].bins, sizeof *p->bins);
        p->came = mem_zalloc((size_t)c->talk->ranks, sizeof *p->came);
        if (p->bins == NULL || p->came == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for the profile '%s'", config->profiles[k].name);
    }
    return c->profiles != NULL ? DM2_OK : dm2_fail(err, DM2_MEMORY, "no memory for profiles");
}

static void close_profiles(struct collection *c)
{
    for (size_t k = 0; c->profiles != NULL && k < c->job->config->n_profiles; k++) {
        free(c->profiles[k].bins);
        free(c->profiles[k].came);
    }
    free(c->profiles);
}

enum dm2_status collection_open(struct collection *c, const struct client_job *job, struct course *course,
                                struct conversation *talk, struct dm2_error *err)
{
    *c = (struct collection){.job = job, .course = course, .talk = talk};
    enum dm2_status status = open_state(c, STATE_SNAPSHOT, err);
    if (status == DM2_OK)
        status = open_state(c, STATE_FINAL, err);
    if (status == DM2_OK)
        status = open_state(c, STATE_COPY, err);
    return status == DM2_OK ? open_profiles(c, err) : status;
}

void collection_close(struct collection *c)
{
    close_state(&c->snapshot);
    close_state(&c->final);
    close_state(&c->copy);
    close_profiles(c);
    wall_outlines_free(&c->outlines);
}

/* --- what is due --- */

void collection_expect(struct collection *c, enum state_purpose purpose, bool due, int64_t step)
{
    struct compilation *state = find_state(c, purpose);
    state->due = due;
    state->step = step;
    for (int k = 0; k < c->talk->ranks; k++)
        state->whole[k] = false;
    if (due)
        state_merge_clear(&state->merge);
}

void collection_expect_profiles(struct collection *c, int64_t step)
{
    const struct config *config = c->job->config;
    c->profile_step = step;
    for (size_t k = 0; k < config->n_profiles; k++) {
        struct profile_part *p = &c->profiles[k];
        p->due = schedule_profile(config, k, step);
        memset(p->bins, 0, (size_t)config->profiles[k].bins * sizeof *p->bins);
        memset(p->came, 0, (size_t)c->talk->ranks * sizeof *p->came);
    }
}

/* --- taking --- */

static enum dm2_status take_state(struct collection *c, int rank, struct bytes_reader *r,
                                  struct dm2_error *err)
{
    struct state_message m;
    struct dm2_error why = {0};
    message_get_state(r, &m);
    if (r->failed)
        return conversation_not_decoded(c->talk, rank, "STATE", err);
    struct compilation *state = find_state(c, m.purpose);
    if (!state->due || m.step != state->step || state->whole[rank])
        return conversation_failed(c->talk, rank, DM2_PROTOCOL, "it sent a state that is not due", err);
    if (!m.last && state_message_empty(&m))
        return conversation_failed(c->talk, rank, DM2_PROTOCOL, "it sent an empty part of a state", err);
    enum dm2_status status = state_merge_add(&state->merge, &m, r, &why);
    state->whole[rank] = m.last;
    return status == DM2_OK ? DM2_OK : conversation_failed(c->talk, rank, status, why.text, err);
}

static enum dm2_status take_profile(struct collection *c, int rank, struct bytes_reader *r,
                                    struct dm2_error *err)
{
    const struct config *config =
        c->job != NULL ? c->job->config : NULL; /* NULL: only the network is measured */
    struct profile_message m;
    message_get_profile(r, &m);
    if (r->failed)
        return conversation_not_decoded(c->talk, rank, "PROFILE", err);
    if (config == NULL || m.which >= config->n_profiles || !c->profiles[m.which].due ||
        c->profiles[m.which].came[rank] || m.step != c->profile_step ||
        m.n_bins != (size_t)config->profiles[m.which].bins)
        return conversation_failed(c->talk, rank, DM2_PROTOCOL, "it sent a profile that is not due", err);
    struct profile_part *p = &c->profiles[m.which];
    for (size_t k = 0; k < m.n_bins; k++) {
        struct profile_bin bin;
        wire_get_bin(r, &bin);
        profile_merge(&p->bins[k], &bin, 1);
    }
    p->came[rank] = true;
    return DM2_OK;
}

bool collection_take(struct collection *c, int rank, const struct frame *frame, enum dm2_status *status,
                     struct dm2_error *err)
{
    struct bytes_reader r = bytes_reader_of(frame->payload, frame->length);
    if (frame->type == MESSAGE_STATE)
        *status = take_state(c, rank, &r, err);
    else if (frame->type == MESSAGE_PROFILE)
        *status = take_profile(c, rank, &r, err);
    else
        return false;
    return true;
}

/* --- writing --- */

enum dm2_status collection_write(struct collection *c, enum state_purpose purpose, struct dm2_error *err)
{
    struct compilation *state = find_state(c, purpose);
    struct state_merge *m = &state->merge;
    struct dm2_error why = {0};
    state->due = false;
    for (int k = 0; k < c->talk->ranks; k++)
        if (!state->whole[k])
            return conversation_failed(c->talk, k, DM2_PROTOCOL,
                                       "it did not finish sending its part of the state", err);
    m->sections[SECTION_BODY].n = 0;
    if (c->loading != NULL && purpose != STATE_SNAPSHOT &&
        !loading_collect(c->loading, &m->sections[SECTION_BODY]))
        return dm2_fail(err, DM2_MEMORY, "no memory for the bodies of a state");
    enum dm2_status status = state_merge_finish(m, &why);
    if (status != DM2_OK)
        return dm2_fail(err, status, "compiling the state of step %lld: %s", (long long)state->step,
                        why.text);
    if (purpose == STATE_COPY)
        return course_keep_copy(c->course, c->job, m, state->step, err);
    if (purpose == STATE_FINAL) {
        const struct state_view whole = state_merge_view(m, state->step);
        return results_final(c->job->results, &whole, err);
    }
    struct snapshot_walls walls = {.forces = m->sections[SECTION_WFOR]};
    walls.outlines = c->outlines;
    return results_snapshot(c->job->results, state->step, m->elements, m->measured, m->n_seen, m->pairs,
                            m->forces, m->n_pairs, &walls, err);
}

enum dm2_status collection_place_walls(struct collection *c, struct dm2_error *err)
{
    wall_outlines_free(&c->outlines);
    return wall_outlines_find(c->job->model, c->loading, c->snapshot.step, &c->outlines, err);
}

enum dm2_status collection_write_profiles(struct collection *c, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < c->job->config->n_profiles && status == DM2_OK; k++) {
        struct profile_part *p = &c->profiles[k];
        if (!p->due)
            continue;
        p->due = false;
        for (int rank = 0; rank < c->talk->ranks; rank++)
            if (!p->came[rank])
                return conversation_failed(c->talk, rank, DM2_PROTOCOL,
                                           "it did not send its part of a profile", err);
        status = results_profile(c->job->results, k, c->profile_step, p->bins, err);
    }
    return status;
}
