/* checksum.c - CRC-32C, in portable C or by the processor's own instruction. */
#include "checksum.h"

#include <string.h>

#ifdef __x86_64__
#include <nmmintrin.h>
#endif

/* Half a byte at a time through a table of 16 entries: small enough to be a constant, fast enough
 * for some hundred bytes per simulated case. Entry i is the remainder of i under the reflected
 * polynomial 0x82F63B78. */
static const uint32_t crc_half[16] = {
    0x00000000, 0x105EC76F, 0x20BD8EDE, 0x30E349B1, 0x417B1DBC, 0x5125DAD3, 0x61C69362, 0x7198540D,
    0x82F63B78, 0x92A8FC17, 0xA24BB5A6, 0xB21572C9, 0xC38D26C4, 0xD3D3E1AB, 0xE330A81A, 0xF36E6F75,
};

static uint32_t crc_bytes(uint32_t crc, const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < 2 * size; i++)
        crc = (crc >> 4) ^ crc_half[(crc ^ bytes[i / 2] >> i % 2 * 4) & 15];
    return crc;
}

#ifdef __x86_64__
/* Eight bytes at a time; SSE 4.2's instruction is for this very polynomial. */
__attribute__((target("sse4.2"))) static uint32_t crc_words(uint32_t crc, const uint8_t *bytes,
                                                            size_t words)
{
    uint64_t wide = crc, word;
    for (size_t i = 0; i < words; i++) {
        memcpy(&word, bytes + 8 * i, sizeof word);
        wide = _mm_crc32_u64(wide, word);
    }
    return (uint32_t)wide;
}
#endif

uint32_t checksum_crc32c(uint32_t crc, const void *data, size_t size)
{
    const uint8_t *bytes = data;
    size_t done = 0;
    crc = ~crc;
#ifdef __x86_64__
    if (size >= 8 && __builtin_cpu_supports("sse4.2")) {
        crc = crc_words(crc, bytes, size / 8);
        done = size / 8 * 8;
    }
#endif
    return ~crc_bytes(crc, bytes + done, size - done);
}
