/* POSIX specifies neither the number of processors nor the load. sysconf has a name for the number of
 * processors on every system where dm2 has run; the load comes from Linux's /proc and is unknown elsewhere.
 * number_parse reads the text of the load, because no locale changes its result. */
#include "dm2/base/machine.h"

#include <stdio.h>
#include <string.h>
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

double machine_load(void)
{
    char line[64] = "";
    double load = -1;
    FILE *file = fopen("/proc/loadavg", "r");
    if (file == NULL)
        return -1;
    if (fgets(line, sizeof line, file) != NULL)
        line[strcspn(line, " \n")] = '\0';
    (void)fclose(file);
    return number_parse(line, strlen(line), &load) && load >= 0 ? load : -1;
}
