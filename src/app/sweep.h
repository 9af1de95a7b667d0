/* Runs made for their timing: the sweep of the paper's section 7.2, and the reports in finished run
 * directories. */
#ifndef DM2_APP_SWEEP_H
#define DM2_APP_SWEEP_H

#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/report.h"
#include "server_choice.h"

enum { SWEEP_OPTIONS = 5, SWEEP_SIZES = 32, SWEEP_PATH = 1024 };

struct sweep {
    const char *deck, *directory;
    struct option_list n_texts;
    int64_t steps, runs;
    double n[SWEEP_SIZES];
    int sizes;
    const struct server_choice *servers;
    const char *argv0;
    int cancel;
    char deck_path[SWEEP_PATH];
};

/* Clears *s and writes SWEEP_OPTIONS entries to `table`. */
void sweep_start(struct sweep *s, struct option *table);

/* Reads the options after options_parse. Sizes: of --n, else n[0 .. sizes). Deck:
 * --deck, or timing.dm2 below the program's ../input or ../share/dm2/input, or ./input. DM2_USAGE. */
enum dm2_status sweep_finish(struct sweep *s, const double *n, int sizes, const char *argv0,
                             struct dm2_error *err);
void sweep_free(struct sweep *s);

/* Makes one run of n elements on `servers` servers (0: dm2-seq), the `run`th, and reads its report into
 * *out, whose servers are malloc'd. The run directory, below s->directory, keeps run.log and timing.csv.
 * DM2_IO, DM2_INTERRUPTED, DM2_MEMORY and the errors of sweep_read. */
enum dm2_status sweep_run(const struct sweep *s, double n, int servers, int run, struct run_report *out,
                          struct dm2_error *err);

/* Reads the report of a finished run: elements, steps, times, servers with their cells, elements and
 * times; `program` is "dm2-seq" or "dm2-client". The caller frees out->servers. DM2_IO, DM2_MEMORY;
 * DM2_USAGE where the directory holds no run of this version. */
enum dm2_status sweep_read(const char *directory, struct run_report *out, struct dm2_error *err);

#endif
