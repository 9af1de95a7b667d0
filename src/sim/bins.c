#include "dm2/sim/bins.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

bool bins_lay_out(struct bins *b, const struct grid *cells, double reach, size_t elements)
{
    b->ready = grid_build(cells->origin, cells->size, cells->periodic, reach, &b->grid, NULL) == DM2_OK &&
               b->grid.lx < 0.6 * cells->lx && b->grid.ly < 0.6 * cells->ly &&
               (double)b->grid.cx * b->grid.cy < 16.0 * (double)elements + 1024.0;
    return b->ready;
}

static int hold(uint32_t **array, size_t *cap, size_t n)
{
    void *block = *array;
    int status = mem_grow(&block, cap, 0, n, sizeof **array);
    *array = block;
    return status;
}

int bins_assign(struct bins *b, const struct particles *p)
{
    size_t count = (size_t)b->grid.cx * (size_t)b->grid.cy;
    if (hold(&b->start, &b->start_cap, count + 2) != 0 || hold(&b->slot, &b->slot_cap, p->n) != 0 ||
        hold(&b->bin, &b->bin_cap, p->n) != 0)
        return -1;
    memset(b->start, 0, (count + 2) * sizeof *b->start);
    for (size_t i = 0; i < p->n; i++) {
        b->bin[i] = (uint32_t)grid_cell(&b->grid, p->r[2 * i], p->r[2 * i + 1]);
        b->start[b->bin[i] + 2]++;
    }
    for (size_t k = 2; k < count + 2; k++)
        b->start[k] += b->start[k - 1];
    /* start[bin + 1] is the cursor of its bin and ends where the next begins. */
    for (size_t i = 0; i < p->n; i++)
        b->slot[b->start[b->bin[i] + 1]++] = (uint32_t)i;
    return 0;
}

void bins_free(struct bins *b)
{
    free(b->start);
    free(b->slot);
    free(b->bin);
    *b = (struct bins){.ready = false};
}

size_t bins_bytes(const struct bins *b)
{
    return (b->start_cap + b->slot_cap + b->bin_cap) * sizeof(uint32_t);
}
