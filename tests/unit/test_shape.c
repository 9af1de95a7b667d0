/* Geometry of shapes: points inside, boxes and areas, overlaps, polygons that cross themselves. */
#include "dm2/deck/shape.h"
#include "check.h"

static struct shape_config rectangle(double x0, double y0, double x1, double y1)
{
    return (struct shape_config){.kind = SHAPE_RECTANGLE, .box = {x0, y0, x1, y1}};
}

static struct shape_config disc(double x, double y, double r)
{
    return (struct shape_config){.kind = SHAPE_DISC, .centre = {x, y}, .radius = r};
}

static struct shape_config polygon(size_t n, const double *xy)
{
    struct shape_config s = {.kind = SHAPE_POLYGON, .n_vertices = n};
    memcpy(s.vertex, xy, 2 * n * sizeof(double));
    return s;
}

static const double triangle_xy[] = {0, 0, 4, 0, 0, 3}, l_xy[] = {0, 0, 3, 0, 3, 1, 1, 1, 1, 3, 0, 3};

TEST(shapes_hold_points)
{
    struct shape_config r = rectangle(0, 0, 1, 2), d = disc(1, 1, 1), t = polygon(3, triangle_xy),
                        l = polygon(6, l_xy);
    CHECK(shape_contains(&r, 0, 0) && !shape_contains(&r, 1, 0) && !shape_contains(&r, 0, 2));
    CHECK(shape_contains(&d, 2, 1) && shape_contains(&d, 1, 0) && !shape_contains(&d, 2, 2));
    CHECK(shape_contains(&t, 1, 1) && !shape_contains(&t, 3, 2));
    CHECK(shape_contains(&l, 0.5, 2.5) && shape_contains(&l, 2.5, 0.5) && !shape_contains(&l, 2, 2));
}

/* Each point of a square is in exactly one of its two halves along the diagonal. */
TEST(neighbours_share_no_point)
{
    static const double a[] = {0, 0, 1, 0, 1, 1}, b[] = {0, 0, 1, 1, 0, 1};
    struct shape_config p = polygon(3, a), q = polygon(3, b);
    for (int i = 0; i < 40; i++)
        for (int j = 0; j < 40; j++)
            CHECK_EQ_INT(shape_contains(&p, i / 40.0, j / 40.0) + shape_contains(&q, i / 40.0, j / 40.0), 1);
    CHECK(!shape_overlaps(&p, &q));
}

TEST(boxes_and_areas)
{
    double box[4];
    struct shape_config d = disc(1, 2, 0.5), t = polygon(3, triangle_xy), l = polygon(6, l_xy);
    shape_box(&d, box);
    CHECK(box[0] == 0.5 && box[1] == 1.5 && box[2] == 1.5 && box[3] == 2.5);
    shape_box(&t, box);
    CHECK(box[0] == 0 && box[1] == 0 && box[2] == 4 && box[3] == 3);
    CHECK_NEAR(shape_area(&t), 6, 1e-15);
    CHECK_NEAR(shape_area(&l), 5, 1e-15);
    CHECK_NEAR(shape_area(&d), 0.78539816339744831, 1e-15);
}

static void check_overlap(struct shape_config a, struct shape_config b, int want)
{
    CHECK_EQ_INT(shape_overlaps(&a, &b), want);
    CHECK_EQ_INT(shape_overlaps(&b, &a), want);
}

TEST(overlaps)
{
    check_overlap(rectangle(0, 0, 1, 1), rectangle(1, 0, 2, 1), 0);
    check_overlap(rectangle(0, 0, 1, 1), rectangle(0.9, 0.9, 2, 2), 1);
    check_overlap(rectangle(0, 0, 3, 3), rectangle(1, 1, 2, 2), 1);
    check_overlap(disc(0, 0, 1), disc(2, 0, 1), 0);
    check_overlap(disc(0, 0, 1), disc(1.4, 1.4, 1), 1);
    check_overlap(disc(0, 0, 1), disc(1.5, 1.5, 1), 0);
    check_overlap(disc(0, 0, 1), rectangle(0.8, 0.8, 2, 2), 0);
    check_overlap(disc(0, 0, 1), rectangle(0.7, 0.7, 2, 2), 1);
    check_overlap(disc(0, 0, 1), rectangle(-3, -3, 3, 3), 1);
    check_overlap(disc(2, 2, 0.5), polygon(6, l_xy), 0);
    check_overlap(disc(2, 2, 1.1), polygon(6, l_xy), 1);
    check_overlap(rectangle(1.1, 1.1, 2, 2), polygon(6, l_xy), 0);
    check_overlap(rectangle(0.5, 2, 2, 2.5), polygon(6, l_xy), 1);
    check_overlap(polygon(3, triangle_xy), polygon(3, triangle_xy), 1);
    check_overlap(rectangle(-1, -1, 9, 9), polygon(3, triangle_xy), 1);
}

TEST(polygons_that_cross_themselves)
{
    static const double bow[] = {0, 0, 1, 1, 1, 0, 0, 1}, spike[] = {0, 0, 2, 0, 1, 0, 1, 1},
                        flat[] = {0, 0, 1, 1, 2, 2}, touch[] = {0, 0, 2, 0, 2, 2, 1, 0, 0, 2},
                        twice[] = {0, 0, 1, 0, 1, 0, 0, 1};
    struct shape_config good[] = {polygon(3, triangle_xy), polygon(6, l_xy)};
    struct shape_config bad[] = {polygon(4, bow), polygon(4, spike), polygon(3, flat), polygon(5, touch),
                                 polygon(4, twice)};
    for (size_t i = 0; i < 2; i++)
        CHECK(!shape_crosses_itself(&good[i]));
    for (size_t i = 0; i < 5; i++)
        CHECK_REPORT(shape_crosses_itself(&bad[i]), "bad polygon %zu passes", i);
}

TEST_MAIN(CASE(shapes_hold_points), CASE(neighbours_share_no_point), CASE(boxes_and_areas), CASE(overlaps),
          CASE(polygons_that_cross_themselves))
