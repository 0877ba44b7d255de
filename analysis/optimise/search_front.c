/* search_front.c - see search_front.h. */
#include "search_front.h"
#include "search_summary.h"

#include "runner/base/message.h"
#include "runner/plan/allowed.h"
#include "runner/scenario/schema.h"
#include "runner/scenario/tree.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- scenarios as lists of numbers and words ---------------------------------------------- */

struct leaf {
    char path[96];
    const char *text; /* of the tree */
};

struct leaves {
    struct tree tree;
    struct problems *problems;
    struct leaf *leaf;
    size_t count, room;
    bool failed; /* no memory */
};

static void add_leaves(struct leaves *l, const struct tree_node *node, const char *path)
{
    char below[96];
    if (node->kind == TREE_SCALAR) {
        if (l->count == l->room) {
            l->room = 2 * l->room + 64;
            struct leaf *const more = realloc(l->leaf, l->room * sizeof *more);
            l->failed = l->failed || !more;
            if (!more)
                return;
            l->leaf = more;
        }
        struct leaf *const leaf = &l->leaf[l->count++];
        snprintf(leaf->path, sizeof leaf->path, "%s", path);
        leaf->text = node->text;
        return;
    }
    for (size_t i = 0; i < node->count && !l->failed; i++) {
        const int length = node->kind == TREE_LIST
                               ? snprintf(below, sizeof below, "%s[%zu]", path, i)
                               : snprintf(below, sizeof below, "%s%s%s", path, path[0] ? "." : "",
                                          node->key[i].name);
        if (length > 0 && (size_t)length < sizeof below)
            add_leaves(l, node->item[i], below);
    }
}

/* Of the scenario as it was read; none of one that is none. */
static bool read_leaves(struct leaves *l, const char *text)
{
    const size_t length = strlen(text);
    *l = (struct leaves){.problems = calloc(1, sizeof *l->problems)};
    if (l->problems && tree_check_text(text, length, l->problems) &&
        tree_parse(&l->tree, text, length, l->problems))
        add_leaves(l, l->tree.root, "");
    return l->problems && !l->failed;
}

/* NULL: it is not given. */
static const char *text_at(const struct leaves *l, const char *path)
{
    for (size_t i = 0; i < l->count; i++)
        if (strcmp(l->leaf[i].path, path) == 0)
            return l->leaf[i].text;
    return NULL;
}

/* NAN: none. */
static double number_at(const struct leaves *l, const char *path)
{
    const char *const text = text_at(l, path);
    char *end = NULL;
    errno = 0;
    const double number = text ? strtod(text, &end) : NAN;
    return text && end != text && !*end && isfinite(number) ? number : NAN;
}

/* ---- what differs ------------------------------------------------------------------------- */

static bool differs(const struct leaves *l, size_t count, const char *path)
{
    const char *const first = text_at(&l[0], path);
    bool differ = false;
    for (size_t i = 1; i < count; i++) {
        const char *const other = text_at(&l[i], path);
        differ = differ || !first != !other || (first && strcmp(first, other) != 0);
    }
    return differ;
}

/* Different numbers; 0: some scenario has none. */
static size_t values_of(const struct leaves *l, size_t count, const char *path)
{
    size_t values = 0;
    for (size_t i = 0; i < count; i++) {
        const double number = number_at(&l[i], path);
        size_t same = 0;
        if (isnan(number))
            return 0;
        while (same < i && number_at(&l[same], path) != number)
            same++;
        values += same == i;
    }
    return values;
}

/* What a search may cost, and what only scatters. */
static bool is_effort(const char *path)
{
    static const char *const effort[] = {"seed",
                                         "optimise.candidates",
                                         "optimise.confirm",
                                         "optimise.grow",
                                         "optimise.restarts",
                                         "optimise.first_step",
                                         "sweep.sample.count"};
    bool is = false;
    for (size_t i = 0; i < sizeof effort / sizeof *effort; i++)
        is = is || strncmp(path, effort[i], strlen(effort[i])) == 0;
    return is;
}

/* The path, into against.name; false: there is none. */
static bool find_against(struct search_front *front, const struct leaves *l)
{
    size_t most = 1;
    for (size_t i = 0; i < l[0].count; i++) {
        const char *const path = l[0].leaf[i].path;
        const size_t values = is_effort(path) ? 0 : values_of(l, front->count, path);
        if (values > most) {
            most = values;
            snprintf(front->against.name, sizeof front->against.name, "%s", path);
        }
    }
    return most > 1;
}

static void find_also(struct search_front *front, const struct leaves *l)
{
    size_t used = 0;
    for (size_t f = 0; f < front->count; f++) {
        for (size_t i = 0; i < l[f].count && used + 100 < sizeof front->also; i++) {
            const char *const path = l[f].leaf[i].path;
            bool met = strcmp(path, "title") == 0 || strcmp(path, front->against.name) == 0;
            for (size_t before = 0; before < f; before++)
                met = met || text_at(&l[before], path);
            if (!met && differs(l, front->count, path))
                used += (size_t)snprintf(front->also + used, sizeof front->also - used, "%s%s",
                                         used ? ", " : "", path);
        }
    }
    results_clean(front->also);
}

static bool compare_scenarios(struct search_front *front, struct leaves *l, stance_message *message)
{
    size_t read = 0;
    bool good = true;
    while (good && read < front->count)
        good =
            read_leaves(&l[read], front->study[read].f.scenario) ? ++read > 0 : no_memory(message);
    good = good &&
           (find_against(front, l) ||
            complain(message,
                     "%.70s, %.70s%s: no number of their scenarios differs, but "
                     "for seed and effort",
                     front->study[0].file, front->study[1].file, front->count > 2 ? " ..." : ""));
    for (size_t i = 0; good && i < front->count; i++)
        front->at[i] = number_at(&l[i], front->against.name);
    if (good)
        find_also(front, l);
    for (size_t i = 0; i < front->count; i++) {
        tree_free(&l[i].tree);
        free(l[i].leaf);
        free(l[i].problems);
    }
    return good;
}

/* ---- opening ------------------------------------------------------------------------------ */

/* Rising, in the order in which they were given where they are the same. */
static void sort(struct search_front *front)
{
    for (size_t i = 1; i < front->count; i++) {
        for (size_t j = i; j > 0 && front->at[j - 1] > front->at[j]; j--) {
            const double at = front->at[j];
            const struct search_study study = front->study[j];
            front->at[j] = front->at[j - 1];
            front->study[j] = front->study[j - 1];
            front->at[j - 1] = at;
            front->study[j - 1] = study;
        }
    }
}

bool search_front_open(struct search_front *front, const char *const *file, size_t count,
                       stance_message *message)
{
    *front = (struct search_front){.study = calloc(count, sizeof *front->study),
                                   .at = calloc(count, sizeof *front->at)};
    struct leaves *const l = calloc(count, sizeof *l);
    bool good = (front->study && front->at && l) || no_memory(message);
    while (good && front->count < count) {
        struct search_study *const study = &front->study[front->count];
        good = search_study_open(study, file[front->count], message);
        front->count += good;
        if (good && !study->done)
            good = complain(message, "%.150s: not finished: stance optimise --resume goes on",
                            study->file);
    }
    good = good && compare_scenarios(front, l, message);
    free(l);
    if (!good) {
        search_front_close(front);
        return false;
    }
    sort(front);
    front->against.count = count;
    front->against.value = front->at;
    search_describe(&front->study[0], &front->against);
    results_clean(front->against.name);
    return true;
}

void search_front_close(struct search_front *front)
{
    for (size_t i = 0; i < front->count; i++)
        search_study_close(&front->study[i]);
    free(front->study);
    free(front->at);
    *front = (struct search_front){0};
}

/* ---- the table ---------------------------------------------------------------------------- */

static void make_table(struct table *t, const struct search_front *front)
{
    for (size_t i = 0; i < front->count; i++) {
        const struct search_study *const study = &front->study[i];
        const struct search_file *const f = &study->f;
        const size_t chosen = (size_t)f->chosen, circumstances = f->length[SEARCH_CIRCUMSTANCE];
        const char *where;
        const double allowed = search_limit(study, chosen, &where);
        TABLE_FACTS(
            t,
            {{front->against.name, schema_last_name(front->against.name), .width = 10},
             as_number(front->at[i])},
            {{"first", "first %", "%.2f", .width = 8, .percent = true},
             as_number(search_share(study, 0, SEARCH_OVERALL))},
            SEARCH_INTERVAL("first_low", "first_high", search_interval(study, 0, SEARCH_OVERALL)),
            {{"chosen", "chosen %", "%.2f", .width = 8, .percent = true},
             as_number(search_share(study, chosen, SEARCH_OVERALL))},
            SEARCH_INTERVAL("chosen_low", "chosen_high",
                            search_interval(study, chosen, SEARCH_OVERALL)),
            {{"allowed", "allowed %", "%.2f", .width = 9, .percent = true}, as_number(allowed)},
            {{"of_allowed", "of that", "%.1f", .width = 7, .percent = true},
             as_number(search_share(study, chosen, SEARCH_OVERALL) / allowed)},
            {{"glued", .hidden = TABLE_NO_CSV}, as_truth(study->glued)},
            {{"critical_chosen", "T* chosen (s)", "%.4g", .width = 13},
             as_number(f->confirmed_critical[chosen * circumstances])},
            {{"file", "file", .width = 4, .left = true, .before = "  "}, as_text(study->file)});
        table_end_row(t);
    }
}

bool search_front_print(const struct search_front *front, enum table_form form)
{
    static const char text[] =
        "{title}\n{.count} searches against {against}[unit: ({unit})][.text:: {.text}]\n"
        "[also:also different: {also}\n]\n{.searches}"
        "(of fresh starts, with 95 % intervals; allowed: by linear theory to any controller)\n"
        "[.glued:(" ALLOWED_GLUED ")\n]";
    const struct results_axis *const axis = &front->against;
    struct table t = {0};
    char view[300];
    bool glued = false;
    for (size_t i = 0; i < front->count; i++)
        glued = glued || front->study[i].glued;
    json_t *const facts = TABLE_OBJECT(
        {"title", as_text(front->study[0].f.title)}, {"against", as_text(axis->name)},
        {"unit", as_text(axis->unit[0] ? axis->unit : NULL)},
        {"also", as_text(front->also[0] ? front->also : NULL)}, {".count", as_whole(front->count)},
        {".text", as_text(axis->text)}, {".glued", as_truth(glued)});
    make_table(&t, front);
    snprintf(view, sizeof view,
             "%s first first_low first_high chosen chosen_low chosen_high allowed of_allowed "
             "critical_chosen file",
             axis->name);
    return table_say(form, table_show(facts, "searches", &t, view, 0), text, &t);
}
