/* A search by id that takes one comparison where no id is missing. */
#include "dm2/engine/element.h"

size_t element_find(const struct element *elements, size_t n, uint32_t id)
{
    if (id < n && elements[id].id == id)
        return id; /* the usual case: no id below this is missing */
    size_t low = 0, high = n;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (elements[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < n && elements[low].id == id ? low : n;
}
