/* Points of a body sorted into square bins, so that the points near a place are found without going through
 * all. */
#ifndef DM2_ENGINE_POINT_BINS_H
#define DM2_ENGINE_POINT_BINS_H

#include <stddef.h>
#include <stdint.h>

struct point_bins {
    double low[2], edge;  /* corner of bin 0, edge of a bin, cm */
    int64_t n[2];         /* columns, rows */
    int64_t *head, *next; /* first point of each bin, point after each point; -1: none */
};

/* Empty bins of edge `edge` cm, or more where there would be many more bins than points, over the rectangle
 * low to high, with room for points 0 .. points-1. 0, or -1 without memory; free with point_bins_free in both
 * cases. */
int point_bins_start(struct point_bins *b, const double low[2], const double high[2], double edge,
                     size_t points);
void point_bins_free(struct point_bins *b);

/* The column (a = 0) or row (a = 1) of coordinate x, cm; points beyond the rectangle belong to its nearest
 * bin. */
int64_t point_bins_index(const struct point_bins *b, int a, double x);

/* Adds a point, at x in cm, to its bin. */
void point_bins_add(struct point_bins *b, int64_t point, const double x[2]);

/* Takes all points out. */
void point_bins_clear(struct point_bins *b);

#endif
