/* Writes an invented state as a snapshot, for tests, and for pictures without a run:
 *
 *     fake_snapshot COLUMNS ROWS OUT.vtp|OUT.xyz
 *
 * The state is two plates on a triangular lattice after an impact, of which the upper one is torn. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../unit/fake_state.h"
#include "output/snapshot.h"

static void shape_plates(struct fake *f, size_t columns, size_t rows)
{
    double height = 0.034641 * (double)rows, width = 0.04 * (double)columns;
    for (size_t i = 0; i < f->n; i++) {
        struct element *e = &f->elements[i];
        struct element_measure *m = &f->measured[i];
        size_t column = i % columns, row = i / columns;
        double y = (double)row / (double)rows, x = (double)column / (double)columns;
        double up = (y > 0.27 ? 0.03 : 0) + (y > 0.7 ? 0.05 + 0.02 * sin(3.14159 * x) : 0);
        e->r[0] = 0.02 + 0.04 * (double)column + (row % 2 == 1 ? 0.02 : 0);
        e->r[1] = 0.02 + 0.034641 * (double)row + up;
        e->body = y > 0.27;
        e->kind = (uint16_t)(e->body == 0 ? 0 : (i * 2654435761u >> 7) % 2);
        m->velocity[0] = 0.004 * (x - 0.5);
        m->velocity[1] = y < 0.27 ? -0.004 : 0.02 * y + (y > 0.7 ? 0.018 : 0);
        m->stress[0] = 0.01 * sin(9 * y) * cos(4 * x);
        m->stress[1] = 0.013 * sin(9 * y);
        e->p = -0.01 * sin(9 * y);
        m->temperature = 300 + 60 * exp(-20 * (y - 0.27) * (y - 0.27));
        m->links = (uint32_t)(row == 0 || row + 1 == rows ? 4 : 6);
    }
    f->config.size[0] = width + 0.02;
    f->config.size[1] = height + 0.2;
    f->config.periodic[0] = false;
}

int main(int argc, char **argv)
{
    struct fake f;
    struct dm2_error err = {0};
    size_t columns = argc == 4 ? strtoul(argv[1], NULL, 10) : 0,
           rows = argc == 4 ? strtoul(argv[2], NULL, 10) : 0;
    if (columns == 0 || rows == 0 || columns > 1u << 16 || rows > 1u << 16) {
        fprintf(stderr, "usage: fake_snapshot COLUMNS ROWS OUT.vtp|OUT.xyz\n");
        return 2;
    }
    fake_make(&f, columns, rows);
    shape_plates(&f, columns, rows);
    uint32_t *fragment = calloc(f.n, sizeof *fragment);
    if (fragment == NULL)
        return 1;
    for (size_t i = 0; i < f.n; i++)
        fragment[i] = i / columns > rows / 2;
    f.config.output.strain = true;
    const struct snapshot s = {&f.config, 200,      f.elements, f.measured, f.n,
                               f.pairs,   f.forces, f.n_pairs,  fragment,   NULL};
    size_t length = strlen(argv[3]);
    int xyz = length > 4 && strcmp(argv[3] + length - 4, ".xyz") == 0;
    if ((xyz ? snapshot_write_xyz(argv[3], &s, &err) : snapshot_write_vtp(argv[3], &s, &err)) != DM2_OK) {
        fprintf(stderr, "fake_snapshot: %s\n", err.text);
        return 1;
    }
    free(fragment);
    fake_free(&f);
    return 0;
}
