/* fonts.c - the letters of the fonts of this machine. */
#include "fonts.h"

#include "runner/base/words.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LETTERS = 0x110000 };

/* "20-7e a0 ...": code points in hexadecimal. */
static void add_ranges(uint8_t *has, const char *text)
{
    for (;;) {
        char *end;
        const unsigned long first = strtoul(text, &end, 16);
        if (end == text)
            return;
        const unsigned long last = *end == '-' ? strtoul(end + 1, &end, 16) : first;
        for (unsigned long c = first; c <= last && c < LETTERS; c++)
            has[c / 8] |= (uint8_t)(1U << c % 8);
        text = end;
    }
}

/* Whether one of "A,B,C" is the family. */
static bool is_among(const char *names, size_t length, const char *family)
{
    char all[400], wanted[100];
    snprintf(all, sizeof all, ",%.*s,", (int)length, names);
    snprintf(wanted, sizeof wanted, ",%s,", family);
    return strcasestr(all, wanted) != NULL;
}

/* The letters that any font of this machine has, as fc-list tells, and whether a family is among
 * the fonts. */
struct fonts {
    uint8_t *has; /* [LETTERS / 8] a bit each; NULL: fontconfig does not tell */
    bool family;
};

/* Lines such as "DejaVu Sans,DejaVu Sans Light:charset=20-7e a0-2e9 ..." */
static void find(struct fonts *fonts, const char *family)
{
    static const char before[] = ":charset=";
    char *line = NULL;
    size_t size = 0, lines = 0;
    *fonts = (struct fonts){calloc(LETTERS / 8, 1), false};
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
    if (!list || pclose(list) != 0 || lines == 0) {
        free(fonts->has);
        fonts->has = NULL;
    }
}

static bool has(const struct fonts *fonts, uint32_t letter)
{
    enum { SEAM = 0x200b }; /* marks, and is not drawn */
    return letter < 0x80 || letter == SEAM ||
           (letter < LETTERS && fonts->has[letter / 8] >> letter % 8 & 1);
}

/* Of missing letters the first few. */
static void say(const char *family, const char *missing)
{
    static bool said_font, said_letters;
    if (family && !said_font) {
        fprintf(stderr,
                "no font is called %s: another one takes its place (fc-list : family "
                "lists fonts)\n",
                family);
        said_font = true;
    }
    if (missing[0] && !said_letters) {
        fprintf(stderr,
                "no font has %s: boxes stand for them in all but SVG; on Debian: apt-get "
                "install fonts-noto-cjk, or another font that has them\n",
                missing);
        said_letters = true;
    }
}

char *fonts_replace(const char *family, const char *text, size_t length)
{
    struct fonts fonts;
    char *drawn = NULL, missing[80] = "";
    size_t used = 0;
    bool any = false;
    find(&fonts, family);
    if (fonts.has)
        drawn = malloc(3 * length + 1); /* a letter of one byte is never replaced */
    for (size_t i = 0; drawn && i < length;) {
        uint32_t letter;
        const size_t bytes = utf8_letter(text + i, length - i, &letter), own = bytes ? bytes : 1;
        if (bytes > 1 && !has(&fonts, letter)) {
            char one[8];
            const size_t listed = strlen(missing);
            any = true;
            used += (size_t)sprintf(drawn + used, "%s", has(&fonts, 0x25a1) ? "□" : "?");
            snprintf(one, sizeof one, "%.*s", (int)bytes, text + i);
            if (listed + bytes + 1 < sizeof missing && !strstr(missing, one))
                memcpy(missing + listed, one, bytes + 1);
        } else {
            memcpy(drawn + used, text + i, own);
            used += own;
        }
        i += own;
    }
    if (drawn) {
        drawn[used] = '\0';
        say(fonts.family ? NULL : family, missing);
    }
    free(fonts.has);
    if (any)
        return drawn;
    free(drawn);
    return NULL;
}
