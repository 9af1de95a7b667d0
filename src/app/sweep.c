/* Runs for timing start the programs that users start, so that a measured run is a user's run. */
#include "sweep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/csv.h"
#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "child.h"
#include "places.h"

static const char DECK[] = "timing.dm2";

void sweep_start(struct sweep *s, struct option *table)
{
    *s = (struct sweep){.steps = 40, .runs = 3, .directory = "dm2-timing", .cancel = -1};
    const struct option all[SWEEP_OPTIONS] = {
        {"n", 0, OPTION_LIST, &s->n_texts, "N,...", "numbers of elements", 0, 0},
        {"steps", 0, OPTION_INTEGER, &s->steps, "K", "time steps of a run (default 40)", 2, INT64_MAX},
        {"runs", 0, OPTION_INTEGER, &s->runs, "R", "runs of each case (default 3)", 1, 100},
        {"deck", 0, OPTION_TEXT, &s->deck, "FILE", "what is run, with a `let n` (default input/timing.dm2)",
         0, 0},
        {"output", 'o', OPTION_TEXT, &s->directory, "DIR", "where runs leave their logs (default dm2-timing)",
         0, 0},
    };
    memcpy(table, all, sizeof all);
}

static enum dm2_status add_size(struct sweep *s, const char *text, size_t length, struct dm2_error *err)
{
    int64_t n;
    if (!number_parse_integer(text, length, &n) || n < 1 || n > 1000000000)
        return dm2_fail(err, DM2_USAGE, "--n '%.*s': a whole number from 1 to 1e9 is expected", (int)length,
                        text);
    if (s->sizes == SWEEP_SIZES)
        return dm2_fail(err, DM2_USAGE, "--n has more than %d numbers", SWEEP_SIZES);
    s->n[s->sizes++] = (double)n;
    return DM2_OK;
}

static enum dm2_status find_deck(struct sweep *s, const char *argv0, struct dm2_error *err)
{
    static const char *const below[] = {"../input/", "../share/dm2/input/"};
    const char *slash = strrchr(argv0, '/');
    int directory = slash == NULL ? 0 : (int)(slash - argv0) + 1;
    if (s->deck != NULL) {
        (void)snprintf(s->deck_path, sizeof s->deck_path, "%s", s->deck);
        return DM2_OK;
    }
    for (size_t k = 0; k < sizeof below / sizeof below[0] && directory > 0; k++) {
        (void)snprintf(s->deck_path, sizeof s->deck_path, "%.*s%s%s", directory, argv0, below[k], DECK);
        if (access(s->deck_path, R_OK) == 0)
            return DM2_OK;
    }
    (void)snprintf(s->deck_path, sizeof s->deck_path, "input/%s", DECK);
    if (access(s->deck_path, R_OK) == 0)
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "the deck %s was not found beside the program: name it with --deck",
                    DECK);
}

enum dm2_status sweep_finish(struct sweep *s, const double *n, int sizes, const char *argv0,
                             struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    s->argv0 = argv0;
    for (size_t k = 0; k < s->n_texts.n; k++)
        for (const char *at = s->n_texts.items[k]; at != NULL && status == DM2_OK;) {
            size_t length = strcspn(at, ",");
            status = add_size(s, at, length, err);
            at = at[length] == ',' ? at + length + 1 : NULL;
        }
    for (int k = 0; k < sizes && s->n_texts.n == 0; k++)
        s->n[s->sizes++] = n[k];
    return status == DM2_OK ? find_deck(s, argv0, err) : status;
}

void sweep_free(struct sweep *s)
{
    option_list_free(&s->n_texts);
}

/* --- running --- */

/* Adds the options that name the client's servers to the command line at `argc`; returns the new argc. */
static int add_servers(const struct server_choice *c, int servers, char *count, size_t size,
                       char (*names)[HOST_MAX + 8], char **argv, int argc)
{
    static char local[] = "-n", server[] = "--server", key[] = "--key";
    if (c->named.n == 0) {
        (void)snprintf(count, size, "%d", servers);
        argv[argc++] = local;
        argv[argc++] = count;
        return argc;
    }
    for (int k = 0; k < servers; k++) {
        const struct endpoint *e = &c->named.items[k];
        bool v6 = strchr(e->host, ':') != NULL;
        (void)snprintf(names[k], sizeof names[k], v6 ? "[%s]:%d" : "%s:%d", e->host, e->port);
        argv[argc++] = server;
        argv[argc++] = names[k];
    }
    if (c->key_file != NULL) {
        argv[argc++] = key;
        argv[argc++] = (char *)c->key_file;
    }
    return argc;
}

/* The command line of a run, and the texts that its words point to. */
struct run_line {
    char directory[SWEEP_PATH], definition[64], steps[32], count[16];
    char *path, **argv;
    char (*names)[HOST_MAX + 8];
};

static void free_line(struct run_line *l)
{
    free(l->path);
    free(l->argv);
    free(l->names);
}

/* Writes the command line; line->directory is set. `servers` 0: of dm2-seq. */
static enum dm2_status write_line(const struct sweep *s, double n, int servers, struct run_line *line,
                                  struct dm2_error *err)
{
    enum { FIXED = 16 };
    static char quiet[] = "-q", overwrite[] = "--overwrite", output[] = "-o", define[] = "-D",
                number[] = "--steps";
    line->path = places_program(s->argv0, servers == 0 ? "dm2-seq" : "dm2-client");
    line->names = mem_zalloc((size_t)servers + 1, sizeof *line->names);
    line->argv = mem_zalloc((size_t)(FIXED + 2 * servers), sizeof *line->argv);
    if (line->path == NULL || line->names == NULL || line->argv == NULL) {
        free_line(line);
        return dm2_fail(err, DM2_MEMORY, "no memory for a run of %d servers", servers);
    }
    char *const fixed[] = {line->path, (char *)s->deck_path, quiet,  overwrite,  output, line->directory,
                           define,     line->definition,     number, line->steps};
    (void)snprintf(line->definition, sizeof line->definition, "n=%.0f", n);
    (void)snprintf(line->steps, sizeof line->steps, "%lld", (long long)s->steps);
    memcpy(line->argv, fixed, sizeof fixed);
    if (servers > 0)
        (void)add_servers(s->servers, servers, line->count, sizeof line->count, line->names, line->argv,
                          (int)(sizeof fixed / sizeof fixed[0]));
    return DM2_OK;
}

/* Reads the report of a finished run and deletes its large files, which have no use in a sweep. */
static enum dm2_status read_report(const char *directory, struct run_report *out, struct dm2_error *err)
{
    static const char *const large[] = {"final.dm2", "history.csv"};
    char path[SWEEP_PATH + 16];
    for (size_t k = 0; k < sizeof large / sizeof large[0]; k++) {
        (void)snprintf(path, sizeof path, "%s/%s", directory, large[k]);
        (void)unlink(path);
    }
    return sweep_read(directory, out, err);
}

enum dm2_status sweep_run(const struct sweep *s, double n, int servers, int run, struct run_report *out,
                          struct dm2_error *err)
{
    struct run_line line = {0};
    if (servers == 0)
        (void)snprintf(line.directory, sizeof line.directory, "%s/n%.0f-seq-%d", s->directory, n, run);
    else
        (void)snprintf(line.directory, sizeof line.directory, "%s/n%.0f-servers%d-%d", s->directory, n,
                       servers, run);
    enum dm2_status status = write_line(s, n, servers, &line, err);
    if (status != DM2_OK)
        return status;
    status = child_run(line.argv, s->cancel, err);
    if (status == DM2_OK)
        status = read_report(line.directory, out, err);
    free_line(&line);
    return status;
}

/* --- reading --- */

/* Reads the number behind `label` at the start of a line of the log. */
static bool find_number(const char *log, const char *label, double *out)
{
    size_t length = strlen(label);
    for (const char *line = log; line != NULL; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, label, length) == 0)
            return number_parse(line + length, strcspn(line + length, " \n"), out);
    }
    return false;
}

/* Reads the number behind `before` on the first line of the log that contains `line`. */
static bool find_after(const char *log, const char *line, const char *before, double *out)
{
    const char *at = strstr(log, line), *end = at == NULL ? NULL : strchr(at, '\n');
    const char *hit = at == NULL ? NULL : strstr(at, before);
    if (hit == NULL || (end != NULL && hit > end))
        return false;
    hit += strlen(before);
    return number_parse(hit, strcspn(hit, " \n"), out);
}

static bool read_log(const char *log, struct run_report *out)
{
    double elements, steps, ranks, stepping, timed, relay, redone, g;
    bool good = find_number(log, "elements: ", &elements) && find_number(log, "steps: ", &steps) &&
                find_number(log, "subdomains: ", &ranks) &&
                find_number(log, "time steps alone: ", &stepping) &&
                find_after(log, "time steps alone: ", " s for ", &timed) &&
                find_after(log, "client: ", "servers, ", &relay) &&
                find_after(log, "rebuilds: ", "of them ", &redone) && find_number(log, "g: ", &g) &&
                elements >= 1 && steps >= 0 && ranks >= 1 && ranks <= HOSTS_MOST;
    if (!good)
        return false;
    out->program = strncmp(log, "program: dm2-seq ", 17) == 0 ? "dm2-seq" : "dm2-client";
    out->elements = (size_t)elements;
    out->steps = (int64_t)steps;
    out->ranks = (int)ranks;
    out->stepping = stepping;
    out->timed = (int64_t)timed;
    out->relay = relay;
    out->redone = (uint64_t)redone;
    out->update_bytes = (size_t)g;
    return true;
}

static enum dm2_status read_table(const char *path, struct run_report *out, struct dm2_error *err)
{
    enum { COLUMNS = 12 };
    static const char *const names[COLUMNS] = {"cells",      "elements",      "mirrored",    "steps",
                                               "forces [s]", "integrate [s]", "rebuild [s]", "pack [s]",
                                               "unpack [s]", "cpu [s]",       "migrants",    "ahead [s]"};
    struct csv csv;
    enum dm2_status status = csv_read(path, &csv, err);
    if (status != DM2_OK)
        return status;
    out->servers = mem_zalloc((size_t)out->ranks, sizeof *out->servers);
    if (out->servers == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory for %d servers", out->ranks);
    else if (csv.n_rows != (size_t)out->ranks)
        status = dm2_fail(err, DM2_USAGE, "%s: %zu servers, run.log has %d", path, csv.n_rows, out->ranks);
    for (size_t c = 0; c < COLUMNS && status == DM2_OK; c++) {
        size_t column;
        double *x = NULL;
        status = csv_column(&csv, names[c], &column, err);
        if (status == DM2_OK)
            status = csv_numbers(&csv, column, &x, err);
        for (int k = 0; k < out->ranks && status == DM2_OK; k++) {
            struct server_report *s = &out->servers[k];
            struct server_times *t = &s->times;
            double *const seconds[COLUMNS] = {
                [4] = &t->forces, [5] = &t->integrate, [6] = &t->rebuild, [7] = &t->pack,
                [8] = &t->unpack, [9] = &t->cpu,       [11] = &t->ahead};
            uint64_t *const counts[COLUMNS] = {
                [1] = &s->owned, [2] = &s->mirrored, [3] = &t->steps, [10] = &t->migrants};
            double value = x[k] >= 0 && x[k] < 1e18 ? x[k] : 0;
            if (c == 0)
                s->cells = (size_t)value;
            else if (seconds[c] != NULL)
                *seconds[c] = value;
            else
                *counts[c] = (uint64_t)value;
        }
        free(x);
    }
    csv_free(&csv);
    return status;
}

enum dm2_status sweep_read(const char *directory, struct run_report *out, struct dm2_error *err)
{
    enum { LOG_MOST = 64 * 1024 * 1024 };
    char path[SWEEP_PATH + 16];
    unsigned char *log;
    size_t length;
    *out = (struct run_report){0};
    (void)snprintf(path, sizeof path, "%s/run.log", directory);
    enum dm2_status status = file_read(path, LOG_MOST, &log, &length, err);
    if (status != DM2_OK)
        return status;
    if (!read_log((const char *)log, out))
        status = dm2_fail(err, DM2_USAGE, "%s: is not the log of a finished run", path);
    free(log);
    (void)snprintf(path, sizeof path, "%s/timing.csv", directory);
    if (status == DM2_OK)
        status = read_table(path, out, err);
    if (status != DM2_OK) {
        free(out->servers);
        out->servers = NULL;
    }
    return status;
}
