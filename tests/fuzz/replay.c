/* Runs a fuzz target without a fuzzer:  replay N FILE...  runs the target on every file as it is, and N times
 * with random changes, the same in each run: bits turned, bytes replaced, pieces cut out or repeated. No
 * input may crash the target. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"

#include "dm2/base/file.h"
#include "dm2/base/random.h"

enum { MOST = 1 << 20 };

static unsigned char changed[2 * MOST];

/* Makes one change to the n bytes of `changed`; returns their new number. */
static size_t change_bytes(size_t n, uint64_t file, uint64_t k)
{
    size_t at = n > 0 ? random_bits(file, k, 1) % n : 0, span = 1 + random_bits(file, k, 2) % 16;
    unsigned char byte = (unsigned char)random_bits(file, k, 3);
    span = span < n - at ? span : n - at;
    switch (n > 0 ? random_bits(file, k, 4) % 5 : 5) {
    case 0:
        changed[at] ^= (unsigned char)(1 << byte % 8);
        return n;
    case 1:
        changed[at] = byte;
        return n;
    case 2:
        memmove(changed + at, changed + at + span, n - at - span);
        return n - span;
    case 3:
        memmove(changed + at + span, changed + at, n - at);
        return n + span;
    case 4:
        return at;
    default:
        return n;
    }
}

int main(int argc, char **argv)
{
    long rounds = argc > 1 ? strtol(argv[1], NULL, 10) : 0;
    unsigned long runs = 0;
    for (int a = 2; a < argc; a++) {
        struct dm2_error err = {0};
        unsigned char *bytes;
        size_t n;
        if (file_read(argv[a], MOST, &bytes, &n, &err) != DM2_OK) {
            (void)fprintf(stderr, "%s\n", err.text);
            return 1;
        }
        (void)LLVMFuzzerTestOneInput(bytes, n);
        for (long k = 0; k < rounds; k++) {
            size_t now = n;
            memcpy(changed, bytes, n);
            for (uint64_t c = 0; c <= random_bits((uint64_t)a, (uint64_t)k, 5) % 8; c++)
                now = change_bytes(now, (uint64_t)a, 8 * (uint64_t)k + c);
            (void)LLVMFuzzerTestOneInput(changed, now);
            runs++;
        }
        free(bytes);
        runs++;
    }
    (void)printf("%lu inputs\n", runs);
    return runs > 0 ? 0 : 1;
}
