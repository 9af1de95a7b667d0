/* Fuzz target: the bytes are a state file without its checksum, which is appended. FINGERPRINT_IEEE in place
 * of the fingerprint becomes the fingerprint of the release. */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/crc32c.h"
#include "dm2/output/state.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *directory = getenv("TMPDIR");
    char path[400];
    enum { AT = 44 }; /* of the fingerprint */
    unsigned char fingerprint[8];
    size_t n = size < AT + sizeof fingerprint ? size : AT;
    (void)snprintf(path, sizeof path, "%s/fuzz-state-%ld", directory == NULL ? "/tmp" : directory,
                   (long)getpid());
    FILE *file = fopen(path, "wb");
    if (file == NULL)
        return 0;
    uint32_t crc = crc32c(0, data, n);
    (void)fwrite(data, 1, n, file);
    if (n < size) {
        memcpy(fingerprint, data + AT, sizeof fingerprint);
        fuzz_renew_fingerprint(fingerprint);
        crc = crc32c(crc, fingerprint, sizeof fingerprint);
        (void)fwrite(fingerprint, 1, sizeof fingerprint, file);
        n += sizeof fingerprint;
        crc = crc32c(crc, data + n, size - n);
        (void)fwrite(data + n, 1, size - n, file);
    }
    for (int k = 0; k < 4; k++)
        (void)fputc((int)(crc >> 8 * k & 0xff), file);
    (void)fclose(file);
    struct state s;
    struct dm2_error err = {0};
    if (state_read(path, &s, &err) == DM2_OK)
        state_free(&s);
    (void)unlink(path);
    return 0;
}
