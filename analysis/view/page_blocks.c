/* page_blocks.c - numbers and JSON as text that stands in a page. */
#include "page_data.h"

#include <openssl/evp.h>
#include <stdlib.h>
#include <zlib.h>

/* In pieces of whole groups. */
void page_base64(FILE *out, const char *id, const uint8_t *bytes, size_t size)
{
    enum { PIECE = 3 * 1024 };
    unsigned char text[PIECE / 3 * 4 + 1];
    fprintf(out, "<script type=\"text/plain\" id=\"%s\">", id);
    for (size_t at = 0; at < size; at += PIECE) {
        const size_t n = size - at < PIECE ? size - at : PIECE;
        const int length = EVP_EncodeBlock(text, bytes + at, (int)n);
        fwrite(text, 1, (size_t)length, out);
    }
    fputs("</script>\n", out);
}

bool page_block(FILE *out, json_t *blocks, const char *name, const char *type, const void *numbers,
                size_t count, size_t *bytes)
{
    const size_t size = strtoul(type + 1, NULL, 10) / 8;
    const uLong plain = (uLong)(size * count);
    uLongf length = compressBound(plain);
    uint8_t *const shuffled = malloc(plain ? plain : 1), *const packed = malloc(length);
    bool good = shuffled && packed;
    for (size_t b = 0; good && b < size; b++)
        for (size_t i = 0; i < count; i++)
            shuffled[b * count + i] = ((const uint8_t *)numbers)[i * size + b];
    good = good && compress2(packed, &length, shuffled, plain, 6) == Z_OK;
    if (bytes)
        *bytes = good ? length : 0;
    if (good) {
        char id[96];
        snprintf(id, sizeof id, "block-%s", name);
        page_base64(out, id, packed, length);
        json_object_set_new(blocks, name,
                            json_pack("{s:s,s:I}", "type", type, "count", (json_int_t)count));
    }
    free(shuffled);
    free(packed);
    return good;
}

static int put_escaped(const char *text, size_t size, void *out)
{
    for (size_t i = 0; i < size; i++) {
        const char c = text[i];
        if (c == '<' || c == '>' || c == '&')
            fprintf(out, "\\u%04x", (unsigned)c);
        else
            fputc(c, out);
    }
    return 0;
}

void page_json(FILE *out, const char *id, const json_t *json)
{
    fprintf(out, "<script type=\"application/json\" id=\"%s\">", id);
    json_dump_callback(json, put_escaped, out, JSON_COMPACT | JSON_ENSURE_ASCII | JSON_ENCODE_ANY);
    fputs("</script>\n", out);
}
