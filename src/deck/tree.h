/* A parsed deck: lets, blocks, entries and their values as trees of nodes, each with its place, not yet
 * evaluated. All arrays refer to each other by index. */
#ifndef DM2_DECK_TREE_H
#define DM2_DECK_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/words.h"
#include "findings.h"
#include "units.h"

enum { DECK_MAX_LETS = 10000, DECK_MAX_DEPTH = 200 };

enum node_kind {
    NODE_BAD,    /* reported already */
    NODE_NUMBER, /* quantity */
    NODE_WORD,   /* a word: a let, pi, a unit, or a word that has a meaning for the keyword */
    NODE_STRING,
    NODE_NEGATE, /* -a */
    NODE_BINARY, /* a op b */
    NODE_CALL    /* op is the index of the function; a is the first argument, `next` links to the next */
};

struct deck_node {
    enum node_kind kind;
    int op;
    int depth;               /* of the tree below this node; 1: a leaf */
    int32_t a, b, next;      /* nodes; -1: none */
    struct deck_place place; /* the whole expression */
    struct deck_place op_place;
    struct quantity number;
};

enum let_state { LET_UNSEEN, LET_UNDER_WAY, LET_DONE, LET_FAILED };

struct deck_let {
    char name[NAME_MAX_LENGTH + 1];
    struct deck_place place; /* of the name in the definition */
    int32_t node;
    enum let_state state;
    bool used;
    struct quantity value;
};

struct deck_entry {
    struct deck_place key;
    size_t first, n; /* the values: tree->values[first .. first + n - 1] */
    bool bad;        /* reported already; the keyword counts as given */
};

struct deck_block {
    struct deck_place word;
    size_t first_name, n_names; /* tree->names */
    size_t first_entry, n_entries;
    bool bad; /* the block has no braces, reported already */
};

struct deck_tree {
    const struct deck_source *source;
    struct deck_node *nodes;
    struct deck_let *lets; /* sorted by name after parsing */
    int32_t *values;       /* nodes */
    struct deck_place *names;
    struct deck_entry *entries;
    struct deck_block *blocks;
    size_t n_nodes, n_lets, n_values, n_names, n_entries, n_blocks;
    size_t cap_nodes, cap_lets, cap_values, cap_names, cap_entries, cap_blocks;
    struct deck_place end;          /* the end of the main text: the place of findings about missing blocks */
    size_t room_tokens, room_bytes; /* what the deck may have beside its texts, whose tables have no tokens */
    bool incomplete; /* an included text is missing; blocks and names that are not found may be defined in
                        that text */
};

void deck_tree_free(struct deck_tree *tree);

/* Parses every text and definition of findings->source into *tree, which is empty. A statement that does not
 * read gives a finding and is left out or marked bad. False: no memory. The caller calls deck_tree_free in
 * both cases. */
bool deck_parse(struct deck_tree *tree, struct findings *findings);

/* Sorts the lets by name. A repeated name gives a finding. */
void deck_tree_sort_lets(struct deck_tree *tree, struct findings *findings);

/* The let of this name; NULL: none. The lets must be sorted. */
struct deck_let *deck_tree_let(const struct deck_tree *tree, const char *name, size_t length);

/* The first entry of a block with this keyword; NULL: none. */
const struct deck_entry *deck_tree_entry(const struct deck_tree *tree, const struct deck_block *block,
                                         const char *key);

/* The names of all lets, for suggestions; the list is valid as long as the tree. */
struct word_list deck_tree_let_names(const struct deck_tree *tree);

#endif
