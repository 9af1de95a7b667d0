/* Changes of kind beside walls, by a phase and by the reaction: the energy book closes as the square of the
 * time step, the same bits on any number of ranks. */
#include <math.h>

#include "thermo_help.h"

/* Discs fall on a moving corner, roll and rub there, turn into a stiffer, denser phase at depth, and back. */
#define CORNER                                                                                               \
    "let dt = 0.005\nlet mu = 0.4\nlet d = 0.04\nlet apart = 1.3\n"                                          \
    "domain { size = 1.4, 1.4; r_c = 0.06; delta_r = 0.01 }\ntime { dt = dt; steps = 1000 }\n"               \
    "material Ni { rho0 = 8.874; c0 = 0.4602; s = 1.437; shear = 0.855; cp = 4.4e-6 }\n"                     \
    "material steel { rho0 = 7.8; c0 = 0.45; s = 1.5; shear = 0.8 }\n"                                       \
    "phase Ni high { transition = pressure; p_line = 0.03; t_line = 300; hysteresis_p = 0.028; rho0 = "      \
    "9.3\n"                                                                                                  \
    "                c0 = 0.55; shear = 1.2; latent = 1e-5 }\n"                                              \
    "interaction { linked = no; mu = mu }\n"                                                                 \
    "body a { shape = rectangle 0.15, 0.51, 0.93, 0.66; origin = 0.15, 0.512; spacing = apart*d; radius = "  \
    "d/2; material = Ni\n"                                                                                   \
    "         velocity = 0.02, -0.03; jitter = 0.002; seed = 4; spin = 0.02 }\n"

static const char corner[] = CORNER
    "wall floor { line = 0.1 0.48 0.4 0.49 0.9 0.48 0.95 0.6; material = steel; velocity = 0.003 0.002 }\n"
    "wall side { line = 0.6 0.49 1.3 0.49; rigid = yes; spin = 0.002 }\n";

/* Discs of nickel and aluminium between two walls that press them; a pair that has reacted is the alloy. */
static const char pressed[] = THERMO_METALS
    "let dt = 0.005\nlet mu = 0.3\nlet apart = 1\n"
    "domain { size = 1, 1; r_c = 0.06; delta_r = 0.01 }\ntime { dt = dt; steps = 1000 }\n"
    "interaction { linked = no; mu = mu }\n"
    "reaction r { reactants = Ni Al; product = NiAl; masses = 8.874, 2.703; k0 = 400; ea = 10 kJ/mol\n"
    "             heat = 0.1 kJ/g; threshold = 0.7 }\n"
    "body a { shape = rectangle 0.2, 0.2, 0.7, 0.27; spacing = 0.04*apart; mix = Ni 0.5, Al 0.5\n"
    "         origin = 0.21 0.22; jitter = 0.002; seed = 7 }\n"
    "wall low { line = 0.1 0.2005 0.5 0.2005 0.9 0.2005; material = Al }\n"
    "wall high { line = 0.1 0.274 0.9 0.274; rigid = yes; velocity = 0.001 -0.003 }\n";

/* Takes so many steps; returns the largest change of the total, and in *moved the most that the
 * account of changes has held, *changed: how many elements have such an account. */
static double run(const char *deck, const char *const *defines, int steps, double *moved, size_t *changed)
{
    struct engine g;
    engine_start(&g, deck, defines, 1);
    struct measures m = thermo_step(&g);
    double start = engine_total(&g, &m), held = thermo_energy(&g, &m.phase), worst = 0.0;
    *moved = 0.0;
    *changed = 0;
    for (int n = 0; n < steps; n++) {
        m = thermo_step(&g);
        worst = fmax(worst, fabs(engine_total(&g, &m) - start));
        *moved = fmax(*moved, fabs(thermo_energy(&g, &m.phase) - held));
    }
    struct engine_state s = engine_collect(&g, false);
    for (size_t i = 0; i < s.n; i++)
        *changed += s.e[i].moved > 0.0 || s.e[i].moved < 0.0;
    engine_state_free(&s);
    engine_stop(&g);
    return worst;
}

/* The book over the account is off by at most `rubbed` with friction, whose springs begin anywhere in a step,
 * and by `slid` without, and then by less than 0.4 of this in half of the step. */
static void check_book(const char *deck, const char *apart, double rubbed, double slid)
{
    for (int k = 0; k < 3; k++) {
        const char *const defines[] = {k < 2 ? "dt=0.0025" : "dt=0.00125", k == 0 ? "mu=0.4" : "mu=0", apart,
                                       NULL};
        double moved, bound = k == 0 ? rubbed : k == 1 ? slid : 0.4 * slid;
        size_t changed;
        double off = run(deck, defines, k < 2 ? 600 : 1200, &moved, &changed);
        printf("%zu elements, account %.3g, book off by %.3g of this\n", changed, moved, off / moved);
        CHECK(changed > 5);
        CHECK(off < bound * moved);
    }
}

TEST(phases_beside_walls_keep_the_book)
{
    check_book(corner, "apart=3", 0.003, 0.001);
}

TEST(a_reaction_beside_walls_keeps_the_book)
{
    check_book(pressed, "apart=1", 0.02, 0.01);
}

TEST(any_number_of_ranks_gives_the_same_bits)
{
    const int ranks[] = {1, 2, 3, 5};
    thermo_check_ranks(corner, "phases beside walls", ranks, 4);
    thermo_check_ranks(pressed, "a reaction beside walls", ranks, 4);
}

TEST_MAIN(CASE(phases_beside_walls_keep_the_book), CASE(a_reaction_beside_walls_keeps_the_book),
          CASE(any_number_of_ranks_gives_the_same_bits))
