/* The paper's performance model (section 6), equation by equation, in the paper's symbols.
 * docs/performance-model.md has the equations in plain text and lists those that the scanned paper shows
 * wrongly.
 *
 * Units: cm, bytes, seconds; n, p_x and p_y count elements ("particles" in the paper). All times are per time
 * step. Times are in seconds also where the paper has milliseconds (eq. 13). The functions are plain
 * arithmetic; the constants must have passed perf_check, and n >= 1, s > 0. */
#ifndef DM2_PERFORMANCE_EQUATIONS_H
#define DM2_PERFORMANCE_EQUATIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"

/* The cost of a round trip of x bytes between one client and each of `servers` servers at once: m x + b, eqs.
 * (2)-(4). */
struct perf_network {
    int servers; /* N */
    double m;    /* m_N, s per byte */
    double b;    /* b_N, s */
};

enum { PERF_NETWORK_MAX = 32, PERF_SIZE_MAX = 32 };

/* k for n elements on one processor. k depends on n through the caches, which eq. (11) leaves out. */
struct perf_size {
    double n;
    double alone;  /* while the machine's other processors are idle, s */
    double shared; /* while all processors compute the same, s */
};

/* The constants of the model. */
struct perf {
    double d_x, d_y; /* distance of neighbouring elements, cm */
    double l_x, l_y; /* L_x, L_y: edges of a cell, cm */
    double k;        /* constant of processor and compiler: T_seq = k n^2/c, s */
    double g;        /* bytes that carry an element */
    struct perf_network network[PERF_NETWORK_MAX]; /* in the order of `servers` */
    size_t n_network;
    struct perf_size size[PERF_SIZE_MAX]; /* in the order of n; without sizes k holds at every n */
    size_t n_size;
};

/* The paper's constants: Ultra-10 workstations on 10BaseT. d_x = 0.04, d_y = 0.03464, L_x = L_y = 0.121, g =
 * 88, eqs. (2)-(4), and the k that eq. (13) gives with them: 3.138e-5 s. */
struct perf perf_paper(void);

/* Checks the constants. DM2_USAGE, with the name of the constant: a constant that is not finite, or not above
 * 0 (m and b: below 0), or outside 1e-30..1e30; no network row, more than one for a number of servers, rows
 * out of order; sizes out of order. */
enum dm2_status perf_check(const struct perf *p, struct dm2_error *err);

/* Sets m (is_b: b) of the row for `servers` servers, which is added if missing. The other value of a new row
 * is NaN, which perf_check refuses. DM2_USAGE: servers outside 1..65535 or too many rows. */
enum dm2_status perf_set_network(struct perf *p, int servers, bool is_b, double value, struct dm2_error *err);

/* The constants for processors `processors` times as fast and a network `network` times as fast: k is divided
 * by `processors`, every m and b by `network`. */
struct perf perf_faster(const struct perf *p, double processors, double network);

/* m_N and b_N for any N, by the rows of the network. N with a row: the numbers of the row. N between two
 * rows: linear in N. N above the last row: both grow with N, as on a link that all servers share. N below the
 * first row: m is proportional to N, b is that of the row. True if N has a row, so that m_N and b_N are
 * measured, not inferred. */
bool perf_network(const struct perf *p, int servers, double *m, double *b);

/* k for n elements on each of `busy` of `processors` processors that share caches and memory. k is linear in
 * log n between two sizes, constant below the first and above the last size, and linear in the number of busy
 * processors between one and all. Without sizes the result is p->k. */
double perf_k_at(const struct perf *p, double n, int busy, int processors);

/* Eq. (7), from the conditions (5) and (6): n_x n_y = n and d_x n_x / (d_y n_y) = s. */
double perf_n_x(const struct perf *p, double n, double s); /* columns: sqrt(s d_y/d_x) sqrt(n) */
double perf_n_y(const struct perf *p, double n, double s); /* rows: sqrt(n) / sqrt(s d_y/d_x) */

double perf_width(const struct perf *p, double n, double s);  /* eq. (6): w = d_x n_x, cm */
double perf_height(const struct perf *p, double n, double s); /* eq. (6): h = d_y n_y, cm */

/* Eqs. (8), (9): numbers of cells, not rounded. c does not depend on s. */
double perf_c_x(const struct perf *p, double n, double s); /* w/L_x */
double perf_c_y(const struct perf *p, double n, double s); /* h/L_y */
double perf_c(const struct perf *p, double n);             /* c_x c_y */

/* Eq. (10): the number of pairs examined, c (9 n/c)^2. The factor 81 is part of k from eq. (11) on. */
double perf_pairs(double n, double c);

double perf_t_seq_cells(const struct perf *p, double n, double c); /* eq. (11): k n^2/c, s */
double perf_t_seq(const struct perf *p, double n);                 /* eq. (12): k (L_x L_y)/(d_x d_y) n, s */

/* The k for which eq. (12) gives `per_element` seconds for each element, as eq. (13) determines k. */
double perf_k(const struct perf *p, double per_element);

double perf_p_x(const struct perf *p, double n, double s); /* eq. (14): elements in a row of cells, c_x n/c */
double perf_p_y(const struct perf *p, double n,
                double s); /* eq. (15): elements in a column of cells, c_y n/c */

double perf_t_comm_bytes(double m, double b, double bytes);                    /* eq. (16), s */
double perf_t_comm(const struct perf *p, double m, double b, double elements); /* eq. (17), s */

/* The number of elements that a server sends, on average, in eqs. (18) to (20) for 2, 4 and 8 servers: p_y;
 * min(3 p_y/2, (p_x + p_y)/2); min(7 p_y/4, (3 p_y + p_x)/4). For s < 1, which the paper leaves out, p_x and
 * p_y are exchanged. `servers` must satisfy perf_is_special (asserted). */
double perf_interface(const struct perf *p, double n, double s, int servers);
bool perf_is_special(int servers); /* 2, 4 or 8 */

/* Eqs. (18) to (20): T_seq/N + m_N g perf_interface + 2 b_N, s. */
double perf_t_dist(const struct perf *p, double n, double s, int servers);

#endif
