/* fuzz_mutate.c - changes to scenarios for libFuzzer: of lines with their indentation, of words in
 * them, of whole branches, and --set strings; the words come from the table of keys itself.
 */
#include "runner/scenario/mechanism.h"
#include "runner/scenario/schema.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t room);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t room, unsigned seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t *one, size_t one_size, const uint8_t *other,
                                 size_t other_size, uint8_t *out, size_t room, unsigned seed);

/* ---- chance ------------------------------------------------------------------------------- */

static uint64_t chance;

static size_t below(size_t n)
{
    chance ^= chance << 13; /* Marsaglia's xorshift */
    chance ^= chance >> 7;
    chance ^= chance << 17;
    return n ? (size_t)(chance >> 11) % n : 0;
}

static void begin_chance(unsigned seed)
{
    chance = (uint64_t)seed * 0x9e3779b97f4a7c15u + 0x1234567;
}

/* ---- words -------------------------------------------------------------------------------- */

static struct schema *schemas; /* one for each scene, and that of mechanisms of BODY and such */
static size_t schema_count;

static void build_schemas(void)
{
    const stance_scene *const *scenes = stance_scenes();
    while (scenes[schema_count])
        schema_count++;
    const stance_scene *const any = mechanism_pattern();
    schemas = calloc(schema_count + 1, sizeof *schemas);
    if (!schemas || !any)
        abort();
    for (size_t i = 0; i <= schema_count; i++)
        schema_build(&schemas[i], i < schema_count ? scenes[i] : any, NULL, true);
    schema_count++;
}

static const struct scenario_field *any_field(void)
{
    const struct schema *schema = &schemas[below(schema_count)];
    return &schema->field[below(schema->count)];
}

static const char values[] = /* with semicolons between them */
    "0;1;-1;2;3;1e-9;1e9;1e308;-1e308;5e-324;0.5;1e400;4294967296;2147483647;-2147483648;"
    "9007199254740992;9223372036854775807;18446744073709551616;.inf;.nan;none;off;all;~;null;"
    "true;\"\";'';[];{};[[]];[1];[0, 1];{a: 1};&a x;*a;&a [*a];!!str 1;|\n  text\n;>-\n  text\n;"
    "10 mm;1:30;0x10;1_000;-3+1.5i;-3-1.5i;-.5e-3;\"\\0\";\"\\u00e9\";<<;---;...;%YAML 1.2;? a;"
    "- ;log;linear;[-3, -3, -3, -3, -3, -3];[-3+1i, -3-1i, -4, -5, -6, -7];[[1, 2], [3, 4]];"
    "1000000;1048577;16777216;1e16;0.999999;1.000001;saltelli;BODY;ROOT;[none, 0];"
    "{joint: hinge, parent: ROOT, mass: 1, centre: [0, 1]}";

static void any_value(char *out, size_t size)
{
    size_t count = 1;
    const char *value = values;
    for (const char *s = values; *s; s++)
        count += *s == ';';
    for (count = below(count); count > 0; count--)
        value = strchr(value, ';') + 1;
    snprintf(out, size, "%.*s", (int)strcspn(value, ";"), value);
}

/* A path with an index for each "[]"; mostly small ones. */
static void concrete_path(const char *path, char *out, size_t size)
{
    size_t n = 0;
    for (const char *s = path; *s && n + 8 < size; s++) {
        out[n++] = *s;
        if (*s == '[')
            n += (size_t)snprintf(out + n, size - n, "%zu", below(8) ? below(3) : below(1000));
    }
    out[n] = '\0';
}

/* A value that the field may have, or nearly. */
static void field_value(const struct scenario_field *field, char *out, size_t size)
{
    char path[128];
    if (field->word_count > 0 && below(4)) {
        const char *format = field->type == FIELD_WORDS ? "[%s]" : "%s";
        snprintf(out, size, format, field->words[below(field->word_count)]);
    } else if ((field->type == FIELD_PATH || field->type == FIELD_PATHS) && below(8)) {
        concrete_path(any_field()->path, path, sizeof path);
        snprintf(out, size, field->type == FIELD_PATHS ? "[%s]" : "%s", path);
    } else if ((field->type == FIELD_NUMBER || field->type == FIELD_INTEGER) && below(3)) {
        const double ends[] = {field->low, field->high, field->fallback, (double)below(10),
                               (double)below(1000) / 997};
        snprintf(out, size, "%.17g", ends[below(sizeof ends / sizeof ends[0])]);
    } else {
        any_value(out, size);
    }
}

/* ---- edits -------------------------------------------------------------------------------- */

struct text {
    char *data;
    size_t size, room;
};

/* Puts `length` bytes where `cut` bytes stood; does nothing when they do not fit. */
static void splice(struct text *t, size_t at, size_t cut, const char *with, size_t length)
{
    if (t->size - cut + length > t->room)
        return;
    memmove(t->data + at + length, t->data + at + cut, t->size - at - cut);
    memcpy(t->data + at, with, length);
    t->size += length - cut;
}

static size_t line_end(const struct text *t, size_t at)
{
    const char *end = memchr(t->data + at, '\n', t->size - at);
    return end ? (size_t)(end - t->data) + 1 : t->size;
}

/* Where some line begins. */
static size_t any_line(const struct text *t)
{
    size_t at = below(t->size + 1);
    while (at > 0 && t->data[at - 1] != '\n')
        at--;
    return at;
}

static size_t indent_of(const struct text *t, size_t line)
{
    size_t n = 0;
    while (line + n < t->size && t->data[line + n] == ' ')
        n++;
    return n;
}

/* The end of the lines that are indented deeper than the one at `line`. */
static size_t branch_end(const struct text *t, size_t line)
{
    const size_t indent = indent_of(t, line);
    size_t end = line_end(t, line);
    while (end < t->size && (t->data[end] == '\n' || indent_of(t, end) > indent))
        end = line_end(t, end);
    return end;
}

static bool is_edge(char c)
{
    return strchr(" \n,[]{}:\"'=", c) != NULL;
}

/* The word around some place: between two marks of the syntax. */
static size_t any_word(const struct text *t, size_t *length)
{
    size_t at = below(t->size), end;
    while (at > 0 && !is_edge(t->data[at - 1]))
        at--;
    for (end = at; end < t->size && !is_edge(t->data[end]);)
        end++;
    *length = end - at;
    return at;
}

static void change_word(struct text *t)
{
    char word[256];
    size_t length, at = any_word(t, &length);
    const struct scenario_field *field = any_field();

    switch (below(4)) {
    case 0:
        snprintf(word, sizeof word, "%s", schema_last_name(field->path));
        break;
    case 1:
        concrete_path(field->path, word, sizeof word);
        break;
    case 2: { /* another one of this text */
        size_t other_length, other = any_word(t, &other_length);
        snprintf(word, sizeof word, "%.*s", (int)(other_length < 200 ? other_length : 200),
                 t->data + other);
        break;
    }
    default:
        field_value(field, word, sizeof word);
    }
    splice(t, at, length, word, strlen(word));
}

/* "key: value" on the line that belongs to that key, if there is one; else a new line. */
static void change_key(struct text *t)
{
    char line[400], value[256], wanted[SCHEMA_MAX_WORDS * 4];
    const struct scenario_field *field = any_field();
    const char *name = schema_last_name(field->path);

    field_value(field, value, sizeof value);
    snprintf(wanted, sizeof wanted, "%s:", name);
    char *place = t->size ? memmem(t->data, t->size, wanted, strlen(wanted)) : NULL;
    if (place && below(4)) {
        size_t at = (size_t)(place - t->data) + strlen(wanted), end = at;
        while (end < t->size && !strchr("\n,}", t->data[end]))
            end++;
        snprintf(line, sizeof line, " %s", value);
        splice(t, at, end - at, line, strlen(line));
        return;
    }
    size_t at = any_line(t);
    snprintf(line, sizeof line, "%*s%s: %s\n", (int)indent_of(t, at) % 20, "", name, value);
    splice(t, at, 0, line, strlen(line));
}

static void add_set(struct text *t)
{
    char line[600], path[160], value[256];
    const struct scenario_field *field = any_field();
    concrete_path(field->path, path, sizeof path);
    field_value(field, value, sizeof value);
    for (char *s = value; *s; s++)
        *s = *s == '\n' ? ' ' : *s;
    snprintf(line, sizeof line, "%s#set %s=%s\n",
             t->size && t->data[t->size - 1] != '\n' ? "\n" : "", path, value);
    splice(t, t->size, 0, line, strlen(line));
}

static void add_axis(struct text *t)
{
    char line[600], path[160], from[256], to[256];
    const struct scenario_field *field = any_field();
    const char *grid = t->size ? memmem(t->data, t->size, "grid:\n", 6) : NULL;
    concrete_path(field->path, path, sizeof path);
    field_value(field, from, sizeof from);
    field_value(field, to, sizeof to);
    int n = grid ? 0 : snprintf(line, sizeof line, "sweep:\n  grid:\n");
    if (below(2)) {
        snprintf(line + n, sizeof line - (size_t)n,
                 "    - {path: %s, from: %.60s, to: %.60s, count: %zu%s}\n", path, from, to,
                 below(6) ? 1 + below(9) : (size_t)1 << below(54),
                 below(4) ? "" : ", spacing: log");
    } else {
        snprintf(line + n, sizeof line - (size_t)n, "    - {path: %s, values: [%.60s, %.60s]}\n",
                 path, from, to);
    }
    splice(t, grid ? (size_t)(grid - t->data) + 6 : t->size, 0, line, strlen(line));
}

static void move_branch(struct text *t)
{
    size_t from = any_line(t), end = branch_end(t, from), length = end - from;
    char *copy = malloc(length + 1);
    if (!copy || from == t->size) {
        free(copy);
        return;
    }
    memcpy(copy, t->data + from, length);
    if (below(3))
        splice(t, from, length, "", 0);
    if (below(3))
        splice(t, any_line(t), 0, copy, length);
    free(copy);
}

static void change_indent(struct text *t)
{
    size_t from = any_line(t), end = below(2) ? branch_end(t, from) : line_end(t, from);
    bool more = below(2) != 0;
    for (size_t at = from; at < end && at < t->size;) {
        if (more) {
            splice(t, at, 0, "  ", 2);
            end += 2;
        } else if (indent_of(t, at) >= 2) {
            splice(t, at, 2, "", 0);
            end -= 2;
        }
        size_t next = line_end(t, at);
        at = next > at ? next : end;
    }
}

/* Whether a list is written in brackets, and so forth, is left to chance. */
static void change_mark(struct text *t)
{
    static const char marks[] = "[]{}:,-&*!|>'\"%@`#?\t\r\n \\~.0";
    size_t at = below(t->size + 1);
    splice(t, at, at < t->size && below(2), &marks[below(sizeof marks - 1)], below(4) != 0);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t room, unsigned seed)
{
    static void (*const edits[])(struct text *) = {
        change_word, change_word, change_key,  change_key,    change_key, add_set,
        add_set,     add_axis,    move_branch, change_indent, change_mark};
    struct text t = {(char *)data, size, room};

    begin_chance(seed);
    if (!schemas)
        build_schemas();
    if (size == 0 || below(8) == 0)
        return LLVMFuzzerMutate(data, size, room);
    for (size_t n = 1 + below(4); n > 0; n--)
        edits[below(sizeof edits / sizeof edits[0])](&t);
    return t.size;
}

/* A branch of the other among the lines of the one. */
size_t LLVMFuzzerCustomCrossOver(const uint8_t *one, size_t one_size, const uint8_t *other,
                                 size_t other_size, uint8_t *out, size_t room, unsigned seed)
{
    struct text t = {(char *)out, one_size < room ? one_size : room, room};
    char *copy = malloc(other_size + 1);

    begin_chance(seed);
    if (!copy)
        abort();
    memcpy(out, one, t.size);
    memcpy(copy, other, other_size);
    const struct text source = {copy, other_size, other_size};
    size_t from = any_line(&source), end = branch_end(&source, from);
    size_t at = any_line(&t), cut = below(2) ? branch_end(&t, at) - at : 0;
    splice(&t, at, cut, copy + from, end - from);
    free(copy);
    return t.size;
}
