/* Writes a copy of a state file in which one number of one element is another, under a checksum that fits:
 *   patch_state FROM TO ID FIELD VALUE
 * FIELD is a name of the table in engine/record.c, of several numbers the first, or share1, the second share.
 * For the FIELDs stretch and spring, ID is the index of a pair. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/engine/record.h"
#include "dm2/output/state.h"

static bool patch_pair(struct pair_record *p, const char *field, double value)
{
    if (strcmp(field, "stretch") == 0)
        p->stretch = value;
    else if (strcmp(field, "spring") == 0)
        p->spring = value;
    else
        return false;
    return true;
}

static bool patch(struct element *e, const char *field, double value)
{
    if (strcmp(field, "share1") == 0) {
        e->share[1] = value;
        return true;
    }
    for (const struct element_field *f = element_fields; f < element_fields + ELEMENT_FIELDS; f++) {
        unsigned char *at = (unsigned char *)e + f->offset;
        if (strcmp(f->name, field) != 0)
            continue;
        if (f->type == FIELD_F64)
            memcpy(at, &value, sizeof value);
        else if (f->type == FIELD_U32)
            *(uint32_t *)(void *)at = (uint32_t)value;
        else if (f->type == FIELD_I32)
            *(int32_t *)(void *)at = (int32_t)value;
        else if (f->type == FIELD_U16)
            *(uint16_t *)(void *)at = (uint16_t)value;
        else
            *at = (uint8_t)value;
        return true;
    }
    return false;
}

int main(int argc, char **argv)
{
    struct dm2_error err = {0};
    struct state s;
    if (argc != 6)
        return 2;
    if (state_read(argv[1], &s, &err) != DM2_OK) {
        printf("%s\n", err.text);
        return 1;
    }
    size_t id = strtoul(argv[3], NULL, 10), k = element_find(s.elements, s.n_elements, (uint32_t)id);
    double value = strtod(argv[5], NULL);
    if (!(id < s.n_pairs && patch_pair(&s.pairs[id], argv[4], value)) &&
        (k == s.n_elements || !patch(&s.elements[k], argv[4], value)))
        return 2;
    const struct state_view view = state_view_of(&s);
    enum dm2_status status = state_write(argv[2], &view, &err);
    if (status != DM2_OK)
        printf("%s\n", err.text);
    state_free(&s);
    return status == DM2_OK ? 0 : 1;
}
