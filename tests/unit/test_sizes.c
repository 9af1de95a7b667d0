/* Products of counts that come from outside do not wrap where size_t has 32 bits (.ci/run runs the unit tests
 * with -m32). */
#include <stdint.h>
#include <stdlib.h>

#include "dm2/base/bytes.h"
#include "dm2/base/mem.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"
#include "check.h"

/* A STATE message of n elements with `rest` bytes behind its head: is it refused? */
static bool is_refused(uint32_t n, size_t rest)
{
    struct bytes_writer w = {0};
    struct state_message m = {.purpose = STATE_FINAL, .last = true, .n_elements = n};
    message_put_state(&w, &m);
    unsigned char *room = bytes_put_room(&w, rest);
    CHECK(room != NULL);
    if (room != NULL)
        memset(room, 0, rest);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_state(&r, &m);
    bytes_free(&w);
    return r.failed;
}

TEST(counts_of_a_state)
{
    /* n elements take 2^32 bytes and the rest. */
    uint32_t n = (uint32_t)((((uint64_t)1 << 32) + WIRE_ELEMENT - 1) / WIRE_ELEMENT);
    CHECK(is_refused(n, (size_t)((uint64_t)n * WIRE_ELEMENT - ((uint64_t)1 << 32))));
    CHECK(!is_refused(3, (size_t)3 * WIRE_ELEMENT));
    CHECK(is_refused(3, (size_t)3 * WIRE_ELEMENT + 1));
}

TEST(sizes_of_arrays)
{
    size_t cap = 0;
    CHECK(mem_alloc(SIZE_MAX / 8 + 1, 8) == NULL);
    CHECK(mem_zalloc(SIZE_MAX / 8 + 1, 8) == NULL);
    CHECK(mem_grown(NULL, &cap, 0, SIZE_MAX / 8 + 1, 8) == NULL);
    CHECK_EQ_INT(cap, 0);
}

TEST_MAIN(CASE(counts_of_a_state), CASE(sizes_of_arrays))
