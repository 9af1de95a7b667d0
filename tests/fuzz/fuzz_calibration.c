/* Fuzz target: the bytes are the text of a calibration file. */
#include "fuzz.h"

#include "dm2/performance/calibration.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct calibration c;
    struct dm2_error err = {0};
    (void)calibration_parse("fuzz", (const char *)data, size, "host", "1.0.0", &c, &err);
    return 0;
}
