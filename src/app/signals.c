/* The self-pipe: the handler writes a byte, for which poll waits together with other descriptors, so that
 * no signal is missed between testing a flag and the wait that follows. */
#include "signals.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t caught;
static volatile sig_atomic_t wake = -1; /* write end of the pipe */

static void on_signal(int signal_number)
{
    int saved = errno;
    if (caught == 0) {
        caught = signal_number;
        ssize_t ignored = write((int)wake, "", 1);
        (void)ignored;                     /* a full pipe is readable as well */
    } else if (signal_number != SIGXCPU) { /* the system repeats SIGXCPU every second */
        (void)signal(signal_number,
                     SIG_DFL); /* a second signal ends the program as soon as this handler returns */
        (void)raise(signal_number);
    }
    errno = saved;
}

static int set_nonblocking(int fd)
{
    int flags = fcntl(fd, F_GETFL);
    return flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0 || fcntl(fd, F_SETFD, FD_CLOEXEC) < 0;
}

int signals_catch(void)
{
    static const int asking[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
    struct sigaction action, before;
    int fd[2];
    memset(&action, 0, sizeof action);
    sigemptyset(&action.sa_mask);
    action.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &action, NULL);
#ifdef SIGXFSZ
    (void)sigaction(SIGXFSZ, &action, NULL);
#endif
    if (pipe(fd) != 0)
        return -1;
    if (set_nonblocking(fd[0]) || set_nonblocking(fd[1])) {
        (void)close(fd[0]);
        (void)close(fd[1]);
        return -1;
    }
    wake = fd[1];
    action.sa_handler = on_signal;
    for (size_t k = 0; k < sizeof asking / sizeof asking[0]; k++)
        if (sigaction(asking[k], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            (void)sigaction(asking[k], &action, NULL);
    return fd[0];
}

int signals_caught(void)
{
    return (int)caught;
}
