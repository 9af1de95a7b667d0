/* dm2-model calibrate: k from runs on one and on all processors, m_N and b_N from round trips, into the
 * calibration file.
 *
 * k = T c/n^2 (eq. 11) of each run. T is the processor time per step, which equals the elapsed time on an
 * idle machine and excludes the time that other programs take on a busy one. k is not one number, because
 * more elements fit worse into caches, and because the processors of one machine share caches and memory;
 * therefore k is measured at every size, with one program alone and with as many servers of that size as
 * there are processors. The k of a server exceeds that of dm2-seq under the same load, because a server
 * also evaluates the pairs across its boundary, keeps the data that it may have to undo, and finds its
 * caches as its client left them. The file's cell edges belong to square cells; the largest
 * run sets the number of cells. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/version.h"
#include "dm2/performance/calibration.h"
#include "local_servers.h"
#include "model_commands.h"
#include "model_options.h"
#include "signals.h"
#include "sweep.h"

static const double SIZES[] = {1689, 5000, 10000, 25000, 50000, 100000, 200000};
static const double SPACING_X = 0.04, SPACING_Y = 0.03464; /* of timing.dm2, cm */

enum { RUNS_MOST = SWEEP_SIZES * 100 };

struct calibrate {
    struct sweep sweep;
    struct server_choice servers;
    const char *file;
    int64_t turns;
    bool help;
    double alone[RUNS_MOST];  /* k of every run of dm2-seq */
    double shared[RUNS_MOST]; /* k of every server, of one size */
};

/* k of one server, or of dm2-seq, in seconds; eq. (11). 0 for a server without elements. */
static double server_k(const struct run_report *r, int server)
{
    const struct server_report *s = &r->servers[server];
    double n = (double)s->owned, cells = (double)s->cells;
    return n > 0 ? s->times.cpu / (double)r->steps * cells / (n * n) : 0;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* The median, because one disturbed run tells nothing about the others. Sorts `values`. */
static double median_of(double *values, size_t n)
{
    qsort(values, n, sizeof *values, compare_doubles);
    return 0.5 * (values[n / 2] + values[(n - 1) / 2]);
}

static void note_run(struct calibration *out, const struct run_report *r, struct perf_size *size)
{
    double n = (double)r->elements, cells = (double)r->servers[0].cells;
    size->n = n;
    out->perf.l_x = out->perf.l_y = sqrt(n * SPACING_X * SPACING_Y / cells);
    out->perf.g = (double)r->update_bytes;
}

/* The runs of one size: dm2-seq, then one server of this size per processor. alone[] gets the k of the
 * runs of dm2-seq. */
static enum dm2_status measure_size(struct calibrate *c, double wanted, int processors, double *alone,
                                    struct calibration *out, struct perf_size *size, struct dm2_error *err)
{
    int runs = (int)c->sweep.runs;
    size_t n_shared = 0;
    enum dm2_status status = DM2_OK;
    for (int run = 1; run <= runs && status == DM2_OK; run++) {
        struct run_report r;
        status = sweep_run(&c->sweep, wanted, 0, run, &r, err);
        if (status != DM2_OK)
            return status;
        note_run(out, &r, size);
        alone[run - 1] = server_k(&r, 0);
        free(r.servers);
        if (processors == 1)
            continue;
        status = sweep_run(&c->sweep, wanted * processors, processors, run, &r, err);
        for (int k = 0; k < processors && status == DM2_OK; k++) {
            double of_server = server_k(&r, k);
            if (n_shared < RUNS_MOST && of_server > 0)
                c->shared[n_shared++] = of_server;
        }
        if (status == DM2_OK)
            free(r.servers);
    }
    if (status != DM2_OK)
        return status;
    size->alone = median_of(alone, (size_t)runs);
    size->shared = n_shared > 0 ? median_of(c->shared, n_shared) : size->alone;
    (void)printf("%8.0f elements: k = %.4g s alone, %.4g s each of %d servers\n", size->n, size->alone,
                 size->shared, processors);
    (void)fflush(stdout);
    return DM2_OK;
}

/* Measures k at every size and its mean and spread over the runs alone, L_x = L_y of the largest run, and
 * g. */
static enum dm2_status measure_k(struct calibrate *c, struct calibration *out, struct dm2_error *err)
{
    size_t count = 0;
    int processors = local_servers_cores();
    enum dm2_status status = DM2_OK;
    if (c->servers.named.n > 0)
        processors = 1; /* named servers have a machine each */
    qsort(c->sweep.n, (size_t)c->sweep.sizes, sizeof c->sweep.n[0], compare_doubles);
    for (int i = 0; i < c->sweep.sizes && status == DM2_OK; i++) {
        struct perf_size *size = &out->perf.size[out->perf.n_size];
        status = measure_size(c, c->sweep.n[i], processors, c->alone + count, out, size, err);
        count += (size_t)c->sweep.runs;
        /* Two sizes with the same number of elements count as one size. */
        out->perf.n_size += out->perf.n_size == 0 || size->n > size[-1].n;
    }
    if (status == DM2_OK)
        fit_spread(c->alone, count, &out->perf.k, &out->k_spread);
    return status;
}

static enum dm2_status measure_network(const struct calibrate *c, struct calibration *out,
                                       struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (int i = 0; i < c->servers.n_counts && status == DM2_OK; i++) {
        struct network_line line;
        status = server_choice_measure(&c->servers, c->sweep.argv0, c->servers.counts[i], (int)c->turns,
                                       c->sweep.cancel, &line, err);
        if (status != DM2_OK)
            break;
        out->residual[out->perf.n_network] = line.residual;
        out->perf.network[out->perf.n_network++] =
            (struct perf_network){.servers = line.servers, .m = line.m, .b = line.b};
        (void)printf("%d server%s: m = %.4g s/byte, b = %.4g s, residual %.2g s\n", line.servers,
                     line.servers == 1 ? "" : "s", line.m, line.b, line.residual);
    }
    return status;
}

static enum dm2_status run_calibration(struct calibrate *c, struct dm2_error *err)
{
    struct calibration out = {.version = DM2_VERSION, .perf = {.d_x = SPACING_X, .d_y = SPACING_Y}};
    const char *named = getenv("DM2_CALIBRATION");
    const char *path = c->file != NULL                     ? c->file
                       : named != NULL && named[0] != '\0' ? named
                                                           : CALIBRATION_FILE;
    if (gethostname(out.host, sizeof out.host - 1) != 0)
        return dm2_fail(err, DM2_IO, "this machine's host name cannot be found out");
    bool absent;
    if (strcmp(path, "-") == 0)
        return dm2_fail(err, DM2_USAGE, "--file -: standard output has the measurements: name a file");
    enum dm2_status status = file_check_name(path, &absent, err);
    if (status != DM2_OK)
        return status;
    c->sweep.cancel = signals_catch();
    c->sweep.servers = &c->servers;
    status = measure_k(c, &out, err);
    if (status == DM2_OK)
        status = measure_network(c, &out, err);
    if (status == DM2_OK)
        status = calibration_write(path, &out, err);
    if (status != DM2_OK)
        return status;
    (void)printf("k = %.4g s, spread %.2g s (%.1f %%), g = %g bytes\nwritten to %s\n", out.perf.k,
                 out.k_spread, 100 * out.k_spread / out.perf.k, out.perf.g, path);
    return DM2_OK;
}

enum dm2_status model_calibrate_command(const char *argv0, int argc, char **argv, struct dm2_error *err)
{
    enum { OWN = 3, ALL = OWN + SERVER_CHOICE_OPTIONS + SWEEP_OPTIONS };
    struct calibrate *c = mem_zalloc(1, sizeof *c); /* 56 kB, too much for a small stack */
    if (c == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for a calibration");
    c->turns = 50;
    struct option table[ALL] = {
        {"file", 'f', OPTION_TEXT, &c->file, "FILE",
         "what to write (default $DM2_CALIBRATION, ./dm2-calibration.csv)", 0, 0},
        {"turns", 0, OPTION_INTEGER, &c->turns, "T", "round trips of each size (default 50)", 4,
         NETWORK_TURNS},
        {"help", 'h', OPTION_FLAG, &c->help, NULL, "prints this", 0, 0},
    };
    server_choice_start(&c->servers, table + OWN);
    sweep_start(&c->sweep, table + OWN + SERVER_CHOICE_OPTIONS);
    enum dm2_status status =
        server_choice_parse(&c->servers, table, ALL, argc, argv, &c->help,
                            "usage: dm2-model calibrate [options]\n"
                            "Measures this cluster: dm2-seq at several sizes, round trips to N servers.\n\n",
                            err);
    if (status == DM2_OK && !c->help)
        status = sweep_finish(&c->sweep, SIZES, (int)(sizeof SIZES / sizeof SIZES[0]), argv0, err);
    if (status == DM2_OK && !c->help)
        status = run_calibration(c, err);
    sweep_free(&c->sweep);
    server_choice_free(&c->servers);
    free(c);
    return status;
}
