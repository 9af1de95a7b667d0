/* Checks of probes: what they measure, and which columns they can report. */
#include <math.h>

#include "dm2/deck/shape.h"
#include "check.h"

/* `shapes_known`: the shapes of all bodies are valid. */
static void check_region(const struct deck_binding *b, size_t i, bool shapes_known)
{
    const struct config *c = b->config;
    const struct probe_config *probe = &c->probes[i];
    const double *box = probe->box;
    struct deck_place place = binding_place(b, b->blocks[BLOCK_PROBE][i], "region", 0);
    struct shape_config region = {.kind = SHAPE_RECTANGLE, .box = {box[0], box[1], box[2], box[3]}};
    bool meets = !shapes_known || c->n_bodies == 0;
    if (!(box[0] < box[2] && box[1] < box[3])) {
        findings_error(b->findings, place, "a region is x0 y0 x1 y1 with x0 < x1 and y0 < y1");
        return;
    }
    for (size_t j = 0; j < c->n_bodies && !meets; j++)
        meets = shape_image_overlaps(&region, c, &c->bodies[j].shape);
    if (!meets)
        findings_error(b->findings, place, "the region of the probe '%s' holds no body", probe->name);
    for (int a = 0; a < 2 && (probe->report >> REPORT_POROSITY & 1u); a++)
        if (c->periodic[a] && box[a + 2] - box[a] > c->size[a] * (1 + 1e-12))
            findings_error(b->findings, place,
                           "the region of the probe '%s' is larger than the periodic domain, so that its "
                           "porosity has no meaning: make the region at most as large",
                           probe->name);
}

/* What a body or a wall does not report. */
static void check_report(const struct deck_binding *b, size_t block, const struct probe_config *probe)
{
    static const struct {
        enum probe_quantity quantity;
        const char *word;
    } not_of_walls[] = {
        {REPORT_STRESS, "stress"}, {REPORT_KINETIC, "kinetic"}, {REPORT_POROSITY, "porosity"}};
    const struct config *c = b->config;
    struct deck_place place = binding_place(b, block, "report", 0);
    if (!probe->wall && (probe->report >> REPORT_HEAT & 1u))
        findings_error(b->findings, place, "'heat' is of a wall, and the probe '%s' is not: leave 'heat' out",
                       probe->name);
    if (probe->mover >= 0 && !probe->wall && (probe->report >> REPORT_POROSITY & 1u))
        findings_error(b->findings, place,
                       "'porosity' is of a region, and the probe '%s' is of a body: leave 'porosity' out",
                       probe->name);
    if (!probe->wall)
        return;
    const size_t wall = (size_t)probe->mover - c->n_bodies;
    for (size_t k = 0; k < sizeof not_of_walls / sizeof not_of_walls[0]; k++)
        if (probe->report >> not_of_walls[k].quantity & 1u)
            findings_error(b->findings, place,
                           "'%s' is of elements, and the probe '%s' is of the wall '%s': leave '%s' out",
                           not_of_walls[k].word, probe->name, c->walls[wall].name, not_of_walls[k].word);
    if ((probe->report >> REPORT_TEMPERATURE & 1u) && !config_wall_conducts(c, wall))
        findings_error(b->findings, place,
                       "the wall '%s' of the probe '%s' has no temperature: give the wall one, or leave "
                       "'temperature' out",
                       c->walls[wall].name, probe->name);
}

void check_probes(const struct deck_binding *b, bool shapes_known)
{
    size_t regions = 0;
    for (size_t i = 0; i < b->config->n_probes; i++) {
        const struct probe_config *probe = &b->config->probes[i];
        size_t block = b->blocks[BLOCK_PROBE][i];
        bool region = binding_given(b, block, "region"), body = binding_given(b, block, "body");
        if (region && body)
            findings_error(b->findings, binding_place(b, block, "body", 0),
                           "give 'region' or 'body', not both");
        else if (binding_missing(b, block, "region") && binding_missing(b, block, "body"))
            findings_error(
                b->findings, binding_place(b, block, "region", 0),
                "the probe '%s' lacks 'body' or 'region': give the body or wall, or x0 y0 x1 y1 of the "
                "elements that are measured",
                probe->name);
        else if (region)
            check_region(b, i, shapes_known);
        regions += probe->mover < 0;
        if (probe->mover < 0 && regions == REGION_MAX + 1)
            findings_error(
                b->findings, b->tree->blocks[block].word,
                "the deck has more than %d blocks 'probe' of regions; a probe of a body has no such "
                "limit",
                REGION_MAX);
        check_report(b, block, probe);
    }
}
