/* M (v(n+1/2) - v(n-1/2))/dt = F + P + m g + q - c (v(n-1/2) - 0.9 u), F, u and the number of contacts those
 * of evaluation n-2. Only + - * / and sqrt, in a fixed order, because all servers advance the same state. */
#include "force_control.h"

#include <math.h>

/* The part of the speed of the elements touched that the damping does not oppose. The whole speed would leave
 * the body undamped on ground that moves with it. */
static const double followed = 0.9;

/* The largest part of the load that the offset may add. */
static const double offset_most = 0.03;

static double clamp(double x, double most)
{
    return x > most ? most : x < -most ? -most : x;
}

double control_damping(const struct control_constants *c, double contacts)
{
    double k = contacts * c->stiffness, omega = sqrt(k / c->mass);
    return 2.0 * (c->zeta + omega * c->dt) * sqrt(k * c->mass);
}

void control_kick(const struct control_constants *c, double load, double weight,
                  const struct control_response *response, struct control_state *s)
{
    double excess = (response->force + load) + weight;
    double damped = control_damping(c, response->contacts) * (s->velocity - followed * response->speed);
    double force = (excess + s->offset) - damped;
    if (response->contacts > 0.0)
        s->offset = clamp(s->offset + excess * (c->dt / c->reset), offset_most * fabs(load));
    s->velocity = clamp(s->velocity + force * (c->dt / c->mass), c->fastest);
}

void control_drift(const struct control_constants *c, struct control_state *s)
{
    s->shift += s->velocity * c->dt;
}
