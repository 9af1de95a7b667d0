/* From ASSIGN to READY: the rank's subdomain, generated from the deck or restored from the state that the
 * client sends. */
#include "server_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/cluster/wire.h"
#include "dm2/output/state_hash.h"

static const double TIMEOUTS_MOST = 10.0; /* bound of s->timeout, in units of options->timeout */

/* Compares grid, number of elements and interfaces of the client with the server's. */
static enum dm2_status check_assignment(struct session *s, struct dm2_error *err)
{
    const struct assign_message *a = &s->assign;
    const struct grid *g = model_grid(s->model);
    if (a->cx != g->cx || a->cy != g->cy || a->elements != model_elements(s->model))
        return dm2_fail(err, DM2_PROTOCOL,
                        "the client has %d x %d cells and %llu elements, the server %d x %d and %zu: "
                        "install the same dm2 on both machines",
                        a->cx, a->cy, (unsigned long long)a->elements, g->cx, g->cy,
                        model_elements(s->model));
    if (a->end > s->config.steps)
        return dm2_fail(err, DM2_PROTOCOL,
                        "the client's run ends at step %lld, that of its deck at step %lld",
                        (long long)a->end, (long long)s->config.steps);
    s->config.steps = a->end;
    enum dm2_status status = decomposition_from_rects(g, a->ranks, a->rects, &s->decomposition, err);
    if (status != DM2_OK)
        return status;
    int interfaces[SIDE_COUNT];
    decomposition_interfaces(&s->decomposition, a->rank, interfaces);
    if (memcmp(interfaces, a->interfaces, sizeof interfaces) != 0)
        return dm2_fail(err, DM2_PROTOCOL,
                        "the client's interface array of rank %d is not that of its rectangles", a->rank);
    return DM2_OK;
}

/* The parts of the state to start from that have come. */
struct received_state {
    struct element *elements;
    struct pair_record *pairs;
    unsigned char *seen; /* by id: the element has come */
    size_t n_elements, n_pairs, elements_cap, pairs_cap;
    struct section_array sections[SECTION_COUNT];
};

/* Room for so many more elements and pairs. False without memory. */
static bool make_room(struct received_state *in, size_t n_elements, size_t n_pairs)
{
    struct element *elements = mem_grown(in->elements, &in->elements_cap, in->n_elements,
                                         in->n_elements + n_elements, sizeof *elements);
    if (elements == NULL)
        return false;
    in->elements = elements;
    struct pair_record *pairs =
        mem_grown(in->pairs, &in->pairs_cap, in->n_pairs, in->n_pairs + n_pairs, sizeof *pairs);
    if (pairs == NULL)
        return false;
    in->pairs = pairs;
    return true;
}

/* Appends the elements and pairs of one STATE message, whose head is *m. */
static enum dm2_status take_part(struct received_state *in, const struct model *model,
                                 const struct state_message *m, struct bytes_reader *r, struct dm2_error *err)
{
    const struct record_limits limits = record_limits_of(model);
    char why[BYTES_WHY] = "";
    r->why = why;
    if (!m->last && state_message_empty(m))
        return dm2_fail(err, DM2_PROTOCOL, "the client sent an empty part of a state");
    if ((uint64_t)in->n_pairs + m->n_pairs > WIRE_PAIRS_MOST * (uint64_t)limits.elements)
        return dm2_fail(err, DM2_PROTOCOL, "the client sent more than %d pairs per element", WIRE_PAIRS_MOST);
    if (!make_room(in, m->n_elements, m->n_pairs))
        return dm2_fail(err, DM2_MEMORY, "no memory for the state to start from");
    for (size_t k = 0; k < m->n_elements && !r->failed; k++) {
        struct element *e = &in->elements[in->n_elements];
        wire_get_element(r, &limits, e);
        if (!r->failed && in->seen[e->id])
            return dm2_fail(err, DM2_PROTOCOL, "the client sent element %u twice", e->id);
        if (!r->failed)
            in->seen[e->id] = 1;
        in->n_elements++;
    }
    for (size_t k = 0; k < m->n_pairs && !r->failed; k++)
        wire_get_pair(r, &limits, &in->pairs[in->n_pairs++]);
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < SECTION_COUNT && status == DM2_OK; k++)
        status = section_get((enum section)k, r, m->sections[k], &limits, &in->sections[k], err);
    r->why = NULL;
    if (status == DM2_OK && why[0] != '\0')
        return dm2_fail(err, DM2_NUMERIC, "the client's state has a value that cannot be: %s", why);
    return status != DM2_OK || bytes_done(r) ? status : server_not_decoded("STATE", err);
}

/* Makes the subdomain. */
static enum dm2_status restore_received(struct session *s, struct received_state *in, int64_t step,
                                        struct dm2_error *err)
{
    struct state_view view = {.step = step,
                              .elements = in->elements,
                              .n_elements = in->n_elements,
                              .pairs = in->pairs,
                              .n_pairs = in->n_pairs};
    for (int k = 0; k < SECTION_COUNT; k++) {
        enum dm2_status status = section_sort((enum section)k, &in->sections[k], err);
        if (status != DM2_OK)
            return status;
    }
    memcpy(view.sections, in->sections, sizeof view.sections);
    return subdomain_restore(s->model, &s->map, s->assign.rank, &view, &s->sd, err);
}

/* Receives the elements and pairs of this rank at step s->assign.start, in STATE messages until the last
 * one, and makes the subdomain of them. */
static enum dm2_status get_state(struct session *s, struct dm2_error *err)
{
    struct received_state in = {.seen = mem_zalloc(model_ids(s->model), 1)};
    struct state_message m = {.last = false};
    enum dm2_status status =
        in.seen == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for the state to start from") : DM2_OK;
    while (status == DM2_OK && !m.last) {
        struct bytes_reader r;
        status = server_expect(s, MESSAGE_STATE, LIMIT_STATE, server_deadline(s), &r, err);
        if (status != DM2_OK)
            break;
        message_get_state(&r, &m);
        if (r.failed || m.purpose != STATE_COPY || m.step != s->assign.start || m.step > s->config.steps)
            status = server_not_decoded("STATE", err);
        else
            status = take_part(&in, s->model, &m, &r, err);
    }
    if (status == DM2_OK)
        status = restore_received(s, &in, m.step, err);
    section_free(in.sections);
    free(in.elements);
    free(in.pairs);
    free(in.seen);
    return status;
}

enum dm2_status server_get_assignment(struct session *s, struct dm2_error *err)
{
    struct bytes_reader r;
    enum dm2_status status = server_expect(s, MESSAGE_ASSIGN, LIMIT_ASSIGN, server_deadline(s), &r, err);
    if (status != DM2_OK)
        return status;
    message_get_assign(&r, &s->assign);
    if (r.failed)
        return server_not_decoded("ASSIGN", err);
    s->summary->rank = s->assign.rank;
    s->summary->ranks = s->assign.ranks;
    s->timeout = fmax(s->timeout, fmin(2 * s->assign.timeout, TIMEOUTS_MOST * s->options->timeout));
    s->alive_every = alive_every(s->assign.timeout);
    status = check_assignment(s, err);
    if (status != DM2_OK)
        return status;
    s->map = (struct domain_map){
        .grid = model_grid(s->model), .ranks = s->assign.ranks, .owner = s->decomposition.owner};
    status = s->assign.start >= 0 ? get_state(s, err)
                                  : subdomain_create(s->model, &s->map, s->assign.rank, &s->sd, err);
    if (status != DM2_OK)
        return status;
    return exchange_open(&s->exchange, s->model, s->assign.rank, s->assign.ranks, err);
}

enum dm2_status server_send_ready(struct session *s, struct dm2_error *err)
{
    struct ready_message m = {.owned = subdomain_owned(s->sd),
                              .mirrored = subdomain_mirrored(s->sd),
                              .bytes = subdomain_bytes(s->sd),
                              .overlap = *subdomain_overlap(s->sd)};
    enum dm2_status status = s->assign.hash_every > 0 ? state_hash_subdomain(s->sd, &m.hash, err) : DM2_OK;
    if (status != DM2_OK)
        return status;
    bytes_clear(&s->out);
    message_put_ready(&s->out, &m);
    struct subdomain_times set_up;
    subdomain_take_times(s->sd, &set_up); /* the set-up counts to no step */
    return server_send(s, MESSAGE_READY, err);
}
