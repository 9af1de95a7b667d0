/* What this machine has, as far as it tells. */
#ifndef DM2_BASE_MACHINE_H
#define DM2_BASE_MACHINE_H

/* Processors that are on line; 1 where that is not known. */
int machine_cores(void);

/* Processes that want to run, as a mean over the last minute; -1 where the system does not tell
 * (/proc/loadavg). */
double machine_load(void);

#endif
