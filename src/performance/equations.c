/* The equations of section 6 of the paper.
 *
 * The model has three parts. A domain of n elements with spacing d_x, d_y and aspect ratio s = w/h has c
 * cells with n/c elements each, and computing costs k n^2/c (eqs. 5-12). A server sends the elements of the
 * cells along its interfaces: some rows (p_x elements each) and some columns (p_y each) of cells (eqs. 14,
 * 15). Sending x bytes to each of N servers and back costs m_N x + b_N (eqs. 16, 17). A step costs this once
 * for the boundary, and another b_N for the migration (eqs. 18-20).
 *
 * The min() in eqs. (19) and (20) chooses between two ways to cut the domain. With L_x = L_y, so that p_x/p_y
 * = s, the choice changes at the aspect ratios 2 and 4 of section 6.2. */
#include "dm2/performance/equations.h"

#include <assert.h>
#include <math.h>

static const double PAPER_T_SEQ_PER_ELEMENT = 0.3316e-3; /* eq. (13), which is in ms */
static const double CONSTANT_LEAST = 1e-30, CONSTANT_MOST = 1e30;

struct perf perf_paper(void)
{
    struct perf p = {
        .d_x = 0.04,
        .d_y = 0.03464,
        .l_x = 0.121,
        .l_y = 0.121,
        .g = 88,
        .network = {{2, 3.6e-6, 3.3e-3}, {4, 7.3e-6, 4.1e-3}, {8, 14.6e-6, 25.8e-3}},
        .n_network = 3,
    };
    p.k = perf_k(&p, PAPER_T_SEQ_PER_ELEMENT);
    return p;
}

static enum dm2_status check_constant(const char *name, const char *unit, double x, bool zero_too,
                                      struct dm2_error *err)
{
    if (zero_too && x == 0)
        return DM2_OK;
    if (x >= CONSTANT_LEAST && x <= CONSTANT_MOST)
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "%s = %g %s: a number %s is expected, in the range %g to %g", name, x,
                    unit, zero_too ? "of at least 0" : "above 0", CONSTANT_LEAST, CONSTANT_MOST);
}

static enum dm2_status check_network(const struct perf_network *row, const struct perf_network *before,
                                     struct dm2_error *err)
{
    if (row->servers < 1 || (before != NULL && row->servers <= before->servers))
        return dm2_fail(err, DM2_USAGE, "the network's rows are not for rising numbers of servers, at %d",
                        row->servers);
    if (isnan(row->m) || isnan(row->b))
        return dm2_fail(err, DM2_USAGE, "the network of %d servers has %s but no %s: give both", row->servers,
                        isnan(row->m) ? "b" : "m", isnan(row->m) ? "m" : "b");
    enum dm2_status status = check_constant("m", "s/byte", row->m, true, err);
    return status != DM2_OK ? status : check_constant("b", "s", row->b, true, err);
}

static enum dm2_status check_size(const struct perf_size *row, const struct perf_size *before,
                                  struct dm2_error *err)
{
    if (!(row->n >= 1 && row->n <= CONSTANT_MOST) || (before != NULL && !(row->n > before->n)))
        return dm2_fail(err, DM2_USAGE, "the sizes at which k was measured do not rise, at %g elements",
                        row->n);
    enum dm2_status status = check_constant("k_alone", "s", row->alone, false, err);
    return status != DM2_OK ? status : check_constant("k_shared", "s", row->shared, false, err);
}

enum dm2_status perf_check(const struct perf *p, struct dm2_error *err)
{
    const struct {
        const char *name, *unit;
        double value;
    } constants[] = {{"d_x", "cm", p->d_x}, {"d_y", "cm", p->d_y}, {"L_x", "cm", p->l_x},
                     {"L_y", "cm", p->l_y}, {"k", "s", p->k},      {"g", "bytes", p->g}};
    for (size_t i = 0; i < sizeof constants / sizeof constants[0]; i++) {
        enum dm2_status status =
            check_constant(constants[i].name, constants[i].unit, constants[i].value, false, err);
        if (status != DM2_OK)
            return status;
    }
    if (p->n_network < 1)
        return dm2_fail(err, DM2_USAGE, "there is no m and b for any number of servers");
    for (size_t i = 0; i < p->n_network; i++) {
        enum dm2_status status = check_network(&p->network[i], i > 0 ? &p->network[i - 1] : NULL, err);
        if (status != DM2_OK)
            return status;
    }
    for (size_t i = 0; i < p->n_size; i++) {
        enum dm2_status status = check_size(&p->size[i], i > 0 ? &p->size[i - 1] : NULL, err);
        if (status != DM2_OK)
            return status;
    }
    return DM2_OK;
}

enum dm2_status perf_set_network(struct perf *p, int servers, bool is_b, double value, struct dm2_error *err)
{
    if (servers < 1 || servers > 65535)
        return dm2_fail(err, DM2_USAGE, "a network of %d servers: 1 to 65535 are expected", servers);
    size_t at = 0;
    while (at < p->n_network && p->network[at].servers < servers)
        at++;
    if (at == p->n_network || p->network[at].servers != servers) {
        if (p->n_network == PERF_NETWORK_MAX)
            return dm2_fail(err, DM2_USAGE, "m and b are given for more than %d numbers of servers",
                            PERF_NETWORK_MAX);
        for (size_t i = p->n_network++; i > at; i--)
            p->network[i] = p->network[i - 1];
        p->network[at] = (struct perf_network){.servers = servers, .m = NAN, .b = NAN};
    }
    *(is_b ? &p->network[at].b : &p->network[at].m) = value;
    return DM2_OK;
}

struct perf perf_faster(const struct perf *p, double processors, double network)
{
    struct perf faster = *p;
    faster.k /= processors;
    for (size_t i = 0; i < faster.n_size; i++) {
        faster.size[i].alone /= processors;
        faster.size[i].shared /= processors;
    }
    for (size_t i = 0; i < faster.n_network; i++) {
        faster.network[i].m /= network;
        faster.network[i].b /= network;
    }
    return faster;
}

bool perf_network(const struct perf *p, int servers, double *m, double *b)
{
    const struct perf_network *row = p->network;
    size_t at = 0;
    while (at + 1 < p->n_network && row[at + 1].servers <= servers)
        at++;
    double ratio = (double)servers / row[at].servers;
    *m = row[at].m;
    *b = row[at].b;
    if (row[at].servers == servers)
        return true;
    if (servers < row[at].servers) { /* below the first row */
        *m *= ratio;
    } else if (at + 1 == p->n_network) { /* above the last row */
        *m *= ratio;
        *b *= ratio;
    } else {
        double along = (double)(servers - row[at].servers) / (row[at + 1].servers - row[at].servers);
        *m += along * (row[at + 1].m - row[at].m);
        *b += along * (row[at + 1].b - row[at].b);
    }
    return false;
}

double perf_k_at(const struct perf *p, double n, int busy, int processors)
{
    const struct perf_size *row = p->size;
    if (p->n_size == 0)
        return p->k;
    size_t at = 0;
    while (at + 1 < p->n_size && row[at + 1].n <= n)
        at++;
    double alone = row[at].alone, shared = row[at].shared;
    if (at + 1 < p->n_size && n > row[at].n) {
        double part = log(n / row[at].n) / log(row[at + 1].n / row[at].n);
        alone += part * (row[at + 1].alone - alone);
        shared += part * (row[at + 1].shared - shared);
    }
    double crowd = processors > 1 ? fmin(1, (busy - 1.0) / (processors - 1)) : 0;
    return alone + fmax(0, crowd) * (shared - alone);
}

double perf_n_x(const struct perf *p, double n, double s)
{
    return sqrt(s * p->d_y / p->d_x) * sqrt(n);
}

double perf_n_y(const struct perf *p, double n, double s)
{
    return sqrt(n) / sqrt(s * p->d_y / p->d_x);
}

double perf_width(const struct perf *p, double n, double s)
{
    return p->d_x * perf_n_x(p, n, s);
}

double perf_height(const struct perf *p, double n, double s)
{
    return p->d_y * perf_n_y(p, n, s);
}

double perf_c_x(const struct perf *p, double n, double s)
{
    return perf_width(p, n, s) / p->l_x;
}

double perf_c_y(const struct perf *p, double n, double s)
{
    return perf_height(p, n, s) / p->l_y;
}

double perf_c(const struct perf *p, double n)
{
    return p->d_x * p->d_y * n / (p->l_x * p->l_y);
}

double perf_pairs(double n, double c)
{
    double window = 9 * n / c;
    return c * window * window;
}

double perf_t_seq_cells(const struct perf *p, double n, double c)
{
    return p->k * n * n / c;
}

double perf_t_seq(const struct perf *p, double n)
{
    return p->k * (p->l_x * p->l_y) / (p->d_x * p->d_y) * n;
}

double perf_k(const struct perf *p, double per_element)
{
    return per_element * (p->d_x * p->d_y) / (p->l_x * p->l_y);
}

double perf_p_x(const struct perf *p, double n, double s)
{
    return p->l_y * sqrt(s / (p->d_x * p->d_y)) * sqrt(n);
}

double perf_p_y(const struct perf *p, double n, double s)
{
    return p->l_x * sqrt(1 / (s * p->d_x * p->d_y)) * sqrt(n);
}

double perf_t_comm_bytes(double m, double b, double bytes)
{
    return m * bytes + b;
}

double perf_t_comm(const struct perf *p, double m, double b, double elements)
{
    return perf_t_comm_bytes(m, b, elements * p->g);
}

bool perf_is_special(int servers)
{
    return servers == 2 || servers == 4 || servers == 8;
}

double perf_interface(const struct perf *p, double n, double s, int servers)
{
    bool wide = s >= 1;
    double p_x = wide ? perf_p_x(p, n, s) : perf_p_y(p, n, s);
    double p_y = wide ? perf_p_y(p, n, s) : perf_p_x(p, n, s);
    assert(perf_is_special(servers));
    if (servers == 2)
        return p_y;
    if (servers == 4)
        return fmin(3 * p_y / 2, (p_x + p_y) / 2);
    return fmin(7 * p_y / 4, (3 * p_y + p_x) / 4);
}

double perf_t_dist(const struct perf *p, double n, double s, int servers)
{
    double m, b;
    (void)perf_network(p, servers, &m, &b);
    return perf_t_seq(p, n) / servers + perf_t_comm(p, m, b, perf_interface(p, n, s, servers)) + b;
}
