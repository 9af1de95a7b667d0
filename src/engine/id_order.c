/* The sort moves pairs of id and slot, so that a comparison need not read the array of ids. */
#include "id_order.h"

#include <stdlib.h>

#include "dm2/base/mem.h"

static int compare_ids(const void *a, const void *b)
{
    const struct id_slot *ia = a, *ib = b;
    return ia->id < ib->id ? -1 : ia->id > ib->id;
}

void id_order_sort(struct id_slot *order, size_t n)
{
    qsort(order, n, sizeof *order, compare_ids);
}

int32_t id_order_find(const struct id_slot *order, size_t n, uint32_t id)
{
    if (n == 0)
        return -1;
    struct id_slot key = {.id = id};
    const struct id_slot *found = bsearch(&key, order, n, sizeof *order, compare_ids);
    return found != NULL ? (int32_t)found->slot : -1;
}

int id_order_sort_slots(const uint32_t *id, uint32_t *slots, size_t n)
{
    struct id_slot *order = mem_alloc(n, sizeof *order);
    if (order == NULL)
        return -1;
    for (size_t k = 0; k < n; k++)
        order[k] = (struct id_slot){id[slots[k]], slots[k]};
    id_order_sort(order, n);
    for (size_t k = 0; k < n; k++)
        slots[k] = order[k].slot;
    free(order);
    return 0;
}
