/* The grains of a body: the cells of a polycrystal, or the discs or polygons of a powder. Each is a small
 * region with a lattice of its own orientation. All of it follows from the deck and the body's seed, so that
 * every server makes the same. */
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

/* A side of a grain: inside is normal . x < offset. */
struct grain_side {
    double normal[2], length; /* outward, and its length */
    double offset;
    double shift[2];   /* of a neighbour across a periodic side, cm: it lies at its centre + shift */
    int64_t neighbour; /* index of the grain beyond, or GRAIN_NO_NEIGHBOUR */
};

struct grain {
    double centre[2];    /* also a site of its lattice, cm */
    double radius;       /* disc; infinite where the sides bound it */
    double box[4];       /* of its outline: x0 y0 x1 y1, cm */
    double cosine, sine; /* of its orientation */
    size_t first_side, n_sides;
};

struct grain_set {
    struct grain *grain;
    struct grain_side *side;
    size_t n, n_sides, side_cap;
    bool wraps[2]; /* the body goes round this periodic direction of the domain */
    double low[2], period[2];
    const struct pulse *pulse; /* beaten while they are made; NULL: none */
};

/* The grains of bodies[body] of the config, which is a polycrystal or a powder; first_grain is the global
 * number of its grain 0. Elements of two grains will be at least `apart` from each other, cm. DM2_DECK where
 * a powder cannot be packed (how dense it got is in the message); DM2_MEMORY. Free with grains_free, also
 * after a failure. */
enum dm2_status grains_build(const struct config *config, size_t body, uint32_t first_grain, double apart,
                             const struct pulse *pulse, struct grain_set *out, struct dm2_error *err);
void grains_free(struct grain_set *set);

/* Is x inside grain g by more than `margin`? */
bool grain_holds(const struct grain_set *set, const struct grain *g, const double x[2], double margin);

#endif
