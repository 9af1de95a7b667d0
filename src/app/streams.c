/* Standard input, output and error of a program.
 *
 * POSIX lets a program rely on the descriptors 0, 1, 2 only where they are open: otherwise the first file or
 * socket of a run gets one of these numbers, and messages land in a table of results. stdio keeps the error
 * of a write until fflush, and exit drops the error, so that a full disk is told only here. */
#include "streams.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool output_closed;

void streams_start(void)
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
}

bool streams_output_closed(void)
{
    return output_closed;
}

int streams_finish(const char *program, int code, bool asked)
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
