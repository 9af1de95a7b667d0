/* Works out the tables in the order in which they need each other: kinds, the reaction, pair laws, the grid,
 * the number of elements, list margins, scales, the stable time step. */
#include "dm2/engine/model.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/base/real.h"
#include "dm2/deck/shape.h"
#include "drive.h"
#include "generate.h"
#include "kinds.h"
#include "laws.h"
#include "moments.h"
#include "probes.h"
#include "scales.h"
#include "stability.h"
#include "tables.h"
#include "wall_shape.h"

static const double second_shell = 0.6; /* in contact distances: sqrt(3) - 1, less a tenth or more */
static const double pi = 0x1.921fb54442d18p1;

/* The model of which the elements are counted, the room of its grain_first, and the moments of the body under
 * way. */
struct counting {
    struct model *m;
    size_t body, cap; /* body: under way, plus 1 */
    struct moments moments;
    double *centroids; /* [n_bodies][2] */
};

/* Notes the ids with which bodies and grains begin and end: those of this element too. */
static enum dm2_status count_element(void *context, const struct element *e, struct dm2_error *err)
{
    struct counting *k = context;
    struct model *m = k->m;
    bool first = k->body != (size_t)e->body + 1;
    m->n_elements++;
    m->n_ids = (size_t)e->id + 1;
    if (first)
        m->bodies[e->body].first = e->id;
    k->body = (size_t)e->body + 1;
    m->bodies[e->body].end = e->id + 1;
    if (motion_needs_centroid(m, e->body)) {
        if (first)
            moments_start(&k->moments, m->config, e->mass);
        moments_add(&k->moments, e->mass, e->home);
        moments_centroid(&k->moments, &k->centroids[2 * e->body]);
    }
    size_t grain = e->grain - m->config->start.next_grain;
    if (m->n_grains > grain)
        return DM2_OK;
    uint32_t *grown = mem_grown(m->grain_first, &k->cap, m->n_grains, grain + 2, sizeof *grown);
    if (grown == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the numbers of %u grains", e->grain);
    m->grain_first = grown;
    while (m->n_grains <= grain)
        m->grain_first[m->n_grains++] = e->id;
    return DM2_OK;
}

/* Takes the bodies that come from a state. */
static void count_taken(struct model *m, double *centroids)
{
    m->n_ids = m->config->start.next_id;
    for (size_t b = 0; b < m->config->n_bodies; b++) {
        const struct body_config *body = &m->config->bodies[b];
        if (!body->from_state)
            continue;
        m->bodies[b] = (struct id_range){body->start.id_first, body->start.id_end};
        m->n_elements += body->start.id_end - body->start.id_first;
        centroids[2 * b] = body->start.centroid[0];
        centroids[2 * b + 1] = body->start.centroid[1];
    }
}

/* Counts the elements, and fills the ranges of bodies and grains. */
static enum dm2_status count_elements(struct model *m, struct dm2_error *err)
{
    struct counting k = {.m = m};
    m->bodies = mem_zalloc(m->config->n_bodies, sizeof *m->bodies);
    k.centroids = mem_zalloc(m->config->n_bodies, 2 * sizeof *k.centroids);
    if (m->bodies == NULL || k.centroids == NULL) {
        free(k.centroids);
        return dm2_fail(err, DM2_MEMORY, "no memory for the tables of %zu bodies", m->config->n_bodies);
    }
    count_taken(m, k.centroids);
    enum dm2_status status = generate_elements(m, count_element, &k, err);
    m->centroids = k.centroids;
    if (status == DM2_OK && m->n_grains > 0)
        m->grain_first[m->n_grains] = (uint32_t)m->n_ids;
    return status;
}

static enum dm2_status check_reach(const struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    for (size_t i = 0; i < m->n_kinds * m->n_kinds * RELATION_COUNT; i++) {
        const struct pair_law *law = &m->laws[i];
        double reach = 2.0 * m->radius_max * (law->near && law->link_break > 1.0 ? law->link_break : 1.0);
        if (law->near && c->r_c < reach)
            return dm2_fail(
                err, DM2_DECK,
                "r_c = %g cm is below %g cm, the distance up to which elements touch or stay linked "
                "(link_break (R_i + R_j)): make r_c at least that",
                c->r_c, reach);
        if (law->cutoff2 > c->r_c * c->r_c)
            return dm2_fail(err, DM2_DECK,
                            "a cutoff of %g cm is beyond r_c = %g cm: make r_c at least the cutoff",
                            sqrt(law->cutoff2), c->r_c);
    }
    return DM2_OK;
}

/* Where all interactions are links and contacts, the near lists reach beyond contact by second_shell, which
 * excludes the second neighbours of a hexagonal lattice until the lattice is compressed by 8 %: the
 * additional pairs cost little, and rebuilds become rarer. No list can reach beyond R_c + dR, because cells
 * are only that much larger. */
static struct margins choose_margins(const struct model *m)
{
    double contact = law_touch_length(2.0 * m->radius_max), dr = m->config->delta_r,
           reach = m->config->r_c + dr;
    struct margins of = {.wide = reach - (m->has_far && m->far_cutoff > contact ? m->far_cutoff : contact)};
    of.close = dr < of.wide ? dr : of.wide;
    double more = second_shell * contact < of.wide ? second_shell * contact : of.wide;
    if (!m->has_far && more > of.close)
        of.close = more;
    return of;
}

/* An estimate of the lattice sites and grains that the generator goes through for a body: for a crystal the
 * sites in a box along its rows, for a grain the sites in a box of about four times the area of the grain. */
static double count_places(const struct body_config *b)
{
    double box[4];
    shape_box(&b->shape, box);
    double width = box[2] - box[0], height = box[3] - box[1], site = b->spacing * b->row_spacing;
    if (b->structure != STRUCTURE_CRYSTAL)
        return width * height * (4.0 / site + 4.0 / (pi * (b->grain_size * b->grain_size)));
    double cosine = fabs(real_cos(b->angle)), sine = fabs(real_sin(b->angle));
    return (width * cosine + height * sine) * (width * sine + height * cosine) / site;
}

struct model_estimate model_estimate(const struct config *config)
{
    double reach = config->r_c + config->delta_r;
    struct model_estimate e = {.cells = (config->size[0] / reach + 1.0) * (config->size[1] / reach + 1.0)};
    for (size_t i = 0; i < config->n_bodies; i++) {
        const struct body_config *b = &config->bodies[i];
        e.elements += shape_area(&b->shape) / (b->spacing * b->row_spacing);
        e.places += count_places(b);
    }
    return e;
}

/* Fills all tables of *m, whose kinds and laws are allocated. */
static enum dm2_status build_tables(struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    for (size_t b = 0; b < c->n_bodies; b++)
        m->radius_max = c->bodies[b].radius > m->radius_max ? c->bodies[b].radius : m->radius_max;
    kinds_build(m);
    kinds_build_reaction(m);
    enum dm2_status status = laws_build(m, err);
    if (status != DM2_OK)
        return status;
    if (m->has_kinds && m->has_far)
        return dm2_fail(err, DM2_DECK,
                        "phases and reactions need interactions of scope linked: their energies are those of "
                        "linked and contacting pairs");
    status = check_reach(m, err);
    if (status != DM2_OK)
        return status;
    for (size_t i = 0; i < m->n_kinds; i++)
        m->has_heat |= isfinite(m->kinds[i].tm) && isfinite(m->kinds[i].cp) && m->has_near;
    status = motion_build(m, err);
    if (status != DM2_OK)
        return status;
    m->has_drives = drive_is_needed(m);
    for (size_t i = 0; i < c->n_loads; i++)
        m->has_held |= c->loads[i].quantity == LOAD_TEMPERATURE;
    m->has_strain = c->output.strain;
    m->has_damping = c->damping > 0.0;
    if (m->has_strain && !m->has_near)
        return dm2_fail(err, DM2_DECK,
                        "strain = yes measures the motion of linked or touching neighbours, and no "
                        "interaction of this deck links or meets (scope = all): leave it out");
    status = grid_build(c->origin, c->size, c->periodic, c->r_c + c->delta_r, &m->grid, err);
    if (status == DM2_OK)
        status = walls_make(m, err);
    if (status == DM2_OK)
        status = count_elements(m, err);
    if (status != DM2_OK)
        return status;
    status = forced_build(m, err);
    if (status != DM2_OK)
        return status;
    m->margins = choose_margins(m);
    scales_choose(m);
    scales_find_far_ranges(m);
    stability_find_time_step(m);
    return stability_check(m, err);
}

enum dm2_status model_build(const struct config *config, struct model **out, struct dm2_error *err)
{
    return model_build_watched(config, (struct pulse){0}, out, err);
}

enum dm2_status model_build_watched(const struct config *config, struct pulse pulse, struct model **out,
                                    struct dm2_error *err)
{
    struct model *m = mem_zalloc(1, sizeof *m);
    *out = NULL;
    if (m == NULL)
        goto no_memory;
    m->config = config;
    m->pulse = pulse;
    m->n_kinds = config_kinds(config);
    m->kinds = mem_zalloc(m->n_kinds, sizeof *m->kinds);
    m->laws = mem_zalloc(m->n_kinds * m->n_kinds * RELATION_COUNT, sizeof *m->laws);
    if (m->kinds == NULL || m->laws == NULL || probes_build(&m->probes, config) != 0)
        goto no_memory;
    enum dm2_status status = build_tables(m, err);
    if (status != DM2_OK) {
        model_free(m);
        return status;
    }
    *out = m;
    return DM2_OK;
no_memory:
    model_free(m);
    return dm2_fail(err, DM2_MEMORY, "no memory for the tables of %zu materials", config->n_materials);
}

void model_free(struct model *m)
{
    if (m == NULL)
        return;
    walls_unmake(m);
    free(m->kinds);
    free(m->laws);
    free(m->bodies);
    free(m->grain_first);
    free(m->forced);
    free(m->forced_of);
    motion_free(m);
    probes_free(&m->probes);
    free(m);
}

const struct config *model_config(const struct model *m)
{
    return m->config;
}

const struct grid *model_grid(const struct model *m)
{
    return &m->grid;
}

struct margins model_margins(const struct model *m)
{
    return m->margins;
}

struct measure_scales model_scales(const struct model *m)
{
    return m->scales;
}

size_t model_elements(const struct model *m)
{
    return m->n_elements;
}

size_t model_ids(const struct model *m)
{
    return m->n_ids;
}

double model_stable_dt(const struct model *m, const char **which)
{
    *which = m->dt_mode;
    return m->dt_stable;
}

struct cell_counter {
    const struct grid *grid;
    uint32_t *counts;
};

static enum dm2_status count_in_cell(void *context, const struct element *e, struct dm2_error *err)
{
    struct cell_counter *counter = context;
    (void)err;
    counter->counts[grid_cell(counter->grid, e->r[0], e->r[1])]++;
    return DM2_OK;
}

enum dm2_status model_cell_counts(const struct model *m, uint32_t *counts, struct dm2_error *err)
{
    struct cell_counter counter = {&m->grid, counts};
    for (size_t cell = 0; cell < (size_t)m->grid.cx * (size_t)m->grid.cy; cell++)
        counts[cell] = 0;
    return generate_elements(m, count_in_cell, &counter, err);
}

void model_count_elements(const struct model *m, const struct element *elements, size_t n, uint32_t *counts)
{
    for (size_t k = 0; k < n; k++)
        counts[grid_cell(&m->grid, elements[k].r[0], elements[k].r[1])]++;
}
