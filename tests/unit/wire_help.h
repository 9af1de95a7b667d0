/* Measures and cracks for the tests of messages. */
#ifndef DM2_TESTS_WIRE_HELP_H
#define DM2_TESTS_WIRE_HELP_H

#include "check.h"

#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"

static inline struct measures some_measures(void)
{
    struct measures m;
    measures_clear(&m);
    m.dt_share = 0.75;
    m.compression = 0.0625;
    (void)exact_add(&m.kinetic, 1.25, 40);
    (void)exact_add(&m.damped, 0.5, 40);
    (void)exact_add(&m.momentum[1], -3.5, 40);
    m.elements = 17;
    m.pairs = 40;
    m.free_elements = 15;
    m.loaded_pairs = 39;
    (void)exact_add(&m.resultants, 1.5, 40);
    (void)exact_add(&m.magnitudes, 2.5, 40);
    (void)exact_add(&m.fabric[0], 0.5, 40);
    (void)exact_add(&m.fabric[1], -0.5, 40);
    m.n_probes = PROBE_MAX;
    for (size_t k = 0; k < PROBE_MAX; k++)
        m.probe[k] = (struct probe_sums){.needs = (uint32_t)(k * 0x9e37U) & ((1u << PROBE_SUMS) - 1u)};
    m.probe[PROBE_MAX - 1].count = 3;
    m.probe[PROBE_MAX - 1].needs = 1u << PROBE_FY;
    (void)exact_add(&m.probe[PROBE_MAX - 1].sum[PROBE_FY], -1.0, 40);
    return m;
}

static const struct crack some_cracks[2] = {
    {.id_a = 3, .id_b = 9, .r = {0.5, -1.25}, .energy = 2e-7, .mode = CRACK_SHEARED, .grains = 2},
    {.id_a = 4, .id_b = 5, .r = {0.25, 0.0}, .energy = -1e-9, .mode = CRACK_PULLED, .grains = 1}};

/* Do the bytes of a message that came hold the two cracks? */
static inline bool same_cracks(const struct crack_part *part)
{
    struct bytes_reader r = bytes_reader_of(part->bytes, part->n * WIRE_CRACK);
    for (size_t k = 0; k < 2; k++) {
        struct crack c;
        const struct crack *want = &some_cracks[k];
        wire_get_crack(&r, 10, &c);
        if (c.id_a != want->id_a || c.id_b != want->id_b || c.r[0] != want->r[0] || c.r[1] != want->r[1] ||
            c.energy != want->energy || c.mode != want->mode || c.grains != want->grains)
            return false;
    }
    return part->n == 2 && bytes_done(&r);
}

#endif
