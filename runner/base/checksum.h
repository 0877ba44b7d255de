/* checksum.h - CRC-32C for rows of results, SHA-256 for the scenario's text. */
#ifndef STANCE_BASE_CHECKSUM_H
#define STANCE_BASE_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

/* CRC-32C (Castagnoli; RFC 3720 appendix B.4) of `size` bytes, continued from `crc`: 0 begins. */
uint32_t checksum_crc32c(uint32_t crc, const void *data, size_t size);

enum { CHECKSUM_SHA256_TEXT = 65 };

/* SHA-256 (FIPS 180-4) as 64 hexadecimal digits and a zero. */
void checksum_sha256(const void *data, size_t size, char text[CHECKSUM_SHA256_TEXT]);

#endif
