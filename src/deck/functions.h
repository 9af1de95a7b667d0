/* The functions that an expression of a deck can call. */
#ifndef DM2_DECK_FUNCTIONS_H
#define DM2_DECK_FUNCTIONS_H

#include <stddef.h>

#include "dm2/base/words.h"

enum deck_function {
    FUNCTION_SQRT,
    FUNCTION_ABS,
    FUNCTION_MIN,
    FUNCTION_MAX,
    FUNCTION_FLOOR,
    FUNCTION_CEIL,
    FUNCTION_ROUND
};

/* The function of this name (enum deck_function); -1: none. */
int function_find(const char *name, size_t length);

/* The arguments of a function; 1: one value, 2: two values or more. */
int function_arguments(int function);

const char *function_name(int function);
struct word_list function_names(void);

#endif
