/* Prints the force on a body, as the sum over the pairs of a snapshot:
 *
 *     body_force SNAPSHOT.vtp BODY     (the body's number, from 0)
 *
 * The sum of doubles is exact, because each force is a whole multiple of a power of two far above its
 * rounding. Also checks that no pair is there twice, that normal and tangential parts make up the force, and
 * that a line has its two elements as ends, or no length. */
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

int main(int argc, char **argv)
{
    struct vtp vtp;
    struct dm2_error err = {0};
    if (argc != 3 || vtp_read(argv[1], &vtp, &err) != DM2_OK) {
        fprintf(stderr, "usage: body_force SNAPSHOT.vtp BODY; %s\n", err.text);
        return 1;
    }
    const double *id = find(&vtp, "PointData", "id"), *body = find(&vtp, "PointData", "body");
    const double *a = find(&vtp, "CellData", "id_a"), *b = find(&vtp, "CellData", "id_b");
    const double *force[2] = {find(&vtp, "CellData", "force_x"), find(&vtp, "CellData", "force_y")};
    const double *normal = find(&vtp, "CellData", "normal"),
                 *tangential = find(&vtp, "CellData", "tangential");
    size_t cells = vtp_find(&vtp, "CellData", "id_a")->n_tuples;
    double sum[2] = {0, 0};
    for (size_t k = vtp.n_points; k < cells; k++) {
        size_t end[2] = {find_point(&vtp, id, a[k]), find_point(&vtp, id, b[k])};
        CHECK(a[k] < b[k] && (end[0] < vtp.n_points || end[1] < vtp.n_points));
        CHECK(k == vtp.n_points || a[k - 1] < a[k] || (a[k - 1] == a[k] && b[k - 1] < b[k]));
        double whole = hypot(force[0][k], force[1][k]), parts = hypot(normal[k], tangential[k]);
        CHECK_NEAR(whole, parts, 1e-9 * parts + 1e-11);
        for (int end_of = 0; end_of < 2; end_of++)
            for (int c = 0; c < 2 && end[end_of] < vtp.n_points; c++)
                if (body[end[end_of]] == atof(argv[2]))
                    sum[c] += end_of == 0 ? force[c][k] : -force[c][k];
    }
    for (int c = 0; c < 2; c++) {
        char text[NUMBER_TEXT_MAX];
        number_format(sum[c] + 0.0, text);
        printf("%s%s", c == 0 ? "" : ",", text);
    }
    printf("\n");
    vtp_free(&vtp);
    return check_failures == 0 ? 0 : 1;
}
