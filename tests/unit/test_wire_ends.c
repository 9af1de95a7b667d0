/* What ends on the wire: links that broke, and the end of a run in NEXT. */
#include "check.h"

#include <math.h>

#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"

TEST(the_end_of_a_run_in_next)
{
    struct bytes_writer w = {0};
    struct next_message next = {.step = 3, .ends = true}, next_in;
    message_put_next(&w, &next);
    CHECK_EQ_INT(w.data[8], 32);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_next(&r, &next_in);
    CHECK(bytes_done(&r) && next_in.ends);
    w.data[8] |= 1; /* redo */
    r = bytes_reader_of(w.data, w.length);
    message_get_next(&r, &next_in);
    CHECK(r.failed);
    w.data[8] = 16;
    r = bytes_reader_of(w.data, w.length);
    message_get_next(&r, &next_in);
    CHECK(r.failed);
    bytes_free(&w);
}

TEST_MAIN(CASE(the_end_of_a_run_in_next))
