/* Arrays grow to 1.5 times their capacity, to the need where that is more, and to 16 items at least. */
#include "dm2/base/mem.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *mem_zalloc(size_t count, size_t size)
{
    if (size != 0 && count > SIZE_MAX / size)
        return NULL; /* calloc's own check ends a sanitized program */
    return calloc(count > 0 ? count : 1, size > 0 ? size : 1);
}

void *mem_alloc(size_t count, size_t size)
{
    void *block = NULL;
    if (size != 0 && count > (SIZE_MAX - 64) / size)
        return NULL;
    if (posix_memalign(&block, 64, count * size > 0 ? count * size : 64) != 0)
        return NULL;
    return block;
}

void *mem_grown(void *item, size_t *cap, size_t used, size_t need, size_t size)
{
    if (need <= *cap && item != NULL)
        return item;
    size_t bigger = *cap + *cap / 2;
    if (bigger < need)
        bigger = need;
    if (bigger < 16)
        bigger = 16;
    void *grown = mem_alloc(bigger, size);
    if (grown == NULL)
        return NULL;
    if (used > 0)
        memcpy(grown, item, used * size);
    free(item);
    *cap = bigger;
    return grown;
}
