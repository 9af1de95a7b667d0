/* The state is read once; the deck gets a text about it, the run its elements. */
#include "run_start.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/text.h"
#include "dm2/deck/start.h"
#include "dm2/engine/stage.h"
#include "session.h"

/* Adds the text about run->from to the source. */
static enum dm2_status add_text(struct run *run, struct dm2_error *err)
{
    struct bytes_writer text = {0};
    const struct state_view view = state_view_of(&run->from);
    enum dm2_status status = stage_describe(run->from_path, &view, run->from_digest, &text, err);
    if (status == DM2_OK)
        status = deck_source_begin(&run->source, (const char *)text.data, text.length, err);
    bytes_free(&text);
    return status;
}

enum dm2_status run_start_read(const struct run_options *o, struct run *run, struct dm2_error *err)
{
    const char *path = o->start != NULL ? o->start : run->source.state;
    struct dm2_error why = {0};
    if (path == NULL)
        return DM2_OK;
    run->from_path = text_join(path, "", "");
    if (run->from_path == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the name of the state to start from");
    enum dm2_status status = state_read(path, &run->from, &why);
    if (status == DM2_OK && !session_digest(path, run->from_digest))
        status = dm2_fail(&why, DM2_IO, "%s: cannot be read again", path);
    if (status == DM2_OK)
        status = add_text(run, &why);
    if (status == DM2_OK)
        return DM2_OK;
    return dm2_fail(err, status == DM2_MEMORY ? status : DM2_DECK, "the state to start from: %.400s%s",
                    why.text,
                    status == DM2_IO && o->start == NULL ? "; --start FILE names another place" : "");
}

static enum dm2_status begin(struct run *run, const struct start_source *from, struct dm2_error *err)
{
    struct state *s = &run->from;
    struct stage_records r = {s->elements, s->n_elements, s->pairs, s->n_pairs, {{NULL, 0, 0}}};
    memcpy(r.sections, s->sections, sizeof r.sections);
    s->elements = NULL;
    s->pairs = NULL;
    memset(s->sections, 0, sizeof s->sections);
    state_free(s);
    enum dm2_status status = stage_begin(run->model, from, &r, err);
    struct state *to = &run->state;
    *to = (struct state){.step = run->config.n_start,
                         .elements = r.elements,
                         .n_elements = r.n_elements,
                         .pairs = r.pairs,
                         .n_pairs = r.n_pairs};
    memcpy(to->sections, r.sections, sizeof r.sections);
    return status;
}

enum dm2_status run_start_take(struct run *run, struct dm2_error *err)
{
    const struct deck_text *text = deck_source_start(&run->source);
    struct start_source from;
    struct dm2_error why = {0};
    enum dm2_status status = start_get(text->text, text->length, &from, &why);
    if (status == DM2_OK) {
        const struct record_limits limits = record_limits_of(run->model);
        status = begin(run, &from, &why);
        if (status == DM2_OK)
            status = state_check(run->from_path, &run->state, &limits, &why);
        start_free(&from);
    }
    run->staged = status == DM2_OK;
    return status == DM2_OK ? DM2_OK
                            : dm2_fail(err, status == DM2_PROTOCOL ? DM2_DECK : status, "%.450s", why.text);
}
