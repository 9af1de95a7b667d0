/* All checks of a state that need the deck: does the state belong to this run, and does the run reach its
 * step? */
#include "restart.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/deck/meaning.h"
#include "dm2/output/run_directory.h"
#include "session.h"

/* --- one state --- */

/* Whether a state is of this run's deck; `status` is that of the failure. */
static enum dm2_status check_deck(const char *path, const struct state *s, const struct run *run,
                                  enum dm2_status status, struct dm2_error *err)
{
    size_t n = model_elements(run->model);
    char difference[MEANING_DIFFERENCE];
    if (meaning_difference(s->origin.text, s->origin.text_length, run->origin.text, run->origin.text_length,
                           difference))
        return dm2_fail(
            err, status,
            "%s: belongs to another deck: %s; to go on from this state with another deck: `start { "
            "state = ... }`, or --start FILE",
            path, difference);
    bool whole = n == 0 || n < model_ids(run->model) ||
                 (s->n_elements > 0 && s->elements[s->n_elements - 1].id == n - 1);
    if (s->n_elements != n || !whole) /* check_records finds ids that are no body's */
        return dm2_fail(err, status, "%s: has %zu elements, the deck makes %zu", path, s->n_elements, n);
    return DM2_OK;
}

static enum dm2_status check_records(const char *path, const struct state *s, const struct run *run,
                                     struct dm2_error *err)
{
    const struct record_limits limits = record_limits_of(run->model);
    return state_check(path, s, &limits, err);
}

/* Enters the path of the state. */
static enum dm2_status note_path(struct run *run, const char *path, struct dm2_error *err)
{
    run->state_path = text_join(path, "", "");
    (void)session_digest(path, run->state_digest);
    run->restarted = run->state_path != NULL;
    return run->restarted ? DM2_OK : dm2_fail(err, DM2_MEMORY, "no memory for the name of the state");
}

/* --- --restart FILE --- */

/* Reads a state and checks that the state belongs to this run: deck, number of elements, step, indices. */
static enum dm2_status read_state(const char *path, const struct run *run, struct state *out,
                                  struct dm2_error *err)
{
    enum dm2_status status = state_read(path, out, err);
    if (status != DM2_OK)
        return status;
    status = check_deck(path, out, run, DM2_PROTOCOL, err);
    if (status == DM2_OK && out->step > run->config.steps)
        status = dm2_fail(err, DM2_PROTOCOL, "%s: is of step %lld, the run has %lld: give more with --steps",
                          path, (long long)out->step, (long long)run->config.steps);
    if (status == DM2_OK)
        status = check_records(path, out, run, err);
    if (status != DM2_OK)
        state_free(out);
    return status;
}

enum dm2_status restart_read(const struct run_options *o, struct run *run, struct dm2_error *err)
{
    static const char name[] = "checkpoint.dm2";
    struct dm2_error why = {0};
    enum dm2_status status = read_state(o->restart, run, &run->state, &why);
    if (status == DM2_OK)
        return note_path(run, o->restart, err);
    char before[4096];
    size_t length = strlen(o->restart), tail = sizeof name - 1;
    if (length >= tail && strcmp(o->restart + length - tail, name) == 0) {
        struct state other;
        (void)snprintf(before, sizeof before, "%.*scheckpoint.prev.dm2", (int)(length - tail), o->restart);
        if (read_state(before, run, &other, NULL) == DM2_OK) {
            long long step = (long long)other.step;
            state_free(&other);
            return dm2_fail(err, status, "%s; the one before it can be used, of step %lld: --restart %s",
                            why.text, step, before);
        }
    }
    return dm2_fail(err, status, "%s", why.text);
}

/* --- --restart auto --- */

/* The states of a directory. */
struct choice {
    char *path;         /* of the whole state of the greatest step; NULL: none */
    struct state state; /* this state */
    bool is_final;      /* its name is final.dm2 */
    char damage[480];   /* why others cannot be read; "": none */
};

static void free_choice(struct choice *c)
{
    free(c->path);
    state_free(&c->state);
}

/* Reads one state of the directory, if it is there and whole. */
static enum dm2_status try_state(struct choice *c, const char *directory, const char *name, bool is_final,
                                 struct dm2_error *err)
{
    struct state s;
    struct dm2_error why = {0};
    char *path = text_join(directory, "/", name);
    if (path == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the name of a state");
    enum dm2_status status = file_is_absent(path) ? DM2_USAGE : state_read(path, &s, &why);
    size_t used = strlen(c->damage);
    if (status == DM2_MEMORY) {
        free(path);
        return dm2_fail(err, status, "%s", why.text);
    }
    if (status == DM2_OK && (c->path == NULL || s.step > c->state.step)) {
        free_choice(c);
        c->path = path;
        c->state = s;
        c->is_final = is_final;
        return DM2_OK;
    }
    if (status == DM2_OK)
        state_free(&s);
    else if (why.text[0] != '\0')
        (void)snprintf(c->damage + used, sizeof c->damage - used, "%s%.230s", used > 0 ? "; " : "", why.text);
    free(path);
    return DM2_OK;
}

static enum dm2_status read_states(struct choice *c, const char *directory, struct dm2_error *err)
{
    enum dm2_status status = try_state(c, directory, "final.dm2", true, err);
    if (status == DM2_OK)
        status = try_state(c, directory, "checkpoint.dm2", false, err);
    if (status == DM2_OK)
        status = try_state(c, directory, "checkpoint.prev.dm2", false, err);
    return status;
}

/* Whether all tables of the run are there under their final names. */
static bool has_tables(const char *directory, const struct run_content *content)
{
    char *history = text_join(directory, "/", "history.csv");
    bool has = history != NULL && content->tables == 0 && !file_is_absent(history);
    free(history);
    return has;
}

static void tell(const struct run_options *o, const char *format, const char *a, long long step,
                 const char *b)
{
    if (o->quiet)
        return;
    (void)fprintf(stderr, "%s: ", o->program);
    (void)fprintf(stderr, format, a, step, b);
    (void)fputc('\n', stderr);
}

/* Takes the chosen state. */
static enum dm2_status take_choice(const struct run_options *o, struct run *run, const char *directory,
                                   const struct run_content *content, struct choice *c, struct dm2_error *err)
{
    long long step = (long long)c->state.step, last = (long long)run->config.steps;
    enum dm2_status status = check_deck(c->path, &c->state, run, DM2_DECK, err);
    if (status == DM2_OK && step > last)
        return dm2_fail(err, DM2_DECK,
                        "%s: is of step %lld, the deck ends at %lld: give more with --steps, or name another "
                        "run directory with -o DIR",
                        c->path, step, last);
    if (status == DM2_OK)
        status = check_records(c->path, &c->state, run, err);
    if (status != DM2_OK)
        return status;
    bool stopped = step < last && results_ended_by_stop(directory, &run->config, step);
    if (c->is_final && (step == last || stopped) && has_tables(directory, content)) {
        run->complete = true;
        if (!o->quiet)
            (void)printf("complete: %s has the results of all %lld steps%s\n", directory, step,
                         stopped ? ", at which a block 'stop' ended the run" : "");
        return DM2_OK;
    }
    if (c->damage[0] != '\0')
        tell(o, "%s; going on from step %lld, %s", c->damage, step, c->path);
    else
        tell(o, "%s: going on from step %lld%s", c->path, step, "");
    run->state = c->state;
    c->state = (struct state){0};
    return note_path(run, c->path, err);
}

static enum dm2_status choose(const struct run_options *o, struct run *run, const char *directory,
                              struct dm2_error *err)
{
    struct run_content content;
    struct choice c = {0};
    enum dm2_status status = run_directory_survey(directory, &content, err);
    if (status == DM2_OK && content.states == 0) {
        run->anew = content.others == 0;
        if (run->anew && content.tables > 0)
            tell(o, "%s: has tables of a run that ended before its first checkpoint: begun anew%.0lld%s",
                 directory, 0, "");
        return DM2_OK;
    }
    if (status == DM2_OK)
        status = read_states(&c, directory, err);
    if (status == DM2_OK && c.path == NULL)
        status = dm2_fail(err, DM2_IO, "%.80s: none of its states can be used: %s", directory, c.damage);
    else if (status == DM2_OK)
        status = take_choice(o, run, directory, &content, &c, err);
    free_choice(&c);
    return status;
}

enum dm2_status restart_choose(const struct run_options *o, struct run *run, struct dm2_error *err)
{
    char *directory = run_directory_name(o), *command = session_command(o);
    enum dm2_status status = DM2_OK;
    if (directory == NULL || command == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory for the run directory's name");
    else if (!o->check)
        status = results_claim(directory, command, &run->results, err);
    if (status == DM2_OK && !(o->check && file_is_absent(directory)))
        status = choose(o, run, directory, err);
    free(directory);
    free(command);
    return status;
}
