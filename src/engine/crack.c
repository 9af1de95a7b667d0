/* The cracks of one evaluation. crack_note is apart from the loops of forces, which call it for a broken link
 * only. */
#include "dm2/engine/crack.h"

#include <stdlib.h>

#include "dm2/base/grid.h"
#include "dm2/base/mem.h"
#include "crack_note.h"
#include "law.h"

int crack_list_add(struct crack_list *list, const struct crack *crack)
{
    struct crack *grown = mem_grown(list->items, &list->cap, list->n, list->n + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    list->items = grown;
    list->items[list->n++] = *crack;
    return 0;
}

void crack_list_free(struct crack_list *list)
{
    free(list->items);
    *list = (struct crack_list){0};
}

static int compare_cracks(const void *a, const void *b)
{
    const struct crack *x = a, *y = b;
    if (x->id_a != y->id_a)
        return x->id_a < y->id_a ? -1 : 1;
    return x->id_b < y->id_b ? -1 : x->id_b > y->id_b;
}

void crack_list_sort(struct crack_list *list)
{
    if (list->n > 1)
        qsort(list->items, list->n, sizeof *list->items, compare_cracks);
}

/* The mode of a link that broke at distance r with the memory `before`. */
static enum crack_mode find_mode(const struct pair_law *law, double r0, double r,
                                 const struct pair_state *before)
{
    double energy = 0.0;
    if (law->scope == SCOPE_LINKED)
        (void)potential_force(law, r - before->stretch, r0, &energy);
    if (0.5 * law->kt_link * (before->spring * before->spring) > energy)
        return CRACK_SHEARED;
    return before->stretch > 0.0 ? CRACK_YIELDED : CRACK_PULLED;
}

void crack_note(struct pass *pass, struct crack_list *list, size_t i, size_t j, const struct pair_law *law,
                double r, const struct pair_state *before, double heat)
{
    const struct particles *p = pass->p;
    const struct grid *g = &pass->m->grid;
    if (!counts_here(p, (uint32_t)i, (uint32_t)j))
        return;
    size_t a = p->id[i] < p->id[j] ? i : j, b = a == i ? j : i;
    struct crack crack = {.id_a = p->id[a],
                          .id_b = p->id[b],
                          .energy = heat,
                          .mode = (uint8_t)find_mode(law, p->radius[i] + p->radius[j], r, before),
                          .grains = p->body[a] == p->body[b] && p->grain[a] == p->grain[b] ? 1 : 2};
    for (size_t k = 0; k < 2; k++) {
        int32_t turns;
        double across =
            period_nearest(p->r[2 * b + k] - p->r[2 * a + k], pass->period.size[k], pass->period.half[k]);
        crack.r[k] = p->r[2 * a + k] + 0.5 * across;
        if (g->periodic[k])
            crack.r[k] = grid_wrap(g->origin[k], g->size[k], crack.r[k], &turns);
    }
    pass->no_memory |= crack_list_add(list, &crack) != 0;
}
