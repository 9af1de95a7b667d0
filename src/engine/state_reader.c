/* Slots are in cell order, records in the order of ids. Slots are sorted by id; entries of the near list are
 * sorted by counting into the order of their lower ids, then the few entries of each lower id by their higher
 * id.
 *
 * An owned element has a pair in its own row, or is the partner in the row of another owned element, so that
 * the rows hold all pairs whose lower id is owned. */
#include "state_reader.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "id_order.h"

/* Where one rank owns all elements, their ids 0 .. n-1 index r->slot. False: ids are others. */
static bool place_slots_by_id(struct state_reader *r)
{
    for (size_t i = 0; i < r->n_elements; i++) {
        if (r->p->id[i] >= r->n_elements)
            return false;
        r->slot[r->p->id[i]] = (uint32_t)i;
    }
    return true;
}

static int sort_slots_by_id(struct state_reader *r)
{
    for (size_t i = 0; i < r->n_elements; i++)
        r->slot[i] = (uint32_t)i;
    return id_order_sort_slots(r->p->id, r->slot, r->n_elements);
}

/* Is entry k of row i one of the pairs asked for, with an owned lower id? *low is the slot of the lower id.
 */
static bool is_record(const struct state_reader *r, uint32_t i, uint32_t k, uint32_t *low)
{
    const struct particles *p = r->p;
    uint32_t j = r->lists->near.j[k];
    bool ordered = p->id[i] < p->id[j];
    *low = ordered ? i : j;
    bool asked = r->which == READER_ACTING ? r->lists->forces[k].acts != 0 : lists_remembers(r->lists, k);
    return asked && (ordered || j < p->n_own);
}

static uint32_t higher_id(const struct state_reader *r, struct reader_pair pair)
{
    uint32_t a = r->p->id[pair.row], b = r->p->id[r->lists->near.j[pair.entry]];
    return a < b ? b : a;
}

/* Sorts the n pairs of one lower id, a handful, by their higher id. */
static void sort_by_higher_id(const struct state_reader *r, struct reader_pair *pair, size_t n)
{
    for (size_t k = 1; k < n; k++) {
        struct reader_pair moving = pair[k];
        size_t at = k;
        for (; at > 0 && higher_id(r, pair[at - 1]) > higher_id(r, moving); at--)
            pair[at] = pair[at - 1];
        pair[at] = moving;
    }
}

/* Fills r->pair. start[n_elements]: start[s] first counts the records whose lower id is in slot s, then is
 * the cursor of these records, and ends as the end of these records. */
static enum dm2_status index_pairs(struct state_reader *r, uint32_t *start)
{
    const uint32_t *row = r->lists->near.start;
    uint32_t low;
    size_t pairs = 0;
    memset(start, 0, r->n_elements * sizeof *start);
    for (uint32_t i = 0; i < r->n_elements; i++)
        for (uint32_t k = row[i]; k < row[i + 1]; k++)
            if (is_record(r, i, k, &low))
                start[low]++;
    for (size_t k = 0; k < r->n_elements; k++) {
        uint32_t count = start[r->slot[k]];
        start[r->slot[k]] = (uint32_t)pairs;
        pairs += count;
    }
    r->pair = mem_alloc(pairs, sizeof *r->pair);
    if (r->pair == NULL)
        return DM2_MEMORY;
    for (uint32_t i = 0; i < r->n_elements; i++)
        for (uint32_t k = row[i]; k < row[i + 1]; k++)
            if (is_record(r, i, k, &low))
                r->pair[start[low]++] = (struct reader_pair){i, k};
    for (size_t k = 0, first = 0; k < r->n_elements; k++) {
        sort_by_higher_id(r, r->pair + first, start[r->slot[k]] - first);
        first = start[r->slot[k]];
    }
    r->n_pairs = pairs;
    return DM2_OK;
}

enum dm2_status state_reader_open(struct state_reader *r, const struct particles *p,
                                  const struct lists *lists, enum reader_pairs which, struct dm2_error *err)
{
    *r = (struct state_reader){.p = p, .lists = lists, .n_elements = p->n_own, .which = which};
    uint32_t *start = mem_alloc(p->n_own, sizeof *start);
    r->slot = mem_alloc(p->n_own, sizeof *r->slot);
    enum dm2_status status = start == NULL || r->slot == NULL ? DM2_MEMORY : DM2_OK;
    if (status == DM2_OK && !place_slots_by_id(r) && sort_slots_by_id(r) != 0)
        status = DM2_MEMORY;
    if (status == DM2_OK && which != READER_NONE)
        status = index_pairs(r, start);
    free(start);
    if (status == DM2_OK)
        return DM2_OK;
    state_reader_free(r);
    return dm2_fail(err, DM2_MEMORY, "no memory to put the state of %zu elements in order", p->n_own);
}

void state_reader_free(struct state_reader *r)
{
    free(r->slot);
    free(r->pair);
    *r = (struct state_reader){.n_pairs = 0};
}

void state_reader_element(const struct state_reader *r, size_t k, struct element *out)
{
    particles_get(r->p, r->slot[k], out);
}

void state_reader_pair(const struct state_reader *r, size_t k, struct pair_record *out)
{
    const struct lists *l = r->lists;
    uint32_t entry = r->pair[k].entry, a = r->p->id[r->pair[k].row], b = r->p->id[l->near.j[entry]];
    *out = (struct pair_record){.id_a = a < b ? a : b,
                                .id_b = a < b ? b : a,
                                .linked = l->linked[entry],
                                .stretch = l->stretch[entry],
                                .spring = l->spring[entry]};
}

void state_reader_force(const struct state_reader *r, double over_force, size_t k, struct pair_measure *out)
{
    const struct lists *l = r->lists;
    const struct entry_force *f = &l->forces[r->pair[k].entry];
    uint32_t row = r->p->id[r->pair[k].row], other = r->p->id[l->near.j[r->pair[k].entry]];
    *out = (struct pair_measure){.normal = number_plus_zero(f->normal),
                                 .tangential = number_plus_zero(f->tangential)};
    for (int a = 0; a < 2; a++)
        out->force[a] = (double)(row < other ? f->f[a] : -f->f[a]) * over_force;
}
