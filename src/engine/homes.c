/* Homes as records of a state; see homes.h. A home is compared with the element's place, because everything
 * else that a wrong home would do is done only at the next step. */
#include "homes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"
#include "periodic.h"
#include "tables.h"

static enum dm2_status no_memory(size_t n, struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "no memory for the homes of %zu elements", n);
}

enum dm2_status homes_collect(const struct model *m, const struct particles *p, struct section_array *out,
                              struct dm2_error *err)
{
    for (size_t i = 0; i < p->n_own; i++) {
        struct home_record home = {p->id[i], {p->home[2 * i], p->home[2 * i + 1]}};
        if (m->placed[p->body[i]] && !section_append(SECTION_HOME, out, &home, 1))
            return no_memory(p->n_own, err);
    }
    return section_sort(SECTION_HOME, out, err);
}

enum dm2_status homes_sorted(const struct section_array *homes, struct section_array *out,
                             struct dm2_error *err)
{
    *out = (struct section_array){.n = 0};
    if (!section_append(SECTION_HOME, out, homes->records, homes->n))
        return no_memory(homes->n, err);
    return section_sort(SECTION_HOME, out, err);
}

static int compare_id(const void *key, const void *record)
{
    uint32_t id = *(const uint32_t *)key, other = section_element(record);
    return id < other ? -1 : id > other;
}

enum dm2_status homes_find(const struct model *m, const struct section_array *homes, int64_t step,
                           const struct loading *loading, struct element *e, struct dm2_error *err)
{
    const char *body = m->config->bodies[e->body].name;
    const struct home_record *found =
        homes->n == 0 ? NULL
                      : bsearch(&e->id, homes->records, homes->n, sizeof(struct home_record), compare_id);
    if (found == NULL)
        return dm2_fail(err, DM2_PROTOCOL,
                        "element %u of body '%s' has no record in section HOME, and the body follows a load",
                        e->id, body);
    memcpy(e->home, found->home, sizeof e->home);
    struct body_drive d;
    double at[2], off2 = 0.0, edge = m->grid.lx < m->grid.ly ? m->grid.lx : m->grid.ly;
    const struct period period = period_of(&m->grid);
    drive_set_place(m, e->body, step - 1, &d);
    loading_add_shift(loading, e->body, d.to);
    drive_place(&d, e->home, at);
    for (size_t a = 0; a < 2; a++) {
        double off = fmod(at[a] - e->r[a], m->grid.periodic[a] ? m->grid.size[a] : HUGE_VAL);
        off = period_nearest(off, period.size[a], period.half[a]);
        off2 += off * off;
    }
    if (off2 <= 1e-12 * edge * edge)
        return DM2_OK;
    return dm2_fail(
        err, DM2_PROTOCOL,
        "element %u of body '%s' is at (%.17g, %.17g) cm, and its home in section HOME puts it at "
        "(%.17g, %.17g) cm",
        e->id, body, e->r[0], e->r[1], at[0], at[1]);
}
