/* fonts.c - the letters of the fonts of this machine. */
#include "fonts.h"

#include "runner/base/words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "20-7e a0 ...": code points in hexadecimal. */
static void add_ranges(uint8_t *has, const char *text)
{
    for (;;) {
        char *end;
        const unsigned long first = strtoul(text, &end, 16);
        if (end == text)
            return;
        const unsigned long last = *end == '-' ? strtoul(end + 1, &end, 16) : first;
        for (unsigned long c = first; c <= last && c < FONTS_LETTERS; c++)
            has[c / 8] |= (uint8_t)(1U << c % 8);
        text = end;
    }
}

/* Whether one of "A,B,C" is the family. */
static bool is_among(const char *names, size_t length, const char *family)
{
    const size_t wanted = strlen(family);
    while (length > 0) {
        const char *comma = memchr(names, ',', length);
        const size_t own = comma ? (size_t)(comma - names) : length;
        if (own == wanted && strncasecmp(names, family, own) == 0)
            return true;
        names += own + (comma != NULL);
        length -= own + (comma != NULL);
    }
    return false;
}

/* Lines such as "DejaVu Sans,DejaVu Sans Light:charset=20-7e a0-2e9 ..." */
void fonts_find(struct fonts *fonts, const char *family)
{
    static const char before[] = ":charset=";
    char *line = NULL;
    size_t size = 0, lines = 0;
    *fonts = (struct fonts){calloc(FONTS_LETTERS / 8, 1), false};
    FILE *list = popen("LC_ALL=C exec fc-list : family charset 2>/dev/null", "r");
    while (list && fonts->has && getline(&line, &size, list) > 0) {
        const char *charset = strstr(line, before);
        if (!charset)
            continue;
        add_ranges(fonts->has, charset + sizeof before - 1);
        fonts->family = fonts->family || is_among(line, (size_t)(charset - line), family);
        lines++;
    }
    free(line);
    if (!list || pclose(list) != 0 || lines == 0)
        fonts_free(fonts);
}

void fonts_free(struct fonts *fonts)
{
    free(fonts->has);
    fonts->has = NULL;
}

bool fonts_has(const struct fonts *fonts, uint32_t letter)
{
    enum { SEAM = 0x200b }; /* marks, and is not drawn */
    return letter < 0x80 || letter == SEAM ||
           (letter < FONTS_LETTERS && fonts->has[letter / 8] >> letter % 8 & 1);
}

char *fonts_replace(const struct fonts *fonts, const char *text, size_t length, char *missing,
                    size_t size)
{
    const char *const instead = fonts_has(fonts, 0x25a1) ? "□" : "?";
    char *drawn = malloc(3 * length + 1); /* a letter of one byte is never replaced */
    size_t used = 0, listed = 0;
    bool any = false;
    for (size_t i = 0; drawn && i < length;) {
        uint32_t letter;
        const size_t bytes = utf8_letter(text + i, length - i, &letter);
        if (bytes > 1 && !fonts_has(fonts, letter)) {
            any = true;
            used += (size_t)sprintf(drawn + used, "%s", instead);
            char one[8];
            snprintf(one, sizeof one, "%.*s", (int)bytes, text + i);
            if (listed + bytes + 1 < size && (listed == 0 || !strstr(missing, one)))
                listed += (size_t)snprintf(missing + listed, size - listed, "%s", one);
        } else {
            memcpy(drawn + used, text + i, bytes ? bytes : 1);
            used += bytes ? bytes : 1;
        }
        i += bytes ? bytes : 1;
    }
    if (drawn)
        drawn[used] = '\0';
    if (any)
        return drawn;
    free(drawn);
    return NULL;
}
