/* The tables that the engine computes with, worked out from a config: kinds of elements, pair laws, scales of
 * the fixed-point sums, the stable time step. All entries are plain numbers, and two programs that load the
 * same deck have the same model, bit for bit. */
#ifndef DM2_ENGINE_MODEL_H
#define DM2_ENGINE_MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/grid.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/pulse.h"
#include "dm2/engine/rebuild.h"

struct model; /* complete in src/engine/tables.h; other layers use the functions below */

/* The size of the run that a deck asks for, from the deck's areas alone: a program can refuse a deck that is
 * too large before it builds the model. */
struct model_estimate {
    double elements; /* area of the bodies over the area of an element; voids and pores are not subtracted */
    double places;   /* lattice sites and grains that the generator goes through */
    double cells;    /* of the grid */
};
struct model_estimate model_estimate(const struct config *config);

/* Works out the tables. *out belongs to the caller, who frees it with model_free; the config is borrowed for
 * the life of the model. DM2_DECK with the reason: r_c below the contact distance or a cutoff, a law that
 * cannot be calibrated, phases, reactions or strain without the interactions that they need, a grid that
 * grid_build refuses, a body without elements, too many elements or grains, a powder that cannot be packed, a
 * time step that is not stable; the powder and the time step with their place in the deck (config_fail).
 * DM2_MEMORY. On failure *out is NULL. */
enum dm2_status model_build(const struct config *config, struct model **out, struct dm2_error *err);

/* model_build with a pulse, which beats while the model is built and in all long work that uses the model.
 * DM2_INTERRUPTED, also of subdomain_create and model_cell_counts: pulse.stopped. */
enum dm2_status model_build_watched(const struct config *config, struct pulse pulse, struct model **out,
                                    struct dm2_error *err);
void model_free(struct model *model);

const struct config *model_config(const struct model *model);
const struct grid *model_grid(const struct model *model);
/* The margins of the neighbour lists, for rebuild_plan_start. */
struct margins model_margins(const struct model *model);
/* The shifts of all exact sums. */
struct measure_scales model_scales(const struct model *model);
/* The number of elements; a number that all ids are below, larger where a stage left bodies of its state out.
 */
size_t model_elements(const struct model *model);
size_t model_ids(const struct model *model);
/* The stable time step, us; *which is the name of the limiting mode, a constant text. */
double model_stable_dt(const struct model *model, const char **which);

/* The stable time step by the neighbours that the elements have at the start, us: the smaller of
 * model_stable_dt and the deck's dt over start->dt_share. `start`: the measures of step 0. */
double model_stable_start(const struct model *model, const struct measures *start, const char **which);

/* DM2_DECK, with the place of dt in the deck, where dt is not below the limit by the neighbours at the start.
 */
enum dm2_status model_check_start(const struct model *model, const struct measures *start,
                                  struct dm2_error *err);

/* The bodies whose contact could make the time step smallest: elements of body `body` have room for `count`
 * elements of body `other` around them, and then `dt`, us, would be the limit. count is 0 where no body has
 * room for more than six of another one's. Only the first MODEL_ROOM_BODIES bodies are compared. */
enum { MODEL_ROOM_BODIES = 1000 };
struct model_room {
    size_t body, other;
    int count;
    double dt;
};
struct model_room model_room(const struct model *model);

/* Fills counts[cx * cy] with the number of elements that the deck makes in each cell, the weights of the
 * decomposition by particles. DM2_MEMORY. */
enum dm2_status model_cell_counts(const struct model *model, uint32_t *counts, struct dm2_error *err);

/* Adds n elements to counts[cx * cy] of the cells in which they are, the weights for a run that goes on. */
struct element;
void model_count_elements(const struct model *model, const struct element *elements, size_t n,
                          uint32_t *counts);

#endif
