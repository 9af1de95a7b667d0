/* The memory of pairs in a rebuild. The ranks that emigrants go to get the memory in their parcels; the lists
 * to be built get the memory of the old lists and of the parcels that came. */
#include "subdomain_parts.h"

#include <stdlib.h>

#include "dm2/base/mem.h"
#include "id_order.h"
#include "lists.h"

/* --- sending --- */

static int add_pair(struct pair_array *a, const struct pair_record *pair)
{
    struct pair_record *grown = mem_grown(a->item, &a->cap, a->n, a->n + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    a->item = grown;
    a->item[a->n++] = *pair;
    return 0;
}

int pair_memory_send(struct subdomain *sd, const int32_t *destination)
{
    const struct lists *l = &sd->lists;
    const struct particles *p = &sd->p;
    for (size_t i = 0; i < p->n_own; i++) {
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
            size_t j = l->near.j[k];
            int32_t to[2] = {destination[i], j < p->n_own ? destination[j] : -1};
            if ((to[0] < 0 && to[1] < 0) || !lists_remembers(l, k))
                continue;
            uint32_t a = p->id[i] < p->id[j] ? p->id[i] : p->id[j],
                     b = p->id[i] < p->id[j] ? p->id[j] : p->id[i];
            struct pair_record pair = {.id_a = a,
                                       .id_b = b,
                                       .linked = l->linked[k],
                                       .stretch = l->stretch[k],
                                       .spring = l->spring[k]};
            for (int e = 0; e < 2; e++) {
                if (to[e] >= 0 && (e == 0 || to[1] != to[0]) &&
                    add_pair(&sd->neighbours[to[e]].pairs, &pair) != 0)
                    return -1;
            }
        }
    }
    return 0;
}

/* --- carrying over --- */

/* The new slot of the element `id` that was in old slot i, -1 where it is no longer here. An element that is
 * not a stayer can be here as a newcomer or a mirror. */
static int32_t find_new_slot(const struct subdomain *sd, const uint32_t *moved, size_t n_old, size_t i,
                             uint32_t id)
{
    if (i < n_old && moved[i] != PARTICLES_NONE)
        return (int32_t)moved[i];
    return idmap_find(&sd->ids, id);
}

/* Carries the memory of the pair in new slots a and b over, if both elements are here and one is owned:
 * counts the pair, or with `place` places its memory. */
static void carry_pair(struct subdomain *sd, bool place, int32_t a, int32_t b, struct carried_pair pair)
{
    if (a < 0 || b < 0)
        return;
    uint32_t low = (uint32_t)(a < b ? a : b);
    if (low >= sd->p.n_own)
        return;
    pair.b = (uint32_t)(a < b ? b : a);
    if (place)
        lists_carry_place(&sd->lists, low, pair);
    else
        lists_carry_count(&sd->lists, low);
}

/* Carries over the memory of the old lists. */
static void carry_lists(struct subdomain *sd, bool place, size_t n_old, const uint32_t *moved,
                        const uint32_t *old_id)
{
    const struct lists *l = &sd->lists;
    for (size_t i = 0; i < n_old; i++) {
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
            if (!lists_remembers(l, k))
                continue;
            size_t j = l->near.j[k];
            struct carried_pair pair = {
                .linked = l->linked[k], .stretch = l->stretch[k], .spring = l->spring[k]};
            carry_pair(sd, place, find_new_slot(sd, moved, n_old, i, old_id[i]),
                       find_new_slot(sd, moved, n_old, j, old_id[j]), pair);
        }
    }
}

/* The new slot of an id, -1 where the element is not here. Mirrors and newcomers are in sd->ids, stayers in
 * stayers[n], which is sorted by id. */
static int32_t find_slot_of_id(const struct subdomain *sd, const struct id_slot *stayers, size_t n,
                               uint32_t id)
{
    int32_t slot = idmap_find(&sd->ids, id);
    return slot >= 0 ? slot : id_order_find(stayers, n, id);
}

/* The *n stayers sorted by id, the caller's to free; NULL without memory. */
static struct id_slot *sort_stayers(const uint32_t *moved, const uint32_t *old_id, size_t n_old, size_t *n)
{
    struct id_slot *stayers = mem_alloc(n_old, sizeof *stayers);
    *n = 0;
    for (size_t i = 0; stayers != NULL && i < n_old; i++) {
        if (moved[i] != PARTICLES_NONE)
            stayers[(*n)++] = (struct id_slot){old_id[i], moved[i]};
    }
    if (stayers != NULL)
        id_order_sort(stayers, *n);
    return stayers;
}

/* Carries over the memory of the parcels, which came with the migrants. */
static void carry_parcels(struct subdomain *sd, bool place, const struct parcel *parcels, size_t n_parcels,
                          const struct id_slot *stayers, size_t n)
{
    for (size_t q = 0; q < n_parcels; q++) {
        for (size_t k = 0; k < parcels[q].n_pairs; k++) {
            const struct pair_record *from = &parcels[q].pairs[k];
            struct carried_pair pair = {
                .linked = from->linked != 0, .stretch = from->stretch, .spring = from->spring};
            carry_pair(sd, place, find_slot_of_id(sd, stayers, n, from->id_a),
                       find_slot_of_id(sd, stayers, n, from->id_b), pair);
        }
    }
}

/* Two passes, as lists.h asks for: one to count the pairs, one to place their
 * memory. */
int pair_memory_carry(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels, size_t n_old,
                      const uint32_t *moved, const uint32_t *old_id, bool initial)
{
    struct id_slot *stayers = NULL;
    size_t pairs = 0, n = 0;
    for (size_t q = 0; q < n_parcels; q++)
        pairs += parcels[q].n_pairs;
    if (pairs > 0 && (stayers = sort_stayers(moved, old_id, n_old, &n)) == NULL)
        return -1;
    int status = lists_carry_start(&sd->lists, sd->p.n_own);
    for (int place = 0; place < 2 && status == 0; place++) {
        if (place)
            status =
                lists_carry_reserve(&sd->lists, sd->p.n_own, sd->p.pair_sum, particles_sum_bytes(&sd->p));
        if (status == 0 && !initial)
            carry_lists(sd, place, n_old, moved, old_id);
        if (status == 0)
            carry_parcels(sd, place, parcels, n_parcels, stayers, n);
    }
    free(stayers);
    return status;
}
