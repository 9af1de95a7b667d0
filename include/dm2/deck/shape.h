/* Plane geometry of the shapes of bodies, voids and regions. */
#ifndef DM2_DECK_SHAPE_H
#define DM2_DECK_SHAPE_H

#include <stdbool.h>

#include "dm2/deck/config.h"

/* True if the shape contains the point (x, y), cm. Rectangles and polygons are half-open, so that adjacent
 * shapes share no point and leave no point out. A disc contains its rim. */
bool shape_contains(const struct shape_config *shape, double x, double y);

/* The smallest box around the shape: x0 y0 x1 y1, cm. */
void shape_box(const struct shape_config *shape, double box[4]);

/* The area of the shape, cm2. */
double shape_area(const struct shape_config *shape);

/* True if the interiors of the shapes overlap. Shapes that only touch do not overlap. */
bool shape_overlaps(const struct shape_config *a, const struct shape_config *b);

/* True if two edges of a polygon cross or touch, other than neighbours at their common vertex. Such a polygon
 * has no defined inside. */
bool shape_crosses_itself(const struct shape_config *polygon);

#endif
