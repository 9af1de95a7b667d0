/* Which records cannot be.
 *
 * Each rule of the table element_fields is one function that, given a text, says what was found and what is
 * expected. The rules of a deck follow from what a deck and a step can make: ids, bodies, grains, materials
 * and masses are those of the generator, so that they are compared exactly; numbers that grow by computing
 * are compared with the ranges that the engine itself holds to (leapfrog_move, measure_element). Fields are
 * checked in the order of the table, so that a rule may use the fields before its own. */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include "dm2/base/exact.h"
#include "dm2/deck/config.h"
#include "dm2/engine/record.h"
#include "dm2/engine/section.h"
#include "generate.h"
#include "kinds.h"
#include "periodic.h"
#include "phase.h"
#include "tables.h"

struct record_limits record_limits_of(const struct model *model)
{
    const struct config *c = model_config(model);
    return (struct record_limits){.elements = model_ids(model),
                                  .holes = model_ids(model) - model_elements(model),
                                  .bodies = c->n_bodies,
                                  .kinds = config_kinds(c),
                                  .probes = config_regions(c),
                                  .movers = c->n_bodies + c->n_walls,
                                  .features = model->n_wall_features,
                                  .sections = section_has(c),
                                  .periodic = {c->periodic[0], c->periodic[1]},
                                  .model = model};
}

bool record_refuse(char *text, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (text != NULL)
        (void)vsnprintf(text, RECORD_FAULT_TEXT, format, args);
    va_end(args);
    return false;
}

/* --- values by themselves, and indices --- */

static uint32_t integer_of(const struct element_field *f, const struct element *e)
{
    const void *from = (const unsigned char *)e + f->offset;
    return f->type == FIELD_U8    ? *(const uint8_t *)from
           : f->type == FIELD_U16 ? *(const uint16_t *)from
                                  : *(const uint32_t *)from;
}

static bool check_doubles(const struct element_field *f, const struct element *e, char *text)
{
    const double *x = (const double *)(const void *)((const unsigned char *)e + f->offset);
    for (int c = 0; c < f->count; c++) {
        if (!isfinite(x[c]))
            return record_refuse(text, "has a number that is not finite: %s %g", f->name, x[c]);
        if ((f->rule == RULE_RADIUS || f->rule == RULE_MASS) && !(x[c] > 0))
            return record_refuse(text, "has a radius or a mass that is not positive: %s %g", f->name, x[c]);
        if (f->rule == RULE_FRACTION && !(x[c] >= 0 && x[c] <= 1))
            return record_refuse(text, "has %s %g, 0 to 1 is expected", f->name, x[c]);
    }
    if (f->rule == RULE_FRACTION && !(x[0] + x[1] <= 1))
        return record_refuse(text, "has %s %g and %g, a sum of at most 1 is expected", f->name, x[0], x[1]);
    return true;
}

static bool check_image(const struct element *e, const struct record_limits *limits, char *text)
{
    for (int a = 0; a < 2; a++) {
        if (e->image[a] > IMAGE_MOST || e->image[a] < -IMAGE_MOST)
            return record_refuse(text, "has image %" PRId32 " in %c, at most 2^30 either way is expected",
                                 e->image[a], "xy"[a]);
        if (limits != NULL && !limits->periodic[a] && e->image[a] != 0)
            return record_refuse(
                text, "has image %" PRId32 " in %c, 0 is expected: the domain is not periodic there",
                e->image[a], "xy"[a]);
    }
    return true;
}

/* The highest bit that is set. */
static int highest_bit(uint32_t bits)
{
    int bit = -1;
    for (; bits != 0; bits >>= 1)
        bit++;
    return bit;
}

static bool check_integer(const struct element_field *f, const struct element *e,
                          const struct record_limits *limits, char *text)
{
    uint32_t value = integer_of(f, e);
    if (f->rule == RULE_FLAGS && (value & ~(uint32_t)ELEMENT_FIXED_MOTION) != 0)
        return record_refuse(
            text, "has a flag that this program does not know: flags %" PRIu32 ", 0 or 1 is expected", value);
    if (limits == NULL)
        return true;
    if (f->rule == RULE_PROBES && value >> limits->probes != 0)
        return record_refuse(text, "belongs to probe %d, counted from 0; the deck has %zu",
                             highest_bit(value), limits->probes);
    if (f->rule == RULE_ID && value >= limits->elements)
        return record_refuse(text, "is none of the %zu elements that the deck makes", limits->elements);
    size_t most = f->rule == RULE_BODY ? limits->bodies : limits->kinds;
    if ((f->rule == RULE_BODY || f->rule == RULE_KIND) && value >= most)
        return record_refuse(text,
                             "is of a body or a kind that the deck does not have: %s %" PRIu32
                             ", counted from 0; the deck "
                             "has %zu",
                             f->name, value, most);
    return true;
}

/* --- what the generator made --- */

static const struct body_config *body_of(const struct model *m, const struct element *e)
{
    return &m->config->bodies[e->body];
}

static int material_of(const struct model *m, const struct element *e)
{
    return generate_material(body_of(m, e), e->id, e->grain);
}

/* The range k of the n ranges that begin at first[k] and hold the id. */
static size_t find_range(const uint32_t *first, size_t n, uint32_t id)
{
    size_t low = 0, high = n;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (first[middle] <= id)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The grain of an element that the deck makes follows from its id; that of an element from a state is in a
 * range of its body, which check_body compares. */
static bool check_grain(const struct model *m, const struct element *e, char *text)
{
    uint32_t start = m->config->start.next_grain, k = e->grain - start;
    if (e->id < m->config->start.next_id)
        return true;
    if (e->grain >= start && k < m->n_grains && m->grain_first[k] <= e->id && e->id < m->grain_first[k + 1])
        return true;
    return record_refuse(text, "has grain %" PRIu32 ", %zu is expected", e->grain,
                         start + find_range(m->grain_first, m->n_grains, e->id));
}

static bool check_body(const struct model *m, const struct element *e, char *text)
{
    const struct body_config *body = body_of(m, e);
    if (m->bodies[e->body].first <= e->id && e->id < m->bodies[e->body].end)
        return !body->from_state ||
               (e->grain >= body->start.grain_first && e->grain < body->start.grain_end) ||
               record_refuse(text, "has grain %" PRIu32 ", %" PRIu32 " to %" PRIu32 " is expected", e->grain,
                             body->start.grain_first, body->start.grain_end - 1);
    for (size_t b = 0; b < m->config->n_bodies; b++)
        if (m->bodies[b].first <= e->id && e->id < m->bodies[b].end)
            return record_refuse(text, "has body %u, %zu is expected", e->body, b);
    return record_refuse(text, "has body %u, and its id is of no body", e->body);
}

static bool check_kind(const struct model *m, const struct element *e, const char *name, uint16_t kind,
                       char *text)
{
    struct kind_name is, made;
    int material = material_of(m, e);
    if (kind_may_become(m, material, kind))
        return true;
    return record_refuse(text, "has %s %u, '%.40s': a kind that its material '%.40s' can become is expected",
                         name, kind, config_kind_name(m->config, kind, &is),
                         config_kind_name(m->config, (size_t)material, &made));
}

/* Changes of phase multiply the radius by ratios of sizes, each rounded. */
static bool is_radius(double radius, double expected)
{
    return fabs(radius - expected) <= 1e-9 * expected;
}

/* The product of a reaction keeps the radius that the reactant's element had, in any of its phases. */
static bool check_radius(const struct model *m, const struct element *e, char *text)
{
    int material = material_of(m, e);
    const struct kind *kind = &m->kinds[e->kind];
    double expected = body_of(m, e)->radius * kind->size;
    for (size_t k = 0; k < m->n_kinds && kind->material != material; k++)
        if (m->kinds[k].material == material && is_radius(e->radius, expected * m->kinds[k].size))
            return true;
    return is_radius(e->radius, expected) ||
           record_refuse(text, "has radius %.10g cm, %.10g is expected", e->radius, expected);
}

static bool check_mass(const struct model *m, const struct element *e, char *text)
{
    double expected = kind_mass(&m->config->materials[material_of(m, e)], body_of(m, e)->radius);
    return e->mass == expected ||
           record_refuse(text, "has mass %.17g g, %.17g is expected", e->mass, expected);
}

static bool check_shares(const struct model *m, const struct element *e, char *text)
{
    int material = material_of(m, e);
    for (int a = 0; a < 2; a++)
        if (e->share[a] > 0 && !(m->reaction.any && material == m->reaction.reactant[a]))
            return record_refuse(
                text, "has share %g of reactant %d, 0 is expected: the element did not start with it",
                e->share[a], a + 1);
    return true;
}

/* How many elements fit around one: centres within the reach of first links, a quarter of the least contact
 * distance apart. */
static double find_room(const struct model *m)
{
    double least = m->radius_max;
    for (size_t b = 0; b < m->config->n_bodies; b++)
        least = m->config->bodies[b].radius < least ? m->config->bodies[b].radius : least;
    double across = 1.02 * 2.0 * m->radius_max / (0.25 * least) + 1.0;
    return across * across;
}

static bool check_bonds(const struct model *m, const struct element *e, char *text)
{
    double most = m->has_near ? (double)m->n_elements - 1.0 : 0.0;
    if (e->bonds > 64) /* more than that need elements of several sizes */
        most = fmin(most, floor(find_room(m)));
    return e->bonds <= most || record_refuse(text, "has bonds %u, at most %.0f is expected", e->bonds, most);
}

/* --- what steps can make --- */

static bool check_place(const struct model *m, const struct element *e, char *text)
{
    for (int a = 0; a < 2; a++) {
        double low = m->grid.origin[a], high = low + m->grid.size[a];
        if (m->grid.periodic[a] && !(e->r[a] >= low && e->r[a] < high))
            return record_refuse(
                text, "has r %.17g cm in %c, %g <= r < %g is expected: the domain is periodic there", e->r[a],
                "xy"[a], low, high);
    }
    return true;
}

/* leapfrog_move ends a run with a faster element. */
static bool check_speed(const struct model *m, const struct element *e, char *text)
{
    double edge = m->grid.lx < m->grid.ly ? m->grid.lx : m->grid.ly, most = edge / m->config->dt;
    return e->v[0] * e->v[0] + e->v[1] * e->v[1] < most * most ||
           record_refuse(text, "has v (%g, %g) cm/us, a speed below %g, a cell edge per step, is expected",
                         e->v[0], e->v[1], most);
}

/* Can the sums of the history hold this energy? */
static bool check_energy(const struct model *m, const char *name, double value, double energy, char *text)
{
    struct exact_sum sum = {0};
    return exact_add(&sum, energy, m->scales.energy) ||
           record_refuse(text, "has %s %g, beyond the energies that a run can hold", name, value);
}

static bool check_deck(const struct element_field *f, const struct element *e, const struct model *m,
                       char *text)
{
    const double *x = (const double *)(const void *)((const unsigned char *)e + f->offset);
    double square = e->radius * e->radius;
    switch (f->rule) {
    case RULE_GRAIN:
        return check_grain(m, e, text);
    case RULE_BODY:
        return check_body(m, e, text);
    case RULE_KIND:
        if (f->offset == offsetof(struct element, was) && !m->has_kinds) /* the engine has no array for it */
            return e->was == 0 ||
                   record_refuse(text, "has was %u, 0 is expected: no kind of the deck changes", e->was);
        return check_kind(m, e, f->name, (uint16_t)integer_of(f, e), text);
    case RULE_FLAGS: {
        unsigned expected = body_of(m, e)->motion == MOTION_FREE ? 0 : ELEMENT_FIXED_MOTION;
        return e->flags == expected ||
               record_refuse(text, "has flags %u, %u is expected by the motion of the body '%.40s'", e->flags,
                             expected, body_of(m, e)->name);
    }
    case RULE_RADIUS:
        return check_radius(m, e, text);
    case RULE_MASS:
        return check_mass(m, e, text);
    case RULE_PLACE:
        return check_place(m, e, text);
    case RULE_SPEED:
        return check_speed(m, e, text);
    case RULE_SPIN:
        return check_energy(m, f->name, e->w, 0.25 * e->mass * square * (e->w * e->w), text);
    case RULE_PRESSURE:
        return check_energy(m, f->name, e->p, e->p * (4.0 * square), text);
    case RULE_FRACTION:
        return check_shares(m, e, text);
    case RULE_HEAT:
    case RULE_ENERGY:
        if (f->offset == offsetof(struct element, damped) && !m->has_damping)
            return e->damped == 0.0 ||
                   record_refuse(text, "has damped %g, 0 is expected: the deck has no damping", e->damped);
        return check_energy(m, f->name, *x, *x, text);
    case RULE_BONDS:
        return check_bonds(m, e, text);
    default:
        return true;
    }
}

/* --- records --- */

static bool check_field(const struct element_field *f, const struct element *e,
                        const struct record_limits *limits, char *text)
{
    bool valid = f->type == FIELD_F64   ? check_doubles(f, e, text)
                 : f->type == FIELD_I32 ? check_image(e, limits, text)
                                        : check_integer(f, e, limits, text);
    return valid && (limits == NULL || limits->model == NULL || check_deck(f, e, limits->model, text));
}

const struct element_field *record_fault(const struct element *e, const struct record_limits *limits)
{
    for (const struct element_field *f = element_fields; f < element_fields + ELEMENT_FIELDS; f++)
        if (!check_field(f, e, limits, NULL))
            return f;
    return NULL;
}

void record_describe_fault(const struct element_field *fault, const struct element *e,
                           const struct record_limits *limits, char text[RECORD_FAULT_TEXT])
{
    text[0] = '\0';
    (void)check_field(fault, e, limits, text);
}

bool record_pair_valid(const struct pair_record *p, const struct record_limits *limits,
                       char text[RECORD_FAULT_TEXT])
{
    const double x[2] = {p->stretch, p->spring};
    const struct model *m = limits != NULL ? limits->model : NULL;
    for (int k = 0; k < 2; k++) {
        const char *name = k == 0 ? "stretch" : "spring";
        if (!isfinite(x[k]))
            return record_refuse(text, "has a number that is not finite: %s %g", name, x[k]);
        double times = k == 0 ? 1.0 : RECORD_SPRING_MOST;
        if (m != NULL && !(fabs(x[k]) < times * m->config->r_c))
            return record_refuse(text, "has %s %g cm, below %s%g cm either way is expected", name, x[k],
                                 k == 0 ? "r_c = " : "2^30 r_c = ", times * m->config->r_c);
    }
    if (p->linked > 1)
        return record_refuse(text, "is neither linked nor not linked: linked %" PRIu32 ", 0 or 1 is expected",
                             p->linked);
    if (p->id_a >= p->id_b)
        return record_refuse(text, "does not name its lower element first");
    if (limits != NULL && p->id_b >= limits->elements)
        return record_refuse(text, "names an element that is none of the %zu that the deck makes",
                             limits->elements);
    return true;
}

/* The distance up to which the last evaluation kept or made a link of a and b, or up to which they touched:
 * by the kinds and radii before the last move, and the reach of first links. 1e-6 leaves room for what counts
 * as touching. */
static double find_reach(const struct model *m, const struct element *a, const struct element *b)
{
    bool moved = m->has_kinds;
    size_t kind_a = moved ? a->was : a->kind, kind_b = moved ? b->was : b->kind;
    double r0 = phase_radius(m, a->radius, a->kind, kind_a) + phase_radius(m, b->radius, b->kind, kind_b);
    const struct pair_law *law =
        model_law(m, kind_a, kind_b, relation_of(a->body, a->grain, b->body, b->grain));
    return law->near ? r0 * (law->link_break > 1.02 ? law->link_break : 1.02) * (1.0 + 1e-6) : m->config->r_c;
}

bool record_pair_reaches(const struct element *a, const struct element *b, const struct record_limits *limits,
                         char text[RECORD_FAULT_TEXT])
{
    const struct model *m = limits != NULL ? limits->model : NULL;
    if (m == NULL)
        return true;
    const struct period period = period_of(&m->grid);
    const double back[3] = {0.0, m->config->dt, m->config->dt_before};
    double most = find_reach(m, a, b), apart = 0.0;
    for (int n = 0; n < 3; n++) {
        double r2 = 0.0;
        for (size_t k = 0; k < 2; k++) {
            double d = period_nearest(a->r[k] - b->r[k], period.size[k], period.half[k]);
            d -= (a->v[k] - b->v[k]) * back[n];
            r2 += d * d;
        }
        apart = n == 0 ? sqrt(r2) : apart;
        if (r2 <= most * most)
            return true;
    }
    return record_refuse(
        text, "has elements %g cm apart, at most %g is expected where they touch or are linked", apart, most);
}
