/* The keywords of `load NAME { ... }`. A quantity's number is its row: the rows begin as enum load_quantity
 * does. */
#include "keys.h"
#include "bind_loads.h"

#define POINTS(q) .offset = offsetof(struct load_block, points) + (q) * sizeof(struct load_points)
#define FIELD(f)  .offset = offsetof(struct load_block, common.f)
#define NONE      .initial = "none"

const struct deck_key load_keys[LOAD_KEYS] = {
    {"velocity_x", VALUE_POINTS, 1, VELOCITY, ANY, NONE, POINTS(LOAD_VELOCITY_X),
     .meaning = "velocity of a driven body or a wall, in place of `velocity` of its block"},
    {"velocity_y", VALUE_POINTS, 1, VELOCITY, ANY, NONE, POINTS(LOAD_VELOCITY_Y),
     .meaning = "likewise along y"},
    {"spin", VALUE_POINTS, 1, SPIN, ANY, NONE, POINTS(LOAD_SPIN),
     .meaning = "angular velocity of a driven body about its centroid, of a wall about its centre, "
                "counter-clockwise"},
    {"force_x", VALUE_POINTS, 1, FORCE, ANY, NONE, POINTS(LOAD_FORCE_X),
     .meaning = "force on a driven body or a wall, which moves by it as a rigid body"},
    {"force_y", VALUE_POINTS, 1, FORCE, ANY, NONE, POINTS(LOAD_FORCE_Y), .meaning = "likewise along y"},
    {"stress_xx", VALUE_POINTS, 1, STRESS, ANY, NONE, POINTS(LOAD_STRESS_XX),
     .meaning = "stress on the side of a driven body or a wall that faces the middle of the domain, tension "
                "positive"},
    {"stress_yy", VALUE_POINTS, 1, STRESS, ANY, NONE, POINTS(LOAD_STRESS_YY), .meaning = "likewise along y"},
    {"temperature", VALUE_POINTS, 1, TEMPERATURE, NOT_NEGATIVE, NONE, POINTS(LOAD_TEMPERATURE),
     .meaning = "temperature at which the elements of any body, or a wall, are held"},
    {"acceleration_x", VALUE_POINTS, 1, ACCELERATION, ANY, NONE, POINTS(LOAD_ACCELERATION_X),
     .meaning = "acceleration of the elements of a free body, beside `gravity`"},
    {"acceleration_y", VALUE_POINTS, 1, ACCELERATION, ANY, NONE, POINTS(LOAD_ACCELERATION_Y),
     .meaning = "likewise along y"},
    {"body", VALUE_MOVERS, 1, PLAIN, ANY, .required = true, FIELD(mover), .meaning = "what is loaded"},
    {"file", VALUE_FILE, 1, PLAIN, ANY, NONE, FIELD(name),
     .meaning = "a table with a column `time [us]` and a column for each quantity, such as `velocity_y "
                "[cm/us]`, in place of points"},
    {"repeat", VALUE_FLAG, 1, PLAIN, ANY, .choices = "no|yes", .initial = "no", FIELD(repeat),
     .meaning = "are the points one period, after which they begin again"},
    {"length", VALUE_REAL, 1, LENGTH, POSITIVE,
     .initial = "the domain's width where periodic, else that of the body or wall", FIELD(length),
     .meaning = "length across the load on which a stress acts"},
    {"between", VALUE_MOVERS, 2, PLAIN, ANY, NONE, FIELD(between),
     .meaning = "two bodies or walls whose gap is that length at every step"},
    {"zeta", VALUE_REAL, 1, PLAIN, NOT_NEGATIVE, .initial = "0.7", FIELD(zeta),
     .meaning = "damping of a body under a force or a stress, as a fraction of the critical one"},
    {"max_velocity", VALUE_REAL, 1, VELOCITY, POSITIVE, .initial = "load per element over sqrt(k m)",
     FIELD(max_velocity), .meaning = "the greatest velocity of a body under a force or a stress"},
    {"mass", VALUE_REAL, 1, MASS, POSITIVE, .initial = "from the time step", FIELD(mass),
     .meaning = "mass of a body under a force or a stress"},
};
