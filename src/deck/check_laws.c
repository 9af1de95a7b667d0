/* A law is what its keywords say, or the reader says so: an error where a keyword would have no meaning or
 * another one, a warning with the value that will hold where the lattice or the potential is the limit.
 * Values that did not read are NaN, and every comparison is written to be false for NaN. */
#include "check_laws.h"

#include <math.h>

#include "dm2/deck/lattice.h"

/* Constants of a material or of one of its phases, and the block that gives them. */
struct law_state {
    const struct material_config *constants;
    size_t block;
    const char *name;
};

static struct law_state material_state(const struct pair_check *p, int which)
{
    int m = p->materials[which];
    const struct material_config *constants = &p->b->config->materials[m];
    return (struct law_state){constants, p->b->blocks[BLOCK_MATERIAL][m], constants->name};
}

static void warn_ignored(const struct pair_check *p, const char *key, const char *chooser, const char *where)
{
    if (pair_check_given_for(p, key, chooser))
        findings_warn(p->b->findings, pair_check_place(p, key), "'%s' has no meaning for %s", key, where);
}

/* True where links may join pairs of this relation. */
static bool may_link(const struct pair_check *p)
{
    return p->law.linked || p->law.link_form > 0.0;
}

/* --- keywords that others ignore --- */

/* True where pairs of scope `all` also have contacts and links: damping, a tangential part, or conduction. */
static bool has_contacts(const struct pair_check *p)
{
    const struct interaction_config *in = &p->law;
    const struct material_config *a = material_state(p, 0).constants, *b = material_state(p, 1).constants;
    bool shear = isnan(in->kt_ratio) ? a->shear > 0.0 && b->shear > 0.0 : in->kt_ratio > 0.0;
    return in->zeta > 0.0 || in->ct_ratio > 0.0 || in->mu > 0.0 || shear ||
           (in->conductance > 0.0 && a->kappa > 0.0 && b->kappa > 0.0);
}

static void check_scope_all(const struct pair_check *p)
{
    static const char *const of_links[] = {"linked", "link_form", "link_break", "yield"};
    struct law_state a = material_state(p, 0);
    warn_ignored(p, "tensile", "scope", "the scope all, whose bonds do not flow");
    if (p->materials[0] == p->materials[1] && binding_given(p->b, a.block, "tensile"))
        findings_warn(p->b->findings, binding_place(p->b, a.block, "tensile", 0),
                      "'tensile' of '%s' has no meaning for the scope all, whose bonds do not flow", a.name);
    for (size_t k = 0; k < sizeof of_links / sizeof of_links[0] && !has_contacts(p); k++)
        if (k > 0 || p->law.linked)
            warn_ignored(p, of_links[k], "scope",
                         "the scope all without damping, friction, shear or conduction, because such pairs "
                         "have no links");
}

static void check_scope(const struct pair_check *p)
{
    bool atoms = p->law.potential == POTENTIAL_LENNARD_JONES && pair_check_given(p, "epsilon") &&
                 pair_check_given(p, "sigma");
    if (p->law.scope == SCOPE_ALL) {
        check_scope_all(p);
        return;
    }
    warn_ignored(p, "cutoff", "scope", "the scope linked");
    if (atoms)
        findings_error(p->b->findings, pair_check_place(p, "epsilon"),
                       "'epsilon' and 'sigma' give the Lennard-Jones potential of all pairs within 'cutoff': "
                       "write 'scope = all'; with the scope linked the minimum of the potential lies at the "
                       "contact distance, so that sigma cannot hold: give 'k' there");
}

/* Checks for keywords that other keywords replace. */
static void check_replaced(const struct pair_check *p)
{
    bool atoms = p->law.potential == POTENTIAL_LENNARD_JONES && !isnan(p->law.epsilon);
    bool shape = p->law.potential == POTENTIAL_MORSE && isnan(p->law.shape);
    if (atoms)
        warn_ignored(p, "k", "epsilon", "a pair with 'epsilon' and 'sigma'");
    if (p->law.zeta <= 0.0) {
        warn_ignored(p, "a_p", "zeta", "a pair without damping: 'zeta' is 0");
        warn_ignored(p, "a_t", "zeta", "a pair without damping: 'zeta' is 0");
    }
    if ((atoms || !isnan(p->law.k)) && !shape)
        warn_ignored(p, "calibration", atoms ? "epsilon" : "k",
                     "a pair whose constants do not follow from Hugoniot data");
}

/* --- constants of a material that the interaction replaces --- */

/* Warns of a material's constant where a keyword of the interaction means another value, by more than 1 %. */
static void warn_replaced(const struct pair_check *p, const char *constant, double value, const char *key,
                          double holds, const char *unit)
{
    struct law_state a = material_state(p, 0);
    struct number_text given;
    if (binding_given(p->b, a.block, constant) && fabs(holds - value) > 0.01 * fabs(value))
        findings_warn(p->b->findings, pair_check_place(p, key),
                      "'%s' of the interaction means %s = %.4g%s, in place of the %s = %s%s that '%s' gives",
                      key, constant, holds, unit, constant, number_text(value, &given), unit, a.name);
}

/* The stiffness of the pair between two states. 0 or NaN where the deck lacks the constants, which has a
 * finding of its own. */
static double find_stiffness(const struct pair_check *p, const struct material_config *a,
                             const struct material_config *b)
{
    if (p->law.potential == POTENTIAL_LENNARD_JONES && !isnan(p->law.epsilon))
        return lattice_atomic_stiffness(p->law.epsilon, p->law.sigma);
    return !isnan(p->law.k) ? p->law.k : lattice_stiffness(a, b, p->law.calibration);
}

/* Only links make a lattice, to which the constants of Hugoniot data and elasticity belong. */
static void check_replaced_constants(const struct pair_check *p)
{
    const struct material_config *m = material_state(p, 0).constants;
    if (p->materials[0] != p->materials[1] || p->relation != RELATION_SAME_GRAIN || !may_link(p))
        return;
    double kn = find_stiffness(p, m, m);
    if (!isnan(p->law.k) && isnan(p->law.epsilon))
        warn_replaced(p, "c0", m->c0, "k", lattice_sound_speed(kn, m->rho0, p->law.calibration), " cm/us");
    if (!isnan(p->law.shape) && p->law.potential == POTENTIAL_MORSE)
        warn_replaced(p, "s", m->s, "shape", lattice_slope(p->law.shape, p->law.calibration), "");
    if (p->law.kt_ratio > 0.0) /* 0 switches the springs off, whatever the material */
        warn_replaced(p, "shear", m->shear, "kt_ratio", lattice_shear_modulus(kn, p->law.kt_ratio * kn),
                      " Mbar");
}

/* --- shear moduli and strengths beyond the lattice --- */

/* -1: the lattice of these states is stiffer against shear by its central forces alone than G asks; 1: the
 * lattice cannot be as stiff; 0: the modulus holds. */
static int shear_beyond(const struct pair_check *p, const struct material_config *a,
                        const struct material_config *b, double *holds)
{
    double kn = find_stiffness(p, a, b), kt = lattice_shear_stiffness(a, b, kn);
    double g = lattice_mean(a->shear, b->shear);
    *holds = lattice_shear_modulus(kn, kt);
    if (!(g > 0.0) || !(kn > 0.0) || !isnan(p->law.kt_ratio))
        return 0;
    return g < *holds * (1.0 - 1e-9) ? -1 : g > *holds * (1.0 + 1e-9) ? 1 : 0;
}

/* Checks that the lattice of a material or phase can have the shear modulus. */
static void check_shear(const struct pair_check *p, struct law_state x)
{
    struct number_text given;
    double holds;
    int beyond = shear_beyond(p, x.constants, x.constants, &holds);
    const char *key = binding_given(p->b, x.block, "shear") ? "shear" : "c0";
    struct deck_place place = binding_place(p->b, x.block, key, 0);
    const char *bulk = p->law.calibration == CALIBRATION_BULK && isnan(p->law.k) && isnan(p->law.epsilon)
                           ? " (calibration = bulk)"
                           : "";
    if (beyond < 0)
        findings_warn(p->b->findings, place,
                      "the lattice of '%s' has a shear modulus of %.4g Mbar by its central forces alone%s: "
                      "'shear' = %s Mbar has no effect%s",
                      x.name, holds, bulk, number_text(x.constants->shear, &given),
                      isnan(x.constants->yield) ? "" : ", nor has 'yield'");
    else if (beyond > 0)
        findings_warn(p->b->findings, place,
                      "the lattice of '%s' can have a shear modulus of %.4g Mbar at most%s, which holds in "
                      "place of 'shear' = %s Mbar",
                      x.name, holds, bulk, number_text(x.constants->shear, &given));
}

/* Two materials whose own lattices hold their moduli hold the harmonic mean, too, unless the interaction of
 * the two has a stiffness or calibration of its own. */
static void check_shear_of_two(const struct pair_check *p)
{
    struct law_state a = material_state(p, 0), b = material_state(p, 1);
    struct pair_check own = *p;
    double holds, unused;
    int beyond = shear_beyond(p, a.constants, b.constants, &holds);
    for (int i = 0; i < 2; i++) {
        int m = p->materials[i];
        own.law = config_interaction(p->b->config, m, m, RELATION_SAME_GRAIN);
        const struct material_config *x = &p->b->config->materials[m];
        if (shear_beyond(&own, x, x, &unused) != 0)
            return;
    }
    if (beyond != 0)
        findings_warn(p->b->findings, pair_check_place(p, isnan(p->law.k) ? "calibration" : "k"),
                      "the lattice of '%s' with '%s' has a shear modulus of %.4g Mbar %s, in place of %.4g "
                      "Mbar, the harmonic mean of their 'shear'",
                      a.name, b.name, holds, beyond < 0 ? "by its central forces alone" : "at most",
                      lattice_mean(a.constants->shear, b.constants->shear));
}

/* Checks that a Morse potential can have the slope of the Hugoniot: its shape is above 0. */
static void check_slope(const struct pair_check *p, struct law_state a, struct law_state b)
{
    struct law_state flat = b.constants->s < a.constants->s ? b : a;
    struct number_text given;
    if (p->law.potential != POTENTIAL_MORSE || !isnan(p->law.shape) ||
        !(lattice_shape(a.constants, b.constants, p->law.calibration) <= 0.0))
        return;
    findings_error(
        p->b->findings, binding_place(p->b, flat.block, "s", 0),
        "'s' = %s of '%s' is too small for the Morse potential of '%s' and '%s': with 'calibration "
        "= bulk' their mean must be above 3/8; give 'shape' in the interaction, or take uniaxial",
        number_text(flat.constants->s, &given), flat.name, a.name, b.name);
}

/* Checks that the potential between two states can pull as hard as the tensile strength asks. */
static void check_strength(const struct pair_check *p, struct law_state a, struct law_state b)
{
    bool given = pair_check_given(p, "tensile");
    struct law_state weaker =
        isnan(a.constants->tensile) || b.constants->tensile < a.constants->tensile ? b : a;
    double tensile = given ? p->law.tensile : weaker.constants->tensile;
    double shape =
        isnan(p->law.shape) ? lattice_shape(a.constants, b.constants, p->law.calibration) : p->law.shape;
    double strength = lattice_strength_to(p->law.potential, find_stiffness(p, a.constants, b.constants),
                                          shape, p->law.link_break);
    struct number_text want;
    if (!(strength > 0.0) || !(tensile >= strength))
        return;
    findings_warn(p->b->findings,
                  given ? pair_check_place(p, "tensile") : binding_place(p->b, weaker.block, "tensile", 0),
                  "'tensile' = %s Mbar is not below %.4g Mbar, the strongest pull of the potential between "
                  "'%s' and '%s' up to link_break = %.4g: their bonds do not flow, they only break there",
                  number_text(tensile, &want), strength, a.name, b.name, p->law.link_break);
}

/* Checks those phases of a material that give a constant which decides. */
static void check_phases(const struct pair_check *p)
{
    const struct config *c = p->b->config;
    for (size_t i = 0; i < c->n_phases; i++) {
        struct kind_name name;
        struct law_state x = {&c->phases[i].state, p->b->blocks[BLOCK_PHASE][i],
                              config_kind_name(c, c->n_materials + i, &name)};
        bool stiffness = binding_given(p->b, x.block, "c0") || binding_given(p->b, x.block, "rho0");
        if (c->phases[i].material != p->materials[0])
            continue;
        if (binding_given(p->b, x.block, "s"))
            check_slope(p, x, x);
        if (stiffness || binding_given(p->b, x.block, "shear"))
            check_shear(p, x);
        if (p->law.scope == SCOPE_LINKED &&
            (stiffness || binding_given(p->b, x.block, "s") || binding_given(p->b, x.block, "tensile")))
            check_strength(p, x, x);
    }
}

void check_law(const struct pair_check *p)
{
    struct law_state a = material_state(p, 0), b = material_state(p, 1);
    check_scope(p);
    check_replaced(p);
    check_replaced_constants(p);
    check_slope(p, a, b);
    if (!may_link(p))
        return;
    if (p->law.scope == SCOPE_LINKED)
        check_strength(p, a, b);
    if (p->materials[0] == p->materials[1]) {
        check_shear(p, a);
        check_phases(p);
    } else {
        check_shear_of_two(p);
    }
}
