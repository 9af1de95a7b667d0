/* A made-up state for the tests of files with states: a lattice of two materials, linked along rows and
 * columns, whose elements all have different values. */
#ifndef DM2_TESTS_FAKE_STATE_H
#define DM2_TESTS_FAKE_STATE_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/deck/config.h"
#include "dm2/engine/element.h"

struct fake {
    struct config config;
    struct material_config materials[2];
    struct body_config bodies[2];
    struct probe_config probes[2];
    size_t n, n_pairs;
    struct element *elements;
    struct element_measure *measured;
    struct pair_record *pairs;
    struct pair_measure *forces;
};

static inline void fake_element(struct element *e, struct element_measure *m, size_t i, size_t column,
                                size_t row)
{
    *e = (struct element){
        .id = (uint32_t)i,
        .grain = (uint32_t)(i / 7),
        .body = (uint16_t)(row % 2),
        .kind = (uint16_t)(i % 2),
        .flags = (uint8_t)(i % 5 == 0),
        .probes = (uint8_t)(i % 4),
        .radius = 0.02,
        .mass = 0.011 + 1e-6 * (double)i,
        .r = {0.02 + 0.04 * (double)column, 0.02 + 0.04 * (double)row},
        .v = {0.001 / (double)(i + 3), -0.04 + 0.0001 * (double)row},
        .w = 0.3 / (double)(i + 1),
        .heat = 1e-9 * (double)i,
        .p = 1e-3 / (double)(i + 7),
        .work = 1e-4 * (double)i,
        .strain = {1e-3 * (double)i, -1e-3, 2e-5 / (double)(i + 1)},
        .image = {(int32_t)(i % 3) - 1, 0},
        .bonds = 6,
        .was = (uint16_t)(i % 2),
        .share = {0.5, 0.25 / (double)(i + 1)},
        .moved = 0 - 1e-7 * (double)i, /* never -0 */
        .damped = 3e-5 * (double)i,
    };
    *m = (struct element_measure){
        .stress = {1e-4 * (double)i, -2e-4 / (double)(i + 1), 1e-5},
        .velocity = {e->v[0] * 0.5, e->v[1] * 0.25},
        .temperature = 300 + (double)i / 3,
        .links = (uint32_t)(i % 7),
        .contacts = (uint32_t)(i % 3),
    };
}

/* columns x rows elements in a domain of the same size, periodic in x. The caller frees *f with fake_free. */
static inline void fake_make(struct fake *f, size_t columns, size_t rows)
{
    memset(f, 0, sizeof *f);
    f->n = columns * rows;
    f->elements = calloc(f->n + 1, sizeof *f->elements);
    f->measured = calloc(f->n + 1, sizeof *f->measured);
    f->pairs = calloc(2 * f->n + 1, sizeof *f->pairs);
    f->forces = calloc(2 * f->n + 1, sizeof *f->forces);
    for (size_t k = 0; k < 2 * f->n; k++) {
        double x = (double)k;
        f->forces[k] = (struct pair_measure){{0.25 * x, -0.5 / (x + 1)}, 1e-3 * x, -1e-5 / (x + 3)};
    }
    for (size_t i = 0; i < f->n; i++) {
        size_t column = i % columns, row = i / columns;
        fake_element(&f->elements[i], &f->measured[i], i, column, row);
        if (column + 1 < columns)
            f->pairs[f->n_pairs++] =
                (struct pair_record){(uint32_t)i, (uint32_t)i + 1, 1, 1e-5 / (double)(i + 1), 0.5e-7};
        else if (columns > 2 && row + 1 == rows) /* not linked: no line */
            continue;
        if (row + 1 < rows)
            f->pairs[f->n_pairs++] =
                (struct pair_record){(uint32_t)i, (uint32_t)(i + columns), (uint32_t)(i % 3 != 0), 0, -1e-8};
    }
    strcpy(f->materials[0].name, "nickel");
    strcpy(f->materials[1].name, "aluminium");
    strcpy(f->bodies[0].name, "flyer");
    strcpy(f->bodies[1].name, "target");
    strcpy(f->probes[0].name, "surface");
    strcpy(f->probes[1].name, "spall");
    for (int k = 0; k < 2; k++) {
        f->probes[k].mover = -1;
        f->probes[k].bit = k;
        f->probes[k].report = 1u << REPORT_POSITION | 1u << REPORT_VELOCITY;
    }
    f->config.size[0] = 0.04 * (double)columns;
    f->config.size[1] = 0.04 * (double)rows;
    f->config.periodic[0] = true;
    f->config.dt = 0.025;
    f->config.steps = 200;
    f->config.n_materials = f->config.n_bodies = f->config.n_probes = 2;
    f->config.materials = f->materials;
    f->config.bodies = f->bodies;
    f->config.probes = f->probes;
    f->config.output.history_every = 10;
    f->config.output.vtp = true;
    f->config.output.fields = UINT32_MAX;
}

static inline void fake_free(struct fake *f)
{
    free(f->elements);
    free(f->measured);
    free(f->pairs);
    free(f->forces);
}

#endif
