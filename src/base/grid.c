/* The column of x is floor((x - x0) / L), clamped to the grid. This function is monotonic, so that two
 * elements closer than one cell edge are at most one column apart, inside the grid and outside. */
#include "dm2/base/grid.h"

#include <math.h>

#include "dm2/base/machine.h"

static int cells_along(double size, double reach)
{
    double most = floor(size / reach);
    if (most > 1e9)
        return -1;
    int n = (int)most;
    while (n > 1 && !(size / n > reach * (1.0 + 1e-9))) /* 2.2/20 exceeds 0.11 by rounding alone */
        n--;
    return n < 1 ? 1 : n;
}

enum dm2_status grid_build(const double origin[2], const double size[2], const bool periodic[2], double reach,
                           struct grid *out, struct dm2_error *err)
{
    int n[2];
    for (int a = 0; a < 2; a++) {
        n[a] = cells_along(size[a], reach);
        if (periodic[a] && n[a] < 3)
            return dm2_fail(err, DM2_DECK,
                            "the domain is %g cm long in %c, which is periodic: at least 3 cells longer than "
                            "r_c + delta_r = %g cm must fit",
                            size[a], a == 0 ? 'x' : 'y', reach);
    }
    if (n[0] < 0 || n[1] < 0 || (double)n[0] * n[1] > 0x1p30)
        return dm2_fail(err, DM2_DECK,
                        "the grid would have more than 2^30 cells: r_c + delta_r = %g cm is too small "
                        "for a domain of %g x %g cm",
                        reach, size[0], size[1]);
    *out = (struct grid){.cx = n[0], .cy = n[1], .lx = size[0] / n[0], .ly = size[1] / n[1]};
    for (int a = 0; a < 2; a++) {
        out->origin[a] = origin[a];
        out->size[a] = size[a];
        out->periodic[a] = periodic[a];
    }
    return DM2_OK;
}

enum dm2_status grid_check_memory(const struct grid *g, double bytes, struct dm2_error *err)
{
    double most = machine_memory();
    if (bytes <= most)
        return DM2_OK;
    return dm2_fail(
        err, DM2_MEMORY,
        "the domain has %d x %d cells of %.3g x %.3g cm, which take %.3g GB, and this process may have "
        "%.3g GB: make the domain smaller, or r_c + delta_r, the length of a cell, larger",
        g->cx, g->cy, g->lx, g->ly, 1e-9 * bytes, 1e-9 * most);
}

static int clamp_index(double at, int n)
{
    if (!(at >= 1.0))
        return 0;
    return at >= n ? n - 1 : (int)at;
}

int grid_cell(const struct grid *g, double x, double y)
{
    int i = clamp_index((x - g->origin[0]) / g->lx, g->cx);
    int j = clamp_index((y - g->origin[1]) / g->ly, g->cy);
    return j * g->cx + i;
}

int grid_neighbours(const struct grid *g, int cell, int out[8])
{
    int i = cell % g->cx, j = cell / g->cx, count = 0;
    for (int b = -1; b <= 1; b++) {
        for (int a = -1; a <= 1; a++) {
            int ni = i + a, nj = j + b;
            if (g->periodic[0])
                ni = (ni + g->cx) % g->cx;
            if (g->periodic[1])
                nj = (nj + g->cy) % g->cy;
            if (ni < 0 || ni >= g->cx || nj < 0 || nj >= g->cy)
                continue;
            int at = nj * g->cx + ni, seen = at == cell;
            for (int k = 0; k < count; k++)
                seen |= out[k] == at;
            if (!seen)
                out[count++] = at;
        }
    }
    return count;
}

double grid_wrap_far(double low, double size, double x, int32_t *turns)
{
    const double most = INT32_MAX / 2;
    double n = floor((x - low) / size);
    n = n > most ? most : n < -most ? -most : n;
    double near = x - n * size; /* by rounding at most about an edge away from its place */
    int32_t last = 0;
    if (near >= low - size && near < low + 2.0 * size)
        near = grid_wrap(low, size, near, &last);
    *turns = (int32_t)n + last;
    return near;
}
