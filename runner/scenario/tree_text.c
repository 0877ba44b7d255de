/* tree_text.c - the characters of a tree: which a text may hold, and how nodes are written back. */
#include "tree.h"

#include "runner/base/words.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- characters ------------------------------------------------------------------------------ */

/* What YAML lets stand in a text as it is. */
static bool printable(uint32_t c)
{
    return c == '\t' || c == '\n' || c == '\r' || (c >= 0x20 && c < 0x7f) || c == 0x85 ||
           (c >= 0xa0 && c != 0xfeff && c != 0xfffe && c != 0xffff);
}

bool tree_check_text(const char *text, size_t length, struct problems *problems)
{
    struct mark mark = {0, 1, 1};
    for (size_t i = 0; i < length;) {
        uint32_t c = 0;
        size_t n = utf8_letter(text + i, length - i, &c);
        if (n == 0) {
            return problem_add(problems, mark, "not UTF-8 text (byte 0x%02x)",
                               (unsigned char)text[i]);
        }
        bool blank;
        const char *const hidden = hidden_letter(c, &blank);
        if (!printable(c) && !(i == 0 && c == 0xfeff)) {
            if (hidden)
                return problem_add(problems, mark,
                                   "U+%04X (%s) stands here and cannot be seen; remove it", c,
                                   hidden);
            return problem_add(problems, mark, "not text: the control character U+%04X stands here",
                               c);
        }
        i += n;
        mark.column++;
        if (c == '\n') {
            mark.line++;
            mark.column = 1;
        }
    }
    return true;
}

/* The line about text[at], without blanks around it, as it is without letters that cannot be seen.
 * False: it is too long to be shown. */
static bool mended_line(const char *text, size_t length, size_t at, char line[160])
{
    size_t n = 0;
    while (at > 0 && text[at - 1] != '\n')
        at--;
    while (at < length && text[at] != '\n' && text[at] != '\r') {
        uint32_t c = 0;
        bool blank = true;
        const size_t letter = utf8_letter(text + at, length - at, &c);
        if (letter == 0 || n + letter >= 160)
            return false;
        const bool hidden = hidden_letter(c, &blank);
        const char *const from = text + at;
        at += letter;
        if (hidden && blank && n > 0 && at < length && !strchr(" ,]}", text[at]))
            line[n++] = ' ';
        else if (!hidden && !(n == 0 && c == ' '))
            memcpy(line + n, from, letter), n += letter;
    }
    while (n > 0 && line[n - 1] == ' ')
        n--;
    line[n] = '\0';
    return true;
}

/* What stands around a letter: whether it is text that may hold anything. */
struct surroundings {
    char quote; /* that it stands in; 0: none */
    bool comment, title, escaped;
    char before;
};

static void pass(struct surroundings *in, const char *at)
{
    const bool begins = strchr(" \t\n[{,:(=", in->before) != NULL;
    if (*at == '\n')
        in->comment = in->title = false;
    if (in->quote && in->escaped)
        in->escaped = false;
    else if (in->quote == '"' && *at == '\\')
        in->escaped = true;
    else if (in->quote && *at == in->quote)
        in->quote = '\0';
    else if (!in->quote && !in->comment && strchr("\"'", *at) && (begins || in->before == *at))
        in->quote = *at; /* two of them in quotes are one */
    else if (!in->quote && begins && *at == '#')
        in->comment = true;
    in->title |= begins && strncmp(at, "title: ", 7) == 0;
    in->before = *at;
}

void tree_find_hidden(const char *text, size_t length, int set, struct problems *hidden)
{
    struct surroundings in = {.before = '\n'};
    struct mark mark = {set, 1, 1};
    bool said = strncmp(text, "title=", 6) == 0; /* of this line, or in no need of it */
    for (size_t i = 0; i < length;) {
        uint32_t c = 0;
        bool blank;
        const size_t n = utf8_letter(text + i, length - i, &c);
        const char *const name = hidden_letter(c, &blank);
        char line[160];
        if (name && !said && i > 0 && !in.quote && !in.comment && !in.title) {
            const bool whole = mended_line(text, length, i, line);
            problem_add(hidden, mark, "U+%04X (%s) %s %d%s%s%s", c, name,
                        set ? "is letter" : "stands in column", mark.column,
                        blank ? ": it is no blank" : ": it cannot be seen", whole ? "; write " : "",
                        whole ? line : "");
            said = true;
        }
        pass(&in, text + i);
        i += n ? n : 1;
        mark.column++;
        if (c == '\n') {
            said = false;
            mark.line++;
            mark.column = 1;
        }
    }
}

bool tree_name_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
}

/* ---- writing --------------------------------------------------------------------------------- */

enum { WRITE_WIDTH = 96 };

struct writer {
    FILE *out;
    int column;
};

static void put(struct writer *w, const char *text)
{
    fputs(text, w->out);
    w->column += (int)strlen(text);
}

static void new_line(struct writer *w, int indent)
{
    fprintf(w->out, "\n%*s", indent, "");
    w->column = indent;
}

/* What is no more than a letter in any text; line ends and tabs are not. */
static bool is_letter(uint32_t c)
{
    return c >= 0x20 && printable(c) && c != 0x85 && c != 0x2028 && c != 0x2029;
}

/* Whether a plain scalar reads back as itself in every context; all numbers do. */
static bool safe_plain(const char *text)
{
    size_t n = 0;
    for (; text[n]; n++)
        if (!tree_name_letter(text[n]) && text[n] != '.' && text[n] != '+')
            return false;
    return n > 0 && !(text[0] == '-' && (n == 1 || text[1] == '-')) && strcmp(text, "...") != 0;
}

static void write_scalar(struct writer *w, const struct tree_node *node)
{
    size_t left = strlen(node->text);
    const char *s = node->text;
    char escape[16];

    if (!node->quoted && safe_plain(node->text)) {
        put(w, node->text);
        return;
    }
    put(w, "\"");
    while (left > 0) {
        uint32_t c = 0xfffd;
        size_t n = utf8_letter(s, left, &c);
        n = n ? n : 1;
        if (c == '"' || c == '\\')
            snprintf(escape, sizeof escape, "\\%c", (char)c);
        else if (!is_letter(c) || c == 0xa0)
            snprintf(escape, sizeof escape, "\\U%08X", c);
        else
            snprintf(escape, sizeof escape, "%.*s", (int)n, s);
        put(w, escape);
        s += n;
        left -= n;
    }
    put(w, "\"");
}

static void write_flow(struct writer *w, const struct tree_node *node, int indent)
{
    if (node->kind == TREE_SCALAR) {
        write_scalar(w, node);
        return;
    }
    put(w, node->kind == TREE_LIST ? "[" : "{");
    for (size_t i = 0; i < node->count; i++) {
        if (i > 0) {
            put(w, ",");
            if (w->column > WRITE_WIDTH - 10)
                new_line(w, indent + 4);
            else
                put(w, " ");
        }
        if (node->kind == TREE_MAP) {
            put(w, node->key[i].name);
            put(w, ": ");
        }
        write_flow(w, node->item[i], indent);
    }
    put(w, node->kind == TREE_LIST ? "]" : "}");
}

/* Whether a text of several lines reads back as itself as a block. */
static bool suits_block(const struct tree_node *node)
{
    const char *s = node->kind == TREE_SCALAR && node->quoted ? node->text : "";
    size_t left = strlen(s);
    const bool lines = strchr(s, '\n') != NULL;
    while (left > 0) {
        uint32_t c = 0;
        const size_t n = utf8_letter(s, left, &c);
        if (n == 0 || (c != '\n' && c != '\t' && !is_letter(c)))
            return false;
        s += n;
        left -= n;
    }
    return lines;
}

/* Its indentation is said, as it may begin with blanks; "-", "+": it ends in none, or in more than
 * one line end. */
static void write_block(struct writer *w, const char *text, int indent)
{
    const size_t length = strlen(text);
    const bool ends = text[length - 1] == '\n',
               more = ends && length > 1 && text[length - 2] == '\n';
    fprintf(w->out, "|2%s", !ends ? "-" : more || length == 1 ? "+" : "");
    for (const char *line = text; *line;) {
        const size_t n = strcspn(line, "\n");
        fprintf(w->out, "\n%*s%.*s", n > 0 ? indent : 0, "", (int)n, line);
        line += n + (line[n] == '\n');
    }
}

/* Mappings as blocks, one key a line; mappings inside lists on one line. */
static void write_map(struct writer *w, const struct tree_node *map, int indent)
{
    for (size_t i = 0; i < map->count; i++) {
        const struct tree_node *item = map->item[i];
        if (i > 0)
            new_line(w, indent);
        put(w, map->key[i].name);
        put(w, ":");
        if (item->kind == TREE_MAP && item->count > 0) {
            new_line(w, indent + 2);
            write_map(w, item, indent + 2);
        } else if (item->kind == TREE_LIST && item->count > 0 && item->item[0]->kind == TREE_MAP) {
            for (size_t k = 0; k < item->count; k++) {
                new_line(w, indent + 2);
                put(w, "- ");
                write_flow(w, item->item[k], indent + 2);
            }
        } else if (suits_block(item)) {
            put(w, " ");
            write_block(w, item->text, indent + 2);
        } else {
            put(w, " ");
            write_flow(w, item, indent + 2);
        }
    }
}

char *tree_write(const struct tree_node *root)
{
    char *text = NULL;
    size_t size = 0;
    struct writer w = {.out = open_memstream(&text, &size)};
    if (!w.out)
        return NULL;
    write_map(&w, root, 0);
    fputc('\n', w.out);
    if (fclose(w.out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}
