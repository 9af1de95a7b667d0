/* The steps that must have rows follow from the deck, so the table is compared with them line by line: a row
 * that is missing, cut short, of another step or there twice is found, wherever it is. What follows the last
 * row that is due before the checkpoint was written after it, and will be written again. */
#include "resume.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* The length of the line at text[0..n) with its newline; 0 where it has none. */
static size_t line_length(const unsigned char *text, size_t n)
{
    const unsigned char *end = memchr(text, '\n', n);
    return end == NULL ? 0 : (size_t)(end - text) + 1;
}

static bool is_of_step(const unsigned char *line, size_t length, int64_t step)
{
    char prefix[32];
    int n = snprintf(prefix, sizeof prefix, "%" PRId64 ",", step);
    return length > (size_t)n && memcmp(line, prefix, (size_t)n) == 0;
}

enum dm2_status resume_keep(const char *path, const unsigned char *text, size_t n,
                            const struct resume_plan *plan, size_t *keep, struct dm2_error *err)
{
    size_t at = line_length(text, n);
    if (at == 0)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: has no heading: it is not the table that the checkpoint needs", path);
    for (int64_t step = 0; step < plan->step; step++) {
        for (int64_t row = 0; row < plan->rows && plan->due(plan->context, step); row++) {
            size_t length = line_length(text + at, n - at);
            if (!is_of_step(text + at, length, step))
                return dm2_fail(
                    err, DM2_PROTOCOL,
                    "%s: the row of step %" PRId64 " is missing, which the run wrote before its checkpoint "
                    "of step %" PRId64 ": bring the tables of the run directory along with its checkpoint, "
                    "and give the same --steps",
                    path, step, plan->step);
            at += length;
        }
    }
    *keep = at;
    return DM2_OK;
}
