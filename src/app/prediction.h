/* Predicted beside measured, for a run that has just ended or a run that is read from its directory. */
#ifndef DM2_APP_PREDICTION_H
#define DM2_APP_PREDICTION_H

#include <stdbool.h>

#include "dm2/base/status.h"
#include "dm2/cluster/report.h"
#include "dm2/performance/calibration.h"
#include "dm2/performance/explain.h"
#include "network.h"

enum { PREDICTION_TEXT = 1024 };

/* Reads the calibration file: `option` (--calibration), else the environment's DM2_CALIBRATION, else
 * CALIBRATION_FILE where it exists. *path gets its name; empty: there is none, and *out is not set. A file
 * that the option or the environment names must be readable and valid; where CALIBRATION_FILE is not
 * usable, *note gives the reason. DM2_USAGE, DM2_DECK, DM2_IO. */
enum dm2_status prediction_calibration(const char *option, struct calibration *out,
                                       char path[PREDICTION_TEXT], char note[PREDICTION_TEXT],
                                       struct dm2_error *err);

/* The constants for one run. */
struct prediction_basis {
    double t_seq;     /* s per step */
    double work;      /* computing of all servers together, s per step */
    double m, b;      /* m_N, b_N */
    int processors;   /* of all servers together */
    bool apart;       /* the client has a processor of its own */
    char source[320]; /* origin of the constants, for users */
};

/* The basis from a calibration: k n^2/c with the run's n and c, eq. (11). T_seq uses the k of n elements
 * on one processor, `work` the k of the elements per busy processor. `cores`: the processors of the
 * machine that all servers are on, which share its memory; 0 where each server has a machine of its own. */
void prediction_calibrated(const struct calibration *c, const char *path, const struct run_report *r,
                           int cores, struct prediction_basis *out);

/* The basis from the run itself: T_seq is the sum of the processor seconds per step that its servers
 * computed; m and b come from a few round trips at its start. `cores` as above. */
void prediction_estimated(const struct network_line *line, const struct run_report *r, int cores,
                          struct prediction_basis *out);

/* Explains the run into *out. False where the run timed no step, or without memory. */
bool prediction_explain(const struct run_report *r, const struct prediction_basis *basis,
                        struct explanation *out);

/* Writes three lines for users: predicted, measured, speedup. */
void prediction_text(const struct explanation *e, const struct prediction_basis *basis,
                     const struct run_report *r, char out[PREDICTION_TEXT]);

#endif
