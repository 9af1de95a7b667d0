/* The digest covers the length of each text before its bytes, so that moving bytes from one text to the next
 * changes the digest. */
#include "dm2/deck/digest.h"

#include <string.h>

static void add_text(struct sha256 *s, const char *text, uint64_t length)
{
    unsigned char prefix[8];
    for (int k = 0; k < 8; k++)
        prefix[k] = (unsigned char)(length >> 8 * k & 0xff);
    sha256_add(s, prefix, sizeof prefix);
    sha256_add(s, text, (size_t)length);
}

void deck_digest(const struct deck_source *source, unsigned char out[SHA256_BYTES])
{
    struct sha256 s;
    sha256_start(&s);
    for (size_t k = 0; k < source->n_texts; k++)
        add_text(&s, source->texts[k].text, source->texts[k].length);
    sha256_add(&s, "-D", 2);
    for (size_t k = 0; k < source->n_defines; k++)
        add_text(&s, source->defines[k], strlen(source->defines[k]));
    sha256_finish(&s, out);
}
