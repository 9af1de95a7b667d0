/* Signals that ask a program to end, as a descriptor that poll can wait for. */
#ifndef DM2_APP_SIGNALS_H
#define DM2_APP_SIGNALS_H

/* From now on SIGINT, SIGTERM and SIGHUP (where they were not ignored already, as by nohup) make the returned
 * descriptor readable instead of ending the program, and SIGPIPE and SIGXFSZ are ignored, so that writes fail
 * with an error instead. A second such signal ends the program at once.
 * -1 where no pipe can be made: then the signals end the program as ever. */
int signals_catch(void);

/* The first of these signals that came, or 0. */
int signals_caught(void);

#endif
