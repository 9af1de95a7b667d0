/* Cracks: which links are noted, with which mode, place and energy; each once, whatever the ranks and whether
 * forces were begun ahead; the table's rows, and the rows that a run takes over. */
#include "engine_help.h"
#include "scratch.h"

#include <math.h>

#include "output/cracks.h"
#include "output/resume.h"

/* --- modes --- */

/* Two linked elements across a seam of x, at the distance 1.06, link_break 1.05. */
static const char two[] =
    "let kt = 0.5; let tensile = 1\n"
    "domain { size = 10 10; r_c = 1.4; delta_r = 0.1; boundary = periodic free }\n"
    "time { dt = 0.01; steps = 100 }\n"
    "material M { mass = 1 }\n"
    "interaction { potential = quadratic; k = 1; kt_ratio = kt }\n"
    "interface body { linked = yes }\n"
    "body a { shape = rectangle 0 5 0.5 5.5; spacing = 1; origin = 0.2 5.2; material = M }\n"
    "body b { shape = rectangle 9 5 9.5 5.5; spacing = 1; origin = 9.14 5.2; material = M }\n";

static struct crack crack_of(double stretch, double spring)
{
    struct engine g;
    engine_start(&g, two, NULL, 1);
    struct engine_state s = engine_collect(&g, false);
    struct pair_record pair = {.id_a = 0, .id_b = 1, .linked = 1, .stretch = stretch, .spring = spring};
    struct engine_state with = {.e = s.e, .n = s.n, .pair = &pair, .n_pairs = 1};
    engine_restore(&g, 0, &with);
    engine_must(&g, engine_forces(&g, false));
    const struct crack_list *list = subdomain_cracks(g.sd[0]);
    CHECK_EQ_INT(list->n, 1);
    struct crack crack = list->n == 1 ? list->items[0] : (struct crack){0};
    engine_state_free(&s);
    engine_stop(&g);
    return crack;
}

TEST(modes_and_places)
{
    struct crack c = crack_of(0, 0);
    CHECK(c.id_a == 0 && c.id_b == 1 && c.mode == CRACK_PULLED && c.grains == 2);
    CHECK_NEAR(c.r[0], 9.67, 1e-12); /* midway over the seam: 9.14 + 0.53 */
    CHECK_NEAR(c.r[1], 5.2, 1e-12);
    CHECK_NEAR(c.energy, 0.5 * 0.06 * 0.06, 1e-12);
    c = crack_of(0.02, 0);
    CHECK(c.mode == CRACK_YIELDED);
    CHECK_NEAR(c.energy, 0.5 * 0.04 * 0.04, 1e-12);
    /* kt s^2/2 = 0.25 s^2 against u = 0.0018 */
    c = crack_of(0, 0.08);
    CHECK(c.mode == CRACK_PULLED);
    CHECK_NEAR(c.energy, 0.5 * 0.06 * 0.06 + 0.25 * 0.08 * 0.08, 1e-12);
    CHECK(crack_of(0, -0.09).mode == CRACK_SHEARED);
    CHECK(crack_of(0.03, 0.09).mode == CRACK_SHEARED);
    CHECK(crack_of(0.03, 0.001).mode == CRACK_YIELDED);
}

/* --- ranks --- */

static const char tear[] =
    "domain { size = 30 20; r_c = 1.6; delta_r = 0.3; boundary = periodic free }\n"
    "time { dt = 0.1; steps = 1000 }\n"
    "material M { mass = 1 }\n"
    "interaction { potential = morse; k = 1; shape = 4; kt_ratio = 0.3; link_break = 1.03 }\n"
    "body sheet { shape = rectangle 0 2 30 18; spacing = 1; material = M\n"
    "    structure = polycrystal; grain_size = 6; jitter = 0.06; seed = 5 }\n";

/* All cracks of `steps` steps in the order of steps and ids. */
static struct crack_list run_cracks(int ranks, bool ahead, int steps, uint64_t *links)
{
    struct engine g;
    struct measures m;
    struct crack_list all = {0}, step;
    engine_start(&g, tear, NULL, ranks);
    g.ahead = ahead;
    for (int k = 0; k < steps; k++) {
        step = (struct crack_list){0};
        engine_must(&g, engine_forces(&g, k == 0 && !ahead));
        for (int r = 0; r < ranks; r++) {
            const struct crack_list *part = subdomain_cracks(g.sd[r]);
            for (size_t c = 0; c < part->n; c++)
                CHECK(crack_list_add(&step, &part->items[c]) == 0);
        }
        crack_list_sort(&step);
        for (size_t c = 0; c < step.n; c++)
            CHECK(crack_list_add(&all, &step.items[c]) == 0);
        crack_list_free(&step);
        g.ahead = ahead && k + 1 < steps;
        engine_must(&g, engine_move(&g, k == 0 && !ahead ? &m : NULL));
        if (k == 0 && !ahead)
            links[0] = m.links;
    }
    if (!ahead) {
        engine_must(&g, engine_forces(&g, true));
        measures_clear(&m);
        for (int r = 0; r < ranks; r++) {
            struct measures part;
            engine_must(&g, subdomain_measure_last(g.sd[r], &part, &g.err));
            measures_merge(&m, &part);
        }
        links[1] = m.links;
        for (int r = 0; r < ranks; r++)
            links[1] += subdomain_cracks(g.sd[r])->n; /* of an evaluation more */
    }
    engine_stop(&g);
    return all;
}

TEST(each_link_once)
{
    uint64_t links[2] = {0, 0}, again[2];
    struct crack_list one = run_cracks(1, false, 40, links);
    CHECK(one.n > 50);
    CHECK_EQ_INT(one.n, links[0] - links[1]);
    for (int ranks = 2; ranks <= 7; ranks += 5) {
        for (int ahead = 0; ahead < 2; ahead++) {
            struct crack_list many = run_cracks(ranks, ahead, 40, again);
            CHECK_EQ_INT(many.n, one.n);
            for (size_t k = 0; k < one.n && k < many.n; k++) {
                const struct crack *a = &one.items[k], *b = &many.items[k];
                CHECK(a->id_a == b->id_a && a->id_b == b->id_b && a->mode == b->mode &&
                      a->grains == b->grains);
                CHECK_SAME_BITS(a->energy, b->energy);
                CHECK_SAME_BITS(a->r[0], b->r[0]);
                CHECK_SAME_BITS(a->r[1], b->r[1]);
            }
            crack_list_free(&many);
        }
    }
    crack_list_free(&one);
}

/* A rebuild puts back what forces begun ahead have broken: the same links break in the next evaluation. */
TEST(forces_that_are_dropped)
{
    struct engine g;
    double dmax;
    size_t seen = 0;
    engine_start(&g, tear, NULL, 1);
    for (int k = 0; k < 30; k++) {
        engine_must(&g, engine_forces(&g, false));
        engine_must(&g, subdomain_move(g.sd[0], &dmax, NULL, &g.err));
        subdomain_forces_ahead(g.sd[0], false);
        size_t begun = subdomain_cracks(g.sd[0])->n;
        engine_rebuild(&g);
        CHECK_EQ_INT(subdomain_cracks(g.sd[0])->n, 0);
        engine_must(&g, engine_forces(&g, false));
        CHECK_EQ_INT(subdomain_cracks(g.sd[0])->n, begun);
        seen += begun;
        engine_must(&g, subdomain_move(g.sd[0], &dmax, NULL, &g.err));
        engine_rebuild(&g);
    }
    CHECK(seen > 20);
    engine_stop(&g);
}

/* --- the table --- */

static const char rows[] = "step,time [us],x [cm],y [cm],id_a,id_b,grains,mode,energy [g cm2/us2]\n"
                           "4,2,0.5,0.25,1,7,2,sheared,1e-07\n"
                           "4,2,0.5,-1,2,3,1,pulled,0.5\n"
                           "10,5,1,1,1,2,1,yielded,0\n";

TEST(rows_by_step_and_ids)
{
    scratch_begin();
    struct file_out f;
    struct dm2_error err = {0};
    struct config c = {.dt = 0.5};
    struct crack_list list = {0};
    const struct crack cracks[] = {
        {.id_a = 2, .id_b = 3, .r = {0.5, -1}, .energy = 0.5, .mode = CRACK_PULLED, .grains = 1},
        {.id_a = 1, .id_b = 7, .r = {0.5, 0.25}, .energy = 1e-7, .mode = CRACK_SHEARED, .grains = 2},
        {.id_a = 1, .id_b = 2, .r = {1, 1}, .energy = -0.0, .mode = CRACK_YIELDED, .grains = 1}};
    CHECK_EQ_INT(file_create(&f, scratch_path("cracks.csv"), &err), DM2_OK);
    cracks_put_heading(&f);
    CHECK(crack_list_add(&list, &cracks[0]) == 0 && crack_list_add(&list, &cracks[1]) == 0);
    CHECK_EQ_INT(cracks_put(&f, &c, 4, &list, &err), DM2_OK);
    list.n = 0;
    CHECK(crack_list_add(&list, &cracks[2]) == 0);
    CHECK_EQ_INT(cracks_put(&f, &c, 10, &list, &err), DM2_OK);
    CHECK_EQ_INT(file_commit(&f, &err), DM2_OK);
    crack_list_free(&list);
    char *text = scratch_read("cracks.csv", NULL);
    CHECK_STR(text, rows);
    free(text);
    scratch_end();
}

/* What a run that continues from `step` has in directory `to`, of a table `text` in directory `from`; NULL:
 * no table. */
static char *resumed(const char *text, const char *name, int64_t step, bool in_place, enum dm2_status *status,
                     struct dm2_error *err)
{
    struct file_out f = {0};
    char from[64], path[80];
    static int count;
    snprintf(from, sizeof from, "from%d", count);
    mkdir(scratch_path(from), 0777);
    snprintf(path, sizeof path, "from%d/%s", count, name);
    scratch_write(path, text);
    char source[500], to[500];
    snprintf(source, sizeof source, "%s", scratch_path(from));
    if (!in_place)
        snprintf(from, sizeof from, "to%d", count);
    mkdir(scratch_path(from), 0777);
    snprintf(to, sizeof to, "%s", scratch_path(from));
    count++;
    const struct crack_count unknown = {.from = -1};
    struct crack_rows kept;
    *status = cracks_check(source, step, &unknown, &kept, err);
    snprintf(path, sizeof path, "%s/cracks.csv", from);
    CHECK(!in_place || scratch_exists(path) == kept.whole); /* untouched */
    if (*status == DM2_OK)
        *status = cracks_take(&kept, to, in_place, &f, err);
    cracks_free(&kept);
    bool any = f.path != NULL;
    file_suspend(&f);
    snprintf(path, sizeof path, "%s/cracks.csv.part", from);
    CHECK(any == scratch_exists(path) || *status != DM2_OK);
    return any ? scratch_read(path, NULL) : NULL;
}

TEST(rows_before_the_checkpoint_stay)
{
    scratch_begin();
    enum dm2_status status;
    struct dm2_error err = {0};
    size_t four = (size_t)(strstr(rows, "10,5") - rows);
    for (int in_place = 0; in_place < 2; in_place++) {
        for (int whole = 0; whole < 2; whole++) {
            const char *name = whole ? "cracks.csv" : "cracks.csv.part";
            char *text = resumed(rows, name, 10, in_place, &status, &err);
            CHECK_EQ_INT(status, DM2_OK);
            CHECK(text != NULL && strlen(text) == four && memcmp(text, rows, four) == 0);
            free(text);
            text = resumed(rows, name, 11, in_place, &status, &err);
            CHECK(text != NULL && strcmp(text, rows) == 0);
            free(text);
            CHECK(resumed(rows, name, 4, in_place, &status, &err) == NULL && status == DM2_OK);
        }
    }
    char torn[sizeof rows + 10];
    snprintf(torn, sizeof torn, "%s12,6,0.", rows); /* the run was killed in the middle of a row */
    char *text = resumed(torn, "cracks.csv.part", 20, true, &status, &err);
    CHECK(text != NULL && strcmp(text, rows) == 0);
    free(text);
    snprintf(torn, sizeof torn, "%sxyz\n", rows);
    CHECK(resumed(torn, "cracks.csv", 20, true, &status, &err) == NULL && status == DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "does not begin a row of step 10 or later");
    snprintf(torn, sizeof torn, "%s9,1\n", rows);
    CHECK(resumed(torn, "cracks.csv", 20, true, &status, &err) == NULL && status == DM2_PROTOCOL);
    CHECK(resumed("step,a\n1,2\n", "cracks.csv", 20, true, &status, &err) == NULL && status == DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "has another heading");
    scratch_end();
}

/* The status of the check of a table, "" for none, at step 11, of which `count` rows from behind `from` on
 * are expected. */
static enum dm2_status counted(const char *text, int64_t from, int64_t count, struct dm2_error *err)
{
    struct crack_rows kept;
    const struct crack_count want = {.from = from, .rows = count};
    scratch_remove(scratch_path("cracks.csv"));
    if (*text != '\0')
        scratch_write("cracks.csv", text);
    enum dm2_status status = cracks_check(scratch_path("."), 11, &want, &kept, err);
    cracks_free(&kept);
    return status;
}

TEST(rows_that_are_missing)
{
    scratch_begin();
    struct dm2_error err = {0};
    int64_t all = 0;
    for (const char *c = strchr(rows, '\n'); c[1] != '\0'; c = strchr(c + 1, '\n'))
        all++;
    CHECK_EQ_INT(counted(rows, 0, all, &err), DM2_OK);
    CHECK_EQ_INT(counted(rows, 0, all - 1, &err), DM2_OK); /* of links that formed meanwhile */
    CHECK_EQ_INT(counted(rows, -1, all + 1, &err), DM2_OK);
    CHECK_EQ_INT(counted(rows, 0, all + 1, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text,
                   "has 3 rows of these steps, but at least 4 links broke after step 0 and before step 11");
    CHECK_EQ_INT(counted(rows, 9, 1, &err), DM2_OK);
    CHECK_EQ_INT(counted(rows, 9, 2, &err), DM2_PROTOCOL);
    CHECK_EQ_INT(counted("", 0, 0, &err), DM2_OK);
    CHECK_EQ_INT(counted("", 0, 3, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text,
                   "cracks.csv: is not there, but at least 3 links broke after step 0 and before step 11");
    scratch_end();
}

TEST_MAIN(CASE(modes_and_places), CASE(each_link_once), CASE(forces_that_are_dropped),
          CASE(rows_by_step_and_ids), CASE(rows_before_the_checkpoint_stay), CASE(rows_that_are_missing))
