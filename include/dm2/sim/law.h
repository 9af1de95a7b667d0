/* The pair law: what two elements do to each other. One documented function per part, apart from how pairs are
 * found and summed (dm2/sim/force.h).
 *
 * Signs: n points from the partner j to i, t = (-n_y, n_x); a normal force f > 0 pushes apart; forces are those on
 * i, and j gets the opposite. Everything here is antisymmetric bit for bit: with i and j exchanged, n, t and the
 * relative velocity change sign exactly, and every other quantity enters through sums, products, minima of two,
 * which commute in IEEE arithmetic. So both servers that evaluate a pair across their boundary get the same numbers,
 * whichever element each takes for i. (2 a b is written 2 (a b): products of three do not commute.)
 *
 * Source: paper, section 2.3 (capabilities) and 4 (status); docs/physics.md has the equations. */
#ifndef DM2_SIM_LAW_H
#define DM2_SIM_LAW_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/real.h"
#include "dm2/sim/config.h"

/* One law per ordered pair of kinds and relation; law(b, a) is law(a, b) with strengths and yields exchanged. */
struct pair_law {
    enum potential_kind potential;
    enum scope_kind scope;
    bool near;         /* does anything beyond a potential of scope `all`: it needs contact status and memory */
    bool initial_link; /* lattice neighbours start linked */
    bool tangential;   /* any of kt, c_t, mu acts */
    double k;          /* stiffness at r0, Mbar cm */
    double shape;      /* Morse: alpha r0 */
    double eps12;      /* Lennard-Jones of plain eps, sigma: 12 eps; else 0 */
    double rm2;        /* there: square of the distance of zero force, 2^(1/3) sigma^2, cm2 */
    double cutoff2;    /* scope all: square of the cutoff, cm2; 0 otherwise */
    double u_cut;      /* scope all, plain Lennard-Jones: potential at the cutoff, taken off so that it ends at 0 */
    double cn, ct;     /* c_n and c_t over sqrt(m_eff) */
    double cn_mass, ct_mass; /* the same with the m_eff of the kinds, where their elements all have one mass; else -1 */
    double a_p, a_t;   /* change of c_n with P and T */
    double t0_mean;    /* K, reference of a_t */
    double kt_link, kt_contact; /* tangential stiffness, Mbar cm */
    double mu;
    double yield_i, yield_j;     /* Y of i's and of j's side at T0, Mbar; infinite: elastic */
    double tensile_i, tensile_j; /* Yt0 likewise */
    double link_form, link_break; /* in r0 */
    double conduction; /* kappa_ij times the conductance factor, g cm/us3/K */
};

/* What the law needs to see of a pair. */
struct pair_view {
    double r;                  /* distance of the centres, cm */
    double radius_i, radius_j; /* cm */
    double vn, vt;             /* relative velocity of i along n and t, without spin, cm/us */
    double w_i, w_j;           /* 1/us */
    double mass_i, mass_j;     /* g */
    double soft_i, soft_j;     /* softening factors 1 - ((T-T0)/(Tm-T0))^n in [0, 1] */
    double t_i, t_j;           /* K */
    double p_i, p_j;           /* Mbar, of the last evaluation */
};

/* The memory of a pair. */
struct pair_state {
    bool linked;
    double stretch; /* residual normal stretch e, cm */
    double spring;  /* tangential spring s, cm */
};

/* What the law gives. */
struct pair_effect {
    bool contacting;
    double fn, ft;      /* total force on i along n and t, Mbar cm2; without the potential of scope `all` */
    double fdn, fdt;    /* the part of them that is damping */
    double arm_i, arm_j; /* lever arms of ft, cm: the torque on i is -arm_i ft, on j -arm_j ft */
    double heat;        /* freed at once by slip, yield and breaking, g cm2/us2 */
    double heat_damped; /* lagged damping heat of this step */
    double exchange;    /* heat conducted to i in this step, g cm2/us2 */
    double potential, elastic; /* energies, g cm2/us2 */
};

static inline double law_lesser(double a, double b)
{
    return a < b ? a : b;
}

/* --- central potentials (docs/physics.md, section 3); x is the bond length r - e, r0 the contact distance -------- */

/* E = exp(-alpha (x - r0)) of the Morse potential, alpha = shape/r0. */
static inline double morse_e(const struct pair_law *law, double x, double r0)
{
    return real_exp(law->shape - (law->shape / r0) * x);
}

/* f = 2 D alpha (E^2 - E) = (k/alpha)(E^2 - E). */
static inline double morse_force(const struct pair_law *law, double e, double r0)
{
    return (law->k * (r0 / law->shape)) * (e * e - e);
}

/* u = D (1 - E)^2, 0 at r0, D = k/(2 alpha^2). */
static inline double morse_energy(const struct pair_law *law, double e, double r0)
{
    double a = r0 / law->shape;
    return 0.5 * law->k * (a * a) * ((1.0 - e) * (1.0 - e));
}

/* f = -k (x - r0) */
static inline double quadratic_force(const struct pair_law *law, double x, double r0)
{
    return law->k * (r0 - x);
}

static inline double quadratic_energy(const struct pair_law *law, double x, double r0)
{
    return 0.5 * law->k * ((r0 - x) * (r0 - x));
}

/* f = (12 eps/x)((r0/x)^12 - (r0/x)^6), eps = k r0^2/72 */
static inline double lennard_jones_force(const struct pair_law *law, double x, double r0)
{
    double q = (r0 * r0) / (x * x), q3 = q * q * q;
    return (law->k * (r0 * r0) / 6.0) * (q3 * q3 - q3) / x;
}

/* u = eps ((r0/x)^12 - 2 (r0/x)^6 + 1), 0 at r0 */
static inline double lennard_jones_energy(const struct pair_law *law, double x, double r0)
{
    double q = (r0 * r0) / (x * x), q3 = q * q * q;
    return (law->k * (r0 * r0) / 72.0) * ((q3 - 1.0) * (q3 - 1.0));
}

/* Force and energy of the potential at bond length x. */
static inline double potential_force(const struct pair_law *law, double x, double r0, double *energy)
{
    if (law->potential == POTENTIAL_MORSE) {
        double e = morse_e(law, x, r0);
        *energy = morse_energy(law, e, r0);
        return morse_force(law, e, r0);
    }
    if (law->potential == POTENTIAL_QUADRATIC) {
        *energy = quadratic_energy(law, x, r0);
        return quadratic_force(law, x, r0);
    }
    *energy = lennard_jones_energy(law, x, r0);
    return lennard_jones_force(law, x, r0);
}

/* The bond length beyond r0 at which the attraction reaches `cap` (tension = true), or below r0 at which the
 * repulsion does: xi_t and xi_c of docs/physics.md, section 4. Infinite, or 0, where it never does. Only called where a
 * bond yields. Exact for Morse and quadratic; for Lennard-Jones by bisection to the last bit. */
double law_yield_length(const struct pair_law *law, double r0, double cap, bool tension);

/* True when a bond of length x pulls with more than `cap`. `force` is the potential's at x. On the falling branch of
 * the potential, beyond its strongest attraction, a bond that may yield has yielded. */
static inline bool law_pulls_too_hard(const struct pair_law *law, double x, double r0, double force, double cap)
{
    if (force < -cap)
        return true;
    if (x <= r0)
        return false;
    double peak = law->potential == POTENTIAL_MORSE ? r0 * (1.0 + 0x1.62e42fefa39efp-1 / law->shape)
                  : law->potential == POTENTIAL_LENNARD_JONES ? r0 * 0x1.1bd2ad2dcb0c6p0 /* (13/7)^(1/6) */
                                                              : INFINITY;
    return x > peak && law_yield_length(law, r0, cap, true) < INFINITY;
}

/* The whole law: updates the pair's memory and fills *out.
 * dt_kick: the time over which this evaluation's forces act (dt, or dt/2 in step 0); dt_path: the time since the
 * positions of the last evaluation (dt, or 0 in step 0), us. Depth h = 1 cm. */
static inline void pair_interact(const struct pair_law *law, const struct pair_view *p, double dt_kick, double dt_path,
                                 struct pair_state *s, struct pair_effect *out)
{
    const double facet = 0x1.279a74590331dp-1; /* 1/sqrt(3): A = r0/sqrt(3) h, the facet of the hexagon */
    double r = p->r, r0 = p->radius_i + p->radius_j, energy = 0.0;
    *out = (struct pair_effect){.contacting = r <= r0};

    /* Status (paper, section 4): contact is where they are; a link has memory. */
    if (s->linked) {
        if (r > law->link_break * r0) {
            if (law->scope == SCOPE_LINKED)
                (void)potential_force(law, r - s->stretch, r0, &energy);
            out->heat += energy + 0.5 * law->kt_link * (s->spring * s->spring);
            *s = (struct pair_state){.linked = false};
        }
    } else if (r <= law->link_form * r0) {
        if (law->kt_link != law->kt_contact) {
            out->heat += 0.5 * law->kt_contact * (s->spring * s->spring);
            s->spring = 0.0;
        }
        s->linked = true;
        s->stretch = 0.0;
    }
    if (!s->linked && !out->contacting) {
        out->heat += 0.5 * law->kt_contact * (s->spring * s->spring);
        s->spring = 0.0;
        return;
    }

    /* Central force with tension yield. */
    double f = 0.0, area = r0 * facet;
    if (law->scope == SCOPE_LINKED) {
        double x = r - s->stretch;
        f = potential_force(law, x, r0, &energy);
        double cap = law_lesser(law->tensile_i * p->soft_i, law->tensile_j * p->soft_j) * area;
        if (s->linked && cap < INFINITY) {
            double before = s->stretch;
            if (law_pulls_too_hard(law, x, r0, f, cap)) {
                double at = law_yield_length(law, r0, cap, true);
                if (at < INFINITY)
                    s->stretch = r - at;
            } else if (s->stretch > 0.0 && f > cap) {
                double at = law_yield_length(law, r0, cap, false);
                s->stretch = r > at ? r - at : 0.0;
            }
            if (s->stretch != before) {
                out->heat += cap * fabs(s->stretch - before);
                f = potential_force(law, r - s->stretch, r0, &energy);
            }
        }
        out->potential = energy;
    }

    /* Central damping; an unlinked contact never pulls. */
    double scale = 1.0 + law->a_p * (0.5 * (p->p_i + p->p_j)) + law->a_t * (0.5 * (p->t_i + p->t_j) - law->t0_mean);
    double root = 1.0, cn = law->cn_mass, ct = law->ct_mass;
    if (cn < 0.0) {
        root = sqrt((p->mass_i * p->mass_j) / (p->mass_i + p->mass_j));
        cn = law->cn * root;
        ct = law->ct * root;
    }
    cn *= scale > 0.0 ? scale : 0.0;
    double fdn = -cn * p->vn;
    if (!s->linked && f + fdn < 0.0)
        fdn = -f;
    out->fn = f + fdn;
    out->fdn = fdn;

    /* Tangential: a spring, elastic-perfectly-plastic in a link and with Coulomb's cap in a contact; viscosity. */
    if (law->tangential) {
        double share = r / r0;
        out->arm_i = share * p->radius_i;
        out->arm_j = share * p->radius_j;
        double vt = p->vt - (p->w_i * out->arm_i + p->w_j * out->arm_j);
        double kt = s->linked ? law->kt_link : law->kt_contact;
        double cap = s->linked ? 0x1.bb67ae8584cabp-1 * /* 1.5/sqrt(3) */
                                     law_lesser(law->yield_i * p->soft_i, law->yield_j * p->soft_j) * area
                               : law->mu * out->fn;
        double spring = s->spring + vt * dt_path;
        if (kt * fabs(spring) > cap) {
            double held = copysign(cap / kt, spring);
            out->heat += kt * (0.5 * (s->spring + held)) * (spring - held);
            spring = held;
        }
        s->spring = spring;
        double fdt = -ct * vt, fs = -kt * spring;
        if (!s->linked && fabs(fs + fdt) > cap)
            fdt = copysign(cap, fs + fdt) - fs;
        out->ft = fs + fdt;
        out->fdt = fdt;
        out->elastic = 0.5 * kt * (spring * spring);
        out->heat_damped -= fdt * vt * dt_kick;
    }
    out->heat_damped -= fdn * p->vn * dt_kick;

    /* Fourier: Q = kappa (A/r)(T_j - T_i) dt. */
    out->exchange = law->conduction * (area / r) * (p->t_j - p->t_i) * dt_kick;
}

#endif
