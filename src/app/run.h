/* The common part of dm2-seq and dm2-client: options, loading the deck, the run directory, --check. */
#ifndef DM2_APP_RUN_H
#define DM2_APP_RUN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "dm2/base/sha256.h"
#include "dm2/base/status.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/deck/config.h"
#include "dm2/deck/deck.h"
#include "dm2/engine/overlap.h"
#include "dm2/engine/model.h"
#include "dm2/output/results.h"
#include "dm2/output/state.h"
#include "options.h"
#include "progress.h"

struct run_options {
    const char *program;
    int argc; /* the command line, which session_fail turns into another that goes on */
    char **argv;
    struct option_list operands; /* the deck */
    const char *deck;
    const char *directory; /* -o; NULL: run_directory_default */
    struct option_list defines;
    int64_t steps;            /* -1: as the deck says */
    int64_t hash_every;       /* 0: never */
    int64_t checkpoint_every; /* -1: as the deck says; 0: never */
    const char *restart;      /* a state file to continue from, or "auto"; NULL: none */
    bool automatic;           /* --restart auto */
    const char *start;        /* the state of another deck to begin from; NULL: as the deck says */
    const char *progress_text;
    enum progress_mode progress;
    bool overwrite, check, quiet, verbose, help, version;
};

enum { RUN_OPTIONS = 14 };

/* Sets the defaults in *o and writes the entries of the options above to `table`. A program puts its own
 * entries before or after them. */
void run_options_start(struct run_options *o, const char *program, int argc, char **argv,
                       struct option table[RUN_OPTIONS]);

/* Checks the options after options_parse: one deck, a known --progress. With --help or --version nothing
 * is checked. DM2_USAGE. */
enum dm2_status run_options_finish(struct run_options *o, struct dm2_error *err);
void run_options_free(struct run_options *o);

/* A loaded deck. */
struct run {
    struct deck_source source;
    struct config config;
    bool loaded; /* config_free is due */
    struct model *model;
    struct state_origin origin; /* of the states of this run */
    struct state from;          /* the state of another deck that the run begins from (run_start.h) */
    char *from_path;            /* its file; NULL: the run begins with the elements of the deck */
    char from_digest[SHA256_TEXT];
    bool restarted, staged; /* `state` is one of this run; the first one of a run that begins from a state */
    struct state state;     /* where the run begins; empty where neither is set */
    char *state_path;       /* its file, of a run that continues */
    char state_digest[SHA256_TEXT];
    struct results *results; /* --restart auto: the claimed directory, until run_open_results */
    bool anew;               /* --restart auto: what an interrupted run without a state has left is removed */
    bool complete;           /* --restart auto: the directory has all results; there is nothing to run */
};

/* Reads and checks the deck, with the state that the run begins from (run_start.h), builds the model, and
 * reads the state of --restart (restart.h). Where run->complete is set, the user has been told so.
 *
 * The deck's findings are printed on standard error (warnings not with --quiet). DM2_DECK and others, with
 * a closing sentence in *err. run_free frees *run, which is empty after a failure. */
enum dm2_status run_load(const struct run_options *o, struct run *run, struct dm2_error *err);
void run_free(struct run *run);

/* Whether this machine has the memory for the cells of the whole domain: DM2_MEMORY. */
enum dm2_status run_check_cells(const struct run *run, struct dm2_error *err);

/* The run directory: that of -o, or the default one; with --restart FILE, the directory of the state.
 * malloc'd, the caller frees it. NULL: no memory. */
char *run_directory_name(const struct run_options *o);

/* Opens the run directory, writes deck.dm2 and the head of run.log. Where a block
 * `stop` held at a row before the state's step, run->config.steps becomes the step at which the run ends. The
 * errors of results_claim, results_begin and results_go_on; then *out is NULL. */
enum dm2_status run_open_results(const struct run_options *o, struct run *run, struct results **out,
                                 struct dm2_error *err);

/* The state that the elements are taken from at once; NULL: the deck makes them. */
const struct state *run_state(const struct run *run);

/* The number of steps between checkpoints of the run; 0: none. */
int64_t run_checkpoint_every(const struct run_options *o, const struct run *run);

/* Prints the warning of the energy book on standard error and its closing line on standard output, the last
 * of a run; nothing with --quiet. */
void run_print_verdict(const struct run_options *o, const struct results_verdict *verdict);

/* Prints the warning about elements that start pressed into each other, if there are any, on standard error;
 * nothing with --quiet. */
void run_print_overlap(const struct run_options *o, const struct run *run, const struct overlap *overlap);

/* Prints the output of --check: elements, cells, time step, each subdomain with its elements and
 * interface, memory. Every subdomain is generated and its forces are evaluated once, so bodies that overlap
 * and a time step that the neighbours at the start make unstable (DM2_DECK) are found here too.
 * `server_names` (one per rank) may be NULL. The errors of subdomain_create and decomposition_boundary. */
enum dm2_status run_print_check(FILE *to, const struct run_options *o, const struct run *run,
                                const struct decomposition *d, const char *const *server_names,
                                struct dm2_error *err);

/* Prints the line of --hash-every, the same in both programs. Hashes are due at step 0, every K steps, and
 * at the last step. */
void run_print_hash(int64_t step, uint64_t hash);
bool run_hash_due(const struct run_options *o, const struct run *run, int64_t step);

/* Whether standard output is what the user asked for (--check, --hash-every, --help, --version), more than
 * the closing lines of a run. */
bool run_output_asked(const struct run_options *o);

/* Prints a failure on standard error, with a hint at --help for a wrong command line; returns the exit
 * status of the program. */
int run_report_failure(const char *program, const struct dm2_error *err);

/* Prints "PROGRAM VERSION". */
void run_print_version(const char *program);

#endif
