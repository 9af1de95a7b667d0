/* The whole of the unit tests' framework: checks that print both values, and a list of test cases.
 *
 *   TEST(lists_match_all_pairs) { CHECK_EQ_INT(found, expected); CHECK_NEAR(e, 1.0, 1e-12); }
 *   TEST_MAIN(CASE(lists_match_all_pairs))
 *
 * A program runs all its cases (or those named on its command line) and exits 0 when every check held,
 * 1 otherwise, 77 when it called SKIP("reason"). */
#ifndef DM2_TESTS_CHECK_H
#define DM2_TESTS_CHECK_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_failures;
static int check_count;

/* With CHECK_FIRST a program ends at its first failure. */
#ifdef CHECK_FIRST
#define CHECK_FAILED exit(1)
#else
#define CHECK_FAILED (void)0
#endif

#define CHECK_REPORT(ok, ...)                                                                                \
    do {                                                                                                     \
        check_count++;                                                                                       \
        if (!(ok)) {                                                                                         \
            check_failures++;                                                                                \
            if (check_failures <= 50) {                                                                      \
                printf("%s:%d: ", __FILE__, __LINE__);                                                       \
                printf(__VA_ARGS__);                                                                         \
                printf("\n");                                                                                \
            }                                                                                                \
            CHECK_FAILED;                                                                                    \
        }                                                                                                    \
    } while (0)

#define CHECK(condition) CHECK_REPORT((condition), "%s is false", #condition)

#define CHECK_EQ_INT(got, want)                                                                              \
    do {                                                                                                     \
        long long check_g = (long long)(got), check_w = (long long)(want);                                   \
        CHECK_REPORT(check_g == check_w, "%s is %lld, expected %lld", #got, check_g, check_w);               \
    } while (0)

/* Same bits: also tells -0 from 0 and compares NaNs. */
#define CHECK_SAME_BITS(got, want)                                                                           \
    do {                                                                                                     \
        double check_g = (got), check_w = (want);                                                            \
        CHECK_REPORT(memcmp(&check_g, &check_w, sizeof check_g) == 0,                                        \
                     "%s is %.17g (%a), expected %.17g (%a)", #got, check_g, check_g, check_w, check_w);     \
    } while (0)

/* |got - want| <= tolerance */
#define CHECK_NEAR(got, want, tolerance)                                                                     \
    do {                                                                                                     \
        double check_g = (got), check_w = (want), check_t = (tolerance);                                     \
        CHECK_REPORT(fabs(check_g - check_w) <= check_t, "%s is %.17g, expected %.17g within %g", #got,      \
                     check_g, check_w, check_t);                                                             \
    } while (0)

/* |got - want| <= tolerance * |want| */
#define CHECK_NEAR_REL(got, want, tolerance)                                                                 \
    do {                                                                                                     \
        double check_g = (got), check_w = (want), check_t = (tolerance);                                     \
        CHECK_REPORT(fabs(check_g - check_w) <= check_t * fabs(check_w),                                     \
                     "%s is %.17g, expected %.17g within %g of it (off by %.3g)", #got, check_g, check_w,    \
                     check_t, (check_g - check_w) / check_w);                                                \
    } while (0)

#define CHECK_STR(got, want)                                                                                 \
    do {                                                                                                     \
        const char *check_g = (got), *check_w = (want);                                                      \
        CHECK_REPORT(check_g != NULL && strcmp(check_g, check_w) == 0, "%s is \"%s\", expected \"%s\"",      \
                     #got, check_g ? check_g : "(null)", check_w);                                           \
    } while (0)

/* The text `got` contains the text `part`. */
#define CHECK_CONTAINS(got, part)                                                                            \
    do {                                                                                                     \
        const char *check_g = (got), *check_w = (part);                                                      \
        CHECK_REPORT(check_g != NULL && strstr(check_g, check_w) != NULL,                                    \
                     "%s is \"%s\", expected it to contain \"%s\"", #got, check_g ? check_g : "(null)",      \
                     check_w);                                                                               \
    } while (0)

#define SKIP(reason)                                                                                         \
    do {                                                                                                     \
        printf("skipped: %s\n", reason);                                                                     \
        exit(77);                                                                                            \
    } while (0)

struct check_case {
    const char *name;
    void (*run)(void);
};

#define TEST(name) static void test_##name(void)
#define CASE(name)                                                                                           \
    {                                                                                                        \
#name, test_##name                                                                                   \
    }

#define TEST_MAIN(...)                                                                                       \
    int main(int argc, char **argv)                                                                          \
    {                                                                                                        \
        static const struct check_case cases[] = {__VA_ARGS__};                                              \
        for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {                                        \
            int wanted = argc < 2;                                                                           \
            for (int a = 1; a < argc; a++)                                                                   \
                wanted |= strcmp(argv[a], cases[c].name) == 0;                                               \
            if (!wanted)                                                                                     \
                continue;                                                                                    \
            int before = check_failures;                                                                     \
            cases[c].run();                                                                                  \
            printf("%-4s %s\n", check_failures == before ? "ok" : "FAIL", cases[c].name);                    \
        }                                                                                                    \
        printf("%d checks, %d failed\n", check_count, check_failures);                                       \
        return check_failures == 0 ? 0 : 1;                                                                  \
    }

#endif
