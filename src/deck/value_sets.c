/* The values of entries that choose from a list: words of a keyword, and bodies. */
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "bind.h"

static bool read_set(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     uint32_t *out)
{
    uint32_t set = 0;
    for (size_t i = 0; i < entry->n; i++) {
        int choice = value_read_choice(b, key, value_word(b, entry, i));
        if (choice < 0)
            return false;
        set |= UINT32_C(1) << choice;
    }
    *out = set;
    return true;
}

static bool read_bodies(struct deck_binding *b, const struct deck_entry *entry, bool **out)
{
    bool ok = true;
    free(*out);
    *out = mem_zalloc(b->config->n_bodies, sizeof **out);
    if (*out == NULL) {
        b->findings->no_memory = true;
        return false;
    }
    for (size_t i = 0; i < entry->n; i++) {
        int body = binding_body(b, value_word(b, entry, i));
        ok = ok && body >= 0;
        if (body >= 0)
            (*out)[body] = true;
    }
    return ok;
}

bool value_read_list(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     void *at)
{
    return key->type == VALUE_SET ? read_set(b, key, entry, at) : read_bodies(b, entry, at);
}
