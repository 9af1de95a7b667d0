/* Checks that the run directory of the plate impact (input/plate-impact.dm2) shows the results of the paper's
 * section 7.1:
 *
 *     check_impact RUN
 *
 * Reads history.csv, the first and the last snapshot and final.dm2 with the project's own readers. */
#include "../unit/check.h"

#include "dm2/base/csv.h"
#include "dm2/output/state.h"
#include "dm2/plot/vtp_reader.h"

enum { ROWS = 31, FLYER_ROWS = 9, ELEMENTS = 1689, STEPS = 200 };

static const char *directory;

static const char *name_file(const char *name)
{
    static char path[1000];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return path;
}

static void require_ok(enum dm2_status status, const struct dm2_error *err)
{
    if (status != DM2_OK) {
        printf("%s\n", err->text);
        exit(1);
    }
}

static double *read_column(const struct csv *history, const char *name)
{
    struct dm2_error err = {0};
    size_t at;
    double *numbers;
    require_ok(csv_column(history, name, &at, &err), &err);
    require_ok(csv_numbers(history, at, &numbers, &err), &err);
    return numbers;
}

static void check_history(void)
{
    struct dm2_error err = {0};
    struct csv h;
    require_ok(csv_read(name_file("history.csv"), &h, &err), &err);
    double *elements = read_column(&h, "elements"), *total = read_column(&h, "total"),
           *px = read_column(&h, "momentum_x"), *py = read_column(&h, "momentum_y"),
           *surface = read_column(&h, "free_surface_vy"), *flyer = read_column(&h, "flyer_vy"),
           *target = read_column(&h, "target_vy");
    double peak = 0.0, energy = 0.0, momentum = 0.0;
    size_t last = h.n_rows - 1;
    CHECK_EQ_INT(h.n_rows, STEPS + 1);
    for (size_t k = 0; k <= last; k++) {
        CHECK_EQ_INT(elements[k], ELEMENTS);
        peak = surface[k] > peak ? surface[k] : peak;
        energy = fmax(energy, fabs(total[k] / total[0] - 1.0));
        momentum = fmax(momentum, fmax(fabs(px[k] - px[0]), fabs(py[k] - py[0])) / py[0]);
    }
    printf("free-surface velocity: peak %g cm/us\nenergy off by %g, momentum by %g of the initial\n", peak,
           energy, momentum);
    CHECK(peak > 0.040 && peak < 0.048);
    CHECK(energy < 0.005);
    CHECK(momentum < 1e-12);
    CHECK(flyer[last] < 0.5 * target[last]); /* the flyer separates from the target */
    free(elements);
    free(total);
    free(px);
    free(py);
    free(surface);
    free(flyer);
    free(target);
    csv_free(&h);
}

/* Checks the mean height of each row at the end. The row of an element follows from its position at the
 * start. */
static void check_rows(void)
{
    struct dm2_error err = {0};
    struct vtp start, end;
    require_ok(vtp_read(name_file("snapshots/state-000000000.vtp"), &start, &err), &err);
    require_ok(vtp_read(name_file("snapshots/state-000000200.vtp"), &end, &err), &err);
    CHECK_EQ_INT(start.n_points, ELEMENTS);
    CHECK_EQ_INT(end.n_points, ELEMENTS);
    const struct vtp_array *links = vtp_find(&end, "PointData", "links");
    CHECK(links != NULL && start.n_lines > end.n_lines);
    double y[ROWS] = {0.0}, widest = 0.0, row = 0.03464;
    size_t n[ROWS] = {0}, at = 0;
    for (size_t i = 0; i < start.n_points && i < end.n_points; i++) {
        size_t k = (size_t)((start.position[3 * i + 1] - 0.02) / row + 0.5);
        k = k < ROWS ? k : ROWS - 1;
        y[k] += end.position[3 * i + 1];
        n[k]++;
    }
    for (size_t k = 0; k < ROWS; k++) {
        CHECK_EQ_INT(n[k], k % 2 == 0 ? 54 : 55);
        y[k] /= (double)n[k];
    }
    for (size_t k = FLYER_ROWS; k + 1 < ROWS; k++) {
        if (y[k + 1] - y[k] > widest) {
            widest = y[k + 1] - y[k];
            at = k + 1 - FLYER_ROWS;
        }
    }
    double interface = y[FLYER_ROWS] - y[FLYER_ROWS - 1];
    printf("flyer and target: rows %g row distances apart\nspall: target rows %zu and %zu are %g row "
           "distances apart\n",
           interface / row, at, at + 1, widest / row);
    CHECK(interface > 1.2 * 0.04); /* farther apart than elements in contact or linked */
    CHECK(widest > 1.4 * row);     /* the target is torn */
    CHECK(at >= 10 && at <= 18);   /* in the upper half of its 22 rows */
    vtp_free(&start);
    vtp_free(&end);
}

static void check_final(void)
{
    struct dm2_error err = {0};
    struct state s;
    require_ok(state_read(name_file("final.dm2"), &s, &err), &err);
    CHECK_EQ_INT(s.step, STEPS);
    CHECK_EQ_INT(s.n_elements, ELEMENTS);
    size_t outside = 0, stretched = 0;
    for (size_t i = 0; i < s.n_elements; i++)
        outside += s.elements[i].r[1] > 1.1;
    for (size_t k = 0; k < s.n_pairs; k++) {
        stretched += s.pairs[k].stretch > 0.0;
        CHECK(!s.pairs[k].linked || (s.elements[s.pairs[k].id_a].body == s.elements[s.pairs[k].id_b].body));
    }
    printf("%zu elements beyond the domain, %zu bonds yielded\n", outside, stretched);
    CHECK(outside > 100);
    CHECK(stretched > 100);
    state_free(&s);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: check_impact RUN\n");
        return 2;
    }
    directory = argv[1];
    check_history();
    check_rows();
    check_final();
    printf("%d checks, %d failed\n", check_count, check_failures);
    return check_failures == 0 ? 0 : 1;
}
