/* basin_questions.c - answers of `stance basin` to single questions: where a threshold is crossed,
 * where the first start is lost, what numbers the cases of a basin have. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"
#include "runner/store/results.h"

#include <gsl/gsl_cdf.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

json_t *basin_titled(const struct results *r, json_t *facts)
{
    TABLE_PUT(facts, {".name", as_text(r->title[0] ? r->title : r->name)},
              {".file", as_text(r->file)}, {".cases", as_whole(r->cases)});
    return facts;
}

int basin_say(const struct results *r, enum table_form form, json_t *facts, struct table *t,
              const char *view, const char *text)
{
    return report_code(
        table_say(form, table_show(basin_titled(r, facts), "rows", t, view, BASIN_SHOWN), text, t));
}

/* ---- thresholds --------------------------------------------------------------------------- */

enum { PARTS = 64 }; /* of the stretch between two values, that are looked at */

/* Rows along the parameter: row first + i * stride has the value number i. */
struct walk {
    const struct basin *b;
    const struct results_axis *axis;
    size_t first, stride;
    double threshold;
};

/* A mean of D over the draws of a sample has that error. */
static double drawn_error(const struct walk *w, size_t i, double part)
{
    const struct basin *b = w->b;
    const double *zero = b->drawn + w->first * b->draws,
                 *here = b->drawn + (w->first + i * w->stride) * b->draws,
                 *next = here + w->stride * b->draws;
    double mean = 0, squares = 0, n = 0;
    for (size_t p = 0; p < b->draws; p++) {
        const double d =
            (1 - part) * here[p] + (part > 0 ? part * next[p] : 0) - w->threshold * zero[p];
        if (isfinite(d)) {
            const double step = d - mean;
            mean += step / ++n; /* Welford's recurrence */
            squares += step * step * (n - 1) / n;
        }
    }
    return n > 1 ? gsl_cdf_tdist_Pinv(0.5 + 0.5 * b->choice.level, n - 1) *
                       sqrt(squares / (n - 1) / n)
                 : INFINITY;
}

/* D and its error a part of the way from value i to the next. */
static double look(const struct walk *w, size_t i, double part, double *error)
{
    const struct basin_row *zero = &w->b->row[w->first],
                           *here = &w->b->row[w->first + i * w->stride],
                           *next = part > 0 ? here + w->stride : here;
    const double at_first = i == 0 ? 1 - part : 0; /* the first row is here, too */
    *error = hypot(hypot((i > 0) * (1 - part) * here->resolution, part * next->resolution),
                   (at_first - w->threshold) * zero->resolution);
    if (w->b->draws > 0)
        *error = hypot(*error, drawn_error(w, i, part));
    return (1 - part) * here->volume + part * next->volume - w->threshold * zero->volume;
}

/* Where D + side * error goes through zero first, from its sign at the beginning: value number and
 * part. False: nowhere. */
static bool find(const struct walk *w, double side, double sign, double *value)
{
    double before = NAN, last = NAN;
    for (size_t i = 0; i < w->axis->count; i++) {
        for (int k = 0; k < (i + 1 < w->axis->count ? PARTS : 1); k++) {
            double error;
            const double part = (double)k / PARTS, here = w->axis->value[i];
            const double x = here + (k > 0 ? part * (w->axis->value[i + 1] - here) : 0);
            const double d = sign * look(w, i, part, &error) + side * error;
            if (!isfinite(d))
                continue;
            if (d < 0) {
                *value = isfinite(before) ? last + (x - last) * before / (before - d) : x;
                return true;
            }
            before = d;
            last = x;
        }
    }
    return false;
}

struct basin_threshold basin_threshold(const struct basin *basin, size_t row, int along,
                                       double threshold)
{
    struct walk w = {basin, &basin->r->axis[basin->by[along]], row, 1, threshold};
    for (int k = along + 1; k < basin->by_axes; k++)
        w.stride *= basin->r->axis[basin->by[k]].count;
    const size_t last = w.axis->count - 1;
    const double sign = threshold < 1 ? 1 : -1;
    struct basin_threshold found = {.first = basin->row[row].volume,
                                    .last = basin->row[row + last * w.stride].volume,
                                    .before = last,
                                    .after = last,
                                    .at = NAN,
                                    .low = NAN,
                                    .high = NAN};
    if (!(found.first > 0))
        return found;
    found.crossed = find(&w, 0, sign, &found.at);
    find(&w, -1, sign, &found.low);
    find(&w, 1, sign, &found.high);
    for (size_t i = 0; found.crossed && i < last; i++) {
        const double a = w.axis->value[i], b = w.axis->value[i + 1];
        if ((found.at - a) * (found.at - b) <= 0) {
            found.before = i;
            found.after = i + 1;
            break;
        }
    }
    return found;
}

#define THRESHOLD(X)                                                                               \
    X("first_share", "", as_number(found.first / b->box), "first", "%.3f %%", 9, .percent = true)  \
    X("last_share", "", as_number(found.last / b->box), "last", "%.3f %%", 9, .percent = true)     \
    X("value", "null: not crossed", as_number(found.at), "crossed at", "%.5g", 11)                 \
    X("low", "", as_number(found.low), "interval", "%.5g", 25, .left = true, .before = "   ",      \
      .empty = beyond)                                                                             \
    X("high", "null: beyond the last value", as_number(found.high), .format = "%.5g",              \
      .joined = true, .before = " ... ", .empty = beyond)                                          \
    X("before", "", found.crossed ? as_place(axis, found.before) : as_nothing(NULL), "between",    \
      .width = 20, .left = true)                                                                   \
    X("after", "values between which it is",                                                       \
      found.crossed ? as_place(axis, found.after) : as_nothing(NULL), .joined = true,              \
      .before = " and ")
#define THRESHOLD_HEAD(X)                                                                          \
    X("outcome", "", as_text(results_kind_names[b->choice.of]))                                    \
    X("threshold", "", as_number(threshold))                                                       \
    X("of", "", as_text(axis->name))                                                               \
    X("unit", "", as_text(axis->unit))                                                             \
    X("level", "", as_number(b->choice.level))                                                     \
    X("within", "", as_text(b->choice.within))
static const struct say_key threshold_rows[] = {TABLE_KEY_AT THRESHOLD(TABLE_KEY){0}};
const struct say_key basin_threshold_keys[] = {
    THRESHOLD_HEAD(TABLE_KEY){"rows", "", threshold_rows}, {0}};

int basin_print_threshold(const struct basin *b, const char *path, double threshold,
                          enum table_form form, stance_message *message)
{
    struct table t = {0};
    char meant[128];
    int along = -1, others[SCENARIO_MAX_AXES], count = 0;
    for (int k = 0; k < b->by_axes; k++)
        if (strcmp(b->r->axis[b->by[k]].name, path) == 0)
            along = k;
        else
            others[count++] = b->by[k];
    if (along < 0 || !statistics_is_monotone(&b->r->axis[b->by[along]]))
        return refuse(message,
                      "stance basin: --threshold needs --of PATH of a parameter whose values "
                      "rise or fall on the grid, not '%.40s'%s",
                      path, basin_meant(b->r, path, meant));
    const struct results_axis *const axis = &b->r->axis[b->by[along]];
    for (size_t row = 0; row < b->rows; row++) {
        if (b->row[row].point[b->by[along]] > 0)
            continue;
        const struct basin_threshold found = basin_threshold(b, row, along, threshold);
        const char *const beyond = found.first > 0 ? "beyond" : "-";
        table_axes(&t, b->r, others, count, b->row[row].point);
        TABLE_FACTS(&t, THRESHOLD(TABLE_FACT));
        table_end_row(&t);
    }
    json_t *const facts =
        TABLE_OBJECT(THRESHOLD_HEAD(TABLE_MEMBER){".asked", as_text(basin_asked(b))},
                     {".from", as_place(axis, 0)}, {".to", as_place(axis, axis->count - 1)});
    return basin_say(
        b->r, form, facts, &t, "at/ first_share last_share value low high before after",
        BASIN_TITLE "Where the share of starts that end as {.asked} [threshold<1:falls below|rises "
                    "above] {threshold*%.6g} % of what it is at {of} = {..from}\n"
                    "(up to {..to}; interval at {level*%.4g} %)\n\n{.rows}");
}

/* ---- losses ------------------------------------------------------------------------------- */

bool basin_more_at_last(const struct results *r, int axis, enum results_kind of)
{
    struct statistics_counts ends[2];
    statistics_count(r, axis, 0, &ends[0]);
    statistics_count(r, axis, r->axis[axis].count - 1, &ends[1]);
    return ends[1].kind[of] > ends[0].kind[of];
}

bool basin_lose(const struct results *r, int axis, bool down, enum results_kind of,
                struct basin_loss *loss)
{
    const size_t count = r->axis[axis].count;
    const uint64_t stride = statistics_stride(r, axis);
    *loss =
        (struct basin_loss){.down = down, .lost = calloc(count, sizeof *loss->lost), .at = count};
    for (uint64_t i = 0; loss->lost && i < r->cases; i++) {
        if (i / stride % count != 0)
            continue;
        for (size_t k = 0; k < count; k++) {
            const uint64_t index = i + (loss->down ? count - 1 - k : k) * stride;
            const uint8_t kind = r->kind[index];
            if (k == 0 && kind != of)
                break;
            loss->starts += k == 0;
            if (!basin_is_known(kind)) {
                loss->unknown++;
                break;
            }
            if (kind != of) {
                loss->lost[k]++;
                if (k < loss->at) {
                    loss->at = k;
                    loss->first = index;
                }
                break;
            }
        }
    }
    return loss->lost != NULL;
}

/* 0: the first value, 1: the last one, 2: none is named, -1: another. */
static int which_end(const struct results_axis *axis, const char *value)
{
    const size_t last = axis->count - 1;
    for (int end = 0; value && end < 2; end++) {
        const size_t i = end ? last : 0;
        char *rest;
        if (axis->word
                ? strcmp(axis->word[i], value) == 0
                : fabs(strtod(value, &rest) - axis->value[i]) <= 1e-9 * fabs(axis->value[i]) &&
                      rest != value && !*rest)
            return end;
    }
    return value ? -1 : 2;
}

#define LOSS(X)                                                                                    \
    X("value", "", as_place(axis, loss.down ? last - k : k), axis->name, .width = 14)              \
    X("lost", "", as_whole(loss.lost[k]), "lost here", .width = 12)                                \
    X("lost_so_far", "", as_whole(gone), "so far", .width = 12)                                    \
    X("share", "", as_number(loss.starts ? (double)gone / (double)loss.starts : NAN), "of all",    \
      "%.3f %%", 10, .percent = true)
#define LOSS_HEAD(X)                                                                               \
    X("outcome", "", as_text(results_kind_names[of]))                                              \
    X("of", "", as_text(axis->name))                                                               \
    X("starts", "", as_whole(loss.starts))                                                         \
    X("unknown", "", as_whole(loss.unknown))                                                       \
    X("kept", "", any ? as_place(axis, before) : as_nothing(NULL))                                 \
    X("lost", "values between which the first are lost",                                           \
      any ? as_place(axis, after) : as_nothing(NULL))                                              \
    X("first", "case", any ? as_whole(loss.first) : as_nothing(NULL))                              \
    X("first_at", "{path: value}", as_tree(any ? table_at(r, NULL, point) : NULL))
static const struct say_key loss_rows[] = {LOSS(TABLE_KEY){0}};
const struct say_key basin_loss_keys[] = {LOSS_HEAD(TABLE_KEY){"rows", "", loss_rows}, {0}};

int basin_print_loss(const struct results *r, const char *path, enum results_kind of,
                     enum table_form form, stance_message *message)
{
    struct basin_loss loss;
    struct table t = {0};
    const char *equals = strchr(path, '=');
    char meant[128];
    const size_t length = equals ? (size_t)(equals - path) : strlen(path);
    int along = -1;
    for (int a = 0; a < r->axes; a++)
        if (strncmp(r->axis[a].name, path, length) == 0 && r->axis[a].name[length] == '\0' &&
            a != r->sample && r->axis[a].count > 1)
            along = a;
    const int end = along < 0 ? -1 : which_end(&r->axis[along], equals ? equals + 1 : NULL);
    if (along < 0 || end < 0)
        return refuse(message,
                      "stance basin: --lost takes PATH or PATH=VALUE of an axis of the grid with "
                      "several values, VALUE its first or last, not '%.40s'%s",
                      path, along < 0 ? basin_meant(r, path, meant) : "");
    const bool down = end < 2 ? end == 1 : basin_more_at_last(r, along, of);
    if (!basin_lose(r, along, down, of, &loss))
        return report_code(statistics_no_memory(r, message));
    const struct results_axis *axis = &r->axis[along];
    const size_t last = axis->count - 1;
    uint64_t gone = 0;
    for (size_t k = 0; k <= last; k++) {
        gone += loss.lost[k];
        TABLE_FACTS(&t, LOSS(TABLE_FACT));
        table_end_row(&t);
    }
    const bool any = loss.at <= last;
    const size_t after = loss.down ? last - loss.at : loss.at,
                 before = loss.down ? after + 1 : after - 1;
    size_t point[SCENARIO_MAX_AXES];
    char where[600] = "";
    if (any) {
        results_point(r, loss.first, point);
        results_case_text(r, loss.first, where, sizeof where);
    }
    json_t *const facts =
        TABLE_OBJECT(LOSS_HEAD(TABLE_MEMBER){".from", as_place(axis, loss.down ? last : 0)},
                     {".where", as_text(where)}, {".count", as_whole(any ? loss.lost[loss.at] : 0)},
                     {".became", as_text(any ? results_kind_names[r->kind[loss.first]] : NULL)});
    free(loss.lost);
    return basin_say(
        r, form, facts, &t, "value lost lost_so_far share",
        BASIN_TITLE "{starts} starts end as {outcome} at {of} = {..from}[unknown: ({unknown} of "
                    "them come to a case that failed or is pending)].\n"
                    "[.where:The first are lost between {.kept} and {.lost}: {.count}, one of them "
                    "case {first}\n  ({.where}: {.became})\n|None of them is lost.\n]\n{.rows}");
}

/* ---- answers ------------------------------------------------------------------------------ */

bool basin_numbers(const struct results *r, const char *answer, double **value,
                   stance_message *message)
{
    struct results_column column = {.id = -1};
    *value = NULL;
    if (strpbrk(answer, "./")) /* an axis, or a group: nothing over the cases */
        return true;
    bool good = results_column_open(r, answer, &column, message);
    if (good && column.id >= 0 && !column.words && column.width == 1)
        good = results_answer(r, answer, value, message);
    if (good)
        results_column_close(&column);
    return good;
}

bool basin_lacks(const struct results *r, enum results_kind of, const double *value,
                 struct basin_lack *lack, stance_message *message)
{
    uint64_t count;
    bool *inferred;
    const bool good = statistics_inferred(r, &count, &inferred, message);
    *lack = (struct basin_lack){0};
    for (uint64_t i = 0; good && i < r->cases; i++)
        if (r->kind[i] == of && isnan(value[i]))
            ++*(inferred && inferred[i] ? &lack->inferred : &lack->others);
    free(inferred);
    return good;
}

/* The numbers of the cases with the outcome, row by row: those of row k are number[begin[k]] up to
 * number[begin[k + 1]]; largest[k]: a case with the largest. begin[rows + 1], zero at first. */
static void sort_numbers(const struct basin *b, const double *value, double *number,
                         uint64_t *begin, uint64_t *largest)
{
    for (int pass = 0; pass < 2; pass++) {
        for (uint64_t i = 0; i < b->r->cases; i++) {
            size_t point[SCENARIO_MAX_AXES];
            if (b->r->kind[i] != b->choice.of || isnan(value[i]))
                continue;
            results_point(b->r, i, point);
            const size_t row = basin_row_of(b, point);
            if (pass == 0) {
                largest[row] =
                    begin[row]++ == 0 || value[i] > value[largest[row]] ? i : largest[row];
            } else {
                number[--begin[row]] = value[i];
            }
        }
        for (size_t row = 0; pass == 0 && row < b->rows; row++)
            begin[row + 1] +=
                begin[row]; /* where each ends, which the second pass goes back from */
    }
}

#define ANSWER(X)                                                                                  \
    X("cases", "", as_whole(found.n), "cases", .width = 10)                                        \
    X("smallest", "", as_number(found.low), "smallest", "%.5g", 11)                                \
    X("median", "", as_number(found.median), "median", "%.5g", 11)                                 \
    X("q90", "", as_number(found.q90), "90 %", "%.5g", 11)                                         \
    X("q99", "", as_number(found.q99), "99 %", "%.5g", 11)                                         \
    X("largest", "", as_number(found.high), "largest", "%.5g", 11)                                 \
    X("largest_case", "", found.n > 0 ? as_whole(largest[row]) : as_nothing(NULL), "in case",      \
      .width = 11)
#define ANSWER_HEAD(X)                                                                             \
    X("outcome", "", as_text(results_kind_names[b->choice.of]))                                    \
    X("answer", "", as_text(answer))
static const struct say_key answer_rows[] = {TABLE_KEY_AT ANSWER(TABLE_KEY){0}};
const struct say_key basin_answer_keys[] = {ANSWER_HEAD(TABLE_KEY){"rows", "", answer_rows}, {0}};

int basin_print_answer(const struct basin *b, const char *answer, enum table_form form,
                       stance_message *message)
{
    struct table t = {0};
    double *value = NULL;
    struct basin_lack lack = {0};
    if (!basin_numbers(b->r, answer, &value, message))
        return EXIT_IO;
    if (!value)
        return refuse(message, "stance basin: %.90s stores no number '%.60s'", b->r->file, answer);
    double *number = malloc(b->r->cases * sizeof *number);
    uint64_t *begin = calloc(2 * b->rows + 1, sizeof *begin);
    uint64_t *const largest = begin + b->rows + 1;
    const bool good = (number && begin) || statistics_no_memory(b->r, message);
    if (!good || !basin_lacks(b->r, b->choice.of, value, &lack, message)) {
        free(number);
        free(begin);
        free(value);
        return EXIT_IO;
    }
    if (lack.inferred > 0)
        fprintf(stderr,
                "stance basin: warning: %" PRIu64 " of these cases were inferred and have no %s: "
                "the numbers are of the others, which are near boundaries\n",
                lack.inferred, answer);
    sort_numbers(b, value, number, begin, largest);
    for (size_t row = 0; row < b->rows; row++) {
        struct statistics_numbers found;
        statistics_summarise(number + begin[row], begin[row + 1] - begin[row], &found);
        table_axes(&t, b->r, b->by, b->by_axes, b->row[row].point);
        TABLE_FACTS(&t, ANSWER(TABLE_FACT));
        table_end_row(&t);
    }
    free(number);
    free(begin);
    free(value);
    return basin_say(b->r, form,
                     TABLE_OBJECT(ANSWER_HEAD(TABLE_MEMBER){".asked", as_text(basin_asked(b))}), &t,
                     "at/ cases smallest median q90 q99 largest largest_case",
                     BASIN_TITLE "{answer} of the starts that end as {.asked}\n\n{.rows}");
}
