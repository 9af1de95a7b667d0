/* The commands of dm2-model. argv0 is the path of dm2-model itself, beside which other programs are found;
 * argv[0] is the name of the command. Each command prints to standard output and returns a status whose
 * text in *err dm2-model prints. */
#ifndef DM2_APP_MODEL_COMMANDS_H
#define DM2_APP_MODEL_COMMANDS_H

#include "dm2/base/status.h"

/* dm2-model predict: T_seq, T_comm, T_dist, speedup and efficiency. */
enum dm2_status model_predict_command(const char *argv0, int argc, char **argv, struct dm2_error *err);

/* dm2-model what-if: other processors and networks, break-even and best number of servers. */
enum dm2_status model_what_if_command(const char *argv0, int argc, char **argv, struct dm2_error *err);

/* dm2-model netbench: the cost of messages between a client and N servers, the paper's Fig. 3. */
enum dm2_status model_netbench_command(const char *argv0, int argc, char **argv, struct dm2_error *err);

/* dm2-model calibrate: measures k, m_N and b_N and writes the calibration file. */
enum dm2_status model_calibrate_command(const char *argv0, int argc, char **argv, struct dm2_error *err);

/* dm2-model compare: measured beside predicted, over the sweep of the paper's section 7.2 or of finished
 * runs. */
enum dm2_status model_compare_command(const char *argv0, int argc, char **argv, struct dm2_error *err);

#endif
