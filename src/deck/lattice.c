/* The constants of the lattice. The bounds of kt keep the lattice stable and its bonds stiffer along than
 * across. */
#include "dm2/deck/lattice.h"

#include <math.h>

#include "dm2/base/real.h"

static const double root3 = 0x1.bb67ae8584caap0;
static const double cube_root2 = 0x1.428a2f98d728bp0; /* 2^(1/3) */

double lattice_mean(double a, double b)
{
    return a + b > 0.0 ? 2.0 * (a * b) / (a + b) : 0.0;
}

double lattice_stiffness(const struct material_config *a, const struct material_config *b,
                         enum calibration_kind calibration)
{
    double k0 = lattice_mean(a->rho0 * (a->c0 * a->c0), b->rho0 * (b->c0 * b->c0));
    return calibration == CALIBRATION_BULK ? 2.0 * k0 / root3 : 4.0 * k0 / (3.0 * root3);
}

double lattice_atomic_stiffness(double epsilon, double sigma)
{
    return 72.0 * epsilon / (cube_root2 * (sigma * sigma));
}

double lattice_sound_speed(double kn, double rho0, enum calibration_kind calibration)
{
    double k0 = kn * (calibration == CALIBRATION_BULK ? root3 / 2.0 : 3.0 * root3 / 4.0);
    return sqrt(k0 / rho0);
}

double lattice_shape(const struct material_config *a, const struct material_config *b,
                     enum calibration_kind calibration)
{
    double s = 0.5 * (a->s + b->s);
    return calibration == CALIBRATION_BULK ? (8.0 * s - 3.0) / 3.0 : (16.0 * s + 3.0) / 9.0;
}

double lattice_slope(double shape, enum calibration_kind calibration)
{
    return calibration == CALIBRATION_BULK ? (3.0 * shape + 3.0) / 8.0 : (9.0 * shape - 3.0) / 16.0;
}

double lattice_shear_stiffness(const struct material_config *a, const struct material_config *b, double kn)
{
    double g = isnan(a->shear) || isnan(b->shear) ? 0.0 : lattice_mean(a->shear, b->shear);
    double kt = 4.0 * g / root3 - kn;
    return kt < 0.0 ? 0.0 : kt > 0.5 * kn ? 0.5 * kn : kt;
}

double lattice_shear_modulus(double kn, double kt)
{
    return 0.25 * root3 * (kn + kt);
}

/* The strongest pull is D alpha/2 = k r0/(4 a) for Morse. For Lennard-Jones, (12 eps/r0)(q^7 - q^13) with q =
 * (7/13)^(1/6) and eps = k r0^2/72, is k r0 q^7/13. A bond flows at Yt A with the facet A = r0 h/sqrt 3. */
double lattice_strength(enum potential_kind potential, double kn, double shape)
{
    static const double q7_over_13 = 0.03735973468339888;
    if (potential == POTENTIAL_QUADRATIC)
        return INFINITY;
    return root3 * (potential == POTENTIAL_MORSE ? kn / (4.0 * shape) : kn * q7_over_13);
}

/* The bond's pull over r0 is (k/a)(E - E^2) with E = exp(-a (s - 1)) for Morse, k (q^7 - q^13)/6 with q = 1/s
 * for Lennard-Jones, k (s - 1) for the quadratic potential. */
double lattice_strength_to(enum potential_kind potential, double kn, double shape, double stretch)
{
    double most = lattice_strength(potential, kn, shape), pull = stretch - 1.0;
    bool peaked = false;
    if (potential == POTENTIAL_MORSE) {
        double e = real_exp(-shape * (stretch - 1.0));
        peaked = e <= 0.5;
        pull = (e - e * e) / shape;
    } else if (potential == POTENTIAL_LENNARD_JONES) {
        double q = 1.0 / stretch, q6 = q * q * q * q * q * q;
        peaked = q6 <= 7.0 / 13.0;
        pull = q * (q6 - q6 * q6) / 6.0;
    }
    return peaked ? most : root3 * kn * pull;
}
