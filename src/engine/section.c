/* The further sections of a state: one table, and loops over it.
 *
 * Each row's put, get and valid stand side by side, field by field in one order. A reader checks a record as
 * soon as it is decoded; order and elements are checked once all sections are there. */
#include "dm2/engine/section.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "forced.h"
#include "tables.h"

static bool are_finite(const double *x, size_t n)
{
    bool finite = true;
    for (size_t k = 0; k < n; k++)
        finite &= isfinite(x[k]) != 0;
    return finite;
}

static int compare_u32(uint32_t a, uint32_t b)
{
    return a < b ? -1 : a > b;
}

static bool element_valid(uint32_t id, const struct record_limits *limits, char *text)
{
    if (limits != NULL && id >= limits->elements)
        return record_refuse(text, "names element %" PRIu32 ", which is none of the %zu that the deck makes",
                             id, limits->elements);
    return true;
}

/* --- HOME --- */

static void put_home(struct bytes_writer *w, const void *record)
{
    const struct home_record *h = record;
    bytes_put_u32(w, h->id);
    bytes_put_f64s(w, h->home, 2);
}

static void get_home(struct bytes_reader *r, void *record)
{
    struct home_record *h = record;
    h->id = bytes_get_u32(r);
    bytes_get_f64s(r, h->home, 2);
}

static int compare_home(const void *a, const void *b)
{
    return compare_u32(section_element(a), section_element(b));
}

static bool home_valid(const void *record, const struct record_limits *limits, char *text)
{
    const struct home_record *h = record;
    if (!are_finite(h->home, 2))
        return record_refuse(text, "has a number that is not finite for element %" PRIu32, h->id);
    return element_valid(h->id, limits, text);
}

/* --- BODY --- */

static void put_body(struct bytes_writer *w, const void *record)
{
    const struct body_record *b = record;
    bytes_put_u16(w, b->mover);
    bytes_put_f64s(w, b->displacement, 2);
    bytes_put_f64s(w, b->velocity, 2);
    bytes_put_f64s(w, b->centroid, 2);
    bytes_put_f64s(w, b->integral, 2);
    bytes_put_f64(w, b->angle);
    bytes_put_f64(w, b->spin);
    for (int n = 0; n < 2; n++)
        for (int k = 0; k < 4; k++) {
            const struct exact_sum *s = k < 2 ? &b->force[n][k] : &b->touched[n][k - 2];
            bytes_put_i64(w, s->hi);
            bytes_put_u64(w, s->lo);
        }
    bytes_put_u32(w, b->contacts[0]);
    bytes_put_u32(w, b->contacts[1]);
}

static void get_body(struct bytes_reader *r, void *record)
{
    struct body_record *b = record;
    b->mover = bytes_get_u16(r);
    bytes_get_f64s(r, b->displacement, 2);
    bytes_get_f64s(r, b->velocity, 2);
    bytes_get_f64s(r, b->centroid, 2);
    bytes_get_f64s(r, b->integral, 2);
    b->angle = bytes_get_f64(r);
    b->spin = bytes_get_f64(r);
    for (int n = 0; n < 2; n++)
        for (int k = 0; k < 4; k++) {
            struct exact_sum *s = k < 2 ? &b->force[n][k] : &b->touched[n][k - 2];
            s->hi = bytes_get_i64(r);
            s->lo = bytes_get_u64(r);
        }
    b->contacts[0] = bytes_get_u32(r);
    b->contacts[1] = bytes_get_u32(r);
}

static int compare_body(const void *a, const void *b)
{
    return compare_u32(((const struct body_record *)a)->mover, ((const struct body_record *)b)->mover);
}

/* Along an axis with a load a displacement is below 2^30 domains and a velocity below a domain per step;
 * along an axis without one all is 0. */
static bool axis_valid(const struct body_record *b, const struct forced_body *forced, const struct config *c,
                       int a, char *text)
{
    char axis = a == 0 ? 'x' : 'y';
    bool none = forced->axis[a].load == NULL;
    double most = none ? 0.0 : 0x1p30 * c->size[a], fastest = none ? 0.0 : c->size[a] / c->dt;
    if (!(fabs(b->displacement[a]) <= most))
        return record_refuse(text,
                             "has displacement %g cm along %c for body or wall %u, at most %g is expected",
                             b->displacement[a], axis, b->mover, most);
    if (!(fabs(b->velocity[a]) <= fastest))
        return record_refuse(text,
                             "has velocity %g cm/us along %c for body or wall %u, at most %g is expected",
                             b->velocity[a], axis, b->mover, fastest);
    if (none && b->integral[a] != 0.0)
        return record_refuse(text, "has integral %g along %c for body or wall %u, which has no load there",
                             b->integral[a], axis, b->mover);
    return true;
}

/* What a record says beside the deck: a body or wall under force, which does not turn. */
static bool body_fits(const struct body_record *b, const struct record_limits *limits, char *text)
{
    const struct model *m = limits->model;
    const struct forced_body *forced =
        m->forced_of == NULL || m->forced_of[b->mover] == 0 ? NULL : &m->forced[m->forced_of[b->mover] - 1];
    if (forced == NULL)
        return record_refuse(text, "names body or wall %u, which no force moves", b->mover);
    if (b->angle != 0.0 || b->spin != 0.0)
        return record_refuse(text, "has angle %g, spin %g for body or wall %u, which does not turn", b->angle,
                             b->spin, b->mover);
    const double *centroid = b->mover < m->config->n_bodies ? &m->centroids[2 * b->mover] : (double[2]){0, 0};
    if (memcmp(centroid, b->centroid, sizeof b->centroid) != 0)
        return record_refuse(text, "has centroid %g %g cm for body or wall %u, %g %g is expected",
                             b->centroid[0], b->centroid[1], b->mover, centroid[0], centroid[1]);
    for (int n = 0; n < 2; n++)
        if (b->contacts[n] > RECORD_CONTACTS_MOST * limits->elements)
            return record_refuse(
                text, "has %" PRIu32 " contacts for body or wall %u, at most %d per element are expected",
                b->contacts[n], b->mover, RECORD_CONTACTS_MOST);
    return axis_valid(b, forced, m->config, 0, text) && axis_valid(b, forced, m->config, 1, text);
}

static bool body_valid(const void *record, const struct record_limits *limits, char *text)
{
    const struct body_record *b = record;
    if (!are_finite(b->displacement, 2) || !are_finite(b->velocity, 2) || !are_finite(b->centroid, 2) ||
        !are_finite(b->integral, 2) || !isfinite(b->angle) || !isfinite(b->spin))
        return record_refuse(text, "has a number that is not finite for body or wall %u", b->mover);
    if (limits != NULL && b->mover >= limits->movers)
        return record_refuse(text, "names body or wall %u, counted from 0; the deck has %zu", b->mover,
                             limits->movers);
    return limits == NULL || limits->model == NULL || body_fits(b, limits, text);
}

/* --- WCON --- */

static void put_wall_contact(struct bytes_writer *w, const void *record)
{
    const struct wall_contact *c = record;
    bytes_put_u32(w, c->id);
    bytes_put_u32(w, c->feature);
    bytes_put_u8(w, (uint8_t)c->sign);
    bytes_put_f64(w, c->spring);
}

static void get_wall_contact(struct bytes_reader *r, void *record)
{
    struct wall_contact *c = record;
    c->id = bytes_get_u32(r);
    c->feature = bytes_get_u32(r);
    uint8_t sign = bytes_get_u8(r);
    c->sign = (int8_t)(sign == 1 ? 1 : sign == 0xff ? -1 : 0);
    c->spring = bytes_get_f64(r);
}

static int compare_wall_contact(const void *a, const void *b)
{
    const struct wall_contact *one = a, *other = b;
    int order = compare_u32(one->id, other->id);
    return order != 0 ? order : compare_u32(one->feature, other->feature);
}

static bool wall_contact_valid(const void *record, const struct record_limits *limits, char *text)
{
    const struct wall_contact *c = record;
    if (!isfinite(c->spring))
        return record_refuse(text, "has a number that is not finite for element %" PRIu32, c->id);
    if (limits != NULL && limits->model != NULL &&
        !(fabs(c->spring) < RECORD_SPRING_MOST * limits->model->config->r_c))
        return record_refuse(text,
                             "has spring %g cm for element %" PRIu32 ", below 2^30 r_c = %g cm is expected",
                             c->spring, c->id, RECORD_SPRING_MOST * limits->model->config->r_c);
    if (c->sign == 0)
        return record_refuse(text, "has a sign that is neither 1 nor -1 for element %" PRIu32, c->id);
    if (limits != NULL && c->feature >= limits->features)
        return record_refuse(text, "names feature %" PRIu32 " of walls, counted from 0; the deck has %zu",
                             c->feature, limits->features);
    return element_valid(c->id, limits, text);
}

/* --- WFOR --- */

static void put_wall_force(struct bytes_writer *w, const void *record)
{
    const struct wall_force *f = record;
    bytes_put_u32(w, f->id);
    bytes_put_u32(w, f->feature);
    bytes_put_u16(w, f->wall);
    bytes_put_f64s(w, f->foot, 2);
    bytes_put_f64s(w, f->force, 2);
    bytes_put_f64(w, f->normal);
    bytes_put_f64(w, f->tangential);
}

static void get_wall_force(struct bytes_reader *r, void *record)
{
    struct wall_force *f = record;
    f->id = bytes_get_u32(r);
    f->feature = bytes_get_u32(r);
    f->wall = bytes_get_u16(r);
    bytes_get_f64s(r, f->foot, 2);
    bytes_get_f64s(r, f->force, 2);
    f->normal = bytes_get_f64(r);
    f->tangential = bytes_get_f64(r);
}

static int compare_wall_force(const void *a, const void *b)
{
    const struct wall_force *x = a, *y = b;
    int by_id = compare_u32(x->id, y->id);
    return by_id != 0 ? by_id : compare_u32(x->feature, y->feature);
}

static bool wall_force_valid(const void *record, const struct record_limits *limits, char *text)
{
    const struct wall_force *f = record;
    if (!are_finite(f->foot, 2) || !are_finite(f->force, 2) || !isfinite(f->normal) ||
        !isfinite(f->tangential))
        return record_refuse(text, "has a number that is not finite for element %" PRIu32, f->id);
    if (limits != NULL && (f->feature >= limits->features || f->wall + limits->bodies >= limits->movers))
        return record_refuse(text,
                             "names feature %" PRIu32 " of wall %u, counted from 0; the deck has not both",
                             f->feature, (unsigned)f->wall);
    return element_valid(f->id, limits, text);
}

/* --- the table --- */

const struct section_kind section_kinds[SECTION_COUNT] = {
    [SECTION_HOME] = {"HOME", 20, sizeof(struct home_record), true, put_home, get_home, compare_home,
                      home_valid},
    [SECTION_BODY] = {"BODY", 218, sizeof(struct body_record), false, put_body, get_body, compare_body,
                      body_valid},
    [SECTION_WCON] = {"WCON", 17, sizeof(struct wall_contact), true, put_wall_contact, get_wall_contact,
                      compare_wall_contact, wall_contact_valid},
    [SECTION_WFOR] = {"WFOR", 58, sizeof(struct wall_force), true, put_wall_force, get_wall_force,
                      compare_wall_force, wall_force_valid},
};

unsigned section_has(const struct config *config)
{
    unsigned has = config->n_walls > 0 ? 1u << SECTION_WCON : 0u;
    for (size_t b = 0; b < config->n_bodies; b++)
        has |= config_is_placed(config, b) ? 1u << SECTION_HOME : 0u;
    for (size_t i = 0; i < config->n_loads; i++)
        has |= config->loads[i].quantity >= LOAD_FORCE_X && config->loads[i].quantity <= LOAD_STRESS_YY
                   ? 1u << SECTION_BODY
                   : 0u;
    return has;
}

unsigned section_in_snapshot(const struct config *config)
{
    return config->n_walls > 0 ? 1u << SECTION_WFOR : 0u;
}

uint32_t section_element(const void *record)
{
    uint32_t id;
    memcpy(&id, record, sizeof id);
    return id;
}

/* --- arrays --- */

bool section_append(enum section kind, struct section_array *a, const void *from, size_t n)
{
    size_t size = section_kinds[kind].size;
    void *grown = n == 0 ? NULL : mem_grown(a->records, &a->cap, a->n, a->n + n, size);
    if (grown == NULL)
        return n == 0;
    a->records = grown;
    unsigned char *to = (unsigned char *)grown + a->n * size;
    memset(to, 0, n * size);
    if (from != NULL)
        memcpy(to, from, n * size);
    a->n += n;
    return true;
}

enum dm2_status section_get(enum section kind, struct bytes_reader *r, size_t n,
                            const struct record_limits *limits, struct section_array *out,
                            struct dm2_error *err)
{
    const struct section_kind *k = &section_kinds[kind];
    size_t first = out->n;
    char text[RECORD_FAULT_TEXT];
    if (n > 0 && limits != NULL && (limits->sections & 1u << kind) == 0)
        return dm2_fail(err, DM2_PROTOCOL, "section %s is there, and the deck has nothing for it", k->tag);
    if (bytes_remaining(r) / k->bytes < n) {
        r->failed = true;
        return DM2_OK;
    }
    if (!section_append(kind, out, NULL, n))
        return dm2_fail(err, DM2_MEMORY, "no memory for %zu records of the section %s", n, k->tag);
    for (size_t i = first; i < out->n; i++) {
        k->get(r, section_record(kind, out, i));
        if (!k->valid(section_record(kind, out, i), limits, text))
            return dm2_fail(err, DM2_PROTOCOL, "section %s %s", k->tag, text);
    }
    return DM2_OK;
}

static enum dm2_status check_order(enum section kind, const struct section_array *a, struct dm2_error *err)
{
    for (size_t i = 1; i < a->n; i++)
        if (section_kinds[kind].compare(section_record(kind, a, i - 1), section_record(kind, a, i)) >= 0)
            return dm2_fail(err, DM2_PROTOCOL, "section %s: record %zu is out of order or there twice",
                            section_kinds[kind].tag, i);
    return DM2_OK;
}

enum dm2_status section_sort(enum section kind, struct section_array *a, struct dm2_error *err)
{
    if (a->n > 1)
        qsort(a->records, a->n, section_kinds[kind].size, section_kinds[kind].compare);
    return check_order(kind, a, err);
}

enum dm2_status section_check(enum section kind, const struct section_array *a,
                              const struct record_limits *limits, const struct element *elements, size_t n,
                              struct dm2_error *err)
{
    const struct section_kind *k = &section_kinds[kind];
    char text[RECORD_FAULT_TEXT];
    if (a->n > 0 && limits != NULL && (limits->sections & 1u << kind) == 0)
        return dm2_fail(err, DM2_PROTOCOL, "section %s is there, and the deck has nothing for it", k->tag);
    for (size_t i = 0; i < a->n; i++) {
        const void *record = section_record(kind, a, i);
        if (!k->valid(record, limits, text))
            return dm2_fail(err, DM2_PROTOCOL, "section %s %s", k->tag, text);
        if (k->of_element && element_find(elements, n, section_element(record)) == n)
            return dm2_fail(err, DM2_PROTOCOL,
                            "section %s names element %" PRIu32 ", which is not in the state", k->tag,
                            section_element(record));
    }
    return check_order(kind, a, err);
}

void section_free(struct section_array arrays[SECTION_COUNT])
{
    for (int kind = 0; kind < SECTION_COUNT; kind++) {
        free(arrays[kind].records);
        arrays[kind] = (struct section_array){.n = 0};
    }
}

/* --- the head of a section in a file --- */

void section_put_head(struct bytes_writer *w, const char *tag, uint32_t bytes, uint64_t records)
{
    bytes_put_raw(w, tag, SECTION_TAG);
    bytes_put_u32(w, bytes);
    bytes_put_u64(w, records);
}

void section_get_head(struct bytes_reader *r, struct section_head *out)
{
    const unsigned char *tag = bytes_get_raw(r, SECTION_TAG);
    *out = (struct section_head){.bytes = bytes_get_u32(r)};
    out->records = bytes_get_u64(r);
    if (tag != NULL)
        memcpy(out->tag, tag, SECTION_TAG);
}
