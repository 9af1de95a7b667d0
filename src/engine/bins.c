/* A counting sort. Along a side that is not periodic the last bins reach beyond the elements, so that edges
 * are no longer than asked for; along a periodic side the bins divide the domain. */
#include "bins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

bool bins_lay_out(struct bins *b, const struct grid *cells, const double *r, size_t n, double reach,
                  double most)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, size[2];
    for (size_t i = 0; i < n; i++) {
        for (size_t a = 0; a < 2; a++) {
            double x = r[2 * i + a];
            low[a] = x < low[a] ? x : low[a];
            high[a] = x > high[a] ? x : high[a];
        }
    }
    const double edge = reach * (1.0 + 1e-8);
    for (int a = 0; a < 2; a++) {
        bool given = cells->periodic[a] || n == 0;
        size[a] = given ? cells->size[a] : edge * (floor((high[a] - low[a]) / edge) + 1.0);
        low[a] = given ? cells->origin[a] : low[a];
    }
    return grid_build(low, size, cells->periodic, reach, &b->grid, NULL) == DM2_OK &&
           (double)b->grid.cx * b->grid.cy <= most;
}

/* Makes *array hold n items, with no contents kept. 0, or -1 without memory. */
static int hold_items(uint32_t **array, size_t *cap, size_t n)
{
    uint32_t *grown = mem_grown(*array, cap, 0, n, sizeof *grown);
    if (grown == NULL)
        return -1;
    *array = grown;
    return 0;
}

int bins_assign(struct bins *b, const double *r, size_t n)
{
    size_t count = (size_t)b->grid.cx * (size_t)b->grid.cy;
    if (hold_items(&b->start, &b->start_cap, count + 2) != 0 || hold_items(&b->slot, &b->slot_cap, n) != 0 ||
        hold_items(&b->bin, &b->bin_cap, n) != 0)
        return -1;
    memset(b->start, 0, (count + 2) * sizeof *b->start);
    for (size_t i = 0; i < n; i++) {
        b->bin[i] = (uint32_t)grid_cell(&b->grid, r[2 * i], r[2 * i + 1]);
        b->start[b->bin[i] + 2]++;
    }
    for (size_t k = 2; k < count + 2; k++)
        b->start[k] += b->start[k - 1];
    /* start[bin + 1] is the cursor of `bin`, and ends as the start of the next bin. */
    for (size_t i = 0; i < n; i++)
        b->slot[b->start[b->bin[i] + 1]++] = (uint32_t)i;
    return 0;
}

void bins_free(struct bins *b)
{
    free(b->start);
    free(b->slot);
    free(b->bin);
    *b = (struct bins){0};
}

size_t bins_bytes(const struct bins *b)
{
    return (b->start_cap + b->slot_cap + b->bin_cap) * sizeof(uint32_t);
}
