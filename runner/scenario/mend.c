/* mend.c - what was probably meant by text that cannot be read. */
#include "mend.h"
#include "tree.h"

#include "runner/base/words.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Length of the name that stands at the beginning. */
static size_t name_length(const char *text)
{
    size_t n = 0;
    if (isalpha((unsigned char)text[0]))
        while (tree_name_letter(text[n]))
            n++;
    return n;
}

#define SAY(...) (snprintf(out, MEND_SIZE, __VA_ARGS__) < MEND_SIZE)

const char *mend_word(const char *word, const char *const *known, size_t count)
{
    /* What is called so elsewhere, and what it is here. */
    static const char others[] =
        " mu=friction friction=friction_factor dt=step steps=count step=count "
        "points=count num=count n=count min=from max=to start=from end=to com=centre "
        "center=centre revolute=hinge prismatic=slide joint=body duration=time "
        "e=restitution g=gravity pd=hold logarithmic=log monte-carlo=random "
        "latin=lhs lqr=state-feedback place=state-feedback left=foot1 right=foot2 "
        "height=z length=leg_length mass=hip_mass every=all bullet=ball robot=biped "
        "rate_limit=torque_rate slew_rate=torque_rate latency=delay dead_time=delay "
        "time_constant=lag ";
    const char *const dash = strchr(word, '-');
    const size_t length = strlen(word);
    char turned[64] = "", called[80];

    if (dash && length < sizeof turned) /* theta-x: x-theta */
        snprintf(turned, sizeof turned, "%s-%.*s", dash + 1, (int)(dash - word), word);
    else if (length > 4 && length < sizeof turned && strcmp(word + length - 4, "_dot") == 0)
        snprintf(turned, sizeof turned, "v%.*s", (int)length - 4, word);
    snprintf(called, sizeof called, " %.60s=", word);
    for (size_t k = 0; k < count; k++) {
        if (strcmp(turned, known[k]) == 0)
            return known[k];
        const size_t own = strlen(known[k]);
        for (const char *at = others; (at = strstr(at, called));) {
            at += strlen(called);
            if (strncmp(at, known[k], own) == 0 && at[own] == ' ')
                return known[k];
        }
    }
    return nearest_word(word, known, count);
}

const char *mend_path(const char *path, const char *const *known, size_t count)
{
    const char *found = NULL;
    size_t most = 0;
    for (size_t k = 0; k < count; k++) {
        const char *a = path + strlen(path), *b = known[k] + strlen(known[k]);
        size_t names = 0;
        while (a > path && b > known[k] && a[-1] == b[-1]) {
            a--, b--;
            names += *a == '.';
        }
        names += (a == path && (b == known[k] || b[-1] == '.'));
        if (names > most) {
            most = names;
            found = known[k];
        } else if (names > 0 && names == most) {
            found = NULL;
        }
    }
    return found;
}

bool mend_pair(const char *text, char *name, size_t size, char out[MEND_SIZE])
{
    const size_t length = name_length(text), blanks = length + strspn(text + length, " ");
    const bool sign = text[blanks] && strchr("=:", text[blanks]);
    const char *value = text + blanks + sign;
    value += strspn(value, " ");
    snprintf(name, size, "%.*s", (int)length, text);
    for (const unsigned char *c = (const unsigned char *)value; *c; c++)
        if (*c < 0x20 || *c == 0x7f)
            return false; /* no line */
    return length > 0 && length < size && value > text + length && *value && !strchr(value, ':') &&
           SAY("%s: %s", name, value);
}

bool mend_number(const char *text, const char *unit, char out[MEND_SIZE])
{
    static const struct {
        const char *name, *of;
        double factor;
    } units[] = {
        {"mm", "m", 1e-3},
        {"cm", "m", 1e-2},
        {"ms", "s", 1e-3},
        {"min", "s", 60},
        {"g", "kg", 1e-3},
        {"deg", "rad", M_PI / 180},
        {"°", "rad", M_PI / 180},
        {"°/s", "rad/s", M_PI / 180},
        {"deg/s", "rad/s", M_PI / 180},
        {"kN", "N", 1e3},
        {"%", "1", 1e-2},
    };
    static const char minus[] = "−"; /* of typography */
    char plain[64], *end;
    size_t n = 0, commas = 0;

    for (const char *s = text; *s && n < sizeof plain - 1; s++) {
        if (strncmp(s, minus, sizeof minus - 1) == 0) {
            plain[n++] = '-';
            s += sizeof minus - 2;
        } else if (*s != '_') {
            commas += *s == ',';
            plain[n++] = *s == ',' ? '.' : *s;
        }
    }
    plain[n] = '\0';
    if (commas > 1 || strspn(plain, "+-.0123456789") == 0 || strstr(plain, "0x"))
        return false;
    double value = strtod(plain, &end), factor = end > plain ? 1 : 0;
    if (*end == '/') {
        const double divisor = strtod(end + 1, &end);
        factor = divisor != 0 && !*end ? 1 / divisor : 0;
    }
    end += strspn(end, " ");
    for (size_t i = 0; *end && i < sizeof units / sizeof units[0]; i++) {
        if (strcmp(end, units[i].name) == 0 && strcmp(unit, units[i].of) == 0) {
            factor *= units[i].factor;
            end += strlen(end);
        }
    }
    for (const char *of = unit; *end && *of; of++) /* "Nm", too, is N m */
        if (*of == *end)
            end++;
        else if (*of != ' ')
            break;
    /* A product of the shortest that reads back: 0.535, not 0.53500000000000003. */
    return !*end && factor != 0 && isfinite(value * factor) && SAY("%.12g", value * factor);
}
