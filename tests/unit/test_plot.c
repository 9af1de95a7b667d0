/* Pictures and charts: round ticks, colours, well-formed SVG with the expected content, small files. */
#include "check.h"
#include "fake_state.h"
#include "scratch.h"

#include "dm2/plot/chart.h"
#include "dm2/plot/picture.h"
#include "output/snapshot.h"
#include "plot/axis.h"
#include "plot/colour.h"
#include "plot/svg.h"
#include "plot/xml.h"

static char *well_formed(const char *name, size_t *size)
{
    struct xml xml;
    struct dm2_error err = {0};
    char *text = scratch_read(name, size);
    enum xml_event event;
    xml_open(&xml, name, text, strlen(text));
    do
        event = xml_next(&xml, &err);
    while (event != XML_DONE && event != XML_ERROR);
    CHECK_STR(err.text, "");
    return text;
}

static size_t count(const char *text, const char *part)
{
    size_t n = 0;
    for (const char *at = text; (at = strstr(at, part)) != NULL; at += strlen(part))
        n++;
    return n;
}

static void check_axis(double low, double high, bool log, bool extend, int about, const char *labels)
{
    struct axis a;
    char all[400] = "";
    axis_make(&a, low, high, log, extend, about);
    for (size_t i = 0; i < a.n_ticks; i++) {
        strcat(all, i == 0 ? "" : " ");
        strcat(all, a.label[i]);
        CHECK(axis_place(&a, a.tick[i]) > -1e-9 && axis_place(&a, a.tick[i]) < 1 + 1e-9);
    }
    CHECK_STR(all, labels);
}

TEST(ticks)
{
    check_axis(0, 5, false, true, 6, "0 1 2 3 4 5");
    check_axis(-0.013, 0.071, false, true, 6, "\u22120.02 0.00 0.02 0.04 0.06 0.08");
    check_axis(-0.013, 0.071, false, false, 6, "0.00 0.02 0.04 0.06");
    check_axis(0.3, 0.3, false, true, 4, "0.1 0.2 0.3 0.4 0.5");
    check_axis(0, 0, false, true, 4, "\u22121.0 \u22120.5 0.0 0.5 1.0");
    check_axis(0, 2.4e-5, false, true, 5, "0.0 0.5 1.0 1.5 2.0 2.5");
    check_axis(0, 3e6, false, true, 3, "0 1 2 3");
    check_axis(7, 3, false, true, 4, "3 4 5 6 7");
    check_axis(2, 3e6, true, true, 8, "1 10 100 1000 10000 10^{5} 10^{6} 10^{7}");
    check_axis(1e-5, 0.02, true, true, 8, "10^{\u22125} 10^{\u22124} 0.001 0.01 0.1");
    check_axis(3, 8, true, true, 8, "5");
    check_axis(1, 20, true, true, 8, "1 2 5 10 20");
}

TEST(shared_factor)
{
    struct axis a;
    char factor[AXIS_LABEL_MAX];
    axis_make(&a, 0, 2.4e-5, false, true, 5);
    axis_factor(&a, factor);
    CHECK_STR(factor, "\u00d710^{\u22125}");
    CHECK_NEAR(a.high, 2.5e-5, 1e-18);
    axis_make(&a, 0, 24, false, true, 5);
    axis_factor(&a, factor);
    CHECK_STR(factor, "");
}

TEST(round_lengths)
{
    CHECK_NEAR(axis_round_below(0.23), 0.2, 1e-15);
    CHECK_NEAR(axis_round_below(0.5), 0.5, 1e-15);
    CHECK_NEAR(axis_round_below(99), 50, 1e-12);
    CHECK_NEAR(axis_round_below(1), 1, 1e-12);
}

static double lightness(const char *colour)
{
    long rgb = strtol(colour + 1, NULL, 16);
    return 0.299 * (double)(rgb >> 16) + 0.587 * (double)(rgb >> 8 & 255) + 0.114 * (double)(rgb & 255);
}

/* The sequential map only gets lighter, the diverging map is lightest in its middle; both end in the
 * tables' colours. */
TEST(colour_maps)
{
    char colour[COLOUR_TEXT], before[COLOUR_TEXT];
    colour_sequential(-1, before);
    CHECK_STR(before, "#440154");
    for (int i = 1; i <= 100; i++) {
        colour_sequential(i / 100.0, colour);
        CHECK(lightness(colour) >= lightness(before));
        memcpy(before, colour, sizeof before);
    }
    CHECK_STR(colour, "#fde725");
    colour_diverging(0.5, colour);
    CHECK_STR(colour, "#dddcdc");
    for (int i = 0; i <= 100; i++) {
        colour_diverging(i / 100.0, before);
        CHECK(lightness(before) <= lightness(colour));
    }
    colour_sequential(NAN, colour);
    CHECK_STR(colour, "#440154");
    colour_category(COLOUR_CATEGORIES, colour);
    colour_category(0, before);
    CHECK_STR(colour, before);
}

TEST(texts_are_escaped)
{
    struct svg svg;
    struct dm2_error err;
    const struct svg_font font = {.size = 10, .anchor = SVG_END};
    CHECK_EQ_INT(svg_create(&svg, scratch_path("t.svg"), 100, 50.5, "a<b", &err), DM2_OK);
    svg_text(&svg, 1, -0.001, &font, "<&\"> 10^{-3} cm\x01");
    CHECK_EQ_INT(svg_commit(&svg, &err), DM2_OK);
    char *text = well_formed("t.svg", NULL);
    CHECK_CONTAINS(text, "viewBox=\"0 0 100 50.5\"");
    CHECK_CONTAINS(text, "<title>a&lt;b</title>");
    CHECK_CONTAINS(text, "x=\"1\" y=\"0\"");
    CHECK_CONTAINS(text, "&lt;&amp;&quot;&gt; 10<tspan font-size=\"7.2\" dy=\"-3.6\">-3</tspan><tspan "
                         "dy=\"3.6\"> </tspan>cm ");
    free(text);
}

static void read_fake(size_t columns, size_t rows, struct vtp *vtp)
{
    struct fake f;
    struct dm2_error err = {0};
    fake_make(&f, columns, rows);
    f.config.output.strain = true;
    uint32_t *fragment = calloc(f.n, sizeof *fragment);
    const struct snapshot s = {&f.config, 200,      f.elements, f.measured, f.n,
                               f.pairs,   f.forces, f.n_pairs,  fragment,   NULL};
    if (snapshot_write_vtp(scratch_path("s.vtp"), &s, &err) != DM2_OK ||
        vtp_read(scratch_path("s.vtp"), vtp, &err) != DM2_OK) {
        printf("%s\n", err.text);
        exit(1);
    }
    free(fragment);
    fake_free(&f);
}

/* Every word for colours gives one disc per element and a well-formed file below the size limit of the
 * paper's case. */
TEST(pictures)
{
    struct vtp vtp;
    struct dm2_error err = {0};
    char words[500];
    read_fake(57, 30, &vtp);
    snprintf(words, sizeof words, "%s", picture_colours());
    char *rest = strstr(words, " body, or ARRAY"); /* the end of the words; then two arrays by their names */
    CHECK(rest != NULL);
    if (rest != NULL)
        strcpy(rest, " body radius velocity:2");
    for (char *word = strtok(words, " "); word != NULL; word = strtok(NULL, " ")) {
        size_t size;
        const struct picture_options options = {
            .colour = word, .links = true, .range = {NAN, NAN}, .title = "A <title>"};
        if (strcmp(word, "phase") == 0 || strcmp(word, "composition") == 0) { /* not in every file */
            CHECK_EQ_INT(picture_write(scratch_path("p.svg"), &vtp, &options, &err), DM2_USAGE);
            CHECK_CONTAINS(err.text, " that the snapshot does not have; it has: id kind");
            err.text[0] = '\0';
            continue;
        }
        CHECK_EQ_INT(picture_write(scratch_path("p.svg"), &vtp, &options, &err), DM2_OK);
        CHECK_STR(err.text, "");
        char *text = well_formed("p.svg", &size);
        CHECK_EQ_INT(count(text, "h0"), vtp.n_points);
        CHECK_CONTAINS(text, "t = 5 \u00b5s, step 200, 1710 elements");
        CHECK_CONTAINS(text, "A &lt;title&gt;");
        CHECK(size < 100000);
        free(text);
    }
    vtp_free(&vtp);
}

TEST(legend_and_scale)
{
    struct vtp vtp;
    struct dm2_error err = {0};
    const struct picture_options options = {.range = {NAN, NAN}};
    read_fake(25, 10, &vtp); /* a domain of 1 x 0.4 cm */
    CHECK_EQ_INT(picture_write(scratch_path("m.svg"), &vtp, &options, &err), DM2_OK);
    char *text = well_formed("m.svg", NULL);
    CHECK_CONTAINS(text, ">nickel</text>");
    CHECK_CONTAINS(text, ">aluminium</text>");
    CHECK_CONTAINS(text, ">2 mm</text>");
    CHECK_CONTAINS(text, "stroke-dasharray"); /* periodic in x */
    CHECK_EQ_INT(count(text, "<circle"), 2);
    free(text);
    vtp_free(&vtp);
}

/* A distant element does not shrink the picture, and is counted. */
TEST(elements_beyond_the_picture)
{
    struct vtp vtp;
    struct dm2_error err = {0};
    const struct picture_options options = {.colour = "vy", .range = {-0.1, 0.1}};
    read_fake(25, 10, &vtp);
    ((double *)vtp.position)[3 * 7] = 4000;
    CHECK_EQ_INT(picture_write(scratch_path("f.svg"), &vtp, &options, &err), DM2_OK);
    char *text = well_formed("f.svg", NULL);
    CHECK_CONTAINS(text, "250 elements (1 beyond the picture)");
    CHECK_EQ_INT(count(text, "h0"), 249);
    CHECK_CONTAINS(text, ">\u22120.10</text>");
    free(text);
    vtp_free(&vtp);
}

TEST(no_elements)
{
    struct vtp vtp;
    struct dm2_error err = {0};
    const struct picture_options options = {.colour = "temperature", .range = {NAN, NAN}};
    read_fake(0, 0, &vtp);
    CHECK_EQ_INT(picture_write(scratch_path("n.svg"), &vtp, &options, &err), DM2_OK);
    char *text = well_formed("n.svg", NULL);
    CHECK_CONTAINS(text, ", 0 elements");
    free(text);
    vtp_free(&vtp);
}

TEST(pictures_refused)
{
    struct vtp vtp;
    struct dm2_error err = {0};
    read_fake(3, 3, &vtp);
    const struct picture_options wrong = {.colour = "mass", .range = {NAN, NAN}};
    CHECK_EQ_INT(picture_write(scratch_path("x.svg"), &vtp, &wrong, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "'mass' is nothing to colour by; choose one of: material velocity");
    const struct picture_options reversed = {.colour = "vy", .range = {1, -1}};
    CHECK_EQ_INT(picture_write(scratch_path("x.svg"), &vtp, &reversed, &err), DM2_USAGE);
    const struct picture_options narrow = {.range = {NAN, NAN}, .width = 60};
    CHECK_EQ_INT(picture_write(scratch_path("x.svg"), &vtp, &narrow, &err), DM2_USAGE);
    const struct picture_options fine = {.range = {NAN, NAN}};
    CHECK_EQ_INT(picture_write(scratch_path("no/x.svg"), &vtp, &fine, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "no/x.svg: cannot create: No such file");
    CHECK(!scratch_exists("x.svg") && !scratch_exists("x.svg.part"));
    vtp_free(&vtp);
}

TEST(charts)
{
    static const double x[] = {0, 1, 2, 3, 4}, y[] = {1, 10, NAN, 1000, -5}, z[] = {2, 2, 2, 2, 2};
    const struct chart_series series[] = {
        {.name = "measured", .x = x, .y = y, .n = 5, .colour = 0, .line = true, .markers = true},
        {.name = "model & more", .x = x, .y = z, .n = 5, .colour = 1, .line = true, .dashed = true},
    };
    struct chart chart = {
        .title = "T", .x_label = "x [us]", .y_label = "y", .log_y = true, .series = series, .n_series = 2};
    struct dm2_error err = {0};
    CHECK_EQ_INT(chart_write(scratch_path("c.svg"), &chart, &err), DM2_OK);
    CHECK_STR(err.text, "");
    char *text = well_formed("c.svg", NULL);
    CHECK_CONTAINS(text, ">model &amp; more</text>");
    CHECK_EQ_INT(count(text, "stroke-dasharray"), 2);   /* the curve and its sample */
    CHECK_EQ_INT(count(text, "a4 4 0 1 0 8 0"), 3 + 1); /* drawable points and the sample */
    CHECK_CONTAINS(text, ">100</text>");
    free(text);
    static const double negative[] = {-1, -2, -3, -4, -5};
    const struct chart_series none = {.name = "n", .x = x, .y = negative, .n = 5, .line = true};
    chart.series = &none;
    chart.n_series = 1;
    CHECK_EQ_INT(chart_write(scratch_path("d.svg"), &chart, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "no point to draw");
    chart.log_y = false;
    chart.width = 60;
    CHECK_EQ_INT(chart_write(scratch_path("d.svg"), &chart, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "no room for its labels");
}

TEST(begin)
{
    scratch_begin();
}

TEST(end)
{
    scratch_end();
}

TEST_MAIN(CASE(begin), CASE(ticks), CASE(shared_factor), CASE(round_lengths), CASE(colour_maps),
          CASE(texts_are_escaped), CASE(pictures), CASE(legend_and_scale), CASE(elements_beyond_the_picture),
          CASE(no_elements), CASE(pictures_refused), CASE(charts), CASE(end))
