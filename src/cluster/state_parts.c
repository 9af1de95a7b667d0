/* The parts of a state hold its elements first, then its pairs; the last part has head.last set. A share
 * follows the cells: struct domain_map gives the owner of an element's cell and the ranks that mirror the
 * cell. */
#include "state_parts.h"

#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/cluster/wire.h"
#include "dm2/engine/domain_map.h"

bool state_parts_next(struct state_parts *s, struct bytes_writer *out)
{
    size_t each = WIRE_ELEMENT + (s->measured != NULL ? WIRE_MEASURED : 0), most = LIMIT_STATE - 64;
    size_t elements = s->n_elements - s->elements_done, pairs = s->n_pairs - s->pairs_done;
    if (s->head.last)
        return false;
    s->head.n_elements = elements < most / each ? elements : most / each;
    size_t room = (most - s->head.n_elements * each) / WIRE_PAIR;
    s->head.n_pairs = pairs < room ? pairs : room;
    s->head.last = s->head.n_elements == elements && s->head.n_pairs == pairs;
    bytes_clear(out);
    message_put_state(out, &s->head);
    for (size_t k = 0; k < s->head.n_elements; k++)
        wire_put_element(out, &s->elements[s->elements_done + k]);
    for (size_t k = 0; k < s->head.n_elements && s->measured != NULL; k++)
        wire_put_measured(out, &s->measured[s->elements_done + k]);
    for (size_t k = 0; k < s->head.n_pairs; k++)
        wire_put_pair(out, &s->pairs[s->pairs_done + k]);
    s->elements_done += s->head.n_elements;
    s->pairs_done += s->head.n_pairs;
    return true;
}

/* Does the rank own or mirror the cell? */
static bool sees_cell(const struct domain_map *map, int rank, int cell)
{
    uint16_t ranks[8];
    bool found = map->owner[cell] == rank;
    for (int k = found ? 0 : domain_map_mirrored_by(map, cell, ranks); k > 0; k--)
        found |= ranks[k - 1] == rank;
    return found;
}

enum dm2_status state_parts_share(const struct decomposition *d, int rank, const struct element *elements,
                                  size_t n_elements, const struct pair_record *pairs, size_t n_pairs,
                                  struct element **out, size_t *n_out, struct pair_record **pairs_out,
                                  size_t *n_pairs_out, struct dm2_error *err)
{
    const struct domain_map map = {.grid = &d->grid, .ranks = d->ranks, .owner = d->owner};
    unsigned char *own = mem_zalloc(n_elements, 1);
    *out = mem_alloc(n_elements, sizeof **out);
    *pairs_out = mem_alloc(n_pairs, sizeof **pairs_out);
    *n_out = *n_pairs_out = 0;
    if (own == NULL || *out == NULL || *pairs_out == NULL) {
        free(own);
        free(*out);
        free(*pairs_out);
        *out = NULL;
        *pairs_out = NULL;
        return dm2_fail(err, DM2_MEMORY, "no memory to share out a state of %zu elements", n_elements);
    }
    for (size_t k = 0; k < n_elements; k++) {
        int cell = grid_cell(&d->grid, elements[k].r[0], elements[k].r[1]);
        own[k] = d->owner[cell] == rank;
        if (sees_cell(&map, rank, cell))
            (*out)[(*n_out)++] = elements[k];
    }
    for (size_t k = 0; k < n_pairs; k++)
        if (own[pairs[k].id_a] || own[pairs[k].id_b])
            (*pairs_out)[(*n_pairs_out)++] = pairs[k];
    free(own);
    return DM2_OK;
}
