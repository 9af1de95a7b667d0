/* The columns are in the order of the tables of names below. A number is the shortest text that reads back as
 * the same double. */
#include "history.h"

#include <inttypes.h>
#include <stdio.h>

#include "dm2/base/csv.h"
#include "dm2/base/exact.h"
#include "dm2/base/number.h"

/* --- history.csv --- */

/* Writes the heading of one column, quoted where CSV requires quotes. */
static void write_heading(struct file_out *f, const char *name, const char *unit)
{
    char text[128], quoted[256];
    (void)snprintf(text, sizeof text, unit[0] == '\0' ? "%s" : "%s [%s]", name, unit);
    (void)csv_quote(text, quoted, sizeof quoted);
    file_puts(f, quoted);
}

void history_put_heading(struct file_out *f, const struct config *c)
{
    static const char *const columns[][2] = {
        {"step", ""},
        {"time", "us"},
        {"kinetic", "g cm2/us2"},
        {"potential", "g cm2/us2"},
        {"elastic", "g cm2/us2"},
        {"thermal", "g cm2/us2"},
        {"chemical", "g cm2/us2"},
        {"phase", "g cm2/us2"},
        {"work", "g cm2/us2"},
        {"total", "g cm2/us2"},
        {"momentum_x", "g cm/us"},
        {"momentum_y", "g cm/us"},
        {"angular_momentum", "g cm2/us"},
        {"elements", ""},
        {"links", ""},
        {"contacts", ""},
        {"temperature_max", "K"},
        {"pressure_min", "Mbar"},
        {"pressure_max", "Mbar"},
        {"drift", ""},
        {"dt_share", ""},
        {"compression", ""},
        {"unbalanced", ""},
        {"coordination", ""},
        {"fabric_xx", ""},
        {"fabric_yy", ""},
        {"fabric_xy", ""},
        {"damped", "g cm2/us2"},
    };
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        file_puts(f, i == 0 ? "" : ",");
        write_heading(f, columns[i][0], columns[i][1]);
    }
    for (size_t p = 0; p < c->n_probes; p++) {
        for (int k = 0; k < PROBE_COLUMNS; k++) {
            char name[64];
            if (!(c->probes[p].report >> probe_columns[k].quantity & 1))
                continue;
            (void)snprintf(name, sizeof name, "%s_%s", c->probes[p].name, probe_columns[k].suffix);
            file_puts(f, ",");
            write_heading(f, name, probe_columns[k].unit);
        }
    }
    file_puts(f, "\n");
}

static void write_number(struct file_out *f, double x)
{
    char text[NUMBER_TEXT_MAX + 1] = ",";
    size_t length = number_format(x, text + 1);
    file_write(f, text, length + 1);
}

/* kinetic + potential + elastic + thermal + chemical + phase + damped - work, exact. */
static struct exact_sum conserved_sum(const struct measures *m)
{
    struct exact_sum sum = m->work;
    sum.lo = ~sum.lo + 1u;
    sum.hi = (int64_t)(~(uint64_t)sum.hi + (sum.lo == 0 ? 1u : 0u));
    exact_merge(&sum, &m->kinetic);
    exact_merge(&sum, &m->potential);
    exact_merge(&sum, &m->elastic);
    exact_merge(&sum, &m->thermal);
    exact_merge(&sum, &m->chemical);
    exact_merge(&sum, &m->phase);
    exact_merge(&sum, &m->damped);
    return sum;
}

static void write_probe(struct file_out *f, const struct probe_config *p, const struct measure_scales *scales,
                        const struct probe_sums *sums)
{
    double values[PROBE_COLUMNS];
    probe_values(p, scales, sums, values);
    for (int k = 0; k < PROBE_COLUMNS; k++)
        if (p->report >> probe_columns[k].quantity & 1)
            write_number(f, values[k]);
}

struct book_row history_book_row(const struct measure_scales *scales, int64_t step, const struct measures *m)
{
    const struct exact_sum total = conserved_sum(m);
    return (struct book_row){
        .step = step,
        .kinetic = exact_value(&m->kinetic, scales->energy),
        .work = exact_value(&m->work, scales->energy),
        .total = exact_value(&total, scales->energy),
        .account = {exact_value(&m->potential, scales->energy), exact_value(&m->elastic, scales->energy),
                    exact_value(&m->thermal, scales->energy), exact_value(&m->chemical, scales->energy),
                    exact_value(&m->phase, scales->energy), exact_value(&m->damped, scales->energy)},
        .elements = (double)m->elements,
        .dt_share = m->dt_share,
        .compression = m->compression};
}

void history_put_row(struct file_out *f, const struct config *c, const struct measure_scales *scales,
                     int64_t step, const struct measures *m, double drift)
{
    struct exact_sum total = conserved_sum(m);
    const struct exact_sum *energies[] = {&m->kinetic,  &m->potential, &m->elastic, &m->thermal,
                                          &m->chemical, &m->phase,     &m->work,    &total};
    file_printf(f, "%" PRId64, step);
    write_number(f, config_time(c, step));
    for (size_t i = 0; i < sizeof energies / sizeof energies[0]; i++)
        write_number(f, exact_value(energies[i], scales->energy));
    for (int a = 0; a < 2; a++)
        write_number(f, exact_value(&m->momentum[a], scales->momentum));
    write_number(f, exact_value(&m->angular, scales->momentum));
    file_printf(f, ",%" PRIu64 ",%" PRIu64 ",%" PRIu64, m->elements, m->links, m->contacts);
    write_number(f, m->t_max);
    write_number(f, m->p_min);
    write_number(f, m->p_max);
    write_number(f, drift);
    write_number(f, m->dt_share);
    write_number(f, m->compression);
    write_number(f, measures_unbalanced(m, scales));
    write_number(f, measures_coordination(m));
    double fabric[3];
    measures_fabric(m, fabric);
    for (int a = 0; a < 3; a++)
        write_number(f, fabric[a]);
    write_number(f, exact_value(&m->damped, scales->energy));
    for (size_t p = 0; p < c->n_probes; p++)
        write_probe(f, &c->probes[p], scales, &m->probe[p]);
    file_puts(f, "\n");
}

/* --- profile-NAME.csv --- */

void history_put_profile_heading(struct file_out *f, const struct profile_config *c)
{
    static const char *const columns[][2] = {
        {"elements", ""},      {"density", "g/cm3"},  {"vx", "cm/us"},
        {"vy", "cm/us"},       {"stress_xx", "Mbar"}, {"stress_yy", "Mbar"},
        {"stress_xy", "Mbar"}, {"temperature", "K"},  {"porosity", ""}};
    file_printf(f, "step,time [us],%s [cm]", c->axis == AXIS_X ? "x" : "y");
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        file_puts(f, ",");
        write_heading(f, columns[i][0], columns[i][1]);
    }
    file_puts(f, "\n");
}

enum dm2_status history_put_profile(struct file_out *f, const struct config *c,
                                    const struct measure_scales *scales, size_t which, int64_t step,
                                    const struct profile_bin *bins, struct dm2_error *err)
{
    const struct profile_config *profile = &c->profiles[which];
    for (size_t k = 0; k < (size_t)profile->bins; k++) {
        struct profile_means m = profile_means(&bins[k], profile, c, scales);
        file_printf(f, "%" PRId64, step);
        write_number(f, config_time(c, step));
        write_number(f, profile_centre(profile, k));
        file_printf(f, ",%" PRIu64, bins[k].elements);
        const double means[] = {m.density,   m.velocity[0], m.velocity[1], m.stress[0],
                                m.stress[1], m.stress[2],   m.temperature, m.porosity};
        for (size_t i = 0; i < sizeof means / sizeof means[0]; i++)
            write_number(f, means[i]);
        file_puts(f, "\n");
    }
    return file_flush(f, err);
}

/* --- fragments.csv --- */

void history_put_fragments_heading(struct file_out *f)
{
    file_puts(f, "step,time [us],fragments,single,largest\n");
}

enum dm2_status history_put_fragments(struct file_out *f, const struct config *c, int64_t step,
                                      const struct fragment_counts *counts, struct dm2_error *err)
{
    file_printf(f, "%" PRId64, step);
    write_number(f, config_time(c, step));
    file_printf(f, ",%zu,%zu,%zu\n", counts->fragments, counts->single, counts->largest);
    return file_flush(f, err);
}
