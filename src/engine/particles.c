/* The table `columns` lists the arrays and the physics that needs each array, so that no function that grows,
 * frees or counts arrays can miss an array; find_needs alone tells which physics a model has. An array that
 * no physics of the deck needs is NULL, because memory per element limits the size of a problem. */
#include "particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/real.h"

/* Physics that may need an array. */
enum need {
    ALWAYS = 1,
    FAR = 2,   /* potentials of scope all; or no pairs at all, because one array of sums is always needed */
    NEAR = 4,  /* contacts and links */
    HEAT = 8,  /* a temperature that changes, or that may differ from T0 at the start */
    WORK = 16, /* a body force, or elements of prescribed motion */
    PRESSURE = 32,
    KINDS = 64,
    REACTION = 128,
    STRAIN = 256,
    PERIODIC = 512,
    DAMPING = 1024,
    HOME = 2048 /* bodies that follow a table or turn */
};

struct column {
    size_t offset; /* of the pointer in struct particles */
    size_t bytes;  /* per element */
    enum need need;
};

#define COLUMN(field, count, need)                                                                           \
    {                                                                                                        \
        offsetof(struct particles, field), (count) * sizeof *((struct particles *)0)->field, need            \
    }
static const struct column columns[] = {
    COLUMN(r, 2, ALWAYS),
    COLUMN(v, 2, ALWAYS),
    COLUMN(radius, 1, ALWAYS),
    COLUMN(mass, 1, ALWAYS),
    COLUMN(id, 1, ALWAYS),
    COLUMN(grain, 1, ALWAYS),
    COLUMN(kind, 1, ALWAYS),
    COLUMN(body, 1, ALWAYS),
    COLUMN(flags, 1, ALWAYS),
    COLUMN(probes, 1, ALWAYS),
    COLUMN(w, 1, ALWAYS),
    COLUMN(bonds, 1, NEAR),
    COLUMN(heat, 1, ALWAYS),
    COLUMN(temperature, 1, HEAT),
    COLUMN(soft, 1, HEAT),
    COLUMN(work, 1, WORK),
    COLUMN(p, 1, PRESSURE),
    COLUMN(moved, 1, KINDS),
    COLUMN(was, 1, KINDS),
    COLUMN(share, 2, REACTION),
    COLUMN(strain, 3, STRAIN),
    COLUMN(image, 2, PERIODIC),
    COLUMN(damped, 1, DAMPING),
    COLUMN(home, 2, HOME),
    /* The last four are no part of the state: they hold the sums of one force evaluation. */
    COLUMN(far_sum, 2, FAR),
    COLUMN(pair_sum, SUM_COUNT, NEAR),
    COLUMN(virial, VIRIAL_COUNT, ALWAYS),
    COLUMN(around, AROUND_COUNT, NEAR),
};
enum { COLUMNS = sizeof columns / sizeof columns[0], STATE_COLUMNS = COLUMNS - 4 };

static unsigned find_needs(const struct model *m)
{
    const struct config *c = m->config;
    unsigned needs = ALWAYS | (m->has_near ? NEAR | HEAT : 0u) | (m->has_far || !m->has_near ? FAR : 0u) |
                     (m->has_pressure || m->has_phases ? PRESSURE : 0u) | (m->has_kinds ? KINDS | HEAT : 0u) |
                     (m->reaction.any ? REACTION : 0u) | (m->has_strain ? STRAIN : 0u) |
                     (m->has_damping ? DAMPING : 0u) | (c->periodic[0] || c->periodic[1] ? PERIODIC : 0u) |
                     (c->gravity[0] != 0.0 || c->gravity[1] != 0.0 || c->n_walls > 0 ? WORK : 0u);
    for (size_t b = 0; b < c->n_bodies; b++)
        needs |= (c->bodies[b].motion != MOTION_FREE ? WORK : 0u) | (config_is_placed(c, b) ? HOME : 0u);
    needs |= c->n_loads > 0 ? WORK : 0u;
    for (size_t k = 0; k < m->n_kinds; k++)
        needs |= isfinite(m->kinds[k].cp) ? HEAT : 0u;
    return needs;
}

void particles_start(struct particles *p, const struct model *m)
{
    *p = (struct particles){.groups = find_needs(m)};
}

static bool has_column(const struct particles *p, size_t c)
{
    return (p->groups & columns[c].need) != 0;
}

static void **column_of(struct particles *p, size_t c)
{
    return (void **)(void *)((char *)p + columns[c].offset);
}

int particles_reserve(struct particles *p, size_t n)
{
    if (n < p->cap)
        return 0;
    size_t cap = (p->cap == 0 ? n : n + n / 16) + 1;
    void *grown[COLUMNS] = {NULL};
    for (size_t c = 0; c < COLUMNS; c++) {
        if (!has_column(p, c))
            continue;
        grown[c] = mem_alloc(cap, columns[c].bytes);
        if (grown[c] == NULL) {
            while (c-- > 0)
                free(grown[c]);
            return -1;
        }
    }
    for (size_t c = 0; c < COLUMNS; c++) {
        void **column = column_of(p, c);
        if (p->n > 0 && has_column(p, c))
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
        bytes += has_column(p, c) ? columns[c].bytes * p->cap : 0;
    return bytes;
}

size_t particles_sum_bytes(const struct particles *p)
{
    return p->pair_sum != NULL ? p->cap * SUM_COUNT * sizeof *p->pair_sum : 0;
}

void particles_get(const struct particles *p, size_t i, struct element *out)
{
    *out = (struct element){.id = p->id[i],
                            .grain = p->grain[i],
                            .body = p->body[i],
                            .kind = p->kind[i],
                            .flags = p->flags[i] & ELEMENT_FIXED_MOTION,
                            .probes = p->probes[i],
                            .radius = p->radius[i],
                            .mass = p->mass[i],
                            .r = {p->r[2 * i], p->r[2 * i + 1]},
                            .v = {p->v[2 * i], p->v[2 * i + 1]},
                            .w = p->w[i],
                            .heat = p->heat[i]};
    if (p->groups & NEAR)
        out->bonds = p->bonds[i];
    if (p->groups & WORK)
        out->work = p->work[i];
    if (p->groups & PRESSURE)
        out->p = p->p[i];
    if (p->groups & KINDS) {
        out->moved = p->moved[i];
        out->was = p->was[i];
    }
    if (p->groups & REACTION)
        memcpy(out->share, p->share + 2 * i, sizeof out->share);
    if (p->groups & STRAIN)
        memcpy(out->strain, p->strain + 3 * i, sizeof out->strain);
    if (p->groups & PERIODIC)
        memcpy(out->image, p->image + 2 * i, sizeof out->image);
    if (p->groups & DAMPING)
        out->damped = p->damped[i];
    if (p->groups & HOME)
        memcpy(out->home, p->home + 2 * i, sizeof out->home);
}

void particles_put(struct particles *p, const struct model *m, size_t i, const struct element *in)
{
    for (int a = 0; a < 2; a++) {
        p->r[2 * i + (size_t)a] = in->r[a];
        p->v[2 * i + (size_t)a] = in->v[a];
    }
    p->w[i] = in->w;
    p->heat[i] = in->heat;
    p->radius[i] = in->radius;
    p->mass[i] = in->mass;
    p->id[i] = in->id;
    p->grain[i] = in->grain;
    p->kind[i] = in->kind;
    p->body[i] = in->body;
    p->flags[i] =
        (uint8_t)(in->flags | (m->forced_of != NULL && m->forced_of[in->body] > 0 ? ELEMENT_FORCED : 0));
    p->probes[i] = in->probes;
    if (p->groups & NEAR)
        p->bonds[i] = in->bonds;
    if (p->groups & WORK)
        p->work[i] = in->work;
    if (p->groups & PRESSURE)
        p->p[i] = in->p;
    if (p->groups & KINDS) {
        p->moved[i] = in->moved;
        p->was[i] = in->was;
    }
    if (p->groups & REACTION)
        memcpy(p->share + 2 * i, in->share, sizeof in->share);
    if (p->groups & STRAIN)
        memcpy(p->strain + 3 * i, in->strain, sizeof in->strain);
    if (p->groups & PERIODIC)
        memcpy(p->image + 2 * i, in->image, sizeof in->image);
    if (p->groups & DAMPING)
        p->damped[i] = in->damped;
    if (p->groups & HOME)
        memcpy(p->home + 2 * i, in->home, sizeof in->home);
    particles_warm(p, m, i, 1.0 / p->mass[i]);
}

/* Writes one column in its new order. Inlined with the common widths, so that memcpy becomes a move and not a
 * call. */
static inline void gather_column(char *to, const char *column, const uint32_t *from, size_t n, size_t width)
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
    if (p->n == 0)
        return 0;
    /* The sums are free between evaluations and as wide as any column of the state, because a deck with
     * strain, the widest column, has near pairs and with them pair_sum. */
    char *scratch = (char *)(p->pair_sum != NULL ? p->pair_sum : p->far_sum);
    for (size_t c = 0; c < STATE_COLUMNS; c++) {
        if (!has_column(p, c))
            continue;
        char *column = *column_of(p, c);
        size_t width = columns[c].bytes;
        if (width == 8)
            gather_column(scratch, column, from, n, 8);
        else if (width == 16)
            gather_column(scratch, column, from, n, 16);
        else
            gather_column(scratch, column, from, n, width);
        memcpy(column, scratch, n * width);
    }
    return 0;
}

double particles_heat_capacity(const struct particles *p, const struct model *m, size_t i)
{
    const struct reaction_table *x = &m->reaction;
    const struct kind *kind = &m->kinds[p->kind[i]];
    if (!x->any || (kind->material != x->reactant[0] && kind->material != x->reactant[1] &&
                    kind->material != x->product))
        return kind->cp;
    const int material[3] = {x->reactant[0], x->reactant[1], x->product};
    const double part[3] = {p->share[2 * i], p->share[2 * i + 1],
                            1.0 - p->share[2 * i] - p->share[2 * i + 1]};
    double cp = 0.0;
    for (int k = 0; k < 3; k++)
        cp += part[k] * (material[k] == kind->material ? kind->cp : m->kinds[material[k]].cp);
    return cp;
}
