/* The stable time step is the smallest limit of any mode, over all elements and all laws that act on them. */
#include "stability.h"

#include <math.h>
#include <string.h>

#include "kinds.h"
#include "wall_shape.h"

static const double root3 = 0x1.bb67ae8584caap0;

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Keeps the limit dt, with its mode and pair, where dt is below the smallest limit so far. */
static void limit_time_step(struct model *m, double dt, const char *mode, size_t a, size_t b)
{
    if (!(dt < m->dt_stable))
        return;
    m->dt_stable = dt;
    m->dt_mode = mode;
    m->dt_kinds[0] = a;
    m->dt_kinds[1] = b;
}

/* The largest dt with omega^2 dt^2 + 2 gamma dt <= 4, us, of a mode with omega^2, 1/us2, and gamma, 1/us.
 * Damping alone limits too: infinite only where both are 0. */
static double mode_limit(double omega2, double gamma)
{
    return 4.0 / (sqrt(gamma * gamma + 4.0 * omega2) + gamma);
}

/* The largest stable step of an element of mass m whose six neighbours have this law: omega^2 dt^2 + 2 gamma
 * dt < 4 for the stiffest mode. Translation omega^2 = (6 kn + 2 kt)/m, gamma = (6 c_n + 2 c_t)/m; rotation
 * omega^2 = 24 kt/m, gamma = 24 c_t/m. The factors by which damping depends on P and T are not known before
 * the run and are omitted. */
static void limit_by_law(struct model *m, double mass, double m_eff, size_t a, size_t b,
                         const struct pair_law *law)
{
    static const char *const modes[2][2] = {{"translation", "damping of the translation"},
                                            {"rotation", "damping of the rotation"}};
    double kt = law->kt_contact, root = sqrt(m_eff); /* kt_link is not larger */
    double omega2[2] = {(6.0 * law->k + 2.0 * kt) / mass, 24.0 * kt / mass};
    double gamma[2] = {(6.0 * law->cn + 2.0 * law->ct) * root / mass, 24.0 * law->ct * root / mass};
    for (int mode = 0; mode < 2; mode++) {
        double g = gamma[mode], o = omega2[mode], dt = mode_limit(o, g);
        limit_time_step(m, dt, modes[mode][2.0 * g > o * dt], a, b); /* names the larger term */
    }
}

/* The largest stable step of an element of mass m among walls of this law, which do not give way: half of the
 * stiffness and damping of six neighbours, with m_eff = m. */
static void limit_by_wall(struct model *m, double mass, size_t a, const struct wall *w)
{
    static const char *const modes[2][2] = {{"translation against a wall", "damping against a wall"},
                                            {"rotation against a wall", "damping of the rotation against a "
                                                                        "wall"}};
    const struct pair_law *law = &w->laws[a];
    size_t b = w->config->material < 0 ? a : (size_t)w->config->material;
    double root = sqrt(mass), cp = m->kinds[a].cp;
    double omega2[2] = {(3.0 * law->k + law->kt_contact) / mass, 12.0 * law->kt_contact / mass};
    double gamma[2] = {(3.0 * law->cn + law->ct) * root / mass, 12.0 * law->ct * root / mass};
    for (int mode = 0; mode < 2; mode++) {
        double g = gamma[mode], o = omega2[mode], dt = mode_limit(o, g);
        limit_time_step(m, dt, modes[mode][2.0 * g > o * dt], a, b);
    }
    if (law->conduction > 0.0 && isfinite(cp) && !isnan(w->config->temperature))
        limit_time_step(m, 2.0 * mass * cp / (6.0 / root3 * law->conduction), "heat conduction of a wall", a,
                        b);
}

/* Goes through all elements of the deck and all laws that can act on them. m_eff is the effective mass of the
 * two kinds where the law has constants by mass (cn_mass >= 0), and otherwise the effective mass with the
 * heaviest element of the deck as partner, which is never too small. Heat conduction: 9 kappa/sqrt(3) / (m
 * cp) dt < 2 for the shortest wave of the hexagonal lattice. */
void stability_find_time_step(struct model *m)
{
    const struct config *c = m->config;
    double heaviest = 0.0;
    m->dt_stable = INFINITY;
    m->dt_mode = "nothing";
    for (size_t body = 0; body < c->n_bodies; body++)
        for (size_t i = 0; i < c->bodies[body].n_mix; i++)
            heaviest = larger(
                heaviest, kind_mass(&c->materials[c->bodies[body].mix_material[i]], c->bodies[body].radius));
    for (size_t body = 0; body < c->n_bodies; body++) {
        for (size_t i = 0; i < c->bodies[body].n_mix; i++) {
            int material = c->bodies[body].mix_material[i];
            double mass = kind_mass(&c->materials[material], c->bodies[body].radius);
            for (size_t w = 0; w < m->n_walls && c->bodies[body].motion == MOTION_FREE; w++)
                limit_by_wall(m, mass, (size_t)material, &m->walls[w]);
            for (size_t k = 0; k < m->n_kinds * m->n_kinds * RELATION_COUNT; k++) {
                size_t a = k / RELATION_COUNT / m->n_kinds, b = k / RELATION_COUNT % m->n_kinds;
                const struct pair_law *law = &m->laws[k];
                double m_eff = mass * heaviest / (mass + heaviest), cp = m->kinds[a].cp;
                if (!kind_may_become(m, material, a))
                    continue;
                if (law->cn_mass >= 0.0 && law->cn > 0.0)
                    m_eff = (law->cn_mass / law->cn) * (law->cn_mass / law->cn);
                if (c->bodies[body].motion == MOTION_FREE) /* driven elements do not vibrate */
                    limit_by_law(m, mass, m_eff, a, b, law);
                if (law->conduction > 0.0 && isfinite(cp))
                    limit_time_step(m, 2.0 * mass * cp / (9.0 / root3 * law->conduction), "heat conduction",
                                    a, b);
            }
        }
    }
}

/* --- neighbours --- */

double model_stable_start(const struct model *m, const struct measures *start, const char **which)
{
    double dt = start->dt_share > 0.0 ? m->config->dt / start->dt_share : INFINITY;
    bool closer = dt < m->dt_stable * (1.0 - 1e-6); /* equal in a lattice, but for rounding */
    *which = closer ? "neighbours at the start" : m->dt_mode;
    return closer ? dt : m->dt_stable;
}

enum dm2_status model_check_start(const struct model *m, const struct measures *start, struct dm2_error *err)
{
    if (start->dt_share < 1.0)
        return DM2_OK;
    double stable = m->config->dt / start->dt_share;
    return config_fail(
        m->config->dt_place, err, DM2_DECK,
        "the time step dt = %g us is not below the stable one, %g us (limit: neighbours at the "
        "start, bonds compressed by up to %.2g %%): choose dt below %.2g us",
        m->config->dt, stable, 100.0 * start->compression, 0.5 * stable);
}

/* The limit of an element of mass m with n neighbours of mass m_j all around, as if the neighbours were at
 * rest: omega^2 = n (kn/2 + kt/6)/m. */
static double limit_among(const struct pair_law *law, double n, double m, double m_j)
{
    double kt = law->kt_contact, root = sqrt(m * m_j / (m + m_j)), turn = 4.0 * n / m;
    double translation =
        mode_limit(0.5 * n * (law->k + kt / 3.0) / m, 0.5 * n * (law->cn + law->ct / 3.0) * root / m);
    double rotation = mode_limit(turn * kt, turn * law->ct * root);
    return translation < rotation ? translation : rotation;
}

static double lightest_mass(const struct config *c, const struct body_config *b)
{
    double mass = INFINITY;
    for (size_t i = 0; i < b->n_mix; i++) {
        double one = kind_mass(&c->materials[b->mix_material[i]], b->radius);
        mass = one < mass ? one : mass;
    }
    return mass;
}

/* How many discs of radius r fit around one of radius R: the most n with sin(pi/n) >= r/(R + r). */
static double count_around(double big_r, double r)
{
    const double pi = 0x1.921fb54442d18p1;
    double q = r / (big_r + r), n = 1.0;
    if (q < 1e-3)
        return floor(pi / q);
    while (real_sin(pi / (n + 1.0)) >= q * (1.0 - 1e-12))
        n += 1.0;
    return n;
}

struct model_room model_room(const struct model *m)
{
    const struct config *c = m->config;
    struct model_room out = {.dt = INFINITY};
    size_t n_bodies = c->n_bodies < MODEL_ROOM_BODIES ? c->n_bodies : MODEL_ROOM_BODIES;
    for (size_t a = 0; a < n_bodies; a++) {
        for (size_t b = 0; b < n_bodies; b++) {
            const struct body_config *one = &c->bodies[a], *other = &c->bodies[b];
            double n = count_around(one->radius, other->radius);
            if (a == b || one->motion != MOTION_FREE || !(n > 6.0) || m->has_far)
                continue;
            for (size_t k = 0; k < one->n_mix * other->n_mix; k++) {
                const struct pair_law *law =
                    model_law(m, (size_t)one->mix_material[k / other->n_mix],
                              (size_t)other->mix_material[k % other->n_mix], RELATION_OTHER_BODY);
                double dt = limit_among(law, n, lightest_mass(c, one), lightest_mass(c, other));
                if (dt < out.dt)
                    out = (struct model_room){.body = a, .other = b, .count = (int)n, .dt = dt};
            }
        }
    }
    return out;
}

/* --- check --- */

enum dm2_status stability_check(const struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    struct kind_name a, b;
    if (c->dt < m->dt_stable)
        return DM2_OK;
    return config_fail(
        c->dt_place, err, DM2_DECK,
        "the time step dt = %g us is not below the stable one, %g us (limit: %s, '%s' with '%s'): choose dt "
        "below %.2g us%s",
        c->dt, m->dt_stable, m->dt_mode, config_kind_name(c, m->dt_kinds[0], &a),
        config_kind_name(c, m->dt_kinds[1], &b), 0.5 * m->dt_stable,
        strncmp(m->dt_mode, "damping", 7) == 0 ? ", or zeta and ct_ratio smaller" : "");
}
