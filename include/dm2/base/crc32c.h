/* CRC-32C (Castagnoli), the checksum of the frames; as in RFC 3720, appendix B.4. */
#ifndef DM2_BASE_CRC32C_H
#define DM2_BASE_CRC32C_H

#include <stddef.h>
#include <stdint.h>

/* The checksum of a sequence whose first part has the checksum `crc` (0 for no first part) and whose last n
 * bytes are data[0 .. n): the result does not depend on the division into parts. */
uint32_t crc32c(uint32_t crc, const void *data, size_t n);

#endif
