/* law_file.c - see law_file.h. */
#include "law_file.h"
#include "reader.h"
#include "schema_laws.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_BYTES = 1 << 18, /* of a source */
    MOST_DATA = 1 << 14,  /* numbers */
    MOST_DATA_BYTES = 1 << 19,
    MOST_ROWS = STANCE_PROGRAM_NUMBERS,
};
static const char word[] = "program"; /* what asks for a law's file */

/* ---- numbers of a file ----------------------------------------------------------------------- */

/* Appends a scalar to a mapping or a list. */
static bool put(struct reader *r, struct tree_node *parent, const char *key, const char *text,
                bool quoted, struct mark mark)
{
    struct tree_node *const node = tree_new(&r->tree, TREE_SCALAR, mark);
    const struct tree_key name = {key, mark};
    if (!node)
        return problem_no_memory(&r->problems);
    node->text = text;
    node->quoted = quoted;
    return tree_append(&r->tree, parent, key ? &name : NULL, node) ||
           problem_no_memory(&r->problems);
}

/* Past what stands between numbers: blanks, lines, a comma or semicolon. False: two of these, so
 * that a number is missing; `line` counts lines. */
static bool pass_blanks(const char **at, int *line)
{
    int between = 0;
    for (; **at && strchr(" \t\r,;\n#", **at); ++*at) {
        if (**at == '#') /* a comment */
            *at += strcspn(*at, "\n");
        between += **at == ',' || **at == ';';
        *line += **at == '\n';
        between = **at == '\n' ? 0 : between;
        if (between > 1)
            return false;
        if (!**at)
            break;
    }
    return true;
}

/* Numbers of a file, whose name becomes a list. False: a problem. */
static bool read_numbers(struct reader *r, struct tree_node *node)
{
    const char *const text = reader_file(r, "controller.data", node, MOST_DATA_BYTES);
    const struct tree_node named = *node;
    int line = 1;
    *node = (struct tree_node){.kind = TREE_LIST, .mark = named.mark};
    for (const char *at = text; at && *at;) {
        if (!pass_blanks(&at, &line))
            return problem_add(&r->problems, named.mark,
                               "controller.data: %.200s:%d: a number is missing", named.text, line);
        const size_t length = strcspn(at, " \t\r,;\n#");
        char *const number = tree_copy(&r->tree, at, length);
        double value;
        bool finite;
        if (length == 0)
            break;
        if (!number || !number_parse(number, &value, &finite))
            return problem_add(&r->problems, named.mark,
                               "controller.data: %.200s:%d: '%.40s' is no number", named.text, line,
                               number ? number : "");
        if (!put(r, node, NULL, number, false, named.mark))
            return false;
        at += length;
    }
    return text != NULL;
}

/* ---- what PARAMETERS declares ---------------------------------------------------------------- */

/* The text of a law, read letter by letter. */
struct cursor {
    struct reader *r;
    struct mark mark; /* of the scenario's key */
    const char *file, *text, *at;
};

static bool refuse(const struct cursor *c, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static bool refuse(const struct cursor *c, const char *format, ...)
{
    char what[300];
    int line = 1;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    for (const char *at = c->text; at < c->at; at++)
        line += *at == '\n';
    return problem_add(&c->r->problems, c->mark, "controller.file: %.200s:%d: %s", c->file, line,
                       what);
}

/* Past blanks, continued lines and comments. */
static void pass(struct cursor *c)
{
    for (;;)
        if (c->at[0] == '\\' && (c->at[1] == '\n' || (c->at[1] == '\r' && c->at[2] == '\n')))
            c->at += c->at[1] == '\n' ? 2 : 3;
        else if (c->at[0] == ' ' || c->at[0] == '\t')
            c->at++;
        else if (c->at[0] == '/' && c->at[1] == '*' && strstr(c->at + 2, "*/"))
            c->at = strstr(c->at + 2, "*/") + 2;
        else
            return;
}

/* Of a row of which something is missing. */
static bool incomplete(const struct cursor *c, const char *of, const char *what)
{
    return refuse(c, "%s: %s is missing: X(name, default, \"unit\", low, high, \"text\")", of,
                  what);
}

static bool take(struct cursor *c, char letter, const char *of)
{
    const char what[] = {'\'', letter, '\'', '\0'};
    pass(c);
    if (*c->at != letter)
        return incomplete(c, of, what);
    c->at++;
    return true;
}

static bool take_name(struct cursor *c, char *name, size_t size)
{
    size_t n = 0;
    pass(c);
    while (isalnum((unsigned char)c->at[n]) || c->at[n] == '_')
        n++;
    if (n == 0 || isdigit((unsigned char)c->at[0]))
        return refuse(c, "PARAMETERS: a name is missing");
    if (n >= size)
        return refuse(c, "PARAMETERS: %.40s...: names have at most %zu letters", c->at, size - 1);
    snprintf(name, size, "%.*s", (int)n, c->at);
    c->at += n;
    return true;
}

static bool take_number(struct cursor *c, const char *of, double *value)
{
    char *end;
    pass(c);
    *value = strtod(c->at, &end);
    if (end == c->at || !isfinite(*value))
        return incomplete(c, of, "a number");
    c->at = end;
    return true;
}

/* A string, or several one after the other. */
static bool take_text(struct cursor *c, const char *of, char *text, size_t size)
{
    size_t n = 0;
    pass(c);
    if (*c->at != '"')
        return incomplete(c, of, "a text in quotes");
    while (*c->at == '"') {
        for (c->at++; *c->at && *c->at != '"' && *c->at != '\n'; c->at++) {
            c->at += *c->at == '\\' && c->at[1];
            if (n + 1 < size && (unsigned char)*c->at >= ' ')
                text[n++] = *c->at;
        }
        if (*c->at != '"')
            return refuse(c, "%s: a text does not end on its line", of);
        c->at++;
        pass(c);
    }
    text[n] = '\0';
    return true;
}

static bool take_row(struct cursor *c, struct law_file *law)
{
    struct law_parameter *const p = &law->parameter[law->parameters];
    double count = 0;
    *p = (struct law_parameter){.place = law->numbers};
    if (!take_name(c, p->name, sizeof p->name))
        return false;
    pass(c);
    if (*c->at == '[') {
        c->at++;
        if (!take_number(c, p->name, &count) || !take(c, ']', p->name))
            return false;
        if (!(count >= 1 && count <= STANCE_PROGRAM_NUMBERS && count == floor(count)))
            return refuse(c, "%s: a list has 1 to %d numbers", p->name, STANCE_PROGRAM_NUMBERS);
        p->count = (size_t)count;
    }
    if (!take(c, ',', p->name) || !take_number(c, p->name, &p->fallback) ||
        !take(c, ',', p->name) || !take_text(c, p->name, p->unit, sizeof p->unit) ||
        !take(c, ',', p->name) || !take_number(c, p->name, &p->low) || !take(c, ',', p->name) ||
        !take_number(c, p->name, &p->high) || !take(c, ',', p->name) ||
        !take_text(c, p->name, p->text, sizeof p->text) || !take(c, ')', p->name))
        return false;
    if (!(p->low <= p->fallback && p->fallback <= p->high))
        return refuse(c, "%s: its default %g lies outside its range %g ... %g", p->name,
                      p->fallback, p->low, p->high);
    for (size_t i = 0; i < law->parameters; i++)
        if (strcmp(law->parameter[i].name, p->name) == 0)
            return refuse(c, "PARAMETERS: %s stands there twice", p->name);
    law->numbers += p->count > 0 ? p->count : 1;
    law->parameters++;
    return true;
}

/* Behind the next "# WORD" at the beginning of a line from `at` on, which is no comment; NULL:
 * there is none. */
static const char *find_directive(const char *at, const char *is)
{
    bool begins = true; /* nothing stands before it on its line */
    for (; *at; at++) {
        const char *const end = at[0] == '/' && at[1] == '*' ? strstr(at + 2, "*/") : NULL;
        if (end) {
            at = end + 1;
        } else if (at[0] == '/' && at[1] == '/') {
            at += strcspn(at, "\n") - 1;
        } else if (*at == '"') {
            for (at++; *at && *at != '"' && *at != '\n'; at++)
                at += *at == '\\' && at[1];
            begins = false;
        } else if (*at == '#' && begins) {
            const char *const name = at + 1 + strspn(at + 1, " \t");
            if (strncmp(name, is, strlen(is)) == 0)
                return name + strlen(is);
            begins = false;
        } else {
            begins = *at == '\n' || (begins && strchr(" \t\r", *at));
        }
        if (!*at)
            break;
    }
    return NULL;
}

/* A law is one file, which results hold; headers of the system are the compiler's. */
static bool check_includes(struct cursor *c)
{
    for (const char *at = c->text; (at = find_directive(at, "include"));) {
        const char *const name = at + strspn(at, " \t"), *const end = name + strcspn(name, "\n");
        const bool own = strncmp(name, "\"stance_law.h\"", 14) == 0;
        const size_t length = strcspn(name, ">\n");
        if (own || (*name == '<' && name[length] == '>' && !memchr(name, '/', length)))
            continue;
        c->at = name;
        return refuse(c, "includes %.*s: a law is one file, with stance_law.h and headers of C",
                      (int)(end - name < 60 ? end - name : 60), name);
    }
    return true;
}

static bool read_parameters(struct cursor *c, struct law_file *law)
{
    static const char head[] = "PARAMETERS(";
    char macro[32], name[32];
    for (c->at = c->text; (c->at = find_directive(c->at, "define"));) {
        c->at += strspn(c->at, " \t");
        if (strncmp(c->at, head, strlen(head)) == 0)
            break;
    }
    if (!c->at)
        return true;
    c->at += strlen(head);
    law->parameter = calloc(MOST_ROWS + 1, sizeof *law->parameter);
    if (!law->parameter)
        return problem_no_memory(&c->r->problems);
    if (!take_name(c, macro, sizeof macro) || !take(c, ')', "PARAMETERS"))
        return false;
    for (;;) {
        pass(c);
        if (*c->at == '\n' || *c->at == '\r' || *c->at == '\0' ||
            (c->at[0] == '/' && c->at[1] == '/'))
            return true;
        if (!take_name(c, name, sizeof name))
            return false;
        if (strcmp(name, macro) != 0)
            return refuse(c, "PARAMETERS: %s(...) is expected, not %s", macro, name);
        if (!take(c, '(', "PARAMETERS") || !take_row(c, law))
            return false;
        if (law->numbers > STANCE_PROGRAM_NUMBERS)
            return refuse(c, "PARAMETERS: more than %d numbers", STANCE_PROGRAM_NUMBERS);
    }
}

/* ---- reading --------------------------------------------------------------------------------- */

static bool is_word(const struct tree_node *map, const char *key)
{
    const struct tree_node *const node = tree_find(map, key);
    return node && node->kind == TREE_SCALAR && strcmp(node->text, word) == 0;
}

static bool read_data(struct reader *r, const struct tree_node *data, struct law_file *law)
{
    const struct scenario_field any = {.type = FIELD_NUMBER, .low = -INFINITY, .high = INFINITY};
    if (!field_list(&r->problems, "controller.data", "a list of numbers, or the name of a file",
                    data, MOST_DATA, "numbers"))
        return false;
    law->data = malloc(data->count * sizeof *law->data);
    if (!law->data)
        return problem_no_memory(&r->problems);
    law->data_count = data->count;
    for (size_t i = 0; i < data->count; i++)
        if (!field_number(&r->problems, &any, "controller.data", data->item[i], &law->data[i]))
            return false;
    return true;
}

void law_file_read(struct reader *r)
{
    struct law_file *const law = &r->s->law;
    struct tree_node *const map = tree_find(r->tree.root, "controller");
    if (!map || map->kind != TREE_MAP || !(is_word(map, "kind") || is_word(map, "far")))
        return;
    const struct tree_node *const file = tree_find(map, "file");
    const struct tree_node *const own = tree_find(map, "source"), *const named = file ? file : own;
    struct tree_node *const data = tree_find(map, "data");
    if (!named) {
        problem_add(&r->problems, map->mark, "controller.file is missing (program needs it)");
        return;
    }
    if ((file && file->kind != TREE_SCALAR &&
         !field_mismatch(&r->problems, "controller.file", "text", file)) ||
        (own && own->kind != TREE_SCALAR &&
         !field_mismatch(&r->problems, "controller.source", "text", own)))
        return;
    law->held = own != NULL;
    snprintf(law->name, sizeof law->name, "%s", file ? file->text : "controller.source");
    const char *const text = own ? own->text : reader_file(r, "controller.file", named, MOST_BYTES);
    struct cursor c = {.r = r, .mark = named->mark, .file = law->name};
    if (!text || (!own && !put(r, map, "source", text, true, named->mark)))
        return;
    if (data && data->kind == TREE_SCALAR)
        read_numbers(r, data);
    c.text = law->source = strdup(text);
    if (!law->source) {
        problem_no_memory(&r->problems);
        return;
    }
    if (data && r->problems.count == 0)
        read_data(r, data, law);
    if (check_includes(&c))
        read_parameters(&c, law);
}

void law_file_check(struct reader *r)
{
    const struct law_file *const law = &r->s->law;
    for (size_t i = 0; i < law->parameters; i++) {
        char path[96];
        size_t found = 0;
        snprintf(path, sizeof path, "controller.%s", law->parameter[i].name);
        for (size_t k = 0; k < r->schema->count; k++)
            found += strcmp(r->schema->field[k].path, path) == 0;
        if (found > 1)
            problem_add(&r->problems, r->tree.root->mark,
                        "controller.file: %.200s: its parameter %s is a key that every controller "
                        "has: give it another name",
                        law->name, law->parameter[i].name);
    }
}

void law_file_free(struct law_file *law)
{
    free((char *)(uintptr_t)law->source);
    free(law->data);
    free(law->parameter);
    *law = (struct law_file){0};
}

bool law_file_rows(struct schema *schema, const struct law_file *law)
{
    for (size_t i = 0; i < law->parameters; i++) {
        const struct law_parameter *const p = &law->parameter[i];
        struct scenario_field row = {
            .type = FIELD_NUMBER,
            .use = USE_PROGRAM,
            .sweep = true,
            .offset = offsetof(struct scenario_values, parameter) + p->place * sizeof(double),
            .fallback = p->fallback,
            .low = p->low,
            .high = p->high,
            .items = p->count,
            .fewer = true, /* those that are not given are as by default */
            .path = "controller.*",
        };
        snprintf(row.unit, sizeof row.unit, "%s", p->unit[0] ? p->unit : "1");
        snprintf(row.text, sizeof row.text, "%s", p->text);
        struct scenario_field *const field = schema_add(schema, &row, "%s", p->name);
        if (!field || (p->count > 0 && (!schema_group(field, FIELD_NUMBERS, "%s", row.text) ||
                                        !schema_add(schema, &row, "%s[]", p->name))))
            return false;
    }
    return true;
}
