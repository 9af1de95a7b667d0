/* What every program asks of its process.
 *
 * POSIX lets a program rely on the descriptors 0, 1, 2 only where they are open: otherwise the first file or
 * socket of a run gets one of these numbers, and messages land in a table of results. stdio keeps the error
 * of a write until fflush, and exit drops the error, so that a full disk is told only here. A stack that is
 * too small would end the program by a signal in the middle of a deck. */
#include "process.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static bool output_closed;

/* Makes the limit of the stack at least STACK_LEAST, with which a deck nested as deeply as its limits allow
 * was seen to load. */
static void require_stack(void)
{
    static const rlim_t STACK_LEAST = 256 << 10;
    struct rlimit limit;
    if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ||
        limit.rlim_cur >= STACK_LEAST)
        return;
    rlim_t had = limit.rlim_cur;
    limit.rlim_cur = STACK_LEAST;
    if (setrlimit(RLIMIT_STACK, &limit) == 0)
        return;
    (void)fprintf(stderr, "the stack is limited to %llu KiB, and %llu KiB are needed: ulimit -s 8192\n",
                  (unsigned long long)had >> 10, (unsigned long long)STACK_LEAST >> 10);
    exit(1);
}

void process_start(void)
{
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++) {
        if (fcntl(fd, F_GETFD) >= 0 || errno != EBADF)
            continue;
        output_closed |= fd == STDOUT_FILENO;
        /* The lowest free number is fd, because all numbers below are open by now. */
        if (open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) == fd)
            continue;
        (void)fprintf(stderr, "descriptor %d is closed, and /dev/null does not open in its place\n", fd);
        exit(1);
    }
    (void)signal(SIGPIPE, SIG_IGN);
    require_stack();
}

bool process_output_closed(void)
{
    return output_closed;
}

int process_finish(const char *program, int code, bool asked)
{
    errno = 0;
    bool lost = fflush(stdout) != 0;
    const char *why = errno != 0 ? strerror(errno) : "an earlier write failed";
    lost |= ferror(stdout) != 0;
    if (!lost || !asked || code != 0)
        return code;
    (void)fprintf(stderr, "%s: cannot write to standard output: %s; what was asked for is lost\n", program,
                  why);
    return 1;
}
