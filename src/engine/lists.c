/* Building the neighbour lists: from cells, from all pairs (config search = lists; the paper's Fig. 4), or,
 * for decks with near pairs only, from bins finer than the cells.
 *
 * The elements of a cell meet the later elements of their own cell, the elements of the later own cells
 * around the cell and the elements of the mirrored cells around the cell. Invariant: every pair with an owned
 * element is met exactly once, from its lower slot. All three searches find the same pairs; only the order in
 * a row differs, and no sum depends on order. */
#include "lists.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/simd.h"
#include "flaws.h"
#include "periodic.h"

/* Lattice neighbours closer than this times the distance of touching start linked: contact, with a tolerance
 * for rounded spacings. */
static const double initial_reach = 1.02;

/* Unlinked neighbours closer than this times r0, or than their lattice puts them, start pressed together. */
static const double pressed_below = 0.98;

struct builder {
    struct lists *lists;
    const struct model *m;
    const struct particles *p;
    bool initial;
    double far_reach2, near_reach2; /* cm2; near_reach2 is at least the reach of every pair */
    struct period period;
    size_t far_count, near_count;
};

/* Lists are the largest arrays of the program: they grow by an eighth, from the size that a lattice needs. */
enum { FAR_GUESS = 10, NEAR_GUESS = 3 }; /* entries per owned element */

static size_t choose_room(size_t cap, size_t need, size_t guess)
{
    size_t least = cap == 0 ? guess : cap + cap / 8;
    return need <= cap ? cap : need > least ? need : least;
}

static int reserve_rows(struct half_list *list, size_t rows)
{
    uint32_t *start = mem_grown(list->start, &list->row_cap, 0, rows + 1, sizeof *start);
    if (start == NULL)
        return -1;
    list->start = start;
    return 0;
}

/* Moves the first `used` items of an array into room for `cap`. */
static int move_array(void **block, size_t used, size_t cap, size_t size)
{
    void *grown = mem_alloc(cap, size);
    if (grown == NULL)
        return -1;
    if (used > 0)
        memcpy(grown, *block, used * size);
    free(*block);
    *block = grown;
    return 0;
}

static int reserve_far(struct half_list *list, size_t used, size_t more, size_t guess)
{
    void *j = list->j;
    size_t cap = choose_room(list->cap, used + more, guess);
    if (cap == list->cap)
        return 0;
    if (move_array(&j, used, cap, sizeof *list->j) != 0)
        return -1;
    list->j = j;
    list->cap = cap;
    return 0;
}

static int reserve_near(struct lists *l, size_t used, size_t more, size_t guess)
{
    size_t cap = choose_room(l->memory_cap, used + more, guess);
    if (cap == l->memory_cap)
        return 0;
    void *j = l->near.j, *linked = l->linked, *stretch = l->stretch, *spring = l->spring;
    int status = move_array(&j, used, cap, sizeof *l->near.j);
    l->near.j = j;
    if (status == 0)
        status = move_array(&linked, used, cap, sizeof *l->linked);
    l->linked = linked;
    if (status == 0)
        status = move_array(&stretch, used, cap, sizeof *l->stretch);
    l->stretch = stretch;
    if (status == 0)
        status = move_array(&spring, used, cap, sizeof *l->spring);
    l->spring = spring;
    if (status == 0)
        l->memory_cap = l->near.cap = cap;
    return status;
}

static void add_near(struct builder *b, uint32_t j, bool linked, double stretch, double spring)
{
    struct lists *l = b->lists;
    size_t at = b->near_count++;
    l->near.j[at] = j;
    l->linked[at] = linked;
    l->stretch[at] = stretch;
    l->spring[at] = spring;
}

static bool is_link_missing(const struct builder *b, uint32_t i, uint32_t j)
{
    const struct particles *p = b->p;
    struct link_end ends[2] = {{p->id[i], p->body[i], p->r + 2 * i}, {p->id[j], p->body[j], p->r + 2 * j}};
    double apart[2];
    for (size_t a = 0; a < 2; a++)
        apart[a] = period_nearest(p->r[2 * i + a] - p->r[2 * j + a], b->period.size[a], b->period.half[a]);
    return flaws_miss(b->m->config, ends[0], ends[1], apart);
}

/* The distance of nearest neighbours in the body's lattice, in diameters of its elements, at most 1. */
static double find_closeness(const struct body_config *b)
{
    double along = b->lattice == LATTICE_HEXAGONAL ? 0.5 * b->spacing : 0.0;
    double next = sqrt(along * along + b->row_spacing * b->row_spacing);
    double nearest =
        fmin(fmin(b->spacing, next), b->lattice == LATTICE_HEXAGONAL ? 2.0 * b->row_spacing : next);
    return fmin(1.0, nearest / (2.0 * b->radius));
}

/* Does the pair start pressed together with a force? Grains whose boundaries are linked stand closer than r0
 * on purpose: their links start without force, and a flaw may have taken some. */
static bool is_pressed(const struct builder *b, uint32_t i, uint32_t j, double r2, double r0,
                       const struct pair_law *law, enum relation relation)
{
    const struct particles *p = b->p;
    const struct body_config *bodies = b->m->config->bodies;
    double most = pressed_below * r0;
    if (r2 >= most * most || (relation == RELATION_OTHER_GRAIN && law->initial_link) ||
        ((p->flags[i] & p->flags[j] & ELEMENT_FIXED_MOTION) != 0 &&
         (p->body[i] == p->body[j] || particles_walls(p, i, j))))
        return false;
    most *= fmin(find_closeness(&bodies[p->body[i]]), find_closeness(&bodies[p->body[j]]));
    return r2 < most * most;
}

/* Counts a pair that is pressed or too close, if the element of lower id is owned here. */
static void note_overlap(struct builder *b, uint32_t i, uint32_t j, double r2, double r0)
{
    const struct particles *p = b->p;
    uint32_t low = p->id[i] < p->id[j] ? i : j, high = low == i ? j : i;
    if (low >= p->n_own)
        return;
    struct overlap pair = {.pairs = 1,
                           .ratio = sqrt(r2) / r0,
                           .id = {p->id[low], p->id[high]},
                           .body = {p->body[low], p->body[high]}};
    for (size_t a = 0; a < 2; a++) {
        pair.r[0][a] = p->r[2 * (size_t)low + a];
        pair.r[1][a] = p->r[2 * (size_t)high + a];
    }
    overlap_merge(&b->lists->overlap, &pair);
}

/* Adds the near entry of a pair that is linked at the start or within reach; notes an overlap. */
static void consider_near(struct builder *b, uint32_t i, uint32_t j, double r2)
{
    const struct particles *p = b->p;
    enum relation relation = relation_of(p->body[i], p->grain[i], p->body[j], p->grain[j]);
    const struct pair_law *law = model_law(b->m, p->kind[i], p->kind[j], relation);
    double r0 = p->radius[i] + p->radius[j],
           reach = law_touch_length(r0 * b->m->growth) + b->m->margins.close;
    bool pressed = b->initial && is_pressed(b, i, j, r2, r0, law, relation);
    if (pressed || (b->initial && r2 < OVERLAP_MOST * OVERLAP_MOST * (r0 * r0)))
        note_overlap(b, i, j, r2, r0);
    if (!law->near)
        return;
    double starts = initial_reach * law_touch_length(r0);
    bool linked =
        b->initial && !pressed && law->initial_link && r2 <= starts * starts && !is_link_missing(b, i, j);
    /* The boundary sets the distance of neighbours in two grains: their links start without force. */
    double stretch = linked && relation == RELATION_OTHER_GRAIN ? sqrt(r2) - r0 : 0.0;
    if (linked || r2 <= reach * reach)
        add_near(b, j, linked, stretch, 0.0);
}

/* Room for one more row that meets at most `candidates` elements. */
static int reserve_row(struct builder *b, size_t candidates)
{
    size_t n = b->p->n_own;
    if (b->m->has_far &&
        reserve_far(&b->lists->far, b->far_count, candidates + SIMD_LANES, FAR_GUESS * n) != 0)
        return -1;
    if (b->m->has_near && reserve_near(b->lists, b->near_count, candidates, NEAR_GUESS * n) != 0)
        return -1;
    return 0;
}

static inline double find_distance2(const struct builder *b, uint32_t i, uint32_t j, bool periodic)
{
    const double *r = b->p->r;
    double dx = r[2 * i] - r[2 * j], dy = r[2 * i + 1] - r[2 * j + 1];
    if (periodic) {
        dx = period_nearest(dx, b->period.size[0], b->period.half[0]);
        dy = period_nearest(dy, b->period.size[1], b->period.half[1]);
    }
    return dx * dx + dy * dy;
}

static inline void meet_pair(struct builder *b, uint32_t i, uint32_t j)
{
    double r2 = find_distance2(b, i, j, true);
    if (r2 <= b->far_reach2 && !particles_walls(b->p, i, j))
        b->lists->far.j[b->far_count++] = 2 * j;
    if (r2 <= b->near_reach2)
        consider_near(b, i, j, r2);
}

static int fill_row_from_cells(struct builder *b, const struct cells *cells, int own, uint32_t i)
{
    size_t candidates = cells->start[own + 1] - i;
    for (uint32_t k = cells->ring_start[own]; k < cells->ring_start[own + 1]; k++) {
        int32_t c = cells->ring[k];
        candidates += c < cells->n_own
                          ? cells->start[c + 1] - cells->start[c]
                          : cells->mirror_start[c - cells->n_own + 1] - cells->mirror_start[c - cells->n_own];
    }
    if (reserve_row(b, candidates) != 0)
        return -1;
    for (uint32_t j = i + 1; j < cells->start[own + 1]; j++)
        meet_pair(b, i, j);
    for (uint32_t k = cells->ring_start[own]; k < cells->ring_start[own + 1]; k++) {
        int32_t c = cells->ring[k];
        if (c < cells->n_own) {
            for (uint32_t j = cells->start[c]; j < cells->start[c + 1]; j++)
                meet_pair(b, i, j);
        } else {
            c -= cells->n_own;
            for (uint32_t s = cells->mirror_start[c]; s < cells->mirror_start[c + 1]; s++)
                meet_pair(b, i, cells->mirror_slot[s]);
        }
    }
    return 0;
}

/* Bin `at` and the bins around it, as ranges of adjacent bins: writes first and last of up to 9, returns how
 * many. */
static int find_bin_ranges(const struct grid *g, int at, int first[9], int last[9])
{
    int i = at % g->cx, j = at / g->cx, count = 0;
    bool seam =
        (g->periodic[0] && (i == 0 || i == g->cx - 1)) || (g->periodic[1] && (j == 0 || j == g->cy - 1));
    if (seam) {
        count = grid_neighbours(g, at, first);
        first[count++] = at;
        memcpy(last, first, (size_t)count * sizeof *last);
        return count;
    }
    int west = i > 0 ? i - 1 : 0, east = i < g->cx - 1 ? i + 1 : i;
    for (int row = j > 0 ? j - 1 : 0; row <= j + 1 && row < g->cy; row++) {
        first[count] = row * g->cx + west;
        last[count++] = row * g->cx + east;
    }
    return count;
}

/* Lays out bins for a deck with near pairs only. False where cells are as good. */
static bool lay_out_bins(struct builder *b)
{
    const struct grid *cells = &b->m->grid, *g = &b->lists->bins.grid;
    return b->m->config->search == SEARCH_CELLS_AND_LISTS && !b->m->has_far &&
           bins_lay_out(&b->lists->bins, cells, b->p->r, b->p->n, sqrt(b->near_reach2),
                        16.0 * (double)b->p->n + 1024.0) &&
           (g->cx == 1 || g->lx < 0.6 * cells->lx) && (g->cy == 1 || g->ly < 0.6 * cells->ly);
}

/* Near pairs only, from bins: the later slots in the bin of i and in the bins around it. Slots within reach
 * are written, without a branch, into the room of the row's entries, and then considered one by one; the
 * entries never overtake the slots still to consider. */
DM2_INLINE int fill_row_from_bins(struct builder *b, uint32_t i, bool periodic)
{
    const struct bins *bins = &b->lists->bins;
    int first[9], last[9], n = find_bin_ranges(&bins->grid, (int)bins->bin[i], first, last);
    size_t candidates = 0;
    for (int q = 0; q < n; q++)
        candidates += bins->start[last[q] + 1] - bins->start[first[q]];
    if (reserve_near(b->lists, b->near_count, candidates, NEAR_GUESS * b->p->n_own) != 0)
        return -1;
    uint32_t *found = b->lists->near.j + b->near_count;
    size_t count = 0;
    for (int q = 0; q < n; q++) {
        for (uint32_t s = bins->start[first[q]]; s < bins->start[last[q] + 1]; s++) {
            uint32_t j = bins->slot[s];
            found[count] = j;
            count += (j > i) & (find_distance2(b, i, j, periodic) <= b->near_reach2);
        }
    }
    for (size_t k = 0; k < count; k++)
        consider_near(b, i, found[k], find_distance2(b, i, found[k], periodic));
    return 0;
}

static int fill_row_from_all(struct builder *b, uint32_t i)
{
    for (uint32_t j = i + 1; j < b->p->n; j++) {
        if ((j - i) % 1024 == 1 &&
            /* room for the pairs found, not for all n candidates */ reserve_row(b, 1024) != 0)
            return -1;
        meet_pair(b, i, j);
    }
    return 0;
}

/* Fills the row up to a multiple of four with slot n, which is far from all elements. */
static void pad_row(struct builder *b)
{
    while (b->far_count % SIMD_LANES != 0)
        b->lists->far.j[b->far_count++] = 2 * (uint32_t)b->p->n;
}

/* Gives the carried memory of row i to its entries; a carried pair without an entry gets a new one. */
static int recall_memory(struct builder *b, uint32_t i)
{
    struct lists *l = b->lists;
    for (uint32_t k = l->rows[i]; k < l->rows[i + 1]; k++) {
        size_t at = l->near.start[i];
        uint32_t partner = l->carried_b[k] & ~CARRIED_LINKED;
        while (at < b->near_count && l->near.j[at] != partner)
            at++;
        if (at == b->near_count) {
            if (reserve_near(l, b->near_count, 1, NEAR_GUESS * b->p->n_own) != 0)
                return -1;
            add_near(b, partner, false, 0.0, 0.0);
        }
        l->linked[at] = (l->carried_b[k] & CARRIED_LINKED) != 0;
        l->stretch[at] = l->carried[2 * (size_t)k];
        l->spring[at] = l->carried[2 * (size_t)k + 1];
    }
    return 0;
}

int lists_carry_start(struct lists *l, size_t n_own)
{
    uint32_t *rows = mem_grown(l->rows, &l->rows_cap, 0, n_own + 2, sizeof *rows);
    if (rows == NULL)
        return -1;
    memset(rows, 0, (n_own + 2) * sizeof *rows);
    l->rows = rows;
    return 0;
}

/* Turns counts into starts: rows[a + 1] is the cursor of row a, which ends at the start of the next row. */
int lists_carry_reserve(struct lists *l, size_t n_own, void *room, size_t bytes)
{
    for (size_t i = 0; i < n_own; i++)
        l->rows[i + 2] += l->rows[i + 1];
    const size_t each = 2 * sizeof *l->carried + sizeof *l->carried_b;
    size_t pairs = l->rows[n_own + 1];
    if (pairs > bytes / each) {
        room = pairs > SIZE_MAX / each ? NULL
                                       : mem_grown(l->carried_own, &l->carried_own_cap, 0, pairs * each, 1);
        if (room == NULL)
            return -1;
        l->carried_own = room;
    }
    l->carried = room;
    l->carried_b = pairs > 0 ? (uint32_t *)(void *)(l->carried + 2 * pairs) : NULL;
    return 0;
}

static struct builder start_builder(struct lists *lists, const struct model *m, const struct particles *p,
                                    bool initial)
{
    double dr = m->config->delta_r, touch = law_touch_length(2.0 * m->radius_max),
           near = m->has_near || initial ? touch + m->margins.close : 0.0;
    struct builder b = {.lists = lists, .m = m, .p = p, .initial = initial, .period = period_of(&m->grid)};
    if (initial && near < initial_reach * touch)
        near = initial_reach * touch;
    b.far_reach2 = m->has_far ? (m->far_cutoff + dr) * (m->far_cutoff + dr) : -1.0;
    b.near_reach2 = near > 0.0 ? near * near : -1.0;
    return b;
}

enum dm2_status lists_build(struct lists *lists, const struct model *m, const struct particles *p,
                            const struct cells *cells, bool initial, struct dm2_error *err)
{
    struct builder b = start_builder(lists, m, p, initial);
    for (int part = 0; part < PART_COUNT; part++)
        lists->inner[part].valid = lists->links[part].valid = false;
    lists->n_inside = cells->start[cells->n_inside];
    bool all_pairs = m->config->search == SEARCH_LISTS;
    bool binned = lay_out_bins(&b), periodic = m->grid.periodic[0] || m->grid.periodic[1];
    enum dm2_status status = DM2_MEMORY;
    if ((binned && bins_assign(&lists->bins, p->r, p->n) != 0) || reserve_rows(&lists->far, p->n_own) != 0 ||
        reserve_rows(&lists->near, p->n_own) != 0)
        goto done;
    for (int own = 0; own < cells->n_own; own++) {
        if (own % 1024 == 0)
            pulse_beat(&m->pulse);
        for (uint32_t i = cells->start[own]; i < cells->start[own + 1]; i++) {
            lists->far.start[i] = (uint32_t)b.far_count;
            lists->near.start[i] = (uint32_t)b.near_count;
            if ((all_pairs            ? fill_row_from_all(&b, i)
                 : binned && periodic ? fill_row_from_bins(&b, i, true)
                 : binned             ? fill_row_from_bins(&b, i, false)
                                      : fill_row_from_cells(&b, cells, own, i)) != 0 ||
                recall_memory(&b, i) != 0)
                goto done;
            if (m->wide_far)
                pad_row(&b);
            if (b.far_count > UINT32_MAX || b.near_count > UINT32_MAX) {
                status = dm2_fail(err, DM2_NUMERIC,
                                  "a subdomain's neighbour list has more than 2^32 - 1 pairs: use more "
                                  "servers or a smaller r_c");
                goto done;
            }
        }
    }
    lists->far.start[p->n_own] = (uint32_t)b.far_count;
    lists->near.start[p->n_own] = (uint32_t)b.near_count;
    status = DM2_OK;
done:
    if (status == DM2_MEMORY)
        return dm2_fail(err, DM2_MEMORY, "no memory for the neighbour lists of %zu elements", p->n_own);
    return status;
}

int lists_keep_memory(struct lists *l, bool springs)
{
    size_t n = l->near.start[l->n_inside], numbers = springs ? 2 * n : n;
    uint64_t need = numbers * (uint64_t)sizeof *l->kept + n * (uint64_t)sizeof *l->linked + 1;
    void *kept = need > SIZE_MAX ? NULL : mem_grown(l->kept, &l->kept_cap, 0, (size_t)need, 1);
    if (kept == NULL)
        return -1;
    l->kept = kept;
    if (n == 0)
        return 0;
    if (springs)
        memcpy(l->kept, l->spring, n * sizeof *l->kept);
    memcpy(l->kept + numbers - n, l->stretch, n * sizeof *l->kept);
    memcpy(l->kept + numbers, l->linked, n * sizeof *l->linked);
    return 0;
}

void lists_restore_memory(struct lists *l, bool springs)
{
    size_t n = l->near.start[l->n_inside], numbers = springs ? 2 * n : n;
    if (n == 0)
        return;
    if (springs)
        memcpy(l->spring, l->kept, n * sizeof *l->kept);
    memcpy(l->stretch, l->kept + numbers - n, n * sizeof *l->kept);
    memcpy(l->linked, l->kept + numbers, n * sizeof *l->linked);
}

void lists_free(struct lists *l)
{
    for (int part = 0; part < PART_COUNT; part++) {
        inner_list_free(&l->inner[part]);
        link_list_free(&l->links[part]);
    }
    free(l->far.start);
    free(l->far.j);
    free(l->near.start);
    free(l->near.j);
    free(l->linked);
    free(l->stretch);
    free(l->spring);
    bins_free(&l->bins);
    free(l->carried_own);
    free(l->kept);
    free(l->rows);
    crack_list_free(&l->cracks);
    free(l->forces);
    *l = (struct lists){0};
}

size_t lists_bytes(const struct lists *l)
{
    size_t bytes = (l->far.row_cap + l->far.cap + l->near.row_cap + l->near.cap) * sizeof(uint32_t) +
                   l->memory_cap * (1 + 2 * sizeof(double)) + bins_bytes(&l->bins) + l->carried_own_cap +
                   l->rows_cap * sizeof *l->rows + l->kept_cap + l->n_forces * sizeof *l->forces;
    for (int part = 0; part < PART_COUNT; part++)
        bytes += inner_list_bytes(&l->inner[part]) + link_list_bytes(&l->links[part]);
    return bytes;
}
