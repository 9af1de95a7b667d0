/* Colours that keep their order in grey and for colour-blind readers. */
#ifndef DM2_PLOT_COLOUR_H
#define DM2_PLOT_COLOUR_H

#include <stddef.h>

enum { COLOUR_TEXT = 8, COLOUR_CATEGORIES = 8 };

/* Each writes "#rrggbb". */

/* The viridis map, perceptually uniform, t from 0 (dark) to 1 (light); t outside is clamped. */
void colour_sequential(double t, char out[COLOUR_TEXT]);

/* Blue through light grey to red (Moreland's "cool to warm"): 0.5 is the middle. */
void colour_diverging(double t, char out[COLOUR_TEXT]);

/* Distinct colours after Okabe and Ito, repeated after COLOUR_CATEGORIES of them. */
void colour_category(size_t index, char out[COLOUR_TEXT]);

#endif
