/* The decks of input/, whose elements are counted by a lattice of this test: the 1689 elements of the paper
 * in rows of 54 and 55, the scaled plates, and the deviation of lj-lattice from the number n. */
#include <limits.h>

#include "dm2/base/mem.h"
#include "dm2/deck/deck.h"
#include "dm2/deck/shape.h"
#include "check.h"
#include "deck_help.h"

static enum dm2_status load_file(const char *path, const char *define, struct config *config)
{
    struct deck_source source;
    struct deck_report report;
    struct dm2_error err;
    enter_source_tree();
    CHECK_EQ_INT(deck_source_read(path, NULL, &source, &err), DM2_OK);
    if (define != NULL) {
        source.defines = mem_zalloc(1, sizeof(char *));
        source.defines[0] = mem_zalloc(strlen(define) + 1, 1);
        memcpy(source.defines[0], define, strlen(define));
        source.n_defines = 1;
    }
    enum dm2_status status = deck_load(&source, config, &report);
    /* The floor of the sliding block is fine, which has its price. */
    bool fine = strcmp(path, "input/sliding-block.dm2") == 0 && strstr(report.text, "add up") != NULL;
    CHECK_REPORT(status == DM2_OK && report.n_warnings == (fine ? 1 : 0), "%s %s\n%s", path,
                 define == NULL ? "" : define, report.text);
    deck_report_free(&report);
    deck_source_free(&source);
    return status;
}

static double site(double origin, long i, double shift, double step)
{
    return origin + ((double)i + shift) * step;
}

/* The number of elements in row j of a body whose lattice is not turned. */
static long count_row(const struct body_config *b, const double box[4], long j)
{
    double shift = b->lattice == LATTICE_HEXAGONAL && j % 2 != 0 ? 0.5 : 0;
    long n = 0, first = (long)floor((box[0] - b->origin[0]) / b->spacing) - 2;
    long last = (long)ceil((box[2] - b->origin[0]) / b->spacing) + 2;
    for (long i = first; i <= last; i++)
        n += shape_contains(&b->shape, site(b->origin[0], i, shift, b->spacing),
                            site(b->origin[1], j, 0, b->row_spacing));
    return n;
}

/* The number of elements of a body; *rows: the number of rows with elements. */
static long count_body(const struct body_config *b, long *rows)
{
    double box[4];
    long total = 0;
    shape_box(&b->shape, box);
    *rows = 0;
    for (long j = (long)floor((box[1] - b->origin[1]) / b->row_spacing) - 2;
         j <= (long)ceil((box[3] - b->origin[1]) / b->row_spacing) + 2; j++) {
        long n = count_row(b, box, j);
        *rows += n > 0;
        total += n;
    }
    return total;
}

TEST(plate_impact_has_the_papers_elements)
{
    struct config c;
    long rows;
    if (load_file("input/plate-impact.dm2", NULL, &c) != DM2_OK)
        return;
    CHECK_EQ_INT(c.n_bodies, 2);
    CHECK_EQ_INT(count_body(&c.bodies[0], &rows), 5 * 54 + 4 * 55);
    CHECK_EQ_INT(rows, 9);
    CHECK_EQ_INT(count_body(&c.bodies[1], &rows), 11 * 54 + 11 * 55);
    CHECK_EQ_INT(rows, 22);
    double box[4];
    shape_box(&c.bodies[0].shape, box);
    CHECK_EQ_INT(count_row(&c.bodies[0], box, 0), 54);
    CHECK_EQ_INT(count_row(&c.bodies[0], box, 1), 55);
    CHECK_SAME_BITS(c.bodies[0].velocity[1], 0.04);
    CHECK_SAME_BITS(c.materials[0].c0, 0.4602);
    CHECK_SAME_BITS(c.materials[0].cp, 4.40e-6);
    CHECK_SAME_BITS(c.materials[0].kappa, 9.09e-12);
    CHECK_SAME_BITS(c.materials[1].tensile, 0.012);
    CHECK_SAME_BITS(c.size[0], 2.2);
    CHECK_SAME_BITS(c.size[1], 1.1);
    /* The probe of the free surface holds the last row only. */
    CHECK(c.probes[2].box[1] < 0.02 + 30 * 0.03464 && c.probes[2].box[1] > 0.02 + 29 * 0.03464);
    config_free(&c);
}

static long count_scaled(const char *define)
{
    struct config c;
    long rows;
    if (load_file("input/plate-impact.dm2", define, &c) != DM2_OK)
        return 0;
    long n = count_body(&c.bodies[0], &rows) + count_body(&c.bodies[1], &rows);
    printf("plate-impact -D %s: %ld elements\n", define, n);
    config_free(&c);
    return n;
}

TEST(plate_impact_scales)
{
    CHECK(labs(count_scaled("scale=10.9") - 200000) < 10000);
    CHECK(labs(count_scaled("scale=24") - 1000000) < 10000);
    CHECK(labs(count_scaled("scale=2") - 4 * 1689) < 300);
    CHECK(count_scaled("scale=0.5") > 300);
}

static long count_lattice(long n)
{
    struct config c;
    char define[40];
    long rows;
    (void)snprintf(define, sizeof define, "n=%ld", n);
    if (load_file("input/lj-lattice.dm2", define, &c) != DM2_OK)
        return 0;
    long count = count_body(&c.bodies[0], &rows);
    config_free(&c);
    return count;
}

TEST(lj_lattice_has_n_elements)
{
    double worst = 0;
    CHECK_EQ_INT(count_lattice(11600), 11600);
    for (long n = 1000; n <= 200000; n += n / 7) {
        double off = fabs((double)count_lattice(n) / (double)n - 1);
        worst = off > worst ? off : worst;
        CHECK_REPORT(off < 0.02, "n=%ld: off by %g", n, off);
    }
    printf("lj-lattice: at most %.2g off\n", worst);
    CHECK(fabs((double)count_lattice(1000000) / 1e6 - 1) < 0.001);
}

TEST_MAIN(CASE(plate_impact_has_the_papers_elements), CASE(plate_impact_scales),
          CASE(lj_lattice_has_n_elements))
