/* Blocks `stop`: at which row one ends the run, with one condition or several, with `after`, and for a run
 * that continues. */
#include "check.h"
#include "deck_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dm2/engine/probe.h"
#include "output/stop_watch.h"

static const char heading[] = "step,time [us],kinetic [g cm2/us2],unbalanced,p_vx [cm/us]\n";

/* Watches rows of (step, kinetic, unbalanced, p_vx); the first `known` of them were there before step `step`.
 * Returns the row that ends the run; -1: none. */
struct row {
    int step;
    double kinetic, unbalanced, vx;
};

static struct stop_watch watch_rows(const struct config *c, const struct row *rows, size_t n, size_t known,
                                    int64_t step)
{
    struct stop_watch watch;
    struct dm2_error err = {0};
    struct csv table;
    char text[2000] = "", line[200];
    strcpy(text, heading);
    for (size_t k = 0; k < known; k++) {
        snprintf(line, sizeof line, "%d,0,%g,%g,%g\n", rows[k].step, rows[k].kinetic, rows[k].unbalanced,
                 rows[k].vx);
        strcat(text, line);
    }
    CHECK_EQ_INT(csv_parse("history.csv", text, strlen(text), &table, &err), DM2_OK);
    CHECK_EQ_INT(stop_watch_open(&watch, c, &table, step, &err), DM2_OK);
    csv_free(&table);
    for (size_t k = known; k < n; k++) {
        snprintf(line, sizeof line, "%d,0,%g,%g,%g\n", rows[k].step, rows[k].kinetic, rows[k].unbalanced,
                 rows[k].vx);
        stop_watch_row(&watch, rows[k].step, line, strlen(line));
    }
    return watch;
}

static int64_t held_row(const struct stop_config *stops, size_t n_stops, const struct row *rows, size_t n,
                        size_t known, int64_t step)
{
    struct config c = {.dt = 0.1, .steps = 1000, .stops = (struct stop_config *)stops, .n_stops = n_stops};
    struct stop_watch watch = watch_rows(&c, rows, n, known, step);
    int64_t held = watch.held;
    stop_watch_free(&watch);
    return held;
}

static const struct row settling[] = {
    {0, 0, NAN, 0},  {10, 5, 0.5, 1},     {20, 0.5, 0.05, 2}, {30, 2, 0.2, 3},      {40, 0.5, 0.005, 4},
    {50, 0.4, 2, 5}, {60, 0.1, 0.001, 6}, {70, 0.2, 0, 7},    {80, 0.1, 0.0001, 8}, {90, 0.1, 0.1, 9}};
enum { ROWS = sizeof settling / sizeof settling[0] };

static int64_t settles(struct stop_config stop)
{
    return held_row(&stop, 1, settling, ROWS, 0, 0);
}

TEST(conditions)
{
    CHECK_EQ_INT(settles((struct stop_config){.kinetic = 1, .unbalanced = NAN}), 0);
    CHECK_EQ_INT(settles((struct stop_config){.kinetic = NAN, .unbalanced = 0.01}),
                 40); /* NaN does not hold */
    CHECK_EQ_INT(settles((struct stop_config){.kinetic = 0.3, .unbalanced = 0.01}), 60);
    CHECK_EQ_INT(settles((struct stop_config){.kinetic = NAN, .unbalanced = 1e-9}), 70);
    CHECK_EQ_INT(settles((struct stop_config){.kinetic = 1e-9, .unbalanced = 1e-9}), -1);
    struct stop_config vx = {
        .kinetic = NAN, .unbalanced = NAN, .column = "p_vx", .above = true, .value = 4.5};
    CHECK_EQ_INT(settles(vx), 50);
    vx.value = 4;
    CHECK_EQ_INT(settles(vx), 50); /* above, not at */
    vx.above = false;
    CHECK_EQ_INT(settles(vx), 0);
    vx.kinetic = 0.7;
    vx.value = 4.5;
    vx.unbalanced = 0.1;
    CHECK_EQ_INT(settles(vx), 20);
}

TEST(after)
{
    struct stop_config stop = {.kinetic = 1, .unbalanced = NAN, .after = 1};
    CHECK_EQ_INT(settles(stop), 50); /* rows 40, 50: 10 steps of 0.1 us */
    stop.after = 4;
    CHECK_EQ_INT(settles(stop), 80);
    stop.after = 4.05;
    CHECK_EQ_INT(settles(stop), 90);
    stop.after = 6;
    CHECK_EQ_INT(settles(stop), -1);
}

TEST(several_blocks)
{
    struct stop_config stops[] = {{.kinetic = 1e-9, .unbalanced = 1e-9},
                                  {.kinetic = 0.3, .unbalanced = NAN, .after = 1},
                                  {.kinetic = NAN, .unbalanced = 1e-9}};
    struct config c = {.dt = 0.1, .steps = 1000, .stops = stops, .n_stops = 3};
    struct stop_watch watch = watch_rows(&c, settling, ROWS, 0, 0);
    char line[RESULTS_LINE];
    CHECK_EQ_INT(watch.held, 70);
    CHECK_EQ_INT(watch.block, 1);
    stop_watch_describe(&watch, line);
    CHECK_STR(line, "stop: kinetic below 0.3 for 1 us at row 70: the run ends at step 73");
    c.steps = 72;
    stop_watch_describe(&watch, line);
    CHECK_CONTAINS(line, "the run ends at step 72");
    stop_watch_free(&watch);
}

/* A run that continues from step S counts the rows before S, and ends where the whole run did; but a block
 * that would have ended it before S is a new one. */
TEST(a_run_that_continues)
{
    struct stop_config stop = {.kinetic = 0.3, .unbalanced = NAN, .after = 1};
    for (size_t known = 1; known < ROWS; known++) {
        int64_t last = settling[known - 1].step;
        for (int64_t step = last + 1; step <= settling[known].step; step++) {
            int64_t row = step <= 73 ? 70 : step <= 83 ? 80 : 90;
            CHECK_EQ_INT(held_row(&stop, 1, settling, ROWS, known, step), row);
        }
    }
}

TEST(a_column_that_is_not_there)
{
    struct stop_config stop = {.kinetic = NAN, .unbalanced = NAN, .column = "q_vx"};
    struct config c = {.dt = 0.1, .stops = &stop, .n_stops = 1};
    struct stop_watch watch;
    struct dm2_error err = {0};
    struct csv table;
    CHECK_EQ_INT(csv_parse("history.csv", heading, strlen(heading), &table, &err), DM2_OK);
    CHECK(stop_watch_open(&watch, &c, &table, 0, &err) != DM2_OK);
    CHECK_CONTAINS(err.text, "q_vx");
    stop_watch_free(&watch);
    csv_free(&table);
}

/* Every column of a probe can end a run. */
TEST(the_columns_of_probes)
{
    static const char deck[] =
        "domain { size = 9 9; r_c = 1.1; delta_r = 0.1 }\ntime { dt = 0.1; steps = 1 }\n"
        "material M { mass = 1 }\ninteraction { potential = quadratic; k = 1 }\n"
        "body lid { shape = rectangle 2 2 4 4; spacing = 1; material = M }\n"
        "wall plane { line = 0 1 9 1; material = M }\n";
    static const char all[] = "position, velocity, force, torque, spin, stress, temperature, kinetic";
    for (int k = 0; k < PROBE_COLUMNS; k++) {
        char text[800], column[80];
        bool region = probe_columns[k].quantity == REPORT_POROSITY,
             wall = probe_columns[k].quantity == REPORT_HEAT;
        snprintf(text, sizeof text, "%sprobe p { %s; report = %s }\nstop { probe = p %s above 0.25 }\n", deck,
                 region ? "region = 2 2 3 3"
                 : wall ? "body = plane"
                        : "body = lid",
                 region ? "porosity"
                 : wall ? "heat"
                        : all,
                 probe_columns[k].suffix);
        struct loaded d = load_text(text, NULL, -1);
        CHECK_REPORT(d.status == DM2_OK, "%s", d.status == DM2_OK ? "" : d.report.text);
        if (d.status == DM2_OK) {
            snprintf(column, sizeof column, "p_%s", probe_columns[k].suffix);
            CHECK_STR(d.config.stops[0].column, column);
            CHECK(d.config.stops[0].above && d.config.stops[0].value == 0.25);
        }
        loaded_free(&d);
    }
}

TEST_MAIN(CASE(conditions), CASE(after), CASE(several_blocks), CASE(a_run_that_continues),
          CASE(a_column_that_is_not_there), CASE(the_columns_of_probes))
