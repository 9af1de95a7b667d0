/* The distance is the Damerau-Levenshtein distance in which neighbouring letters are swapped at most once
 * (optimal string alignment); a letter of the wrong case costs an eighth of a wrong letter. A candidate is
 * near where at most about a third of the word must change. */
#include "dm2/base/words.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST = 40, FAR = 10000, LETTER = WORDS_LETTER, CASE = 1 };

static int lower(char c)
{
    return tolower((unsigned char)c);
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

int words_distance(const char *a, size_t n_a, const char *b, size_t n_b)
{
    int d[LONGEST + 1][LONGEST + 1];
    if (n_a > LONGEST || n_b > LONGEST)
        return FAR;
    for (size_t i = 0; i <= n_a; i++)
        d[i][0] = LETTER * (int)i;
    for (size_t j = 0; j <= n_b; j++)
        d[0][j] = LETTER * (int)j;
    for (size_t i = 1; i <= n_a; i++) {
        for (size_t j = 1; j <= n_b; j++) {
            int change = a[i - 1] == b[j - 1] ? 0 : lower(a[i - 1]) == lower(b[j - 1]) ? CASE : LETTER;
            int best = least(d[i - 1][j], d[i][j - 1]) + LETTER;
            best = least(best, d[i - 1][j - 1] + change);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                best = least(best, d[i - 2][j - 2] + LETTER);
            d[i][j] = best;
        }
    }
    return d[n_a][n_b];
}

static void list_all(const struct word_list *known, struct word_hint *out)
{
    size_t used = 0;
    for (size_t i = 0; i < known->n; i++) {
        const char *name = known->name(known->context, i);
        if (used + strlen(name) + 16 > sizeof out->text) {
            (void)snprintf(out->text + used, sizeof out->text - used, ", ...");
            return;
        }
        used += (size_t)snprintf(out->text + used, sizeof out->text - used, "%s%s",
                                 i == 0 ? "; known: " : ", ", name);
    }
}

/* The largest distance at which a word of this length is near. One letter of a word of one or two letters
 * must be right. */
static int limit(size_t length)
{
    return length <= 1 ? CASE : length == 2 ? LETTER : LETTER * ((int)length + 1) / 3;
}

/* False where the lengths alone differ by more than the limit, so that no comparison is needed. */
static bool lengths_near(size_t a, size_t b)
{
    return LETTER * (int)(a > b ? a - b : b - a) <= limit(a);
}

bool words_near(const char *word, size_t length, const char *known)
{
    return length <= LONGEST && lengths_near(length, strlen(known)) &&
           words_distance(word, length, known, strlen(known)) <= limit(length);
}

const char *words_hint(const struct word_list *known, const char *word, size_t length, struct word_hint *out)
{
    const char *nearest = NULL;
    int distance = limit(length) + 1;
    for (size_t i = 0; i < known->n; i++) {
        const char *name = known->name(known->context, i);
        bool compare = length <= LONGEST && lengths_near(length, strlen(name));
        int d = compare ? words_distance(word, length, name, strlen(name)) : FAR;
        if (d < distance) {
            distance = d;
            nearest = name;
        }
    }
    out->text[0] = '\0';
    if (nearest != NULL)
        (void)snprintf(out->text, sizeof out->text, "; did you mean '%s'?", nearest);
    else
        list_all(known, out);
    return out->text;
}
