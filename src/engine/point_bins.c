/* A linked list of points per bin. */
#include "point_bins.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"

int point_bins_start(struct point_bins *b, const double low[2], const double high[2], double edge,
                     size_t points)
{
    *b = (struct point_bins){.low = {low[0], low[1]}};
    double area = (high[0] - low[0]) * (high[1] - low[1]), least = sqrt(area / (4.0 * (double)points + 16.0));
    b->edge = edge > least ? edge : least;
    for (int a = 0; a < 2; a++) {
        b->n[a] = (int64_t)floor((high[a] - low[a]) / b->edge);
        b->n[a] = b->n[a] > 0 ? b->n[a] : 1;
    }
    b->head = mem_alloc((size_t)(b->n[0] * b->n[1]), sizeof *b->head);
    b->next = mem_alloc(points, sizeof *b->next);
    if (b->head == NULL || b->next == NULL)
        return -1;
    for (int64_t i = 0; i < b->n[0] * b->n[1]; i++)
        b->head[i] = -1;
    return 0;
}

void point_bins_free(struct point_bins *b)
{
    free(b->head);
    free(b->next);
    *b = (struct point_bins){0};
}

int64_t point_bins_index(const struct point_bins *b, int a, double x)
{
    double i = floor((x - b->low[a]) / b->edge);
    return !(i > 0.0) ? 0 : i >= (double)b->n[a] ? b->n[a] - 1 : (int64_t)i;
}

void point_bins_add(struct point_bins *b, int64_t point, const double x[2])
{
    int64_t bin = point_bins_index(b, 1, x[1]) * b->n[0] + point_bins_index(b, 0, x[0]);
    b->next[point] = b->head[bin];
    b->head[bin] = point;
}

void point_bins_clear(struct point_bins *b)
{
    for (int64_t i = 0; i < b->n[0] * b->n[1]; i++)
        b->head[i] = -1;
}
