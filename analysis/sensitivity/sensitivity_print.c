/* sensitivity_print.c - the sensitivity of a study as facts, a text and a table. */
#include "sensitivity_study.h"

#include <math.h>

static bool is_sobol(const struct sensitivity_study *study)
{
    return study->design->method == DOE_SALTELLI;
}

static bool is_morris(const struct sensitivity_study *study)
{
    return study->design->method == DOE_MORRIS;
}

static const char *policy_word(const struct sensitivity_study *study)
{
    return study->request.fallen ? "fallen" : "drop";
}

/* What a block is called. */
static const char *block_word(const struct sensitivity_study *study, size_t count)
{
    static const char *const words[][2] = {
        {"block", "blocks"}, {"trajectory", "trajectories"}, {"point", "points"}};
    return words[is_sobol(study) ? 0 : is_morris(study) ? 1 : 2][count != 1];
}

/* ---- the table ---------------------------------------------------------------------------- */

/* Indices are shares, with as many decimals as matter; effects have a unit. */
static void add_measure(struct table *t, const char *word, const struct sensitivity_value *v,
                        bool share)
{
    char low[32], high[32];
    snprintf(low, sizeof low, "%s_low", word);
    snprintf(high, sizeof high, "%s_high", word);
    TABLE_FACTS(
        t,
        {{word, word, share ? "%.4f" : "%.4g", .width = 10, .group = word, .key = "estimate"},
         as_number(v->estimate)},
        {{low, "interval", share ? "(%.4f" : "(%.4g", .width = 24, .empty = "", .group = word,
          .key = "low"},
         as_number(v->low)},
        {{high, .format = share ? "%.4f)" : "%.4g)", .joined = true, .before = " ... ",
          .group = word, .key = "high"},
         as_number(v->high)});
}

/* A row for each factor, the most important first. */
static void add_factors(struct table *t, const struct sensitivity_study *study,
                        const struct sensitivity_table *table, enum table_form form)
{
    int kept[SCENARIO_MAX_AXES], count = 0;
    char name[128], response[200];
    for (int a = 0; a < study->r->axes; a++)
        if (study->kept[a])
            kept[count++] = a;
    sensitivity_response_text(study, response, sizeof response);
    for (size_t i = 0; i < study->factors; i++) {
        const size_t j = study->order[i];
        if (form == TABLE_AS_CSV)
            table_axes(t, study->r, kept, count, table->point);
        sensitivity_factor_text(study, j, name, sizeof name);
        json_t *paths = json_array();
        const char *path;
        for (int k = 0; (path = sensitivity_factor_path(study, j, k)); k++)
            table_append(paths, as_text(path));
        TABLE_FACTS(t, {{"factor", .key = "path"}, as_text(sensitivity_factor_path(study, j, 0))},
                    {{"label", "factor", .hidden = TABLE_VIEW_ONLY, .left = true}, as_text(name)},
                    {{.name = "paths"}, as_tree(paths)});
        for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++)
            if (table->s.measure[m])
                add_measure(t, sensitivity_words[m], &table->s.measure[m][j], !is_morris(study));
        TABLE_FACTS(t, {{"response", .hidden = TABLE_NO_JSON}, as_text(response)},
                    {{"failed_cases", .hidden = TABLE_NO_JSON}, as_text(policy_word(study))},
                    {{"blocks", .hidden = TABLE_NO_JSON}, as_whole(table->s.blocks)},
                    {{"mean", .hidden = TABLE_NO_JSON}, as_number(table->s.mean)},
                    {{"deviation", .hidden = TABLE_NO_JSON}, as_number(table->s.deviation)});
        table_end_row(t);
    }
}

/* ---- facts -------------------------------------------------------------------------------- */

static json_t *value_facts(const struct sensitivity_value *v)
{
    return TABLE_OBJECT({"estimate", as_number(v->estimate)}, {"low", as_number(v->low)},
                        {"high", as_number(v->high)});
}

/* People see pairs whose interval is above zero. */
static void add_pairs(const struct sensitivity_study *study, const struct sensitivity_table *table,
                      json_t *facts)
{
    const size_t k = study->factors;
    char one[128], other[128];
    bool any = false;
    json_t *const list = json_array();
    for (size_t i = 0; i < k; i++) {
        for (size_t j = i + 1; j < k; j++) {
            const struct sensitivity_value *v = &table->s.second[i * k + j];
            json_t *const entry = value_facts(v);
            any = any || v->low > 0;
            sensitivity_factor_text(study, i, one, sizeof one);
            sensitivity_factor_text(study, j, other, sizeof other);
            TABLE_PUT(entry,
                      {"paths", as_tree(table_texts(sensitivity_factor_path(study, i, 0),
                                                    sensitivity_factor_path(study, j, 0)))},
                      {".above", as_truth(v->low > 0)}, {".one", as_text(one)},
                      {".other", as_text(other)});
            json_array_append_new(list, entry);
        }
    }
    table_put(facts, "pairs", as_tree(list));
    table_put(facts, ".pairs", as_text(any ? "some" : "none"));
}

/* Where counting failed cases the other way moves an estimate. */
static void add_moved(const struct sensitivity_study *study, const struct sensitivity_table *table,
                      json_t *facts)
{
    const enum sensitivity_measure measure = table->moved_measure;
    char name[128];
    table_put(facts, "policies_differ", as_truth(table->moved));
    if (!table->moved)
        return;
    const double estimate = table->s.measure[measure][table->moved_factor].estimate;
    sensitivity_factor_text(study, table->moved_factor, name, sizeof name);
    say_add(facts, ".moved", "%s of %s would be %.4f, not ", sensitivity_words[measure], name,
            table->moved_to);
    say_add(facts, ".moved", isfinite(estimate) ? "%.4f" : "nothing", estimate);
}

/* What is told of a table before its factors. */
#define TABLE(X)                                                                                   \
    X("at", "{path: value}", as_tree(table_at(study->r, study->kept, table->point)))               \
    X("cases", "", as_whole(table->cases))                                                         \
    X("failed", "", as_whole(table->failed))                                                       \
    X("pending", "", as_whole(table->pending))                                                     \
    X("blocks", "", as_whole(study->blocks))                                                       \
    X("used", "", as_whole(s->blocks))                                                             \
    X("incomplete", "", as_whole(table->waiting))

static json_t *table_facts_of(const struct sensitivity_study *study, size_t k)
{
    const struct sensitivity_table *const table = &study->table[k];
    const struct sensitivity *const s = &table->s;
    const bool morris = is_morris(study), shown = s->blocks > 1 && s->deviation > 0;
    const size_t all = study->blocks * (morris ? study->factors : 1),
                 /* with fewer a mean is not yet normal: measured, see tests/test_sensitivity.c */
        least = is_sobol(study) ? 128
                : morris        ? 10
                                : 512;
    struct table factors = {0};
    char at[400];
    sensitivity_table_text(study, k, at, sizeof at);
    json_t *const facts = TABLE_OBJECT(
        TABLE(TABLE_MEMBER){morris ? "lost_effects" : "lost", as_whole(table->lost)},
        {"mean", as_number(s->mean)}, {"deviation", as_number(s->deviation)}, {".at", as_text(at)},
        {".used", as_text(block_word(study, s->blocks))}, {".lost", as_whole(table->lost)},
        {".what", as_text(morris ? "effects" : block_word(study, table->lost))},
        {".varies", as_truth(isfinite(s->deviation))},
        {".unfair", as_truth(10 * table->lost > all)}, {".same", as_truth(s->deviation == 0)},
        {".least", s->blocks < least ? as_whole(least) : as_nothing(NULL)});
    add_factors(&factors, study, table, TABLE_AS_JSON);
    table_give(facts, "factors", &factors, shown ? "label first/ total/ mu/ mu_star/ sigma/" : NULL,
               0);
    add_moved(study, table, facts);
    if (s->measure[SENSITIVITY_FIRST]) {
        json_t *const sum = value_facts(&s->first_sum);
        TABLE_PUT(sum, {".known", as_truth(!isnan(s->first_sum.estimate))},
                  {".bounded", as_truth(!isnan(s->first_sum.low))});
        if (s->first_sum.estimate < 1)
            say_add(sum, ".rest", "%.4f", 1 - s->first_sum.estimate);
        table_put(facts, "first_sum", as_tree(sum));
    }
    if (s->second)
        add_pairs(study, table, facts);
    return facts;
}

/* What is told of all of them, of study_facts. */
#define STUDY(X)                                                                                   \
    X("file", "", as_text(r->file))                                                                \
    X("title", "", as_text(r->title))                                                              \
    X("method", "", as_text(doe_words[study->design->method]))                                     \
    X("count", "", as_whole(study->design->count))                                                 \
    X("block", "points in one", as_whole(study->block))                                            \
    X("response", "", as_text(text))                                                               \
    X("answer", "", as_text(request->answer))                                                      \
    X("of", "",                                                                                    \
      as_text(request->of == RESULTS_KIND_COUNT ? NULL : results_kind_names[request->of]))         \
    X("unit", "", as_text(request->unit))                                                          \
    X("over", "grid axes that the response is a mean over", as_tree(over))                         \
    X("failed_cases", "drop or fallen", as_text(policy_word(study)))                               \
    X("level", "", as_number(request->bootstrap.level))                                            \
    X("resamples", "", drawn ? as_whole(request->bootstrap.resamples) : as_nothing(NULL))          \
    X("seed", "these two are null for saltelli, morris",                                           \
      drawn ? as_whole(request->bootstrap.seed) : as_nothing(NULL))

static const struct say_key table_keys[] = {
    TABLE(TABLE_KEY){"lost", "morris: lost_effects", NULL},
    {"mean", "", NULL},
    {"deviation", "", NULL},
    {"policies_differ", "", NULL},
    {"factors", "[{path, paths, first, total | mu, mu_star, sigma}], most important first", NULL},
    {"first_sum", "", NULL},
    {"pairs", "[{paths, estimate, low, high}]", NULL},
    {0},
};
const struct say_key sensitivity_keys[] = {
    STUDY(TABLE_KEY){"tables", "a measure is {estimate, low, high}, null where it cannot be had",
                     table_keys},
    {0},
};

static json_t *study_facts(const struct sensitivity_study *study)
{
    const struct sensitivity_request *const request = &study->request;
    const struct results *const r = study->r;
    const bool drawn = !is_sobol(study) && !is_morris(study); /* intervals of these draw nothing */
    json_t *const tables = json_array(), *const over = json_array();
    char text[200];
    uint64_t cases = 1;
    for (size_t k = 0; k < study->tables; k++)
        json_array_append_new(tables, table_facts_of(study, k));
    for (int a = 0; a < r->sample; a++) {
        if (!study->kept[a]) {
            table_append(over, as_text(r->axis[a].name));
            cases *= r->axis[a].count;
        }
    }
    sensitivity_response_text(study, text, sizeof text);
    return TABLE_OBJECT(
        STUDY(TABLE_MEMBER){".name", as_text(r->title[0] ? r->title : r->name)},
        {".factors_count", as_whole(study->factors)}, {".blocks", as_text(block_word(study, 0))},
        {".cases", as_whole(cases)}, {".failed", as_whole(study->failed)},
        {".total", as_whole(r->cases)},
        {".replicates", is_sobol(study) ? as_whole(DOE_REPLICATES) : as_nothing(NULL)},
        {".conservative", as_truth(study->design->method == DOE_SOBOL)},
        {"tables", as_tree(tables)});
}

static const char text[] =
    "{.name}\n{method}, {.factors_count} factors: {count} {.blocks}[block>1: of {block} points]\n"
    "response of a point: {response}[unit: ({unit})][over:, over [over* and :{value}]]"
    "[.cases>1:: {.cases} cases]\n"
    "failed cases: [.failed:{.failed} of {.total}, [failed_cases=fallen:counted as fallen|left "
    "out; "
    "a point without another case takes its block or effects along]|none]\n"
    "intervals: {level*%g} %, [resamples:from {resamples} quarters of the points"
    "[.conservative:, conservative]|Student's, from [.replicates:{.replicates} independently "
    "scrambled sequences|groups of trajectories]]\n"
    "[tables*:\n[.at:{.at}\n]  {used} {.used}[incomplete:, {incomplete} not complete yet]"
    "[.lost:, {.lost} {.what} lost for want of a case]"
    "[.varies:; response {mean%.4g} on the mean, standard deviation {deviation%.4g}"
    "[unit: {unit}]]\n"
    "[.unfair:  WARNING: what is left after so many losses is no fair sample of the ranges\n]"
    "[.same:  the response is the same at all points: it depends on none of the factors\n"
    "|[used<2:  too few to say anything\n]]"
    "[.factors:{.factors}"
    "[first_sum:[.known:  sum of first-order indices {estimate%.4f}"
    "[.bounded: ({low%.4f} ... {high%.4f})]"
    "[.rest:; interactions of factors account for the rest, {.rest}]\n]]"
    "[.pairs=some:  second-order indices above zero\n"
    "[pairs*:[.above:    {.one} with {.other} {estimate%.4f} ({low%.4f} ... {high%.4f})\n]]]"
    "[.pairs=none:  no second-order index is certainly above zero\n]"
    "[.least:  intervals from fewer than {.least} {.blocks} may be too narrow\n]]"
    "[.moved:  WARNING: failed cases [failed_cases=fallen:left out (--failed drop)|counted as "
    "fallen (--failed fallen)], {.moved}: find out why cases fail\n]]";

bool sensitivity_print(const struct sensitivity_study *study, enum table_form form)
{
    struct table csv = {0};
    for (size_t k = 0; form == TABLE_AS_CSV && k < study->tables; k++)
        add_factors(&csv, study, &study->table[k], form);
    return table_say(form, form == TABLE_AS_CSV ? NULL : study_facts(study), text, &csv);
}
