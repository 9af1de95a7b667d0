/* The grains of a body: the cells of a polycrystal, or the discs or polygons of a powder. Each grain is a
 * small region with a lattice of its own orientation. The grains follow from the deck and the body's seed
 * alone, so that every server makes the same grains. */
#ifndef DM2_ENGINE_GRAINS_H
#define DM2_ENGINE_GRAINS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/pulse.h"

enum { GRAIN_NO_NEIGHBOUR = -1, POLYGON_CORNERS = 64 };

/* A convex polygon; its corners counter-clockwise. */
struct polygon {
    size_t n;
    double x[POLYGON_CORNERS][2];
};

/* A side of a grain; the inside is normal . x < offset. */
struct grain_side {
    double normal[2], length; /* outward normal and its length, cm */
    double offset;            /* cm2 */
    double shift[2];   /* the neighbour lies shifted by this vector, not 0 across a periodic side, cm */
    int64_t neighbour; /* index of the grain beyond the side, or GRAIN_NO_NEIGHBOUR */
};

struct grain {
    double centre[2]; /* also a site of the grain's lattice, cm */
    double radius;    /* of the disc, or of the circle through a polygon's corners, cm; infinite for a cell */
    double reach;     /* of a powder: radius of the circle about the centre that holds all elements, cm */
    double box[4];    /* of the outline: x0 y0 x1 y1, cm */
    double cosine, sine;        /* of the orientation */
    size_t first_side, n_sides; /* sides first_side .. first_side + n_sides of the set; 0 sides: a disc */
};

struct grain_set {
    struct grain *grain;
    struct grain_side *side;
    size_t n, n_sides, side_cap;
    bool wraps[2];             /* the body spans this periodic direction of the domain */
    double low[2], period[2];  /* lower corner and size of the domain, cm */
    const struct pulse *pulse; /* beats while the grains are made; NULL: none */
};

/* Makes the grains of bodies[body] of the config, a polycrystal or a powder; first_grain is the global number
 * of the body's grain 0. A grain also gets a side for each neighbour within `apart` cm, the least distance
 * that the caller keeps between elements of two grains. DM2_DECK where a powder cannot be packed (the message
 * has the fraction that can); DM2_MEMORY. Free with grains_free, also after a failure. */
enum dm2_status grains_build(const struct config *config, size_t body, uint32_t first_grain, double apart,
                             const struct pulse *pulse, struct grain_set *out, struct dm2_error *err);
void grains_free(struct grain_set *set);

/* Sets the random orientation of grain `id` (a global number) of the body. */
void grain_turn(const struct body_config *body, uint32_t id, struct grain *g);

/* Is x inside grain g by more than `margin`, cm? */
bool grain_holds(const struct grain_set *set, const struct grain *g, const double x[2], double margin);

#endif
