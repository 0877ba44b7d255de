/* words.c - edit distances to known words; letters. */
#include "words.h"
#include "numbers.h"

#include <stdarg.h>
#include <string.h>
#include <strings.h>

enum { LONGEST_WORD = 63 };

/* Damerau-Levenshtein distance in its restricted form (a pair is swapped at most once). Words
 * longer than LONGEST_WORD are compared by their beginning: no known word is that long. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][LONGEST_WORD + 1];
    size_t m = smaller(strlen(a), LONGEST_WORD), n = smaller(strlen(b), LONGEST_WORD);
    size_t *before = rows[0], *previous = rows[1], *current = rows[2];

    for (size_t j = 0; j <= n; j++)
        previous[j] = j;
    for (size_t i = 1; i <= m; i++) {
        current[0] = i;
        for (size_t j = 1; j <= n; j++) {
            size_t differs = a[i - 1] != b[j - 1];
            current[j] =
                smaller(smaller(previous[j], current[j - 1]) + 1, previous[j - 1] + differs);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                current[j] = smaller(current[j], before[j - 2] + 1);
        }
        size_t *oldest = before;
        before = previous;
        previous = current;
        current = oldest;
    }
    return previous[n];
}

size_t word_place(const char *word, const char *const *known, size_t count)
{
    size_t k = 0;
    while (k < count && strcmp(word, known[k]) != 0)
        k++;
    return k;
}

const char *nearest_word(const char *word, const char *const *known, size_t count)
{
    const char *nearest = NULL;
    size_t length = smaller(strlen(word), LONGEST_WORD);
    const size_t third = length / 3, admitted = third > 2 ? third : length > 3 ? 2 : 1;
    size_t best = admitted + 1;

    for (size_t i = 0; i < count; i++) {
        if (strcasecmp(word, known[i]) == 0)
            return known[i];
        size_t distance = edit_distance(word, known[i]);
        /* As many edits as letters, of either word, would be another word altogether. */
        if (distance < best && distance < smaller(length, strlen(known[i]))) {
            best = distance;
            nearest = known[i];
        }
    }
    return nearest;
}

size_t utf8_letter(const char *text, size_t left, uint32_t *character)
{
    const unsigned char *s = (const unsigned char *)text;
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    size_t length = s[0] < 0x80             ? 1
                    : (s[0] & 0xe0) == 0xc0 ? 2
                    : (s[0] & 0xf0) == 0xe0 ? 3
                    : (s[0] & 0xf8) == 0xf0 ? 4
                                            : 0;
    if (length == 0 || length > left)
        return 0;
    uint32_t c = length == 1 ? s[0] : s[0] & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        if ((s[i] & 0xc0) != 0x80)
            return 0;
        c = c << 6 | (s[i] & 0x3fu);
    }
    if (c < least[length] || c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff))
        return 0;
    *character = c;
    return length;
}

const char *hidden_letter(uint32_t character, bool *blank)
{
    static const struct {
        uint32_t first, last;
        bool blank;
        const char *name;
    } hidden[] = {
        {0x85, 0x85, true, "next line"},
        {0xa0, 0xa0, true, "no-break space"},
        {0xad, 0xad, false, "soft hyphen"},
        {0x34f, 0x34f, false, "combining grapheme joiner"},
        {0x61c, 0x61c, false, "Arabic letter mark"},
        {0x115f, 0x1160, false, "Hangul filler"},
        {0x1680, 0x1680, true, "Ogham space"},
        {0x17b4, 0x17b5, false, "Khmer inherent vowel"},
        {0x180b, 0x180f, false, "Mongolian mark"},
        {0x2000, 0x2006, true, "quad or em space"},
        {0x2007, 0x2007, true, "figure space"},
        {0x2008, 0x2008, true, "punctuation space"},
        {0x2009, 0x2009, true, "thin space"},
        {0x200a, 0x200a, true, "hair space"},
        {0x200b, 0x200b, false, "zero width space"},
        {0x200c, 0x200c, false, "zero width non-joiner"},
        {0x200d, 0x200d, false, "zero width joiner"},
        {0x200e, 0x200f, false, "direction mark"},
        {0x2028, 0x2028, true, "line separator"},
        {0x2029, 0x2029, true, "paragraph separator"},
        {0x202a, 0x202e, false, "direction mark"},
        {0x202f, 0x202f, true, "narrow no-break space"},
        {0x205f, 0x205f, true, "mathematical space"},
        {0x2060, 0x2060, false, "word joiner"},
        {0x2061, 0x2064, false, "invisible operator"},
        {0x2065, 0x206f, false, "direction mark"},
        {0x2800, 0x2800, true, "blank Braille pattern"},
        {0x3000, 0x3000, true, "ideographic space"},
        {0x3164, 0x3164, false, "Hangul filler"},
        {0xfe00, 0xfe0f, false, "variation selector"},
        {0xfeff, 0xfeff, false, "byte order mark"},
        {0xffa0, 0xffa0, false, "Hangul filler"},
        {0xfff0, 0xfffb, false, "annotation mark"},
        {0x1bca0, 0x1bca3, false, "format mark"},
        {0x1d173, 0x1d17a, false, "format mark"},
        {0xe0000, 0xe0fff, false, "tag or variation selector"},
    };
    for (size_t i = 0; i < sizeof hidden / sizeof hidden[0]; i++) {
        if (character >= hidden[i].first && character <= hidden[i].last) {
            *blank = hidden[i].blank;
            return hidden[i].name;
        }
    }
    return NULL;
}

void words_add(char *text, size_t size, const char *format, ...)
{
    const size_t used = strnlen(text, size);
    va_list arguments;
    va_start(arguments, format);
    if (used < size)
        vsnprintf(text + used, size - used, format, arguments);
    va_end(arguments);
}

size_t words_fill(FILE *out, const char *text, size_t length, size_t column, size_t indent,
                  size_t margin)
{
    const char *const end = text + length;
    for (size_t word; (text += strspn(text, " ")) < end; text += word) {
        word = strcspn(text, " \n");
        if (column >= indent && column + 1 + word > margin) {
            fputc('\n', out);
            column = 0;
        }
        column +=
            (size_t)fprintf(out, "%*s%.*s", column < indent ? (int)(indent - column) : column > 0,
                            "", (int)word, text);
    }
    return column;
}
