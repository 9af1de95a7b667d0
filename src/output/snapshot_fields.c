/* A function per field gives its numbers. */
#include "snapshot_fields.h"

#include <string.h>

static void get_position(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].r[0];
    out[1] = s->elements[i].r[1];
    out[2] = 0;
}

static void get_id(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].id;
}

static void get_kind(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].kind;
}

static void get_body(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].body;
}

static void get_grain(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].grain;
}

static void get_radius(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].radius;
}

static void get_velocity(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].velocity[0];
    out[1] = s->measured[i].velocity[1];
    out[2] = 0;
}

static void get_spin(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].w;
}

static void get_temperature(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].temperature;
}

static void get_pressure(const struct snapshot *s, size_t i, double out[3])
{
    const double *stress = s->measured[i].stress;
    out[0] = -0.5 * (stress[0] + stress[1]);
}

static void get_stress(const struct snapshot *s, size_t i, double out[3])
{
    memcpy(out, s->measured[i].stress, sizeof s->measured[i].stress);
}

/* The index of the element's phase among the phases of its material: 0 the first, then in deck order. */
static void get_phase(const struct snapshot *s, size_t i, double out[3])
{
    const struct config *c = s->config;
    size_t kind = s->elements[i].kind, phase = 0;
    for (size_t k = c->n_materials; k <= kind && k < config_kinds(c); k++)
        phase += c->phases[k - c->n_materials].material == c->phases[kind - c->n_materials].material;
    out[0] = (double)phase;
}

static bool has_phases(const struct snapshot *s)
{
    return s->config->n_phases > 0;
}

static bool has_composition(const struct snapshot *s)
{
    return s->config->n_reactions > 0;
}

static void get_composition(const struct snapshot *s, size_t i, double out[3])
{
    const struct reaction_config *r = &s->config->reactions[0];
    const struct config *c = s->config;
    size_t kind = s->elements[i].kind;
    int material = kind < c->n_materials ? (int)kind : c->phases[kind - c->n_materials].material;
    bool takes_part = material == r->reactant[0] || material == r->reactant[1] || material == r->product;
    out[0] = s->elements[i].share[0];
    out[1] = s->elements[i].share[1];
    out[2] = takes_part ? 1.0 - out[0] - out[1] : 0.0;
}

static void get_links(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].links;
}

static void get_contacts(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].contacts;
}

static void get_bonds(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].bonds;
}

/* 1 - links/bonds, at least 0: links that formed during the run make up for broken ones, but damage is not
 * negative. */
static void get_damage(const struct snapshot *s, size_t i, double out[3])
{
    double bonds = s->elements[i].bonds, links = s->measured[i].links;
    out[0] = links < bonds ? 1 - links / bonds : 0;
}

static void get_fragment(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->fragment[i];
}

static bool has_fragment(const struct snapshot *s)
{
    return s->fragment != NULL;
}

static void get_strain(const struct snapshot *s, size_t i, double out[3])
{
    memcpy(out, s->elements[i].strain, sizeof s->elements[i].strain);
}

static bool has_strain(const struct snapshot *s)
{
    return s->config->output.strain;
}

static void get_image(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].image[0];
    out[1] = s->elements[i].image[1];
}

static bool has_image(const struct snapshot *s)
{
    return s->config->periodic[0] || s->config->periodic[1];
}

const struct snapshot_field snapshot_position = {"position",         "pos",        TYPE_F64, 3,
                                                 {NULL, NULL, NULL}, get_position, NULL};

const struct snapshot_field snapshot_fields[SNAPSHOT_FIELDS] = {
    {"id", "id", TYPE_U32, 1, {NULL, NULL, NULL}, get_id, NULL},
    {"kind", "kind", TYPE_U16, 1, {NULL, NULL, NULL}, get_kind, NULL},
    {"body", "body", TYPE_U16, 1, {NULL, NULL, NULL}, get_body, NULL},
    {"grain", "grain", TYPE_U32, 1, {NULL, NULL, NULL}, get_grain, NULL},
    {"radius", "radius", TYPE_F64, 1, {NULL, NULL, NULL}, get_radius, NULL},
    {"velocity", "velo", TYPE_F64, 3, {"x", "y", "z"}, get_velocity, NULL},
    {"spin", "angular_velocity", TYPE_F64, 1, {NULL, NULL, NULL}, get_spin, NULL},
    {"temperature", "temperature", TYPE_F64, 1, {NULL, NULL, NULL}, get_temperature, NULL},
    {"pressure", "pressure", TYPE_F64, 1, {NULL, NULL, NULL}, get_pressure, NULL},
    {"stress", NULL, TYPE_F64, 3, {"xx", "yy", "xy"}, get_stress, NULL},
    {"phase", "phase", TYPE_U16, 1, {NULL, NULL, NULL}, get_phase, has_phases},
    {"composition", NULL, TYPE_F64, 3, {"a", "b", "product"}, get_composition, has_composition},
    {"links", "links", TYPE_U32, 1, {NULL, NULL, NULL}, get_links, NULL},
    {"contacts", "contacts", TYPE_U32, 1, {NULL, NULL, NULL}, get_contacts, NULL},
    {"bonds", "bonds", TYPE_U16, 1, {NULL, NULL, NULL}, get_bonds, NULL},
    {"damage", "damage", TYPE_F64, 1, {NULL, NULL, NULL}, get_damage, NULL},
    {"fragment", "fragment", TYPE_U32, 1, {NULL, NULL, NULL}, get_fragment, has_fragment},
    {"strain", NULL, TYPE_F64, 3, {"xx", "yy", "xy"}, get_strain, has_strain},
    {"image", "image", TYPE_I32, 2, {"x", "y", NULL}, get_image, has_image},
};

bool snapshot_has(const struct snapshot *s, const struct snapshot_field *f)
{
    size_t index = (size_t)(f - snapshot_fields);
    return (s->config->output.fields >> index & 1u) && (f->present == NULL || f->present(s));
}

bool snapshot_writes(const struct snapshot *s, const char *name)
{
    for (int k = 0; k < SNAPSHOT_FIELDS; k++)
        if (strcmp(snapshot_fields[k].name, name) == 0)
            return snapshot_has(s, &snapshot_fields[k]);
    return false;
}

bool snapshot_has_pairs(const struct snapshot *s)
{
    return s->config->output.fields >> SNAPSHOT_FIELDS & 1u;
}

bool snapshot_shows(const struct snapshot *s, size_t i)
{
    const bool *bodies = s->config->output.bodies;
    return bodies == NULL || bodies[s->elements[i].body];
}
