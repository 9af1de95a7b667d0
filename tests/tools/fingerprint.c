/* Prints the fingerprint of this build as scripts/fingerprint.sh writes it into engine/self_test.h. */
#include <inttypes.h>
#include <stdio.h>

#include "dm2/engine/self_test.h"

int main(void)
{
    uint64_t found;
    struct dm2_error err = {0};
    if (self_test_compute(&found, &err) != DM2_OK) {
        (void)fprintf(stderr, "fingerprint: %s\n", err.text);
        return 1;
    }
    (void)printf("0x%016" PRIx64 "U\n", found);
    return 0;
}
