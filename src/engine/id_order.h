/* Slots in the order of the ids of their elements. */
#ifndef DM2_ENGINE_ID_ORDER_H
#define DM2_ENGINE_ID_ORDER_H

#include <stddef.h>
#include <stdint.h>

struct id_slot {
    uint32_t id, slot;
};

/* Sorts n entries by id, ascending. */
void id_order_sort(struct id_slot *order, size_t n);

/* The slot of an id among n entries sorted by id; -1 where no entry has the id. */
int32_t id_order_find(const struct id_slot *order, size_t n, uint32_t id);

/* Sorts n slots by id[slot], ascending. 0, or -1 without memory. */
int id_order_sort_slots(const uint32_t *id, uint32_t *slots, size_t n);

#endif
