/* CRC-32C (Castagnoli), the checksum of the frames; as in RFC 3720, appendix B.4. */
#ifndef DM2_BASE_CRC32C_H
#define DM2_BASE_CRC32C_H

#include <stddef.h>
#include <stdint.h>

/* The checksum of n more bytes after those that gave `crc`; start with 0. Piecewise is the same as at once.
 */
uint32_t crc32c(uint32_t crc, const void *data, size_t n);

#endif
