/* basin_allowed.c - a basin against what linear theory allows any controller: the starts in the
 * null-controllable set of the robot about its equilibrium (engine/control/null_controllable.c), of
 * these the ones with the outcome, and those with the outcome that are not in it. Linear theory is
 * no bound: a robot far from its equilibrium, or one that slips, may recover from outside. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"
#include "runner/plan/design.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROWS = 2000 };

/* Of a row: its design, and how many of its starts are where. */
struct allowed {
    stance_null_set *set; /* NULL where there is none: `why` */
    bool asked;
    stance_message why;
    stance_equilibrium equilibrium;
    struct resolved_design design;
    uint64_t starts, allowed, inside, outside;
};

static void look_at_row(struct allowed *row, const struct scenario *s, uint64_t index,
                        struct scenario *at, struct design_report *report)
{
    row->asked = true;
    *at = *s;
    scenario_case_values(s, index, &at->base);
    if (!resolve_design(s->scene, &at->base, &row->design, &row->why) ||
        !design_loop(report, at, &row->why))
        return;
    row->equilibrium = report->equilibrium;
    row->set = design_null_set(report, &row->why);
}

static void count_case(struct allowed *row, const struct scenario *s, uint64_t index,
                       const struct scenario_values *values, stance_case *c, bool has_outcome)
{
    const stance_equilibrium *const e = &row->equilibrium;
    double x[2 * STANCE_MAX_POSTURE];
    stance_message ignored;
    if (!resolve_case(s->scene, values, &row->design, s->seed, index, c, &ignored))
        return;
    for (int i = 0; i < e->freedoms; i++) {
        x[i] = c->position[e->freedom[i]] - e->position[e->freedom[i]];
        x[e->freedoms + i] = c->velocity[e->freedom[i]];
    }
    const bool holds = stance_null_set_holds(row->set, x);
    row->starts++;
    row->allowed += holds;
    row->inside += holds && has_outcome;
    row->outside += !holds && has_outcome;
}

static bool count_rows(const struct basin *b, const struct scenario *s, struct allowed *rows,
                       stance_message *message)
{
    const struct results *const r = b->r;
    struct scenario *const at = malloc(sizeof *at);
    struct design_report *const report = malloc(sizeof *report);
    struct scenario_values *const values = malloc(sizeof *values);
    stance_case *const c = malloc(sizeof *c);
    const bool good = at && report && values && c;
    for (uint64_t i = 0; good && i < r->cases; i++) {
        size_t point[SCENARIO_MAX_AXES];
        results_point(r, i, point);
        struct allowed *const row = &rows[basin_row_of(b, point)];
        if (!row->asked)
            look_at_row(row, s, i, at, report);
        if (!row->set)
            continue;
        scenario_case_values(s, i, values);
        count_case(row, s, i, values, c, r->kind[i] == b->choice.of);
    }
    free(c);
    free(values);
    free(report);
    free(at);
    return good || statistics_no_memory(r, message);
}

static void add_row(struct table *t, const struct basin *b, size_t k, const struct allowed *row)
{
    const double starts = (double)row->starts, allowed = (double)row->allowed;
    const bool known = row->set != NULL;
    table_axes(t, b->r, b->by, b->by_axes, b->row[k].point);
    TABLE_FACTS(t, {{"starts", "starts", .width = 10}, as_whole(row->starts)},
                {{"allowed", "allowed", "%.3f %%", .width = 10, .percent = true},
                 as_number(known ? allowed / starts : NAN)},
                {{"used", "of that", "%.3f %%", .width = 10, .percent = true},
                 as_number(known ? (double)row->inside / allowed : NAN)},
                {{"outside", "outside", "%.3f %%", .width = 10, .percent = true},
                 as_number(known ? (double)row->outside / starts : NAN)},
                {{"why", "", .width = 2, .left = true, .before = "  "},
                 known ? as_nothing("") : as_text(row->why.text)});
    table_end_row(t);
}

bool basin_print_allowed(const struct basin *b, enum table_form form, bool *usage,
                         stance_message *message)
{
    struct table t = {0};
    struct scenario s;
    *usage = b->averaged >= 0 || b->rows > MOST_ROWS;
    for (size_t k = 0; k < b->rows; k++)
        *usage = *usage || b->row[k].slices > 1;
    if (*usage)
        return complain(message,
                        "stance basin: --allowed needs a row for each point of the parameters, "
                        "%d of them at most: no --by, no sample of parameters",
                        MOST_ROWS);
    struct allowed *const rows = calloc(b->rows + 1, sizeof *rows);
    if (!rows)
        return statistics_no_memory(b->r, message);
    if (!scenario_read(&s, b->r->file, b->r->scenario, NULL, 0, stderr)) {
        free(rows);
        return complain(message, "%.150s: the scenario in it cannot be read", b->r->file);
    }
    const bool counted = count_rows(b, &s, rows, message);
    for (size_t k = 0; k < b->rows; k++) {
        if (counted)
            add_row(&t, b, k, &rows[k]);
        stance_null_set_free(rows[k].set);
    }
    scenario_free(&s);
    free(rows);
    if (!counted)
        return false;
    if (form == TABLE_AS_TEXT)
        printf("%s\n%s: %" PRIu64 " cases\n\n"
               "Starts from which linear theory allows some controller to recover with these "
               "torques, while the\ncontacts stand; of that, what ends as %s; and what does from "
               "outside of it\n\n",
               b->r->title[0] ? b->r->title : b->r->name, b->r->file, b->r->cases, basin_asked(b));
    return basin_table_write(&t, form, "at/ starts allowed used outside why",
                             TABLE_OBJECT({"outcome", as_text(results_kind_names[b->choice.of])}));
}
