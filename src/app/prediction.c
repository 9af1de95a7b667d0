/* Puts the model's prediction of a run into words. Every run has a prediction: with the constants of a
 * calibration file where there is one, else with constants learned from the run itself; the text names
 * their origin. An estimate of the latter kind takes T_seq from the same times with which it is compared, so
 * the comparison tells about communication and balance, not about computing. */
#include "prediction.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/mem.h"
#include "dm2/base/version.h"
#include "dm2/cluster/wire.h"

/* Bytes of a migrating element, which takes its pairs along: six on a hexagonal lattice. */
enum { MIGRANT_BYTES = WIRE_ELEMENT + 6 * WIRE_PAIR };

enum dm2_status prediction_calibration(const char *option, struct calibration *out,
                                       char path[PREDICTION_TEXT], char note[PREDICTION_TEXT],
                                       struct dm2_error *err)
{
    char host[CALIBRATION_TEXT_MAX] = "";
    const char *named = option != NULL ? option : getenv("DM2_CALIBRATION");
    bool asked = named != NULL && named[0] != '\0';
    path[0] = note[0] = '\0';
    if (!asked && access(CALIBRATION_FILE, F_OK) != 0)
        return DM2_OK;
    (void)snprintf(path, PREDICTION_TEXT, "%s", asked ? named : CALIBRATION_FILE);
    if (gethostname(host, sizeof host - 1) != 0)
        return dm2_fail(err, DM2_IO, "this machine's host name cannot be found out");
    enum dm2_status status = calibration_read(path, host, DM2_VERSION, out, err);
    if (status == DM2_OK || asked)
        return status;
    (void)snprintf(note, PREDICTION_TEXT, "%s; the prediction is estimated from the run itself", err->text);
    path[0] = '\0';
    return DM2_OK;
}

static double sum_cells(const struct run_report *r)
{
    double cells = 0;
    for (int k = 0; k < r->ranks; k++)
        cells += (double)r->servers[k].cells;
    return cells;
}

/* The processors that the servers have together. `cores`: of the machine that all servers are on; 0 where
 * each server has its own machine. */
static int count_processors(const struct run_report *r, int cores)
{
    return cores > 0 && cores < r->ranks ? cores : r->ranks;
}

/* Whether the client has a processor that no server computes on. */
static bool has_own_processor(const struct run_report *r, int cores)
{
    return cores == 0 || cores > r->ranks;
}

void prediction_calibrated(const struct calibration *c, const char *path, const struct run_report *r,
                           int cores, struct prediction_basis *out)
{
    struct perf p = c->perf;
    double n = (double)r->elements, cells = sum_cells(r);
    int processors = count_processors(r, cores), busy = cores > 0 ? processors : 1;
    *out = (struct prediction_basis){.processors = processors, .apart = has_own_processor(r, cores)};
    p.k = perf_k_at(&c->perf, n, 1, cores);
    out->t_seq = perf_t_seq_cells(&p, n, cells);
    p.k = perf_k_at(&c->perf, n / processors, busy, cores);
    out->work = perf_t_seq_cells(&p, n, cells);
    bool row = perf_network(&c->perf, r->ranks, &out->m, &out->b);
    (void)snprintf(out->source, sizeof out->source, "calibrated: %.200s%s", path,
                   row ? "" : ", m and b inferred from other numbers of servers");
}

void prediction_estimated(const struct network_line *line, const struct run_report *r, int cores,
                          struct prediction_basis *out)
{
    *out = (struct prediction_basis){.m = line->m,
                                     .b = line->b,
                                     .processors = count_processors(r, cores),
                                     .apart = has_own_processor(r, cores)};
    for (int k = 0; k < r->ranks; k++) {
        const struct server_times *t = &r->servers[k].times;
        double computing = t->forces + t->integrate + t->rebuild;
        double all = computing + t->pack + t->unpack;
        if (t->steps > 0 && all > 0)
            out->t_seq += t->cpu * (computing / all) / (double)t->steps;
    }
    out->work = out->t_seq;
    (void)snprintf(out->source, sizeof out->source,
                   "estimated from this run's own processor time and %d round trips before it",
                   line->turns * line->sizes);
}

bool prediction_explain(const struct run_report *r, const struct prediction_basis *basis,
                        struct explanation *out)
{
    struct explain_server *servers = mem_zalloc((size_t)r->ranks, sizeof *servers);
    if (servers == NULL || r->timed == 0 || !(r->stepping > 0) || r->steps == 0) {
        free(servers);
        return false;
    }
    for (int k = 0; k < r->ranks; k++) {
        const struct server_times *t = &r->servers[k].times;
        double steps = (double)r->steps;
        servers[k] = (struct explain_server){.computing = (t->forces + t->integrate + t->rebuild) / steps,
                                             .ahead = t->ahead / steps,
                                             .packing = (t->pack + t->unpack) / steps,
                                             .mirrored = (double)r->servers[k].mirrored,
                                             .migrants = (double)t->migrants / steps};
    }
    const struct explain_input in = {.servers = r->ranks,
                                     .processors = basis->processors,
                                     .t_seq = basis->t_seq,
                                     .work = basis->work,
                                     .m = basis->m,
                                     .b = basis->b,
                                     .apart = basis->apart,
                                     .g = (double)r->update_bytes,
                                     .g_migrant = MIGRANT_BYTES,
                                     .measured = r->stepping / (double)r->timed,
                                     .relay = r->relay / (double)r->steps,
                                     .redone = (double)r->redone / (double)r->steps,
                                     .server = servers};
    *out = explain_run(&in);
    free(servers);
    return true;
}

void prediction_text(const struct explanation *e, const struct prediction_basis *basis,
                     const struct run_report *r, char out[PREDICTION_TEXT])
{
    char crowd[80] = "";
    double difference = e->measured - e->predicted;
    if (basis->processors < r->ranks)
        (void)snprintf(crowd, sizeof crowd, ", %d servers on %d processors", r->ranks, basis->processors);
    (void)snprintf(out, PREDICTION_TEXT,
                   "predicted: %.4g ms per step = %.4g computing + %.4g communication (%s%s)\n"
                   "measured: %.4g ms per step, %+.1f %%; largest cause of the difference: %s, %+.3g ms\n"
                   "speedup: %.3g, efficiency %.3g, against T_seq %.4g ms per step\n",
                   1e3 * e->predicted, 1e3 * e->computing, 1e3 * e->communication, basis->source, crowd,
                   1e3 * e->measured, 100 * difference / e->predicted, explain_cause_name(e->largest),
                   1e3 * e->share[e->largest], e->speedup, e->efficiency, 1e3 * basis->t_seq);
}
