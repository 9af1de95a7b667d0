/* Linked into dm2-server in front of the engine (-Wl,--wrap): from step 5 on subdomain_owned counts one
 * element too many, as in a server that has kept an element which another server has taken over. The
 * self-test of the program, which has no other server, is spared. */
#include "dm2/engine/subdomain.h"

size_t __real_subdomain_owned(const struct subdomain *sd);
size_t __wrap_subdomain_owned(const struct subdomain *sd);

size_t __wrap_subdomain_owned(const struct subdomain *sd)
{
    return __real_subdomain_owned(sd) + (subdomain_step(sd) >= 5 && subdomain_mirrored(sd) > 0);
}
