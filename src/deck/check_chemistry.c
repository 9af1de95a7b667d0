/* Checks of phases and of the reaction: constants that are missing, and constants with which a phase would
 * form at the first step or go back as soon as it forms. A value that did not read is NaN, and every
 * comparison is written to be false for NaN. */
#include <math.h>

#include "check.h"

static void warn_meaningless(const struct deck_binding *b, size_t block, const char *key, const char *where)
{
    if (binding_given(b, block, key))
        findings_warn(b->findings, binding_place(b, block, key, 0), "'%s' has no meaning for %s", key, where);
}

static const struct material_config *parent_state(const struct config *c, const struct phase_config *phase)
{
    return phase->from < 0 ? &c->materials[phase->material] : &c->phases[phase->from].state;
}

/* The latent heat lowers the temperature by latent/cp. The hysteresis must be larger, because the phase would
 * go back at once otherwise. */
static void check_hysteresis(const struct deck_binding *b, size_t i)
{
    const struct phase_config *phase = &b->config->phases[i];
    const struct material_config *from = parent_state(b->config, phase);
    struct number_text got, want;
    double cp = phase->state.cp < from->cp ? phase->state.cp : from->cp;
    double drop = phase->latent / cp, ratio = from->rho0 / phase->state.rho0;
    struct deck_place place = binding_place(b, b->blocks[BLOCK_PHASE][i], "hysteresis_t", 0);
    if (phase->reversible && phase->transition == TRANSITION_TEMPERATURE && phase->hysteresis_t <= drop &&
        drop > 0)
        findings_error(b->findings, place,
                       "hysteresis_t = %s K is not above latent/cp = %s K, by which the temperature falls "
                       "when '%s' forms: it "
                       "would go back at once",
                       number_text(phase->hysteresis_t, &got), number_text(drop, &want), phase->name);
    double back = isnan(phase->hysteresis_t) ? 1.1 * drop : phase->hysteresis_t;
    if (phase->reversible && phase->transition == TRANSITION_TEMPERATURE && back >= phase->t_line &&
        drop <= phase->t_line && phase->dt_dp == 0) /* a larger drop is check_latent's */
        findings_warn(
            b->findings, place,
            "'%s' would go back %.4g K below its line, which is at %s K: no temperature is below 0 K, "
            "so that the phase stays",
            phase->name, back, number_text(phase->t_line, &want));
    double relief = from->rho0 * (from->c0 * from->c0) * (1.0 - ratio);
    if (phase->reversible && phase->transition == TRANSITION_PRESSURE && phase->hysteresis_p < 0.5 * relief)
        findings_warn(b->findings, binding_place(b, b->blocks[BLOCK_PHASE][i], "hysteresis_p", 0),
                      "hysteresis_p = %s Mbar is small against the pressure that the smaller volume of '%s' "
                      "relieves, about %s "
                      "Mbar: elements may go to and fro",
                      number_text(phase->hysteresis_p, &got), phase->name, number_text(relief, &want));
}

/* What a change of phase takes up comes out of the heat cp t_line that the material holds at t_line above 0
 * K. A reversible transition by temperature whose latent heat is negative takes up heat when it goes back. */
static void check_latent(const struct deck_binding *b, size_t i)
{
    const struct phase_config *phase = &b->config->phases[i];
    const struct material_config *from = parent_state(b->config, phase);
    bool back = phase->latent < 0 && phase->reversible && phase->transition == TRANSITION_TEMPERATURE;
    double cp = phase->state.cp < from->cp ? phase->state.cp : from->cp;
    double taken = back ? -phase->latent : phase->latent, held = cp * phase->t_line;
    struct number_text got, want, line, drop;
    if (taken > held)
        findings_error(b->findings, binding_place(b, b->blocks[BLOCK_PHASE][i], "latent", 0),
                       "the latent heat of '%s' is %s cm2/us2, and at t_line = %s K its material holds "
                       "cp t_line = %s cm2/us2: the temperature would fall by latent/cp = %s K, below 0 K; "
                       "give less latent heat or a larger cp",
                       phase->name, number_text(taken, &got), number_text(phase->t_line, &line),
                       number_text(held, &want), number_text(taken / cp, &drop));
}

/* A reaction that takes up heat cools its elements, by |heat|/cp once all is product. */
static void warn_cooling(const struct deck_binding *b, size_t i)
{
    const struct config *c = b->config;
    const struct reaction_config *r = &c->reactions[i];
    double coldest = HUGE_VAL, drop = -r->heat / c->materials[r->product].cp;
    struct number_text want;
    for (size_t k = 0; k < c->n_bodies; k++)
        for (size_t m = 0; m < c->bodies[k].n_mix; m++)
            if (c->bodies[k].mix_material[m] == r->reactant[0] ||
                c->bodies[k].mix_material[m] == r->reactant[1])
                coldest = fmin(coldest, c->bodies[k].temperature);
    if (drop > coldest)
        findings_warn(
            b->findings, binding_place(b, b->blocks[BLOCK_REACTION][i], "heat", 0),
            "the reaction '%s' takes up heat that lowers the temperature by |heat|/cp = %.4g K, and its "
            "reactants start at %s K: temperatures may fall below 0 K",
            r->name, drop, number_text(coldest, &want));
}

/* A body that lies beyond the line at zero pressure would change its phase at the first step. */
static void check_initial_phase(const struct deck_binding *b, size_t i)
{
    const struct phase_config *phase = &b->config->phases[i];
    struct number_text t;
    for (size_t k = 0; k < b->config->n_bodies && phase->from < 0; k++) {
        const struct body_config *body = &b->config->bodies[k];
        double above = phase->transition == TRANSITION_PRESSURE
                           ? -(phase->p_line + phase->dp_dt * (body->temperature - phase->t_line))
                           : body->temperature - (phase->t_line - phase->dt_dp * phase->p_line);
        for (size_t m = 0; m < body->n_mix; m++)
            if (body->mix_material[m] == phase->material && above > 0)
                findings_error(b->findings, binding_place(b, b->blocks[BLOCK_BODY][k], "temperature", 0),
                               "the body '%s' starts at %s K and without pressure, where its material '%s' "
                               "is already the "
                               "phase '%s'",
                               body->name, number_text(body->temperature, &t),
                               b->config->materials[phase->material].name, phase->name);
    }
}

static void check_phase(const struct deck_binding *b, size_t i)
{
    const struct phase_config *phase = &b->config->phases[i];
    const struct material_config *from = parent_state(b->config, phase);
    size_t block = b->blocks[BLOCK_PHASE][i], parent = b->blocks[BLOCK_MATERIAL][phase->material];
    bool by_pressure = phase->transition == TRANSITION_PRESSURE;
    if (!binding_given(b, block, "transition"))
        return;
    warn_meaningless(b, block, by_pressure ? "dt_dp" : "dp_dt",
                     by_pressure ? "a transition by pressure" : "a transition by temperature");
    warn_meaningless(b, block, by_pressure ? "hysteresis_t" : "hysteresis_p",
                     by_pressure ? "a transition by pressure" : "a transition by temperature");
    if (binding_given(b, block, "rho0") && binding_given(b, parent, "mass"))
        findings_error(
            b->findings, binding_place(b, block, "rho0", 0),
            "the material '%s' gives 'mass', not 'rho0', so that the volume of its phase '%s' is not known",
            from->name, phase->name);
    bool lacks = binding_missing(b, parent, "cp") && isnan(from->cp);
    if (lacks && (phase->latent != 0 || !by_pressure || phase->dp_dt != 0 || binding_given(b, block, "cp")))
        findings_error(
            b->findings, binding_place(b, block, "transition", 0),
            "the material '%s' lacks 'cp': without it temperatures stay, and the phase '%s' needs them",
            from->name, phase->name);
    check_hysteresis(b, i);
    check_latent(b, i);
    check_initial_phase(b, i);
}

static void check_reaction(const struct deck_binding *b, size_t i)
{
    const struct config *c = b->config;
    const struct reaction_config *r = &c->reactions[i];
    size_t block = b->blocks[BLOCK_REACTION][i];
    struct number_text first, other;
    const int material[3] = {r->reactant[0], r->reactant[1], r->product};
    if (r->kind == REACTION_STOICHIOMETRIC && binding_missing(b, block, "masses"))
        findings_error(b->findings, binding_place(b, block, "masses", 0),
                       "the reaction '%s' lacks 'masses': how much of each reactant goes into the product",
                       r->name);
    if (r->kind != REACTION_STOICHIOMETRIC)
        warn_meaningless(b, block, "masses", "a non-stoichiometric reaction");
    for (int a = 0; a < 3; a++)
        if (material[a] < 0)
            return;
    if (material[0] == material[1] || material[0] == material[2] || material[1] == material[2])
        findings_error(b->findings, binding_place(b, block, "product", 0),
                       "reactants and product of the reaction '%s' must be three materials", r->name);
    for (int a = 0; a < 3; a++) {
        const struct material_config *m = &c->materials[material[a]];
        const char *key = a < 2 ? "reactants" : "product";
        if (binding_missing(b, b->blocks[BLOCK_MATERIAL][material[a]], "cp"))
            findings_error(b->findings, binding_place(b, block, key, a < 2 ? (size_t)a : 0),
                           "the material '%s' lacks 'cp', which its reaction needs", m->name);
        if (m->t0 < c->materials[material[0]].t0 || m->t0 > c->materials[material[0]].t0)
            findings_error(
                b->findings, binding_place(b, block, key, a < 2 ? (size_t)a : 0),
                "t0 of '%s' is %s K, of '%s' %s K: materials that react with each other need the same",
                m->name, number_text(m->t0, &other), c->materials[material[0]].name,
                number_text(c->materials[material[0]].t0, &first));
    }
    warn_cooling(b, i);
}

/* Warns of `softening` in a block of this material where neither the block's own state nor a phase, which may
 * take the keyword over, has a melting temperature. */
static void warn_softening(const struct deck_binding *b, int material, size_t block, double tm)
{
    const struct config *c = b->config;
    for (size_t i = 0; i < c->n_phases; i++)
        tm = c->phases[i].material == material && isnan(tm) ? c->phases[i].state.tm : tm;
    if (binding_given(b, block, "softening") && isnan(tm))
        findings_warn(
            b->findings, binding_place(b, block, "softening", 0),
            "'softening' has no meaning without 'tm', the temperature at which the strength of '%s' ends",
            c->materials[material].name);
}

void check_chemistry(const struct deck_binding *b)
{
    for (size_t i = 0; i < b->config->n_materials; i++)
        warn_softening(b, (int)i, b->blocks[BLOCK_MATERIAL][i], b->config->materials[i].tm);
    for (size_t i = 0; i < b->config->n_phases; i++)
        warn_softening(b, b->config->phases[i].material, b->blocks[BLOCK_PHASE][i],
                       b->config->phases[i].state.tm);
    for (size_t i = 0; i < b->config->n_phases; i++)
        check_phase(b, i);
    for (size_t i = 0; i < b->config->n_reactions; i++)
        check_reaction(b, i);
}
