/* Colour maps as short tables, interpolated linearly in sRGB, which at this spacing differs from the
 * originals by at most a step or two: viridis (S. van der Walt, N. Smith, CC0), cool-to-warm (K. Moreland,
 * 2009), and the palette of M. Okabe and K. Ito, without its black. */
#include "colour.h"

#include <stdio.h>

static const unsigned viridis[] = {0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d,
                                   0x2c728e, 0x26828e, 0x21918c, 0x1fa088, 0x28ae80, 0x3fbc73,
                                   0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725};

static const unsigned cool_to_warm[] = {0x3b4cc0, 0x5977e3, 0x7b9ff9, 0x9ebeff, 0xc0d4f5, 0xdddcdc,
                                        0xf2cbb7, 0xf7ac8e, 0xee8468, 0xd65244, 0xb40426};

static const unsigned categories[COLOUR_CATEGORIES] = {0x0072b2, 0xe69f00, 0x009e73, 0xd55e00,
                                                       0x56b4e9, 0xcc79a7, 0x999999, 0xf0e442};

static void interpolate_colour(const unsigned *table, size_t n, double t, char out[COLOUR_TEXT])
{
    double place = (t > 0 ? (t < 1 ? t : 1) : 0) * (double)(n - 1);
    size_t i = (size_t)place;
    if (i > n - 2)
        i = n - 2;
    double part = place - (double)i;
    unsigned mixed = 0;
    for (int shift = 0; shift <= 16; shift += 8) {
        double a = table[i] >> shift & 255, b = table[i + 1] >> shift & 255;
        mixed |= (unsigned)(a + part * (b - a) + 0.5) << shift;
    }
    (void)snprintf(out, COLOUR_TEXT, "#%06x", mixed & 0xffffff);
}

void colour_sequential(double t, char out[COLOUR_TEXT])
{
    interpolate_colour(viridis, sizeof viridis / sizeof viridis[0], t, out);
}

void colour_diverging(double t, char out[COLOUR_TEXT])
{
    interpolate_colour(cool_to_warm, sizeof cool_to_warm / sizeof cool_to_warm[0], t, out);
}

void colour_category(size_t index, char out[COLOUR_TEXT])
{
    (void)snprintf(out, COLOUR_TEXT, "#%06x", categories[index % COLOUR_CATEGORIES]);
}
