/* Reads snapshots: VTK PolyData as this program writes it (output/snapshot.h), into arrays of doubles. */
#ifndef DM2_PLOT_VTP_READER_H
#define DM2_PLOT_VTP_READER_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"

enum { VTP_NAME_MAX = 64 };

struct vtp_array {
    char section[16]; /* FieldData, Points, Verts, Lines, PointData or CellData */
    char name[VTP_NAME_MAX];
    size_t components, n_tuples;
    double *values; /* n_tuples x components */
};

struct vtp_names {
    size_t n;
    char **name;
};

struct vtp {
    size_t n_points; /* of elements; those of feet and walls come behind them */
    size_t n_lines;
    struct vtp_array *arrays;
    size_t n_arrays;
    struct vtp_names materials, bodies, walls;
    /* Pointers into `arrays`. */
    const double *position; /* n_points x 3, then further points */
    const double *line;     /* n_lines x 2 indices of points, checked: of the linked pairs whose line has a
                               length; of all lines where the file has no array `linked` of cells */
    const double *outline;  /* indices of points, checked: the polyline of each wall, one after the other */
    const double *outline_end; /* [walls.n] where each ends in `outline`, ascending */
    size_t outline_start;      /* where the first begins */
};

/* Reads a .vtp into *out, which the caller frees with vtp_free; *out is empty after a failure. DM2_IO,
 * DM2_MEMORY; DM2_PROTOCOL with path:line: the file is no well-formed PolyData with one piece of inline
 * binary (UInt64 headers, little-endian) or ascii arrays, an array's length does not fit the number of
 * points, or a line names an absent point. */
enum dm2_status vtp_read(const char *path, struct vtp *out, struct dm2_error *err);
void vtp_free(struct vtp *vtp);

/* The array `name` of a section, or NULL. *vtp keeps it. */
const struct vtp_array *vtp_find(const struct vtp *vtp, const char *section, const char *name);

/* The first value of a field data array, or `otherwise` where the file lacks the array. */
double vtp_value(const struct vtp *vtp, const char *name, double otherwise);

#endif
