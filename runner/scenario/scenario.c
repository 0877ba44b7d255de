/* scenario.c - a scenario file, read, checked and bound into struct scenario.
 *
 * First every value by itself, against its row of the schema; then the axes; then what the keys
 * mean for each other. A key whose value was bad counts as given, so that one error does not lead
 * to others.
 */
#include "scenario.h"
#include "mechanism.h"
#include "reader.h"
#include "schema_mechanism.h"

#include "runner/base/command.h"
#include "runner/base/numbers.h"
#include "runner/base/words.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_SIZE = 160 };

static bool read_tree(struct reader *r, const char *file, const char *given)
{
    size_t length = given ? strlen(given) : 0;
    char *own = given ? NULL : scenario_text(file, &r->problems, &length);
    const char *text = given ? given : own;
    bool good = text != NULL;

    if (good && length > TREE_MAX_BYTES)
        good = problem_add(&r->problems, (struct mark){0}, "larger than 1 MiB");
    good = good && tree_check_text(text, length, &r->problems);
    if (good)
        tree_find_hidden(text, length, 0, &r->hidden);
    good = good && tree_parse(&r->tree, text, length, &r->problems);
    free(own);
    return good;
}

/* ---- keys ------------------------------------------------------------------------------------ */

struct seen *reader_seen(struct reader *r, const char *path)
{
    const struct scenario_field *field = schema_find(r->schema, path);
    return field ? &r->seen[field - r->schema->field] : &r->nothing;
}

double reader_number(struct reader *r, const char *path, bool *good)
{
    const struct scenario_field *field = schema_find(r->schema, path);
    const struct tree_node *node = reader_seen(r, path)->node;
    double value = field->fallback;

    if (!node || field_value(&r->problems, field, path, node, &value))
        return value;
    *good = false;
    return field->fallback;
}

void reader_report(struct reader *r, const char *path, const char *format, ...)
{
    char text[PROBLEM_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    problem_record(&r->problems, reader_mark(r, path), "%s%s", path, text);
}

struct mark reader_mark(struct reader *r, const char *path)
{
    char around[112];
    snprintf(around, sizeof around, "%s", path);
    for (char *dot = around; dot; dot = strrchr(around, '.')) {
        *dot = dot == around ? *dot : '\0';
        const struct seen *const seen = reader_seen(r, around);
        if (reader_given(seen))
            return seen->swept ? seen->sweep : seen->key;
    }
    return r->tree.root->mark;
}

/* ---- values by themselves -------------------------------------------------------------------- */

static void read_map(struct reader *r, const struct tree_node *map, const char *path);

/* Reads a value that is bound by its offset in the table. */
static bool read_bound(struct reader *r, const struct scenario_field *field,
                       const struct tree_node *node)
{
    double number = 0;
    uint64_t mask = 0;
    const size_t pole = (field->offset - offsetof(struct scenario_values, pole_re)) / sizeof number;
    bool good =
        pole < SCENARIO_MAX_POLES
            ? field_pole(&r->problems, field, field->path, node, &number, &r->s->base.pole_im[pole])
        : field->type == FIELD_WORDS ? field_words(&r->problems, field, field->path, node, &mask)
                                     : field_value(&r->problems, field, field->path, node, &number);
    if (good && field->type == FIELD_WORDS)
        number = (double)mechanism_contacts(r->s->scene, (uint32_t)mask);
    if (good)
        scenario_put(&r->s->base, field->offset, field->type != FIELD_NUMBER, number);
    return good;
}

size_t reader_pole(const struct reader *r, const struct tree_node *poles, size_t i, char path[96])
{
    if (poles->kind == TREE_LIST) {
        snprintf(path, 96, "controller.poles[%zu]", i);
        return i;
    }
    snprintf(path, 96, "controller.poles.%.64s", poles->key[i].name);
    const struct scenario_field *const field = schema_find(r->schema, path);
    return field ? (field->offset - offsetof(struct scenario_values, pole_re)) / sizeof(double)
                 : SCENARIO_MAX_POLES - 1;
}

static bool check_conjugates(struct reader *r, const struct tree_node *node)
{
    const struct scenario_values *base = &r->s->base;
    bool taken[SCENARIO_MAX_POLES] = {false}, good = true;
    char word[SHOWN_SIZE], path[96], other[96];

    for (size_t n = 0; n < node->count; n++) {
        const size_t i = reader_pole(r, node, n, path);
        bool paired = taken[i] || base->pole_im[i] == 0;
        for (size_t m = n + 1; m < node->count && !paired; m++) {
            const size_t k = reader_pole(r, node, m, other);
            paired = !taken[k] && base->pole_re[k] == base->pole_re[i] &&
                     base->pole_im[k] == -base->pole_im[i];
            taken[k] = taken[k] || paired;
        }
        good = good && paired;
        if (!paired) {
            problem_add(&r->problems, node->item[n]->mark, "%s: %s lacks its conjugate", path,
                        shown(word, node->item[n]->text));
        }
    }
    return good;
}

int scenario_poles(const struct scenario_values *values, double re[SCENARIO_MAX_POLES],
                   double im[SCENARIO_MAX_POLES])
{
    int count = 0;
    for (int i = 0; i < SCENARIO_MAX_POLES; i++) {
        if (isnan(values->pole_re[i]) || values->pole_re[i] == 0)
            continue;
        re[count] = values->pole_re[i];
        im[count++] = values->pole_im[i];
    }
    return count;
}

/* Keeps a list of states that has another length than it should, to be reported later. */
static bool misfits(struct reader *r, const char *path, const struct tree_node *node, size_t items,
                    const char *what)
{
    if (scenario_numbers_feet(r->s->scene) || node->kind != TREE_LIST || node->count == items ||
        r->misfits == sizeof r->misfit / sizeof r->misfit[0])
        return false;
    struct misfit *const misfit = &r->misfit[r->misfits++];
    *misfit = (struct misfit){.node = node, .items = items, .what = what};
    snprintf(misfit->path, sizeof misfit->path, "%.90s", path);
    return true;
}

/* A list of fixed length: numbers, poles, rows of numbers. Its items have a row of their own. */
static bool read_items(struct reader *r, const struct scenario_field *field,
                       const struct tree_node *node)
{
    const bool matrix = field->type == FIELD_MATRIX, poles = field->type == FIELD_POLES;
    char path[PATH_SIZE], name[PATH_SIZE];

    snprintf(path, sizeof path, "%s%s", field->path, matrix ? "[][]" : "[]");
    const struct scenario_field *item = schema_find(r->schema, path);
    double *number = (double *)(void *)((char *)&r->s->base + item->offset);
    const size_t items =
        field->fewer && node->kind == TREE_LIST && node->count > 0 && node->count < field->items
            ? node->count
            : field->items;
    if (field->fewer && field->type == FIELD_NUMBERS && items == field->items &&
        (node->kind != TREE_LIST || node->count != items))
        return problem_add(&r->problems, node->mark, "%s: expected a list of 1 to %zu numbers",
                           field->path, items);
    const bool states = field->items == 2 * (size_t)r->s->scene->postures && !matrix;
    bool good = !(states && misfits(r, field->path, node, items, poles ? "poles" : "numbers")) &&
                field_items(&r->problems, field->path, node, items,
                            matrix  ? "rows"
                            : poles ? "poles"
                                    : "numbers");
    for (size_t i = 0; good && i < items; i++) {
        const struct tree_node *row = node->item[i];
        snprintf(name, sizeof name, "%s[%zu]", field->path, i);
        good = poles ? field_pole(&r->problems, item, name, row, &number[i], &r->s->base.pole_im[i])
               : !matrix ? field_number(&r->problems, item, name, row, &number[i])
                         : !misfits(r, name, row, item->columns, "numbers") &&
                               field_items(&r->problems, name, row, item->columns, "numbers");
        for (size_t k = 0; good && matrix && k < item->columns; k++) {
            snprintf(name, sizeof name, "%s[%zu][%zu]", field->path, i, k);
            good = field_number(&r->problems, item, name, row->item[k],
                                &number[i * item->columns + k]);
        }
    }
    return good && (!poles || check_conjugates(r, node));
}

static void read_value(struct reader *r, const struct scenario_field *field,
                       const struct tree_key *key, const struct tree_node *node)
{
    struct seen *seen = &r->seen[field - r->schema->field];

    seen->node = node;
    seen->key = key->mark;
    if (field->by_scene && !r->schema->scene)
        return;
    const bool map = field->type == FIELD_MAP || field->type == FIELD_MAP_OR_WORD;
    if (map && node->kind == TREE_MAP) {
        read_map(r, node, field->path);
    } else if (field->type == FIELD_POLES && node->kind == TREE_MAP) {
        read_map(r, node, field->path);
        for (size_t i = 0; i < node->count; i++) {
            char path[96];
            snprintf(path, sizeof path, "controller.poles.%.64s", node->key[i].name);
            seen->bad = seen->bad || reader_seen(r, path)->bad || !schema_find(r->schema, path);
        }
        seen->bad = seen->bad || !check_conjugates(r, node);
    } else if (reader_described(r, field->path)) {
        return;
    } else if (field->type == FIELD_MAP_OR_WORD && node->kind == TREE_SCALAR &&
               strcmp(node->text, field->words[0]) == 0) {
        r->s->base.settle = 0; /* stop.settle is the only one */
    } else if (map) {
        seen->bad = true;
        reader_no_mapping(r, field, node);
    } else if ((field->type == FIELD_POLES || field->type == FIELD_NUMBERS ||
                field->type == FIELD_MATRIX) &&
               field->items > 0) {
        seen->bad = !read_items(r, field, node);
    } else if (field->offset != NO_OFFSET) {
        seen->bad = !read_bound(r, field, node);
    }
}

static void read_map(struct reader *r, const struct tree_node *map, const char *path)
{
    if (!reader_described(r, path)) /* else it was checked when it was read */
        reader_check_keys(r, map, path, path);
    for (size_t i = 0; i < map->count; i++) {
        char below[PATH_SIZE];
        snprintf(below, sizeof below, "%s%s%.64s", path, path[0] ? "." : "", map->key[i].name);
        const struct scenario_field *field =
            strpbrk(map->key[i].name, ".[") ? NULL : schema_find(r->schema, below);
        if (field)
            read_value(r, field, &map->key[i], map->item[i]);
    }
}

static void set_defaults(struct reader *r)
{
    struct scenario_values *base = &r->s->base;

    if (r->s->scene)
        stance_robot_fallback(r->s->scene, base->robot);
    for (int i = 0; i < STANCE_MAX_ROBOT; i++)
        base->model[i] = NAN;
    for (size_t i = 0; i < r->schema->count; i++) {
        const struct scenario_field *field = &r->schema->field[i];
        if (field->offset == NO_OFFSET || reader_described(r, field->path))
            continue;
        const bool required = strchr(field->path, '[') && isnan(field->fallback) && !field->fewer;
        for (size_t k = 0; field->type == FIELD_NUMBER && k < schema_items(field) && !required; k++)
            scenario_put(base, field->offset + k * sizeof(double), false, field->fallback);
        if (field->type == FIELD_WORD)
            scenario_put(base, field->offset, true, isnan(field->fallback) ? 0 : field->fallback);
    }
    if (r->s->scene && r->s->scene->actuators == 0)
        base->torque_limit = INFINITY;
    base->settle = 1;
    base->contacts = r->s->scene ? (1 << r->s->scene->contacts) - 1 : 0;
    r->s->cases = 1;
    r->s->seed = 1;
}

/* ---- values that are bound by hand ----------------------------------------------------------- */

static void read_record_list(struct reader *r, const struct tree_node *node)
{
    struct scenario *s = r->s;
    const struct scenario_field index = {.type = FIELD_INTEGER,
                                         .high = r->axes_bad ? 0x1p53 : (double)(s->cases - 1)};
    double number;

    if (!field_list(&r->problems, "record.cases", "none, all or a list of cases", node, 0, NULL))
        return;
    s->record_cases = RECORD_LIST;
    s->record_list = malloc(node->count * sizeof *s->record_list);
    if (!s->record_list) {
        problem_no_memory(&r->problems);
        return;
    }
    for (size_t i = 0; i < node->count; i++)
        if (field_number(&r->problems, &index, "record.cases", node->item[i], &number))
            s->record_list[s->record_count++] = (uint64_t)number;
    s->record_count = numbers_unite(s->record_list, s->record_count);
}

static void read_record(struct reader *r)
{
    struct scenario *s = r->s;
    const struct tree_node *cases = reader_seen(r, "record.cases")->node;
    const struct tree_node *answers = reader_seen(r, "record.answers")->node;
    bool good = true;

    if (cases && (cases->kind != TREE_SCALAR || isdigit((unsigned char)cases->text[0])))
        read_record_list(r, cases);
    else if (cases && reader_number(r, "record.cases", &good) > 0)
        s->record_cases = RECORD_ALL;
    if (reader_seen(r, "record.every")->node || s->record_cases != RECORD_NONE)
        s->record_every = reader_number(r, "record.every", &good);
    s->answers = UINT64_MAX;
    if (answers)
        field_words(&r->problems, schema_find(r->schema, "record.answers"), "record.answers",
                    answers, &s->answers);
}

static void read_by_hand(struct reader *r)
{
    const struct tree_node *title = reader_seen(r, "title")->node;
    const struct tree_node *seed = reader_seen(r, "seed")->node;
    const struct tree_node *grid = reader_seen(r, "sweep.grid")->node;

    snprintf(r->s->title, sizeof r->s->title, "%s", r->s->name);
    if (title)
        field_text(&r->problems, "title", title, r->s->title, sizeof r->s->title);
    if (seed)
        field_seed(&r->problems, "seed", seed, &r->s->seed);
    r->axes_bad = !r->s->scene;
    if (grid && r->s->scene)
        sweep_read(r, grid);
    doe_read(r);
    search_read(r);
    read_record(r);
    sweep_read_refine(r);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Format version and scene decide what else may stand in the file. */
static bool read_version(struct reader *r)
{
    const struct tree_node *version = tree_find(r->tree.root, "stance");
    char word[SHOWN_SIZE];
    double number = 1;
    bool finite;

    if (version && (version->kind != TREE_SCALAR || version->quoted ||
                    !number_parse(version->text, &number, &finite)))
        return field_mismatch(&r->problems, "stance", "the version of the format, 1", version);
    return !version || number == 1 || /* what is missing is reported later */
           problem_add(&r->problems, version->mark,
                       "stance: this program reads version 1 of the format, not %s",
                       shown(word, version->text));
}

/* Whether the robot is one of the scene's kind: described by its bodies, or by the numbers of a
 * scene that is known. */
static bool robot_fits(struct reader *r, const struct tree_node *scene)
{
    const struct tree_node *const robot = tree_find(r->tree.root, "robot");
    char path[PATH_SIZE];
    if (!robot || robot->kind != TREE_MAP || robot->count == 0)
        return true;
    if (r->s->scene) {
        return !tree_find(robot, "bodies") ||
               problem_add(&r->problems, scene->mark,
                           "scene: robot.bodies is given, which %s has not; write scene: %s",
                           r->s->scene->name, MECHANISM_WORD);
    }
    snprintf(path, sizeof path, "robot.%.64s", robot->key[0].name);
    const stance_scene *const of = tree_find(robot, "bodies") ? NULL : schema_scene_with(path);
    return !of || problem_add(&r->problems, scene->mark,
                              "scene: %s is a number of the scene %s, a %s has bodies; write "
                              "scene: %s",
                              path, of->name, MECHANISM_WORD, of->name);
}

/* False: out of memory, or nothing more is to be said. */
static bool read_scene(struct reader *r)
{
    const struct tree_node *const root = r->tree.root, *const scene = tree_find(root, "scene");
    int place;

    r->schema = schema_of(NULL, NULL, &r->own_schema);
    if (!r->schema)
        return problem_no_memory(&r->problems);
    if (scene &&
        field_word(&r->problems, schema_find(r->schema, "scene"), "scene", scene, &place)) {
        r->s->scene = stance_scenes()[place]; /* NULL behind the last one */
        if (!robot_fits(r, scene))
            return false;
        const stance_scene *const carried = r->s->scene;
        if (!carried || tree_find(tree_find(root, "robot"), "points") ||
            tree_find(tree_find(root, "ground"), "plates"))
            r->s->scene = r->s->own_scene = mechanism_read(r, carried);
        const struct schema *const known =
            r->s->scene ? schema_of(r->s->scene, &r->s->law, &r->own_schema) : NULL;
        if (known)
            r->schema = known;
        else if (r->s->scene) {
            problem_add(&r->problems, scene->mark, "scene: %s has more names than fit",
                        r->s->scene->name);
            r->s->scene = NULL;
        }
    }
    return true;
}

/* Remembers where keys stand. Without memory later errors point at the mapping instead. */
static void note_places(struct reader *r)
{
    struct scenario *s = r->s;
    s->place = calloc(r->schema->count, sizeof *s->place);
    for (size_t i = 0; s->place && i < r->schema->count; i++) {
        if (r->seen[i].node && r->seen[i].key.set == 0) {
            struct scenario_place *place = &s->place[s->places++];
            snprintf(place->path, sizeof place->path, "%s", r->schema->field[i].path);
            place->line = r->seen[i].key.line;
            place->column = r->seen[i].key.column;
        }
    }
}

bool scenario_place(const struct scenario *s, const char *text, int *line, int *column)
{
    size_t best = 0;
    for (size_t i = 0; i < s->places; i++) {
        const size_t length = strlen(s->place[i].path);
        if (length > best && strncmp(text, s->place[i].path, length) == 0 &&
            strchr(".[: ", text[length]) && text[length]) {
            best = length;
            *line = s->place[i].line;
            *column = s->place[i].column;
        }
    }
    return best > 0;
}

/* Keys in the order of the table, so that equal scenarios have equal text. */
static void sort_keys(const struct schema *schema, struct tree_node *node, const char *path)
{
    const char *known[SCHEMA_MAX_FIELDS];
    char below[PATH_SIZE];

    if (node->kind == TREE_LIST) {
        snprintf(below, sizeof below, "%.100s[]", path);
        for (size_t i = 0; i < node->count; i++)
            sort_keys(schema, node->item[i], below);
    }
    if (node->kind != TREE_MAP)
        return;
    size_t count = schema_children(schema, path, known, SCHEMA_MAX_FIELDS), sorted = 0;
    for (size_t k = 0; k < count; k++) {
        for (size_t i = sorted; i < node->count; i++) {
            if (strcmp(node->key[i].name, known[k]) != 0)
                continue;
            struct tree_key key = node->key[i];
            struct tree_node *item = node->item[i];
            node->key[i] = node->key[sorted];
            node->item[i] = node->item[sorted];
            node->key[sorted] = key;
            node->item[sorted++] = item;
            break;
        }
    }
    for (size_t i = 0; i < node->count; i++) {
        snprintf(below, sizeof below, "%.90s%s%.64s", path, path[0] ? "." : "", node->key[i].name);
        sort_keys(schema, node->item[i], below);
    }
}

static void read_all(struct reader *r, const char *file, const char *text, const char *const *sets,
                     size_t set_count)
{
    struct scenario *s = r->s;

    if (!read_tree(r, file, text))
        return;
    for (size_t i = 0; i < set_count; i++) {
        if (!named_waits(sets[i]))
            tree_set(&r->tree, sets[i], (int)i + 1, &r->problems);
        tree_find_hidden(sets[i], strlen(sets[i]), (int)i + 1, &r->hidden);
    }
    if (r->tree.root->kind != TREE_MAP) {
        problem_add(&r->problems, r->tree.root->mark,
                    "a scenario is a mapping that begins with \"stance: 1\"");
        return;
    }
    law_file_read(r);
    if (!read_version(r) || !read_scene(r) || !named_read(r, sets, set_count))
        return;
    law_file_check(r);
    set_defaults(r);
    read_map(r, r->tree.root, "");
    read_by_hand(r);
    scenario_cross_check(r);
    note_places(r);
    if (r->problems.count == 0) {
        sort_keys(r->schema, r->tree.root, "");
        s->text = tree_write(r->tree.root);
        if (!s->text)
            problem_no_memory(&r->problems);
    }
}

/* The file's name without its directory and .yaml. That of a text that is given, most often out of
 * a results file, names no results: it may be cut. */
static bool set_names(struct scenario *s, const char *file, bool given)
{
    const char *const slash = strrchr(file, '/'), *const name = slash ? slash + 1 : file,
                      *const dot = strrchr(name, '.');
    const bool yaml = dot && dot > name && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0);
    const size_t length = yaml ? (size_t)(dot - name) : strlen(name);
    snprintf(s->file, sizeof s->file, "%s", file);
    snprintf(s->name, sizeof s->name, "%.*s", (int)length, name);
    return given || (length < sizeof s->name && strlen(file) < sizeof s->file);
}

bool scenario_read(struct scenario *s, const char *file, const char *text, const char *const *sets,
                   size_t set_count, FILE *errors)
{
    struct reader *r = calloc(1, sizeof *r);

    memset(s, 0, sizeof *s);
    if (!r) {
        if (errors)
            fprintf(errors, "%s: out of memory\n", file);
        return false;
    }
    r->s = s;
    if (!set_names(s, file, text != NULL))
        problem_add(&r->problems, (struct mark){0}, "the file's name is too long");
    else
        read_all(r, file, text, sets, set_count);
    bool good = r->problems.count == 0;
    if (!good) {
        if (errors)
            problems_print(r->hidden.count ? &r->hidden : &r->problems, file, sets, errors);
        scenario_free(s);
    }
    tree_free(&r->tree);
    free(r->own_schema);
    free(r);
    return good;
}

void scenario_free(struct scenario *s)
{
    for (int a = 0; a < s->axes; a++)
        sweep_free(&s->axis[a]);
    doe_free(&s->sample);
    sweep_free(&s->search.axis);
    free(s->record_list);
    free(s->text);
    free(s->place);
    if (s->program)
        s->program_free(s->program);
    law_file_free(&s->law);
    stance_scene_free(s->own_scene);
    memset(s, 0, sizeof *s);
}

struct scenario *scenario_new(const char *file, const char *text, const char *const *sets,
                              size_t set_count, FILE *errors)
{
    struct scenario *const s = calloc(1, sizeof *s);
    if (s && scenario_read(s, file, text, sets, set_count, errors))
        return s;
    if (!s && errors)
        fprintf(errors, "%s: out of memory\n", file);
    free(s);
    return NULL;
}

void scenario_drop(struct scenario *s)
{
    if (s)
        scenario_free(s);
    free(s);
}

bool scenario_same_scene(const struct scenario *a, const struct scenario *b)
{
    return a->scene == b->scene || (a->own_scene && b->own_scene &&
                                    mechanism_same(a->scene->mechanism, b->scene->mechanism));
}

bool scenario_numbers_feet(const stance_scene *scene)
{
    return scene->mechanism->carried && scene->mechanism->carried->numbered;
}

uint32_t scenario_supports(const stance_scene *scene, const struct scenario_values *values)
{
    return !scenario_numbers_feet(scene) ? (uint32_t)values->support
           : values->support_foot > 0    ? UINT32_C(1) << (values->support_foot - 1)
                                         : 1;
}

/* ---- laws ------------------------------------------------------------------------------------ */

const stance_law *scenario_law(const struct scenario_values *values)
{
    return stance_laws()[values->law];
}

const stance_law *scenario_far(const struct scenario_values *values)
{
    int far = scenario_law(values)->designed ? values->far : 0; /* counts those that act far */
    const stance_law *const *law = stance_laws();
    while (far > 0 || !(*law)->acts_far)
        far -= (*law++)->acts_far;
    return *law;
}

bool scenario_selection_name(const stance_scene *scene, int selection, char name[SCENARIO_NAME])
{
    int coordinate[STANCE_MAX_ACTUATORS];
    char *end = name;
    if (!stance_selection(scene, selection, coordinate))
        return false;
    for (int i = 0; i < scene->actuators; i++)
        end += snprintf(end, STANCE_NAME + 1, "%s%s", i ? "-" : "",
                        scene->coordinate[coordinate[i]].name);
    return true;
}

const double *scenario_law_value(const struct scenario_values *values, const char *law,
                                 const char *parameter)
{
    int l = 0, p = 0;
    while (strcmp(stance_laws()[l]->name, law) != 0)
        l++;
    while (strcmp(stance_laws()[l]->parameter[p].of.name, parameter) != 0)
        p++;
    return &values->law_value[(stance_law_first(stance_laws()[l]) + p) * STANCE_LAW_ROOM];
}
