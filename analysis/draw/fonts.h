/* fonts.h - which letters pictures can be drawn with. gnuplot draws a letter that no font has as a
 * blot over the whole picture. */
#ifndef STANCE_DRAW_FONTS_H
#define STANCE_DRAW_FONTS_H

#include <stddef.h>

/* The text with another letter in the place of each that no font of this machine has, freed by the
 * caller; NULL: all have one, or fontconfig does not tell. Says on standard error, once in a
 * process, which letters these are, and that no font is called `family`. */
char *fonts_replace(const char *family, const char *text, size_t length);

#endif
