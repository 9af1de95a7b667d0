/* For tests of heat, phases and the reaction: energies as doubles, refused decks, and the same bits on any
 * number of ranks. */
#ifndef DM2_TESTS_THERMO_HELP_H
#define DM2_TESTS_THERMO_HELP_H

#include "engine_help.h"

/* Nickel, aluminium and their product. */
#define THERMO_METALS                                                                                        \
    "material Ni { rho0 = 8.874; c0 = 0.4602; s = 1.437; shear = 0.855; yield = 0.0014; tensile = 0.02; cp " \
    "= 4.4e-6; kappa = 9e-12 }\n"                                                                            \
    "material Al { rho0 = 2.703; c0 = 0.535; s = 1.34; shear = 0.276; yield = 0.0029; tensile = 0.012; cp "  \
    "= 8.97e-6; kappa = 2e-11 }\n"                                                                           \
    "material NiAl { rho0 = 5.86; c0 = 0.519; s = 1.5; shear = 0.75; yield = 0.003; tensile = 0.01; cp = "   \
    "5.4e-6; kappa = 8e-12 }\n"

/* Frame and specimen of a deck with a phase or a reaction that is refused. */
#define THERMO_FRAME                                                                                         \
    THERMO_METALS "domain { size = 1, 1; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 1 }\n"
#define THERMO_SPECIMEN "body a { shape = rectangle 0, 0, 0.2, 0.2; spacing = 0.04; material = Al }\n"

/* An energy of struct measures, g cm2/us2. */
static inline double thermo_energy(const struct engine *g, const struct exact_sum *sum)
{
    return exact_value(sum, model_scales(g->model).energy);
}

/* Takes one step that measures. */
static inline struct measures thermo_step(struct engine *g)
{
    struct measures m;
    engine_step(g, &m);
    return m;
}

static inline void thermo_check_refused(const char *text, const char *part)
{
    struct loaded l = load_text(text, NULL, -1);
    struct model *m = NULL;
    struct dm2_error err = {0};
    enum dm2_status status = l.status == DM2_OK ? model_build(&l.config, &m, &err) : l.status;
    CHECK_EQ_INT(status, DM2_DECK);
    CHECK_CONTAINS(l.status == DM2_OK ? err.text : l.report.text, part);
    model_free(m);
    loaded_free(&l);
}

/* 250 steps of the deck give the same bits on each number of ranks. */
static inline void thermo_check_ranks(const char *deck, const char *what, const int *ranks, size_t n_ranks)
{
    struct engine_state want = {0};
    for (size_t k = 0; k < n_ranks; k++) {
        struct engine g;
        struct measures m;
        engine_start(&g, deck, NULL, ranks[k]);
        engine_run(&g, 250);
        engine_step(&g, &m);
        CHECK(8 * subdomain_update_width(g.model) <= 88); /* g of the paper */
        struct engine_state s = engine_collect(&g, false);
        if (k == 0) {
            size_t changed = 0;
            for (size_t i = 0; i < s.n; i++)
                changed += s.e[i].moved < 0.0 || s.e[i].moved > 0.0;
            CHECK(changed > 10);
            want = s;
        } else {
            engine_check_same(&s, &want, what);
            engine_state_free(&s);
        }
        engine_stop(&g);
    }
    engine_state_free(&want);
}

/* Takes two steps and stops the engine: the chemical energy that the first step freed, g cm2/us2. */
static inline double thermo_freed(struct engine *g)
{
    struct measures m = thermo_step(g);
    double before = thermo_energy(g, &m.chemical);
    m = thermo_step(g);
    double after = thermo_energy(g, &m.chemical);
    engine_stop(g);
    return before - after;
}

#endif
