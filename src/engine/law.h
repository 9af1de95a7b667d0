/* The pair law: the forces, torques and heats that two elements exert on each other, a function for each
 * part. How pairs are found and their effects summed: engine/force.h.
 *
 * Signs: n points from the partner j to i, t = (-n_y, n_x); a normal force f > 0 pushes apart; forces are
 * those on i, and j gets the opposite.
 *
 * The law is antisymmetric bit for bit: with i and j exchanged, n, t and the relative velocity change sign
 * exactly, and all other quantities enter through sums, products and minima of two, which commute in IEEE
 * arithmetic. So two servers that evaluate a pair across their boundary get the same numbers, whichever
 * element each takes for i. (2 a b is written 2 (a b), because products of three do not commute.)
 *
 * Source: paper, sections 2.3 (capabilities) and 4 (status); equations: docs/physics.md. */
#ifndef DM2_ENGINE_LAW_H
#define DM2_ENGINE_LAW_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/real.h"
#include "dm2/base/simd.h"
#include "dm2/deck/config.h"

/* The constants of a law at one contact distance r0, which spare the pair loop its divisions. */
struct bond {
    double r0;            /* cm; 0: the pair's r0 is not known beforehand, so there are no constants */
    double over_r0;       /* 1/r0 */
    double touch;         /* law_touch_length(r0), cm */
    double forms, breaks; /* link_form r0, link_break touch, cm */
    double area;          /* A = r0/sqrt(3) h, the facet of the hexagon, cm2 */
    double alpha;         /* Morse: shape/r0, 1/cm */
    double force, energy; /* the potential's prefactors: Morse k/alpha and k/(2 alpha^2); quadratic k and k/2;
                           * Lennard-Jones k r0^2/6 and k r0^2/72 */
    double peak;          /* length of the strongest attraction, cm; infinite: the attraction never falls */
};

/* One law per ordered pair of kinds and relation; law(b, a) is law(a, b) with strengths and yields exchanged.
 */
struct pair_law {
    enum potential_kind potential;
    enum scope_kind scope;
    bool near;         /* more than a potential of scope `all`: pairs need contact status and memory */
    bool initial_link; /* lattice neighbours start linked */
    bool wide;         /* linked pairs may be taken four at a time: Morse, with the constants in `bond` */
    bool tangential;   /* any of kt, c_t, mu acts */
    double k;          /* stiffness at r0, Mbar cm */
    double shape;      /* Morse: alpha r0 */
    double eps12;      /* Lennard-Jones of plain eps, sigma: 12 eps; else 0 */
    double strength;   /* where eps12 > 0: eps12/rm2, Mbar cm */
    double rm2;        /* where eps12 > 0: square of the distance of zero force, 2^(1/3) sigma^2, cm2 */
    double cutoff2;    /* scope all: square of the cutoff, cm2; 0 otherwise */
    double u_cut;      /* scope all and eps12 > 0: potential at the cutoff, which ends the potential at 0 */
    double r2_least; /* scope all and eps12 > 0: below this r^2 the force leaves the range of far sums, cm2 */
    double cn, ct;   /* c_n and c_t over sqrt(m_eff) */
    double cn_mass, ct_mass; /* of links: c_n, c_t where all elements of each kind have one mass; else -1 */
    double a_p, a_t;         /* change of c_n with P and T */
    double t0_mean;          /* K, reference of a_t */
    double kt_link, kt_contact; /* tangential stiffness, Mbar cm */
    double mu;
    double yield_i, yield_j;      /* Y of i's and of j's side at T0, Mbar; infinite: elastic */
    double tensile_i, tensile_j;  /* Yt0 of i's and of j's side, Mbar; infinite: elastic */
    double link_form, link_break; /* in r0 */
    double radius_i, radius_j;    /* cm; where all elements of each kind have one radius */
    struct bond bond;             /* the constants for radius_i + radius_j; else r0 = 0 */
    double conduction;            /* kappa_ij times the conductance factor, g cm/us3/K */
};

/* The quantities of a pair that enter the law. */
struct pair_view {
    double r, over_r;          /* distance of the centres, cm, and its reciprocal */
    double radius_i, radius_j; /* cm */
    double vn, vt;             /* relative velocity of i along n and t, without spin, cm/us */
    double w_i, w_j;           /* 1/us */
    double mass_i, mass_j;     /* g */
    double soft_i, soft_j;     /* softening factors 1 - ((T-T0)/(Tm-T0))^n in [0, 1] */
    double t_i, t_j;           /* K */
    double p_i, p_j;           /* Mbar, of the last evaluation */
    bool held_i, held_j;       /* the motion is prescribed: no force moves the element */
    bool walls;                /* both are held, in different bodies: no force acts */
};

/* The memory of a pair. */
struct pair_state {
    bool linked;
    double stretch; /* residual normal stretch e, cm */
    double spring;  /* tangential spring s, cm */
};

/* The effect of a pair on its two elements in one step. */
struct pair_effect {
    bool contacting;
    double fn, ft;       /* total force on i along n and t, Mbar cm2; without the potential of scope `all` */
    double fdn, fdt;     /* damping parts of fn and ft */
    double arm_i, arm_j; /* lever arms of ft, cm: the torque on i is -arm_i ft, on j -arm_j ft */
    double heat;         /* freed at once by slip, yield and breaking, g cm2/us2 (law_freed) */
    double heat_damped;  /* lagged damping heat of this step */
    double exchange;     /* heat conducted to i in this step, g cm2/us2 */
    double potential, elastic; /* energies, g cm2/us2 */
};

static inline double law_lesser(double a, double b)
{
    return a < b ? a : b;
}

/* The weaker of the strengths of two sides. A side without limit has none when it is molten, either: infinity
 * times the softening factor 0 is not a number, and then the other side decides, on whichever side it is. */
static inline double law_weaker(double a, double b)
{
    return a < b || b != b ? a : b;
}

/* --- touching --- */

/* The distance up to which two elements of contact distance r0 touch, cm. The tolerance of 2^-26 r0 takes in
 * the rounding of positions, some 2^-53 of the domain, in domains of 1e6 spacings 15 times over; as a strain
 * of metals 2^-26 is some kPa. */
DM2_INLINE double law_touch_length(double r0)
{
    return r0 * (1.0 + 0x1p-26);
}

/* Do two elements at the distance r, cm, touch? Force, heat, friction, reaction, strain, measures and lists
 * ask here, or compare r with law_touch_length. */
DM2_INLINE bool law_touches(double r, double r0)
{
    return r <= law_touch_length(r0);
}

/* Is r2, the square of a distance, certainly too large for touching? False near the limit: then law_touches
 * decides. Spares the loops a root. */
DM2_INLINE bool law_far_apart(double r2, double r0)
{
    return r2 > r0 * r0 * (1.0 + 0x1p-24);
}

/* --- central potentials --- */

/* The constants of a law at contact distance r0 (docs/physics.md, section 3). */
static inline struct bond law_bond(const struct pair_law *law, double r0)
{
    struct bond b = {.r0 = r0,
                     .over_r0 = 1.0 / r0,
                     .touch = law_touch_length(r0),
                     .forms = law->link_form * r0,
                     .breaks = law->link_break * law_touch_length(r0),
                     .area = r0 * 0x1.279a74590331dp-1 /* 1/sqrt(3) */};
    double a = r0 / law->shape; /* of Morse alone */
    switch (law->potential) {
    case POTENTIAL_MORSE:
        b.alpha = law->shape / r0;
        b.force = law->k * a;
        b.energy = 0.5 * law->k * (a * a);
        b.peak = r0 * (1.0 + 0x1.62e42fefa39efp-1 / law->shape); /* E = 1/2 */
        break;
    case POTENTIAL_QUADRATIC:
        b.force = law->k;
        b.energy = 0.5 * law->k;
        b.peak = INFINITY;
        break;
    case POTENTIAL_LENNARD_JONES:
        b.force = law->k * (r0 * r0) * (1.0 / 6.0);
        b.energy = law->k * (r0 * r0) * (1.0 / 72.0);
        b.peak = r0 * 0x1.1bd2ad2dcb0c6p0; /* (13/7)^(1/6) */
        break;
    }
    return b;
}

/* Force, and energy with its zero at r0, of the potential at bond length x = r - e:
 *   Morse          f = 2 D alpha (E^2 - E), u = D (1 - E)^2, E = exp(-alpha (x - r0)), D = k/(2 alpha^2)
 *   quadratic      f = -k (x - r0), u = k (x - r0)^2/2
 *   Lennard-Jones  f = (12 eps/x)((r0/x)^12 - (r0/x)^6), u = eps ((r0/x)^6 - 1)^2, eps = k r0^2/72
 * Not a number for any other potential, so that the run ends. */
DM2_INLINE double bond_force(const struct pair_law *law, const struct bond *b, double x, double *energy)
{
    switch (law->potential) {
    case POTENTIAL_MORSE: {
        double e = real_exp(law->shape - b->alpha * x);
        *energy = b->energy * ((1.0 - e) * (1.0 - e));
        return b->force * (e * e - e);
    }
    case POTENTIAL_QUADRATIC: {
        double d = b->r0 - x;
        *energy = b->energy * (d * d);
        return b->force * d;
    }
    case POTENTIAL_LENNARD_JONES: {
        double over_x = 1.0 / x, q = b->r0 * over_x, q2 = q * q, q6 = q2 * q2 * q2;
        *energy = b->energy * ((q6 - 1.0) * (q6 - 1.0));
        return b->force * (q6 * q6 - q6) * over_x;
    }
    }
    *energy = NAN;
    return NAN;
}

/* bond_force for a contact distance r0 whose constants are not at hand. */
static inline double potential_force(const struct pair_law *law, double x, double r0, double *energy)
{
    struct bond b = law_bond(law, r0);
    return bond_force(law, &b, x, energy);
}

/* xi_t of docs/physics.md, section 4: the bond length, cm, beyond r0 at which the attraction reaches `cap`,
 * Mbar cm2 (tension = true), infinite where no attraction does; or xi_c: the length below r0 at which the
 * repulsion reaches `cap`, 0 where no repulsion does. Exact for Morse and quadratic; for Lennard-Jones by
 * bisection to the last bit. Only called where a bond yields. */
double law_yield_length(const struct pair_law *law, double r0, double cap, bool tension);

/* True when a bond of length x pulls with more than `cap`. `force`: of the potential at x. A bond that may
 * yield has yielded beyond the strongest attraction, on the falling branch of the potential. */
DM2_INLINE bool law_pulls_too_hard(const struct pair_law *law, const struct bond *b, double x, double force,
                                   double cap)
{
    return force < -cap || (x > b->peak && law_yield_length(law, b->r0, cap, true) < INFINITY);
}

/* --- the parts of the law --- */

/* The energy book. The kinetic energy at a whole step holds half a kick of this step's force. So a bond whose
 * energy and force jump at its present length, from u, f before to u, f after, frees
 *   u_before - u_after + (f_before - f_after) v_n dt/2,
 * dt the time since the last positions; a spring, s long at the last positions, whose stiffness or memory
 * ends, kt s (s + v_t dt)/2 (docs/physics.md, section 7). Either may be below 0, by |f v_n| dt/2 and kt |s
 * v_t| dt at most. */
DM2_INLINE double law_freed(double u_before, double u_after, double f_before, double f_after, double vn,
                            double dt_path)
{
    return (u_before - u_after) + (f_before - f_after) * (vn * (0.5 * dt_path));
}

DM2_INLINE double law_spring_freed(double kt, double spring, double vt, double dt_path)
{
    return 0.5 * kt * (spring * (spring + vt * dt_path));
}

/* The tangential velocity of the contact points, v_t; sets the lever arms of the tangential force. */
DM2_INLINE double law_sliding(const struct bond *bond, const struct pair_view *p, struct pair_effect *out)
{
    double share = p->r * bond->over_r0;
    out->arm_i = share * p->radius_i;
    out->arm_j = share * p->radius_j;
    return p->vt - (p->w_i * out->arm_i + p->w_j * out->arm_j);
}

/* Ends the spring of a pair, of stiffness kt: its energy becomes heat. */
DM2_INLINE void law_end_spring(double kt, const struct bond *bond, const struct pair_view *p, double dt_path,
                               struct pair_state *s, struct pair_effect *out)
{
    if (s->spring == 0.0)
        return;
    out->heat += law_spring_freed(kt, s->spring, law_sliding(bond, p, out), dt_path);
    s->spring = 0.0;
}

/* Status (paper, section 4): a contact follows from the positions, a link has memory. A link that breaks
 * frees the energy of its bond and its spring, a contact that ends the energy of its spring. False: the pair
 * is neither linked nor in contact, so no force acts. */
DM2_INLINE bool law_status(const struct pair_law *law, const struct bond *bond, const struct pair_view *p,
                           double dt_path, struct pair_state *s, struct pair_effect *out)
{
    if (s->linked) {
        if (p->r > bond->breaks) {
            double energy = 0.0, f = 0.0;
            if (law->scope == SCOPE_LINKED)
                f = bond_force(law, bond, p->r - s->stretch, &energy);
            out->heat += law_freed(energy, 0.0, f, 0.0, p->vn, dt_path);
            law_end_spring(law->kt_link, bond, p, dt_path, s, out);
            *s = (struct pair_state){.linked = false};
        }
    } else if (p->r <= bond->forms) {
        if (law->kt_link != law->kt_contact)
            law_end_spring(law->kt_contact, bond, p, dt_path, s, out);
        s->linked = true;
        s->stretch = 0.0;
    }
    if (s->linked || out->contacting)
        return true;
    law_end_spring(law->kt_contact, bond, p, dt_path, s, out);
    return false;
}

/* Returns the central force f of the bond, with yield in tension; 0 where the potential has scope `all`, and
 * in a contact from r0 on, where the repulsion ends. Sets the potential energy. */
DM2_INLINE double law_central(const struct pair_law *law, const struct bond *bond, const struct pair_view *p,
                              double dt_path, struct pair_state *s, struct pair_effect *out)
{
    if (law->scope != SCOPE_LINKED)
        return 0.0;
    double r = p->r, x = r - s->stretch, energy, f;
    if (!s->linked && r >= bond->r0)
        return 0.0;
    f = bond_force(law, bond, x, &energy);
    double cap = law_weaker(law->tensile_i * p->soft_i, law->tensile_j * p->soft_j) * bond->area;
    if (s->linked && cap < INFINITY) {
        double before = s->stretch;
        if (law_pulls_too_hard(law, bond, x, f, cap)) {
            double at = law_yield_length(law, bond->r0, cap, true);
            if (at < INFINITY)
                s->stretch = r - at;
        } else if (s->stretch > 0.0 && f > cap) {
            double at = law_yield_length(law, bond->r0, cap, false);
            s->stretch = r > at ? r - at : 0.0;
        }
        if (s->stretch != before) {
            double pulled = f, held = energy;
            f = bond_force(law, bond, r - s->stretch, &energy);
            out->heat += law_freed(held, energy, pulled, f, p->vn, dt_path);
        }
    }
    out->potential = energy;
    return f;
}

/* m_eff of an unlinked contact, g: the reduced mass of what moves, so the whole mass of an element that
 * touches a wall, whatever mass the elements of the wall have. */
DM2_INLINE double law_moving_mass(const struct pair_view *p)
{
    if (p->held_i != p->held_j)
        return p->held_i ? p->mass_j : p->mass_i;
    return (p->mass_i * p->mass_j) / (p->mass_i + p->mass_j);
}

/* The factor of a contact's damping force in the evaluation that is the first to see the contact: the part of
 * the kick's time, half a step before and half a step behind the evaluation, in which the two elements touch.
 * Neighbours of an unstrained lattice, at r0 but for a rounding, have touched before. The path since the last
 * evaluation is `dt_path` long, us; else 1. */
DM2_INLINE double law_touched_part(const struct bond *bond, const struct pair_view *p, double dt_path)
{
    double approach = -p->vn * dt_path, depth = bond->touch - p->r;
    if (!(approach > 0.0) || !(depth < approach))
        return 1.0;
    return 0.5 + depth / approach;
}

/* Central damping, fdn, and the sum fn = f + fdn; an unlinked contact never pulls. Returns c_t, which has the
 * same effective mass, Mbar us cm. The velocity is half a step old, and in a contact this lag acts as a mass
 * m_eff - c dt/2: c over 1 + c dt/(4 m_eff) makes the restitution right to second order. A link keeps c and
 * its reduced mass, because its damping is the viscosity of the crystal. c_t stays as it is: the same factor
 * with m_eff/3 puts the rebound of spinning discs further off where they have a tangential spring. */
DM2_INLINE double law_damping(const struct pair_law *law, const struct bond *bond, const struct pair_view *p,
                              bool linked, double f, double dt_path, struct pair_effect *out)
{
    double scale =
        1.0 + law->a_p * (0.5 * (p->p_i + p->p_j)) + law->a_t * (0.5 * (p->t_i + p->t_j) - law->t0_mean);
    double cn = law->cn_mass, ct = law->ct_mass, m_eff = 0.0;
    if (!linked || cn < 0.0) {
        m_eff = linked ? (p->mass_i * p->mass_j) / (p->mass_i + p->mass_j) : law_moving_mass(p);
        double root = sqrt(m_eff);
        cn = law->cn * root;
        ct = law->ct * root;
    }
    cn *= scale > 0.0 ? scale : 0.0;
    double fdn = -cn * p->vn;
    if (!linked) {
        fdn *= law_touched_part(bond, p, dt_path) / (1.0 + 0.25 * cn * (dt_path / m_eff));
        if (f + fdn < 0.0)
            fdn = -f;
    }
    out->fn = f + fdn;
    out->fdn = fdn;
    return ct;
}

/* The tangential force: a spring, elastic-perfectly-plastic in a link and with Coulomb's cap in a contact,
 * and viscosity; with the arms, the elastic energy and the heat. ct: c_t, from law_damping. The spring of a
 * link has the cap Y A: the lattice's resistance to shear is then Y/2 along its rows and Y/sqrt(3) midway
 * between them (docs/physics.md, section 6), the shear strengths of Tresca and von Mises. */
DM2_INLINE void law_tangential(const struct pair_law *law, const struct bond *bond, const struct pair_view *p,
                               double ct, double dt_kick, double dt_path, struct pair_state *s,
                               struct pair_effect *out)
{
    double vt = law_sliding(bond, p, out);
    double kt = s->linked ? law->kt_link : law->kt_contact;
    double cap = s->linked ? law_weaker(law->yield_i * p->soft_i, law->yield_j * p->soft_j) * bond->area
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

/* The whole law: updates the memory *s of the pair and fills *out.
 * dt_kick: the time over which this evaluation's forces act (dt, or dt/2 in step 0), us; dt_path: the time
 * since the positions of the last evaluation (dt, or 0 in step 0), us. Depth h = 1 cm. Conduction is
 * Fourier's: Q = kappa (A/r)(T_j - T_i) dt. Two walls only conduct, link and touch: a bond that no force can
 * stretch holds no energy. */
DM2_INLINE void pair_interact(const struct pair_law *law, const struct pair_view *p, double dt_kick,
                              double dt_path, struct pair_state *s, struct pair_effect *out)
{
    double r0 = p->radius_i + p->radius_j;
    const struct bond bond = r0 == law->bond.r0 ? law->bond : law_bond(law, r0);
    *out = (struct pair_effect){.contacting = p->r <= bond.touch};
    bool acts = law_status(law, &bond, p, dt_path, s, out);
    if (p->walls)
        out->heat = 0.0;
    if (!acts)
        return;
    if (!p->walls) {
        double f = law_central(law, &bond, p, dt_path, s, out);
        double ct = law_damping(law, &bond, p, s->linked, f, dt_path, out);
        if (law->tangential)
            law_tangential(law, &bond, p, ct, dt_kick, dt_path, s, out);
        out->heat_damped -=
            out->fdn * p->vn * dt_kick; /* behind the tangential one: the bits depend on the order */
    }
    out->exchange = law->conduction * (bond.area * p->over_r) * (p->t_j - p->t_i) * dt_kick;
}

#endif
