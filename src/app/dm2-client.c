/* dm2-client: runs a deck on servers; the paper's client process. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/version.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/client.h"
#include "dm2/cluster/hosts.h"
#include "dm2/cluster/report.h"
#include "dm2/engine/self_test.h"
#include "dm2/net/socket.h"
#include "local_servers.h"
#include "network.h"
#include "options.h"
#include "prediction.h"
#include "progress.h"
#include "run.h"
#include "server_status.h"
#include "session.h"
#include "signals.h"
#include "process.h"

static const char PROGRAM[] = "dm2-client";
static const double STATUS_SECONDS = 10; /* for a server to answer --status */

enum { LOCAL_MOST = 1024, PROBE_TURNS = 15 };

struct client_command {
    struct run_options run;
    int64_t local; /* -n; 0: not given */
    struct option_list servers;
    const char *hosts, *balance, *key_file, *calibration_file;
    struct auth_key key;
    bool send_deck, no_recover, status;
    double timeout, reconnect;
    int64_t copy_every; /* -1: by cost */
    const char *argv0;
    int cancel;
    char calibration_path[PREDICTION_TEXT]; /* empty: the run is predicted from itself */
    struct calibration calibration;
};

/* The context of a run's events. */
struct display {
    struct progress progress;
    bool quiet;
};

/* --status requires servers and no deck. */
static enum dm2_status check_status(const struct client_command *c, struct dm2_error *err)
{
    if (c->run.help || c->run.version)
        return DM2_OK;
    if (c->hosts == NULL && c->servers.n == 0)
        return dm2_fail(err, DM2_USAGE,
                        "--status of which servers? --hosts FILE or --server HOST[:PORT] name them");
    if (c->run.operands.n > 0)
        return dm2_fail(err, DM2_USAGE, "'%s' is too much: --status runs no deck", c->run.operands.items[0]);
    return DM2_OK;
}

static enum dm2_status parse_command_line(struct client_command *c, int argc, char **argv,
                                          struct dm2_error *err)
{
    enum { OWN = 12 };
    *c = (struct client_command){
        .timeout = 60, .reconnect = 5, .copy_every = -1, .argv0 = argv[0], .cancel = -1};
    struct option table[OWN + RUN_OPTIONS] = {
        {"local", 'n', OPTION_INTEGER, &c->local, "N", "starts N servers on this machine for this run", 1,
         LOCAL_MOST},
        {"hosts", 0, OPTION_TEXT, &c->hosts, "FILE",
         "uses the servers of a hosts file: host[:port] [slots=K] [spare]", 0, 0},
        {"server", 0, OPTION_LIST, &c->servers, "HOST[:PORT]", "uses this server; may be repeated", 0, 0},
        {"key", 0, OPTION_TEXT, &c->key_file, "FILE",
         "proves this key to the servers, and wants them to prove it", 0, 0},
        {"status", 0, OPTION_FLAG, &c->status, NULL,
         "prints what the servers of --hosts or --server do, and stops", 0, 0},
        {"balance", 0, OPTION_TEXT, &c->balance, "WHAT",
         "cuts by space or particles (default: as the deck says)", 0, 0},
        {"calibration", 0, OPTION_TEXT, &c->calibration_file, "FILE",
         "predicts with these constants (default $DM2_CALIBRATION, ./dm2-calibration.csv)", 0, 0},
        {"send-deck", 0, OPTION_FLAG, &c->send_deck, NULL, "sends the deck even where servers have a copy", 0,
         0},
        {"timeout", 0, OPTION_SECONDS, &c->timeout, "S",
         "gives a silent server up after S seconds (default 60)", 0, 0},
        {"no-recover", 0, OPTION_FLAG, &c->no_recover, NULL, "gives the run up when a server is lost", 0, 0},
        {"reconnect", 0, OPTION_SECONDS, &c->reconnect, "S",
         "waits S seconds for a lost server to come back (default 5)", 0, 0},
        {"copy-every", 0, OPTION_INTEGER, &c->copy_every, "K",
         "takes a copy of the state every K steps, to go back to (default: by its cost; 0: none)", 0,
         INT64_MAX},
    };
    run_options_start(&c->run, PROGRAM, argc, argv, table + OWN);
    enum dm2_status status = options_parse(table, OWN + RUN_OPTIONS, argc, argv, &c->run.operands, err);
    if (status == DM2_OK && c->run.help) {
        (void)printf("usage: %s DECK [-n N | --hosts FILE | --server HOST[:PORT]...] [options]\n"
                     "       %s --status (--hosts FILE | --server HOST[:PORT]...) [--key FILE]\n"
                     "Runs a deck on servers. Without any, one per core is started on this machine.\n\n",
                     PROGRAM, PROGRAM);
        options_print(stdout, table, OWN + RUN_OPTIONS);
    }
    if (status == DM2_OK && c->status)
        return check_status(c, err);
    if (status == DM2_OK)
        status = run_options_finish(&c->run, err);
    if (status == DM2_OK && c->local > 0 && (c->hosts != NULL || c->servers.n > 0))
        status =
            dm2_fail(err, DM2_USAGE, "-n starts servers itself: it does not go with --hosts or --server");
    if (status == DM2_OK && c->key_file != NULL && c->hosts == NULL && c->servers.n == 0)
        status = dm2_fail(err, DM2_USAGE,
                          "--key is for servers of --hosts or --server: those that this program starts "
                          "itself need none");
    if (status == DM2_OK && c->balance != NULL && strcmp(c->balance, "space") != 0 &&
        strcmp(c->balance, "particles") != 0)
        status = dm2_fail(err, DM2_USAGE, "--balance '%s': space or particles is expected", c->balance);
    return status;
}

/* Adds the servers that the command line names to *list; none where local servers are to be started. */
static enum dm2_status named_servers(const struct client_command *c, struct endpoints *list,
                                     struct dm2_error *err)
{
    enum dm2_status status = c->hosts != NULL ? hosts_read(c->hosts, list, err) : DM2_OK;
    for (size_t k = 0; k < c->servers.n && status == DM2_OK; k++)
        status = hosts_parse_server(c->servers.items[k], list, err);
    return status;
}

static bool is_by_particles(const struct client_command *c, const struct run *run)
{
    return c->balance != NULL ? strcmp(c->balance, "particles") == 0
                              : run->config.balance == BALANCE_PARTICLES;
}

static enum dm2_status decompose_domain(const struct client_command *c, const struct run *run, int ranks,
                                        struct decomposition *out, struct dm2_error *err)
{
    const struct grid *g = model_grid(run->model);
    uint32_t *counts = NULL;
    enum dm2_status status = DM2_OK;
    *out = (struct decomposition){0};
    if (is_by_particles(c, run)) {
        status = grid_check_memory(g, (double)g->cx * g->cy * (sizeof *counts + sizeof *out->owner), err);
        if (status != DM2_OK)
            return status;
        counts = mem_zalloc((size_t)g->cx * (size_t)g->cy, sizeof *counts);
        if (counts == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for %d x %d cells", g->cx, g->cy);
        if (run_state(run) != NULL)
            model_count_elements(run->model, run->state.elements, run->state.n_elements, counts);
        else
            status = model_cell_counts(run->model, counts, err);
    }
    if (status == DM2_OK)
        status = decomposition_bisect(g, ranks, counts, out, err);
    free(counts);
    return status;
}

static void show_step(void *context, int64_t step, const char *slowest, double busy)
{
    struct display *d = context;
    char text[SOCKET_NAME + 64];
    if (slowest != NULL)
        (void)snprintf(text, sizeof text, "%s (%.2f ms)", slowest, 1e3 * busy);
    progress_step(&d->progress, step, slowest != NULL ? text : NULL);
}

static void show_hash(void *context, int64_t step, uint64_t hash)
{
    (void)context;
    run_print_hash(step, hash);
}

static void show_note(void *context, const char *line)
{
    const struct display *d = context;
    if (!d->quiet)
        (void)fprintf(stderr, "%s: %s\n", PROGRAM, line);
}

static void print_summary(const struct client_command *c, const struct run_report *r, const char *directory)
{
    if (c->run.quiet)
        return;
    (void)printf("%lld steps of %zu elements on %d server%s in %.3f s: %.4g element-steps/s\n",
                 (long long)r->steps, r->elements, r->ranks, r->ranks == 1 ? "" : "s", r->total,
                 report_rate(r));
    if (r->prediction != NULL)
        (void)fputs(r->prediction, stdout);
    (void)printf("results in %s\n", directory);
}

/* Starts local servers for client_options.renew. A local server ends with its session, so after a loss all
 * are started anew. */
struct local_starter {
    const struct client_command *command;
    struct local_servers servers;
};

static enum dm2_status restart_servers(void *context, int ranks, struct endpoint *servers,
                                       struct dm2_error *err)
{
    struct local_starter *s = context;
    const struct client_command *c = s->command;
    struct endpoints list = {0};
    local_servers_stop(&s->servers);
    enum dm2_status status =
        local_servers_start(c->argv0, ranks, c->run.verbose, c->cancel, &s->servers, &list, err);
    for (int k = 0; k < ranks && status == DM2_OK; k++)
        servers[k] = list.items[k];
    endpoints_free(&list);
    return status;
}

/* Runs the deck on servers that are up. */
static enum dm2_status run_on_servers(const struct client_command *c, struct run *run,
                                      const struct decomposition *d, const struct endpoints *servers,
                                      struct local_starter *starter, struct results *results,
                                      struct network_probe *probe, struct run_report *report,
                                      struct dm2_error *err)
{
    struct display display = {.quiet = c->run.quiet};
    const struct client_options options = {
        .servers = servers->items,
        .spares = servers->items + d->ranks,
        .n_spares = servers->n - (size_t)d->ranks,
        .renew = starter->servers.n > 0 ? restart_servers : NULL,
        .renew_context = starter,
        .recover = !c->no_recover,
        .reconnect = c->reconnect,
        .copy_every = c->copy_every,
        .checkpoint_every = run_checkpoint_every(&c->run, run),
        .deck_path = c->run.deck,
        .version = DM2_VERSION,
        .timeout = c->timeout,
        .send_deck = c->send_deck || starter->servers.n > 0,
        .hash_every = c->run.hash_every,
        .cancel = c->cancel,
        .echo = c->calibration_path[0] == '\0' ? network_probe_echo(probe) : NULL,
        .key = c->key_file != NULL ? &c->key : NULL,
        .events = {.context = &display, .step = show_step, .hash = show_hash, .note = show_note}};
    const struct client_job job = {.source = &run->source,
                                   .config = &run->config,
                                   .model = run->model,
                                   .decomposition = d,
                                   .start = run_state(run),
                                   .by_particles = is_by_particles(c, run),
                                   .results = results};
    progress_start(&display.progress, c->run.progress, run->config.steps, model_elements(run->model));
    enum dm2_status status = client_run(&job, &options, report, err);
    progress_end(&display.progress);
    return status;
}

/* Predicts the run that has ended: report->prediction is `text`, or NULL where no step was timed. */
static enum dm2_status predict_run(const struct client_command *c, const struct network_probe *probe,
                                   bool local, struct run_report *report, char text[PREDICTION_TEXT],
                                   struct dm2_error *err)
{
    int cores = local ? local_servers_cores() : 0;
    struct prediction_basis basis;
    struct explanation e;
    struct network_line line;
    enum dm2_status status = DM2_OK;
    if (c->calibration_path[0] != '\0') {
        prediction_calibrated(&c->calibration, c->calibration_path, report, cores, &basis);
    } else {
        status = network_fit(probe, report->ranks, &line, err);
        if (status == DM2_OK)
            prediction_estimated(&line, report, cores, &basis);
    }
    if (status == DM2_OK && prediction_explain(report, &basis, &e)) {
        prediction_text(&e, &basis, report, text);
        report->prediction = text;
    }
    return status;
}

/* Opens the run directory, runs, and writes the remaining files. */
static enum dm2_status run_all(const struct client_command *c, struct run *run, const struct decomposition *d,
                               struct endpoints *servers, struct dm2_error *err)
{
    struct results *results = NULL;
    struct run_report report = {0};
    struct local_starter starter = {.command = c};
    struct network_probe probe = {0};
    char prediction[PREDICTION_TEXT];
    bool start = servers->n == 0;
    enum dm2_status status = run_open_results(&c->run, run, &results, err);
    if (status == DM2_OK)
        status = network_probe_start(&probe, true, PROBE_TURNS, err);
    if (status == DM2_OK && start)
        status = local_servers_start(c->argv0, d->ranks, c->run.verbose, c->cancel, &starter.servers, servers,
                                     err);
    if (status == DM2_OK)
        status = run_on_servers(c, run, d, servers, &starter, results, &probe, &report, err);
    local_servers_stop(&starter.servers);
    if (status == DM2_OK)
        status = predict_run(c, &probe, start, &report, prediction, err);
    if (status == DM2_OK)
        status = session_end(results, err);
    if (status == DM2_OK)
        status = report_write(&report, results, err);
    if (status != DM2_OK) {
        session_fail(&c->run, results, err);
        results_abort(results);
    } else {
        char directory[1024];
        struct results_verdict verdict;
        results_verdict(results, &verdict);
        (void)snprintf(directory, sizeof directory, "%s", results_directory(results));
        status = results_close(results, err);
        if (status == DM2_OK) {
            print_summary(c, &report, directory);
            run_print_verdict(&c->run, &verdict);
        }
    }
    network_probe_free(&probe);
    free(report.servers);
    return status;
}

static enum dm2_status print_check(const struct client_command *c, const struct run *run,
                                   const struct decomposition *d, const struct endpoints *servers,
                                   struct dm2_error *err)
{
    char(*names)[HOST_MAX + 8] = mem_zalloc((size_t)d->ranks, sizeof *names);
    const char **list = mem_zalloc((size_t)d->ranks, sizeof *list);
    enum dm2_status status = DM2_OK;
    if (names == NULL || list == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory for %d names", d->ranks);
    for (size_t k = 0; k < servers->n && k < (size_t)d->ranks && status == DM2_OK; k++) {
        (void)snprintf(names[k], sizeof names[k], "%s:%d", servers->items[k].host, servers->items[k].port);
        list[k] = names[k];
    }
    if (status == DM2_OK)
        status = run_print_check(stdout, &c->run, run, d, servers->n > 0 ? list : NULL, err);
    free(names);
    free(list);
    return status;
}

/* The number of servers of the run. */
static int choose_ranks(const struct client_command *c, const struct run *run,
                        const struct endpoints *servers, size_t active)
{
    if (servers->n > 0)
        return (int)active;
    if (c->local > 0)
        return (int)c->local;
    const struct grid *g = model_grid(run->model);
    int cells = g->cx * g->cy, cores = local_servers_cores(), n = cores < cells ? cores : cells;
    if (!c->run.quiet)
        (void)fprintf(
            stderr,
            "%s: no servers are named: using %d on this machine, one per core (-n N, --hosts or --server "
            "choose)\n",
            PROGRAM, n);
    return n;
}

static enum dm2_status find_calibration(struct client_command *c, struct dm2_error *err)
{
    char note[PREDICTION_TEXT];
    enum dm2_status status =
        prediction_calibration(c->calibration_file, &c->calibration, c->calibration_path, note, err);
    if (status == DM2_OK && note[0] != '\0' && !c->run.quiet)
        (void)fprintf(stderr, "%s: %s\n", PROGRAM, note);
    return status;
}

static enum dm2_status print_status(struct client_command *c, struct dm2_error *err)
{
    struct endpoints servers = {0};
    enum dm2_status status = named_servers(c, &servers, err);
    if (status == DM2_OK && c->key_file != NULL)
        status = auth_key_read(c->key_file, &c->key, err);
    if (status == DM2_OK)
        status =
            server_status_print(stdout, &servers, c->key_file != NULL ? &c->key : NULL,
                                c->timeout < STATUS_SECONDS ? c->timeout : STATUS_SECONDS, c->cancel, err);
    endpoints_free(&servers);
    return status;
}

static enum dm2_status run_deck(struct client_command *c, struct dm2_error *err)
{
    struct endpoints servers = {0};
    struct run run = {0};
    struct decomposition d = {0};
    enum dm2_status status = named_servers(c, &servers, err);
    size_t active = endpoints_sort(&servers);
    if (status == DM2_OK && servers.n > 0 && active == 0)
        status = dm2_fail(err, DM2_USAGE,
                          "%s: all servers are spares: one at least is needed without the word", c->hosts);
    if (status == DM2_OK && c->key_file != NULL)
        status = auth_key_read(c->key_file, &c->key, err);
    if (status == DM2_OK && !c->run.check)
        status = find_calibration(c, err);
    if (status == DM2_OK)
        status = run_load(&c->run, &run, err);
    bool runs = status == DM2_OK && (!run.complete || c->run.check);
    if (runs && servers.n == 0)
        status = run_check_cells(&run, err);
    if (runs && status == DM2_OK)
        status = decompose_domain(c, &run, choose_ranks(c, &run, &servers, active), &d, err);
    if (runs && status == DM2_OK)
        status = c->run.check ? print_check(c, &run, &d, &servers, err) : run_all(c, &run, &d, &servers, err);
    decomposition_free(&d);
    run_free(&run);
    endpoints_free(&servers);
    session_explain(&c->run, status, err);
    return status;
}

int main(int argc, char **argv)
{
    struct client_command c;
    struct dm2_error err = {0};
    process_start();
    int cancel = signals_catch(); /* first, because an uncaught signal is no exit status 4 */
    enum dm2_status status = parse_command_line(&c, argc, argv, &err);
    if (status == DM2_OK && c.run.version)
        run_print_version(PROGRAM);
    bool computes = !c.run.help && !c.run.version;
    if (status == DM2_OK && computes)
        status = self_test_check(&err);
    if (status == DM2_OK && computes) {
        c.cancel = cancel;
        status = c.status ? print_status(&c, &err) : run_deck(&c, &err);
    }
    option_list_free(&c.servers);
    run_options_free(&c.run);
    return process_finish(PROGRAM, status == DM2_OK ? 0 : run_report_failure(PROGRAM, &err),
                          c.status || run_output_asked(&c.run));
}
