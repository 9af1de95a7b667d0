/* Which elements are near which features, found at rebuilds: features are sorted into the own cells that they
 * can reach, then compared with the elements of these cells.
 *
 * An entry is valid while no element can have approached a wall by more than the margin that any two elements
 * have (struct margins), because the displacements of walls count in the bounds of struct rebuild_plan. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "cells.h"
#include "wall.h"

/* --- displacements --- */

/* The displacement of a wall between two poses: of its centre in d, cm; returned: how much further a point
 * can have moved by turning. */
static double displace(const struct wall *w, const struct wall_pose *from, const struct wall_pose *to,
                       double d[2])
{
    for (size_t a = 0; a < 2; a++)
        d[a] = to->d[a] - from->d[a];
    return w->circle ? 0.0 : fabs(to->angle - from->angle) * w->extent;
}

enum dm2_status walls_move(const struct model *m, const struct loading *l, int64_t step, double *dmax,
                           struct dm2_error *err)
{
    double edge = fmin(m->grid.lx, m->grid.ly);
    for (size_t k = 0; k < m->n_walls; k++) {
        struct wall_pose from, to;
        double d[2];
        wall_pose_at(m, l, &m->walls[k], step, &from);
        wall_pose_at(m, l, &m->walls[k], step + 1, &to);
        double turned = displace(&m->walls[k], &from, &to, d),
               moved = sqrt(d[0] * d[0] + d[1] * d[1]) + turned;
        if (!(moved < edge))
            return dm2_fail(
                err, DM2_NUMERIC,
                "step %lld: the wall '%s' would move by %g cm in one step, further than a cell edge, %g "
                "cm, and past elements: choose a smaller dt or a slower wall",
                (long long)step, m->walls[k].config->name, moved, edge);
        *dmax = fmax(*dmax, moved);
    }
    return DM2_OK;
}

void walls_survey(const struct walls *ws, const struct model *m, const struct loading *l, int64_t step,
                  struct spread *out)
{
    for (size_t k = 0; k < m->n_walls; k++) {
        struct wall_pose now;
        double d[2];
        wall_pose_at(m, l, &m->walls[k], step, &now);
        double turned = displace(&m->walls[k], &ws->anchor[k], &now, d);
        struct spread of = {.most = sqrt(d[0] * d[0] + d[1] * d[1]) + turned};
        for (size_t a = 0; a < 2; a++) {
            if (m->grid.periodic[a] && fabs(d[a]) > 0.5 * m->grid.size[a])
                d[a] -= m->grid.size[a] * round(d[a] / m->grid.size[a]);
            of.low[a] = d[a] - turned;
            of.high[a] = d[a] + turned;
        }
        spread_merge(out, &of);
    }
}

/* --- features by cell --- */

/* A feature that can reach elements of an own cell, and the image of the cell that it reaches. */
struct cell_feature {
    int32_t cell; /* local number */
    uint32_t feature;
    int32_t image[2];
};

struct index {
    struct walls *ws;
    const struct model *m;
    const struct particles *p;
    const struct cells *cells;
    struct cell_feature *item;
    size_t n, cap;
};

/* The end of the segment behind vertex k, cm; not wrapped where the line closes across a periodic side. */
static const double *end_of(const struct wall *w, size_t k)
{
    return k + 1 == w->n_vertices ? w->config->points + 2 * (w->config->n_points - 1) : w->vertex[k + 1].p;
}

/* The box of a feature at the present pose, cm, wider by `reach`. */
static void find_box(const struct wall *w, const struct wall_pose *pose, size_t local, double reach,
                     double low[2], double high[2])
{
    double around = reach + w->radius;
    const struct wall_vertex *v = w->circle ? NULL : &w->vertex[local / 2];
    for (size_t end = 0; end < (w->circle || local % 2 == 0 ? 1u : 2u); end++) {
        double x = w->circle ? w->centre[0] : v->p[0], y = w->circle ? w->centre[1] : v->p[1];
        if (end == 1) {
            const double *last = end_of(w, local / 2);
            x = last[0];
            y = last[1];
        }
        double arm[2] = {x - w->centre[0], y - w->centre[1]};
        double place[2] = {pose->cosine * arm[0] - pose->sine * arm[1] + w->centre[0] + pose->d[0],
                           pose->sine * arm[0] + pose->cosine * arm[1] + w->centre[1] + pose->d[1]};
        for (size_t a = 0; a < 2; a++) {
            low[a] = end == 0 || place[a] - around < low[a] ? place[a] - around : low[a];
            high[a] = end == 0 || place[a] + around > high[a] ? place[a] + around : high[a];
        }
    }
}

/* The number of the column or row of a coordinate; along a periodic direction counted on beyond the domain.
 */
static long find_column(const struct grid *g, int a, double x)
{
    double edge = a == 0 ? g->lx : g->ly, at = floor((x - g->origin[a]) / edge);
    long cells = a == 0 ? g->cx : g->cy;
    if (g->periodic[a])
        return (long)at;
    return at < 0.0 ? 0 : at > (double)(cells - 1) ? cells - 1 : (long)at;
}

static long floor_divide(long x, long by)
{
    return x >= 0 ? x / by : -((by - 1 - x) / by);
}

/* Adds the feature to all own cells that it can reach. 0, or -1 without memory. */
static int add_feature(struct index *x, const struct wall *w, const struct wall_pose *pose, size_t local,
                       double reach)
{
    const struct grid *g = &x->m->grid;
    const long size[2] = {g->cx, g->cy};
    double low[2], high[2];
    long from[2], to[2];
    find_box(w, pose, local, reach, low, high);
    for (int a = 0; a < 2; a++) { /* one cell more, because the edges are rounded */
        double edge = a == 0 ? g->lx : g->ly;
        from[a] = find_column(g, a, low[a] - 1e-6 * edge);
        to[a] = find_column(g, a, high[a] + 1e-6 * edge);
    }
    for (long j = from[1]; j <= to[1]; j++) {
        for (long i = from[0]; i <= to[0]; i++) {
            long image[2] = {floor_divide(i, size[0]), floor_divide(j, size[1])};
            long cell = (j - image[1] * size[1]) * size[0] + (i - image[0] * size[0]);
            int32_t own = x->cells->local_of[cell];
            if (own < 0 || own >= x->cells->n_own || x->cells->start[own] == x->cells->start[own + 1])
                continue;
            struct cell_feature *grown = mem_grown(x->item, &x->cap, x->n, x->n + 1, sizeof *grown);
            if (grown == NULL)
                return -1;
            x->item = grown;
            x->item[x->n++] = (struct cell_feature){.cell = own,
                                                    .feature = (uint32_t)(w->first + local),
                                                    .image = {(int32_t)image[0], (int32_t)image[1]}};
        }
    }
    return 0;
}

static int compare_cells(const void *a, const void *b)
{
    const struct cell_feature *x = a, *y = b;
    if (x->cell != y->cell)
        return x->cell < y->cell ? -1 : 1;
    if (x->feature != y->feature)
        return x->feature < y->feature ? -1 : 1;
    for (int k = 0; k < 2; k++)
        if (x->image[k] != y->image[k])
            return x->image[k] < y->image[k] ? -1 : 1;
    return 0;
}

/* --- entries --- */

/* The distance of an element, at its place q in the frame of the wall, from a feature as a set of points, cm.
 */
static double distance_of(const struct wall *w, size_t local, const double q[2])
{
    if (w->circle) {
        double x = q[0] - w->centre[0], y = q[1] - w->centre[1];
        return fabs(sqrt(x * x + y * y) - w->radius);
    }
    const struct wall_vertex *v = &w->vertex[local / 2];
    double x = q[0] - v->p[0], y = q[1] - v->p[1];
    if (local % 2 == 0)
        return sqrt(x * x + y * y);
    const double *end = end_of(w, local / 2);
    double length = (end[0] - v->p[0]) * v->after[0] + (end[1] - v->p[1]) * v->after[1];
    double s = x * v->after[0] + y * v->after[1], t = y * v->after[0] - x * v->after[1];
    double beyond = s < 0.0 ? -s : s > length ? s - length : 0.0;
    return sqrt(beyond * beyond + t * t);
}

/* The distance at the last rebuild. */
static double entry_distance(const struct walls *ws, const struct model *m, const struct particles *p,
                             size_t i, const struct wall_entry *entry)
{
    const struct wall *w = walls_of_feature(m, entry->feature);
    int32_t turns[2] = {entry->base[0], entry->base[1]};
    double q[2];
    for (size_t a = 0; p->image != NULL && a < 2; a++)
        turns[a] += p->image[2 * i + a];
    wall_place(m, w, &ws->anchor[w - m->walls], p->r + 2 * i, turns, q);
    return distance_of(w, entry->feature - w->first, q);
}

static int add_entry(struct walls *ws, const struct wall_entry *entry)
{
    struct wall_entry *grown =
        mem_grown(ws->entry, &ws->entry_cap, ws->n_entries, ws->n_entries + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    ws->entry = grown;
    ws->entry[ws->n_entries++] = *entry;
    return 0;
}

/* Adds the entries of slot i, which is in the cell of items [first, last). 0, or -1 without memory. */
static int add_row(struct index *x, size_t i, size_t first, size_t last, double margin)
{
    struct walls *ws = x->ws;
    const size_t before = ws->n_entries;
    const double radius = x->p->radius[i] * x->m->growth;
    const double reach = (radius + (margin > 0.5 * radius ? margin : 0.5 * radius)) * (1.0 + 1e-9);
    for (size_t k = first; k < last; k++) {
        const struct cell_feature *f = &x->item[k];
        const struct wall *w = walls_of_feature(x->m, f->feature);
        double q[2];
        wall_place(x->m, w, &ws->anchor[w - x->m->walls], x->p->r + 2 * i, f->image, q);
        if (!(distance_of(w, f->feature - w->first, q) <= reach))
            continue;
        struct wall_entry entry = {.feature = f->feature, .base = {f->image[0], f->image[1]}};
        for (size_t a = 0; x->p->image != NULL && a < 2; a++)
            entry.base[a] -= x->p->image[2 * i + a];
        if (add_entry(ws, &entry) != 0)
            return -1;
    }
    if (ws->n_entries == before)
        return 0;
    uint32_t *slot = mem_grown(ws->slot, &ws->row_cap, ws->n_rows, ws->n_rows + 1, sizeof *slot);
    if (slot == NULL)
        return -1;
    ws->slot = slot;
    uint32_t *start = mem_grown(ws->start, &ws->start_cap, ws->n_rows + 1, ws->n_rows + 2, sizeof *start);
    if (start == NULL)
        return -1;
    ws->start = start;
    ws->slot[ws->n_rows++] = (uint32_t)i;
    ws->start[ws->n_rows] = (uint32_t)ws->n_entries;
    return 0;
}

/* --- memory through a rebuild --- */

int walls_carry(struct walls *ws, uint32_t slot, uint32_t feature, int32_t sign, double spring)
{
    struct wall_carried *grown =
        mem_grown(ws->carried, &ws->carried_cap, ws->n_carried, ws->n_carried + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    ws->carried = grown;
    ws->carried[ws->n_carried++] = (struct wall_carried){slot, feature, sign, spring};
    return 0;
}

static int compare_slots(const void *a, const void *b)
{
    const struct wall_carried *x = a, *y = b;
    if (x->slot != y->slot)
        return x->slot < y->slot ? -1 : 1;
    return x->feature < y->feature ? -1 : x->feature > y->feature;
}

/* Rows and memories are both sorted by slot and feature. Of a feature that is near by two images, the nearer
 * one has the memory: the other one is half of the domain away. */
void walls_give_memory(struct walls *ws, const struct model *m, const struct particles *p)
{
    size_t at = 0;
    if (ws->n_carried > 0)
        qsort(ws->carried, ws->n_carried, sizeof *ws->carried, compare_slots);
    for (size_t row = 0; row < ws->n_rows; row++) {
        while (at < ws->n_carried && ws->carried[at].slot < ws->slot[row])
            at++;
        for (; at < ws->n_carried && ws->carried[at].slot == ws->slot[row]; at++) {
            struct wall_entry *best = NULL;
            double least = INFINITY;
            for (uint32_t k = ws->start[row]; k < ws->start[row + 1]; k++) {
                if (ws->entry[k].feature != ws->carried[at].feature)
                    continue;
                double distance = entry_distance(ws, m, p, ws->slot[row], &ws->entry[k]);
                if (distance < least) {
                    least = distance;
                    best = &ws->entry[k];
                }
            }
            if (best != NULL) {
                best->sign = ws->carried[at].sign;
                best->spring = ws->carried[at].spring;
            }
        }
    }
    ws->n_carried = 0;
}

/* --- the whole index --- */

static int add_rows(struct index *x, double margin)
{
    for (size_t first = 0, last; first < x->n; first = last) {
        int32_t cell = x->item[first].cell;
        for (last = first; last < x->n && x->item[last].cell == cell;)
            last++;
        for (uint32_t i = x->cells->start[cell]; i < x->cells->start[cell + 1]; i++)
            if (add_row(x, i, first, last, margin) != 0)
                return -1;
    }
    return 0;
}

/* Room for the work of each row and for the longest row. 0, or -1 without memory. */
static int reserve_rows(struct walls *ws)
{
    size_t longest = 0;
    for (size_t row = 0; row < ws->n_rows; row++)
        if (ws->start[row + 1] - ws->start[row] > longest)
            longest = ws->start[row + 1] - ws->start[row];
    double *work = mem_grown(ws->work, &ws->work_cap, 0, ws->n_rows + 1, sizeof *work);
    if (work == NULL)
        return -1;
    ws->work = work;
    struct wall_entry *next = mem_grown(ws->next, &ws->next_cap, 0, longest + 1, sizeof *next);
    if (next == NULL)
        return -1;
    ws->next = next;
    memset(work, 0, ws->n_rows * sizeof *work);
    return 0;
}

enum dm2_status walls_build(struct walls *ws, const struct model *m, const struct loading *l,
                            const struct particles *p, const struct cells *cells, int64_t step,
                            struct dm2_error *err)
{
    struct index x = {.ws = ws, .m = m, .p = p, .cells = cells};
    double margin = m->margins.wide;
    double reach = m->radius_max + (margin > 0.5 * m->radius_max ? margin : 0.5 * m->radius_max);
    int failed = 0;
    ws->n_rows = ws->n_entries = 0;
    uint32_t *start = mem_grown(ws->start, &ws->start_cap, 0, 1, sizeof *start);
    if (start != NULL) {
        ws->start = start;
        ws->start[0] = 0;
    }
    failed = start == NULL ? -1 : 0;
    for (size_t k = 0; k < m->n_walls && failed == 0; k++) {
        const struct wall *w = &m->walls[k];
        wall_pose_at(m, l, w, step, &ws->anchor[k]);
        for (size_t local = 0; local < w->n_features && failed == 0; local++)
            failed = add_feature(&x, w, &ws->anchor[k], local, reach * (1.0 + 1e-9));
    }
    if (failed == 0 && x.n > 0) {
        qsort(x.item, x.n, sizeof *x.item, compare_cells);
        failed = add_rows(&x, margin);
    }
    if (failed == 0)
        failed = reserve_rows(ws);
    free(x.item);
    if (failed != 0)
        return dm2_fail(err, DM2_MEMORY, "no memory for the contacts with %zu walls", m->n_walls);
    walls_give_memory(ws, m, p);
    return DM2_OK;
}
