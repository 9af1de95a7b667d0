/* The motion of a mover from its tables. The displacement of a step is the difference of two integrals, both
 * from the same function of the step alone. */
#include "motion.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "tables.h"

/* --- tables --- */

/* The last point k, at most n - 2, whose time is at most t; 0 where none is. */
static size_t find_segment(const struct load_config *load, double t)
{
    size_t low = 0, high = load->n - 1;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (load->time[middle] <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The time within the first period, and the number of whole periods before it in *turns. */
static double reduce_time(const struct motion_table *table, double t, double *turns)
{
    *turns = 0.0;
    if (!(table->period > 0.0))
        return t;
    const double first = table->load->time[0];
    *turns = floor((t - first) / table->period);
    t -= *turns * table->period;
    double last = table->load->time[table->load->n - 1];
    return t < first ? first : t > last ? last : t;
}

double motion_table_value(const struct motion_table *table, double t)
{
    const struct load_config *load = table->load;
    double turns;
    t = reduce_time(table, t, &turns);
    if (!(t > load->time[0]))
        return load->value[0];
    if (!(t < load->time[load->n - 1]))
        return load->value[load->n - 1];
    size_t k = find_segment(load, t);
    const double *at = &load->time[k], *v = &load->value[k];
    return v[0] + (v[1] - v[0]) * ((t - at[0]) / (at[1] - at[0]));
}

double motion_table_integral(const struct motion_table *table, double t)
{
    const struct load_config *load = table->load;
    double turns, last = load->time[load->n - 1], total = table->sum[load->n - 1];
    t = reduce_time(table, t, &turns);
    if (!(t > load->time[0]))
        return load->value[0] * (t - load->time[0]) + turns * total;
    if (!(t < last))
        return total + load->value[load->n - 1] * (t - last) + turns * total;
    size_t k = find_segment(load, t);
    const double *at = &load->time[k], *v = &load->value[k];
    double slope = (v[1] - v[0]) / (at[1] - at[0]), u = t - at[0];
    return table->sum[k] + u * (v[0] + slope * u * 0.5) + turns * total;
}

/* The sums carry the rounding of each addition along (Kahan), so that many points cost no digits. */
static enum dm2_status build_table(const struct load_config *load, double t_start, struct motion_table *out,
                                   struct dm2_error *err)
{
    *out = (struct motion_table){.load = load, .sum = mem_zalloc(load->n, sizeof *out->sum)};
    if (out->sum == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the %zu points of load '%s'", load->n, load->name);
    double lost = 0.0;
    for (size_t k = 1; k < load->n; k++) {
        double part =
            (load->time[k] - load->time[k - 1]) * (load->value[k] + load->value[k - 1]) * 0.5 - lost;
        out->sum[k] = out->sum[k - 1] + part;
        lost = (out->sum[k] - out->sum[k - 1]) - part;
    }
    out->period = load->repeat ? load->time[load->n - 1] - load->time[0] : 0.0;
    out->start = motion_table_integral(out, t_start);
    return DM2_OK;
}

static struct mover_path find_path(const struct model *m, size_t mover)
{
    const struct config *c = m->config;
    struct mover_path d = {{NULL, NULL, NULL}, {0.0, 0.0, 0.0}};
    if (mover < c->n_bodies && c->bodies[mover].motion == MOTION_DRIVEN) {
        d.constant[0] = c->bodies[mover].velocity[0];
        d.constant[1] = c->bodies[mover].velocity[1];
        d.constant[2] = c->bodies[mover].spin;
    }
    if (mover >= c->n_bodies) {
        const struct wall_config *w = &c->walls[mover - c->n_bodies];
        d.constant[0] = w->velocity[0];
        d.constant[1] = w->velocity[1];
        d.constant[2] = w->spin;
    }
    for (size_t i = 0; i < c->n_loads; i++) {
        if (c->loads[i].mover != mover)
            continue;
        switch (c->loads[i].quantity) {
        case LOAD_VELOCITY_X:
        case LOAD_VELOCITY_Y:
        case LOAD_SPIN:
            d.table[c->loads[i].quantity - LOAD_VELOCITY_X] = &m->load_tables[i];
            break;
        case LOAD_FORCE_X:
        case LOAD_STRESS_XX:
            d.constant[0] = 0.0;
            break;
        case LOAD_FORCE_Y:
        case LOAD_STRESS_YY:
            d.constant[1] = 0.0;
            break;
        default:
            break;
        }
    }
    return d;
}

enum dm2_status motion_build(struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    m->load_tables = mem_zalloc(c->n_loads, sizeof *m->load_tables);
    enum dm2_status status =
        m->load_tables == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for %zu loads", c->n_loads) : DM2_OK;
    for (size_t i = 0; i < c->n_loads && status == DM2_OK; i++)
        status = build_table(&c->loads[i], m->config->t_start, &m->load_tables[i], err);
    m->paths = mem_zalloc(config_movers(c), sizeof *m->paths);
    m->placed = mem_zalloc(c->n_bodies, sizeof *m->placed);
    m->driven = mem_zalloc(c->n_bodies, sizeof *m->driven);
    if (status == DM2_OK && (m->paths == NULL || m->placed == NULL || m->driven == NULL))
        status = dm2_fail(err, DM2_MEMORY, "no memory for the motions of %zu bodies", c->n_bodies);
    for (size_t i = 0; i < config_movers(c) && status == DM2_OK; i++)
        m->paths[i] = find_path(m, i);
    for (size_t b = 0; b < c->n_bodies && status == DM2_OK; b++) {
        m->placed[b] = config_is_placed(c, b);
        m->driven[b] = m->placed[b] || config_load(c, b, LOAD_ACCELERATION_X) != NULL ||
                       config_load(c, b, LOAD_ACCELERATION_Y) != NULL;
    }
    return status;
}

void motion_free(struct model *m)
{
    for (size_t i = 0; m->load_tables != NULL && i < m->config->n_loads; i++)
        free(m->load_tables[i].sum);
    free(m->load_tables);
    free(m->paths);
    free(m->placed);
    free(m->driven);
    free(m->centroids);
}

/* --- motions --- */

double motion_time(const struct model *m, int64_t step)
{
    return config_time(m->config, step);
}

double motion_load(const struct model *m, size_t load, int64_t step)
{
    return motion_table_value(&m->load_tables[load], motion_time(m, step));
}

/* The path along k since the stage's start at time t. */
static double path_at(const struct model *m, const struct mover_path *d, int k, double t)
{
    return d->table[k] != NULL ? motion_table_integral(d->table[k], t) - d->table[k]->start
                               : d->constant[k] * (t - m->config->t_start);
}

void motion_at(const struct model *m, size_t mover, int64_t step, struct rigid_motion *out)
{
    const struct mover_path *d = &m->paths[mover];
    double t = motion_time(m, step), before = motion_time(m, step - 1), path[3], speed[3];
    for (int k = 0; k < 3; k++) {
        path[k] = path_at(m, d, k, t);
        if (d->table[k] == NULL)
            speed[k] = d->constant[k];
        else if (step <= m->config->n_start)
            speed[k] = motion_table_value(d->table[k], t);
        else
            speed[k] = (path[k] - path_at(m, d, k, before)) / m->config->dt;
    }
    *out = (struct rigid_motion){path[0], path[1], speed[0], speed[1], path[2], speed[2]};
}

bool motion_needs_centroid(const struct model *m, size_t body)
{
    return m->placed[body] || m->config->bodies[body].spin != 0.0;
}
