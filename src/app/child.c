/* Programs of dm2 that start each other.
 *
 * A child holds the writing end of a pipe and never writes to it. The reading end reaches its end of file
 * when the child ends, so that poll waits for the child's end together with the request to cancel. */
#include "child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Runs in the child: only async-signal-safe calls until exec. */
static void become_program(char *const argv[])
{
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    (void)setpgid(0, 0);
    if (null >= 0 && dup2(null, STDIN_FILENO) >= 0 && dup2(null, STDOUT_FILENO) >= 0)
        (void)execvp(argv[0], argv);
    _exit(127);
}

/* Waits for the end of the child; a readable `cancel` sends SIGTERM to the child. Returns whether SIGTERM
 * was sent. */
static bool wait_for_end(pid_t pid, int alive, int cancel)
{
    bool asked = false;
    for (;;) {
        struct pollfd polls[2] = {{.fd = alive, .events = POLLIN},
                                  {.fd = asked ? -1 : cancel, .events = POLLIN}};
        if (poll(polls, 2, -1) < 0 && errno != EINTR)
            return asked;
        if (polls[0].revents != 0)
            return asked;
        if (polls[1].revents != 0) {
            (void)kill(pid, SIGTERM);
            asked = true;
        }
    }
}

struct child {
    pid_t pid; /* -1: not started */
    int alive; /* reading end of the pipe that ends with the child */
};

static enum dm2_status start_child(char *const argv[], struct child *out, struct dm2_error *err)
{
    int fd[2];
    *out = (struct child){.pid = -1, .alive = -1};
    if (pipe(fd) != 0)
        return dm2_fail(err, DM2_IO, "cannot start %s: %s", argv[0], strerror(errno));
    (void)fcntl(fd[0], F_SETFD, FD_CLOEXEC);
    (void)fflush(NULL);
    out->pid = fork();
    if (out->pid == 0)
        become_program(argv);
    (void)close(fd[1]);
    out->alive = fd[0];
    return out->pid < 0 ? dm2_fail(err, DM2_IO, "cannot start %s: %s", argv[0], strerror(errno)) : DM2_OK;
}

/* The status whose exit code the child ended with, so that the caller ends with the same code; else
 * DM2_IO. */
static enum dm2_status status_of_exit(int code)
{
    static const enum dm2_status known[] = {DM2_DECK, DM2_NET};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
        if (WIFEXITED(code) && WEXITSTATUS(code) == dm2_exit_code(known[k]))
            return known[k];
    return DM2_IO;
}

static enum dm2_status finish_child(const struct child *c, const char *path, int cancel,
                                    struct dm2_error *err)
{
    int code = -1;
    bool asked = c->pid > 0 && wait_for_end(c->pid, c->alive, cancel);
    if (c->alive >= 0)
        (void)close(c->alive);
    if (c->pid < 0)
        return DM2_OK; /* start_child has set the error */
    while (waitpid(c->pid, &code, 0) < 0 && errno == EINTR)
        continue;
    if (asked)
        return dm2_fail(err, DM2_INTERRUPTED, "interrupted by a signal");
    if (WIFEXITED(code) && WEXITSTATUS(code) == 0)
        return DM2_OK;
    if (WIFEXITED(code) && WEXITSTATUS(code) == 127)
        return dm2_fail(err, DM2_IO,
                        "the program '%s' did not start: is it installed beside dm2-model or on PATH?", path);
    return dm2_fail(err, status_of_exit(code), "%s failed, see above", path);
}

enum dm2_status child_run(char *const argv[], int cancel, struct dm2_error *err)
{
    struct child child;
    enum dm2_status status = start_child(argv, &child, err),
                    ended = finish_child(&child, argv[0], cancel, err);
    return status != DM2_OK ? status : ended;
}
