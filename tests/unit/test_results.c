/* The run directory: names, the history's columns and values, overwriting, aborting, and a full disk. */
#include "check.h"
#include "fake_state.h"
#include "scratch.h"

#include <dirent.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "dm2/base/csv.h"
#include "dm2/base/exact.h"
#include "dm2/deck/schedule.h"
#include "dm2/output/results.h"
#include "dm2/output/run_directory.h"
#include "dm2/output/state.h"
#include "dm2/plot/vtp_reader.h"

static const struct state_origin origin = {.digest = {0xe3, 0xb0, 0xc4, 0x42, 0x98, 0xfc, 0x1c, 0x14, 0x9a,
                                                      0xfb, 0xf4, 0xc8, 0x99, 0x6f, 0xb9, 0x24, 0x27, 0xae,
                                                      0x41, 0xe4, 0x64, 0x9b, 0x93, 0x4c, 0xa4, 0x95, 0x99,
                                                      0x1b, 0x78, 0x52, 0xb8, 0x55}, /* SHA-256 of no text */
                                           .next_id = UINT32_MAX,
                                           .next_grain = UINT32_MAX};
static const struct measure_scales scales = {
    .energy = 80, .momentum = 80, .length = 60, .velocity = 80, .mass = 80, .volume = 80, .temperature = 60};

static struct results *open_results(const struct fake *f, const char *name, bool overwrite)
{
    struct results *r;
    struct dm2_error err = {0};
    CHECK_EQ_INT(results_open(scratch_path(name), overwrite, &f->config, scales, &origin, &r, &err), DM2_OK);
    CHECK_STR(err.text, "");
    if (r == NULL)
        exit(1);
    return r;
}

static struct measures some_measures(void)
{
    struct measures m;
    measures_clear(&m);
    exact_add(&m.kinetic, 1.25, scales.energy);
    exact_add(&m.potential, 0.5, scales.energy);
    exact_add(&m.elastic, 0.125, scales.energy);
    exact_add(&m.thermal, 0x1p-30, scales.energy);
    exact_add(&m.chemical, 2, scales.energy);
    exact_add(&m.phase, -0.25, scales.energy);
    exact_add(&m.work, 0.0625, scales.energy);
    exact_add(&m.momentum[0], -3, scales.momentum);
    exact_add(&m.momentum[1], 0.1, scales.momentum);
    exact_add(&m.angular, 7, scales.momentum);
    m.links = 4903;
    m.t_max = 311.5;
    m.p_min = -0.25;
    m.p_max = 0.75;
    m.dt_share = 0.375;
    m.compression = 0.125;
    m.contacts = 16;
    m.pairs = 4000;
    m.elements = 1600;
    m.free_elements = 4;
    m.loaded_pairs = 8;
    exact_add(&m.resultants, 2, scales.force);
    exact_add(&m.magnitudes, 16, scales.force);
    exact_add(&m.fabric[0], 4, FABRIC_SHIFT);
    exact_add(&m.fabric[1], -1, FABRIC_SHIFT);
    m.n_probes = 2;
    m.probe[0] = m.probe[1] =
        (struct probe_sums){.needs = 1u << PROBE_X | 1u << PROBE_Y | 1u << PROBE_VX | 1u << PROBE_VY};
    m.probe[0].count = 4;
    exact_add(&m.probe[0].sum[PROBE_X], 8, scales.length);
    exact_add(&m.probe[0].sum[PROBE_Y], 1, scales.length);
    exact_add(&m.probe[0].sum[PROBE_VX], -2, scales.velocity);
    exact_add(&m.probe[0].sum[PROBE_VY], 0.5, scales.velocity);
    return m;
}

/* Entries of a directory other than . and .. ; -1: there is none. */
static int entries(const char *name)
{
    DIR *dir = opendir(scratch_path(name));
    int n = 0;
    if (dir == NULL)
        return -1;
    while (readdir(dir) != NULL)
        n++;
    closedir(dir);
    return n - 2;
}

TEST(default_directory)
{
    static const char *const cases[][2] = {{"input/plate-impact.dm2", "plate-impact.run"},
                                           {"a.b/deck", "deck.run"},
                                           {"../x.y.dm2", "x.y.run"},
                                           {".hidden", ".hidden.run"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *name = run_directory_default(cases[i][0]);
        CHECK_STR(name, cases[i][1]);
        free(name);
    }
}

TEST(steps_that_are_due)
{
    static int64_t at[] = {3, 17};
    struct config c = {.steps = 25, .output = {.history_every = 10, .n_snapshot_at = 2, .snapshot_at = at}};
    static const int64_t history[] = {0, 10, 20, 25}, snapshots[] = {3, 17}, every[] = {0, 3, 12, 17, 24};
    size_t h = 0, s = 0, e = 0;
    for (int64_t step = 0; step <= 25; step++) {
        if (schedule_history(&c, step))
            CHECK_EQ_INT(step, history[h++]);
        c.output.snapshot_every = 0;
        if (schedule_snapshot(&c, step))
            CHECK_EQ_INT(step, snapshots[s++]);
        c.output.snapshot_every = 12;
        if (schedule_snapshot(&c, step))
            CHECK_EQ_INT(step, every[e++]);
    }
    CHECK_EQ_INT(h, 4);
    CHECK_EQ_INT(s, 2);
    CHECK_EQ_INT(e, 5);
}

/* A whole run: every file has its final name, no other file is left, and the values are those put in. */
TEST(whole_run)
{
    struct fake f;
    struct dm2_error err = {0};
    fake_make(&f, 5, 4);
    f.config.output.xyz = true;
    struct measures m = some_measures();
    struct results *r = open_results(&f, "new/parents/run", false);
    CHECK_STR(results_directory(r), scratch_path("new/parents/run"));
    CHECK_EQ_INT(results_history(r, 0, &m, &err), DM2_OK);
    CHECK_EQ_INT(
        results_snapshot(r, 0, f.elements, f.measured, f.n, f.pairs, f.forces, f.n_pairs, NULL, &err),
        DM2_OK);
    CHECK_EQ_INT(results_history(r, 200, &m, &err), DM2_OK);
    CHECK_EQ_INT(
        results_snapshot(r, 200, f.elements, f.measured, f.n, f.pairs, f.forces, f.n_pairs, NULL, &err),
        DM2_OK);
    CHECK_EQ_INT(results_final(r,
                               &(struct state_view){.step = 200,
                                                    .elements = f.elements,
                                                    .n_elements = f.n,
                                                    .pairs = f.pairs,
                                                    .n_pairs = f.n_pairs},
                               &err),
                 DM2_OK);
    CHECK_EQ_INT(results_log(r, "first\n", 6, &err), DM2_OK);
    CHECK_EQ_INT(results_log(r, "log\n", 4, &err), DM2_OK);
    CHECK_EQ_INT(results_text(r, "timing.csv", "a\n", 2, &err), DM2_OK);
    CHECK(!scratch_exists("new/parents/run/history.csv"));
    CHECK_EQ_INT(results_close(r, &err), DM2_OK);
    CHECK_STR(err.text, "");
    CHECK_EQ_INT(entries("new/parents/run"), 7);
    CHECK_EQ_INT(entries("new/parents/run/snapshots"), 5);

    struct vtp vtp;
    struct state s;
    CHECK_EQ_INT(vtp_read(scratch_path("new/parents/run/snapshots/state-000000200.vtp"), &vtp, &err), DM2_OK);
    CHECK_EQ_INT(vtp.n_points, f.n);
    vtp_free(&vtp);
    CHECK_EQ_INT(state_read(scratch_path("new/parents/run/final.dm2"), &s, &err), DM2_OK);
    CHECK_EQ_INT(s.n_pairs, f.n_pairs);
    CHECK_EQ_INT(memcmp(s.origin.digest, origin.digest, sizeof origin.digest), 0);
    state_free(&s);
    char *log = scratch_read("new/parents/run/run.log", NULL);
    CHECK_STR(log, "first\nlog\n");
    free(log);
    char *fragments = scratch_read("new/parents/run/fragments.csv", NULL);
    CHECK_STR(fragments, "step,time [us],fragments,single,largest\n0,0,1,0,20\n200,5,1,0,20\n");
    free(fragments);
    char *pvd = scratch_read("new/parents/run/snapshots/series.pvd", NULL);
    CHECK_CONTAINS(pvd, "state-000000000.vtp");
    CHECK_CONTAINS(pvd, "state-000000200.vtp");
    free(pvd);
    fake_free(&f);
}

TEST(history_rows)
{
    struct fake f;
    struct csv csv;
    struct dm2_error err = {0};
    fake_make(&f, 2, 2);
    struct measures m = some_measures();
    struct results *r = open_results(&f, "history", false);
    CHECK_EQ_INT(results_history(r, 40, &m, &err), DM2_OK);
    measures_clear(&m); /* the sum over bins equals the input, to the last quantum */
    exact_add(&m.kinetic, 3.6625, scales.energy);
    exact_add(&m.work, 0.1, scales.energy);
    m.t_max = m.p_min = m.p_max = 0;
    m.n_probes = 2;
    m.probe[0] = m.probe[1] = (struct probe_sums){.count = 0};
    CHECK_EQ_INT(results_history(r, 50, &m, &err), DM2_OK);
    CHECK_EQ_INT(results_close(r, &err), DM2_OK);
    char *text = scratch_read("history/history.csv", NULL);
    CHECK_STR(
        text,
        "step,time [us],kinetic [g cm2/us2],potential [g cm2/us2],elastic [g cm2/us2],thermal [g cm2/us2],"
        "chemical [g cm2/us2],phase [g cm2/us2],work [g cm2/us2],total [g cm2/us2],momentum_x [g "
        "cm/us],momentum_y [g cm/us],angular_momentum [g "
        "cm2/us],"
        "elements,links,contacts,temperature_max [K],pressure_min [Mbar],pressure_max "
        "[Mbar],drift,dt_share,compression,unbalanced,coordination,fabric_xx,fabric_yy,fabric_xy,damped [g "
        "cm2/us2],surface_x "
        "[cm],"
        "surface_y [cm],surface_vx [cm/us],surface_vy [cm/us],spall_x [cm],spall_y [cm],spall_vx [cm/us],"
        "spall_vy [cm/us]\n"
        "40,1,1.25,0.5,0.125,9.313225746154785e-10,2,-0.25,0.0625,3.5625000009313226,-3,0.1,7,1600,4903,16,"
        "311.5,-0."
        "25,0.75,0,0.375,0.125,0.25,5,0.25,0.75,-0.0625,0,"
        "2,0.25,-0.5,0.125,nan,nan,nan,nan\n"
        "50,1.25,3.6625,0,0,0,0,0,0.1,3.5625,0,0,0,0,0,0,0,0,0,-2.5428602719876547e-10,0,0,nan,nan,nan,nan,"
        "nan,0,nan,nan,nan,nan,"
        "nan,"
        "nan,nan,nan\n");
    free(text);
    CHECK_EQ_INT(csv_read(scratch_path("history/history.csv"), &csv, &err), DM2_OK);
    CHECK_EQ_INT(csv.n_columns, 36);
    csv_free(&csv);
    fake_free(&f);
}

/* Two bins along y, one of them empty. */
TEST(the_limit_is_summed_at_rows_ten_steps_apart)
{
    static const struct {
        int64_t every, first; /* steps between rows; the first step after 0 that sums */
    } cases[] = {{1, 10}, {2, 10}, {3, 12}, {7, 14}, {10, 10}, {25, 25}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        struct config c = {.steps = 1000, .output = {.history_every = cases[k].every}};
        CHECK(schedule_limit(&c, 0));
        for (int64_t step = 1; step <= 60; step++)
            CHECK(schedule_limit(&c, step) == (step % cases[k].first == 0));
    }
}

TEST(profile_rows)
{
    struct fake f;
    struct dm2_error err = {0};
    struct profile_config profile = {
        .name = "depth", .axis = AXIS_Y, .bins = 2, .range = {0, 0.5}, .every = 10};
    struct profile_bin bins[2] = {{.elements = 4}, {.elements = 0}};
    fake_make(&f, 50, 2); /* 2 cm wide */
    f.config.profiles = &profile;
    f.config.n_profiles = 1;
    exact_add(&bins[0].mass, 2, scales.mass);
    exact_add(&bins[0].momentum[0], -1, scales.momentum);
    exact_add(&bins[0].momentum[1], 0.5, scales.momentum);
    exact_add(&bins[0].volume, 0.25, scales.volume);
    for (int c = 0; c < 3; c++)
        exact_add(&bins[0].stress[c], -0.5 * c, scales.energy);
    exact_add(&bins[0].temperature, 1240, scales.temperature);
    exact_add(&bins[0].area, (2) / 8.0, scales.volume);
    struct results *r = open_results(&f, "profile", false);
    CHECK(schedule_profile(&f.config, 0, 0) && schedule_profile(&f.config, 0, 20) &&
          schedule_profile(&f.config, 0, 200) && !schedule_profile(&f.config, 0, 5));
    CHECK(schedule_measure(&f.config, 20) && !schedule_measure(&f.config, 5));
    CHECK_EQ_INT(results_profile(r, 0, 40, bins, &err), DM2_OK);
    CHECK(!scratch_exists("profile/profile-depth.csv"));
    CHECK_EQ_INT(results_close(r, &err), DM2_OK);
    char *text = scratch_read("profile/profile-depth.csv", NULL);
    CHECK_STR(text, "step,time [us],y [cm],elements,density [g/cm3],vx [cm/us],vy [cm/us],stress_xx [Mbar],"
                    "stress_yy [Mbar],stress_xy [Mbar],temperature [K],porosity\n"
                    "40,1,0.125,4,4,-0.5,0.25,0,-2,-4,310,0.5\n"
                    "40,1,0.375,0,0,nan,nan,nan,nan,nan,nan,1\n");
    free(text);
    r = open_results(&f, "profile-aborted", false);
    CHECK_EQ_INT(results_profile(r, 0, 40, bins, &err), DM2_OK);
    results_abort(r);
    CHECK_EQ_INT(entries("profile-aborted"), -1);
    fake_free(&f);
}

TEST(not_empty_is_an_error)
{
    struct fake f;
    struct results *r;
    struct dm2_error err = {0};
    fake_make(&f, 2, 2);
    mkdir(scratch_path("full"), 0777);
    scratch_write("full/notes.txt", "mine\n");
    CHECK_EQ_INT(results_open(scratch_path("full"), false, &f.config, scales, &origin, &r, &err), DM2_IO);
    CHECK(r == NULL);
    CHECK_CONTAINS(err.text, scratch_path("full"));
    CHECK_CONTAINS(err.text, "is not empty; name another one with -o DIR, or give --overwrite");
    CHECK_EQ_INT(entries("full"), 1);
    CHECK_EQ_INT(results_open(scratch_path("full/notes.txt"), true, &f.config, scales, &origin, &r, &err),
                 DM2_IO);
    CHECK_CONTAINS(err.text, "full/notes.txt: cannot use it as the run directory: Not a directory");
    CHECK_EQ_INT(
        results_open(scratch_path("full/notes.txt/below"), true, &f.config, scales, &origin, &r, &err),
        DM2_IO);
    CHECK_CONTAINS(err.text, "full/notes.txt/below: cannot make the directory: Not a directory");
    CHECK_EQ_INT(results_open("", true, &f.config, scales, &origin, &r, &err), DM2_IO);
    fake_free(&f);
}

/* Overwriting removes the files that a run writes and keeps all others. */
TEST(overwrite_replaces_only_our_files)
{
    struct fake f;
    struct dm2_error err = {0};
    static const char *const ours[] = {"history.csv",
                                       "final.dm2",
                                       "run.log",
                                       "timing.csv",
                                       "history.csv.part",
                                       "fragments.csv",
                                       "cracks.csv",
                                       "cracks.csv.part",
                                       "profile-old.csv",
                                       "profile-x_2.csv.part",
                                       "snapshots/state-000000007.vtp",
                                       "snapshots/state-000000007.xyz.part",
                                       "snapshots/series.pvd"};
    static const char *const theirs[] = {"notes.txt",
                                         "history.csv.orig",
                                         "profile-.csv",
                                         "profile-a.b.csv",
                                         "snapshots/state-best.vtp",
                                         "snapshots/state-000000007.vtp.bak",
                                         "snapshots/state-7.png"};
    fake_make(&f, 2, 2);
    mkdir(scratch_path("again"), 0777);
    mkdir(scratch_path("again/snapshots"), 0777);
    for (size_t i = 0; i < sizeof ours / sizeof ours[0]; i++) {
        char name[128];
        snprintf(name, sizeof name, "again/%s", ours[i]);
        scratch_write(name, "old");
    }
    for (size_t i = 0; i < sizeof theirs / sizeof theirs[0]; i++) {
        char name[128];
        snprintf(name, sizeof name, "again/%s", theirs[i]);
        scratch_write(name, "old");
    }
    struct results *r = open_results(&f, "again", true);
    CHECK_EQ_INT(entries("again"),
                 8); /* the others' files, snapshots, history.csv.part, schedule.csv, the lock */
    CHECK_EQ_INT(entries("again/snapshots"), 3);
    CHECK_EQ_INT(results_close(r, &err), DM2_OK);
    CHECK(scratch_exists("again/history.csv"));
    fake_free(&f);
}

TEST(abort_leaves_nothing_half_written)
{
    struct fake f;
    struct dm2_error err = {0};
    fake_make(&f, 2, 2);
    struct measures m = some_measures();
    struct results *r = open_results(&f, "aborted", false);
    CHECK_EQ_INT(results_history(r, 0, &m, &err), DM2_OK);
    results_abort(r);
    CHECK_EQ_INT(entries("aborted"), -1);

    mkdir(scratch_path("there"), 0777);
    r = open_results(&f, "there", false);
    results_abort(r);
    CHECK_EQ_INT(entries("there"), 0); /* a directory that existed before stays */

    r = open_results(&f, "aborted", false);
    CHECK_EQ_INT(
        results_snapshot(r, 0, f.elements, f.measured, f.n, f.pairs, f.forces, f.n_pairs, NULL, &err),
        DM2_OK);
    results_abort(r);
    CHECK_EQ_INT(entries("aborted"), 1); /* complete files stay */
    CHECK_EQ_INT(entries("aborted/snapshots"), 2);
    results_abort(NULL);
    fake_free(&f);
}

static void limit_file_size(rlim_t bytes)
{
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes;
    CHECK_EQ_INT(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

/* A file size limit stands for a full disk: the write fails half-way. */
TEST(full_disk)
{
    struct fake f;
    struct dm2_error err = {0};
    char path[700];
    struct rlimit before;
    getrlimit(RLIMIT_FSIZE, &before);
    fake_make(&f, 40, 40);
    f.config.output.xyz = true;
    struct measures m = some_measures();
    struct results *r = open_results(&f, "disk", false);
    limit_file_size(4096);
    CHECK_EQ_INT(
        results_snapshot(r, 7, f.elements, f.measured, f.n, f.pairs, f.forces, f.n_pairs, NULL, &err),
        DM2_IO);
    snprintf(path, sizeof path, "%s: cannot write: File too large",
             scratch_path("disk/snapshots/state-000000007.vtp"));
    CHECK_STR(err.text, path);
    CHECK_EQ_INT(
        results_final(
            r,
            &(struct state_view){
                .step = 7, .elements = f.elements, .n_elements = f.n, .pairs = f.pairs, .n_pairs = f.n_pairs},
            &err),
        DM2_IO);
    CHECK_CONTAINS(err.text, "disk/final.dm2: cannot write: File too large");
    f.config.output.vtp = false;
    CHECK_EQ_INT(
        results_snapshot(r, 7, f.elements, f.measured, f.n, f.pairs, f.forces, f.n_pairs, NULL, &err),
        DM2_IO);
    CHECK_CONTAINS(err.text, "disk/snapshots/state-000000007.xyz: cannot write: File too large");
    enum dm2_status status = DM2_OK;
    int64_t rows = 0;
    for (; status == DM2_OK && rows < 1000; rows++)
        status = results_history(r, rows, &m, &err);
    CHECK_EQ_INT(status, DM2_IO);
    CHECK(rows > 10 && rows < 50);
    CHECK_CONTAINS(err.text, "disk/history.csv: cannot write: File too large");
    CHECK_EQ_INT(results_close(r, &err), DM2_IO); /* the first failure is reported again */
    CHECK_EQ_INT(entries("disk"), -1);
    setrlimit(RLIMIT_FSIZE, &before);
    fake_free(&f);
}

TEST(directory_that_cannot_be_written)
{
    struct fake f;
    struct results *r;
    struct dm2_error err = {0};
    fake_make(&f, 2, 2);
    CHECK_EQ_INT(results_open("/proc/nowhere/run", false, &f.config, scales, &origin, &r, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "/proc/nowhere: cannot make the directory");
    r = open_results(&f, "moved", false);
    CHECK_EQ_INT(rename(scratch_path("moved"), scratch_path("elsewhere")), 0);
    CHECK_EQ_INT(
        results_final(
            r,
            &(struct state_view){
                .step = 1, .elements = f.elements, .n_elements = f.n, .pairs = f.pairs, .n_pairs = f.n_pairs},
            &err),
        DM2_IO);
    CHECK_CONTAINS(err.text, "moved/final.dm2: cannot create: No such file or directory");
    CHECK_EQ_INT(results_close(r, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "moved/history.csv: cannot rename its .part file: No such file or directory");
    fake_free(&f);
}

TEST(begin)
{
    (void)signal(SIGXFSZ, SIG_IGN);
    scratch_begin();
}

TEST(end)
{
    scratch_end();
}

TEST_MAIN(CASE(begin), CASE(default_directory), CASE(steps_that_are_due), CASE(whole_run), CASE(history_rows),
          CASE(the_limit_is_summed_at_rows_ten_steps_apart), CASE(profile_rows), CASE(not_empty_is_an_error),
          CASE(overwrite_replaces_only_our_files), CASE(abort_leaves_nothing_half_written), CASE(full_disk),
          CASE(directory_that_cannot_be_written), CASE(end))
