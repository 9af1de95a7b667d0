/* Rules of interactions: one `interaction` or `interface` block each. config_interaction resolves the rules
 * for a pair. */
#ifndef DM2_DECK_INTERACTION_RULE_H
#define DM2_DECK_INTERACTION_RULE_H

#include <stdint.h>

#include "dm2/deck/config.h"

struct interaction_rule {
    int relation;    /* enum relation of an `interface` block; -1: any */
    int material[2]; /* -1 -1: any */
    uint32_t set;    /* bit i: the block gives the i-th keyword of the schema's `interaction` block */
    uint32_t bad;    /* bit i: the i-th keyword is given, but its value does not read */
    struct interaction_config value; /* the values of the keywords in `set` and not in `bad` */
};

/* How specific a rule is for a pair of materials a and b and their relation, 0 (any pair) to 3; -1: the rule
 * does not apply to the pair. */
int interaction_rule_rank(const struct interaction_rule *rule, int a, int b, enum relation relation);

/* The index in c->rules of the rule that decides keyword `key` (its index in the schema's `interaction`
 * block) for the pair; -1: none, the default holds. */
int interaction_rule_of(const struct config *c, int a, int b, enum relation relation, int key);

#endif
