/* A crack: one link that has broken. The loops of forces note the cracks of an evaluation; a result holds
 * each crack once, because the owner of the lower id alone notes it. */
#ifndef DM2_ENGINE_CRACK_H
#define DM2_ENGINE_CRACK_H

#include <stddef.h>
#include <stdint.h>

/* How the link was loaded when it broke (docs/physics.md, section 5). */
enum crack_mode {
    CRACK_PULLED,  /* its bond held at least as much energy as its spring, and had not yielded in tension */
    CRACK_YIELDED, /* the same, and it had yielded: its residual stretch was above 0 */
    CRACK_SHEARED, /* its spring held more energy than its bond */
    CRACK_MODES
};

struct crack {
    uint32_t id_a, id_b; /* of the two elements, id_a < id_b */
    double r[2];         /* midway between the two elements, wrapped into the domain, cm */
    double energy;       /* freed as heat, g cm2/us2 (law_freed); 0 between elements of prescribed motion */
    uint8_t mode;        /* enum crack_mode */
    uint8_t grains;      /* 1: both elements are of one grain; 2: of two */
};

/* Cracks in any order; zeroed: none. */
struct crack_list {
    struct crack *items; /* [n], malloc'd */
    size_t n, cap;
};

/* Appends *crack. 0, or -1 without memory. */
int crack_list_add(struct crack_list *list, const struct crack *crack);

/* Frees the cracks and empties the list. */
void crack_list_free(struct crack_list *list);

/* Sorts the cracks by (id_a, id_b), an order that no decomposition changes. */
void crack_list_sort(struct crack_list *list);

#endif
