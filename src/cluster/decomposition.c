/* The assignment of cells to ranks: the rectangles of base/bisect, and the owner of every cell.
 *
 * The boundary of a rank is read from owner[] of the cells beyond its rectangle, so that periodic sides and
 * sides that meet several ranks need no cases of their own. */
#include "dm2/cluster/decomposition.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

static enum dm2_status allocate_arrays(const struct grid *grid, int ranks, struct decomposition *out,
                                       struct dm2_error *err)
{
    *out = (struct decomposition){.grid = *grid, .ranks = ranks};
    double cells = (double)grid->cx * grid->cy;
    enum dm2_status status = grid_check_memory(grid, cells * sizeof *out->owner, err);
    if (status != DM2_OK)
        return status;
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
    enum dm2_status status = bisect_check(grid->cx, grid->cy, ranks, err);
    if (status == DM2_OK)
        status = allocate_arrays(grid, ranks, out, err);
    if (status != DM2_OK)
        return status;
    bisect_grid(grid->cx, grid->cy, grid->lx, grid->ly, ranks, weights, out->rect);
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
        covered += bisect_cells(r);
    }
    enum dm2_status status = allocate_arrays(grid, ranks, out, err);
    if (status != DM2_OK)
        return status;
    memcpy(out->rect, rects, (size_t)ranks * sizeof *rects);
    for (int k = 0; k < ranks; k++)
        fill_owner(out, k);
    /* `covered` cells in all, and no cell overwritten by a later rectangle: each cell exactly once. */
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

/* The owner of cell (i, j), wrapped across periodic sides; -1: outside the grid. */
static int find_owner(const struct decomposition *d, int i, int j)
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

static struct rim make_rim(const struct cell_rect *r, enum side side)
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

/* The cells of each rank are consecutive along a straight side, so that the number of changes is the number
 * of ranks. */
void decomposition_interfaces(const struct decomposition *d, int rank, int out[SIDE_COUNT])
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct rim rim = make_rim(&d->rect[rank], (enum side)side);
        int last = -1;
        out[side] = 0;
        for (int k = 0; k < rim.count; k++) {
            int owner = find_owner(d, rim.i + k * rim.di, rim.j + k * rim.dj);
            out[side] += owner >= 0 && owner != rank && owner != last;
            last = owner;
        }
    }
}

/* Does another rank own one of the eight cells around (i, j)? */
static int touches_other_rank(const struct decomposition *d, int rank, int i, int j)
{
    for (int b = -1; b <= 1; b++)
        for (int a = -1; a <= 1; a++) {
            int owner = find_owner(d, i + a, j + b);
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
    struct rim rim = make_rim(&d->rect[rank], (enum side)side);
    for (int k = 0; k < rim.count; k++) {
        int i = rim.i + k * rim.di, j = rim.j + k * rim.dj, owner = find_owner(d, i, j);
        if (owner < 0 || owner == rank)
            continue;
        if (side <= SIDE_NORTH) {
            out->interface_cells++;
            out->interface_cm += side <= SIDE_EAST ? g->ly : g->lx;
        }
        size_t at = (size_t)((j + g->cy) % g->cy) * (size_t)g->cx + (size_t)((i + g->cx) % g->cx);
        out->outer += cell_seen[at] == 0; /* on a small periodic grid one cell may lie beyond two sides */
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
                out->inner += rim && touches_other_rank(d, rank, i, j);
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
    return bisect_cells(&d->rect[rank]);
}

uint64_t decomposition_weight(const struct decomposition *d, int rank, const uint32_t *weights)
{
    return bisect_weight(d->grid.cx, weights, &d->rect[rank]);
}
