/* The memory of wall contacts in a rebuild and in states. */
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "id_order.h"
#include "subdomain_parts.h"

/* --- rebuilds --- */

static int add_record(struct wall_array *a, const struct wall_contact *record)
{
    struct wall_contact *grown = mem_grown(a->item, &a->cap, a->n, a->n + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    a->item = grown;
    a->item[a->n++] = *record;
    return 0;
}

/* The record of entry k in the row of slot i. */
static struct wall_contact record_of(const struct subdomain *sd, size_t i, const struct wall_entry *entry)
{
    struct wall_contact record;
    memset(&record, 0, sizeof record);
    record.id = sd->p.id[i];
    record.feature = entry->feature;
    record.sign = (int8_t)entry->sign;
    record.spring = entry->spring;
    return record;
}

int wall_memory_send(struct subdomain *sd, const int32_t *destination)
{
    const struct walls *ws = &sd->walls;
    for (size_t row = 0; row < ws->n_rows; row++) {
        int32_t to = destination[ws->slot[row]];
        for (uint32_t k = ws->start[row]; to >= 0 && k < ws->start[row + 1]; k++) {
            struct wall_contact record = record_of(sd, ws->slot[row], &ws->entry[k]);
            if (record.sign != 0 && add_record(&sd->neighbours[to].walls, &record) != 0)
                return -1;
        }
    }
    return 0;
}

int wall_memory_carry(struct subdomain *sd, const struct parcel *parcels, size_t n_parcels,
                      const uint32_t *moved)
{
    struct walls *ws = &sd->walls;
    for (size_t row = 0; row < ws->n_rows; row++) {
        uint32_t slot = moved[ws->slot[row]];
        for (uint32_t k = ws->start[row]; slot != PARTICLES_NONE && k < ws->start[row + 1]; k++) {
            const struct wall_entry *entry = &ws->entry[k];
            if (entry->sign != 0 && walls_carry(ws, slot, entry->feature, entry->sign, entry->spring) != 0)
                return -1;
        }
    }
    for (size_t q = 0; q < n_parcels; q++) {
        for (size_t k = 0; k < parcels[q].n_walls; k++) {
            const struct wall_contact *from = &parcels[q].walls[k];
            int32_t slot = idmap_find(&sd->ids, from->id);
            if (slot >= 0 && (size_t)slot < sd->p.n_own &&
                walls_carry(ws, (uint32_t)slot, from->feature, from->sign, from->spring) != 0)
                return -1;
        }
    }
    return 0;
}

/* --- states --- */

enum dm2_status wall_memory_collect(const struct subdomain *sd, struct section_array *out,
                                    struct dm2_error *err)
{
    const struct walls *ws = &sd->walls;
    for (size_t row = 0; row < ws->n_rows; row++) {
        for (uint32_t k = ws->start[row]; k < ws->start[row + 1]; k++) {
            const struct wall_contact record = record_of(sd, ws->slot[row], &ws->entry[k]);
            if (record.sign != 0 && !section_append(SECTION_WCON, out, &record, 1))
                return subdomain_no_memory(sd, err);
        }
    }
    return section_sort(SECTION_WCON, out, err);
}

/* --- sums --- */

const struct wall_sums *subdomain_wall_sums(const struct subdomain *sd)
{
    return sd->walls.sums;
}

struct wall_load subdomain_wall_load(const struct model *m, const struct wall_sums *sums)
{
    double over = m->fixed.over_force; /* a power of two: exact */
    return (struct wall_load){
        .force = {exact_value(&sums->force[0], 0) * over, exact_value(&sums->force[1], 0) * over},
        .torque = exact_value(&sums->torque, m->scales.energy),
        .heat = exact_value(&sums->heat, m->scales.energy),
        .magnitude = exact_value(&sums->magnitude, 0) * over};
}
