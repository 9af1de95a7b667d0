/* dm2-server: the iterative daemon on a workstation, which waits for a client, serves its session, and
 * waits again. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "dm2/base/version.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/server.h"
#include "dm2/engine/self_test.h"
#include "dm2/net/allow.h"
#include "dm2/net/socket.h"
#include "options.h"
#include "run.h"
#include "signals.h"
#include "process.h"

static const char PROGRAM[] = "dm2-server";

struct server_command {
    int64_t port;
    const char *listen, *deck_dir, *key_file, *new_key;
    struct option_list allow_texts;
    struct auth_key key;
    struct allow_list allow;
    int64_t max_elements, max_steps; /* 0: any */
    double timeout;
    bool once, quiet, verbose, help, version;
};

static enum dm2_status parse_command_line(struct server_command *c, int argc, char **argv,
                                          struct dm2_error *err)
{
    *c = (struct server_command){.port = DEFAULT_PORT,
                                 .listen = "127.0.0.1",
                                 .deck_dir = ".",
                                 .max_elements = 20000000,
                                 .max_steps = 1000000000,
                                 .timeout = 60};
    const struct option table[] = {
        {"port", 'p', OPTION_INTEGER, &c->port, "P", "port (default 4702); 0 picks a free one", 0,
         SOCKET_PORT_MAX},
        {"listen", 0, OPTION_TEXT, &c->listen, "ADDR", "address to listen on (default 127.0.0.1)", 0, 0},
        {"key", 0, OPTION_TEXT, &c->key_file, "FILE",
         "serves only clients that prove to have this key; needed off 127.0.0.1", 0, 0},
        {"new-key", 0, OPTION_TEXT, &c->new_key, "FILE", "makes a key and stops", 0, 0},
        {"allow", 0, OPTION_LIST, &c->allow_texts, "CIDR",
         "serves only addresses of this network; may be repeated", 0, 0},
        {"max-elements", 0, OPTION_INTEGER, &c->max_elements, "N",
         "refuses decks with more elements (default 20000000; 0: any)", 0, INT64_MAX},
        {"max-steps", 0, OPTION_INTEGER, &c->max_steps, "N",
         "refuses decks with more time steps (default 1000000000; 0: any)", 0, INT64_MAX},
        {"deck-dir", 0, OPTION_TEXT, &c->deck_dir, "DIR", "where decks named by clients lie (default: here)",
         0, 0},
        {"once", 0, OPTION_FLAG, &c->once, NULL, "ends after one session, or when no client comes in time", 0,
         0},
        {"timeout", 0, OPTION_SECONDS, &c->timeout, "S",
         "gives a silent client up after S seconds (default 60)", 0, 0},
        {"quiet", 'q', OPTION_FLAG, &c->quiet, NULL, "keeps no log of sessions", 0, 0},
        {"verbose", 'v', OPTION_FLAG, &c->verbose, NULL, "logs connections too", 0, 0},
        {"help", 'h', OPTION_FLAG, &c->help, NULL, "prints this and stops", 0, 0},
        {"version", 0, OPTION_FLAG, &c->version, NULL, "prints the version and stops", 0, 0},
    };
    struct option_list operands = {0};
    enum dm2_status status = options_parse(table, sizeof table / sizeof table[0], argc, argv, &operands, err);
    if (status == DM2_OK && c->help) {
        (void)printf("usage: %s [options]\nWaits for dm2-clients and computes their subdomains, one client "
                     "at a time.\n\n",
                     PROGRAM);
        options_print(stdout, table, sizeof table / sizeof table[0]);
    } else if (status == DM2_OK && operands.n > 0) {
        status = dm2_fail(err, DM2_USAGE, "'%s' is too much: a server takes options only", operands.items[0]);
    }
    option_list_free(&operands);
    return status;
}

static void log_line(void *context, enum server_event event, const char *peer, const char *line)
{
    const struct server_command *c = context;
    char stamp[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (c->quiet || (event == SERVER_CONNECTED && !c->verbose))
        return;
    if (gmtime_r(&now, &utc) != NULL)
        (void)strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%SZ", &utc);
    (void)fprintf(stderr, "%s %s %s\n", stamp, peer, line);
    (void)fflush(stderr);
}

/* Requires a key for addresses other than loopback, because there any machine on the network can connect. */
static enum dm2_status check_address(const struct server_command *c, struct dm2_error *err)
{
    int loopback = 0;
    enum dm2_status status = socket_is_loopback(c->listen, &loopback, err);
    if (status != DM2_OK || loopback || c->key_file != NULL)
        return status;
    return dm2_fail(
        err, DM2_USAGE,
        "--listen %s: a server that can be reached from other machines needs a key: dm2-server --new-key "
        "FILE makes one, --key FILE uses it, here and with dm2-client",
        c->listen);
}

static enum dm2_status read_secrets(struct server_command *c, struct dm2_error *err)
{
    enum dm2_status status = c->key_file != NULL ? auth_key_read(c->key_file, &c->key, err) : DM2_OK;
    for (size_t k = 0; k < c->allow_texts.n && status == DM2_OK; k++)
        status = allow_add(&c->allow, c->allow_texts.items[k], err);
    return status;
}

/* Prevents core dumps, because the server's memory holds decks and keys. Linux pipes a core to the program
 * of kernel.core_pattern whatever the limit is, except for a process that is not dumpable. */
static void disable_core_dumps(void)
{
    const struct rlimit none = {0, 0};
    (void)setrlimit(RLIMIT_CORE, &none);
#ifdef __linux__
    (void)prctl(PR_SET_DUMPABLE, 0);
#endif
}

static enum dm2_status serve_clients(struct server_command *c, int cancel, struct dm2_error *err)
{
    int listener = -1;
    char bound[SOCKET_NAME];
    enum dm2_status status = check_address(c, err);
    if (status == DM2_OK)
        status = read_secrets(c, err);
    if (status == DM2_OK)
        status = socket_listen(c->listen, (int)c->port, &listener, bound, err);
    if (status != DM2_OK)
        return status;
    const struct server_options options = {.deck_dir = c->deck_dir,
                                           .version = DM2_VERSION,
                                           .handshake = 10,
                                           .timeout = c->timeout,
                                           .cancel = cancel,
                                           .key = c->key_file != NULL ? &c->key : NULL,
                                           .allow = &c->allow,
                                           .max_elements = (uint64_t)c->max_elements,
                                           .max_steps = c->max_steps};
    (void)printf("%s: listening on %s\n", PROGRAM, bound);
    (void)fflush(stdout);
    status = server_serve(listener, &options, c->once, log_line, c, err);
    socket_close(listener);
    return status;
}

int main(int argc, char **argv)
{
    struct server_command c;
    struct dm2_error err = {0};
    process_start();
    enum dm2_status status = parse_command_line(&c, argc, argv, &err);
    if (status == DM2_OK && c.version && !c.help)
        run_print_version(PROGRAM);
    if (status == DM2_OK && (c.help || c.version))
        return process_finish(PROGRAM, 0, true);
    disable_core_dumps();
    if (status == DM2_OK && c.new_key != NULL) {
        status = auth_key_create(c.new_key, &err);
        return status == DM2_OK ? 0 : run_report_failure(PROGRAM, &err);
    }
    if (status == DM2_OK)
        status = self_test_check(&err);
    if (status == DM2_OK)
        status = serve_clients(&c, signals_catch(), &err);
    option_list_free(&c.allow_texts);
    if (status == DM2_OK || (status == DM2_INTERRUPTED && signals_caught() != 0))
        return 0; /* ended as requested */
    if (c.once && c.quiet && status != DM2_USAGE)
        return dm2_exit_code(status); /* the client that started this server reports the failure */
    return run_report_failure(PROGRAM, &err);
}
