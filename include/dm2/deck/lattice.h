/* The hexagonal lattice that a material's constants are fitted to (docs/physics.md, section 3): bonds with
 * central stiffness kn and shear stiffness kt, thickness h = 1 cm, C11 = sqrt(3)/4 (3 kn + kt)/h, C66 =
 * sqrt(3)/4 (kn + kt)/h. Two materials: harmonic mean of K0 = rho0 c0^2 and of G, mean of S. */
#ifndef DM2_DECK_LATTICE_H
#define DM2_DECK_LATTICE_H

#include "dm2/deck/config.h"

/* The harmonic mean, by which constants of two materials combine; 0 where both are 0. */
double lattice_mean(double a, double b);

/* kn from the Hugoniot data of the two materials, Mbar cm: 4 K0 h/(3 sqrt 3) for uniaxial calibration, 2 K0
 * h/sqrt 3 for bulk. 0 or NaN where a material has no rho0 or c0. */
double lattice_stiffness(const struct material_config *a, const struct material_config *b,
                         enum calibration_kind calibration);

/* The same of a Lennard-Jones potential with its own depth and length, 72 epsilon/(2^(1/3) sigma^2), Mbar cm.
 */
double lattice_atomic_stiffness(double epsilon, double sigma);

/* c0 of the lattice whose bonds have the stiffness kn, cm/us: the inverse of lattice_stiffness for one
 * material of density rho0. NaN where rho0 is. */
double lattice_sound_speed(double kn, double rho0, enum calibration_kind calibration);

/* The Morse shape a = alpha r0 from S: (16 S + 3)/9 for uniaxial calibration, (8 S - 3)/3 for bulk; not above
 * 0 or NaN where S allows no Morse potential. */
double lattice_shape(const struct material_config *a, const struct material_config *b,
                     enum calibration_kind calibration);

/* S of the lattice with the Morse shape a: the inverse of lattice_shape for one material. */
double lattice_slope(double shape, enum calibration_kind calibration);

/* kt = 4 G h/sqrt 3 - kn, kept within [0, kn/2], Mbar cm; with G = 0 where a material has no shear modulus.
 */
double lattice_shear_stiffness(const struct material_config *a, const struct material_config *b, double kn);

/* C66, the shear modulus that a lattice of kn and kt has, Mbar. */
double lattice_shear_modulus(double kn, double kt);

/* The tensile strength Yt of the lattice whose bonds flow at the strongest pull of the potential, Mbar;
 * infinite for the quadratic potential, whose pull has no end. shape: of the Morse potential. */
double lattice_strength(enum potential_kind potential, double kn, double shape);

/* The same of bonds that break at the length stretch r0: at the strongest pull up to there, which no bond
 * exceeds. */
double lattice_strength_to(enum potential_kind potential, double kn, double shape, double stretch);

#endif
