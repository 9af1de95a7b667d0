/* The deck of a session: the server's own copy or the texts that the client sends, compared by digest,
 * checked against the server's limits, loaded.
 *
 * A name from a client leads to no file outside the deck directory: neither by an absolute path, nor by "..",
 * nor by a symbolic link; the same holds for the files that a deck includes. */
#include "server_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "dm2/base/mem.h"
#include "dm2/deck/meaning.h"

/* Is a component of the path ".."? */
static bool has_parent_component(const char *name)
{
    for (const char *p = name; p != NULL; p = strchr(p, '/')) {
        p += *p == '/';
        if (p[0] == '.' && p[1] == '.' && (p[2] == '/' || p[2] == '\0'))
            return true;
    }
    return false;
}

/* The path of the regular file `name` below `directory`: `name` is no absolute path and has no component
 * "..", and no component of it is a symbolic link. malloc'd, or NULL where there is no such file. */
static char *find_deck(const char *directory, const char *name)
{
    size_t root = strlen(directory) + 1, size = root + strlen(name) + 1;
    char *path = name[0] == '\0' || name[0] == '/' || has_parent_component(name) ? NULL : mem_alloc(size, 1);
    if (path == NULL)
        return NULL;
    (void)snprintf(path, size, "%s/%s", directory, name);
    bool found = true;
    struct stat info;
    for (char *end = path + root; end != NULL && found;) { /* the path up to each component of the name */
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

/* May a deck of the directory include this file? `path` begins with `directory`. */
static bool may_read_file(void *directory, const char *path)
{
    char *found = find_deck(directory, path + strlen(directory) + 1);
    free(found);
    return found != NULL;
}

/* Moves the texts of the server's own copy of the deck to s->deck. False where there is no copy. */
static bool read_own_copy(struct session *s)
{
    char *path = find_deck(s->options->deck_dir, s->deck.name);
    struct deck_source own;
    struct dm2_error ignored;
    bool found =
        path != NULL && deck_source_read_some(path, may_read_file, (void *)(uintptr_t)s->options->deck_dir,
                                              &own, &ignored) == DM2_OK;
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

/* Compares the meaning of the loaded deck with the client's. */
static enum dm2_status check_digest(const struct session *s, bool own_copy, struct dm2_error *err)
{
    struct deck_meaning meaning;
    char here[SHA256_TEXT], there[SHA256_TEXT];
    enum dm2_status status = meaning_build(&s->config, PARTS_ALL, &meaning, err);
    if (status != DM2_OK)
        return status;
    sha256_text(meaning.digest, here);
    sha256_text(s->deck.digest, there);
    meaning_free(&meaning);
    if (strcmp(here, there) == 0)
        return DM2_OK;
    return dm2_fail(err, DM2_PROTOCOL,
                    "the deck '%.100s' differs: digest %s on the client, %s on the server%s", s->deck.name,
                    there, here, own_copy ? ": bring the copies together, or use --send-deck" : "");
}

static enum dm2_status send_answer(struct session *s, uint8_t loaded, struct dm2_error *err)
{
    bytes_clear(&s->out);
    bytes_put_u8(&s->out, loaded);
    return server_send(s, MESSAGE_ANSWER, err);
}

/* Compares the number of time steps with --max-steps. DM2_DECK. */
static enum dm2_status check_steps(const struct session *s, struct dm2_error *err)
{
    int64_t most = s->options->max_steps;
    if (most == 0 || s->config.steps <= most)
        return DM2_OK;
    return dm2_fail(err, DM2_DECK,
                    "the deck has %lld time steps, this server takes at most %lld: dm2-server --max-steps N",
                    (long long)s->config.steps, (long long)most);
}

/* Compares an estimate of the model with --max-elements, before the model is built. The bounds are loose,
 * because the estimate is; check_elements compares the exact number. DM2_DECK. */
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
    if (most == 0 || model_ids(s->model) <= most)
        return DM2_OK;
    return dm2_fail(
        err, DM2_DECK,
        "the deck makes %zu elements, this server takes at most %llu: dm2-server --max-elements N",
        model_ids(s->model), (unsigned long long)most);
}

static enum dm2_status load_deck(struct session *s, bool own_copy, struct dm2_error *err)
{
    struct deck_report report = {0};
    enum dm2_status status = deck_load(&s->deck.source, &s->config, &report);
    s->loaded = status == DM2_OK;
    if (status != DM2_OK)
        status = dm2_fail(err, status, "the deck does not load: %s",
                          report.text == NULL ? "no memory" : report.text);
    deck_report_free(&report);
    if (status == DM2_OK)
        status = check_digest(s, own_copy, err);
    if (status == DM2_OK)
        status = check_steps(s, err);
    if (status == DM2_OK)
        status = check_estimate(s, err);
    if (status == DM2_OK)
        status =
            model_build_watched(&s->config, (struct pulse){server_beat, s, server_stopped}, &s->model, err);
    return status == DM2_OK ? check_elements(s, err) : status;
}

/* Waits for DECK. Each ECHO before DECK is sent back unchanged, so that the client can time round trips. With
 * summary->measured an empty ECHO has come, and *out is not set. */
static enum dm2_status expect_deck(struct session *s, struct bytes_reader *out, struct dm2_error *err)
{
    struct frame f;
    enum dm2_status status;
    for (;;) {
        status = server_receive(s, LIMIT_DECK, server_deadline(s), &f, err);
        if (status != DM2_OK || f.type != MESSAGE_ECHO)
            break;
        s->summary->measured = f.length == 0;
        if (s->summary->measured)
            return DM2_OK;
        status = channel_send(&s->channel, MESSAGE_ECHO, 0, f.payload, f.length, server_deadline(s), err);
        if (status != DM2_OK)
            break;
        s->summary->echoes++;
    }
    return status == DM2_OK ? server_check_type(&f, MESSAGE_DECK, out, err) : status;
}

enum dm2_status server_get_deck(struct session *s, struct dm2_error *err)
{
    for (int attempt = 0;; attempt++) {
        struct bytes_reader r;
        enum dm2_status status =
            attempt == 0 ? expect_deck(s, &r, err)
                         : server_expect(s, MESSAGE_DECK, LIMIT_DECK, server_deadline(s), &r, err);
        if (status != DM2_OK || s->summary->measured)
            return status;
        message_free_deck(&s->deck);
        message_get_deck(&r, &s->deck);
        if (r.failed || (attempt > 0 && !s->deck.with_texts))
            return server_not_decoded("DECK", err);
        (void)snprintf(s->summary->deck, sizeof s->summary->deck, "%s", s->deck.name);
        bool own_copy = !s->deck.with_texts && read_own_copy(s);
        if (s->deck.with_texts || own_copy) {
            status = load_deck(s, own_copy, err);
            return status == DM2_OK ? send_answer(s, 1, err) : status;
        }
        status = send_answer(s, 0, err);
        if (status != DM2_OK)
            return status;
    }
}
