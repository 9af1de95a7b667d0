/* The outline of a wall is worked out from its pose alone, so that every process draws the same. */
#include "dm2/engine/wall_outline.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/base/real.h"
#include "wall.h"

enum { CHORDS = 128 };

static size_t count_points(const struct wall_config *c)
{
    return c->n_points > 0 ? c->n_points : CHORDS + 1;
}

/* Point k of the wall at the start, against the wall's centre. */
static void find_point(const struct wall *w, size_t k, double out[2])
{
    const struct wall_config *c = w->config;
    if (w->circle) {
        double angle = (double)(k % CHORDS) * (0x1.921fb54442d18p2 / CHORDS);
        out[0] = w->radius * real_cos(angle);
        out[1] = w->radius * real_sin(angle);
        return;
    }
    for (size_t a = 0; a < 2; a++)
        out[a] = c->points[2 * k + a] - w->centre[a];
}

static void outline_wall(const struct model *m, const struct loading *l, const struct wall *w, int64_t step,
                         double (*point)[2])
{
    const struct grid *g = &m->grid;
    struct wall_pose pose;
    double centre[2];
    wall_pose_at(m, l, w, step, &pose);
    for (size_t a = 0; a < 2; a++) {
        centre[a] = w->centre[a] + pose.d[a];
        if (g->periodic[a])
            centre[a] -= floor((centre[a] - g->origin[a]) / g->size[a]) * g->size[a];
    }
    for (size_t k = 0; k < count_points(w->config); k++) {
        double at[2];
        find_point(w, k, at);
        point[k][0] = centre[0] + (pose.cosine * at[0] - pose.sine * at[1]);
        point[k][1] = centre[1] + (pose.sine * at[0] + pose.cosine * at[1]);
    }
}

enum dm2_status wall_outlines_find(const struct model *model, const struct loading *loading, int64_t step,
                                   struct wall_outlines *out, struct dm2_error *err)
{
    size_t points = 0;
    *out = (struct wall_outlines){.n_walls = model->n_walls};
    for (size_t k = 0; k < model->n_walls; k++)
        points += count_points(model->walls[k].config);
    out->start = mem_zalloc(model->n_walls + 1, sizeof *out->start);
    out->point = mem_zalloc(points, sizeof *out->point);
    if (out->start == NULL || out->point == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the outlines of %zu walls", model->n_walls);
    for (size_t k = 0; k < model->n_walls; k++) {
        out->start[k + 1] = out->start[k] + count_points(model->walls[k].config);
        outline_wall(model, loading, &model->walls[k], step, out->point + out->start[k]);
    }
    return DM2_OK;
}

void wall_outlines_free(struct wall_outlines *outlines)
{
    free(outlines->start);
    free(outlines->point);
    *outlines = (struct wall_outlines){.n_walls = 0};
}
