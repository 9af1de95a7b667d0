/* Plane geometry of the bodies' shapes. */
#ifndef DM2_DECK_SHAPE_H
#define DM2_DECK_SHAPE_H

#include <stdbool.h>

#include "dm2/deck/config.h"

/* Does the shape contain the point? A rectangle and a polygon are half-open, so that shapes side by side
 * share no point and leave none out; a disc has its rim. */
bool shape_contains(const struct shape_config *shape, double x, double y);

/* The smallest box around it: x0 y0 x1 y1. */
void shape_box(const struct shape_config *shape, double box[4]);

/* Its area, cm2. */
double shape_area(const struct shape_config *shape);

/* Do their interiors meet? Shapes that only touch do not. */
bool shape_overlaps(const struct shape_config *a, const struct shape_config *b);

/* Do two edges of a polygon cross or touch, other than neighbours at their vertex? Then it has no inside. */
bool shape_crosses_itself(const struct shape_config *polygon);

#endif
