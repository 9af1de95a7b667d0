/* Linked into dm2-server in front of the engine (-Wl,--wrap): the first server that comes to the forces of
 * step DM2_END_AT is killed there. The file DM2_END_MARK, which the server makes, spares the others and those
 * that take its place; the self-test of the program, which has no other server, is spared, too. */
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>

#include "dm2/engine/subdomain.h"

enum dm2_status __real_subdomain_forces(struct subdomain *sd, bool measure, struct dm2_error *err);
enum dm2_status __wrap_subdomain_forces(struct subdomain *sd, bool measure, struct dm2_error *err);

enum dm2_status __wrap_subdomain_forces(struct subdomain *sd, bool measure, struct dm2_error *err)
{
    const char *step = getenv("DM2_END_AT"), *mark = getenv("DM2_END_MARK");
    if (step != NULL && mark != NULL && subdomain_mirrored(sd) > 0 &&
        subdomain_step(sd) == strtoll(step, NULL, 10) && open(mark, O_WRONLY | O_CREAT | O_EXCL, 0666) >= 0)
        (void)raise(SIGKILL);
    return __real_subdomain_forces(sd, measure, err);
}
