/* The tables that the engine computes with, worked out from a config: kinds of elements, pair laws, scales of
 * the fixed-point sums, the stable time step. Everything is plain numbers: two programs that load the same
 * deck have the same model, bit for bit. */
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

struct model; /* completed in engine/tables.h for the engine; the accessors below are what other layers need
               */

/* What a deck asks for, from its areas alone: to be looked at before anything is made of it. */
struct model_estimate {
    double elements; /* area of the bodies over that of an element: voids and pores are not taken off */
    double places;   /* lattice sites and grains that are gone through to make them */
    double cells;    /* of the grid */
};
struct model_estimate model_estimate(const struct config *config);

/* Works out the tables. The config is borrowed for the life of the model. DM2_DECK with the reason: r_c below
 * the contact distance, a law that cannot be calibrated, a powder that cannot be packed, a time step that is
 * not stable; the last two with their place in the deck (config_fail). */
enum dm2_status model_build(const struct config *config, struct model **out, struct dm2_error *err);

/* The same where somebody waits: the pulse beats while the model is built, and in all that is computed with
 * it. */
enum dm2_status model_build_watched(const struct config *config, struct pulse pulse, struct model **out,
                                    struct dm2_error *err);
void model_free(struct model *model);

const struct config *model_config(const struct model *model);
const struct grid *model_grid(const struct model *model);
/* What rebuild_plan_start needs. */
struct margins model_margins(const struct model *model);
struct measure_scales model_scales(const struct model *model);
size_t model_elements(const struct model *model); /* elements that the generator makes */
double model_stable_dt(const struct model *model,
                       const char **which); /* us; *which names the limiting mode */

/* Elements per cell, counts[cx*cy], as generated: for the decomposition by particles. */
enum dm2_status model_cell_counts(const struct model *model, uint32_t *counts, struct dm2_error *err);

#endif
