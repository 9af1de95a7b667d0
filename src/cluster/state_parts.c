/* The parts of a state hold its elements first, then its pairs, then its further sections; the last part has
 * head.last set. A share follows the cells: struct domain_map gives the owner of an element's cell and the
 * ranks that mirror the cell. */
#include "state_parts.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/cluster/wire.h"
#include "dm2/engine/domain_map.h"

/* Room for the heads of a message and of its sections. */
enum { HEADS = 64 + SECTION_HEAD * (4 + SECTION_COUNT) };

/* Takes of `left` records as many as *room has bytes for. */
static size_t take_records(size_t left, size_t width, size_t *room)
{
    size_t n = left < *room / width ? left : *room / width;
    *room -= n * width;
    return n;
}

/* Decides which records the next part holds. */
static void plan_part(struct state_parts *s)
{
    size_t room = LIMIT_STATE - HEADS, width = WIRE_PAIR + (s->forces != NULL ? WIRE_FORCE : 0);
    size_t elements = s->state.n_elements - s->elements_done, pairs = s->state.n_pairs - s->pairs_done;
    s->head.n_elements =
        take_records(elements, WIRE_ELEMENT + (s->measured != NULL ? WIRE_MEASURED : 0), &room);
    s->head.n_pairs = s->head.n_elements == elements ? take_records(pairs, width, &room) : 0;
    bool all = s->head.n_elements == elements && s->head.n_pairs == pairs;
    for (int k = 0; k < SECTION_COUNT; k++) {
        size_t left = s->state.sections[k].n - s->sections_done[k];
        s->head.sections[k] = all ? take_records(left, section_kinds[k].bytes, &room) : 0;
        all &= s->head.sections[k] == left;
    }
    s->head.last = all;
}

bool state_parts_next(struct state_parts *s, struct bytes_writer *out)
{
    const struct state_view *state = &s->state;
    if (s->head.last)
        return false;
    plan_part(s);
    bytes_clear(out);
    message_put_state(out, &s->head);
    for (size_t k = 0; k < s->head.n_elements; k++)
        wire_put_element(out, &state->elements[s->elements_done + k]);
    for (size_t k = 0; k < s->head.n_elements && s->measured != NULL; k++)
        wire_put_measured(out, &s->measured[s->elements_done + k]);
    for (size_t k = 0; k < s->head.n_pairs; k++)
        wire_put_pair(out, &state->pairs[s->pairs_done + k]);
    for (size_t k = 0; k < s->head.n_pairs && s->forces != NULL; k++)
        wire_put_force(out, &s->forces[s->pairs_done + k]);
    for (int kind = 0; kind < SECTION_COUNT; kind++) {
        for (size_t k = 0; k < s->head.sections[kind]; k++)
            section_kinds[kind].put(
                out, section_record((enum section)kind, &state->sections[kind], s->sections_done[kind] + k));
        s->sections_done[kind] += s->head.sections[kind];
    }
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

/* Copies the records of owned elements, of sections of the run all. own[ids] tells which ids are owned. */
static bool share_sections(const struct state_view *state, const unsigned char *own, struct state_share *out)
{
    for (int kind = 0; kind < SECTION_COUNT; kind++) {
        const struct section_array *all = &state->sections[kind];
        for (size_t k = 0; k < all->n; k++) {
            const void *record = section_record((enum section)kind, all, k);
            if ((!section_kinds[kind].of_element || own[section_element(record)]) &&
                !section_append((enum section)kind, &out->sections[kind], record, 1))
                return false;
        }
    }
    return true;
}

enum dm2_status state_parts_share(const struct decomposition *d, int rank, const struct state_view *state,
                                  struct state_share *out, struct dm2_error *err)
{
    const struct domain_map map = {.grid = &d->grid, .ranks = d->ranks, .owner = d->owner};
    size_t n = state->n_elements, ids = n == 0 ? 0 : (size_t)state->elements[n - 1].id + 1;
    unsigned char *own = mem_zalloc(ids, 1);
    *out = (struct state_share){.elements = mem_alloc(n, sizeof *out->elements),
                                .pairs = mem_alloc(state->n_pairs, sizeof *out->pairs)};
    bool room = own != NULL && out->elements != NULL && out->pairs != NULL;
    for (size_t k = 0; k < n && room; k++) {
        const struct element *e = &state->elements[k];
        int cell = grid_cell(&d->grid, e->r[0], e->r[1]);
        own[e->id] = d->owner[cell] == rank;
        if (sees_cell(&map, rank, cell))
            out->elements[out->n_elements++] = *e;
    }
    for (size_t k = 0; k < state->n_pairs && room; k++)
        if (own[state->pairs[k].id_a] || own[state->pairs[k].id_b])
            out->pairs[out->n_pairs++] = state->pairs[k];
    room = room && share_sections(state, own, out);
    free(own);
    return room ? DM2_OK : dm2_fail(err, DM2_MEMORY, "no memory to share out a state of %zu elements", n);
}

void state_share_free(struct state_share *share)
{
    free(share->elements);
    free(share->pairs);
    section_free(share->sections);
    *share = (struct state_share){.n_elements = 0};
}

struct state_view state_share_view(const struct state_share *share, int64_t step)
{
    struct state_view view = {.step = step,
                              .elements = share->elements,
                              .n_elements = share->n_elements,
                              .pairs = share->pairs,
                              .n_pairs = share->n_pairs};
    memcpy(view.sections, share->sections, sizeof view.sections);
    return view;
}
