/* The calibration file: the constants of the performance model as measured on one cluster. `dm2-model
 * calibrate` writes the file, `--preset here` reads it. docs/performance-model.md describes the format. */
#ifndef DM2_PERFORMANCE_CALIBRATION_H
#define DM2_PERFORMANCE_CALIBRATION_H

#include "dm2/base/status.h"
#include "dm2/performance/equations.h"

enum { CALIBRATION_FORMAT = 2, CALIBRATION_TEXT_MAX = 256, CALIBRATION_BYTES_MAX = 65536 };

/* The file in the working directory; the environment variable DM2_CALIBRATION names another file. */
#define CALIBRATION_FILE "dm2-calibration.csv"

struct calibration {
    char host[CALIBRATION_TEXT_MAX];    /* host of the client */
    char version[CALIBRATION_TEXT_MAX]; /* version of dm2 */
    struct perf perf;
    double k_spread;                   /* standard deviation of k over the runs, s */
    double residual[PERF_NETWORK_MAX]; /* residual of the line m x + b, for each row of perf.network, s */
};

/* Writes the file atomically. DM2_USAGE: constants that perf_check refuses, a spread or residual that is
 * negative or not finite, a host or version that is empty or has control characters. DM2_IO, DM2_MEMORY. */
enum dm2_status calibration_write(const char *path, const struct calibration *c, struct dm2_error *err);

/* Reads a file that calibration_write wrote on this host with this version. DM2_IO: the file cannot be read
 * or is larger than CALIBRATION_BYTES_MAX. DM2_DECK with path:line: another format, an unknown, missing or
 * repeated quantity, another unit, a field that is not a number or is out of range. DM2_USAGE: another host
 * or version; the message names both and the remedy. DM2_MEMORY. */
enum dm2_status calibration_read(const char *path, const char *host, const char *version,
                                 struct calibration *out, struct dm2_error *err);

/* The same from text[0..length); messages call the text `name`. */
enum dm2_status calibration_parse(const char *name, const char *text, size_t length, const char *host,
                                  const char *version, struct calibration *out, struct dm2_error *err);

#endif
