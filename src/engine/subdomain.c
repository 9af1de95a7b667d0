/* One subdomain: its creation, the order of the phases of a time step, its states. The phases themselves are
 * in lists.c, force.c, reaction.c, phase.c, strain.c and leapfrog.c, the exchange in survey.c, update.c and
 * migrate.c. */
#include "dm2/engine/subdomain.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/deck/schedule.h"
#include "drive.h"
#include "generate.h"
#include "homes.h"
#include "leapfrog.h"
#include "pair_forces.h"
#include "phase.h"
#include "probes.h"
#include "state_reader.h"
#include "subdomain_parts.h"

/* Makes room for n elements. 0, or -1 without memory. */
static int reserve_elements(struct element_array *a, size_t n)
{
    struct element *grown = mem_grown(a->item, &a->cap, a->n, n, sizeof *grown);
    if (grown == NULL)
        return -1;
    a->item = grown;
    return 0;
}

/* --- creation --- */

/* A subdomain without elements. *out is to be freed by subdomain_free after an error, too. DM2_MEMORY. */
static enum dm2_status open_subdomain(const struct model *model, const struct domain_map *map, int rank,
                                      int64_t step, struct subdomain **out, struct dm2_error *err)
{
    struct subdomain *sd = mem_zalloc(1, sizeof *sd);
    *out = sd;
    if (sd == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for a subdomain");
    sd->model = model;
    sd->map = *map;
    sd->rank = rank;
    sd->step = step;
    particles_start(&sd->p, model);
    sd->neighbours = mem_zalloc((size_t)map->ranks, sizeof *sd->neighbours);
    if (model->has_drives)
        sd->p.drives = sd->drives = mem_zalloc(model->config->n_bodies, sizeof *sd->drives);
    sd->p.runs = model->has_drives ? &sd->drive_runs : NULL;
    if (sd->neighbours == NULL || (model->has_drives && sd->drives == NULL))
        return subdomain_no_memory(sd, err);
    if (model->n_walls > 0 && walls_start(&sd->walls, model, err) != DM2_OK)
        return DM2_MEMORY;
    enum dm2_status status = loading_open(model, step, &sd->loading, err);
    return status == DM2_OK ? cells_build(&sd->cells, map, rank, err) : status;
}

/* The elements that a new subdomain owns, and those that it mirrors. */
struct chooser {
    struct subdomain *sd;
    struct element_array own, mirrors;
};

static enum dm2_status choose_element(void *context, const struct element *e, struct dm2_error *err)
{
    struct chooser *c = context;
    int32_t local = c->sd->cells.local_of[subdomain_cell_at(c->sd, e->r)];
    if (local < 0)
        return DM2_OK;
    if (element_array_add(local < c->sd->cells.n_own ? &c->own : &c->mirrors, e) != 0)
        return subdomain_no_memory(c->sd, err);
    return DM2_OK;
}

/* Puts the elements of *chosen into a new subdomain and builds its lists. The records are freed as soon as
 * the elements are in their slots, because the lists need the room. */
static enum dm2_status place_chosen(struct subdomain *sd, struct chooser *chosen,
                                    const struct state_view *state, bool initial, struct dm2_error *err)
{
    struct parcel parcel = {.migrants = chosen->own.item,
                            .n_migrants = chosen->own.n,
                            .mirrors = chosen->mirrors.item,
                            .n_mirrors = chosen->mirrors.n};
    if (state != NULL) {
        parcel.pairs = (struct pair_record *)state->pairs;
        parcel.n_pairs = state->n_pairs;
        parcel.walls = state->sections[SECTION_WCON].records;
        parcel.n_walls = state->sections[SECTION_WCON].n;
    }
    enum dm2_status status = migrate_arrange(sd, &parcel, 1, initial, err);
    free(chosen->own.item);
    free(chosen->mirrors.item);
    chosen->own.item = chosen->mirrors.item = NULL;
    idmap_free(&sd->ids); /* large enough for all elements; a rebuild has few newcomers */
    return status == DM2_OK ? migrate_build_lists(sd, initial, err) : status;
}

/* Counts the links that each owned element starts with. */
static void count_bonds(struct subdomain *sd)
{
    const struct lists *l = &sd->lists;
    for (size_t i = 0; i < sd->p.n_own; i++) {
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
            sd->p.bonds[i] = (uint16_t)(sd->p.bonds[i] + l->linked[k]);
            sd->p.bonds[l->near.j[k]] = (uint16_t)(sd->p.bonds[l->near.j[k]] + l->linked[k]);
        }
    }
}

/* Places the chosen elements of a new subdomain, after a status of DM2_OK, and frees the lists of the choice.
 * After a failure *out is freed, too. */
static enum dm2_status begin_chosen(enum dm2_status status, struct chooser *chosen, struct subdomain **out,
                                    struct dm2_error *err)
{
    if (status == DM2_OK)
        status = place_chosen(*out, chosen, NULL, true, err);
    free(chosen->own.item);
    free(chosen->mirrors.item);
    if (status != DM2_OK) {
        subdomain_free(*out);
        *out = NULL;
        return status;
    }
    count_bonds(*out);
    return DM2_OK;
}

enum dm2_status subdomain_create(const struct model *model, const struct domain_map *map, int rank,
                                 struct subdomain **out, struct dm2_error *err)
{
    double started = clock_now();
    enum dm2_status status = open_subdomain(model, map, rank, 0, out, err);
    struct chooser chosen = {.sd = *out};
    if (status == DM2_OK && map->ranks == 1 && reserve_elements(&chosen.own, model_elements(model)) != 0)
        status = subdomain_no_memory(*out, err);
    if (status == DM2_OK)
        status = generate_elements(model, choose_element, &chosen, err);
    status = begin_chosen(status, &chosen, out, err);
    if (status == DM2_OK)
        (*out)->times.rebuild += clock_now() - started;
    return status;
}

enum dm2_status subdomain_link(const struct model *model, const struct domain_map *map, int rank,
                               const struct element *elements, size_t n, struct subdomain **out,
                               struct dm2_error *err)
{
    enum dm2_status status = open_subdomain(model, map, rank, model->config->n_start, out, err);
    struct chooser chosen = {.sd = *out};
    for (size_t k = 0; k < n && status == DM2_OK; k++)
        status = choose_element(&chosen, &elements[k], err);
    return begin_chosen(status, &chosen, out, err);
}

enum dm2_status subdomain_restore(const struct model *model, const struct domain_map *map, int rank,
                                  const struct state_view *state, struct subdomain **out,
                                  struct dm2_error *err)
{
    enum dm2_status status = open_subdomain(model, map, rank, state->step, out, err);
    struct chooser chosen = {.sd = *out};
    if (status == DM2_OK && (*out)->loading != NULL)
        status = loading_restore((*out)->loading, &state->sections[SECTION_BODY], err);
    if (status == DM2_OK && map->ranks == 1 && reserve_elements(&chosen.own, state->n_elements) != 0)
        status = subdomain_no_memory(*out, err);
    struct section_array homes = {.n = 0};
    if (status == DM2_OK)
        status = homes_sorted(&state->sections[SECTION_HOME], &homes, err);
    for (size_t k = 0; k < state->n_elements && status == DM2_OK; k++) {
        struct element e = state->elements[k];
        if (model->placed[e.body] && map->owner[subdomain_cell_at(*out, e.r)] == (*out)->rank)
            status = homes_find(model, &homes, state->step, (*out)->loading, &e, err);
        if (status == DM2_OK)
            status = choose_element(&chosen, &e, err);
    }
    free(homes.records);
    /* All elements are newcomers or mirrors, so that sd->ids holds the id of every element of a pair. */
    if (status == DM2_OK)
        status = place_chosen(*out, &chosen, state, false, err);
    free(chosen.own.item);
    free(chosen.mirrors.item);
    if (status != DM2_OK) {
        subdomain_free(*out);
        *out = NULL;
    }
    return status;
}

void subdomain_free(struct subdomain *sd)
{
    if (sd == NULL)
        return;
    for (int r = 0; sd->neighbours != NULL && r < sd->map.ranks; r++) {
        free(sd->neighbours[r].migrants.item);
        free(sd->neighbours[r].mirrors.item);
        free(sd->neighbours[r].pairs.item);
        free(sd->neighbours[r].walls.item);
        free(sd->neighbours[r].send.item);
    }
    free(sd->neighbours);
    cells_free(&sd->cells);
    particles_free(&sd->p);
    force_drop(&sd->pass, &sd->lists);
    loading_free(sd->loading);
    load_sums_free(&sd->load_sums);
    lists_free(&sd->lists);
    walls_free(&sd->walls);
    strain_free(&sd->strain);
    stiffness_free(&sd->stiff);
    idmap_free(&sd->ids);
    free(sd->drives);
    free(sd->drive_runs.edge);
    free(sd->cell_of);
    free(sd->reacted.item);
    free(sd->from.item);
    free(sd->moved.item);
    free(sd->old_id.item);
    free(sd->anchors.item);
    free(sd->spreads.item);
    bins_free(&sd->anchor_bins);
    free(sd);
}

int64_t subdomain_step(const struct subdomain *sd)
{
    return sd->step;
}

size_t subdomain_owned(const struct subdomain *sd)
{
    return sd->p.n_own - sd->n_leaving;
}

size_t subdomain_mirrored(const struct subdomain *sd)
{
    return sd->p.n - sd->p.n_own;
}

const struct overlap *subdomain_overlap(const struct subdomain *sd)
{
    return &sd->lists.overlap;
}

size_t subdomain_bytes(const struct subdomain *sd)
{
    size_t bytes = sizeof *sd + particles_bytes(&sd->p) + lists_bytes(&sd->lists) +
                   sd->lists.cracks.cap * sizeof *sd->lists.cracks.items + cells_bytes(&sd->cells, &sd->map) +
                   sd->cell_cap * sizeof *sd->cell_of + sd->ids.slots * 8 + sd->from.cap + sd->moved.cap +
                   sd->old_id.cap + sd->anchors.cap + sd->spreads.cap + bins_bytes(&sd->anchor_bins) +
                   sd->strain.cap * STRAIN_SUMS * sizeof *sd->strain.sum + stiffness_bytes(&sd->stiff) +
                   sd->reacted.cap * sizeof *sd->reacted.item + walls_bytes(&sd->walls, sd->model) +
                   (sd->loading != NULL ? sizeof *sd->loading : 0) + load_sums_bytes(&sd->load_sums) +
                   sd->drive_runs.cap * sizeof *sd->drive_runs.edge;
    for (int r = 0; r < sd->map.ranks; r++)
        bytes += sd->neighbours[r].send.cap * sizeof(uint32_t) +
                 (sd->neighbours[r].migrants.cap + sd->neighbours[r].mirrors.cap) * sizeof(struct element) +
                 sd->neighbours[r].pairs.cap * sizeof(struct pair_record) +
                 sd->neighbours[r].walls.cap * sizeof(struct wall_contact);
    return bytes;
}

/* --- a time step --- */

static bool needs_pressure(const struct model *m)
{
    return m->has_pressure || m->has_phases;
}

/* Makes the lists keep the forces of pairs where the next evaluation is that of a snapshot. False without
 * memory. */
static bool prepare_forces(struct subdomain *sd, bool measure)
{
    if (measure && schedule_snapshot(sd->model->config, sd->step))
        return pair_forces_hold(&sd->lists, sd->p.n_own) == 0;
    pair_forces_drop(&sd->lists);
    return true;
}

void subdomain_forces_ahead(struct subdomain *sd, bool measure)
{
    double started = clock_now();
    const struct model *m = sd->model;
    if (!prepare_forces(sd, measure))
        return; /* subdomain_forces tries again, and fails */
    force_ahead(&sd->pass, m, &sd->p, &sd->lists, leapfrog_kick_time(m, sd->step),
                leapfrog_path_time(m, sd->step), measure || needs_pressure(m) ? &sd->totals : NULL);
    sd->times.forces += clock_now() - started;
}

enum dm2_status subdomain_forces(struct subdomain *sd, bool measure, struct dm2_error *err)
{
    double started = clock_now();
    const struct model *m = sd->model;
    bool pressure = needs_pressure(m), totals = measure || pressure;
    if (!sd->pass.ahead && !prepare_forces(sd, measure))
        return subdomain_no_memory(sd, err);
    subdomain_beat(sd);
    if (m->has_drives)
        drive_set(m, sd->step, sd->drives);
    enum dm2_status status = sd->loading != NULL ? loading_kick(sd->loading, err) : DM2_OK;
    if (sd->loading != NULL)
        loading_drive(sd->loading, sd->drives);
    walls_place(&sd->walls, m, sd->loading, sd->step);
    if (status == DM2_OK && m->has_kinds)
        status = walls_account(&sd->walls, m, &sd->p, sd->step, leapfrog_path_time(m, sd->step), err);
    if (status == DM2_OK && m->has_kinds)
        status = phase_account(m, &sd->p, &sd->lists, sd->step, err);
    if (status == DM2_OK && sd->pass.ahead)
        status = force_rest(&sd->pass, &sd->lists, sd->step, err);
    else if (status == DM2_OK)
        status = force_evaluate(sd->model, &sd->p, &sd->lists, leapfrog_kick_time(sd->model, sd->step),
                                leapfrog_path_time(sd->model, sd->step), totals ? &sd->totals : NULL,
                                sd->step, err);
    if (status == DM2_OK && m->n_walls > 0)
        status = walls_evaluate(&sd->walls, m, &sd->p, sd->step, leapfrog_kick_time(m, sd->step),
                                leapfrog_path_time(m, sd->step), totals ? &sd->totals : NULL,
                                sd->lists.forces != NULL, err);
    subdomain_beat(sd);
    sd->stiffness = (struct stiffness){0};
    if (status == DM2_OK && measure && schedule_limit(m->config, sd->step))
        status = stiffness_measure(m, &sd->p, &sd->lists, &sd->walls, &sd->stiff, &sd->stiffness, err);
    if (status == DM2_OK && m->reaction.any)
        status = reaction_evaluate(m, &sd->p, &sd->lists, leapfrog_kick_time(m, sd->step), sd->step,
                                   &sd->reacted, err);
    if (status == DM2_OK && pressure)
        leapfrog_set_pressure(m, &sd->p);
    if (status == DM2_OK && sd->loading != NULL)
        load_sums_add(&sd->load_sums, m, &sd->p, &sd->lists, &sd->walls);
    if (status == DM2_OK && sd->model->has_strain)
        status = strain_add(sd->model, &sd->p, &sd->lists, leapfrog_path_time(sd->model, sd->step), sd->step,
                            &sd->strain, err);
    sd->times.forces += clock_now() - started;
    return status;
}

const struct load_totals *subdomain_load_totals(const struct subdomain *sd)
{
    return sd->load_sums.own;
}

void subdomain_take_totals(struct subdomain *sd, const struct load_totals *totals)
{
    if (sd->loading != NULL)
        loading_take(sd->loading, totals);
}

struct loading *subdomain_loading(const struct subdomain *sd)
{
    return sd->loading;
}

static enum dm2_status integrate_motion(struct subdomain *sd, bool drift, double *dmax, struct measures *out,
                                        struct dm2_error *err)
{
    double started = clock_now();
    if (out != NULL) {
        measures_clear(out);
        out->potential = sd->totals.potential;
        out->elastic = sd->totals.elastic;
        out->links = sd->totals.links;
        out->contacts = sd->totals.contacts;
        out->pairs = sd->totals.pairs;
        out->wall_contacts = sd->totals.wall_contacts;
        out->loaded_pairs = sd->totals.loaded_pairs;
        out->magnitudes = sd->totals.magnitudes;
        memcpy(out->fabric, sd->totals.fabric, sizeof out->fabric);
        out->dt_share = sd->stiffness.dt_share;
        out->compression = sd->stiffness.compression;
        probes_start(sd->model, out);
    }
    subdomain_beat(sd);
    /* Of the work of a kick, what is before its whole step counts there. */
    double share = 1.0 - 0.5 * sd->model->config->dt / leapfrog_kick_time(sd->model, sd->step);
    walls_add_work(&sd->walls, &sd->p, share);
    enum dm2_status status = leapfrog_move(sd->model, &sd->p, sd->step, drift, dmax, out, err);
    if (status == DM2_OK && out != NULL && sd->model->n_walls > 0)
        status = wall_probes_add(sd, out, err);
    if (status == DM2_OK && drift && sd->model->n_walls > 0) {
        status = walls_move(sd->model, sd->loading, sd->step, dmax, err);
        walls_add_work(&sd->walls, &sd->p, 1.0 - share);
    }
    sd->times.integrate += clock_now() - started;
    return status;
}

enum dm2_status subdomain_move(struct subdomain *sd, double *dmax, struct measures *out,
                               struct dm2_error *err)
{
    enum dm2_status status = integrate_motion(sd, true, dmax, out, err);
    if (status == DM2_OK && sd->model->reaction.any)
        status = reaction_apply(sd->model, &sd->p, &sd->reacted, sd->step, err);
    if (status == DM2_OK && sd->model->has_phases)
        phase_apply(sd->model, &sd->p);
    sd->step++;
    if (status == DM2_OK && sd->model->has_held)
        drive_hold_heat(sd->model, &sd->p, sd->step);
    return status;
}

enum dm2_status subdomain_measure_last(struct subdomain *sd, struct measures *out, struct dm2_error *err)
{
    return integrate_motion(sd, false, NULL, out, err);
}

struct crack_list *subdomain_cracks(struct subdomain *sd)
{
    return &sd->lists.cracks;
}

enum dm2_status subdomain_profile(const struct subdomain *sd, size_t which, struct profile_bin *bins,
                                  struct dm2_error *err)
{
    return profile_add(sd->model, &sd->p, &sd->model->config->profiles[which], sd->step, bins, err);
}

/* --- states --- */

enum dm2_status subdomain_collect(const struct subdomain *sd, struct element *elements,
                                  struct element_measure *measured, struct dm2_error *err)
{
    struct state_reader reader;
    enum dm2_status status = state_reader_open(&reader, &sd->p, &sd->lists, READER_NONE, err);
    for (size_t k = 0; k < reader.n_elements; k++) {
        state_reader_element(&reader, k, &elements[k]);
        if (measured == NULL)
            continue;
        double w;
        size_t i = reader.slot[k];
        struct element_measure *out = &measured[k];
        leapfrog_stress(sd->model, &sd->p, i, out->stress);
        leapfrog_whole_velocity(sd->model, &sd->p, i, sd->step, out->velocity, &w);
        out->temperature = particles_temperature(&sd->p, sd->model, i);
        out->links = particles_links(&sd->p, i);
        out->contacts = particles_contacts(&sd->p, i);
    }
    state_reader_free(&reader);
    return status;
}

static enum dm2_status collect_pairs(const struct subdomain *sd, enum reader_pairs which,
                                     struct pair_record **pairs, struct pair_measure **forces,
                                     size_t *n_pairs, struct dm2_error *err)
{
    struct state_reader reader;
    enum dm2_status status = state_reader_open(&reader, &sd->p, &sd->lists, which, err);
    size_t n = *n_pairs = reader.n_pairs;
    *pairs = status == DM2_OK ? mem_alloc(n, sizeof **pairs) : NULL;
    if (forces != NULL)
        *forces = status == DM2_OK ? mem_alloc(n, sizeof **forces) : NULL;
    if (status == DM2_OK && (*pairs == NULL || (forces != NULL && *forces == NULL)))
        status = subdomain_no_memory(sd, err);
    for (size_t k = 0; status == DM2_OK && k < n; k++) {
        state_reader_pair(&reader, k, &(*pairs)[k]);
        if (forces != NULL)
            state_reader_force(&reader, sd->model->fixed.over_force, k, &(*forces)[k]);
    }
    state_reader_free(&reader);
    return status;
}

enum dm2_status subdomain_collect_pairs(const struct subdomain *sd, struct pair_record **pairs,
                                        size_t *n_pairs, struct dm2_error *err)
{
    return collect_pairs(sd, READER_MEMORY, pairs, NULL, n_pairs, err);
}

enum dm2_status subdomain_collect_acting(const struct subdomain *sd, struct pair_record **pairs,
                                         struct pair_measure **forces, size_t *n_pairs, struct dm2_error *err)
{
    assert(sd->lists.forces != NULL);
    return collect_pairs(sd, READER_ACTING, pairs, forces, n_pairs, err);
}

enum dm2_status subdomain_collect_sections(const struct subdomain *sd,
                                           struct section_array out[SECTION_COUNT], struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    if ((section_has(sd->model->config) & 1u << SECTION_HOME) != 0)
        status = homes_collect(sd->model, &sd->p, &out[SECTION_HOME], err);
    return status == DM2_OK ? wall_memory_collect(sd, &out[SECTION_WCON], err) : status;
}

static void read_element(const void *context, size_t k, struct element *out)
{
    state_reader_element(context, k, out);
}

static void read_pair(const void *context, size_t k, struct pair_record *out)
{
    state_reader_pair(context, k, out);
}

enum dm2_status subdomain_write(const struct subdomain *sd, subdomain_writer write, void *context,
                                struct dm2_error *err)
{
    struct state_reader reader;
    enum dm2_status status = state_reader_open(&reader, &sd->p, &sd->lists, READER_MEMORY, err);
    struct state_view view = {.step = sd->step,
                              .n_elements = reader.n_elements,
                              .n_pairs = reader.n_pairs,
                              .records = &reader,
                              .element = read_element,
                              .pair = read_pair};
    if (status == DM2_OK)
        status = subdomain_collect_sections(sd, view.sections, err);
    if (status == DM2_OK && sd->loading != NULL &&
        !loading_collect(sd->loading, &view.sections[SECTION_BODY]))
        status = subdomain_no_memory(sd, err);
    if (status == DM2_OK)
        status = write(context, &view, err);
    section_free(view.sections);
    state_reader_free(&reader);
    return status;
}

void subdomain_take_times(struct subdomain *sd, struct subdomain_times *out)
{
    *out = sd->times;
    sd->times = (struct subdomain_times){0};
}
