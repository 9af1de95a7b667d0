/* From the tree of a deck to its config, by the schema: names, types, dimensions, limits, duplicates, missing
 * keywords. What the values mean together is deck_check's. */
#ifndef DM2_DECK_BIND_H
#define DM2_DECK_BIND_H

#include "dm2/base/number.h"
#include "dm2/deck/config.h"
#include "interaction_rule.h"
#include "schema.h"
#include "tree.h"

enum { MATERIAL_MAX = 256, BODY_MAX = 65535, RULE_MAX = 1000, VOID_MAX = 10000, FLAW_MAX = 10000 };
enum { PHASE_MAX = 256, REACTION_MAX = 1 };

struct deck_binding {
    struct deck_tree *tree;
    struct findings *findings;
    struct config *config;
    bool steps_replaced;         /* by --steps */
    enum block_kind *kinds;      /* of each block of the tree; BLOCK_COUNT: unknown */
    size_t single[BLOCK_COUNT];  /* index of the first block of a kind; tree->n_blocks: none */
    size_t *blocks[BLOCK_COUNT]; /* blocks[kind][i]: the block of the i-th item of config->materials and so
                                  * on; of config->rules: [BLOCK_INTERACTION] */
};

/* Fills *b and b->config, both empty at the start but for tree, findings and config. A real value that was
 * given but does not read is NaN, any other such value its default. False: no memory. */
bool deck_bind(struct deck_binding *b, int64_t steps);
void deck_binding_free(struct deck_binding *b);

/* Was the keyword given in this block, and does it read? */
bool binding_given(const struct deck_binding *b, size_t block, const char *key);

/* Was it given, but does it not read? */
bool binding_bad(const struct deck_binding *b, size_t block, const char *key);

/* Is it simply not there, nor something that could be meant by it? */
bool binding_missing(const struct deck_binding *b, size_t block, const char *key);

/* The place of the i-th value of a keyword; where it was not given, that of the block's word. */
struct deck_place binding_place(const struct deck_binding *b, size_t block, const char *key, size_t i);

/* Reads the values of one entry into `base`, the struct that its block fills. False: it was bad. */
bool value_read(struct deck_binding *b, const struct deck_key *key, struct deck_entry *entry, void *base);

/* The index of the material that a value names; -1: there is none, reported. */
int binding_material(struct deck_binding *b, struct deck_place name);

/* The index of the body that a value names; -1: there is none, reported. Bodies are bound by then. */
int binding_body(struct deck_binding *b, struct deck_place name);

/* A double as messages show it, with the fewest digits that read back. */
struct number_text {
    char text[NUMBER_TEXT_MAX];
};
const char *number_text(double value, struct number_text *out);

#endif
