/* What the model predicts for one problem and N servers: eqs. (18)-(20) where they apply, and their
 * generalisation to any N, any aspect ratio and the rectangles that the run really uses.
 *
 * The general form bisects the same cell grid as the client does (base/bisect), counts what each server's
 * rectangle exchanges at n/c elements per cell, and adds what the paper leaves out as options. With every
 * option at its zero it is eqs. (18)-(20) on the same geometry. Units as in equations.h. */
#ifndef DM2_PERFORMANCE_PREDICT_H
#define DM2_PERFORMANCE_PREDICT_H

#include <stdbool.h>

#include "dm2/base/bisect.h"
#include "dm2/performance/equations.h"

#define PREDICT_N_MOST      1e15
#define PREDICT_ASPECT_MOST 1e6

/* All zero: the paper's assumptions. */
struct predict_options {
    bool general; /* the general form for 2, 4 and 8 servers too */
    bool peer; /* servers exchange directly: half the communication (sections 7.3 and 8), no client's link */
    bool mirrored; /* counts the cells that a server mirrors, corners once; not the cells' edges as the paper
                      does */
    bool slowest;  /* the server with the most work, not the average one */
    bool overlap_inner; /* communication hides behind the computing of elements that need no mirrored ones */
    double overlap;     /* or behind this share of the computing, 0..1 */
    double migrants; /* elements that leave a server per step, as a share of those it exchanges, 0 or more */
    double migrant_bytes; /* that carry one; 0: g */
    double client_rate; /* bytes/s that pass through the client's link, both ways together; 0: no limit of its
                           own */
    bool periodic[2];   /* sides that meet each other */
};

/* The part of one server. */
struct predict_load {
    double share;     /* of the whole computation, 0..1 */
    double exchanged; /* elements that it sends (and receives) per step */
    double inner;     /* share of its own elements that touch no other server's cells, 0..1 */
};

struct prediction {
    double n, s;
    int servers;
    double p_x, p_y;   /* eqs. (14), (15), elements */
    double exchanged;  /* elements that the server sends per step */
    double t_seq;      /* s */
    double t_comp;     /* computing of the server, s; T_seq/N unless `slowest` */
    double t_comm;     /* communication, hidden or not, s */
    double t_dist;     /* s */
    double speedup;    /* t_seq / t_dist */
    double efficiency; /* speedup / servers */
    bool general;      /* not by eqs. (18)-(20) themselves */
    bool measured; /* m_N and b_N are a row of the constants, not inferred from others; true for 1 server */
    bool client_bound; /* the client's link is what takes the time */
};

/* The prediction; for one server T_dist = T_seq: there is nothing to communicate. DM2_USAGE: constants that
 * perf_check refuses; n outside 1..PREDICT_N_MOST or not finite; s not above 0, or outside
 * 1/PREDICT_ASPECT_MOST..PREDICT_ASPECT_MOST; servers below 1 or above the cells of the grid; an option out
 * of its range; a result that is not finite. DM2_MEMORY. */
enum dm2_status predict(const struct perf *p, double n, double s, int servers,
                        const struct predict_options *o, struct prediction *out, struct dm2_error *err);

/* The grid on which the general form counts: eq. (8) rounded to whole cells, at least one each way. False
 * where a side would have more than 2^30. */
bool predict_grid(const struct perf *p, double n, double s, int *cx, int *cy);

/* The load of a rectangle of a cx x cy grid with `per_cell` elements in each cell. Only the options
 * `mirrored` and `periodic` matter. */
struct predict_load predict_rect_load(const struct cell_rect *r, int cx, int cy, double per_cell,
                                      const struct predict_options *o);

/* The times from loads that the caller counted, in a finished run for instance: out->t_seq and out->servers
 * are read, the fields from `exchanged` on written, `t_seq` kept. Errors as above. */
enum dm2_status predict_from_loads(const struct perf *p, const struct predict_load *loads,
                                   const struct predict_options *o, struct prediction *out,
                                   struct dm2_error *err);

/* The smallest whole n at which `servers` (2 or more) take less time than one: *n, or 0 where none up to
 * PREDICT_N_MOST does. The general form moves in steps of whole cells, so that slightly above *n it may lose
 * once more. */
enum dm2_status predict_break_even(const struct perf *p, double s, int servers,
                                   const struct predict_options *o, double *n, struct dm2_error *err);

/* The number of servers, from 1 to `most` and to the number of cells, with the smallest T_dist; the fewest
 * where several are as fast. */
enum dm2_status predict_best(const struct perf *p, double n, double s, int most,
                             const struct predict_options *o, struct prediction *out, struct dm2_error *err);

#endif
