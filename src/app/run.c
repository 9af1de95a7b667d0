/* The part of dm2-seq and dm2-client that a user sees alike in both. */
#include "run.h"
#include "run_loads.h"
#include "run_start.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/base/version.h"
#include "dm2/deck/meaning.h"
#include "dm2/engine/subdomain.h"
#include "dm2/output/run_directory.h"
#include "places.h"
#include "process.h"
#include "restart.h"
#include "session.h"
#include "signals.h"

void run_options_start(struct run_options *o, const char *program, int argc, char **argv,
                       struct option table[RUN_OPTIONS])
{
    *o = (struct run_options){.program = program,
                              .argc = argc,
                              .argv = argv,
                              .steps = -1,
                              .checkpoint_every = -1,
                              .progress_text = "auto"};
    const struct option options[RUN_OPTIONS] = {
        {"output", 'o', OPTION_TEXT, &o->directory, "DIR", "run directory (default: the deck's name + .run)",
         0, 0},
        {"define", 'D', OPTION_LIST, &o->defines, "NAME=VALUE",
         "overrides a `let` of the deck; may be repeated", 0, 0},
        {"steps", 0, OPTION_INTEGER, &o->steps, "K", "number of time steps instead of the deck's", 0,
         INT64_MAX},
        {"overwrite", 0, OPTION_FLAG, &o->overwrite, NULL, "takes a run directory that is not empty", 0, 0},
        {"check", 0, OPTION_FLAG, &o->check, NULL, "checks the deck, prints what would be run, and stops", 0,
         0},
        {"hash-every", 0, OPTION_INTEGER, &o->hash_every, "K", "prints a hash of the state every K steps", 1,
         INT64_MAX},
        {"checkpoint-every", 0, OPTION_INTEGER, &o->checkpoint_every, "K",
         "writes a checkpoint every K steps instead of as the deck says; 0: never", 0, INT64_MAX},
        {"restart", 0, OPTION_TEXT, &o->restart, "FILE",
         "continues from a state, in its directory; auto: from what the run directory has, or begins", 0, 0},
        {"start", 0, OPTION_TEXT, &o->start, "FILE",
         "begins from this state, in place of that of the deck's block `start`", 0, 0},
        {"progress", 0, OPTION_TEXT, &o->progress_text, "WHEN",
         "live line: auto (on a terminal), always or never", 0, 0},
        {"quiet", 'q', OPTION_FLAG, &o->quiet, NULL, "prints nothing but errors", 0, 0},
        {"verbose", 'v', OPTION_FLAG, &o->verbose, NULL, "prints more", 0, 0},
        {"help", 'h', OPTION_FLAG, &o->help, NULL, "prints this and stops", 0, 0},
        {"version", 0, OPTION_FLAG, &o->version, NULL, "prints the version and stops", 0, 0},
    };
    memcpy(table, options, sizeof options);
}

enum dm2_status run_options_finish(struct run_options *o, struct dm2_error *err)
{
    static const char *const modes[] = {"auto", "always", "never"};
    if (o->help || o->version)
        return DM2_OK;
    size_t mode = 0;
    while (mode < 3 && strcmp(o->progress_text, modes[mode]) != 0)
        mode++;
    if (mode == 3)
        return dm2_fail(err, DM2_USAGE, "--progress '%s': auto, always or never is expected",
                        o->progress_text);
    o->progress = o->quiet ? PROGRESS_NEVER : (enum progress_mode)mode;
    if (o->operands.n == 0)
        return dm2_fail(err, DM2_USAGE, "no deck is named");
    if (o->operands.n > 1)
        return dm2_fail(err, DM2_USAGE, "one deck is expected, and then '%s' is too much",
                        o->operands.items[1]);
    if (process_output_closed() && o->hash_every > 0)
        return dm2_fail(
            err, DM2_USAGE,
            "--hash-every prints on standard output, which is closed: open it, or leave the option out");
    o->deck = o->operands.items[0];
    o->automatic = o->restart != NULL && strcmp(o->restart, "auto") == 0;
    if (o->automatic && o->overwrite)
        return dm2_fail(
            err, DM2_USAGE,
            "--restart auto goes on with what the run directory has, --overwrite removes it: give "
            "one of the two");
    return DM2_OK;
}

void run_options_free(struct run_options *o)
{
    option_list_free(&o->operands);
    option_list_free(&o->defines);
}

static char *copy_text(const char *text)
{
    size_t n = strlen(text) + 1;
    char *copy = mem_alloc(n, 1);
    if (copy != NULL)
        memcpy(copy, text, n);
    return copy;
}

/* Adds -D and --steps to the source of the deck. */
static enum dm2_status add_changes(const struct run_options *o, struct deck_source *source,
                                   struct dm2_error *err)
{
    source->steps = o->steps;
    if (o->defines.n == 0)
        return DM2_OK;
    source->defines = mem_zalloc(o->defines.n, sizeof *source->defines);
    for (size_t k = 0; k < o->defines.n && source->defines != NULL; k++) {
        source->defines[k] = copy_text(o->defines.items[k]);
        if (source->defines[k] == NULL)
            break;
        source->n_defines++;
    }
    if (source->n_defines < o->defines.n)
        return dm2_fail(err, DM2_MEMORY, "no memory for the command line's definitions");
    return DM2_OK;
}

static bool is_signalled(void *context)
{
    (void)context;
    return signals_caught() != 0;
}

/* Builds the model; a signal ends the set-up. The error of a deck whose elements cannot be made is printed
 * like the deck's other findings. */
static enum dm2_status build_model(const struct run_options *o, struct run *run, struct dm2_error *err)
{
    const struct pulse pulse = {.stopped = is_signalled};
    enum dm2_status status = model_build_watched(&run->config, pulse, &run->model, err);
    if (status != DM2_DECK)
        return status;
    (void)fprintf(stderr, "%s\n", err->text);
    return dm2_fail(err, status, "%s: 1 error", o->deck);
}

enum dm2_status run_load(const struct run_options *o, struct run *run, struct dm2_error *err)
{
    struct deck_report report = {0};
    *run = (struct run){0};
    struct deck_roots roots;
    enum dm2_status status = places_roots(o->argv[0], &roots, err);
    if (status == DM2_OK)
        status = deck_source_read(o->deck, &roots, &run->source, err);
    places_free_roots(&roots);
    if (status == DM2_IO)
        err->status = status = DM2_DECK; /* an unreadable deck is a wrong deck */
    if (status != DM2_OK)
        return status;
    status = add_changes(o, &run->source, err);
    if (status == DM2_OK)
        status = run_start_read(o, run, err);
    if (status == DM2_OK) {
        status = deck_load(&run->source, &run->config, &report);
        run->loaded = status == DM2_OK;
        if (report.text != NULL && (status != DM2_OK || !o->quiet))
            (void)fputs(report.text, stderr);
        if (status != DM2_OK)
            status = dm2_fail(err, status, "%s: %d error%s", o->deck, report.n_errors,
                              report.n_errors == 1 ? "" : "s");
        deck_report_free(&report);
    }
    if (status == DM2_OK)
        status = build_model(o, run, err);
    if (status == DM2_OK && !o->quiet)
        run_loads_warn(o->program, run->model);
    if (status == DM2_OK)
        status = state_origin_build(run->model, &run->origin, err);
    if (status == DM2_OK && o->automatic)
        status = restart_choose(o, run, err);
    else if (status == DM2_OK && o->restart != NULL)
        status = restart_read(o, run, err);
    if (status == DM2_OK && run->from_path != NULL && !run->restarted && !run->complete)
        status = run_start_take(run, err);
    state_free(&run->from);
    if (status != DM2_OK)
        run_free(run);
    return status;
}

void run_free(struct run *run)
{
    model_free(run->model);
    if (run->loaded)
        config_free(&run->config);
    deck_source_free(&run->source);
    state_free(&run->state);
    state_origin_free(&run->origin);
    free(run->state_path);
    state_free(&run->from);
    free(run->from_path);
    results_abort(run->results);
    *run = (struct run){0};
}

enum dm2_status run_check_cells(const struct run *run, struct dm2_error *err)
{
    const struct grid *g = model_grid(run->model);
    return grid_check_memory(g, (double)g->cx * g->cy * (SUBDOMAIN_CELL_BYTES + sizeof(uint16_t)), err);
}

char *run_directory_name(const struct run_options *o)
{
    if (o->directory != NULL)
        return copy_text(o->directory);
    return o->restart != NULL && !o->automatic ? run_directory_of(o->restart)
                                               : run_directory_default(o->deck);
}

/* Claims the run directory, unless --restart auto has done so. */
static enum dm2_status claim_directory(const struct run_options *o, struct run *run, struct results **out,
                                       struct dm2_error *err)
{
    *out = run->results;
    run->results = NULL;
    if (*out != NULL)
        return DM2_OK;
    char *directory = run_directory_name(o), *command = session_command(o);
    enum dm2_status status = directory == NULL || command == NULL
                                 ? dm2_fail(err, DM2_MEMORY, "no memory for the run directory's name")
                                 : results_claim(directory, command, out, err);
    free(directory);
    free(command);
    return status;
}

enum dm2_status run_open_results(const struct run_options *o, struct run *run, struct results **out,
                                 struct dm2_error *err)
{
    struct measure_scales scales = model_scales(run->model);
    bool overwrite = o->overwrite || run->anew;
    enum dm2_status status = claim_directory(o, run, out, err);
    if (status != DM2_OK)
        return status;
    if (results_warning(*out)[0] != '\0')
        (void)fprintf(stderr, "%s: warning: %s: %s\n", o->program, results_directory(*out),
                      results_warning(*out));
    if (run->restarted)
        status = results_go_on(*out, overwrite, run->state_path, &run->state, &run->config, scales,
                               &run->origin, err);
    else
        status = results_begin(*out, overwrite, &run->config, scales, &run->origin, err);
    int64_t end;
    if (status == DM2_OK && results_stopped(*out, &end) && end < run->config.steps)
        run->config.steps = end;
    if (status == DM2_OK)
        status = session_begin(o, run, *out, err);
    if (status != DM2_OK) {
        results_abort(*out);
        *out = NULL;
    }
    return status;
}

const struct state *run_state(const struct run *run)
{
    return run->restarted || run->staged ? &run->state : NULL;
}

int64_t run_checkpoint_every(const struct run_options *o, const struct run *run)
{
    return o->checkpoint_every >= 0 ? o->checkpoint_every : run->config.output.checkpoint_every;
}

void run_print_overlap(const struct run_options *o, const struct run *run, const struct overlap *overlap)
{
    char line[OVERLAP_LINE];
    if (!o->quiet && overlap_describe(overlap, &run->config, line))
        (void)fprintf(stderr, "%s: %s\n", o->program, line);
}

/* What --check finds out about one rank. */
struct rank_size {
    size_t owned, mirrored, bytes;
};

/* The start of a run as --check finds it. */
struct run_start {
    struct measures measures;
    struct overlap overlap;
    enum dm2_status status; /* of the forces; the elements of all ranks come first in overlap_check */
};

/* Generates one rank's subdomain and returns its size. Adds its pressed pairs to *start, evaluates its forces
 * once while they make sense, and adds the measures of step 0. */
static enum dm2_status measure_rank(const struct run *run, const struct decomposition *d, int rank,
                                    struct rank_size *out, struct run_start *start, struct dm2_error *err)
{
    const struct domain_map map = {.grid = &d->grid, .ranks = d->ranks, .owner = d->owner};
    struct subdomain *sd = NULL;
    struct measures part;
    const struct state_view from = state_view_of(&run->state);
    enum dm2_status status = run->staged ? subdomain_restore(run->model, &map, rank, &from, &sd, err)
                                         : subdomain_create(run->model, &map, rank, &sd, err);
    if (status != DM2_OK)
        return status;
    *out = (struct rank_size){subdomain_owned(sd), subdomain_mirrored(sd), subdomain_bytes(sd)};
    overlap_merge(&start->overlap, subdomain_overlap(sd));
    if (start->status == DM2_OK && overlap_check(&start->overlap, &run->config, NULL) == DM2_OK) {
        start->status = subdomain_forces(sd, true, err);
        if (start->status == DM2_OK)
            start->status = subdomain_measure_last(sd, &part, err);
        if (start->status == DM2_OK)
            measures_merge(&start->measures, &part);
    }
    subdomain_free(sd);
    return DM2_OK;
}

static void print_rank(FILE *to, const struct decomposition *d, int rank, const char *name, size_t owned,
                       size_t mirrored, const struct rank_boundary *b)
{
    static const char *const sides[] = {"w", "e", "s", "n", "sw", "se", "nw", "ne"};
    const struct cell_rect *r = &d->rect[rank];
    int interfaces[SIDE_COUNT];
    decomposition_interfaces(d, rank, interfaces);
    (void)fprintf(to,
                  "server %d%s%s: particles %zu, mirrored %zu, cells %zu = %d x %d from (%d, %d), interface "
                  "%zu cells = %.6g cm, "
                  "boundary cells %zu inner %zu outer, meets others at",
                  rank, name == NULL ? "" : " ", name == NULL ? "" : name, owned, mirrored,
                  decomposition_cells(d, rank), r->x1 - r->x0, r->y1 - r->y0, r->x0, r->y0,
                  b->interface_cells, b->interface_cm, b->inner, b->outer);
    bool none = true;
    for (int side = 0; side < SIDE_COUNT; side++)
        if (interfaces[side] > 0) {
            (void)fprintf(to, " %s", sides[side]);
            none = false;
        }
    (void)fprintf(to, "%s\n", none ? " no side" : "");
}

static void print_run(FILE *to, const struct run_options *o, const struct run *run,
                      const struct measures *start)
{
    const struct grid *g = model_grid(run->model);
    const char *which = "";
    double stable = model_stable_start(run->model, start, &which);
    const struct model_room room = model_room(run->model);
    (void)fprintf(to, "deck %s\n", o->deck);
    (void)fprintf(to, "particles %zu\n", model_elements(run->model));
    (void)fprintf(to, "cells %d = %d x %d\n", g->cx * g->cy, g->cx, g->cy);
    (void)fprintf(to, "cell edges %.6g x %.6g cm, r_c + delta_r = %.6g cm\n", g->lx, g->ly,
                  run->config.r_c + run->config.delta_r);
    (void)fprintf(to, "steps %lld of %.6g us\n", (long long)run->config.steps, run->config.dt);
    (void)fprintf(to, "stable time step %.6g us (%s), chosen %.6g us = %.3g of it\n", stable, which,
                  run->config.dt, run->config.dt / stable);
    for (size_t k = 0; k < run->config.n_walls; k++) {
        const struct wall_config *w = &run->config.walls[k];
        if (w->n_points == 0)
            (void)fprintf(to, "wall %s: circle of radius %.6g cm\n", w->name, w->circle[2]);
        else
            (void)fprintf(to, "wall %s: %s line of %zu parts\n", w->name, w->closed ? "closed" : "open",
                          w->n_points - 1);
    }
    if (room.count > 0 && room.dt < stable)
        (void)fprintf(to, "elements of '%s' have room for %d of '%s': then %.3g us\n",
                      run->config.bodies[room.body].name, room.count, run->config.bodies[room.other].name,
                      room.dt);
    run_loads_print(to, run->model);
}

/* Prints the lines of the subdomains, of their interfaces and of the memory. */
static enum dm2_status print_ranks(FILE *to, const struct decomposition *d, const struct rank_size *size,
                                   const char *const *server_names, struct dm2_error *err)
{
    uint64_t total = 0; /* of several servers: more than one process can have */
    size_t most = 0, edges = 0;
    double length = 0;
    for (int rank = 0; rank < d->ranks; rank++) {
        struct rank_boundary b = {0};
        const struct rank_size *s = &size[rank];
        enum dm2_status status = decomposition_boundary(d, rank, &b, err);
        if (status != DM2_OK)
            return status;
        print_rank(to, d, rank, server_names == NULL ? NULL : server_names[rank], s->owned, s->mirrored, &b);
        total += s->bytes;
        most = s->bytes > most ? s->bytes : most;
        edges += b.interface_cells;
        length += b.interface_cm;
    }
    (void)fprintf(to, "interfaces %zu cells = %.6g cm in all\n", edges / 2,
                  length / 2); /* every interface counts at both sides */
    (void)fprintf(to, "memory %.1f MB in all, %.1f MB at most on one server\n", 1e-6 * (double)total,
                  1e-6 * (double)most);
    return DM2_OK;
}

enum dm2_status run_print_check(FILE *to, const struct run_options *o, const struct run *run,
                                const struct decomposition *d, const char *const *server_names,
                                struct dm2_error *err)
{
    struct run_start start = {.status = DM2_OK};
    struct rank_size *size = mem_zalloc((size_t)d->ranks, sizeof *size);
    enum dm2_status status = DM2_OK;
    if (size == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d subdomains", d->ranks);
    measures_clear(&start.measures);
    for (int rank = 0; rank < d->ranks && status == DM2_OK; rank++)
        status = measure_rank(run, d, rank, &size[rank], &start, err);
    if (status == DM2_OK)
        status = overlap_check(&start.overlap, &run->config, err);
    if (status == DM2_OK)
        status = start.status; /* *err is from then */
    if (status == DM2_OK)
        status = model_check_start(run->model, &start.measures, err);
    if (status == DM2_OK) {
        print_run(to, o, run, &start.measures);
        status = print_ranks(to, d, size, server_names, err);
        run_print_overlap(o, run, &start.overlap);
    }
    free(size);
    return status;
}

void run_print_verdict(const struct run_options *o, const struct results_verdict *verdict)
{
    if (o->quiet)
        return;
    if (verdict->warning[0] != '\0')
        (void)fprintf(stderr, "%s: %s\n", o->program, verdict->warning);
    if (verdict->stop[0] != '\0')
        (void)printf("%s\n", verdict->stop);
    (void)printf("%s\n", verdict->energy);
}

void run_print_hash(int64_t step, uint64_t hash)
{
    (void)printf("step %lld hash %016llx\n", (long long)step, (unsigned long long)hash);
    (void)fflush(stdout);
}

bool run_hash_due(const struct run_options *o, const struct run *run, int64_t step)
{
    return o->hash_every > 0 && (step % o->hash_every == 0 || step == run->config.steps);
}

bool run_output_asked(const struct run_options *o)
{
    return o->check || o->hash_every > 0 || o->help || o->version;
}

int run_report_failure(const char *program, const struct dm2_error *err)
{
    (void)fprintf(stderr, "%s: %s\n", program, err->text);
    if (err->status == DM2_USAGE)
        (void)fprintf(stderr, "%s --help tells how it is called\n", program);
    return dm2_exit_code(err->status);
}

void run_print_version(const char *program)
{
    (void)printf("%s %s\n", program, DM2_VERSION);
}
