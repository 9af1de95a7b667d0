/* Walls as polylines, for pictures. */
#ifndef DM2_ENGINE_WALL_OUTLINE_H
#define DM2_ENGINE_WALL_OUTLINE_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/loading.h"
#include "dm2/engine/model.h"

/* Wall k of the config has the points [start[k], start[k + 1]), joined in their order. */
struct wall_outlines {
    size_t n_walls, *start;
    double (*point)[2]; /* cm */
};

/* The walls of the model where they are at `step`: a line by its points, of which a closed one has the first
 * once more at its end, a circle by 128 chords. Where the domain is periodic, the centre lies in the domain.
 * loading: of the present step `step`; NULL: no forces move anything. The caller frees *out with
 * wall_outlines_free, also after a failure. DM2_MEMORY. */
enum dm2_status wall_outlines_find(const struct model *model, const struct loading *loading, int64_t step,
                                   struct wall_outlines *out, struct dm2_error *err);
void wall_outlines_free(struct wall_outlines *outlines);

#endif
