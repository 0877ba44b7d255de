/* say.c - see say.h. */
#include "say.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Where names are looked for: in what a loop knows of its item, in the item, then around it. */
struct scope {
    const struct scope *outer;
    json_t *own, *here;
};

/* ---- values ------------------------------------------------------------------------------- */

static json_t *member(json_t *of, const char *name, size_t length)
{
    char word[96];
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    return json_is_array(of) ? json_array_get(of, strtoul(word, NULL, 10))
                             : json_object_get(of, word);
}

/* NULL: there is none. */
static json_t *find(const struct scope *scope, const char *path, size_t size)
{
    const size_t first = strcspn(path, "/") < size ? strcspn(path, "/") : size;
    json_t *found = NULL;
    for (; scope && !found; scope = scope->outer) {
        found = member(scope->own, path, first);
        found = found ? found : member(scope->here, path, first);
    }
    for (size_t at = first, length; found && at < size; at += length) {
        length = strcspn(path + ++at, "/");
        length = length < size - at ? length : size - at;
        found = member(found, path + at, length);
    }
    return found;
}

static bool is_there(const json_t *value)
{
    return json_is_number(value)   ? json_number_value(value) != 0
           : json_is_string(value) ? json_string_length(value) > 0
           : json_is_array(value)  ? json_array_size(value) > 0
           : json_is_object(value) ? json_object_size(value) > 0
                                   : json_is_true(value);
}

/* In "%-12d" what stands between the percent sign and the letter. */
static void put_value(const struct scope *scope, const json_t *value, const char *format,
                      size_t length, FILE *out)
{
    const bool hundredfold = length > 0 && format[0] == '*';
    const double number = (hundredfold ? 100 : 1) * json_number_value(value);
    char spec[32], own[64];
    const char *text = own;
    snprintf(spec, sizeof spec, "%.*s", (int)length - hundredfold, format + hundredfold);
    const size_t last = strlen(spec) > 0 ? strlen(spec) - 1 : 0;
    if (json_is_string(value))
        text = json_string_value(value);
    else if (json_is_number(value) && last > 0 && strchr("efg", spec[last]))
        snprintf(own, sizeof own, spec, number);
    else if (json_is_integer(value) && !hundredfold)
        snprintf(own, sizeof own, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    else if (json_is_number(value))
        snprintf(own, sizeof own, "%.6g", number);
    else
        text = "";
    const size_t flags = strspn(spec, "%-+");
    const int width =
        spec[flags] == '*' ? (int)json_integer_value(find(scope, ".width", 6)) : atoi(spec + flags);
    fprintf(out, "%*s", strchr(spec, '-') ? -width : width, text);
}

/* ---- texts -------------------------------------------------------------------------------- */

/* Where the first of some letters stands that is in no inner bracket; the end: nowhere. */
static const char *stop_at(const char *text, const char *end, const char *letters)
{
    for (int depth = 0; text < end && (depth > 0 || !strchr(letters, *text)); text++) {
        depth += *text == '[' ? 1 : *text == ']' ? -1 : 0;
        text += *text == '\\';
    }
    return text < end ? text : end;
}

/* Whether what is asked in "PATH", "PATH=...", "PATH<..." or "PATH>..." is so. */
static bool holds(const struct scope *scope, const char *path, size_t length, const char *end)
{
    json_t *const value = find(scope, path, length);
    char word[64];
    if (path + length >= end)
        return is_there(value);
    snprintf(word, sizeof word, "%.*s", (int)(end - path - (ptrdiff_t)length - 1),
             path + length + 1);
    if (json_is_string(value))
        return strcmp(json_string_value(value), word) == 0;
    const double is = json_number_value(value), than = strtod(word, NULL);
    return json_is_number(value) && (path[length] == '='   ? is == than
                                     : path[length] == '<' ? is < than
                                                           : is > than);
}

static void put_text(const struct scope *scope, const char *text, const char *end, FILE *out);

static void put_all(const struct scope *scope, json_t *of, const char *const between[2],
                    const char *const text[2], FILE *out)
{
    const bool list = json_is_array(of);
    const size_t count = list ? json_array_size(of) : json_object_size(of);
    void *at = list ? NULL : json_object_iter(of);
    for (size_t i = 0; i < count; i++, at = list ? NULL : json_object_iter_next(of, at)) {
        json_t *const here = list ? json_array_get(of, i) : json_object_iter_value(at);
        const struct scope inner = {scope,
                                    json_pack("{s:O, s:I, s:s}", "value", here, "i", (json_int_t)i,
                                              "key", list ? "" : json_object_iter_key(at)),
                                    here};
        put_text(&inner, text[0], text[1], out);
        if (i + 1 < count)
            put_text(&inner, between[0], between[1], out);
        json_decref(inner.own);
    }
}

/* What stands in brackets, from the first letter behind "[" to that behind "]". */
static void put_bracket(const struct scope *scope, const char *text, const char *end, FILE *out)
{
    const bool no = *text == '!';
    const char *const path = text + no, *const head = stop_at(path, end, ":"),
                      *const then = head < end ? head + 1 : end,
                      *const bar = stop_at(then, end, "|"),
                      *const otherwise = bar < end ? bar + 1 : end;
    const size_t length = strcspn(path, "*=<>:");
    json_t *const value = find(scope, path, length);
    const struct scope inner = {scope, NULL, json_is_object(value) ? value : NULL};
    if (path[length] == '*' && is_there(value))
        put_all(scope, value, (const char *const[]){path + length + 1, head},
                (const char *const[]){then, bar}, out);
    else if (path[length] != '*' && holds(scope, path, length, head) != no)
        put_text(&inner, then, bar, out);
    else
        put_text(scope, otherwise, end, out);
}

static void put_text(const struct scope *scope, const char *text, const char *end, FILE *out)
{
    for (const char *stop; text < end; text = stop) {
        if (*text == '[') {
            stop = stop_at(text + 1, end, "]");
            put_bracket(scope, text + 1, stop++, out);
        } else if (*text == '{') {
            stop = text + strcspn(text, "}") + 1;
            const size_t length = strcspn(++text, "*%#}");
            json_t *const value = find(scope, text, length);
            if (text[length] != '#')
                put_value(scope, value, text + length, (size_t)(stop - text) - length - 1, out);
            else if (json_number_value(value) != 1)
                fwrite(text + length + 1, 1, (size_t)(stop - text) - length - 2, out);
        } else {
            text += *text == '\\';
            stop = text + 1;
            putc(*text, out);
        }
    }
}

void say_add(json_t *facts, const char *key, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    json_t *const more = json_vsprintf(format, arguments), *const text =
                                                               json_object_get(facts, key);
    va_end(arguments);
    json_object_set_new(facts, key,
                        json_sprintf("%s%s", text ? json_string_value(text) : "",
                                     more ? json_string_value(more) : ""));
    json_decref(more);
}

/* ---- keys --------------------------------------------------------------------------------- */

static void put_keys(const struct say_key *key, bool inner, FILE *out)
{
    const char *const line = inner ? ", " : "\n    ", *before = inner ? "" : "    ";
    for (; key->name || key->text; key++) {
        const bool consists = key->text && (key->text[0] == '[' || key->text[0] == '{');
        if (!key->text)
            continue;
        if (!key->name) {
            fprintf(out, "%s%s%s", key->text[0] ? "  " : "", key->text, key->text[0] ? "\n" : "");
            say_keys(key->of, out);
            continue;
        }
        fprintf(out, "%s%s", key->of && before[0] == ',' ? line : before, key->name);
        if (key->of) {
            fputs(inner ? ": {" : "    [{", out);
            put_keys(key->of, true, out);
            fprintf(out, "}%s%s%s", inner ? "" : "]", key->text[0] ? "; " : "", key->text);
        } else {
            fprintf(out, consists ? ": %s" : key->text[0] ? " (%s)" : "%s", key->text);
        }
        before = key->of ? line : ", ";
    }
}

void say_keys(const struct say_key *key, FILE *out)
{
    put_keys(key, false, out);
    fputs(key->name ? "\n" : "", out);
}

/* ---- JSON --------------------------------------------------------------------------------- */

static void drop_hidden(json_t *of)
{
    const char *key;
    json_t *value;
    void *next;
    size_t i;
    json_object_foreach_safe(of, next, key, value)
    {
        if (key[0] == '.')
            json_object_del(of, key);
        else
            drop_hidden(value);
    }
    json_array_foreach(of, i, value) drop_hidden(value);
}

bool say_facts(json_t *facts, bool json, const char *text, FILE *out)
{
    const struct scope scope = {NULL, NULL, facts};
    bool good = facts != NULL;
    if (json) {
        drop_hidden(facts);
        good = good && json_dumpf(facts, out, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
        putc('\n', out);
    } else if (good) {
        put_text(&scope, text, text + strlen(text), out);
    }
    json_decref(facts);
    return good && !ferror(out);
}
