/* merge_plan.c - how the scenarios of parts differ, and the scenario of them all. */
#include "merge.h"

#include "runner/base/message.h"
#include "runner/base/numbers.h"
#include "runner/base/words.h"
#include "runner/scenario/field.h"
#include "runner/scenario/tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- scenarios as trees ------------------------------------------------------------------- */

static bool read_tree(struct merge *m, struct tree *tree, const struct merge_part *part)
{
    struct problems *problems = calloc(1, sizeof *problems);
    *tree = (struct tree){0};
    const bool good =
        problems && part->of.origin.scenario &&
        tree_parse(tree, part->of.origin.scenario, strlen(part->of.origin.scenario), problems);
    free(problems);
    if (!good)
        complain(&m->message, "%.100s: its scenario cannot be read", part->of.file);
    return good;
}

enum { MOST_DIFFERENCES = 64, PATH = 128 };

struct differences {
    char path[MOST_DIFFERENCES][PATH];
    size_t count;
};

static void note(struct differences *found, const char *path)
{
    for (size_t i = 0; i < found->count; i++)
        if (strcmp(found->path[i], path) == 0)
            return;
    if (found->count < MOST_DIFFERENCES)
        snprintf(found->path[found->count++], PATH, "%s", path);
}

static void find_differences(const struct tree_node *a, const struct tree_node *b, const char *path,
                             struct differences *found)
{
    char below[PATH];
    if (!a || !b || a->kind != b->kind || (a->kind == TREE_LIST && a->count != b->count) ||
        (a->kind == TREE_SCALAR && strcmp(a->text, b->text) != 0)) {
        note(found, path);
        return;
    }
    for (size_t i = 0; i < a->count; i++) {
        if (a->kind == TREE_LIST) {
            snprintf(below, sizeof below, "%.100s[%zu]", path, i);
            find_differences(a->item[i], b->item[i], below, found);
        } else {
            const char *key = a->key[i].name;
            snprintf(below, sizeof below, "%.60s%s%.64s", path, path[0] ? "." : "", key);
            find_differences(a->item[i], tree_find(b, key), below, found);
        }
    }
    for (size_t i = 0; b->kind == TREE_MAP && i < b->count; i++) {
        if (!tree_find(a, b->key[i].name)) {
            snprintf(below, sizeof below, "%.60s%s%.64s", path, path[0] ? "." : "", b->key[i].name);
            note(found, below);
        }
    }
}

/* The text of the scalar at a path; NULL: there is none. */
static const char *text_at(const struct tree_node *node, const char *path)
{
    char name[TREE_MAX_NAME];
    size_t index;
    for (bool first = true; node && *path; first = false) {
        if (!tree_path_step(&path, first, name, &index))
            return NULL;
        node = name[0]                                          ? tree_find(node, name)
               : node->kind == TREE_LIST && index < node->count ? node->item[index]
                                                                : NULL;
    }
    return node && node->kind == TREE_SCALAR ? node->text : NULL;
}

/* ---- how the parts fit -------------------------------------------------------------------- */

/* "sweep.grid[2].from" is of axis 2; -1: of none. */
static int axis_of(const char *path)
{
    int axis = -1;
    return sscanf(path, "sweep.grid[%d]", &axis) == 1 ? axis : -1;
}

static bool misfit(struct merge *m, const struct differences *found, size_t part)
{
    char list[84] = "";
    for (size_t i = 0; i < found->count && strlen(list) + 41 < sizeof list; i++)
        words_add(list, sizeof list, "%s%.38s", i ? ", " : "", found->path[i]);
    return complain(
        &m->message,
        "%.32s: differs from %.32s in %.70s: parts may differ along one axis or in one value "
        "that can be swept",
        m->part[part].of.file, m->part[0].of.file, list);
}

/* A value that stands in every part and may become an axis. */
static bool is_value(struct merge *m, const struct tree *trees, const char *path)
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
    for (size_t p = 0; p < m->parts; p++)
        if (!text_at(trees[p].root, path))
            return false;
    return true;
}

static bool classify(struct merge *m, const struct tree *trees)
{
    struct differences found = {.count = 0};
    size_t last = 0;
    for (size_t p = 1; p < m->parts; p++) {
        const size_t before = found.count;
        find_differences(trees[0].root, trees[p].root, "", &found);
        last = found.count > before ? p : last;
    }
    for (size_t i = found.count; i-- > 0;) { /* names do not matter; lists are united */
        if (strcmp(found.path[i], "title") == 0 ||
            strncmp(found.path[i], "record.cases", strlen("record.cases")) == 0) {
            memmove(found.path[i], found.path[found.count - 1], PATH);
            found.count--;
        }
    }
    if (found.count == 0) {
        m->kind = MERGE_EQUAL;
        return true;
    }
    m->axis = axis_of(found.path[0]);
    for (size_t i = 1; i < found.count; i++)
        m->axis = axis_of(found.path[i]) == m->axis ? m->axis : -1;
    if (m->axis >= 0) {
        m->kind = MERGE_AXIS;
        return true;
    }
    m->axis = 0;
    m->kind = MERGE_VALUE;
    snprintf(m->path, sizeof m->path, "%s", found.path[0]);
    return (found.count == 1 && is_value(m, trees, m->path)) || misfit(m, &found, last);
}

/* ---- points of the merged axis ------------------------------------------------------------ */

/* A point of some part: its text, as YAML, and its number, where it is one. */
struct point {
    char *text;
    double number; /* NAN: words, or several paths */
    size_t part, place;
    size_t order; /* in which it appeared */
};

struct points {
    struct point *point;
    size_t count, room;
    bool numbers, rising, falling; /* all of them; in every part */
};

static bool add_point(struct points *points, const char *text, double number, size_t part,
                      size_t place)
{
    if (points->count == points->room) {
        const size_t room = points->room ? 2 * points->room : 64;
        struct point *larger = realloc(points->point, room * sizeof *larger);
        if (!larger)
            return false;
        points->point = larger;
        points->room = room;
    }
    if (place > 0) {
        const double before = points->point[points->count - 1].number;
        points->rising = points->rising && number > before;
        points->falling = points->falling && number < before;
    }
    points->numbers = points->numbers && !isnan(number);
    struct point *point = &points->point[points->count];
    *point = (struct point){strdup(text), number, part, place, points->count};
    points->count += point->text != NULL;
    return point->text != NULL;
}

/* The points that a part has along the axis, as YAML: "0.1", or "0.1, 2" for several paths. */
static bool add_points(const struct scenario_axis *axis, struct points *points, size_t part)
{
    char text[1024], value[128];
    const bool number = !axis->words && axis->paths == 1;
    bool good = true;
    for (size_t i = 0; good && i < axis->count; i++) {
        text[0] = '\0';
        for (int k = 0; k < axis->paths; k++) {
            scenario_axis_text(axis, i, k, value, sizeof value);
            words_add(text, sizeof text, "%s%s", k ? ", " : "", value);
        }
        good = add_point(points, text, number ? scenario_axis_value(axis, i, 0) : NAN, part, i);
    }
    return good;
}

/* Of all parts, whose axes must have the same paths. */
static bool collect_axis(struct merge *m, struct points *points)
{
    struct scenario_axis *first = calloc(1, sizeof *first);
    bool good = first || no_memory(&m->message);
    for (size_t p = 0; good && p < m->parts; p++) {
        struct adopted *const part = &m->part[p].of;
        good = adopt_scenario(part, &m->message);
        if (!good)
            break;
        const struct scenario_axis *axis = &part->scenario->axis[m->axis];
        if (p == 0)
            *first = *axis; /* its paths, which are no pointers */
        m->part[p].points = axis->count;
        good = axis->paths == first->paths;
        for (int k = 0; good && k < axis->paths; k++)
            good = strcmp(axis->path[k], first->path[k]) == 0;
        good = good ? add_points(axis, points, p) || no_memory(&m->message)
                    : complain(&m->message, "%.80s: its axis %.40s is not that of %.80s",
                               part->file, axis->name, m->part[0].of.file);
        adopt_close(part);
    }
    snprintf(m->path, sizeof m->path, "%s", good ? first->name : "");
    free(first);
    return good;
}

/* The value that each part has instead of an axis. */
static bool collect_values(struct merge *m, const struct tree *trees, struct points *points)
{
    for (size_t p = 0; p < m->parts; p++) {
        const char *text = text_at(trees[p].root, m->path);
        double number;
        bool finite;
        if (!number_parse(text, &number, &finite))
            number = strcmp(text, "none") == 0 ? INFINITY : NAN;
        m->part[p].points = 1;
        if (!add_point(points, text, number, p, 0))
            return no_memory(&m->message);
    }
    return true;
}

static int by_number(const void *left, const void *right)
{
    const struct point *a = left, *b = right;
    return a->number != b->number ? (a->number > b->number) - (a->number < b->number)
                                  : (a->order > b->order) - (a->order < b->order);
}

static int by_number_falling(const void *left, const void *right)
{
    return by_number(right, left);
}

/* Finds the place of every point in the merged axis; only the first of equal ones is kept in the
 * list, which is then the axis. */
static bool place_points(struct merge *m, struct points *points)
{
    for (size_t p = 0; p < m->parts; p++) {
        m->part[p].position = calloc(m->part[p].points, sizeof *m->part[p].position);
        if (!m->part[p].position)
            return no_memory(&m->message);
    }
    const bool sort = points->numbers && (points->rising || points->falling);
    if (sort && points->count > 1) {
        qsort(points->point, points->count, sizeof *points->point,
              points->rising ? by_number : by_number_falling);
    }
    size_t kept = 0;
    for (size_t i = 0; i < points->count; i++) {
        struct point *point = &points->point[i];
        size_t at = sort && kept > 0 ? kept - 1 : 0; /* equal ones are neighbours when sorted */
        while (at < kept && (points->numbers ? points->point[at].number != point->number
                                             : strcmp(points->point[at].text, point->text) != 0))
            at++;
        m->part[point->part].position[point->place] = at;
        if (at == kept) {
            struct point moved = *point;
            *point = points->point[kept];
            points->point[kept++] = moved;
        }
    }
    m->points = kept;
    return true;
}

/* ---- the merged scenario ------------------------------------------------------------------ */

/* Values `first`, `last` and their number give all of them, to the bit. */
static bool is_range(const struct points *points, size_t count)
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
static char *axis_setting(struct merge *m, const struct points *points, int axis,
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
static bool set_axis(struct merge *m, const struct points *points, struct tree *tree,
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

/* Cases that are recorded, by their numbers in the merged file. */
struct recorded {
    uint64_t *row;
    size_t count;
};

/* The cases that any part lists; those of a part that records all of them need no list, but then
 * all parts have to. */
static bool collect_recorded(struct merge *m, bool all, struct recorded *list)
{
    bool good = true;
    for (size_t p = 0; good && p < m->parts; p++) {
        struct merge_part *const part = &m->part[p];
        good = adopt_scenario(&part->of, &m->message);
        const struct scenario *const s = part->of.scenario;
        if (good && (s->record_cases == RECORD_ALL) != all) {
            good = complain(&m->message, "%.60s: record.cases is `all` in some of the files only",
                            part->of.file);
        } else if (good) {
            uint64_t *larger =
                realloc(list->row, (list->count + s->record_count + 1) * sizeof *larger);
            list->row = larger ? larger : list->row;
            for (size_t i = 0; larger && i < s->record_count; i++)
                larger[list->count++] = merge_row(m, part, s->record_list[i]);
            good = larger || no_memory(&m->message);
        }
        adopt_close(&part->of);
    }
    list->count = list->row ? numbers_unite(list->row, list->count) : 0;
    return good;
}

/* record.cases lists cases by their number, which the merged axis changes. `first`: the first
 * part, whose text is left where it says the same. */
static bool set_recorded(struct merge *m, const struct scenario *first, struct tree *tree,
                         struct problems *problems)
{
    struct recorded list = {.count = 0};
    char *text = NULL;
    size_t size = 0;
    bool good = collect_recorded(m, first->record_cases == RECORD_ALL, &list);
    const bool same = list.count == first->record_count &&
                      (list.count == 0 ||
                       memcmp(list.row, first->record_list, list.count * sizeof *list.row) == 0);
    FILE *out = good && !same ? open_memstream(&text, &size) : NULL;
    if (out) {
        fputs("record.cases=", out);
        for (size_t i = 0; list.row && i < list.count; i++)
            fprintf(out, "%s%llu", i ? ", " : "[", (unsigned long long)list.row[i]);
        fputs("]", out);
        fclose(out);
        good = tree_set(tree, text, 1, problems) || no_memory(&m->message);
    } else if (good && !same) {
        good = no_memory(&m->message);
    }
    free(list.row);
    free(text);
    return good;
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

static bool make_scenario(struct merge *m, struct tree *trees)
{
    struct points points = {.numbers = true, .rising = true, .falling = true};
    struct problems *problems = calloc(1, sizeof *problems);
    struct scenario *first = NULL;
    bool good = problems || no_memory(&m->message);

    if (good && m->kind != MERGE_EQUAL) {
        good = (m->kind == MERGE_AXIS ? collect_axis(m, &points)
                                      : collect_values(m, trees, &points)) &&
               place_points(m, &points);
        if (good && !set_axis(m, &points, &trees[0], problems)) {
            good = no_memory(&m->message);
            if (problems->count > 0)
                complain(&m->message, "the merged axis: %.200s", problems->list[0].text);
        }
    }
    if (good)
        first = adopt_text(m->part[0].of.file, m->part[0].of.origin.scenario, &m->message);
    good = first != NULL;
    if (good) {
        m->inner = first->cases;
        for (int a = 0; m->kind == MERGE_AXIS && a <= m->axis; a++)
            m->inner /= first->axis[a].count;
        good = set_recorded(m, first, &trees[0], problems);
    }
    scenario_drop(first);
    free(problems);
    for (size_t i = 0; i < points.count; i++)
        free(points.point[i].text);
    free(points.point);
    return good && read_merged(m, &trees[0]);
}

/* ---- parts -------------------------------------------------------------------------------- */

static bool open_parts(struct merge *m, const char *const *files, size_t count)
{
    m->part = calloc(count, sizeof *m->part);
    if (!m->part)
        return no_memory(&m->message);
    for (; m->parts < count; m->parts++) {
        struct merge_part *part = &m->part[m->parts];
        part->of.file = files[m->parts];
        part->points = 1;
        if (!store_check(part->of.file, true, &m->message) ||
            !store_read_origin(part->of.file, &part->of.origin, &m->message))
            return false;
    }
    return true;
}

/* Where random numbers come in, other than by an axis: half-width of the noise, probes. */
static bool has_random_numbers(const struct scenario *s)
{
    bool noise = s->base.noise > 0 || s->base.angle_noise > 0 || s->base.rate_noise > 0 ||
                 (s->refine.given && s->refine.probes > 0);
    for (int a = 0; a < s->axes; a++)
        for (int k = 0; k < s->axis[a].paths; k++)
            noise = noise || strcmp(s->axis[a].path[k], "controller.noise") == 0 ||
                    strcmp(s->axis[a].path[k], "controller.angle_noise") == 0 ||
                    strcmp(s->axis[a].path[k], "controller.rate_noise") == 0;
    return noise;
}

bool merge_plan(struct merge *m, const char *const *files, size_t count)
{
    *m = (struct merge){.points = 1};
    m->usage = false;
    struct tree *trees = calloc(count, sizeof *trees);
    bool good = (trees || no_memory(&m->message)) && open_parts(m, files, count);
    for (size_t p = 0; good && p < count; p++)
        good = read_tree(m, &trees[p], &m->part[p]);
    if (good) {
        m->usage = true;
        /* Of the values of keys that cases of several scenarios have, a file tells those of the
         * last one. */
        for (size_t p = 0; good && p < count; p++)
            good = m->part[p].of.origin.ancestors == 0 ||
                   complain(&m->message,
                            "%.120s: was made from several scenarios: it cannot be merged",
                            m->part[p].of.file);
        good = good && classify(m, trees) && make_scenario(m, trees);
    }
    for (size_t p = 0; good && p < count; p++)
        good =
            store_same_points(m->part[p].of.file, &m->part[p].of.origin, m->scenario, &m->message);
    for (size_t p = 0; trees && p < count; p++)
        tree_free(&trees[p]);
    free(trees);
    m->keyed = good && m->kind != MERGE_EQUAL && has_random_numbers(m->scenario);
    m->refined = good && m->kind != MERGE_EQUAL && m->scenario->axis[m->axis].refined;
    return good;
}

void merge_free(struct merge *m)
{
    for (size_t p = 0; p < m->parts; p++) {
        store_origin_free(&m->part[p].of.origin);
        free(m->part[p].position);
    }
    free(m->part);
    scenario_drop(m->scenario);
    *m = (struct merge){0};
}
