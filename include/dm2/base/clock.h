/* Time for measuring and for deadlines, in seconds. */
#ifndef DM2_BASE_CLOCK_H
#define DM2_BASE_CLOCK_H

/* Seconds on the monotonic clock, from an arbitrary origin. */
double clock_now(void);

/* CPU seconds that this process has used. */
double clock_cpu(void);

#endif
