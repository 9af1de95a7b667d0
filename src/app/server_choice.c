/* Local servers are started for each measurement, because a local server ends after one session. Named
 * servers run on. */
#include "server_choice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/number.h"
#include "dm2/base/version.h"
#include "local_servers.h"

static const int DEFAULT_COUNTS[] = {1, 2, 4, 8};

void server_choice_start(struct server_choice *c, struct option *table)
{
    *c = (struct server_choice){0};
    const struct option all[SERVER_CHOICE_OPTIONS] = {
        {"servers", 'n', OPTION_LIST, &c->counts_texts, "N,...", "numbers of servers (default 1,2,4,8)", 0,
         0},
        {"hosts", 0, OPTION_TEXT, &c->hosts, "FILE", "uses the servers of a hosts file instead of local ones",
         0, 0},
        {"server", 0, OPTION_LIST, &c->servers, "HOST[:PORT]", "uses this server; may be repeated", 0, 0},
        {"key", 0, OPTION_TEXT, &c->key_file, "FILE", "the key that these servers want", 0, 0},
    };
    memcpy(table, all, sizeof all);
}

static int compare_counts(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static enum dm2_status add_count(struct server_choice *c, const char *text, size_t length,
                                 struct dm2_error *err)
{
    int64_t n;
    if (!number_parse_integer(text, length, &n) || n < 1 || n > SERVER_CHOICE_MOST)
        return dm2_fail(err, DM2_USAGE, "--servers '%.*s': a whole number from 1 to %d is expected",
                        (int)length, text, SERVER_CHOICE_MOST);
    if (c->named.n > 0 && (size_t)n > c->named.n)
        return dm2_fail(err, DM2_USAGE, "--servers %lld: only %zu are named", (long long)n, c->named.n);
    if (c->n_counts == SERVER_CHOICE_COUNTS)
        return dm2_fail(err, DM2_USAGE, "--servers has more than %d numbers", SERVER_CHOICE_COUNTS);
    c->counts[c->n_counts++] = (int)n;
    return DM2_OK;
}

static enum dm2_status read_counts(struct server_choice *c, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < c->counts_texts.n; k++)
        for (const char *at = c->counts_texts.items[k]; at != NULL && status == DM2_OK;) {
            size_t length = strcspn(at, ",");
            status = add_count(c, at, length, err);
            at = at[length] == ',' ? at + length + 1 : NULL;
        }
    for (size_t k = 0; k < sizeof DEFAULT_COUNTS / sizeof DEFAULT_COUNTS[0] && c->counts_texts.n == 0; k++)
        if (c->named.n == 0 || (size_t)DEFAULT_COUNTS[k] <= c->named.n)
            c->counts[c->n_counts++] = DEFAULT_COUNTS[k];
    qsort(c->counts, (size_t)c->n_counts, sizeof c->counts[0], compare_counts);
    int kept = 0;
    for (int k = 0; k < c->n_counts; k++)
        if (kept == 0 || c->counts[k] != c->counts[kept - 1])
            c->counts[kept++] = c->counts[k];
    c->n_counts = kept;
    return status;
}

enum dm2_status server_choice_finish(struct server_choice *c, struct dm2_error *err)
{
    enum dm2_status status = c->hosts != NULL ? hosts_read(c->hosts, &c->named, err) : DM2_OK;
    for (size_t k = 0; k < c->servers.n && status == DM2_OK; k++)
        status = hosts_parse_server(c->servers.items[k], &c->named, err);
    if (status == DM2_OK && c->key_file != NULL && c->named.n == 0)
        status = dm2_fail(err, DM2_USAGE, "--key is for servers of --hosts or --server");
    if (status == DM2_OK && c->key_file != NULL)
        status = auth_key_read(c->key_file, &c->key, err);
    return status == DM2_OK ? read_counts(c, err) : status;
}

enum dm2_status server_choice_parse(struct server_choice *c, const struct option *table, size_t n, int argc,
                                    char **argv, const bool *help, const char *usage, struct dm2_error *err)
{
    struct option_list operands = {0};
    enum dm2_status status = options_parse(table, n, argc, argv, &operands, err);
    if (status == DM2_OK && *help) {
        (void)fputs(usage, stdout);
        options_print(stdout, table, n);
    } else {
        if (status == DM2_OK && operands.n > 0)
            status = dm2_fail(err, DM2_USAGE, "'%s' is not an option", operands.items[0]);
        if (status == DM2_OK)
            status = server_choice_finish(c, err);
    }
    option_list_free(&operands);
    return status;
}

void server_choice_free(struct server_choice *c)
{
    option_list_free(&c->servers);
    option_list_free(&c->counts_texts);
    endpoints_free(&c->named);
}

enum dm2_status server_choice_measure(const struct server_choice *c, const char *argv0, int servers,
                                      int turns, int cancel, struct network_line *out, struct dm2_error *err)
{
    struct network_probe probe;
    struct local_servers local = {0};
    struct endpoints started = {0};
    enum dm2_status status = network_probe_start(&probe, false, turns, err);
    if (status == DM2_OK && c->named.n == 0)
        status = local_servers_start(argv0, servers, false, cancel, &local, &started, err);
    const struct client_options options = {.servers = c->named.n > 0 ? c->named.items : started.items,
                                           .version = DM2_VERSION,
                                           .timeout = 60,
                                           .cancel = cancel,
                                           .echo = network_probe_echo(&probe),
                                           .key = c->key_file != NULL ? &c->key : NULL};
    if (status == DM2_OK)
        status = client_measure_network(&options, servers, err);
    if (status == DM2_OK)
        status = network_fit(&probe, servers, out, err);
    local_servers_stop(&local);
    endpoints_free(&started);
    network_probe_free(&probe);
    return status;
}
