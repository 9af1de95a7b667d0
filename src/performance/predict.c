/* The general form of eqs. (18)-(20).
 *
 *     x      = g exchanged + migrant_bytes migrants exchanged        bytes of one server, one way
 *     t_comm = max(m_N x, client's bytes / client_rate) + 2 b_N      halved for direct exchange
 *     t_dist = t_comp + max(0, t_comm - overlap t_comp)
 *
 * The times are those of the average server, as in the paper, or of the server with the largest t_dist. The
 * counts of the paper are edges of cells: eq. (19) with s < 2, (p_x + p_y)/2, is one full column and one full
 * row of cells, both sides of each, divided by four servers. Therefore a rectangle exchanges one cell for
 * each edge of a cell that it shares with another rectangle. In a run a rectangle mirrors the cells beyond
 * its corners as well; `mirrored` counts these. Because the rectangles cover the grid without gaps, both
 * counts follow from the position of the rectangle, and no cell is visited. */
#include "dm2/performance/predict.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"

enum { SIDE_CELLS_MOST = 1 << 30 };

static enum dm2_status check_share(const char *what, double x, double most, struct dm2_error *err)
{
    if (x >= 0 && x <= most)
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "%s = %g: a number from 0 to %g is expected", what, x, most);
}

static enum dm2_status check_options(const struct predict_options *o, struct dm2_error *err)
{
    enum dm2_status status = check_share("the overlapping share of the computation", o->overlap, 1, err);
    if (status == DM2_OK)
        status = check_share("the share of migrating elements", o->migrants, 1e6, err);
    if (status == DM2_OK)
        status = check_share("the bytes of a migrating element", o->migrant_bytes, 1e9, err);
    if (status == DM2_OK)
        status = check_share("the bytes per second through the client", o->client_rate, 1e30, err);
    return status;
}

static enum dm2_status check_aspect(double s, struct dm2_error *err)
{
    if (s >= 1 / PREDICT_ASPECT_MOST && s <= PREDICT_ASPECT_MOST)
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE,
                    "aspect ratio %g: width divided by height is expected, above 0 (%g to %g)", s,
                    1 / PREDICT_ASPECT_MOST, PREDICT_ASPECT_MOST);
}

static enum dm2_status check_problem(const struct perf *p, double n, double s,
                                     const struct predict_options *o, struct dm2_error *err)
{
    enum dm2_status status = perf_check(p, err);
    if (status == DM2_OK)
        status = check_options(o, err);
    if (status == DM2_OK)
        status = check_aspect(s, err);
    if (status == DM2_OK && !(n >= 1 && n <= PREDICT_N_MOST))
        status = dm2_fail(err, DM2_USAGE, "n = %g elements: 1 to %g can be predicted for", n, PREDICT_N_MOST);
    return status;
}

bool predict_grid(const struct perf *p, double n, double s, int *cx, int *cy)
{
    double x = fmax(1, rint(perf_c_x(p, n, s))), y = fmax(1, rint(perf_c_y(p, n, s)));
    if (!(x <= SIDE_CELLS_MOST && y <= SIDE_CELLS_MOST))
        return false;
    *cx = (int)x;
    *cy = (int)y;
    return true;
}

/* A rectangle in one direction: cells from..to of `cells`. */
struct extent {
    double length;   /* number of cells */
    double ends;     /* number of ends that meet other servers: 0, 1, 2 */
    double mirrored; /* cells along, with those beyond the ends */
};

static struct extent extent_of(int from, int to, int cells, bool periodic)
{
    struct extent e = {.length = to - from};
    if (periodic)
        e.ends = to - from < cells ? 2 : 0;
    else
        e.ends = (from > 0 ? 1 : 0) + (to < cells ? 1 : 0);
    e.mirrored = fmin(e.length + e.ends, cells);
    return e;
}

struct predict_load predict_rect_load(const struct cell_rect *r, int cx, int cy, double per_cell,
                                      const struct predict_options *o)
{
    struct extent x = extent_of(r->x0, r->x1, cx, o->periodic[0]);
    struct extent y = extent_of(r->y0, r->y1, cy, o->periodic[1]);
    double area = x.length * y.length;
    double edges = x.ends * y.length + y.ends * x.length;
    double mirrored = x.mirrored * y.mirrored - area;
    double inner = fmax(0, x.length - x.ends) * fmax(0, y.length - y.ends);
    return (struct predict_load){
        .share = area / ((double)cx * cy),
        .exchanged = (o->mirrored ? mirrored : edges) * per_cell,
        .inner = inner / area,
    };
}

/* The load of the average server with equal shares, which is the perfect balance of the paper. */
static struct predict_load mean_load(const struct predict_load *loads, int servers)
{
    struct predict_load mean = {.share = 1.0 / servers};
    for (int k = 0; k < servers; k++) {
        mean.exchanged += loads[k].exchanged;
        mean.inner += loads[k].inner * loads[k].share; /* weighted by elements */
    }
    mean.exchanged /= servers;
    return mean;
}

/* The time in s that the client's link is busy in a step, because the bytes of every server come in and go
 * out. */
static double client_time(const struct perf *p, double exchanged, int servers,
                          const struct predict_options *o)
{
    if (o->client_rate == 0 || o->peer)
        return 0;
    double migrant = o->migrant_bytes > 0 ? o->migrant_bytes : p->g;
    return 2 * servers * exchanged * (p->g + o->migrants * migrant) / o->client_rate;
}

static void time_load(const struct perf *p, const struct predict_load *load, double t_client,
                      const struct predict_options *o, struct prediction *out)
{
    double m, b, migrant = o->migrant_bytes > 0 ? o->migrant_bytes : p->g;
    out->measured = perf_network(p, out->servers, &m, &b);
    double own = m * (load->exchanged * p->g + o->migrants * load->exchanged * migrant);
    out->exchanged = load->exchanged;
    out->client_bound = t_client > own;
    out->t_comm = fmax(own, t_client) + 2 * b;
    if (o->peer)
        out->t_comm /= 2;
    out->t_comp = out->t_seq * load->share;
    double overlap = o->overlap_inner ? load->inner : o->overlap;
    out->t_dist = out->t_comp + fmax(0, out->t_comm - overlap * out->t_comp);
}

static enum dm2_status finish_prediction(struct prediction *out, struct dm2_error *err)
{
    out->speedup = out->t_seq / out->t_dist;
    out->efficiency = out->speedup / out->servers;
    if (isfinite(out->t_dist) && isfinite(out->p_x) && isfinite(out->p_y) && isfinite(out->speedup))
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE,
                    "the constants are so large or small that the predicted times are no numbers");
}

enum dm2_status predict_from_loads(const struct perf *p, const struct predict_load *loads,
                                   const struct predict_options *o, struct prediction *out,
                                   struct dm2_error *err)
{
    enum dm2_status status = perf_check(p, err);
    if (status == DM2_OK)
        status = check_options(o, err);
    if (status != DM2_OK)
        return status;
    struct predict_load mean = mean_load(loads, out->servers);
    double t_client = client_time(p, mean.exchanged, out->servers, o);
    out->general = true;
    time_load(p, &mean, t_client, o, out);
    for (int k = 0; o->slowest && k < out->servers; k++) {
        struct prediction one = *out;
        time_load(p, &loads[k], t_client, o, &one);
        if (k == 0 || one.t_dist > out->t_dist)
            *out = one;
    }
    return finish_prediction(out, err);
}

static enum dm2_status predict_general(const struct perf *p, int cx, int cy, const struct predict_options *o,
                                       struct prediction *out, struct dm2_error *err)
{
    size_t servers = (size_t)out->servers;
    struct cell_rect *rects = mem_zalloc(servers, sizeof *rects);
    struct predict_load *loads = mem_zalloc(servers, sizeof *loads);
    enum dm2_status status = DM2_OK;
    if (rects == NULL || loads == NULL) {
        status = dm2_fail(err, DM2_MEMORY, "no memory to predict for %d servers", out->servers);
    } else {
        /* The cells divide the domain evenly, so that their edges are lx and ly, not L_x and L_y. */
        double lx = perf_width(p, out->n, out->s) / cx, ly = perf_height(p, out->n, out->s) / cy;
        double per_cell = out->n / ((double)cx * cy);
        bisect_grid(cx, cy, lx, ly, out->servers, NULL, rects);
        for (size_t k = 0; k < servers; k++)
            loads[k] = predict_rect_load(&rects[k], cx, cy, per_cell, o);
        status = predict_from_loads(p, loads, o, out, err);
    }
    free(rects);
    free(loads);
    return status;
}

/* True if no option needs the general form. `peer` does not, because half the communication is part of the
 * paper (section 7.3). */
static bool is_plain(const struct predict_options *o)
{
    return !o->general && !o->mirrored && !o->slowest && !o->overlap_inner && o->overlap == 0 &&
           o->migrants == 0 && o->client_rate == 0 && !o->periodic[0] && !o->periodic[1];
}

static void predict_special(const struct perf *p, bool peer, struct prediction *out)
{
    double m, b;
    out->measured = perf_network(p, out->servers, &m, &b);
    out->exchanged = perf_interface(p, out->n, out->s, out->servers);
    out->t_comp = out->t_seq / out->servers;
    out->t_comm = perf_t_comm(p, m, b, out->exchanged) + b;
    if (peer)
        out->t_comm /= 2;
    out->t_dist = out->t_comp + out->t_comm;
}

enum dm2_status predict(const struct perf *p, double n, double s, int servers,
                        const struct predict_options *o, struct prediction *out, struct dm2_error *err)
{
    int cx = 0, cy = 0;
    *out = (struct prediction){.n = n, .s = s, .servers = servers};
    enum dm2_status status = check_problem(p, n, s, o, err);
    if (status == DM2_OK && !predict_grid(p, n, s, &cx, &cy))
        status =
            dm2_fail(err, DM2_USAGE,
                     "the grid for n = %g at aspect ratio %g has more than 2^30 cells along a side", n, s);
    if (status == DM2_OK)
        status = bisect_check(cx, cy, servers, err);
    if (status != DM2_OK)
        return status;
    out->p_x = perf_p_x(p, n, s);
    out->p_y = perf_p_y(p, n, s);
    out->t_seq = perf_t_seq(p, n);
    if (servers > 1 && !(perf_is_special(servers) && is_plain(o)))
        return predict_general(p, cx, cy, o, out, err);
    if (servers > 1) {
        predict_special(p, o->peer, out);
    } else {
        out->t_comp = out->t_dist = out->t_seq;
        out->measured = true;
    }
    return finish_prediction(out, err);
}

/* Sets *beats if `servers` are faster than one server at this n; false where the grid has fewer cells than
 * servers or too many cells. */
static enum dm2_status beats_one(const struct perf *p, double n, double s, int servers,
                                 const struct predict_options *o, bool *beats, struct dm2_error *err)
{
    int cx, cy;
    struct prediction at;
    *beats = false;
    if (!predict_grid(p, n, s, &cx, &cy) || (double)cx * cy < servers)
        return DM2_OK;
    enum dm2_status status = predict(p, n, s, servers, o, &at, err);
    *beats = status == DM2_OK && at.t_dist < at.t_seq;
    return status;
}

enum dm2_status predict_break_even(const struct perf *p, double s, int servers,
                                   const struct predict_options *o, double *n, struct dm2_error *err)
{
    bool beats = false;
    *n = 0;
    enum dm2_status status = check_problem(p, 1, s, o, err);
    if (status == DM2_OK && (servers < 2 || servers > BISECT_PARTS_MAX))
        status = dm2_fail(err, DM2_USAGE, "%d servers: from 2 to %d can be compared with one", servers,
                          BISECT_PARTS_MAX);
    double loses = 0, wins = 1;
    while (status == DM2_OK && wins <= PREDICT_N_MOST) {
        status = beats_one(p, wins, s, servers, o, &beats, err);
        if (beats)
            break;
        loses = wins;
        wins *= 2;
    }
    if (status != DM2_OK || !beats)
        return status;
    while (status == DM2_OK && wins - loses > 1) {
        double middle = floor((loses + wins) / 2);
        status = beats_one(p, middle, s, servers, o, &beats, err);
        *(beats ? &wins : &loses) = middle;
    }
    if (status == DM2_OK)
        *n = wins;
    return status;
}

enum dm2_status predict_best(const struct perf *p, double n, double s, int most,
                             const struct predict_options *o, struct prediction *out, struct dm2_error *err)
{
    enum dm2_status status = predict(p, n, s, 1, o, out, err);
    int cx, cy;
    if (status != DM2_OK || !predict_grid(p, n, s, &cx, &cy))
        return status;
    for (int servers = 2; servers <= most && (double)servers <= (double)cx * cy; servers++) {
        struct prediction one;
        status = predict(p, n, s, servers, o, &one, err);
        if (status != DM2_OK)
            return status;
        if (one.t_dist < out->t_dist)
            *out = one;
    }
    return status;
}
