/* Overflow-checked allocation. No function here aborts: NULL means no memory or size overflow. */
#ifndef DM2_BASE_MEM_H
#define DM2_BASE_MEM_H

#include <stddef.h>

/* count * size bytes, zeroed, aligned for any type; NULL on overflow or lack of memory. A valid pointer also
 * for count = 0. The caller frees the block with free(). */
void *mem_zalloc(size_t count, size_t size);

/* Like mem_zalloc, but not zeroed, and aligned to 64 bytes (a cache line). */
void *mem_alloc(size_t count, size_t size);

/* An array of at least `need` items of `size` bytes that begins with the first `used` items of `item`: `item`
 * itself where it is large enough, and otherwise a new array that replaces `item`, which is freed. *cap is
 * the capacity in items and grows geometrically. NULL without memory: then `item` and *cap are unchanged.
 *
 *     struct thing *grown = mem_grown(list->item, &list->cap, list->n, list->n + 1, sizeof *grown);
 *     if (grown == NULL)
 *         return no_memory(err);
 *     list->item = grown; */
void *mem_grown(void *item, size_t *cap, size_t used, size_t need, size_t size);

#endif
