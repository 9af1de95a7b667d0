/* Union-find (Galler and Fischer, 1964) with path halving. The root of a tree is its lowest index in any
 * order of the pairs, because the higher root becomes a child of the lower one. On lattices the trees stay
 * flat without ranks. */
#include "fragments.h"

#include <stdlib.h>

#include "dm2/base/mem.h"

struct fragment {
    uint32_t root;
    uint32_t size;
};

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void join_trees(uint32_t *parent, uint32_t i, uint32_t j)
{
    i = root_of(parent, i);
    j = root_of(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

static int compare_fragments(const void *a, const void *b)
{
    const struct fragment *fa = a, *fb = b;
    if (fa->size != fb->size)
        return fa->size > fb->size ? -1 : 1;
    return fa->root < fb->root ? -1 : fa->root > fb->root;
}

/* Writes the fragments to `list` in the order of their numbers and returns how many there are. `size` comes
 * as n zeros and returns with the fragment's number at the index of each root. */
static size_t number_fragments(uint32_t *parent, size_t n, uint32_t *size, struct fragment *list)
{
    size_t fragments = 0;
    for (size_t i = 0; i < n; i++)
        size[root_of(parent, (uint32_t)i)]++;
    for (size_t i = 0; i < n; i++)
        if (size[i] > 0)
            list[fragments++] = (struct fragment){(uint32_t)i, size[i]};
    qsort(list, fragments, sizeof *list, compare_fragments);
    for (size_t f = 0; f < fragments; f++)
        size[list[f].root] = (uint32_t)f;
    return fragments;
}

enum dm2_status fragments_find(const struct element *elements, size_t n_elements,
                               const struct pair_record *pairs, size_t n_pairs, uint32_t *fragment,
                               struct fragment_counts *counts, struct dm2_error *err)
{
    uint32_t *parent = mem_alloc(n_elements, sizeof *parent),
             *number = mem_zalloc(n_elements, sizeof *number);
    struct fragment *list = mem_alloc(n_elements, sizeof *list);
    enum dm2_status status = DM2_OK;
    *counts = (struct fragment_counts){0};
    if (parent == NULL || number == NULL || list == NULL) {
        status = dm2_fail(err, DM2_MEMORY, "no memory to find the fragments of %zu elements", n_elements);
        goto done;
    }
    for (size_t i = 0; i < n_elements; i++)
        parent[i] = (uint32_t)i;
    for (size_t k = 0; k < n_pairs; k++) {
        size_t i = pairs[k].linked == 0 ? n_elements : element_find(elements, n_elements, pairs[k].id_a);
        size_t j = i == n_elements ? n_elements : element_find(elements, n_elements, pairs[k].id_b);
        if (j < n_elements)
            join_trees(parent, (uint32_t)i, (uint32_t)j);
    }
    counts->fragments = number_fragments(parent, n_elements, number, list);
    for (size_t f = 0; f < counts->fragments; f++)
        counts->single += list[f].size == 1;
    counts->largest = counts->fragments > 0 ? list[0].size : 0;
    for (size_t i = 0; i < n_elements; i++)
        fragment[i] = number[root_of(parent, (uint32_t)i)];
done:
    free(parent);
    free(number);
    free(list);
    return status;
}
