/* dm2-model what-if: the paper's Fig. 17 and the questions that follow from it.
 *
 * A case is a change of processors or network. Three tables show the same cases: the speedup at a number
 * of servers, the size from which servers take less time than one processor, and the best number of
 * servers. Relative to the paper's 10BaseT, networks 10 and 100 times as fast are Fast and Gigabit
 * Ethernet. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/number.h"
#include "dm2/base/version.h"
#include "model_commands.h"
#include "model_options.h"

enum { CASES_MAX = 7, OWN_OPTIONS = 4, OPTIONS = OWN_OPTIONS + MODEL_OPTIONS, BEST_MOST = 1024 };

struct what_if_case {
    char name[48];
    struct perf perf;
    struct predict_options form;
};

struct what_if {
    struct model_options model;
    const char *table, *processors, *network;
    int64_t most;
    struct what_if_case cases[CASES_MAX];
    size_t n_cases;
    const double *n;
    const int *speedup_servers, *servers;     /* of the speedups; of the break-even */
    size_t n_n, n_speedup_servers, n_servers; /* lengths of the three lists */
};

static const double PAPER_SIZES[] = {1689, 5000, 10000, 20000, 50000, 100000, 200000};
static const int PAPER_SERVERS[] = {2, 4, 8};

static void add_case(struct what_if *w, double processors, double network, bool peer)
{
    struct what_if_case *c = &w->cases[w->n_cases++];
    c->perf = perf_faster(&w->model.perf, processors, network);
    c->form = w->model.form;
    c->form.peer |= peer;
    /* The client's link is a part of the network. */
    c->form.client_rate = peer ? 0 : c->form.client_rate * network;
    if (peer)
        (void)snprintf(c->name, sizeof c->name, "peer-to-peer");
    else if (processors != 1)
        (void)snprintf(c->name, sizeof c->name, "processors-x%g", processors);
    else if (network != 1)
        (void)snprintf(c->name, sizeof c->name, "network-x%g", network);
    else
        (void)snprintf(c->name, sizeof c->name, "as-is");
}

static enum dm2_status add_cases(struct what_if *w, struct dm2_error *err)
{
    double factor;
    enum dm2_status status = DM2_OK;
    add_case(w, 1, 1, false);
    add_case(w, 10, 1, false);
    if (!w->model.form.peer)
        add_case(w, 1, 1, true);
    add_case(w, 1, 10, false);
    add_case(w, 1, 100, false);
    if (w->processors != NULL) {
        status = model_option_number("processors", w->processors, &factor, err);
        if (status == DM2_OK)
            add_case(w, factor, 1, false);
    }
    if (status == DM2_OK && w->network != NULL) {
        status = model_option_number("network", w->network, &factor, err);
        if (status == DM2_OK)
            add_case(w, 1, factor, false);
    }
    return status;
}

static void print_field(double x)
{
    char text[NUMBER_TEXT_MAX];
    (void)number_format(x, text);
    (void)printf(",%s", text);
}

static void print_sizes(const struct what_if *w)
{
    (void)printf("%-20s", "case");
    for (size_t i = 0; i < w->n_n; i++)
        (void)printf(" %11.0f", w->n[i]);
    (void)printf("\n");
}

/* --- speedups --- */

static enum dm2_status speedup_row(const struct what_if *w, const struct what_if_case *c, int servers,
                                   struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    if (!w->model.csv)
        (void)printf("%-20s", c->name);
    for (size_t i = 0; status == DM2_OK && i < w->n_n; i++) {
        struct prediction p;
        status = predict(&c->perf, w->n[i], w->model.s, servers, &c->form, &p, err);
        if (status != DM2_OK)
            return status;
        if (!w->model.csv) {
            (void)printf(" %11.3f", p.speedup);
            continue;
        }
        const double fields[] = {p.n, p.s, servers, p.t_seq, p.t_comm, p.t_dist, p.speedup, p.efficiency};
        (void)printf("%s", c->name);
        for (size_t f = 0; f < sizeof fields / sizeof fields[0]; f++)
            print_field(fields[f]);
        (void)printf("\n");
    }
    if (!w->model.csv)
        (void)printf("\n");
    return status;
}

static enum dm2_status speedup_table(const struct what_if *w, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    if (w->model.csv)
        (void)printf("case,n,s,servers,t_seq,t_comm,t_dist,speedup,efficiency\n");
    for (size_t j = 0; status == DM2_OK && j < w->n_speedup_servers; j++) {
        if (!w->model.csv) {
            (void)printf("Speedup of %d servers, by number of elements\n", w->speedup_servers[j]);
            print_sizes(w);
        }
        for (size_t i = 0; status == DM2_OK && i < w->n_cases; i++)
            status = speedup_row(w, &w->cases[i], w->speedup_servers[j], err);
        if (!w->model.csv)
            (void)printf("\n");
    }
    return status;
}

/* --- break-even --- */

static enum dm2_status break_even_row(const struct what_if *w, const struct what_if_case *c,
                                      struct dm2_error *err)
{
    if (!w->model.csv)
        (void)printf("%-20s", c->name);
    for (size_t j = 0; j < w->n_servers; j++) {
        double n;
        enum dm2_status status = predict_break_even(&c->perf, w->model.s, w->servers[j], &c->form, &n, err);
        if (status != DM2_OK)
            return status;
        if (w->model.csv) {
            (void)printf("%s", c->name);
            print_field(w->model.s);
            print_field(w->servers[j]);
            if (n > 0)
                print_field(n);
            else
                (void)printf(",");
            (void)printf("\n");
        } else if (n > 0) {
            (void)printf(" %11.0f", n);
        } else {
            (void)printf(" %11s", "never");
        }
    }
    if (!w->model.csv)
        (void)printf("\n");
    return DM2_OK;
}

static enum dm2_status break_even_table(const struct what_if *w, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    if (w->model.csv) {
        (void)printf("case,s,servers,n\n");
    } else {
        (void)printf("Number of elements from which N servers take less time than one\n%-20s", "case");
        for (size_t j = 0; j < w->n_servers; j++)
            (void)printf(" %11d", w->servers[j]);
        (void)printf("\n");
    }
    for (size_t i = 0; status == DM2_OK && i < w->n_cases; i++)
        status = break_even_row(w, &w->cases[i], err);
    if (!w->model.csv)
        (void)printf("\n");
    return status;
}

/* --- best number of servers --- */

static enum dm2_status best_row(const struct what_if *w, const struct what_if_case *c, struct dm2_error *err)
{
    if (!w->model.csv)
        (void)printf("%-20s", c->name);
    for (size_t i = 0; i < w->n_n; i++) {
        struct prediction p;
        enum dm2_status status = predict_best(&c->perf, w->n[i], w->model.s, (int)w->most, &c->form, &p, err);
        if (status != DM2_OK)
            return status;
        if (w->model.csv) {
            const double fields[] = {p.n, p.s, p.servers, p.t_seq, p.t_dist, p.speedup, p.efficiency};
            (void)printf("%s", c->name);
            for (size_t f = 0; f < sizeof fields / sizeof fields[0]; f++)
                print_field(fields[f]);
            (void)printf("\n");
        } else {
            char cell[40];
            (void)snprintf(cell, sizeof cell, "%d (%.2f)", p.servers, p.speedup);
            (void)printf(" %11s", cell);
        }
    }
    if (!w->model.csv)
        (void)printf("\n");
    return DM2_OK;
}

static enum dm2_status best_table(const struct what_if *w, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    if (w->model.csv) {
        (void)printf("case,n,s,servers,t_seq,t_dist,speedup,efficiency\n");
    } else {
        (void)printf("Best number of servers, of 1 to %d, and its speedup, by number of elements\n",
                     (int)w->most);
        print_sizes(w);
    }
    for (size_t i = 0; status == DM2_OK && i < w->n_cases; i++)
        status = best_row(w, &w->cases[i], err);
    return status;
}

/* --- the command --- */

struct table_kind {
    const char *name;
    enum dm2_status (*print)(const struct what_if *w, struct dm2_error *err);
};

static const struct table_kind TABLES[] = {
    {"speedup", speedup_table}, {"break-even", break_even_table}, {"best", best_table}};

enum { N_TABLES = sizeof TABLES / sizeof TABLES[0] };

static enum dm2_status print_tables(const struct what_if *w, struct dm2_error *err)
{
    const char *wanted = w->table == NULL && w->model.csv ? TABLES[0].name : w->table;
    bool known = wanted == NULL;
    for (size_t i = 0; i < N_TABLES; i++)
        known |= wanted != NULL && strcmp(wanted, TABLES[i].name) == 0;
    if (!known)
        return dm2_fail(err, DM2_USAGE, "--table '%s': speedup, break-even or best is expected", wanted);
    enum dm2_status status = DM2_OK;
    for (size_t i = 0; status == DM2_OK && i < N_TABLES; i++)
        if (wanted == NULL || strcmp(wanted, TABLES[i].name) == 0)
            status = TABLES[i].print(w, err);
    return status;
}

/* Computes the speedups once without printing, so that a refusal comes before the first line of output. */
static enum dm2_status check_tables(const struct what_if *w, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    struct prediction p;
    for (size_t j = 0; j < w->n_servers; j++)
        if (w->servers[j] < 2)
            return dm2_fail(err, DM2_USAGE, "--servers %d: what-if compares 2 and more servers with one",
                            w->servers[j]);
    for (size_t c = 0; c < w->n_cases; c++)
        for (size_t i = 0; i < w->n_n; i++)
            for (size_t j = 0; status == DM2_OK && j < w->n_speedup_servers; j++)
                status = predict(&w->cases[c].perf, w->n[i], w->model.s, w->speedup_servers[j],
                                 &w->cases[c].form, &p, err);
    return status;
}

static enum dm2_status run_what_if(struct what_if *w, struct dm2_error *err)
{
    const struct model_options *o = &w->model;
    bool sizes = o->n_count > 0, servers = o->servers_count > 0;
    w->n = sizes ? o->n : PAPER_SIZES;
    w->n_n = sizes ? o->n_count : sizeof PAPER_SIZES / sizeof PAPER_SIZES[0];
    w->servers = servers ? o->servers : PAPER_SERVERS;
    w->n_servers = servers ? o->servers_count : sizeof PAPER_SERVERS / sizeof PAPER_SERVERS[0];
    w->speedup_servers = servers ? o->servers : &PAPER_SERVERS[2]; /* Fig. 17 is for eight */
    w->n_speedup_servers = servers ? o->servers_count : 1;
    enum dm2_status status = add_cases(w, err);
    if (status == DM2_OK)
        status = check_tables(w, err);
    if (status == DM2_OK)
        status = print_tables(w, err);
    return status;
}

enum dm2_status model_what_if_command(const char *argv0, int argc, char **argv, struct dm2_error *err)
{
    (void)argv0;
    struct what_if w = {.most = 64};
    struct option table[OPTIONS] = {
        {"table", 0, OPTION_TEXT, &w.table, "WHICH",
         "speedup, break-even or best; all, or with --csv the first", 0, 0},
        {"most", 0, OPTION_INTEGER, &w.most, "N", "servers that there could be (default 64)", 1, BEST_MOST},
        {"processors", 0, OPTION_TEXT, &w.processors, "F", "adds a case: processors F times as fast", 0, 0},
        {"network", 0, OPTION_TEXT, &w.network, "F", "adds a case: a network F times as fast", 0, 0},
    };
    model_options_start(&w.model, table + OWN_OPTIONS);
    enum dm2_status status = options_parse(table, OPTIONS, argc, argv, &w.model.operands, err);
    if (status == DM2_OK)
        status = model_options_finish(&w.model, err);
    if (status == DM2_OK && w.model.help) {
        (void)printf(
            "usage: dm2-model what-if [options]\n"
            "Speedups with other processors and networks (the paper's Fig. 17), from which size on servers\n"
            "pay, and how many of them are best.\n\n");
        options_print(stdout, table, OPTIONS);
    } else if (status == DM2_OK && w.model.version) {
        (void)printf("dm2-model %s\n", DM2_VERSION);
    } else if (status == DM2_OK) {
        status = run_what_if(&w, err);
    }
    model_options_free(&w.model);
    return status;
}
