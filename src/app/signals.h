/* Signals that request the end of a program, as a descriptor for poll. */
#ifndef DM2_APP_SIGNALS_H
#define DM2_APP_SIGNALS_H

/* From this call on SIGINT, SIGTERM, SIGHUP and SIGXCPU (the limit of processor time), unless they were
 * ignored already (as by nohup), make the returned descriptor readable instead of ending the program, and
 * SIGPIPE and SIGXFSZ are ignored, so that writes fail with an error instead. A second such signal other than
 * SIGXCPU ends the program at once. -1 where no pipe can be made: then the signals end the program as by
 * default. */
int signals_catch(void);

/* The number of the first of these signals that was caught, or 0. */
int signals_caught(void);

#endif
