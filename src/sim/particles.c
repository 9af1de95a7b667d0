/* The arrays of a subdomain. One table lists them, so that growing, freeing and counting cannot forget one. */
#include "dm2/sim/particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/real.h"

struct column {
    size_t offset; /* of the pointer in struct particles */
    size_t bytes;  /* per element */
};

#define COLUMN(field, count) {offsetof(struct particles, field), (count) * sizeof *((struct particles *)0)->field}
static const struct column columns[] = {
    COLUMN(r, 2),      COLUMN(v, 2),     COLUMN(w, 1),     COLUMN(radius, 1),  COLUMN(mass, 1),
    COLUMN(temperature, 1), COLUMN(soft, 1), COLUMN(p, 1), COLUMN(heat, 1),   COLUMN(work, 1),
    COLUMN(id, 1),     COLUMN(grain, 1), COLUMN(kind, 1),  COLUMN(body, 1),    COLUMN(flags, 1),
    COLUMN(probes, 1), COLUMN(strain, 3), COLUMN(bonds, 1),
    COLUMN(share, 2),  COLUMN(moved, 1), COLUMN(was, 1),
    /* what only one force evaluation needs */
    COLUMN(far_sum, 2), COLUMN(pair_sum, SUM_COUNT), COLUMN(virial, 3), COLUMN(around, AROUND_COUNT),
    COLUMN(links, 1), COLUMN(contacts, 1),
};
enum { COLUMNS = sizeof columns / sizeof columns[0], STATE_COLUMNS = COLUMNS - 6 };

static void **column_of(struct particles *p, size_t c)
{
    return (void **)(void *)((char *)p + columns[c].offset);
}

int particles_reserve(struct particles *p, size_t n)
{
    if (n < p->cap)
        return 0;
    size_t cap = (p->cap == 0 ? n : n + n / 16) + 1;
    void *grown[COLUMNS];
    for (size_t c = 0; c < COLUMNS; c++) {
        grown[c] = mem_alloc(cap, columns[c].bytes);
        if (grown[c] == NULL) {
            while (c-- > 0)
                free(grown[c]);
            return -1;
        }
    }
    for (size_t c = 0; c < COLUMNS; c++) {
        void **column = column_of(p, c);
        if (p->n > 0)
            memcpy(grown[c], *column, p->n * columns[c].bytes);
        free(*column);
        *column = grown[c];
    }
    p->cap = cap;
    return 0;
}

void particles_free(struct particles *p)
{
    for (size_t c = 0; c < COLUMNS; c++)
        free(*column_of(p, c));
    *p = (struct particles){0};
}

size_t particles_bytes(const struct particles *p)
{
    size_t bytes = 0;
    for (size_t c = 0; c < COLUMNS; c++)
        bytes += columns[c].bytes * p->cap;
    return bytes;
}

void particles_get(const struct particles *p, size_t i, struct element *out)
{
    *out = (struct element){.id = p->id[i], .grain = p->grain[i], .body = p->body[i], .kind = p->kind[i],
                            .flags = p->flags[i], .probes = p->probes[i], .radius = p->radius[i], .mass = p->mass[i],
                            .r = {p->r[2 * i], p->r[2 * i + 1]}, .v = {p->v[2 * i], p->v[2 * i + 1]}, .w = p->w[i],
                            .heat = p->heat[i], .p = p->p[i], .work = p->work[i],
                            .strain = {p->strain[3 * i], p->strain[3 * i + 1], p->strain[3 * i + 2]},
                            .share = {p->share[2 * i], p->share[2 * i + 1]}, .moved = p->moved[i],
                            .was = p->was[i], .bonds = p->bonds[i]};
}

void particles_put(struct particles *p, const struct model *m, size_t i, const struct element *in)
{
    for (int a = 0; a < 2; a++) {
        p->r[2 * i + (size_t)a] = in->r[a];
        p->v[2 * i + (size_t)a] = in->v[a];
        p->share[2 * i + (size_t)a] = in->share[a];
    }
    p->w[i] = in->w;
    p->radius[i] = in->radius;
    p->mass[i] = in->mass;
    p->p[i] = in->p;
    p->heat[i] = in->heat;
    p->work[i] = in->work;
    p->id[i] = in->id;
    p->grain[i] = in->grain;
    p->kind[i] = in->kind;
    p->body[i] = in->body;
    p->flags[i] = in->flags;
    p->probes[i] = in->probes;
    memcpy(p->strain + 3 * i, in->strain, sizeof in->strain);
    p->bonds[i] = in->bonds;
    p->moved[i] = in->moved;
    p->was[i] = in->was;
    particles_warm(p, m, i, 1.0 / p->mass[i]);
}

/* One column in its new order. Inlined with the common widths, so that a copy is a move and not a call. */
static inline void gather(char *to, const char *column, const uint32_t *from, size_t n, size_t width)
{
    for (size_t k = 0; k < n; k++) {
        if (from[k] != PARTICLES_NONE)
            memcpy(to + k * width, column + from[k] * width, width);
    }
}

int particles_permute(struct particles *p, const uint32_t *from, size_t n)
{
    if (particles_reserve(p, n) != 0)
        return -1;
    if (n == 0)
        return 0;
    char *scratch = (char *)p->pair_sum; /* free between evaluations, and wider than any column of the state */
    for (size_t c = 0; c < STATE_COLUMNS; c++) {
        char *column = *column_of(p, c);
        size_t width = columns[c].bytes;
        if (width == 8)
            gather(scratch, column, from, n, 8);
        else if (width == 16)
            gather(scratch, column, from, n, 16);
        else
            gather(scratch, column, from, n, width);
        memcpy(column, scratch, n * width);
    }
    return 0;
}

double particles_heat_capacity(const struct particles *p, const struct model *m, size_t i)
{
    const struct reaction_table *x = &m->reaction;
    const struct kind *kind = &m->kinds[p->kind[i]];
    if (!x->any || (kind->material != x->reactant[0] && kind->material != x->reactant[1] && kind->material != x->product))
        return kind->cp;
    const int material[3] = {x->reactant[0], x->reactant[1], x->product};
    const double part[3] = {p->share[2 * i], p->share[2 * i + 1], 1.0 - p->share[2 * i] - p->share[2 * i + 1]};
    double cp = 0.0;
    for (int k = 0; k < 3; k++)
        cp += part[k] * (material[k] == kind->material ? kind->cp : m->kinds[material[k]].cp);
    return cp;
}
