/* From the report of a run to the printed line: in each made-up report one cause makes the difference. */
#include "check.h"

#include "app/prediction.h"

enum { STEPS = 100 };

/* Two servers on 1000 elements in 100 cells each: 2 ms of computing and 3 ms elapsed per step; 50 mirrored
 * elements. */
static struct run_report sample(struct server_report server[2])
{
    for (int k = 0; k < 2; k++)
        server[k] = (struct server_report){.cells = 100,
                                           .owned = 1000,
                                           .mirrored = 50,
                                           .times = {.steps = STEPS,
                                                     .forces = 1.2e-3 * STEPS,
                                                     .integrate = 0.3e-3 * STEPS,
                                                     .rebuild = 0.5e-3 * STEPS,
                                                     .cpu = 2e-3 * STEPS}};
    return (struct run_report){.program = "dm2-client",
                               .elements = 2000,
                               .steps = STEPS,
                               .timed = STEPS,
                               .stepping = 3e-3 * STEPS,
                               .ranks = 2,
                               .update_bytes = 40,
                               .servers = server};
}

/* k so that two servers compute 2 ms each: T_seq = k n^2/c = 4 ms. Messages take 0.1 ms. */
static struct calibration constants(void)
{
    struct calibration c = {.perf = perf_paper()};
    c.perf.k = 4e-3 * 200 / (2000.0 * 2000.0);
    c.perf.n_network = 1;
    c.perf.network[0] = (struct perf_network){.servers = 2, .m = 0, .b = 1e-4};
    return c;
}

static struct explanation explain(const struct run_report *r, const struct calibration *c, int cores,
                                  char *text)
{
    struct prediction_basis basis;
    struct explanation e = {0};
    prediction_calibrated(c, "here.csv", r, cores, &basis);
    CHECK(prediction_explain(r, &basis, &e));
    prediction_text(&e, &basis, r, text);
    return e;
}

TEST(waiting)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct calibration c = constants();
    char text[PREDICTION_TEXT];
    struct explanation e = explain(&r, &c, 2, text);
    CHECK_NEAR(e.predicted, 2.1e-3, 1e-12);
    CHECK_NEAR(e.measured, 3e-3, 1e-12);
    CHECK_CONTAINS(text,
                   "predicted: 2.1 ms per step = 2 computing + 0.1 communication (calibrated: here.csv)\n");
    CHECK_CONTAINS(text,
                   "measured: 3 ms per step, +42.9 %; largest cause of the difference: waiting, +0.9 ms\n");
    CHECK_CONTAINS(text, "speedup: 1.33, efficiency 0.667, against T_seq 4 ms per step\n");
}

TEST(imbalance)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct calibration c = constants();
    char text[PREDICTION_TEXT];
    server[0].times.forces += 0.8e-3 * STEPS;
    server[1].times.forces -= 0.8e-3 * STEPS;
    struct explanation e = explain(&r, &c, 2, text);
    CHECK_NEAR(e.share[EXPLAIN_IMBALANCE], 0.8e-3, 1e-12);
    CHECK_CONTAINS(text, "largest cause of the difference: imbalance, +0.8 ms");
}

/* Migrants cost their bytes, and a b for each second round trip. */
TEST(migration)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct calibration c = constants();
    char text[PREDICTION_TEXT];
    r.redone = STEPS / 2;
    c.perf.network[0].b = 1e-3;
    struct explanation e = explain(&r, &c, 2, text);
    CHECK_NEAR(e.share[EXPLAIN_MIGRATION], 0.5e-3, 1e-12);
    r.stepping = 3.6e-3 * STEPS;
    e = explain(&r, &c, 2, text);
    CHECK_CONTAINS(text, "largest cause of the difference: migration, +0.5 ms");

    r = sample(server);
    c = constants();
    c.perf.network[0].m = 1e-8;
    server[0].times.migrants = server[1].times.migrants = 300 * STEPS;
    e = explain(&r, &c, 2, text);
    CHECK(e.share[EXPLAIN_MIGRATION] > 300 * 40 * 1e-8 && e.share[EXPLAIN_MIGRATION] < 300 * 1000 * 1e-8);
    r.stepping = (e.predicted + 1.5 * e.share[EXPLAIN_MIGRATION]) * STEPS;
    (void)explain(&r, &c, 2, text);
    CHECK_CONTAINS(text, "largest cause of the difference: migration, +");
}

/* Two processors for two servers leave none for the client; three do. */
TEST(work_ahead)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct calibration c = constants();
    char text[PREDICTION_TEXT];
    server[0].times.ahead = server[1].times.ahead = 0.06e-3 * STEPS;
    double share =
        0.06 / (1e3 * (server[0].times.forces + server[0].times.integrate + server[0].times.rebuild) / STEPS);
    CHECK_NEAR(explain(&r, &c, 2, text).predicted, 2.1e-3, 1e-12);
    CHECK_NEAR(explain(&r, &c, 3, text).predicted, 2.1e-3 - share * 2e-3, 1e-12);
    CHECK_NEAR(explain(&r, &c, 0, text).predicted, 2.1e-3 - share * 2e-3, 1e-12);
}

TEST(relay)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct calibration c = constants();
    char text[PREDICTION_TEXT];
    r.relay = 0.4e-3 * STEPS;
    server[0].times.pack = server[1].times.pack = 0.2e-3 * STEPS;
    server[0].times.unpack = server[1].times.unpack = 0.1e-3 * STEPS;
    struct explanation e = explain(&r, &c, 2, text);
    CHECK_NEAR(e.share[EXPLAIN_RELAY], 0.7e-3, 1e-12);
    CHECK_CONTAINS(text, "largest cause of the difference: relay, +0.7 ms");
}

TEST(computing)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct calibration c = constants();
    char text[PREDICTION_TEXT];
    c.perf.k /= 2;
    (void)explain(&r, &c, 2, text);
    CHECK_CONTAINS(text, "largest cause of the difference: computing, +1 ms");
    c.perf.k *= 8;
    (void)explain(&r, &c, 2, text);
    CHECK_CONTAINS(text, "largest cause of the difference: computing, -6 ms");
}

/* Fewer processors than servers share the work; k is taken at the size of a server's part, beside busy
 * neighbours only where the servers share a machine. */
TEST(processors_and_caches)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct calibration c = constants();
    struct prediction_basis basis;
    char text[PREDICTION_TEXT];
    CHECK_NEAR(explain(&r, &c, 1, text).computing, 4e-3, 1e-12);
    CHECK_CONTAINS(text, "2 servers on 1 processors");
    c.perf.n_size = 2;
    c.perf.size[0] = (struct perf_size){.n = 1000, .alone = 0.5 * c.perf.k, .shared = 0.75 * c.perf.k};
    c.perf.size[1] = (struct perf_size){.n = 2000, .alone = c.perf.k, .shared = 2 * c.perf.k};
    prediction_calibrated(&c, "here.csv", &r, 2, &basis);
    CHECK_NEAR(basis.t_seq, 4e-3, 1e-12);
    CHECK_NEAR(basis.work, 3e-3, 1e-12);
    prediction_calibrated(&c, "here.csv", &r, 0, &basis);
    CHECK_NEAR(basis.work, 2e-3, 1e-12);
    prediction_calibrated(&c, "here.csv", &r, 1, &basis);
    CHECK_NEAR(basis.work, 4e-3, 1e-12);
}

/* Without a calibration T_seq is the servers' own processor time for computing. */
TEST(estimated)
{
    struct server_report server[2];
    struct run_report r = sample(server);
    struct network_line line = {.servers = 2, .sizes = 3, .turns = 15, .m = 0, .b = 2e-4};
    struct prediction_basis basis;
    struct explanation e;
    char text[PREDICTION_TEXT];
    server[1].times.cpu = 1e-3 * STEPS;
    server[0].times.output = server[1].times.output = 10; /* sending results is no part of the steps */
    prediction_estimated(&line, &r, 2, &basis);
    CHECK_NEAR(basis.t_seq, 3e-3, 1e-12);
    CHECK(prediction_explain(&r, &basis, &e));
    CHECK_NEAR(e.predicted, 1.7e-3, 1e-12);
    prediction_text(&e, &basis, &r, text);
    CHECK_CONTAINS(text, "estimated from this run's own processor time and 45 round trips before it");
    r.timed = 0;
    CHECK(!prediction_explain(&r, &basis, &e));
}

TEST_MAIN(CASE(waiting), CASE(imbalance), CASE(migration), CASE(work_ahead), CASE(relay), CASE(computing),
          CASE(processors_and_caches), CASE(estimated))
