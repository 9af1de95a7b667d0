/* Sums and counts add; extremes take the further of two. */
#include "dm2/engine/measures.h"

#include <math.h>
#include <string.h>

void measures_clear(struct measures *m)
{
    memset(m, 0, sizeof *m);
    m->t_max = -INFINITY;
    m->p_min = INFINITY;
    m->p_max = -INFINITY;
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
    exact_merge(&m->momentum[0], &part->momentum[0]);
    exact_merge(&m->momentum[1], &part->momentum[1]);
    exact_merge(&m->angular, &part->angular);
    m->elements += part->elements;
    m->links += part->links;
    m->contacts += part->contacts;
    m->t_max = part->t_max > m->t_max ? part->t_max : m->t_max;
    m->p_min = part->p_min < m->p_min ? part->p_min : m->p_min;
    m->p_max = part->p_max > m->p_max ? part->p_max : m->p_max;
    m->dt_share = part->dt_share > m->dt_share ? part->dt_share : m->dt_share;
    m->compression = part->compression > m->compression ? part->compression : m->compression;
    for (int p = 0; p < PROBE_MAX; p++) {
        m->probe[p].count += part->probe[p].count;
        for (int a = 0; a < 2; a++) {
            exact_merge(&m->probe[p].r[a], &part->probe[p].r[a]);
            exact_merge(&m->probe[p].v[a], &part->probe[p].v[a]);
        }
    }
}
