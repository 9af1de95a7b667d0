/* Strain by least squares over the interacting neighbours.
 *
 * Each pair adds r (x) r and du (x) r, du = dv dt, to both its elements as 64-bit integers, so that neither
 * the sums depend on order nor the strain on the number of servers; both products are even in the pair's
 * orientation. The quantum is 2^-48 r0^2, r0 the largest contact distance: strain increments are good to
 * about 1e-14.
 *
 * With r midway between the last two positions, r(n) - du/2, the increment of a homogeneous stretch from l to
 * l' is 2 (l' - l)/(l' + l): the sum of many increments is the logarithmic strain, to second order in the
 * time step. */
#include "strain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "periodic.h"

enum strain_sum { RXX, RYY, RXY, UXX, UXY, UYX, UYY }; /* UXY: du_x r_y */

static const double quantum_bits = 0x1p48; /* quanta in r0^2 */

/* Of the part of one pair: the sums of 64 pairs of one element still fit. */
static const double range = 0x1p57;

/* Neighbours whose second moments have det <= 2^-6 (trace)^2 lie on one line, within some 14 degrees: their
 * motion across the line is noise. */
static const double on_one_line = 0x1p-6;

void strain_free(struct strain_sums *s)
{
    free(s->sum);
    *s = (struct strain_sums){0};
}

static enum dm2_status reserve_sums(struct strain_sums *s, size_t n, struct dm2_error *err)
{
    if (n <= s->cap)
        return DM2_OK;
    int64_t *grown = mem_alloc(n + n / 16, STRAIN_SUMS * sizeof *grown);
    if (grown == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the strain of %zu elements", n);
    free(s->sum);
    s->sum = grown;
    s->cap = n + n / 16;
    return DM2_OK;
}

/* Nearest integer of a scaled double, halves away from 0; |scaled| < range. */
static inline int64_t to_fixed(double scaled)
{
    return (int64_t)(scaled + copysign(0.5, scaled));
}

/* Adds the part of a pair to the sums a and b of its elements. False where the part is out of range. */
static bool add_pair(int64_t *a, int64_t *b, const double r[2], const double u[2], double scale)
{
    const double part[STRAIN_SUMS] = {
        [RXX] = r[0] * r[0], [RYY] = r[1] * r[1], [RXY] = r[0] * r[1], [UXX] = u[0] * r[0],
        [UXY] = u[0] * r[1], [UYX] = u[1] * r[0], [UYY] = u[1] * r[1]};
    for (int k = 0; k < STRAIN_SUMS; k++) {
        double scaled = part[k] * scale;
        if (!(fabs(scaled) < range))
            return false;
        int64_t quanta = to_fixed(scaled);
        a[k] += quanta;
        b[k] += quanta;
    }
    return true;
}

/* strain += sym(U R^-1), U = sum du (x) r, R = sum r (x) r; the common scale cancels. */
static void add_increment(const int64_t *sum, double strain[3])
{
    double xx = (double)sum[RXX], yy = (double)sum[RYY], xy = (double)sum[RXY];
    double det = xx * yy - xy * xy, trace = xx + yy;
    if (!(det > on_one_line * (trace * trace)))
        return;
    double uxx = (double)sum[UXX], uxy = (double)sum[UXY], uyx = (double)sum[UYX], uyy = (double)sum[UYY];
    strain[0] += (uxx * yy - uxy * xy) / det;
    strain[1] += (uyy * xx - uyx * xy) / det;
    strain[2] += 0.5 * ((uxy * xx - uxx * xy) + (uyx * yy - uyy * xy)) / det;
}

enum dm2_status strain_add(const struct model *m, struct particles *p, const struct lists *lists,
                           double dt_path, int64_t step, struct strain_sums *s, struct dm2_error *err)
{
    if (dt_path == 0.0)
        return DM2_OK;
    enum dm2_status status = reserve_sums(s, p->n, err);
    if (status != DM2_OK)
        return status;
    const struct half_list *near = &lists->near;
    double r0 = 2.0 * m->radius_max, scale = quantum_bits / (r0 * r0);
    const struct period period = period_of(&m->grid);
    memset(s->sum, 0, p->n * STRAIN_SUMS * sizeof *s->sum);
    for (size_t i = 0; i < p->n_own; i++) {
        for (uint32_t k = near->start[i]; k < near->start[i + 1]; k++) {
            size_t j = near->j[k];
            double contact = p->radius[i] + p->radius[j], r[2], u[2];
            for (size_t a = 0; a < 2; a++) {
                r[a] = period_nearest(p->r[2 * i + a] - p->r[2 * j + a], period.size[a], period.half[a]);
                u[a] = (p->v[2 * i + a] - p->v[2 * j + a]) * dt_path;
            }
            if (!lists->linked[k] && !law_touches(sqrt(r[0] * r[0] + r[1] * r[1]), contact))
                continue;
            for (int a = 0; a < 2; a++)
                r[a] -= 0.5 * u[a];
            if (!add_pair(s->sum + STRAIN_SUMS * i, s->sum + STRAIN_SUMS * j, r, u, scale))
                return dm2_fail(
                    err, DM2_NUMERIC,
                    "step %lld: elements %u and %u, near (%g, %g) cm, pass each other too fast to measure "
                    "strain; a smaller dt may help",
                    (long long)step, p->id[i], p->id[j], p->r[2 * i], p->r[2 * i + 1]);
        }
        /* Pairs of i with lower slots are in earlier rows, so the sums of i are complete. */
        add_increment(s->sum + STRAIN_SUMS * i, p->strain + 3 * i);
    }
    return DM2_OK;
}
