/* A kind's constants, from the material or the phase that the deck gives, and the bounds of an element's size
 * in all kinds that it may take. */
#include "kinds.h"

#include <math.h>

static const double root3 = 0x1.bb67ae8584caap0;

double kind_mass(const struct material_config *m, double radius)
{
    if (!isnan(m->mass))
        return m->mass;
    double d = 2.0 * radius;
    return m->rho0 * (0.5 * root3 * (d * d));
}

double kind_given(double value, double otherwise)
{
    return isnan(value) ? otherwise : value;
}

/* The least and the largest size of a material's elements in all phases, relative to the first phase. */
static void find_size_range(const struct model *m, int material, double *least, double *most)
{
    *least = *most = 1.0;
    for (size_t i = 0; i < m->n_kinds; i++) {
        double size = m->kinds[i].material == material ? m->kinds[i].size : 1.0;
        *least = size < *least ? size : *least;
        *most = size > *most ? size : *most;
    }
}

/* Finds the largest radius of any element at any time, and the largest factor by which an element may grow.
 * An element that becomes the product of a reaction keeps its size, and the phases of the product scale that
 * size. */
static void bound_sizes(struct model *m)
{
    const struct reaction_config *r = m->config->n_reactions > 0 ? &m->config->reactions[0] : NULL;
    double largest = 1.0, least, most, product_least = 1.0, product_most = 1.0;
    m->growth = 1.0;
    if (r != NULL)
        find_size_range(m, r->product, &product_least, &product_most);
    for (int i = 0; i < (int)m->config->n_materials; i++) {
        find_size_range(m, i, &least, &most);
        if (r != NULL && (i == r->reactant[0] || i == r->reactant[1])) {
            least *= product_least;
            most *= product_most;
        }
        m->growth = most / least > m->growth ? most / least : m->growth;
        largest = most > largest ? most : largest;
    }
    m->radius_max *= largest;
}

/* The energy of a phase is the energy of its parent phase plus the latent heat, minus the difference of the
 * two heat capacities times the temperature range from T0 to the temperature at which the latent heat is
 * given. */
void kinds_build(struct model *m)
{
    const struct config *c = m->config;
    for (size_t i = 0; i < m->n_kinds; i++) {
        const struct phase_config *phase = i < c->n_materials ? NULL : &c->phases[i - c->n_materials];
        const struct material_config *state = phase == NULL ? &c->materials[i] : &phase->state;
        struct kind *kind = &m->kinds[i];
        *kind = (struct kind){.material = phase == NULL ? (int)i : phase->material,
                              .state = state,
                              .phase = phase,
                              .size = 1.0,
                              .t0 = state->t0,
                              .tm = kind_given(state->tm, INFINITY),
                              .softening = state->softening,
                              .cp = kind_given(state->cp, INFINITY)};
        kind->over_cp = 1.0 / kind->cp;
        kind->over_range = 1.0 / (kind->tm - kind->t0);
        if (phase == NULL)
            continue;
        kind->from = phase->from < 0 ? (size_t)phase->material : c->n_materials + (size_t)phase->from;
        const struct kind *from = &m->kinds[kind->from];
        kind->energy = from->energy + phase->latent;
        if (isfinite(kind->cp))
            kind->energy -= (kind->cp - from->cp) * (phase->t_line - kind->t0);
        double least_cp = kind->cp < from->cp ? kind->cp : from->cp;
        double latent = phase->latent > 0.0 ? phase->latent : 0.0;
        kind->hysteresis = phase->transition == TRANSITION_PRESSURE
                               ? phase->hysteresis_p
                               : kind_given(phase->hysteresis_t, 1.1 * latent / least_cp);
        if (isnan(c->materials[phase->material].mass))
            kind->size = sqrt(c->materials[phase->material].rho0 / state->rho0);
    }
    bound_sizes(m);
    m->has_phases = c->n_phases > 0;
    m->has_kinds = m->has_phases || c->n_reactions > 0;
}

bool kind_may_become(const struct model *m, int material, size_t kind)
{
    const struct reaction_table *x = &m->reaction;
    bool reacts = x->any && (material == x->reactant[0] || material == x->reactant[1]);
    return m->kinds[kind].material == material || (reacts && m->kinds[kind].material == x->product);
}

void kinds_build_reaction(struct model *m)
{
    const struct config *c = m->config;
    if (c->n_reactions == 0)
        return;
    const double gas_constant =
        8.31446261815324e-5; /* g cm2/us2/mol/K; CODATA 2018, 8.31446261815324 J/mol/K */
    const struct reaction_config *r = &c->reactions[0];
    double least = INFINITY;
    for (size_t b = 0; b < c->n_bodies; b++)
        least = c->bodies[b].radius < least ? c->bodies[b].radius : least;
    m->reaction = (struct reaction_table){.any = true,
                                          .reactant = {r->reactant[0], r->reactant[1]},
                                          .product = r->product,
                                          .stoichiometric = r->kind == REACTION_STOICHIOMETRIC,
                                          .k0 = r->k0,
                                          .theta = r->ea / gas_constant,
                                          .heat = r->heat,
                                          .threshold = r->threshold};
    for (int a = 0; a < 2 && m->reaction.stoichiometric; a++)
        m->reaction.share[a] = r->masses[a] / (r->masses[0] + r->masses[1]);
    /* A disc among equal discs has six neighbours, eight in a crushed material; a large disc may touch as
     * many as the 64 that the sums allow. */
    m->reaction.limit = m->radius_max <= 1.5 * least ? 1.0 / 8.0 : 1.0 / 64.0;
    m->has_heat = true;
}
