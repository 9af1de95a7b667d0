/* The text about the state that a run begins from. The text comes from the client, so that a server takes no
 * number on trust: counts are bounded by the meaning, ids by the next ones. */
#include "dm2/deck/start.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/deck/meaning.h"

/* No file has this name, because a name on disk has single slashes and a text from a root has more of them
 * before its path. */
static const char start_name[] = "//start";

enum { BODY_REALS = 9 };

/* The doubles of a body in the order of the text. */
static void list_reals(struct body_start *body, double *out[BODY_REALS])
{
    double *const all[BODY_REALS] = {&body->centroid[0], &body->centroid[1], &body->low[0],
                                     &body->low[1],      &body->high[0],     &body->high[1],
                                     &body->mass,        &body->least,       &body->lightest};
    memcpy(out, all, sizeof all);
}

/* --- writing --- */

static void put(struct bytes_writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(struct bytes_writer *w, const char *format, ...)
{
    char line[256];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    bytes_put_raw(w, line, n > 0 ? (size_t)n : 0);
}

static void put_real(struct bytes_writer *w, double x)
{
    char text[NUMBER_TEXT_MAX];
    size_t n = number_format(x, text);
    bytes_put_raw(w, " ", 1);
    bytes_put_raw(w, text, n);
}

void start_put(struct bytes_writer *w, const struct start_source *s, const char *meaning, size_t length)
{
    size_t n_kinds = config_kinds(&s->before);
    put(w, "start %s %" PRId64, s->digest, s->step);
    put_real(w, s->time);
    put_real(w, s->dt_before);
    put(w, " %" PRId64, s->n_clock);
    put_real(w, s->t_clock);
    put(w, " %" PRIu32 " %" PRIu32 " %zu %zu\n", s->next_id, s->next_grain, s->before.n_bodies,
        s->before.n_walls);
    for (size_t b = 0; b < s->before.n_bodies; b++) {
        struct body_start body = s->bodies[b];
        double *reals[BODY_REALS];
        list_reals(&body, reals);
        const bool *kinds = s->kinds + b * n_kinds;
        size_t n = 0;
        for (size_t k = 0; k < n_kinds; k++)
            n += kinds[k];
        put(w, "%" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32, body.id_first, body.id_end, body.grain_first,
            body.grain_end);
        for (size_t k = 0; k < BODY_REALS; k++)
            put_real(w, *reals[k]);
        put(w, " %zu", n);
        for (size_t k = 0; k < n_kinds; k++)
            if (kinds[k])
                put(w, " %zu", k);
        put(w, "\n");
    }
    for (size_t k = 0; k < s->before.n_walls; k++) {
        put_real(w, s->walls[k].moved[0]);
        put_real(w, s->walls[k].moved[1]);
        put_real(w, s->walls[k].angle);
        put(w, "\n");
    }
    bytes_put_raw(w, meaning, length);
}

/* --- reading --- */

/* The words of a text; `failed` sticks. */
struct words {
    const char *text;
    size_t length, at;
    bool failed;
};

static size_t next_word(struct words *w, const char **out)
{
    while (w->at < w->length && (w->text[w->at] == ' ' || w->text[w->at] == '\n'))
        w->at++;
    size_t from = w->at;
    while (w->at < w->length && w->text[w->at] != ' ' && w->text[w->at] != '\n')
        w->at++;
    *out = w->text + from;
    return w->at - from;
}

static int64_t get_whole(struct words *w, int64_t most)
{
    const char *word;
    int64_t n = 0;
    size_t length = next_word(w, &word);
    w->failed |= !number_parse_integer(word, length, &n) || n < 0 || n > most;
    return w->failed ? 0 : n;
}

static double get_real(struct words *w)
{
    const char *word;
    double x = 0.0;
    size_t length = next_word(w, &word);
    w->failed |= !number_parse(word, length, &x) || !isfinite(x);
    return w->failed ? 0.0 : x;
}

static void get_body(struct words *w, const struct start_source *s, size_t n_kinds, size_t b)
{
    struct body_start *body = &s->bodies[b];
    double *reals[BODY_REALS];
    list_reals(body, reals);
    body->id_first = (uint32_t)get_whole(w, s->next_id);
    body->id_end = (uint32_t)get_whole(w, s->next_id);
    body->grain_first = (uint32_t)get_whole(w, s->next_grain);
    body->grain_end = (uint32_t)get_whole(w, s->next_grain);
    for (size_t k = 0; k < BODY_REALS; k++)
        *reals[k] = get_real(w);
    w->failed |= body->id_end <= body->id_first || body->grain_end <= body->grain_first;
    for (int64_t n = get_whole(w, (int64_t)n_kinds); n > 0 && !w->failed; n--) {
        size_t kind = (size_t)get_whole(w, (int64_t)n_kinds - 1);
        s->kinds[b * n_kinds + kind] = true;
    }
}

/* The head, without the bodies and walls, whose numbers become those of the config. */
static void get_head(struct words *w, struct start_source *out, int64_t counts[2])
{
    const char *word;
    w->failed |= next_word(w, &word) != 5 || memcmp(word, "start", 5) != 0;
    w->failed |= next_word(w, &word) != START_DIGEST - 1;
    for (size_t k = 0; k < START_DIGEST - 1 && !w->failed; k++)
        w->failed |= strchr("0123456789abcdef", word[k]) == NULL || word[k] == '\0';
    if (!w->failed)
        memcpy(out->digest, word, START_DIGEST - 1);
    out->step = get_whole(w, INT64_MAX);
    out->time = get_real(w);
    out->dt_before = get_real(w);
    w->failed |= out->dt_before < 0.0;
    out->n_clock = get_whole(w, out->step);
    out->t_clock = get_real(w);
    out->next_id = (uint32_t)get_whole(w, UINT32_MAX);
    out->next_grain = (uint32_t)get_whole(w, UINT32_MAX);
    for (int k = 0; k < 2; k++)
        counts[k] = get_whole(w, MOVER_MAX);
}

/* The number of bytes of n lines from w->at on; w->length - w->at where there are fewer lines. */
static size_t lines_length(const struct words *w, int64_t n)
{
    size_t at = w->at;
    for (; at < w->length && n > 0; at++)
        n -= w->text[at] == '\n';
    return at - w->at;
}

static enum dm2_status get_parts(struct words *w, struct start_source *out, struct dm2_error *err)
{
    int64_t counts[2] = {0, 0};
    get_head(w, out, counts);
    if (w->failed)
        return dm2_fail(err, DM2_PROTOCOL, "the text about the state to start from does not read");
    size_t meaning = w->at + lines_length(w, 1 + counts[0] + counts[1]);
    enum dm2_status status = meaning_load(w->text + meaning, w->length - meaning, &out->before, err);
    if (status != DM2_OK)
        return status;
    size_t n_kinds = config_kinds(&out->before);
    out->bodies = mem_zalloc(out->before.n_bodies, sizeof *out->bodies);
    out->walls = mem_zalloc(out->before.n_walls, sizeof *out->walls);
    out->kinds = mem_zalloc(out->before.n_bodies, n_kinds * sizeof *out->kinds);
    if (out->bodies == NULL || out->walls == NULL || out->kinds == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the bodies of the state to start from");
    w->failed |= (size_t)counts[0] != out->before.n_bodies || (size_t)counts[1] != out->before.n_walls;
    w->length = meaning;
    uint64_t elements = 0;
    for (size_t b = 0; b < out->before.n_bodies && !w->failed; b++) {
        get_body(w, out, n_kinds, b);
        elements += out->bodies[b].id_end - out->bodies[b].id_first;
    }
    w->failed |= elements > out->next_id;
    for (size_t k = 0; k < out->before.n_walls && !w->failed; k++) {
        struct start_wall *wall = &out->walls[k];
        wall->moved[0] = get_real(w);
        wall->moved[1] = get_real(w);
        wall->angle = get_real(w);
    }
    const char *rest;
    w->failed |= next_word(w, &rest) != 0;
    return w->failed ? dm2_fail(err, DM2_PROTOCOL, "the text about the state to start from does not read")
                     : DM2_OK;
}

enum dm2_status start_get(const char *text, size_t length, struct start_source *out, struct dm2_error *err)
{
    struct words w = {.text = text, .length = length};
    memset(out, 0, sizeof *out);
    enum dm2_status status = get_parts(&w, out, err);
    if (status != DM2_OK)
        start_free(out);
    return status;
}

void start_free(struct start_source *s)
{
    config_free(&s->before);
    free(s->bodies);
    free(s->walls);
    free(s->kinds);
    memset(s, 0, sizeof *s);
}

/* --- beside the deck --- */

enum dm2_status deck_source_begin(struct deck_source *source, const char *text, size_t length,
                                  struct dm2_error *err)
{
    struct deck_text one = {mem_alloc(sizeof start_name, 1), mem_alloc(length + 1, 1), length};
    struct deck_text *texts = realloc(source->texts, (source->n_texts + 1) * sizeof *texts);
    if (texts != NULL)
        source->texts = texts;
    if (one.name == NULL || one.text == NULL || texts == NULL) {
        free(one.name);
        free(one.text);
        return dm2_fail(err, DM2_MEMORY, "no memory for the text about the state to start from");
    }
    memcpy(one.name, start_name, sizeof start_name);
    memcpy(one.text, text, length);
    one.text[length] = '\0';
    source->texts[source->n_texts++] = one;
    return DM2_OK;
}

const struct deck_text *deck_source_start(const struct deck_source *source)
{
    for (size_t k = 1; k < source->n_texts; k++)
        if (strcmp(source->texts[k].name, start_name) == 0)
            return &source->texts[k];
    return NULL;
}
