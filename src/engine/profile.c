/* Sums over bins (docs/physics.md, section 12). Velocities are whole-step velocities, as in the history;
 * stress is the mean of leapfrog_stress, each element weighted by the volume of its lattice cell at rest. */
#include "dm2/engine/profile.h"

#include <math.h>

#include "leapfrog.h"
#include "particles.h"
#include "probes.h"

static double bin_width(const struct profile_config *c)
{
    return (c->range[1] - c->range[0]) / (double)c->bins;
}

long profile_bin_of(const struct profile_config *c, double x)
{
    if (!(x >= c->range[0] && x < c->range[1]))
        return -1;
    long bin = (long)((x - c->range[0]) / bin_width(c));
    return bin < c->bins ? bin : (long)c->bins - 1; /* the quotient may round up to c->bins */
}

double profile_centre(const struct profile_config *c, size_t bin)
{
    return c->range[0] + ((double)bin + 0.5) * bin_width(c);
}

static bool add_element(const struct model *m, const struct particles *p, size_t i, int64_t step,
                        struct profile_bin *bin)
{
    const struct measure_scales *s = &m->scales;
    double v[2], w, stress[3], d = 2.0 * p->radius[i],
                               volume = 0x1.bb67ae8584caap-1 * (d * d); /* sqrt(3)/2 d^2 h */
    leapfrog_whole_velocity(m, p, i, step, v, &w);
    leapfrog_stress(m, p, i, stress);
    bin->elements++;
    bool fits = exact_add(&bin->mass, p->mass[i], s->mass);
    fits &= exact_add(&bin->volume, volume, s->volume);
    fits &= exact_add(&bin->area, probe_disc_area(p->radius[i]), s->volume);
    fits &= exact_add(&bin->temperature, particles_temperature(p, m, i), s->temperature);
    for (int a = 0; a < 2; a++)
        fits &= exact_add(&bin->momentum[a], p->mass[i] * v[a], s->momentum);
    for (int a = 0; a < 3; a++)
        fits &= exact_add(&bin->stress[a], stress[a] * volume, s->energy);
    return fits;
}

enum dm2_status profile_add(const struct model *m, const struct particles *p, const struct profile_config *c,
                            int64_t step, struct profile_bin *bins, struct dm2_error *err)
{
    for (size_t i = 0; i < p->n_own; i++) {
        long bin = profile_bin_of(c, p->r[2 * i + (size_t)c->axis]);
        if (bin >= 0 && !add_element(m, p, i, step, &bins[bin]))
            return dm2_fail(
                err, DM2_NUMERIC,
                "step %lld: element %u at (%g, %g) cm left the range that the sums of profile '%s' can "
                "hold: the run is unstable; choose a smaller dt",
                (long long)step, p->id[i], p->r[2 * i], p->r[2 * i + 1], c->name);
    }
    return DM2_OK;
}

void profile_merge(struct profile_bin *bins, const struct profile_bin *part, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        bins[k].elements += part[k].elements;
        exact_merge(&bins[k].mass, &part[k].mass);
        exact_merge(&bins[k].volume, &part[k].volume);
        exact_merge(&bins[k].temperature, &part[k].temperature);
        exact_merge(&bins[k].area, &part[k].area);
        for (int a = 0; a < 2; a++)
            exact_merge(&bins[k].momentum[a], &part[k].momentum[a]);
        for (int a = 0; a < 3; a++)
            exact_merge(&bins[k].stress[a], &part[k].stress[a]);
    }
}

struct profile_means profile_means(const struct profile_bin *bin, const struct profile_config *c,
                                   const struct config *config, const struct measure_scales *scales)
{
    struct profile_means out;
    double mass = exact_value(&bin->mass, scales->mass), volume = exact_value(&bin->volume, scales->volume);
    double across = config->size[c->axis == AXIS_X ? 1 : 0]; /* times h = 1 cm */
    out.density = mass / (bin_width(c) * across);
    out.porosity = 1.0 - exact_value(&bin->area, scales->volume) / (bin_width(c) * across);
    out.temperature = exact_value(&bin->temperature, scales->temperature) / (double)bin->elements;
    for (int a = 0; a < 2; a++)
        out.velocity[a] = exact_value(&bin->momentum[a], scales->momentum) / mass;
    for (int a = 0; a < 3; a++)
        out.stress[a] = exact_value(&bin->stress[a], scales->energy) / volume;
    return out;
}
