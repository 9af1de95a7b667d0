/* Walls as the engine sees them: signed features and laws, worked out from the config.
 *
 * The distance from the centre c of an element has minima and maxima along a line. With b = e_before . (c -
 * p) and f = e_after . (c - p) at each vertex p, the same numbers for all features that share the vertex, a
 * feature counts with the sign
 *
 *     segment  +1 where f >= 0 at its start and b < 0 at its end
 *     vertex   +1 where b >= 0 and f < 0, a minimum; -1 where b < 0 and f >= 0, a maximum
 *     end      +1 beyond the end of an open line
 *
 * and else not at all. A circle is one feature. Where a minimum and a maximum are born or die, their
 * distances are equal, so that sums over features with their signs are continuous.
 *
 * Features of a line are numbered along the line: vertex k is 2k, the segment behind the vertex 2k + 1. A
 * part that is longer than half of a periodic side is several segments, because then only one image of a
 * segment can be near an element. Source: docs/physics.md, section 11. */
#ifndef DM2_ENGINE_WALL_SHAPE_H
#define DM2_ENGINE_WALL_SHAPE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "law.h"
#include "tables.h"

struct wall_vertex {
    double p[2];                /* cm, at the start */
    double before[2], after[2]; /* unit directions of the segments before and behind; of an open end's missing
                                   segment 0 0 */
};

struct wall {
    const struct wall_config *config;
    size_t mover; /* the number by which motion_at knows the wall */
    bool circle, closed;
    int seam[2];       /* of a closed line: sizes of the domain from the start to the end */
    size_t n_vertices; /* 0: a circle */
    struct wall_vertex *vertex;
    size_t n_features, first; /* the numbers of its features: first, first + 1, ... */
    double centre[2], radius; /* cm; about the centre the wall turns */
    double extent;            /* largest distance of a point of a line from the centre, cm; 0: a circle */
    size_t temperature_load;  /* of the config; n_loads: none */
    struct pair_law *laws;    /* [n_kinds] of an element of each kind with the wall; never links */
};

/* Makes m->walls from the config; m->laws and m->grid are built. DM2_DECK with the place of the wall where
 * its interaction with a kind of element has scope all; DM2_MEMORY. */
enum dm2_status walls_make(struct model *m, struct dm2_error *err);
void walls_unmake(struct model *m);

/* The number of features that a wall has, by the size of the domain. */
size_t walls_count_features(const struct wall_config *c, const struct grid *g);

/* The wall that has the feature. */
const struct wall *walls_of_feature(const struct model *m, size_t feature);

#endif
