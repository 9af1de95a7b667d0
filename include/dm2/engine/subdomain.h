/* The engine: the elements of one subdomain, their lists, and one time step.
 *
 * `dm2-seq` runs one subdomain that owns every cell; each server of a distributed run owns the cells of its
 * rectangle. Both call the same functions in the same order:
 *
 *     subdomain_create                     generate, assign to cells, link, build lists
 *     loop:  subdomain_forces              status of pairs, forces, heats at x(n); measures where due
 *            subdomain_move                leapfrog: v(n+1/2), x(n+1)
 *            exchange                      mirrored elements' new state (update), or migration (rebuild)
 *
 * Exchange in a distributed run. In an *update* every rank sends the elements that
 * subdomain_pack_update(dest) packs, in their order, and subdomain_take_update(src) stores them in the slots
 * mirrored from src. A *rebuild* is subdomain_sort_out, which fills one parcel per rank, the transport of the
 * parcels, and subdomain_take_in with all parcels addressed to this rank. With one rank an update has no
 * elements, and a rebuild takes in the rank's own parcel.
 *
 * Lists are valid while no two elements can have approached by more than their margin (struct margins) since
 * the last rebuild. The keeper of struct rebuild_plan decides when to rebuild; no result depends on when
 * rebuilds happen.
 *
 * Every function that returns a status can return DM2_MEMORY, and the errors that its comment names. */
#ifndef DM2_ENGINE_SUBDOMAIN_H
#define DM2_ENGINE_SUBDOMAIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/crack.h"
#include "dm2/engine/domain_map.h"
#include "dm2/engine/element.h"
#include "dm2/engine/load_totals.h"
#include "dm2/engine/loading.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/model.h"
#include "dm2/engine/profile.h"
#include "dm2/engine/overlap.h"
#include "dm2/engine/rebuild.h"
#include "dm2/engine/section.h"
#include "dm2/engine/wall_sums.h"

/* The memory that a subdomain takes for each of its cells, beside its elements, bytes. */
enum { SUBDOMAIN_CELL_BYTES = 49 };

struct subdomain;

/* Generates the elements that `rank` owns or mirrors, links them and builds the lists: the state of step 0.
 * The model and the map are borrowed; *out is the caller's, to be freed by subdomain_free. Forces make no
 * sense before overlap_check has passed the merged overlaps of all ranks. DM2_DECK: a body holds no
 * element. */
enum dm2_status subdomain_create(const struct model *model, const struct domain_map *map, int rank,
                                 struct subdomain **out, struct dm2_error *err);

/* The same with n given elements of a whole system in place of those that the deck makes. */
enum dm2_status subdomain_link(const struct model *model, const struct domain_map *map, int rank,
                               const struct element *elements, size_t n, struct subdomain **out,
                               struct dm2_error *err);

/* The same from the records of a state, arrays in any order. state->elements hold at least all elements that
 * `rank` owns or mirrors, pairs at least all pairs with memory and an owned element, sections at least all
 * records of owned elements and of the run; others are ignored. */
enum dm2_status subdomain_restore(const struct model *model, const struct domain_map *map, int rank,
                                  const struct state_view *state, struct subdomain **out,
                                  struct dm2_error *err);
void subdomain_free(struct subdomain *sd);

int64_t subdomain_step(const struct subdomain *sd);    /* steps moved since the start of the run */
size_t subdomain_owned(const struct subdomain *sd);    /* elements owned */
size_t subdomain_mirrored(const struct subdomain *sd); /* elements mirrored from other ranks */
size_t subdomain_bytes(const struct subdomain *sd);    /* memory held */

/* Pairs that subdomain_create found pressed together; of a restored subdomain none. */
const struct overlap *subdomain_overlap(const struct subdomain *sd);

/* Forces and heats at the present positions. With `measure`, also the measures of subdomain_move and
 * subdomain_measure_last, and the `measured` of subdomain_collect. DM2_NUMERIC: the fixed-point sums
 * overflow; the text names id and step. */
enum dm2_status subdomain_forces(struct subdomain *sd, bool measure, struct dm2_error *err);

/* Begins the next subdomain_forces, which must have the same `measure`, with the pairs of owned elements
 * only, while the mirrored elements' new states are on the way. To be called after subdomain_move and after
 * the own states are sent. Only the exchange may come before subdomain_forces: an update keeps the forces
 * begun, a rebuild drops them. */
void subdomain_forces_ahead(struct subdomain *sd, bool measure);

/* Moves the owned elements by one step. *dmax: the largest displacement of an owned element in this step, cm.
 * *out: the measures of the owned elements (a pair counts where its lower id is owned) at the step that
 * subdomain_forces(measure) evaluated; NULL where that call did not measure. DM2_NUMERIC: an element's state
 * is not finite, or an element moved further than a cell edge in one step; the text names id, step, position.
 */
enum dm2_status subdomain_move(struct subdomain *sd, double *dmax, struct measures *out,
                               struct dm2_error *err);

/* The totals of the bodies under force, [model_forced], by the owned elements, at the last subdomain_forces.
 */
const struct load_totals *subdomain_load_totals(const struct subdomain *sd);

/* Takes the totals of all subdomains, [model_forced], of the step before subdomain_step. To be called after
 * every subdomain_move where the deck has bodies under force. */
void subdomain_take_totals(struct subdomain *sd, const struct load_totals *totals);

/* The states of the bodies under force; NULL where there are none. */
struct loading *subdomain_loading(const struct subdomain *sd);

/* The displacements of the owned elements since the last rebuild, for struct rebuild_plan. out->close
 * includes the mirrored elements at their positions before the last move. To be called after subdomain_move
 * and before subdomain_sort_out or the next subdomain_take_update. */
void subdomain_survey(struct subdomain *sd, struct spread *out);

/* The measures as of subdomain_move, without a move: for the last state of a run. Afterwards only
 * subdomain_collect and subdomain_free may be called. */
enum dm2_status subdomain_measure_last(struct subdomain *sd, struct measures *out, struct dm2_error *err);

/* The links that broke in the last subdomain_forces, each of the pairs whose lower id is owned, in any order.
 * Borrowed; valid until the next subdomain_forces or subdomain_forces_ahead. Sorting the list is allowed. */
struct crack_list *subdomain_cracks(struct subdomain *sd);

/* Adds the owned elements to the bins of the deck's profile `which`. To be called after
 * subdomain_forces(measure) and before the move. DM2_NUMERIC: a value is beyond the range of the sums. */
enum dm2_status subdomain_profile(const struct subdomain *sd, size_t which, struct profile_bin *bins,
                                  struct dm2_error *err);

/* --- update --- */

/* The fields of a mirrored element that change between rebuilds besides its position, by the physics of the
 * deck. */
enum update_field {
    UPDATE_VELOCITY = 1,    /* 2 doubles */
    UPDATE_SPIN = 2,        /* 1 */
    UPDATE_HEAT = 4,        /* 1 */
    UPDATE_PRESSURE = 8,    /* 1 */
    UPDATE_KIND = 16,       /* 1: kind + 65536 was */
    UPDATE_COMPOSITION = 32 /* 2 */
};
unsigned subdomain_update_fields(const struct model *model);

/* Doubles per element in an update: 2 of the position and those of the fields. */
size_t subdomain_update_width(const struct model *model);

/* Number of elements in an update to `dest`, and in an update from `src`. */
size_t subdomain_send_count(const struct subdomain *sd, int dest);
size_t subdomain_receive_count(const struct subdomain *sd, int src);

/* Writes the update for `dest` to out[send_count][update_width]. */
void subdomain_pack_update(const struct subdomain *sd, int dest, double *out);

/* Takes the update in[receive_count][update_width] from `src`. DM2_NUMERIC: a value cannot be: it is not
 * finite, or an element is more than two cell edges from its position before or outside the periodic domain,
 * cannot become its kind, or has more of a reactant than before. */
enum dm2_status subdomain_take_update(struct subdomain *sd, int src, const double *in, struct dm2_error *err);

/* --- rebuild --- */

/* The elements and pairs that one rank gives another at a rebuild. The maker of the parcel owns the arrays:
 * the sending subdomain, or the program that received and decoded the parcel. */
struct parcel {
    struct element *migrants; /* elements that change owner */
    size_t n_migrants;
    struct pair_record *pairs; /* the memory of all pairs of the migrants */
    size_t n_pairs;
    struct wall_contact *walls; /* the memory of all wall contacts of the migrants */
    size_t n_walls;
    struct element *mirrors; /* elements in cells that the receiver mirrors */
    size_t n_mirrors;
};

/* Fills parcels[ranks]; parcels[rank] has the emigrants that this rank itself mirrors. The arrays are valid
 * until the next call with this subdomain. Emigrants leave the subdomain. */
enum dm2_status subdomain_sort_out(struct subdomain *sd, struct parcel *parcels, struct dm2_error *err);

/* Takes all parcels addressed to this rank, its own among them, in any order: sorts the elements into cells,
 * carries the memory of pairs over, builds lists. DM2_NUMERIC: an element has an unknown kind, lies in a
 * cell that this rank neither owns nor mirrors, or came twice, or there are more elements or pairs than slots
 * or entries can number. */
enum dm2_status subdomain_take_in(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                                  struct dm2_error *err);

/* --- walls --- */

/* What each wall of the deck felt at the last subdomain_forces, over the owned elements: [config.n_walls],
 * valid until the next one. The sums of several subdomains merge by wall_sums_merge. */
const struct wall_sums *subdomain_wall_sums(const struct subdomain *sd);

/* Force, Mbar cm2, and torque, Mbar cm3, on a wall, and the heat that it conducts into elements, g cm2/us3.
 */
struct wall_load {
    double force[2], torque, heat;
};
struct wall_load subdomain_wall_load(const struct model *model, const struct wall_sums *sums);

/* --- states --- */

/* Writes the owned elements to elements[subdomain_owned] in id order, and where `measured` is not NULL the
 * values of the last measuring step to measured[subdomain_owned], in the same order. */
enum dm2_status subdomain_collect(const struct subdomain *sd, struct element *elements,
                                  struct element_measure *measured, struct dm2_error *err);

/* The pairs with memory whose lower id is owned, sorted by (id_a, id_b). *pairs is the caller's, to be
 * released by free(). */
enum dm2_status subdomain_collect_pairs(const struct subdomain *sd, struct pair_record **pairs,
                                        size_t *n_pairs, struct dm2_error *err);

/* Appends to out[SECTION_COUNT] the records of further sections of owned elements. BODY, which is known only
 * where the totals of all ranks are, comes from loading_collect; subdomain_write has it. The caller frees
 * them with section_free, also after a failure. */
enum dm2_status subdomain_collect_sections(const struct subdomain *sd,
                                           struct section_array out[SECTION_COUNT], struct dm2_error *err);

/* The pairs that touch or are linked and whose lower id is owned, as of the last evaluation, a measuring one
 * of a step that has a snapshot; sorted likewise, with their forces beside them. The caller frees *pairs and
 * *forces with free(), also after a failure. */
enum dm2_status subdomain_collect_acting(const struct subdomain *sd, struct pair_record **pairs,
                                         struct pair_measure **forces, size_t *n_pairs,
                                         struct dm2_error *err);

/* Appends the forces of walls on owned elements, as of the same evaluation, sorted by element and feature, to
 * *out, an array of SECTION_WFOR that the caller frees, also after a failure. */
enum dm2_status subdomain_collect_wall_forces(const struct subdomain *sd, struct section_array *out,
                                              struct dm2_error *err);

/* Hands the state of the owned elements to `write` record by record (the functions of struct state_view), so
 * that a whole state never exists twice. Returns the status of `write`, or DM2_MEMORY. */
typedef enum dm2_status (*subdomain_writer)(void *context, const struct state_view *state,
                                            struct dm2_error *err);
enum dm2_status subdomain_write(const struct subdomain *sd, subdomain_writer write, void *context,
                                struct dm2_error *err);

/* By phase, since the last call of subdomain_take_times. */
struct subdomain_times {
    double rebuild, forces, integrate; /* s */
    uint64_t rebuilds;                 /* rebuilds, each a subdomain_take_in */
};
void subdomain_take_times(struct subdomain *sd, struct subdomain_times *out);

#endif
