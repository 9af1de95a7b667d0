/* Processors and load of this machine. */
#ifndef DM2_BASE_MACHINE_H
#define DM2_BASE_MACHINE_H

/* The number of online processors, 1 to 65535; 1 where the number is unknown. */
int machine_cores(void);

/* The load average of the last minute, the mean number of runnable processes (/proc/loadavg); -1 where the
 * load is unknown. */
double machine_load(void);

#endif
