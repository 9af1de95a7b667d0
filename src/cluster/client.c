/* A run is a sequence of sessions; the last session reaches the end of the run.
 *
 * The stages of a session follow the paper's Fig. 7 and docs/protocol.md. Any failure closes all connections,
 * which ends the session on every server. After the loss of a server, struct course gives the servers and the
 * starting state of the next session. */
#include "dm2/cluster/client.h"

#include <stdlib.h>

#include "dm2/base/clock.h"
#include "dm2/base/mem.h"
#include "dm2/engine/subdomain.h"
#include "client_parts.h"

/* --- one session --- */

/* Takes CHALLENGE, STATE and PROFILE frames, which come before the answer that is due. */
static bool take_aside(void *context, int rank, enum message_type due, const struct frame *f,
                       enum dm2_status *status, struct dm2_error *err)
{
    struct client *c = context;
    if (f->type != MESSAGE_CHALLENGE)
        return collection_take(&c->collection, rank, f, status, err);
    if (due != MESSAGE_GRANT || c->answers[rank].challenged)
        return false;
    struct bytes_reader r = bytes_reader_of(f->payload, f->length);
    *status = client_answer_challenge(c, rank, &r, err);
    return true;
}

/* Prepares the connections, but opens none. */
static enum dm2_status open_conversation(struct client *c, struct dm2_error *err)
{
    const struct client_options *o = c->options;
    c->talk = (struct conversation){
        .ranks = c->ranks,
        .timeout = o->timeout,
        .cancel = o->cancel,
        .events = &o->events,
        .refusal =
            o->key == NULL
                ? "it refuses the connection: it wants a key (--key FILE), or does not admit this machine"
                : "it refuses the connection: it has another key, or does not admit this machine",
        .advice = o->recover ? "" : "; see that server's log, start it again and repeat the run",
        .context = c,
        .aside = take_aside,
        .from = c->job != NULL ? course_step(c->course, c->job) : 0,
        .again = c->course->stepping};
    c->collection.talk = &c->talk;
    enum dm2_status status = conversation_open(&c->talk, err);
    if (status != DM2_OK)
        return status;
    c->answers = mem_zalloc((size_t)c->ranks, sizeof *c->answers);
    return c->answers != NULL ? DM2_OK : dm2_fail(err, DM2_MEMORY, "no memory for %d servers", c->ranks);
}

/* Prepares a whole session. */
static enum dm2_status open_client(struct client *c, struct dm2_error *err)
{
    size_t n = (size_t)c->ranks;
    struct run_report *report = &c->course->report;
    enum dm2_status status = open_conversation(c, err);
    if (status != DM2_OK)
        return status;
    c->sources = mem_zalloc(n, sizeof *c->sources);
    report->servers = mem_zalloc(n, sizeof *report->servers);
    if (c->sources == NULL || report->servers == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d servers", c->ranks);
    rebuild_plan_start(&c->plan, c->job->config, model_margins(c->job->model));
    struct state_view start = {.step = 0};
    bool begun = course_state(c->course, c->job, &start);
    status = loading_open(c->job->model, start.step, &c->loading, err);
    if (status == DM2_OK && begun && c->loading != NULL)
        status = loading_restore(c->loading, &start.sections[SECTION_BODY], err);
    if (status == DM2_OK)
        status = collection_open(&c->collection, c->job, c->course, &c->talk, err);
    c->collection.loading = c->loading;
    return status != DM2_OK ? status : relay_open(&c->relay, c->ranks, err);
}

/* Closes every connection and frees the session. After a failure, the servers get its status and text. */
static void close_client(struct client *c, enum dm2_status status, const struct dm2_error *err)
{
    conversation_close(&c->talk, status, err);
    relay_free(&c->relay);
    collection_close(&c->collection);
    crack_list_free(&c->cracks);
    loading_free(c->loading);
    free(c->answers);
    free(c->sources);
}

/* How a session failed. */
struct loss {
    int culprit;   /* the rank that failed; -1: none */
    bool silent;   /* the culprit sent nothing for options->timeout seconds */
    bool stepping; /* the failure came after all servers were ready */
};

/* Runs one session, from the first connection to the last result. */
static enum dm2_status run_session(const struct client_job *job, const struct client_options *options,
                                   struct course *course, struct loss *loss, struct dm2_error *err)
{
    struct client c = {.job = job,
                       .options = options,
                       .course = course,
                       .decomposition = course->decomposition,
                       .ranks = course->decomposition->ranks};
    struct run_report *report = &course->report;
    double start = clock_now();
    enum dm2_status status = open_client(&c, err);
    if (status == DM2_OK)
        status = client_connect(&c, err);
    if (status == DM2_OK)
        status = client_greet(&c, err);
    if (status == DM2_OK && options->echo != NULL && !course->stepping)
        status = client_echo(&c, options->echo, err);
    if (status == DM2_OK)
        status = client_share_deck(&c, err);
    if (status == DM2_OK)
        status = client_assign(&c, err);
    report->set_up += clock_now() - start;
    c.talk.waited = 0; /* the report counts the waits of the steps only */
    if (status == DM2_OK)
        status = client_run_steps(&c, err);
    if (status == DM2_OK)
        status = client_finish(&c, err);
    report->wait += c.talk.waited;
    close_client(&c, status, err);
    report->ranks = c.ranks;
    if (status != DM2_OK) {
        free(report->servers);
        report->servers = NULL;
    }
    *loss = (struct loss){c.talk.culprit, c.talk.silent, c.talk.stopping != NULL};
    return status;
}

/* --- the run --- */

/* The failure of the run. A scheduler's signal often reaches the servers, too: a server that is lost after
 * the client was asked to end is no failure of its own. */
static enum dm2_status fail_course(const struct course *course, enum dm2_status status, const char *why,
                                   struct dm2_error *err)
{
    if (course->stopping && (status == DM2_NET || status == DM2_TIMEOUT))
        return dm2_fail(err, DM2_INTERRUPTED,
                        "the run was interrupted by a signal, then a server was lost: %s", why);
    return dm2_fail(err, status, "%s", why);
}

/* Runs sessions until a session reaches the end of the run, or until the run cannot recover from a failure.
 */
static enum dm2_status run_course(const struct client_job *job, const struct client_options *options,
                                  struct course *course, struct dm2_error *err)
{
    for (;;) {
        struct loss loss;
        struct dm2_error why = {0}, end = {0};
        enum dm2_status status = run_session(job, options, course, &loss, &why);
        if (status == DM2_OK || !course_goes_on(course, options, status, loss.culprit))
            return status == DM2_OK ? DM2_OK : fail_course(course, status, why.text, err);
        course_tell_user(options, why.text);
        status = course_replace(course, job, options, loss.culprit, loss.silent || !loss.stepping, &end);
        if (status != DM2_OK)
            return dm2_fail(err, status, "%.250s: %.340s", end.text, why.text);
        copy_plan_start(&course->plan, options->copy_every, course->copy_step >= 0 ? course->copy_step : 0);
    }
}

enum dm2_status client_run(const struct client_job *job, const struct client_options *options,
                           struct run_report *report, struct dm2_error *err)
{
    double start = clock_now();
    struct course course;
    *report = (struct run_report){0};
    enum dm2_status status = course_open(&course, job, options, job->decomposition->ranks, err);
    if (status != DM2_OK)
        return status;
    status = run_course(job, options, &course, err);
    if (status != DM2_OK)
        status = course_leave_checkpoint(&course, job, status, err);
    course_close(&course);
    if (status != DM2_OK)
        return status;
    course.report.program = "dm2-client";
    course.report.deck = options->deck_path;
    course.report.elements = model_elements(job->model);
    course.report.update_bytes = 8 * subdomain_update_width(job->model);
    course.report.total = clock_now() - start;
    *report = course.report;
    return DM2_OK;
}

enum dm2_status client_measure_network(const struct client_options *options, int ranks, struct dm2_error *err)
{
    struct course course;
    struct dm2_error why = {0};
    enum dm2_status status = course_open(&course, NULL, options, ranks, err);
    if (status != DM2_OK)
        return status;
    struct client c = {.options = options, .course = &course, .ranks = ranks};
    status = open_conversation(&c, &why);
    if (status == DM2_OK)
        status = client_connect(&c, &why);
    if (status == DM2_OK)
        status = client_greet(&c, &why);
    if (status == DM2_OK)
        status = client_echo(&c, options->echo, &why);
    bytes_clear(&c.talk.out);
    for (int k = 0; k < ranks && status == DM2_OK; k++) /* an empty ECHO ends the session */
        status = conversation_send(&c.talk, k, MESSAGE_ECHO, &why);
    close_client(&c, status, &why);
    course_close(&course);
    return status == DM2_OK ? DM2_OK : dm2_fail(err, status, "%s", why.text);
}
