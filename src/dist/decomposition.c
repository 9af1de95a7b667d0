/* Recursive bisection of the cell grid.
 *
 * bisect() holds a rectangle and the ranks first .. first+n-1 that share it, n at most its number of cells.
 * It picks the direction whose cut is shorter, the share of ranks (half and half where that can be), and the
 * column or row where the parts come closest to the shares; then each part does the same. Both parts always
 * keep at least one cell per rank, so the recursion cannot run dry: where no cut leaves room for the halves
 * (9 ranks on 3 x 3 cells), unequal shares are tried, nearest first; a cut after the first column always
 * exists.
 *
 * Boundaries are found by looking at the cells beyond the rectangle's rim through owner[], so that periodic
 * sides and sides that meet several ranks need no cases of their own. */
#include "dm2/dist/decomposition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

struct bisection {
    struct decomposition *d;
    const uint32_t *weights; /* per cell, or NULL: each counts 1 */
};

static size_t rect_cells(const struct cell_rect *r)
{
    return (size_t)(r->x1 - r->x0) * (size_t)(r->y1 - r->y0);
}

static uint64_t rect_weight(const struct decomposition *d, const uint32_t *weights, const struct cell_rect *r)
{
    if (weights == NULL)
        return rect_cells(r);
    uint64_t sum = 0;
    for (int j = r->y0; j < r->y1; j++)
        for (int i = r->x0; i < r->x1; i++)
            sum += weights[(size_t)j * (size_t)d->grid.cx + (size_t)i];
    return sum;
}

/* The two parts of r when it is cut `at` cells from its start along axis 0 (x) or 1 (y). */
static void cut_rect(const struct cell_rect *r, int axis, int at, struct cell_rect part[2])
{
    part[0] = part[1] = *r;
    if (axis == 0)
        part[0].x1 = part[1].x0 = r->x0 + at;
    else
        part[0].y1 = part[1].y0 = r->y0 + at;
}

/* The best cut along `axis` that gives `low` of `n` ranks the first part: its distance, or 0 where none
 * leaves every rank a cell. */
static int find_cut(const struct bisection *b, const struct cell_rect *r, int axis, int n, int low)
{
    int along = axis == 0 ? r->x1 - r->x0 : r->y1 - r->y0, best = 0;
    uint64_t total = rect_weight(b->d, b->weights, r), before = 0;
    double want = (double)total * low / n, best_miss = INFINITY;
    for (int at = 1; at < along; at++) {
        struct cell_rect part[2], strip[2];
        cut_rect(r, axis, at, part);
        cut_rect(&part[0], axis, at - 1, strip);
        before += rect_weight(b->d, b->weights, &strip[1]); /* the column or row that this cut adds */
        double miss = fabs((double)before - want);
        if (rect_cells(&part[0]) >= (size_t)low && rect_cells(&part[1]) >= (size_t)(n - low) &&
            miss < best_miss) {
            best_miss = miss;
            best = at;
        }
    }
    return best;
}

static void bisect(const struct bisection *b, struct cell_rect r, int first, int n)
{
    if (n == 1) {
        b->d->rect[first] = r;
        return;
    }
    double width = (r.x1 - r.x0) * b->d->grid.lx, height = (r.y1 - r.y0) * b->d->grid.ly;
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
    bisect(b, part[0], first, low);
    bisect(b, part[1], first + low, n - low);
}

static enum dm2_status allocate(const struct grid *grid, int ranks, struct decomposition *out,
                                struct dm2_error *err)
{
    *out = (struct decomposition){.grid = *grid, .ranks = ranks};
    out->rect = mem_zalloc((size_t)ranks, sizeof *out->rect);
    out->owner = mem_zalloc((size_t)grid->cx * (size_t)grid->cy, sizeof *out->owner);
    if (out->rect != NULL && out->owner != NULL)
        return DM2_OK;
    decomposition_free(out);
    return dm2_fail(err, DM2_MEMORY, "no memory for the decomposition of %d x %d cells", grid->cx, grid->cy);
}

static void fill_owner(struct decomposition *d, int rank)
{
    const struct cell_rect *r = &d->rect[rank];
    for (int j = r->y0; j < r->y1; j++)
        for (int i = r->x0; i < r->x1; i++)
            d->owner[(size_t)j * (size_t)d->grid.cx + (size_t)i] = (uint16_t)rank;
}

enum dm2_status decomposition_bisect(const struct grid *grid, int ranks, const uint32_t *weights,
                                     struct decomposition *out, struct dm2_error *err)
{
    *out = (struct decomposition){0};
    if (ranks < 1 || ranks > DECOMPOSITION_RANKS_MAX)
        return dm2_fail(err, DM2_USAGE, "%d servers: 1 to %d can be used", ranks, DECOMPOSITION_RANKS_MAX);
    size_t cells = (size_t)grid->cx * (size_t)grid->cy;
    if (cells < (size_t)ranks)
        return dm2_fail(err, DM2_USAGE,
                        "%d servers for a grid of %zu cells (%d x %d): each server needs at least one cell, "
                        "use %zu servers or fewer",
                        ranks, cells, grid->cx, grid->cy, cells);
    enum dm2_status status = allocate(grid, ranks, out, err);
    if (status != DM2_OK)
        return status;
    const struct bisection b = {.d = out, .weights = weights};
    bisect(&b, (struct cell_rect){.x0 = 0, .y0 = 0, .x1 = grid->cx, .y1 = grid->cy}, 0, ranks);
    for (int rank = 0; rank < ranks; rank++)
        fill_owner(out, rank);
    return DM2_OK;
}

enum dm2_status decomposition_from_rects(const struct grid *grid, int ranks, const struct cell_rect *rects,
                                         struct decomposition *out, struct dm2_error *err)
{
    *out = (struct decomposition){0};
    size_t cells = (size_t)grid->cx * (size_t)grid->cy, covered = 0;
    if (ranks < 1 || ranks > DECOMPOSITION_RANKS_MAX || (size_t)ranks > cells)
        return dm2_fail(err, DM2_PROTOCOL, "a decomposition into %d ranks of %zu cells", ranks, cells);
    for (int k = 0; k < ranks; k++) {
        const struct cell_rect *r = &rects[k];
        if (r->x0 < 0 || r->y0 < 0 || r->x1 > grid->cx || r->y1 > grid->cy || r->x0 >= r->x1 ||
            r->y0 >= r->y1)
            return dm2_fail(err, DM2_PROTOCOL,
                            "rank %d has the cells %d..%d x %d..%d, outside the grid of %d x %d", k, r->x0,
                            r->x1, r->y0, r->y1, grid->cx, grid->cy);
        covered += rect_cells(r);
    }
    enum dm2_status status = allocate(grid, ranks, out, err);
    if (status != DM2_OK)
        return status;
    memcpy(out->rect, rects, (size_t)ranks * sizeof *rects);
    for (int k = 0; k < ranks; k++)
        fill_owner(out, k);
    /* As many cells as there are, and no rectangle overwritten by a later one: each cell exactly once. */
    size_t kept = 0;
    for (int k = 0; k < ranks; k++)
        for (int j = rects[k].y0; j < rects[k].y1; j++)
            for (int i = rects[k].x0; i < rects[k].x1; i++)
                kept += out->owner[(size_t)j * (size_t)grid->cx + (size_t)i] == k;
    if (covered == cells && kept == cells)
        return DM2_OK;
    decomposition_free(out);
    return dm2_fail(err, DM2_PROTOCOL,
                    "the decomposition's rectangles do not cover each of the %zu cells exactly once", cells);
}

void decomposition_free(struct decomposition *d)
{
    free(d->rect);
    free(d->owner);
    *d = (struct decomposition){0};
}

/* The owner of cell (i, j), wrapped across periodic sides; -1 outside the grid. */
static int owner_at(const struct decomposition *d, int i, int j)
{
    const struct grid *g = &d->grid;
    if (g->periodic[0])
        i = (i + g->cx) % g->cx;
    if (g->periodic[1])
        j = (j + g->cy) % g->cy;
    return i < 0 || i >= g->cx || j < 0 || j >= g->cy ? -1 : d->owner[(size_t)j * (size_t)g->cx + (size_t)i];
}

/* The cells beyond one side or corner: `count` of them from (i, j) on, in steps of (di, dj). */
struct rim {
    int i, j, di, dj, count;
};

static struct rim rim_beyond(const struct cell_rect *r, enum side side)
{
    int w = r->x1 - r->x0, h = r->y1 - r->y0;
    switch (side) {
    case SIDE_WEST:
        return (struct rim){r->x0 - 1, r->y0, 0, 1, h};
    case SIDE_EAST:
        return (struct rim){r->x1, r->y0, 0, 1, h};
    case SIDE_SOUTH:
        return (struct rim){r->x0, r->y0 - 1, 1, 0, w};
    case SIDE_NORTH:
        return (struct rim){r->x0, r->y1, 1, 0, w};
    case CORNER_SOUTH_WEST:
        return (struct rim){r->x0 - 1, r->y0 - 1, 0, 0, 1};
    case CORNER_SOUTH_EAST:
        return (struct rim){r->x1, r->y0 - 1, 0, 0, 1};
    case CORNER_NORTH_WEST:
        return (struct rim){r->x0 - 1, r->y1, 0, 0, 1};
    case CORNER_NORTH_EAST:
        return (struct rim){r->x1, r->y1, 0, 0, 1};
    case SIDE_COUNT:
        break;
    }
    return (struct rim){0};
}

/* Distinct other ranks beyond a side. Along a straight side each rank's cells are consecutive, so counting
 * the changes counts the ranks. */
void decomposition_interfaces(const struct decomposition *d, int rank, int out[SIDE_COUNT])
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct rim rim = rim_beyond(&d->rect[rank], (enum side)side);
        int last = -1;
        out[side] = 0;
        for (int k = 0; k < rim.count; k++) {
            int owner = owner_at(d, rim.i + k * rim.di, rim.j + k * rim.dj);
            out[side] += owner >= 0 && owner != rank && owner != last;
            last = owner;
        }
    }
}

/* Does another rank own one of the eight cells around (i, j)? */
static int touches_other(const struct decomposition *d, int rank, int i, int j)
{
    for (int b = -1; b <= 1; b++)
        for (int a = -1; a <= 1; a++) {
            int owner = owner_at(d, i + a, j + b);
            if (owner >= 0 && owner != rank)
                return 1;
        }
    return 0;
}

/* Counts the cells beyond one side or corner that other ranks own. */
static void count_rim(const struct decomposition *d, int rank, int side, unsigned char *cell_seen,
                      unsigned char *rank_seen, struct rank_boundary *out)
{
    const struct grid *g = &d->grid;
    struct rim rim = rim_beyond(&d->rect[rank], (enum side)side);
    for (int k = 0; k < rim.count; k++) {
        int i = rim.i + k * rim.di, j = rim.j + k * rim.dj, owner = owner_at(d, i, j);
        if (owner < 0 || owner == rank)
            continue;
        if (side <= SIDE_NORTH) {
            out->interface_cells++;
            out->interface_cm += side <= SIDE_EAST ? g->ly : g->lx;
        }
        size_t at = (size_t)((j + g->cy) % g->cy) * (size_t)g->cx + (size_t)((i + g->cx) % g->cx);
        out->outer += cell_seen[at] == 0; /* on small periodic grids a cell may lie beyond two sides */
        out->neighbours += rank_seen[owner] == 0;
        cell_seen[at] = rank_seen[owner] = 1;
    }
}

enum dm2_status decomposition_boundary(const struct decomposition *d, int rank, struct rank_boundary *out,
                                       struct dm2_error *err)
{
    const struct cell_rect *r = &d->rect[rank];
    unsigned char *cell_seen = mem_zalloc((size_t)d->grid.cx * (size_t)d->grid.cy, 1);
    unsigned char *rank_seen = mem_zalloc((size_t)d->ranks, 1);
    enum dm2_status status = DM2_OK;
    *out = (struct rank_boundary){0};
    if (cell_seen == NULL || rank_seen == NULL) {
        status = dm2_fail(err, DM2_MEMORY, "no memory for the boundary of rank %d", rank);
    } else {
        for (int j = r->y0; j < r->y1; j++)
            for (int i = r->x0; i < r->x1; i++) {
                int rim = i == r->x0 || i == r->x1 - 1 || j == r->y0 || j == r->y1 - 1;
                out->inner += rim && touches_other(d, rank, i, j);
            }
        for (int side = 0; side < SIDE_COUNT; side++)
            count_rim(d, rank, side, cell_seen, rank_seen, out);
    }
    free(cell_seen);
    free(rank_seen);
    return status;
}

size_t decomposition_cells(const struct decomposition *d, int rank)
{
    return rect_cells(&d->rect[rank]);
}

uint64_t decomposition_weight(const struct decomposition *d, int rank, const uint32_t *weights)
{
    return rect_weight(d, weights, &d->rect[rank]);
}
