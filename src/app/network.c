/* Measures the network.
 *
 * The sizes take turns, so that a lasting disturbance affects all of them, and the result is the median
 * over the turns, because one delayed message tells nothing about the others. The first turn, with cold
 * caches and congestion windows, is left out where more than three turns are done. */
#include "network.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

static const uint32_t QUICK[] = {64, 4096, 16384};
static const uint32_t FULL[] = {64, 2048, 4096, 8192, 16384, 32768, 65536};
static const double QUICK_SECONDS = 0.03, FULL_SECONDS = 30;

enum dm2_status network_probe_start(struct network_probe *probe, bool quick, int turns, struct dm2_error *err)
{
    const uint32_t *from = quick ? QUICK : FULL;
    int sizes = (int)(quick ? sizeof QUICK / sizeof QUICK[0] : sizeof FULL / sizeof FULL[0]);
    *probe = (struct network_probe){
        .echo = {.sizes = sizes, .repeats = turns, .budget = quick ? QUICK_SECONDS : FULL_SECONDS}};
    memcpy(probe->bytes, from, (size_t)sizes * sizeof *from);
    probe->echo.seconds = mem_zalloc((size_t)(turns * sizes), sizeof *probe->echo.seconds);
    if (probe->echo.seconds == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d round trips", turns * sizes);
    return DM2_OK;
}

struct client_echo *network_probe_echo(struct network_probe *probe)
{
    probe->echo.bytes = probe->bytes;
    return &probe->echo;
}

void network_probe_free(struct network_probe *probe)
{
    free(probe->echo.seconds);
    *probe = (struct network_probe){0};
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median_of(const struct client_echo *e, int size)
{
    double values[NETWORK_TURNS];
    int first = e->done > 3 ? 1 : 0, n = 0;
    for (int turn = first; turn < e->done && n < NETWORK_TURNS; turn++)
        values[n++] = e->seconds[turn * e->sizes + size];
    qsort(values, (size_t)n, sizeof values[0], compare_doubles);
    return n == 0 ? 0 : 0.5 * (values[n / 2] + values[(n - 1) / 2]);
}

static double mean_of(const double *x, int n)
{
    double mean, deviation;
    fit_spread(x, (size_t)n, &mean, &deviation);
    return mean;
}

enum dm2_status network_fit(const struct network_probe *probe, int servers, struct network_line *out,
                            struct dm2_error *err)
{
    const struct client_echo *e = &probe->echo;
    struct fit line;
    *out = (struct network_line){.servers = servers, .sizes = e->sizes, .turns = e->done};
    if (e->done == 0)
        return dm2_fail(err, DM2_NUMERIC, "no round trip was measured");
    for (int k = 0; k < e->sizes; k++) {
        out->bytes[k] = probe->bytes[k];
        out->seconds[k] = median_of(e, k);
    }
    enum dm2_status status = fit_line(out->bytes, out->seconds, (size_t)e->sizes, &line, err);
    if (status == DM2_OK && line.intercept < 0)
        status = fit_proportional(out->bytes, out->seconds, (size_t)e->sizes, &line, err);
    if (status != DM2_OK)
        return status;
    out->m = fmax(0, line.slope);
    out->b = line.slope < 0 ? mean_of(out->seconds, e->sizes) : line.intercept;
    out->residual = line.residual;
    return DM2_OK;
}
