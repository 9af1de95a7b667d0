/* Sorting near pairs by their law: count, lay out, fill. Rows keep their order within a law, so neighbours in
 * the list are neighbours in space; and laws alternate chunk by chunk, so that elements are still in the
 * cache when the next law needs them. */
#include "links.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "half_list.h"
#include "particles.h"
#include "tables.h"

/* The law of entry k of row i if the pair belongs in a quad, else NULL. */
static const struct pair_law *find_quad_law(const struct half_list *near, const uint8_t *linked,
                                            const struct model *m, const struct particles *p, uint32_t i,
                                            uint32_t k)
{
    uint32_t j = near->j[k];
    if (!linked[k] || particles_walls(p, i, j))
        return NULL;
    const struct pair_law *law = particles_law(m, p, i, j);
    return law->wide && p->radius[i] == law->radius_i && p->radius[j] == law->radius_j ? law : NULL;
}

enum { CHUNK = 2048 }; /* rows; the state and sums of their elements and neighbours are some 300 KB */

/* Turns the n of each group from links to quads and gets room for the quads and the single ones of all
 * `pairs`. 0, or -1 without memory. */
static int lay_out_groups(struct link_list *links, size_t pairs)
{
    size_t quads = 0;
    for (size_t a = 0; a < links->n_groups; a++) {
        struct link_group *g = &links->group[a];
        g->n /= SIMD_LANES;
        g->first = quads;
        quads += g->n;
    }
    struct link_quad *quad = mem_grown(links->quad, &links->quad_cap, 0, quads, sizeof *quad);
    if (quad == NULL)
        return -1;
    links->quad = quad;
    struct single_pair *single =
        mem_grown(links->single, &links->single_cap, 0, pairs - SIMD_LANES * quads, sizeof *single);
    if (single == NULL)
        return -1;
    links->single = single;
    return 0;
}

static int sort_pairs(struct link_list *links, const struct half_list *near, const uint8_t *linked,
                      uint32_t first, uint32_t last, const struct model *m, const struct particles *p)
{
    size_t n_laws = m->n_kinds * m->n_kinds * RELATION_COUNT;
    uint64_t n_groups = (uint64_t)n_laws * (((uint64_t)last - first + CHUNK - 1) / CHUNK);
    if (n_groups > SIZE_MAX)
        return -1;
    links->n_groups = (size_t)n_groups;
    struct link_group *groups =
        mem_grown(links->group, &links->group_cap, 0, links->n_groups, sizeof *groups);
    if (groups == NULL)
        return -1;
    links->group = groups;
    for (size_t a = 0; a < links->n_groups; a++)
        groups[a] = (struct link_group){.law = &m->laws[a % n_laws]};
    for (uint32_t i = first; i < last; i++) {
        struct link_group *group = &groups[(i - first) / CHUNK * n_laws];
        for (uint32_t k = near->start[i]; k < near->start[i + 1]; k++) {
            const struct pair_law *law = find_quad_law(near, linked, m, p, i, k);
            if (law != NULL)
                group[law - m->laws].n++;
        }
    }
    size_t *placed = mem_zalloc(n_laws, sizeof *placed);
    if (placed == NULL || lay_out_groups(links, near->start[last] - near->start[first]) != 0) {
        free(placed);
        return -1;
    }
    links->n_single = 0;
    for (uint32_t i = first; i < last; i++) {
        const struct link_group *group = &groups[(i - first) / CHUNK * n_laws];
        if ((i - first) % CHUNK == 0)
            memset(placed, 0, n_laws * sizeof *placed);
        for (uint32_t k = near->start[i]; k < near->start[i + 1]; k++) {
            const struct pair_law *law = find_quad_law(near, linked, m, p, i, k);
            size_t a = law != NULL ? (size_t)(law - m->laws) : 0;
            if (law == NULL || placed[a] == SIMD_LANES * group[a].n) {
                links->single[links->n_single++] = (struct single_pair){i, k};
                continue;
            }
            struct link_quad *q = &links->quad[group[a].first + placed[a] / SIMD_LANES];
            size_t lane = placed[a]++ % SIMD_LANES;
            q->i[lane] = i;
            q->j[lane] = near->j[k];
            q->k[lane] = k;
        }
    }
    free(placed);
    return 0;
}

int link_list_prepare(struct link_list *links, const struct half_list *near, const uint8_t *linked,
                      uint32_t first, uint32_t last, const struct model *m, const struct particles *p)
{
    if (links->valid && (!m->has_kinds || memcmp(links->kind, p->kind, p->n * sizeof *p->kind) == 0))
        return 0;
    links->valid = false;
    if (sort_pairs(links, near, linked, first, last, m, p) != 0)
        return -1;
    if (m->has_kinds) {
        uint16_t *kind = mem_grown(links->kind, &links->kind_cap, 0, p->n, sizeof *kind);
        if (kind == NULL)
            return -1;
        links->kind = kind;
        memcpy(kind, p->kind, p->n * sizeof *p->kind);
    }
    links->valid = true;
    return 0;
}

void link_list_free(struct link_list *links)
{
    free(links->quad);
    free(links->group);
    free(links->single);
    free(links->kind);
    *links = (struct link_list){0};
}

size_t link_list_bytes(const struct link_list *links)
{
    return links->quad_cap * sizeof *links->quad + links->group_cap * sizeof *links->group +
           links->single_cap * sizeof *links->single + links->kind_cap * sizeof *links->kind;
}
