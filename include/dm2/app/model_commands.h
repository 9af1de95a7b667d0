/* The commands of dm2-model: argv[0] is the command's name. Each prints to standard output and returns a
 * status whose text in *err is for dm2-model to print. */
#ifndef DM2_APP_MODEL_COMMANDS_H
#define DM2_APP_MODEL_COMMANDS_H

#include "dm2/base/status.h"

/* dm2-model predict: T_seq, T_comm, T_dist, speedup and efficiency. */
enum dm2_status model_predict_command(int argc, char **argv, struct dm2_error *err);

/* dm2-model what-if: other processors and networks, break-even and best number of servers. */
enum dm2_status model_what_if_command(int argc, char **argv, struct dm2_error *err);

#endif
