/* Linked into dm2-server in front of the engine (-Wl,--wrap): from step 5 on one number of the first element
 * in each update has another value. DM2_SPOIL is "NUMBER VALUE": the index of the number (0 and 1: the
 * position) and its value (nan, inf, 1e300...). */
#include <stdlib.h>

#include "dm2/engine/subdomain.h"

void __real_subdomain_pack_update(const struct subdomain *sd, int dest, double *out);
void __wrap_subdomain_pack_update(const struct subdomain *sd, int dest, double *out);

void __wrap_subdomain_pack_update(const struct subdomain *sd, int dest, double *out)
{
    const char *text = getenv("DM2_SPOIL");
    char *rest;
    __real_subdomain_pack_update(sd, dest, out);
    if (text == NULL || subdomain_step(sd) < 5)
        return;
    long which = strtol(text, &rest, 10);
    out[which] = strtod(rest, NULL);
}
