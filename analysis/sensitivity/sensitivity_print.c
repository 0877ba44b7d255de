/* sensitivity_print.c - the sensitivity of a study as text, JSON and comma-separated values. */
#include "sensitivity_study.h"

#include <inttypes.h>
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
        if (study->response.kept[a])
            kept[count++] = a;
    sensitivity_response_text(study, response, sizeof response);
    for (size_t i = 0; i < study->factors; i++) {
        const size_t j = study->order[i];
        if (form == TABLE_AS_CSV)
            table_axes(t, study->r, kept, count, table->response->point);
        sensitivity_factor_text(study, j, name, sizeof name);
        json_t *paths = json_array();
        const char *path;
        for (int k = 0; (path = sensitivity_factor_path(study, j, k)); k++)
            table_append(paths, as_text(path));
        TABLE_FACTS(t, {{"factor", .key = "path"}, as_text(sensitivity_factor_path(study, j, 0))},
                    {{"label", "factor", .hidden = TABLE_VIEW_ONLY, .left = true}, as_text(name)},
                    {{"paths", .hidden = TABLE_NO_CSV}, as_tree(paths)});
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

/* ---- text --------------------------------------------------------------------------------- */

static void print_head(const struct sensitivity_study *study)
{
    const struct results *r = study->r;
    const struct doe *d = study->design;
    char text[200];
    uint64_t failed = 0, over = 1;

    printf("%s\n%s, %zu factors: ", r->title[0] ? r->title : r->name, doe_words[d->method],
           study->factors);
    printf("%" PRIu64 " %s", (uint64_t)d->count, block_word(study, 0));
    if (study->block > 1)
        printf(" of %zu points", study->block);
    sensitivity_response_text(study, text, sizeof text);
    printf("\nresponse of a point: %s", text);
    if (study->request.unit[0])
        printf(" (%s)", study->request.unit);
    const char *separator = ", over ";
    for (int a = 0; a < r->sample; a++) {
        if (!study->response.kept[a]) {
            printf("%s%s", separator, r->axis[a].name);
            over *= r->axis[a].count;
            separator = " and ";
        }
    }
    if (over > 1)
        printf(": %" PRIu64 " cases", over);
    for (size_t t = 0; t < study->response.tables; t++)
        failed += study->response.table[t].failed;
    printf("\nfailed cases: ");
    if (failed == 0) {
        puts("none");
    } else {
        printf("%" PRIu64 " of %" PRIu64 ", %s\n", failed, r->cases,
               study->request.fallen ? "counted as fallen"
                                     : "left out; a point without another case takes its "
                                       "block or effects along");
    }
    printf("intervals: %g %%, ", 100 * study->request.bootstrap.level);
    if (is_sobol(study)) {
        printf("Student's, from %d independently scrambled sequences\n", DOE_REPLICATES);
    } else if (is_morris(study)) {
        printf("Student's, from groups of trajectories\n");
    } else {
        printf("from %zu quarters of the points%s\n", study->request.bootstrap.resamples,
               study->design->method == DOE_SOBOL ? ", conservative" : "");
    }
}

static void print_sum(const struct sensitivity_table *table)
{
    const struct sensitivity_value *sum = &table->s.first_sum;
    if (isnan(sum->estimate))
        return;
    printf("  sum of first-order indices %.4f", sum->estimate);
    if (!isnan(sum->low))
        printf(" (%.4f ... %.4f)", sum->low, sum->high);
    if (sum->estimate < 1)
        printf("; interactions of factors account for the rest, %.4f", 1 - sum->estimate);
    putchar('\n');
}

/* Pairs whose interval is above zero. */
static void print_pairs(const struct sensitivity_study *study,
                        const struct sensitivity_table *table)
{
    const size_t k = study->factors;
    char one[128], other[128];
    size_t shown = 0;
    for (size_t i = 0; i < k; i++) {
        for (size_t j = i + 1; j < k; j++) {
            const struct sensitivity_value *v = &table->s.second[i * k + j];
            if (v->low > 0) {
                sensitivity_factor_text(study, i, one, sizeof one);
                sensitivity_factor_text(study, j, other, sizeof other);
                printf("%s    %s with %s %.4f (%.4f ... %.4f)\n",
                       shown++ ? "" : "  second-order indices above zero\n", one, other,
                       v->estimate, v->low, v->high);
            }
        }
    }
    if (shown == 0)
        puts("  no second-order index is certainly above zero");
}

static void print_counts(const struct sensitivity_study *study,
                         const struct sensitivity_table *table)
{
    const struct sensitivity *s = &table->s;
    const char *unit = study->request.unit;
    printf("  %zu %s", s->blocks, block_word(study, s->blocks));
    if (table->waiting > 0)
        printf(", %zu not complete yet", table->waiting);
    if (table->lost > 0) {
        printf(", %zu %s lost for want of a case", table->lost,
               is_morris(study) ? "effects" : block_word(study, table->lost));
    }
    if (isfinite(s->deviation)) {
        printf("; response %.4g on the mean, standard deviation %.4g%s%s", s->mean, s->deviation,
               unit[0] ? " " : "", unit);
    }
    putchar('\n');
    const size_t all = table->blocks * (is_morris(study) ? study->factors : 1);
    if (10 * table->lost > all)
        printf("  WARNING: what is left after so many losses is no fair sample of the ranges\n");
    if (s->deviation == 0)
        puts("  the response is the same at all points: it depends on none of the factors");
    else if (s->blocks < 2)
        puts("  too few to say anything");
}

static void print_policies(const struct sensitivity_study *study,
                           const struct sensitivity_table *table)
{
    char name[128], now[32] = "nothing";
    if (table->moved) {
        const double estimate =
            table->s.measure[table->moved_measure][table->moved_factor].estimate;
        if (isfinite(estimate))
            snprintf(now, sizeof now, "%.4f", estimate);
        sensitivity_factor_text(study, table->moved_factor, name, sizeof name);
        printf("  WARNING: failed cases %s, %s of %s would be %.4f, not %s: find out why cases "
               "fail\n",
               study->request.fallen ? "left out (--failed drop)"
                                     : "counted as fallen (--failed fallen)",
               sensitivity_words[table->moved_measure], name, table->moved_to, now);
    }
}

static bool print_text(const struct sensitivity_study *study)
{
    char at[400];
    bool good = true;
    print_head(study);
    for (size_t k = 0; k < study->response.tables; k++) {
        const struct sensitivity_table *table = &study->table[k];
        sensitivity_table_text(study, k, at, sizeof at);
        printf("\n%s%s", at, at[0] ? "\n" : "");
        print_counts(study, table);
        if (table->s.blocks > 1 && table->s.deviation > 0) {
            struct table t = {0};
            add_factors(&t, study, table, TABLE_AS_TEXT);
            good = table_print(&t, TABLE_AS_TEXT, "label first/ total/ mu/ mu_star/ sigma/", 0) &&
                   good;
            if (table->s.measure[SENSITIVITY_FIRST])
                print_sum(table);
            if (table->s.second)
                print_pairs(study, table);
            /* with fewer a mean is not yet normal: measured, see tests/test_sensitivity.c */
            const size_t least = is_sobol(study) ? 128 : is_morris(study) ? 10 : 512;
            if (table->s.blocks < least)
                printf("  intervals from fewer than %zu %s may be too narrow\n", least,
                       block_word(study, 0));
        }
        print_policies(study, table);
    }
    return good;
}

/* ---- JSON --------------------------------------------------------------------------------- */

static json_t *value_json(const struct sensitivity_value *v)
{
    return TABLE_OBJECT({"estimate", as_number(v->estimate)}, {"low", as_number(v->low)},
                        {"high", as_number(v->high)});
}

static json_t *pairs_json(const struct sensitivity_study *study,
                          const struct sensitivity_table *table)
{
    const size_t k = study->factors;
    json_t *list = json_array();
    for (size_t i = 0; i < k; i++) {
        for (size_t j = i + 1; j < k; j++) {
            json_t *entry = value_json(&table->s.second[i * k + j]);
            json_object_set_new(entry, "paths",
                                table_texts(sensitivity_factor_path(study, i, 0),
                                            sensitivity_factor_path(study, j, 0)));
            json_array_append_new(list, entry);
        }
    }
    return list;
}

static json_t *table_of(const struct sensitivity_study *study,
                        const struct sensitivity_table *table)
{
    const struct response_table *response = table->response;
    struct table factors = {0};
    add_factors(&factors, study, table, TABLE_AS_JSON);
    json_t *object = TABLE_OBJECT(
        {"at", as_tree(table_at(study->r, study->response.kept, response->point))},
        {"cases", as_whole(response->cases)}, {"failed", as_whole(response->failed)},
        {"pending", as_whole(response->pending)}, {"blocks", as_whole(table->blocks)},
        {"used", as_whole(table->s.blocks)}, {"incomplete", as_whole(table->waiting)},
        {is_morris(study) ? "lost_effects" : "lost", as_whole(table->lost)},
        {"mean", as_number(table->s.mean)}, {"deviation", as_number(table->s.deviation)},
        {"factors", as_tree(table_tree(&factors, false))},
        {"policies_differ", as_truth(table->moved)});
    if (table->s.measure[SENSITIVITY_FIRST])
        json_object_set_new(object, "first_sum", value_json(&table->s.first_sum));
    if (table->s.second)
        json_object_set_new(object, "pairs", pairs_json(study, table));
    return object;
}

static bool print_json(const struct sensitivity_study *study)
{
    const struct sensitivity_request *request = &study->request;
    const bool drawn = !is_sobol(study) && !is_morris(study); /* intervals of these draw nothing */
    json_t *tables = json_array(), *over = json_array();
    char text[200];
    for (size_t k = 0; k < study->response.tables; k++)
        json_array_append_new(tables, table_of(study, &study->table[k]));
    for (int a = 0; a < study->r->sample; a++)
        if (!study->response.kept[a])
            table_append(over, as_text(study->r->axis[a].name));
    sensitivity_response_text(study, text, sizeof text);
    return table_write_json(
        TABLE_OBJECT(
            {"file", as_text(study->r->file)}, {"title", as_text(study->r->title)},
            {"method", as_text(doe_words[study->design->method])},
            {"count", as_whole(study->design->count)}, {"block", as_whole(study->block)},
            {"response", as_text(text)}, {"answer", as_text(request->answer)},
            {"of",
             as_text(request->of == RESULTS_KIND_COUNT ? NULL : results_kind_names[request->of])},
            {"unit", as_text(request->unit)}, {"over", as_tree(over)},
            {"failed_cases", as_text(policy_word(study))},
            {"level", as_number(request->bootstrap.level)},
            {"resamples", drawn ? as_whole(request->bootstrap.resamples) : as_nothing(NULL)},
            {"seed", drawn ? as_whole(request->bootstrap.seed) : as_nothing(NULL)},
            {"tables", as_tree(tables)}),
        stdout);
}

/* ---- all forms ---------------------------------------------------------------------------- */

bool sensitivity_print(const struct sensitivity_study *study, enum table_form form)
{
    struct table t = {0};
    if (form != TABLE_AS_CSV)
        return (form == TABLE_AS_TEXT ? print_text : print_json)(study);
    for (size_t k = 0; k < study->response.tables; k++)
        add_factors(&t, study, &study->table[k], form);
    return table_print(&t, form, NULL, 0);
}
