/* describe.c - documentation of the scenario format, and its JSON Schema, from the table. */
#include "mechanism.h"
#include "schema_mechanism.h"
#include "tree.h"

#include "runner/base/words.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 78, TEXT_INDENT = 4 };

/* ---- text ------------------------------------------------------------------------------------ */

/* Prints words, broken at WIDTH. */
static void print_wrapped(FILE *out, const char *text)
{
    words_fill(out, text, strlen(text), 0, TEXT_INDENT, WIDTH);
    fputc('\n', out);
}

static const char *default_text(const struct scenario_field *field, char *buffer, size_t size)
{
    const bool known = !isnan(field->fallback);
    buffer[0] = '\0';
    if (field->fallback_text)
        snprintf(buffer, size, ", default: %s", field->fallback_text);
    else if (field->required)
        snprintf(buffer, size, ", required");
    else if (known && (field->type == FIELD_WORD || field->type == FIELD_CASES))
        snprintf(buffer, size, ", default %s", field->words[(size_t)field->fallback]);
    else if (known && (field->type == FIELD_NUMBER || field->type == FIELD_INTEGER))
        snprintf(buffer, size, ", default %.9g", field->fallback);
    return buffer;
}

/* How many items a list has; of any mechanism it is not known. */
static const char *count_text(size_t count, char text[24])
{
    snprintf(text, 24, "%zu", count);
    return count ? text : "some";
}

static const char *kind_text(const struct scenario_field *field, char *buffer, size_t size)
{
    static const struct {
        const char *before, *after; /* of the words, where there are any */
    } text[] = {
        [FIELD_MAP] = {"mapping", ""},
        [FIELD_TEXT] = {"text", ""},
        [FIELD_NUMBER] = {"number", ", or "},
        [FIELD_INTEGER] = {"whole number", ", or "},
        [FIELD_WORD] = {"one of: ", ""},
        [FIELD_WORDS] = {"list of: ", ""},
        [FIELD_MAP_OR_WORD] = {"mapping, or ", ""},
        [FIELD_CASES] = {"one of: ", "; or a list of cases"},
        [FIELD_AXES] = {"list of mappings", ""},
        [FIELD_FACTORS] = {"list of mappings", ""},
        [FIELD_VARIED] = {"one of: ", "; or a list of these and of mappings"},
        [FIELD_ENDS] = {"number, or list of numbers", ""},
        [FIELD_DATA] = {"list of numbers, or the name of a file", ""},
        [FIELD_PATH] = {"path", ""},
        [FIELD_VALUES] = {"list of numbers, words or lists of these", ""},
    };
    char range[96], words[400] = "", count[2][24];
    const char *unit = strcmp(field->unit, "1") != 0 ? field->unit : "";

    word_list(words, sizeof words, field->words, field->word_count);
    schema_range_text(field, range, sizeof range);
    switch (field->type) {
    case FIELD_NUMBER:
    case FIELD_INTEGER:
        snprintf(buffer, size, "%s, %s%s%s%s%s",
                 text[field->whole ? FIELD_INTEGER : field->type].before, range, unit[0] ? " " : "",
                 unit, field->words ? text[field->type].after : "", words);
        break;
    case FIELD_POLES:
    case FIELD_NUMBERS:
        snprintf(buffer, size, "list of %s%s numbers, %s%s%s",
                 field->fewer && field->type == FIELD_NUMBERS ? "up to " : "",
                 count_text(field->items, count[0]), field->unit,
                 words[0] ? text[FIELD_NUMBER].after : "", words);
        break;
    case FIELD_MATRIX:
        snprintf(buffer, size, "%s lists of %s numbers, %s", count_text(field->items, count[0]),
                 count_text(field->columns, count[1]), field->unit);
        break;
    case FIELD_PATHS:
        snprintf(buffer, size, "list of at most %d paths", SCENARIO_MAX_PATHS);
        break;
    default:
        snprintf(buffer, size, "%s%s%s", text[field->type].before, words, text[field->type].after);
    }
    return buffer;
}

/* What it is used with, and what it needs; "": nothing. */
static const char *use_text(const struct scenario_field *field, char *buffer, size_t size)
{
    const stance_law *const law = stance_laws()[field->law];
    int used = 0;
    buffer[0] = '\0';
    if (field->use == USE_LAW)
        used =
            snprintf(buffer, size, "Only with controller.kind %s%s%s.", law->name,
                     law->acts_far ? ", or controller.far " : "", law->acts_far ? law->name : "");
    else if (field->use != USE_ALWAYS)
        used = snprintf(buffer, size, "Only %s.", schema_uses[field->use].needs);
    if (field->samples && field->offset != offsetof(struct scenario_values, law))
        snprintf(buffer + used, size - (size_t)used, "%sNeeds controller.sample_time > 0: %s.",
                 used ? " " : "", field->samples);
    return buffer;
}

static void print_row(FILE *out, const struct scenario_field *field)
{
    char kind[700], fallback[128], line[900];

    snprintf(line, sizeof line, "%s%s", kind_text(field, kind, sizeof kind),
             default_text(field, fallback, sizeof fallback));
    fprintf(out, "%s\n", field->path);
    print_wrapped(out, field->text);
    print_wrapped(out, line);
}

static void print_field(FILE *out, const struct schema *schema, const struct scenario_field *field)
{
    const char *names[SCHEMA_MAX_FIELDS];
    char use[192], list[700], line[720], path[sizeof field->path + 2];

    print_row(out, field);
    if (field->more)
        print_wrapped(out, field->more);
    if (use_text(field, use, sizeof use)[0])
        print_wrapped(out, use);
    if (field->sweep)
        print_wrapped(out, field->design
                               ? "May be swept; each value is a controller design of its own."
                               : "May be swept.");
    const bool is_list = field->type == FIELD_AXES || field->type == FIELD_FACTORS;
    snprintf(path, sizeof path, "%s%s", field->path, is_list ? "[]" : "");
    size_t n = schema_children(schema, path, names, SCHEMA_MAX_FIELDS);
    if (n > 0) {
        snprintf(line, sizeof line, "Keys: %s", word_list(list, sizeof list, names, n));
        print_wrapped(out, line);
    }
}

/* Whether a path stands for the same in every scene. */
static bool is_common(const struct schema *schemas, size_t count,
                      const struct scenario_field *field)
{
    bool common = !field->by_scene;
    for (size_t k = 0; common && k < count; k++)
        common = schema_find(&schemas[k], field->path) != NULL;
    return common;
}

static void print_all(FILE *out, const struct schema *schemas, size_t count)
{
    fputs("The scenario format, version 1. Units are SI; [] stands for an index from 0.\n"
          "stance describe PATH tells more; stance describe --schema prints JSON Schema.\n"
          "Keys that begin with x- are passed over: under them stands what aliases (*NAME) repeat\n"
          "and << merges into a mapping, whose own keys come first.\n",
          out);
    /* What is the same in every scene is said once, before what each brings. */
    for (size_t k = 0; k <= count; k++) {
        const struct schema *schema = &schemas[k > 0 ? k - 1 : 0];
        if (k == 0)
            fputs("\nIn every scene\n\n", out);
        else
            fprintf(out, "\nscene: %s (%s)\n\n", schema->scene->name, schema->scene->text);
        for (size_t i = 0; i < schema->count; i++)
            if (is_common(schemas, count, &schema->field[i]) == (k == 0))
                print_row(out, &schema->field[i]);
    }
}

/* ---- JSON Schema ----------------------------------------------------------------------------- */

/* Every function below returns a new reference, NULL without memory; json_object_set_new and
 * json_pack accept that and fail in turn. */

/* A whole number without a decimal point, which some readers want. */
static json_t *json_number(double value)
{
    if (value >= 0x1p63)
        return json_integer(INT64_MAX);
    return value == floor(value) && fabs(value) < 0x1p53 ? json_integer((json_int_t)value)
                                                         : json_real(value);
}

static json_t *number_schema(const struct scenario_field *field)
{
    json_t *schema = json_pack("{s:s}", "type",
                               field->whole || field->type == FIELD_INTEGER ? "integer" : "number");
    if (isfinite(field->low))
        json_object_set_new(schema, field->low_open ? "exclusiveMinimum" : "minimum",
                            json_number(field->low));
    if (isfinite(field->high))
        json_object_set_new(schema, field->high_open ? "exclusiveMaximum" : "maximum",
                            json_number(field->high));
    if (field->words)
        return json_pack("{s:[o,{s:s}]}", "anyOf", schema, "const", field->words[0]);
    return schema;
}

static bool is_truth(const struct scenario_field *field)
{
    return field->word_count == 2 && strcmp(field->words[0], "false") == 0;
}

static json_t *words_schema(const struct scenario_field *field)
{
    if (is_truth(field))
        return json_pack("{s:s}", "type", "boolean");
    json_t *words = json_array();
    for (size_t i = 0; i < field->word_count; i++)
        json_array_append_new(words, json_string(field->words[i]));
    return json_pack("{s:o}", "enum", words);
}

static json_t *list_schema(json_t *items, size_t count)
{
    json_t *schema = json_pack("{s:s,s:o,s:i}", "type", "array", "items", items, "minItems",
                               count ? (int)count : 1);
    if (count)
        json_object_set_new(schema, "maxItems", json_integer((json_int_t)count));
    return schema;
}

static json_t *map_schema(const struct schema *schema, const char *path);

static json_t *any_of(json_t *one, json_t *other)
{
    return json_pack("{s:[o,o]}", "anyOf", one, other);
}

static json_t *type(const char *of)
{
    return json_pack("{s:s}", "type", of);
}

/* A list of mappings of a path or several. */
static json_t *varied_schema(const struct schema *schema, const char *path, int most)
{
    json_t *entry = map_schema(schema, path);
    json_object_set_new(entry, "oneOf",
                        json_pack("[{s:[s]},{s:[s]}]", "required", "path", "required", "paths"));
    json_t *list = list_schema(entry, 0);
    json_object_set_new(list, "maxItems", json_integer(most));
    return list;
}

static json_t *complex_schema(const struct schema *schema)
{
    static const char pattern[] = "^[-+]?[0-9.]+([eE][-+]?[0-9]+)?[-+][0-9.]+([eE][-+]?[0-9]+)?i$";
    return any_of(number_schema(schema_find(schema, "controller.poles[]")),
                  json_pack("{s:s,s:s}", "type", "string", "pattern", pattern));
}

/* A list whose items may be given by name, too. */
static json_t *or_named(const struct schema *schema, const struct scenario_field *field,
                        json_t *list)
{
    const char *name;
    return schema_children(schema, field->path, &name, 1) == 0
               ? list
               : any_of(list, map_schema(schema, field->path));
}

static json_t *type_schema(const struct schema *schema, const struct scenario_field *field)
{
    json_t *list;
    if (strncmp(field->path, "controller.poles.", 17) == 0)
        return complex_schema(schema);
    switch (field->type) {
    case FIELD_MAP:
        return map_schema(schema, field->path);
    case FIELD_NUMBER:
    case FIELD_INTEGER:
        return number_schema(field);
    case FIELD_WORD:
        return words_schema(field);
    case FIELD_WORDS:
        list =
            list_schema(schema->pattern && field->words == schema->elements ? type("string")
                                                                            : words_schema(field),
                        0);
        json_object_set_new(list, "uniqueItems", json_true());
        return list;
    case FIELD_POLES:
        return or_named(schema, field, list_schema(complex_schema(schema), field->items));
    case FIELD_NUMBERS: {
        char item[sizeof field->path + 2];
        snprintf(item, sizeof item, "%s[]", field->path);
        list = list_schema(number_schema(schema_find(schema, item)), field->items);
        if (field->fewer)
            json_object_set_new(list, "minItems", json_integer(1));
        return or_named(schema, field, list);
    }
    case FIELD_MATRIX:
        list =
            list_schema(number_schema(schema_find(schema, "controller.gains[][]")), field->columns);
        return or_named(schema, field, list_schema(list, field->items));
    case FIELD_MAP_OR_WORD:
        return any_of(words_schema(field), map_schema(schema, field->path));
    case FIELD_CASES:
        return any_of(words_schema(field),
                      list_schema(json_pack("{s:s,s:i}", "type", "integer", "minimum", 0), 0));
    case FIELD_AXES:
        return varied_schema(schema, "sweep.grid[]", SCENARIO_MAX_AXES);
    case FIELD_FACTORS:
        return varied_schema(schema, "sweep.sample.vary[]", DOE_MAX_FACTORS);
    case FIELD_VARIED:
        list = list_schema(any_of(words_schema(field), map_schema(schema, "optimise.vary[]")), 0);
        return any_of(words_schema(field), list);
    case FIELD_DATA:
        return any_of(type("string"), list_schema(type("number"), 0));
    case FIELD_ENDS:
        return any_of(type("number"), list_schema(type("number"), 0));
    case FIELD_PATHS:
        list = list_schema(type("string"), 0);
        json_object_set_new(list, "maxItems", json_integer(SCENARIO_MAX_PATHS));
        return list;
    case FIELD_VALUES: {
        json_t *const scalar = json_pack("{s:[s,s]}", "type", "number", "string");
        list = list_schema(json_copy(scalar), 0);
        return list_schema(any_of(scalar, list), 0);
    }
    default:
        return type("string");
    }
}

static json_t *default_value(const struct scenario_field *field)
{
    bool word = field->type == FIELD_WORD || field->type == FIELD_CASES;
    bool number = field->type == FIELD_NUMBER || field->type == FIELD_INTEGER;
    if (field->required || isnan(field->fallback) || !(word || number))
        return NULL;
    if (number && isinf(field->fallback))
        return json_string("none");
    if (field->fallback_text)
        return NULL;
    if (word && is_truth(field))
        return json_boolean(field->fallback != 0);
    return word ? json_string(field->words[(size_t)field->fallback]) : json_number(field->fallback);
}

static json_t *field_schema(const struct schema *schema, const struct scenario_field *field)
{
    char text[900], use[192];
    bool unit = field->unit[0] && strcmp(field->unit, "1") != 0;
    json_t *object = type_schema(schema, field), *fallback = default_value(field);

    use_text(field, use, sizeof use);
    snprintf(text, sizeof text, "%s%s%s%s%s%s%s%s", field->text, unit ? ", in " : "",
             unit ? field->unit : "", field->more ? ". " : "", field->more ? field->more : "",
             use[0] && !field->more ? "." : "", use[0] ? " " : "", use);
    json_object_set_new(object, "description", json_string(text));
    if (fallback)
        json_object_set_new(object, "default", fallback);
    return object;
}

/* Whether a key stands for any name. */
static bool is_pattern(const struct schema *schema, const char *name)
{
    const stance_mechanism *const m = schema->scene->mechanism;
    bool is = schema_any_plate(schema) && strcmp(name, PLATE_PATTERN) == 0;
    for (int part = 0; part < ROBOT_PARTS && schema->pattern; part++)
        is = is || strcmp(name + (part == PART_BODY && name[0] == 'v'),
                          part_name(m, (enum part)part, 0)) == 0;
    return is;
}

/* A mapping with the keys below `path`. */
static json_t *map_schema(const struct schema *schema, const char *path)
{
    const char *names[SCHEMA_MAX_FIELDS];
    char below[256];
    size_t count = schema_children(schema, path, names, SCHEMA_MAX_FIELDS);
    json_t *properties = json_object(), *required = json_array(), *others = json_array();

    for (size_t i = 0; i < count; i++) {
        snprintf(below, sizeof below, "%s%s%s", path, path[0] ? "." : "", names[i]);
        const struct scenario_field *field = schema_find(schema, below);
        if (is_pattern(schema, names[i])) {
            json_array_append_new(others, field_schema(schema, field));
            continue;
        }
        json_object_set_new(properties, names[i], field_schema(schema, field));
        /* What may also come from a sweep, or only some kinds need, cannot be asked for here. */
        if (field->required && field->type != FIELD_MAP && field->use == USE_ALWAYS &&
            !field->sweep)
            json_array_append_new(required, json_string(names[i]));
    }
    json_t *object = json_pack("{s:s,s:o,s:b}", "type", "object", "properties", properties,
                               "additionalProperties", 0);
    if (json_array_size(others) > 0)
        json_object_set_new(object, "additionalProperties", json_pack("{s:O}", "anyOf", others));
    json_decref(others);
    if (json_array_size(required) > 0)
        json_object_set(object, "required", required);
    json_decref(required);
    if (strcmp(path, "controller") == 0) { /* a law of the user's own has keys of its own */
        json_t *known = json_array();
        for (size_t i = 0; i < count; i++)
            json_array_append_new(known, json_string(names[i]));
        json_object_set_new(object, "additionalProperties",
                            json_pack("{s:[s,s]}", "type", "number", "array"));
        json_object_set_new(object, "if",
                            json_pack("{s:[{s:{s:{s:s}},s:[s]},{s:{s:{s:s}},s:[s]}]}", "anyOf",
                                      "properties", "kind", "const", "program", "required", "kind",
                                      "properties", "far", "const", "program", "required", "far"));
        json_object_set_new(object, "else", json_pack("{s:{s:o}}", "propertyNames", "enum", known));
    }
    if (strcmp(path, "initial") == 0) {
        json_object_set_new(object, "not",
                            json_pack("{s:[s,s]}", "required", "equilibrium", "state"));
    }
    return object;
}

static json_t *scene_schema(const struct schema *schema)
{
    json_t *object = map_schema(schema, "");
    json_t *scene = json_object_get(json_object_get(object, "properties"), "scene");
    json_object_set_new(scene, "enum", json_pack("[s]", schema->scene->name));
    json_object_set_new(object, "patternProperties", json_pack("{s:b}", "^x-", 1));
    return object;
}

static bool print_schema(FILE *out, const struct schema *schemas, size_t count)
{
    json_t *root;
    if (count == 1) {
        root = scene_schema(&schemas[0]);
    } else {
        json_t *scenes = json_array();
        for (size_t i = 0; i < count; i++)
            json_array_append_new(scenes, scene_schema(&schemas[i]));
        root = json_pack("{s:o}", "oneOf", scenes);
    }
    json_object_set_new(root, "$schema",
                        json_string("https://json-schema.org/draft/2020-12/schema"));
    json_object_set_new(root, "title", json_string("stance scenario, format version 1"));
    bool good = root && json_dumpf(root, out, JSON_INDENT(2) | JSON_REAL_PRECISION(15)) == 0;
    json_decref(root);
    fputc('\n', out);
    return good;
}

/* ---- which of them --------------------------------------------------------------------------- */

enum { SHOWN_PATHS = 12 };

/* Paths whose last name is `word` or, where `words`, that admit it as a value, each once. Returns
 * how many, at most SHOWN_PATHS. */
static size_t paths_with(const char *word, bool words, const struct schema *schemas, size_t count,
                         const char *list[SHOWN_PATHS])
{
    size_t n = 0;
    for (size_t k = 0; k < count; k++) {
        for (size_t i = 0; i < schemas[k].count && n < SHOWN_PATHS; i++) {
            const struct scenario_field *field = &schemas[k].field[i];
            bool found = !words && strcmp(schema_last_name(field->path), word) == 0;
            found |= words && word_place(word, field->words, field->word_count) < field->word_count;
            if (found && word_place(field->path, list, n) == n)
                list[n++] = field->path;
        }
    }
    return n;
}

/* What a path that no scene has may have meant, or NULL; one name is compared with last names. */
static const char *nearest_path(const char *path, const struct schema *schemas, size_t count)
{
    const char **known = malloc(count * SCHEMA_MAX_FIELDS * sizeof *known), *near = NULL;
    const bool whole = strchr(path, '.') != NULL;
    size_t n = 0;
    for (size_t k = 0; known && k < count; k++)
        for (size_t i = 0; i < schemas[k].count; i++) {
            const char *const row = schemas[k].field[i].path;
            known[n++] = whole ? row : schema_last_name(row);
        }
    near = known ? nearest_word(path, known, n) : NULL;
    for (size_t k = 0; near && k < count; k++)
        for (size_t i = 0; i < schemas[k].count; i++)
            if (schema_last_name(schemas[k].field[i].path) == near)
                near = schemas[k].field[i].path;
    free(known);
    return near;
}

/* Says what to ask for instead of a path that no scene has. */
static void explain_path(const char *path, FILE *errors, const struct schema *schemas, size_t count)
{
    const char *list[SHOWN_PATHS], *suffix = strrchr(path, '.');
    char word[SHOWN_SIZE], text[SHOWN_PATHS * sizeof schemas->field->path];
    const size_t ends = paths_with(path, false, schemas, count, list);
    const size_t n = ends > 0 ? ends : paths_with(path, true, schemas, count, list);
    const char *near = n > 0 ? NULL : nearest_path(path, schemas, count);

    shown(word, path);
    if (suffix && strcmp(suffix, ".yaml") == 0) {
        fprintf(errors,
                "stance describe: documents the format, not a file; write stance check %s\n", word);
    } else if (n > 0) {
        fprintf(errors, "stance describe: '%s' is %s %s; write stance describe %s\n", word,
                ends > 1   ? "the end of"
                : ends > 0 ? "the key"
                           : "a word of",
                words_join(text, sizeof text, ", ", list, n), list[0]);
    } else {
        fprintf(errors, "stance describe: unknown path '%s'%s%s%s\n", word,
                near ? "; did you mean '" : "", near ? near : "",
                near ? "'?" : " (stance describe lists them)");
    }
}

/* Whether a path is the one of a row, in which any name may stand for one of the pattern's. */
static bool fits_pattern(const struct schema *schema, const char *row, const char *path)
{
    for (;; row++, path++) {
        const size_t length = strcspn(row, ".["), own = strcspn(path, ".[");
        char name[sizeof schema->field->path];
        snprintf(name, sizeof name, "%.*s", (int)length, row);
        if (!(length == own && strncmp(row, path, own) == 0) &&
            !(own > 0 && is_pattern(schema, name) && (name[0] != 'v' || path[0] == 'v')))
            return false;
        row += length;
        path += own;
        if (*row != *path || !*row)
            return *row == *path;
    }
}

/* The row of a path, with indices or "[]", in which names of a robot of one's own may stand for
 * those of the pattern. */
static const struct scenario_field *find_row(const struct schema *schema, const char *path)
{
    char general[sizeof schema->field->path];
    size_t n = 0;
    for (const char *at = path; *at && n < sizeof general - 1; n++) {
        general[n] = *at++;
        if (general[n] == '[')
            at += strspn(at, "0123456789");
    }
    general[n] = '\0';
    const struct scenario_field *field = schema_find(schema, general);
    const bool exact = field != NULL;
    for (size_t i = 0; i < schema->count && !exact; i++)
        if (fits_pattern(schema, schema->field[i].path, general))
            field = &schema->field[i]; /* a rate comes after its coordinate */
    return field;
}

/* What a scene says of a path, to be freed; NULL: nothing. */
static char *text_of(const struct schema *schema, const char *path)
{
    const struct scenario_field *const field = find_row(schema, path);
    char *text = NULL;
    size_t size = 0;
    FILE *const out = field ? open_memstream(&text, &size) : NULL;
    if (out)
        print_field(out, schema, field);
    if (out)
        fclose(out);
    return text;
}

/* A path, for every scene where it stands for something else. */
static bool print_path(const char *path, FILE *out, FILE *errors, const struct schema *schemas,
                       size_t count)
{
    char *text[SCHEMA_MAX_WORDS + 1] = {NULL};
    bool found = false, common = false;
    for (size_t k = 0; k < count; k++)
        text[k] = text_of(&schemas[k], path);
    for (size_t k = 0; k < count && !common; k++) {
        bool said = !text[k];
        for (size_t i = 0; i < k && !said; i++)
            said = text[i] && strcmp(text[i], text[k]) == 0;
        if (said)
            continue;
        common = is_common(schemas, count, find_row(&schemas[k], path));
        if (!common)
            fprintf(out, "%sscene: %s", found ? "\n" : "", schemas[k].scene->name);
        for (size_t i = k + 1; i < count && !common; i++)
            if (text[i] && strcmp(text[i], text[k]) == 0)
                fprintf(out, ", %s", schemas[i].scene->name);
        fprintf(out, "%s%s", common ? "" : "\n", text[k]);
        found = true;
    }
    for (size_t k = 0; k < count; k++)
        free(text[k]);
    if (!found)
        explain_path(path, errors, schemas, count);
    return found;
}

bool scenario_describe(const char *path, bool json_schema, const struct scenario *of, FILE *out,
                       FILE *errors)
{
    size_t count = 0;
    while (!of && stance_scenes()[count])
        count++;
    struct schema *schemas = calloc(count + 1, sizeof *schemas);
    stance_scene *any = mechanism_pattern();
    bool good = schemas != NULL && any != NULL;

    for (size_t i = 0; i <= count && good; i++)
        good = schema_build(&schemas[i],
                            i < count ? stance_scenes()[i]
                            : of      ? of->scene
                                      : any,
                            of ? &of->law : NULL, true);
    count++;
    if (!good) {
        fputs("stance describe: out of memory\n", errors);
    } else if (path) {
        good = print_path(path, out, errors, schemas, count);
    } else if (json_schema) {
        good = print_schema(out, schemas, count) || ferror(out);
        if (!good)
            fputs("stance describe: out of memory\n", errors);
    } else {
        print_all(out, schemas, count);
    }
    free(schemas);
    stance_scene_free(any);
    return good;
}
