/* The sums of one element for the probes that the element belongs to, and the columns from the sums.
 *
 * Forces are sums of the elements' fixed-point forces. A pair within the probe cancels in these integers, and
 * over all bodies they sum to 0. */
#include "dm2/engine/probe.h"

#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/deck/shape.h"
#include "leapfrog.h"
#include "probes.h"

#define BIT(sum) (UINT32_C(1) << (sum))

const struct probe_column probe_columns[PROBE_COLUMNS] = {
    {"x", "cm", REPORT_POSITION},
    {"y", "cm", REPORT_POSITION},
    {"vx", "cm/us", REPORT_VELOCITY},
    {"vy", "cm/us", REPORT_VELOCITY},
    {"fx", "Mbar cm2", REPORT_FORCE},
    {"fy", "Mbar cm2", REPORT_FORCE},
    {"torque", "Mbar cm3", REPORT_TORQUE},
    {"spin", "1/us", REPORT_SPIN},
    {"stress_xx", "Mbar", REPORT_STRESS},
    {"stress_yy", "Mbar", REPORT_STRESS},
    {"stress_xy", "Mbar", REPORT_STRESS},
    {"temperature", "K", REPORT_TEMPERATURE},
    {"kinetic", "g cm2/us2", REPORT_KINETIC},
    {"porosity", "", REPORT_POROSITY},
    {"heat", "g cm2/us3", REPORT_HEAT},
};

/* --- which sums --- */

uint32_t probe_needs(const struct probe_config *p)
{
    const uint32_t centre = BIT(PROBE_MASS) | BIT(PROBE_MX) | BIT(PROBE_MY);
    const uint32_t momentum = BIT(PROBE_MASS) | BIT(PROBE_PX) | BIT(PROBE_PY);
    const uint32_t force = BIT(PROBE_FX) | BIT(PROBE_FY);
    const bool region = p->mover < 0 || p->wall;
    const uint32_t of[REPORT_COUNT] = {
        [REPORT_POSITION] = region ? BIT(PROBE_X) | BIT(PROBE_Y) : centre,
        [REPORT_VELOCITY] = region ? BIT(PROBE_VX) | BIT(PROBE_VY) : momentum,
        [REPORT_FORCE] = force,
        [REPORT_TORQUE] = p->wall ? BIT(PROBE_TORQUE) : centre | force | BIT(PROBE_TORQUE),
        [REPORT_SPIN] =
            p->wall ? BIT(PROBE_SPIN) : centre | momentum | BIT(PROBE_ANGULAR) | BIT(PROBE_INERTIA),
        [REPORT_STRESS] =
            BIT(PROBE_STRESS_XX) | BIT(PROBE_STRESS_YY) | BIT(PROBE_STRESS_XY) | BIT(PROBE_VOLUME),
        [REPORT_TEMPERATURE] = BIT(PROBE_TEMPERATURE),
        [REPORT_KINETIC] = BIT(PROBE_KINETIC),
        [REPORT_POROSITY] = BIT(PROBE_AREA),
        [REPORT_HEAT] = BIT(PROBE_HEAT),
    };
    uint32_t needs = 0;
    for (int q = 0; q < REPORT_COUNT; q++)
        needs |= p->report >> q & 1u ? of[q] : 0;
    return needs;
}

int probe_shift(const struct measure_scales *s, enum probe_sum sum)
{
    const int shift[PROBE_SUMS] = {
        [PROBE_X] = s->length,
        [PROBE_Y] = s->length,
        [PROBE_VX] = s->velocity,
        [PROBE_VY] = s->velocity,
        [PROBE_MASS] = s->mass,
        [PROBE_MX] = s->moment,
        [PROBE_MY] = s->moment,
        [PROBE_PX] = s->momentum,
        [PROBE_PY] = s->momentum,
        [PROBE_ANGULAR] = s->momentum,
        [PROBE_INERTIA] = s->inertia,
        [PROBE_FX] = s->force,
        [PROBE_FY] = s->force,
        [PROBE_TORQUE] = s->energy,
        [PROBE_STRESS_XX] = s->energy,
        [PROBE_STRESS_YY] = s->energy,
        [PROBE_STRESS_XY] = s->energy,
        [PROBE_VOLUME] = s->volume,
        [PROBE_TEMPERATURE] = s->temperature,
        [PROBE_KINETIC] = s->energy,
        [PROBE_AREA] = s->volume,
        [PROBE_SPIN] = s->spin,
        [PROBE_HEAT] = s->energy,
    };
    return shift[sum];
}

void probe_origin(const struct probe_config *p, double origin[2])
{
    for (int a = 0; a < 2; a++)
        origin[a] = p->mover < 0 ? 0.0 : 0.5 * (p->box[a] + p->box[a + 2]);
}

int probes_build(struct probe_table *t, const struct config *c)
{
    *t = (struct probe_table){.n = c->n_probes};
    t->of_body = mem_zalloc(c->n_bodies, sizeof *t->of_body);
    if (t->of_body == NULL)
        return -1;
    for (size_t p = 0; p < c->n_probes; p++) {
        const struct probe_config *probe = &c->probes[p];
        t->needs[p] = probe_needs(probe);
        if (probe->wall)
            continue; /* wall_memory.c */
        if (probe->mover >= 0)
            t->of_body[probe->mover] |= UINT64_C(1) << p;
        else
            t->of_region[probe->bit] = (uint8_t)p;
        if (t->needs[p] & BIT(PROBE_AREA))
            t->porous |= UINT64_C(1) << p;
    }
    return 0;
}

void probes_free(struct probe_table *t)
{
    free(t->of_body);
}

/* --- the sums of an element --- */

bool probe_add(struct probe_sums *out, const struct measure_scales *s, enum probe_sum sum, double value)
{
    return (out->needs & BIT(sum)) == 0 || exact_add(&out->sum[sum], value, probe_shift(s, sum));
}

/* The force of slot i in quanta of the sums; far forces have 64 times the quantum of near ones. */
static void add_force(const struct model *m, const struct particles *p, size_t i, struct probe_sums *out)
{
    int left = m->fixed.energy_left;
    for (size_t a = 0; a < 2; a++) {
        if (m->has_near)
            exact_add_units(&out->sum[PROBE_FX + a], p->pair_sum[SUM_COUNT * i + SUM_FX + a], left);
        if (p->far_sum != NULL)
            exact_add_units(&out->sum[PROBE_FX + a], p->far_sum[2 * i + a], left + 6);
    }
}

static bool add_turning(const struct model *m, const struct particles *p, size_t i,
                        const struct probe_sample *at, const double r[2], struct probe_sums *out)
{
    const struct measure_scales *s = &m->scales;
    double mass = p->mass[i], radius2 = p->radius[i] * p->radius[i];
    double spin = 0.5 * mass * radius2 * at->w;
    double torque = m->has_near && m->has_spin
                        ? (double)p->pair_sum[SUM_COUNT * i + SUM_TORQUE] * m->fixed.over_torque
                        : 0.0;
    bool fits = probe_add(out, s, PROBE_ANGULAR, mass * (r[0] * at->v[1] - r[1] * at->v[0]) + spin);
    fits &= probe_add(out, s, PROBE_INERTIA, mass * (r[0] * r[0] + r[1] * r[1] + 0.5 * radius2));
    return fits & probe_add(out, s, PROBE_TORQUE, r[0] * at->force[1] - r[1] * at->force[0] + torque);
}

static bool add_stress(const struct model *m, const struct particles *p, size_t i, struct probe_sums *out)
{
    const struct measure_scales *s = &m->scales;
    double stress[3], d = 2.0 * p->radius[i], volume = 0x1.bb67ae8584caap-1 * (d * d); /* sqrt(3)/2 d^2 h */
    leapfrog_stress(m, p, i, stress);
    bool fits = probe_add(out, s, PROBE_VOLUME, volume);
    for (int a = 0; a < 3; a++)
        fits &= probe_add(out, s, (enum probe_sum)(PROBE_STRESS_XX + a), stress[a] * volume);
    return fits;
}

static bool add_element(const struct model *m, const struct particles *p, size_t i,
                        const struct probe_sample *at, const struct probe_config *probe,
                        struct probe_sums *out)
{
    const struct measure_scales *s = &m->scales;
    double mass = p->mass[i], origin[2], r[2];
    bool fits = true;
    probe_origin(probe, origin);
    out->count++;
    for (int a = 0; a < 2; a++) {
        r[a] = at->r[a] - origin[a];
        fits &= probe_add(out, s, (enum probe_sum)(PROBE_X + a), r[a]);
        fits &= probe_add(out, s, (enum probe_sum)(PROBE_VX + a), at->v[a]);
        fits &= probe_add(out, s, (enum probe_sum)(PROBE_MX + a), mass * r[a]);
        fits &= probe_add(out, s, (enum probe_sum)(PROBE_PX + a), mass * at->v[a]);
    }
    fits &= probe_add(out, s, PROBE_MASS, mass);
    fits &= probe_add(out, s, PROBE_TEMPERATURE, at->temperature);
    fits &= probe_add(out, s, PROBE_KINETIC, at->kinetic);
    if (out->needs & BIT(PROBE_FX))
        add_force(m, p, i, out);
    if (out->needs & (BIT(PROBE_TORQUE) | BIT(PROBE_INERTIA)))
        fits &= add_turning(m, p, i, at, r, out);
    if (out->needs & BIT(PROBE_VOLUME))
        fits &= add_stress(m, p, i, out);
    return fits;
}

double probe_disc_area(double radius)
{
    return 0x1.921fb54442d18p1 * (radius * radius);
}

/* Adds the area of the disc to the probes whose region has the disc's centre. */
static bool add_area(const struct model *m, const struct particles *p, size_t i, struct measures *out)
{
    const struct config *c = m->config;
    bool fits = true;
    for (size_t k = 0; m->probes.porous >> k != 0; k++) {
        const double *box = c->probes[k].box;
        const struct shape_config region = {.kind = SHAPE_RECTANGLE, .box = {box[0], box[1], box[2], box[3]}};
        if ((m->probes.porous >> k & 1) && shape_contains_image(&region, c, p->r + 2 * i, 0.0))
            fits &= probe_add(&out->probe[k], &m->scales, PROBE_AREA, probe_disc_area(p->radius[i]));
        if (k + 1 == m->probes.n)
            break;
    }
    return fits;
}

bool probes_add(const struct model *m, const struct particles *p, size_t i, const struct probe_sample *at,
                struct measures *out)
{
    const struct probe_table *t = &m->probes;
    uint64_t mask = t->of_body[p->body[i]];
    bool fits = true;
    for (int b = 0; p->probes[i] >> b != 0; b++)
        if (p->probes[i] >> b & 1)
            mask |= UINT64_C(1) << t->of_region[b];
    for (size_t k = 0; k < t->n && mask >> k != 0; k++)
        if (mask >> k & 1)
            fits &= add_element(m, p, i, at, &m->config->probes[k], &out->probe[k]);
    return t->porous != 0 ? fits & add_area(m, p, i, out) : fits;
}

void probes_start(const struct model *m, struct measures *out)
{
    out->n_probes = m->probes.n;
    for (size_t k = 0; k < out->n_probes; k++)
        out->probe[k] = (struct probe_sums){.needs = m->probes.needs[k]};
}

void probe_merge(struct probe_sums *sums, const struct probe_sums *part)
{
    sums->count += part->count;
    for (int k = 0; k < PROBE_SUMS; k++)
        if (sums->needs >> k & 1)
            exact_merge(&sums->sum[k], &part->sum[k]);
}

/* --- columns --- */

/* Angular velocity of the sums' elements about their centre of mass: (L - c x P)/(I - M c^2), with places c
 * from the probe's origin. */
static double find_spin(const double sum[PROBE_SUMS], const double centre[2])
{
    double angular = sum[PROBE_ANGULAR] - (centre[0] * sum[PROBE_PY] - centre[1] * sum[PROBE_PX]);
    double inertia = sum[PROBE_INERTIA] - sum[PROBE_MASS] * (centre[0] * centre[0] + centre[1] * centre[1]);
    return angular / inertia;
}

void probe_values(const struct probe_config *p, const struct measure_scales *scales,
                  const struct probe_sums *sums, double values[PROBE_COLUMNS])
{
    const bool region = p->mover < 0 || p->wall;
    double sum[PROBE_SUMS], origin[2], centre[2], count = (double)sums->count;
    double width = p->box[2] - p->box[0], height = p->box[3] - p->box[1];
    for (int k = 0; k < PROBE_SUMS; k++)
        sum[k] =
            sums->needs >> k & 1 ? exact_value(&sums->sum[k], probe_shift(scales, (enum probe_sum)k)) : 0.0;
    probe_origin(p, origin);
    for (int a = 0; a < 2; a++)
        centre[a] = sum[PROBE_MX + a] / sum[PROBE_MASS];
    double *v = values;
    for (int a = 0; a < 2; a++)
        *v++ = region ? sum[PROBE_X + a] / count : origin[a] + centre[a];
    for (int a = 0; a < 2; a++)
        *v++ = region ? sum[PROBE_VX + a] / count : sum[PROBE_PX + a] / sum[PROBE_MASS];
    *v++ = sum[PROBE_FX];
    *v++ = sum[PROBE_FY];
    *v++ = p->wall ? sum[PROBE_TORQUE]
                   : sum[PROBE_TORQUE] - (centre[0] * sum[PROBE_FY] - centre[1] * sum[PROBE_FX]);
    *v++ = p->wall ? sum[PROBE_SPIN] : find_spin(sum, centre);
    for (int a = 0; a < 3; a++)
        *v++ = sum[PROBE_STRESS_XX + a] / sum[PROBE_VOLUME];
    *v++ = sum[PROBE_TEMPERATURE] / count;
    *v++ = sum[PROBE_KINETIC];
    *v++ = 1.0 - sum[PROBE_AREA] / (width * height);
    *v++ = sum[PROBE_HEAT];
    for (int k = 0; k < PROBE_COLUMNS; k++)
        values[k] = p->report >> probe_columns[k].quantity & 1u ? number_plus_zero(values[k]) : 0.0;
}
