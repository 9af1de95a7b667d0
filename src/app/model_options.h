/* What the commands of dm2-model share: the options that choose constants, problem and form of the model. */
#ifndef DM2_APP_MODEL_OPTIONS_H
#define DM2_APP_MODEL_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"
#include "dm2/performance/predict.h"
#include "options.h"

enum { MODEL_OPTIONS = 24, MODEL_CONSTANTS = 6 };

struct model_options {
    /* As given on the command line; NULL where not. */
    const char *preset, *aspect, *constants[MODEL_CONSTANTS], *m, *b;
    const char *transport, *count, *overlap, *migrants, *migrant_bytes, *client_rate, *periodic;
    struct option_list n_texts, servers_texts, operands;
    bool general, slowest, csv, help, version;

    /* What they mean, after model_options_finish. */
    struct perf perf;
    struct predict_options form;
    double s;
    double *n; /* n_count of them; none given: none */
    size_t n_count;
    int *servers; /* the same */
    size_t servers_count;
};

/* Writes MODEL_OPTIONS entries to `table` that put what is given into *o, which it clears. */
void model_options_start(struct model_options *o, struct option *table);

/* After options_parse: reads every text. DM2_USAGE that names the option: a malformed number, an unknown
 * word, operands, an option without the one that it belongs to, a preset that is neither known nor a file;
 * and what perf_check and calibration_read refuse. With --help or --version nothing is read. */
enum dm2_status model_options_finish(struct model_options *o, struct dm2_error *err);

void model_options_free(struct model_options *o);

/* A number that an option needs: finite and above 0. DM2_USAGE. */
enum dm2_status model_option_number(const char *name, const char *text, double *out, struct dm2_error *err);

/* Flushes standard output. DM2_IO where not everything could be written. */
enum dm2_status model_output_end(struct dm2_error *err);

#endif
