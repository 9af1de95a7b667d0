/* One session, from HELLO to DONE.
 *
 * The order of messages is the flow of the paper's Fig. 7 and of docs/protocol.md; each function below is one
 * stage of it and either goes on or fails, and whatever fails ends up in server_session, which tells the
 * client and frees everything. Nothing survives a session: the next client meets a server as fresh as the
 * first did.
 *
 * A step: forces, move, pack, one STEP message out, one NEXT message in, take. Between the two messages the
 * forces of the next step begin, for all pairs that need nothing from the message. What the client asked for
 * with its last NEXT decides whether the segments are updates or the parcels of a rebuild; with `redo` it
 * asks for the latter after all, and the same step is sent again. */
#include "dm2/cluster/server.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "dm2/base/clock.h"
#include "dm2/base/fingerprint.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/cluster/messages.h"
#include "dm2/deck/digest.h"
#include "dm2/engine/subdomain.h"
#include "dm2/output/results.h"
#include "dm2/output/state_hash.h"
#include "exchange.h"
#include "lobby.h"
#include "state_parts.h"

static const double HANG_UP_SECONDS = 2.0; /* for a peer to read our last message */
static const double MOST_PATIENCE = 10.0;  /* times --timeout, however patient the client is itself */

struct session {
    const struct server_options *options;
    struct lobby *lobby; /* looked after while the client is waited for */
    struct session_summary *summary;
    struct channel channel;
    bool greeted; /* WELCOME is sent: the client may say that it is at work */
    struct bytes_writer out;
    struct deck_message deck;
    struct config config;
    bool loaded; /* config is to be freed */
    struct model *model;
    struct assign_message assign;
    struct decomposition decomposition;
    struct domain_map map;
    struct subdomain *sd;
    struct exchange exchange;
    double timeout;
    double quiet_since;      /* the last message, from here or from there */
    double alive_every;      /* seconds of work from then until ALIVE, and from one to the next */
    struct dm2_error unsaid; /* what came of the one that could not be sent */
    double heard;            /* when the last message had come: work since then is `busy` */
    double ahead;            /* seconds of work on this step before that */
    bool counts;             /* the processor's seconds, since `counted`; see count_cpu */
    double counted;
    struct server_times times;
};

static struct deadline patience(const struct session *s)
{
    return deadline_in(s->timeout, s->options->cancel);
}

/* Sends what s->out holds. */
static enum dm2_status send_out(struct session *s, enum message_type type, struct dm2_error *err)
{
    if (s->unsaid.status != DM2_OK)
        return dm2_fail(err, s->unsaid.status, "%s", s->unsaid.text);
    if (s->out.failed)
        return dm2_fail(err, DM2_MEMORY, "no memory for a message");
    enum dm2_status status =
        channel_send(&s->channel, (uint8_t)type, 0, s->out.data, s->out.length, patience(s), err);
    s->quiet_since = clock_now();
    return status;
}

/* Called in the midst of work that may take longer than the client waits. What goes wrong here is told
 * by the next message that is sent. */
static void beat(void *context)
{
    struct session *s = context;
    double now = clock_now();
    if (now - s->quiet_since < s->alive_every || s->unsaid.status != DM2_OK)
        return;
    s->quiet_since = now;
    (void)channel_send(&s->channel, MESSAGE_ALIVE, 0, NULL, 0, patience(s), &s->unsaid);
    lobby_look(s->lobby);
}

/* Is this the message that is due? */
static enum dm2_status check_type(const struct frame *f, enum message_type type, struct bytes_reader *out,
                                  struct dm2_error *err)
{
    *out = bytes_reader_of(f->payload, f->length);
    if (f->type == type)
        return DM2_OK;
    char name[2][16];
    if (f->type == MESSAGE_ERROR) {
        struct error_message m;
        message_get_error(out, &m);
        return dm2_fail(err, DM2_NET, "the client ended the session: %s", m.text);
    }
    return dm2_fail(err, DM2_PROTOCOL, "the client sent %s where %s is due", message_name(f->type, name[0]),
                    message_name((uint8_t)type, name[1]));
}

/* Waits for a frame, and meanwhile looks after those who stand outside. */
static enum dm2_status receive_frame(struct session *s, uint32_t limit, struct deadline until,
                                     struct frame *f, struct dm2_error *err)
{
    bool complete = false;
    enum dm2_status status = DM2_OK;
    if (channel_pending(&s->channel))
        status = channel_receive_some(&s->channel, limit, &complete, f, err);
    while (status == DM2_OK && !complete) {
        if (!lobby_wait(s->lobby, s->channel.fd, until))
            return channel_receive(&s->channel, limit, until, f,
                                   err); /* which also says why there is nothing */
        status = channel_receive_some(&s->channel, limit, &complete, f, err);
    }
    return status;
}

/* Waits for a message; with each sign of life from the client, as long again. */
static enum dm2_status receive(struct session *s, uint32_t limit, struct deadline until, struct frame *f,
                               struct dm2_error *err)
{
    for (;;) {
        enum dm2_status status = receive_frame(s, limit, until, f, err);
        s->quiet_since = clock_now();
        if (status != DM2_OK || f->type != MESSAGE_ALIVE || f->length != 0 || !s->greeted)
            return status;
        until = patience(s);
    }
}

/* Waits for a message of this type. */
static enum dm2_status expect(struct session *s, enum message_type type, uint32_t limit,
                              struct deadline until, struct bytes_reader *out, struct dm2_error *err)
{
    struct frame f;
    enum dm2_status status = receive(s, limit, until, &f, err);
    return status == DM2_OK ? check_type(&f, type, out, err) : status;
}

static enum dm2_status not_decoded(const char *what, struct dm2_error *err)
{
    return dm2_fail(err, DM2_PROTOCOL, "the client's %s message does not decode", what);
}

/* --- before the steps --- */

static enum dm2_status shake_hands(struct session *s, struct dm2_error *err)
{
    struct bytes_reader r;
    struct hello_message hello, own = {.fingerprint = fingerprint_compute()};
    struct deadline until = deadline_in(s->options->handshake, s->options->cancel);
    enum dm2_status status = expect(s, MESSAGE_HELLO, LIMIT_HELLO, until, &r, err);
    if (status != DM2_OK)
        return status;
    message_get_hello(&r, &hello);
    if (r.failed)
        return not_decoded("HELLO", err);
    (void)snprintf(own.version, sizeof own.version, "%s", s->options->version);
    if (hello.fingerprint != own.fingerprint)
        return dm2_fail(
            err, DM2_PROTOCOL,
            "the arithmetic differs: fingerprint %016llx on the client (dm2 %s), %016llx on the server (dm2 "
            "%s): build both with the Makefile's flags for IEEE 754 doubles",
            (unsigned long long)hello.fingerprint, hello.version, (unsigned long long)own.fingerprint,
            own.version);
    bytes_clear(&s->out);
    message_put_hello(&s->out, &own);
    return send_out(s, MESSAGE_WELCOME, err);
}

/* A path's last component is "..", or one before it is. */
static bool climbs(const char *name)
{
    for (const char *p = name; p != NULL; p = strchr(p, '/')) {
        p += *p == '/';
        if (p[0] == '.' && p[1] == '.' && (p[2] == '/' || p[2] == '\0'))
            return true;
    }
    return false;
}

char *server_deck_path(const char *directory, const char *name)
{
    size_t root = strlen(directory) + 1, size = root + strlen(name) + 1;
    char *path = name[0] == '\0' || name[0] == '/' || climbs(name) ? NULL : mem_alloc(size, 1);
    if (path == NULL)
        return NULL;
    (void)snprintf(path, size, "%s/%s", directory, name);
    bool found = true;
    struct stat info;
    for (char *end = path + root; end != NULL && found;) { /* from one component of the name to the next */
        end = strchr(end, '/');
        if (end != NULL)
            *end = '\0';
        found = lstat(path, &info) == 0 && !S_ISLNK(info.st_mode);
        if (end != NULL)
            *end++ = '/';
    }
    if (found && S_ISREG(info.st_mode))
        return path;
    free(path);
    return NULL;
}

/* Of the files that a deck below the directory includes, too. */
static bool may_read(void *directory, const char *path)
{
    char *found = server_deck_path(directory, path + strlen(directory) + 1);
    free(found);
    return found != NULL;
}

/* Puts the texts of the server's own copy into the message, if there is one. */
static bool read_own_copy(struct session *s)
{
    char *path = server_deck_path(s->options->deck_dir, s->deck.name);
    struct deck_source own;
    struct dm2_error ignored;
    bool found =
        path != NULL && deck_source_read_some(path, may_read, (void *)(uintptr_t)s->options->deck_dir, &own,
                                              &ignored) == DM2_OK;
    free(path);
    if (!found)
        return false;
    struct deck_text *none = s->deck.source.texts; /* an empty array */
    s->deck.source.texts = own.texts;
    s->deck.source.n_texts = own.n_texts;
    own.texts = none;
    own.n_texts = 0;
    deck_source_free(&own);
    return true;
}

static enum dm2_status check_digest(const struct session *s, bool own_copy, struct dm2_error *err)
{
    unsigned char digest[SHA256_BYTES];
    char here[SHA256_TEXT], there[SHA256_TEXT];
    deck_digest(&s->deck.source, digest);
    if (memcmp(digest, s->deck.digest, SHA256_BYTES) == 0)
        return DM2_OK;
    sha256_text(digest, here);
    sha256_text(s->deck.digest, there);
    return dm2_fail(err, DM2_PROTOCOL,
                    "the deck '%.100s' differs: digest %s on the client, %s on the server%s", s->deck.name,
                    there, here, own_copy ? ": bring the copies together, or use --send-deck" : "");
}

static enum dm2_status answer_deck(struct session *s, uint8_t loaded, struct dm2_error *err)
{
    bytes_clear(&s->out);
    bytes_put_u8(&s->out, loaded);
    return send_out(s, MESSAGE_ANSWER, err);
}

/* What a deck may ask of this server. */
static enum dm2_status check_steps(const struct session *s, struct dm2_error *err)
{
    int64_t most = s->options->max_steps;
    if (most == 0 || s->config.steps <= most)
        return DM2_OK;
    return dm2_fail(err, DM2_DECK,
                    "the deck has %lld time steps, this server takes at most %lld: dm2-server --max-steps N",
                    (long long)s->config.steps, (long long)most);
}

/* Before the work that the limit is to prevent: some four times as many are counted, and taken or not for
 * their number; what is beyond is not begun. */
static enum dm2_status check_estimate(const struct session *s, struct dm2_error *err)
{
    const struct model_estimate e = model_estimate(&s->config);
    double most = (double)s->options->max_elements;
    if (most == 0 ||
        (e.elements <= 4 * most + 0x1p16 && e.places <= 64 * most + 0x1p20 && e.cells <= 64 * most + 0x1p20))
        return DM2_OK;
    return dm2_fail(err, DM2_DECK,
                    "the deck makes about %.3g elements from %.3g lattice sites in %.3g cells, this server "
                    "takes at most %.0f: "
                    "dm2-server --max-elements N",
                    e.elements, e.places, e.cells, most);
}

static enum dm2_status check_elements(const struct session *s, struct dm2_error *err)
{
    uint64_t most = s->options->max_elements;
    if (most == 0 || model_elements(s->model) <= most)
        return DM2_OK;
    return dm2_fail(
        err, DM2_DECK,
        "the deck makes %zu elements, this server takes at most %llu: dm2-server --max-elements N",
        model_elements(s->model), (unsigned long long)most);
}

static enum dm2_status load_deck(struct session *s, struct dm2_error *err)
{
    struct deck_report report = {0};
    enum dm2_status status = deck_load(&s->deck.source, &s->config, &report);
    s->loaded = status == DM2_OK;
    if (status != DM2_OK)
        status = dm2_fail(err, status, "the deck does not load: %s",
                          report.text == NULL ? "no memory" : report.text);
    deck_report_free(&report);
    if (status == DM2_OK)
        status = check_steps(s, err);
    if (status == DM2_OK)
        status = check_estimate(s, err);
    if (status == DM2_OK)
        status = model_build_watched(&s->config, (struct pulse){beat, s}, &s->model, err);
    return status == DM2_OK ? check_elements(s, err) : status;
}

/* Waits for DECK; what comes before it is sent back as it is, so that the client can time the way there and
 * back. With summary->measured that was all it came for. */
static enum dm2_status expect_deck(struct session *s, struct bytes_reader *out, struct dm2_error *err)
{
    struct frame f;
    enum dm2_status status;
    for (;;) {
        status = receive(s, LIMIT_DECK, patience(s), &f, err);
        if (status != DM2_OK || f.type != MESSAGE_ECHO)
            break;
        s->summary->measured = f.length == 0;
        if (s->summary->measured)
            return DM2_OK;
        status = channel_send(&s->channel, MESSAGE_ECHO, 0, f.payload, f.length, patience(s), err);
        if (status != DM2_OK)
            break;
        s->summary->echoes++;
    }
    return status == DM2_OK ? check_type(&f, MESSAGE_DECK, out, err) : status;
}

static enum dm2_status get_deck(struct session *s, struct dm2_error *err)
{
    for (int attempt = 0;; attempt++) {
        struct bytes_reader r;
        enum dm2_status status = attempt == 0 ? expect_deck(s, &r, err)
                                              : expect(s, MESSAGE_DECK, LIMIT_DECK, patience(s), &r, err);
        if (status != DM2_OK || s->summary->measured)
            return status;
        message_free_deck(&s->deck);
        message_get_deck(&r, &s->deck);
        if (r.failed || (attempt > 0 && !s->deck.with_texts))
            return not_decoded("DECK", err);
        (void)snprintf(s->summary->deck, sizeof s->summary->deck, "%s", s->deck.name);
        bool own_copy = !s->deck.with_texts && read_own_copy(s);
        if (s->deck.with_texts || own_copy) {
            status = check_digest(s, own_copy, err);
            if (status == DM2_OK)
                status = load_deck(s, err);
            return status == DM2_OK ? answer_deck(s, 1, err) : status;
        }
        status = answer_deck(s, 0, err);
        if (status != DM2_OK)
            return status;
    }
}

/* The client's view of the domain must be the server's. */
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

/* What is known of the state to start from. */
struct intake {
    struct element *elements;
    struct pair_record *pairs;
    unsigned char *seen; /* by id */
    size_t n_elements, n_pairs, elements_cap, pairs_cap;
};

static enum dm2_status take_part(struct intake *in, const struct model *model, const struct state_message *m,
                                 struct bytes_reader *r, struct dm2_error *err)
{
    const struct wire_limits limits = wire_limits_of(model);
    void *elements = in->elements, *pairs = in->pairs;
    if (!m->last && m->n_elements == 0 && m->n_pairs == 0)
        return dm2_fail(err, DM2_PROTOCOL, "the client sent an empty part of a state");
    if (in->n_pairs + m->n_pairs > WIRE_PAIRS_MOST * limits.elements)
        return dm2_fail(err, DM2_PROTOCOL, "the client sent more than %d pairs per element", WIRE_PAIRS_MOST);
    int failed = mem_grow(&elements, &in->elements_cap, in->n_elements, in->n_elements + m->n_elements,
                          sizeof *in->elements);
    in->elements = elements;
    if (failed == 0)
        failed = mem_grow(&pairs, &in->pairs_cap, in->n_pairs, in->n_pairs + m->n_pairs, sizeof *in->pairs);
    in->pairs = pairs;
    if (failed != 0)
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
    return bytes_done(r) ? DM2_OK : not_decoded("STATE", err);
}

/* The elements and pairs of this rank at the step to start from, in as many parts as they take. */
static enum dm2_status get_state(struct session *s, struct dm2_error *err)
{
    struct intake in = {.seen = mem_zalloc(model_elements(s->model), 1)};
    struct state_message m = {.last = false};
    enum dm2_status status =
        in.seen == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for the state to start from") : DM2_OK;
    while (status == DM2_OK && !m.last) {
        struct bytes_reader r;
        status = expect(s, MESSAGE_STATE, LIMIT_STATE, patience(s), &r, err);
        if (status != DM2_OK)
            break;
        message_get_state(&r, &m);
        if (r.failed || m.purpose != STATE_COPY || m.step != s->assign.start || m.step > s->config.steps)
            status = not_decoded("STATE", err);
        else
            status = take_part(&in, s->model, &m, &r, err);
    }
    if (status == DM2_OK)
        status = subdomain_restore(s->model, &s->map, s->assign.rank, m.step, in.elements, in.n_elements,
                                   in.pairs, in.n_pairs, &s->sd, err);
    free(in.elements);
    free(in.pairs);
    free(in.seen);
    return status;
}

static enum dm2_status get_assignment(struct session *s, struct dm2_error *err)
{
    struct bytes_reader r;
    enum dm2_status status = expect(s, MESSAGE_ASSIGN, LIMIT_ASSIGN, patience(s), &r, err);
    if (status != DM2_OK)
        return status;
    message_get_assign(&r, &s->assign);
    if (r.failed)
        return not_decoded("ASSIGN", err);
    s->summary->rank = s->assign.rank;
    s->summary->ranks = s->assign.ranks;
    s->timeout = fmax(s->timeout, fmin(2 * s->assign.timeout, MOST_PATIENCE * s->options->timeout));
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

static enum dm2_status send_ready(struct session *s, struct dm2_error *err)
{
    struct ready_message m = {.owned = subdomain_owned(s->sd),
                              .mirrored = subdomain_mirrored(s->sd),
                              .bytes = subdomain_bytes(s->sd)};
    enum dm2_status status = s->assign.hash_every > 0 ? state_hash_subdomain(s->sd, &m.hash, err) : DM2_OK;
    if (status != DM2_OK)
        return status;
    bytes_clear(&s->out);
    message_put_ready(&s->out, &m);
    struct subdomain_times set_up;
    subdomain_take_times(s->sd, &set_up); /* not part of the steps */
    return send_out(s, MESSAGE_READY, err);
}

/* --- states --- */

/* The processor's seconds count while it computes, packs and unpacks, from here to the call that ends it; not
 * while it sends, receives and waits, which costs seconds of its own in the system. */
static bool count_cpu(struct session *s, bool on)
{
    double now = clock_cpu();
    bool before = s->counts;
    if (before)
        s->times.cpu += now - s->counted;
    s->counts = on;
    s->counted = now;
    return before;
}

static enum dm2_status send_state(struct session *s, enum state_purpose purpose, struct dm2_error *err)
{
    double start = clock_now();
    beat(s);
    bool counted = count_cpu(s, false);
    size_t n = subdomain_owned(s->sd);
    struct state_parts parts = {.head = {.step = subdomain_step(s->sd), .purpose = purpose}, .n_elements = n};
    struct element *elements = mem_alloc(n, sizeof *elements);
    struct element_measure *measured = purpose == STATE_SNAPSHOT ? mem_alloc(n, sizeof *measured) : NULL;
    struct pair_record *pairs = NULL;
    enum dm2_status status = DM2_OK;
    if (elements == NULL || (purpose == STATE_SNAPSHOT && measured == NULL))
        status = dm2_fail(err, DM2_MEMORY, "no memory to send a state of %zu elements", n);
    if (status == DM2_OK)
        status = subdomain_collect(s->sd, elements, measured, err);
    beat(s);
    if (status == DM2_OK)
        status = subdomain_collect_pairs(s->sd, &pairs, &parts.n_pairs, err);
    beat(s);
    parts.elements = elements;
    parts.measured = measured;
    parts.pairs = pairs;
    while (status == DM2_OK && state_parts_next(&parts, &s->out))
        status = send_out(s, MESSAGE_STATE, err);
    free(elements);
    free(measured);
    free(pairs);
    s->times.output += clock_now() - start;
    (void)count_cpu(s, counted);
    return status;
}

/* The profiles that are due, one message each. */
static enum dm2_status send_profiles(struct session *s, struct dm2_error *err)
{
    if (s->config.n_profiles == 0)
        return DM2_OK;
    double start = clock_now();
    int64_t step = subdomain_step(s->sd);
    bool counted = count_cpu(s, false);
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < s->config.n_profiles && status == DM2_OK; k++) {
        struct profile_message m = {.step = step, .which = k, .n_bins = (size_t)s->config.profiles[k].bins};
        if (!results_profile_due(&s->config, k, step))
            continue;
        struct profile_bin *bins = mem_zalloc(m.n_bins, sizeof *bins);
        if (bins == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for a profile of %zu bins", m.n_bins);
        status = subdomain_profile(s->sd, k, bins, err);
        bytes_clear(&s->out);
        message_put_profile(&s->out, &m);
        for (size_t b = 0; b < m.n_bins; b++)
            wire_put_bin(&s->out, &bins[b]);
        free(bins);
        if (status == DM2_OK)
            status = send_out(s, MESSAGE_PROFILE, err);
    }
    s->times.output += clock_now() - start;
    (void)count_cpu(s, counted);
    return status;
}

/* --- steps --- */

/* Adds up the engine's own times; returns the seconds of rebuilds among them. */
static double tally(struct session *s)
{
    struct subdomain_times t;
    subdomain_take_times(s->sd, &t);
    s->times.forces += t.forces;
    s->times.integrate += t.integrate;
    s->times.rebuild += t.rebuild;
    s->times.rebuilds += t.rebuilds;
    return t.rebuild;
}

/* Packs and sends one STEP message. The head holds counts that packing finds out: it is written again at the
 * end. */
static enum dm2_status send_step(struct session *s, struct step_message *m, struct dm2_error *err)
{
    enum dm2_status status;
    double start = clock_now();
    (void)tally(s);
    bytes_clear(&s->out);
    message_put_step(&s->out, m);
    size_t head = s->out.length;
    m->owned = subdomain_owned(s->sd);
    m->migrants = 0;
    if (m->rebuild)
        status = exchange_pack_rebuild(&s->exchange, s->sd, &s->out, &m->n_segments, &m->migrants, err);
    else
        status = exchange_pack_update(&s->exchange, s->sd, &s->out, &m->n_segments, err);
    if (status != DM2_OK)
        return status;
    double rebuild = tally(s), now = clock_now();
    m->busy = now - s->heard + s->ahead;
    s->ahead = 0.0;
    s->times.pack += now - start - rebuild;
    s->times.migrants += m->migrants;
    size_t length = s->out.length;
    s->out.length = 0;
    message_put_step(&s->out, m);
    if (s->out.length != head)
        return dm2_fail(err, DM2_PROTOCOL, "the head of a step message changed its length");
    s->out.length = length;
    (void)count_cpu(s, false);
    return send_out(s, MESSAGE_STEP, err);
}

static enum dm2_status get_next(struct session *s, int64_t step, struct next_message *next,
                                struct bytes_reader *r, struct dm2_error *err)
{
    double start = clock_now();
    enum dm2_status status = expect(s, MESSAGE_NEXT, LIMIT_STEP, patience(s), r, err);
    s->heard = clock_now();
    s->times.wait += s->heard - start;
    (void)count_cpu(s, true);
    if (status != DM2_OK)
        return status;
    message_get_next(r, next);
    if (r->failed)
        return not_decoded("NEXT", err);
    if (next->step != step)
        return dm2_fail(err, DM2_PROTOCOL, "the client sent NEXT for step %lld where %lld is due",
                        (long long)next->step, (long long)step);
    return DM2_OK;
}

/* While the others' states are on the way: what of the next step needs none of them. A client on the same
 * processor gets it first, or the message would lie there until this work is done. */
static void work_ahead(struct session *s, int64_t step)
{
    if (step == s->config.steps)
        return; /* the final state comes first */
    (void)sched_yield();
    double start = clock_now();
    (void)count_cpu(s, true);
    subdomain_forces_ahead(s->sd, results_measure_due(&s->config, step));
    (void)count_cpu(s, false);
    s->ahead = clock_now() - start;
    s->times.ahead += s->ahead;
}

/* The exchange after a step; *asked says how, and gets how the next one will be. */
static enum dm2_status exchange_step(struct session *s, struct step_message *m, struct next_message *asked,
                                     struct dm2_error *err)
{
    struct next_message next;
    struct bytes_reader r;
    m->rebuild = asked->rebuild_next;
    enum dm2_status status = send_step(s, m, err);
    if (status == DM2_OK && !m->rebuild)
        work_ahead(s, m->step);
    if (status == DM2_OK)
        status = get_next(s, m->step, &next, &r, err);
    if (status == DM2_OK && next.redo) {
        if (m->rebuild)
            return dm2_fail(err, DM2_PROTOCOL, "the client asks for a rebuild of step %lld, which was one",
                            (long long)m->step);
        m->rebuild = true;
        m->measured = m->hashed = m->surveyed = false;
        status = send_step(s, m, err);
        if (status == DM2_OK)
            status = get_next(s, m->step, &next, &r, err);
        if (status == DM2_OK && next.redo)
            return dm2_fail(err, DM2_PROTOCOL, "the client asks twice for a rebuild of step %lld",
                            (long long)m->step);
    }
    if (status != DM2_OK)
        return status;
    double start = clock_now();
    if (m->rebuild)
        status = exchange_take_rebuild(&s->exchange, s->sd, &r, next.n_segments, err);
    else
        status = exchange_take_update(&s->exchange, s->sd, &r, next.n_segments, err);
    s->times.unpack += clock_now() - start - tally(s);
    *asked = next;
    return status;
}

static enum dm2_status step(struct session *s, int64_t n, struct next_message *asked, struct dm2_error *err)
{
    bool snapshot = results_snapshot_due(&s->config, n), measure = results_measure_due(&s->config, n);
    struct step_message m = {.step = n + 1, .measured = measure};
    int64_t every = s->assign.hash_every;
    enum dm2_status status = subdomain_forces(s->sd, measure, err);
    if (status == DM2_OK && snapshot)
        status = send_state(s, STATE_SNAPSHOT, err);
    if (status == DM2_OK)
        status = send_profiles(s, err);
    if (status == DM2_OK)
        status = subdomain_move(s->sd, &m.dmax, measure ? &m.measures : NULL, err);
    m.surveyed = asked->survey_next;
    if (status == DM2_OK && m.surveyed)
        subdomain_survey(s->sd, &m.spread);
    m.hashed = every > 0 && (m.step % every == 0 || m.step == s->config.steps);
    beat(s);
    if (status == DM2_OK && m.hashed)
        status = state_hash_subdomain(s->sd, &m.hash, err);
    if (status == DM2_OK && asked->copy_next)
        status = send_state(s, STATE_COPY, err);
    if (status == DM2_OK)
        status = exchange_step(s, &m, asked, err);
    s->times.steps++;
    s->times.mirrored += subdomain_mirrored(s->sd);
    s->summary->steps = m.step;
    return status;
}

static enum dm2_status run_steps(struct session *s, struct dm2_error *err)
{
    struct next_message asked = {.rebuild_next = s->assign.rebuild_first, .copy_next = s->assign.copy_first};
    enum dm2_status status = DM2_OK;
    (void)count_cpu(s, true);
    s->heard = clock_now();
    for (int64_t n = subdomain_step(s->sd); n < s->config.steps && status == DM2_OK; n++)
        status = step(s, n, &asked, err);
    (void)count_cpu(s, false);
    return status;
}

static enum dm2_status finish(struct session *s, struct dm2_error *err)
{
    struct done_message done = {0};
    (void)tally(s);
    enum dm2_status status = send_state(s, STATE_FINAL, err);
    if (status == DM2_OK)
        status = subdomain_forces(s->sd, true, err);
    if (status == DM2_OK && results_snapshot_due(&s->config, s->config.steps))
        status = send_state(s, STATE_SNAPSHOT, err);
    if (status == DM2_OK)
        status = send_profiles(s, err);
    if (status == DM2_OK)
        status = subdomain_measure_last(s->sd, &done.measures, err);
    if (status != DM2_OK)
        return status;
    done.times = s->times;
    done.times.messages_in = s->channel.frames_in;
    done.times.messages_out = s->channel.frames_out;
    done.times.bytes_in = s->channel.bytes_in;
    done.times.bytes_out = s->channel.bytes_out;
    bytes_clear(&s->out);
    message_put_done(&s->out, &done);
    return send_out(s, MESSAGE_DONE, err);
}

/* --- the session --- */

static void tell_client(struct session *s, const struct dm2_error *err)
{
    struct error_message m = {.status = err->status};
    (void)snprintf(m.text, sizeof m.text, "%s", err->text);
    bytes_clear(&s->out);
    message_put_error(&s->out, &m);
    if (!s->out.failed)
        (void)channel_send(&s->channel, MESSAGE_ERROR, 0, s->out.data, s->out.length,
                           deadline_in(HANG_UP_SECONDS, -1), NULL);
}

static void free_session(struct session *s)
{
    exchange_free(&s->exchange);
    subdomain_free(s->sd);
    decomposition_free(&s->decomposition);
    message_free_assign(&s->assign);
    model_free(s->model);
    if (s->loaded)
        config_free(&s->config);
    message_free_deck(&s->deck);
    bytes_free(&s->out);
}

/* Everything after the deck. */
static enum dm2_status serve_run(struct session *s, struct dm2_error *err)
{
    enum dm2_status status = get_assignment(s, err);
    if (status == DM2_OK)
        status = send_ready(s, err);
    if (status == DM2_OK)
        status = run_steps(s, err);
    return status == DM2_OK ? finish(s, err) : status;
}

/* The session of a client from the lobby, which is looked after meanwhile. The channel is taken over. */
static enum dm2_status serve_client(const struct channel *client, const struct server_options *options,
                                    struct lobby *lobby, struct session_summary *summary,
                                    struct dm2_error *err)
{
    struct session s = {.options = options,
                        .lobby = lobby,
                        .summary = summary,
                        .timeout = options->timeout,
                        .channel = *client,
                        .alive_every = ALIVE_SECONDS};
    double start = s.quiet_since = clock_now();
    *summary = (struct session_summary){.rank = -1};
    lobby->business = (struct lobby_business){.peer = client->name, .since = start, .session = summary};
    enum dm2_status status = shake_hands(&s, err);
    s.greeted = status == DM2_OK;
    if (status == DM2_OK)
        status = get_deck(&s, err);
    if (status == DM2_OK && !summary->measured)
        status = serve_run(&s, err);
    if (status != DM2_OK && status != DM2_NET)
        tell_client(&s, err);
    channel_hang_up(&s.channel,
                    deadline_in(HANG_UP_SECONDS, -1)); /* a signal does not cut the last message */
    free_session(&s);
    summary->seconds = clock_now() - start;
    return status;
}

enum dm2_status server_session(int fd, const char *peer, const struct server_options *options,
                               struct session_summary *summary, struct dm2_error *err)
{
    struct lobby lobby;
    struct channel client;
    *summary = (struct session_summary){.rank = -1};
    lobby_open(&lobby, -1, options, NULL, NULL);
    lobby_enter(&lobby, fd, peer);
    enum dm2_status status =
        lobby_next(&lobby, deadline_in(options->handshake, options->cancel), &client, err);
    if (status == DM2_OK)
        status = serve_client(&client, options, &lobby, summary, err);
    lobby_close(&lobby);
    return status;
}

static void log_session(const struct session_summary *sum, enum dm2_status status,
                        const struct dm2_error *err, server_log log, void *context, const char *peer)
{
    char line[1100], what[320] = "";
    if (sum->rank >= 0)
        (void)snprintf(what, sizeof what, "%s, rank %d of %d, %lld steps in %.3f s", sum->deck, sum->rank,
                       sum->ranks, (long long)sum->steps, sum->seconds);
    if (sum->measured)
        (void)snprintf(what, sizeof what, "network measured, %llu round trips in %.3f s",
                       (unsigned long long)sum->echoes, sum->seconds);
    if (status == DM2_OK)
        (void)snprintf(line, sizeof line, "done: %s", what);
    else
        (void)snprintf(line, sizeof line, "%s%s%s", err->text, what[0] != '\0' ? "; " : "", what);
    text_make_printable(line, false); /* of which a client has sent much */
    log(context, status == DM2_OK ? SERVER_DONE : SERVER_FAILED, peer, line);
}

enum dm2_status server_serve(int listener, const struct server_options *options, bool once, server_log log,
                             void *context, struct dm2_error *err)
{
    const double for_ever = 1e9;
    enum dm2_status status = DM2_OK;
    struct lobby lobby;
    lobby_open(&lobby, listener, options, log, context);
    for (bool over = false; !over;) {
        struct channel client;
        struct session_summary summary;
        status = lobby_next(&lobby, deadline_in(once ? options->timeout : for_ever, options->cancel), &client,
                            err);
        if (status == DM2_TIMEOUT && !once)
            continue;
        if (status == DM2_TIMEOUT)
            status = dm2_fail(err, DM2_TIMEOUT, "no client came within %g s", options->timeout);
        if (status != DM2_OK)
            break;
        log(context, SERVER_CONNECTED, client.name, "connected");
        status = serve_client(&client, options, &lobby, &summary, err);
        log_session(&summary, status, err, log, context, client.name);
        over = once || status == DM2_INTERRUPTED;
    }
    lobby_close(&lobby);
    return status;
}
