/* Recursive bisection of the cell grid.
 *
 * split() holds a rectangle and the parts first .. first+n-1 that share it, n at most its number of cells.
 * split() picks the direction with the shorter cut, the number of parts on each side (halves where possible),
 * and the column or row where the two sides come closest to these shares; then split() recurs into each side.
 * Both sides always keep at least one cell per part, so the recursion always ends with a cell for each part:
 * where no cut leaves room for the halves (9 parts on 3 x 3 cells), split() tries unequal shares, nearest
 * first; a cut after the first column always exists.
 *
 * Without weights the best cut is computed, not searched for, so that the cost does not depend on the grid's
 * size. */
#include "dm2/base/bisect.h"

#include <math.h>

struct bisection {
    int cx;
    double lx, ly;
    const uint32_t *weights; /* per cell; NULL: every cell has weight 1 */
    struct cell_rect *out;
};

size_t bisect_cells(const struct cell_rect *r)
{
    return (size_t)(r->x1 - r->x0) * (size_t)(r->y1 - r->y0);
}

uint64_t bisect_weight(int cx, const uint32_t *weights, const struct cell_rect *r)
{
    if (weights == NULL)
        return bisect_cells(r);
    uint64_t sum = 0;
    for (int j = r->y0; j < r->y1; j++)
        for (int i = r->x0; i < r->x1; i++)
            sum += weights[(size_t)j * (size_t)cx + (size_t)i];
    return sum;
}

/* The two sides of r when it is cut `at` cells from its start along axis 0 (x) or 1 (y). */
static void cut_rect(const struct cell_rect *r, int axis, int at, struct cell_rect part[2])
{
    part[0] = part[1] = *r;
    if (axis == 0)
        part[0].x1 = part[1].x0 = r->x0 + at;
    else
        part[0].y1 = part[1].y0 = r->y0 + at;
}

/* The distances of a cut along `axis` that leave a cell for each of `low` parts before the cut and n - low
 * behind. */
static void cut_range(const struct cell_rect *r, int axis, int n, int low, int *from, int *to)
{
    int along = axis == 0 ? r->x1 - r->x0 : r->y1 - r->y0, across = axis == 0 ? r->y1 - r->y0 : r->x1 - r->x0;
    *from = 1 + (low - 1) / across;
    *to = along - (1 + (n - low - 1) / across);
}

/* The first of the best cuts where all cells have the same weight. */
static int nearest_cut(int along, int n, int low, int from, int to)
{
    int at = (int)((int64_t)along * low / n); /* floor; the ideal distance is along * low / n */
    int64_t beyond = (int64_t)along * low % n;
    at += 2 * beyond > n ? 1 : 0;
    return at < from ? from : at > to ? to : at;
}

/* The distance of the best cut along `axis` with `low` of `n` parts on the first side; 0 where no cut leaves
 * a cell for every part. */
static int find_cut(const struct bisection *b, const struct cell_rect *r, int axis, int n, int low)
{
    int from, to, best = 0;
    cut_range(r, axis, n, low, &from, &to);
    if (from > to)
        return 0;
    if (b->weights == NULL)
        return nearest_cut(axis == 0 ? r->x1 - r->x0 : r->y1 - r->y0, n, low, from, to);
    uint64_t total = bisect_weight(b->cx, b->weights, r), before = 0;
    double want = (double)total * low / n, best_miss = INFINITY;
    for (int at = 1; at <= to; at++) {
        struct cell_rect part[2], strip[2];
        cut_rect(r, axis, at, part);
        cut_rect(&part[0], axis, at - 1, strip);
        before += bisect_weight(b->cx, b->weights, &strip[1]); /* the column or row that this cut adds */
        double miss = fabs((double)before - want);
        if (at >= from && miss < best_miss) {
            best_miss = miss;
            best = at;
        }
    }
    return best;
}

static void split(const struct bisection *b, struct cell_rect r, int first, int n)
{
    if (n == 1) {
        b->out[first] = r;
        return;
    }
    double width = (r.x1 - r.x0) * b->lx, height = (r.y1 - r.y0) * b->ly;
    int longer = width >= height ? 0 : 1, at = 0, low = n / 2, axis = longer;
    for (int away = 0; at == 0 && away < n; away++) {
        for (int k = 0; at == 0 && k < 4; k++) {
            axis = k < 2 ? longer : 1 - longer;
            low = k % 2 == 0 ? n / 2 - away : n / 2 + away;
            if (low >= 1 && low < n)
                at = find_cut(b, &r, axis, n, low);
        }
    }
    struct cell_rect part[2];
    cut_rect(&r, axis, at, part);
    split(b, part[0], first, low);
    split(b, part[1], first + low, n - low);
}

enum dm2_status bisect_check(int cx, int cy, int parts, struct dm2_error *err)
{
    if (parts < 1 || parts > BISECT_PARTS_MAX)
        return dm2_fail(err, DM2_USAGE, "%d servers: 1 to %d can be used", parts, BISECT_PARTS_MAX);
    size_t cells = (size_t)cx * (size_t)cy;
    if (cells < (size_t)parts)
        return dm2_fail(err, DM2_USAGE,
                        "%d servers for a grid of %zu cells (%d x %d): each server needs at least one cell, "
                        "use %zu servers or fewer",
                        parts, cells, cx, cy, cells);
    return DM2_OK;
}

void bisect_grid(int cx, int cy, double lx, double ly, int parts, const uint32_t *weights,
                 struct cell_rect *out)
{
    const struct bisection b = {.cx = cx, .lx = lx, .ly = ly, .weights = weights, .out = out};
    split(&b, (struct cell_rect){.x0 = 0, .y0 = 0, .x1 = cx, .y1 = cy}, 0, parts);
}
