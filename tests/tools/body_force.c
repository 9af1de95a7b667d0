/* Prints the force on a body or a wall, as the sum over the pairs and the contacts with walls of a snapshot:
 *
 *     body_force SNAPSHOT.vtp BODY          (the body's number, from 0)
 *     body_force SNAPSHOT.vtp wall WALL     (the wall's)
 *
 * The sum of doubles is exact, because each force is a whole multiple of a power of two far above its
 * rounding. Also checks that no pair is there twice, that normal and tangential parts make up the force, and
 * that a line has its two elements as ends, or no length; that the force of a wall is along the line to its
 * foot and across. */
#include "../unit/check.h"

#include <math.h>

#include "dm2/base/number.h"
#include "dm2/plot/vtp_reader.h"

static const double *find(const struct vtp *vtp, const char *section, const char *name)
{
    const struct vtp_array *a = vtp_find(vtp, section, name);
    CHECK_REPORT(a != NULL, "no array '%s' of %s", name, section);
    if (a == NULL)
        exit(1);
    return a->values;
}

/* The number of the point with this id; n_points: the element is not shown. */
static size_t find_point(const struct vtp *vtp, const double *id, double want)
{
    for (size_t i = 0; i < vtp->n_points; i++)
        if (id[i] == want)
            return i;
    return vtp->n_points;
}

struct snapshot {
    struct vtp vtp;
    const double *id, *a, *b, *force[2], *normal, *tangential, *wall;
    size_t cells, foot; /* foot: the point of the next contact with a wall */
};

static void read_snapshot(struct snapshot *s, const char *path)
{
    struct dm2_error err = {0};
    *s = (struct snapshot){.wall = NULL};
    if (vtp_read(path, &s->vtp, &err) != DM2_OK) {
        fprintf(stderr, "body_force: %s\n", err.text);
        exit(1);
    }
    s->id = find(&s->vtp, "PointData", "id");
    s->a = find(&s->vtp, "CellData", "id_a");
    s->b = find(&s->vtp, "CellData", "id_b");
    s->force[0] = find(&s->vtp, "CellData", "force_x");
    s->force[1] = find(&s->vtp, "CellData", "force_y");
    s->normal = find(&s->vtp, "CellData", "normal");
    s->tangential = find(&s->vtp, "CellData", "tangential");
    s->wall = s->vtp.walls.n > 0 ? find(&s->vtp, "CellData", "wall") : NULL;
    s->cells = vtp_find(&s->vtp, "CellData", "id_a")->n_tuples - s->vtp.walls.n;
    s->foot = s->vtp.n_points;
}

/* The wall of cell k; -1: a pair. */
static double wall_of(const struct snapshot *s, size_t k)
{
    return s->wall != NULL && s->wall[k] < (double)s->vtp.walls.n ? s->wall[k] : -1;
}

static void check_cell(struct snapshot *s, size_t k, const size_t end[2])
{
    const struct vtp *vtp = &s->vtp;
    bool wall = wall_of(s, k) >= 0, first = k == vtp->n_points || (wall && wall_of(s, k - 1) < 0);
    CHECK(s->a[k] < s->b[k] && (wall || end[0] < vtp->n_points || end[1] < vtp->n_points));
    CHECK(first || s->a[k - 1] < s->a[k] || (s->a[k - 1] == s->a[k] && (wall || s->b[k - 1] < s->b[k])));
    double whole = hypot(s->force[0][k], s->force[1][k]), parts = hypot(s->normal[k], s->tangential[k]);
    CHECK_NEAR(whole, parts, 1e-9 * parts + 1e-11);
    if (!wall)
        return;
    const double *foot = vtp->position + 3 * s->foot++;
    for (int c = 0; c < 2 && end[0] < vtp->n_points; c++) {
        const double *r = vtp->position + 3 * end[0];
        double d = hypot(r[0] - foot[0], r[1] - foot[1]), n[2] = {(r[0] - foot[0]) / d, (r[1] - foot[1]) / d};
        double t = c == 0 ? -n[1] : n[0];
        CHECK_NEAR(s->force[c][k], s->normal[k] * n[c] + s->tangential[k] * t, 1e-9 * parts + 1e-11);
    }
}

int main(int argc, char **argv)
{
    struct snapshot s;
    bool of_wall = argc == 4 && strcmp(argv[2], "wall") == 0;
    if (argc != 3 && !of_wall) {
        fprintf(stderr, "usage: body_force SNAPSHOT.vtp BODY | body_force SNAPSHOT.vtp wall WALL\n");
        return 1;
    }
    read_snapshot(&s, argv[1]);
    const double *body = find(&s.vtp, "PointData", "body"), which = atof(argv[argc - 1]);
    double sum[2] = {0, 0};
    for (size_t k = s.vtp.n_points; k < s.cells; k++) {
        size_t end[2] = {find_point(&s.vtp, s.id, s.a[k]), find_point(&s.vtp, s.id, s.b[k])};
        check_cell(&s, k, end);
        for (int c = 0; c < 2; c++) {
            double f = s.force[c][k];
            if (of_wall)
                sum[c] -= wall_of(&s, k) == which ? f : 0;
            else
                sum[c] += (end[0] < s.vtp.n_points && body[end[0]] == which ? f : 0) -
                          (end[1] < s.vtp.n_points && body[end[1]] == which ? f : 0);
        }
    }
    for (int c = 0; c < 2; c++) {
        char text[NUMBER_TEXT_MAX];
        number_format(sum[c] + 0.0, text);
        printf("%s%s", c == 0 ? "" : ",", text);
    }
    printf("\n");
    vtp_free(&s.vtp);
    return check_failures == 0 ? 0 : 1;
}
