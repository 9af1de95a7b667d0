/* Discs start at random places and overlap. Each sweep pushes both discs of every overlapping pair apart by
 * half the overlap, and every disc into the container, until no two discs overlap. After 1000 sweeps an
 * overlap of 1e-5 grain sizes is accepted, because large dense packings reach that overlap and hardly less.
 * The discs take up to some 0.83 of the area (the random close packing of discs is 0.82 to 0.84). Polygons
 * are inscribed in such discs. Across periodic sides that the body spans, overlaps are those of the nearest
 * images. */
#include "packing.h"

#include <math.h>

#include "dm2/base/grid.h"
#include "dm2/base/mem.h"
#include "dm2/base/random.h"
#include "dm2/base/real.h"
#include "dm2/deck/shape.h"
#include "grain_sizes.h"
#include "point_bins.h"

static const double pi = 0x1.921fb54442d18p1;

enum { SWEEPS = 20000, STRICT_SWEEPS = 1000 };
static const double push_slack = 1e-3; /* extra distance of a push, relative to the contact distance */
static const double left_over = 1e-5;  /* in grain sizes: the overlap accepted after STRICT_SWEEPS sweeps */

/* Moves a disc of this radius at x into the container. Returns the distance of the move, cm. */
static double keep_inside(const struct body_config *body, const struct grain_set *set, double x[2],
                          double radius)
{
    const struct shape_config *s = &body->shape;
    double out = 0.0;
    if (s->kind == SHAPE_DISC) {
        double dx = x[0] - s->centre[0], dy = x[1] - s->centre[1], r = sqrt(dx * dx + dy * dy),
               most = s->radius - radius;
        if (r > most) {
            out = r - most;
            x[0] = s->centre[0] + dx * (most / r);
            x[1] = s->centre[1] + dy * (most / r);
        }
        return out;
    }
    for (int a = 0; a < 2; a++) {
        double low = s->box[a], high = s->box[a + 2], before = x[a];
        int32_t turns;
        if (set->wraps[a])
            x[a] = grid_wrap(set->low[a], set->period[a], x[a], &turns);
        else {
            x[a] = x[a] < low + radius ? low + radius : x[a] > high - radius ? high - radius : x[a];
            out = fabs(x[a] - before) > out ? fabs(x[a] - before) : out;
        }
    }
    return out;
}

/* Pushes discs i and j apart where they are closer than their contact distance times 1 + slack. Returns their
 * overlap, cm, which does not include the slack. */
static double push_apart(struct grain_set *set, size_t i, size_t j, double slack, uint64_t seed)
{
    struct grain *p = &set->grain[i], *q = &set->grain[j];
    double d[2], touch = p->reach + q->reach, wanted = touch * (1.0 + slack);
    for (int a = 0; a < 2; a++) {
        d[a] = p->centre[a] - q->centre[a];
        if (set->wraps[a])
            d[a] -= set->period[a] * rint(d[a] / set->period[a]);
    }
    double r2 = d[0] * d[0] + d[1] * d[1];
    if (r2 >= wanted * wanted)
        return 0.0;
    double r = sqrt(r2);
    if (!(r > 1e-6 * touch)) { /* the centres coincide: push along a random direction */
        double angle = 2.0 * pi * random_uniform(seed, i, RANDOM_GRAIN_ANGLE);
        d[0] = real_cos(angle);
        d[1] = real_sin(angle);
        r = 0.0;
    } else {
        d[0] /= r;
        d[1] /= r;
    }
    for (int a = 0; a < 2; a++) {
        p->centre[a] += 0.5 * (wanted - r) * d[a];
        q->centre[a] -= 0.5 * (wanted - r) * d[a];
    }
    return touch - r;
}

/* Lists bin i and the bins next to bin i along one direction of n bins, each bin once, even where the
 * direction wraps and has fewer than three bins. */
static size_t list_bins_around(int64_t i, int64_t n, bool wraps, int64_t out[3])
{
    size_t count = 0;
    for (int64_t k = i - 1; k <= i + 1; k++) {
        int64_t at = wraps ? (k + n) % n : k;
        bool seen = at < 0 || at >= n;
        for (size_t m = 0; m < count; m++)
            seen |= out[m] == at;
        if (!seen)
            out[count++] = at;
    }
    return count;
}

/* One sweep over all discs. Returns the largest overlap of two discs, or of a disc with the container's wall,
 * that the sweep removed, cm. */
static double sweep_discs(const struct body_config *body, struct grain_set *set, struct point_bins *b,
                          double slack)
{
    double worst = 0.0;
    point_bins_clear(b);
    for (size_t g = 0; g < set->n; g++)
        point_bins_add(b, (int64_t)g, set->grain[g].centre);
    for (size_t g = 0; g < set->n; g++) {
        int64_t us[3], vs[3];
        size_t n_u =
            list_bins_around(point_bins_index(b, 0, set->grain[g].centre[0]), b->n[0], set->wraps[0], us);
        size_t n_v =
            list_bins_around(point_bins_index(b, 1, set->grain[g].centre[1]), b->n[1], set->wraps[1], vs);
        for (size_t v = 0; v < n_v; v++) {
            for (size_t u = 0; u < n_u; u++) {
                for (int64_t k = b->head[vs[v] * b->n[0] + us[u]]; k >= 0; k = b->next[k]) {
                    double overlap = (size_t)k < g ? push_apart(set, g, (size_t)k, slack, body->seed) : 0.0;
                    worst = overlap > worst ? overlap : worst;
                }
            }
        }
    }
    for (size_t g = 0; g < set->n; g++) {
        double out = keep_inside(body, set, set->grain[g].centre, set->grain[g].reach);
        worst = out > worst ? out : worst;
    }
    return worst;
}

enum dm2_status packing_build(const struct body_config *body, uint32_t first, struct grain_set *set,
                              struct dm2_error *err)
{
    double box[4], largest = 0.0, worst = INFINITY;
    struct point_bins bins = {0};
    shape_box(&body->shape, box);
    enum dm2_status status = grain_sizes_choose(body, first, set, err);
    if (status != DM2_OK)
        return status;
    for (size_t g = 0; g < set->n; g++) {
        struct grain *p = &set->grain[g];
        largest = p->reach > largest ? p->reach : largest;
        for (int a = 0; a < 2; a++)
            p->centre[a] =
                box[a] + (box[a + 2] - box[a]) *
                             random_uniform(body->seed, first + g, a == 0 ? RANDOM_GRAIN_X : RANDOM_GRAIN_Y);
    }
    int sweeps = 0, most = set->n > 4000 ? SWEEPS / 4 : SWEEPS;
    if (point_bins_start(&bins, box, box + 2, 2.0 * largest * (1.0 + push_slack), set->n) != 0) {
        point_bins_free(&bins);
        return dm2_fail(err, DM2_MEMORY, "no memory for the grains of the body '%s'", body->name);
    }
    double touch = 1e-9 * body->grain_size;
    while (sweeps++ < most && worst > (sweeps <= STRICT_SWEEPS ? touch : left_over * body->grain_size)) {
        pulse_beat(set->pulse);
        if (pulse_stopped(set->pulse))
            break;
        worst = sweep_discs(body, set, &bins, push_slack);
        if (worst <= touch) /* without slack only overlaps, which the last pushes may have made, move discs */
            worst = sweep_discs(body, set, &bins, 0.0);
    }
    point_bins_free(&bins);
    if (pulse_stopped(set->pulse))
        return pulse_give_up(err);
    if (worst > left_over * body->grain_size)
        return config_fail(
            body->packing_place, err, DM2_DECK,
            "the powder of the body '%s' cannot be packed to a solid fraction of %g: after %d sweeps grains "
            "still overlap by %.2g of their size; grains of this size reach about %.2f: choose less, or "
            "larger "
            "grains",
            body->name, body->solid_fraction, most, worst / body->grain_size,
            grain_sizes_reachable(body, first, set));
    return DM2_OK;
}
