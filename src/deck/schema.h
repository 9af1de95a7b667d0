/* The one table of a deck's blocks and keywords: type, dimension, default, limits, meaning, and where in the
 * config the value goes. docs/deck.md is checked against it. */
#ifndef DM2_DECK_SCHEMA_H
#define DM2_DECK_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/words.h"
#include "units.h"

enum block_kind {
    BLOCK_DOMAIN,
    BLOCK_TIME,
    BLOCK_MATERIAL,
    BLOCK_PHASE,
    BLOCK_REACTION,
    BLOCK_INTERACTION,
    BLOCK_INTERFACE, /* has the keywords of interaction */
    BLOCK_BODY,
    BLOCK_VOID,
    BLOCK_FLAW,
    BLOCK_PROBE,
    BLOCK_PROFILE,
    BLOCK_OUTPUT,
    BLOCK_COUNT
};

enum value_type {
    VALUE_REAL,      /* `count` doubles */
    VALUE_WHOLE,     /* one int64_t or uint64_t from 0 to 2^53 */
    VALUE_CHOICE,    /* one word of `choices`, stored as an int: its index */
    VALUE_FLAG,      /* `count` words of two choices, stored as bools: is it the second? */
    VALUE_SHAPE,     /* rectangle | disc | polygon and lengths */
    VALUE_MATERIAL,  /* the name of a material */
    VALUE_MATERIALS, /* `count` names of materials, stored as ints: their indices */
    VALUE_NAME,      /* one word, stored as a name_text */
    VALUE_BODY,      /* the name of a body */
    VALUE_MIX,       /* names of materials, each with a fraction */
    VALUE_STEPS,     /* a list of steps */
    VALUE_FORMATS    /* a list of vtp, xyz */
};

struct deck_key {
    const char *name;
    enum value_type type;
    int count; /* values of VALUE_REAL and VALUE_FLAG */
    struct dimension dim;
    double low, high;         /* limits of each value; infinite where there are none */
    bool low_open, high_open; /* the limit itself is outside */
    bool required;
    const char *choices; /* "a|b|c" */
    const char *initial; /* the default as docs/deck.md says it: a value, or words where it is worked out or
                          * absent; NULL: required */
    size_t offset;       /* in the struct that the block fills; not for VALUE_SHAPE and below */
    const char *meaning;
};

struct block_schema {
    const char *name;
    const char *names; /* what stands between the word and the brace, for messages: "a name" */
    bool single;       /* at most once in a deck */
    bool required;
    const struct deck_key *keys;
    size_t n_keys;
};

const struct block_schema *schema_block(enum block_kind kind);

/* The kind of a block's word; BLOCK_COUNT: none. */
enum block_kind schema_find_block(const char *word, size_t length);

/* The index of a keyword; -1: none. */
int schema_find_key(const struct block_schema *block, const char *word, size_t length);

/* The name of the first block that has this keyword; NULL: none. */
const char *schema_block_of_key(const char *word, size_t length);

/* The choice with this text: its index, -1: none. */
int schema_find_choice(const char *choices, const char *word, size_t length);

/* Bytes that a stored value takes. */
size_t schema_size(const struct deck_key *key);

/* Fills in what the table says as defaults; NaN for a VALUE_REAL whose default is none or worked out, -1 for
 * such a VALUE_WHOLE. `base` is the struct that the block fills. */
void schema_defaults(const struct block_schema *block, void *base);

/* For suggestions. */
struct word_list schema_block_names(void);
struct word_list schema_key_names(const struct block_schema *block);

#endif
