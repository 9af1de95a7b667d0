/* foreground COMMAND [ARGUMENT...]: runs the command as a terminal starts it: in a process group of its own,
 * whose id is the command's process id, and with SIGINT not ignored. A shell without a terminal does neither
 * for its background commands, so that kill -INT -PID could not stand for Ctrl-C. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

int main(int argc, char **argv)
{
    if (argc < 2)
        return 2;
    if (setpgid(0, 0) == 0 && signal(SIGINT, SIG_DFL) != SIG_ERR && signal(SIGQUIT, SIG_DFL) != SIG_ERR)
        (void)execvp(argv[1], argv + 1);
    (void)fprintf(stderr, "foreground: %s: %s\n", argv[1], strerror(errno));
    return 127;
}
