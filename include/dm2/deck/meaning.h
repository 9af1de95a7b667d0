/* The meaning of a deck: the checked config as a canonical text. Two decks of one meaning are one run,
 * whatever their comments, order, units, lets and included files.
 *
 * A line per keyword that is given or has a default, "body lid: velocity 0 -0.01"; blocks and keywords in the
 * schema's order; numbers in base units with the fewest digits that read back, so that equal texts mean equal
 * doubles, and -0 is 0. Blocks whose order numbers something (materials, phases, bodies, loads, probes) stand
 * in deck order, all others by their names, interactions from the least to the most specific.
 */
#ifndef DM2_DECK_MEANING_H
#define DM2_DECK_MEANING_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/sha256.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"

/* What a keyword has a part in. */
enum deck_part {
    PART_MEANING, /* the states of the run */
    PART_COLUMNS, /* the columns and rows of tables, without any effect on states */
    PART_LOOKS,   /* when and in which form something is written, and how long the run is */
    PART_WAYS,    /* how the run is computed; no bit of a result depends on these */
    PART_COUNT
};
enum { PARTS_ALL = (1 << PART_COUNT) - 1 };

struct deck_meaning {
    char *text; /* NUL-terminated */
    size_t length;
    unsigned char digest[SHA256_BYTES]; /* of the text without its NUL */
};

/* The lines of the keywords of these parts, bits 1 << enum deck_part. The caller frees *out with
 * meaning_free. DM2_MEMORY; *out is then empty. */
enum dm2_status meaning_build(const struct config *config, unsigned parts, struct deck_meaning *out,
                              struct dm2_error *err);
void meaning_free(struct deck_meaning *meaning);

/* The config of the deck that has the meaning text[0 .. length), of any bytes, with PART_MEANING alone:
 * keywords of other parts have their defaults, `steps` is 1. *out is freed by config_free. DM2_PROTOCOL: the
 * text is no meaning; DM2_MEMORY. Then *out is empty. */
enum dm2_status meaning_load(const char *text, size_t length, struct config *out, struct dm2_error *err);

/* Says in which keyword, or in which order of blocks, two texts of meaning_build first differ, as a sentence
 * without its end: "`velocity` of body piston was 0 -0.01, is 0 -0.02 cm/us". False: the texts are the same.
 * Texts may be any bytes. */
enum { MEANING_DIFFERENCE = 400 };
bool meaning_difference(const char *was, size_t was_length, const char *is, size_t is_length,
                        char out[MEANING_DIFFERENCE]);

#endif
