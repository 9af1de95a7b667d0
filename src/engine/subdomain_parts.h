/* The inside of struct subdomain, for the files that implement subdomain.h: subdomain.c, survey.c, update.c,
 * migrate.c and pair_memory.c.
 *
 * Invariants between calls: owned elements are slots [0, n_own) in cell order; mirrored elements follow,
 * sorted by (owner, id), so that the mirrors from each rank are one range. The order in that range is the
 * order in which the rank sends their updates, because its send lists are sorted by id. Both sides derive
 * these orders from the elements alone; no ids travel in an update. */
#ifndef DM2_ENGINE_SUBDOMAIN_PARTS_H
#define DM2_ENGINE_SUBDOMAIN_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/grid.h"
#include "dm2/base/idmap.h"
#include "dm2/base/mem.h"
#include "dm2/base/status.h"
#include "dm2/engine/domain_map.h"
#include "dm2/engine/element.h"
#include "dm2/engine/pulse.h"
#include "dm2/engine/subdomain.h"
#include "bins.h"
#include "cells.h"
#include "drive.h"
#include "force.h"
#include "lists.h"
#include "load_sums.h"
#include "loading_parts.h"
#include "pair_pass.h"
#include "particles.h"
#include "reaction.h"
#include "stiffness.h"
#include "strain.h"
#include "tables.h"
#include "wall.h"

/* A block that is kept from rebuild to rebuild, because getting a large block anew costs more than filling
 * it. */
struct block {
    void *item;
    size_t cap; /* bytes */
};

struct element_array {
    struct element *item;
    size_t n, cap;
};

struct pair_array {
    struct pair_record *item;
    size_t n, cap;
};

struct wall_array {
    struct wall_contact *item;
    size_t n, cap;
};

struct slot_array {
    uint32_t *item;
    size_t n, cap;
};

/* What this rank gives to and gets from one other rank. */
struct neighbour {
    struct element_array migrants, mirrors; /* of the parcel being made */
    struct pair_array pairs;                /* likewise */
    struct wall_array walls;                /* likewise */
    struct slot_array send;                 /* owned slots that the rank mirrors, by id */
    size_t mirror_begin, mirror_end;        /* slots mirrored from the rank */
};

struct subdomain {
    const struct model *model;
    struct domain_map map;
    int rank;
    int64_t step;
    struct cells cells;
    struct particles p;
    struct lists lists;
    struct neighbour *neighbours;     /* [ranks] */
    struct idmap ids;                 /* slots of mirrored elements and newcomers, for the memory of pairs */
    struct block from, moved, old_id; /* struct intake (migrate.c) */
    struct block anchors;    /* [][2] positions at the last rebuild, cm; of mirrored elements too where
                                subdomain_surveys_close */
    struct block spreads;    /* of a survey's bins, where the pair sums have no room for them */
    struct bins anchor_bins; /* the anchors, for surveys; edges longer than R_c + dR */
    bool anchors_sorted;     /* into anchor_bins, since the last rebuild */
    int32_t *cell_of; /* global cell of each owned slot at the last subdomain_sort_out; -1: emigrated */
    size_t cell_cap;
    size_t n_leaving; /* emigrants of the last subdomain_sort_out, still in their slots until
                         subdomain_take_in */
    struct pair_totals totals;
    struct pass pass;   /* the evaluation under way, where subdomain_forces_ahead began it */
    struct walls walls; /* all NULL in a deck without walls */
    struct strain_sums strain;
    struct body_drive *drives;    /* [n_bodies], p.drives; NULL: the deck has none */
    struct drive_runs drive_runs; /* p.runs */
    struct stiffness_sums stiff;
    struct stiffness stiffness;   /* of the last row of the history, or of step 0 */
    struct reaction_sums reacted; /* of the last evaluation */
    struct loading *loading;      /* of the bodies under force; NULL: there are none */
    struct load_sums load_sums;   /* of the last evaluation, where there are such bodies */
    struct subdomain_times times;
};

/* DM2_MEMORY, with its text. */
static inline enum dm2_status subdomain_no_memory(const struct subdomain *sd, struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "no memory for a subdomain of %zu elements", sd->p.n);
}

/* Makes *b hold count items of `size` bytes, with no contents kept: the items, or NULL without memory. */
static inline void *block_hold(struct block *b, size_t count, size_t size)
{
    if (size != 0 && count > SIZE_MAX / 2 / size)
        return NULL;
    void *grown = mem_grown(b->item, &b->cap, 0, count * size + 1, 1);
    if (grown != NULL)
        b->item = grown;
    return grown;
}

/* Appends *e. 0, or -1 without memory. */
static inline int element_array_add(struct element_array *a, const struct element *e)
{
    struct element *grown = mem_grown(a->item, &a->cap, a->n, a->n + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    a->item = grown;
    a->item[a->n++] = *e;
    return 0;
}

/* A sign of life, between two pieces of work that take long. */
static inline void subdomain_beat(const struct subdomain *sd)
{
    pulse_beat(&sd->model->pulse);
}

/* The global cell of a position r, cm. */
static inline int subdomain_cell_at(const struct subdomain *sd, const double r[2])
{
    return grid_cell(sd->map.grid, r[0], r[1]);
}

/* Do surveys compare elements close to each other? Not where far pairs interact, because any two elements
 * then have the same margin. */
static inline bool subdomain_surveys_close(const struct subdomain *sd)
{
    return !sd->model->has_far;
}

/* --- migrate.c --- */

/* Puts the stayers among the owned elements (sd->cell_of not -1) and the elements of the parcels into slots
 * in cell order, and hands the memory of pairs over to the lists to be built. With `initial` there are no old
 * lists. DM2_MEMORY; DM2_NUMERIC as subdomain_take_in. */
enum dm2_status migrate_arrange(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                                bool initial, struct dm2_error *err);

/* After migrate_arrange: keeps the positions from which surveys count displacements, and builds the lists.
 * `initial` and errors as of lists_build. */
enum dm2_status migrate_build_lists(struct subdomain *sd, bool initial, struct dm2_error *err);

/* --- pair_memory.c --- */

/* Adds the memory of every pair of an emigrant to the parcel of the rank that the emigrant goes to.
 * destination[owned slot] is that rank, -1 for a stayer. 0, or -1 without memory. */
int pair_memory_send(struct subdomain *sd, const int32_t *destination);

/* Hands all memory over to the lists to be built. Of the n_old slots that were owned, moved[] is the new slot
 * of a stayer, else PARTICLES_NONE; old_id[] are the ids of all old slots, mirrored ones too; sd->ids has the
 * new slots of newcomers and mirrored elements. With `initial` there are no old lists. 0, or -1 without
 * memory. */
int pair_memory_carry(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels, size_t n_old,
                      const uint32_t *moved, const uint32_t *old_id, bool initial);

/* --- wall_memory.c --- */

/* pair_memory_send and pair_memory_carry for the contacts with walls; 0 in a deck without walls. */
int wall_memory_send(struct subdomain *sd, const int32_t *destination);
int wall_memory_carry(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                      const uint32_t *moved);

/* Adds to *out, for the probes of walls, what the owned elements did to these; rank 0 adds how the walls
 * move. DM2_NUMERIC: a value leaves the range of its sum. */
enum dm2_status wall_probes_add(const struct subdomain *sd, struct measures *out, struct dm2_error *err);

/* Appends the memory of the owned elements' contacts with walls to *out, sorted. DM2_MEMORY. */
enum dm2_status wall_memory_collect(const struct subdomain *sd, struct section_array *out,
                                    struct dm2_error *err);

#endif
