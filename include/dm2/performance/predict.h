/* Prediction of the performance model for one problem and N servers: eqs. (18)-(20) where they apply, and
 * their general form for any N, any aspect ratio and the rectangles of the real decomposition.
 *
 * The general form bisects the same cell grid as the client (base/bisect), counts the cells that each
 * rectangle exchanges with n/c elements in each cell, and has options for effects that the paper leaves out.
 * With every option at zero the general form is eqs. (18)-(20) on the same geometry. Units as in
 * equations.h. */
#ifndef DM2_PERFORMANCE_PREDICT_H
#define DM2_PERFORMANCE_PREDICT_H

#include <stdbool.h>

#include "dm2/base/bisect.h"
#include "dm2/performance/equations.h"

#define PREDICT_N_MOST      1e15
#define PREDICT_ASPECT_MOST 1e6

/* All zero: the assumptions of the paper. */
struct predict_options {
    bool general;  /* use the general form for 2, 4 and 8 servers too */
    bool peer;     /* servers exchange directly: half the communication (sections 7.3 and 8), no limit of the
                      client's link */
    bool mirrored; /* count the mirrored cells, corners once; the paper counts edges of cells */
    bool slowest;  /* the times of the slowest server instead of the average one */
    bool overlap_inner; /* communication overlaps with the computing of elements that need no mirrored ones */
    double overlap;     /* or with this share of the computing, 0..1 */
    double migrants; /* elements that leave a server in a step, as a share of those it exchanges, 0 or more */
    double migrant_bytes; /* bytes of one migrating element; 0: g */
    double client_rate;   /* bytes/s through the client's link, both ways together; 0: no limit of its own */
    bool periodic[2];     /* periodic sides in x, in y */
};

/* The load of one server. */
struct predict_load {
    double share;     /* share of the whole computation, 0..1 */
    double exchanged; /* elements that the server sends (and receives) per step */
    double inner;     /* share of the server's elements that touch no other server's cells, 0..1 */
};

struct prediction {
    double n, s;
    int servers;
    double p_x, p_y;   /* eqs. (14), (15), elements */
    double exchanged;  /* elements that the server sends per step */
    double t_seq;      /* s */
    double t_comp;     /* computing of the server, s; T_seq/N without the option `slowest` */
    double t_comm;     /* communication, whether overlapped or not, s */
    double t_dist;     /* s */
    double speedup;    /* t_seq / t_dist */
    double efficiency; /* speedup / servers */
    bool general;      /* by the general form, not by eqs. (18)-(20) themselves */
    bool measured; /* m_N and b_N are a row of the constants, not inferred from others; true for 1 server */
    bool client_bound; /* the client's link limits the communication */
};

/* The prediction for n elements, aspect ratio s and `servers`. One server: T_dist = T_seq, because there is
 * no communication. DM2_USAGE: constants that perf_check refuses; n outside 1..PREDICT_N_MOST or not finite;
 * s not above 0, or outside 1/PREDICT_ASPECT_MOST..PREDICT_ASPECT_MOST; servers below 1 or above the cells of
 * the grid; an option out of its range; a result that is not finite. DM2_MEMORY. */
enum dm2_status predict(const struct perf *p, double n, double s, int servers,
                        const struct predict_options *o, struct prediction *out, struct dm2_error *err);

/* The cell grid of the general form: eqs. (8), (9) rounded to whole cells, at least one each way. False where
 * a side would have more than 2^30 cells. */
bool predict_grid(const struct perf *p, double n, double s, int *cx, int *cy);

/* The load of a rectangle of a cx x cy grid with `per_cell` elements in each cell. Of the options only
 * `mirrored` and `periodic` matter. */
struct predict_load predict_rect_load(const struct cell_rect *r, int cx, int cy, double per_cell,
                                      const struct predict_options *o);

/* The times from loads of out->servers servers that the caller counted, in a finished run for instance.
 * out->t_seq and out->servers are read and kept; the other fields from `exchanged` on are written. Errors as
 * above. */
enum dm2_status predict_from_loads(const struct perf *p, const struct predict_load *loads,
                                   const struct predict_options *o, struct prediction *out,
                                   struct dm2_error *err);

/* The smallest whole n at which `servers` (2 or more) are faster than one server: *n, or 0 where there is
 * none up to PREDICT_N_MOST. The general form changes in steps of whole cells, so that `servers` may be
 * slower again slightly above *n. Errors as above. */
enum dm2_status predict_break_even(const struct perf *p, double s, int servers,
                                   const struct predict_options *o, double *n, struct dm2_error *err);

/* The prediction for the number of servers, from 1 to `most` and to the number of cells, with the smallest
 * T_dist; for the fewest servers where several are as fast. Errors as above. */
enum dm2_status predict_best(const struct perf *p, double n, double s, int most,
                             const struct predict_options *o, struct prediction *out, struct dm2_error *err);

#endif
