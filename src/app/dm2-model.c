/* dm2-model: the paper's performance model (section 6) as a tool. */
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "dm2/base/version.h"
#include "dm2/engine/self_test.h"
#include "model_commands.h"
#include "process.h"

static const char PROGRAM[] = "dm2-model";

struct model_command {
    const char *name, *help;
    enum dm2_status (*run)(const char *argv0, int argc, char **argv, struct dm2_error *err);
};

static const struct model_command COMMANDS[] = {
    {"predict", "times, speedup and efficiency of N servers", model_predict_command},
    {"what-if", "other processors and networks; from which size servers pay, and how many",
     model_what_if_command},
    {"netbench", "what messages cost between a client and N servers", model_netbench_command},
    {"calibrate", "measures this cluster's constants and writes the calibration file",
     model_calibrate_command},
    {"compare", "measured beside predicted: a sweep of runs, or finished ones", model_compare_command},
};

enum { N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0] };

static void print_help(void)
{
    (void)printf("usage: %s COMMAND [options]\nThe performance model of the distributed run.\n\n", PROGRAM);
    for (size_t i = 0; i < N_COMMANDS; i++)
        (void)printf("  %-10s %s\n", COMMANDS[i].name, COMMANDS[i].help);
    (void)printf("\n%s COMMAND --help lists a command's options.\n", PROGRAM);
}

static enum dm2_status fail_unknown_command(const char *word, struct dm2_error *err)
{
    char names[200] = "";
    size_t used = 0;
    for (size_t i = 0; i < N_COMMANDS && used < sizeof names; i++)
        used +=
            (size_t)snprintf(names + used, sizeof names - used, "%s%s", i > 0 ? ", " : "", COMMANDS[i].name);
    return dm2_fail(err, DM2_USAGE,
                    word == NULL ? "a command is missing%s: %s" : "the command '%s' is not known: %s",
                    word == NULL ? "" : word, names);
}

static enum dm2_status run_command(int argc, char **argv, struct dm2_error *err)
{
    const char *word = argc > 1 ? argv[1] : NULL;
    if (word != NULL && (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)) {
        print_help();
        return DM2_OK;
    }
    if (word != NULL && strcmp(word, "--version") == 0) {
        (void)printf("%s %s\n", PROGRAM, DM2_VERSION);
        return DM2_OK;
    }
    for (size_t i = 0; word != NULL && i < N_COMMANDS; i++)
        if (strcmp(word, COMMANDS[i].name) == 0) {
            enum dm2_status status = self_test_check(err);
            return status == DM2_OK ? COMMANDS[i].run(argv[0], argc - 1, argv + 1, err) : status;
        }
    return fail_unknown_command(word, err);
}

int main(int argc, char **argv)
{
    struct dm2_error err = {0};
    process_start();
    enum dm2_status status = run_command(argc, argv, &err);
    if (status == DM2_OK)
        return process_finish(PROGRAM, 0, true);
    (void)fprintf(stderr, "%s: %s\n", PROGRAM, err.text);
    if (status == DM2_USAGE)
        (void)fprintf(stderr, "%s --help tells how it is called\n", PROGRAM);
    return dm2_exit_code(status);
}
