/* Linked into dm2-server in front of the engine (-Wl,--wrap): from step 5 on the first mirrored element of
 * each parcel of a rebuild has a mass that no element of the deck has, or, with DM2_FORGE=twice, comes twice.
 * The self-test of the program, which has no other server, is spared. */
#include <stdlib.h>
#include <string.h>

#include "dm2/engine/subdomain.h"

enum dm2_status __real_subdomain_sort_out(struct subdomain *sd, struct parcel *parcels,
                                          struct dm2_error *err);
enum dm2_status __wrap_subdomain_sort_out(struct subdomain *sd, struct parcel *parcels,
                                          struct dm2_error *err);

enum dm2_status __wrap_subdomain_sort_out(struct subdomain *sd, struct parcel *parcels, struct dm2_error *err)
{
    const char *how = getenv("DM2_FORGE");
    enum dm2_status status = __real_subdomain_sort_out(sd, parcels, err);
    for (int k = 0; k < 2 && status == DM2_OK && subdomain_mirrored(sd) > 0 && subdomain_step(sd) >= 5; k++) {
        if (parcels[k].n_mirrors > 1 && how != NULL && strcmp(how, "twice") == 0)
            parcels[k].mirrors[1] = parcels[k].mirrors[0];
        else if (parcels[k].n_mirrors > 1)
            parcels[k].mirrors[0].mass *= 1.5;
    }
    return status;
}
