/* The functions are those whose result is exact or correctly rounded on every machine, because a deck must
 * give the same bits everywhere. Therefore there is no sin, exp or pow. */
#include "functions.h"

#include <string.h>

static const struct {
    const char *name;
    int arguments;
} functions[] = {
    [FUNCTION_SQRT] = {"sqrt", 1},   [FUNCTION_ABS] = {"abs", 1},     [FUNCTION_MIN] = {"min", 2},
    [FUNCTION_MAX] = {"max", 2},     [FUNCTION_FLOOR] = {"floor", 1}, [FUNCTION_CEIL] = {"ceil", 1},
    [FUNCTION_ROUND] = {"round", 1},
};

enum { FUNCTIONS = sizeof functions / sizeof functions[0] };

int function_find(const char *name, size_t length)
{
    for (int i = 0; i < FUNCTIONS; i++)
        if (strlen(functions[i].name) == length && memcmp(functions[i].name, name, length) == 0)
            return i;
    return -1;
}

int function_arguments(int function)
{
    return functions[function].arguments;
}

const char *function_name(int function)
{
    return functions[function].name;
}

static const char *name_at(const void *context, size_t i)
{
    (void)context;
    return functions[i].name;
}

struct word_list function_names(void)
{
    return (struct word_list){name_at, NULL, FUNCTIONS};
}
