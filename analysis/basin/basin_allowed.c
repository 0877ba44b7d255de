/* basin_allowed.c - a basin against what linear theory allows any controller (allowed.h): the
 * starts in that set, of these the ones with the outcome, and those with the outcome that are not
 * in it. Linear theory is no bound: a robot that slips, lifts a foot, or is far from its
 * equilibrium may recover from outside, and what it did is told. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"
#include "runner/plan/allowed.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROWS = 2000 };

#define SLIPPED 1e-6 /* m: less is dust of the steps */

/* What a case did that linear theory does not know of. X(NAME, name, heading) */
#define EXCUSES(X)                                                                                 \
    X(SLID, slipped, "slipped")                                                                    \
    X(LIFTED, lifted, "lifted")                                                                    \
    X(NEITHER, neither, "neither")                                                                 \
    X(UNKNOWN, unknown, "unknown") /* the file does not say */
enum excuse {
#define EXCUSE(NAME, name, heading) NAME,
    EXCUSES(EXCUSE)
#undef EXCUSE
        EXCUSE_COUNT
};

/* Of a row: its set, and how many of its starts are where. */
struct row {
    struct allowed of;
    bool asked;
    uint64_t starts, allowed, inside, outside;
    struct {
        uint64_t starts, index; /* index: of the farthest */
        double gauge;           /* how far it is: the set's boundary is at 1 */
    } excuse[EXCUSE_COUNT];
};

/* Numbers of all cases; NULL: not stored. */
struct motion {
    double *slip, *footfalls, *least;
};

static void count_case(struct row *row, uint64_t index, const stance_case *c, bool has_outcome,
                       const struct motion *m)
{
    double x[DESIGN_STATES];
    allowed_state(&row->of, c->position, c->velocity, x);
    const bool holds = stance_null_set_holds(row->of.set, x);
    row->starts++;
    row->allowed += holds;
    row->inside += holds && has_outcome;
    if (holds || !has_outcome)
        return;
    const double slip = m->slip ? m->slip[index] : NAN,
                 steps = m->footfalls ? m->footfalls[index] : NAN,
                 least = m->least ? m->least[index] : NAN;
    const enum excuse e = steps > 0 || least <= 0                         ? LIFTED
                          : slip > SLIPPED                                ? SLID
                          : isnan(slip) || (isnan(steps) && isnan(least)) ? UNKNOWN
                                                                          : NEITHER;
    const double gauge = stance_null_set_gauge(row->of.set, x);
    row->outside++;
    if (row->excuse[e].starts++ == 0 || gauge > row->excuse[e].gauge) {
        row->excuse[e].gauge = gauge;
        row->excuse[e].index = index;
    }
}

static bool count_rows(const struct basin *b, const struct scenario *s, struct row *rows,
                       const struct motion *motion, stance_message *message)
{
    const struct results *const r = b->r;
    struct scenario_values *const values = malloc(sizeof *values);
    stance_case *const c = malloc(sizeof *c);
    bool good = (values && c) || statistics_no_memory(r, message);
    for (uint64_t i = 0; good && i < r->cases; i++) {
        size_t point[SCENARIO_MAX_AXES];
        stance_message ignored;
        results_point(r, i, point);
        struct row *const row = &rows[basin_row_of(b, point)];
        if (!row->asked)
            good = allowed_make(&row->of, s, i, message);
        row->asked = true;
        if (!row->of.set)
            continue;
        scenario_case_values(s, i, values);
        if (resolve_case(s, values, &row->of.design, i, c, &ignored))
            count_case(row, i, c, r->kind[i] == b->choice.of, motion);
    }
    free(c);
    free(values);
    return good;
}

static bool glued(const struct row *row)
{
    return row->of.set && allowed_glued(&row->of.equilibrium);
}

/* Of a row; `known`: there is a set. */
#define ROW(X)                                                                                     \
    X("starts", "", known ? as_whole(row->starts) : as_nothing(NULL), "starts", .width = 10)       \
    X("allowed", "", as_number(known ? allowed / starts : NAN), "allowed", "%.3f %%", 10,          \
      .percent = true)                                                                             \
    X("used", "", as_number(known ? (double)row->inside / allowed : NAN), "of that", "%.3f %%",    \
      10, .percent = true)                                                                         \
    X("outside", "shares", as_number(known ? (double)row->outside / starts : NAN), "outside",      \
      "%.3f %%", 10, .percent = true)                                                              \
    X("why", "there is no such set", known ? as_nothing("") : as_text(row->of.why.text), "",       \
      .width = 2, .left = true, .before = "  ")                                                    \
    X("unreached", "modes that no torque moves and that do not decay",                             \
      known ? as_whole((uint64_t)stance_null_set_unreached(row->of.set, NULL, NULL))               \
            : as_nothing(NULL))                                                                    \
    X("glued", "several contacts carry", as_tree(known ? json_boolean(glued(row)) : NULL))
#define EXCUSED(NAME, name, heading)                                                               \
    {{#name "_starts", heading, .width = 9, .group = #name, .key = "starts"},                      \
     known ? as_whole(row->excuse[NAME].starts) : as_nothing(NULL)},                               \
        {{#name "_farthest", "farthest", "%.4f", .width = 9, .group = #name, .key = "farthest"},   \
         as_number(row->excuse[NAME].starts && isfinite(row->excuse[NAME].gauge)                   \
                       ? row->excuse[NAME].gauge                                                   \
                       : NAN)},                                                                    \
        {{#name "_case", "case", .width = 9, .group = #name, .key = "case"},                       \
         row->excuse[NAME].starts ? as_whole(row->excuse[NAME].index) : as_nothing(NULL)},
#define EXCUSE_KEY(NAME, name, heading)                                                            \
    {#name, "{starts, farthest (null: no growth suffices), case}", NULL},
static const struct say_key row_keys[] = {TABLE_KEY_AT ROW(TABLE_KEY) EXCUSES(EXCUSE_KEY){0}};
const struct say_key basin_allowed_keys[] = {{"outcome", "", NULL}, {"rows", "", row_keys}, {0}};

static void add_row(struct table *t, const struct basin *b, size_t k, const struct row *row)
{
    const double starts = (double)row->starts, allowed = (double)row->allowed;
    const bool known = row->of.set != NULL;
    table_axes(t, b->r, b->by, b->by_axes, b->row[k].point);
    TABLE_FACTS(t, ROW(TABLE_FACT) EXCUSES(EXCUSED));
    table_end_row(t);
}

static const char text[] = BASIN_TITLE
    "Starts from which linear theory allows some controller to recover with these torques, while "
    "the\ncontacts stand; of that, what ends as {.asked}; and what does from outside of it\n\n"
    "[.glued:(" ALLOWED_GLUED ")\n[!.unreached:\n]]"
    "[.unreached:(no torque moves some modes that do not decay: starts with a part in them are not "
    "allowed)\n\n]"
    "{.rows}"
    "[.excuses:\nThose from outside by what they did: slipped, lifted (a foot; it may have "
    "slipped, "
    "too), or neither,\nfor linear theory is none of a robot far from its equilibrium; the "
    "farthest of each in units of the\nset, whose boundary is at 1, and which case that is\n\n"
    "{.excuses}]";

static int print_rows(const struct basin *b, const struct row *rows, enum table_form form)
{
    struct table t = {0};
    bool any_glued = false, unreached = false, excused = false;
    char view[300];
    size_t used = (size_t)snprintf(view, sizeof view, "at/");
    uint64_t excuses[EXCUSE_COUNT] = {0};
    for (size_t k = 0; k < b->rows; k++) {
        add_row(&t, b, k, &rows[k]);
        any_glued = any_glued || glued(&rows[k]);
        unreached = unreached ||
                    (rows[k].of.set && stance_null_set_unreached(rows[k].of.set, NULL, NULL) > 0);
        for (int e = 0; e < EXCUSE_COUNT; e++)
            excuses[e] += rows[k].excuse[e].starts;
    }
#define VIEW(NAME, name, heading)                                                                  \
    if (excuses[NAME] > 0)                                                                         \
        used += (size_t)snprintf(view + used, sizeof view - used,                                  \
                                 " " #name "_starts " #name "_farthest " #name "_case");
    EXCUSES(VIEW)
#undef VIEW
    excused = used > strlen("at/");
    json_t *const facts = TABLE_OBJECT(
        {"outcome", as_text(results_kind_names[b->choice.of])}, {".asked", as_text(basin_asked(b))},
        {".glued", as_truth(any_glued)}, {".unreached", as_truth(unreached)});
    if (excused)
        table_show(facts, ".excuses", &t, view, BASIN_SHOWN);
    return basin_say(b->r, form, facts, &t, "at/ starts allowed used outside why", text);
}

int basin_print_allowed(const struct basin *b, enum table_form form, stance_message *message)
{
    struct motion motion = {0};
    bool wrong = b->averaged >= 0 || b->rows > MOST_ROWS;
    for (size_t k = 0; k < b->rows; k++)
        wrong = wrong || b->row[k].slices > 1;
    if (wrong)
        return refuse(message,
                      "stance basin: --allowed needs a row for each point of the parameters, "
                      "%d of them at most: no --by, no sample of parameters",
                      MOST_ROWS);
    const struct scenario *const s = results_swept(b->r, message);
    struct row *const rows = calloc(b->rows + 1, sizeof *rows);
    const bool good = s && (rows || statistics_no_memory(b->r, message)) &&
                      basin_numbers(b->r, "slip_distance", &motion.slip, message) &&
                      basin_numbers(b->r, "footfalls", &motion.footfalls, message) &&
                      basin_numbers(b->r, "least_normal_force", &motion.least, message) &&
                      count_rows(b, s, rows, &motion, message);
    const int code = good ? print_rows(b, rows, form) : EXIT_IO;
    for (size_t k = 0; rows && k < b->rows; k++)
        allowed_free(&rows[k].of);
    free(motion.slip);
    free(motion.footfalls);
    free(motion.least);
    free(rows);
    return code;
}
