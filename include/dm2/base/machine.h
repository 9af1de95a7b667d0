/* Processors, load and memory of this machine. */
#ifndef DM2_BASE_MACHINE_H
#define DM2_BASE_MACHINE_H

/* The number of online processors, 1 to 65535; 1 where the number is unknown. */
int machine_cores(void);

/* The load average of the last minute, the mean number of runnable processes (/proc/loadavg); -1 where the
 * load is unknown. */
double machine_load(void);

/* The bytes of memory that a process may have: the least of the machine's memory, the limits RLIMIT_AS and
 * RLIMIT_DATA, and on Linux the limit of the control group; HUGE_VAL where none of them is known. */
double machine_memory(void);

#endif
