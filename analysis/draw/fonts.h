/* fonts.h - which letters pictures can be drawn with. gnuplot draws a letter that no font has as a
 * blot over the whole picture. */
#ifndef STANCE_DRAW_FONTS_H
#define STANCE_DRAW_FONTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FONTS_LETTERS = 0x110000 };

/* The letters that any font of this machine has, as fc-list of fontconfig tells, and whether
 * `family` is among the fonts. */
struct fonts {
    uint8_t *has; /* [FONTS_LETTERS / 8] a bit each; NULL: fontconfig does not tell */
    bool family;
};
void fonts_find(struct fonts *fonts, const char *family);
void fonts_free(struct fonts *fonts);
bool fonts_has(const struct fonts *fonts, uint32_t letter);

/* The text with another letter in the place of each that no font has, freed by the caller; NULL:
 * all have one. missing[size]: the first few of them. */
char *fonts_replace(const struct fonts *fonts, const char *text, size_t length, char *missing,
                    size_t size);

#endif
