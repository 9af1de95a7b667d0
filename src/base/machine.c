/* POSIX specifies neither the number of processors nor the load. sysconf has a name for the number of
 * processors on every system where dm2 has run; the load and the limit of a control group come from Linux
 * and are unknown elsewhere.
 * number_parse reads the text of the load, because no locale changes its result. */
#include "dm2/base/machine.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "dm2/base/number.h"

int machine_cores(void)
{
#ifdef _SC_NPROCESSORS_ONLN
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    return cores < 1 ? 1 : cores > 65535 ? 65535 : (int)cores;
#else
    return 1;
#endif
}

/* The first number of a file of the system; -1: none. */
static double read_number(const char *path)
{
    char line[64] = "";
    double value = -1;
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return -1;
    if (fgets(line, sizeof line, file) != NULL)
        line[strcspn(line, " \n")] = '\0';
    (void)fclose(file);
    return number_parse(line, strlen(line), &value) && value >= 0 ? value : -1;
}

double machine_load(void)
{
    return read_number("/proc/loadavg");
}

double machine_memory(void)
{
    static const int limits[] = {RLIMIT_AS, RLIMIT_DATA};
    double least = HUGE_VAL, group = read_number("/sys/fs/cgroup/memory.max");
    struct rlimit limit;
#ifdef _SC_PHYS_PAGES
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0)
        least = (double)pages * (double)page;
#endif
    for (size_t k = 0; k < sizeof limits / sizeof limits[0]; k++)
        if (getrlimit(limits[k], &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
            least = fmin(least, (double)limit.rlim_cur);
    return group > 0 ? fmin(least, group) : least;
}
