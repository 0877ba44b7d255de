/* results_text.c - the words for what a results file holds: cases, values, its scenario. */
#include "results.h"

#include "runner/base/words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Significant digits of a number for people, and where its neighbours ask for more. */
enum { DIGITS = 6, MOST_DIGITS = 17 };

/* ---- letters ------------------------------------------------------------------------------ */

int results_letter(const char *text)
{
    uint32_t character;
    return (int)utf8_letter(text, strnlen(text, 4), &character);
}

void results_clean(char *text)
{
    while (*text) {
        int length = results_letter(text);
        if (length == 0)
            *text = '?';
        else if ((unsigned char)*text < ' ' || *text == 0x7f)
            *text = ' ';
        text += length > 0 ? length : 1;
    }
}

/* ---- cases -------------------------------------------------------------------------------- */

void results_point(const struct results *r, uint64_t index, size_t *point)
{
    for (int a = r->axes - 1; a >= 0; a--) {
        point[a] = (size_t)(index % r->axis[a].count);
        index /= r->axis[a].count;
    }
}

void results_number_text(double value, double gap, char *buffer, size_t size)
{
    int digits = DIGITS;
    if (isinf(value)) { /* an absent limit */
        snprintf(buffer, size, "none");
        return;
    }
    do { /* the text is nearer to this value than to its neighbours */
        snprintf(buffer, size, "%.*g", digits, value);
    } while (gap > 0 && fabs(strtod(buffer, NULL) - value) > gap / 4 && digits++ < MOST_DIGITS);
}

/* A word, or a number with its unit, which "none" does not have. */
static void value_text(const char *word, double value, double gap, const char *unit, char *buffer,
                       size_t size)
{
    char number[32];
    results_number_text(value, gap, number, sizeof number);
    unit = unit && isfinite(value) ? unit : "";
    snprintf(buffer, size, "%s%s%s", word ? word : number, !word && unit[0] ? " " : "",
             word ? "" : unit);
}

void results_value_text(const struct results_axis *axis, size_t i, bool unit, char *buffer,
                        size_t size)
{
    /* Distance from the nearest other value; 0: there is none. */
    const double below = i > 0 ? fabs(axis->value[i] - axis->value[i - 1]) : 0,
                 above = i + 1 < axis->count ? fabs(axis->value[i + 1] - axis->value[i]) : 0;
    value_text(axis->word ? axis->word[i] : NULL, axis->value[i],
               below > 0 && (below < above || above == 0) ? below : above, unit ? axis->unit : NULL,
               buffer, size);
}

void results_varied_text(const struct results_varied *v, size_t i, bool unit, char *buffer,
                         size_t size)
{
    value_text(v->word ? v->word[(int)v->of.value[i]] : NULL, v->of.value[i], 0,
               unit ? v->of.unit : NULL, buffer, size);
}

const char *results_ends_text(const struct results_axis *axis, char *first, char *last, size_t size)
{
    size_t ends[2];
    const bool sorted = scenario_ends(axis->value, axis->count, 1, ends);
    results_value_text(axis, ends[0], false, first, size);
    results_value_text(axis, ends[1], true, last, size);
    return sorted ? "" : ", not sorted";
}

void results_case_text(const struct results *r, uint64_t index, char *buffer, size_t size)
{
    size_t point[SCENARIO_MAX_AXES];
    char text[128];

    buffer[0] = '\0';
    results_point(r, index, point);
    for (int a = 0; !r->single && a < r->axes; a++) {
        results_value_text(&r->axis[a], point[a], true, text, sizeof text);
        words_add(buffer, size, "%s%s = %s", a ? ", " : "", r->axis[a].name, text);
    }
    for (int k = 0; k < r->varied; k++) {
        results_varied_text(&r->vary[k], point[r->sample], true, text, sizeof text);
        words_add(buffer, size, "%s%s = %s%s", k ? ", " : " (", r->vary[k].of.name, text,
                  k + 1 == r->varied ? ")" : "");
    }
}

void results_warn(const struct results *r)
{
    const bool one = r->damage.cases == 1;
    if (r->damage.cases > 0) {
        fprintf(stderr,
                "stance: warning: %.200s: %llu case%s not verify and %s as pending, the first is "
                "%llu; stance run --resume computes %s again\n",
                r->file, (unsigned long long)r->damage.cases, one ? " does" : "s do",
                one ? "counts" : "count", (unsigned long long)r->damage.first, one ? "it" : "them");
    }
}
