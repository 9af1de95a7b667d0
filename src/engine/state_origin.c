/* The origin of a run's states: the deck's meaning, names in the order in which records number them, and the
 * numbers of the next element and grain. */
#include "dm2/engine/section.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/deck/meaning.h"
#include "tables.h"

static void add_name(struct state_origin *o, enum name_sort sort, const char *text)
{
    struct state_name *name = &o->names[o->n_names++];
    name->sort = sort;
    memcpy(name->text, text, strlen(text) + 1);
}

enum dm2_status state_origin_build(const struct model *model, struct state_origin *out, struct dm2_error *err)
{
    const struct config *c = model->config;
    size_t kinds = config_kinds(c);
    *out = (struct state_origin){
        .n_start = c->n_start,
        .t_start = c->t_start,
        .next_id = (uint32_t)model->n_ids,
        .next_grain = c->start.next_grain + (uint32_t)model->n_grains,
        .names = mem_zalloc(kinds + c->n_bodies + c->n_walls + c->n_loads, sizeof *out->names)};
    if (out->names == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the names of a state");
    for (size_t k = 0; k < kinds; k++) {
        struct kind_name name;
        add_name(out, NAME_KIND, config_kind_name(c, k, &name));
    }
    for (size_t b = 0; b < c->n_bodies; b++)
        add_name(out, NAME_BODY, c->bodies[b].name);
    for (size_t w = 0; w < c->n_walls; w++)
        add_name(out, NAME_WALL, c->walls[w].name);
    for (size_t k = 0; k < c->n_loads; k++) /* the quantities of one block have one name */
        if (k == 0 || strcmp(c->loads[k].name, c->loads[k - 1].name) != 0)
            add_name(out, NAME_LOAD, c->loads[k].name);
    struct deck_meaning meaning;
    enum dm2_status status = meaning_build(c, 1u << PART_MEANING, &meaning, err);
    if (status != DM2_OK) {
        state_origin_free(out);
        return status;
    }
    out->text = meaning.text;
    out->text_length = meaning.length;
    memcpy(out->digest, meaning.digest, sizeof out->digest);
    return DM2_OK;
}

void state_origin_free(struct state_origin *origin)
{
    free(origin->text);
    free(origin->names);
    *origin = (struct state_origin){.n_start = 0};
}
