/* The dimensions and limits with which the tables of keywords are written, and the tables that have files of
 * their own. */
#ifndef DM2_DECK_KEYS_H
#define DM2_DECK_KEYS_H

#include <math.h>

#include "schema.h"

#define DIM(l, m, t, k)                                                                                      \
    {                                                                                                        \
        l, m, t, k, 0                                                                                        \
    }
#define PLAIN           DIM(0, 0, 0, 0)
#define LENGTH          DIM(1, 0, 0, 0)
#define MASS            DIM(0, 1, 0, 0)
#define TIME            DIM(0, 0, 1, 0)
#define TEMPERATURE     DIM(0, 0, 0, 1)
#define PER_TEMPERATURE DIM(0, 0, 0, -1)
#define VELOCITY        DIM(1, 0, -1, 0)
#define ACCELERATION    DIM(1, 0, -2, 0)
#define DENSITY         DIM(-3, 1, 0, 0)
#define STRESS          DIM(-1, 1, -2, 0)
#define PER_STRESS      DIM(1, -1, 2, 0)
#define STIFFNESS       DIM(0, 1, -2, 0)
#define ENERGY          DIM(2, 1, -2, 0)
#define HEAT_CAPACITY   DIM(2, 0, -2, -1)
#define CONDUCTIVITY    DIM(1, 1, -3, -1)
#define SPECIFIC_ENERGY DIM(2, 0, -2, 0)
#define MOLAR_ENERGY                                                                                         \
    {                                                                                                        \
        2, 1, -2, 0, -1                                                                                      \
    }

#define ANY          .low = -HUGE_VAL, .high = HUGE_VAL
#define POSITIVE     .low = 0, .low_open = true, .high = HUGE_VAL
#define NOT_NEGATIVE .low = 0, .high = HUGE_VAL
#define SPIN         DIM(0, 0, -1, 0)
#define FORCE        DIM(1, 1, -2, 0)

enum { LOAD_KEYS = 18 };
extern const struct deck_key load_keys[LOAD_KEYS];

#endif
