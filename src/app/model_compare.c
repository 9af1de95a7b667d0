/* dm2-model compare: measured beside predicted (the paper's section 7.2, Figs. 13 to 16).
 *
 * A case is a number of elements and a number of servers; its runs are averaged. The predictions are those
 * of app/prediction.h, with this machine's processors where the servers run on this machine. `critical` is
 * computed, not measured: the processor time of the busiest server plus the communication of the model,
 * which is the time of a step if every server had a processor of its own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "local_servers.h"
#include "model_commands.h"
#include "model_options.h"
#include "prediction.h"
#include "signals.h"
#include "sweep.h"

static const double SIZES[] = {1689, 10000, 50000, 100000, 200000}; /* section 7.2 */

struct compare {
    struct sweep sweep;
    struct server_choice servers;
    struct option_list operands; /* finished run directories; none: the sweep */
    const char *calibration_file;
    char path[PREDICTION_TEXT];
    struct calibration calibration;
    bool csv, help;
};

/* One case: sums over its runs, until average_cases divides them. */
struct measured_case {
    double n;
    int servers; /* 0: dm2-seq */
    int runs;
    double measured, predicted, critical; /* s per step */
    double t_seq_predicted, t_seq_cpu;    /* s per step; t_seq_cpu: processor time of the busiest server */
};

struct cases {
    struct measured_case *items;
    size_t n, cap;
};

static struct measured_case *find_case(const struct cases *all, double n, int servers)
{
    for (size_t k = 0; k < all->n; k++)
        if (all->items[k].n == n && all->items[k].servers == servers)
            return &all->items[k];
    return NULL;
}

static enum dm2_status add_run(const struct compare *c, struct cases *all, const struct run_report *r,
                               struct dm2_error *err)
{
    int servers = strcmp(r->program, "dm2-seq") == 0 ? 0 : r->ranks;
    int cores = c->servers.named.n == 0 ? local_servers_cores() : 0;
    struct measured_case *one = find_case(all, (double)r->elements, servers);
    struct prediction_basis basis;
    struct explanation e;
    double busiest = 0;
    if (one == NULL) {
        struct measured_case *grown = mem_grown(all->items, &all->cap, all->n, all->n + 1, sizeof *grown);
        if (grown == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for %zu cases", all->n + 1);
        all->items = grown;
        one = &all->items[all->n++];
        *one = (struct measured_case){.n = (double)r->elements, .servers = servers};
    }
    prediction_calibrated(&c->calibration, c->path, r, cores, &basis);
    if (servers == 0)
        basis.m = basis.b = 0; /* dm2-seq sends no messages */
    if (!prediction_explain(r, &basis, &e))
        return dm2_fail(err, DM2_USAGE, "a run of %zu elements timed no step", r->elements);
    for (int k = 0; k < r->ranks; k++)
        busiest = fmax(busiest, r->servers[k].times.cpu / (double)r->steps);
    one->runs++;
    one->measured += e.measured;
    one->predicted += e.predicted;
    one->critical += busiest + e.communication;
    one->t_seq_predicted += basis.t_seq;
    one->t_seq_cpu += busiest;
    return DM2_OK;
}

static void average_cases(struct cases *all)
{
    for (size_t k = 0; k < all->n; k++) {
        struct measured_case *one = &all->items[k];
        double *const sums[] = {&one->measured, &one->predicted, &one->critical, &one->t_seq_predicted,
                                &one->t_seq_cpu};
        for (size_t i = 0; i < sizeof sums / sizeof sums[0]; i++)
            *sums[i] /= one->runs;
    }
}

/* --- output --- */

enum { FIELDS = 13 };

/* The fields of one row. servers 0 is printed as 1, with the program's name beside it; speedups are
 * relative to dm2-seq with the same n, NaN where there is no such run. */
static void fill_fields(const struct cases *all, const struct measured_case *one, double out[FIELDS])
{
    const struct measured_case *seq = find_case(all, one->n, 0);
    int servers = one->servers == 0 ? 1 : one->servers;
    double t_seq = seq == NULL ? NAN : seq->measured, cpu = seq == NULL ? NAN : seq->t_seq_cpu;
    double speedup = t_seq / one->measured, predicted = one->t_seq_predicted / one->predicted;
    const double fields[FIELDS] = {one->n,
                                   servers,
                                   one->runs,
                                   one->measured,
                                   one->predicted,
                                   100 * (one->predicted - one->measured) / one->measured,
                                   t_seq,
                                   speedup,
                                   predicted,
                                   speedup / servers,
                                   predicted / servers,
                                   one->critical,
                                   cpu / one->critical};
    memcpy(out, fields, sizeof fields);
}

static void print_csv(const struct cases *all)
{
    (void)printf(
        "program,n,servers,runs,measured,predicted,error_percent,t_seq,speedup,speedup_predicted,efficiency,"
        "efficiency_predicted,critical,speedup_critical\n");
    for (size_t k = 0; k < all->n; k++) {
        double fields[FIELDS];
        fill_fields(all, &all->items[k], fields);
        (void)printf("%s", all->items[k].servers == 0 ? "dm2-seq" : "dm2-client");
        for (int f = 0; f < FIELDS; f++) {
            char text[NUMBER_TEXT_MAX];
            (void)number_format(fields[f], text);
            (void)printf(",%s", text);
        }
        (void)printf("\n");
    }
}

static void print_table(const struct compare *c, const struct cases *all)
{
    (void)printf(
        "constants: %s\nms per step; speedup and efficiency against dm2-seq; critical: computed from "
        "processor "
        "time\n\n"
        "   elements servers runs   measured  predicted  error %%  speedup predicted  efficiency predicted  "
        "critical  speedup\n",
        c->path);
    for (size_t k = 0; k < all->n; k++) {
        double f[FIELDS];
        fill_fields(all, &all->items[k], f);
        (void)printf("%11.0f %7s%.0f %4.0f %10.4f %10.4f %8.1f %8.3f %9.3f %11.3f %9.3f %9.4f %8.3f\n", f[0],
                     all->items[k].servers == 0 ? "seq " : "", f[1], f[2], 1e3 * f[3], 1e3 * f[4], f[5], f[7],
                     f[8], f[9], f[10], 1e3 * f[11], f[12]);
    }
}

/* --- runs --- */

static enum dm2_status read_runs(const struct compare *c, struct cases *all, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < c->operands.n && status == DM2_OK; k++) {
        struct run_report r;
        status = sweep_read(c->operands.items[k], &r, err);
        if (status != DM2_OK)
            break;
        status = add_run(c, all, &r, err);
        free(r.servers);
    }
    return status;
}

static enum dm2_status make_runs(struct compare *c, struct cases *all, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    c->sweep.cancel = signals_catch();
    c->sweep.servers = &c->servers;
    for (int i = 0; i < c->sweep.sizes && status == DM2_OK; i++)
        for (int run = 1; run <= c->sweep.runs && status == DM2_OK; run++)
            for (int j = -1; j < c->servers.n_counts && status == DM2_OK; j++) { /* -1: dm2-seq */
                struct run_report r;
                status = sweep_run(&c->sweep, c->sweep.n[i], j < 0 ? 0 : c->servers.counts[j], run, &r, err);
                if (status != DM2_OK)
                    break;
                status = add_run(c, all, &r, err);
                free(r.servers);
            }
    return status;
}

static enum dm2_status run_comparison(struct compare *c, struct dm2_error *err)
{
    struct cases all = {0};
    char note[PREDICTION_TEXT];
    enum dm2_status status = prediction_calibration(c->calibration_file, &c->calibration, c->path, note, err);
    if (status == DM2_OK && c->path[0] == '\0')
        status = dm2_fail(err, DM2_USAGE,
                          "%s%sthere are no constants to predict with: dm2-model calibrate measures them",
                          note, note[0] == '\0' ? "" : "; ");
    if (status == DM2_OK)
        status = c->operands.n > 0 ? read_runs(c, &all, err) : make_runs(c, &all, err);
    if (status == DM2_OK) {
        average_cases(&all);
        if (c->csv)
            print_csv(&all);
        else
            print_table(c, &all);
    }
    free(all.items);
    return status;
}

enum dm2_status model_compare_command(const char *argv0, int argc, char **argv, struct dm2_error *err)
{
    enum { OWN = 3, ALL = OWN + SERVER_CHOICE_OPTIONS + SWEEP_OPTIONS };
    struct compare c = {0};
    struct option table[ALL] = {
        {"calibration", 0, OPTION_TEXT, &c.calibration_file, "FILE",
         "the constants (default $DM2_CALIBRATION, ./dm2-calibration.csv)", 0, 0},
        {"csv", 0, OPTION_FLAG, &c.csv, NULL, "comma-separated values, times in seconds", 0, 0},
        {"help", 'h', OPTION_FLAG, &c.help, NULL, "prints this", 0, 0},
    };
    server_choice_start(&c.servers, table + OWN);
    sweep_start(&c.sweep, table + OWN + SERVER_CHOICE_OPTIONS);
    enum dm2_status status = options_parse(table, ALL, argc, argv, &c.operands, err);
    if (status == DM2_OK && c.help) {
        (void)printf("usage: dm2-model compare [RUN-DIRECTORY...] [options]\n"
                     "Measured beside predicted, of finished runs or of a sweep that it makes: dm2-seq and N "
                     "servers,\n"
                     "1689 to 200000 elements unless --n says otherwise.\n\n");
        options_print(stdout, table, ALL);
    } else {
        if (status == DM2_OK)
            status = server_choice_finish(&c.servers, err);
        if (status == DM2_OK && c.operands.n == 0) /* finished runs need no deck */
            status = sweep_finish(&c.sweep, SIZES, (int)(sizeof SIZES / sizeof SIZES[0]), argv0, err);
        if (status == DM2_OK)
            status = run_comparison(&c, err);
    }
    option_list_free(&c.operands);
    sweep_free(&c.sweep);
    server_choice_free(&c.servers);
    return status;
}
