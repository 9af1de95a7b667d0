/* The table of all keywords, and the functions that read the table. Each keyword is declared once, in one
 * row. Reading, defaults, limits, error texts and the check of docs/deck.md use this row. */
#include "schema.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/deck/config.h"
#include "keys.h"

_Static_assert(sizeof(enum potential_kind) == sizeof(int), "a choice is stored as an int");

static const struct deck_key domain_keys[] = {
    {"size", VALUE_REAL, 2, LENGTH, POSITIVE, .required = true, .offset = offsetof(struct config, size),
     .meaning = "width and height of the domain"},
    {"origin", VALUE_REAL, 2, LENGTH, ANY, .initial = "0 0", .offset = offsetof(struct config, origin),
     .meaning = "its lower left corner"},
    {"boundary", VALUE_FLAG, 2, PLAIN, ANY, .choices = "free|periodic", .initial = "free free",
     .offset = offsetof(struct config, periodic),
     .meaning = "in x and in y: `free` (elements may leave and stay in the simulation) or `periodic`"},
    {"r_c", VALUE_REAL, 1, LENGTH, POSITIVE, .required = true, .offset = offsetof(struct config, r_c),
     .meaning = "R_c, the distance up to which elements can interact"},
    {"delta_r", VALUE_REAL, 1, LENGTH, POSITIVE, .required = true, .offset = offsetof(struct config, delta_r),
     .part = PART_WAYS, .meaning = "dR, the least margin of the neighbour lists beyond interaction"},
    {"search", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "cells+lists|lists|cells", .initial = "cells+lists",
     .offset = offsetof(struct config, search), .part = PART_WAYS,
     .meaning = "how pairs are found; the results are the same, bit for bit"},
    {"rebuild_every", VALUE_WHOLE, 1, PLAIN, NOT_NEGATIVE, .initial = "0",
     .offset = offsetof(struct config, rebuild_every), .part = PART_WAYS,
     .meaning = "0: lists are rebuilt when the elements' displacements demand it; K: also every K steps"},
    {"balance", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "space|particles", .initial = "space",
     .offset = offsetof(struct config, balance), .part = PART_WAYS,
     .meaning = "what the servers get equal parts of"},
    {"gravity", VALUE_REAL, 2, ACCELERATION, ANY, .initial = "0 0",
     .offset = offsetof(struct config, gravity), .meaning = "a constant acceleration of every element"},
    {"damping", VALUE_REAL, 1, PLAIN, .low = 0, .high = 1, .high_open = true, .initial = "0",
     .offset = offsetof(struct config, damping),
     .meaning =
         "alpha of local damping, for bodies that shall come to rest: what drives a free element on is "
         "made smaller by this share, what slows it down larger"},
};

static const struct deck_key time_keys[] = {
    {"dt", VALUE_REAL, 1, TIME, POSITIVE, .required = true, .offset = offsetof(struct config, dt),
     .meaning = "the time step: at most 0.5 of the limit that `--check` prints"},
    {"steps", VALUE_WHOLE, 1, PLAIN, NOT_NEGATIVE, .required = true, .offset = offsetof(struct config, steps),
     .part = PART_LOOKS, .meaning = "number of time steps; `--steps` on the command line replaces it"},
};

static const struct deck_key start_keys[] = {
    {"state", VALUE_STATE, 1, PLAIN, ANY, .initial = "that of `--start`",
     .meaning = "the file of the state, in quotes, beside or below the deck; `--start FILE` replaces it"},
    {"without", VALUE_NAMES, 1, PLAIN, ANY, .initial = "none",
     .meaning = "bodies and walls of the state that are left out"},
    {"velocity", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "keep|zero", .initial = "keep",
     .offset = offsetof(struct config, start.velocity),
     .meaning = "do the elements keep their velocities and spins, or begin at rest"},
    {"time", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "zero|keep", .initial = "zero",
     .offset = offsetof(struct config, start.time),
     .meaning = "do steps and time begin at 0, or go on from those of the state"},
    {"links", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "keep|none|form", .initial = "keep",
     .offset = offsetof(struct config, start.links),
     .meaning =
         "do the links of the state last, does none, or do new ones form, without force, where a new body "
         "would have some"},
};

static const struct deck_key material_keys[] = {
    {"rho0", VALUE_REAL, 1, DENSITY, POSITIVE, .initial = "none: give `mass`",
     .offset = offsetof(struct material_config, rho0),
     .meaning = "density; with the radius it makes an element's mass"},
    {"mass", VALUE_REAL, 1, MASS, POSITIVE, .initial = "from `rho0`",
     .offset = offsetof(struct material_config, mass), .meaning = "mass of one element, in place of `rho0`"},
    {"c0", VALUE_REAL, 1, VELOCITY, POSITIVE, .initial = "none: the interaction gives `k` or `epsilon`",
     .offset = offsetof(struct material_config, c0), .meaning = "bulk sound speed: Us = c0 + s up"},
    {"s", VALUE_REAL, 1, PLAIN, NOT_NEGATIVE, .initial = "none: the interaction gives `shape`",
     .offset = offsetof(struct material_config, s), .meaning = "slope of the Hugoniot Us = c0 + s up"},
    {"shear", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "none: no shear stiffness",
     .offset = offsetof(struct material_config, shear), .meaning = "shear modulus G"},
    {"yield", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "none: elastic without limit",
     .offset = offsetof(struct material_config, yield), .meaning = "yield stress Y of the shear resistance"},
    {"tensile", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "none: links break at `link_break` only",
     .offset = offsetof(struct material_config, tensile),
     .meaning = "tensile strength Yt0 at the temperature t0"},
    {"softening", VALUE_REAL, 1, PLAIN, POSITIVE, .initial = "1",
     .offset = offsetof(struct material_config, softening),
     .meaning = "n in Yt(T) = tensile (1 - ((T - t0)/(tm - t0))^n)"},
    {"t0", VALUE_REAL, 1, TEMPERATURE, NOT_NEGATIVE, .initial = "300",
     .offset = offsetof(struct material_config, t0), .meaning = "reference temperature"},
    {"tm", VALUE_REAL, 1, TEMPERATURE, POSITIVE, .initial = "none: no softening",
     .offset = offsetof(struct material_config, tm), .meaning = "melting temperature, where strength ends"},
    {"cp", VALUE_REAL, 1, HEAT_CAPACITY, POSITIVE, .initial = "none: heat is counted, T stays",
     .offset = offsetof(struct material_config, cp), .meaning = "heat capacity"},
    {"kappa", VALUE_REAL, 1, CONDUCTIVITY, NOT_NEGATIVE, .initial = "0",
     .offset = offsetof(struct material_config, kappa), .meaning = "heat conductivity"},
};

#define PHASE(f)    .offset = offsetof(struct phase_config, f)
#define REACTION(f) .offset = offsetof(struct reaction_config, f)
static const struct deck_key phase_keys[] = {
    {"from", VALUE_NAME, 1, PLAIN, ANY, .initial = "the material itself", PHASE(from_name),
     .meaning = "the phase that it forms from: one of the same material and before this one"},
    {"transition", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "pressure|temperature", .required = true,
     PHASE(transition),
     .meaning = "it forms above a pressure, P > p_line + dp_dt (T - t_line), or above a temperature, T > "
                "t_line + dt_dp (P - "
                "p_line)"},
    {"reversible", VALUE_FLAG, 1, PLAIN, ANY, .choices = "no|yes", .initial = "yes", PHASE(reversible),
     .meaning = "does it go back below its line"},
    {"p_line", VALUE_REAL, 1, STRESS, ANY, .initial = "0", PHASE(p_line),
     .meaning = "pressure of one point of the line: half the sum of the stresses in the plane, which is 0.67 "
                "to 0.71 of the axial stress of a plane shock"},
    {"t_line", VALUE_REAL, 1, TEMPERATURE, NOT_NEGATIVE, .required = true, PHASE(t_line),
     .meaning = "temperature of that point, at which `latent` is meant"},
    {"dp_dt", VALUE_REAL, 1, DIM(-1, 1, -2, -1), ANY, .initial = "0", PHASE(dp_dt),
     .meaning = "slope of the line of a transition by pressure"},
    {"dt_dp", VALUE_REAL, 1, DIM(1, -1, 2, 1), ANY, .initial = "0", PHASE(dt_dp),
     .meaning = "slope of the line of a transition by temperature"},
    {"hysteresis_p", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "0", PHASE(hysteresis_p),
     .meaning = "a transition by pressure goes back where P is so much below the line"},
    {"hysteresis_t", VALUE_REAL, 1, TEMPERATURE, NOT_NEGATIVE, .initial = "a tenth more than latent/cp",
     PHASE(hysteresis_t),
     .meaning = "a transition by temperature goes back where T is so much below the line"},
    {"latent", VALUE_REAL, 1, SPECIFIC_ENERGY, ANY, .initial = "0", PHASE(latent),
     .meaning = "heat per mass that forming it takes up; negative: sets free"},
    {"rho0", VALUE_REAL, 1, DENSITY, POSITIVE, .initial = "that of `from`", PHASE(state.rho0),
     .meaning = "density; it scales the radius by the square root of the old density over the new"},
    {"c0", VALUE_REAL, 1, VELOCITY, POSITIVE, .initial = "that of `from`", PHASE(state.c0),
     .meaning = "bulk sound speed: Us = c0 + s up"},
    {"s", VALUE_REAL, 1, PLAIN, NOT_NEGATIVE, .initial = "that of `from`", PHASE(state.s),
     .meaning = "slope of the Hugoniot Us = c0 + s up"},
    {"shear", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "that of `from`", PHASE(state.shear),
     .meaning = "shear modulus G"},
    {"yield", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "that of `from`", PHASE(state.yield),
     .meaning = "yield stress Y of the shear resistance"},
    {"tensile", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "that of `from`", PHASE(state.tensile),
     .meaning = "tensile strength"},
    {"softening", VALUE_REAL, 1, PLAIN, POSITIVE, .initial = "that of `from`", PHASE(state.softening),
     .meaning = "n of the softening with temperature"},
    {"tm", VALUE_REAL, 1, TEMPERATURE, POSITIVE, .initial = "that of `from`", PHASE(state.tm),
     .meaning = "melting temperature, where strength ends"},
    {"cp", VALUE_REAL, 1, HEAT_CAPACITY, POSITIVE, .initial = "that of `from`", PHASE(state.cp),
     .meaning = "heat capacity"},
    {"kappa", VALUE_REAL, 1, CONDUCTIVITY, NOT_NEGATIVE, .initial = "that of `from`", PHASE(state.kappa),
     .meaning = "heat conductivity"},
};

static const struct deck_key reaction_keys[] = {
    {"reactants", VALUE_MATERIALS, 2, PLAIN, ANY, .required = true, REACTION(reactant),
     .meaning = "the two materials that react where elements of them are linked or touch"},
    {"product", VALUE_MATERIALS, 1, PLAIN, ANY, .required = true, REACTION(product),
     .meaning = "the material that they become"},
    {"kind", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "stoichiometric|non-stoichiometric",
     .initial = "stoichiometric", REACTION(kind),
     .meaning = "do the reactants go in the proportion of `masses` or of what the two elements hold"},
    {"masses", VALUE_REAL, 2, PLAIN, POSITIVE, .initial = "none: only for non-stoichiometric",
     REACTION(masses), .meaning = "masses of the reactants that react with each other, such as molar masses"},
    {"k0", VALUE_REAL, 1, DIM(-2, 1, -1, 0), POSITIVE, .required = true, REACTION(k0),
     .meaning = "mass of product per area of contact and time, k0 exp(-ea/(R T))"},
    {"ea", VALUE_REAL, 1, MOLAR_ENERGY, NOT_NEGATIVE, .required = true, REACTION(ea),
     .meaning = "activation energy"},
    {"heat", VALUE_REAL, 1, SPECIFIC_ENERGY, ANY, .required = true, REACTION(heat),
     .meaning = "heat that a mass of product sets free"},
    {"threshold", VALUE_REAL, 1, PLAIN, .low = 0, .low_open = true, .high = 1, .high_open = true,
     .initial = "0.01", REACTION(threshold),
     .meaning = "an element that holds less of the reactants than this becomes the product material"},
};
#undef PHASE
#undef REACTION

#define FIELD(f) .offset = offsetof(struct interaction_config, f)
static const struct deck_key interaction_keys[] = {
    {"potential", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "quadratic|morse|lennard-jones", .initial = "morse",
     FIELD(potential), .meaning = "law of the central force"},
    {"calibration", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "uniaxial|bulk", .initial = "uniaxial",
     FIELD(calibration),
     .meaning =
         "which lattice deformation is fitted to the Hugoniot data: plane shocks or isotropic compression"},
    {"scope", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "linked|all", .initial = "linked", FIELD(scope),
     .meaning =
         "`linked`: linked or contacting pairs; `all`: every pair within `cutoff`, as in molecular dynamics"},
    {"k", VALUE_REAL, 1, STIFFNESS, POSITIVE, .initial = "from rho0 and c0", FIELD(k),
     .meaning = "stiffness of the pair at its contact distance"},
    {"shape", VALUE_REAL, 1, PLAIN, POSITIVE, .initial = "from s", FIELD(shape),
     .meaning = "alpha r0 of the Morse potential"},
    {"epsilon", VALUE_REAL, 1, ENERGY, POSITIVE, .initial = "from k", FIELD(epsilon),
     .meaning = "depth of the Lennard-Jones potential"},
    {"sigma", VALUE_REAL, 1, LENGTH, POSITIVE, .initial = "from the radii", FIELD(sigma),
     .meaning = "length of the Lennard-Jones potential: it is 0 there"},
    {"cutoff", VALUE_REAL, 1, LENGTH, POSITIVE, .initial = "r_c", FIELD(cutoff),
     .meaning = "range of scope `all`"},
    {"zeta", VALUE_REAL, 1, PLAIN, .low = 0, .high = 1, .high_open = true, .initial = "0", FIELD(zeta),
     .meaning = "central damping as a fraction of the critical one"},
    {"a_p", VALUE_REAL, 1, PER_STRESS, ANY, .initial = "0", FIELD(a_p),
     .meaning = "change of damping with pressure"},
    {"a_t", VALUE_REAL, 1, PER_TEMPERATURE, ANY, .initial = "0", FIELD(a_t),
     .meaning = "change of damping with temperature"},
    {"ct_ratio", VALUE_REAL, 1, PLAIN, NOT_NEGATIVE, .initial = "0", FIELD(ct_ratio),
     .meaning = "tangential viscosity over 2 sqrt(k m)"},
    {"kt_ratio", VALUE_REAL, 1, PLAIN, NOT_NEGATIVE, .initial = "from shear", FIELD(kt_ratio),
     .meaning = "tangential over central stiffness"},
    {"mu", VALUE_REAL, 1, PLAIN, NOT_NEGATIVE, .initial = "0", FIELD(mu), .meaning = "dry friction"},
    {"yield", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "the weaker material's", FIELD(yield),
     .meaning = "yield stress of the pair in shear"},
    {"tensile", VALUE_REAL, 1, STRESS, NOT_NEGATIVE, .initial = "the weaker material's", FIELD(tensile),
     .meaning = "tensile strength of the pair"},
    {"link_form", VALUE_REAL, 1, PLAIN, .low = 0, .high = 1, .high_open = true, .initial = "0",
     FIELD(link_form), .meaning = "a link forms at this fraction of the contact distance; 0: never"},
    {"link_break", VALUE_REAL, 1, PLAIN, .low = 1, .high = HUGE_VAL, .initial = "1.05", FIELD(link_break),
     .meaning = "a link breaks at this multiple of the contact distance"},
    {"linked", VALUE_FLAG, 1, PLAIN, ANY, .choices = "no|yes",
     .initial = "yes in a grain, no between grains and bodies", FIELD(linked),
     .meaning = "do lattice neighbours start linked"},
    {"conductance", VALUE_REAL, 1, PLAIN, NOT_NEGATIVE, .initial = "1", FIELD(conductance),
     .meaning = "factor on the heat conductivity of the pair"},
};
#undef FIELD

#define FIELD(f) .offset = offsetof(struct body_config, f)
static const struct deck_key body_keys[] = {
    {"from", VALUE_FLAG, 1, PLAIN, ANY, .choices = "deck|state", .initial = "deck", FIELD(from_state),
     .meaning = "`state`: its elements are those of the state's body of this name; then only `motion`, "
                "`velocity` and `spin` may be given"},
    {"shape", VALUE_SHAPE, 1, LENGTH, ANY, .required = true, FIELD(shape),
     .meaning =
         "`rectangle x0 y0 x1 y1`, `disc x y radius` or `polygon x y x y x y ...`: where the centres of its "
         "elements lie"},
    {"structure", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "crystal|polycrystal|discs|polygons",
     .initial = "crystal", FIELD(structure),
     .meaning = "one lattice; Voronoi grains, each turned at random; or a powder of such discs or polygons"},
    {"grain_size", VALUE_REAL, 1, LENGTH, POSITIVE, .initial = "none: a crystal has one grain",
     FIELD(grain_size), .meaning = "mean diameter of the grains of a polycrystal or powder"},
    {"grain_spread", VALUE_REAL, 1, PLAIN, .low = 0, .high = 1, .high_open = true, .initial = "0",
     FIELD(grain_spread),
     .meaning = "diameters of powder grains are uniform within grain_size (1 plus or minus this)"},
    {"solid_fraction", VALUE_REAL, 1, PLAIN, .low = 0, .low_open = true, .high = 1,
     .initial = "none: powders need it", FIELD(solid_fraction),
     .meaning = "mass of a powder over the mass of a full lattice in the shape"},
    {"missing_links", VALUE_REAL, 1, PLAIN, .low = 0, .high = 1, .initial = "0", FIELD(missing_links),
     .meaning = "this fraction of the body's links, at random, is not there at the start"},
    {"lattice", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "hexagonal|square", .initial = "hexagonal",
     FIELD(lattice), .meaning = "how the elements are placed"},
    {"spacing", VALUE_REAL, 1, LENGTH, POSITIVE, .required = true, FIELD(spacing),
     .meaning = "distance of neighbours in a row"},
    {"row_spacing", VALUE_REAL, 1, LENGTH, POSITIVE,
     .initial = "sqrt(3)/2 spacing; spacing on a square lattice", FIELD(row_spacing),
     .meaning = "distance of rows"},
    {"origin", VALUE_REAL, 2, LENGTH, ANY, .initial = "0 0", FIELD(origin),
     .meaning = "where one lattice site lies; bodies that share origin and spacing are one lattice"},
    {"angle", VALUE_REAL, 1, PLAIN, ANY, .initial = "0", FIELD(angle),
     .meaning = "of the rows against the x axis, in radians or with `deg`"},
    {"radius", VALUE_REAL, 1, LENGTH, POSITIVE, .initial = "spacing/2", FIELD(radius),
     .meaning = "of the elements"},
    {"material", VALUE_MATERIAL, 1, PLAIN, ANY, .initial = "none: give `mix`", FIELD(mix_material),
     .meaning = "what it is made of"},
    {"mix", VALUE_MIX, 1, PLAIN, .low = 0, .low_open = true, .high = 1, .initial = "none: give `material`",
     FIELD(mix_fraction),
     .meaning =
         "materials and their fractions, at random over the elements (of a polycrystal or powder: over the "
         "grains): `Ni 0.5, Al 0.5`"},
    {"seed", VALUE_WHOLE, 1, PLAIN, NOT_NEGATIVE, .initial = "0", FIELD(seed),
     .meaning = "of the mix, the random velocities, the grains and the missing links"},
    {"motion", VALUE_CHOICE, 1, PLAIN, ANY, .choices = "free|fixed|driven", .initial = "free", FIELD(motion),
     .meaning = "`free`: forces move it; `fixed`: it stays; `driven`: it keeps `velocity`, whatever the "
                "forces (a piston)"},
    {"velocity", VALUE_REAL, 2, VELOCITY, ANY, .initial = "0 0", FIELD(velocity),
     .meaning = "at the start, or for ever if driven"},
    {"jitter", VALUE_REAL, 1, VELOCITY, NOT_NEGATIVE, .initial = "0", FIELD(jitter),
     .meaning =
         "random part of each element's velocity: each component is uniform within plus or minus this"},
    {"spin", VALUE_REAL, 1, SPIN, ANY, .initial = "0", FIELD(spin),
     .meaning = "angular velocity about the centroid, counter-clockwise: of a free body at the start, of a "
                "driven one always"},
    {"temperature", VALUE_REAL, 1, TEMPERATURE, NOT_NEGATIVE, .initial = "300", FIELD(temperature),
     .meaning = "at the start"},
};
#undef FIELD

static const struct deck_key void_keys[] = {
    {"shape", VALUE_SHAPE, 1, LENGTH, ANY, .required = true, .offset = offsetof(struct void_config, shape),
     .meaning = "as of a body: no element has its centre there"},
    {"body", VALUE_BODY, 1, PLAIN, ANY, .initial = "every body", .offset = offsetof(struct void_config, body),
     .meaning = "the body that has the void"},
};

static const struct deck_key flaw_keys[] = {
    {"line", VALUE_REAL, 4, LENGTH, ANY, .required = true, .offset = offsetof(struct flaw_config, line),
     .meaning = "`x0 y0 x1 y1`: no link crosses it at the start"},
    {"body", VALUE_BODY, 1, PLAIN, ANY, .initial = "every body", .offset = offsetof(struct flaw_config, body),
     .meaning = "the body that has the flaw"},
};

#define FIELD(f) .offset = offsetof(struct wall_config, f)
static const struct deck_key wall_keys[] = {
    {"line", VALUE_LINE, 1, LENGTH, ANY, .initial = "none: give `circle`",
     .meaning = "`x0 y0 x1 y1 ...`: points that straight parts join, closed where the last point is the "
                "first, also across a periodic side"},
    {"circle", VALUE_REAL, 3, LENGTH, ANY, .initial = "none: give `line`", FIELD(circle),
     .meaning = "`x y radius`"},
    {"material", VALUE_MATERIALS, 1, PLAIN, ANY, .initial = "none: give `rigid`", FIELD(material),
     .meaning = "whose interactions hold, as between two bodies"},
    {"rigid", VALUE_FLAG, 1, PLAIN, ANY, .choices = "no|yes", .initial = "no", FIELD(rigid),
     .meaning =
         "`yes` in place of a material: an element meets its mirror image, with twice the stiffness of "
         "its own law"},
    {"velocity", VALUE_REAL, 2, VELOCITY, ANY, .initial = "0 0", FIELD(velocity),
     .meaning = "for ever, whatever the forces"},
    {"spin", VALUE_REAL, 1, SPIN, ANY, .initial = "0", FIELD(spin),
     .meaning = "angle per time, anticlockwise, about the circle's centre or the mean of the points"},
    {"temperature", VALUE_REAL, 1, TEMPERATURE, NOT_NEGATIVE, .initial = "none: no conduction",
     FIELD(temperature), .meaning = "which heat does not change"},
};
#undef FIELD

#define FIELD(f) .offset = offsetof(struct probe_config, f)
static const struct deck_key probe_keys[] = {
    {"region", VALUE_REAL, 4, LENGTH, ANY, .initial = "none: give `body`", FIELD(box),
     .meaning = "`x0 y0 x1 y1`: the elements that start in it are averaged; half-open, x0 <= x < x1"},
    {"body", VALUE_MOVER, 1, PLAIN, ANY, .initial = "none: give `region`", FIELD(mover), .part = PART_COLUMNS,
     .meaning = "the body or wall that is measured"},
    {"report", VALUE_SET, 1, PLAIN, ANY,
     .choices = "position|velocity|force|torque|spin|stress|temperature|kinetic|porosity|heat",
     .initial = "position, velocity, and force of a body or wall", FIELD(report), .part = PART_COLUMNS,
     .meaning = "the columns, below"},
};
#undef FIELD

#define FIELD(f) .offset = offsetof(struct profile_config, f)
static const struct deck_key profile_keys[] = {
    {"axis", VALUE_CHOICE, 1, PLAIN, ANY, .required = true, .choices = "x|y", FIELD(axis),
     .part = PART_COLUMNS, .meaning = "the axis that is cut into bins"},
    {"bins", VALUE_WHOLE, 1, PLAIN, .low = 1, .high = 10000, .required = true, FIELD(bins),
     .part = PART_COLUMNS, .meaning = "how many bins"},
    {"range", VALUE_REAL, 2, LENGTH, ANY, .initial = "the domain", FIELD(range), .part = PART_COLUMNS,
     .meaning = "from where to where the bins reach; elements outside are in none"},
    {"every", VALUE_WHOLE, 1, PLAIN, .low = 1, .high = HUGE_VAL, .initial = "steps/20, at least 1",
     FIELD(every), .part = PART_LOOKS,
     .meaning = "steps between profiles; the last state has one in any case"},
};
#undef FIELD

#define FIELD(f) .offset = offsetof(struct stop_config, f)
static const struct deck_key stop_keys[] = {
    {"unbalanced", VALUE_REAL, 1, PLAIN, POSITIVE, .initial = "none", FIELD(unbalanced), .part = PART_LOOKS,
     .meaning = "holds where `unbalanced` of history.csv is below this"},
    {"kinetic", VALUE_REAL, 1, ENERGY, POSITIVE, .initial = "none", FIELD(kinetic), .part = PART_LOOKS,
     .meaning = "holds where the kinetic energy is below this"},
    {"probe", VALUE_LIMIT, 1, PLAIN, ANY, .initial = "none", FIELD(column), .part = PART_LOOKS,
     .meaning =
         "`NAME fy above 0.01`: holds where this quantity of the probe is `above` or `below` the number"},
    {"after", VALUE_REAL, 1, TIME, NOT_NEGATIVE, .initial = "0", FIELD(after), .part = PART_LOOKS,
     .meaning = "the block ends the run once its conditions have held at all rows of this time"},
};
#undef FIELD

#define FIELD(f) .offset = offsetof(struct config, output.f)
static const struct deck_key output_keys[] = {
    {"history_every", VALUE_WHOLE, 1, PLAIN, .low = 1, .high = HUGE_VAL, .initial = "steps/200, at least 150",
     FIELD(history_every), .part = PART_LOOKS, .meaning = "steps between rows of history.csv"},
    {"snapshot_every", VALUE_WHOLE, 1, PLAIN, NOT_NEGATIVE, .initial = "0", FIELD(snapshot_every),
     .part = PART_LOOKS, .meaning = "steps between snapshots; 0: none but those of `snapshot_at`"},
    {"snapshot_at", VALUE_STEPS, 1, PLAIN, NOT_NEGATIVE, .initial = "none", FIELD(snapshot_at),
     .part = PART_LOOKS, .meaning = "further steps to take a snapshot at, in any order"},
    {"checkpoint_every", VALUE_WHOLE, 1, PLAIN, NOT_NEGATIVE, .initial = "0", FIELD(checkpoint_every),
     .part = PART_LOOKS, .meaning = "steps between checkpoints, from which `--restart` continues; 0: none"},
    {"format", VALUE_FORMATS, 1, PLAIN, ANY, .choices = "vtp|xyz", .initial = "vtp", FIELD(vtp),
     .part = PART_LOOKS, .meaning = "of snapshots: `vtp` (ParaView), `xyz` (OVITO), or both"},
    {"fields", VALUE_SET, 1, PLAIN, ANY,
     .choices = "id|kind|body|grain|radius|velocity|spin|temperature|pressure|stress|phase|composition|links|"
                "contacts|bonds|damage|fragment|strain|image|pairs",
     .initial = "all that the deck has", FIELD(fields), .part = PART_LOOKS,
     .meaning = "what snapshots have of each element beside its place, and the pairs with their forces"},
    {"bodies", VALUE_BODIES, 1, PLAIN, ANY, .initial = "all", FIELD(bodies), .part = PART_LOOKS,
     .meaning = "the bodies whose elements snapshots show"},
    {"strain", VALUE_FLAG, 1, PLAIN, ANY, .choices = "no|yes", .initial = "no", FIELD(strain),
     .meaning = "is the strain of the elements measured, for snapshots; it costs some time at every step"},
};
#undef FIELD

#define KEYS(k) k, sizeof k / sizeof k[0]
static const struct block_schema blocks[BLOCK_COUNT] = {
    [BLOCK_DOMAIN] = {"domain", "nothing", true, true, KEYS(domain_keys)},
    [BLOCK_TIME] = {"time", "nothing", true, true, KEYS(time_keys)},
    [BLOCK_START] = {"start", "nothing", true, false, KEYS(start_keys)},
    [BLOCK_MATERIAL] = {"material", "a name", false, true, KEYS(material_keys)},
    [BLOCK_PHASE] = {"phase", "a material and a name", false, false, KEYS(phase_keys)},
    [BLOCK_REACTION] = {"reaction", "a name", false, false, KEYS(reaction_keys)},
    [BLOCK_INTERACTION] = {"interaction", "nothing or two materials", false, false, KEYS(interaction_keys)},
    [BLOCK_INTERFACE] = {"interface", "grain or body, and nothing or two materials", false, false,
                         KEYS(interaction_keys)},
    [BLOCK_BODY] = {"body", "a name", false, true, KEYS(body_keys)},
    [BLOCK_VOID] = {"void", "a name", false, false, KEYS(void_keys)},
    [BLOCK_FLAW] = {"flaw", "a name", false, false, KEYS(flaw_keys)},
    [BLOCK_LOAD] = {"load", "a name", false, false, load_keys, LOAD_KEYS},
    [BLOCK_WALL] = {"wall", "a name", false, false, KEYS(wall_keys)},
    [BLOCK_PROBE] = {"probe", "a name", false, false, KEYS(probe_keys)},
    [BLOCK_PROFILE] = {"profile", "a name", false, false, KEYS(profile_keys)},
    [BLOCK_STOP] = {"stop", "nothing", false, false, KEYS(stop_keys)},
    [BLOCK_OUTPUT] = {"output", "nothing", true, false, KEYS(output_keys)},
};

const struct block_schema *schema_block(enum block_kind kind)
{
    return &blocks[kind];
}

static bool word_is(const char *name, const char *word, size_t length)
{
    return strlen(name) == length && memcmp(name, word, length) == 0;
}

enum block_kind schema_find_block(const char *word, size_t length)
{
    int kind = 0;
    while (kind < BLOCK_COUNT && !word_is(blocks[kind].name, word, length))
        kind++;
    return (enum block_kind)kind;
}

int schema_find_key(const struct block_schema *block, const char *word, size_t length)
{
    for (size_t i = 0; i < block->n_keys; i++)
        if (word_is(block->keys[i].name, word, length))
            return (int)i;
    return -1;
}

const char *schema_block_of_key(const char *word, size_t length)
{
    for (int kind = 0; kind < BLOCK_COUNT; kind++)
        if (schema_find_key(&blocks[kind], word, length) >= 0)
            return blocks[kind].name;
    return NULL;
}

int schema_find_choice(const char *choices, const char *word, size_t length)
{
    for (int i = 0;; i++) {
        size_t n = strcspn(choices, "|");
        if (n == length && memcmp(choices, word, length) == 0)
            return i;
        if (choices[n] == '\0')
            return -1;
        choices += n + 1;
    }
}

size_t schema_size(const struct deck_key *key)
{
    switch (key->type) {
    case VALUE_REAL:
        return (size_t)key->count * sizeof(double);
    case VALUE_WHOLE:
        return sizeof(int64_t);
    case VALUE_CHOICE:
        return sizeof(int);
    case VALUE_FLAG:
        return (size_t)key->count * sizeof(bool);
    default:
        return 0;
    }
}

/* Sets a default of `count` words; the first choice, or false, where the table has no default. */
static void set_default_words(const struct deck_key *key, void *at)
{
    const char *word = key->initial;
    for (int i = 0; i < key->count; i++) {
        size_t n = word == NULL ? 0 : strcspn(word, " ");
        int choice = word == NULL ? -1 : schema_find_choice(key->choices, word, n);
        if (key->type == VALUE_CHOICE)
            ((int *)at)[i] = choice < 0 ? 0 : choice;
        else
            ((bool *)at)[i] = choice == 1;
        word = word == NULL || word[n] == '\0' ? NULL : word + n + 1;
    }
}

static void set_default_numbers(const struct deck_key *key, void *at)
{
    const char *word = key->initial;
    for (int i = 0; i < key->count; i++) {
        char *end = NULL;
        double value = (double)NAN;
        if (word != NULL && ((word[0] >= '0' && word[0] <= '9') || word[0] == ' ')) {
            value = strtod(word, &end);
            word = end;
        }
        if (key->type == VALUE_REAL)
            ((double *)at)[i] = value;
        else
            *(int64_t *)at = isnan(value) ? -1 : (int64_t)value;
    }
}

void schema_defaults(const struct block_schema *block, void *base)
{
    for (size_t i = 0; i < block->n_keys; i++) {
        const struct deck_key *key = &block->keys[i];
        void *at = (char *)base + key->offset;
        if (key->type == VALUE_CHOICE || key->type == VALUE_FLAG)
            set_default_words(key, at);
        else if (key->type == VALUE_REAL || key->type == VALUE_WHOLE)
            set_default_numbers(key, at);
    }
}

static const char *block_name(const void *context, size_t i)
{
    (void)context;
    return blocks[i].name;
}

struct word_list schema_block_names(void)
{
    return (struct word_list){block_name, NULL, BLOCK_COUNT};
}

static const char *key_name(const void *context, size_t i)
{
    return ((const struct block_schema *)context)->keys[i].name;
}

struct word_list schema_key_names(const struct block_schema *block)
{
    return (struct word_list){key_name, block, block->n_keys};
}
