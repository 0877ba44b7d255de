/* checksum.c - CRC-32C and SHA-256, in portable C; CRC-32C by the processor's own instruction where
 * it has one. */
#include "checksum.h"

#include <string.h>

#ifdef __x86_64__
#include <nmmintrin.h>
#endif

/* One byte at a time through two tables of 16 entries, one for each half of a byte: small enough
 * to be a constant, fast enough for some hundred bytes per simulated case. Entry i is the
 * remainder of i (low half) or 16 i (high half) under the reflected polynomial 0x82F63B78. */
static const uint32_t crc_low[16] = {
    0x00000000, 0xF26B8303, 0xE13B70F7, 0x1350F3F4, 0xC79A971F, 0x35F1141C, 0x26A1E7E8, 0xD4CA64EB,
    0x8AD958CF, 0x78B2DBCC, 0x6BE22838, 0x9989AB3B, 0x4D43CFD0, 0xBF284CD3, 0xAC78BF27, 0x5E133C24,
};
static const uint32_t crc_high[16] = {
    0x00000000, 0x105EC76F, 0x20BD8EDE, 0x30E349B1, 0x417B1DBC, 0x5125DAD3, 0x61C69362, 0x7198540D,
    0x82F63B78, 0x92A8FC17, 0xA24BB5A6, 0xB21572C9, 0xC38D26C4, 0xD3D3E1AB, 0xE330A81A, 0xF36E6F75,
};

static uint32_t crc_bytes(uint32_t crc, const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        uint32_t byte = (crc ^ bytes[i]) & 0xFF;
        crc = (crc >> 8) ^ crc_low[byte & 15] ^ crc_high[byte >> 4];
    }
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

static const uint32_t round_constant[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2,
};

static uint32_t rotate(uint32_t x, int n)
{
    return x >> n | x << (32 - n);
}

static void sha256_block(uint32_t hash[8], const uint8_t block[64])
{
    uint32_t w[64], s[8];
    for (int i = 0; i < 16; i++) {
        w[i] = (uint32_t)block[4 * i] << 24 | (uint32_t)block[4 * i + 1] << 16 |
               (uint32_t)block[4 * i + 2] << 8 | block[4 * i + 3];
    }
    for (int i = 16; i < 64; i++) {
        uint32_t a = w[i - 15], b = w[i - 2];
        w[i] = w[i - 16] + (rotate(a, 7) ^ rotate(a, 18) ^ a >> 3) + w[i - 7] +
               (rotate(b, 17) ^ rotate(b, 19) ^ b >> 10);
    }
    memcpy(s, hash, sizeof s);
    for (int i = 0; i < 64; i++) {
        uint32_t first = s[7] + (rotate(s[4], 6) ^ rotate(s[4], 11) ^ rotate(s[4], 25)) +
                         ((s[4] & s[5]) ^ (~s[4] & s[6])) + round_constant[i] + w[i];
        uint32_t second = (rotate(s[0], 2) ^ rotate(s[0], 13) ^ rotate(s[0], 22)) +
                          ((s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]));
        memmove(s + 1, s, 7 * sizeof s[0]);
        s[4] += first;
        s[0] = first + second;
    }
    for (int i = 0; i < 8; i++)
        hash[i] += s[i];
}

void checksum_sha256(const void *data, size_t size, char text[CHECKSUM_SHA256_TEXT])
{
    uint32_t hash[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    const uint8_t *bytes = data;
    size_t left = size;
    for (; left >= 64; left -= 64, bytes += 64)
        sha256_block(hash, bytes);
    /* The end: a one bit, zeros, and the length in bits, in one block or two. */
    uint8_t tail[128] = {0};
    size_t tail_size = left < 56 ? 64 : 128;
    if (left > 0)
        memcpy(tail, bytes, left);
    tail[left] = 0x80;
    for (int i = 0; i < 8; i++)
        tail[tail_size - 1 - (size_t)i] = (uint8_t)((uint64_t)size * 8 >> (8 * i));
    for (size_t i = 0; i < tail_size; i += 64)
        sha256_block(hash, tail + i);
    static const char digit[] = "0123456789abcdef";
    for (int i = 0; i < 64; i++)
        text[i] = digit[hash[i / 8] >> (28 - 4 * (i % 8)) & 15];
    text[64] = '\0';
}
