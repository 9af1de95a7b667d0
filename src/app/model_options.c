/* Options of dm2-model's commands.
 *
 * options_parse only collects texts; model_options_finish then reads them in a fixed order, the preset
 * before the options that replace its constants, so that the order on the command line does not matter. */
#include "model_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/version.h"
#include "dm2/performance/calibration.h"

static const double PAPER_ASPECT = 1.3571; /* domain of the study in section 7.2 */
static const char *const CONSTANT_NAMES[MODEL_CONSTANTS] = {"dx", "dy", "lx", "ly", "k", "g"};

void model_options_start(struct model_options *o, struct option *table)
{
    *o = (struct model_options){0};
    const char **c = o->constants;
    const struct option all[MODEL_OPTIONS] = {
        {"preset", 0, OPTION_TEXT, &o->preset, "WHICH",
         "constants: paper (default), here (calibrated), or a FILE", 0, 0},
        {"n", 0, OPTION_LIST, &o->n_texts, "N,...", "numbers of elements; may be repeated", 0, 0},
        {"aspect", 0, OPTION_TEXT, &o->aspect, "S", "width of the domain to its height (default 1.3571)", 0,
         0},
        {"servers", 0, OPTION_LIST, &o->servers_texts, "N,...", "numbers of servers; may be repeated", 0, 0},
        {"dx", 0, OPTION_TEXT, &c[0], "CM", "d_x, distance of neighbouring elements in x, cm", 0, 0},
        {"dy", 0, OPTION_TEXT, &c[1], "CM", "d_y, the same in y, cm", 0, 0},
        {"lx", 0, OPTION_TEXT, &c[2], "CM", "L_x, width of a cell, cm", 0, 0},
        {"ly", 0, OPTION_TEXT, &c[3], "CM", "L_y, height of a cell, cm", 0, 0},
        {"k", 0, OPTION_TEXT, &c[4], "S", "k, cost of computing in T_seq = k n^2/c, seconds", 0, 0},
        {"g", 0, OPTION_TEXT, &c[5], "BYTES", "g, bytes that carry an element", 0, 0},
        {"m", 0, OPTION_TEXT, &o->m, "S", "m_N, seconds per byte: one number, or 2=3.6e-6,4=7.3e-6,...", 0,
         0},
        {"b", 0, OPTION_TEXT, &o->b, "S", "b_N, seconds per round trip: likewise", 0, 0},
        {"general", 0, OPTION_FLAG, &o->general, NULL, "counts on the real bisection for 2, 4, 8 servers too",
         0, 0},
        {"transport", 0, OPTION_TEXT, &o->transport, "HOW",
         "relay (default), or peer: half the communication", 0, 0},
        {"count", 0, OPTION_TEXT, &o->count, "WHAT", "edges (default, the paper's), or mirrored cells", 0, 0},
        {"slowest", 0, OPTION_FLAG, &o->slowest, NULL, "the server with the most work, not the average", 0,
         0},
        {"overlap", 0, OPTION_TEXT, &o->overlap, "F",
         "share of computing that hides communication, or: inner", 0, 0},
        {"migrants", 0, OPTION_TEXT, &o->migrants, "F", "elements that migrate per step / those exchanged", 0,
         0},
        {"migrant-bytes", 0, OPTION_TEXT, &o->migrant_bytes, "BYTES",
         "that carry a migrating element (default g)", 0, 0},
        {"client-rate", 0, OPTION_TEXT, &o->client_rate, "B/S", "bytes/s that the client's link carries", 0,
         0},
        {"periodic", 0, OPTION_TEXT, &o->periodic, "SIDES", "x, y or xy: sides that meet each other", 0, 0},
        {"csv", 0, OPTION_FLAG, &o->csv, NULL, "comma-separated values, times in seconds", 0, 0},
        {"help", 'h', OPTION_FLAG, &o->help, NULL, "prints this", 0, 0},
        {"version", 0, OPTION_FLAG, &o->version, NULL, "prints the version", 0, 0},
    };
    memcpy(table, all, sizeof all);
}

/* --- numbers and lists --- */

static enum dm2_status read_number(const char *name, const char *text, size_t length, double *out,
                                   struct dm2_error *err)
{
    if (number_parse(text, length, out) && isfinite(*out))
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "--%s '%.*s': a number is expected", name, (int)length, text);
}

static enum dm2_status read_optional_number(const char *name, const char *text, double *out,
                                            struct dm2_error *err)
{
    return text == NULL ? DM2_OK : read_number(name, text, strlen(text), out, err);
}

enum dm2_status model_option_number(const char *name, const char *text, double *out, struct dm2_error *err)
{
    enum dm2_status status = read_number(name, text, strlen(text), out, err);
    if (status == DM2_OK && !(*out > 0))
        status = dm2_fail(err, DM2_USAGE, "--%s '%s': a number above 0 is expected", name, text);
    return status;
}

/* Called with each item of a comma-separated list. */
typedef enum dm2_status (*take_item)(void *context, const char *text, size_t length, struct dm2_error *err);

static enum dm2_status for_each_item(const char *list, take_item take, void *context, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (const char *at = list; status == DM2_OK && at != NULL;) {
        size_t length = strcspn(at, ",");
        status = take(context, at, length, err);
        at = at[length] == ',' ? at + length + 1 : NULL;
    }
    return status;
}

struct whole_list {
    const char *name;
    double most;
    double *items;
    size_t n, cap;
};

static enum dm2_status take_whole(void *context, const char *text, size_t length, struct dm2_error *err)
{
    struct whole_list *list = context;
    double x;
    if (!number_parse(text, length, &x) || !(x >= 1 && x <= list->most) || x != floor(x))
        return dm2_fail(err, DM2_USAGE, "--%s '%.*s': a whole number from 1 to %g is expected", list->name,
                        (int)length, text, list->most);
    double *grown = mem_grown(list->items, &list->cap, list->n, list->n + 1, sizeof *grown);
    if (grown == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the command line");
    list->items = grown;
    list->items[list->n++] = x;
    return DM2_OK;
}

static enum dm2_status read_wholes(const struct option_list *texts, struct whole_list *list,
                                   struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t i = 0; status == DM2_OK && i < texts->n; i++)
        status = for_each_item(texts->items[i], take_whole, list, err);
    return status;
}

static enum dm2_status read_lists(struct model_options *o, struct dm2_error *err)
{
    struct whole_list n = {.name = "n", .most = PREDICT_N_MOST};
    struct whole_list servers = {.name = "servers", .most = BISECT_PARTS_MAX};
    enum dm2_status status = read_wholes(&o->n_texts, &n, err);
    if (status == DM2_OK)
        status = read_wholes(&o->servers_texts, &servers, err);
    o->n = n.items;
    o->n_count = n.n;
    o->servers = mem_zalloc(servers.n, sizeof *o->servers);
    if (status == DM2_OK && o->servers == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory for the command line");
    o->servers_count = status == DM2_OK ? servers.n : 0;
    for (size_t i = 0; i < o->servers_count; i++)
        o->servers[i] = (int)servers.items[i];
    free(servers.items);
    return status;
}

/* --- constants --- */

static enum dm2_status read_calibration(const char *path, struct perf *out, struct dm2_error *err)
{
    char host[CALIBRATION_TEXT_MAX] = "";
    struct calibration c;
    if (gethostname(host, sizeof host - 1) != 0)
        return dm2_fail(err, DM2_IO, "this machine's host name cannot be found out");
    enum dm2_status status = calibration_read(path, host, DM2_VERSION, &c, err);
    *out = c.perf;
    return status;
}

static enum dm2_status read_preset(const char *preset, struct perf *out, struct dm2_error *err)
{
    if (preset == NULL || strcmp(preset, "paper") == 0) {
        *out = perf_paper();
        return DM2_OK;
    }
    if (strcmp(preset, "here") != 0) {
        if (access(preset, F_OK) == 0)
            return read_calibration(preset, out, err);
        return dm2_fail(err, DM2_USAGE,
                        "--preset '%s': paper, here or a calibration file is expected, and there is no "
                        "such file",
                        preset);
    }
    const char *path = getenv("DM2_CALIBRATION");
    if (path == NULL || path[0] == '\0')
        path = CALIBRATION_FILE;
    if (access(path, F_OK) == 0)
        return read_calibration(path, out, err);
    return dm2_fail(err, DM2_USAGE,
                    "--preset here: there is no calibration file %s; dm2-model calibrate writes one, and the "
                    "environment's "
                    "DM2_CALIBRATION may name another",
                    path);
}

struct network_list {
    struct perf *perf;
    bool is_b;
};

/* Reads `V`, which sets every row of the network, or `N=V`, which sets the row of N servers. */
static enum dm2_status take_network(void *context, const char *text, size_t length, struct dm2_error *err)
{
    struct network_list *list = context;
    struct perf *p = list->perf;
    const char *name = list->is_b ? "b" : "m", *equals = memchr(text, '=', length);
    int64_t servers;
    double value;
    if (equals == NULL) {
        enum dm2_status status = read_number(name, text, length, &value, err);
        for (size_t i = 0; status == DM2_OK && i < p->n_network; i++)
            *(list->is_b ? &p->network[i].b : &p->network[i].m) = value;
        return status;
    }
    size_t before = (size_t)(equals - text);
    if (!number_parse_integer(text, before, &servers) || servers < 1 || servers > BISECT_PARTS_MAX)
        return dm2_fail(err, DM2_USAGE, "--%s '%.*s': N=VALUE with N servers from 1 to %d is expected", name,
                        (int)length, text, BISECT_PARTS_MAX);
    enum dm2_status status = read_number(name, equals + 1, length - before - 1, &value, err);
    return status == DM2_OK ? perf_set_network(p, (int)servers, list->is_b, value, err) : status;
}

static enum dm2_status read_constants(struct model_options *o, struct dm2_error *err)
{
    struct perf *p = &o->perf;
    double *const constants[MODEL_CONSTANTS] = {&p->d_x, &p->d_y, &p->l_x, &p->l_y, &p->k, &p->g};
    enum dm2_status status = read_preset(o->preset, p, err);
    for (int i = 0; status == DM2_OK && i < MODEL_CONSTANTS; i++)
        status = read_optional_number(CONSTANT_NAMES[i], o->constants[i], constants[i], err);
    if (status == DM2_OK && o->m != NULL)
        status = for_each_item(o->m, take_network, &(struct network_list){p, false}, err);
    if (status == DM2_OK && o->b != NULL)
        status = for_each_item(o->b, take_network, &(struct network_list){p, true}, err);
    return status == DM2_OK ? perf_check(p, err) : status;
}

/* --- the form of the model --- */

/* *second: true for the second of the two words, false for the first word or an absent option. */
static enum dm2_status read_word(const char *name, const char *text, const char *first, const char *other,
                                 bool *second, struct dm2_error *err)
{
    *second = text != NULL && strcmp(text, other) == 0;
    if (text == NULL || *second || strcmp(text, first) == 0)
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "--%s '%s': %s or %s is expected", name, text, first, other);
}

static enum dm2_status read_periodic(const char *text, bool periodic[2], struct dm2_error *err)
{
    if (text == NULL)
        return DM2_OK;
    periodic[0] = text[0] == 'x';
    periodic[1] = strcmp(text + (periodic[0] ? 1 : 0), "y") == 0;
    if (strcmp(text, "x") == 0 || periodic[1])
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "--periodic '%s': x, y or xy is expected", text);
}

static enum dm2_status read_form(struct model_options *o, struct dm2_error *err)
{
    struct predict_options *form = &o->form;
    form->general = o->general;
    form->slowest = o->slowest;
    form->overlap_inner = o->overlap != NULL && strcmp(o->overlap, "inner") == 0;
    enum dm2_status status = read_word("transport", o->transport, "relay", "peer", &form->peer, err);
    if (status == DM2_OK)
        status = read_word("count", o->count, "edges", "mirrored", &form->mirrored, err);
    if (status == DM2_OK && !form->overlap_inner)
        status = read_optional_number("overlap", o->overlap, &form->overlap, err);
    if (status == DM2_OK)
        status = read_optional_number("migrants", o->migrants, &form->migrants, err);
    if (status == DM2_OK && o->migrant_bytes != NULL)
        status = model_option_number("migrant-bytes", o->migrant_bytes, &form->migrant_bytes, err);
    if (status == DM2_OK && o->client_rate != NULL)
        status = model_option_number("client-rate", o->client_rate, &form->client_rate, err);
    if (status == DM2_OK)
        status = read_periodic(o->periodic, form->periodic, err);
    if (status == DM2_OK && o->migrant_bytes != NULL && o->migrants == NULL)
        status = dm2_fail(err, DM2_USAGE,
                          "--migrant-bytes says how large migrating elements are: --migrants has to say "
                          "how many there are");
    if (status == DM2_OK && form->peer && o->client_rate != NULL)
        status = dm2_fail(err, DM2_USAGE,
                          "--client-rate does not go with --transport peer: nothing passes through the "
                          "client then");
    return status;
}

enum dm2_status model_options_finish(struct model_options *o, struct dm2_error *err)
{
    if (o->help || o->version)
        return DM2_OK;
    o->s = PAPER_ASPECT;
    if (o->operands.n > 0)
        return dm2_fail(err, DM2_USAGE, "'%s' is not an option; numbers of elements are given with --n",
                        o->operands.items[0]);
    enum dm2_status status = read_constants(o, err);
    if (status == DM2_OK && o->aspect != NULL)
        status = model_option_number("aspect", o->aspect, &o->s, err);
    if (status == DM2_OK)
        status = read_form(o, err);
    if (status == DM2_OK)
        status = read_lists(o, err);
    return status;
}

void model_options_free(struct model_options *o)
{
    option_list_free(&o->n_texts);
    option_list_free(&o->servers_texts);
    option_list_free(&o->operands);
    free(o->n);
    free(o->servers);
    *o = (struct model_options){0};
}
