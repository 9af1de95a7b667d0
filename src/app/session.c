/* run.log keeps the heads of all sessions; a session without a line "ended" was killed. */
#include "session.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/sha256.h"
#include "dm2/base/text.h"
#include "dm2/base/version.h"
#include "dm2/engine/self_test.h"
#include "dm2/output/run_directory.h"
#include "signals.h"

/* --- command lines --- */

static void put(struct bytes_writer *w, const char *text)
{
    bytes_put_raw(w, text, strlen(text));
}

/* Adds a word in the form that a shell reads back. */
static void put_quoted(struct bytes_writer *w, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+@%";
    if (word[0] != '\0' && word[strspn(word, plain)] == '\0') {
        put(w, word);
        return;
    }
    put(w, "'");
    for (const char *c = word; *c != '\0'; c++)
        if (*c == '\'')
            put(w, "'\\''");
        else
            bytes_put_raw(w, c, 1);
    put(w, "'");
}

/* Ends a text; malloc'd, NULL without memory. */
static char *end_text(struct bytes_writer *w)
{
    bytes_put_u8(w, 0);
    if (!w->failed)
        return (char *)w->data;
    bytes_free(w);
    return NULL;
}

char *session_command(const struct run_options *o)
{
    struct bytes_writer w = {0};
    for (int k = 0; k < o->argc; k++) {
        if (k > 0)
            put(&w, " ");
        put_quoted(&w, o->argv[k]);
    }
    return end_text(&w);
}

/* The number of words at `word` that choose the start of the run and are left out of the new command line. */
static int words_of_restart(const char *word)
{
    return strcmp(word, "--restart") == 0
               ? 2
               : strncmp(word, "--restart=", 10) == 0 || strcmp(word, "--overwrite") == 0;
}

/* Whether the run goes on in the directory of its state, which the command line names by the state alone. */
static bool is_beside_state(const struct run_options *o)
{
    return o->directory == NULL && o->restart != NULL && !o->automatic;
}

static void print_advice(const struct run_options *o, const struct results *results)
{
    struct bytes_writer w = {0};
    if (results_checkpoint_step(results) < 0)
        return;
    put_quoted(&w, o->argv[0]);
    put(&w, " --restart auto");
    if (is_beside_state(o)) {
        put(&w, " -o ");
        put_quoted(&w, results_directory(results));
    }
    for (int k = 1; k < o->argc;) {
        int left_out = words_of_restart(o->argv[k]);
        if (left_out == 0) {
            put(&w, " ");
            put_quoted(&w, o->argv[k]);
        }
        k += left_out == 0 ? 1 : left_out;
    }
    char *command = end_text(&w);
    (void)fprintf(stderr, "%s: the last checkpoint is of step %lld; to continue: %s\n", o->program,
                  (long long)results_checkpoint_step(results), command == NULL ? "" : command);
    free(command);
}

/* " -o DIRECTORY" for a shell: where the state is, if the command line does not name the directory itself.
 * NULL without memory. */
static char *find_place(const struct run_options *o)
{
    struct bytes_writer w = {0};
    char *directory = is_beside_state(o) ? run_directory_of(o->restart) : NULL;
    if (directory != NULL) {
        put(&w, " -o ");
        put_quoted(&w, directory);
    }
    w.failed |= is_beside_state(o) && directory == NULL;
    free(directory);
    return end_text(&w);
}

void session_explain(const struct run_options *o, enum dm2_status status, struct dm2_error *err)
{
    struct dm2_error why = *err;
    if (status != DM2_INTERRUPTED || o->check)
        return;
    char *place = find_place(o);
    static const char advice[] = "; the same command with --restart auto";
    size_t room = sizeof err->text - sizeof advice - sizeof " goes on" - strlen(why.text);
    if (place == NULL || strlen(why.text) > 350 || strlen(place) >= room) /* half a name is another name */
        (void)dm2_fail(err, status, "%.350s%s, and -o with the directory of the state, goes on", why.text,
                       advice);
    else
        (void)dm2_fail(err, status, "%s%s%s goes on", why.text, advice, place);
    free(place);
}

/* --- run.log --- */

static void put_line(struct bytes_writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put_line(struct bytes_writer *w, const char *format, ...)
{
    char line[1024];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(line, sizeof line, format, args);
    va_end(args);
    text_make_printable(line, false);
    put(w, line);
    put(w, "\n");
}

static void put_now(struct bytes_writer *w, const char *name)
{
    char text[64] = "";
    time_t now = time(NULL);
    struct tm parts;
    if (localtime_r(&now, &parts) != NULL)
        (void)strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S %z", &parts);
    put_line(w, "%s: %s", name, text);
}

/* By blocks, because a state may be as large as the memory. */
bool session_digest(const char *path, char out[SHA256_TEXT])
{
    unsigned char block[1 << 14], digest[SHA256_BYTES];
    struct stat info;
    struct sha256 s;
    ssize_t got = -1;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    out[0] = '\0';
    if (fd < 0)
        return false;
    sha256_start(&s);
    if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode))
        while ((got = read(fd, block, sizeof block)) > 0 || (got < 0 && errno == EINTR))
            if (got > 0)
                sha256_add(&s, block, (size_t)got);
    close(fd);
    if (got < 0)
        return false;
    sha256_finish(&s, digest);
    sha256_text(digest, out);
    return true;
}

static enum dm2_status add_log(struct results *results, struct bytes_writer *w, struct dm2_error *err)
{
    enum dm2_status status = w->failed ? dm2_fail(err, DM2_MEMORY, "no memory for the run's log")
                                       : results_log(results, (const char *)w->data, w->length, err);
    bytes_free(w);
    return status;
}

/* deck.dm2 of a run that begins from a state opens with this line. */
static const char begun_from[] = "# begun from the state ";

static enum dm2_status write_deck(const struct run *run, struct results *results, struct dm2_error *err)
{
    struct bytes_writer text = {0}, deck = {0};
    enum dm2_status status = deck_source_flatten(&run->source, &run->config, &deck, err);
    const char *from = (const char *)deck.data;
    size_t n = deck.length, mark = sizeof begun_from - 1;
    if (status == DM2_OK && run->from_path != NULL) {
        put_line(&text, "%s%.600s, SHA-256 %s: give it with --start FILE", begun_from, run->from_path,
                 run->from_digest);
        const char *end = n >= mark && memcmp(from, begun_from, mark) == 0 ? memchr(from, '\n', n) : NULL;
        n -= end == NULL ? 0 : (size_t)(end + 1 - from); /* a deck.dm2 that is run again has such a line */
        from = end == NULL ? from : end + 1;
    }
    bytes_put_raw(&text, from, n);
    if (status == DM2_OK && text.failed)
        status = dm2_fail(err, DM2_MEMORY, "no memory for the deck as one text");
    if (status == DM2_OK)
        status = results_text(results, "deck.dm2", (const char *)text.data, text.length, err);
    bytes_free(&text);
    bytes_free(&deck);
    return status;
}

enum dm2_status session_begin(const struct run_options *o, const struct run *run, struct results *results,
                              struct dm2_error *err)
{
    struct bytes_writer w = {0};
    char host[256] = "", digest[SHA256_TEXT], *command = session_command(o);
    enum dm2_status status = command == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for the command line")
                                             : write_deck(run, results, err);
    (void)gethostname(host, sizeof host - 1);
    sha256_text(run->origin.digest, digest);
    put_line(&w, "program: %s %s", o->program, DM2_VERSION);
    put_line(&w, "fingerprint: %016" PRIx64, (uint64_t)SELF_TEST_FINGERPRINT);
    put(&w, "command: ");
    put(&w, command == NULL ? "" : command);
    put(&w, "\n");
    put_line(&w, "host: %s, process %ld", host, (long)getpid());
    put_now(&w, "start");
    put_line(&w, "deck digest: %s", digest);
    if (run->restarted)
        put_line(&w, "from: step %lld, %s, SHA-256 %s", (long long)run->state.step, run->state_path,
                 run->state_digest);
    else if (run->staged)
        put_line(&w, "from: the state %s, SHA-256 %s", run->from_path, run->from_digest);
    else
        put_line(&w, "from: the beginning");
    free(command);
    if (status == DM2_OK)
        return add_log(results, &w, err);
    bytes_free(&w);
    return status;
}

/* Adds the digest of the state `name` in the run directory, if it is there, and the time. */
static void put_end(struct bytes_writer *w, const struct results *results, const char *name)
{
    char digest[SHA256_TEXT], *path = text_join(results_directory(results), "/", name);
    if (path == NULL)
        w->failed = true;
    else if (session_digest(path, digest))
        put_line(w, "state: %s, SHA-256 %s", name, digest);
    put_now(w, "end");
    free(path);
}

enum dm2_status session_end(struct results *results, struct dm2_error *err)
{
    struct bytes_writer w = {0};
    put_end(&w, results, "final.dm2");
    put_line(&w, "ended: done");
    return add_log(results, &w, err);
}

void session_fail(const struct run_options *o, struct results *results, const struct dm2_error *why)
{
    struct bytes_writer w = {0};
    if (results == NULL)
        return;
    print_advice(o, results);
    put_end(&w, results, "checkpoint.dm2");
    if (why->status == DM2_INTERRUPTED)
        put_line(&w, "ended: signal %d: %s", signals_caught(), why->text);
    else
        put_line(&w, "ended: failed: %s", why->text);
    (void)add_log(results, &w, NULL);
}
