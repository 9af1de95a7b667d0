/* One subdomain: who is in it, and the order of things in a time step. The parts are in their own files:
 * cells.c, lists.c, force.c, leapfrog.c.
 *
 * Invariants between calls: owned elements are slots [0, n_own) in cell order; mirrored ones follow, sorted
 * by (owner, id), so that each rank's mirrors are one range in the order in which that rank sends their
 * updates: its send lists are sorted by id. Both sides derive these orders from the elements alone; no ids
 * travel in an update.
 *
 * At a rebuild an element's new cell decides its new owner and who mirrors it. The old owner knows the whole
 * partition, so it sends everything in one parcel per rank: migrants with the memory of their pairs, and
 * mirrors also of those that it sends away. */
#include "dm2/engine/subdomain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/base/idmap.h"
#include "dm2/base/mem.h"
#include "cells.h"
#include "force.h"
#include "generate.h"
#include "leapfrog.h"
#include "lists.h"
#include "pair_pass.h"
#include "phase.h"
#include "reaction.h"
#include "state_reader.h"
#include "strain.h"

/* A block that is kept from rebuild to rebuild: getting a large one anew costs more than filling it. */
struct block {
    void *item;
    size_t cap; /* bytes */
};

static void *block_hold(struct block *b, size_t count, size_t size)
{
    if (size != 0 && count > SIZE_MAX / 2 / size)
        return NULL;
    return mem_grow(&b->item, &b->cap, 0, count * size + 1, 1) == 0 ? b->item : NULL;
}

struct element_array {
    struct element *item;
    size_t n, cap;
};

struct pair_array {
    struct pair_record *item;
    size_t n, cap;
};

struct slot_array {
    uint32_t *item;
    size_t n, cap;
};

/* What this rank gives to and gets from one other rank. */
struct peer {
    struct element_array migrants, mirrors; /* of the parcel being made */
    struct pair_array pairs;
    struct slot_array send;          /* owned slots that it mirrors, by id */
    size_t mirror_begin, mirror_end; /* slots mirrored from it */
};

struct subdomain {
    const struct model *model;
    struct domain_map map;
    int rank;
    int64_t step;
    struct cells cells;
    struct particles p;
    struct lists lists;
    struct peer *peers;               /* [ranks] */
    struct idmap ids;                 /* of mirrored elements and immigrants, for the memory of pairs */
    struct block from, moved, old_id; /* of settle */
    struct block
        anchors; /* positions at the last rebuild: 2 doubles each; of mirrored elements where surveys_close */
    struct block spreads; /* of a survey's bins, where the pair sums have no room for them */
    struct bins near_by;  /* the anchors, for surveys; edges longer than R_c + dR */
    bool binned;          /* they have been sorted since the last rebuild */
    int32_t *cell_of;     /* global cell of each owned slot at the last sort_out; -1: emigrated */
    size_t cell_cap;
    size_t n_leaving; /* emigrants of the last sort_out, still in their slots until take_in */
    struct pair_totals totals;
    struct pass pass; /* the evaluation under way, where one was begun ahead */
    struct strain_sums strain;
    struct reaction_sums reacted; /* of the last evaluation */
    bool measured; /* totals, virial, surroundings, links and contacts are of the present step */
    struct subdomain_times times;
};

static enum dm2_status no_memory(const struct subdomain *sd, struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "no memory for a subdomain of %zu elements", sd->p.n);
}

static int reserve_elements(struct element_array *a, size_t n)
{
    void *block = a->item;
    int status = mem_grow(&block, &a->cap, a->n, n, sizeof *a->item);
    a->item = block;
    return status;
}

static int add_element(struct element_array *a, const struct element *e)
{
    void *block = a->item;
    int status = mem_grow(&block, &a->cap, a->n, a->n + 1, sizeof *a->item);
    a->item = block;
    if (status == 0)
        a->item[a->n++] = *e;
    return status;
}

static int add_pair(struct pair_array *a, const struct pair_record *pair)
{
    void *block = a->item;
    int status = mem_grow(&block, &a->cap, a->n, a->n + 1, sizeof *a->item);
    a->item = block;
    if (status == 0)
        a->item[a->n++] = *pair;
    return status;
}

static int add_slot(struct slot_array *a, uint32_t slot)
{
    void *block = a->item;
    int status = mem_grow(&block, &a->cap, a->n, a->n + 1, sizeof *a->item);
    a->item = block;
    if (status == 0)
        a->item[a->n++] = slot;
    return status;
}

/* Between any two pieces of work that take long. */
static void beat(const struct subdomain *sd)
{
    pulse_beat(&sd->model->pulse);
}

static int cell_of_element(const struct subdomain *sd, const double r[2])
{
    return grid_cell(sd->map.grid, r[0], r[1]);
}

/* --- taking elements in --- */

struct keyed {
    uint64_t key; /* owner, id */
    const struct element *e;
};

static int by_key(const void *a, const void *b)
{
    const struct keyed *ka = a, *kb = b;
    return ka->key < kb->key ? -1 : ka->key > kb->key;
}

/* Counts per own cell, then new slots: stayers first in a cell, then newcomers. from[slot] is the old slot or
 * PARTICLES_NONE; newcomer_slot[k] where newcomer k goes; moved[old slot] is the new slot of a stayer. */
static void assign_slots(struct subdomain *sd, size_t n_old, const struct element *const *newcomers,
                         size_t n_new, uint32_t *from, uint32_t *newcomer_slot, uint32_t *moved)
{
    struct cells *c = &sd->cells;
    memset(c->start, 0, ((size_t)c->n_own + 1) * sizeof *c->start);
    for (size_t i = 0; i < n_old; i++) {
        if (sd->cell_of[i] >= 0)
            c->start[c->local_of[sd->cell_of[i]] + 1]++;
    }
    for (size_t k = 0; k < n_new; k++)
        c->start[c->local_of[cell_of_element(sd, newcomers[k]->r)] + 1]++;
    for (int cell = 0; cell < c->n_own; cell++)
        c->start[cell + 1] += c->start[cell];
    /* start[cell] is used as the cursor of its cell and ends as start[cell + 1]; then all are shifted back.
     */
    for (size_t i = 0; i < n_old; i++) {
        moved[i] = PARTICLES_NONE;
        if (sd->cell_of[i] < 0)
            continue;
        uint32_t slot = c->start[c->local_of[sd->cell_of[i]]]++;
        from[slot] = (uint32_t)i;
        moved[i] = slot;
    }
    for (size_t k = 0; k < n_new; k++) {
        uint32_t slot = c->start[c->local_of[cell_of_element(sd, newcomers[k]->r)]]++;
        from[slot] = PARTICLES_NONE;
        newcomer_slot[k] = slot;
    }
    for (int cell = c->n_own; cell > 0; cell--)
        c->start[cell] = c->start[cell - 1];
    c->start[0] = 0;
}

/* Puts the mirrors into slots from n_own on, sorted by (owner, id), and notes each rank's range. */
static enum dm2_status place_mirrors(struct subdomain *sd, struct keyed *mirrors, size_t n,
                                     struct dm2_error *err)
{
    int32_t *cells = mem_alloc(n, sizeof *cells);
    if (cells == NULL)
        return no_memory(sd, err);
    qsort(mirrors, n, sizeof *mirrors, by_key);
    for (int r = 0; r < sd->map.ranks; r++)
        sd->peers[r].mirror_begin = sd->peers[r].mirror_end = 0;
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < n && status == DM2_OK; k++) {
        size_t slot = sd->p.n_own + k, owner = (size_t)(mirrors[k].key >> 32);
        struct peer *peer = &sd->peers[owner];
        if (peer->mirror_end == 0)
            peer->mirror_begin = slot;
        peer->mirror_end = slot + 1;
        cells[k] = cell_of_element(sd, mirrors[k].e->r);
        particles_put(&sd->p, sd->model, slot, mirrors[k].e);
        if (!idmap_add(&sd->ids, mirrors[k].e->id, (int32_t)slot))
            status = dm2_fail(err, DM2_PROTOCOL, "step %lld: element %u came twice to server %d",
                              (long long)sd->step, mirrors[k].e->id, sd->rank);
    }
    if (status == DM2_OK && cells_assign_mirrored(&sd->cells, &sd->p, cells) != 0)
        status = no_memory(sd, err);
    free(cells);
    return status;
}

struct id_slot {
    uint32_t id, slot;
};

static int by_id(const void *a, const void *b)
{
    const struct id_slot *ia = a, *ib = b;
    return ia->id < ib->id ? -1 : ia->id > ib->id;
}

static int sort_slots_by_id(const struct particles *p, uint32_t *slots, size_t n)
{
    struct id_slot *order = mem_alloc(n, sizeof *order);
    if (order == NULL)
        return -1;
    for (size_t k = 0; k < n; k++)
        order[k] = (struct id_slot){p->id[slots[k]], slots[k]};
    qsort(order, n, sizeof *order, by_id);
    for (size_t k = 0; k < n; k++)
        slots[k] = order[k].slot;
    free(order);
    return 0;
}

/* Which owned elements each rank mirrors: those in own cells that it sees (the inner boundary). */
static int build_send_lists(struct subdomain *sd)
{
    const struct cells *c = &sd->cells;
    for (int r = 0; r < sd->map.ranks; r++)
        sd->peers[r].send.n = 0;
    for (int own = 0; own < c->n_own; own++) {
        uint16_t ranks[8];
        if (!c->seen_by[c->global_of[own]])
            continue;
        int n = domain_map_mirrored_by(&sd->map, c->global_of[own], ranks);
        for (int k = 0; k < n; k++) {
            for (uint32_t i = c->start[own]; i < c->start[own + 1]; i++) {
                if (add_slot(&sd->peers[ranks[k]].send, i) != 0)
                    return -1;
            }
        }
    }
    for (int r = 0; r < sd->map.ranks; r++) {
        if (sort_slots_by_id(&sd->p, sd->peers[r].send.item, sd->peers[r].send.n) != 0)
            return -1;
    }
    return 0;
}

/* New slot of an element that was in old slot i: a stayer's, else that of the newcomer or mirror of its id.
 */
static int32_t new_slot(const struct subdomain *sd, const uint32_t *moved, size_t n_old, size_t i,
                        uint32_t id)
{
    if (i < n_old && moved[i] != PARTICLES_NONE)
        return (int32_t)moved[i];
    return idmap_find(&sd->ids, id);
}

/* Keeps the memory of a pair if both elements are here and one is owned: counts it, or places it. */
static void carry(struct subdomain *sd, bool place, int32_t a, int32_t b, struct carried_pair pair)
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

/* What the lists remember, in new slots. old_id[] are the ids of all old slots, mirrored ones too. */
static void carry_memory(struct subdomain *sd, bool place, size_t n_old, const uint32_t *moved,
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
            carry(sd, place, new_slot(sd, moved, n_old, i, old_id[i]),
                  new_slot(sd, moved, n_old, j, old_id[j]), pair);
        }
    }
}

/* New slot by id alone: mirrors and newcomers are in the map; stayers are looked up among `stayers`, sorted
 * by id. */
static int32_t slot_of_id(const struct subdomain *sd, const struct id_slot *stayers, size_t n, uint32_t id)
{
    struct id_slot key = {.id = id};
    int32_t slot = idmap_find(&sd->ids, id);
    if (slot >= 0 || n == 0)
        return slot;
    const struct id_slot *found = bsearch(&key, stayers, n, sizeof *stayers, by_id);
    return found != NULL ? (int32_t)found->slot : -1;
}

/* The stayers by id, for carry_parcels; NULL without memory. */
static struct id_slot *sort_stayers(const uint32_t *moved, const uint32_t *old_id, size_t n_old, size_t *n)
{
    struct id_slot *stayers = mem_alloc(n_old, sizeof *stayers);
    *n = 0;
    for (size_t i = 0; stayers != NULL && i < n_old; i++) {
        if (moved[i] != PARTICLES_NONE)
            stayers[(*n)++] = (struct id_slot){old_id[i], moved[i]};
    }
    if (stayers != NULL)
        qsort(stayers, *n, sizeof *stayers, by_id);
    return stayers;
}

/* What came with the migrants. */
static void carry_parcels(struct subdomain *sd, bool place, const struct parcel *parcels, size_t n_parcels,
                          const struct id_slot *stayers, size_t n)
{
    for (size_t q = 0; q < n_parcels; q++) {
        for (size_t k = 0; k < parcels[q].n_pairs; k++) {
            const struct pair_record *from = &parcels[q].pairs[k];
            struct carried_pair pair = {
                .linked = from->linked != 0, .stretch = from->stretch, .spring = from->spring};
            carry(sd, place, slot_of_id(sd, stayers, n, from->id_a), slot_of_id(sd, stayers, n, from->id_b),
                  pair);
        }
    }
}

/* Hands all memory over to the lists to be built: once to count, once to place. 0, or -1 without memory. */
static int carry_all(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels, size_t n_old,
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
            carry_memory(sd, place, n_old, moved, old_id);
        if (status == 0)
            carry_parcels(sd, place, parcels, n_parcels, stayers, n);
    }
    free(stayers);
    return status;
}

/* Everything that take_in gathers before it changes the arrays. */
struct intake {
    const struct element **newcomers;
    struct keyed *mirrors;
    size_t n_newcomers, n_mirrors;
};

static bool kinds_known(const struct model *m, const struct element *e)
{
    return e->kind < m->n_kinds && e->was < m->n_kinds;
}

static enum dm2_status gather(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                              struct intake *in, struct dm2_error *err)
{
    size_t most_new = 0, most_mirrors = 0;
    for (size_t q = 0; q < n_parcels; q++) {
        most_new += parcels[q].n_migrants;
        most_mirrors += parcels[q].n_mirrors;
    }
    in->newcomers = mem_alloc(most_new, sizeof *in->newcomers);
    in->mirrors = mem_alloc(most_mirrors, sizeof *in->mirrors);
    if (in->newcomers == NULL || in->mirrors == NULL)
        return no_memory(sd, err);
    for (size_t q = 0; q < n_parcels; q++) {
        for (size_t k = 0; k < parcels[q].n_migrants; k++) {
            const struct element *e = &parcels[q].migrants[k];
            if (!kinds_known(sd->model, e) || sd->map.owner[cell_of_element(sd, e->r)] != sd->rank)
                return dm2_fail(err, DM2_PROTOCOL,
                                "step %lld: element %u at (%g, %g) cm came to server %d, which does not own "
                                "its cell",
                                (long long)sd->step, e->id, e->r[0], e->r[1], sd->rank);
            in->newcomers[in->n_newcomers++] = e;
        }
        for (size_t k = 0; k < parcels[q].n_mirrors; k++) {
            const struct element *e = &parcels[q].mirrors[k];
            int cell = cell_of_element(sd, e->r);
            if (!kinds_known(sd->model, e) || sd->cells.local_of[cell] < sd->cells.n_own)
                return dm2_fail(
                    err, DM2_PROTOCOL,
                    "step %lld: element %u at (%g, %g) cm came as a mirror to server %d, which does "
                    "not mirror its cell",
                    (long long)sd->step, e->id, e->r[0], e->r[1], sd->rank);
            in->mirrors[in->n_mirrors++] = (struct keyed){(uint64_t)sd->map.owner[cell] << 32 | e->id, e};
        }
    }
    return DM2_OK;
}

/* Puts everybody into slots in cell order and hands the memory of pairs over to the lists to be built. */
static enum dm2_status arrange(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                               bool initial, struct dm2_error *err)
{
    size_t n_old = sd->p.n_own, n_all_old = sd->p.n, stayers = 0;
    struct intake in = {0};
    uint32_t *from = NULL, *newcomer_slot = NULL, *moved = NULL, *old_id = NULL;
    enum dm2_status status = gather(sd, parcels, n_parcels, &in, err);
    if (status != DM2_OK)
        goto done;
    for (size_t i = 0; i < n_old; i++)
        stayers += sd->cell_of[i] >= 0;
    size_t n_own = stayers + in.n_newcomers, n = n_own + in.n_mirrors;
    if (n > INT32_MAX) {
        status = dm2_fail(err, DM2_NUMERIC, "a subdomain holds more than 2^31 elements: use more servers");
        goto done;
    }
    from = block_hold(&sd->from, n, sizeof *from);
    newcomer_slot = mem_alloc(in.n_newcomers, sizeof *newcomer_slot);
    moved = block_hold(&sd->moved, n_old, sizeof *moved);
    old_id = block_hold(&sd->old_id, n_all_old, sizeof *old_id);
    status = DM2_MEMORY;
    if (from == NULL || newcomer_slot == NULL || moved == NULL || old_id == NULL ||
        idmap_prepare(&sd->ids, in.n_newcomers + in.n_mirrors) != 0)
        goto done;
    if (n_all_old > 0)
        memcpy(old_id, sd->p.id, n_all_old * sizeof *old_id);
    assign_slots(sd, n_old, in.newcomers, in.n_newcomers, from, newcomer_slot, moved);
    for (size_t k = n_own; k < n; k++)
        from[k] = PARTICLES_NONE;
    beat(sd);
    if (particles_permute(&sd->p, from, n) != 0)
        goto done;
    sd->p.n_own = n_own;
    sd->p.n = n;
    sd->n_leaving = 0;
    beat(sd);
    for (size_t k = 0; k < in.n_newcomers; k++) {
        particles_put(&sd->p, sd->model, newcomer_slot[k], in.newcomers[k]);
        if (!idmap_add(&sd->ids, in.newcomers[k]->id, (int32_t)newcomer_slot[k])) {
            status = dm2_fail(err, DM2_PROTOCOL, "step %lld: element %u came twice to server %d",
                              (long long)sd->step, in.newcomers[k]->id, sd->rank);
            goto done;
        }
    }
    status = place_mirrors(sd, in.mirrors, in.n_mirrors, err);
    if (status != DM2_OK)
        goto done;
    status = DM2_MEMORY;
    beat(sd);
    if (carry_all(sd, parcels, n_parcels, n_old, moved, old_id, initial) != 0 || build_send_lists(sd) != 0)
        goto done;
    sd->p.r[2 * n] = sd->p.r[2 * n + 1] = sd->model->far_place;
    status = DM2_OK;
done:
    free(in.newcomers);
    free(in.mirrors);
    free(newcomer_slot);
    if (status == DM2_MEMORY)
        return no_memory(sd, err);
    return status;
}

/* Where far pairs interact, any two elements have the margin that those close to each other have. */
static bool surveys_close(const struct subdomain *sd)
{
    return !sd->model->has_far;
}

/* Lists, and from where displacements count. */
static enum dm2_status build_lists(struct subdomain *sd, bool initial, struct dm2_error *err)
{
    size_t n = surveys_close(sd) ? sd->p.n : sd->p.n_own;
    double *anchor = block_hold(&sd->anchors, n, 2 * sizeof *anchor);
    if (anchor == NULL)
        return no_memory(sd, err);
    beat(sd);
    if (n > 0)
        memcpy(anchor, sd->p.r, n * 2 * sizeof *anchor);
    sd->binned = false;
    return lists_build(&sd->lists, sd->model, &sd->p, &sd->cells, initial, err);
}

/* The whole of a rebuild's second half. */
static enum dm2_status settle(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                              struct dm2_error *err)
{
    enum dm2_status status = arrange(sd, parcels, n_parcels, false, err);
    return status == DM2_OK ? build_lists(sd, false, err) : status;
}

/* --- creation --- */

static enum dm2_status begin(const struct model *model, const struct domain_map *map, int rank, int64_t step,
                             struct subdomain **out, struct dm2_error *err)
{
    struct subdomain *sd = mem_zalloc(1, sizeof *sd);
    *out = sd;
    if (sd == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for a subdomain");
    sd->model = model;
    sd->map = *map;
    sd->rank = rank;
    sd->step = step;
    particles_start(&sd->p, model);
    sd->peers = mem_zalloc((size_t)map->ranks, sizeof *sd->peers);
    if (sd->peers == NULL)
        return no_memory(sd, err);
    return cells_build(&sd->cells, map, rank, err);
}

/* Sorts elements into what is owned and what is mirrored here. */
struct chooser {
    struct subdomain *sd;
    struct element_array own, mirrors;
};

static enum dm2_status choose(void *context, const struct element *e, struct dm2_error *err)
{
    struct chooser *c = context;
    int32_t local = c->sd->cells.local_of[cell_of_element(c->sd, e->r)];
    if (local < 0)
        return DM2_OK;
    if (add_element(local < c->sd->cells.n_own ? &c->own : &c->mirrors, e) != 0)
        return no_memory(c->sd, err);
    return DM2_OK;
}

/* The whole set-up, with nothing old. The records are freed as soon as the elements are in their slots: lists
 * need the room. */
static enum dm2_status settle_chosen(struct subdomain *sd, struct chooser *chosen,
                                     const struct pair_record *pairs, size_t n_pairs, bool initial,
                                     struct dm2_error *err)
{
    struct parcel parcel = {.migrants = chosen->own.item,
                            .n_migrants = chosen->own.n,
                            .mirrors = chosen->mirrors.item,
                            .n_mirrors = chosen->mirrors.n,
                            .pairs = (struct pair_record *)pairs,
                            .n_pairs = n_pairs};
    enum dm2_status status = arrange(sd, &parcel, 1, initial, err);
    free(chosen->own.item);
    free(chosen->mirrors.item);
    chosen->own.item = chosen->mirrors.item = NULL;
    idmap_free(&sd->ids); /* large enough for everybody, who will not all be newcomers again */
    return status == DM2_OK ? build_lists(sd, initial, err) : status;
}

/* How many links each owned element starts with. */
static void count_bonds(struct subdomain *sd)
{
    const struct lists *l = &sd->lists;
    for (size_t i = 0; i < sd->p.n_own; i++) {
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
            sd->p.bonds[i] = (uint16_t)(sd->p.bonds[i] + l->linked[k]);
            sd->p.bonds[l->near.j[k]] = (uint16_t)(sd->p.bonds[l->near.j[k]] + l->linked[k]);
        }
    }
}

enum dm2_status subdomain_create(const struct model *model, const struct domain_map *map, int rank,
                                 struct subdomain **out, struct dm2_error *err)
{
    double started = clock_now();
    enum dm2_status status = begin(model, map, rank, 0, out, err);
    struct chooser chosen = {.sd = *out};
    if (status == DM2_OK && map->ranks == 1 && reserve_elements(&chosen.own, model_elements(model)) != 0)
        status = no_memory(*out, err);
    if (status == DM2_OK)
        status = generate_elements(model, choose, &chosen, err);
    if (status == DM2_OK)
        status = settle_chosen(*out, &chosen, NULL, 0, true, err);
    free(chosen.own.item);
    free(chosen.mirrors.item);
    if (status != DM2_OK) {
        subdomain_free(*out);
        *out = NULL;
        return status;
    }
    count_bonds(*out);
    (*out)->times.rebuild += clock_now() - started;
    return DM2_OK;
}

enum dm2_status subdomain_restore(const struct model *model, const struct domain_map *map, int rank,
                                  int64_t step, const struct element *elements, size_t n_elements,
                                  const struct pair_record *pairs, size_t n_pairs, struct subdomain **out,
                                  struct dm2_error *err)
{
    enum dm2_status status = begin(model, map, rank, step, out, err);
    struct chooser chosen = {.sd = *out};
    if (status == DM2_OK && map->ranks == 1 && reserve_elements(&chosen.own, n_elements) != 0)
        status = no_memory(*out, err);
    for (size_t k = 0; k < n_elements && status == DM2_OK; k++)
        status = choose(&chosen, &elements[k], err);
    /* The pairs' elements are all newcomers or mirrors, so every id is in the map. */
    if (status == DM2_OK)
        status = settle_chosen(*out, &chosen, pairs, n_pairs, false, err);
    free(chosen.own.item);
    free(chosen.mirrors.item);
    if (status != DM2_OK) {
        subdomain_free(*out);
        *out = NULL;
    }
    return status;
}

void subdomain_free(struct subdomain *sd)
{
    if (sd == NULL)
        return;
    for (int r = 0; sd->peers != NULL && r < sd->map.ranks; r++) {
        free(sd->peers[r].migrants.item);
        free(sd->peers[r].mirrors.item);
        free(sd->peers[r].pairs.item);
        free(sd->peers[r].send.item);
    }
    free(sd->peers);
    cells_free(&sd->cells);
    particles_free(&sd->p);
    force_drop(&sd->pass, &sd->lists);
    lists_free(&sd->lists);
    strain_free(&sd->strain);
    idmap_free(&sd->ids);
    free(sd->cell_of);
    free(sd->reacted.item);
    free(sd->from.item);
    free(sd->moved.item);
    free(sd->old_id.item);
    free(sd->anchors.item);
    free(sd->spreads.item);
    bins_free(&sd->near_by);
    free(sd);
}

int64_t subdomain_step(const struct subdomain *sd)
{
    return sd->step;
}

size_t subdomain_owned(const struct subdomain *sd)
{
    return sd->p.n_own - sd->n_leaving;
}

size_t subdomain_mirrored(const struct subdomain *sd)
{
    return sd->p.n - sd->p.n_own;
}

size_t subdomain_bytes(const struct subdomain *sd)
{
    size_t bytes =
        sizeof *sd + particles_bytes(&sd->p) + lists_bytes(&sd->lists) + cells_bytes(&sd->cells, &sd->map) +
        sd->cell_cap * sizeof *sd->cell_of + sd->ids.slots * 8 + sd->from.cap + sd->moved.cap +
        sd->old_id.cap + sd->anchors.cap + sd->spreads.cap + bins_bytes(&sd->near_by) +
        sd->strain.cap * STRAIN_SUMS * sizeof *sd->strain.sum + sd->reacted.cap * sizeof *sd->reacted.item;
    for (int r = 0; r < sd->map.ranks; r++)
        bytes += sd->peers[r].send.cap * sizeof(uint32_t) +
                 (sd->peers[r].migrants.cap + sd->peers[r].mirrors.cap) * sizeof(struct element) +
                 sd->peers[r].pairs.cap * sizeof(struct pair_record);
    return bytes;
}

/* --- a time step --- */

static bool needs_pressure(const struct model *m)
{
    return m->has_pressure || m->has_phases;
}

void subdomain_forces_ahead(struct subdomain *sd, bool measure)
{
    double started = clock_now();
    const struct model *m = sd->model;
    force_ahead(&sd->pass, m, &sd->p, &sd->lists, leapfrog_kick_time(m, sd->step),
                leapfrog_path_time(m, sd->step), measure || needs_pressure(m) ? &sd->totals : NULL);
    sd->times.forces += clock_now() - started;
}

enum dm2_status subdomain_forces(struct subdomain *sd, bool measure, struct dm2_error *err)
{
    double started = clock_now();
    const struct model *m = sd->model;
    bool pressure = needs_pressure(m), totals = measure || pressure;
    beat(sd);
    enum dm2_status status = m->has_kinds ? phase_account(m, &sd->p, &sd->lists, sd->step, err) : DM2_OK;
    if (status == DM2_OK && sd->pass.ahead)
        status = force_rest(&sd->pass, &sd->lists, sd->step, err);
    else if (status == DM2_OK)
        status = force_evaluate(sd->model, &sd->p, &sd->lists, leapfrog_kick_time(sd->model, sd->step),
                                leapfrog_path_time(sd->model, sd->step), totals ? &sd->totals : NULL,
                                sd->step, err);
    beat(sd);
    if (status == DM2_OK && m->reaction.any)
        status = reaction_evaluate(m, &sd->p, &sd->lists, leapfrog_kick_time(m, sd->step), sd->step,
                                   &sd->reacted, err);
    if (status == DM2_OK && pressure)
        leapfrog_set_pressure(m, &sd->p);
    if (status == DM2_OK && sd->model->has_strain)
        status = strain_add(sd->model, &sd->p, &sd->lists, leapfrog_path_time(sd->model, sd->step), sd->step,
                            &sd->strain, err);
    sd->measured = totals;
    sd->times.forces += clock_now() - started;
    return status;
}

static enum dm2_status integrate(struct subdomain *sd, bool drift, double *dmax, struct measures *out,
                                 struct dm2_error *err)
{
    double started = clock_now();
    if (out != NULL) {
        measures_clear(out);
        out->potential = sd->totals.potential;
        out->elastic = sd->totals.elastic;
        out->links = sd->totals.links;
        out->contacts = sd->totals.contacts;
    }
    beat(sd);
    enum dm2_status status = leapfrog_move(sd->model, &sd->p, sd->step, drift, dmax, out, err);
    sd->times.integrate += clock_now() - started;
    return status;
}

enum dm2_status subdomain_move(struct subdomain *sd, double *dmax, struct measures *out,
                               struct dm2_error *err)
{
    enum dm2_status status = integrate(sd, true, dmax, out, err);
    if (status == DM2_OK && sd->model->reaction.any)
        status = reaction_apply(sd->model, &sd->p, &sd->reacted, sd->step, err);
    if (status == DM2_OK && sd->model->has_phases)
        phase_apply(sd->model, &sd->p);
    sd->step++;
    sd->measured = false;
    return status;
}

/* Displacements of slots first .. last-1, or of those that `slots` names there. */
static inline struct spread survey_slots(const struct subdomain *sd, const uint32_t *slots, size_t first,
                                         size_t last)
{
    const struct grid *g = &sd->model->grid;
    const bool periodic = g->periodic[0] || g->periodic[1];
    const double *r = sd->p.r, *anchor = sd->anchors.item;
    struct spread out = spread_none();
    double most2 = 0.0;
    for (size_t s = first; s < last; s++) {
        size_t i = slots != NULL ? slots[s] : s;
        double d[2];
        for (size_t a = 0; a < 2; a++) {
            d[a] = r[2 * i + a] - anchor[2 * i + a];
            if (periodic && g->periodic[a])
                d[a] = lists_wrap(d[a], g->size[a], 0.5 * g->size[a]);
            out.low[a] = d[a] < out.low[a] ? d[a] : out.low[a];
            out.high[a] = d[a] > out.high[a] ? d[a] : out.high[a];
        }
        double d2 = d[0] * d[0] + d[1] * d[1];
        most2 = d2 > most2 ? d2 : most2;
    }
    out.most = sqrt(most2);
    return out;
}

/* Sorts the anchors into bins, once after each rebuild: edges longer than R_c + dR, and twice that again and
 * again where there would be more bins than elements. False where that cannot be. */
static bool sort_anchors(struct subdomain *sd)
{
    const struct config *c = sd->model->config;
    double reach = c->r_c + c->delta_r, most = (double)sd->p.n + 1024.0;
    for (int k = 0; k < 16 && !sd->binned; k++, reach *= 2.0) {
        if (!bins_lay_out(&sd->near_by, &sd->model->grid, sd->anchors.item, sd->p.n, reach, most))
            continue;
        if (bins_assign(&sd->near_by, sd->anchors.item, sd->p.n) != 0)
            return false;
        sd->binned = true;
    }
    return sd->binned;
}

/* Room for the spread of each bin: that of the pair sums, which mean nothing between a move and the next
 * forces. NULL without memory. */
static struct spread *room_for_spreads(struct subdomain *sd)
{
    size_t bins = (size_t)sd->near_by.grid.cx * (size_t)sd->near_by.grid.cy;
    return bins <= particles_sum_bytes(&sd->p) / sizeof(struct spread)
               ? (struct spread *)(void *)sd->p.pair_sum
               : block_hold(&sd->spreads, bins, sizeof(struct spread));
}

/* How much those of bin (i, j) can have approached each other, and those in the bins around it that have not
 * been compared with it yet: east of it, and in the row above. */
static double close_to_bin(const struct grid *g, const struct spread *of, int i, int j)
{
    static const int later[4][2] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};
    const struct spread *here = &of[j * g->cx + i];
    double close = spread_approach(here);
    for (int k = 0; k < 4; k++) {
        int x = i + later[k][0], y = j + later[k][1];
        if (g->periodic[0])
            x = (x + g->cx) % g->cx;
        if (g->periodic[1])
            y %= g->cy;
        if (x < 0 || x >= g->cx || y >= g->cy)
            continue;
        double between = spread_between(here, &of[y * g->cx + x], later[k]);
        close = between > close ? between : close;
    }
    return close;
}

/* Bin by bin, and then what each has against those around it. Owned slots come first in a bin. */
static struct spread survey_bins(const struct subdomain *sd, struct spread *of)
{
    const struct bins *b = &sd->near_by;
    const struct grid *g = &b->grid;
    struct spread out = spread_none();
    for (int k = 0; k < g->cx * g->cy; k++) {
        size_t first = b->start[k], last = b->start[k + 1], own = last;
        while (own > first && b->slot[own - 1] >= sd->p.n_own)
            own--;
        of[k] = survey_slots(sd, b->slot, first, own);
        spread_merge(&out, &of[k]);
        if (own < last) {
            struct spread mirrored = survey_slots(sd, b->slot, own, last);
            spread_merge(&of[k], &mirrored);
        }
    }
    for (int j = 0; j < g->cy; j++) {
        for (int i = 0; i < g->cx; i++) {
            double close =
                b->start[j * g->cx + i + 1] > b->start[j * g->cx + i] ? close_to_bin(g, of, i, j) : 0.0;
            out.close = close > out.close ? close : out.close;
        }
    }
    return out;
}

void subdomain_survey(struct subdomain *sd, struct spread *out)
{
    double started = clock_now();
    struct spread *of = surveys_close(sd) && sort_anchors(sd) ? room_for_spreads(sd) : NULL;
    if (of != NULL) {
        *out = survey_bins(sd, of);
    } else {
        *out = survey_slots(sd, NULL, 0, sd->p.n_own);
        out->close = INFINITY;
    }
    sd->times.integrate += clock_now() - started;
}

enum dm2_status subdomain_measure_last(struct subdomain *sd, struct measures *out, struct dm2_error *err)
{
    return integrate(sd, false, NULL, out, err);
}

enum dm2_status subdomain_profile(const struct subdomain *sd, size_t which, struct profile_bin *bins,
                                  struct dm2_error *err)
{
    return profile_add(sd->model, &sd->p, &sd->model->config->profiles[which], sd->step, bins, err);
}

/* --- update --- */

/* Velocities of mirrored elements matter where pairs damp and where strain is measured. */
static bool needs_velocity(const struct model *m)
{
    return m->has_damping || m->has_strain;
}

unsigned subdomain_update_fields(const struct model *m)
{
    return (needs_velocity(m) ? UPDATE_VELOCITY : 0u) | (m->has_spin ? UPDATE_SPIN : 0u) |
           (m->has_heat ? UPDATE_HEAT : 0u) | (m->has_pressure ? UPDATE_PRESSURE : 0u) |
           (m->has_kinds ? UPDATE_KIND : 0u) | (m->reaction.any ? UPDATE_COMPOSITION : 0u);
}

size_t subdomain_update_width(const struct model *m)
{
    return 2u + (needs_velocity(m) ? 2u : 0u) + (m->has_spin ? 1u : 0u) + (m->has_heat ? 1u : 0u) +
           (m->has_pressure ? 1u : 0u) + (m->has_kinds ? 1u : 0u) + (m->reaction.any ? 2u : 0u);
}

size_t subdomain_send_count(const struct subdomain *sd, int dest)
{
    return sd->peers[dest].send.n;
}

size_t subdomain_receive_count(const struct subdomain *sd, int src)
{
    return sd->peers[src].mirror_end - sd->peers[src].mirror_begin;
}

void subdomain_pack_update(const struct subdomain *sd, int dest, double *out)
{
    const struct particles *p = &sd->p;
    const struct model *m = sd->model;
    const struct slot_array *send = &sd->peers[dest].send;
    for (size_t k = 0; k < send->n; k++) {
        size_t i = send->item[k];
        *out++ = p->r[2 * i];
        *out++ = p->r[2 * i + 1];
        if (needs_velocity(m)) {
            *out++ = p->v[2 * i];
            *out++ = p->v[2 * i + 1];
        }
        if (m->has_spin)
            *out++ = p->w[i];
        if (m->has_heat)
            *out++ = p->heat[i];
        if (m->has_pressure)
            *out++ = p->p[i];
        if (m->has_kinds)
            *out++ = (double)p->kind[i] + 65536.0 * (double)p->was[i];
        for (size_t a = 0; a < 2 && m->reaction.any; a++)
            *out++ = p->share[2 * i + a];
    }
}

/* Kind and the kind before, as one number of an update. False: there are none such. */
static bool take_kind(const struct model *m, struct particles *p, size_t i, double packed)
{
    double was = floor(packed / 65536.0), kind = packed - 65536.0 * was, most = (double)m->n_kinds;
    if (!(was >= 0.0 && was < most && kind < most && kind == floor(kind)))
        return false;
    phase_follow(m, p, i, (size_t)was, (size_t)kind);
    return true;
}

/* No element moves further than a cell edge in a step (leapfrog_move); twice that leaves room for rounding.
 */
static bool is_near(const struct grid *g, const double now[2], const double before[2])
{
    double edge = g->lx < g->ly ? g->lx : g->ly, d[2];
    for (size_t a = 0; a < 2; a++)
        d[a] = lists_wrap(now[a] - before[a], g->periodic[a] ? g->size[a] : 0.0,
                          g->periodic[a] ? 0.5 * g->size[a] : INFINITY);
    return d[0] * d[0] + d[1] * d[1] <= 4.0 * edge * edge;
}

/* What cannot be said of the mirror in slot i; it was where p->r still has it. */
static enum dm2_status wrong_update(const struct subdomain *sd, size_t i, int src, const char *what,
                                    enum dm2_status status, struct dm2_error *err)
{
    const double *r = &sd->p.r[2 * i];
    return dm2_fail(err, status,
                    "step %lld: the update of element %u from server %d, last at (%g, %g) cm, %s",
                    (long long)sd->step, sd->p.id[i], src, r[0], r[1], what);
}

enum dm2_status subdomain_take_update(struct subdomain *sd, int src, const double *in, struct dm2_error *err)
{
    struct particles *p = &sd->p;
    const struct model *m = sd->model;
    size_t width = subdomain_update_width(m);
    for (size_t i = sd->peers[src].mirror_begin; i < sd->peers[src].mirror_end; i++, in += width) {
        double check = 0.0;
        for (size_t k = 0; k < width; k++)
            check += in[k] * 0.0; /* NaN where a value is not finite */
        if (check != 0.0 || check != check)
            return wrong_update(sd, i, src, "is not finite", DM2_NUMERIC, err);
        if (!is_near(&m->grid, in, &p->r[2 * i]))
            return wrong_update(sd, i, src, "puts it further than a cell edge away", DM2_NUMERIC, err);
        size_t k = 2;
        p->r[2 * i] = in[0];
        p->r[2 * i + 1] = in[1];
        if (needs_velocity(m)) {
            p->v[2 * i] = in[k++];
            p->v[2 * i + 1] = in[k++];
        }
        if (m->has_spin)
            p->w[i] = in[k++];
        if (m->has_heat)
            p->heat[i] = in[k++];
        if (m->has_pressure)
            p->p[i] = in[k++];
        if (m->has_kinds && !take_kind(m, p, i, in[k++]))
            return wrong_update(sd, i, src, "names a kind that the deck does not have", DM2_PROTOCOL, err);
        for (size_t a = 0; a < 2 && m->reaction.any; a++)
            p->share[2 * i + a] = in[k++];
        if (m->has_heat || m->has_kinds)
            particles_warm(p, m, i, 1.0 / p->mass[i]);
    }
    return DM2_OK;
}

/* --- rebuild --- */

/* Adds the element to the parcels of everyone who mirrors its new cell. */
static int mirror_to_all(struct subdomain *sd, int cell, const struct element *e)
{
    uint16_t ranks[8];
    int n = domain_map_mirrored_by(&sd->map, cell, ranks);
    for (int k = 0; k < n; k++) {
        if (add_element(&sd->peers[ranks[k]].mirrors, e) != 0)
            return -1;
    }
    return 0;
}

/* The memory of every pair of an emigrant goes where the emigrant goes. */
static int send_memory(struct subdomain *sd, const int32_t *destination)
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
                if (to[e] >= 0 && (e == 0 || to[1] != to[0]) && add_pair(&sd->peers[to[e]].pairs, &pair) != 0)
                    return -1;
            }
        }
    }
    return 0;
}

enum dm2_status subdomain_sort_out(struct subdomain *sd, struct parcel *parcels, struct dm2_error *err)
{
    double started = clock_now();
    size_t n = sd->p.n_own;
    void *cells = sd->cell_of;
    force_drop(&sd->pass, &sd->lists);
    int32_t *destination = NULL;
    for (int r = 0; r < sd->map.ranks; r++)
        sd->peers[r].migrants.n = sd->peers[r].mirrors.n = sd->peers[r].pairs.n = 0;
    if (mem_grow(&cells, &sd->cell_cap, 0, n, sizeof *sd->cell_of) != 0)
        return no_memory(sd, err);
    sd->cell_of = cells;
    destination = mem_alloc(sd->map.ranks > 1 ? n : 0, sizeof *destination);
    if (destination == NULL)
        return no_memory(sd, err);
    for (size_t i = 0; i < n; i++) {
        int cell = grid_cell(sd->map.grid, sd->p.r[2 * i], sd->p.r[2 * i + 1]);
        sd->cell_of[i] = cell;
        if (sd->map.ranks == 1)
            continue;
        int owner = sd->map.owner[cell];
        destination[i] = -1;
        if (owner == sd->rank && !sd->cells.seen_by[cell])
            continue;
        struct element e;
        particles_get(&sd->p, i, &e);
        int failed = sd->cells.seen_by[cell] ? mirror_to_all(sd, cell, &e) : 0;
        if (owner != sd->rank) {
            sd->n_leaving++;
            destination[i] = owner;
            failed |= add_element(&sd->peers[owner].migrants, &e);
        }
        if (failed != 0) {
            free(destination);
            return no_memory(sd, err);
        }
    }
    int failed = sd->n_leaving > 0 ? send_memory(sd, destination) : 0;
    for (size_t i = 0; i < n && sd->n_leaving > 0; i++) {
        if (destination[i] >= 0)
            sd->cell_of[i] = -1;
    }
    free(destination);
    if (failed != 0)
        return no_memory(sd, err);
    for (int r = 0; r < sd->map.ranks; r++) {
        const struct peer *peer = &sd->peers[r];
        parcels[r] = (struct parcel){.migrants = peer->migrants.item,
                                     .n_migrants = peer->migrants.n,
                                     .pairs = peer->pairs.item,
                                     .n_pairs = peer->pairs.n,
                                     .mirrors = peer->mirrors.item,
                                     .n_mirrors = peer->mirrors.n};
    }
    sd->times.rebuild += clock_now() - started;
    return DM2_OK;
}

enum dm2_status subdomain_take_in(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                                  struct dm2_error *err)
{
    double started = clock_now();
    enum dm2_status status = settle(sd, parcels, n_parcels, err);
    sd->times.rebuild += clock_now() - started;
    sd->times.rebuilds++;
    return status;
}

/* --- states --- */

enum dm2_status subdomain_collect(const struct subdomain *sd, struct element *elements,
                                  struct element_measure *measured, struct dm2_error *err)
{
    struct state_reader reader;
    enum dm2_status status = state_reader_open(&reader, &sd->p, &sd->lists, false, err);
    for (size_t k = 0; k < reader.n_elements; k++) {
        state_reader_element(&reader, k, &elements[k]);
        if (measured == NULL)
            continue;
        double w;
        size_t i = reader.slot[k];
        struct element_measure *out = &measured[k];
        leapfrog_stress(sd->model, &sd->p, i, out->stress);
        leapfrog_whole_velocity(sd->model, &sd->p, i, sd->step, out->velocity, &w);
        out->temperature = particles_temperature(&sd->p, sd->model, i);
        out->links = particles_links(&sd->p, i);
        out->contacts = particles_contacts(&sd->p, i);
    }
    state_reader_free(&reader);
    return status;
}

enum dm2_status subdomain_collect_pairs(const struct subdomain *sd, struct pair_record **pairs,
                                        size_t *n_pairs, struct dm2_error *err)
{
    struct state_reader reader;
    enum dm2_status status = state_reader_open(&reader, &sd->p, &sd->lists, true, err);
    *n_pairs = reader.n_pairs;
    *pairs = status == DM2_OK ? mem_alloc(reader.n_pairs, sizeof **pairs) : NULL;
    if (status == DM2_OK && *pairs == NULL)
        status = no_memory(sd, err);
    for (size_t k = 0; status == DM2_OK && k < reader.n_pairs; k++)
        state_reader_pair(&reader, k, &(*pairs)[k]);
    state_reader_free(&reader);
    return status;
}

static void read_element(const void *context, size_t k, struct element *out)
{
    state_reader_element(context, k, out);
}

static void read_pair(const void *context, size_t k, struct pair_record *out)
{
    state_reader_pair(context, k, out);
}

enum dm2_status subdomain_write(const struct subdomain *sd, subdomain_writer write, void *context,
                                struct dm2_error *err)
{
    struct state_reader reader;
    enum dm2_status status = state_reader_open(&reader, &sd->p, &sd->lists, true, err);
    const struct state_view view = {.step = sd->step,
                                    .n_elements = reader.n_elements,
                                    .n_pairs = reader.n_pairs,
                                    .records = &reader,
                                    .element = read_element,
                                    .pair = read_pair};
    if (status == DM2_OK)
        status = write(context, &view, err);
    state_reader_free(&reader);
    return status;
}

void subdomain_take_times(struct subdomain *sd, struct subdomain_times *out)
{
    *out = sd->times;
    sd->times = (struct subdomain_times){0};
}
