/* A rebuild: elements move to the ranks that own their new cells, and the elements of this rank to new slots.
 *
 * The new cell of an element decides which rank owns the element and which ranks mirror it. The old owner
 * knows the whole partition, so that it sends all ranks their parcels at once: migrants with the memory of
 * their pairs, and mirrors, also of elements that the old owner sends away. "Stayers" are owned before and
 * after the rebuild, "newcomers" are the migrants that came. */
#include "dm2/engine/subdomain.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/base/mem.h"
#include "force.h"
#include "id_order.h"
#include "lists.h"
#include "subdomain_parts.h"

/* --- sending --- */

/* Adds the element to the parcels of all ranks that mirror its new cell. 0, or -1 without memory. */
static int add_mirrors(struct subdomain *sd, int cell, const struct element *e)
{
    uint16_t ranks[8];
    int n = domain_map_mirrored_by(&sd->map, cell, ranks);
    for (int k = 0; k < n; k++) {
        if (element_array_add(&sd->neighbours[ranks[k]].mirrors, e) != 0)
            return -1;
    }
    return 0;
}

/* Adds the element of owned slot i, which is in `cell` now, to the parcels of its new owner and of the ranks
 * that mirror it. *destination is the new owner, -1 where this rank keeps the element. 0, or -1 without
 * memory. */
static inline int sort_element(struct subdomain *sd, size_t i, int cell, int32_t *destination)
{
    int owner = sd->map.owner[cell];
    *destination = -1;
    if (owner == sd->rank && !sd->cells.seen_by[cell])
        return 0;
    struct element e;
    particles_get(&sd->p, i, &e);
    int failed = sd->cells.seen_by[cell] ? add_mirrors(sd, cell, &e) : 0;
    if (owner != sd->rank) {
        sd->n_leaving++;
        *destination = owner;
        failed |= element_array_add(&sd->neighbours[owner].migrants, &e);
    }
    return failed;
}

/* Fills the arrays of all parcels; destination[n_own] is read and written only where there are several
 * ranks. 0, or -1 without memory. */
static int fill_parcels(struct subdomain *sd, int32_t *destination)
{
    size_t n = sd->p.n_own;
    for (size_t i = 0; i < n; i++) {
        int cell = grid_cell(sd->map.grid, sd->p.r[2 * i], sd->p.r[2 * i + 1]);
        sd->cell_of[i] = cell;
        if (sd->map.ranks > 1 && sort_element(sd, i, cell, &destination[i]) != 0)
            return -1;
    }
    int failed = sd->n_leaving > 0 ? pair_memory_send(sd, destination) : 0;
    if (failed == 0 && sd->n_leaving > 0)
        failed = wall_memory_send(sd, destination);
    for (size_t i = 0; i < n && sd->n_leaving > 0; i++) {
        if (destination[i] >= 0)
            sd->cell_of[i] = -1;
    }
    return failed;
}

enum dm2_status subdomain_sort_out(struct subdomain *sd, struct parcel *parcels, struct dm2_error *err)
{
    double started = clock_now();
    size_t n = sd->p.n_own;
    force_drop(&sd->pass, &sd->lists);
    for (int r = 0; r < sd->map.ranks; r++)
        sd->neighbours[r].migrants.n = sd->neighbours[r].mirrors.n = sd->neighbours[r].pairs.n =
            sd->neighbours[r].walls.n = 0;
    int32_t *cells = mem_grown(sd->cell_of, &sd->cell_cap, 0, n, sizeof *cells);
    if (cells == NULL)
        return subdomain_no_memory(sd, err);
    sd->cell_of = cells;
    int32_t *destination = mem_alloc(sd->map.ranks > 1 ? n : 0, sizeof *destination);
    if (destination == NULL)
        return subdomain_no_memory(sd, err);
    int failed = fill_parcels(sd, destination);
    free(destination);
    if (failed != 0)
        return subdomain_no_memory(sd, err);
    for (int r = 0; r < sd->map.ranks; r++) {
        const struct neighbour *to = &sd->neighbours[r];
        parcels[r] = (struct parcel){.migrants = to->migrants.item,
                                     .n_migrants = to->migrants.n,
                                     .pairs = to->pairs.item,
                                     .n_pairs = to->pairs.n,
                                     .walls = to->walls.item,
                                     .n_walls = to->walls.n,
                                     .mirrors = to->mirrors.item,
                                     .n_mirrors = to->mirrors.n};
    }
    sd->times.rebuild += clock_now() - started;
    return DM2_OK;
}

/* --- taking in --- */

struct keyed {
    uint64_t key; /* owner in the upper 32 bits, id in the lower */
    const struct element *e;
};

static int compare_keys(const void *a, const void *b)
{
    const struct keyed *ka = a, *kb = b;
    return ka->key < kb->key ? -1 : ka->key > kb->key;
}

/* The elements that a rebuild takes in, and the new order of slots. */
struct intake {
    const struct element **newcomers;
    struct keyed *mirrors;
    size_t n_newcomers, n_mirrors;
    size_t n_old;            /* elements owned before */
    size_t n_own, n;         /* elements owned afterwards, and all elements afterwards */
    uint32_t *from;          /* [n] old slot of the stayer in each new slot, else PARTICLES_NONE */
    uint32_t *moved;         /* [n_old] new slot of the stayer in each old slot, else PARTICLES_NONE */
    uint32_t *old_id;        /* ids of all old slots, mirrored ones too */
    uint32_t *newcomer_slot; /* [n_newcomers] new slots */
};

static enum dm2_status refuse_duplicate(const struct subdomain *sd, uint32_t id, struct dm2_error *err)
{
    return dm2_fail(err, DM2_NUMERIC, "step %lld: element %u came twice to server %d", (long long)sd->step,
                    id, sd->rank);
}

/* Fills in->from, in->moved and in->newcomer_slot by a counting sort into own cells; in each cell stayers
 * come first. */
static void assign_slots(struct subdomain *sd, struct intake *in)
{
    struct cells *c = &sd->cells;
    const struct element *const *newcomers = in->newcomers;
    const size_t n_old = in->n_old, n_new = in->n_newcomers;
    uint32_t *from = in->from, *newcomer_slot = in->newcomer_slot, *moved = in->moved;
    memset(c->start, 0, ((size_t)c->n_own + 1) * sizeof *c->start);
    for (size_t i = 0; i < n_old; i++) {
        if (sd->cell_of[i] >= 0)
            c->start[c->local_of[sd->cell_of[i]] + 1]++;
    }
    for (size_t k = 0; k < n_new; k++)
        c->start[c->local_of[subdomain_cell_at(sd, newcomers[k]->r)] + 1]++;
    for (int cell = 0; cell < c->n_own; cell++)
        c->start[cell + 1] += c->start[cell];
    /* start[cell] is the cursor of `cell` and ends as start[cell + 1]; then all starts are shifted back. */
    for (size_t i = 0; i < n_old; i++) {
        moved[i] = PARTICLES_NONE;
        if (sd->cell_of[i] < 0)
            continue;
        uint32_t slot = c->start[c->local_of[sd->cell_of[i]]]++;
        from[slot] = (uint32_t)i;
        moved[i] = slot;
    }
    for (size_t k = 0; k < n_new; k++) {
        uint32_t slot = c->start[c->local_of[subdomain_cell_at(sd, newcomers[k]->r)]]++;
        from[slot] = PARTICLES_NONE;
        newcomer_slot[k] = slot;
    }
    for (int cell = c->n_own; cell > 0; cell--)
        c->start[cell] = c->start[cell - 1];
    c->start[0] = 0;
}

/* Puts the mirrors into slots from n_own on, sorted by (owner, id), and sets the range of each rank. */
static enum dm2_status place_mirrors(struct subdomain *sd, struct keyed *mirrors, size_t n,
                                     struct dm2_error *err)
{
    int32_t *cells = mem_alloc(n, sizeof *cells);
    if (cells == NULL)
        return subdomain_no_memory(sd, err);
    qsort(mirrors, n, sizeof *mirrors, compare_keys);
    for (int r = 0; r < sd->map.ranks; r++)
        sd->neighbours[r].mirror_begin = sd->neighbours[r].mirror_end = 0;
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < n && status == DM2_OK; k++) {
        size_t slot = sd->p.n_own + k, owner = (size_t)(mirrors[k].key >> 32);
        struct neighbour *from = &sd->neighbours[owner];
        if (from->mirror_end == 0)
            from->mirror_begin = slot;
        from->mirror_end = slot + 1;
        cells[k] = subdomain_cell_at(sd, mirrors[k].e->r);
        particles_put(&sd->p, sd->model, slot, mirrors[k].e);
        if (!idmap_add(&sd->ids, mirrors[k].e->id, (int32_t)slot))
            status = refuse_duplicate(sd, mirrors[k].e->id, err);
    }
    if (status == DM2_OK && cells_assign_mirrored(&sd->cells, &sd->p, cells) != 0)
        status = subdomain_no_memory(sd, err);
    free(cells);
    return status;
}

static int add_slot(struct slot_array *a, uint32_t slot)
{
    uint32_t *grown = mem_grown(a->item, &a->cap, a->n, a->n + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    a->item = grown;
    a->item[a->n++] = slot;
    return 0;
}

/* Lists for each rank the slots in the own cells that it mirrors (the inner boundary), by id. 0, or -1
 * without memory. */
static int build_send_lists(struct subdomain *sd)
{
    const struct cells *c = &sd->cells;
    for (int r = 0; r < sd->map.ranks; r++)
        sd->neighbours[r].send.n = 0;
    for (int own = 0; own < c->n_own; own++) {
        uint16_t ranks[8];
        if (!c->seen_by[c->global_of[own]])
            continue;
        int n = domain_map_mirrored_by(&sd->map, c->global_of[own], ranks);
        for (int k = 0; k < n; k++) {
            for (uint32_t i = c->start[own]; i < c->start[own + 1]; i++) {
                if (add_slot(&sd->neighbours[ranks[k]].send, i) != 0)
                    return -1;
            }
        }
    }
    for (int r = 0; r < sd->map.ranks; r++) {
        if (id_order_sort_slots(sd->p.id, sd->neighbours[r].send.item, sd->neighbours[r].send.n) != 0)
            return -1;
    }
    return 0;
}

static bool kinds_known(const struct model *m, const struct element *e)
{
    return e->kind < m->n_kinds && e->was < m->n_kinds;
}

/* Collects newcomers and mirrors from the parcels and checks their kinds and cells. */
static enum dm2_status gather_parcels(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
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
        return subdomain_no_memory(sd, err);
    for (size_t q = 0; q < n_parcels; q++) {
        for (size_t k = 0; k < parcels[q].n_migrants; k++) {
            const struct element *e = &parcels[q].migrants[k];
            if (!kinds_known(sd->model, e) || sd->map.owner[subdomain_cell_at(sd, e->r)] != sd->rank)
                return dm2_fail(err, DM2_NUMERIC,
                                "step %lld: element %u at (%g, %g) cm came to server %d, which does not own "
                                "its cell",
                                (long long)sd->step, e->id, e->r[0], e->r[1], sd->rank);
            in->newcomers[in->n_newcomers++] = e;
        }
        for (size_t k = 0; k < parcels[q].n_mirrors; k++) {
            const struct element *e = &parcels[q].mirrors[k];
            int cell = subdomain_cell_at(sd, e->r);
            if (!kinds_known(sd->model, e) || sd->cells.local_of[cell] < sd->cells.n_own)
                return dm2_fail(
                    err, DM2_NUMERIC,
                    "step %lld: element %u at (%g, %g) cm came as a mirror to server %d, which does "
                    "not mirror its cell",
                    (long long)sd->step, e->id, e->r[0], e->r[1], sd->rank);
            in->mirrors[in->n_mirrors++] = (struct keyed){(uint64_t)sd->map.owner[cell] << 32 | e->id, e};
        }
    }
    return DM2_OK;
}

/* Counts the new elements, gets room for their order, and keeps the old ids. */
static enum dm2_status prepare_intake(struct subdomain *sd, struct intake *in, struct dm2_error *err)
{
    size_t stayers = 0, n_all_old = sd->p.n;
    in->n_old = sd->p.n_own;
    for (size_t i = 0; i < in->n_old; i++)
        stayers += sd->cell_of[i] >= 0;
    in->n_own = stayers + in->n_newcomers;
    in->n = in->n_own + in->n_mirrors;
    if (in->n > INT32_MAX)
        return dm2_fail(err, DM2_NUMERIC, "a subdomain holds more than 2^31 elements: use more servers");
    in->from = block_hold(&sd->from, in->n, sizeof *in->from);
    in->newcomer_slot = mem_alloc(in->n_newcomers, sizeof *in->newcomer_slot);
    in->moved = block_hold(&sd->moved, in->n_old, sizeof *in->moved);
    in->old_id = block_hold(&sd->old_id, n_all_old, sizeof *in->old_id);
    if (in->from == NULL || in->newcomer_slot == NULL || in->moved == NULL || in->old_id == NULL ||
        idmap_prepare(&sd->ids, in->n_newcomers + in->n_mirrors) != 0)
        return subdomain_no_memory(sd, err);
    if (n_all_old > 0)
        memcpy(in->old_id, sd->p.id, n_all_old * sizeof *in->old_id);
    return DM2_OK;
}

/* Moves the stayers to their new slots. 0, or -1 without memory. */
static int move_stayers(struct subdomain *sd, struct intake *in)
{
    assign_slots(sd, in);
    for (size_t k = in->n_own; k < in->n; k++)
        in->from[k] = PARTICLES_NONE;
    subdomain_beat(sd);
    if (particles_permute(&sd->p, in->from, in->n) != 0)
        return -1;
    sd->p.n_own = in->n_own;
    sd->p.n = in->n;
    sd->n_leaving = 0;
    return 0;
}

/* Writes the newcomers to their slots and adds them to sd->ids. */
static enum dm2_status place_newcomers(struct subdomain *sd, const struct intake *in, struct dm2_error *err)
{
    for (size_t k = 0; k < in->n_newcomers; k++) {
        particles_put(&sd->p, sd->model, in->newcomer_slot[k], in->newcomers[k]);
        if (!idmap_add(&sd->ids, in->newcomers[k]->id, (int32_t)in->newcomer_slot[k]))
            return refuse_duplicate(sd, in->newcomers[k]->id, err);
    }
    return DM2_OK;
}

/* migrate_arrange, but for the arrays of *in that are to be freed. */
static enum dm2_status arrange_intake(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                                      bool initial, struct intake *in, struct dm2_error *err)
{
    enum dm2_status status = gather_parcels(sd, parcels, n_parcels, in, err);
    if (status == DM2_OK)
        status = prepare_intake(sd, in, err);
    if (status == DM2_OK && move_stayers(sd, in) != 0)
        status = subdomain_no_memory(sd, err);
    if (status != DM2_OK)
        return status;
    subdomain_beat(sd);
    status = place_newcomers(sd, in, err);
    if (status == DM2_OK)
        status = place_mirrors(sd, in->mirrors, in->n_mirrors, err);
    if (status != DM2_OK)
        return status;
    subdomain_beat(sd);
    if (pair_memory_carry(sd, parcels, n_parcels, in->n_old, in->moved, in->old_id, initial) != 0 ||
        wall_memory_carry(sd, parcels, n_parcels, in->moved) != 0 || build_send_lists(sd) != 0)
        return subdomain_no_memory(sd, err);
    sd->p.r[2 * in->n] = sd->p.r[2 * in->n + 1] = sd->model->far_place;
    return DM2_OK;
}

enum dm2_status migrate_arrange(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                                bool initial, struct dm2_error *err)
{
    struct intake in = {0};
    enum dm2_status status = arrange_intake(sd, parcels, n_parcels, initial, &in, err);
    free(in.newcomers);
    free(in.mirrors);
    free(in.newcomer_slot);
    return status;
}

enum dm2_status migrate_build_lists(struct subdomain *sd, bool initial, struct dm2_error *err)
{
    size_t n = subdomain_surveys_close(sd) ? sd->p.n : sd->p.n_own;
    double *anchor = block_hold(&sd->anchors, n, 2 * sizeof *anchor);
    if (anchor == NULL)
        return subdomain_no_memory(sd, err);
    subdomain_beat(sd);
    if (n > 0)
        memcpy(anchor, sd->p.r, n * 2 * sizeof *anchor);
    sd->anchors_sorted = false;
    enum dm2_status status = sd->model->n_walls > 0 ? walls_build(&sd->walls, sd->model, sd->loading, &sd->p,
                                                                  &sd->cells, sd->step, err)
                                                    : DM2_OK;
    if (status == DM2_OK)
        status = lists_build(&sd->lists, sd->model, &sd->p, &sd->cells, initial, err);
    if (status == DM2_OK && sd->drives != NULL && drive_find_runs(&sd->drive_runs, sd->model, &sd->p) != 0)
        status = subdomain_no_memory(sd, err);
    if (status == DM2_OK && sd->loading != NULL &&
        load_sums_build(&sd->load_sums, sd->model, &sd->p, &sd->lists) != 0)
        status = subdomain_no_memory(sd, err);
    return status;
}

enum dm2_status subdomain_take_in(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                                  struct dm2_error *err)
{
    double started = clock_now();
    enum dm2_status status = migrate_arrange(sd, parcels, n_parcels, false, err);
    if (status == DM2_OK)
        status = migrate_build_lists(sd, false, err);
    sd->times.rebuild += clock_now() - started;
    sd->times.rebuilds++;
    return status;
}
