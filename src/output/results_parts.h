/* The results of a run, for the files that begin them (results_start.c) and add to them (results.c). */
#ifndef DM2_OUTPUT_RESULTS_PARTS_H
#define DM2_OUTPUT_RESULTS_PARTS_H

#include "dm2/output/results.h"

#include "dm2/base/bytes.h"
#include "dm2/base/file.h"
#include "energy_book.h"
#include "history.h"
#include "run_lock.h"
#include "snapshot.h"
#include "stop_watch.h"

struct results {
    char *directory;
    bool made_directory, made_snapshots; /* by this run */
    bool begun;                          /* files of this run are in the directory */
    struct run_lock lock;
    struct bytes_writer log; /* run.log */
    const struct config *config;
    struct measure_scales scales;
    const struct state_origin *origin;
    struct history_tables tables;
    struct energy_book book; /* of the rows of tables.history */
    struct stop_watch stops; /* likewise; not open in a deck without blocks `stop` */
    bool made_final;         /* final.dm2, by this run */
    /* The newest steps that are written; -1: none. */
    int64_t history_step, snapshot_step, profile_step[PROFILE_MAX], crack_step, checkpoint_step;
    struct snapshot_steps series; /* the snapshots that are written, for series.pvd */
};

/* Releases the lock and the memory. */
void results_free(struct results *r);

/* Writes series.pvd in `directory`, of the snapshots in r->series. DM2_IO, DM2_MEMORY. */
enum dm2_status results_write_series(const struct results *r, const char *directory, struct dm2_error *err);

#endif
