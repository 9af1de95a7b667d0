/* The table of a deck's blocks and keywords: type, dimension, default, limits, meaning, and the place of the
 * value in the config. A test checks docs/deck.md against the table. */
#ifndef DM2_DECK_SCHEMA_H
#define DM2_DECK_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/words.h"
#include "dm2/deck/meaning.h"
#include "units.h"

enum block_kind {
    BLOCK_DOMAIN,
    BLOCK_TIME,
    BLOCK_START,
    BLOCK_MATERIAL,
    BLOCK_PHASE,
    BLOCK_REACTION,
    BLOCK_INTERACTION,
    BLOCK_INTERFACE, /* with the keywords of `interaction` */
    BLOCK_BODY,
    BLOCK_VOID,
    BLOCK_FLAW,
    BLOCK_LOAD,
    BLOCK_WALL,
    BLOCK_PROBE,
    BLOCK_PROFILE,
    BLOCK_STOP,
    BLOCK_OUTPUT,
    BLOCK_COUNT
};

enum value_type {
    VALUE_REAL,      /* `count` doubles */
    VALUE_WHOLE,     /* one int64_t or uint64_t from 0 to 2^53 */
    VALUE_CHOICE,    /* one word of `choices`, stored as an int, the index of the word */
    VALUE_FLAG,      /* `count` words of two choices, stored as bools: true for the second choice */
    VALUE_SHAPE,     /* rectangle | disc | polygon and lengths */
    VALUE_MATERIAL,  /* the name of a material */
    VALUE_MATERIALS, /* `count` names of materials, stored as ints, the indices of the materials */
    VALUE_NAME,      /* one word, stored as a name_text */
    VALUE_BODY,      /* the name of a body */
    VALUE_MOVER,     /* the name of a body or a wall, stored as an int, the index of the mover */
    VALUE_MOVERS,    /* `count` names of bodies or walls, stored as size_t, the indices of the movers */
    VALUE_FILE,      /* a file name in quotes */
    VALUE_POINTS,    /* pairs of a time and a value of the dimension, stored as a struct load_points */
    VALUE_BODIES,    /* names of bodies, stored as bools, one per body, in new memory; NULL without names */
    VALUE_MIX,       /* names of materials, each with a fraction */
    VALUE_LIMIT,     /* the name of a probe, one of its quantities, above | below, a number */
    VALUE_STEPS,     /* a list of steps */
    VALUE_SET,       /* a list of words of `choices`, stored as a uint32_t: bit k for the k-th word */
    VALUE_FORMATS,   /* a list of vtp, xyz */
    VALUE_LINE,      /* pairs x y, the points of a wall's line */
    VALUE_STATE,     /* the file of a state in quotes; in a meaning its digest */
    VALUE_NAMES      /* names of bodies and walls of the state */
};

struct deck_key {
    const char *name;
    enum value_type type;
    int count; /* the number of values of the types with `count` */
    struct dimension dim;
    double low, high;         /* limits of each value; infinite: none */
    bool low_open, high_open; /* the limit itself is not allowed */
    bool required;
    const char *choices; /* "a|b|c" */
    const char *initial; /* the default as docs/deck.md prints it: a value, or words where the default is
                            computed or absent; NULL: the keyword is required */
    size_t offset; /* in the struct that the block fills; unused for VALUE_MATERIAL, VALUE_MIX, VALUE_STEPS,
                      VALUE_FORMATS, VALUE_LINE, VALUE_STATE and VALUE_NAMES */
    const char *meaning;
    enum deck_part part;
};

struct block_schema {
    const char *name;
    const char *names; /* the names between the word and the brace, for messages: "a name" */
    bool single;       /* a deck has at most one such block */
    bool required;
    const struct deck_key *keys;
    size_t n_keys;
};

const struct block_schema *schema_block(enum block_kind kind);

/* The kind of the block with this word; BLOCK_COUNT: none. */
enum block_kind schema_find_block(const char *word, size_t length);

/* The index of a keyword in block->keys; -1: none. */
int schema_find_key(const struct block_schema *block, const char *word, size_t length);

/* The name of the first block that has this keyword; NULL: none. */
const char *schema_block_of_key(const char *word, size_t length);

/* The index of a word in "a|b|c"; -1: none. */
int schema_find_choice(const char *choices, const char *word, size_t length);

/* The bytes of a stored value of type VALUE_REAL, VALUE_WHOLE, VALUE_CHOICE or VALUE_FLAG; 0 for other
 * types. */
size_t schema_size(const struct deck_key *key);

/* Sets the defaults of the table in `base`, the struct that the block fills. A VALUE_REAL without a default,
 * or with a computed one, is NaN, and such a VALUE_WHOLE is -1. Values of types other than VALUE_REAL,
 * VALUE_WHOLE, VALUE_CHOICE and VALUE_FLAG are left as they are. */
void schema_defaults(const struct block_schema *block, void *base);

/* The names of all blocks, of all keywords of a block, for suggestions. */
struct word_list schema_block_names(void);
struct word_list schema_key_names(const struct block_schema *block);

#endif
