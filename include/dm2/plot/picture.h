/* Pictures of a state: every element a disc to scale, coloured by its kind or by a measured quantity. */
#ifndef DM2_PLOT_PICTURE_H
#define DM2_PLOT_PICTURE_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"
#include "dm2/plot/vtp_reader.h"

struct picture_options {
    const char *colour; /* one of picture_colours(); NULL: material */
    bool links;         /* draw the links too */
    double range[2];    /* of the colours; NaN: the range of the values */
    const char *title;  /* may be NULL */
    double width;       /* px; 0: 900 */
};

/* The words for `colour`, blank-separated, for usage and messages. */
const char *picture_colours(void);

/* Draws the state into the SVG file `path`. The picture shows the domain, and the elements that left it up
 * to a distance of half its larger side; the subtitle counts the elements further out. DM2_USAGE: an
 * unknown colour, a colour for which the file has no array, an empty range, or a width without room for
 * the elements; DM2_IO, DM2_MEMORY. */
enum dm2_status picture_write(const char *path, const struct vtp *vtp, const struct picture_options *options,
                              struct dm2_error *err);

#endif
