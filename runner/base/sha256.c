/* sha256.c - SHA-256 by libcrypto. */
#include "checksum.h"

#include <openssl/sha.h>
#include <stdio.h>

void checksum_sha256(const void *data, size_t size, char text[CHECKSUM_SHA256_TEXT])
{
    uint8_t hash[SHA256_DIGEST_LENGTH];
    SHA256(data, size, hash);
    for (int i = 0; i < SHA256_DIGEST_LENGTH; i++)
        snprintf(text + 2 * i, 3, "%02x", hash[i]);
}
