/* States for viewers: VTK PolyData (.vtp, ParaView) with a .pvd series, and extended XYZ (OVITO).
 *
 * The .vtp holds one point and one vertex per element, and one line per pair that touches or is linked. Per
 * point: id, kind, body, grain, radius [cm], velocity [cm/us], spin [1/us], temperature [K], pressure [Mbar],
 * stress [Mbar] (xx, yy, xy), phase where the deck has phases, composition where it has a reaction (mass
 * fractions a, b, product), links, contacts, bonds (links at the start), damage (1 - links/bonds), fragment
 * where it is known (output/fragments.h), and strain (xx, yy, xy) where the deck asks for it. Per cell, first
 * the vertices (0), then the lines: id_a, id_b (of a vertex its element's), linked, force_x, force_y (on
 * element id_a; exactly what the sums of the run added), normal (> 0 pushes apart), tangential [Mbar cm2]. A
 * line across a periodic side, or to an element that is not shown, begins and ends at one point, so that
 * nothing is drawn.
 *
 * In a deck with walls, points without a vertex follow: the foot of each contact with a wall, then the points
 * of the walls. Their values are 0 but for id, 4294967295. After the lines of pairs come a line from each
 * element to its foot (id_b 4294967295; force on the element), then a polyline per wall (both ids
 * 4294967295), and each cell has `wall`, the index in the array `walls` of names in the field data, 65535 of
 * none. The feet of an element that is not shown have lines without length.
 *
 * The deck's `fields` and `bodies` choose of these. Field data: TimeValue [us], step,
 * domain (x0, y0, width, height [cm]), periodic, and the names of kinds (array `materials`, indexed by
 * `kind`) and of bodies. Positions and velocities have a z of 0. Numbers are little-endian in base64,
 * floating point numbers 64 bits wide.
 *
 * The .xyz has the values of elements as text, with the name of the kind as species.
 *
 * The bytes depend on the snapshot alone. Every function: DM2_IO, DM2_MEMORY; no file is left under `path`
 * after a failure. */
#ifndef DM2_OUTPUT_SNAPSHOT_H
#define DM2_OUTPUT_SNAPSHOT_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/element.h"
#include "dm2/output/results.h"

/* A state as measured at one step. All pointers are borrowed; `elements` in id order, `measured` beside
 * them. */
struct snapshot {
    const struct config *config;
    int64_t step;
    const struct element *elements;
    const struct element_measure *measured;
    size_t n_elements;
    const struct pair_record *pairs;
    const struct pair_measure *forces; /* beside the pairs */
    size_t n_pairs;
    const uint32_t *fragment;           /* fragment of each element, or NULL: unknown */
    const struct snapshot_walls *walls; /* NULL: the deck has none */
};

/* Write the state in one format. snapshot_write_vtp: DM2_NUMERIC, too, where a pair names an absent
 * element. */
enum dm2_status snapshot_write_vtp(const char *path, const struct snapshot *s, struct dm2_error *err);
enum dm2_status snapshot_write_xyz(const char *path, const struct snapshot *s, struct dm2_error *err);

/* The steps of the snapshots of a run, ascending. `items` is malloc'd. */
struct snapshot_steps {
    int64_t *items;
    size_t n, cap;
};

/* Writes the ParaView collection of the files state-STEP.vtp (snapshot_file_name) beside `path`, one per
 * step; `config` gives their times. */
enum dm2_status snapshot_write_series(const char *path, const int64_t *steps, size_t n_steps,
                                      const struct config *config, struct dm2_error *err);

/* The name of a step's file in its directory: "state-000000200.vtp" for suffix "vtp". */
enum { SNAPSHOT_NAME_MAX = 48 };
void snapshot_file_name(int64_t step, const char *suffix, char out[SNAPSHOT_NAME_MAX]);

#endif
