/* The few pairs of bodies under force are sought once per rebuild, so that a step costs a walk over them
 * alone. The forces between elements of one body cancel in the sum to the last bit. */
#include "load_sums.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "pair_pass.h"

int load_sums_build(struct load_sums *s, const struct model *m, const struct particles *p,
                    const struct lists *l)
{
    s->n_pairs = s->n_slots = 0;
    for (size_t i = 0; i < p->n_own; i++) {
        bool forced = m->forced_of[p->body[i]] > 0;
        if (forced) {
            uint32_t *slot = mem_grown(s->slot, &s->slot_cap, s->n_slots, s->n_slots + 1, sizeof *slot);
            if (slot == NULL)
                return -1;
            s->slot = slot;
            slot[s->n_slots++] = (uint32_t)i;
        }
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
            size_t j = l->near.j[k];
            if (p->body[i] == p->body[j] || !(forced || m->forced_of[p->body[j]] > 0) ||
                !counts_here(p, (uint32_t)i, (uint32_t)j))
                continue;
            struct loaded_pair *pair =
                mem_grown(s->pair, &s->pair_cap, s->n_pairs, s->n_pairs + 1, sizeof *pair);
            if (pair == NULL)
                return -1;
            s->pair = pair;
            pair[s->n_pairs++] = (struct loaded_pair){(uint32_t)i, k};
        }
    }
    return 0;
}

/* Counts a pair of slot i, whose partner is slot j, for the body of i where that is under force. */
static void add_contact(struct load_sums *s, const struct model *m, const struct particles *p, size_t i,
                        size_t j)
{
    size_t forced = m->forced_of[p->body[i]];
    if (forced == 0)
        return;
    struct load_totals *t = &s->own[forced - 1];
    t->contacts++;
    for (size_t a = 0; a < 2; a++) /* in range: the leapfrog bounds all velocities */
        (void)exact_add(&t->speed[a], p->v[2 * j + a], m->scales.velocity);
}

/* Counts contacts of mover number `forced`, none where it is 0, with something of velocity v. */
static void add_touching(struct load_sums *s, const struct model *m, size_t forced, int64_t contacts,
                         const double v[2])
{
    struct load_totals *t = forced > 0 ? &s->own[forced - 1] : NULL;
    if (t != NULL)
        t->contacts += (uint32_t)contacts;
    for (size_t a = 0; t != NULL && a < 2; a++)
        for (int64_t k = 0; k < contacts; k++)
            (void)exact_add(&t->speed[a], v[a], m->scales.velocity);
}

/* Adds walls: the sums that the evaluation has, and the contacts of each element with each wall. These count
 * with their signs, so that a joint or a corner counts as in the law; features come wall by wall. */
static void add_walls(struct load_sums *s, const struct model *m, const struct particles *p,
                      const struct walls *ws)
{
    for (size_t b = 0; b < m->n_forced; b++)
        for (int a = 0; m->forced[b].mover >= m->config->n_bodies && a < 2; a++)
            exact_merge(&s->own[b].force[a], &ws->sums[m->forced[b].mover - m->config->n_bodies].force[a]);
    for (size_t row = 0; row < ws->n_rows; row++) {
        size_t i = ws->slot[row], k = ws->start[row];
        while (k < ws->start[row + 1]) {
            const struct wall *w = walls_of_feature(m, ws->entry[k].feature);
            int64_t contacts = 0;
            for (; k < ws->start[row + 1] && ws->entry[k].feature < w->first + w->n_features; k++)
                contacts += ws->entry[k].sign;
            if (contacts <= 0)
                continue;
            add_touching(s, m, m->forced_of[w->mover], contacts, &p->v[2 * i]);
            add_touching(s, m, m->forced_of[p->body[i]], contacts, ws->pose[w - m->walls].v);
        }
    }
}

void load_sums_add(struct load_sums *s, const struct model *m, const struct particles *p,
                   const struct lists *l, const struct walls *ws)
{
    const struct period period = period_of(&m->grid);
    for (size_t b = 0; b < m->n_forced; b++)
        s->own[b] = (struct load_totals){.contacts = 0};
    for (size_t n = 0; n < s->n_slots; n++) {
        size_t i = s->slot[n];
        const int64_t *sum = p->pair_sum + SUM_COUNT * i;
        struct load_totals *t = &s->own[m->forced_of[p->body[i]] - 1];
        exact_add_units(&t->force[0], sum[SUM_FX], 0);
        exact_add_units(&t->force[1], sum[SUM_FY], 0);
    }
    for (size_t n = 0; n < s->n_pairs; n++) {
        size_t i = s->pair[n].i, k = s->pair[n].k, j = l->near.j[k];
        double d[2], r0 = p->radius[i] + p->radius[j];
        for (size_t a = 0; a < 2; a++)
            d[a] = period_nearest(p->r[2 * i + a] - p->r[2 * j + a], period.size[a], period.half[a]);
        double r2 = d[0] * d[0] + d[1] * d[1];
        if (!l->linked[k] && (law_far_apart(r2, r0) || !law_touches(sqrt(r2), r0)))
            continue;
        add_contact(s, m, p, i, j);
        add_contact(s, m, p, j, i);
    }
    add_walls(s, m, p, ws);
}

void load_sums_free(struct load_sums *s)
{
    free(s->pair);
    free(s->slot);
    *s = (struct load_sums){0};
}

size_t load_sums_bytes(const struct load_sums *s)
{
    return s->pair_cap * sizeof *s->pair + s->slot_cap * sizeof *s->slot;
}
