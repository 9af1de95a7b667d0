/* The engine: the elements of one subdomain, their lists, and one time step of them.
 *
 * `dm2-seq` runs one subdomain that owns every cell; each server of a distributed run owns the cells of its
 * rectangle. Both call the same functions in the same order:
 *
 *     subdomain_create                     generate, assign to cells, link, build lists
 *     loop:  subdomain_forces              status of pairs, forces, heats at x(n); measures where due
 *            subdomain_move                leapfrog: v(n+1/2), x(n+1)
 *            exchange                      mirrored elements' new state (update), or migration (rebuild)
 *
 * Exchange in a distributed run. An *update* sends, for every destination, the state of the elements in
 * subdomain_send_list(dest), in that order; the receiver stores it in the slots
 * [subdomain_mirror_begin(src), subdomain_mirror_end(src)). A *rebuild* is subdomain_sort_out, which fills
 * one parcel per rank, the transport of the parcels, and subdomain_take_in with all parcels addressed to this
 * rank. With one rank a rebuild is sort_out and take_in of the own parcel, and an update is nothing.
 *
 * Lists stay valid while no two elements can have approached by more than their margin (struct margins) since
 * the last rebuild; who keeps the bounds (struct rebuild_plan) decides about rebuilds. No result depends on
 * when they happen.
 *
 * Every function that returns a status: DM2_MEMORY, and what its comment names. */
#ifndef DM2_ENGINE_SUBDOMAIN_H
#define DM2_ENGINE_SUBDOMAIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/domain_map.h"
#include "dm2/engine/element.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/model.h"
#include "dm2/engine/profile.h"
#include "dm2/engine/rebuild.h"

struct subdomain;

/* Generates the elements of `rank` and those it mirrors, links them and builds the lists. The state is that
 * of step 0. DM2_DECK where the deck's bodies overlap or hold no element. The model and the map are borrowed.
 */
enum dm2_status subdomain_create(const struct model *model, const struct domain_map *map, int rank,
                                 struct subdomain **out, struct dm2_error *err);

/* The same from records: `elements` (any order) are all those owned by `rank` and those it mirrors; pairs are
 * those that touch an owned element (others are ignored). `step` is the step they are at. */
enum dm2_status subdomain_restore(const struct model *model, const struct domain_map *map, int rank,
                                  int64_t step, const struct element *elements, size_t n_elements,
                                  const struct pair_record *pairs, size_t n_pairs, struct subdomain **out,
                                  struct dm2_error *err);
void subdomain_free(struct subdomain *sd);

int64_t subdomain_step(const struct subdomain *sd);    /* steps moved since the start of the run */
size_t subdomain_owned(const struct subdomain *sd);    /* elements owned */
size_t subdomain_mirrored(const struct subdomain *sd); /* elements mirrored from other ranks */
size_t subdomain_bytes(const struct subdomain *sd);    /* memory held */

/* Forces and heats at the present positions. With `measure`, also what subdomain_measures and
 * subdomain_collect(measured) report. DM2_NUMERIC on an overflow of the fixed-point sums: id and step. */
enum dm2_status subdomain_forces(struct subdomain *sd, bool measure, struct dm2_error *err);

/* After subdomain_move, and the state sent to the others: begins the next subdomain_forces, which is to have
 * the same `measure`, with the pairs that no mirrored element takes part in, while the others' new states are
 * on the way. Nothing but the exchange may come between the two; an update leaves what was begun as it is, a
 * rebuild drops it. */
void subdomain_forces_ahead(struct subdomain *sd, bool measure);

/* Measures of the owned elements (a pair counts where its lower id is owned); valid after
 * subdomain_forces(measure) and, for the kinetic part, filled by the following subdomain_move or, at the end
 * of a run, subdomain_measure_last. *out is complete after that call. */
enum dm2_status subdomain_move(struct subdomain *sd, double *dmax, struct measures *out,
                               struct dm2_error *err);
/* dmax: largest displacement of an owned element in this step, cm. `out` may be NULL where the step did not
 * measure. DM2_NUMERIC: an element went non-finite or moved further than a cell edge in one step: id, step,
 * position. */

/* The displacements of the owned elements since the last rebuild, for struct rebuild_plan; `close` is of the
 * mirrored ones too, as these were before the last move. After subdomain_move, before subdomain_sort_out or
 * the next subdomain_take_update. */
void subdomain_survey(struct subdomain *sd, struct spread *out);

/* As subdomain_move, without moving: the measures of the last state of a run. The subdomain is then spent:
 * only subdomain_collect and subdomain_free may follow. */
enum dm2_status subdomain_measure_last(struct subdomain *sd, struct measures *out, struct dm2_error *err);

/* Adds the owned elements to the bins of the deck's profile `which`, after subdomain_forces(measure) and
 * before the move. DM2_NUMERIC: a value beyond the sums. */
enum dm2_status subdomain_profile(const struct subdomain *sd, size_t which, struct profile_bin *bins,
                                  struct dm2_error *err);

/* --- update --- */

/* What of a mirrored element changes between rebuilds, by the physics of the deck. Position always. */
enum update_field {
    UPDATE_VELOCITY = 1,    /* 2 doubles */
    UPDATE_SPIN = 2,        /* 1 */
    UPDATE_HEAT = 4,        /* 1 */
    UPDATE_PRESSURE = 8,    /* 1 */
    UPDATE_KIND = 16,       /* 1: kind + 65536 was */
    UPDATE_COMPOSITION = 32 /* 2 */
};
unsigned subdomain_update_fields(const struct model *model);

/* Doubles per element in an update: 2 and those of the fields. */
size_t subdomain_update_width(const struct model *model);

/* Number of elements that an update sends to `dest`, and gets from `src`. */
size_t subdomain_send_count(const struct subdomain *sd, int dest);
size_t subdomain_receive_count(const struct subdomain *sd, int src);

/* Writes the update for `dest`: send_count x update_width doubles, element by element. */
void subdomain_pack_update(const struct subdomain *sd, int dest, double *out);
/* Takes the update from `src`: receive_count x update_width doubles. DM2_NUMERIC: a value is not finite.
 * DM2_PROTOCOL: a kind that the deck does not have. */
enum dm2_status subdomain_take_update(struct subdomain *sd, int src, const double *in, struct dm2_error *err);

/* --- rebuild --- */

/* What one rank gives another at a rebuild. Arrays are owned by the parcel's maker. */
struct parcel {
    struct element *migrants; /* elements that change owner, */
    size_t n_migrants;
    struct pair_record *pairs; /* the memory of all their pairs, */
    size_t n_pairs;
    struct element *mirrors; /* and elements in cells that the receiver mirrors */
    size_t n_mirrors;
};

/* Fills parcels[0 .. ranks-1] (parcels[rank]: mirrors among what this rank itself sends away, from its own
 * former elements). They stay valid until the next call with this subdomain. Emigrants leave the subdomain.
 */
enum dm2_status subdomain_sort_out(struct subdomain *sd, struct parcel *parcels, struct dm2_error *err);

/* Takes what came: n parcels addressed to this rank, the own one among them, in any order. Sorts the elements
 * into cells, carries the memory of pairs over, builds lists. DM2_PROTOCOL: an element that does not belong
 * here or came twice. */
enum dm2_status subdomain_take_in(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                                  struct dm2_error *err);

/* --- states --- */

/* Writes the owned elements (subdomain_owned of them), in id order, and where `measured` is not NULL what the
 * last measuring step measured of each, in the same order. */
enum dm2_status subdomain_collect(const struct subdomain *sd, struct element *elements,
                                  struct element_measure *measured, struct dm2_error *err);

/* The pairs with memory whose lower id is owned, sorted by (id_a, id_b). *pairs is malloc'd for the caller.
 */
enum dm2_status subdomain_collect_pairs(const struct subdomain *sd, struct pair_record **pairs,
                                        size_t *n_pairs, struct dm2_error *err);

/* Hands the state of the owned elements to `write`, record by record (state_view's functions), so that a
 * whole state never exists twice. What `write` returns, or DM2_MEMORY. */
typedef enum dm2_status (*subdomain_writer)(void *context, const struct state_view *state,
                                            struct dm2_error *err);
enum dm2_status subdomain_write(const struct subdomain *sd, subdomain_writer write, void *context,
                                struct dm2_error *err);

/* Seconds spent since the last call of this function, by phase. */
struct subdomain_times {
    double rebuild, forces, integrate;
    uint64_t rebuilds;
};
void subdomain_take_times(struct subdomain *sd, struct subdomain_times *out);

#endif
