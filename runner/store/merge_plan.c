/* merge_plan.c - how the scenarios of parts differ, and the scenario of them all. */
#include "merge.h"

#include "runner/base/message.h"
#include "runner/base/numbers.h"
#include "runner/base/words.h"
#include "runner/scenario/field.h"

#include <math.h>
#include <stdlib.h>

/* ---- how the parts fit -------------------------------------------------------------------- */

enum { MOST_DIFFERENCES = 64, PATH = 128 };

struct differences {
    struct merge *m;
    size_t part; /* that is compared with the first one */
    char path[MOST_DIFFERENCES][PATH];
    size_t count;
    size_t last; /* the part that had another one */
    bool others; /* what stands at the first of the paths is no scalar in each */
};

/* Names do not matter, and lists of recorded cases are united. */
static void note(void *context, const char *path, const struct tree_node *before,
                 const struct tree_node *after)
{
    struct differences *const found = context;
    char **const value = &found->m->part[found->part].value,
                 **const first = &found->m->part[0].value;
    size_t i = 0;
    if (strcmp(path, "title") == 0 || strncmp(path, "record.cases", strlen("record.cases")) == 0)
        return;
    while (i < found->count && strcmp(found->path[i], path) != 0)
        i++;
    if (i == found->count && i < MOST_DIFFERENCES) {
        snprintf(found->path[found->count++], PATH, "%s", path);
        found->last = found->part;
    }
    if (i == 0 && before && after && before->kind == TREE_SCALAR && after->kind == TREE_SCALAR) {
        *value = strdup(after->text);
        *first = *first ? *first : strdup(before->text);
    }
    found->others = found->others || (i == 0 && !(*value && *first));
}

/* "sweep.grid[2].from" is of axis 2; -1: of none. */
static int axis_of(const char *path)
{
    int axis = -1;
    return sscanf(path, "sweep.grid[%d]", &axis) == 1 ? axis : -1;
}

/* A value that stands in every part may become an axis, but for some. */
static bool is_value(const char *path)
{
    static const char *const fixed[] = {"stance",
                                        "title",
                                        "scene",
                                        "seed",
                                        "sweep",
                                        "record",
                                        "controller.source",
                                        "controller.file",
                                        "controller.data"};
    for (size_t i = 0; i < sizeof fixed / sizeof fixed[0]; i++) {
        const size_t length = strlen(fixed[i]);
        if (strncmp(path, fixed[i], length) == 0 && (!path[length] || strchr(".[", path[length])))
            return false;
    }
    return true;
}

static bool classify(struct merge *m, const struct differences *found)
{
    char list[84] = "";
    if (found->count == 0)
        return true;
    int axis = axis_of(found->path[0]);
    for (size_t i = 1; i < found->count; i++)
        axis = axis_of(found->path[i]) == axis ? axis : -1;
    m->axis = axis >= 0 ? axis : 0;
    m->kind = axis >= 0 ? MERGE_AXIS : MERGE_VALUE;
    snprintf(m->path, sizeof m->path, "%s", found->path[0]);
    if (axis >= 0 || (found->count == 1 && !found->others && is_value(m->path)))
        return true;
    for (size_t i = 0; i < found->count && strlen(list) + 41 < sizeof list; i++)
        words_add(list, sizeof list, "%s%.38s", i ? ", " : "", found->path[i]);
    return complain(
        &m->message,
        "%.32s: differs from %.32s in %.70s: parts may differ along one axis or in one value "
        "that can be swept",
        m->part[found->last].of.file, m->part[0].of.file, list);
}

/* Reads the tree of the first part, and how the others differ from it. */
static bool compare_parts(struct merge *m, struct tree *first)
{
    struct differences found = {.m = m};
    for (size_t p = 0; p < m->parts; p++) {
        const struct adopted *const part = &m->part[p].of;
        struct tree tree;
        /* Of the values of keys that cases of several scenarios have, a file tells those of the
         * last one. */
        m->usage = part->origin.ancestors > 0;
        if (m->usage)
            return complain(&m->message,
                            "%.120s: was made from several scenarios: it cannot be merged",
                            part->file);
        if (!adopt_tree(p == 0 ? first : &tree, part->file, part->origin.scenario, &m->message))
            return false;
        if (p > 0) {
            found.part = p;
            adopt_differ(first->root, tree.root, "", &(struct adopted_differences){note, &found});
            tree_free(&tree);
        }
    }
    m->usage = true;
    return classify(m, &found);
}

/* ---- what each part has ------------------------------------------------------------------- */

/* A point of some part along the merged axis: its text, as YAML, and its number, where it is one.
 */
struct point {
    char *text;
    double number; /* NAN: words, or several paths */
    size_t part, place;
};

/* A case that a part records, by its number there. */
struct recorded {
    size_t part;
    uint64_t row;
};

struct look {
    struct point *point; /* in the order of the parts */
    size_t points;
    bool numbers, rising, falling; /* all of them; in every part */
    struct recorded *recorded;
    size_t records;
    bool records_all; /* then all parts do, and there is no list */
    char path[SCENARIO_MAX_PATHS][96];
};

static bool add_point(struct look *look, const char *text, double number, size_t part, size_t place)
{
    struct point *const larger = realloc(look->point, (look->points + 1) * sizeof *larger);
    if (!larger)
        return false;
    look->point = larger;
    struct point *const made = &look->point[look->points];
    *made = (struct point){strdup(text), number, part, place};
    if (!made->text)
        return false;
    const double before = place > 0 ? made[-1].number : NAN;
    look->rising = look->rising && !(place > 0 && !(number > before));
    look->falling = look->falling && !(place > 0 && !(number < before));
    look->numbers = look->numbers && !isnan(number);
    look->points++;
    return true;
}

/* The points that a part has along the axis, as YAML: "0.1", or "0.1, 2" for several paths. */
static bool look_at_axis(struct merge *m, struct look *look, size_t p)
{
    struct adopted *const part = &m->part[p].of;
    const struct scenario_axis *const axis = &part->scenario->axis[m->axis];
    bool same = true;
    for (int k = 0; k < SCENARIO_MAX_PATHS; k++) {
        const char *path = k < axis->paths ? axis->path[k] : "";
        if (p == 0)
            snprintf(look->path[k], sizeof look->path[k], "%s", path);
        same = same && strcmp(path, look->path[k]) == 0;
    }
    if (!same)
        return complain(&m->message, "%.80s: its axis %.40s is not that of %.80s", part->file,
                        axis->name, m->part[0].of.file);
    if (p == 0)
        snprintf(m->path, sizeof m->path, "%s", axis->name);
    part->points = axis->count;
    for (size_t i = 0; i < axis->count; i++) {
        char text[1024] = "", value[128];
        const bool number = !axis->words && axis->paths == 1;
        for (int k = 0; k < axis->paths; k++) {
            scenario_axis_text(axis, i, k, value, sizeof value);
            words_add(text, sizeof text, "%s%s", k ? ", " : "", value);
        }
        if (!add_point(look, text, number ? scenario_axis_value(axis, i, 0) : NAN, p, i))
            return no_memory(&m->message);
    }
    return true;
}

/* The value that a part has instead of an axis. */
static bool look_at_value(struct merge *m, struct look *look, size_t p)
{
    const char *const text = m->part[p].value ? m->part[p].value : m->part[0].value;
    double number;
    bool finite;
    if (!text)
        return no_memory(&m->message);
    if (!number_parse(text, &number, &finite))
        number = strcmp(text, "none") == 0 ? INFINITY : NAN;
    m->part[p].of.points = 1;
    return add_point(look, text, number, p, 0) || no_memory(&m->message);
}

/* Which cases a part records; one that records all needs no list, but then all have to. */
static bool look_at_records(struct merge *m, struct look *look, size_t p)
{
    const struct scenario *const s = m->part[p].of.scenario;
    const bool all = s->record_cases == RECORD_ALL;
    if (p == 0)
        look->records_all = all;
    if (all != look->records_all)
        return complain(&m->message, "%.60s: record.cases is `all` in some of the files only",
                        m->part[p].of.file);
    struct recorded *const larger =
        realloc(look->recorded, (look->records + s->record_count + 1) * sizeof *larger);
    if (!larger)
        return no_memory(&m->message);
    look->recorded = larger;
    for (size_t i = 0; i < s->record_count; i++)
        larger[look->records++] = (struct recorded){p, s->record_list[i]};
    return true;
}

static bool look_at_parts(struct merge *m, struct look *look)
{
    bool good = true;
    for (size_t p = 0; good && p < m->parts; p++) {
        struct adopted *const part = &m->part[p].of;
        if (!adopt_scenario(part, &m->message))
            return false;
        part->inner = part->scenario->cases;
        for (int a = 0; m->kind == MERGE_AXIS && a <= m->axis; a++)
            part->inner /= part->scenario->axis[a].count;
        good = look_at_records(m, look, p) &&
               (m->kind == MERGE_EQUAL ||
                (m->kind == MERGE_AXIS ? look_at_axis(m, look, p) : look_at_value(m, look, p)));
        adopt_close(part);
    }
    return good;
}

/* ---- points of the merged axis ------------------------------------------------------------ */

static int by_number(const void *left, const void *right)
{
    const struct point *a = left, *b = right;
    const int order = (a->number > b->number) - (a->number < b->number);
    return order ? order : (a->part > b->part) - (a->part < b->part);
}

static int by_number_falling(const void *left, const void *right)
{
    return by_number(right, left);
}

/* Finds the place of every point in the merged axis; only the first of equal ones is kept in the
 * list, which is then the axis. */
static bool place_points(struct merge *m, struct look *look)
{
    for (size_t p = 0; p < m->parts; p++) {
        struct adopted *const part = &m->part[p].of;
        part->position = calloc(part->points + 1, sizeof *part->position);
        if (!part->position)
            return no_memory(&m->message);
    }
    const bool sort = look->numbers && (look->rising || look->falling);
    if (sort && look->points > 1)
        qsort(look->point, look->points, sizeof *look->point,
              look->rising ? by_number : by_number_falling);
    size_t kept = 0;
    for (size_t i = 0; i < look->points; i++) {
        struct point *const point = &look->point[i], moved = *point;
        size_t at = sort && kept > 0 ? kept - 1 : 0; /* equal ones are neighbours when sorted */
        while (at < kept && (look->numbers ? look->point[at].number != point->number
                                           : strcmp(look->point[at].text, point->text) != 0))
            at++;
        m->part[point->part].of.position[point->place] = at;
        if (at == kept) {
            *point = look->point[kept];
            look->point[kept++] = moved;
        }
    }
    m->points = kept;
    for (size_t p = 0; p < m->parts; p++)
        m->part[p].of.all = kept;
    return true;
}

/* ---- the merged scenario ------------------------------------------------------------------ */

/* Values `first`, `last` and their number give all of them, to the bit. */
static bool is_range(const struct look *points, size_t count)
{
    if (!points->numbers || count < 3)
        return false;
    const double from = points->point[0].number, to = points->point[count - 1].number;
    bool same = isfinite(from) && isfinite(to);
    for (size_t i = 0; same && i + 1 < count; i++)
        same = points->point[i].number == from + (double)i * (to - from) / (double)(count - 1);
    return same;
}

/* "sweep.grid[AXIS]={path: ..., values: [...]}"; freed by the caller. */
static char *axis_setting(struct merge *m, const struct look *points, int axis,
                          const struct tree_node *paths)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = points->point ? open_memstream(&text, &size) : NULL;
    if (!out)
        return NULL;
    fprintf(out, "sweep.grid[%d]={", axis);
    if (paths) {
        fputs("paths: [", out);
        for (size_t k = 0; k < paths->count; k++)
            fprintf(out, "%s%s", k ? ", " : "", paths->item[k]->text);
        fputs("]", out);
    } else {
        fprintf(out, "path: %s", m->path);
    }
    if (!paths && is_range(points, m->points)) {
        fprintf(out, ", from: %s, to: %s, count: %zu}", points->point[0].text,
                points->point[m->points - 1].text, m->points);
    } else {
        fputs(", values: [", out);
        for (size_t i = 0; i < m->points; i++) {
            fprintf(out, "%s%s%s%s", i ? ", " : "", paths ? "[" : "", points->point[i].text,
                    paths ? "]" : "");
        }
        fputs("]}", out);
    }
    const bool good = !ferror(out);
    if (fclose(out) != 0 || !good) {
        free(text);
        return NULL;
    }
    return text;
}

static struct tree_node *grid_of(const struct tree *tree)
{
    struct tree_node *sweep = tree_find(tree->root, "sweep");
    return sweep && sweep->kind == TREE_MAP ? tree_find(sweep, "grid") : NULL;
}

/* Gives the tree of the first part the merged axis. */
static bool set_axis(struct merge *m, const struct look *points, struct tree *tree,
                     struct problems *problems)
{
    struct tree_node *grid = grid_of(tree);
    const size_t axes = grid ? grid->count : 0;
    const struct tree_node *paths =
        grid && m->kind == MERGE_AXIS ? tree_find(grid->item[m->axis], "paths") : NULL;
    char *setting = axis_setting(m, points, m->kind == MERGE_AXIS ? m->axis : (int)axes, paths);
    const bool good = setting && tree_set(tree, setting, 1, problems);
    free(setting);
    grid = grid_of(tree);
    if (good && m->kind == MERGE_VALUE && grid && grid->count == axes + 1) { /* to the front */
        struct tree_node *made = grid->item[axes];
        memmove(grid->item + 1, grid->item, axes * sizeof(struct tree_node *));
        grid->item[0] = made;
    }
    return good;
}

/* record.cases lists cases by their number, which the merged axis changes. The text of the first
 * part is left where it says the same. */
static bool set_recorded(struct merge *m, const struct look *look, struct tree *tree,
                         struct problems *problems)
{
    uint64_t *row = calloc(look->records + 1, sizeof *row);
    char *text = NULL;
    size_t size = 0;
    FILE *out = row ? open_memstream(&text, &size) : NULL;
    bool same = true, good = out != NULL;
    for (size_t i = 0; row && i < look->records; i++)
        row[i] = adopt_row(&m->part[look->recorded[i].part].of, look->recorded[i].row);
    const size_t count = row ? numbers_unite(row, look->records) : 0;
    for (size_t i = 0; i < count && i < look->records; i++)
        same = same && look->recorded[i].part == 0 && look->recorded[i].row == row[i];
    if (good) {
        fputs("record.cases=", out);
        for (size_t i = 0; i < count; i++)
            fprintf(out, "%s%llu", i ? ", " : "[", (unsigned long long)row[i]);
        fputs("]", out);
        good = fclose(out) == 0 && (same || tree_set(tree, text, 1, problems));
    }
    free(row);
    free(text);
    return good || no_memory(&m->message);
}

static bool read_merged(struct merge *m, const struct tree *tree)
{
    char *text = tree_write(tree->root);
    struct scenario *const s = m->scenario =
        text ? adopt_text("the merged scenario", text, &m->message) : NULL;
    const struct adopted *const first = &m->part[0].of;
    if (!text)
        no_memory(&m->message);
    free(text);
    if (!s)
        return false;
    if (first->origin.title)
        snprintf(s->title, sizeof s->title, "%s", first->origin.title);
    /* Computed axes as the first file has them: they may differ in last bits between processors. */
    const int before = m->kind == MERGE_EQUAL ? s->axes : m->axis;
    return store_read_axes(first->file, s->axis, before, &m->message) &&
           (before == s->axes ||
            store_read_axes(first->file, s->axis + before + 1, s->axes - before - 1, &m->message));
}

/* Of the tree of the first part, which is changed. */
static bool make_scenario(struct merge *m, struct tree *tree)
{
    struct look look = {.numbers = true, .rising = true, .falling = true};
    struct problems *problems = calloc(1, sizeof *problems);
    bool good = problems ? look_at_parts(m, &look) : no_memory(&m->message);

    if (good && m->kind != MERGE_EQUAL) {
        good = place_points(m, &look);
        if (good && !set_axis(m, &look, tree, problems)) {
            good = no_memory(&m->message);
            if (problems->count > 0)
                complain(&m->message, "the merged axis: %.200s", problems->list[0].text);
        }
    }
    good = good && set_recorded(m, &look, tree, problems) && read_merged(m, tree);
    free(problems);
    for (size_t i = 0; i < look.points; i++)
        free(look.point[i].text);
    free(look.point);
    free(look.recorded);
    return good;
}

/* ---- parts -------------------------------------------------------------------------------- */

/* Where random numbers come in: half-width of the noise, probes. */
static bool has_random_numbers(const struct scenario *s)
{
    static const size_t noise[] = {offsetof(struct scenario_values, noise),
                                   offsetof(struct scenario_values, angle_noise),
                                   offsetof(struct scenario_values, rate_noise)};
    double least, largest = 0;
    for (size_t k = 0; k < sizeof noise / sizeof noise[0] && !(largest > 0); k++)
        scenario_extent(s, noise[k], &least, &largest);
    return largest > 0 || (s->refine.given && s->refine.probes > 0);
}

bool merge_plan(struct merge *m, const char *const *files, size_t count)
{
    struct tree tree = {0};
    *m = (struct merge){.points = 1};
    m->part = calloc(count, sizeof *m->part);
    bool good = m->part || no_memory(&m->message);
    for (size_t p = 0; good && p < count; p++) {
        struct adopted *const part = &m->part[p].of;
        part->file = files[p];
        good = store_check(part->file, true, &m->message) &&
               store_read_origin(part->file, &part->origin, &m->message);
        m->parts += good;
    }
    good = good && compare_parts(m, &tree) && make_scenario(m, &tree);
    for (size_t p = 0; good && p < count; p++)
        good =
            store_same_points(m->part[p].of.file, &m->part[p].of.origin, m->scenario, &m->message);
    tree_free(&tree);
    if (good && m->kind != MERGE_EQUAL) {
        m->noted[MERGE_KEYED] = has_random_numbers(m->scenario);
        m->noted[MERGE_REFINED] = m->scenario->axis[m->axis].refined;
    }
    return good;
}

void merge_free(struct merge *m)
{
    for (size_t p = 0; p < m->parts; p++) {
        store_origin_free(&m->part[p].of.origin);
        free(m->part[p].of.position);
        free(m->part[p].value);
    }
    free(m->part);
    scenario_drop(m->scenario);
    *m = (struct merge){0};
}
