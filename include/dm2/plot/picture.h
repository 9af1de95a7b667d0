/* Pictures of a state: every element a disc to scale, coloured by what it is or by what was measured of it.
 */
#ifndef DM2_PLOT_PICTURE_H
#define DM2_PLOT_PICTURE_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"
#include "dm2/plot/vtp_reader.h"

struct picture_options {
    const char *colour; /* one of picture_colours(); NULL: material */
    bool links;         /* draw them too */
    double range[2];    /* of the colours; NaN: as the values say */
    const char *title;  /* may be NULL */
    double width;       /* px; 0: 900 */
};

/* The words for `colour`, blank-separated, for usage and messages. */
const char *picture_colours(void);

/* Draws the state. The picture shows the domain, and beyond it, up to half of its larger side, the elements
 * that left it; those further out are counted in the subtitle. DM2_USAGE: a colour that is not known, that
 * the file has no array for, or a range or width that is none; DM2_IO, DM2_MEMORY. */
enum dm2_status picture_write(const char *path, const struct vtp *vtp, const struct picture_options *options,
                              struct dm2_error *err);

#endif
