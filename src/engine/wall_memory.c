/* The memory of wall contacts in a rebuild and in states; what walls felt, for probes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "id_order.h"
#include "motion.h"
#include "probes.h"
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

enum dm2_status subdomain_collect_wall_forces(const struct subdomain *sd, struct section_array *out,
                                              struct dm2_error *err)
{
    const struct section_array *forces = &sd->walls.forces;
    if (!section_append(SECTION_WFOR, out, forces->records, forces->n))
        return subdomain_no_memory(sd, err);
    return section_sort(SECTION_WFOR, out, err);
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
        .heat = exact_value(&sums->heat, m->scales.energy)};
}

/* *x times 2^left, 0 < left < 64. */
static struct exact_sum shifted(const struct exact_sum *x, int left)
{
    return (struct exact_sum){.hi = (int64_t)((uint64_t)x->hi << left | x->lo >> (64 - left)),
                              .lo = x->lo << left};
}

/* How the wall moves at the whole step. */
static bool add_motion(const struct subdomain *sd, const struct wall *w, struct probe_sums *out)
{
    const struct model *m = sd->model;
    const struct wall_pose *pose = &sd->walls.pose[w - m->walls];
    double before = sd->step == m->config->n_start ? 1.0 : 0.5, behind = 1.0 - before;
    bool fits = true;
    out->count++;
    for (int a = 0; a < 2; a++) {
        fits &= probe_add(out, &m->scales, (enum probe_sum)(PROBE_X + a), w->centre[a] + pose->d[a]);
        fits &= probe_add(out, &m->scales, (enum probe_sum)(PROBE_VX + a),
                          before * pose->v[a] + behind * pose->next_v[a]);
    }
    fits &= probe_add(out, &m->scales, PROBE_SPIN, before * pose->spin + behind * pose->next_spin);
    return fits &
           (isnan(pose->temperature) || probe_add(out, &m->scales, PROBE_TEMPERATURE, pose->temperature));
}

enum dm2_status wall_probes_add(const struct subdomain *sd, struct measures *out, struct dm2_error *err)
{
    const struct model *m = sd->model;
    for (size_t k = 0; k < m->config->n_probes; k++) {
        const struct probe_config *p = &m->config->probes[k];
        struct exact_sum force[2];
        if (!p->wall)
            continue;
        const struct wall *w = &m->walls[(size_t)p->mover - m->config->n_bodies];
        const struct wall_sums *felt = &sd->walls.sums[w - m->walls];
        struct probe_sums *sums = &out->probe[k];
        for (int a = 0; a < 2; a++)
            force[a] = shifted(&felt->force[a], m->fixed.energy_left);
        const struct {
            enum probe_sum sum;
            const struct exact_sum *from;
        } part[] = {{PROBE_FX, &force[0]},
                    {PROBE_FY, &force[1]},
                    {PROBE_TORQUE, &felt->torque},
                    {PROBE_HEAT, &felt->heat}};
        for (size_t s = 0; s < sizeof part / sizeof part[0]; s++)
            if (sums->needs >> part[s].sum & 1u)
                exact_merge(&sums->sum[part[s].sum], part[s].from);
        if (sd->rank == 0 && !add_motion(sd, w, sums))
            return dm2_fail(err, DM2_NUMERIC,
                            "step %lld: the wall '%s' has left the range that sums can hold, a million times "
                            "the domain: end the run earlier",
                            (long long)sd->step, w->config->name);
    }
    return DM2_OK;
}
