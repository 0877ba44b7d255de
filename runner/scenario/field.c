/* field.c - one value of a scenario: read from a node, checked against its row of the schema. */
#include "field.h"
#include "mend.h"

#include "runner/base/words.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers as text ------------------------------------------------------------------------- */

/* Length of the decimal number that `text` begins with; 0: none. */
static size_t number_length(const char *text)
{
    const char *s = text;
    size_t whole = 0, fraction = 0;

    if (*s == '+' || *s == '-')
        s++;
    const char *digits = s;
    for (; isdigit((unsigned char)*s); s++)
        whole++;
    if (whole > 1 && digits[0] == '0')
        return 0;
    if (*s == '.')
        for (s++; isdigit((unsigned char)*s); s++)
            fraction++;
    if (whole + fraction == 0)
        return 0;
    if (*s == 'e' || *s == 'E') {
        const char *exponent = s + 1;
        if (*exponent == '+' || *exponent == '-')
            exponent++;
        if (isdigit((unsigned char)*exponent)) {
            for (s = exponent; isdigit((unsigned char)*s); s++) {
            }
        }
    }
    return (size_t)(s - text);
}

bool number_parse(const char *text, double *value, bool *finite)
{
    size_t length = number_length(text);

    *finite = true;
    if (length == 0 || text[length])
        return false;
    *value = strtod(text, NULL);
    *finite = isfinite(*value);
    return *finite;
}

/* "5 mm", "10ms": a number with letters after it. */
static bool has_unit(const char *text)
{
    size_t length = number_length(text);
    if (length == 0)
        return false;
    const char *rest = text + length + strspn(text + length, " ");
    return isalpha((unsigned char)*rest) || *rest == '%' || (unsigned char)*rest >= 0x80;
}

/* ---- problems -------------------------------------------------------------------------------- */

static const char *found(char *buffer, size_t size, const struct tree_node *node)
{
    char word[SHOWN_SIZE];
    if (node->kind != TREE_SCALAR)
        snprintf(buffer, size, "%s", node->kind == TREE_LIST ? "a list" : "a mapping");
    else if (node->quoted)
        snprintf(buffer, size, "the text \"%s\"", shown(word, node->text));
    else if (!node->text[0] || strcmp(node->text, "~") == 0 || strcmp(node->text, "null") == 0)
        snprintf(buffer, size, "nothing");
    else
        snprintf(buffer, size, "'%s'", shown(word, node->text));
    return buffer;
}

bool field_mismatch(struct problems *problems, const char *name, const char *wanted,
                    const struct tree_node *node)
{
    char what[2 * SHOWN_SIZE];
    return problem_add(problems, node->mark, "%s: expected %s, found %s", name, wanted,
                       found(what, sizeof what, node));
}

bool field_unknown(struct problems *problems, const char *name, const char *what, const char *word,
                   struct mark mark, const char *const *known, size_t count)
{
    char wrong[SHOWN_SIZE], list[500], hint[2 * SHOWN_SIZE] = "";
    const char *near = problems_full(problems) ? NULL : mend_word(word, known, count);

    if (near)
        snprintf(hint, sizeof hint, "; did you mean '%.96s'?", near);
    return problem_add(problems, mark, "%s%sunknown %s '%s'%s (known: %s)", name,
                       name[0] ? ": " : "", what, shown(wrong, word), hint,
                       word_list(list, sizeof list, known, count));
}

bool field_admits(struct problems *problems, const struct scenario_field *field, const char *name,
                  const char *what, struct mark mark, double value)
{
    char range[96], word[SHOWN_SIZE];
    if (isnan(value) || value < field->low || value > field->high ||
        (field->low_open && value == field->low) || (field->high_open && value == field->high)) {
        bool quantity = field->unit[0] && strcmp(field->unit, "1") != 0 && field->columns == 0;
        return problem_add(problems, mark, "%s: %s is out of range (%s%s%s)", name,
                           shown(word, what), schema_range_text(field, range, sizeof range),
                           quantity ? " " : "", quantity ? field->unit : "");
    }
    return true;
}

/* Says why a node is no number. */
static bool no_number(struct problems *problems, const struct scenario_field *field,
                      const char *name, const char *wanted, const struct tree_node *node)
{
    char what[2 * SHOWN_SIZE], mend[MEND_SIZE], hint[MEND_SIZE + 160] = "";
    const bool quantity = field->unit[0] && strcmp(field->unit, "1") != 0;
    double value;
    bool finite = true;

    if (node->kind != TREE_SCALAR)
        return field_mismatch(problems, name, wanted, node);
    const bool known = !node->quoted && mend_number(node->text, field->unit, mend),
               number = number_parse(node->text, &value, &finite);
    const char *const letters = node->text + strspn(node->text, "+-");
    found(what, sizeof what, node);
    if (!node->quoted && !number && !finite)
        return problem_add(problems, node->mark, "%s: %s is too large for a number", name, what);
    if (node->quoted && number)
        add_text(hint, sizeof hint, "; remove the quotes");
    else if (!node->quoted && letters <= node->text + 1 &&
             (!strcasecmp(letters, ".inf") || !strcasecmp(node->text, ".nan")))
        add_text(hint, sizeof hint, "; it must be finite%s",
                 field->type == FIELD_NUMBER && field->words ? ", or none" : "");
    else if (has_unit(node->text))
        add_text(hint, sizeof hint, " (numbers only; %s %s%s)", schema_last_name(name),
                 quantity ? "is in " : "has no unit", quantity ? field->unit : "");
    if (known)
        add_text(hint, sizeof hint, "; write %s", mend);
    return problem_add(problems, node->mark, "%s: expected %s, found %s%s", name, wanted, what,
                       hint);
}

/* ---- values ---------------------------------------------------------------------------------- */

bool field_number(struct problems *problems, const struct scenario_field *field, const char *name,
                  const struct tree_node *node, double *value)
{
    bool finite;
    const bool whole = field->whole || field->type == FIELD_INTEGER,
               none = field->words && (field->type == FIELD_NUMBER || field->type == FIELD_NUMBERS);
    const char *const wanted = whole && none ? "a whole number or none"
                               : whole       ? "a whole number"
                               : none        ? "a number or none"
                                             : "a number";
    if (none && node->kind == TREE_SCALAR && strcmp(node->text, field->words[0]) == 0) {
        *value = INFINITY;
        return true;
    }
    if (node->kind != TREE_SCALAR || node->quoted || !number_parse(node->text, value, &finite))
        return no_number(problems, field, name, wanted, node);
    if (whole && *value != floor(*value))
        return field_mismatch(problems, name, wanted, node);
    return field_admits(problems, field, name, node->text, node->mark, *value);
}

bool field_seed(struct problems *problems, const char *name, const struct tree_node *node,
                uint64_t *value)
{
    static const struct scenario_field field = {
        .type = FIELD_INTEGER, .low = -INFINITY, .high = INFINITY};
    double number = 0;
    if (!field_number(problems, &field, name, node, &number))
        return false;
    bool digits = !node->text[strspn(node->text, "+-0123456789")]; /* unlike 1e3 or 7.0 */
    *value = UINT64_MAX;
    if (number >= 0 && digits)
        *value = strtoull(node->text, NULL, 10);
    else if (number >= 0 && number < 0x1p63)
        *value = (uint64_t)number;
    if (*value > INT64_MAX) {
        char word[SHOWN_SIZE];
        return problem_add(problems, node->mark,
                           "%s: %s is out of range (0 ... 9223372036854775807)", name,
                           shown(word, node->text));
    }
    return true;
}

bool field_word(struct problems *problems, const struct scenario_field *field, const char *name,
                const struct tree_node *node, int *place)
{
    if (node->kind != TREE_SCALAR || (!node->text[0] && !node->quoted)) {
        char list[300], wanted[320];
        snprintf(wanted, sizeof wanted, "one of %s",
                 word_list(list, sizeof list, field->words, field->word_count));
        return field_mismatch(problems, name, wanted, node);
    }
    const size_t k = word_place(node->text, field->words, field->word_count);
    if (k == field->word_count)
        return field_unknown(problems, name, "word", node->text, node->mark, field->words,
                             field->word_count);
    *place = (int)k;
    return true;
}

bool field_value(struct problems *problems, const struct scenario_field *field, const char *name,
                 const struct tree_node *node, double *value)
{
    int place = 0;
    if (field->type != FIELD_WORD && field->type != FIELD_CASES)
        return field_number(problems, field, name, node, value);
    const bool good = field_word(problems, field, name, node, &place);
    *value = place;
    return good;
}

/* A mapping or a scalar where a list is wanted: what is in it is probably meant to be an item. */
static bool no_list(struct problems *problems, const char *name, const char *wanted,
                    const struct tree_node *node)
{
    char what[2 * SHOWN_SIZE], word[SHOWN_SIZE];
    found(what, sizeof what, node);
    if (node->kind == TREE_MAP && node->count > 0) {
        return problem_add(problems, node->mark,
                           "%s: expected %s, found %s; each item begins with a dash: - %s: ...",
                           name, wanted, what, shown(word, node->key[0].name));
    }
    if (node->kind == TREE_SCALAR && node->text[0] && strlen(node->text) < SHOWN_SIZE / 2) {
        return problem_add(problems, node->mark, "%s: expected %s, found %s; write [%s]", name,
                           wanted, what, shown(word, node->text));
    }
    return field_mismatch(problems, name, wanted, node);
}

bool field_items(struct problems *problems, const char *name, const struct tree_node *node,
                 size_t items, const char *what)
{
    char wanted[64];
    const size_t letters = strlen(what);
    snprintf(wanted, sizeof wanted, "%zu %.*s", items,
             (int)(items == 1 && what[letters - 1] == 's' ? letters - 1 : letters), what);
    if (node->kind == TREE_SCALAR && items > 1 && !strpbrk(node->text, ", "))
        return field_mismatch(problems, name, wanted, node);
    if (node->kind == TREE_MAP && items == 1 && node->count == 1 &&
        node->item[0]->kind == TREE_SCALAR) { /* under the name that it has elsewhere */
        char word[SHOWN_SIZE];
        return problem_add(problems, node->mark, "%s: expected %s, found a mapping; write [%s]",
                           name, wanted, shown(word, node->item[0]->text));
    }
    if (node->kind != TREE_LIST)
        return no_list(problems, name, wanted, node);
    if (node->count == items)
        return true;
    size_t commas = 0; /* [0,2, 0,4]: whole numbers followed by digits alone */
    for (size_t i = 1; i < node->count; i++) {
        const struct tree_node *const left = node->item[i - 1], *const right = node->item[i];
        commas += left->kind == TREE_SCALAR && right->kind == TREE_SCALAR && left->text[0] &&
                  right->text[0] && !left->text[strspn(left->text, "+-0123456789")] &&
                  !right->text[strspn(right->text, "0123456789")];
    }
    return problem_add(
        problems, node->mark, "%s: expected %s, found %zu%s", name, wanted, node->count,
        node->count > items && commas > 0 ? "; decimals have a point, not a comma" : "");
}

bool field_list(struct problems *problems, const char *name, const char *wanted,
                const struct tree_node *node, size_t most, const char *what)
{
    if (node->kind != TREE_LIST)
        return no_list(problems, name, wanted, node);
    if (node->count == 0)
        return problem_add(problems, node->mark, "%s: the list is empty", name);
    return most == 0 || node->count <= most ||
           problem_add(problems, node->mark, "%s: more than %zu %s", name, most, what);
}

bool field_words(struct problems *problems, const struct scenario_field *field, const char *name,
                 const struct tree_node *node, uint64_t *mask)
{
    bool good = true;
    uint64_t bits = 0;

    int one;
    if (node->kind == TREE_SCALAR && node->text[0] &&
        !field_word(problems, field, name, node, &one))
        return false;
    if (!field_list(problems, name, "a list of names", node, 0, NULL))
        return false;
    for (size_t i = 0; i < node->count; i++) {
        int place;
        if (!field_word(problems, field, name, node->item[i], &place)) {
            good = false;
        } else if (bits >> place & 1) {
            good = problem_add(problems, node->item[i]->mark, "%s: '%s' is listed twice", name,
                               field->words[place]);
        } else {
            bits |= (uint64_t)1 << place;
        }
    }
    *mask = bits;
    return good;
}

bool field_text(struct problems *problems, const char *name, const struct tree_node *node,
                char *text, size_t size)
{
    double value;
    bool finite;

    if (node->kind != TREE_SCALAR)
        return field_mismatch(problems, name, "text", node);
    if (!node->quoted) {
        static const char *const others[] = {"", "~", "null", "true", "false"};
        bool other = number_parse(node->text, &value, &finite) || !finite;
        for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
            other = other || strcmp(node->text, others[i]) == 0;
        if (other) {
            return field_mismatch(problems, name, "text (in quotes where it looks otherwise)",
                                  node);
        }
    }
    for (const unsigned char *s = (const unsigned char *)node->text; *s; s++) {
        if (*s < 0x20 || *s == 0x7f || (*s == 0xc2 && s[1] < 0xa0)) {
            return problem_add(problems, node->mark, "%s: more than a line, or control characters",
                               name);
        }
    }
    if (strlen(node->text) >= size)
        return problem_add(problems, node->mark, "%s: longer than %zu bytes", name, size - 1);
    memcpy(text, node->text, strlen(node->text) + 1);
    return true;
}

static bool stable_pole(struct problems *problems, const struct scenario_field *field,
                        const char *name, const struct tree_node *node, double re)
{
    char word[SHOWN_SIZE];
    if (re >= 0) {
        return problem_add(
            problems, node->mark,
            "%s: %s is not in the open left half plane: the loop would not be stable", name,
            shown(word, node->text));
    }
    return field_admits(problems, field, name, node->text, node->mark, re);
}

bool field_pole(struct problems *problems, const struct scenario_field *field, const char *name,
                const struct tree_node *node, double *re, double *im)
{
    static const char wanted[] = "a number, or a complex one such as -3+1.5i";
    struct scenario_field imaginary = *field;
    char part[64];
    bool finite;

    *im = 0;
    if (node->kind != TREE_SCALAR || node->quoted)
        return no_number(problems, field, name, wanted, node);
    size_t length = number_length(node->text), total = strlen(node->text);
    bool sign = node->text[length] == '+' || node->text[length] == '-';
    if (length == 0 || !sign || node->text[total - 1] != 'i' || total >= sizeof part) {
        if (!number_parse(node->text, re, &finite))
            return no_number(problems, field, name, wanted, node);
        return stable_pole(problems, field, name, node, *re);
    }
    snprintf(part, sizeof part, "%.*s", (int)(total - length - 1), node->text + length);
    bool good = number_parse(part, im, &finite);
    snprintf(part, sizeof part, "%.*s", (int)length, node->text);
    if (!good || !number_parse(part, re, &finite))
        return field_mismatch(problems, name, wanted, node);
    imaginary.high = -field->low;
    imaginary.high_open = false;
    return stable_pole(problems, field, name, node, *re) &&
           field_admits(problems, &imaginary, name, node->text, node->mark, *im);
}
