/* Exact sums, the id map, random hashes, growing memory. */
#include "dm2/base/exact.h"
#include "dm2/base/idmap.h"
#include "dm2/base/mem.h"
#include "dm2/base/random.h"
#include "dm2/base/text.h"
#include "check.h"

TEST(exact_sums_do_not_depend_on_order)
{
    enum { N = 1000 };
    struct exact_sum up = {0}, down = {0}, parts[7] = {{0, 0}}, merged = {0};
    double plain = 0.0;
    for (int i = 0; i < N; i++) {
        double a = (random_uniform(1, i, 1) - 0.5) * pow(10.0, i % 17 - 8);
        double b = (random_uniform(1, N - 1 - i, 1) - 0.5) * pow(10.0, (N - 1 - i) % 17 - 8);
        plain += a;
        CHECK(exact_add(&up, a, 60));
        CHECK(exact_add(&down, b, 60));
        CHECK(exact_add(&parts[i % 7], a, 60));
    }
    for (int p = 6; p >= 0; p--)
        exact_merge(&merged, &parts[p]);
    CHECK_EQ_INT(up.hi, down.hi);
    CHECK_EQ_INT(up.lo, down.lo);
    CHECK_EQ_INT(up.hi, merged.hi);
    CHECK_EQ_INT(up.lo, merged.lo);
    CHECK_NEAR(exact_value(&up, 60), plain, 1e-6);
}

TEST(exact_sums_are_exact)
{
    struct exact_sum s = {0};
    CHECK(exact_add(&s, 1e10, 60));
    CHECK(exact_add(&s, 0x1p-60, 60));
    CHECK(exact_add(&s, -1e10, 60));
    CHECK_SAME_BITS(exact_value(&s, 60), 0x1p-60);
    CHECK(exact_add(&s, -0x1p-59, 60));
    CHECK_SAME_BITS(exact_value(&s, 60), -0x1p-60);
    struct exact_sum before = s;
    CHECK(!exact_add(&s, NAN, 60));
    CHECK(!exact_add(&s, 0x1p61, 60));
    CHECK(!exact_add(&s, -INFINITY, 60));
    CHECK_EQ_INT(s.lo, before.lo);
}

TEST(exact_sums_take_integer_units)
{
    struct exact_sum s = {0};
    exact_add_units(&s, -3, 40);
    CHECK_SAME_BITS(exact_value(&s, 40), -3.0);
    exact_add_units(&s, 5, 0);
    CHECK_SAME_BITS(exact_value(&s, 0), 5.0 - 3.0 * 0x1p40);
    exact_add_units(&s, INT64_MAX, 62);
    exact_add_units(&s, -INT64_MAX, 62);
    CHECK_SAME_BITS(exact_value(&s, 0), 5.0 - 3.0 * 0x1p40);
    for (int i = 0; i < 1000; i++) {
        struct exact_sum t = {0};
        double v = (random_uniform(9, i, 1) - 0.5) * pow(2.0, i % 40 - 20);
        CHECK(exact_add(&t, v, 90));
        CHECK_SAME_BITS(exact_value(&t, 90), v);
    }
}

TEST(idmap_finds_what_was_added)
{
    struct idmap map = {0};
    CHECK_EQ_INT(idmap_find(&map, 5), -1);
    CHECK_EQ_INT(idmap_prepare(&map, 5000), 0);
    for (int i = 0; i < 5000; i++)
        CHECK(idmap_add(&map, (uint32_t)random_bits(3, i, 0), i));
    CHECK(!idmap_add(&map, (uint32_t)random_bits(3, 17, 0), 1));
    for (int i = 0; i < 5000; i++)
        CHECK_EQ_INT(idmap_find(&map, (uint32_t)random_bits(3, i, 0)), i);
    CHECK_EQ_INT(idmap_find(&map, (uint32_t)random_bits(4, 1, 0)), -1);
    idmap_free(&map);
}

TEST(random_numbers_are_uniform)
{
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < 100000; i++) {
        double u = random_uniform(7, i, RANDOM_MIX);
        CHECK(u >= 0.0 && u < 1.0);
        mean += u / 1e5;
        square += u * u / 1e5;
    }
    CHECK_NEAR(mean, 0.5, 0.004);
    CHECK_NEAR(square, 1.0 / 3.0, 0.004);
    CHECK(random_bits(1, 2, 3) != random_bits(1, 3, 2));
}

TEST(memory_sizes_do_not_overflow)
{
    CHECK(mem_alloc(SIZE_MAX / 2, 4) == NULL);
    size_t cap = 0;
    double *item = mem_grown(NULL, &cap, 0, 10, sizeof *item);
    CHECK(item != NULL && cap >= 10);
    item[9] = 4.5;
    CHECK(mem_grown(item, &cap, 10, SIZE_MAX / 4, sizeof *item) == NULL);
    CHECK_SAME_BITS(item[9], 4.5);
    CHECK(mem_grown(item, &cap, 10, 10, sizeof *item) == item);
    item = mem_grown(item, &cap, 10, 1000, sizeof *item);
    CHECK(item != NULL && cap >= 1000);
    CHECK_SAME_BITS(item[9], 4.5);
    free(item);
}

TEST(texts_of_others_do_nothing_to_a_terminal)
{
    static const struct {
        const char *text, *line, *lines;
    } cases[] = {
        {"plain ~", "plain ~", "plain ~"},
        {"", "", ""},
        {"a\033[1m\177b\a\r", "a?[1m?b??", "a?[1m?b??"},
        {"a\nb\tc", "a b c", "a\nb\tc"},
        {"\303\244 \342\202\254 \360\237\230\200", "\303\244 \342\202\254 \360\237\230\200",
         "\303\244 \342\202\254 \360\237\230\200"},
        {"\302\233x \233y \342\202", "??x ?y ??",
         "??x ?y ??"}, /* U+009B, the byte 9B alone, a character cut short */
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char text[64];
        (void)snprintf(text, sizeof text, "%s", cases[k].text);
        text_make_printable(text, false);
        CHECK_STR(text, cases[k].line);
        (void)snprintf(text, sizeof text, "%s", cases[k].text);
        text_make_printable(text, true);
        CHECK_STR(text, cases[k].lines);
    }
}

TEST_MAIN(CASE(texts_of_others_do_nothing_to_a_terminal), CASE(exact_sums_do_not_depend_on_order),
          CASE(exact_sums_are_exact), CASE(exact_sums_take_integer_units), CASE(idmap_finds_what_was_added),
          CASE(random_numbers_are_uniform), CASE(memory_sizes_do_not_overflow))
