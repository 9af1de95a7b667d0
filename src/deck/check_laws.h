/* The check of one pair of materials, for check_pairs.c and check_laws.c. */
#ifndef DM2_DECK_CHECK_LAWS_H
#define DM2_DECK_CHECK_LAWS_H

#include "bind.h"

struct pair_check {
    const struct deck_binding *b;
    int materials[2];
    enum relation relation;
    struct interaction_config law; /* the keywords that hold for the pair, defaults included */
};

/* True where a block of the deck gives this keyword of the interaction for the pair. */
bool pair_check_given(const struct pair_check *p, const char *key);

/* True where the keyword is given by a rule that is no more general than the rule which gives `chooser`, the
 * keyword that may take the first one's meaning away. */
bool pair_check_given_for(const struct pair_check *p, const char *key, const char *chooser);

/* The place of that block's entry. */
struct deck_place pair_check_place(const struct pair_check *p, const char *key);

/* Findings about constants that the law of the pair cannot follow: keywords that its scope or other keywords
 * ignore, and shear moduli and strengths beyond its lattice. */
void check_law(const struct pair_check *p);

#endif
