/* dm2-model calibrate: k from sequential runs, m_N and b_N from round trips, into the calibration file.
 *
 * k = T c/n^2 (eq. 11) of each run; T is the processor's time per step, which is the time that passes where a machine has
 * nothing else to do, and does not count what other programs take where it has. The cells' edges of the file are those of
 * square cells that give the largest run its number of cells. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/app/model_commands.h"
#include "dm2/app/model_options.h"
#include "dm2/app/signals.h"
#include "dm2/app/sweep.h"
#include "dm2/base/version.h"
#include "dm2/model/calibration.h"

static const double SIZES[] = {1689, 10000, 50000};
static const double SPACING_X = 0.04, SPACING_Y = 0.03464; /* of timing.dm2, cm */

enum { RUNS_MOST = SWEEP_SIZES * 100 };

struct calibrate {
    struct sweep sweep;
    struct server_choice servers;
    struct option_list operands;
    const char *file;
    int64_t turns;
    bool help;
};

/* Runs dm2-seq at every size; k and its spread, L_x = L_y and g. */
static enum dm2_status measure_k(const struct calibrate *c, struct calibration *out, struct dm2_error *err)
{
    static double k[RUNS_MOST];
    size_t count = 0;
    double largest = 0;
    enum dm2_status status = DM2_OK;
    for (int i = 0; i < c->sweep.sizes && status == DM2_OK; i++)
        for (int run = 1; run <= c->sweep.runs && status == DM2_OK; run++) {
            struct run_report r;
            status = sweep_run(&c->sweep, c->sweep.n[i], 0, run, &r, err);
            if (status != DM2_OK)
                break;
            double n = (double)r.elements, cells = (double)r.servers[0].cells;
            double t = r.servers[0].times.cpu / (double)r.steps;
            k[count++] = t * cells / (n * n);
            (void)printf("%8.0f elements, run %d: %10.4f ms per step, %.4g us per element, k = %.4g s\n", n, run,
                         1e3 * t, 1e6 * t / n, k[count - 1]);
            (void)fflush(stdout);
            if (n > largest) {
                largest = n;
                out->perf.l_x = out->perf.l_y = sqrt(n * SPACING_X * SPACING_Y / cells);
                out->perf.g = (double)r.update_bytes;
            }
            free(r.servers);
        }
    if (status == DM2_OK)
        fit_spread(k, count, &out->perf.k, &out->k_spread);
    return status;
}

static enum dm2_status measure_network(const struct calibrate *c, struct calibration *out, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (int i = 0; i < c->servers.n_counts && status == DM2_OK; i++) {
        struct network_line line;
        status = server_choice_measure(&c->servers, c->sweep.argv0, c->servers.counts[i], (int)c->turns, c->sweep.cancel,
                                       &line, err);
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

static enum dm2_status run(struct calibrate *c, struct dm2_error *err)
{
    struct calibration out = {.version = DM2_VERSION, .perf = {.d_x = SPACING_X, .d_y = SPACING_Y}};
    const char *named = getenv("DM2_CALIBRATION");
    const char *path = c->file != NULL ? c->file : named != NULL && named[0] != '\0' ? named : CALIBRATION_FILE;
    if (gethostname(out.host, sizeof out.host - 1) != 0)
        return dm2_fail(err, DM2_IO, "this machine's host name cannot be found out");
    c->sweep.cancel = signals_catch();
    c->sweep.servers = &c->servers;
    enum dm2_status status = measure_k(c, &out, err);
    if (status == DM2_OK)
        status = measure_network(c, &out, err);
    if (status == DM2_OK)
        status = calibration_write(path, &out, err);
    if (status != DM2_OK)
        return status;
    (void)printf("k = %.4g s, spread %.2g s (%.1f %%), g = %g bytes\nwritten to %s\n", out.perf.k, out.k_spread,
                 100 * out.k_spread / out.perf.k, out.perf.g, path);
    return model_output_end(err);
}

enum dm2_status model_calibrate_command(const char *argv0, int argc, char **argv, struct dm2_error *err)
{
    enum { OWN = 3, ALL = OWN + SERVER_CHOICE_OPTIONS + SWEEP_OPTIONS };
    struct calibrate c = {.turns = 50};
    struct option table[ALL] = {
        {"file", 'f', OPTION_TEXT, &c.file, "FILE",
         "what to write (default $DM2_CALIBRATION, ./dm2-calibration.csv)", 0, 0},
        {"turns", 0, OPTION_INTEGER, &c.turns, "T", "round trips of each size (default 50)", 4, NETWORK_TURNS},
        {"help", 'h', OPTION_FLAG, &c.help, NULL, "prints this", 0, 0},
    };
    server_choice_start(&c.servers, table + OWN);
    sweep_start(&c.sweep, table + OWN + SERVER_CHOICE_OPTIONS);
    enum dm2_status status = options_parse(table, ALL, argc, argv, &c.operands, err);
    if (status == DM2_OK && c.help) {
        (void)printf("usage: dm2-model calibrate [options]\n"
                     "Measures this cluster: dm2-seq at several sizes, round trips to N servers.\n\n");
        options_print(stdout, table, ALL);
    } else {
        if (status == DM2_OK && c.operands.n > 0)
            status = dm2_fail(err, DM2_USAGE, "'%s' is not an option", c.operands.items[0]);
        if (status == DM2_OK)
            status = server_choice_finish(&c.servers, err);
        if (status == DM2_OK)
            status = sweep_finish(&c.sweep, SIZES, (int)(sizeof SIZES / sizeof SIZES[0]), argv0, err);
        if (status == DM2_OK)
            status = run(&c, err);
    }
    option_list_free(&c.operands);
    sweep_free(&c.sweep);
    server_choice_free(&c.servers);
    return status;
}
