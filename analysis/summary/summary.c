/* summary.c - what a results file is, what came out of its cases, with what numbers and effort. */
#include "summary.h"

#include "analysis/statistics/faces.h"
#include "analysis/statistics/statistics.h"
#include "runner/plan/ground_line.h"
#include "runner/store/results.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define THROUGH 1e-9 /* m: less is rounding of what lies on the ground */
#define TOUCHES 1e-9 /* m, rad */

enum results_kind summary_judged(const struct results *r)
{
    const struct scenario_values *const base = r->read ? &r->read->base : NULL;
    const stance_law *const law = base ? scenario_law(base) : NULL;
    return base && base->walk_steps > 0                                    ? RESULTS_WALKS
           : !law || law->designed || (law->program && !base->state_given) ? RESULTS_STABILISED
                                                                           : RESULTS_RESTED;
}

double summary_share(const struct summary *summary, const struct statistics_counts *counts)
{
    return counts->done ? (double)counts->kind[summary->judged] / (double)counts->done : NAN;
}

/* ---- the file ----------------------------------------------------------------------------- */

/* What a sample varies: its least value and its largest. */
static json_t *varied_facts(const struct results_varied *v)
{
    json_t *const facts = json_object();
    char first[128], last[128];
    size_t low = 0, high = 0;
    for (size_t i = 1; i < v->of.count; i++) {
        low = v->of.value[i] < v->of.value[low] ? i : low;
        high = v->of.value[i] > v->of.value[high] ? i : high;
    }
    results_varied_text(v, low, false, first, sizeof first);
    results_varied_text(v, high, true, last, sizeof last);
    say_add(facts, "path", "  %s", v->of.name);
    say_add(facts, "range", "%s ... %s%s%s", first, last, v->of.text[0] ? "; " : "", v->of.text);
    return facts;
}

static json_t *axes_facts(const struct results *r, size_t *width)
{
    json_t *const list = json_array();
    char first[128], last[128];
    for (int a = 0; !r->single && a < r->axes; a++) {
        const struct results_axis *const axis = &r->axis[a];
        json_t *const varied = json_array();
        json_t *const facts = TABLE_OBJECT(
            {"path", as_text(axis->name)}, {"unit", as_text(axis->unit[0] ? axis->unit : NULL)},
            {"long_name", as_text(axis->text[0] ? axis->text : NULL)},
            {"count", as_whole(axis->count)}, {"first", as_place(axis, 0)},
            {"last", as_place(axis, axis->count - 1)}, {".varied", as_tree(varied)});
        const char *const order = results_ends_text(axis, first, last, sizeof first);
        *width = strlen(axis->name) > *width ? strlen(axis->name) : *width;
        for (int k = 0; a == r->sample && k < r->varied; k++) {
            const size_t length = strlen(r->vary[k].of.name) + 2;
            *width = length > *width ? length : *width;
            json_array_append_new(varied, varied_facts(&r->vary[k]));
        }
        if (a == r->sample)
            say_add(facts, ".range", "%zu points, %s", axis->count, r->method);
        else
            say_add(facts, ".range", "%s ... %s, %zu value%s%s%s%s", first, last, axis->count,
                    axis->count == 1 ? "" : "s", order, axis->text[0] ? "; " : "", axis->text);
        json_array_append_new(list, facts);
    }
    return list;
}

bool summary_head(const struct summary *summary)
{
    const struct results *const r = summary->r;
    json_t *const facts = summary->facts, *const scenarios = json_array();
    struct ancestry ancestry;
    size_t width = 0;
    char judged[SCENARIO_NAME];
    snprintf(judged, sizeof judged, "%s", results_kind_names[summary->judged]);
    judged[0] = (char)toupper(judged[0]);
    if (!ancestry_read(r, &ancestry, summary->message))
        return false;
    for (size_t k = 0; k < ancestry.scenarios; k++)
        TABLE_APPEND(scenarios, {"date", as_text(ancestry.date[k])},
                     {"done", as_whole(ancestry.done[k])});
    TABLE_PUT(facts, {"file", as_text(r->file)}, {"title", as_text(r->title)},
              {"version", as_text(r->version)}, {"revision", as_text(r->revision)},
              {"date", as_text(r->date)}, {"ranks", as_whole((uint64_t)r->ranks)},
              {".name", as_text(r->title[0] ? r->title : r->name)},
              {".sampled", as_truth(r->sample >= 0)}, {".shards", as_whole(r->shard.count)},
              {".judged", as_text(results_kind_names[summary->judged])},
              {".Judged", as_text(judged)}, {".scenarios", as_whole(ancestry.scenarios)});
    if (r->shard.count > 0 && r->shard.count <= r->cases) {
        const struct shard shard = shard_of(&r->shard, r->cases);
        table_put(facts, ".shard",
                  as_tree(TABLE_OBJECT({"number", as_whole(shard.number)},
                                       {"count", as_whole(shard.count)},
                                       {"rows", as_whole(shard_rows(&shard))})));
    }
    if (ancestry.scenarios > 1)
        json_object_set(facts, "scenarios", scenarios);
    json_decref(scenarios);
    table_put(facts, "axes", as_tree(axes_facts(r, &width)));
    table_put(facts, ".width", as_whole(width));
    return true;
}

/* ---- outcomes ----------------------------------------------------------------------------- */

static bool add_outcomes(struct summary *summary)
{
    const struct results *const r = summary->r;
    const struct statistics_counts *const counts = &summary->counts;
    struct table t = {.named = true};
    for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
        struct interval interval = {NAN, NAN};
        if (k == RESULTS_PENDING || k == RESULTS_FAILED)
            continue;
        if (r->sample >= 0 && !intervals_find(r, (enum results_kind)k, -1, NULL, 1, &interval))
            return statistics_no_memory(r, summary->message);
        if (k == (int)summary->judged)
            summary->share = interval;
        if (k == RESULTS_DONE && counts->kind[k] == 0)
            continue;
        TABLE_FACTS(
            &t,
            {{"outcome", .hidden = TABLE_NO_JSON, .width = 11, .left = true},
             as_text(results_kind_names[k])},
            {{"count", .before = "", .width = 12}, as_whole(counts->kind[k])},
            {{"share", .format = "%.3f %%", .before = "  ", .width = 9, .percent = true},
             as_number(counts->done ? (double)counts->kind[k] / (double)counts->done : NAN)},
            {{"low", .format = "(%.3f", .before = "   ", .left = true, .empty = "",
              .percent = true},
             as_number(interval.low)},
            {{"high", .format = "%.3f %%)", .joined = true, .before = " ... ", .percent = true},
             as_number(interval.high)});
        table_end_row(&t);
    }
    if (summary->known)
        return table_give(summary->facts, "outcomes", &t, "outcome count share low high", 0);
    table_put(summary->facts, "outcomes", as_nothing(NULL));
    table_free(&t);
    return true;
}

/* Reasons of failures, and the first case that has one. */
static void add_failures(const struct summary *summary)
{
    const struct results *const r = summary->r;
    json_t *const reasons = json_object(), *const told = json_array();
    uint64_t failures[STANCE_FAILURE_COUNT + 1] = {0}, first = UINT64_MAX;
    for (uint64_t i = 0; i < r->cases; i++) {
        if (r->kind[i] == RESULTS_FAILED) {
            const int reason = r->failure ? r->failure[i] : 0;
            failures[reason < STANCE_FAILURE_COUNT ? reason : STANCE_FAILURE_COUNT]++;
            first = i < first ? i : first;
        }
    }
    for (int f = 0; f <= STANCE_FAILURE_COUNT; f++) {
        if (failures[f] == 0)
            continue;
        const bool known = f < STANCE_FAILURE_COUNT;
        const char *const name = known ? stance_failure_name[f] : "unknown";
        table_put(reasons, name, as_whole(failures[f]));
        TABLE_APPEND(told, {"count", as_whole(failures[f])}, {"reason", as_text(name)},
                     {"text", as_text(known && f > 0 ? stance_failure_text[f]
                                                     : "the file does not say why")});
    }
    TABLE_PUT(summary->facts, {"failures", as_tree(reasons)}, {".failures", as_tree(told)},
              {".first_failed", as_whole(first)});
}

/* By what cases fell, as the file names it. */
static bool add_causes(const struct summary *summary)
{
    const struct results *const r = summary->r;
    struct results_column column;
    double *values = NULL;
    uint64_t fallen[STANCE_MAX_WORDS] = {0};
    json_t *const causes = json_object(), *const told = json_array();
    if (!results_column_open(r, stance_answers[STANCE_ANSWER_fall_cause].name, &column,
                             summary->message))
        return false;
    const bool good = column.id < 0 || results_answer(r, column.name, &values, summary->message);
    for (uint64_t i = 0; values && i < r->cases; i++)
        if (r->kind[i] == RESULTS_FELL && values[i] >= 0 && values[i] < STANCE_MAX_WORDS)
            fallen[(int)values[i]]++;
    char *rest = column.words;
    for (int k = 0; k < STANCE_MAX_WORDS; k++) {
        const char *const cause = rest ? strsep(&rest, " ") : "";
        if (k == 0 || fallen[k] == 0)
            continue;
        table_put(causes, cause, as_whole(fallen[k]));
        TABLE_APPEND(told, {"cause", as_text(cause)}, {"count", as_whole(fallen[k])},
                     {"share", as_number((double)fallen[k] / (double)summary->counts.done)});
    }
    free(values);
    results_column_close(&column);
    TABLE_PUT(summary->facts, {"fall_causes", as_tree(causes)}, {".fallen", as_tree(told)});
    return good;
}

/* Whether the share is the box's, or where there is no boundary to be seen. */
static void add_cut(const struct summary *summary)
{
    const struct statistics_counts *const counts = &summary->counts;
    struct faces faces;
    char text[2048];
    faces_make(&faces, summary->r, NULL, 0);
    const face_set cut = faces_cut(&faces, summary->judged);
    faces_text(&faces, cut, text, sizeof text);
    const bool starts = faces.starts > 0, many = counts->done > 1;
    const char *const whole = counts->kind[RESULTS_STABILISED] == counts->done ? "domain"
                              : counts->kind[RESULTS_FELL] == counts->done     ? "none"
                                                                               : NULL;
    TABLE_PUT(summary->facts, {"cut", as_tree(faces_json(&faces, cut))}, {".cut", as_text(text)},
              {".uncut", as_text(!starts || counts->kind[summary->judged] == 0 ? NULL
                                 : counts->done < summary->r->cases ? "not known to be cut"
                                                                    : "not cut")},
              {".whole", as_text(starts && many ? whole : NULL)});
}

bool summary_outcomes(struct summary *summary)
{
    const struct results *const r = summary->r;
    const struct statistics_counts *const counts = &summary->counts;
    const double done = (double)counts->done;
    uint64_t inferred;
    if (!statistics_inferred(r, &inferred, NULL, summary->message))
        return false;
    json_t *const cases =
        TABLE_OBJECT({"total", as_whole(r->cases)}, {"done", as_whole(counts->done)},
                     {"failed", as_whole(counts->kind[RESULTS_FAILED])},
                     {"pending", as_whole(counts->kind[RESULTS_PENDING])},
                     {"inferred", as_whole(inferred)}, {"damaged", as_whole(r->damage.cases)});
    table_put(summary->facts, "cases", as_tree(cases));
    table_put(summary->facts, ".inferred", as_number((double)inferred / done));
    table_put(summary->facts, ".shared",
              as_truth(r->sample >= 0 && r->cases > r->axis[r->sample].count));
    table_put(summary->facts, ".one",
              as_number(r->sample < 0 && counts->done > 1 ? 100 / done : NAN));
    add_failures(summary);
    if (!add_outcomes(summary))
        return false;
    add_cut(summary);
    return add_causes(summary);
}

/* ---- a single case ------------------------------------------------------------------------ */

/* Contacts on the ground, stops reached, where it failed: "foot1, foot2". */
static void add_touching(const struct summary *summary, json_t *facts)
{
    const struct results *const r = summary->r;
    const struct scenario *const s = r->read;
    double state[SCENARIO_MAX_STATES], gap[STANCE_MAX_CONTACTS];
    if (!s || (s->axes > 0 && r->index >= s->cases) ||
        results_numbers(r, "final_state", state, SCENARIO_MAX_STATES) !=
            2 * (size_t)s->scene->coordinates)
        return;
    struct scenario_values values = s->base;
    if (s->axes > 0)
        scenario_case_values(s, r->index, &values);
    stance_case *const c = malloc(sizeof *c);
    if (!c)
        return;
    ground_case(s, &values, r->index, c);
    ground_gaps(c, state, gap);
    free(c);
    for (int k = 0; k < s->scene->contacts; k++) {
        const bool stop = s->scene->grip[k] < 0;
        if (gap[k] <= TOUCHES && (stop || values.contacts >> k & 1))
            say_add(facts, ".touching", "%s%s", json_object_get(facts, ".touching") ? ", " : "",
                    s->scene->contact_name[k]);
    }
}

/* {name: value}, and for people in two lines. */
static void add_final_state(const struct results *r, bool done, json_t *facts)
{
    char name[SCENARIO_MAX_STATES][SCENARIO_NAME];
    double state[SCENARIO_MAX_STATES];
    json_t *const final = json_object();
    size_t n = results_words(r, "state", name, SCENARIO_MAX_STATES);
    n = done && results_numbers(r, "final_state", state, SCENARIO_MAX_STATES) == n ? n : 0;
    for (size_t i = 0; i < n; i++) {
        table_put(final, name[i], as_number(state[i]));
        say_add(facts, ".final_state", "%s%s %.6g",
                i == 0       ? ""
                : i == n / 2 ? ",\n               "
                             : ", ",
                name[i], state[i]);
    }
    table_put(facts, "final_state", as_tree(final));
}

bool summary_case(const struct summary *summary)
{
    static const char *const times[][2] = {
        {"end_time", "ended at"}, {"settle_time", "settled at"}, {"fall_time", "fell at"}};
    const struct results *const r = summary->r;
    const bool failed = r->kind[0] == RESULTS_FAILED,
               done = !failed && r->kind[0] != RESULTS_PENDING;
    json_t *const told = json_array(), *const facts = TABLE_OBJECT(
                                           {"index", as_whole(r->index)},
                                           {"outcome", as_text(results_kind_names[r->kind[0]])});
    const json_t *const reasons = json_object_get(summary->facts, ".failures");
    table_put(facts, "failure",
              failed && r->failure ? as_text(json_string_value(
                                         json_object_get(json_array_get(reasons, 0), "reason")))
                                   : as_nothing(NULL));
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
        double time = NAN;
        if (results_numbers(r, times[k][0], &time, 1) != 1)
            time = NAN;
        if (failed && k == 0)
            table_put(facts, ".step", as_number(time));
        table_put(facts, times[k][0], as_number(done ? time : NAN));
        if (done && !isnan(time))
            TABLE_APPEND(told, {"what", as_text(times[k][1])}, {"time", as_number(time)});
    }
    if (failed)
        add_touching(summary, facts);
    table_put(facts, ".times", as_tree(told));
    table_put(facts, ".done", as_truth(done));
    add_final_state(r, done, facts);
    table_put(summary->facts, "case", as_tree(facts));
    return true;
}

/* ---- numbers ------------------------------------------------------------------------------ */

/* An answer that is summarised, of the cases of a kind: RESULTS_STABILISED is what the study judges
 * by, RESULTS_KIND_COUNT all that are done. */
static const struct number {
    int answer;
    enum results_kind of;
    bool idle;            /* 0 throughout is nothing to tell: nothing is actuated, nothing struck */
    const char *residual; /* how far cases are from a law that they ought to obey: its name */
} number[] = {
    {STANCE_ANSWER_settle_time, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_step_time, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_step_length, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_walking_speed, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_cost_of_transport, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_gait_period, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_friction_used, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_impact_friction, RESULTS_STABILISED, true, NULL},
    {STANCE_ANSWER_least_normal_force, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_excursion, RESULTS_STABILISED, true, NULL},
    {STANCE_ANSWER_slip_distance, RESULTS_STABILISED, false, NULL},
    {STANCE_ANSWER_fall_time, RESULTS_FELL, false, NULL},
    {STANCE_ANSWER_footfalls, RESULTS_KIND_COUNT, true, NULL},
    {STANCE_ANSWER_peak_torque, RESULTS_KIND_COUNT, true, NULL},
    {STANCE_ANSWER_max_penetration, RESULTS_KIND_COUNT, false, NULL},
    {STANCE_ANSWER_through_ground, RESULTS_KIND_COUNT, false, NULL},
    {STANCE_ANSWER_impact_energy, RESULTS_KIND_COUNT, false, NULL},
    {STANCE_ANSWER_projection_energy, RESULTS_KIND_COUNT, false, NULL},
    {STANCE_ANSWER_signorini_residual, RESULTS_KIND_COUNT, false, "Signorini"},
    {STANCE_ANSWER_coulomb_residual, RESULTS_KIND_COUNT, false, "Coulomb"},
    {STANCE_ANSWER_dissipation_residual, RESULTS_KIND_COUNT, false, "dissipation"},
    {STANCE_ANSWER_energy_gain, RESULTS_KIND_COUNT, false, "energy gained"},
    {STANCE_ANSWER_energy_drift, RESULTS_KIND_COUNT, false, "drifted"},
};

static void add_number(struct table *t, const stance_answer *answer, const char *unit,
                       const char *of, const struct statistics_numbers *n)
{
    char label[64];
    snprintf(label, sizeof label, unit ? "  %s (%s)" : "  %s", answer->name, unit);
    TABLE_FACTS(
        t, {{"answer", .hidden = TABLE_NO_JSON}, as_text(answer->name)},
        {{"label", "Numbers", .hidden = TABLE_VIEW_ONLY, .before = "", .width = 26, .left = true},
         as_text(label)},
        {{"of", .joined = true, .before = " "}, as_text(of)}, {{.name = "unit"}, as_text(unit)},
        {{"count", "cases", .before = "  ", .left = true}, as_whole(n->n)},
        {{"smallest", "smallest", "%.4g", .width = 10}, as_number(n->low)},
        {{"median", "median", "%.4g", .width = 10}, as_number(n->median)},
        {{"q90", "90 %", "%.4g", .width = 10}, as_number(n->q90)},
        {{"q99", "99 %", "%.4g", .width = 10}, as_number(n->q99)},
        {{"largest", "largest", "%.4g", .width = 10}, as_number(n->high)});
    table_end_row(t);
}

/* Of a contact that the scenario leaves out: how many cases, and how many of those judged by. */
static uint64_t add_through(const struct summary *summary, const double *depth)
{
    const struct results *const r = summary->r;
    uint64_t through = 0, judged = 0;
    for (uint64_t i = 0; depth && i < r->cases; i++) {
        through += depth[i] > THROUGH; /* false for NAN, too */
        judged += depth[i] > THROUGH && r->kind[i] == summary->judged;
    }
    table_put(summary->facts, "through_ground",
              as_tree(TABLE_OBJECT({"cases", as_whole(through)}, {"judged", as_whole(judged)})));
    return through;
}

bool summary_numbers(const struct summary *summary)
{
    const struct results *const r = summary->r;
    struct table all = {.named = true}, seen = {0};
    json_t *const residuals = json_array(), *const single = json_array();
    bool good = true;
    table_put(summary->facts, "numbers", as_nothing(NULL)); /* its place */
    add_through(summary, NULL);
    for (size_t k = 0; good && k < sizeof number / sizeof *number; k++) {
        const struct number *const row = &number[k];
        const stance_answer *const answer = &stance_answers[row->answer];
        const char *const unit = strcmp(answer->unit, "1") == 0 ? NULL : answer->unit;
        const enum results_kind of = row->of == RESULTS_STABILISED ? summary->judged : row->of;
        const char *const of_word = of == RESULTS_KIND_COUNT ? "done" : results_kind_names[of];
        struct statistics_numbers n;
        double *values;
        if (!(good = results_answer(r, answer->name, &values, summary->message)) || !values)
            continue;
        const bool around =
            row->answer == STANCE_ANSWER_through_ground && add_through(summary, values) == 0;
        const double one = r->single ? values[0] : NAN;
        for (uint64_t i = 0; of != RESULTS_KIND_COUNT && i < r->cases; i++)
            values[i] = r->kind[i] == of ? values[i] : NAN;
        statistics_summarise(values, (size_t)r->cases, &n);
        free(values);
        add_number(&all, answer, unit, of_word, &n);
        if (row->residual && n.n > 0)
            TABLE_APPEND(residuals, {"law", as_text(row->residual)}, {"largest", as_number(n.high)},
                         {"unit", as_text(unit ? unit : "")});
        if (row->residual)
            continue;
        if (n.n > 0 && !around && !(row->idle && n.high == 0))
            add_number(&seen, answer, unit, of_word, &n);
        if (!isnan(one) && row->answer != STANCE_ANSWER_settle_time &&
            row->answer != STANCE_ANSWER_fall_time &&
            !(row->answer == STANCE_ANSWER_footfalls && one == 0))
            TABLE_APPEND(single, {"answer", as_text(answer->name)}, {"is", as_number(one)},
                         {"unit", as_text(unit ? unit : "")});
    }
    table_put(summary->facts, ".residuals", as_tree(residuals));
    table_put(summary->facts, ".single", as_tree(single));
    good = table_give(summary->facts, "numbers", &all, NULL, 0) && good;
    return table_give(summary->facts, ".numbers", &seen,
                      "label smallest median q90 q99 largest count of", 0) &&
           good;
}

/* ---- cost --------------------------------------------------------------------------------- */

/* A count per case: name, name in JSON of the cases that have any, text. Those that are signs of
 * trouble come last and are told even if there are none. */
static const struct count {
    const char *name, *cases, *text;
    bool trouble;
} count[] = {
    {"steps", NULL, NULL, false},
    {"iterations", NULL, NULL, false},
    {"evaluations", NULL, NULL, false},
    {"events", "events_cases", "events, changes of contact mode", false},
    {"limited_impacts", "limited_cases", "impacts with less restitution than asked for", false},
    {"degraded_samples", "degraded_cases",
     "samples at which decoupling could not do what it promises", false},
    {"subdivided_steps", "subdivided_cases", "steps that had to be subdivided", true},
    {"ambiguous_steps", "ambiguous_cases", "steps with several contact solutions", true},
};

/* The sum over the cases, and how many have any; false: it cannot be read. */
static bool add_count(const struct summary *summary, const struct count *of, json_t *cost,
                      json_t *told)
{
    double *values, sum = 0;
    uint64_t cases = 0;
    if (!results_answer(summary->r, of->name, &values, summary->message) || !values)
        return !summary->message->text[0];
    for (uint64_t i = 0; i < summary->r->cases; i++) {
        if (values[i] > 0) { /* false for NAN, too */
            sum += values[i];
            cases++;
        }
    }
    free(values);
    table_put(cost, of->name, as_whole((uint64_t)sum));
    if (of->cases)
        table_put(cost, of->cases, as_whole(cases));
    if (of->text && (of->trouble || sum > 0))
        TABLE_APPEND(told, {"text", as_text(of->text)}, {"sum", as_number(sum)},
                     {"cases", as_whole(cases)});
    return true;
}

bool summary_cost(const struct summary *summary)
{
    json_t *const cost = json_object(), *const told = json_array();
    double longest, total, cases;
    size_t ranks = 0;
    bool good = true;
    for (size_t k = 0; good && k < sizeof count / sizeof *count; k++)
        good = add_count(summary, &count[k], cost, told);
    const json_t *const steps = json_object_get(cost, "steps"),
                        *const iterations = json_object_get(cost, "iterations"),
                        *const evaluations = json_object_get(cost, "evaluations");
    if (steps && iterations)
        table_put(cost, "iterations_per_step",
                  as_number(json_number_value(iterations) / json_number_value(steps)));
    if (evaluations && json_number_value(evaluations) != json_number_value(iterations))
        table_put(cost, ".evaluations",
                  as_number(json_number_value(evaluations) / json_number_value(steps)));
    const bool timed = results_timing(summary->r, &longest, &total, &cases, &ranks);
    TABLE_PUT(cost, {"wall_time", as_number(timed ? longest : NAN)},
              {"total_time", as_number(timed ? total : NAN)},
              {"cases_per_second", as_number(timed ? cases / longest : NAN)},
              {".timed", as_truth(timed)}, {".ranks", as_whole(ranks)}, {".counts", as_tree(told)},
              {".steps", as_truth(steps != NULL)});
    table_put(summary->facts, "cost", as_tree(cost));
    return good;
}
