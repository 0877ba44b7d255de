/* command_failure.c - `stance bench failure`: runs the failure studies, judges and maps them. */
#include "failure.h"
#include "studies.h"

#include <math.h>

extern const struct command command_failure; /* below */

/* ---- facts -------------------------------------------------------------------------------- */

/* For people. */
static bool give_shares(json_t *facts, const struct failure *f)
{
    struct table t = {0};
    for (int v = 0; v < FAILURE_VERDICT_COUNT; v++) {
        uint64_t sum = 0;
        for (size_t k = 0; k < f->rows; k++)
            sum += f->row[k].count[v];
        if (sum == 0)
            continue;
        TABLE_FACTS(
            &t, {{"verdict", "share of the cases, %", .width = 28, .left = true, .group = "seen"},
                 as_text(failure_styles[v].text)});
        for (size_t k = 0; k < f->rows; k++) {
            char name[40];
            failure_row_name(&f->row[k], name);
            TABLE_FACTS(&t, {{name, name, "%.2f", .width = 18, .percent = true, .group = "seen"},
                             as_number((double)f->row[k].count[v] / (double)f->cells)});
        }
        table_end_row(&t);
    }
    return table_give(facts, ".shares", &t, "seen/", 0);
}

static json_t *row_facts(const struct failure *f, size_t k)
{
    const struct failure_row *row = &f->row[k];
    json_t *shares = json_object(), *reasons = json_object(), *map = json_array();
    char name[40];
    for (int v = 0; v < FAILURE_VERDICT_COUNT; v++)
        table_put(shares, failure_styles[v].name, as_whole(row->count[v]));
    for (int v = 0; v < STANCE_FAILURE_COUNT; v++)
        if (row->reason[v] > 0)
            table_put(reasons, stance_failure_name[v], as_whole(row->reason[v]));
    for (size_t i = 0; i < f->count[1]; i++) {
        json_t *line = json_array();
        for (size_t j = 0; j < f->count[2]; j++) {
            const uint8_t verdict = f->verdict[k * f->cells + i * f->count[2] + j];
            table_append(line, as_text(failure_styles[verdict].name));
        }
        json_array_append_new(map, line);
    }
    json_t *const sides = f->line.axis > 0 ? json_array() : NULL;
    for (int side = 0; sides && side < 2; side++)
        TABLE_APPEND(sides, {"failed", as_whole(row->bad[side])}, {"of", as_whole(row->side[side])},
                     {"stand", as_whole(row->stands[side])});
#define LARGEST(NAME, name, bound) {#name, as_number(row->largest[FAILURE_##NAME])},
    return TABLE_OBJECT({"method", as_text(row->method->name)},
                        {".name", as_text(failure_row_name(row, name))},
                        {"tolerance", as_number(row->tolerance)}, {"cases", as_tree(shares)},
                        {"failed", as_tree(reasons)}, FAILURE_LARGEST(LARGEST){"map", as_tree(map)},
                        {".sides", as_tree(sides)});
}

static json_t *theory_facts(const struct failure *f, const struct results *r)
{
    if (f->line.axis == 0)
        return json_null();
    json_t *values = json_array();
    for (size_t i = 0; i < f->count[f->line.axis]; i++)
        table_append(values, as_number(f->line.value[i]));
    return TABLE_OBJECT(
        {"text", as_text(f->line.text)}, {"along", as_text(r->axis[f->line.axis].name)},
        {"of", as_text(r->axis[3 - f->line.axis].name)}, {"values", as_tree(values)});
}

static json_t *study_facts(const struct failure *f, const struct results *r)
{
    json_t *rows = json_array(), *axes = json_array();
    for (int a = 1; a < 3; a++) {
        const struct results_axis *const axis = &r->axis[a];
        json_t *const values = json_array();
        for (size_t i = 0; i < axis->count; i++)
            table_append(values, as_place(axis, i));
        TABLE_APPEND(axes, {"name", as_text(axis->name)}, {"unit", as_text(axis->unit)},
                     {"values", as_tree(values)}, {".count", as_whole(axis->count)});
    }
    for (size_t k = 0; k < f->rows; k++)
        json_array_append_new(rows, row_facts(f, k));
    return TABLE_OBJECT({"name", as_text(r->name)}, {"title", as_text(r->title)},
                        {"file", as_text(r->file)}, {"axes", as_tree(axes)},
                        {"theory", as_tree(theory_facts(f, r))}, {"rows", as_tree(rows)});
}

static const char text[] =
    "\n{title}\n  {axes/0/name} ({axes/0/.count} values) x {axes/1/name} ({axes/1/.count} values)\n"
    "{.shares}[theory:  line of theory: {text}\n]"
    "[rows*:  {.name%-18s} energy created at most {energy_gain%.2g} J, {energy_share%.2g} of that "
    "at the start; penetration {max_penetration%.0e} m, residuals {signorini_residual%.0e}, "
    "{coulomb_residual%.0e}, {dissipation_residual%.0e}\n"
    "[failed:                     failed: [failed*, :{key} {value}]\n]"
    "[.sides:                     before the line of theory {.sides/0/failed} of {.sides/0/of} "
    "failed, {.sides/0/stand} came to stand; beyond it {.sides/1/failed} of {.sides/1/of} and "
    "{.sides/1/stand}\n]]";

/* ---- the command --------------------------------------------------------------------------- */

static bool study(const struct plot *plot, json_t **object)
{
    const struct results *const r = plot->r;
    struct failure f;
    if (!failure_make(&f, r, plot->message))
        return false;
    json_t *const facts = study_facts(&f, r);
    bool good = give_shares(facts, &f);
    if (object)
        *object = facts;
    else
        good = say_facts(facts, false, text, stdout) && good && fflush(stdout) == 0 &&
               failure_plot(&f, plot);
    failure_free(&f);
    return good;
}

static int run(int argc, char **argv)
{
    static const struct study_kind kind = {"failure", failure_fits, study};
    return studies_run(&command_failure, &kind, argc, argv);
}

const struct command command_failure = {
    "bench failure",
    "where each method fails, as maps with the lines of theory",
    run,
    studies_options,
    "Runs studies, by default those of scenarios/failure, like any other scenario. The first axis "
    "of a study varies method.name (with method.tolerance), the other two are a map. Every cell "
    "is compared with event-driven, or with the most exact row of capturing where event-driven "
    "gave up; with method.step on the map, both at the smallest step. It gets the first of\n"
    "  gave_up        the case failed; `failed` counts the reasons\n"
    "  ran_away       numbers not finite, angles beyond 1e4 rad, or more energy created than "
    "there was at the start (kinetic, and potential above z = 0; at least 1 mJ)\n"
    "  broke_law      penetration beyond 1e-6 m, or a residual of a contact law beyond 1e-6\n"
    "  wrong_outcome  not the reference's\n"
    "  inaccurate     a coordinate is off by more than 0.01 m or rad at the end\n"
    "  unjudged       there is no reference\n"
    "  right_other, right_stands  as the reference; whether it came to stand or rest\n"
    "A line in the maps is what theory says, where it is known: the limit of stability of "
    "explicit steps (servo of the biped's legs), T* of a sampled controller, Painleve's paradox "
    "(rod). A second picture shows the energy that discretisation created.\n",
    "    name, title, file   strings\n"
    "    axes                the two of the map: name, unit, values\n"
    "    theory              null, or text, along (an axis), of (the other), values: of the other "
    "axis, for each point along; null where there is none\n"
    "    rows                method, tolerance, cases (for each verdict), failed (for each "
    "reason), energy_gain (J), energy_share (of that at the start), max_penetration, "
    "signorini_residual, coulomb_residual, dissipation_residual: largest of the cases that did "
    "not fail; map: verdicts, a list for each point of the first axis\n",
};
