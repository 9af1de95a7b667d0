/* Linked into dm2-server in front of the engine (-Wl,--wrap): from step 5 on it counts an element more than
 * it owns, as a server would that has kept one which another has taken over. */
#include "dm2/engine/subdomain.h"

size_t __real_subdomain_owned(const struct subdomain *sd);
size_t __wrap_subdomain_owned(const struct subdomain *sd);

size_t __wrap_subdomain_owned(const struct subdomain *sd)
{
    return __real_subdomain_owned(sd) + (subdomain_step(sd) >= 5);
}
