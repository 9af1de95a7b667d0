/* The lattice's response to the materials' constants: speeds of longitudinal and shear waves along both
 * directions of the lattice, the free surface of a symmetric impact, and convergence of the energy of an
 * undamped lattice. */
#include "engine_help.h"

#include "engine/tables.h"

#define METALS                                                                                               \
    "material Ni { rho0 = 8.874; c0 = 0.4602; s = 1.437; shear = 0.855 }\n"                                  \
    "material Al { rho0 = 2.703; c0 = 0.5350; s = 1.340; shear = 0.276 }\n"                                  \
    "material Cu { rho0 = 8.930; c0 = 0.3940; s = 1.489; shear = 0.477 }\n"

/* A sheet, periodic both ways: columns x rows elements. */
static const char sheet_deck[] =
    "let columns = 60; let rows = 6; let d = 0.04; let half = d/2\n"
    "let width = columns*d; let height = rows*sqrt(3)*half\n"
    "domain { size = width height; boundary = periodic periodic; r_c = 1.1*d; delta_r = 0.1*d }\n"
    "time { dt = 0.02; steps = 1 }\n" METALS "interaction { potential = morse; %s }\n"
    "body sheet { shape = rectangle 0 0 width height; spacing = d; origin = half/2 sqrt(3)*half/2; material "
    "= %s }\n";

static void sheet_text(char *text, size_t size, const char *metal, const char *more)
{
    snprintf(text, size, sheet_deck, more, metal);
}

static const double pi = 3.14159265358979323846;

/* Speed of the standing wave of one wavelength along axis `along`, with motion along axis `motion`. */
static double wave_speed(const char *metal, int along, int motion, double *expected)
{
    struct engine g;
    char text[2000];
    const char *lying[] = {"columns=60", "rows=6", NULL}, *upright[] = {"columns=6", "rows=70", NULL};
    sheet_text(text, sizeof text, metal, "zeta = 0");
    engine_start(&g, text, along == 0 ? lying : upright, 1);
    struct engine_state s = engine_collect(&g, false);
    const struct grid *grid = &g.parts.grid;
    double k = 2.0 * pi / grid->size[along], amplitude = 1e-6, dt = g.deck.config.dt;
    for (size_t i = 0; i < s.n; i++)
        s.e[i].v[motion] = amplitude * sin(k * s.e[i].r[along]);
    engine_restore(&g, 0, &s);
    const struct pair_law *law = model_law(g.model, s.e[0].kind, s.e[0].kind, RELATION_SAME_GRAIN);
    double c11 = sqrt(3.0) / 4.0 * (3.0 * law->k + law->kt_link),
           c66 = sqrt(3.0) / 4.0 * (law->k + law->kt_link);
    double rho = g.deck.config.materials[s.e[0].kind].rho0;
    *expected = sqrt((along == motion ? c11 : c66) / rho);
    engine_state_free(&s);
    /* The mode's velocity at half steps changes sign at 1/4, 3/4 and 5/4 of the period. */
    double before = 1.0, t = 0.0;
    for (int64_t step = 0, crossings = 0; crossings < 3; step++) {
        double mode = 0.0;
        engine_step(&g, NULL);
        s = engine_collect(&g, false);
        for (size_t i = 0; i < s.n; i++)
            mode += s.e[i].v[motion] * sin(k * s.e[i].r[along]);
        engine_state_free(&s);
        t = ((double)step + 0.5) * dt; /* time of this velocity */
        if ((mode < 0.0) != (before < 0.0)) {
            crossings++;
            t -= dt * mode / (mode - before);
        }
        before = mode;
    }
    double omega = 2.5 * pi / t;
    engine_stop(&g);
    return omega / k;
}

TEST(waves_travel_at_the_lattice_constants_speeds)
{
    static const char *const metals[] = {"Ni", "Al", "Cu"};
    for (int m = 0; m < 3; m++) {
        for (int along = 0; along < 2; along++) {
            for (int motion = 0; motion < 2; motion++) {
                double expected, speed = wave_speed(metals[m], along, motion, &expected);
                printf("%s, %s wave along %c: %.6f cm/us, %.6f of sqrt(C%s/rho)\n", metals[m],
                       along == motion ? "long" : "shear", "xy"[along], speed, speed / expected,
                       along == motion ? "11" : "66");
                CHECK_NEAR_REL(speed, expected, 0.005);
            }
        }
    }
}

/* Without shear springs C11 is K0: the bulk sound speed of the Hugoniot. */
TEST(uniaxial_calibration_gives_the_bulk_sound_speed)
{
    struct engine g;
    char text[2000];
    sheet_text(text, sizeof text, "Ni", "kt_ratio = 0");
    engine_start(&g, text, NULL, 1);
    const struct pair_law *law = model_law(g.model, 0, 0, RELATION_SAME_GRAIN);
    CHECK_NEAR_REL(sqrt(sqrt(3.0) / 4.0 * 3.0 * law->k / 8.874), 0.4602, 1e-14);
    CHECK_SAME_BITS(law->kt_link, 0.0);
    engine_stop(&g);
}

/* --- symmetric impact --- */

static const char impact_deck[] =
    "let d = 0.04; let row = sqrt(3)/2*d; let rows = 40; let columns = 6; let up2 = 0.04\n"
    "let width = columns*d; let height = (rows + 60)*row; let line = rows*row\n"
    "domain { size = width height; boundary = periodic free; r_c = 1.1*d; delta_r = 0.1*d }\n"
    "time { dt = 0.02; steps = 400 }\n" METALS
    "interaction { potential = morse; zeta = 0.1; ct_ratio = 0.02; link_break = 1.09 }\n"
    "body flyer { shape = rectangle 0 0 width line; spacing = d; origin = d/4 row/2; material = Ni; velocity "
    "= 0 up2 }\n"
    "body target { shape = rectangle 0 line width 2*line; spacing = d; origin = d/4 row/2; material = Ni }\n"
    "probe surface { region = 0, 2*line - 1.01*row, width, 2*line }\n";

TEST(free_surface_moves_at_twice_the_particle_velocity)
{
    struct engine g;
    static const char *const speeds[] = {"up2=0.02", "up2=0.04", "up2=0.08"};
    for (int k = 0; k < 3; k++) {
        const char *defines[] = {"height=3.6", speeds[k], NULL};
        engine_start(&g, impact_deck, defines, 1);
        double up2 = g.deck.config.bodies[0].velocity[1], peak = 0.0, sum = 0.0;
        int counted = 0, arrived = -1;
        for (int step = 0; step < 210; step++) {
            struct measures m;
            engine_step(&g, &m);
            double v = exact_value(&m.probe[0].sum[PROBE_VY], model_scales(g.model).velocity) /
                       (double)m.probe[0].count;
            peak = v > peak ? v : peak;
            if (arrived < 0 && v > 0.5 * up2)
                arrived = step;
            if (arrived >= 0 && step > arrived + 15 && step <= arrived + 55) {
                sum += v;
                counted++;
            }
        }
        CHECK_EQ_INT(counted, 40);
        printf("2 up = %g: free surface %.6f (%.4f), peak %.6f, shock arrived at step %d\n", up2,
               sum / counted, sum / counted / up2, peak, arrived);
        CHECK_NEAR_REL(sum / counted, up2, 0.02);
        engine_stop(&g);
    }
}

/* --- convergence of the energy --- */

static const char atoms_deck[] =
    "let dt = 0.01; let width = 20; let height = 10*sqrt(3)\n"
    "domain { size = width height; boundary = periodic periodic; r_c = 2.3; delta_r = 0.3 }\n"
    "time { dt = dt; steps = 1 }\n"
    "material atom { mass = 1 }\n"
    "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9; cutoff = 2.3; linked = "
    "no }\n"
    "body sheet { shape = rectangle 0 0 width height; spacing = 1; origin = 0.25 0.4; material = atom; "
    "jitter = 0.25\n"
    "             seed = 5 }\n";

/* Largest difference of the total energy from its first value, over the time 2. */
static double energy_error(const char *dt)
{
    struct engine g;
    const char *defines[] = {dt, NULL};
    engine_start(&g, atoms_deck, defines, 1);
    double first = 0.0, worst = 0.0;
    int64_t steps = (int64_t)(2.0 / g.deck.config.dt + 0.5);
    for (int64_t k = 0; k <= steps; k++) {
        struct measures m;
        engine_step(&g, &m);
        double total = engine_total(&g, &m);
        first = k == 0 ? total : first;
        worst = fmax(worst, fabs(total - first));
    }
    engine_stop(&g);
    return worst;
}

TEST(energy_error_of_atoms_falls_as_the_square_of_the_step)
{
    double coarse = energy_error("dt=0.01"), middle = energy_error("dt=0.005"),
           fine = energy_error("dt=0.0025");
    printf("energy off by %g, %g, %g: ratios %.3f, %.3f\n", coarse, middle, fine, coarse / middle,
           middle / fine);
    CHECK_NEAR(coarse / middle, 4.0, 0.3);
    CHECK_NEAR(middle / fine, 4.0, 0.3);
}

TEST_MAIN(CASE(waves_travel_at_the_lattice_constants_speeds),
          CASE(uniaxial_calibration_gives_the_bulk_sound_speed),
          CASE(free_surface_moves_at_twice_the_particle_velocity),
          CASE(energy_error_of_atoms_falls_as_the_square_of_the_step))
