/* Elements that a deck makes beside those of a state: generated and linked among themselves in a subdomain of
 * their own. None may be pressed into an element of the state, because a link that would let a pair stand
 * closer is none between bodies that meet. */
#include "stage_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/engine/subdomain.h"
#include "periodic.h"
#include "tables.h"

static const double pressed_below = 0.98; /* of the contact distance */

static enum dm2_status no_memory(size_t n, struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "no memory for %zu elements", n);
}

/* --- overlap --- */

/* The elements of the state by cell: item[start[cell]] .. item[start[cell + 1] - 1]. */
struct by_cell {
    uint32_t *start, *item;
};

static bool sort_by_cell(const struct grid *g, const struct element *e, size_t n, struct by_cell *out)
{
    size_t cells = (size_t)g->cx * (size_t)g->cy;
    *out = (struct by_cell){mem_zalloc(cells + 2, sizeof *out->start), mem_zalloc(n, sizeof *out->item)};
    if (out->start == NULL || out->item == NULL)
        return false;
    for (size_t k = 0; k < n; k++)
        out->start[grid_cell(g, e[k].r[0], e[k].r[1]) + 2]++;
    for (size_t c = 0; c < cells; c++)
        out->start[c + 2] += out->start[c + 1];
    for (size_t k = 0; k < n; k++)
        out->item[out->start[grid_cell(g, e[k].r[0], e[k].r[1]) + 1]++] = (uint32_t)k;
    return true;
}

/* Adds the pressed pairs of a new element with the elements of one cell. */
static void search_cell(const struct model *m, const struct by_cell *by, int cell, const struct element *old,
                        const struct element *e, struct overlap *deepest)
{
    const struct period period = period_of(&m->grid);
    for (uint32_t k = by->start[cell]; k < by->start[cell + 1]; k++) {
        const struct element *o = &old[by->item[k]];
        double dx = period_nearest(o->r[0] - e->r[0], period.size[0], period.half[0]),
               dy = period_nearest(o->r[1] - e->r[1], period.size[1], period.half[1]),
               ratio = sqrt(dx * dx + dy * dy) / (o->radius + e->radius);
        struct overlap pair = {.pairs = 1,
                               .ratio = ratio,
                               .id = {o->id, e->id},
                               .body = {o->body, e->body},
                               .r = {{o->r[0], o->r[1]}, {e->r[0], e->r[1]}}};
        if (ratio < pressed_below)
            overlap_merge(deepest, &pair);
    }
}

static enum dm2_status check_room(const struct model *m, const struct element *old, size_t n_old,
                                  const struct element *new, size_t n_new, struct dm2_error *err)
{
    const struct config *c = m->config;
    struct by_cell by;
    struct overlap o = {0};
    bool ok = sort_by_cell(&m->grid, old, n_old, &by);
    for (size_t k = 0; k < n_new && ok; k++) {
        int around[8], cell = grid_cell(&m->grid, new[k].r[0], new[k].r[1]);
        int n = grid_neighbours(&m->grid, cell, around);
        search_cell(m, &by, cell, old, &new[k], &o);
        for (int i = 0; i < n; i++)
            search_cell(m, &by, around[i], old, &new[k], &o);
    }
    free(by.start);
    free(by.item);
    if (!ok)
        return no_memory(n_old, err);
    if (o.pairs == 0)
        return DM2_OK;
    return dm2_fail(
        err, DM2_DECK,
        "%llu new elements are pressed into elements of the state; the deepest, element %u of '%s' at "
        "(%.6g, %.6g) cm and new element %u of '%s' at (%.6g, %.6g) cm, stand at %.3g of their "
        "contact distance: move the new body, or leave the other one out",
        (unsigned long long)o.pairs, o.id[0], c->bodies[o.body[0]].name, o.r[0][0], o.r[0][1], o.id[1],
        c->bodies[o.body[1]].name, o.r[1][0], o.r[1][1], o.ratio);
}

/* --- elements --- */

/* Appends the records of a subdomain that has the new elements alone. */
static enum dm2_status append_records(const struct model *m, const struct subdomain *sd,
                                      struct stage_records *s, struct dm2_error *err)
{
    size_t n = subdomain_owned(sd), n_pairs = 0;
    struct pair_record *pairs = NULL, *all_pairs = NULL;
    struct element *all = mem_alloc(s->n_elements + n, sizeof *all);
    enum dm2_status status = all == NULL ? no_memory(n, err) : DM2_OK;
    if (status == DM2_OK)
        status = subdomain_collect(sd, all + s->n_elements, NULL, err);
    if (status == DM2_OK)
        status = check_room(m, s->elements, s->n_elements, all + s->n_elements, n, err);
    if (status == DM2_OK)
        status = subdomain_collect_pairs(sd, &pairs, &n_pairs, err);
    if (status == DM2_OK && (all_pairs = mem_alloc(s->n_pairs + n_pairs, sizeof *pairs)) == NULL)
        status = no_memory(n, err);
    if (status == DM2_OK)
        status = subdomain_collect_sections(sd, s->sections, err);
    if (status != DM2_OK) {
        free(all);
        free(pairs);
        return status;
    }
    memcpy(all, s->elements, s->n_elements * sizeof *all);
    memcpy(all_pairs, s->pairs, s->n_pairs * sizeof *pairs);
    memcpy(all_pairs + s->n_pairs, pairs, n_pairs * sizeof *pairs);
    free(pairs);
    free(s->elements);
    free(s->pairs);
    s->elements = all;
    s->n_elements += n;
    s->pairs = all_pairs;
    s->n_pairs += n_pairs;
    return DM2_OK;
}

/* --- links --- */

static bool comes_before(const struct pair_record *a, const struct pair_record *b)
{
    return a->id_a != b->id_a ? a->id_a < b->id_a : a->id_b < b->id_b;
}

/* Gives a link the stretch with which it has no force at its present length. */
static void relax_link(const struct model *m, const struct stage_records *s, struct pair_record *p)
{
    const struct period period = period_of(&m->grid);
    const struct element *a = &s->elements[element_find(s->elements, s->n_elements, p->id_a)],
                         *b = &s->elements[element_find(s->elements, s->n_elements, p->id_b)];
    double dx = period_nearest(a->r[0] - b->r[0], period.size[0], period.half[0]),
           dy = period_nearest(a->r[1] - b->r[1], period.size[1], period.half[1]);
    p->stretch = sqrt(dx * dx + dy * dy) - (a->radius + b->radius);
}

/* Adds the links to the pairs of the state, in order; a link replaces what its pair had. */
static enum dm2_status merge_links(const struct model *m, struct stage_records *s,
                                   const struct pair_record *links, size_t n, struct dm2_error *err)
{
    struct pair_record *all = mem_alloc(s->n_pairs + n, sizeof *all);
    size_t used = 0, old = 0;
    if (all == NULL)
        return no_memory(s->n_elements, err);
    for (size_t k = 0; k < n; k++) {
        while (old < s->n_pairs && comes_before(&s->pairs[old], &links[k]))
            all[used++] = s->pairs[old++];
        old += old < s->n_pairs && !comes_before(&links[k], &s->pairs[old]);
        all[used] = links[k];
        relax_link(m, s, &all[used++]);
    }
    while (old < s->n_pairs)
        all[used++] = s->pairs[old++];
    free(s->pairs);
    s->pairs = all;
    s->n_pairs = used;
    return DM2_OK;
}

/* Takes the links of a subdomain that has the elements of the state. */
static enum dm2_status take_links(const struct model *m, const struct subdomain *sd, struct stage_records *s,
                                  struct dm2_error *err)
{
    size_t n = 0;
    struct pair_record *links = NULL;
    struct element *linked = mem_alloc(s->n_elements, sizeof *linked);
    enum dm2_status status =
        linked == NULL ? no_memory(s->n_elements, err) : subdomain_collect(sd, linked, NULL, err);
    for (size_t k = 0; k < s->n_elements && status == DM2_OK; k++)
        s->elements[k].bonds = linked[k].bonds;
    free(linked);
    if (status == DM2_OK)
        status = subdomain_collect_pairs(sd, &links, &n, err);
    if (status == DM2_OK)
        status = merge_links(m, s, links, n, err);
    free(links);
    return status;
}

enum dm2_status stage_form_links(const struct model *model, struct stage_records *records,
                                 struct dm2_error *err)
{
    const struct grid *g = &model->grid;
    uint16_t *owner = mem_zalloc((size_t)g->cx * (size_t)g->cy, sizeof *owner);
    if (owner == NULL)
        return no_memory(records->n_elements, err);
    const struct domain_map map = {.grid = g, .ranks = 1, .owner = owner};
    struct subdomain *sd = NULL;
    enum dm2_status status = subdomain_link(model, &map, 0, records->elements, records->n_elements, &sd, err);
    if (status == DM2_OK)
        status = take_links(model, sd, records, err);
    subdomain_free(sd);
    free(owner);
    return status;
}

/* --- all new elements --- */

enum dm2_status stage_add_new(const struct model *model, struct stage_records *records, struct dm2_error *err)
{
    const struct grid *g = &model->grid;
    bool any = false;
    for (size_t b = 0; b < model->config->n_bodies; b++)
        any |= !model->config->bodies[b].from_state;
    if (!any)
        return DM2_OK;
    uint16_t *owner = mem_zalloc((size_t)g->cx * (size_t)g->cy, sizeof *owner);
    if (owner == NULL)
        return no_memory(records->n_elements, err);
    const struct domain_map map = {.grid = g, .ranks = 1, .owner = owner};
    struct subdomain *sd = NULL;
    enum dm2_status status = subdomain_create(model, &map, 0, &sd, err);
    if (status == DM2_OK)
        status = overlap_check(subdomain_overlap(sd), model->config, err);
    if (status == DM2_OK)
        status = append_records(model, sd, records, err);
    subdomain_free(sd);
    free(owner);
    return status;
}
