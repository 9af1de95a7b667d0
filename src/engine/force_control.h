/* The motion of a rigid body under a force along one axis (docs/physics.md, section 17): one equation of
 * motion with a damping that follows from the stiffness of the body's contacts, so that the reaction of the
 * sample reaches the asked load without oscillation. Pure functions; engine/loading.h keeps the states. */
#ifndef DM2_ENGINE_FORCE_CONTROL_H
#define DM2_ENGINE_FORCE_CONTROL_H

/* What does not change during a run. */
struct control_constants {
    double dt;        /* us */
    double mass;      /* inertia M of the body along the axis, g */
    double stiffness; /* k of one contact, Mbar cm: the stiffest law that the body's contacts follow */
    double zeta;      /* fraction of critical damping, without the part that makes up for the delay */
    double fastest;   /* max_velocity, cm/us */
    double reset;     /* T, in which an offset of the force is made up for, us; infinite: never */
};

/* What the sample did to the body in one evaluation. */
struct control_response {
    double force;    /* sum of the forces of others on the body along the axis, Mbar cm2 */
    double speed;    /* mean velocity of the elements touched, cm/us; 0 where there are none */
    double contacts; /* pairs that touch the body or are linked with it */
};

/* The state of the axis. */
struct control_state {
    double shift;    /* displacement since the start, cm */
    double velocity; /* of the half step before, cm/us */
    double offset;   /* q, the force that makes up for lasting differences, Mbar cm2 */
};

/* The damping c, Mbar us cm, for so many contacts: 2 (zeta + omega dt) sqrt(K M), K = contacts k, omega =
 * sqrt(K/M). The term omega dt makes up for the delay of two steps of the response. */
double control_damping(const struct control_constants *c, double contacts);

/* One kick, without the drift: `load` is the force P on the body at this step, `weight` its weight along the
 * axis, Mbar cm2; `response` that of the evaluation two steps before. */
void control_kick(const struct control_constants *c, double load, double weight,
                  const struct control_response *response, struct control_state *s);

/* The drift. */
void control_drift(const struct control_constants *c, struct control_state *s);

#endif
