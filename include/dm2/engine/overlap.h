/* Elements that start pressed into each other: closer than their contact distance, or than their own lattice
 * puts them, with a force. */
#ifndef DM2_ENGINE_OVERLAP_H
#define DM2_ENGINE_OVERLAP_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"

/* Elements closer than this share of their contact distance are an error, because they would explode. */
#define OVERLAP_MOST 0.5

struct overlap {
    uint64_t pairs;   /* how many, and all pairs below OVERLAP_MOST; 0: the rest is not valid */
    double ratio;     /* of the deepest pair: distance over contact distance */
    uint32_t id[2];   /* its elements, the lower id first; of pairs of one ratio the lowest ids */
    uint16_t body[2]; /* their bodies */
    double r[2][2];   /* their places, cm */
};

/* Adds the pairs of another part of the system to *o. */
void overlap_merge(struct overlap *o, const struct overlap *part);

/* DM2_DECK: the deepest pair is closer than OVERLAP_MOST; the same text for any decomposition. */
enum dm2_status overlap_check(const struct overlap *o, const struct config *config, struct dm2_error *err);

/* Writes a warning with number, deepest pair, places and remedy into line, without a newline. False, and an
 * empty line, without pairs. */
enum { OVERLAP_LINE = 500 };
bool overlap_describe(const struct overlap *o, const struct config *config, char line[OVERLAP_LINE]);

#endif
