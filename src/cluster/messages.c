/* The messages as bytes. message_put_X and message_get_X stand together and list the same fields in the same
 * order. A get checks ranges, counts and finite numbers, as far as one message alone shows them to be wrong;
 * the roles compare the message with the run. */
#include "dm2/cluster/messages.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/cluster/wire.h"

static void require(struct bytes_reader *r, bool holds)
{
    if (!holds)
        r->failed = true;
}

static bool get_bool(struct bytes_reader *r)
{
    uint8_t value = bytes_get_u8(r);
    require(r, value <= 1);
    return value == 1;
}

static double get_seconds(struct bytes_reader *r)
{
    double s = bytes_get_f64(r);
    require(r, isfinite(s) && s >= 0);
    return s;
}

/* Reads a text into a buffer of `size` bytes; a text that is too long sets r->failed. */
static void get_text_into(struct bytes_reader *r, char *out, size_t size)
{
    char *text = bytes_get_text(r, size - 1, NULL);
    (void)snprintf(out, size, "%s", text == NULL ? "" : text);
    free(text);
}

void message_put_hello(struct bytes_writer *w, const struct hello_message *m)
{
    bytes_put_u64(w, m->fingerprint);
    bytes_put_text(w, m->version, strlen(m->version));
    bytes_put_u8(w, m->turn);
}

void message_get_hello(struct bytes_reader *r, struct hello_message *m)
{
    *m = (struct hello_message){0};
    m->fingerprint = bytes_get_u64(r);
    get_text_into(r, m->version, sizeof m->version);
    m->turn = get_bool(r);
    text_make_printable(m->version, false);
    require(r, bytes_done(r));
}

void message_put_place(struct bytes_writer *w, const struct place_message *m)
{
    bytes_put_raw(w, m->id, SERVER_ID);
    bytes_put_u32(w, m->before);
    bytes_put_text(w, m->peer, strlen(m->peer));
    bytes_put_text(w, m->deck, strlen(m->deck));
    bytes_put_i64(w, m->step);
}

void message_get_place(struct bytes_reader *r, struct place_message *m)
{
    *m = (struct place_message){0};
    const unsigned char *id = bytes_get_raw(r, SERVER_ID);
    if (id != NULL)
        memcpy(m->id, id, SERVER_ID);
    m->before = bytes_get_u32(r);
    get_text_into(r, m->peer, sizeof m->peer);
    get_text_into(r, m->deck, sizeof m->deck);
    m->step = bytes_get_i64(r);
    require(r, m->step >= 0);
    text_make_printable(m->peer, false);
    text_make_printable(m->deck, false);
    require(r, bytes_done(r));
}

void message_put_deck(struct bytes_writer *w, const struct deck_message *m)
{
    const struct deck_source *s = &m->source;
    bytes_put_u8(w, m->with_texts);
    bytes_put_raw(w, m->digest, SHA256_BYTES);
    bytes_put_text(w, m->name, strlen(m->name));
    bytes_put_i64(w, s->steps);
    bytes_put_u32(w, (uint32_t)s->n_defines);
    for (size_t k = 0; k < s->n_defines; k++)
        bytes_put_text(w, s->defines[k], strlen(s->defines[k]));
    bytes_put_u32(w, m->with_texts ? (uint32_t)s->n_texts : 0);
    for (size_t k = 0; k < s->n_texts && m->with_texts; k++) {
        bytes_put_text(w, s->texts[k].name, strlen(s->texts[k].name));
        bytes_put_text(w, s->texts[k].text, s->texts[k].length);
    }
}

void message_get_deck(struct bytes_reader *r, struct deck_message *m)
{
    struct deck_source *s = &m->source;
    *m = (struct deck_message){0};
    m->with_texts = get_bool(r);
    const unsigned char *digest = bytes_get_raw(r, SHA256_BYTES);
    if (digest != NULL)
        memcpy(m->digest, digest, SHA256_BYTES);
    m->name = bytes_get_text(r, DECK_NAME_MAX, NULL);
    s->steps = bytes_get_i64(r);
    require(r, s->steps >= -1);
    size_t n = bytes_get_count(r, 4);
    require(r, n <= DECK_MAX_DEFINES);
    s->defines = r->failed ? NULL : mem_zalloc(n, sizeof *s->defines);
    require(r, s->defines != NULL);
    for (; s->n_defines < n && !r->failed; s->n_defines++)
        s->defines[s->n_defines] = bytes_get_text(r, LIMIT_DECK, NULL);
    n = bytes_get_count(r, 8);
    require(r, n <= DECK_TEXTS_MAX && (n > 0) == m->with_texts);
    s->texts = r->failed ? NULL : mem_zalloc(n, sizeof *s->texts);
    require(r, s->texts != NULL);
    for (; s->n_texts < n && !r->failed; s->n_texts++) {
        struct deck_text *t = &s->texts[s->n_texts];
        t->name = bytes_get_text(r, DECK_NAME_MAX, NULL);
        t->text = bytes_get_text(r, LIMIT_DECK, &t->length);
    }
    require(r, bytes_done(r));
}

void message_free_deck(struct deck_message *m)
{
    free(m->name);
    deck_source_free(&m->source);
    *m = (struct deck_message){0};
}

void message_put_assign(struct bytes_writer *w, const struct assign_message *m)
{
    bytes_put_u16(w, (uint16_t)m->rank);
    bytes_put_u16(w, (uint16_t)m->ranks);
    bytes_put_u32(w, (uint32_t)m->cx);
    bytes_put_u32(w, (uint32_t)m->cy);
    bytes_put_u64(w, m->elements);
    for (int k = 0; k < m->ranks; k++) {
        bytes_put_u32(w, (uint32_t)m->rects[k].x0);
        bytes_put_u32(w, (uint32_t)m->rects[k].y0);
        bytes_put_u32(w, (uint32_t)m->rects[k].x1);
        bytes_put_u32(w, (uint32_t)m->rects[k].y1);
    }
    for (int side = 0; side < SIDE_COUNT; side++)
        bytes_put_u16(w, (uint16_t)m->interfaces[side]);
    bytes_put_f64(w, m->timeout);
    bytes_put_i64(w, m->hash_every);
    bytes_put_u8(w, m->rebuild_first);
    bytes_put_u8(w, m->copy_first);
    bytes_put_i64(w, m->end);
    bytes_put_i64(w, m->start);
}

static int get_cells(struct bytes_reader *r)
{
    uint32_t n = bytes_get_u32(r);
    require(r, n <= 1U << 30);
    return r->failed ? 0 : (int)n;
}

void message_get_assign(struct bytes_reader *r, struct assign_message *m)
{
    *m = (struct assign_message){0};
    m->rank = bytes_get_u16(r);
    m->ranks = bytes_get_u16(r);
    require(r, m->rank < m->ranks);
    m->cx = get_cells(r);
    m->cy = get_cells(r);
    m->elements = bytes_get_u64(r);
    require(r, bytes_remaining(r) / 16 >= (size_t)m->ranks);
    m->rects = r->failed ? NULL : mem_zalloc((size_t)m->ranks, sizeof *m->rects);
    require(r, m->rects != NULL);
    for (int k = 0; k < m->ranks && !r->failed; k++) {
        m->rects[k].x0 = get_cells(r);
        m->rects[k].y0 = get_cells(r);
        m->rects[k].x1 = get_cells(r);
        m->rects[k].y1 = get_cells(r);
    }
    for (int side = 0; side < SIDE_COUNT; side++)
        m->interfaces[side] = bytes_get_u16(r);
    m->timeout = get_seconds(r);
    m->hash_every = bytes_get_i64(r);
    m->rebuild_first = get_bool(r);
    m->copy_first = get_bool(r);
    m->end = bytes_get_i64(r);
    m->start = bytes_get_i64(r);
    require(r, m->hash_every >= 0 && m->start >= -1 && m->end >= m->start && m->end >= 0 && bytes_done(r));
}

void message_free_assign(struct assign_message *m)
{
    free(m->rects);
    m->rects = NULL;
}

void message_put_ready(struct bytes_writer *w, const struct ready_message *m)
{
    bytes_put_u64(w, m->owned);
    bytes_put_u64(w, m->mirrored);
    bytes_put_u64(w, m->bytes);
    bytes_put_u64(w, m->hash);
    wire_put_overlap(w, &m->overlap);
}

void message_get_ready(struct bytes_reader *r, struct ready_message *m)
{
    m->owned = bytes_get_u64(r);
    m->mirrored = bytes_get_u64(r);
    m->bytes = bytes_get_u64(r);
    m->hash = bytes_get_u64(r);
    wire_get_overlap(r, &m->overlap);
    require(r, bytes_done(r));
}

static void put_spread(struct bytes_writer *w, const struct spread *s)
{
    bytes_put_f64s(w, s->low, 2);
    bytes_put_f64s(w, s->high, 2);
    bytes_put_f64(w, s->most);
    bytes_put_f64(w, s->close);
}

/* low and high are infinite where there is no element, close where it was not surveyed. NaN is refused,
 * because in a comparison NaN would hide the values of the other servers. */
static void get_spread(struct bytes_reader *r, struct spread *s)
{
    bytes_get_f64s(r, s->low, 2);
    bytes_get_f64s(r, s->high, 2);
    s->most = get_seconds(r);
    s->close = bytes_get_f64(r);
    require(r, s->close >= 0.0);
    for (int a = 0; a < 2; a++)
        require(r, s->low[a] <= s->high[a] || (s->low[a] == INFINITY && s->high[a] == -INFINITY));
}

static void put_cracks(struct bytes_writer *w, const struct crack_part *c)
{
    bytes_put_u32(w, (uint32_t)c->n);
    for (size_t k = 0; k < c->n; k++)
        wire_put_crack(w, &c->items[k]);
}

static void get_cracks(struct bytes_reader *r, struct crack_part *c)
{
    c->n = bytes_get_count(r, WIRE_CRACK);
    c->bytes = bytes_get_raw(r, c->n * WIRE_CRACK);
}

/* Totals of the bodies under force: u8 their number, then each. */
static void put_loads(struct bytes_writer *w, const struct load_totals *loads, size_t n)
{
    bytes_put_u8(w, (uint8_t)n);
    for (size_t i = 0; i < n; i++)
        wire_put_load(w, &loads[i]);
}

static size_t get_loads(struct bytes_reader *r, struct load_totals *loads)
{
    size_t n = bytes_get_u8(r);
    require(r, n > 0 && n <= FORCED_MAX);
    for (size_t i = 0; i < n && !r->failed; i++)
        wire_get_load(r, &loads[i]);
    return r->failed ? 0 : n;
}

enum { STEP_REBUILD = 1, STEP_MEASURED = 2, STEP_HASHED = 4, STEP_SURVEYED = 8 };
enum { STEP_CRACKED = 16, STEP_LOADED = 32, STEP_FLAGS = 63 };

void message_put_step(struct bytes_writer *w, const struct step_message *m)
{
    bytes_put_i64(w, m->step);
    bytes_put_u8(w, (uint8_t)((m->rebuild ? STEP_REBUILD : 0) | (m->measured ? STEP_MEASURED : 0) |
                              (m->hashed ? STEP_HASHED : 0) | (m->surveyed ? STEP_SURVEYED : 0) |
                              (m->cracks.n > 0 ? STEP_CRACKED : 0) | (m->n_loads > 0 ? STEP_LOADED : 0)));
    bytes_put_u64(w, m->owned);
    bytes_put_u64(w, m->migrants);
    bytes_put_f64(w, m->dmax);
    bytes_put_f64(w, m->busy);
    if (m->surveyed)
        put_spread(w, &m->spread);
    if (m->measured)
        wire_put_measures(w, &m->measures);
    if (m->hashed)
        bytes_put_u64(w, m->hash);
    if (m->cracks.n > 0)
        put_cracks(w, &m->cracks);
    if (m->n_loads > 0)
        put_loads(w, m->loads, m->n_loads);
    bytes_put_u32(w, m->n_segments);
}

void message_get_step(struct bytes_reader *r, struct step_message *m)
{
    m->step = bytes_get_i64(r);
    uint8_t flags = bytes_get_u8(r);
    require(r, (flags & ~STEP_FLAGS) == 0);
    m->rebuild = (flags & STEP_REBUILD) != 0;
    m->measured = (flags & STEP_MEASURED) != 0;
    m->hashed = (flags & STEP_HASHED) != 0;
    m->surveyed = (flags & STEP_SURVEYED) != 0;
    m->owned = bytes_get_u64(r);
    m->migrants = bytes_get_u64(r);
    m->dmax = get_seconds(r); /* a length, but finite and not negative, too */
    m->busy = get_seconds(r);
    if (m->surveyed)
        get_spread(r, &m->spread);
    if (m->measured)
        wire_get_measures(r, &m->measures);
    m->hash = m->hashed ? bytes_get_u64(r) : 0;
    m->cracks = (struct crack_part){0};
    if ((flags & STEP_CRACKED) != 0)
        get_cracks(r, &m->cracks);
    require(r, ((flags & STEP_CRACKED) != 0) == (m->cracks.n > 0));
    m->n_loads = (flags & STEP_LOADED) != 0 ? get_loads(r, m->loads) : 0;
    m->n_segments = bytes_get_u32(r);
}

enum {
    NEXT_REDO = 1,
    NEXT_REBUILD = 2,
    NEXT_COPY = 4,
    NEXT_SURVEY = 8,
    NEXT_ENDS = 32, /* 16 is not in use */
    NEXT_LOADED = 64,
    NEXT_FLAGS = 15 | NEXT_ENDS | NEXT_LOADED
};

void message_put_next(struct bytes_writer *w, const struct next_message *m)
{
    bytes_put_i64(w, m->step);
    bytes_put_u8(w, (uint8_t)((m->redo ? NEXT_REDO : 0) | (m->rebuild_next ? NEXT_REBUILD : 0) |
                              (m->copy_next ? NEXT_COPY : 0) | (m->survey_next ? NEXT_SURVEY : 0) |
                              (m->ends ? NEXT_ENDS : 0) | (m->n_loads > 0 ? NEXT_LOADED : 0)));
    if (m->n_loads > 0)
        put_loads(w, m->loads, m->n_loads);
    bytes_put_u32(w, m->n_segments);
}

void message_get_next(struct bytes_reader *r, struct next_message *m)
{
    m->step = bytes_get_i64(r);
    uint8_t flags = bytes_get_u8(r);
    require(r, (flags & ~NEXT_FLAGS) == 0);
    m->redo = (flags & NEXT_REDO) != 0;
    m->rebuild_next = (flags & NEXT_REBUILD) != 0;
    m->copy_next = (flags & NEXT_COPY) != 0;
    m->survey_next = (flags & NEXT_SURVEY) != 0;
    m->ends = (flags & NEXT_ENDS) != 0;
    m->n_loads = (flags & NEXT_LOADED) != 0 ? get_loads(r, m->loads) : 0;
    m->n_segments = bytes_get_u32(r);
    require(r, !m->redo || (m->n_segments == 0 && m->n_loads == 0 && !m->ends));
}

void message_put_profile(struct bytes_writer *w, const struct profile_message *m)
{
    bytes_put_i64(w, m->step);
    bytes_put_u16(w, (uint16_t)m->which);
    bytes_put_u32(w, (uint32_t)m->n_bins);
}

void message_get_profile(struct bytes_reader *r, struct profile_message *m)
{
    m->step = bytes_get_i64(r);
    m->which = bytes_get_u16(r);
    m->n_bins = bytes_get_u32(r);
    require(r, m->n_bins * (uint64_t)WIRE_BIN == bytes_remaining(r));
}

void message_put_done(struct bytes_writer *w, const struct done_message *m)
{
    const struct server_times *t = &m->times;
    wire_put_measures(w, &m->measures);
    put_cracks(w, &m->cracks);
    bytes_put_f64(w, t->forces);
    bytes_put_f64(w, t->integrate);
    bytes_put_f64(w, t->rebuild);
    bytes_put_f64(w, t->pack);
    bytes_put_f64(w, t->wait);
    bytes_put_f64(w, t->unpack);
    bytes_put_f64(w, t->output);
    bytes_put_f64(w, t->ahead);
    bytes_put_f64(w, t->cpu);
    bytes_put_u64(w, t->steps);
    bytes_put_u64(w, t->rebuilds);
    bytes_put_u64(w, t->migrants);
    bytes_put_u64(w, t->mirrored);
    bytes_put_u64(w, t->messages_in);
    bytes_put_u64(w, t->messages_out);
    bytes_put_u64(w, t->bytes_in);
    bytes_put_u64(w, t->bytes_out);
}

void message_get_done(struct bytes_reader *r, struct done_message *m)
{
    struct server_times *t = &m->times;
    wire_get_measures(r, &m->measures);
    get_cracks(r, &m->cracks);
    t->forces = get_seconds(r);
    t->integrate = get_seconds(r);
    t->rebuild = get_seconds(r);
    t->pack = get_seconds(r);
    t->wait = get_seconds(r);
    t->unpack = get_seconds(r);
    t->output = get_seconds(r);
    t->ahead = get_seconds(r);
    t->cpu = get_seconds(r);
    t->steps = bytes_get_u64(r);
    t->rebuilds = bytes_get_u64(r);
    t->migrants = bytes_get_u64(r);
    t->mirrored = bytes_get_u64(r);
    t->messages_in = bytes_get_u64(r);
    t->messages_out = bytes_get_u64(r);
    t->bytes_in = bytes_get_u64(r);
    t->bytes_out = bytes_get_u64(r);
    require(r, bytes_done(r));
}

void message_put_report(struct bytes_writer *w, const struct report_message *m)
{
    bytes_put_text(w, m->version, strlen(m->version));
    bytes_put_u8(w, m->busy);
    bytes_put_text(w, m->peer, strlen(m->peer));
    bytes_put_f64(w, m->seconds);
    bytes_put_text(w, m->deck, strlen(m->deck));
    bytes_put_u16(w, (uint16_t)m->rank);
    bytes_put_u16(w, (uint16_t)m->ranks);
    bytes_put_i64(w, m->step);
    bytes_put_u32(w, m->waiting);
    bytes_put_f64(w, m->load);
    bytes_put_u16(w, (uint16_t)m->cores);
}

void message_get_report(struct bytes_reader *r, struct report_message *m)
{
    *m = (struct report_message){0};
    get_text_into(r, m->version, sizeof m->version);
    m->busy = get_bool(r);
    get_text_into(r, m->peer, sizeof m->peer);
    m->seconds = get_seconds(r);
    get_text_into(r, m->deck, sizeof m->deck);
    m->rank = bytes_get_u16(r);
    m->ranks = bytes_get_u16(r);
    m->step = bytes_get_i64(r);
    m->waiting = bytes_get_u32(r);
    m->load = bytes_get_f64(r);
    m->cores = bytes_get_u16(r);
    require(r, m->step >= 0 && isfinite(m->load) && (m->ranks == 0 || m->rank < m->ranks));
    text_make_printable(m->version, false);
    text_make_printable(m->peer, false);
    text_make_printable(m->deck, false);
    require(r, bytes_done(r));
}

void message_put_error(struct bytes_writer *w, const struct error_message *m)
{
    bytes_put_u16(w, (uint16_t)m->status);
    bytes_put_text(w, m->text, strlen(m->text));
}

void message_get_error(struct bytes_reader *r, struct error_message *m)
{
    uint16_t status = bytes_get_u16(r);
    require(r, status > DM2_OK && status <= DM2_INTERRUPTED);
    m->status = r->failed ? DM2_PROTOCOL : (enum dm2_status)status;
    get_text_into(r, m->text, sizeof m->text);
    text_make_printable(m->text, true);
    require(r, bytes_done(r));
}

const char *message_name(uint8_t type, char buffer[16])
{
    static const char *const names[] = {
        [0] = "type 0",
        [MESSAGE_HELLO] = "HELLO",
        [MESSAGE_WELCOME] = "WELCOME",
        [MESSAGE_DECK] = "DECK",
        [MESSAGE_ANSWER] = "ANSWER",
        [MESSAGE_ASSIGN] = "ASSIGN",
        [MESSAGE_READY] = "READY",
        [MESSAGE_STEP] = "STEP",
        [MESSAGE_NEXT] = "NEXT",
        [MESSAGE_STATE] = "STATE",
        [MESSAGE_DONE] = "DONE",
        [MESSAGE_ERROR] = "ERROR",
        [MESSAGE_PROFILE] = "PROFILE",
        [MESSAGE_ALIVE] = "ALIVE",
        [MESSAGE_ECHO] = "ECHO",
        [MESSAGE_KNOCK] = "KNOCK",
        [MESSAGE_CHALLENGE] = "CHALLENGE",
        [MESSAGE_PROOF] = "PROOF",
        [MESSAGE_GRANT] = "GRANT",
        [MESSAGE_STATUS] = "STATUS",
        [MESSAGE_REPORT] = "REPORT",
        [MESSAGE_PLACE] = "PLACE",
    };
    if (type < sizeof names / sizeof names[0] && names[type] != NULL)
        return names[type];
    (void)snprintf(buffer, 16, "type %u", type);
    return buffer;
}
