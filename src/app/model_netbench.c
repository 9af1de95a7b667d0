/* dm2-model netbench: the cost of messages (the paper's Fig. 3). */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "dm2/base/number.h"
#include "model_commands.h"
#include "model_options.h"
#include "server_choice.h"
#include "signals.h"

struct netbench {
    struct server_choice servers;
    int64_t turns;
    bool csv, help;
};

static void print_csv(const struct network_line *lines, int n)
{
    (void)printf("servers,bytes,seconds,fit\n");
    for (int k = 0; k < n; k++)
        for (int i = 0; i < lines[k].sizes; i++) {
            char text[3][NUMBER_TEXT_MAX];
            const struct network_line *l = &lines[k];
            (void)number_format(l->bytes[i], text[0]);
            (void)number_format(l->seconds[i], text[1]);
            (void)number_format(l->m * l->bytes[i] + l->b, text[2]);
            (void)printf("%d,%s,%s,%s\n", l->servers, text[0], text[1], text[2]);
        }
}

static void print_table(const struct network_line *lines, int n)
{
    for (int k = 0; k < n; k++) {
        const struct network_line *l = &lines[k];
        (void)printf(
            "%d server%s, %d round trips of each size, medians\n     bytes          ms      fit ms\n",
            l->servers, l->servers == 1 ? "" : "s", l->turns);
        for (int i = 0; i < l->sizes; i++)
            (void)printf("%10.0f %11.5f %11.5f\n", l->bytes[i], 1e3 * l->seconds[i],
                         1e3 * (l->m * l->bytes[i] + l->b));
        (void)printf("m_%d = %.4g s/byte, b_%d = %.4g s, residual %.2g s\n\n", l->servers, l->m, l->servers,
                     l->b, l->residual);
    }
}

static enum dm2_status run_netbench(const struct netbench *c, const char *argv0, struct dm2_error *err)
{
    struct network_line lines[SERVER_CHOICE_COUNTS];
    int cancel = signals_catch();
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->servers.n_counts && status == DM2_OK; k++)
        status = server_choice_measure(&c->servers, argv0, c->servers.counts[k], (int)c->turns, cancel,
                                       &lines[k], err);
    if (status != DM2_OK)
        return status;
    (c->csv ? print_csv : print_table)(lines, c->servers.n_counts);
    return DM2_OK;
}

enum dm2_status model_netbench_command(const char *argv0, int argc, char **argv, struct dm2_error *err)
{
    enum { OWN = 3, ALL = OWN + SERVER_CHOICE_OPTIONS };
    struct netbench c = {.turns = 50};
    struct option table[ALL] = {
        {"turns", 0, OPTION_INTEGER, &c.turns, "T", "round trips of each size (default 50)", 4,
         NETWORK_TURNS},
        {"csv", 0, OPTION_FLAG, &c.csv, NULL, "comma-separated values: servers,bytes,seconds,fit", 0, 0},
        {"help", 'h', OPTION_FLAG, &c.help, NULL, "prints this", 0, 0},
    };
    server_choice_start(&c.servers, table + OWN);
    enum dm2_status status =
        server_choice_parse(&c.servers, table, ALL, argc, argv, &c.help,
                            "usage: dm2-model netbench [-n N,...] [options]\n"
                            "Times messages to N servers and back, and fits the line m_N x + b_N.\n\n",
                            err);
    if (status == DM2_OK && !c.help)
        status = run_netbench(&c, argv0, err);
    server_choice_free(&c.servers);
    return status;
}
