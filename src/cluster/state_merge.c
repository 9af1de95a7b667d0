/* Each element is stored at the index of its id. Pairs are appended as they come and sorted once: a counting
 * sort by id_a, then insertion by id_b, which is cheap because an element has few pairs. */
#include "state_merge.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

void state_merge_open(struct state_merge *m, struct record_limits limits)
{
    *m = (struct state_merge){.limits = limits};
}

void state_merge_free(struct state_merge *m)
{
    free(m->elements);
    free(m->measured);
    free(m->seen);
    free(m->pairs);
    free(m->forces);
    section_free(m->sections);
    *m = (struct state_merge){0};
}

void state_merge_clear(struct state_merge *m)
{
    if (m->seen != NULL)
        memset(m->seen, 0, m->limits.elements);
    m->n_seen = m->n_pairs = 0;
    for (int k = 0; k < SECTION_COUNT; k++)
        m->sections[k].n = 0;
}

static enum dm2_status allocate_arrays(struct state_merge *m, struct dm2_error *err)
{
    size_t n = m->limits.elements;
    if (m->seen != NULL)
        return DM2_OK;
    m->elements = mem_alloc(n, sizeof *m->elements);
    m->measured = mem_alloc(n, sizeof *m->measured);
    m->seen = mem_zalloc(n, 1);
    if (m->elements != NULL && m->measured != NULL && m->seen != NULL)
        return DM2_OK;
    state_merge_free(m);
    m->limits.elements = n;
    return dm2_fail(err, DM2_MEMORY, "no memory to compile a state of %zu elements", n);
}

/* A value that cannot be ends the run, because another server would compute it again. */
static enum dm2_status fail_record(const char *why, struct dm2_error *err)
{
    return why[0] == '\0'
               ? dm2_fail(err, DM2_PROTOCOL, "a part of a state is cut or too long")
               : dm2_fail(err, DM2_NUMERIC, "a part of a state has a value that cannot be: %s", why);
}

static enum dm2_status add_pairs(struct state_merge *m, const struct state_message *head,
                                 struct bytes_reader *r, struct dm2_error *err)
{
    size_t before = m->n_pairs, need = before + head->n_pairs;
    struct pair_record *pairs = mem_grown(m->pairs, &m->pairs_cap, before, need, sizeof *pairs);
    if (pairs != NULL)
        m->pairs = pairs;
    struct pair_measure *forces = head->purpose == STATE_SNAPSHOT && pairs != NULL
                                      ? mem_grown(m->forces, &m->forces_cap, before, need, sizeof *forces)
                                      : NULL;
    if (forces != NULL)
        m->forces = forces;
    if (pairs == NULL || (head->purpose == STATE_SNAPSHOT && forces == NULL))
        return dm2_fail(err, DM2_MEMORY, "no memory to compile %zu pairs", need);
    m->n_pairs = need;
    for (size_t k = before; k < need; k++)
        wire_get_pair(r, &m->limits, &pairs[k]);
    for (size_t k = before; k < need && forces != NULL; k++)
        wire_get_force(r, &forces[k]);
    return DM2_OK;
}

enum dm2_status state_merge_add(struct state_merge *m, const struct state_message *head,
                                const struct bytes_reader *from, struct dm2_error *err)
{
    char why[BYTES_WHY] = "";
    struct dm2_error fault = {0};
    struct bytes_reader reader = *from, *r = &reader;
    enum dm2_status status = allocate_arrays(m, err);
    reader.why = why;
    if (status != DM2_OK)
        return status;
    if (bytes_remaining(r) / WIRE_ELEMENT < head->n_elements)
        return fail_record("", err);
    if ((uint64_t)m->n_pairs + head->n_pairs > WIRE_PAIRS_MOST * (uint64_t)m->limits.elements)
        return dm2_fail(err, DM2_PROTOCOL, "a state came with more than %d pairs per element",
                        WIRE_PAIRS_MOST);
    uint32_t *ids = mem_alloc(head->n_elements, sizeof *ids);
    if (ids == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory to compile a state");
    for (size_t k = 0; k < head->n_elements && status == DM2_OK; k++) {
        struct element e;
        wire_get_element(r, &m->limits, &e);
        if (r->failed) {
            status = fail_record(why, err);
        } else if (m->seen[e.id]) {
            status = dm2_fail(err, DM2_NUMERIC, "element %u came twice: two servers own it", e.id);
        } else {
            m->seen[e.id] = 1;
            m->n_seen++;
            m->elements[e.id] = e;
            ids[k] = e.id;
        }
    }
    for (size_t k = 0; k < head->n_elements && head->purpose == STATE_SNAPSHOT && status == DM2_OK; k++)
        wire_get_measured(r, &m->measured[ids[k]]);
    free(ids);
    if (status != DM2_OK)
        return status;
    status = add_pairs(m, head, r, err);
    for (int k = 0; k < SECTION_COUNT && status == DM2_OK; k++)
        status = section_get((enum section)k, r, head->sections[k], &m->limits, &m->sections[k], &fault);
    if (status == DM2_PROTOCOL)
        return fail_record(fault.text, err);
    if (status != DM2_OK)
        return dm2_fail(err, status, "%s", fault.text);
    return bytes_done(r) ? DM2_OK : fail_record(why, err);
}

/* The order of the pairs: a new array of their indices, or NULL without memory. */
static size_t *sort_pairs(const struct state_merge *m)
{
    size_t n = m->limits.elements;
    size_t *start = mem_zalloc(n + 1, sizeof *start), *order = mem_alloc(m->n_pairs, sizeof *order);
    const struct pair_record *pairs = m->pairs;
    for (size_t k = 0; k < m->n_pairs && start != NULL; k++)
        start[pairs[k].id_a + 1]++;
    for (size_t k = 0; k < n && start != NULL; k++)
        start[k + 1] += start[k];
    if (start == NULL || order == NULL) {
        free(start);
        free(order);
        return NULL;
    }
    for (size_t k = 0; k < m->n_pairs; k++) /* start[a] moves to the end of the pairs of a */
        order[start[pairs[k].id_a]++] = k;
    for (size_t k = 1; k < m->n_pairs; k++) {
        size_t moving = order[k], at = k;
        const struct pair_record *p = &pairs[moving];
        for (; at > 0 && pairs[order[at - 1]].id_a == p->id_a && pairs[order[at - 1]].id_b > p->id_b; at--)
            order[at] = order[at - 1];
        order[at] = moving;
    }
    free(start);
    return order;
}

/* Puts pairs, and with `forced` their forces, in order. False without memory. */
static bool order_pairs(struct state_merge *m, bool forced)
{
    size_t *order = sort_pairs(m);
    struct pair_record *pairs = mem_alloc(m->n_pairs, sizeof *pairs);
    struct pair_measure *forces = forced ? mem_alloc(m->n_pairs, sizeof *forces) : NULL;
    bool room = order != NULL && pairs != NULL && (!forced || forces != NULL);
    for (size_t k = 0; k < m->n_pairs && room; k++) {
        pairs[k] = m->pairs[order[k]];
        if (forced)
            forces[k] = m->forces[order[k]];
    }
    free(order);
    if (!room) {
        free(pairs);
        free(forces);
        return false;
    }
    free(m->pairs);
    m->pairs = pairs;
    m->pairs_cap = m->n_pairs;
    if (forced) {
        free(m->forces);
        m->forces = forces;
        m->forces_cap = m->n_pairs;
    }
    return true;
}

/* Moves the elements together, in the order of their ids. */
static void close_holes(struct state_merge *m)
{
    size_t n = 0;
    for (size_t id = 0; id < m->limits.elements && m->limits.holes > 0; id++) {
        if (!m->seen[id])
            continue;
        m->elements[n] = m->elements[id];
        m->measured[n++] = m->measured[id];
    }
}

enum dm2_status state_merge_finish(struct state_merge *m, struct dm2_error *err)
{
    enum dm2_status status = allocate_arrays(m, err);
    if (status != DM2_OK)
        return status;
    size_t n = m->limits.elements - m->limits.holes;
    if (m->n_seen != n && m->limits.holes > 0)
        return dm2_fail(err, DM2_PROTOCOL, "%zu of %zu elements are missing: a server lost them",
                        n - m->n_seen, n);
    if (m->n_seen != n) {
        const unsigned char *missing = memchr(m->seen, 0, n);
        return dm2_fail(err, DM2_PROTOCOL,
                        "%zu of %zu elements are missing, the first is element %zu: a server lost them",
                        n - m->n_seen, n, (size_t)(missing - m->seen));
    }
    if (!order_pairs(m, m->forces != NULL))
        return dm2_fail(err, DM2_MEMORY, "no memory to sort %zu pairs", m->n_pairs);
    const struct pair_record *sorted = m->pairs;
    for (size_t k = 1; k < m->n_pairs; k++)
        if (sorted[k - 1].id_a == sorted[k].id_a && sorted[k - 1].id_b == sorted[k].id_b)
            return dm2_fail(err, DM2_PROTOCOL, "the pair %u-%u came twice", sorted[k].id_a, sorted[k].id_b);
    for (size_t k = 0; k < m->n_pairs; k++) {
        char text[RECORD_FAULT_TEXT];
        if (!record_pair_reaches(&m->elements[sorted[k].id_a], &m->elements[sorted[k].id_b], &m->limits,
                                 text))
            return dm2_fail(err, DM2_PROTOCOL, "the pair %u-%u %s", sorted[k].id_a, sorted[k].id_b, text);
    }
    for (int k = 0; k < SECTION_COUNT && status == DM2_OK; k++)
        status = section_sort((enum section)k, &m->sections[k], err);
    close_holes(m);
    return status;
}

struct state_view state_merge_view(const struct state_merge *m, int64_t step)
{
    struct state_view view = {.step = step,
                              .elements = m->elements,
                              .n_elements = m->n_seen,
                              .pairs = m->pairs,
                              .n_pairs = m->n_pairs};
    memcpy(view.sections, m->sections, sizeof view.sections);
    return view;
}
