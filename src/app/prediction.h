/* Predicted beside measured, for a run that has just ended or one that is read back from its directory. */
#ifndef DM2_APP_PREDICTION_H
#define DM2_APP_PREDICTION_H

#include <stdbool.h>

#include "dm2/base/status.h"
#include "dm2/cluster/report.h"
#include "dm2/performance/calibration.h"
#include "dm2/performance/explain.h"
#include "network.h"

enum { PREDICTION_TEXT = 1024 };

/* The calibration file: `option` (--calibration), else the environment's DM2_CALIBRATION, else
 * CALIBRATION_FILE where it exists. *path gets its name, empty where there is none: then *out is not set. A
 * file that was asked for has to be there and be right; for one that merely lies there *note tells why it is
 * not used. DM2_USAGE, DM2_DECK, DM2_IO. */
enum dm2_status prediction_calibration(const char *option, struct calibration *out,
                                       char path[PREDICTION_TEXT], char note[PREDICTION_TEXT],
                                       struct dm2_error *err);

/* The constants for one run. */
struct prediction_basis {
    double t_seq;     /* s per step */
    double work;      /* what the servers compute together, s per step */
    double m, b;      /* m_N, b_N */
    int processors;   /* that the servers have together */
    bool apart;       /* the client has one of its own */
    char source[320]; /* where the constants come from, for people */
};

/* From a calibration: k n^2/c with the run's n and c, eq. (11); T_seq with the k of n elements on one
 * processor, the work of the servers with that of their part on each of the processors that are busy.
 * `cores`: the processors of the machine that all servers are on, which share its memory; 0 where each has a
 * machine of its own. */
void prediction_calibrated(const struct calibration *c, const char *path, const struct run_report *r,
                           int cores, struct prediction_basis *out);

/* From the run itself: T_seq is the processor seconds that its servers computed, together; m and b are of a
 * few round trips at its start. `cores` as above. */
void prediction_estimated(const struct network_line *line, const struct run_report *r, int cores,
                          struct prediction_basis *out);

/* False where the run timed no step. */
bool prediction_explain(const struct run_report *r, const struct prediction_basis *basis,
                        struct explanation *out);

/* Two or three lines for people: predicted, measured, speedup. */
void prediction_text(const struct explanation *e, const struct prediction_basis *basis,
                     const struct run_report *r, char out[PREDICTION_TEXT]);

#endif
