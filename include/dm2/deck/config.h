/* The config: what a deck says, in base units, checked; nothing is derived yet.
 *
 * deck_load (dm2/deck/deck.h) fills a struct config; model_build (dm2/engine/model.h) derives the tables from
 * which the engine computes. Base units: cm, g, us, K; so velocity cm/us, stress Mbar, energy g cm2/us2 (1e5
 * J). The model is two-dimensional with a depth of h = 1 cm.
 *
 * A double that the deck did not set is NaN where its comment says "NaN: ...". */
#ifndef DM2_DECK_CONFIG_H
#define DM2_DECK_CONFIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"

enum { NAME_MAX_LENGTH = 31, PROBE_MAX = 64, PROFILE_MAX = 8, MIX_MAX = 4, POLYGON_MAX = 64 };
typedef char name_text[NAME_MAX_LENGTH + 1];

enum potential_kind { POTENTIAL_QUADRATIC, POTENTIAL_MORSE, POTENTIAL_LENNARD_JONES };
enum calibration_kind { CALIBRATION_UNIAXIAL, CALIBRATION_BULK };
enum scope_kind { SCOPE_LINKED, SCOPE_ALL };
enum search_kind { SEARCH_CELLS_AND_LISTS, SEARCH_LISTS, SEARCH_CELLS };
enum balance_kind { BALANCE_SPACE, BALANCE_PARTICLES };
enum lattice_kind { LATTICE_HEXAGONAL, LATTICE_SQUARE };
enum motion_kind { MOTION_FREE, MOTION_FIXED, MOTION_DRIVEN };
enum transition_kind { TRANSITION_PRESSURE, TRANSITION_TEMPERATURE };
enum reaction_kind { REACTION_STOICHIOMETRIC, REACTION_NON_STOICHIOMETRIC };
enum structure_kind { STRUCTURE_CRYSTAL, STRUCTURE_POLYCRYSTAL, STRUCTURE_DISCS, STRUCTURE_POLYGONS };
enum shape_kind { SHAPE_RECTANGLE, SHAPE_DISC, SHAPE_POLYGON };

/* What a load prescribes in time. The keyword of each is in the schema's block `load`, in this order. */
enum load_quantity {
    LOAD_VELOCITY_X, /* cm/us; of a driven body or a wall, as the next five */
    LOAD_VELOCITY_Y,
    LOAD_SPIN,    /* 1/us, counter-clockwise, about the centroid */
    LOAD_FORCE_X, /* Mbar cm2 */
    LOAD_FORCE_Y,
    LOAD_STRESS_XX, /* Mbar, tension positive */
    LOAD_STRESS_YY,
    LOAD_TEMPERATURE,    /* K, of any body or wall */
    LOAD_ACCELERATION_X, /* cm/us2, of a free body */
    LOAD_ACCELERATION_Y,
    LOAD_QUANTITIES
};

/* material NAME { ... } */
struct material_config {
    name_text name;
    double rho0;      /* density, g/cm3; NaN: `mass` is given instead */
    double mass;      /* mass of one element, g; NaN: from rho0 and the radius */
    double c0;        /* bulk sound speed of Us = c0 + s up, cm/us; NaN: interaction gives k or epsilon */
    double s;         /* slope of Us = c0 + s up; NaN: interaction gives shape */
    double shear;     /* shear modulus G, Mbar; NaN: no shear stiffness from the material */
    double yield;     /* flow stress Y, Mbar: shear yields at Y/2 to Y/sqrt(3); NaN: elastic */
    double tensile;   /* tensile strength Yt0, Mbar; NaN: links only break at link_break */
    double softening; /* exponent n of Yt(T), default 1 */
    double t0;        /* reference temperature T0, K, default 300 */
    double tm;        /* melting temperature, K; NaN: no softening with temperature */
    double cp;        /* heat capacity, cm2/us2/K; NaN: heat is counted but T stays */
    double kappa;     /* conductivity, g cm/us3/K; 0 by default */
};

/* phase MATERIAL NAME { ... }: a further phase of a material, and the line at which the phase forms. The line
 * is P = p_line + dp_dt (T - t_line), or T = t_line + dt_dp (P - p_line); the phase is stable above its
 * line. */
struct phase_config {
    name_text name;
    int material;
    name_text from_name; /* the phase from which this one forms; "": the material as its own block gives it */
    int from;            /* the index of the phase `from_name`, which is before this one; -1: the material */
    enum transition_kind transition;
    bool reversible;              /* default yes */
    double p_line;                /* Mbar, default 0 */
    double t_line;                /* K */
    double dp_dt, dt_dp;          /* Mbar/K, K/Mbar, default 0 */
    double hysteresis_p;          /* the phase goes back at this much below the line, Mbar, default 0 */
    double hysteresis_t;          /* the same in K; NaN: 1.1 times latent heat over heat capacity */
    double latent;                /* heat taken up at t_line, cm2/us2 */
    struct material_config state; /* constants of the phase; a constant that the deck omits has the value of
                                     the phase from which this one forms */
};

/* reaction NAME { ... }: A + B -> product in contacting elements. */
struct reaction_config {
    name_text name;
    int reactant[2], product; /* materials; -1: unknown */
    enum reaction_kind kind;
    double masses[2]; /* masses that react with each other, in any unit; NaN: non-stoichiometric */
    double k0;        /* rate per facet, g/cm2/us */
    double ea;        /* activation energy, g cm2/us2/mol */
    double heat;      /* heat set free per mass of product, cm2/us2 */
    double threshold; /* an element with less of its reactants than this becomes the product material */
};

/* The interaction of a pair of elements, resolved for two materials and a relation. */
struct interaction_config {
    enum potential_kind potential;     /* default Morse */
    enum calibration_kind calibration; /* default uniaxial */
    enum scope_kind scope;             /* default linked */
    double k;                          /* stiffness at r0, Mbar cm; NaN: from the materials' Hugoniot data */
    double shape;                      /* alpha r0 of the Morse potential; NaN: from S */
    double epsilon, sigma;             /* Lennard-Jones, energy and length; NaN: from k and r0 */
    double cutoff;                     /* range of scope `all`, cm; NaN: r_c */
    double zeta;                       /* fraction of critical central damping, default 0 */
    double a_p, a_t;                   /* change of the damping with P (1/Mbar) and T (1/K), default 0 */
    double ct_ratio;                   /* tangential viscosity c_t / (2 sqrt(k m_eff)), default 0 */
    double kt_ratio;                   /* kt / kn; NaN: from G */
    double mu;                         /* dry friction, default 0 */
    double yield, tensile; /* of the pair, in place of the weaker material's Y and Yt0; NaN: not given */
    double link_form, link_break; /* in r0; defaults 0 (no welding) and 1.05 */
    bool linked;                  /* lattice neighbours start linked; default yes in one grain, else no */
    double conductance;           /* factor on kappa_ij, default 1 */
};

/* The relation of two elements: which interface lies between them. */
enum relation { RELATION_SAME_GRAIN, RELATION_OTHER_GRAIN, RELATION_OTHER_BODY, RELATION_COUNT };

struct shape_config {
    enum shape_kind kind;
    double box[4];     /* rectangle: x0 y0 x1 y1, half-open: x0 <= x < x1; of the centre of an element */
    double centre[2];  /* disc */
    double radius;     /* disc */
    size_t n_vertices; /* polygon */
    double vertex[POLYGON_MAX][2];
};

/* A body of a state, as its elements are there. */
struct body_start {
    uint32_t id_first, id_end;       /* its elements have the ids id_first .. id_end - 1 */
    uint32_t grain_first, grain_end; /* its grains are among grain_first .. grain_end - 1 */
    double centroid[2];              /* centre of mass, not wrapped, cm */
    double low[2], high[2];          /* what its elements cover, with their radii, cm */
    double mass;                     /* g */
    double least, lightest;          /* smallest radius, cm; least mass of an element of this radius, g */
};

/* body NAME { ... }: a shape filled with elements on a lattice. */
struct body_config {
    name_text name;
    struct shape_config shape;
    enum lattice_kind lattice;
    enum structure_kind structure; /* one crystal, a polycrystal, a powder of discs or of polygons */
    double grain_size;             /* mean diameter of grains, cm; NaN for a crystal */
    double grain_spread;           /* of a powder: diameters are uniform in grain_size (1 +- spread) */
    double solid_fraction;         /* of a powder: mass over that of a full lattice; NaN otherwise */
    char *packing_place;  /* place of `solid_fraction` in the deck, for config_fail; NULL: no powder, or
                             unknown */
    double missing_links; /* fraction of the body's own initial links that are missing */
    double spacing;       /* d, cm */
    double row_spacing;   /* cm; default sqrt(3)/2 d, or d on the square lattice */
    double origin[2];     /* the position of one lattice site, cm; rows are counted from there */
    double angle;         /* angle between the rows and the x axis, radians, default 0 */
    double radius;        /* R of the elements, cm; default d/2 */
    size_t n_mix;         /* materials and their volume fractions; the fractions sum to 1 */
    int mix_material[MIX_MAX];
    double mix_fraction[MIX_MAX];
    uint64_t seed; /* seed of everything random in the body */
    enum motion_kind
        motion;         /* free, fixed, or driven: moves with `velocity` at all times, whatever the forces */
    double velocity[2]; /* cm/us */
    double jitter; /* each velocity component is uniform in +-jitter about `velocity`, cm/us; default 0 */
    double spin;   /* 1/us about the centroid: of a free body at the start, of a driven one always */
    double temperature; /* K, default 300 */
    bool from_state;    /* its elements are those of the body of this name in the state that the run begins
                           from; then the rest of the body says how they were made, once */
    bool pushed; /* of a free body from the state: the deck gives `velocity`, and its elements get it */
    struct body_start start; /* of a body from the state */
};

/* The index of a body or a wall: bodies in deck order, then walls in deck order. */
enum { MOVER_MAX = 2 * 65535 };
#define MOVER_NONE ((size_t)-1)

/* load NAME { ... }: one quantity of a body or a wall as a function of time, linear between points. A block
 * with several quantities gives as many loads of one name. */
struct load_config {
    name_text name;
    size_t mover;
    enum load_quantity quantity;
    size_t n;          /* points, 2 to LOAD_POINTS_MAX */
    double *time;      /* [n] us, ascending */
    double *value;     /* [n] */
    bool repeat;       /* the points are one period; default: the first and the last value hold beyond */
    double length;     /* cm, across the load, on which a stress acts; NaN: by `between` or by the mover */
    size_t between[2]; /* movers whose gap is that length; MOVER_NONE: not given */
    double zeta; /* damping of a mover under a force or a stress, fraction of the critical; default 0.7 */
    double max_velocity; /* cm/us, of a mover under a force or a stress; NaN: by the load */
    double mass;         /* g, of a mover under a force or a stress; NaN: by the time step */
    char *mass_place;    /* place of `mass`, or of the load, in the deck, for config_fail; NULL: unknown */
};
enum { LOAD_POINTS_MAX = 100000 };

/* void NAME { ... }: no element of the body, or of any body, has its centre in the shape. */
struct void_config {
    name_text name;
    struct shape_config shape;
    int body; /* -1: any */
};

/* flaw NAME { ... }: no initial link crosses the line: no link within the body, or no link at all. */
struct flaw_config {
    name_text name;
    double line[4]; /* x0 y0 x1 y1, cm */
    int body;       /* -1: any */
};

/* What a probe reports; bit q of probe_config.report: the columns of quantity q. */
enum probe_quantity {
    REPORT_POSITION,
    REPORT_VELOCITY,
    REPORT_FORCE,
    REPORT_TORQUE,
    REPORT_SPIN,
    REPORT_STRESS,
    REPORT_TEMPERATURE,
    REPORT_KINETIC,
    REPORT_POROSITY,
    REPORT_HEAT,
    REPORT_COUNT
};

/* probe NAME { region = x0 y0 x1 y1 } or { body = NAME }: the elements that start in the region, or those of
 * the body; or a wall. What they report are columns of history.csv. At most REGION_MAX probes are of regions.
 */
enum { REGION_MAX = 8 };
struct probe_config {
    name_text name;
    double box[4];   /* the region; of a body, the box around its shape; of a wall, 0 */
    int mover;       /* of bodies, then walls; -1: of a region */
    bool wall;       /* the mover is a wall */
    int bit;         /* of element.probes, 0 to REGION_MAX - 1; -1: of a body or wall */
    uint32_t report; /* default position and velocity, and force of a body or wall */
};

/* stop { ... }: the run ends when all conditions of one such block hold at a row of history.csv, and have
 * held at all rows of the last `after`. */
struct stop_config {
    double unbalanced, kinetic;       /* hold below these values; kinetic in g cm2/us2; NaN: no condition */
    char column[2 * NAME_MAX_LENGTH]; /* of a probe, PROBE_QUANTITY in history.csv; "": no condition */
    bool above;                       /* the column's condition holds above `value`; false: below it */
    double value;                     /* in base units */
    double after;                     /* us, default 0 */
};

/* wall NAME { ... }: a line or a circle without thickness that elements touch. */
struct wall_config {
    name_text name;
    size_t n_points; /* of the line, at least 2; 0: a circle */
    double *points; /* [n_points][2], cm; NULL: a circle. Of a closed line the last point is the first one, or
                       the image of the first one across a periodic side */
    bool closed;    /* the line's ends meet */
    int seam[2];    /* of a closed line: sizes of the domain from the first point to the last */
    double circle[3];   /* x y radius, cm; NaN: a line */
    int material;       /* -1: rigid */
    bool rigid;         /* twice the stiffness of the element's own law */
    double velocity[2]; /* cm/us */
    double spin;        /* 1/us, about the circle's centre or the mean of the points */
    double temperature; /* K; NaN: no conduction */
    char *place;        /* of the block in the deck, for config_fail; NULL: unknown */
};

enum axis_kind { AXIS_X, AXIS_Y };

/* profile NAME { axis = x|y ... }: means over bins along an axis, in profile-NAME.csv. */
struct profile_config {
    name_text name;
    enum axis_kind axis;
    int64_t bins;    /* 1 to 10000 */
    double range[2]; /* cm; default the domain */
    int64_t every;   /* steps between profiles, default 1/20 of the run, at least 1 */
};

#define OUTPUT_ALL_FIELDS ((UINT32_C(1) << 20) - 1)
struct output_config {
    int64_t history_every;    /* steps between rows of history.csv, default 1/200 of the run, at least 1 */
    int64_t snapshot_every;   /* 0: no snapshots by interval */
    int64_t checkpoint_every; /* steps between checkpoints; 0: no checkpoints by interval */
    size_t n_snapshot_at;
    int64_t *snapshot_at; /* further steps, ascending, without repeats */
    bool vtp, xyz;        /* formats; default vtp */
    bool strain;          /* measure the strain of elements; default no */
    uint32_t fields; /* bit k: snapshots have field k of output/snapshot_fields, or behind these the pairs;
                        default all */
    bool *bodies;    /* [n_bodies] snapshots show the elements of the body; NULL: of all */
};

enum start_velocity { START_KEEP_VELOCITY, START_AT_REST };
enum start_time { START_AT_ZERO, START_KEEP_TIME };
enum start_links { START_KEEP_LINKS, START_WITHOUT_LINKS, START_FORM_LINKS };

/* start { ... }: the run begins from a state of another deck. */
enum { START_DIGEST = 65 }; /* bytes of a SHA-256 as a text */
struct start_config {
    bool on;
    char state[START_DIGEST]; /* the digest of the state's file */
    name_text *without;       /* [n_without] ascending: bodies and walls of the state that are left out */
    size_t n_without;
    enum start_velocity velocity;
    enum start_time time;
    enum start_links links;
    uint32_t next_id, next_grain; /* of the first new element and grain; 0 without `on` */
};

struct config {
    double origin[2], size[2]; /* of the domain, cm */
    bool periodic[2];
    double r_c, delta_r; /* R_c and the margin dR of the lists, cm */
    enum search_kind search;
    int64_t rebuild_every; /* 0: lists are rebuilt when the displacements demand it; K: also every K steps */
    enum balance_kind balance;
    double dt;          /* us */
    char *dt_place;     /* place of `dt` in the deck, for config_fail; NULL: unknown */
    int64_t steps;      /* fewer than deck_steps where a block `stop` has ended the run */
    int64_t deck_steps; /* as the deck or --steps says */
    int64_t n_start; /* the step with which the run's stage begins, its first one; 0 without a stage before */
    double t_start;  /* time of that step, us */
    bool
        same_clock; /* a stage that keeps time and dt: times are those of the run before, to the last digit */
    int64_t n_clock; /* then the n_start and t_start of that run */
    double t_clock;
    double
        dt_before; /* of the steps before n_start, us; 0: the velocities at n_start are those of that time */
    struct start_config start;
    double gravity[2]; /* body acceleration, cm/us2 */
    double damping;    /* alpha of local damping, 0 <= alpha < 1; 0 by default */
    size_t n_materials, n_phases, n_reactions, n_bodies, n_probes, n_profiles, n_voids, n_flaws, n_loads,
        n_stops, n_walls;
    struct material_config *materials;
    struct phase_config *phases;       /* in deck order: kind n_materials + i is phase i */
    struct reaction_config *reactions; /* none or one */
    struct body_config *bodies;
    struct probe_config *probes;
    struct profile_config *profiles;
    struct stop_config *stops;
    struct void_config *voids;
    struct flaw_config *flaws;
    struct load_config *loads;
    struct wall_config *walls;
    struct output_config output;
    struct interaction_rule *rules; /* rules of interactions, resolved by config_interaction */
    size_t n_rules;
};

/* The interaction of materials a and b (indices in any order) in `relation`: the defaults above, overridden
 * by each matching rule from the least to the most specific: `interaction {}`, `interface grain|body {}`,
 * `interaction A B {}`, `interface grain|body A B {}`. */
struct interaction_config config_interaction(const struct config *c, int a, int b, enum relation relation);

/* The number of kinds of elements. A kind is a material with a phase. */
static inline size_t config_kinds(const struct config *c)
{
    return c->n_materials + c->n_phases;
}

/* The number of movers, and the name of one. */
size_t config_movers(const struct config *c);
const char *config_mover_name(const struct config *c, size_t mover);

/* The velocity of the block of a mover, x and y, cm/us. */
const double *config_velocity(const struct config *c, size_t mover);

/* Has the wall a temperature, set or by a load, so that it conducts? */
bool config_wall_conducts(const struct config *c, size_t wall);

/* The load with this quantity of this mover; NULL: none. */
const struct load_config *config_load(const struct config *c, size_t mover, enum load_quantity quantity);

/* Does the body follow a table of velocities or spins, a force or a stress, or turn, so that its elements
 * have homes and their places are worked out from these? */
bool config_is_placed(const struct config *c, size_t body);
/* The number of probes of regions. */
size_t config_regions(const struct config *c);

/* The time of a step, us: t_start + (step - n_start) dt, multiplied out. */
static inline double config_time(const struct config *c, int64_t step)
{
    if (c->same_clock)
        return c->t_clock + (double)(step - c->n_clock) * c->dt;
    return c->t_start + (double)(step - c->n_start) * c->dt;
}

/* The contact distance of the two largest elements, cm; 0 without a body whose radius is known. */
double config_contact_distance(const struct config *c);

/* The name of a kind of element: the material; for a further phase the material, a slash and the phase.
 * Returns `out->text`. */
struct kind_name {
    char text[2 * NAME_MAX_LENGTH + 2];
};
const char *config_kind_name(const struct config *c, size_t kind, struct kind_name *out);

/* dm2_fail at a place of the deck: the text is "file:line:column: error: message", the line, and a caret
 * below the line. A place of NULL gives the message alone. Returns `status`. */
enum dm2_status config_fail(const char *place, struct dm2_error *err, enum dm2_status status,
                            const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Frees everything that *c owns and sets *c to zeros. */
void config_free(struct config *c);

#endif
