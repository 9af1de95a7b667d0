/* dm2-seq: the sequential algorithm (paper, Fig. 5). The engine runs on one subdomain that owns every
 * cell, without sockets. Its time per step is T_seq of the performance model. */
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>

#include "dm2/base/clock.h"
#include "dm2/base/mem.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/report.h"
#include "dm2/deck/schedule.h"
#include "dm2/engine/rebuild.h"
#include "dm2/engine/self_test.h"
#include "dm2/engine/subdomain.h"
#include "dm2/output/state_hash.h"
#include "options.h"
#include "progress.h"
#include "run.h"
#include "session.h"
#include "signals.h"
#include "process.h"

static const char PROGRAM[] = "dm2-seq";

/* A run in progress. */
struct sequence {
    double cpu; /* processor seconds of all steps */
    const struct run_options *options;
    struct run *run;
    struct results *results;
    struct subdomain *sd;
    struct rebuild_plan plan;
    struct parcel parcel;
    int64_t every;            /* steps between checkpoints; 0: none */
    struct profile_bin *bins; /* room for a profile */
    struct run_report report;
    struct server_report server;
};

enum purpose { SNAPSHOT, CHECKPOINT, FINAL };

static enum dm2_status write_final(void *context, const struct state_view *state, struct dm2_error *err)
{
    return results_final(context, state, err);
}

static enum dm2_status write_checkpoint(void *context, const struct state_view *state, struct dm2_error *err)
{
    return results_checkpoint(context, state, err);
}

/* Collects the present state with its measures and passes it to the results. */
static enum dm2_status write_snapshot(struct sequence *s, struct dm2_error *err)
{
    size_t n = subdomain_owned(s->sd), n_pairs = 0;
    struct pair_record *pairs = NULL;
    struct pair_measure *forces = NULL;
    struct snapshot_walls walls = {.forces = {.n = 0}};
    struct element *elements = mem_alloc(n, sizeof *elements);
    struct element_measure *measured = mem_alloc(n, sizeof *measured);
    enum dm2_status status = DM2_OK;
    if (elements == NULL || measured == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory to collect the state of %zu elements", n);
    if (status == DM2_OK)
        status = subdomain_collect(s->sd, elements, measured, err);
    if (status == DM2_OK)
        status = subdomain_collect_acting(s->sd, &pairs, &forces, &n_pairs, err);
    if (status == DM2_OK)
        status = subdomain_collect_wall_forces(s->sd, &walls.forces, err);
    if (status == DM2_OK)
        status = wall_outlines_find(s->run->model, subdomain_loading(s->sd), subdomain_step(s->sd),
                                    &walls.outlines, err);
    if (status == DM2_OK)
        status = results_snapshot(s->results, subdomain_step(s->sd), elements, measured, n, pairs, forces,
                                  n_pairs, &walls, err);
    free(walls.forces.records);
    wall_outlines_free(&walls.outlines);
    free(pairs);
    free(forces);
    free(measured);
    free(elements);
    return status;
}

static enum dm2_status write_state(struct sequence *s, enum purpose purpose, struct dm2_error *err)
{
    double started = clock_now();
    enum dm2_status status =
        purpose == SNAPSHOT
            ? write_snapshot(s, err)
            : subdomain_write(s->sd, purpose == FINAL ? write_final : write_checkpoint, s->results, err);
    s->report.output += clock_now() - started;
    return status;
}

/* Writes the profiles that are due at the present state. */
static enum dm2_status write_profiles(struct sequence *s, struct dm2_error *err)
{
    const struct config *c = &s->run->config;
    int64_t step = subdomain_step(s->sd);
    double started = clock_now();
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < c->n_profiles && status == DM2_OK; k++) {
        size_t bytes = (size_t)c->profiles[k].bins * sizeof *s->bins;
        if (!schedule_profile(c, k, step))
            continue;
        free(s->bins);
        s->bins = mem_zalloc(1, bytes);
        if (s->bins == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for a profile of %lld bins",
                            (long long)c->profiles[k].bins);
        status = subdomain_profile(s->sd, k, s->bins, err);
        if (status == DM2_OK)
            status = results_profile(s->results, k, step, s->bins, err);
    }
    s->report.output += clock_now() - started;
    return status;
}

static enum dm2_status print_hash(const struct sequence *s, struct dm2_error *err)
{
    uint64_t hash;
    if (!run_hash_due(s->options, s->run, subdomain_step(s->sd)))
        return DM2_OK;
    enum dm2_status status = state_hash_subdomain(s->sd, &hash, err);
    if (status == DM2_OK)
        run_print_hash(subdomain_step(s->sd), hash);
    return status;
}

/* Sorts all elements into new cells and renews the lists. */
static enum dm2_status rebuild_lists(struct sequence *s, struct dm2_error *err)
{
    enum dm2_status status = subdomain_sort_out(s->sd, &s->parcel, err);
    if (status == DM2_OK)
        status = subdomain_take_in(s->sd, &s->parcel, 1, err);
    rebuild_plan_done(&s->plan);
    s->report.rebuilds++;
    return status;
}

/* Writes a row of the history, and the warning that follows from the row. Where the row ends the run by a
 * block `stop`, the config gets the last step. */
static enum dm2_status write_row(struct sequence *s, int64_t n, const struct measures *m,
                                 struct dm2_error *err)
{
    char line[RESULTS_LINE];
    enum dm2_status status = results_history(s->results, n, m, err);
    if (status == DM2_OK && results_warns(s->results, line) && !s->options->quiet)
        (void)fprintf(stderr, "%s: %s\n", PROGRAM, line);
    int64_t end;
    if (status == DM2_OK && results_stopped(s->results, &end) && end < s->run->config.steps)
        s->run->config.steps = end;
    return status;
}

/* Closes the step of the bodies under force, and tells of a body that meets nothing. */
static void take_totals(struct sequence *s)
{
    char line[LOADING_LINE];
    struct loading *loading = subdomain_loading(s->sd);
    if (loading == NULL)
        return;
    subdomain_take_totals(s->sd, subdomain_load_totals(s->sd));
    while (loading_warns(loading, line))
        if (!s->options->quiet)
            (void)fprintf(stderr, "%s: %s\n", PROGRAM, line);
}

/* One time step (paper, Fig. 5): forces, the states and measures that are due, leapfrog, lists. */
static enum dm2_status take_step(struct sequence *s, struct dm2_error *err)
{
    const struct config *c = &s->run->config;
    int64_t n = subdomain_step(s->sd);
    bool history = schedule_history(c, n), snapshot = schedule_snapshot(c, n);
    struct measures measures;
    struct spread spread;
    bool survey = rebuild_plan_survey(&s->plan);
    double dmax, started = clock_now(), output = s->report.output;
    enum dm2_status status = subdomain_forces(s->sd, schedule_measure(c, n), err);
    if (status == DM2_OK && snapshot)
        status = write_state(s, SNAPSHOT, err);
    if (status == DM2_OK)
        status = write_profiles(s, err);
    if (status == DM2_OK)
        status =
            subdomain_move(s->sd, &dmax, n == c->n_start || schedule_history(c, n) ? &measures : NULL, err);
    if (status == DM2_OK)
        take_totals(s);
    if (status == DM2_OK && n == c->n_start)
        status = model_check_start(s->run->model, &measures, err);
    if (status == DM2_OK && survey)
        subdomain_survey(s->sd, &spread);
    if (status == DM2_OK && rebuild_plan_step(&s->plan, dmax, survey ? &spread : NULL))
        status = rebuild_lists(s, err);
    if (!snapshot) { /* a step with a snapshot takes longer and is not timed */
        s->report.stepping += clock_now() - started - (s->report.output - output);
        s->report.timed++;
    }
    started = clock_now();
    if (status == DM2_OK && history)
        status = write_row(s, n, &measures, err);
    if (status == DM2_OK)
        status = results_cracks(s->results, n, subdomain_cracks(s->sd), err);
    s->report.output += clock_now() - started;
    s->report.steps = n + 1;
    return status;
}

/* Writes the last state, then evaluates its forces once more for the last measures. */
static enum dm2_status finish_run(struct sequence *s, struct dm2_error *err)
{
    const struct config *c = &s->run->config;
    struct measures measures;
    enum dm2_status status = write_state(s, FINAL, err);
    if (status == DM2_OK)
        status = subdomain_forces(s->sd, true, err);
    if (status == DM2_OK && schedule_snapshot(c, c->steps))
        status = write_state(s, SNAPSHOT, err);
    if (status == DM2_OK)
        status = write_profiles(s, err);
    if (status == DM2_OK)
        status = subdomain_measure_last(s->sd, &measures, err);
    if (status == DM2_OK && schedule_history(c, c->steps))
        status = write_row(s, c->steps, &measures, err);
    if (status == DM2_OK)
        status = results_cracks(s->results, c->steps, subdomain_cracks(s->sd), err);
    return status;
}

static enum dm2_status run_steps(struct sequence *s, int cancel, struct dm2_error *err)
{
    struct progress progress;
    struct pollfd signal = {.fd = cancel, .events = POLLIN};
    const struct config *c = &s->run->config;
    enum dm2_status status = print_hash(s, err);
    double cpu = clock_cpu();
    progress_start(&progress, s->options->progress, c->steps, model_elements(s->run->model));
    while (status == DM2_OK && subdomain_step(s->sd) < c->steps) {
        status = take_step(s, err);
        if (status == DM2_OK)
            status = print_hash(s, err);
        bool asked = cancel >= 0 && poll(&signal, 1, 0) > 0;
        int64_t n = subdomain_step(s->sd);
        if (status == DM2_OK && ((asked && n < c->steps) || schedule_checkpoint(c, s->every, n)))
            status = write_state(s, CHECKPOINT, err);
        if (status == DM2_OK && asked && n < c->steps)
            status = dm2_fail(err, DM2_INTERRUPTED, "the run was interrupted by a signal at step %lld",
                              (long long)n);
        if (status == DM2_OK)
            progress_step(&progress, subdomain_step(s->sd), NULL);
    }
    s->cpu = clock_cpu() - cpu;
    progress_end(&progress);
    return status == DM2_OK ? finish_run(s, err) : status;
}

static void fill_report(struct sequence *s, double started)
{
    struct subdomain_times t;
    subdomain_take_times(s->sd, &t);
    const struct grid *g = model_grid(s->run->model);
    s->server = (struct server_report){.name = "here",
                                       .cells = (size_t)g->cx * (size_t)g->cy,
                                       .owned = subdomain_owned(s->sd),
                                       .bytes = subdomain_bytes(s->sd)};
    s->server.times.forces = t.forces;
    s->server.times.integrate = t.integrate;
    s->server.times.rebuild = t.rebuild;
    s->server.times.cpu = s->cpu;
    s->server.times.output = s->report.output;
    s->server.times.rebuilds = t.rebuilds;
    s->server.times.steps = (uint64_t)s->report.steps;
    s->report.program = PROGRAM;
    s->report.deck = s->options->deck;
    s->report.elements = model_elements(s->run->model);
    s->report.update_bytes = 8 * subdomain_update_width(s->run->model);
    s->report.ranks = 1;
    s->report.servers = &s->server;
    s->report.total = clock_now() - started;
}

static void print_summary(const struct sequence *s, const char *directory)
{
    if (s->options->quiet)
        return;
    (void)printf("%lld steps of %zu elements in %.3f s: %.4g element-steps/s\n", (long long)s->report.steps,
                 s->report.elements, s->report.total, report_rate(&s->report));
    (void)printf("results in %s\n", directory);
}

static enum dm2_status run_all(struct sequence *s, struct run *run, const struct decomposition *d, int cancel,
                               struct dm2_error *err)
{
    const struct domain_map map = {.grid = &d->grid, .ranks = 1, .owner = d->owner};
    double started = clock_now();
    enum dm2_status status = run_open_results(s->options, run, &s->results, err);
    const struct state_view from = state_view_of(&s->run->state);
    if (status == DM2_OK && run_state(s->run) != NULL)
        status = subdomain_restore(s->run->model, &map, 0, &from, &s->sd, err);
    else if (status == DM2_OK)
        status = subdomain_create(s->run->model, &map, 0, &s->sd, err);
    if (status == DM2_OK)
        status = overlap_check(subdomain_overlap(s->sd), &s->run->config, err);
    if (status == DM2_OK)
        run_print_overlap(s->options, s->run, subdomain_overlap(s->sd));
    s->every = run_checkpoint_every(s->options, s->run);
    s->report.set_up = clock_now() - started;
    rebuild_plan_start(&s->plan, &s->run->config, model_margins(s->run->model));
    if (status == DM2_OK)
        status = run_steps(s, cancel, err);
    if (status == DM2_OK) {
        fill_report(s, started);
        status = session_end(s->results, err);
        if (status == DM2_OK)
            status = report_write(&s->report, s->results, err);
    }
    if (status != DM2_OK) {
        session_fail(s->options, s->results, err);
        results_abort(s->results);
    } else {
        char directory[4096];
        struct results_verdict verdict;
        results_verdict(s->results, &verdict);
        (void)snprintf(directory, sizeof directory, "%s", results_directory(s->results));
        status = results_close(s->results, err);
        if (status == DM2_OK) {
            print_summary(s, directory);
            run_print_verdict(s->options, &verdict);
        }
    }
    subdomain_free(s->sd);
    free(s->bins);
    return status;
}

static enum dm2_status run_deck(const struct run_options *o, int cancel, struct dm2_error *err)
{
    struct run run = {0};
    struct decomposition d = {0};
    enum dm2_status status = run_load(o, &run, err);
    if (status == DM2_OK)
        status = run_check_cells(&run, err);
    if (status == DM2_OK)
        status = decomposition_bisect(model_grid(run.model), 1, NULL, &d, err);
    if (status == DM2_OK && o->check) {
        status = run_print_check(stdout, o, &run, &d, NULL, err);
    } else if (status == DM2_OK && !run.complete) {
        struct sequence s = {.options = o, .run = &run};
        status = run_all(&s, &run, &d, cancel, err);
    }
    decomposition_free(&d);
    run_free(&run);
    session_explain(o, status, err);
    return status;
}

int main(int argc, char **argv)
{
    struct run_options options;
    struct option table[RUN_OPTIONS];
    struct dm2_error err = {0};
    process_start();
    int cancel = signals_catch(); /* first, because an uncaught signal is no exit status 4 */
    run_options_start(&options, PROGRAM, argc, argv, table);
    enum dm2_status status = options_parse(table, RUN_OPTIONS, argc, argv, &options.operands, &err);
    if (status == DM2_OK && options.help) {
        (void)printf("usage: %s DECK [options]\nRuns a deck in this one process.\n\n", PROGRAM);
        options_print(stdout, table, RUN_OPTIONS);
    }
    if (status == DM2_OK)
        status = run_options_finish(&options, &err);
    if (status == DM2_OK && options.version)
        run_print_version(PROGRAM);
    bool computes = !options.help && !options.version;
    if (status == DM2_OK && computes)
        status = self_test_check(&err);
    if (status == DM2_OK && computes)
        status = run_deck(&options, cancel, &err);
    run_options_free(&options);
    return process_finish(PROGRAM, status == DM2_OK ? 0 : run_report_failure(PROGRAM, &err),
                          run_output_asked(&options));
}
