/* The calibration file: the model's constants as measured on one cluster. `dm2-model calibrate` writes it,
 * `--preset here` reads it. docs/performance-model.md describes the format. */
#ifndef DM2_PERFORMANCE_CALIBRATION_H
#define DM2_PERFORMANCE_CALIBRATION_H

#include "dm2/base/status.h"
#include "dm2/performance/equations.h"

enum { CALIBRATION_FORMAT = 2, CALIBRATION_TEXT_MAX = 256, CALIBRATION_BYTES_MAX = 65536 };

/* In the working directory; the environment's DM2_CALIBRATION names another one. */
#define CALIBRATION_FILE "dm2-calibration.csv"

struct calibration {
    char host[CALIBRATION_TEXT_MAX];    /* where the client ran */
    char version[CALIBRATION_TEXT_MAX]; /* of dm2 */
    struct perf perf;
    double k_spread;                   /* standard deviation of k over the runs, s */
    double residual[PERF_NETWORK_MAX]; /* of the line m x + b, per row of perf.network, s */
};

/* Writes the file atomically. DM2_USAGE: constants that perf_check refuses, a spread or residual that is
 * negative or not finite, a host or version that is empty or has control characters. DM2_IO, DM2_MEMORY. */
enum dm2_status calibration_write(const char *path, const struct calibration *c, struct dm2_error *err);

/* Reads a file that calibration_write wrote for this host and version. DM2_IO where it cannot be read or is
 * larger than CALIBRATION_BYTES_MAX. DM2_DECK with path:line: another format, an unknown, missing or repeated
 * quantity, another unit, a field that is not a number or out of range. DM2_USAGE: the file is of another
 * host or version; it names both and says what to do. DM2_MEMORY. */
enum dm2_status calibration_read(const char *path, const char *host, const char *version,
                                 struct calibration *out, struct dm2_error *err);

/* The same from text[0..length); `name` is what messages call it. */
enum dm2_status calibration_parse(const char *name, const char *text, size_t length, const char *host,
                                  const char *version, struct calibration *out, struct dm2_error *err);

#endif
