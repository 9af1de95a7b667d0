/* Flaws: which links are missing at the start. */
#ifndef DM2_ENGINE_FLAWS_H
#define DM2_ENGINE_FLAWS_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/deck/config.h"

/* One end of a link. */
struct link_end {
    uint32_t id;
    uint16_t body;
    const double *r; /* cm */
};

/* Is the link between two neighbours missing at the start, because the link crosses the line of a flaw or by
 * chance (missing_links of the body)? `apart` is the shortest vector from b to a across periodic sides, cm.
 * The answer does not depend on the order of a and b. */
bool flaws_miss(const struct config *config, struct link_end a, struct link_end b, const double apart[2]);

#endif
