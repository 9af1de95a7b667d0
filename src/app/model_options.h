/* The options that the commands of dm2-model share: constants, problem and form of the model. */
#ifndef DM2_APP_MODEL_OPTIONS_H
#define DM2_APP_MODEL_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"
#include "dm2/performance/predict.h"
#include "options.h"

enum { MODEL_OPTIONS = 24, MODEL_CONSTANTS = 6 };

struct model_options {
    /* As given on the command line; NULL: not given. */
    const char *preset, *aspect, *constants[MODEL_CONSTANTS], *m, *b;
    const char *transport, *count, *overlap, *migrants, *migrant_bytes, *client_rate, *periodic;
    struct option_list n_texts, servers_texts, operands;
    bool general, slowest, csv, help, version;

    /* The values of these texts, after model_options_finish. */
    struct perf perf;
    struct predict_options form;
    double s;  /* width of the domain to its height */
    double *n; /* the n_count numbers of elements that are given */
    size_t n_count;
    int *servers; /* the servers_count numbers of servers that are given */
    size_t servers_count;
};

/* Clears *o and writes MODEL_OPTIONS entries to `table` whose targets are in *o. */
void model_options_start(struct model_options *o, struct option *table);

/* Reads every text after options_parse. DM2_USAGE that names the option: a malformed number, an unknown
 * word, operands, an option without the option that it requires, a preset that is neither known nor a
 * file; and the errors of perf_check and calibration_read. DM2_MEMORY, DM2_IO. With --help or --version
 * nothing is read. */
enum dm2_status model_options_finish(struct model_options *o, struct dm2_error *err);

void model_options_free(struct model_options *o);

/* Reads the number of the option `name`: finite and above 0. DM2_USAGE. */
enum dm2_status model_option_number(const char *name, const char *text, double *out, struct dm2_error *err);

#endif
