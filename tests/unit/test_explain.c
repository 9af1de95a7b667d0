/* A finished run and the model: the parts of the difference add up to the difference, and the largest one
 * is named. */
#include "check.h"

#include "dm2/performance/explain.h"

/* Two servers with 10 ms each of computing, 100 mirrored elements of 50 bytes. */
static struct explain_input example(struct explain_server server[2])
{
    server[0] = server[1] = (struct explain_server){.computing = 5e-3, .mirrored = 100};
    return (struct explain_input){.servers = 2,
                                  .processors = 2,
                                  .t_seq = 10e-3,
                                  .work = 10e-3,
                                  .m = 1e-8,
                                  .b = 1e-4,
                                  .g = 50,
                                  .g_migrant = 200,
                                  .measured = 5.15e-3,
                                  .server = server};
}

static double sum(const struct explanation *e)
{
    double total = 0;
    for (int k = 0; k < EXPLAIN_CAUSES; k++)
        total += e->share[k];
    return total;
}

TEST(prediction_is_the_models)
{
    struct explain_server server[2];
    struct explain_input in = example(server);
    struct explanation e = explain_run(&in);
    CHECK_NEAR(e.computing, 5e-3, 1e-15);
    CHECK_NEAR(e.communication, 1e-8 * 50 * 100 + 1e-4, 1e-15);
    CHECK_NEAR(e.predicted, 5.15e-3, 1e-15);
    CHECK_NEAR(sum(&e), 0, 1e-15);
    CHECK_NEAR(e.speedup, 10 / 5.15, 1e-12);
    CHECK_NEAR(e.efficiency, 5 / 5.15, 1e-12);
}

TEST(fewer_processors_than_servers_share_the_computing)
{
    struct explain_server server[2];
    struct explain_input in = example(server);
    in.processors = 1;
    CHECK_NEAR(explain_run(&in).computing, 10e-3, 1e-15);
    in.processors = 5; /* more processors do not help */
    CHECK_NEAR(explain_run(&in).computing, 5e-3, 1e-15);
}

/* The work of servers while messages are on the way hides the messages, unless the client works on the same
 * processors. */
TEST(work_ahead_hides_communication)
{
    struct explain_server server[2];
    struct explain_input in = example(server);
    in.apart = true;
    server[0].ahead = server[1].ahead = 0.01 * 5e-3;
    CHECK_NEAR(explain_run(&in).communication, 1.5e-4 - 0.5e-4, 1e-15);
    CHECK_NEAR(explain_run(&in).predicted, 5.1e-3, 1e-15);
    server[0].ahead = server[1].ahead = 4e-3;
    CHECK_NEAR(explain_run(&in).predicted, 5e-3, 1e-15);
    in.apart = false;
    CHECK_NEAR(explain_run(&in).predicted, 5.15e-3, 1e-15);
}

TEST(largest_cause_is_named)
{
    struct explain_server server[2];
    struct explain_input in = example(server);
    in.measured = 7.15e-3;
    server[0].computing = 7e-3;
    server[1].computing = 3e-3;
    struct explanation e = explain_run(&in);
    CHECK_STR(explain_cause_name(e.largest), "imbalance");
    CHECK_NEAR(e.share[e.largest], 2e-3, 1e-15);
    CHECK_NEAR(sum(&e), 2e-3, 1e-15);

    in = example(server);
    in.measured = 6.15e-3;
    in.relay = 0.5e-3;
    server[0].packing = server[1].packing = 0.4e-3;
    e = explain_run(&in);
    CHECK_STR(explain_cause_name(e.largest), "relay");
    CHECK_NEAR(sum(&e), 1e-3, 1e-15);

    in = example(server);
    in.measured = 6e-3;
    in.redone = 1;
    in.b = 4e-4;
    server[0].migrants = server[1].migrants = 200;
    e = explain_run(&in);
    CHECK_STR(explain_cause_name(e.largest), "migration");
    CHECK_NEAR(e.share[EXPLAIN_MIGRATION], 8e-4, 1e-15);

    in = example(server);
    in.measured = 9e-3;
    CHECK_STR(explain_cause_name(explain_run(&in).largest), "waiting");

    in = example(server);
    in.work = 8e-3;
    in.measured = 5.15e-3;
    CHECK_STR(explain_cause_name(explain_run(&in).largest), "computing");

    in = example(server); /* faster than predicted: the named cause must be a part that takes less */
    in.work = 12e-3;
    in.measured = 5.2e-3;
    in.relay = 1e-5;
    e = explain_run(&in);
    CHECK(e.share[e.largest] < 0);
    CHECK_STR(explain_cause_name(e.largest), "computing");
}

TEST_MAIN(CASE(prediction_is_the_models), CASE(fewer_processors_than_servers_share_the_computing),
          CASE(work_ahead_hides_communication), CASE(largest_cause_is_named))
