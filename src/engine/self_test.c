/* The built-in deck has the operations whose rounding a compiler could change: sites of a lattice turned by
 * an angle, grains of a polycrystal, first links, and the forces of linked and unlinked pairs with damping,
 * friction, yield, heat. */
#include "dm2/engine/self_test.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/fingerprint.h"
#include "dm2/base/mem.h"
#include "dm2/deck/deck.h"
#include "dm2/engine/subdomain.h"

static const char DECK[] =
    "let d = 0.04 cm\n"
    "domain { size = 0.8 cm, 0.4 cm; r_c = 2.5*d; delta_r = 0.25*d }\n"
    "time { dt = 0.003 us; steps = 5 }\n"
    "material a { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489; tensile = 1 GPa; yield = 0.1 GPa\n"
    "             cp = 0.385 J/g/K; kappa = 401 W/m/K }\n"
    "material b { rho0 = 2.7 g/cm3; c0 = 5.35 km/s; s = 1.34; tensile = 1 GPa\n"
    "             cp = 0.9 J/g/K; kappa = 237 W/m/K }\n"
    "interaction { zeta = 0.1; kt_ratio = 0.3; ct_ratio = 0.05; mu = 0.2 }\n"
    "interface grain { linked = yes; tensile = 0.5 GPa }\n"
    "body left { shape = disc 0.2 cm, 0.2 cm, 0.147 cm; spacing = d; angle = 17 deg; material = a\n"
    "            velocity = 0.04, 0.01; jitter = 0.001; temperature = 350 }\n"
    "body right { shape = rectangle 0.36 cm, 0.06 cm, 0.68 cm, 0.36 cm; structure = polycrystal\n"
    "             grain_size = 0.16 cm; spacing = d; material = b; seed = 3; velocity = -0.04, 0 }\n";

enum { STEPS = 5 };

static const char ADVICE[] = "build with the Makefile, without flags for fast maths, in CFLAGS or LDFLAGS";

/* --- the hash --- */

static uint64_t mix(uint64_t h, uint64_t value)
{
    h = (h ^ value) * 0x9e3779b97f4a7c15U;
    return h ^ h >> 29;
}

/* Both zeros are the same value. */
static uint64_t mix_double(uint64_t h, double value)
{
    uint64_t bits;
    value += 0.0;
    memcpy(&bits, &value, sizeof bits);
    return mix(h, bits);
}

/* Mixes the elements and pairs of a subdomain into *hash. */
static enum dm2_status mix_state(const struct subdomain *sd, uint64_t *hash, struct dm2_error *err)
{
    size_t n = subdomain_owned(sd), n_pairs = 0;
    struct pair_record *pairs = NULL;
    struct element *elements = mem_alloc(n, sizeof *elements);
    if (elements == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %zu elements", n);
    enum dm2_status status = subdomain_collect(sd, elements, NULL, err);
    if (status == DM2_OK)
        status = subdomain_collect_pairs(sd, &pairs, &n_pairs, err);
    uint64_t h = mix(*hash, n);
    for (size_t k = 0; k < n && status == DM2_OK; k++) {
        const struct element *e = &elements[k];
        const double values[] = {e->r[0], e->r[1], e->v[0], e->v[1], e->w, e->heat, e->p, e->mass};
        h = mix(h, (uint64_t)e->grain << 32 | e->id);
        for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
            h = mix_double(h, values[i]);
    }
    for (size_t k = 0; k < n_pairs && status == DM2_OK; k++) {
        h = mix(mix(h, (uint64_t)pairs[k].id_a << 32 | pairs[k].id_b), pairs[k].linked);
        h = mix_double(mix_double(h, pairs[k].stretch), pairs[k].spring);
    }
    free(elements);
    free(pairs);
    *hash = h;
    return status;
}

/* --- the run --- */

static enum dm2_status run_steps(const struct model *model, uint64_t *hash, struct dm2_error *err)
{
    const struct grid *grid = model_grid(model);
    uint16_t *owner = mem_zalloc((size_t)grid->cx * (size_t)grid->cy, sizeof *owner);
    const struct domain_map map = {.grid = grid, .ranks = 1, .owner = owner};
    struct subdomain *sd = NULL;
    struct parcel parcel;
    double dmax;
    if (owner == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d x %d cells", grid->cx, grid->cy);
    enum dm2_status status = subdomain_create(model, &map, 0, &sd, err);
    if (status == DM2_OK)
        status = mix_state(sd, hash, err);
    for (int step = 0; step < STEPS && status == DM2_OK; step++) {
        status = subdomain_forces(sd, true, err);
        if (status == DM2_OK)
            status = subdomain_move(sd, &dmax, NULL, err);
        if (status == DM2_OK)
            status = subdomain_sort_out(sd, &parcel, err);
        if (status == DM2_OK)
            status = subdomain_take_in(sd, &parcel, 1, err);
    }
    if (status == DM2_OK)
        status = mix_state(sd, hash, err);
    subdomain_free(sd);
    free(owner);
    return status;
}

enum dm2_status self_test_compute(uint64_t *fingerprint, struct dm2_error *err)
{
    char name[] = "self-test", text[sizeof DECK];
    struct deck_text only = {.name = name, .text = text, .length = sizeof DECK - 1};
    const struct deck_source source = {.texts = &only, .n_texts = 1, .steps = -1};
    struct config config;
    struct deck_report report;
    struct model *model = NULL;
    memcpy(text, DECK, sizeof DECK);
    *fingerprint = fingerprint_compute();
    enum dm2_status status = deck_load(&source, &config, &report);
    if (status != DM2_OK) {
        (void)dm2_fail(err, status, "the deck of the self-test has errors: %.500s", report.text);
        deck_report_free(&report);
        return status;
    }
    deck_report_free(&report);
    status = model_build(&config, &model, err);
    if (status == DM2_OK)
        status = run_steps(model, fingerprint, err);
    model_free(model);
    config_free(&config);
    return status;
}

enum dm2_status self_test_check(struct dm2_error *err)
{
    uint64_t found = 0;
    struct dm2_error why = {0};
    enum dm2_status status = self_test_compute(&found, &why);
    if (status == DM2_OK && found == SELF_TEST_FINGERPRINT)
        return DM2_OK;
    if (status == DM2_MEMORY)
        return dm2_fail(err, status, "%s", why.text);
    if (status == DM2_OK)
        (void)snprintf(why.text, sizeof why.text, "its fingerprint is %016" PRIx64, found);
    return dm2_fail(err, DM2_PROTOCOL,
                    "this build does not compute as IEEE 754 says: %.350s, %016" PRIx64 " is expected: %s",
                    why.text, (uint64_t)SELF_TEST_FINGERPRINT, ADVICE);
}
