/* Each child is `dm2-server --port 0 --once` with a pipe as its standard output. The first line on the
 * pipe names the address where the child listens; end of file marks the end of the child, so that waiting
 * has a deadline without sleep. Children are signalled by their process ids, which stay theirs until
 * waitpid here. A client that dies without ending its servers leaves no server behind, because --once ends
 * a server with its session, or when no client comes. */
#include "local_servers.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dm2/base/machine.h"
#include "dm2/base/mem.h"
#include "dm2/net/socket.h"
#include "places.h"

static const double START_SECONDS = 20.0; /* until a server prints its address */
static const double STOP_SECONDS = 5.0;   /* until a server ends after SIGTERM */

/* Runs in the child: only async-signal-safe calls until exec. */
static void become_server(char *path, int out, bool verbose)
{
    char port[] = "--port", zero[] = "0", once[] = "--once", quiet[] = "--quiet";
    char elements[] = "--max-elements",
         steps[] = "--max-steps"; /* 0: no limits, because client and server have the same user */
    char *arguments[] = {path, port, zero, once, elements, zero, steps, zero, verbose ? NULL : quiet, NULL};
    int null = open("/dev/null", O_RDONLY | O_CLOEXEC);
    (void)setpgid(0, 0);
    if (null >= 0 && dup2(null, STDIN_FILENO) >= 0 && dup2(out, STDOUT_FILENO) >= 0)
        (void)execvp(path, arguments);
    _exit(127);
}

static enum dm2_status spawn_server(char *path, bool verbose, struct local_server *server,
                                    struct dm2_error *err)
{
    int fd[2];
    if (pipe(fd) != 0)
        return dm2_fail(err, DM2_NET, "cannot start a server: %s", strerror(errno));
    (void)fcntl(fd[0], F_SETFD, FD_CLOEXEC);
    (void)fcntl(fd[1], F_SETFD, FD_CLOEXEC);
    (void)fflush(NULL);
    pid_t pid = fork();
    if (pid == 0)
        become_server(path, fd[1], verbose);
    (void)close(fd[1]);
    if (pid < 0) {
        (void)close(fd[0]);
        return dm2_fail(err, DM2_NET, "cannot start a server: %s", strerror(errno));
    }
    *server = (struct local_server){.pid = pid, .out = fd[0]};
    return DM2_OK;
}

/* Reads the line "dm2-server: listening on ADDR:PORT" and adds the address to *list. */
static enum dm2_status read_port(const struct local_server *server, const char *path, int cancel,
                                 struct endpoints *list, struct dm2_error *err)
{
    static const char expected[] = "dm2-server: listening on ";
    char line[SOCKET_NAME + sizeof expected] = "";
    size_t n = 0;
    struct deadline until = deadline_in(START_SECONDS, cancel);
    while (n + 1 < sizeof line && (n == 0 || line[n - 1] != '\n')) {
        enum dm2_status status = socket_wait(server->out, POLLIN, until, err);
        if (status == DM2_INTERRUPTED)
            return status;
        ssize_t got = status == DM2_OK ? read(server->out, line + n, 1) : 0;
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        n++;
    }
    line[n > 0 ? n - 1 : 0] = '\0';
    if (strncmp(line, expected, sizeof expected - 1) != 0)
        return dm2_fail(
            err, DM2_NET,
            "the server program '%s' did not start: is it installed beside dm2-client or on PATH?", path);
    return hosts_parse_server(line + sizeof expected - 1, list, err);
}

enum dm2_status local_servers_start(const char *argv0, int n, bool verbose, int cancel,
                                    struct local_servers *out, struct endpoints *list, struct dm2_error *err)
{
    char *path = places_program(argv0, "dm2-server");
    enum dm2_status status = DM2_OK;
    *out = (struct local_servers){.items = mem_zalloc((size_t)n, sizeof *out->items)};
    if (path == NULL || out->items == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory for %d servers", n);
    while (out->n < n && status == DM2_OK) {
        status = spawn_server(path, verbose, &out->items[out->n], err);
        out->n += status == DM2_OK;
    }
    for (int k = 0; k < n && status == DM2_OK; k++)
        status = read_port(&out->items[k], path, cancel, list, err);
    free(path);
    if (status != DM2_OK)
        local_servers_stop(out);
    return status;
}

/* Waits for the end of file of the server's standard output, which only the server holds. False after
 * STOP_SECONDS. */
static bool wait_for_end(const struct local_server *server)
{
    struct deadline until = deadline_in(STOP_SECONDS, -1);
    char waste[256];
    for (;;) {
        if (socket_wait(server->out, POLLIN, until, NULL) != DM2_OK)
            return false;
        ssize_t got = read(server->out, waste, sizeof waste);
        if (got == 0 || (got < 0 && errno != EINTR))
            return true;
    }
}

void local_servers_stop(struct local_servers *servers)
{
    for (int k = 0; k < servers->n; k++) {
        (void)kill(servers->items[k].pid, SIGTERM);
        (void)kill(servers->items[k].pid, SIGCONT); /* a stopped process would not handle SIGTERM */
    }
    for (int k = 0; k < servers->n; k++) {
        if (!wait_for_end(&servers->items[k]))
            (void)kill(servers->items[k].pid, SIGKILL);
        while (waitpid(servers->items[k].pid, NULL, 0) < 0 && errno == EINTR)
            continue;
        (void)close(servers->items[k].out);
    }
    free(servers->items);
    *servers = (struct local_servers){0};
}

int local_servers_cores(void)
{
    int cores = machine_cores();
    return cores > 1024 ? 1024 : cores;
}
