/* Recursive bisection for 1 to 64 ranks on several grids, against brute force over neighbouring cells. */
#include "check.h"

#include "dm2/base/mem.h"
#include "dm2/cluster/decomposition.h"

static struct grid make_grid(int cx, int cy, double lx, double ly, bool px, bool py)
{
    return (struct grid){
        .cx = cx, .cy = cy, .lx = lx, .ly = ly, .size = {cx * lx, cy * ly}, .periodic = {px, py}};
}

static struct decomposition bisected(const struct grid *g, int ranks, const uint32_t *weights)
{
    struct decomposition d;
    struct dm2_error err = {0};
    CHECK_EQ_INT(decomposition_bisect(g, ranks, weights, &d, &err), DM2_OK);
    return d;
}

/* Every cell belongs to the rectangle of its owner, and the rectangles have as many cells as the grid. */
static void check_partition(const struct decomposition *d)
{
    const struct grid *g = &d->grid;
    size_t sum = 0, misplaced = 0;
    for (int k = 0; k < d->ranks; k++) {
        CHECK(decomposition_cells(d, k) >= 1);
        sum += decomposition_cells(d, k);
    }
    for (int j = 0; j < g->cy; j++)
        for (int i = 0; i < g->cx; i++) {
            const struct cell_rect *r = &d->rect[d->owner[j * g->cx + i]];
            misplaced += !(i >= r->x0 && i < r->x1 && j >= r->y0 && j < r->y1);
        }
    CHECK_EQ_INT(sum, g->cx * g->cy);
    CHECK_EQ_INT(misplaced, 0);
}

/* The owner of the cell (i, j), wrapped independently of the decomposition; -1 outside. */
static int owner_of(const struct decomposition *d, int i, int j)
{
    const struct grid *g = &d->grid;
    if ((!g->periodic[0] && (i < 0 || i >= g->cx)) || (!g->periodic[1] && (j < 0 || j >= g->cy)))
        return -1;
    return d->owner[(j + 2 * g->cy) % g->cy * g->cx + (i + 2 * g->cx) % g->cx];
}

/* The eight elements and the boundary counts from the definition, cell by cell. */
static void check_boundary(const struct decomposition *d, int rank)
{
    const struct grid *g = &d->grid;
    const struct cell_rect *r = &d->rect[rank];
    unsigned char *beyond = mem_zalloc((size_t)SIDE_COUNT * (size_t)d->ranks, 1);
    unsigned char *outer = mem_zalloc((size_t)g->cx * (size_t)g->cy, 1);
    size_t inner = 0, n_outer = 0, edges = 0;
    double length = 0;
    for (int j = r->y0; j < r->y1; j++)
        for (int i = r->x0; i < r->x1; i++) {
            int touches = 0;
            for (int b = -1; b <= 1; b++)
                for (int a = -1; a <= 1; a++) {
                    int other = owner_of(d, i + a, j + b);
                    bool out_x = i + a < r->x0 || i + a >= r->x1, out_y = j + b < r->y0 || j + b >= r->y1;
                    if (other < 0 || other == rank)
                        continue;
                    touches = 1;
                    int at = (j + b + g->cy) % g->cy * g->cx + (i + a + g->cx) % g->cx;
                    n_outer += outer[at] == 0;
                    outer[at] = 1;
                    if (a == 0 || b == 0) {
                        edges++;
                        length += b == 0 ? g->ly : g->lx;
                    }
                    int side = out_x && out_y ? CORNER_SOUTH_WEST + (a > 0) + 2 * (b > 0)
                               : out_x        ? (a > 0 ? SIDE_EAST : SIDE_WEST)
                                              : (b > 0 ? SIDE_NORTH : SIDE_SOUTH);
                    beyond[side * d->ranks + other] = 1;
                }
            inner += touches;
        }
    int got[SIDE_COUNT];
    decomposition_interfaces(d, rank, got);
    for (int side = 0; side < SIDE_COUNT; side++) {
        int want = 0;
        for (int k = 0; k < d->ranks; k++)
            want += beyond[side * d->ranks + k];
        CHECK_EQ_INT(got[side], want);
    }
    struct rank_boundary boundary;
    CHECK_EQ_INT(decomposition_boundary(d, rank, &boundary, NULL), DM2_OK);
    CHECK_EQ_INT(boundary.inner, inner);
    CHECK_EQ_INT(boundary.outer, n_outer);
    CHECK_EQ_INT(boundary.interface_cells, edges);
    CHECK_NEAR(boundary.interface_cm, length, 1e-9);
    free(beyond);
    free(outer);
}

/* Where rank b lies beyond a side of rank a, a lies beyond the opposite side of b, or at the opposite
 * corner: in the sum every edge counts from both ends. */
static void check_symmetry(const struct decomposition *d)
{
    long sum[SIDE_COUNT] = {0};
    for (int k = 0; k < d->ranks; k++) {
        int out[SIDE_COUNT];
        decomposition_interfaces(d, k, out);
        for (int side = 0; side < SIDE_COUNT; side++)
            sum[side] += out[side];
    }
    CHECK_EQ_INT(sum[SIDE_WEST], sum[SIDE_EAST]);
    CHECK_EQ_INT(sum[SIDE_SOUTH], sum[SIDE_NORTH]);
}

TEST(one_to_64_ranks_on_several_grids)
{
    const struct grid grids[] = {
        make_grid(19, 9, 0.1158, 0.1222, false, false),
        make_grid(64, 64, 1, 1, false, false),
        make_grid(100, 1, 1, 1, false, false),
        make_grid(1, 77, 1, 2, false, true),
        make_grid(13, 17, 2, 1, true, true),
        make_grid(8, 8, 1, 1, true, false),
        make_grid(3, 22, 1, 0.3, false, true),
    };
    for (size_t k = 0; k < sizeof grids / sizeof grids[0]; k++)
        for (int ranks = 1; ranks <= 64; ranks++) {
            struct decomposition d = bisected(&grids[k], ranks, NULL);
            check_partition(&d);
            check_symmetry(&d);
            for (int rank = 0; rank < ranks; rank++)
                check_boundary(&d, rank);
            decomposition_free(&d);
        }
}

/* Cuts are rounded to whole columns and rows: each rank is within one column and one row of its share. */
TEST(areas_are_proportional)
{
    struct grid g = make_grid(190, 90, 0.11, 0.12, false, false);
    for (int ranks = 1; ranks <= 64; ranks++) {
        struct decomposition d = bisected(&g, ranks, NULL);
        double share = 190.0 * 90.0 / ranks;
        for (int rank = 0; rank < ranks; rank++) {
            const struct cell_rect *r = &d.rect[rank];
            int w = r->x1 - r->x0, h = r->y1 - r->y0;
            CHECK_NEAR((double)decomposition_cells(&d, rank), share, w + h);
        }
        decomposition_free(&d);
    }
}

TEST(as_many_ranks_as_cells)
{
    const int sizes[][2] = {{1, 1}, {1, 7}, {3, 1}, {3, 3}, {5, 5}, {4, 7}, {19, 9}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        struct grid g = make_grid(sizes[k][0], sizes[k][1], 1, 1, false, false);
        for (int ranks = 1; ranks <= g.cx * g.cy; ranks++) {
            struct decomposition d = bisected(&g, ranks, NULL);
            check_partition(&d);
            decomposition_free(&d);
        }
        struct decomposition d;
        struct dm2_error err = {0};
        CHECK_EQ_INT(decomposition_bisect(&g, g.cx * g.cy + 1, NULL, &d, &err), DM2_USAGE);
        char both[64];
        (void)snprintf(both, sizeof both, "%d servers for a grid of %d cells", g.cx * g.cy + 1, g.cx * g.cy);
        CHECK_CONTAINS(err.text, both);
    }
}

/* The paper's Fig. 9: 2, 4 and 8 servers on wide domains. */
TEST(cuts_go_across_the_longer_side)
{
    struct grid wide = make_grid(40, 5, 1, 1, false, false); /* aspect 8 */
    struct decomposition d = bisected(&wide, 8, NULL);
    for (int rank = 0; rank < 8; rank++)
        CHECK_EQ_INT(d.rect[rank].y1 - d.rect[rank].y0, 5); /* only vertical cuts */
    decomposition_free(&d);
    struct grid square = make_grid(20, 20, 1, 1, false, false);
    d = bisected(&square, 4, NULL);
    for (int rank = 0; rank < 4; rank++)
        CHECK_EQ_INT(decomposition_cells(&d, rank), 100); /* quadrants */
    decomposition_free(&d);
    struct grid flat = make_grid(10, 10, 1, 3, false, false); /* high cells make the domain high */
    d = bisected(&flat, 2, NULL);
    CHECK_EQ_INT(d.rect[0].x1 - d.rect[0].x0, 10);
    decomposition_free(&d);
}

TEST(balance_by_particles)
{
    struct grid g = make_grid(30, 10, 1, 1, false, false);
    uint32_t weights[300];
    for (int j = 0; j < 10; j++)
        for (int i = 0; i < 30; i++)
            weights[j * 30 + i] = i < 10 ? 0 : i < 20 ? 8 : 2; /* a void, a dense and a loose third */
    for (int ranks = 1; ranks <= 16; ranks++) {
        struct decomposition d = bisected(&g, ranks, weights);
        uint64_t sum = 0, most = 0;
        check_partition(&d);
        for (int rank = 0; rank < ranks; rank++) {
            uint64_t w = decomposition_weight(&d, rank, weights);
            sum += w;
            most = w > most ? w : most;
        }
        CHECK_EQ_INT(sum, 1000);
        CHECK((double)most <= 1000.0 / ranks + 85); /* one dense column */
        decomposition_free(&d);
    }
    struct decomposition d = bisected(&g, 2, weights);
    CHECK_EQ_INT(d.rect[0].x1, 16);
    decomposition_free(&d);
    memset(weights, 0, sizeof weights);
    d = bisected(&g, 7, weights); /* nothing to balance: every rank still has cells */
    check_partition(&d);
    decomposition_free(&d);
}

TEST(rectangles_from_elsewhere_are_checked)
{
    struct grid g = make_grid(4, 4, 1, 1, false, false);
    struct decomposition d;
    struct dm2_error err = {0};
    const struct cell_rect good[2] = {{0, 0, 2, 4}, {2, 0, 4, 4}};
    const struct cell_rect bad[][2] = {
        {{0, 0, 2, 4}, {1, 0, 3, 4}},  /* overlap and a hole, the right number of cells */
        {{0, 0, 2, 4}, {2, 0, 4, 3}},  /* a hole */
        {{0, 0, 3, 4}, {2, 0, 4, 4}},  /* overlap */
        {{0, 0, 2, 4}, {2, 0, 5, 4}},  /* outside */
        {{-1, 0, 2, 4}, {2, 0, 4, 4}}, /* outside */
        {{0, 0, 4, 4}, {4, 0, 4, 4}},  /* empty */
    };
    CHECK_EQ_INT(decomposition_from_rects(&g, 2, good, &d, &err), DM2_OK);
    check_partition(&d);
    decomposition_free(&d);
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++)
        CHECK_EQ_INT(decomposition_from_rects(&g, 2, bad[k], &d, &err), DM2_PROTOCOL);
    CHECK_EQ_INT(decomposition_from_rects(&g, 0, good, &d, &err), DM2_PROTOCOL);
    CHECK_EQ_INT(decomposition_from_rects(&g, 17, good, &d, &err), DM2_PROTOCOL);
}

TEST_MAIN(CASE(one_to_64_ranks_on_several_grids), CASE(areas_are_proportional), CASE(as_many_ranks_as_cells),
          CASE(cuts_go_across_the_longer_side), CASE(balance_by_particles),
          CASE(rectangles_from_elsewhere_are_checked))
