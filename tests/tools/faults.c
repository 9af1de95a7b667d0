/* Runs dm2-client through faults (tests/tools/proxy.c) that are drawn from seeds, and judges how each run
 * ends.
 *
 *     faults SEED RUNS FAULTS TIMEOUT
 *
 * Seeds go from SEED on, until FAULTS faults have happened and each kind at least once, or RUNS runs are
 * done.
 *
 * The working directory has deck.dm2, its sequential results in whole/, their names in `results`, one per
 * line, and a key file `key`; DM2_BIN and DM2_BUILD are set. A seed chooses the number of servers, 2 to 8, a
 * key or none, checkpoints or none, whether killed servers come back, and one to three faults. The kind of
 * the first fault goes round with the seed, so that consecutive seeds cover every kind. Servers last from run
 * to run.
 *
 * A run is right when it ends within its deadline, its servers serve another client afterwards, and its end
 * is one of
 *
 *     same       the results are those of the sequential run to the byte
 *     continued  the client ended with a sentence or was killed, no result is under its final name,
 *                and the last checkpoint leads to the same bytes
 *     ended      as `continued`, but there was no checkpoint yet
 *
 * Every other run is a failure: its seed is printed, its directory is kept, and the exit status is 1. The
 * last lines are a table of kinds and ends. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dm2/base/clock.h"
#include "dm2/base/random.h"

enum { SERVERS = 8, ARGS = 80, TEXT = 200, KINDS = 14, MOST_FAULTS = 3, LINE = 400 };
enum outcome { SAME, CONTINUED, ENDED, FAILED, OUTCOMES };

static const char *const KIND[KINDS] = {"reset",  "flip",        "kill", "silence",    "halfclose",
                                        "slices", "truncate",    "stop", "double",     "delay",
                                        "drop",   "kill-client", "swap", "stop-client"};
static const double DEADLINE = 60; /* of a run, in units of 1.5 s of timeout */

struct server {
    pid_t pid; /* 0: none */
    int port;
};

/* The choices of a seed, and the faults that have happened. */
struct trial {
    uint64_t seed;
    int servers, n_faults;
    bool keyed, revive, local;
    char fault[MOST_FAULTS][64];
    int injected[MOST_FAULTS], n_injected; /* kinds */
    bool client_killed;
    char why[TEXT];
};

static struct server pool[2][SERVERS];
static const char *bin, *build;
static char client_timeout[32];
static double deadline;
static int table[KINDS][OUTCOMES];

static void die(const char *what)
{
    (void)fprintf(stderr, "faults: %s: %s\n", what, strerror(errno));
    exit(2);
}

static void open_pipe(int fd[2])
{
    if (pipe(fd) != 0 || fcntl(fd[0], F_SETFD, FD_CLOEXEC) != 0 || fcntl(fd[1], F_SETFD, FD_CLOEXEC) != 0)
        die("pipe");
}

/* Starts a program. `in` and `out` are descriptors or -1; `err` is a file to append to; `life` (-1: none)
 * stays open as descriptor 3 of the program until the program ends. */
static pid_t start_program(const char **argv, int in, int out, const char *err, int life)
{
    pid_t pid = fork();
    if (pid < 0)
        die("fork");
    if (pid > 0)
        return pid;
    int null = open("/dev/null", O_RDWR), log = open(err, O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (null < 0 || log < 0 || dup2(in >= 0 ? in : null, 0) < 0 || dup2(out >= 0 ? out : null, 1) < 0 ||
        dup2(log, 2) < 0 || (life >= 0 && life != 3 && dup2(life, 3) < 0))
        _exit(126);
    if (life == 3)
        (void)fcntl(3, F_SETFD, 0);
    (void)execv(argv[0], (char **)(uintptr_t)argv);
    _exit(127);
}

/* Reads a line, byte by byte; false at the end of the file. */
static bool read_line(int fd, char line[LINE])
{
    size_t n = 0;
    ssize_t k;
    while (n + 1 < LINE && ((k = read(fd, line + n, 1)) == 1 || (k < 0 && errno == EINTR)))
        if (k == 1 && line[n++] == '\n')
            break;
    line[n] = '\0';
    return n > 0 && line[n - 1] == '\n';
}

static void start_server(bool keyed, int k)
{
    struct server *s = &pool[keyed][k];
    char port[16], path[TEXT], log[32], line[LINE];
    int out[2];
    (void)snprintf(path, sizeof path, "%s/dm2-server", bin);
    (void)snprintf(port, sizeof port, "%d", s->port);
    (void)snprintf(log, sizeof log, "server-%d-%d.log", keyed, k);
    const char *argv[] = {path,  "--port", port, "--timeout", client_timeout, keyed ? "--key" : NULL,
                          "key", NULL};
    open_pipe(out);
    s->pid = start_program(argv, -1, out[1], log, -1);
    (void)close(out[1]);
    if (!read_line(out[0], line) || strrchr(line, ':') == NULL)
        die("a server did not start");
    (void)close(out[0]);
    s->port = (int)strtol(strrchr(line, ':') + 1, NULL, 10);
}

/* Runs a program to its end; false where it was killed after `seconds`. */
static bool run_program(const char **argv, const char *err, double seconds, int *status)
{
    int life[2];
    double end = clock_now() + seconds;
    open_pipe(life);
    pid_t pid = start_program(argv, -1, -1, err, life[1]);
    (void)close(life[1]);
    struct pollfd p = {.fd = life[0], .events = POLLIN};
    while (poll(&p, 1, end > clock_now() ? (int)(1000 * (end - clock_now())) + 1 : 0) < 0 && errno == EINTR)
        continue;
    bool ended = p.revents != 0;
    if (!ended)
        (void)kill(pid, SIGKILL);
    (void)waitpid(pid, status, 0);
    (void)close(life[0]);
    return ended;
}

static bool is_there(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0;
}

static bool same_file(const char *a, const char *b)
{
    FILE *f = fopen(a, "rb"), *g = fopen(b, "rb");
    int x = 0, y = 0;
    while (f != NULL && g != NULL && x != EOF && x == y) {
        x = fgetc(f);
        y = fgetc(g);
    }
    bool same = f != NULL && g != NULL && x == y;
    if (f != NULL)
        (void)fclose(f);
    if (g != NULL)
        (void)fclose(g);
    return same;
}

/* Does a line of the file contain this text? */
static bool has_text(const char *path, const char *text)
{
    char line[2000];
    bool found = false;
    FILE *f = fopen(path, "r");
    while (f != NULL && !found && fgets(line, sizeof line, f) != NULL)
        found = strstr(line, text) != NULL;
    if (f != NULL)
        (void)fclose(f);
    return found;
}

static void remove_run(void)
{
    const char *argv[] = {"/bin/rm", "-rf", "run", "health", "err", "err.more", NULL};
    int status;
    (void)run_program(argv, "faults.log", 10, &status);
}

/* --- one run --- */

static uint64_t draw_number(const struct trial *t, uint64_t which, uint64_t below)
{
    return random_bits(t->seed, which, 1001) % below;
}

static unsigned long fault_argument(const struct trial *t, const char *kind, uint64_t which)
{
    double ms = 1000 * strtod(client_timeout, NULL);
    if (strcmp(kind, "delay") == 0)
        return 20 + draw_number(t, which, (uint64_t)(0.4 * ms));
    if (strncmp(kind, "stop", 4) == 0) /* half of the stops last longer than the other end's timeout */
        return 20 + draw_number(t, which, 2) * (unsigned long)(1.5 * ms) +
               draw_number(t, which + 1, (uint64_t)(0.4 * ms));
    if (strcmp(kind, "slices") == 0)
        return 100 + draw_number(t, which, 3000);
    return 1 + draw_number(t, which, 100);
}

static void choose_trial(struct trial *t, uint64_t seed)
{
    *t = (struct trial){.seed = seed};
    t->servers = 2 + (int)draw_number(t, 1, SERVERS - 1);
    t->keyed = draw_number(t, 2, 2) == 1;
    t->revive = draw_number(t, 3, 2) == 1;
    t->local = draw_number(t, 4, 2) == 1;
    t->n_faults = draw_number(t, 5, 10) < 6 ? 1 : 2 + (int)draw_number(t, 6, MOST_FAULTS - 1);
    for (int k = 0; k < t->n_faults; k++) {
        uint64_t at = 100 * (k + 1);
        const char *kind = KIND[k == 0 ? seed % KINDS : draw_number(t, at, KINDS)];
        bool up = draw_number(t, at + 1, 2) == 1, boundary = draw_number(t, at + 2, 3) == 0;
        /* the first fault is mostly in the steps, one in six before them; the others are soon after it */
        bool stepping = k == 0 && draw_number(t, at + 3, 6) > 0;
        int frame =
            stepping ? 45 + (int)draw_number(t, at + 5, 95) : (int)draw_number(t, at + 5, k == 0 ? 50 : 12);
        (void)snprintf(t->fault[k], sizeof t->fault[k], "%s,%d,%s,%d,%lu,%lu", kind,
                       (int)draw_number(t, at + 4, (uint64_t)t->servers), up ? "up" : "down", frame,
                       boundary ? 0UL : (unsigned long)draw_number(t, at + 6, 100000),
                       fault_argument(t, kind, at + 7));
    }
}

/* Notes a fault that the proxy reports; starts a server that was killed again, where the seed says so. */
static void note_injection(struct trial *t, const char *line, int proxy_in)
{
    char kind[16] = {0}, text[40];
    int k = 0;
    if (sscanf(line, "injected %15[a-z-]: server %d", kind, &k) != 2 || t->n_injected == MOST_FAULTS)
        die("the proxy says something else");
    for (int i = 0; i < KINDS; i++)
        if (strcmp(kind, KIND[i]) == 0)
            t->injected[t->n_injected] = i;
    t->n_injected++;
    t->client_killed |= strcmp(kind, "kill-client") == 0;
    if (strcmp(kind, "kill") != 0)
        return;
    struct server *s = &pool[t->keyed][k];
    (void)waitpid(s->pid, NULL, 0);
    s->pid = 0;
    if (!t->revive)
        return;
    start_server(t->keyed, k);
    int n = snprintf(text, sizeof text, "%d %ld\n", k, (long)s->pid);
    if (write(proxy_in, text, (size_t)n) != n)
        die("the proxy does not listen");
}

/* Appends the ports of a line to argv as options of the client; returns the new n. */
static int server_options(char line[LINE], const char **argv, int n, char text[SERVERS][32])
{
    int k = 0;
    for (char *port = strtok(line, " \n"); port != NULL && k < SERVERS; port = strtok(NULL, " \n"), k++) {
        (void)snprintf(text[k], 32, "127.0.0.1:%.8s", port);
        argv[n++] = "--server";
        argv[n++] = text[k];
    }
    argv[n] = NULL;
    return n;
}

/* Starts the proxy and reads its ports into `line`. */
static pid_t start_proxy(struct trial *t, int *in, int *out, char line[LINE])
{
    char path[TEXT], ports[SERVERS][16];
    const char *argv[ARGS] = {path};
    int n = 1, to[2], from[2];
    (void)snprintf(path, sizeof path, "%s/tools/proxy", build);
    for (int k = 0; k < t->n_faults; k++) {
        argv[n++] = "--fault";
        argv[n++] = t->fault[k];
    }
    for (int k = 0; k < t->servers; k++) {
        (void)snprintf(ports[k], sizeof ports[k], "%d", pool[t->keyed][k].port);
        argv[n++] = ports[k];
    }
    open_pipe(to);
    open_pipe(from);
    pid_t pid = start_program(argv, to[0], from[1], "proxy.log", -1);
    (void)close(to[0]);
    (void)close(from[1]);
    *in = to[1];
    *out = from[0];
    if (!read_line(*out, line))
        die("the proxy did not start");
    for (int k = 0; k < t->servers; k++) {
        char text[40];
        int length = snprintf(text, sizeof text, "%d %ld\n", k, (long)pool[t->keyed][k].pid);
        if (write(*in, text, (size_t)length) != length)
            die("the proxy does not listen");
    }
    return pid;
}

/* Runs the client through the proxy; false where the client did not end before the deadline. */
static bool run_client(struct trial *t, int *status)
{
    char line[LINE], path[TEXT], text[SERVERS][32], who[40];
    int in, out, life[2], n = 0;
    const char *argv[ARGS] = {path,           "deck.dm2",    "-o",  "run",          "-q", "--timeout",
                              client_timeout, "--reconnect", "0.3", "--copy-every", "7"};
    (void)snprintf(path, sizeof path, "%s/dm2-client", bin);
    while (argv[n] != NULL)
        n++;
    if (draw_number(t, 7, 2) == 1) {
        argv[n++] = "--checkpoint-every";
        argv[n++] = "11";
    }
    if (t->keyed) {
        argv[n++] = "--key";
        argv[n++] = "key";
    }
    pid_t proxy = start_proxy(t, &in, &out, line);
    (void)server_options(line, argv, n, text);
    open_pipe(life);
    double end = clock_now() + deadline;
    pid_t client = start_program(argv, -1, -1, "err", life[1]);
    (void)close(life[1]);
    int length = snprintf(who, sizeof who, "%d %ld\n", SERVERS, (long)client);
    if (write(in, who, (size_t)length) != length)
        die("the proxy does not listen");
    bool ended = false;
    while (!ended && clock_now() < end) {
        struct pollfd p[2] = {{.fd = life[0], .events = POLLIN}, {.fd = out, .events = POLLIN}};
        (void)poll(p, 2, (int)(1000 * (end - clock_now())) + 1);
        if (p[1].revents != 0 && !read_line(out, line))
            die("the proxy ended");
        if (p[1].revents != 0)
            note_injection(t, line, in);
        ended = p[0].revents != 0;
    }
    if (!ended) {
        (void)kill(client, SIGKILL);
        (void)kill(client, SIGCONT);
    }
    (void)waitpid(client, status, 0);
    (void)close(in);
    while (read_line(out, line))
        note_injection(t, line, -1);
    (void)waitpid(proxy, NULL, 0);
    (void)close(out);
    (void)close(life[0]);
    return ended;
}

/* --- the judgement --- */

static enum outcome judge_failed(struct trial *t, const char *why)
{
    (void)snprintf(t->why, sizeof t->why, "%s", why);
    return FAILED;
}

/* Are all results those of the sequential run? `early`: only results that exist are compared, without the
 * list of snapshots, because the list grows. */
static bool same_results(bool early)
{
    char ours[TEXT], theirs[TEXT], entry[LINE];
    int n = 0;
    bool same = true;
    FILE *list = fopen("results", "r");
    if (list == NULL)
        die("results");
    for (; same && fgets(entry, sizeof entry, list) != NULL; n++) {
        entry[strcspn(entry, "\n")] = '\0';
        (void)snprintf(ours, sizeof ours, "whole/%.150s", entry);
        (void)snprintf(theirs, sizeof theirs, "run/%.150s", entry);
        if (!early || (is_there(theirs) && strstr(entry, ".pvd") == NULL))
            same = same_file(ours, theirs);
    }
    (void)fclose(list);
    if (n < 2)
        die("results");
    return same;
}

/* Judges a run that did not come to its end: its results must be complete, and its checkpoint must lead to
 * the same bytes. */
static enum outcome judge_checkpoint(struct trial *t)
{
    char path[TEXT];
    int status;
    (void)snprintf(path, sizeof path, "%s/%s", bin, t->local ? "dm2-client" : "dm2-seq");
    const char *local[] = {path, "deck.dm2", "-q", "--restart", "run/checkpoint.dm2", "-n", "3", NULL};
    const char *alone[] = {path, "deck.dm2", "-q", "--restart", "run/checkpoint.dm2", NULL};
    if (!same_results(true))
        return judge_failed(t,
                            "it ended early, and left a result under its final name that is not the result");
    if (!is_there("run/checkpoint.dm2"))
        return is_there("run/checkpoint.prev.dm2") ? judge_failed(t, "the newest checkpoint is missing")
                                                   : ENDED;
    if (!run_program(t->local ? local : alone, "err.more", deadline, &status) || status != 0)
        return judge_failed(t, "the restart from the checkpoint failed");
    return same_results(false) ? CONTINUED
                               : judge_failed(t, "the restart from the checkpoint gave other results");
}

static enum outcome judge_run(struct trial *t, bool ended, int status)
{
    if (!ended)
        return judge_failed(t, "it did not end before its deadline");
    if (has_text("err", "Sanitizer") || has_text("err", "runtime error"))
        return judge_failed(t, "a sanitizer reported");
    if (WIFSIGNALED(status))
        return WTERMSIG(status) == SIGKILL && t->client_killed ? judge_checkpoint(t)
                                                               : judge_failed(t, "it crashed");
    if (WEXITSTATUS(status) == 0)
        return same_results(false) ? SAME
                                   : judge_failed(t, "its results are not those of the sequential run");
    if (WEXITSTATUS(status) > 3 || !has_text("err", "dm2-client: "))
        return judge_failed(t, "it ended without a sentence");
    /* said of the first session alone: the set-up of later sessions is reported with the step to continue
     * from */
    if (!has_text("err", "before the first step") && !has_text("err", "no server is left"))
        return judge_failed(t, "it gave up while servers were left");
    return judge_checkpoint(t);
}

/* Are all servers alive but the killed ones, and do all serve another client? Starts those that are not. */
static enum outcome judge_servers(struct trial *t, enum outcome so_far)
{
    char path[TEXT], line[LINE] = "", text[SERVERS][32];
    const char *argv[ARGS] = {path,      "deck.dm2", "-o",           "health",    "-q",
                              "--steps", "3",        "--no-recover", "--timeout", "20"};
    int n = 0, status;
    (void)snprintf(path, sizeof path, "%s/dm2-client", bin);
    while (argv[n] != NULL)
        n++;
    if (t->keyed) {
        argv[n++] = "--key";
        argv[n++] = "key";
    }
    for (int k = 0; k < t->servers; k++) {
        struct server *s = &pool[t->keyed][k];
        if (s->pid > 0 && waitpid(s->pid, &status, WNOHANG) == s->pid) {
            s->pid = 0;
            so_far = judge_failed(t, "a server crashed");
        }
        if (s->pid == 0)
            start_server(t->keyed, k);
        (void)snprintf(line + strlen(line), sizeof line - strlen(line), "%d ", s->port);
    }
    (void)server_options(line, argv, n, text);
    if (so_far != FAILED && (!run_program(argv, "err.more", deadline, &status) || status != 0))
        so_far = judge_failed(t, "its servers do not serve the next client");
    return so_far;
}

static enum outcome try_seed(struct trial *t, uint64_t seed)
{
    int status = 0;
    choose_trial(t, seed);
    for (int k = 0; k < t->servers; k++)
        if (pool[t->keyed][k].pid == 0)
            start_server(t->keyed, k);
    remove_run();
    double begun = clock_now();
    bool ended = run_client(t, &status);
    double took = clock_now() - begun;
    enum outcome o = judge_servers(t, judge_run(t, ended, status));
    for (int k = 0; k < t->n_injected; k++)
        table[t->injected[k]][o]++;
    static const char *const NAME[OUTCOMES] = {"same", "continued", "ended", "FAILED"};
    (void)printf("seed %llu: %d servers%s, %d of %d faults:", (unsigned long long)seed, t->servers,
                 t->keyed ? " with a key" : "", t->n_injected, t->n_faults);
    for (int k = 0; k < t->n_faults; k++)
        (void)printf(" %s", t->fault[k]);
    (void)printf("; %.2f s, %s%s%s\n", took, NAME[o], o == FAILED ? ": " : "", o == FAILED ? t->why : "");
    (void)fflush(stdout);
    return o;
}

/* Keeps the files of a run that failed. */
static void keep_run(uint64_t seed)
{
    char name[64];
    (void)snprintf(name, sizeof name, "failed-%llu", (unsigned long long)seed);
    (void)mkdir("run", 0777);
    (void)rename("err", "run/err");
    (void)rename("err.more", "run/err.more");
    if (rename("run", name) == 0)
        (void)printf("seed %llu: what it left is in %s; to repeat it: faults %llu 1 1 %s\n",
                     (unsigned long long)seed, name, (unsigned long long)seed, client_timeout);
}

static void stop_servers(void)
{
    for (int k = 0; k < 2 * SERVERS; k++) {
        struct server *s = &pool[k / SERVERS][k % SERVERS];
        if (s->pid == 0)
            continue;
        (void)kill(s->pid, SIGTERM);
        (void)kill(s->pid, SIGCONT);
        (void)waitpid(s->pid, NULL, 0);
    }
}

static bool all_kinds_seen(void)
{
    for (int k = 0; k < KINDS; k++)
        if (table[k][SAME] + table[k][CONTINUED] + table[k][ENDED] + table[k][FAILED] == 0)
            return false;
    return true;
}

static void print_table(int runs, int injected)
{
    (void)printf("%-12s %8s %8s %10s %8s %8s\n", "fault", "injected", "same", "continued", "ended", "failed");
    int sum[OUTCOMES] = {0};
    for (int k = 0; k < KINDS; k++) {
        const int *n = table[k];
        (void)printf("%-12s %8d %8d %10d %8d %8d\n", KIND[k], n[SAME] + n[CONTINUED] + n[ENDED] + n[FAILED],
                     n[SAME], n[CONTINUED], n[ENDED], n[FAILED]);
        for (int o = 0; o < OUTCOMES; o++)
            sum[o] += n[o];
    }
    (void)printf("%-12s %8d %8d %10d %8d %8d   in %d runs\n", "all", injected, sum[SAME], sum[CONTINUED],
                 sum[ENDED], sum[FAILED], runs);
}

int main(int argc, char **argv)
{
    bin = getenv("DM2_BIN");
    build = getenv("DM2_BUILD");
    if (argc != 5 || bin == NULL || build == NULL) {
        (void)fprintf(stderr, "usage: faults SEED RUNS FAULTS TIMEOUT\n");
        return 2;
    }
    struct sigaction ignore;
    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &ignore, NULL);
    uint64_t seed = strtoull(argv[1], NULL, 10);
    int most = (int)strtol(argv[2], NULL, 10), wanted = (int)strtol(argv[3], NULL, 10);
    int runs = 0, injected = 0, failures = 0;
    (void)snprintf(client_timeout, sizeof client_timeout, "%.20s", argv[4]);
    deadline = DEADLINE / 1.5 * strtod(client_timeout, NULL);
    for (; runs < most && (injected < wanted || !all_kinds_seen()); runs++, seed++) {
        struct trial t;
        if (try_seed(&t, seed) == FAILED) {
            failures++;
            keep_run(seed);
        }
        injected += t.n_injected;
    }
    stop_servers();
    print_table(runs, injected);
    return failures > 0;
}
