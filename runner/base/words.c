/* words.c - edit distances to known words. */
#include "words.h"

#include <string.h>
#include <strings.h>

enum { LONGEST_WORD = 63 };

static size_t minimum(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Damerau-Levenshtein distance in its restricted form (a pair is swapped at most once). Words
 * longer than LONGEST_WORD are compared by their beginning: no known word is that long. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][LONGEST_WORD + 1];
    size_t m = minimum(strlen(a), LONGEST_WORD), n = minimum(strlen(b), LONGEST_WORD);
    size_t *before = rows[0], *previous = rows[1], *current = rows[2];

    for (size_t j = 0; j <= n; j++)
        previous[j] = j;
    for (size_t i = 1; i <= m; i++) {
        current[0] = i;
        for (size_t j = 1; j <= n; j++) {
            size_t differs = a[i - 1] != b[j - 1];
            current[j] =
                minimum(minimum(previous[j], current[j - 1]) + 1, previous[j - 1] + differs);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                current[j] = minimum(current[j], before[j - 2] + 1);
        }
        size_t *oldest = before;
        before = previous;
        previous = current;
        current = oldest;
    }
    return previous[n];
}

const char *nearest_word(const char *word, const char *const *known, size_t count)
{
    const char *nearest = NULL;
    size_t length = minimum(strlen(word), LONGEST_WORD);
    const size_t third = length / 3, admitted = third > 2 ? third : length > 3 ? 2 : 1;
    size_t best = admitted + 1;

    for (size_t i = 0; i < count; i++) {
        if (strcasecmp(word, known[i]) == 0)
            return known[i];
        size_t distance = edit_distance(word, known[i]);
        /* As many edits as letters, of either word, would be another word altogether. */
        if (distance < best && distance < minimum(length, strlen(known[i]))) {
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
