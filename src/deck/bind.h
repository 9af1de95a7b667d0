/* Binding: from the tree of a deck to its config, by the schema. Binding checks names, types, dimensions,
 * limits, repeated and missing keywords; deck_check checks the values against each other. */
#ifndef DM2_DECK_BIND_H
#define DM2_DECK_BIND_H

#include "dm2/base/number.h"
#include "dm2/deck/config.h"
#include "interaction_rule.h"
#include "schema.h"
#include "tree.h"

enum { MATERIAL_MAX = 256, BODY_MAX = 65535, RULE_MAX = 1000, VOID_MAX = 10000, FLAW_MAX = 10000 };
enum { PHASE_MAX = 256, REACTION_MAX = 1, STOP_MAX = 16, WALL_MAX = 1000 };

struct deck_binding {
    struct deck_tree *tree;
    struct findings *findings;
    struct config *config;
    bool steps_replaced;         /* --steps replaces `steps` of the deck */
    size_t table_points;         /* of all loads, from files */
    enum block_kind *kinds;      /* of each block of the tree; BLOCK_COUNT: unknown */
    size_t single[BLOCK_COUNT];  /* index of the first block of a kind; tree->n_blocks: none */
    struct start_source *stage;  /* the state that the run begins from; NULL: none (bind_start.h) */
    size_t *blocks[BLOCK_COUNT]; /* blocks[kind][i]: the block of the i-th item of the config's array for this
                                    kind; of config->rules: blocks[BLOCK_INTERACTION] */
};

/* The blocks of one kind, each of which fills one item of an array of the config. An item of a kind that is
 * named begins with its name. `finish` sets the defaults that depend on other values. */
struct deck_things {
    size_t most, size;   /* the most items of a deck; bytes of an item */
    size_t items, count; /* offsets in struct config: the array, the number of its items */
    const void *initial; /* an item before the schema's defaults; NULL: zeros */
    void (*finish)(struct deck_binding *b, size_t block, void *item); /* NULL: none */
};

/* All 0 for blocks that fill no such array. */
const struct deck_things *binding_things(enum block_kind kind);

/* Fills *b and b->config. Both are empty at the start, except for b->tree, b->findings and b->config. `steps`
 * is the value of --steps, -1: none. A real value that was given but does not read is NaN, any other such
 * value has its default. False: no memory. */
bool deck_bind(struct deck_binding *b, int64_t steps);
void deck_binding_free(struct deck_binding *b);

/* True if the keyword was given in this block and its value reads. */
bool binding_given(const struct deck_binding *b, size_t block, const char *key);

/* True if the keyword was given in this block and its value does not read. */
bool binding_bad(const struct deck_binding *b, size_t block, const char *key);

/* True if the keyword is missing in this block, and no unknown keyword is near its name. */
bool binding_missing(const struct deck_binding *b, size_t block, const char *key);

/* The place of the i-th value of a keyword; of the block's word where the keyword was not given; of the end
 * of the deck where `block` is no block. */
struct deck_place binding_place(const struct deck_binding *b, size_t block, const char *key, size_t i);

/* Reads the values of one entry into `base`, the struct that its block fills. False: the value does not read,
 * and a finding was added. */
bool value_read(struct deck_binding *b, const struct deck_key *key, struct deck_entry *entry, void *base);

/* --- bind_walls.c --- */

/* Reads the points of a wall's line. False: a finding was added, or there is no memory. */
bool walls_read_points(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       struct wall_config *wall);

/* After the domain: which lines are closed? */
void walls_finish(struct deck_binding *b);

/* The index of the material that a value names. -1: no such material, a finding was added. */
int binding_material(struct deck_binding *b, struct deck_place name);

/* The index of the body that a value names; bodies must be bound. -1: no such body, a finding was added. */
int binding_body(struct deck_binding *b, struct deck_place name);

/* The index of the body or wall that a value names; bodies and walls must be bound. -1: none, a finding was
 * added. */
int binding_mover(struct deck_binding *b, struct deck_place name);

/* The place of value i of an entry, which should be a word, without quotes; the index of a word among the
 * choices of the keyword, -1: none, a finding was added. */
struct deck_place value_word(const struct deck_binding *b, const struct deck_entry *entry, size_t i);
int value_read_choice(struct deck_binding *b, const struct deck_key *key, struct deck_place word);

/* Reads the values of a VALUE_SET or a VALUE_BODIES to `at`. False: a finding was added. */
bool value_read_list(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     void *at);

/* The i-th value of an entry as a number of the keyword's dimension and within the keyword's limits. False: a
 * finding was added. */
bool value_read_real(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     size_t i, double *out);

/* A double as messages show it: the fewest digits that read back to the same double. Returns `out->text`. */
struct number_text {
    char text[NUMBER_TEXT_MAX];
};
const char *number_text(double value, struct number_text *out);

#endif
