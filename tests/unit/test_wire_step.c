/* STEP messages, with measures and cracks: round trips, and what no reader may take. */
#include "check.h"
#include "wire_help.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"

static void check_measures(const struct measures *in, const struct measures *out)
{
    CHECK(memcmp(&in->kinetic, &out->kinetic, sizeof in->kinetic) == 0);
    CHECK(memcmp(&in->damped, &out->damped, sizeof in->damped) == 0);
    CHECK_NEAR(out->dt_share, in->dt_share, 0);
    CHECK_NEAR(out->compression, in->compression, 0);
    CHECK(in->pairs == 40 && in->free_elements == 15 && in->loaded_pairs == 39);
    CHECK(memcmp(&in->fabric, &out->fabric, sizeof in->fabric) == 0);
    CHECK(memcmp(&in->resultants, &out->resultants, sizeof in->resultants) == 0);
    CHECK(memcmp(&in->magnitudes, &out->magnitudes, sizeof in->magnitudes) == 0);
    for (size_t k = 0; k < PROBE_MAX; k++) {
        CHECK(in->probe[k].needs == out->probe[k].needs && in->probe[k].count == out->probe[k].count);
        CHECK(memcmp(&in->probe[k].sum, &out->probe[k].sum, sizeof in->probe[k].sum) == 0);
    }
    CHECK_SAME_BITS(in->p_min, INFINITY);
    CHECK_EQ_INT(in->n_probes, PROBE_MAX);
}

TEST(measures_of_probes_that_no_deck_has)
{
    struct bytes_writer w = {0};
    struct measures m = some_measures(), in;
    m.n_probes = 1;
    m.probe[0] = (struct probe_sums){.needs = 1u << (PROBE_SUMS - 1)};
    for (int wrong = 0; wrong < 3; wrong++) {
        bytes_clear(&w);
        m.probe[0].needs = wrong == 1 ? 1u << PROBE_SUMS : 1u << (PROBE_SUMS - 1);
        wire_put_measures(&w, &m);
        if (wrong == 2)
            w.data[WIRE_MEASURES - 2] = PROBE_MAX + 1;
        struct bytes_reader r = bytes_reader_of(w.data, w.length);
        wire_get_measures(&r, &in);
        CHECK(r.failed == (wrong != 0));
        CHECK(wrong != 0 || (bytes_done(&r) && w.length == WIRE_MEASURES + 12 + 16));
    }
    bytes_free(&w);
}

TEST(a_crack_that_cannot_be)
{
    const struct crack wrong[] = {{.id_a = 5, .id_b = 5, .grains = 1},
                                  {.id_a = 5, .id_b = 10, .grains = 1},
                                  {.id_a = 1, .id_b = 2, .grains = 0},
                                  {.id_a = 1, .id_b = 2, .grains = 3},
                                  {.id_a = 1, .id_b = 2, .grains = 1, .mode = CRACK_MODES},
                                  {.id_a = 1, .id_b = 2, .grains = 1, .r = {NAN, 0}},
                                  {.id_a = 1, .id_b = 2, .grains = 1, .energy = INFINITY}};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        struct bytes_writer w = {0};
        struct crack c;
        wire_put_crack(&w, &wrong[k]);
        CHECK_EQ_INT(w.length, WIRE_CRACK);
        struct bytes_reader r = bytes_reader_of(w.data, w.length);
        wire_get_crack(&r, 10, &c);
        CHECK(r.failed);
        bytes_free(&w);
    }
}

TEST(a_step_message_round_trip)
{
    struct bytes_writer w = {0};
    struct step_message out = {.step = 12,
                               .rebuild = true,
                               .owned = 40,
                               .migrants = 2,
                               .dmax = 0.5,
                               .busy = 0.001,
                               .measured = true,
                               .hashed = true,
                               .surveyed = true,
                               .spread = {.low = {-1.5, INFINITY},
                                          .high = {2.5, -INFINITY},
                                          .most = 3.5,
                                          .close = INFINITY},
                               .measures = some_measures(),
                               .cracks = {.n = 2, .items = some_cracks},
                               .hash = 0xfeedU,
                               .n_segments = 0},
                        in = {0};
    message_put_step(&w, &out);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_step(&r, &in);
    CHECK(bytes_done(&r));
    CHECK(in.step == 12 && in.rebuild && in.owned == 40 && in.migrants == 2 && in.measured && in.hashed &&
          in.hash == 0xfeedU);
    CHECK_SAME_BITS(in.dmax, 0.5);
    CHECK(in.surveyed && memcmp(&in.spread, &out.spread, sizeof in.spread) == 0);
    check_measures(&in.measures, &out.measures);
    CHECK(same_cracks(&in.cracks));
    for (size_t n = 0; n < w.length; n++) {
        r = bytes_reader_of(w.data, n);
        message_get_step(&r, &in);
        CHECK(r.failed);
    }
    const struct spread wrong[] = {{.low = {NAN, 0}}, {.high = {0, NAN}}, {.low = {1, 0}},
                                   {.most = -1},      {.close = -1},      {.close = NAN}};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        bytes_clear(&w);
        out.spread = wrong[k];
        message_put_step(&w, &out);
        r = bytes_reader_of(w.data, w.length);
        message_get_step(&r, &in);
        CHECK(r.failed);
    }
    bytes_free(&w);
}

TEST(a_step_message_without_a_number)
{
    struct bytes_writer w = {0};
    struct step_message out = {.step = 12, .dmax = NAN}, in;
    message_put_step(&w, &out);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_step(&r, &in);
    CHECK(r.failed);
    bytes_free(&w);
}

TEST_MAIN(CASE(measures_of_probes_that_no_deck_has), CASE(a_crack_that_cannot_be),
          CASE(a_step_message_round_trip), CASE(a_step_message_without_a_number))
