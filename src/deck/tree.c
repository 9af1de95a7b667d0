/* Look-ups in a parsed deck. The parser appends the lets in the order of the texts; deck_tree_sort_lets sorts
 * them by name, so that deck_tree_let can search by bisection. */
#include "tree.h"

#include <stdlib.h>
#include <string.h>

static int compare_lets(const void *a, const void *b)
{
    const struct deck_let *x = a, *y = b;
    int order = strcmp(x->name, y->name);
    if (order != 0)
        return order;
    if (x->place.text != y->place.text)
        return x->place.text < y->place.text ? -1 : 1;
    return x->place.offset < y->place.offset ? -1 : x->place.offset > y->place.offset;
}

void deck_tree_sort_lets(struct deck_tree *tree, struct findings *findings)
{
    if (tree->n_lets > 0)
        qsort(tree->lets, tree->n_lets, sizeof tree->lets[0], compare_lets);
    for (size_t i = 1; i < tree->n_lets; i++)
        if (strcmp(tree->lets[i].name, tree->lets[i - 1].name) == 0)
            findings_error(findings, tree->lets[i].place, "the let '%s' was defined before",
                           tree->lets[i].name);
}

struct deck_let *deck_tree_let(const struct deck_tree *tree, const char *name, size_t length)
{
    size_t low = 0, high = tree->n_lets;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        const char *other = tree->lets[middle].name;
        int order = strncmp(other, name, length);
        if (order == 0 && other[length] != '\0')
            order = 1;
        if (order == 0)
            return &tree->lets[middle];
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

static const char *let_name(const void *context, size_t i)
{
    return ((const struct deck_tree *)context)->lets[i].name;
}

struct word_list deck_tree_let_names(const struct deck_tree *tree)
{
    return (struct word_list){let_name, tree, tree->n_lets};
}

const struct deck_entry *deck_tree_entry(const struct deck_tree *tree, const struct deck_block *block,
                                         const char *key)
{
    for (size_t i = 0; i < block->n_entries; i++) {
        const struct deck_entry *entry = &tree->entries[block->first_entry + i];
        if (place_is(tree->source, entry->key, key))
            return entry;
    }
    return NULL;
}

void deck_tree_free(struct deck_tree *tree)
{
    free(tree->nodes);
    free(tree->lets);
    free(tree->values);
    free(tree->names);
    free(tree->entries);
    free(tree->blocks);
    *tree = (struct deck_tree){0};
}
