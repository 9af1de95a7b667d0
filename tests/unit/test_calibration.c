/* The calibration file: a written calibration comes back bit for bit; any other text is refused and never
 * crashes the reader. */
#include "check.h"

#include <stdint.h>
#include <unistd.h>

#include "dm2/performance/calibration.h"

static const char HOST[] = "ws1, \"the left\" one", VERSION[] = "1.0.0";

static struct calibration sample(void)
{
    struct calibration c = {.perf = perf_paper(), .k_spread = 1.0 / 3e7, .residual = {1e-4, 2e-4, 0}};
    c.perf.k = 1.0 / 3e4;
    c.perf.size[0] = (struct perf_size){.n = 1689, .alone = 1.0 / 7e4, .shared = 1.0 / 6e4};
    c.perf.size[1] = (struct perf_size){.n = 10000, .alone = 1.0 / 5e4, .shared = 1.0 / 3e4};
    c.perf.n_size = 2;
    strcpy(c.host, HOST);
    strcpy(c.version, VERSION);
    return c;
}

static const char *path_of(void)
{
    static char path[64];
    (void)snprintf(path, sizeof path, "calibration-%ld.csv", (long)getpid());
    return path;
}

/* The text of calibration_write, NUL-terminated. */
static size_t written(const struct calibration *c, char *out, size_t size)
{
    struct dm2_error err = {0};
    CHECK_EQ_INT(calibration_write(path_of(), c, &err), DM2_OK);
    FILE *f = fopen(path_of(), "rb");
    size_t n = f == NULL ? 0 : fread(out, 1, size - 1, f);
    out[n] = '\0';
    if (f != NULL)
        (void)fclose(f);
    return n;
}

TEST(written_and_read_again)
{
    struct calibration c = sample(), back;
    struct dm2_error err = {0};
    CHECK_EQ_INT(calibration_write(path_of(), &c, &err), DM2_OK);
    CHECK_EQ_INT(calibration_read(path_of(), HOST, VERSION, &back, &err), DM2_OK);
    CHECK_STR(back.host, HOST);
    CHECK_STR(back.version, VERSION);
    CHECK_SAME_BITS(back.perf.k, c.perf.k);
    CHECK_SAME_BITS(back.perf.d_x, c.perf.d_x);
    CHECK_SAME_BITS(back.perf.d_y, c.perf.d_y);
    CHECK_SAME_BITS(back.perf.l_x, c.perf.l_x);
    CHECK_SAME_BITS(back.perf.l_y, c.perf.l_y);
    CHECK_SAME_BITS(back.perf.g, c.perf.g);
    CHECK_SAME_BITS(back.k_spread, c.k_spread);
    CHECK_EQ_INT(back.perf.n_size, 2);
    for (size_t i = 0; i < 2; i++) {
        CHECK_SAME_BITS(back.perf.size[i].n, c.perf.size[i].n);
        CHECK_SAME_BITS(back.perf.size[i].alone, c.perf.size[i].alone);
        CHECK_SAME_BITS(back.perf.size[i].shared, c.perf.size[i].shared);
    }
    CHECK_EQ_INT(back.perf.n_network, 3);
    for (size_t i = 0; i < 3; i++) {
        CHECK_EQ_INT(back.perf.network[i].servers, c.perf.network[i].servers);
        CHECK_SAME_BITS(back.perf.network[i].m, c.perf.network[i].m);
        CHECK_SAME_BITS(back.perf.network[i].b, c.perf.network[i].b);
        CHECK_SAME_BITS(back.residual[i], c.residual[i]);
    }
    (void)unlink(path_of());
}

TEST(another_host_or_version)
{
    char text[4000];
    struct calibration c = sample(), back;
    struct dm2_error err = {0};
    size_t n = written(&c, text, sizeof text);
    CHECK_EQ_INT(calibration_parse("a.csv", text, n, "ws2", VERSION, &back, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "on the host 'ws1, \"the left\" one', this is 'ws2'; run dm2-model calibrate");
    CHECK_EQ_INT(calibration_parse("a.csv", text, n, HOST, "1.0.1", &back, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "with dm2 1.0.0, this is 1.0.1");
    CHECK_EQ_INT(calibration_read("absent.csv", HOST, VERSION, &back, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "absent.csv");
    (void)unlink(path_of());
}

/* The text of the sample with its first `old` replaced. */
static void refuse(const char *old, const char *new, const char *part)
{
    char text[4000], changed[8000];
    struct calibration c = sample(), back;
    struct dm2_error err = {0};
    (void)written(&c, text, sizeof text);
    const char *at = strstr(text, old);
    CHECK(at != NULL);
    if (at == NULL)
        return;
    int n = snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
    CHECK_EQ_INT(calibration_parse("a.csv", changed, (size_t)n, HOST, VERSION, &back, &err), DM2_DECK);
    CHECK_EQ_INT(err.status, DM2_DECK);
    CHECK_CONTAINS(err.text, "a.csv");
    CHECK_CONTAINS(err.text, part);
    (void)unlink(path_of());
}

TEST(files_that_do_not_read)
{
    refuse("quantity,servers", "quantity,server", "headings");
    refuse("quantity,servers,value,unit", "quantity,servers,value", "");
    refuse("format,,2,\n", "", "first row");
    refuse("format,,2,\n", "format,,3,\n", "a.csv:2: 'format': this dm2 reads format 2");
    refuse("format,,2,\n", "format,,2,\nformat,,2,\n", "twice");
    refuse("version,,1.0.0,\n", "", "'version' is missing");
    refuse("version,,1.0.0,\n", "version,,1.0.0,\nversion,,1.0.0,\n", "twice");
    refuse("version,,1.0.0,\n", "version,,,\n", "no version");
    refuse("version,,1.0.0,\n", "version,,1.0.0,s\n", "no unit");
    refuse("version,,1.0.0,\n", "version,3,1.0.0,\n", "does not depend");
    refuse("d_x,,0.04,cm\n", "", "'d_x' is missing");
    refuse("d_x,,0.04,cm\n", "d_x,,0.04,cm\nd_x,,0.04,cm\n", "twice");
    refuse("d_x,,0.04,cm\n", "d_x,,0.4,mm\n", "a.csv:5: 'd_x': the unit 'cm' is expected, not 'mm'");
    refuse("d_x,,0.04,cm\n", "d_x,,0.04 cm,cm\n", "'0.04 cm' is not a finite number");
    refuse("d_x,,0.04,cm\n", "d_x,,inf,cm\n", "not a finite number");
    refuse("d_x,,0.04,cm\n", "d_x,,nan,cm\n", "not a finite number");
    refuse("d_x,,0.04,cm\n", "d_x,,-0.04,cm\n", "above 0");
    refuse("d_x,,0.04,cm\n", "d_z,,0.04,cm\n", "'d_z': is not a quantity");
    refuse("g,,88,byte\n", "g,,0,byte\n", "above 0");
    refuse("k_spread,,", "k_spread,,-", "at least 0");
    refuse("sizes,,2,\n", "sizes,,3,\n", "k is there for 2 sizes, not for 3");
    refuse("sizes,,2,\n", "", "'sizes' is missing");
    refuse("size,,1689,\n", "", "'k_alone': is expected behind its size");
    refuse("size,,1689,\n", "size,,16890,\n", "do not rise");
    refuse("size,,1689,\n", "size,,0,\n", "do not rise");
    refuse("size,,1689,\n", "size,4,1689,\n", "does not depend");
    refuse("size,,1689,\n", "size,,1689,\nk_alone,,1,s\n", "is there twice");
    refuse("k_shared,,", "k_shared,,-", "above 0");
    refuse("k_alone,,", "k_aloof,,", "is not a quantity");
    refuse("m,2,", "m,0,", "number of servers from 1");
    refuse("m,2,", "m,2.5,", "number of servers from 1");
    refuse("m,2,", "m,,", "number of servers from 1");
    refuse("m,2,", "m,9,", "have to rise");
    refuse("b,2,0.0033,s\n", "", "has m but no b");
    refuse("b,2,0.0033,s\n", "b,2,0.0033,s\nb,2,0.0033,s\n", "twice");
    refuse("residual,4,0.0002,s\n", "", "'residual' is missing");
    refuse("residual,4,0.0002,s\n", "residual,4,0.0002,s\nresidual,4,0.0002,s\n", "twice");
    refuse("m,2,", "residual,2,0.1,s\nm,2,", "behind m and b");
    refuse("networks,,3,\n", "networks,,4,\n", "for 3 numbers of servers, not for 4");
    refuse("residual,4,0.0002,s\n", "residual,4,-0.0002,s\n", "at least 0");
}

TEST(calibrations_that_are_not_written)
{
    struct dm2_error err = {0};
    struct calibration c = sample();
    c.host[0] = '\0';
    CHECK_EQ_INT(calibration_write(path_of(), &c, &err), DM2_USAGE);
    c = sample();
    c.version[1] = '\n';
    CHECK_EQ_INT(calibration_write(path_of(), &c, &err), DM2_USAGE);
    c = sample();
    c.perf.k = NAN;
    CHECK_EQ_INT(calibration_write(path_of(), &c, &err), DM2_USAGE);
    c = sample();
    c.residual[1] = -1;
    CHECK_EQ_INT(calibration_write(path_of(), &c, &err), DM2_USAGE);
    CHECK(access(path_of(), F_OK) != 0);
    c = sample();
    CHECK_EQ_INT(calibration_write("no/such/directory/a.csv", &c, &err), DM2_IO);
}

/* Cut short everywhere, and with bytes changed: an error, or a calibration that passes its own checks. */
TEST(damaged_files)
{
    static const unsigned char odd[] = {0, ',', '"', '\n', '\r', '-', '9', 'e', 'm', 0xff};
    char text[4000], changed[4000];
    struct calibration c = sample(), back;
    struct dm2_error err = {0};
    size_t n = written(&c, text, sizeof text), accepted = 0;
    (void)unlink(path_of());
    for (size_t k = 0; k + 1 < n; k++)
        CHECK(calibration_parse("a.csv", text, k, HOST, VERSION, &back, &err) != DM2_OK);
    uint64_t random = 1;
    for (int round = 0; round < 20000; round++) {
        memcpy(changed, text, n);
        for (int k = 0; k <= round % 3; k++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            changed[(random >> 33) % n] = (char)odd[(random >> 20) % sizeof odd];
        }
        if (calibration_parse("a.csv", changed, n, HOST, VERSION, &back, &err) == DM2_OK) {
            accepted++;
            CHECK_EQ_INT(perf_check(&back.perf, &err), DM2_OK);
        }
    }
    CHECK(accepted > 0 && accepted < 10000); /* a digit in the place of a digit is still a number */
}

TEST_MAIN(CASE(written_and_read_again), CASE(another_host_or_version), CASE(files_that_do_not_read),
          CASE(calibrations_that_are_not_written), CASE(damaged_files))
