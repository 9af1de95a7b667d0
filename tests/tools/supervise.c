/* Runs one test for tests/run.sh:
 *
 *     supervise NAME SECONDS LOG COMMAND [ARGUMENT...]
 *
 * The command gets a process group of its own, /dev/null as standard input and LOG as output. When the
 * command ends, or after SECONDS, or when the runner that started this program has ended, the rest of the
 * group is killed: with TERM first, so that a test can end its own servers, with KILL two seconds later. Then
 * one line goes to standard output, in one write, so that several supervisors can share a pipe:
 *
 *     NAME exit CODE SECONDS
 *     NAME signal NUMBER SECONDS
 *     NAME timeout 0 SECONDS
 *     NAME broken ERRNO SECONDS
 *
 * A shell could do neither part reliably: without a terminal it has no process groups, and its clock counts
 * whole seconds. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dm2/base/clock.h"

static volatile sig_atomic_t stop_signal;

static void note_signal(int number)
{
    if (number != SIGCHLD)
        stop_signal = number;
}

/* In the child process: executes the command. */
static void exec_test(const char *log, char **command, const sigset_t *mask)
{
    static const int reset[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGCHLD, SIGPIPE};
    struct rlimit core = {0, 0};
    setpgid(0, 0);
    for (size_t i = 0; i < sizeof reset / sizeof reset[0]; i++)
        signal(reset[i], SIG_DFL);
    sigprocmask(SIG_SETMASK, mask, NULL);
    if (getrlimit(RLIMIT_CORE, &core) == 0) {
        core.rlim_cur = 0;
        setrlimit(RLIMIT_CORE, &core);
    }
    int in = open("/dev/null", O_RDONLY);
    int out = open(log, O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (in < 0 || out < 0 || dup2(in, 0) < 0 || dup2(out, 1) < 0 || dup2(out, 2) < 0)
        _exit(126);
    if (in > 2)
        close(in);
    if (out > 2)
        close(out);
    execvp(command[0], command);
    fprintf(stderr, "%s: %s\n", command[0], strerror(errno));
    _exit(errno == ENOENT ? 127 : 126);
}

/* Waits for the end of the child, the deadline, a signal to this program, or the end of the runner. True: the
 * child has ended. The child is not reaped yet, because its id then stays in use, so that no other process
 * group can be hit when its group is killed. */
static bool wait_for_child(pid_t child, double deadline, const sigset_t *unblocked, pid_t parent)
{
    for (;;) {
        siginfo_t info;
        info.si_pid = 0;
        if (waitid(P_PID, (id_t)child, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == child)
            return true;
        double left = deadline - clock_now();
        if (left <= 0 || stop_signal || getppid() != parent)
            return false;
        if (left > 0.5)
            left = 0.5; /* calls getppid twice a second, because no signal tells of the runner's end */
        struct timespec slice = {0, (long)(left * 1e9)};
        pselect(0, NULL, NULL, NULL, &slice, unblocked);
    }
}

int main(int argc, char **argv)
{
    char *end = NULL;
    double limit = argc > 4 ? strtod(argv[2], &end) : 0;
    if (argc < 5 || end == argv[2] || *end != '\0' || !(limit > 0)) {
        fprintf(stderr, "usage: supervise NAME SECONDS LOG COMMAND [ARGUMENT...]\n");
        return 2;
    }
    static const int caught[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGCHLD};
    struct sigaction action;
    sigset_t blocked, before, unblocked;
    memset(&action, 0, sizeof action);
    action.sa_handler = note_signal;
    sigemptyset(&action.sa_mask);
    sigemptyset(&blocked);
    sigprocmask(SIG_BLOCK, NULL, &unblocked);
    for (size_t i = 0; i < sizeof caught / sizeof caught[0]; i++) {
        sigaction(caught[i], &action, NULL);
        sigaddset(&blocked, caught[i]);
        sigdelset(&unblocked, caught[i]);
    }
    sigprocmask(SIG_BLOCK, &blocked, &before);

    pid_t parent = getppid();
    double start = clock_now();
    const char *how = "broken";
    int code = 0, status = 0;
    pid_t child = fork();
    if (child == 0)
        exec_test(argv[3], argv + 4, &before);
    if (child < 0) {
        code = errno;
    } else {
        setpgid(child, child); /* as in exec_test, because either process may come first */
        bool in_time = wait_for_child(child, start + limit, &unblocked, parent);
        if (!in_time) {
            kill(-child, SIGTERM);
            kill(-child, SIGCONT);
            stop_signal = 0;
            wait_for_child(child, clock_now() + 2, &unblocked, getppid());
        }
        kill(-child, SIGKILL);
        waitpid(child, &status, 0);
        how = !in_time ? "timeout" : WIFSIGNALED(status) ? "signal" : "exit";
        if (in_time)
            code = WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
    }
    char line[300];
    int length = snprintf(line, sizeof line, "%.200s %s %d %.2f\n", argv[1], how, code, clock_now() - start);
    return write(1, line, (size_t)length) == length ? 0 : 1;
}
