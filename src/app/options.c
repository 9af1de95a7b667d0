/* One table describes a program's options for both the parser and the help. */
#include "options.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/words.h"

/* The table, and the position in the command line. */
struct parser {
    const struct option *table;
    size_t n;
    int argc, at;
    char **argv;
};

enum dm2_status option_list_add(struct option_list *list, const char *item, struct dm2_error *err)
{
    const char **grown = mem_grown(list->items, &list->cap, list->n, list->n + 1, sizeof *grown);
    if (grown == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the command line");
    list->items = grown;
    list->items[list->n++] = item;
    return DM2_OK;
}

void option_list_free(struct option_list *list)
{
    free(list->items);
    *list = (struct option_list){0};
}

static const char *name_at(const void *context, size_t index)
{
    return ((const struct parser *)context)->table[index].name;
}

static enum dm2_status fail_unknown_option(const struct parser *p, const char *word, size_t length,
                                           struct dm2_error *err)
{
    struct word_list known = {.context = p, .name = name_at, .n = p->n};
    struct word_hint hint;
    return dm2_fail(err, DM2_USAGE, "the option --%.*s is not known%s", (int)length, word,
                    words_hint(&known, word, length, &hint));
}

static enum dm2_status set_integer(const struct option *o, const char *value, struct dm2_error *err)
{
    int64_t number;
    if (!number_parse_integer(value, strlen(value), &number) || number < o->least || number > o->most) {
        if (o->most == INT64_MAX)
            return dm2_fail(err, DM2_USAGE, "--%s '%s': a whole number from %lld on is expected", o->name,
                            value, (long long)o->least);
        return dm2_fail(err, DM2_USAGE, "--%s '%s': a whole number from %lld to %lld is expected", o->name,
                        value, (long long)o->least, (long long)o->most);
    }
    *(int64_t *)o->target = number;
    return DM2_OK;
}

static enum dm2_status set_value(const struct option *o, const char *value, struct dm2_error *err)
{
    double seconds;
    switch (o->kind) {
    case OPTION_FLAG:
        *(bool *)o->target = true;
        return DM2_OK;
    case OPTION_TEXT:
        *(const char **)o->target = value;
        return DM2_OK;
    case OPTION_INTEGER:
        return set_integer(o, value, err);
    case OPTION_SECONDS:
        if (!number_parse(value, strlen(value), &seconds) || !(seconds > 0 && seconds <= 1e6))
            return dm2_fail(err, DM2_USAGE,
                            "--%s '%s': a number of seconds above 0, at most 1e6, is expected", o->name,
                            value);
        *(double *)o->target = seconds;
        return DM2_OK;
    case OPTION_LIST:
        return option_list_add(o->target, value, err);
    }
    return DM2_OK;
}

/* Sets the option from the text attached to its name, or else from the next argument. */
static enum dm2_status take_value(struct parser *p, const struct option *o, const char *attached,
                                  struct dm2_error *err)
{
    if (o->kind == OPTION_FLAG || attached != NULL)
        return set_value(o, attached, err);
    if (p->at >= p->argc)
        return dm2_fail(err, DM2_USAGE, "--%s needs a value: %s", o->name, o->argument);
    return set_value(o, p->argv[p->at++], err);
}

static enum dm2_status parse_long(struct parser *p, const char *word, struct dm2_error *err)
{
    size_t length = strcspn(word, "=");
    const char *attached = word[length] == '=' ? word + length + 1 : NULL;
    for (size_t k = 0; k < p->n; k++) {
        const struct option *o = &p->table[k];
        if (strlen(o->name) != length || memcmp(o->name, word, length) != 0)
            continue;
        if (o->kind == OPTION_FLAG && attached != NULL)
            return dm2_fail(err, DM2_USAGE, "--%s takes no value", o->name);
        return take_value(p, o, attached, err);
    }
    return fail_unknown_option(p, word, length, err);
}

static enum dm2_status parse_letters(struct parser *p, const char *word, struct dm2_error *err)
{
    for (const char *c = word; *c != '\0'; c++) {
        size_t k = 0;
        while (k < p->n && p->table[k].letter != *c)
            k++;
        if (k == p->n)
            return dm2_fail(err, DM2_USAGE, "the option -%c is not known; --help lists them", *c);
        bool last = p->table[k].kind != OPTION_FLAG || c[1] == '\0';
        enum dm2_status status = take_value(p, &p->table[k], last && c[1] != '\0' ? c + 1 : NULL, err);
        if (status != DM2_OK || last)
            return status;
    }
    return DM2_OK;
}

enum dm2_status options_parse(const struct option *table, size_t n, int argc, char **argv,
                              struct option_list *operands, struct dm2_error *err)
{
    struct parser p = {.table = table, .n = n, .argc = argc, .at = 1, .argv = argv};
    enum dm2_status status = DM2_OK;
    bool operands_only = false;
    while (p.at < argc && status == DM2_OK) {
        const char *word = argv[p.at++];
        if (operands_only || word[0] != '-' || word[1] == '\0')
            status = option_list_add(operands, word, err);
        else if (strcmp(word, "--") == 0)
            operands_only = true;
        else if (word[1] == '-')
            status = parse_long(&p, word + 2, err);
        else
            status = parse_letters(&p, word + 1, err);
    }
    return status;
}

void options_print(FILE *to, const struct option *table, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        const struct option *o = &table[k];
        char left[64];
        const char *argument = o->argument == NULL ? "" : o->argument, *gap = o->argument == NULL ? "" : " ";
        if (o->letter != 0)
            (void)snprintf(left, sizeof left, "-%c, --%s%s%s", o->letter, o->name, gap, argument);
        else
            (void)snprintf(left, sizeof left, "    --%s%s%s", o->name, gap, argument);
        (void)fprintf(to, "  %-28s %s\n", left, o->help);
    }
}
