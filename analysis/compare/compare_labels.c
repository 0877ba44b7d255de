/* compare_labels.c - counts, and distances by the two passes of A. Rosenfeld and J. Pfaltz (1968),
 * Distance functions on digital pictures, exact for this metric.
 */
#include "compare_labels.h"

#include "runner/base/message.h"
#include "runner/store/results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LABELS_SHOWN = 3 };

struct labels {
    uint64_t compared, equal; /* cases that are pending in neither file */
    /* Chebyshev distance from an unequal case to the nearest one of another label than its own in
     * the first file, along the refined axes (without any: along all axes of numbers): 1 is beside
     * the boundary. 0: there is no unequal case, or no boundary. */
    uint64_t farthest;
    /* Of those compared, by the label in the first file and that in the second. */
    uint64_t cases[RESULTS_KIND_COUNT][RESULTS_KIND_COUNT];
    enum results_kind of;     /* the domain that is looked at */
    uint64_t kept, won, lost; /* cases in it of both files, of the second and of the first alone */
    /* Of the share of the first domain that the second has lost, at 95 %, of a sample; else NAN. */
    struct interval lost_interval;
    int shown;
    uint64_t place[LABELS_SHOWN]; /* the first unequal cases */
};

/* ---- neighbours --------------------------------------------------------------------------- */

/* The axes along which cases are neighbours. */
struct lattice {
    const struct results *r;
    bool along[SCENARIO_MAX_AXES];
};

static bool find_refined(const struct results *r, bool *along)
{
    bool any = false;
    for (int a = 0; r->read && a < r->read->axes && a < r->axes; a++) {
        along[a] = along[a] || r->read->axis[a].refined;
        any = any || along[a];
    }
    return any;
}

/* Goes to the next neighbour of the case at `point`: step[] counts through -1, 0, 1 along each
 * axis. False: that was the last. *index is the neighbour's, UINT64_MAX where it is beyond the
 * grid. */
static bool next_neighbour(const struct lattice *lattice, const size_t *point, int *step,
                           uint64_t *index)
{
    int a = lattice->r->axes - 1;
    for (; a >= 0 && (!lattice->along[a] || step[a] == 1); a--)
        step[a] = lattice->along[a] ? -1 : 0;
    if (a < 0)
        return false;
    step[a]++;
    *index = 0;
    for (a = 0; a < lattice->r->axes; a++) {
        const size_t count = lattice->r->axis[a].count;
        if ((step[a] < 0 && point[a] == 0) || (step[a] > 0 && point[a] + 1 == count)) {
            *index = UINT64_MAX;
            return true;
        }
        *index = *index * count + point[a] + (size_t)step[a];
    }
    return true;
}

/* Least distance of a case that its neighbours before (way < 0) or after it tell. */
static uint32_t told(const struct lattice *lattice, const uint32_t *distance, uint64_t i, int way)
{
    size_t point[SCENARIO_MAX_AXES];
    int step[SCENARIO_MAX_AXES];
    uint32_t least = distance[i];
    uint64_t index;

    results_point(lattice->r, i, point);
    int last = -1;
    for (int a = 0; a < lattice->r->axes; a++) {
        step[a] = lattice->along[a] ? -1 : 0;
        last = lattice->along[a] ? a : last;
    }
    if (last >= 0)
        step[last]--; /* before the first neighbour */
    while (next_neighbour(lattice, point, step, &index)) {
        if (index == UINT64_MAX || (way < 0 ? index >= i : index <= i))
            continue;
        const uint32_t by = lattice->r->kind[index] != lattice->r->kind[i] ? 1
                            : distance[index] < UINT32_MAX                 ? distance[index] + 1
                                                                           : UINT32_MAX;
        least = by < least ? by : least;
    }
    return least;
}

/* ---- comparing ---------------------------------------------------------------------------- */

/* Starts at other places are other cases. */
static bool same_values(const struct results_axis *first, const struct results_axis *second)
{
    bool same = first->count == second->count;
    for (size_t i = 0; same && i < first->count && scenario_is_start(first->name); i++)
        same = fabs(first->value[i] - second->value[i]) <=
               1e-9 * fmax(fabs(first->value[i]), fabs(second->value[i]));
    return same;
}

bool compare_lost(struct interval *share, const struct results r[2], enum results_kind of)
{
    struct results had = r[0]; /* whose other cases are left out */
    had.kind = malloc(had.cases);
    for (uint64_t i = 0; had.kind && i < had.cases; i++)
        had.kind[i] = r[0].kind[i] != of || r[1].kind[i] == RESULTS_PENDING ? RESULTS_PENDING
                      : r[1].kind[i] == of                                  ? RESULTS_STABILISED
                                                                            : RESULTS_FELL;
    const bool good = had.kind && intervals_find(&had, RESULTS_FELL, -1, NULL, 1, share);
    free(had.kind);
    return good;
}

static bool find_labels(struct labels *comparison, const struct results r[2],
                        stance_message *message)
{
    const struct results *const first = &r[0], *const second = &r[1];
    const enum results_kind of = comparison->of;
    bool axes = first->axes == second->axes && first->cases == second->cases &&
                first->single == second->single;
    bool starts = first->varied == second->varied;
    for (int a = 0; axes && a < first->axes; a++)
        axes = first->axis[a].count == second->axis[a].count &&
               strcmp(first->axis[a].name, second->axis[a].name) == 0;
    for (int a = 0; axes && starts && !first->single && a < first->axes; a++)
        starts = first->axis[a].word || same_values(&first->axis[a], &second->axis[a]);
    for (int k = 0; starts && k < first->varied; k++)
        starts = first->vary[k].word || same_values(&first->vary[k].of, &second->vary[k].of);
    if (!axes)
        return complain(message, "stance compare: %.90s and %.90s are not over the same axes",
                        first->file, second->file);
    if (!starts)
        return complain(message, "stance compare: the starts of %.80s and %.80s are not the same",
                        first->file, second->file);
    uint32_t *distance = malloc(first->cases * sizeof *distance);
    if (!distance || !compare_lost(&comparison->lost_interval, r, of)) {
        free(distance);
        return complain(message, "stance compare: not enough memory");
    }
    struct lattice lattice = {.r = first};
    const bool one = find_refined(first, lattice.along), two = find_refined(second, lattice.along);
    for (int a = 0; !one && !two && a < first->axes; a++)
        lattice.along[a] = first->axis[a].word == NULL && a != first->sample;
    memset(distance, 0xff, first->cases * sizeof *distance); /* no other label can be reached */
    for (uint64_t i = 0; i < first->cases; i++)
        distance[i] = told(&lattice, distance, i, -1);
    for (uint64_t i = first->cases; i-- > 0;)
        distance[i] = told(&lattice, distance, i, 1);
    for (uint64_t i = 0; i < first->cases; i++) {
        if (first->kind[i] == RESULTS_PENDING || second->kind[i] == RESULTS_PENDING)
            continue;
        comparison->compared++;
        comparison->cases[first->kind[i]][second->kind[i]]++;
        comparison->kept += first->kind[i] == of && second->kind[i] == of;
        comparison->lost += first->kind[i] == of && second->kind[i] != of;
        comparison->won += first->kind[i] != of && second->kind[i] == of;
        if (first->kind[i] == second->kind[i]) {
            comparison->equal++;
            continue;
        }
        if (distance[i] < UINT32_MAX && distance[i] > comparison->farthest)
            comparison->farthest = distance[i];
        if (comparison->shown < LABELS_SHOWN)
            comparison->place[comparison->shown++] = i;
    }
    free(distance);
    return true;
}

/* ---- what is said ------------------------------------------------------------------------- */

static double share_of(uint64_t part, uint64_t all)
{
    return all ? (double)part / (double)all : NAN;
}

/* What the labels of the first file have become in the second. */
static void add_labels(struct table *t, const struct labels *c)
{
    for (int from = 0; from < RESULTS_KIND_COUNT; from++) {
        uint64_t all = 0;
        for (int to = 0; to < RESULTS_KIND_COUNT; to++)
            all += c->cases[from][to];
        for (int to = 0; to < RESULTS_KIND_COUNT; to++) {
            if (c->cases[from][to] == 0)
                continue;
            TABLE_FACTS(
                t,
                {{"first", "first", .width = 10, .left = true}, as_text(results_kind_names[from])},
                {{"second", "second", .width = 10, .left = true}, as_text(results_kind_names[to])},
                {{"cases", "cases", .width = 12}, as_whole(c->cases[from][to])},
                {{"share", "of all", "%.3f %%", .width = 9, .percent = true},
                 as_number(share_of(c->cases[from][to], c->compared))},
                {{"share_of_first", "of the first", "%.3f %%", .width = 12, .percent = true},
                 as_number(share_of(c->cases[from][to], all))});
            table_end_row(t);
        }
    }
}

static json_t *domain_facts(const struct labels *c)
{
    return TABLE_OBJECT(
        {"outcome", as_text(results_kind_names[c->of])}, {"kept", as_whole(c->kept)},
        {"lost", as_whole(c->lost)}, {"won", as_whole(c->won)},
        {"neither", as_whole(c->compared - c->kept - c->lost - c->won)},
        {"lost_share", as_number(share_of(c->lost, c->kept + c->lost))},
        {"lost_low", as_number(c->lost_interval.low)},
        {"lost_high", as_number(c->lost_interval.high)},
        {"won_share", as_number(share_of(c->won, c->kept + c->won))},
        {".before", as_whole(c->kept + c->lost)}, {".after", as_whole(c->kept + c->won)},
        {".either", as_whole(c->kept + c->lost + c->won)},
        {".bounded", as_truth(isfinite(c->lost_interval.low))});
}

static const char labels_text[] =
    "labels: {equal} of {compared} equal ({equal_share*%.5g} %)\n"
    "[farthest:unequal: {.unequal}, at most {farthest} cell{farthest#s} from another label in "
    "{files/0}\n"
    "|[.unequal:unequal: {.unequal}, and {files/0} has no boundary\n]]"
    "[first*:  case {index}[.where: ({.where})]: " COMPARE_VALUES "]"
    "[.unequal:\n{.became}]"
    "[domain:[.either:\n{outcome} in both: {kept}; lost, in {files/0} alone: {lost}"
    "[.before: ({lost_share*%.3f} % of its domain"
    "[.bounded:; 95 % interval {lost_low*%.3f} ... {lost_high*%.3f} %])];\n"
    "won, in {files/1} alone: {won}[.after: ({won_share*%.3f} % of its domain)]\n]]";

static bool print_labels(const struct results r[2], const struct labels *c, enum table_form form)
{
    struct table became = {0};
    json_t *const first = json_array();
    char where[600];
    for (int k = 0; k < c->shown; k++) {
        const uint64_t i = c->place[k];
        results_case_text(&r[0], i, where, sizeof where);
        TABLE_APPEND(first, {"index", as_whole(i)}, {"at", as_tree(compare_point(&r[0], i))},
                     {"values", as_tree(table_texts(results_kind_names[r[0].kind[i]],
                                                    results_kind_names[r[1].kind[i]]))},
                     {".where", as_text(where)});
    }
    json_t *const facts = TABLE_OBJECT(
        {"files", as_tree(table_texts(r[0].file, r[1].file))}, {"compared", as_whole(c->compared)},
        {"equal", as_whole(c->equal)}, {".unequal", as_whole(c->compared - c->equal)},
        {"equal_share", as_number(c->compared ? share_of(c->equal, c->compared) : 1)},
        {"farthest", c->farthest ? as_whole(c->farthest) : as_nothing(NULL)});
    add_labels(&became, c);
    json_t *const all =
        table_show(facts, "became", &became, "first second cases share share_of_first", 0);
    TABLE_PUT(all, {"domain", as_tree(domain_facts(c))}, {"first", as_tree(first)});
    return table_say(form, all, labels_text, &became);
}

int compare_labels(const struct results r[2], enum results_kind of, enum table_form form,
                   stance_message *message)
{
    struct labels c = {.of = of < RESULTS_KIND_COUNT ? of : statistics_judged(&r[0])};
    if (!find_labels(&c, r, message))
        return EXIT_USAGE;
    return !print_labels(r, &c, form) ? EXIT_IO
           : c.equal == c.compared    ? EXIT_DONE
                                      : EXIT_CASES_FAILED;
}
