/* sweep.c - the axes of the grid, and the cases that they make. */
#include "mend.h"
#include "reader.h"

#include "runner/base/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_KEPT_POINTS 1e7 /* that are computed beforehand */

const char *axis_key(const struct scenario *s, int axis, char name[AXIS_NAME])
{
    if (s->axis[axis].sample)
        snprintf(name, AXIS_NAME, "sweep.sample");
    else
        snprintf(name, AXIS_NAME, "sweep.grid[%d]", axis);
    return name;
}

/* ---- paths ----------------------------------------------------------------------------------- */

static bool unknown_path(struct axis_reader *a, const struct tree_node *node)
{
    const struct schema *schema = a->r->schema;
    char path[SCHEMA_MAX_FIELDS][128], word[SHOWN_SIZE];
    const char *known[SCHEMA_MAX_FIELDS], *near;
    size_t n = 0;

    for (size_t i = 0; i < schema->count; i++)
        if (schema->field[i].sweep) {
            known[n] = schema_item_path(&schema->field[i], 0, path[n]);
            n++;
        }
    near = mend_path(node->text, known, n);
    near = near ? near : nearest_word(node->text, known, n);
    shown(word, node->text);
    if (schema->scene && schema_scene_with(node->text))
        return problem_add(&a->r->problems, node->mark,
                           "%s: the scene %s has no field '%s' (stance describe lists them)",
                           a->name, schema->scene->name, word);
    return problem_add(&a->r->problems, node->mark,
                       "%s: unknown field '%s'%s%s%s (stance describe lists them)", a->name, word,
                       near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static bool beyond_end(struct axis_reader *a, const struct tree_node *node,
                       const struct swept_field *swept)
{
    const struct scenario_field *field = swept->field;
    size_t limit = field->items, index = swept->index[0];
    if (field->items == 0 ||
        (index < field->items && swept->index[1] < (field->columns + !field->columns)))
        return false;
    if (index < field->items) {
        limit = field->columns;
        index = swept->index[1];
    }
    problem_add(&a->r->problems, node->mark, "%s: %s has %zu %s, so [%zu] is beyond the end",
                a->name, node->text, limit, limit == field->columns ? "columns" : "items", index);
    return true;
}

static bool is_sought(const struct axis_reader *a)
{
    return a->axis == &a->r->s->search.axis;
}

/* Under this name or another: a.b[0], a.theta. */
static bool swept_before(struct axis_reader *a, const struct tree_node *node, size_t offset)
{
    for (int i = 0; i <= a->number + is_sought(a); i++) {
        const bool other = i <= a->number;
        const struct scenario_axis *axis = other ? &a->r->s->axis[i] : a->axis;
        for (int k = 0; k < axis->paths; k++) {
            if (strcmp(axis->path[k], node->text) == 0 || axis->offset[k] == offset) {
                char first[AXIS_NAME];
                problem_add(&a->r->problems, node->mark, "%s: %s is %s twice (first in %s)",
                            a->name, node->text, other && !is_sought(a) ? "swept" : "varied",
                            other ? axis_key(a->r->s, i, first) : "optimise.vary");
                return true;
            }
        }
    }
    return false;
}

bool axis_read_path(struct axis_reader *a, const struct tree_node *node)
{
    struct scenario_axis *axis = a->axis;
    struct swept_field swept = {.mark = node->mark};
    char word[SHOWN_SIZE];

    if (node->kind != TREE_SCALAR)
        return field_mismatch(&a->r->problems, a->name, "a path such as ground.friction", node);
    if (axis->paths == SCENARIO_MAX_PATHS)
        return problem_add(&a->r->problems, node->mark, "%s: more than %d paths", a->name,
                           SCENARIO_MAX_PATHS);
    swept.field = schema_find_concrete(a->r->schema, node->text, swept.index);
    if (!swept.field)
        return unknown_path(a, node);
    if (!swept.field->sweep) {
        return problem_add(&a->r->problems, node->mark, "%s: %s cannot be %s", a->name,
                           shown(word, node->text), is_sought(a) ? "varied" : "swept");
    }
    const bool integer = swept.field->type != FIELD_NUMBER;
    const size_t columns = swept.field->columns ? swept.field->columns : 1;
    const size_t offset = swept.field->offset +
                          (integer ? swept.index[0] * sizeof(int)
                                   : (swept.index[0] * columns + swept.index[1]) * sizeof(double));
    if (beyond_end(a, node, &swept) || swept_before(a, node, offset))
        return false;
    int k = axis->paths++;
    a->swept[k] = swept;
    snprintf(axis->path[k], sizeof axis->path[k], "%s", node->text);
    axis->integer[k] = integer;
    axis->whole[k] = integer || swept.field->whole;
    axis->enumeration[k] = swept.field->type == FIELD_WORD;
    axis->offset[k] = offset;
    axis->words = axis->words || axis->enumeration[k];
    axis->design = axis->design || swept.field->design;

    if (!is_sought(a)) {
        struct seen *seen = &a->r->seen[swept.field - a->r->schema->field];
        seen->swept = true;
        seen->sweep = node->mark;
    }
    return true;
}

static bool read_paths(struct axis_reader *a)
{
    const struct tree_node *path = tree_find(a->node, "path"), *paths = tree_find(a->node, "paths");
    if (!path && !paths)
        return axis_complain(a, "path is missing");
    if (path && paths)
        return axis_complain(a, "path and paths exclude each other");
    if (path)
        return axis_read_path(a, path);
    bool good =
        field_list(&a->r->problems, a->name, "a list of paths", paths, SCENARIO_MAX_PATHS, "paths");
    if (!good)
        return false;
    for (size_t k = 0; k < paths->count && (good || a->axis->paths < SCENARIO_MAX_PATHS); k++)
        good = axis_read_path(a, paths->item[k]) && good;
    return good;
}

/* ---- points ---------------------------------------------------------------------------------- */

static bool read_one(struct axis_reader *a, const char *key, const struct tree_node *node, int k,
                     double *value)
{
    if (!field_value(&a->r->problems, a->swept[k].field, a->axis->path[k], node, value))
        return false;
    return !key || isfinite(*value) ||
           problem_add(&a->r->problems, node->mark, "%s: %s must be a number", a->name, key);
}

/* Values of the mapping's paths at one point. */
static bool read_row(struct axis_reader *a, const char *key, const struct tree_node *node,
                     double *value)
{
    const size_t paths = (size_t)(a->axis->paths - a->first);
    char wanted[80];
    bool good = true;

    if (!a->rows)
        return read_one(a, key, node, a->first, value);
    snprintf(wanted, sizeof wanted, "a list of %zu values, one for each path", paths);
    if (node->kind != TREE_LIST)
        return field_mismatch(&a->r->problems, a->name, wanted, node);
    if (node->count != paths)
        return problem_add(&a->r->problems, node->mark, "%s: expected %s, found %zu", a->name,
                           wanted, node->count);
    for (size_t k = 0; k < paths; k++)
        good = read_one(a, key, node->item[k], a->first + (int)k, &value[k]) && good;
    return good;
}

bool axis_read_list(struct axis_reader *a, const struct tree_node *values, double **value,
                    size_t *count)
{
    const size_t paths = (size_t)(a->axis->paths - a->first);
    bool good = true;
    if (!field_list(&a->r->problems, a->name, "a list of values", values, 0, NULL))
        return false;
    *count = values->count;
    *value = calloc(*count * paths, sizeof **value);
    if (!*value)
        return problem_no_memory(&a->r->problems);
    for (size_t i = 0; i < *count; i++)
        good = read_row(a, NULL, values->item[i], *value + i * paths) && good;
    return good;
}

bool axis_read_ends(struct axis_reader *a, const char *wanted, double *from, double *to)
{
    const struct tree_node *const first = tree_find(a->node, "from");
    const struct tree_node *const last = tree_find(a->node, "to");
    char text[160];
    for (int k = a->first; k < a->axis->paths; k++) {
        if (a->axis->enumeration[k]) {
            snprintf(text, sizeof text, "%s takes words: list them as values", a->axis->path[k]);
            return axis_complain(a, text);
        }
    }
    if (!first)
        return axis_complain(a, last || tree_find(a->node, "count") ? "from is missing" : wanted);
    const bool good = read_row(a, "from", first, from);
    memcpy(to, from, (size_t)(a->axis->paths - a->first) * sizeof *to);
    return (!last || read_row(a, "to", last, to)) && good;
}

static bool read_values(struct axis_reader *a, const struct tree_node *values)
{
    struct scenario_axis *axis = a->axis;
    const size_t paths = (size_t)axis->paths;
    bool good = axis_read_list(a, values, &axis->value, &axis->count);
    if (good && axis->words) {
        axis->word = calloc(axis->count * paths, sizeof *axis->word);
        good = axis->word || problem_no_memory(&a->r->problems);
    }
    for (size_t i = 0; good && axis->word && i < axis->count * paths; i++) {
        const struct tree_node *const point = values->item[i / paths];
        axis->word[i] = strdup(a->rows ? point->item[i % paths]->text : point->text);
        good = axis->word[i] || problem_no_memory(&a->r->problems);
    }
    return good && axis_check_values(a, values);
}

bool axis_read_key(struct axis_reader *a, const char *key, double *value)
{
    const struct tree_node *const node = tree_find(a->node, key);
    char path[AXIS_NAME], name[AXIS_NAME + 16];
    snprintf(path, sizeof path, "%s.%.16s", a->path, key);
    snprintf(name, sizeof name, "%s.%.14s", a->name, key);
    const struct scenario_field *const field = schema_find(a->r->schema, path);
    *value = field->fallback;
    return !node || field_value(&a->r->problems, field, name, node, value);
}

/* The points of a range that is logarithmic, or along which several paths move: from[paths] to
 * to[paths]. */
static bool compute_points(struct axis_reader *a, const double *from, const double *to)
{
    struct scenario_axis *axis = a->axis;
    const size_t paths = (size_t)axis->paths;
    for (size_t k = 0; k < paths && axis->log; k++)
        if (from[k] <= 0 || to[k] <= 0)
            return problem_add(&a->r->problems, tree_find(a->node, "spacing")->mark,
                               "%s: spacing log needs from and to above 0", a->name);
    if ((double)axis->count * (double)paths > MOST_KEPT_POINTS) {
        return problem_add(&a->r->problems,
                           axis->log ? tree_find(a->node, "spacing")->mark : a->node->mark,
                           "%s: %s has at most %.0f points", a->name,
                           paths > 1 ? "a range of several paths" : "spacing log",
                           MOST_KEPT_POINTS / (double)paths);
    }
    axis->value = malloc(axis->count * paths * sizeof *axis->value);
    if (!axis->value)
        return problem_no_memory(&a->r->problems);
    for (size_t i = 0; i < axis->count; i++) {
        const double part = axis->count > 1 ? (double)i / (double)(axis->count - 1) : 0;
        for (size_t k = 0; k < paths; k++)
            axis->value[i * paths + k] = i == 0                 ? from[k]
                                         : i + 1 == axis->count ? to[k]
                                         : axis->log ? from[k] * pow(to[k] / from[k], part)
                                                     : from[k] + part * (to[k] - from[k]);
    }
    return true;
}

/* What `from`, `to` and `count` must be to each other, of path k. */
static bool check_range(struct axis_reader *a, int k, double from, double to)
{
    const size_t count = a->axis->count;
    const char *wrong = NULL;

    if (count > 1 && !tree_find(a->node, "to"))
        wrong = "to is missing";
    else if (count > 1 && k == 0 && from == to)
        wrong = a->axis->paths > 1 ? "from and to are equal in the first path, whose values name "
                                     "the points"
                                   : "from and to are equal: use count 1";
    else if (count == 1 && from != to)
        wrong = "count 1 leaves no room for to";
    else if (a->axis->whole[k] && count > 1 && fmod(to - from, (double)(count - 1)) != 0)
        wrong = "this count leads to values that are not whole numbers";
    if (wrong)
        axis_complain(a, wrong);
    return !wrong;
}

static bool read_range(struct axis_reader *a)
{
    struct scenario_axis *axis = a->axis;
    double first[SCENARIO_MAX_PATHS] = {0}, last[SCENARIO_MAX_PATHS] = {0}, count, spacing;

    bool good = axis_read_ends(a, "give from, to and count, or values", first, last);
    if (!tree_find(a->node, "count"))
        return good && axis_complain(a, "count is missing");
    good = axis_read_key(a, "count", &count) && good;
    good = axis_read_key(a, "spacing", &spacing) && good;
    if (!good)
        return false;
    axis->count = (size_t)count;
    axis->log = spacing != 0;
    axis->from = first[0];
    axis->to = last[0];
    for (int k = 0; k < axis->paths; k++)
        if (!check_range(a, k, first[k], last[k]))
            return false;
    return ((!axis->log && axis->paths == 1) || compute_points(a, first, last)) &&
           axis_check_points(a);
}

/* ---- axes ------------------------------------------------------------------------------------ */

void axis_describe(const struct axis_reader *a, int k, char unit[24], char text[160])
{
    const struct scenario_field *field = a->swept[k].field;
    snprintf(unit, 24, "%s", field->unit[0] ? field->unit : "1");
    if (field->columns > 0) { /* gains on angles, then on rates */
        const bool angle = a->swept[k].index[1] < field->columns / 2;
        snprintf(unit, 24, "%s", angle ? "N m/rad" : "N m s/rad");
    }
    snprintf(text, 160, "%s", field->text);
}

bool axis_begin(struct axis_reader *a, const char *wanted)
{
    static const char *const range_keys[] = {"from", "to", "count", "spacing"};
    struct problems *problems = &a->r->problems;
    const size_t before = problems->count + problems->lost;
    if (a->node->kind != TREE_MAP)
        return field_mismatch(problems, a->name, wanted, a->node);
    reader_check_keys(a->r, a->node, a->path, a->name);
    a->first = a->axis->paths;
    a->rows = tree_find(a->node, "paths") != NULL;
    if (problems->count + problems->lost != before || !read_paths(a))
        return false;
    for (size_t i = 0; i < sizeof range_keys / sizeof range_keys[0]; i++)
        if (tree_find(a->node, "values") && tree_find(a->node, range_keys[i]))
            return problem_add(problems, a->node->mark, "%s: values and %s exclude each other",
                               a->name, range_keys[i]);
    return true;
}

static bool read_axis(struct axis_reader *a)
{
    struct scenario_axis *axis = a->axis;

    axis->line = a->node->mark.line;
    axis->column = a->node->mark.column;
    if (!axis_begin(a, "a mapping with path, from, to, count"))
        return false;
    snprintf(axis->name, sizeof axis->name, "%s", axis->path[0]);
    axis_describe(a, 0, axis->unit, axis->text);
    for (int k = 1; k < axis->paths; k++) {
        const size_t used = strlen(axis->text);
        snprintf(axis->text + used, sizeof axis->text - used, "%s %s", k > 1 ? "," : "; with",
                 axis->path[k]);
    }
    const struct tree_node *values = tree_find(a->node, "values");
    return values ? read_values(a, values) : read_range(a);
}

void sweep_read(struct reader *r, const struct tree_node *grid)
{
    struct scenario *s = r->s;

    r->axes_bad =
        !field_list(&r->problems, "sweep.grid", "a list of axes", grid, SCENARIO_MAX_AXES, "axes");
    if (r->axes_bad)
        return;
    for (size_t i = 0; i < grid->count; i++) {
        struct axis_reader a = {.r = r,
                                .axis = &s->axis[i],
                                .swept = r->swept[i],
                                .node = grid->item[i],
                                .number = (int)i,
                                .path = "sweep.grid[]"};
        snprintf(a.name, sizeof a.name, "sweep.grid[%zu]", i);
        s->axes = (int)i + 1;
        if (!read_axis(&a)) {
            r->axes_bad = true;
        } else if ((double)a.axis->count > MOST_CASES / (double)s->cases) {
            if (!r->axes_bad) {
                problem_add(&r->problems, a.node->mark,
                            "sweep.grid: the axes up to this one make more than 2^53 cases");
            }
            r->axes_bad = true;
        } else {
            s->cases *= a.axis->count;
        }
    }
}

/* ---- refinement ------------------------------------------------------------------------------ */

/* What is stored must leave room for cases that are not simulated. */
static void check_refined_record(struct reader *r)
{
    const struct scenario *s = r->s;
    const uint64_t needed = 1u << STANCE_ANSWER_outcome | 1u << STANCE_ANSWER_evidence;

    if (s->record_cases == RECORD_ALL) {
        reader_refuse(r, "record.cases",
                      " all has no meaning with sweep.refine: list those to be recorded");
    }
    if ((s->answers & needed) != needed)
        reader_refuse(r, "record.answers", ": sweep.refine needs outcome and evidence among them");
}

void sweep_read_refine(struct reader *r)
{
    struct scenario *s = r->s;
    const struct seen *seen = reader_seen(r, "sweep.refine");
    const struct tree_node *const along = reader_seen(r, "sweep.refine.along")->node;
    char path[sizeof s->axis[0].name] = ""; /* of the only axis; "": all */
    bool any = false, good = true;

    if (!seen->node || seen->bad)
        return;
    const struct scenario_refine refine = {
        .given = true,
        .start = (size_t)reader_number(r, "sweep.refine.start", &good),
        .margin = (size_t)reader_number(r, "sweep.refine.margin", &good),
        .probes = reader_number(r, "sweep.refine.probes", &good),
    };
    if (!reader_seen(r, "sweep.grid")->node) {
        reader_refuse(r, "sweep.refine", " needs sweep.grid: axes to refine");
        return;
    }
    good = good &&
           (!along || field_text(&r->problems, "sweep.refine.along", along, path, sizeof path));
    if (!good || r->axes_bad)
        return;
    s->refine = refine;
    for (int a = 0; a < s->axes; a++) {
        struct scenario_axis *axis = &s->axis[a];
        axis->refined = !axis->words && !axis->sample && axis->count > s->refine.start &&
                        (!along || strcmp(axis->name, path) == 0);
        any = any || axis->refined;
    }
    if (!any && along)
        reader_refuse(r, "sweep.refine.along",
                      ": no axis of numbers on the grid is %s and has more points than start, %zu",
                      path, s->refine.start);
    else if (!any)
        reader_refuse(r, "sweep.refine", ": no axis of numbers has more points than start, %zu",
                      s->refine.start);
    else if ((double)s->cases > SCENARIO_MOST_REFINED)
        reader_refuse(r, "sweep.refine",
                      ": %llu cases are more than the %.0f that it can keep in memory",
                      (unsigned long long)s->cases, SCENARIO_MOST_REFINED);
    check_refined_record(r);
}

void sweep_free(struct scenario_axis *axis)
{
    if (axis->word)
        for (size_t i = 0; i < axis->count * (size_t)axis->paths; i++)
            free(axis->word[i]);
    for (int k = 0; axis->meaning && k < axis->paths; k++)
        free(axis->meaning[k].words);
    free(axis->word);
    free(axis->value);
    free(axis->meaning);
    axis->word = NULL;
    axis->value = NULL;
    axis->meaning = NULL;
}

/* ---- values of cases ------------------------------------------------------------------------- */

double scenario_axis_value(const struct scenario_axis *axis, size_t i, int k)
{
    if (axis->value)
        return axis->value[i * (size_t)axis->paths + (size_t)k];
    if (i + 1 == axis->count)
        return axis->to;
    return axis->from + (double)i * (axis->to - axis->from) / (double)(axis->count - 1);
}

bool scenario_ends(const double *value, size_t count, size_t stride, size_t ends[2])
{
    size_t low = 0, high = 0, rises = 0, falls = 0;
    for (size_t i = 1; value && i < count; i++) {
        const double here = value[i * stride], before = value[(i - 1) * stride];
        low = here < value[low * stride] ? i : low;
        high = here > value[high * stride] ? i : high;
        rises += here >= before;
        falls += here <= before;
    }
    const bool sorted = !value || count < 2 || rises == count - 1 || falls == count - 1;
    ends[0] = sorted ? 0 : low;
    ends[1] = sorted ? count - 1 : high;
    return sorted;
}

bool scenario_is_start(const char *path)
{
    return (strncmp(path, "initial.offset.", 15) == 0 ||
            strncmp(path, "initial.state.", 14) == 0) &&
           strcmp(path, "initial.offset.scale") != 0;
}

const struct scenario_axis *scenario_axis_of(const struct scenario *s, size_t offset, int *k)
{
    for (int a = 0; a < s->axes; a++)
        for (*k = 0; *k < s->axis[a].paths; ++*k)
            if (s->axis[a].offset[*k] == offset)
                return &s->axis[a];
    return NULL;
}

bool scenario_takes(const struct scenario *s, size_t offset, int word)
{
    int base, k;
    const struct scenario_axis *const axis = scenario_axis_of(s, offset, &k);

    for (size_t i = 0; axis && axis->value && i < axis->count; i++)
        if ((int)scenario_axis_value(axis, i, k) == word)
            return true;
    memcpy(&base, (const char *)&s->base + offset, sizeof base);
    return !(axis && axis->value) && base == word;
}

void scenario_extent(const struct scenario *s, size_t offset, double *least, double *largest)
{
    int k;
    const struct scenario_axis *axis = scenario_axis_of(s, offset, &k);

    memcpy(least, (const char *)&s->base + offset, sizeof *least);
    *largest = *least;
    if (!axis || axis->count == 0)
        return;
    size_t ends[2];
    scenario_ends(axis->value ? axis->value + k : NULL, axis->count, (size_t)axis->paths, ends);
    const double first = scenario_axis_value(axis, ends[0], k),
                 last = scenario_axis_value(axis, ends[1], k);
    *least = fmin(first, last);
    *largest = fmax(first, last);
}

void scenario_axis_text(const struct scenario_axis *axis, size_t i, int k, char *buffer,
                        size_t size)
{
    if (axis->word && axis->word[i * (size_t)axis->paths + (size_t)k]) {
        snprintf(buffer, size, "%s", axis->word[i * (size_t)axis->paths + (size_t)k]);
        return;
    }
    double value = scenario_axis_value(axis, i, k);
    if (axis->meaning && axis->meaning[k].words) {
        const char *word = axis->meaning[k].words;
        for (int skipped = 0; skipped < (int)value && strchr(word, ' '); skipped++)
            word = strchr(word, ' ') + 1;
        snprintf(buffer, size, "%.*s", (int)strcspn(word, " "), word);
        return;
    }
    if (isinf(value)) {
        snprintf(buffer, size, "none");
        return;
    }
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(buffer, size, "%.*g", digits, value);
        if (strtod(buffer, NULL) == value)
            return;
    }
}

void scenario_case_keys(const struct scenario *s, uint64_t index, uint64_t *grid, uint64_t *sample)
{
    const uint64_t points = s->sample.given ? s->axis[s->axes - 1].count : 1;
    *grid = index / points;
    *sample = index % points;
}

void scenario_put(struct scenario_values *values, size_t offset, bool integer, double value)
{
    const int whole = integer ? (int)value : 0;
    memcpy((char *)values + offset, integer ? (const void *)&whole : (const void *)&value,
           integer ? sizeof whole : sizeof value);
}

void scenario_case_values(const struct scenario *s, uint64_t index, struct scenario_values *values)
{
    *values = s->base;
    for (int a = s->axes - 1; a >= 0; a--) {
        const struct scenario_axis *axis = &s->axis[a];
        size_t point = (size_t)(index % axis->count);
        index /= axis->count;
        for (int k = 0; k < axis->paths; k++) {
            scenario_put(values, axis->offset[k], axis->integer[k],
                         scenario_axis_value(axis, point, k));
        }
    }
}
