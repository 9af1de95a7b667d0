/* Records of messages as bytes.
 *
 * For each record but the element, put and get list the same fields in the same order, side by side; the
 * tests check the sizes in the header. A failed reader stays failed, so the checks here only ever set
 * r->failed, and the first failure r->why. */
#include "dm2/cluster/wire.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/deck/config.h"

static void fail_unless(struct bytes_reader *r, bool holds)
{
    if (!holds)
        r->failed = true;
}

/* Fails because of a value; the sentence is `what`, the id, and `text`. */
static void refuse(struct bytes_reader *r, const char *what, uint32_t id, const char *text)
{
    if (!r->failed && r->why != NULL)
        (void)snprintf(r->why, BYTES_WHY, "%s %" PRIu32 " %s", what, id, text);
    r->failed = true;
}

static void check_element(struct bytes_reader *r, const struct record_limits *limits, const struct element *e)
{
    char text[RECORD_FAULT_TEXT];
    const struct element_field *fault = r->failed ? NULL : record_fault(e, limits);
    if (fault == NULL)
        return;
    record_describe_fault(fault, e, limits, text);
    refuse(r, "element", e->id, text);
}

static double get_finite(struct bytes_reader *r)
{
    double x = bytes_get_f64(r);
    fail_unless(r, isfinite(x) != 0);
    return x;
}

void wire_put_mirror(struct bytes_writer *w, const struct element *e)
{
    record_put(w, RECORD_MIRROR, e);
}

void wire_put_element(struct bytes_writer *w, const struct element *e)
{
    record_put(w, RECORD_OWNED, e);
}

void wire_get_mirror(struct bytes_reader *r, const struct record_limits *limits, struct element *out)
{
    record_get(r, RECORD_MIRROR, out);
    check_element(r, limits, out);
}

void wire_get_element(struct bytes_reader *r, const struct record_limits *limits, struct element *out)
{
    record_get(r, RECORD_OWNED, out);
    check_element(r, limits, out);
}

void wire_put_pair(struct bytes_writer *w, const struct pair_record *p)
{
    bytes_put_u32(w, p->id_a);
    bytes_put_u32(w, p->id_b);
    bytes_put_u8(w, (uint8_t)p->linked);
    bytes_put_f64(w, p->stretch);
    bytes_put_f64(w, p->spring);
}

void wire_get_pair(struct bytes_reader *r, const struct record_limits *limits, struct pair_record *out)
{
    out->id_a = bytes_get_u32(r);
    out->id_b = bytes_get_u32(r);
    out->linked = bytes_get_u8(r);
    out->stretch = bytes_get_f64(r);
    out->spring = bytes_get_f64(r);
    char what[40], text[RECORD_FAULT_TEXT];
    (void)snprintf(what, sizeof what, "the pair of element %" PRIu32 " and", out->id_a);
    if (!record_pair_valid(out, limits, text))
        refuse(r, what, out->id_b, text);
}

void wire_put_crack(struct bytes_writer *w, const struct crack *c)
{
    bytes_put_u32(w, c->id_a);
    bytes_put_u32(w, c->id_b);
    bytes_put_f64s(w, c->r, 2);
    bytes_put_f64(w, c->energy);
    bytes_put_u8(w, c->mode);
    bytes_put_u8(w, c->grains);
}

void wire_get_crack(struct bytes_reader *r, uint64_t elements, struct crack *out)
{
    out->id_a = bytes_get_u32(r);
    out->id_b = bytes_get_u32(r);
    out->r[0] = get_finite(r);
    out->r[1] = get_finite(r);
    out->energy = get_finite(r);
    out->mode = bytes_get_u8(r);
    out->grains = bytes_get_u8(r);
    fail_unless(r, out->id_a < out->id_b && out->id_b < elements);
    fail_unless(r, out->mode < CRACK_MODES && (out->grains == 1 || out->grains == 2));
}

void wire_put_measured(struct bytes_writer *w, const struct element_measure *m)
{
    bytes_put_f64s(w, m->stress, 3);
    bytes_put_f64s(w, m->velocity, 2);
    bytes_put_f64(w, m->temperature);
    bytes_put_u32(w, m->links);
    bytes_put_u32(w, m->contacts);
}

void wire_get_measured(struct bytes_reader *r, struct element_measure *out)
{
    for (int k = 0; k < 3; k++)
        out->stress[k] = get_finite(r);
    for (int k = 0; k < 2; k++)
        out->velocity[k] = get_finite(r);
    out->temperature = get_finite(r);
    out->links = bytes_get_u32(r);
    out->contacts = bytes_get_u32(r);
}

void wire_put_force(struct bytes_writer *w, const struct pair_measure *f)
{
    bytes_put_f64s(w, f->force, 2);
    bytes_put_f64(w, f->normal);
    bytes_put_f64(w, f->tangential);
}

void wire_get_force(struct bytes_reader *r, struct pair_measure *out)
{
    for (int k = 0; k < 2; k++)
        out->force[k] = get_finite(r);
    out->normal = get_finite(r);
    out->tangential = get_finite(r);
}

static void put_sum(struct bytes_writer *w, const struct exact_sum *s)
{
    bytes_put_i64(w, s->hi);
    bytes_put_u64(w, s->lo);
}

static void get_sum(struct bytes_reader *r, struct exact_sum *s)
{
    s->hi = bytes_get_i64(r);
    s->lo = bytes_get_u64(r);
}

void wire_put_load(struct bytes_writer *w, const struct load_totals *t)
{
    for (int k = 0; k < 4; k++)
        put_sum(w, k < 2 ? &t->force[k] : &t->speed[k - 2]);
    bytes_put_u32(w, t->contacts);
}

void wire_get_load(struct bytes_reader *r, struct load_totals *t)
{
    for (int k = 0; k < 4; k++)
        get_sum(r, k < 2 ? &t->force[k] : &t->speed[k - 2]);
    t->contacts = bytes_get_u32(r);
}

void wire_put_overlap(struct bytes_writer *w, const struct overlap *o)
{
    bytes_put_u64(w, o->pairs);
    bytes_put_f64(w, o->ratio);
    for (int k = 0; k < 2; k++) {
        bytes_put_u32(w, o->id[k]);
        bytes_put_u16(w, o->body[k]);
        bytes_put_f64(w, o->r[k][0]);
        bytes_put_f64(w, o->r[k][1]);
    }
}

void wire_get_overlap(struct bytes_reader *r, struct overlap *out)
{
    out->pairs = bytes_get_u64(r);
    out->ratio = bytes_get_f64(r);
    fail_unless(r, out->ratio >= 0.0 && out->ratio < 1.0);
    for (int k = 0; k < 2; k++) {
        out->id[k] = bytes_get_u32(r);
        out->body[k] = bytes_get_u16(r);
        for (int a = 0; a < 2; a++) {
            out->r[k][a] = bytes_get_f64(r);
            fail_unless(r, isfinite(out->r[k][a]));
        }
    }
}

/* A probe: the sums that the probe needs, in the order of enum probe_sum. */
static void put_probe(struct bytes_writer *w, const struct probe_sums *p)
{
    bytes_put_u32(w, p->needs);
    bytes_put_u64(w, p->count);
    for (int k = 0; k < PROBE_SUMS; k++)
        if (p->needs >> k & 1)
            put_sum(w, &p->sum[k]);
}

static void get_probe(struct bytes_reader *r, struct probe_sums *out)
{
    *out = (struct probe_sums){.needs = bytes_get_u32(r)};
    fail_unless(r, out->needs >> PROBE_SUMS == 0);
    out->count = bytes_get_u64(r);
    for (int k = 0; k < PROBE_SUMS && !r->failed; k++)
        if (out->needs >> k & 1)
            get_sum(r, &out->sum[k]);
}

void wire_put_measures(struct bytes_writer *w, const struct measures *m)
{
    put_sum(w, &m->kinetic);
    put_sum(w, &m->potential);
    put_sum(w, &m->elastic);
    put_sum(w, &m->thermal);
    put_sum(w, &m->chemical);
    put_sum(w, &m->phase);
    put_sum(w, &m->work);
    put_sum(w, &m->damped);
    put_sum(w, &m->momentum[0]);
    put_sum(w, &m->momentum[1]);
    put_sum(w, &m->angular);
    bytes_put_u64(w, m->elements);
    bytes_put_u64(w, m->links);
    bytes_put_u64(w, m->contacts);
    bytes_put_u64(w, m->pairs);
    bytes_put_u64(w, m->wall_contacts);
    put_sum(w, &m->fabric[0]);
    put_sum(w, &m->fabric[1]);
    bytes_put_u64(w, m->free_elements);
    bytes_put_u64(w, m->loaded_pairs);
    put_sum(w, &m->resultants);
    put_sum(w, &m->magnitudes);
    bytes_put_f64(w, m->t_max);
    bytes_put_f64(w, m->p_min);
    bytes_put_f64(w, m->p_max);
    bytes_put_f64(w, m->dt_share);
    bytes_put_f64(w, m->compression);
    bytes_put_u16(w, (uint16_t)m->n_probes);
    for (size_t k = 0; k < m->n_probes; k++)
        put_probe(w, &m->probe[k]);
}

void wire_get_measures(struct bytes_reader *r, struct measures *out)
{
    get_sum(r, &out->kinetic);
    get_sum(r, &out->potential);
    get_sum(r, &out->elastic);
    get_sum(r, &out->thermal);
    get_sum(r, &out->chemical);
    get_sum(r, &out->phase);
    get_sum(r, &out->work);
    get_sum(r, &out->damped);
    get_sum(r, &out->momentum[0]);
    get_sum(r, &out->momentum[1]);
    get_sum(r, &out->angular);
    out->elements = bytes_get_u64(r);
    out->links = bytes_get_u64(r);
    out->contacts = bytes_get_u64(r);
    out->pairs = bytes_get_u64(r);
    out->wall_contacts = bytes_get_u64(r);
    get_sum(r, &out->fabric[0]);
    get_sum(r, &out->fabric[1]);
    out->free_elements = bytes_get_u64(r);
    out->loaded_pairs = bytes_get_u64(r);
    get_sum(r, &out->resultants);
    get_sum(r, &out->magnitudes);
    out->t_max = bytes_get_f64(r);
    out->p_min = bytes_get_f64(r);
    out->p_max = bytes_get_f64(r);
    out->dt_share = bytes_get_f64(r);
    out->compression = bytes_get_f64(r);
    fail_unless(r, !isnan(out->t_max) && !isnan(out->p_min) && !isnan(out->p_max));
    fail_unless(r, out->dt_share >= 0.0 && out->compression >= 0.0);
    size_t probes = bytes_get_u16(r);
    fail_unless(r, probes <= PROBE_MAX);
    out->n_probes = r->failed ? 0 : probes;
    for (size_t k = 0; k < out->n_probes; k++)
        get_probe(r, &out->probe[k]);
}

void wire_put_bin(struct bytes_writer *w, const struct profile_bin *b)
{
    bytes_put_u64(w, b->elements);
    put_sum(w, &b->mass);
    put_sum(w, &b->momentum[0]);
    put_sum(w, &b->momentum[1]);
    put_sum(w, &b->volume);
    for (int a = 0; a < 3; a++)
        put_sum(w, &b->stress[a]);
    put_sum(w, &b->temperature);
    put_sum(w, &b->area);
}

void wire_get_bin(struct bytes_reader *r, struct profile_bin *out)
{
    out->elements = bytes_get_u64(r);
    get_sum(r, &out->mass);
    get_sum(r, &out->momentum[0]);
    get_sum(r, &out->momentum[1]);
    get_sum(r, &out->volume);
    for (int a = 0; a < 3; a++)
        get_sum(r, &out->stress[a]);
    get_sum(r, &out->temperature);
    get_sum(r, &out->area);
}

static void put_elements(struct bytes_writer *w, const struct element *e, size_t n, bool mirrors)
{
    bytes_put_u32(w, (uint32_t)n);
    for (size_t k = 0; k < n && mirrors; k++)
        wire_put_mirror(w, &e[k]);
    for (size_t k = 0; k < n && !mirrors; k++)
        wire_put_element(w, &e[k]);
}

static struct element *get_elements(struct bytes_reader *r, const struct record_limits *limits, size_t *n,
                                    bool mirrors)
{
    *n = bytes_get_count(r, mirrors ? WIRE_MIRROR : WIRE_ELEMENT);
    struct element *e = r->failed ? NULL : mem_zalloc(*n, sizeof *e);
    fail_unless(r, e != NULL);
    for (size_t k = 0; k < *n && !r->failed; k++)
        (mirrors ? wire_get_mirror : wire_get_element)(r, limits, &e[k]);
    return e;
}

/* The homes of migrants, in their order; of a migrant without a record the home is 0 0. */
static void put_homes(struct bytes_writer *w, const struct parcel *p)
{
    size_t at = w->length;
    uint32_t n = 0;
    bytes_put_u32(w, 0);
    for (size_t k = 0; k < p->n_migrants; k++) {
        const double *home = p->migrants[k].home;
        const struct home_record record = {p->migrants[k].id, {home[0], home[1]}};
        if (home[0] == 0.0 && home[1] == 0.0)
            continue;
        section_kinds[SECTION_HOME].put(w, &record);
        n++;
    }
    if (!w->failed)
        bytes_patch_u32(w, at, n);
}

static void get_homes(struct bytes_reader *r, const struct record_limits *limits, struct parcel *p)
{
    const struct section_kind *kind = &section_kinds[SECTION_HOME];
    size_t n = bytes_get_count(r, kind->bytes), at = 0;
    for (size_t k = 0; k < n && !r->failed; k++, at++) {
        struct home_record home;
        kind->get(r, &home);
        while (at < p->n_migrants && p->migrants[at].id != home.id)
            at++;
        char text[RECORD_FAULT_TEXT] = "is of no migrant";
        if (at >= p->n_migrants || !kind->valid(&home, limits, text))
            refuse(r, "the home of element", home.id, text);
        if (!r->failed)
            memcpy(p->migrants[at].home, home.home, sizeof home.home);
    }
}

static void get_walls(struct bytes_reader *r, const struct record_limits *limits, struct parcel *out)
{
    const struct section_kind *kind = &section_kinds[SECTION_WCON];
    out->n_walls = bytes_get_count(r, kind->bytes);
    out->walls = r->failed ? NULL : mem_zalloc(out->n_walls, sizeof *out->walls);
    fail_unless(r, out->walls != NULL);
    for (size_t k = 0; k < out->n_walls && !r->failed; k++) {
        kind->get(r, &out->walls[k]);
        fail_unless(r, kind->valid(&out->walls[k], limits, NULL));
    }
}

void wire_put_parcel(struct bytes_writer *w, const struct parcel *p)
{
    if (p->n_migrants > UINT32_MAX || p->n_pairs > UINT32_MAX || p->n_mirrors > UINT32_MAX ||
        p->n_walls > UINT32_MAX) {
        w->failed = true;
        return;
    }
    put_elements(w, p->migrants, p->n_migrants, false);
    bytes_put_u32(w, (uint32_t)p->n_pairs);
    for (size_t k = 0; k < p->n_pairs; k++)
        wire_put_pair(w, &p->pairs[k]);
    put_elements(w, p->mirrors, p->n_mirrors, true);
    put_homes(w, p);
    bytes_put_u32(w, (uint32_t)p->n_walls);
    for (size_t k = 0; k < p->n_walls; k++)
        section_kinds[SECTION_WCON].put(w, &p->walls[k]);
}

void wire_get_parcel(struct bytes_reader *r, const struct record_limits *limits, struct parcel *out)
{
    *out = (struct parcel){0};
    out->migrants = get_elements(r, limits, &out->n_migrants, false);
    out->n_pairs = bytes_get_count(r, WIRE_PAIR);
    out->pairs = r->failed ? NULL : mem_zalloc(out->n_pairs, sizeof *out->pairs);
    fail_unless(r, out->pairs != NULL);
    for (size_t k = 0; k < out->n_pairs && !r->failed; k++)
        wire_get_pair(r, limits, &out->pairs[k]);
    out->mirrors = get_elements(r, limits, &out->n_mirrors, true);
    get_homes(r, limits, out);
    get_walls(r, limits, out);
    if (r->failed)
        wire_parcel_free(out);
}

void wire_parcel_free(struct parcel *p)
{
    free(p->migrants);
    free(p->pairs);
    free(p->mirrors);
    free(p->walls);
    *p = (struct parcel){0};
}
