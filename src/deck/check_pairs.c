/* Checks of materials, and of the interactions of those pairs of materials that can meet in one body or in
 * two. Each finding is at the block that decides the keyword in question. A finding that several pairs share
 * appears once, because equal findings at one place are one finding. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "check.h"
#include "check_laws.h"

static void check_material(const struct deck_binding *b, size_t i)
{
    const struct material_config *m = &b->config->materials[i];
    size_t block = b->blocks[BLOCK_MATERIAL][i];
    struct number_text t0, tm;
    if (binding_missing(b, block, "rho0") && binding_missing(b, block, "mass"))
        findings_error(b->findings, binding_place(b, block, "rho0", 0),
                       "the material '%s' lacks 'rho0' (density) or 'mass' (of one element)", m->name);
    if (binding_given(b, block, "rho0") && binding_given(b, block, "mass"))
        findings_error(b->findings, binding_place(b, block, "mass", 0), "give 'rho0' or 'mass', not both");
    if (m->t0 >= m->tm)
        findings_error(b->findings, binding_place(b, block, "tm", 0),
                       "'tm' = %s K must be above the reference temperature 't0' = %s K",
                       number_text(m->tm, &tm), number_text(m->t0, &t0));
    if (m->kappa > 0 && binding_missing(b, block, "cp"))
        findings_warn(b->findings, binding_place(b, block, "kappa", 0),
                      "without 'cp' temperatures stay as they are, so that nothing is conducted");
}

static int key_index(const char *key)
{
    return schema_find_key(schema_block(BLOCK_INTERACTION), key, strlen(key));
}

/* The block that decides this keyword for the pair; tree->n_blocks: none, the default holds. */
static size_t deciding_block(const struct pair_check *p, const char *key)
{
    int rule =
        interaction_rule_of(p->b->config, p->materials[0], p->materials[1], p->relation, key_index(key));
    return rule < 0 ? p->b->tree->n_blocks : p->b->blocks[BLOCK_INTERACTION][rule];
}

bool pair_check_given(const struct pair_check *p, const char *key)
{
    return deciding_block(p, key) < p->b->tree->n_blocks;
}

struct deck_place pair_check_place(const struct pair_check *p, const char *key)
{
    return binding_place(p->b, deciding_block(p, key), key, 0);
}

static const char *potential_name(enum potential_kind potential)
{
    return potential == POTENTIAL_QUADRATIC ? "quadratic"
           : potential == POTENTIAL_MORSE   ? "morse"
                                            : "lennard-jones";
}

bool pair_check_given_for(const struct pair_check *p, const char *key, const char *chooser)
{
    const struct config *c = p->b->config;
    int m = p->materials[0], n = p->materials[1];
    int rule = interaction_rule_of(c, m, n, p->relation, key_index(key));
    int chosen = interaction_rule_of(c, m, n, p->relation, key_index(chooser));
    if (rule < 0 || chosen < 0)
        return rule >= 0;
    return interaction_rule_rank(&c->rules[rule], m, n, p->relation) >=
           interaction_rule_rank(&c->rules[chosen], m, n, p->relation);
}

static void warn_meaningless(const struct pair_check *p, const char *key)
{
    if (pair_check_given_for(p, key, "potential"))
        findings_warn(p->b->findings, pair_check_place(p, key), "'%s' has no meaning for the potential %s",
                      key, potential_name(p->law.potential));
}

/* Checks for keywords of another potential, and for Hugoniot data that the potential cannot follow. */
static void check_potential(const struct pair_check *p)
{
    bool lj = p->law.potential == POTENTIAL_LENNARD_JONES, morse = p->law.potential == POTENTIAL_MORSE;
    if (!morse)
        warn_meaningless(p, "shape");
    if (!lj) {
        warn_meaningless(p, "epsilon");
        warn_meaningless(p, "sigma");
    } else if (pair_check_given(p, "epsilon") != pair_check_given(p, "sigma")) {
        findings_error(
            p->b->findings, pair_check_place(p, pair_check_given(p, "epsilon") ? "epsilon" : "sigma"),
            "'epsilon' and 'sigma' go together, or neither is given and both follow from the stiffness");
    }
    for (int i = 0; i < 2 && !morse; i++)
        if (binding_given(p->b, p->b->blocks[BLOCK_MATERIAL][p->materials[i]], "s") &&
            !pair_check_given(p, "epsilon"))
            findings_warn(
                p->b->findings, pair_check_place(p, "potential"),
                "the potential %s has s = %s built in: only rho0 c0^2 of '%s' can be fitted, not its s",
                potential_name(p->law.potential), lj ? "3" : "0.375",
                p->b->config->materials[p->materials[i]].name);
}

/* Checks that the pair has a stiffness and, with the Morse potential, a shape. */
static void check_calibration(const struct pair_check *p)
{
    static const char *const needed[] = {"rho0", "c0", "s"};
    bool stiffness = !pair_check_given(p, "k") &&
                     !(p->law.potential == POTENTIAL_LENNARD_JONES && pair_check_given(p, "epsilon"));
    bool shape = p->law.potential == POTENTIAL_MORSE && !pair_check_given(p, "shape");
    for (int i = 0; i < 2; i++) {
        size_t block = p->b->blocks[BLOCK_MATERIAL][p->materials[i]];
        const char *name = p->b->config->materials[p->materials[i]].name;
        /* A material with neither rho0 nor mass has a finding of check_material. */
        bool massive = binding_given(p->b, block, "mass");
        for (int k = 0; k < 3; k++) {
            if (!(k < 2 ? stiffness : shape) || !binding_missing(p->b, block, needed[k]) ||
                (k == 0 && !massive))
                continue;
            findings_error(
                p->b->findings, binding_place(p->b, block, "", 0),
                k < 2 ? "the material '%s' lacks '%s', from which the stiffness of its pairs follows; "
                        "or give 'k', or 'epsilon' and 'sigma' of lennard-jones, in the interaction"
                      : "the material '%s' lacks '%s', from which the potential's shape follows; or give "
                        "'shape' in the interaction",
                name, needed[k]);
        }
    }
}

/* Checks that a pair with a yield stress has a shear stiffness. */
static void check_yield(const struct pair_check *p)
{
    int m = p->materials[0];
    size_t block = p->b->blocks[BLOCK_MATERIAL][m];
    if (p->materials[1] == m && !pair_check_given(p, "kt_ratio") && p->b->config->materials[m].yield > 0 &&
        binding_given(p->b, block, "yield") && binding_missing(p->b, block, "shear"))
        findings_warn(
            p->b->findings, binding_place(p->b, block, "yield", 0),
            "'yield' bounds the shear stiffness, and without 'shear' (or 'kt_ratio' in the interaction) '%s' "
            "has none",
            p->b->config->materials[m].name);
}

static void check_ranges(const struct pair_check *p)
{
    const struct config *c = p->b->config;
    double reach = p->law.link_break * config_contact_distance(c);
    struct number_text a, b;
    if (p->law.scope == SCOPE_ALL && p->law.cutoff > c->r_c)
        findings_error(p->b->findings, pair_check_place(p, "cutoff"),
                       "'cutoff' = %s cm is beyond r_c = %s cm, up to which pairs are found",
                       number_text(p->law.cutoff, &a), number_text(c->r_c, &b));
    if ((p->law.linked || p->law.link_form > 0) && c->r_c < reach && c->r_c >= config_contact_distance(c))
        findings_error(p->b->findings, binding_place(p->b, p->b->single[BLOCK_DOMAIN], "r_c", 0),
                       "r_c = %s cm is below %g cm, to where links stretch before they break at link_break",
                       number_text(c->r_c, &a), reach);
}

static void check_pair(const struct deck_binding *b, int m, int n, enum relation relation)
{
    struct pair_check p = {b, {m, n}, relation, config_interaction(b->config, m, n, relation)};
    for (size_t i = 0; i < b->config->n_rules; i++)
        if (interaction_rule_rank(&b->config->rules[i], m, n, relation) >= 0 && b->config->rules[i].bad != 0)
            return;
    check_potential(&p);
    check_calibration(&p);
    check_ranges(&p);
    check_yield(&p);
    check_law(&p);
}

struct usage {
    unsigned char together[MATERIAL_MAX][MATERIAL_MAX]; /* two materials occur together in a body */
    unsigned char grains[MATERIAL_MAX][MATERIAL_MAX];   /* the same in a body of several grains */
    size_t bodies[MATERIAL_MAX];                        /* the number of bodies that have the material */
    size_t last[MATERIAL_MAX];                          /* the last of these bodies */
};

/* The materials of a body's elements, the product of a reaction included. Returns their number. */
static size_t list_materials(const struct config *c, const struct body_config *body, size_t list[MIX_MAX + 1])
{
    size_t n = body->n_mix;
    bool product = false;
    for (size_t x = 0; x < n; x++) {
        list[x] = (size_t)body->mix_material[x];
        for (int a = 0; a < 2 && c->n_reactions > 0; a++)
            product |= c->reactions[0].reactant[a] == body->mix_material[x] && c->reactions[0].product >= 0;
    }
    for (size_t x = 0; x < n && product; x++)
        product = list[x] != (size_t)c->reactions[0].product;
    if (product)
        list[n++] = (size_t)c->reactions[0].product;
    return n;
}

static void count_usage(const struct config *c, struct usage *u)
{
    for (size_t i = 0; i < c->n_bodies; i++) {
        size_t list[MIX_MAX + 1], n = list_materials(c, &c->bodies[i], list);
        for (size_t x = 0; x < n; x++) {
            u->bodies[list[x]]++;
            u->last[list[x]] = i;
            for (size_t y = 0; y < n; y++) {
                u->together[list[x]][list[y]] = 1;
                u->grains[list[x]][list[y]] |= c->bodies[i].structure != STRUCTURE_CRYSTAL;
            }
        }
    }
}

/* True if an element of material m in one body can meet an element of material n in another. */
static bool meet_across_bodies(const struct usage *u, size_t m, size_t n)
{
    if (u->bodies[m] == 0 || u->bodies[n] == 0)
        return false;
    return u->bodies[m] > 1 || u->bodies[n] > 1 || u->last[m] != u->last[n];
}

void check_materials(const struct deck_binding *b)
{
    struct usage *u = mem_zalloc(1, sizeof *u); /* 70 kB, too much for a small stack */
    if (u == NULL) {
        b->findings->no_memory = true;
        return;
    }
    count_usage(b->config, u);
    for (size_t m = 0; m < b->config->n_materials; m++) {
        check_material(b, m);
        for (size_t n = 0; n <= m && !b->findings->more_errors; n++) {
            if (u->together[m][n])
                check_pair(b, (int)n, (int)m, RELATION_SAME_GRAIN);
            if (u->grains[m][n])
                check_pair(b, (int)n, (int)m, RELATION_OTHER_GRAIN);
            if (meet_across_bodies(u, m, n))
                check_pair(b, (int)n, (int)m, RELATION_OTHER_BODY);
        }
    }
    free(u);
}
