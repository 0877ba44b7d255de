/* mend.c - what was probably meant by text that cannot be read. */
#include "mend.h"

#include "runner/base/words.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 160 };

/* ---- lines ----------------------------------------------------------------------------------- */

/* One line without its indentation, a comment and blanks at its end; cut where it is longer. */
struct line {
    char text[LINE_SIZE];
    size_t indent;
    bool tab, whole; /* a tab indents it; nothing was cut */
};

static bool get_line(const struct misread *m, size_t number, struct line *line)
{
    const char *at = m->text, *end = m->text + m->length;
    *line = (struct line){.whole = true};
    while (number > 0 && at && at < end) {
        at = memchr(at, '\n', (size_t)(end - at));
        at = at ? at + 1 : NULL;
        number--;
    }
    if (!at || number > 0)
        return false;
    for (; at < end && (*at == ' ' || *at == '\t'); at++) {
        line->tab = line->tab || *at == '\t';
        line->indent++;
    }
    size_t n = 0;
    for (; at < end && *at != '\n' && *at != '\r' && n < LINE_SIZE - 1; at++) {
        if (*at == '#' && (n == 0 || line->text[n - 1] == ' '))
            break;
        line->text[n++] = *at == '\t' ? ' ' : *at;
    }
    line->whole = n < LINE_SIZE - 1;
    while (n > 0 && line->text[n - 1] == ' ')
        n--;
    line->text[n] = '\0';
    return true;
}

/* Where a column of the whole line, in characters, is in `text`. */
static size_t place_in(const struct line *line, size_t column)
{
    size_t n = 0;
    for (size_t left = column > line->indent ? column - line->indent : 0; left > 0; left--) {
        n += line->text[n] != '\0';
        while (((unsigned char)line->text[n] & 0xc0) == 0x80)
            n++;
    }
    return n;
}

/* The last line before `number` that has text; false: none. */
static bool line_before(const struct misread *m, size_t *number, struct line *line)
{
    while (*number > 0)
        if (get_line(m, --*number, line) && line->text[0])
            return true;
    return false;
}

static bool name_letter(char c)
{
    return isalnum((unsigned char)c) || c == '_' || c == '-';
}

/* Length of the name that stands at the beginning. */
static size_t name_length(const char *text)
{
    size_t n = 0;
    if (isalpha((unsigned char)text[0]))
        while (name_letter(text[n]))
            n++;
    return n;
}

/* Skips the dash of an item. */
static const char *after_dash(const char *text)
{
    return text[0] == '-' && text[1] == ' ' ? text + 1 + strspn(text + 1, " ") : text;
}

/* Splits "key: value" of a line; false: it is none. */
static bool split(const char *line, size_t *key, const char **value)
{
    *key = name_length(line);
    if (*key == 0 || line[*key] != ':' || line[*key + 1] != ' ')
        return false;
    *value = line + *key + 1 + strspn(line + *key + 1, " ");
    return **value != '\0';
}

/* A value in double quotes; quotes that it stands in already are taken off. */
static void quote(char *out, size_t size, const char *value)
{
    size_t left = strlen(value), n = 0;
    if (left > 1 && (*value == '"' || *value == '\'') && value[left - 1] == *value) {
        value++;
        left -= 2;
    }
    out[n++] = '"';
    for (; left > 0 && n < size - 4; value++, left--) {
        if (*value == '"' || *value == '\\')
            out[n++] = '\\';
        out[n++] = *value;
    }
    out[n++] = '"';
    out[n] = '\0';
}

/* ---- YAML ------------------------------------------------------------------------------------ */

#define SAY(...) (snprintf(out, MEND_SIZE, __VA_ARGS__) < MEND_SIZE)

static bool say_quoted(const char *line, const char *why, char out[MEND_SIZE])
{
    char quoted[2 * LINE_SIZE];
    const char *value;
    size_t key;
    if (!split(line, &key, &value))
        return false;
    quote(quoted, sizeof quoted, value);
    return SAY("%s; write %.*s: %s", why, (int)key, line, quoted);
}

static bool say_pair(const char *text, char out[MEND_SIZE])
{
    char name[64], pair[MEND_SIZE];
    return mend_pair(text, name, sizeof name, pair) &&
           SAY("a colon and a blank stand after a key; write %s", pair);
}

static bool is_title(const char *text)
{
    return strncmp(text, "title:", 6) == 0;
}

/* ": " in a value; or keys below a line that is no key alone. */
static bool second_colon(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    const char *text = after_dash(line->text), *value;
    size_t key;

    if (split(text, &key, &value) &&
        place_in(line, m->column) > (size_t)(text - line->text) + key) {
        const char *inner = value + (strchr("({", *value) != NULL);
        const size_t own = name_length(inner), length = strlen(inner);
        if (is_title(text) || own == 0 || inner[own] != ':')
            return say_quoted(text, "text with ': ' in it stands in quotes", out);
        const size_t closing = strchr(")}", inner[length - 1]) != NULL;
        return SAY("keys in one line stand in braces; write %.*s: {%.*s}", (int)key, text,
                   (int)(length - closing), inner);
    }
    struct line before;
    size_t number = m->line;
    if (!line_before(m, &number, &before))
        return false;
    m->line = number;
    m->column = before.indent;
    text = after_dash(before.text);
    if (split(text, &key, &value)) {
        return SAY("%.*s has a value and keys below it; take the value out, or begin the next line "
                   "where this one begins",
                   (int)key, text);
    }
    return say_pair(text, out);
}

static bool no_colon(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    struct line key, before;
    size_t number = m->context_line;
    (void)line;
    if (!get_line(m, m->context_line, &key))
        return false;
    m->line = m->context_line;
    m->column = m->context_column;
    if (strchr("{[", key.text[0]) && line_before(m, &number, &before) && before.text[0] == '-')
        return SAY("a dash is missing; write - %s", key.text);
    return say_pair(key.text, out);
}

/* A key between the items of a list: of the item before it, or of one without its dash. */
static bool no_dash(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    struct line item;
    size_t number = m->line;
    (void)line;
    while (line_before(m, &number, &item)) {
        if (item.text[0] == '-') {
            return SAY("indent this line by %zu blanks, as what else belongs to the item of line "
                       "%zu, or begin it with a dash",
                       item.indent + (size_t)(after_dash(item.text) - item.text), number + 1);
        }
    }
    return false;
}

static bool no_key(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    const char *text = after_dash(line->text), *value;
    const size_t place = place_in(line, m->column);
    const char *rest = line->text + place;
    size_t key;

    if (m->column <= line->indent) {
        struct line before;
        size_t number = m->line;
        if (line_before(m, &number, &before) && before.indent > m->context_column)
            return SAY("indent this line by %zu blanks, as line %zu, or by %zu, as line %zu",
                       before.indent, number + 1, m->context_column, m->context_line + 1);
        return SAY("indent this line by %zu blanks, as line %zu", m->context_column,
                   m->context_line + 1);
    }
    if (*rest && strchr("]})", *rest))
        return SAY("this %c closes nothing; remove it", *rest);
    if (strncmp(rest, "//", 2) == 0) {
        return SAY("a comment begins with #; write %.*s# %s", (int)place, line->text,
                   rest + 2 + strspn(rest + 2, " "));
    }
    if (!split(text, &key, &value) || (strchr("[{", *value) && !is_title(text)))
        return false;
    return say_quoted(text, "text with quotes or brackets in it stands in quotes as a whole", out);
}

/* In brackets that are not closed, or without a comma. */
static bool no_comma(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    struct line opening;
    if (!get_line(m, m->context_line, &opening))
        return false;
    if (m->line != m->context_line && line->indent <= opening.indent) {
        m->line = m->context_line;
        m->column = m->context_column;
        return SAY("what is opened here is not closed; write %s%c", opening.text,
                   m->problem[strlen(m->problem) - 2]);
    }
    const char closing = m->problem[strlen(m->problem) - 2];
    const size_t length = strlen(line->text);
    if (length > 0 && strchr(")]}", line->text[length - 1]) && line->text[length - 1] != closing) {
        return SAY("closed by another bracket than opened; write %.*s%c", (int)length - 1,
                   line->text, closing);
    }
    /* Back from the colon to its key, and to what stands before it. */
    size_t word = place_in(line, m->column);
    const size_t bracket = word;
    while (word > 0 && (name_letter(line->text[word - 1]) || line->text[word - 1] == '.'))
        word--;
    size_t before = word;
    while (before > 0 && strchr(" ;", line->text[before - 1]))
        before--;
    m->column = line->indent + before;
    if (word < bracket && line->text[bracket] == '[') { /* an element of a list, in a path */
        const char *path = line->text + word;
        const size_t size = strcspn(path, ",} ");
        m->column = line->indent + word;
        return SAY("a path with brackets stands in quotes here; write '%.*s'", (int)size, path);
    }
    return before > 0 &&
           SAY("a comma is missing; write %.*s, %s", (int)before, line->text, line->text + word);
}

static bool unsuited_letter(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    (void)m;
    return say_quoted(after_dash(line->text), "text that begins so stands in quotes", out);
}

static bool list_in_line(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    const char *value;
    size_t key;
    if (is_title(line->text))
        return unsuited_letter(m, line, out);
    return split(line->text, &key, &value) && *value == '-' &&
           SAY("a list in one line stands in brackets; write %.*s: [%s]", (int)key, line->text,
               after_dash(value));
}

static bool open_quote(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    (void)line;
    m->line = m->context_line;
    m->column = m->context_column;
    return SAY("the quote that opens here is not closed");
}

static bool first_indented(struct misread *m, const struct line *line, char out[MEND_SIZE])
{
    struct line first;
    size_t number = 0;
    while (get_line(m, number, &first) && !first.text[0])
        number++;
    if (first.indent == 0 || line->indent > 0)
        return false;
    m->line = number;
    m->column = first.indent;
    return SAY("this line is indented and others are not; remove the blanks before it");
}

bool mend_yaml(struct misread *m, char out[MEND_SIZE])
{
    static const struct {
        const char *problem; /* as libyaml says it begins */
        bool (*mend)(struct misread *m, const struct line *line, char out[MEND_SIZE]);
    } known[] = {
        {"mapping values are not allowed", second_colon},
        {"could not find expected ':'", no_colon},
        {"did not find expected '-'", no_dash},
        {"did not find expected key", no_key},
        {"did not find expected ',' or", no_comma},
        {"found character that cannot start", unsuited_letter},
        {"block sequence entries are not", list_in_line},
        {"found unexpected end of stream", open_quote},
        {"did not find expected <document", first_indented},
    };
    const struct misread given = *m;
    struct line line;

    if (!get_line(m, m->line, &line))
        line = (struct line){.whole = true};
    if (line.tab) {
        m->column = 0;
        return SAY("a tab indents this line; write blanks instead");
    }
    if (line.text[0] == '-' && line.text[1] && !strchr(" -", line.text[1]) && line.whole)
        return SAY("a blank stands after a dash; write - %s", line.text + 1);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (line.whole && strncmp(m->problem, known[i].problem, strlen(known[i].problem)) == 0 &&
            known[i].mend(m, &line, out))
            return true;
    *m = given;
    return false;
}

/* ---- words and values ------------------------------------------------------------------------ */

const char *mend_word(const char *word, const char *const *known, size_t count)
{
    static const char *const others[][2] = {
        {"mu", "friction"},
        {"dt", "step"},
        {"steps", "count"},
        {"step", "count"},
        {"points", "count"},
        {"num", "count"},
        {"n", "count"},
        {"min", "from"},
        {"max", "to"},
        {"start", "from"},
        {"end", "to"},
        {"com", "centre"},
        {"center", "centre"},
        {"revolute", "hinge"},
        {"prismatic", "slide"},
        {"joint", "body"},
        {"duration", "time"},
        {"e", "restitution"},
        {"g", "gravity"},
        {"pd", "hold"},
        {"logarithmic", "log"},
        {"monte-carlo", "random"},
        {"latin", "lhs"},
        {"lqr", "state-feedback"},
        {"place", "state-feedback"},
        {"left", "foot1"},
        {"right", "foot2"},
        {"height", "z"},
        {"length", "leg_length"},
        {"mass", "hip_mass"},
        {"every", "all"},
        {"bullet", "ball"},
        {"robot", "biped"},
        {"rate_limit", "torque_rate"},
        {"slew_rate", "torque_rate"},
        {"latency", "delay"},
        {"dead_time", "delay"},
        {"time_constant", "lag"},
    };
    const char *const dash = strchr(word, '-');
    const size_t length = strlen(word);
    char turned[64] = "";

    if (dash && length < sizeof turned) /* theta-x: x-theta */
        snprintf(turned, sizeof turned, "%s-%.*s", dash + 1, (int)(dash - word), word);
    else if (length > 4 && length < sizeof turned && strcmp(word + length - 4, "_dot") == 0)
        snprintf(turned, sizeof turned, "v%.*s", (int)length - 4, word);
    for (size_t k = 0; k < count; k++) {
        if (strcmp(turned, known[k]) == 0)
            return known[k];
        for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
            if (strcmp(word, others[i][0]) == 0 && strcmp(known[k], others[i][1]) == 0)
                return known[k];
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
