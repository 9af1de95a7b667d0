/* Plane geometry of the shapes of bodies, voids and regions. */
#ifndef DM2_DECK_SHAPE_H
#define DM2_DECK_SHAPE_H

#include <stdbool.h>

#include "dm2/deck/config.h"

/* True if the shape contains the point (x, y), cm. Rectangles and polygons are half-open, so that adjacent
 * shapes share no point and leave no point out. A disc contains its rim. */
bool shape_contains(const struct shape_config *shape, double x, double y);

/* Does the shape contain the lattice site r, cm? A site within SITE_TOLERANCE spacings of an edge is on the
 * edge, whatever its coordinates were rounded to: a rectangle and a polygon contain a site on their lower and
 * left edges, and none on the others; a disc contains a site on its rim. `spacing` is that of the lattice,
 * cm. */
#define SITE_TOLERANCE 1e-9
bool shape_contains_site(const struct shape_config *shape, const double r[2], double spacing);

/* The same for the site and its images whole periods of the config's domain away. */
bool shape_contains_image(const struct shape_config *shape, const struct config *config, const double r[2],
                          double spacing);

/* The vector by which a point near an edge is moved to decide on which side of the edge the point is, cm. All
 * shapes and lines move a point alike, so that shapes that share a border share out the sites on the border.
 */
void shape_site_shift(double spacing, double shift[2]);

/* The whole numbers k, first to last along each direction, for which k periods of the config's domain lie
 * between low and high, cm, and their neighbours by rounding; 0 alone along a direction without periods. At
 * most IMAGE_MAX along a direction. */
enum { IMAGE_MAX = 100 };
struct image_range {
    int64_t first[2], last[2];
};
struct image_range shape_images(const struct config *config, const double low[2], const double high[2]);

/* The smallest box around the shape: x0 y0 x1 y1, cm. */
void shape_box(const struct shape_config *shape, double box[4]);

/* The area of the shape, cm2. */
double shape_area(const struct shape_config *shape);

/* True if the interiors of the shapes overlap. Shapes that only touch do not overlap. */
bool shape_overlaps(const struct shape_config *a, const struct shape_config *b);

/* True if shape_overlaps holds for `a`, or an image of `a` one period of the config's domain away, and `b`.
 */
bool shape_image_overlaps(const struct shape_config *a, const struct config *config,
                          const struct shape_config *b);

/* True if two edges of a polygon cross or touch, other than neighbours at their common vertex. Such a polygon
 * has no defined inside. */
bool shape_crosses_itself(const struct shape_config *polygon);

#endif
