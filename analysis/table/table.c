/* table.c - see table.h. */
#include "table.h"

#include "runner/base/words.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELL = 512, MOST_SEEN = 64 };

static const size_t HEAD = SIZE_MAX; /* for a row: the names or headings */

/* ---- building ----------------------------------------------------------------------------- */

/* Room for `need` items in an array that doubles. NULL: no memory, the array stays. */
static void *grow(void *list, size_t *room, size_t need, size_t size)
{
    const size_t wanted = need > *room ? 2 * need : *room;
    void *longer = wanted > *room ? realloc(list, wanted * size) : list;
    *room = longer ? wanted : *room;
    return longer;
}

static bool keep_text(struct table *t, struct table_value *value)
{
    const size_t size = strlen(value->text) + 1;
    char *letter = grow(t->letter, &t->letter_rooms, t->letters + size, 1);
    if (!letter)
        return false;
    t->letter = letter;
    memcpy(letter + t->letters, value->text, size);
    value->whole = t->letters;
    t->letters += size;
    return true;
}

void table_columns(struct table *t, const struct table_column *column, size_t count)
{
    struct table_column *longer =
        t->failed ? NULL : realloc(t->column, (t->columns + count) * sizeof *longer);
    t->failed = longer == NULL;
    t->column = longer ? longer : t->column;
    for (size_t k = 0; !t->failed && k < count; k++) {
        struct table_column *own = &t->column[t->columns++];
        *own = column[k];
        own->name = own->name ? strdup(own->name) : NULL;
        own->heading = own->heading ? strdup(own->heading) : NULL;
        t->failed = (column[k].name && !own->name) || (column[k].heading && !own->heading);
    }
}

void table_values(struct table *t, const struct table_value *value, size_t count)
{
    struct table_value *cell =
        t->failed ? NULL : grow(t->cell, &t->rooms, t->cells + count, sizeof *cell);
    t->failed = cell == NULL;
    t->cell = cell ? cell : t->cell;
    for (size_t k = 0; k < count; k++) {
        struct table_value own = value[k];
        t->failed = t->failed || (own.text && !keep_text(t, &own));
        if (t->failed)
            json_decref(own.tree);
        else
            cell[t->cells++] = own;
    }
}

void table_facts(struct table *t, const struct table_fact *fact, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        struct table_column column = fact[k].column;
        column.hidden |= fact[k].value.kind == TABLE_TREE ? TABLE_NO_CSV : 0;
        if (!t->closed)
            table_columns(t, &column, 1);
        table_values(t, &fact[k].value, 1);
    }
}

void table_end_row(struct table *t)
{
    t->closed = true;
    assert(t->failed || t->cells % t->columns == 0);
}

void table_axes(struct table *t, const struct results *r, const int *axis, int count,
                const size_t *point)
{
    TABLE_FACTS(t, {{.group = "at"}, as_nothing(NULL)}); /* there, even if it is empty */
    for (int k = 0; k < count; k++) {
        const struct results_axis *along = &r->axis[axis[k]];
        TABLE_FACTS(t, {{along->name, along->name, .width = 16, .group = "at"},
                        as_place(along, point[axis[k]])});
    }
}

size_t table_rows(const struct table *t)
{
    return t->columns ? t->cells / t->columns : 0;
}

void table_clear(struct table *t)
{
    for (size_t k = 0; k < t->cells; k++)
        json_decref(t->cell[k].tree);
    t->cells = t->letters = 0;
    t->begun = true;
}

void table_free(struct table *t)
{
    table_clear(t);
    for (size_t k = 0; k < t->columns; k++) {
        free((char *)t->column[k].name);
        free((char *)t->column[k].heading);
    }
    free(t->column);
    free(t->cell);
    free(t->letter);
    *t = (struct table){0};
}

static const struct table_value *cell_at(const struct table *t, size_t row, size_t column)
{
    return &t->cell[row * t->columns + column];
}

static const char *cell_text(const struct table *t, const struct table_value *cell)
{
    return cell->text ? t->letter + cell->whole : NULL;
}

static struct table_value at_place(const struct table_value *value)
{
    const struct results_axis *axis = value->axis;
    return axis->word ? as_text(axis->word[value->whole]) : as_number(axis->value[value->whole]);
}

/* What programs get: a word or a number of a point, the text itself. */
static struct table_value plain(const struct table *t, const struct table_value *cell)
{
    struct table_value value = cell->kind == TABLE_PLACE ? at_place(cell) : *cell;
    if (cell->kind == TABLE_TEXT)
        value.text = t->letter + cell->whole;
    assert(value.kind != TABLE_TEXT || value.text);
    return value;
}

/* ---- text --------------------------------------------------------------------------------- */

/* False: there is nothing. */
static bool print_value(const struct table *t, const struct table_column *column,
                        const struct table_value *cell, char *text, size_t size)
{
    const double scale = column->percent ? 100 : 1;
    const char *words = cell_text(t, cell);
    text[0] = '\0';
    if (words)
        snprintf(text, size, "%s", words);
    else if (cell->kind == TABLE_NUMBER && isfinite(cell->number))
        snprintf(text, size, column->format ? column->format : "%.6g", scale * cell->number);
    else if (cell->kind == TABLE_WHOLE && column->format)
        snprintf(text, size, column->format, scale * (double)cell->whole);
    else if (cell->kind == TABLE_WHOLE)
        snprintf(text, size, "%" PRIu64, cell->whole);
    else if (cell->kind == TABLE_PLACE)
        results_value_text(cell->axis, cell->whole, false, text, size);
    else
        return false;
    results_clean(text);
    return true;
}

/* Letters of UTF-8. */
static int letters(const char *text)
{
    int count = 0;
    for (; *text; text++)
        count += (*text & 0xc0) != 0x80;
    return count;
}

/* The columns of a view. */
struct seen {
    size_t count, column[MOST_SEEN];
    int width[MOST_SEEN]; /* letters */
    bool headed;          /* there is a heading */
};

/* The heading of the k-th column seen (row HEAD), or its cell with those that are joined to it.
 * False: the column has none. */
static bool seen_text(const struct table *t, const struct seen *seen, size_t row, size_t k,
                      char text[CELL])
{
    const struct table_column *column = &t->column[seen->column[k]];
    if (column->joined || (row == HEAD && !column->heading))
        return false;
    if (row == HEAD)
        snprintf(text, CELL, "%s", column->heading);
    const bool any =
        row == HEAD || print_value(t, column, cell_at(t, row, seen->column[k]), text, CELL);
    if (!any)
        snprintf(text, CELL, "%s", column->empty ? column->empty : "-");
    while (row != HEAD && ++k < seen->count && t->column[seen->column[k]].joined) {
        char more[CELL];
        const size_t used = strlen(text);
        column = &t->column[seen->column[k]];
        const bool has =
            print_value(t, column, cell_at(t, row, seen->column[k]), more, sizeof more);
        if (!has && any && column->empty)
            snprintf(more, sizeof more, "%s", column->empty);
        if (has || (any && column->empty))
            snprintf(text + used, CELL - used, "%s%s", column->before ? column->before : "", more);
    }
    return true;
}

/* Row i of those shown, both ends among them. */
static size_t spread(size_t i, size_t shown, size_t rows)
{
    return shown == rows || shown < 2 ? i : i * (rows - 1) / (shown - 1);
}

static void see(const struct table *t, const char *view, struct seen *seen, size_t shown)
{
    char text[CELL];
    *seen = (struct seen){0};
    for (size_t length; *view; view += length + (view[length] != '\0')) {
        length = strcspn(view, " ");
        const bool group = length > 0 && view[length - 1] == '/';
        const size_t size = length - group;
        for (size_t k = 0; k < t->columns && seen->count < MOST_SEEN; k++) {
            const struct table_column *column = &t->column[k];
            const char *word = group ? column->group : column->name;
            if (column->name && word && strncmp(word, view, size) == 0 && !word[size])
                seen->column[seen->count++] = k;
        }
    }
    for (size_t k = 0; k < seen->count; k++) {
        int width = t->column[seen->column[k]].width;
        seen->headed = seen->headed || t->column[seen->column[k]].heading;
        for (size_t i = 0; i < shown + 1; i++) {
            const size_t row = i == shown ? HEAD : spread(i, shown, table_rows(t));
            if (seen_text(t, seen, row, k, text) && letters(text) > width)
                width = letters(text);
        }
        seen->width[k] = width;
    }
}

/* Without blanks at its end; row HEAD: the headings. False: no memory. */
static bool print_line(const struct table *t, const struct seen *seen, size_t row, FILE *out)
{
    char text[CELL], *line = NULL;
    size_t size = 0;
    FILE *const to = open_memstream(&line, &size);
    for (size_t k = 0; to && k < seen->count; k++) {
        const struct table_column *column = &t->column[seen->column[k]];
        if (!seen_text(t, seen, row, k, text))
            continue;
        const int fill = seen->width[k] - letters(text);
        fprintf(to, "%s%*s%s%*s",
                column->before ? column->before
                : k            ? " "
                               : "  ",
                column->left ? 0 : fill, "", text, column->left ? fill : 0, "");
    }
    const bool good = to && fclose(to) == 0;
    while (good && size > 0 && line[size - 1] == ' ')
        size--;
    if (good)
        fprintf(out, "%.*s\n", (int)size, line);
    free(line);
    return good;
}

bool table_write_text(const struct table *t, FILE *out, const char *view, size_t most)
{
    const size_t rows = table_rows(t), shown = most == 0 || rows < most ? rows : most;
    bool good = !t->failed;
    struct seen seen;
    see(t, view, &seen, shown);
    if (seen.headed && !t->begun)
        good = print_line(t, &seen, HEAD, out) && good;
    for (size_t i = 0; good && i < shown; i++)
        good = print_line(t, &seen, spread(i, shown, rows), out);
    if (shown < rows)
        fprintf(out, "  (%zu of %zu rows; --csv and --json have them all)\n", shown, rows);
    return good && !ferror(out);
}

/* ---- CSV ---------------------------------------------------------------------------------- */

static void csv_text(FILE *out, const char *text)
{
    const bool quoted = strpbrk(text, ",\"\r\n") != NULL;
    if (quoted)
        putc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            putc('"', out);
        putc(*text, out);
    }
    if (quoted)
        putc('"', out);
}

/* As short as gives the same number again. */
static void csv_number(FILE *out, double value)
{
    enum { SURE = 15, MOST = 17 }; /* digits that may be enough, that always are */
    char text[40] = "";
    for (int digits = SURE; digits <= MOST && !isnan(value); digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    fputs(text, out);
}

static void csv_row(const struct table *t, size_t row, FILE *out)
{
    bool inside = false;
    for (size_t k = 0; k < t->columns; k++) {
        if (!t->column[k].name || t->column[k].name[0] == '.' || t->column[k].hidden & TABLE_NO_CSV)
            continue;
        if (inside)
            putc(',', out);
        inside = true;
        const struct table_value value =
            row == HEAD ? as_text(t->column[k].name) : plain(t, cell_at(t, row, k));
        if (value.kind == TABLE_TEXT)
            csv_text(out, value.text);
        else if (value.kind == TABLE_NUMBER)
            csv_number(out, value.number);
        else if (value.kind == TABLE_WHOLE)
            fprintf(out, "%" PRIu64, value.whole);
    }
    fputs("\r\n", out);
}

bool table_write_csv(const struct table *t, FILE *out)
{
    if (!t->begun)
        csv_row(t, HEAD, out);
    for (size_t row = 0; row < table_rows(t); row++)
        csv_row(t, row, out);
    return !t->failed && !ferror(out);
}

/* ---- JSON --------------------------------------------------------------------------------- */

static json_t *json_text(const char *text)
{
    json_t *string = json_string(text);
    char *clean = string ? NULL : strdup(text);
    if (clean) {
        results_clean(clean);
        string = json_string(clean);
        free(clean);
    }
    return string;
}

/* NULL: no memory. */
static json_t *json_of(const struct table_value *value)
{
    switch (value->kind) {
    case TABLE_TEXT:
        return json_text(value->text);
    case TABLE_NUMBER:
        return isfinite(value->number) ? json_real(value->number) : json_null();
    case TABLE_WHOLE:
        return json_integer((json_int_t)value->whole);
    case TABLE_TREE:
        return value->tree ? json_incref(value->tree) : json_null();
    default:
        return json_null();
    }
}

/* NULL: no memory. */
static json_t *json_row(const struct table *t, size_t row)
{
    json_t *object = json_object();
    bool good = object != NULL;
    for (size_t k = 0; good && k < t->columns; k++) {
        const struct table_column *column = &t->column[k];
        const struct table_value value = plain(t, cell_at(t, row, k));
        if (column->hidden & TABLE_NO_JSON)
            continue;
        json_t *inner = column->group ? json_object_get(object, column->group) : object;
        if (!inner && json_object_set_new(object, column->group, json_object()) == 0)
            inner = json_object_get(object, column->group);
        good = inner && (!column->name ||
                         json_object_set_new(inner, column->key ? column->key : column->name,
                                             json_of(&value)) == 0);
    }
    if (!good)
        json_decref(object);
    return good ? object : NULL;
}

json_t *table_json(const struct table *t, bool by_name)
{
    json_t *root = by_name ? json_object() : json_array();
    bool good = root && !t->failed;
    for (size_t row = 0; good && row < table_rows(t); row++) {
        json_t *object = json_row(t, row);
        good = (by_name ? json_object_set_new(root, cell_text(t, cell_at(t, row, 0)), object)
                        : json_array_append_new(root, object)) == 0;
    }
    if (!good)
        json_decref(root);
    return good ? root : NULL;
}

json_t *table_value_json(struct table_value value)
{
    const struct table_value place = value.kind == TABLE_PLACE ? at_place(&value) : value;
    json_t *json = json_of(&place);
    json_decref(value.tree);
    return json;
}

json_t *table_list(const char *const *text, size_t count)
{
    json_t *const list = text ? json_array() : NULL;
    for (size_t i = 0; text && i < count; i++)
        table_append(list, as_text(text[i]));
    return list;
}

json_t *table_pair(double low, double high)
{
    json_t *const list = json_array();
    table_append(list, as_number(low));
    table_append(list, as_number(high));
    return list;
}

json_t *table_at(const struct results *r, const bool *which, const size_t *point)
{
    json_t *at = json_object();
    for (int a = 0; a < r->axes; a++)
        if (!which || which[a])
            table_put(at, r->axis[a].name, as_place(&r->axis[a], point[a]));
    return at;
}

void table_at_text(const struct results *r, const bool *which, const size_t *point, char *text,
                   size_t size)
{
    char value[128];
    text[0] = '\0';
    for (int a = 0; a < r->axes; a++) {
        if (which[a]) {
            results_value_text(&r->axis[a], point[a], true, value, sizeof value);
            words_add(text, size, "%s%s = %s", text[0] ? ", " : "", r->axis[a].name, value);
        }
    }
}

void table_put(json_t *object, const char *key, struct table_value value)
{
    char shown[128], text[128];
    if (value.kind == TABLE_PLACE) {
        snprintf(shown, sizeof shown, ".%s", key);
        results_value_text(value.axis, value.whole, true, text, sizeof text);
        table_put(object, shown, as_text(text));
    }
    json_object_set_new(object, key, table_value_json(value));
}

json_t *table_object(const struct table_member *member, size_t count)
{
    json_t *object = json_object();
    for (size_t k = 0; k < count; k++)
        table_put(object, member[k].key, member[k].value);
    return object;
}

json_t *table_show(json_t *facts, const char *key, const struct table *t, const char *view,
                   size_t most)
{
    char shown[64], *text = NULL;
    size_t size;
    bool good = !t->failed;
    FILE *const to = view ? open_memstream(&text, &size) : NULL;
    if (to) {
        table_write_text(t, to, view, most);
        fclose(to);
        snprintf(shown, sizeof shown, ".%s", key + (key[0] == '.'));
        good = json_object_set_new(facts, shown, json_string(text)) == 0 && good;
        free(text);
    }
    if (key[0] != '.')
        good = json_object_set_new(facts, key, table_json(t, t->named)) == 0 && good;
    if (!good)
        json_decref(facts);
    return good ? facts : NULL;
}

bool table_give(json_t *facts, const char *key, struct table *t, const char *view, size_t most)
{
    json_t *const same = table_show(json_incref(facts), key, t, view, most);
    table_free(t);
    json_decref(same);
    return same != NULL;
}

bool table_say(enum table_form form, json_t *facts, const char *text, struct table *csv)
{
    const bool good = form == TABLE_AS_CSV
                          ? table_write_csv(csv, stdout)
                          : say_facts(json_incref(facts), form == TABLE_AS_JSON, text, stdout);
    json_decref(facts);
    table_free(csv);
    return good;
}

bool table_write_json(json_t *root, FILE *out)
{
    return say_facts(root, true, NULL, out);
}
