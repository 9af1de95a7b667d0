/* Command lines by table: `--name value`, `--name=value`, `-l value`, `-lvalue`, several flags in one word
 * (`-qv`), `--` before operands that start with a dash. */
#ifndef DM2_APP_OPTIONS_H
#define DM2_APP_OPTIONS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "dm2/base/status.h"

enum option_kind {
    OPTION_FLAG,    /* target: bool, set to true */
    OPTION_TEXT,    /* target: const char * */
    OPTION_INTEGER, /* target: int64_t, from `least` to `most` */
    OPTION_SECONDS, /* target: double, above 0 */
    OPTION_LIST     /* target: struct option_list; may be repeated */
};

struct option_list {
    const char **items; /* point into argv */
    size_t n, cap;
};

struct option {
    const char *name; /* the long name without dashes */
    char letter;      /* 0: none */
    enum option_kind kind;
    void *target;
    const char *argument; /* in the help, NULL for a flag */
    const char *help;     /* one line */
    int64_t least, most;  /* of an integer */
};

/* Reads the command line after argv[0]; words that are not options are appended to *operands, also before
 * a failure. DM2_USAGE: an unknown option (with the nearest known one), a missing or impossible value, a
 * value for a flag. DM2_MEMORY. */
enum dm2_status options_parse(const struct option *table, size_t n, int argc, char **argv,
                              struct option_list *operands, struct dm2_error *err);

/* Appends an item, which is borrowed. DM2_MEMORY. */
enum dm2_status option_list_add(struct option_list *list, const char *item, struct dm2_error *err);
void option_list_free(struct option_list *list);

/* Prints a line per option. */
void options_print(FILE *to, const struct option *table, size_t n);

#endif
