/* A step that is computed again writes nothing twice: the results know which steps they have, and hashes are
 * told only for steps newer than course->hashed. */
#include "course.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/cluster/wire.h"
#include "dm2/deck/schedule.h"

enum { LOSSES_MOST = 3 }; /* survived without a new copy in between: losses of one server, renewals of all */

enum dm2_status course_open(struct course *course, const struct client_job *job,
                            const struct client_options *options, int ranks, struct dm2_error *err)
{
    *course = (struct course){.stations = mem_zalloc((size_t)ranks, sizeof *course->stations),
                              .copy_step = -1,
                              .checkpoint_every = options->checkpoint_every,
                              .hashed = -1};
    if (course->stations == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d servers", ranks);
    for (int k = 0; k < ranks; k++)
        course->stations[k].at = options->servers[k];
    if (job == NULL)
        return DM2_OK;
    course->decomposition = job->decomposition;
    state_merge_open(&course->copy, record_limits_of(job->model));
    copy_plan_start(&course->plan, options->recover ? options->copy_every : 0,
                    job->start != NULL ? job->start->step : 0);
    return DM2_OK;
}

void course_close(struct course *course)
{
    decomposition_free(&course->cut);
    state_merge_free(&course->copy);
    free(course->stations);
}

/* --- copies --- */

/* The state to start from: the last copy, else the job's. False: the beginning. */
bool course_state(const struct course *course, const struct client_job *job, struct state_view *out)
{
    const struct state *s = job->start;
    if (course->copy_step >= 0)
        *out = state_merge_view(&course->copy, course->copy_step);
    else if (s != NULL)
        *out = state_view_of(s);
    return course->copy_step >= 0 || s != NULL;
}

int64_t course_step(const struct course *course, const struct client_job *job)
{
    struct state_view s = {0};
    return course_state(course, job, &s) ? s.step : 0;
}

bool course_wants_copy(struct course *course, const struct client_job *job, int64_t step)
{
    const struct config *config = job->config;
    bool wanted = step < config->steps && (course->stopping || copy_plan_due(&course->plan, step) ||
                                           schedule_checkpoint(config, course->checkpoint_every, step));
    if (wanted)
        copy_plan_asked(&course->plan, step);
    return wanted;
}

void course_tell_hash(struct course *course, const struct client_options *options, int64_t step,
                      uint64_t hash)
{
    if (step > course->hashed && options->events.hash != NULL)
        options->events.hash(options->events.context, step, hash);
    if (step > course->hashed)
        course->hashed = step;
}

/* Whether the copy of the state at `step` is to be written as a checkpoint. */
static bool checkpoint_due(const struct course *course, const struct client_job *job, int64_t step)
{
    return course->stopping || schedule_checkpoint(job->config, course->checkpoint_every, step);
}

/* Writes course->copy as a checkpoint. */
static enum dm2_status write_checkpoint(const struct course *course, const struct client_job *job,
                                        struct dm2_error *err)
{
    const struct state_view copy = state_merge_view(&course->copy, course->copy_step);
    return results_checkpoint(job->results, &copy, err);
}

enum dm2_status course_keep_copy(struct course *course, const struct client_job *job,
                                 struct state_merge *state, int64_t step, struct dm2_error *err)
{
    struct state_merge old = course->copy;
    course->copy = *state;
    *state = old;
    course->copy_step = step;
    course->renewals = 0;
    for (int k = 0; k < course->decomposition->ranks; k++)
        course->stations[k].losses = 0;
    return checkpoint_due(course, job, step) ? write_checkpoint(course, job, err) : DM2_OK;
}

void course_note_copy(struct course *course, const struct client_job *job, int64_t step, bool copy,
                      bool snapshot, double seconds)
{
    struct copy_plan *plan = &course->plan;
    if (!copy) {
        copy_plan_plain(plan, snapshot, seconds);
    } else if (!checkpoint_due(course, job, step)) {
        course->report.copies++;
        course->report.copying += copy_plan_done(plan, snapshot, seconds);
    }
}

/* --- after a loss --- */

void course_tell_user(const struct client_options *options, const char *line)
{
    if (options->events.note != NULL)
        options->events.note(options->events.context, line);
}

bool course_goes_on(const struct course *course, const struct client_options *options, enum dm2_status status,
                    int culprit)
{
    return options->recover && course->stepping && !course->stopping && culprit >= 0 &&
           (status == DM2_NET || status == DM2_TIMEOUT || status == DM2_PROTOCOL);
}

/* Adds to weights[cells] the elements per cell: of the last copy, else of the job's state, else of the
 * generated elements. */
static enum dm2_status count_elements(const struct client_job *job, const struct course *course,
                                      uint32_t *weights, struct dm2_error *err)
{
    struct state_view state;
    if (!course_state(course, job, &state))
        return model_cell_counts(job->model, weights, err);
    model_count_elements(job->model, state.elements, state.n_elements, weights);
    return DM2_OK;
}

/* Removes a server and cuts the domain for the remaining servers. */
static enum dm2_status drop_server(const struct client_job *job, struct course *course, int lost,
                                   struct dm2_error *err)
{
    const struct grid *g = model_grid(job->model);
    int ranks = course->decomposition->ranks - 1;
    uint32_t *weights = NULL;
    struct decomposition cut = {0};
    enum dm2_status status = DM2_OK;
    if (job->by_particles) {
        weights = mem_zalloc((size_t)g->cx * (size_t)g->cy, sizeof *weights);
        status = weights == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for %d x %d cells", g->cx, g->cy)
                                 : count_elements(job, course, weights, err);
    }
    if (status == DM2_OK)
        status = decomposition_bisect(g, ranks, weights, &cut, err);
    free(weights);
    if (status != DM2_OK)
        return status;
    memmove(&course->stations[lost], &course->stations[lost + 1],
            (size_t)(ranks - lost) * sizeof *course->stations);
    decomposition_free(&course->cut);
    course->cut = cut;
    course->decomposition = &course->cut;
    return DM2_OK;
}

/* Starts all servers anew through options->renew. */
static enum dm2_status renew_servers(const struct client_options *options, struct course *course,
                                     struct dm2_error *err)
{
    int ranks = course->decomposition->ranks;
    if (++course->renewals > LOSSES_MOST)
        return dm2_fail(err, DM2_NET, "servers were lost %d times without a new copy of the state between",
                        course->renewals);
    struct endpoint *servers = mem_zalloc((size_t)ranks, sizeof *servers);
    enum dm2_status status = servers == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for %d servers", ranks)
                                             : options->renew(options->renew_context, ranks, servers, err);
    for (int k = 0; k < ranks && status == DM2_OK; k++)
        course->stations[k].at = servers[k];
    free(servers);
    return status;
}

enum dm2_status course_replace(struct course *course, const struct client_job *job,
                               const struct client_options *options, int lost, bool absent,
                               struct dm2_error *err)
{
    struct station *s = &course->stations[lost];
    char line[2 * HOST_MAX + 200], from[32] = "the beginning";
    if (course->copy_step >= 0)
        (void)snprintf(from, sizeof from, "step %lld", (long long)course->copy_step);
    else if (job->start != NULL)
        (void)snprintf(from, sizeof from, "step %lld", (long long)job->start->step);
    course->report.losses++;
    if (options->renew != NULL) {
        (void)snprintf(line, sizeof line, "going on from %s with servers started anew", from);
        course_tell_user(options, line);
        return renew_servers(options, course, err);
    }
    if (!absent && ++s->losses <= LOSSES_MOST) {
        (void)snprintf(line, sizeof line, "going on from %s, waiting up to %g s for %s:%d", from,
                       options->reconnect, s->at.host, s->at.port);
        course_tell_user(options, line);
        return DM2_OK;
    }
    if (course->spares_used < options->n_spares) {
        const struct endpoint *spare = &options->spares[course->spares_used++];
        (void)snprintf(line, sizeof line, "going on from %s with the spare %s:%d in place of %s:%d", from,
                       spare->host, spare->port, s->at.host, s->at.port);
        *s = (struct station){.at = *spare};
        course_tell_user(options, line);
        return DM2_OK;
    }
    if (course->decomposition->ranks == 1)
        return dm2_fail(err, DM2_NET, "no server is left");
    (void)snprintf(line, sizeof line, "going on from %s without %s:%d, with %d of the servers", from,
                   s->at.host, s->at.port, course->decomposition->ranks - 1);
    course_tell_user(options, line);
    return drop_server(job, course, lost, err);
}

enum dm2_status course_leave_checkpoint(const struct course *course, const struct client_job *job,
                                        enum dm2_status status, struct dm2_error *err)
{
    struct dm2_error why = {0};
    if (status == DM2_IO || course->copy_step <= results_checkpoint_step(job->results))
        return status;
    enum dm2_status written = write_checkpoint(course, job, &why);
    if (written == DM2_OK || status != DM2_INTERRUPTED)
        return status;
    return dm2_fail(err, written, "%s", why.text); /* an interrupted run tells that its state is saved */
}
