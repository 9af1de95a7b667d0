/* Sums and counts add; extremes take the further of two. */
#include "dm2/engine/measures.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

void measures_clear(struct measures *m)
{
    memset(m, 0, offsetof(struct measures, probe));
    m->t_max = -INFINITY;
    m->p_min = INFINITY;
    m->p_max = -INFINITY;
}

bool measures_match(const struct measures *m, const struct config *c)
{
    bool match = m->n_probes == c->n_probes;
    for (size_t p = 0; match && p < c->n_probes; p++)
        match = m->probe[p].needs == probe_needs(&c->probes[p]);
    return match;
}

void measures_merge(struct measures *m, const struct measures *part)
{
    exact_merge(&m->kinetic, &part->kinetic);
    exact_merge(&m->potential, &part->potential);
    exact_merge(&m->elastic, &part->elastic);
    exact_merge(&m->thermal, &part->thermal);
    exact_merge(&m->chemical, &part->chemical);
    exact_merge(&m->phase, &part->phase);
    exact_merge(&m->work, &part->work);
    exact_merge(&m->damped, &part->damped);
    exact_merge(&m->momentum[0], &part->momentum[0]);
    exact_merge(&m->momentum[1], &part->momentum[1]);
    exact_merge(&m->angular, &part->angular);
    m->elements += part->elements;
    m->links += part->links;
    m->contacts += part->contacts;
    m->pairs += part->pairs;
    m->wall_contacts += part->wall_contacts;
    exact_merge(&m->fabric[0], &part->fabric[0]);
    exact_merge(&m->fabric[1], &part->fabric[1]);
    m->free_elements += part->free_elements;
    m->loaded_pairs += part->loaded_pairs;
    exact_merge(&m->resultants, &part->resultants);
    exact_merge(&m->magnitudes, &part->magnitudes);
    m->t_max = part->t_max > m->t_max ? part->t_max : m->t_max;
    m->p_min = part->p_min < m->p_min ? part->p_min : m->p_min;
    m->p_max = part->p_max > m->p_max ? part->p_max : m->p_max;
    m->dt_share = part->dt_share > m->dt_share ? part->dt_share : m->dt_share;
    m->compression = part->compression > m->compression ? part->compression : m->compression;
    for (; m->n_probes < part->n_probes; m->n_probes++)
        m->probe[m->n_probes] = (struct probe_sums){.needs = part->probe[m->n_probes].needs};
    for (size_t p = 0; p < part->n_probes; p++)
        probe_merge(&m->probe[p], &part->probe[p]);
}

double measures_unbalanced(const struct measures *m, const struct measure_scales *scales)
{
    double resultant = exact_value(&m->resultants, scales->force) / (double)m->free_elements;
    return resultant / (exact_value(&m->magnitudes, scales->force) / (double)m->loaded_pairs);
}

double measures_coordination(const struct measures *m)
{
    return (2.0 * (double)m->pairs + (double)m->wall_contacts) / (double)m->elements;
}

void measures_fabric(const struct measures *m, double fabric[3])
{
    uint64_t pairs = m->contacts - m->wall_contacts;
    double n = (double)pairs;
    struct exact_sum yy = {.hi = ~m->fabric[0].hi, .lo = ~m->fabric[0].lo}; /* pairs - xx */
    exact_add_units(&yy, 1, 0);
    exact_add_units(&yy, (int64_t)pairs, FABRIC_SHIFT);
    fabric[0] = exact_value(&m->fabric[0], FABRIC_SHIFT) / n;
    fabric[1] = exact_value(&yy, FABRIC_SHIFT) / n;
    fabric[2] = exact_value(&m->fabric[1], FABRIC_SHIFT) / n;
}
