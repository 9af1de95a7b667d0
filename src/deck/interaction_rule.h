/* One `interaction` or `interface` block: what config_interaction puts together. */
#ifndef DM2_DECK_INTERACTION_RULE_H
#define DM2_DECK_INTERACTION_RULE_H

#include <stdint.h>

#include "dm2/deck/config.h"

struct interaction_rule {
    int relation;    /* enum relation of an interface; -1: any */
    int material[2]; /* -1 -1: any */
    uint32_t set;    /* bit i: the block gives the i-th keyword of the schema's interaction, */
    uint32_t bad;    /* bit i: but it does not read, and `value` has nothing for it */
    struct interaction_config value; /* of the set fields */
};

/* How specific a rule is, 0 to 3; -1: it is not for this pair. */
int interaction_rule_rank(const struct interaction_rule *rule, int a, int b, enum relation relation);

/* The rule that has the last word on keyword `key` for this pair: its index, -1: none, the default holds. */
int interaction_rule_of(const struct config *c, int a, int b, enum relation relation, int key);

#endif
