/* Fragments against a search that colours one component after the other, on made-up graphs with pairs in
 * any order. */
#include <stdbool.h>

#include "check.h"

#include "dm2/base/random.h"
#include "output/fragments.h"

enum { MOST = 400 };

struct graph {
    struct element e[MOST];
    struct pair_record p[4 * MOST];
    size_t n, n_pairs;
};

static uint64_t draw(uint64_t seed, uint64_t k, uint64_t below)
{
    return random_bits(seed, k, 0) % below;
}

/* n elements, some ids missing, and random pairs of which some are not linked. */
static void make(struct graph *g, uint64_t seed, size_t n, size_t n_pairs)
{
    memset(g, 0, sizeof *g);
    g->n = n;
    g->n_pairs = n_pairs;
    uint32_t id = 0;
    for (size_t i = 0; i < n; i++) {
        id += 1 + (draw(seed, i, 4) == 0);
        g->e[i].id = id;
    }
    for (size_t k = 0; k < n_pairs; k++)
        g->p[k] = (struct pair_record){.id_a = g->e[draw(seed, 1000 + k, n)].id,
                                       .id_b = g->e[draw(seed, 9000 + k, n)].id,
                                       .linked = draw(seed, 17000 + k, 5) != 0};
}

static void spread(const struct graph *g, uint32_t from, int *colour, int c)
{
    bool more = true;
    colour[from] = c;
    while (more) {
        more = false;
        for (size_t k = 0; k < g->n_pairs; k++) {
            size_t a = element_find(g->e, g->n, g->p[k].id_a), b = element_find(g->e, g->n, g->p[k].id_b);
            if (g->p[k].linked != 0 && (colour[a] == c) != (colour[b] == c)) {
                colour[a] = colour[b] = c;
                more = true;
            }
        }
    }
}

static void compare(const struct graph *g, uint32_t *fragment, struct fragment_counts *counts)
{
    int colour[MOST], size[MOST] = {0}, colours = 0;
    struct dm2_error err;
    for (size_t i = 0; i < g->n; i++)
        colour[i] = -1;
    for (size_t i = 0; i < g->n; i++)
        if (colour[i] < 0)
            spread(g, (uint32_t)i, colour, colours++);
    CHECK_EQ_INT(fragments_find(g->e, g->n, g->p, g->n_pairs, fragment, counts, &err), DM2_OK);
    CHECK_EQ_INT(counts->fragments, colours);
    for (size_t i = 0; i < g->n; i++) {
        size[fragment[i]]++;
        for (size_t j = 0; j < i; j++)
            CHECK((colour[i] == colour[j]) == (fragment[i] == fragment[j]));
    }
    size_t single = 0, seen = 0;
    for (int f = 0; f < colours; f++) {
        single += size[f] == 1;
        CHECK(f == 0 || size[f] <= size[f - 1]);
    }
    CHECK_EQ_INT(counts->single, single);
    CHECK_EQ_INT(counts->largest, colours > 0 ? size[0] : 0);
    for (size_t i = 0; i < g->n; i++) { /* of equal fragments, the one with the lowest id comes first */
        size_t f = fragment[i];
        bool new_one = true;
        for (size_t j = 0; j < i; j++)
            new_one = new_one && fragment[j] != f;
        for (size_t j = 0; new_one && j < i; j++)
            CHECK(size[fragment[j]] != size[f] || fragment[j] < f);
        seen += new_one;
    }
    CHECK_EQ_INT(seen, counts->fragments);
}

TEST(as_a_search_finds_them)
{
    static const size_t pairs[] = {0, 40, 100, 160, 300};
    for (size_t k = 0; k < sizeof pairs / sizeof pairs[0]; k++) {
        struct graph g;
        uint32_t fragment[MOST], again[MOST];
        struct fragment_counts counts, same;
        make(&g, 7 + k, 200, pairs[k]);
        compare(&g, fragment, &counts);
        printf("%zu pairs: %zu fragments, %zu single, largest %zu\n", pairs[k], counts.fragments,
               counts.single, counts.largest);
        for (size_t p = 0; p < g.n_pairs / 2; p++) { /* the pairs in reverse order */
            struct pair_record swap = g.p[p];
            g.p[p] = g.p[g.n_pairs - 1 - p];
            g.p[g.n_pairs - 1 - p] = swap;
        }
        compare(&g, again, &same);
        CHECK_EQ_INT(memcmp(fragment, again, g.n * sizeof *fragment), 0);
    }
}

TEST(no_element_and_an_absent_one)
{
    struct graph g;
    uint32_t fragment[MOST];
    struct fragment_counts counts;
    make(&g, 1, 0, 0);
    compare(&g, fragment, &counts);
    CHECK(counts.fragments == 0 && counts.largest == 0);
    make(&g, 1, 3, 0);
    struct dm2_error err;
    const struct pair_record absent = {.id_a = g.e[0].id, .id_b = 99, .linked = 1};
    CHECK_EQ_INT(fragments_find(g.e, g.n, &absent, 1, fragment, &counts, &err), DM2_OK);
    CHECK_EQ_INT(counts.fragments, 3);
}

TEST(elements_are_found_by_id)
{
    struct graph g;
    make(&g, 5, 100, 0);
    size_t found = 0;
    for (uint32_t id = 0; id < 200; id++) {
        size_t i = element_find(g.e, g.n, id);
        CHECK(i <= g.n && (i == g.n || g.e[i].id == id));
        found += i < g.n;
    }
    CHECK_EQ_INT(found, g.n);
}

TEST_MAIN(CASE(as_a_search_finds_them), CASE(no_element_and_an_absent_one), CASE(elements_are_found_by_id))
