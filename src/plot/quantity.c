/* The table lists the words of --colour, in the order of quantity_words. */
#include "quantity.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "dm2/base/number.h"
#include "colour.h"

/* --- the table --- */

static double get_first(const double *tuple)
{
    return tuple[0];
}

static double get_second(const double *tuple)
{
    return tuple[1];
}

static double get_third(const double *tuple)
{
    return tuple[2];
}

static double get_speed(const double *tuple)
{
    return sqrt(tuple[0] * tuple[0] + tuple[1] * tuple[1]);
}

static double get_mean_stress(const double *tuple)
{
    return 0.5 * (tuple[0] + tuple[1]);
}

/* The largest shear strain in the plane. */
static double get_shear_strain(const double *tuple)
{
    double half = 0.5 * (tuple[0] - tuple[1]);
    return sqrt(half * half + tuple[2] * tuple[2]);
}

/* The change of area. */
static double get_area_strain(const double *tuple)
{
    return tuple[0] + tuple[1];
}

static const struct quantity_entry quantities[] = {
    {"material", "material", "kind", SCHEME_CATEGORY, get_first},
    {"velocity", "speed [cm/\u00b5s]", "velocity", SCHEME_SEQUENTIAL, get_speed},
    {"vx", "velocity x [cm/\u00b5s]", "velocity", SCHEME_DIVERGING, get_first},
    {"vy", "velocity y [cm/\u00b5s]", "velocity", SCHEME_DIVERGING, get_second},
    {"stress", "mean stress, tension positive [Mbar]", "stress", SCHEME_DIVERGING, get_mean_stress},
    {"stress-xx", "stress xx [Mbar]", "stress", SCHEME_DIVERGING, get_first},
    {"stress-yy", "stress yy [Mbar]", "stress", SCHEME_DIVERGING, get_second},
    {"stress-xy", "stress xy [Mbar]", "stress", SCHEME_DIVERGING, get_third},
    {"pressure", "pressure [Mbar]", "pressure", SCHEME_DIVERGING, get_first},
    {"temperature", "temperature [K]", "temperature", SCHEME_SEQUENTIAL, get_first},
    {"spin", "angular velocity [1/\u00b5s]", "spin", SCHEME_DIVERGING, get_first},
    {"links", "links", "links", SCHEME_SEQUENTIAL, get_first},
    {"contacts", "contacts", "contacts", SCHEME_SEQUENTIAL, get_first},
    {"bonds", "links at the start", "bonds", SCHEME_SEQUENTIAL, get_first},
    {"damage", "damage: lost share of links", "damage", SCHEME_SEQUENTIAL, get_first},
    {"strain", "largest shear strain", "strain", SCHEME_SEQUENTIAL, get_shear_strain},
    {"strain-area", "area strain", "strain", SCHEME_DIVERGING, get_area_strain},
    {"strain-xx", "strain xx", "strain", SCHEME_DIVERGING, get_first},
    {"strain-yy", "strain yy", "strain", SCHEME_DIVERGING, get_second},
    {"strain-xy", "strain xy", "strain", SCHEME_DIVERGING, get_third},
    {"fragment", "fragment", "fragment", SCHEME_CATEGORY, get_first},
    {"phase", "phase", "phase", SCHEME_CATEGORY, get_first},
    {"composition", "mass fraction of the product", "composition", SCHEME_SEQUENTIAL, get_third},
    {"grain", "grain", "grain", SCHEME_CATEGORY, get_first},
    {"body", "body", "body", SCHEME_CATEGORY, get_first},
};

enum { N_QUANTITIES = sizeof quantities / sizeof quantities[0] };

const char *quantity_words(void)
{
    return "material velocity vx vy stress stress-xx stress-yy stress-xy pressure temperature spin links "
           "contacts bonds damage strain strain-area strain-xx strain-yy strain-xy fragment phase "
           "composition grain "
           "body, or ARRAY or ARRAY:COMPONENT of the file";
}

/* --- choosing --- */

void quantity_list_arrays(const struct vtp *vtp, char *out, size_t size)
{
    size_t used = 0;
    out[0] = '\0';
    for (size_t k = 0; k < vtp->n_arrays && used < size; k++)
        if (strcmp(vtp->arrays[k].section, "PointData") == 0)
            used +=
                (size_t)snprintf(out + used, size - used, "%s%s", used == 0 ? "" : " ", vtp->arrays[k].name);
}

/* Finds an array of the points that is not in the table, by NAME or NAME:COMPONENT, and sets q->name. */
static const struct vtp_array *find_array(struct shown_quantity *q, const char *word, size_t *component)
{
    const char *colon = strrchr(word, ':');
    size_t length = colon == NULL ? strlen(word) : (size_t)(colon - word);
    int64_t number = 1;
    if (length >= VTP_NAME_MAX ||
        (colon != NULL && (!number_parse_integer(colon + 1, strlen(colon + 1), &number) || number < 1)))
        return NULL;
    (void)snprintf(q->name, sizeof q->name, "%.*s", (int)length, word);
    const struct vtp_array *array = vtp_find(q->vtp, "PointData", q->name);
    if (array == NULL || (uint64_t)number > array->components)
        return NULL;
    if (array->components > 1)
        (void)snprintf(q->name, sizeof q->name, "%.*s, component %d", (int)length, word, (int)number);
    *component = (size_t)number - 1;
    return array;
}

static bool has_negative(const struct shown_quantity *q)
{
    for (size_t i = 0; i < q->vtp->n_points; i++)
        if (q->values[i * q->components] < 0)
            return true;
    return false;
}

enum dm2_status quantity_choose(struct shown_quantity *q, const struct vtp *vtp, const char *word,
                                struct dm2_error *err)
{
    const struct vtp_array *values;
    size_t component = 0;
    char names[400];
    bool known = false;
    q->vtp = vtp;
    for (int i = 0; i < N_QUANTITIES && !known; i++) {
        known = strcmp(word, quantities[i].word) == 0;
        q->entry = quantities[i];
    }
    values = known ? vtp_find(q->vtp, "PointData", q->entry.array) : find_array(q, word, &component);
    quantity_list_arrays(q->vtp, names, sizeof names);
    if (!known && values == NULL)
        return dm2_fail(err, DM2_USAGE,
                        "'%.60s' is nothing to colour by; choose one of: %s. The file has the arrays: %.200s",
                        word, quantity_words(), names);
    size_t least = q->entry.value == get_first || !known ? 1
                   : q->entry.value == get_second        ? 2
                                                         : 3; /* components that the function reads */
    if (values == NULL || values->components < least)
        return dm2_fail(err, DM2_USAGE,
                        "'%s' needs an array '%s' that the snapshot does not have; it has: %s", word,
                        q->entry.array, names);
    q->values = values->values + component;
    q->components = values->components;
    if (!known)
        q->entry = (struct quantity_entry){word, q->name, values->name,
                                           has_negative(q) ? SCHEME_DIVERGING : SCHEME_SEQUENTIAL, get_first};
    return DM2_OK;
}

double quantity_value(const struct shown_quantity *q, size_t i)
{
    return q->entry.value(q->values + i * q->components);
}

enum dm2_status quantity_choose_range(struct shown_quantity *q, const double range[2], struct dm2_error *err)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < q->vtp->n_points; i++) {
        double value = quantity_value(q, i);
        if (isfinite(value)) {
            low = fmin(low, value);
            high = fmax(high, value);
        }
    }
    if (low > high)
        low = high = 0;
    if (q->entry.scheme == SCHEME_DIVERGING) {
        high = fmax(fabs(low), fabs(high));
        low = -high;
    }
    if (!isnan(range[0])) {
        low = range[0];
        high = range[1];
        if (!(low < high) || !isfinite(low) || !isfinite(high))
            return dm2_fail(err, DM2_USAGE, "the range of the colours needs a minimum below its maximum");
    }
    if (high - low <= 1e-9 * fmax(fabs(low), fabs(high))) {
        double half = low == 0 ? 1 : 0.01 * fabs(low);
        low -= half;
        high += half;
    }
    q->low = low;
    q->high = high;
    return DM2_OK;
}

/* --- categories --- */

void quantity_category_name(const struct shown_quantity *q, size_t category, char *out, size_t size)
{
    const struct vtp_names *names = strcmp(q->entry.word, "material") == 0 ? &q->vtp->materials
                                    : strcmp(q->entry.word, "body") == 0   ? &q->vtp->bodies
                                                                           : NULL;
    if (names != NULL && category < names->n)
        (void)snprintf(out, size, "%s", names->name[category]);
    else
        (void)snprintf(out, size, "%s %zu", q->entry.word, category);
}

/* The many grains are spread over the colours by a hash of their number. */
uint32_t quantity_category_colour(const struct shown_quantity *q, double value)
{
    uint64_t category = value >= 0 && value < 0x1p53 ? (uint64_t)value : 0;
    if (strcmp(q->entry.word, "grain") == 0)
        category = category * 0x9E3779B97F4A7C15u >> 40;
    return (uint32_t)(category % COLOUR_CATEGORIES);
}

size_t quantity_categories(const struct shown_quantity *q, size_t out[QUANTITY_CATEGORIES_MAX + 1])
{
    size_t n = 0;
    for (size_t i = 0; i < q->vtp->n_points; i++) {
        double value = quantity_value(q, i);
        size_t category = value >= 0 && value < 0x1p53 ? (size_t)value : 0, at = 0;
        while (at < n && out[at] < category)
            at++;
        if ((at < n && out[at] == category) || at > QUANTITY_CATEGORIES_MAX)
            continue;
        size_t kept = n > QUANTITY_CATEGORIES_MAX ? QUANTITY_CATEGORIES_MAX : n;
        for (size_t k = kept; k > at; k--)
            out[k] = out[k - 1];
        out[at] = category;
        n = kept + 1;
    }
    return n;
}
