/* The condition of a block `stop` on a column of a probe: NAME QUANTITY above|below VALUE. */
#include "bind_stops.h"

#include <math.h>
#include <stdio.h>

#include "dm2/base/words.h"
#include "findings.h"

#define DIM(l, m, t, k)                                                                                      \
    {                                                                                                        \
        l, m, t, k, 0                                                                                        \
    }

/* The quantities: the end of the column's name, and what of `report` gives the column. A test compares them
 * with the columns of engine/probe.h. */
static const struct quantity_column {
    const char *name;
    enum probe_quantity report;
    struct dimension dim;
} quantities[] = {
    {"x", REPORT_POSITION, DIM(1, 0, 0, 0)},         {"y", REPORT_POSITION, DIM(1, 0, 0, 0)},
    {"vx", REPORT_VELOCITY, DIM(1, 0, -1, 0)},       {"vy", REPORT_VELOCITY, DIM(1, 0, -1, 0)},
    {"fx", REPORT_FORCE, DIM(1, 1, -2, 0)},          {"fy", REPORT_FORCE, DIM(1, 1, -2, 0)},
    {"torque", REPORT_TORQUE, DIM(2, 1, -2, 0)},     {"spin", REPORT_SPIN, DIM(0, 0, -1, 0)},
    {"stress_xx", REPORT_STRESS, DIM(-1, 1, -2, 0)}, {"stress_yy", REPORT_STRESS, DIM(-1, 1, -2, 0)},
    {"stress_xy", REPORT_STRESS, DIM(-1, 1, -2, 0)}, {"temperature", REPORT_TEMPERATURE, DIM(0, 0, 0, 1)},
    {"kinetic", REPORT_KINETIC, DIM(2, 1, -2, 0)},   {"porosity", REPORT_POROSITY, DIM(0, 0, 0, 0)},
    {"heat", REPORT_HEAT, DIM(2, 1, -3, 0)}};
enum { QUANTITIES = sizeof quantities / sizeof quantities[0] };

/* --- words --- */

static const char *probe_name(const void *context, size_t i)
{
    return ((const struct config *)context)->probes[i].name;
}

static const char *quantity_name(const void *context, size_t i)
{
    return ((const struct quantity_column *)context)[i].name;
}

static const char *side_name(const void *context, size_t i)
{
    return ((const char *const *)context)[i];
}

/* The index of the word at `place` in `known`; -1: none, and a finding was added that there is no such
 * `what`. */
static int find_word(struct deck_binding *b, struct deck_place place, const struct word_list *known,
                     const char *what)
{
    struct place_text text;
    struct word_hint hint;
    for (size_t i = 0; i < known->n; i++)
        if (place_is(b->tree->source, place, known->name(known->context, i)))
            return (int)i;
    if (!b->tree->incomplete)
        findings_error(b->findings, place, "there is no %s '%s'%s", what,
                       place_text(b->tree->source, place, &text),
                       words_hint(known, place_bytes(b->tree->source, place), place.length, &hint));
    return -1;
}

/* --- the condition --- */

bool stop_read_probe(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     struct stop_config *stop)
{
    static const char *const sides[] = {"below", "above"};
    const struct config *c = b->config;
    const struct word_list probes = {probe_name, c, c->n_probes},
                           columns = {quantity_name, quantities, QUANTITIES}, both = {side_name, sides, 2};
    struct deck_place place[3];
    if (entry->n != 4) {
        findings_error(b->findings, entry->key,
                       "'%s' takes the name of a probe, one of its quantities, above or below, and a number: "
                       "found %zu value%s",
                       key->name, entry->n, entry->n == 1 ? "" : "s");
        return false;
    }
    for (size_t i = 0; i < 3; i++)
        place[i] = b->tree->nodes[b->tree->values[entry->first + i]].place;
    int probe = find_word(b, place[0], &probes, "probe"),
        which = find_word(b, place[1], &columns, "quantity"), above = find_word(b, place[2], &both, "side");
    if (probe < 0 || which < 0 || above < 0)
        return false;
    const struct probe_config *p = &c->probes[probe];
    if (!(p->report >> quantities[which].report & 1u)) {
        findings_error(
            b->findings, place[1],
            "the probe '%s' does not report '%s': history.csv has no such column; add it to 'report'",
            p->name, quantities[which].name);
        return false;
    }
    const struct deck_key number = {
        .name = key->name, .dim = quantities[which].dim, .low = -HUGE_VAL, .high = HUGE_VAL};
    if (!value_read_real(b, &number, entry, 3, &stop->value))
        return false;
    stop->above = above == 1;
    (void)snprintf(stop->column, sizeof stop->column, "%s_%s", p->name, quantities[which].name);
    return true;
}
