/* Programs of dm2 that start each other.
 *
 * A child holds the writing end of a pipe that it never writes to: its end of file says that the child is gone, which
 * can be waited for together with the request to end. */
#include "dm2/app/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dm2/base/mem.h"

char *child_path(const char *argv0, const char *name)
{
    const char *slash = strrchr(argv0, '/');
    size_t directory = slash == NULL ? 0 : (size_t)(slash - argv0) + 1, length = strlen(name) + 1;
    char *path = mem_alloc(directory + length, 1);
    if (path == NULL)
        return NULL;
    memcpy(path, argv0, directory);
    memcpy(path + directory, name, length);
    if (directory > 0 && access(path, X_OK) != 0)
        memcpy(path, name, length);
    return path;
}

/* In the child: only async-signal-safe calls until exec. */
static void become(char *const argv[])
{
    int null = open("/dev/null", O_RDWR);
    (void)setpgid(0, 0);
    if (null >= 0 && dup2(null, STDIN_FILENO) >= 0 && dup2(null, STDOUT_FILENO) >= 0)
        (void)execvp(argv[0], argv);
    _exit(127);
}

/* True when it was asked to end before it did. */
static bool wait_for_end(pid_t pid, int alive, int cancel)
{
    bool asked = false;
    for (;;) {
        struct pollfd polls[2] = {{.fd = alive, .events = POLLIN}, {.fd = asked ? -1 : cancel, .events = POLLIN}};
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

enum dm2_status child_run(char *const argv[], int cancel, struct dm2_error *err)
{
    int fd[2], code = -1;
    if (pipe(fd) != 0)
        return dm2_fail(err, DM2_IO, "cannot start %s: %s", argv[0], strerror(errno));
    (void)fcntl(fd[0], F_SETFD, FD_CLOEXEC);
    (void)fflush(NULL);
    pid_t pid = fork();
    if (pid == 0)
        become(argv);
    (void)close(fd[1]);
    bool asked = pid > 0 && wait_for_end(pid, fd[0], cancel);
    (void)close(fd[0]);
    if (pid < 0)
        return dm2_fail(err, DM2_IO, "cannot start %s: %s", argv[0], strerror(errno));
    while (waitpid(pid, &code, 0) < 0 && errno == EINTR)
        continue;
    if (asked)
        return dm2_fail(err, DM2_INTERRUPTED, "interrupted by a signal");
    if (WIFEXITED(code) && WEXITSTATUS(code) == 0)
        return DM2_OK;
    if (WIFEXITED(code) && WEXITSTATUS(code) == 127)
        return dm2_fail(err, DM2_IO, "the program '%s' did not start: is it installed beside dm2-model or on PATH?",
                        argv[0]);
    return dm2_fail(err, DM2_IO, "%s failed, see above", argv[0]);
}
