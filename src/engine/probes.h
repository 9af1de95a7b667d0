/* The probes of a model, and the sums of one element for them (dm2/engine/probe.h). */
#ifndef DM2_ENGINE_PROBES_H
#define DM2_ENGINE_PROBES_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/engine/measures.h"
#include "particles.h"

/* An element at the whole step. */
struct probe_sample {
    double r[2], v[2], w; /* unwrapped, cm, cm/us, 1/us */
    double force[2];      /* of its pairs, Mbar cm2 */
    double temperature, kinetic;
};

/* Fills and frees the table of a config's probes. probes_build: 0, or -1 without memory. */
int probes_build(struct probe_table *t, const struct config *c);
void probes_free(struct probe_table *t);

/* Sets out->probe to the sums of no element. */
void probes_start(const struct model *m, struct measures *out);

/* Adds owned slot i, after a measuring evaluation. False where a value leaves the range of its sum. */
bool probes_add(const struct model *m, const struct particles *p, size_t i, const struct probe_sample *at,
                struct measures *out);

/* Adds a value to a sum where the probe needs the sum. False where the value leaves the range of the sum. */
bool probe_add(struct probe_sums *out, const struct measure_scales *s, enum probe_sum sum, double value);

/* pi R^2, cm2. */
double probe_disc_area(double radius);

#endif
