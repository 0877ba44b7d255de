/* sensitivity_print.c - the sensitivity of a study as text, JSON and comma-separated values. */
#include "sensitivity_study.h"

#include "analysis/table/csv.h"
#include "analysis/table/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { INTERVAL = 24 }; /* columns of an interval */

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
static const char *block_word(const struct sensitivity_study *study)
{
    return is_sobol(study) ? "block" : is_morris(study) ? "trajectory" : "point";
}

static const char *blocks_word(const struct sensitivity_study *study)
{
    return is_sobol(study) ? "blocks" : is_morris(study) ? "trajectories" : "points";
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
    printf("%llu %s", (unsigned long long)d->count, blocks_word(study));
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
        printf(": %llu cases", (unsigned long long)over);
    for (size_t t = 0; t < study->response.tables; t++)
        failed += study->response.table[t].failed;
    printf("\nfailed cases: ");
    if (failed == 0) {
        puts("none");
    } else {
        printf("%llu of %llu, %s\n", (unsigned long long)failed, (unsigned long long)r->cases,
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

/* Indices are shares, with as many decimals as matter; effects have a unit. */
static void print_value(const struct sensitivity_value *v, bool share)
{
    char interval[64] = "";
    if (isnan(v->estimate)) {
        printf(" %10s %*s", "-", INTERVAL, "");
        return;
    }
    if (!isnan(v->low)) {
        snprintf(interval, sizeof interval, share ? "(%.4f ... %.4f)" : "(%.4g ... %.4g)", v->low,
                 v->high);
    }
    printf(share ? " %10.4f %*s" : " %10.4g %*s", v->estimate, INTERVAL, interval);
}

static void print_factors(const struct sensitivity_study *study,
                          const struct sensitivity_table *table)
{
    char name[128];
    int width = 6;
    for (size_t j = 0; j < study->factors; j++) {
        sensitivity_factor_text(study, j, name, sizeof name);
        width = (int)strlen(name) > width ? (int)strlen(name) : width;
    }
    printf("  %-*s", width, "factor");
    for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++)
        if (table->s.measure[m])
            printf(" %10s %*s", sensitivity_words[m], INTERVAL, "interval");
    putchar('\n');
    for (size_t i = 0; i < study->factors; i++) {
        sensitivity_factor_text(study, study->order[i], name, sizeof name);
        printf("  %-*s", width, name);
        for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++)
            if (table->s.measure[m])
                print_value(&table->s.measure[m][study->order[i]], !is_morris(study));
        putchar('\n');
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
    printf("  %zu %s", s->blocks, s->blocks == 1 ? block_word(study) : blocks_word(study));
    if (table->waiting > 0)
        printf(", %zu not complete yet", table->waiting);
    if (table->lost > 0) {
        printf(", %zu %s lost for want of a case", table->lost,
               is_morris(study)   ? "effects"
               : table->lost == 1 ? block_word(study)
                                  : blocks_word(study));
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

/* With fewer than these a mean is not yet normal: measured, see tests/test_sensitivity.c. */
static void print_caution(const struct sensitivity_study *study, size_t blocks)
{
    const size_t least = is_sobol(study) ? 128 : is_morris(study) ? 10 : 512;
    if (blocks > 1 && blocks < least)
        printf("  intervals from fewer than %zu %s may be too narrow\n", least, blocks_word(study));
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

void sensitivity_print_text(const struct sensitivity_study *study)
{
    char at[400];
    print_head(study);
    for (size_t t = 0; t < study->response.tables; t++) {
        const struct sensitivity_table *table = &study->table[t];
        sensitivity_table_text(study, t, at, sizeof at);
        printf("\n%s%s", at, at[0] ? "\n" : "");
        print_counts(study, table);
        if (table->s.blocks > 1 && table->s.deviation > 0) {
            print_factors(study, table);
            if (table->s.measure[SENSITIVITY_FIRST])
                print_sum(table);
            if (table->s.second)
                print_pairs(study, table);
            print_caution(study, table->s.blocks);
        }
        print_policies(study, table);
    }
}

/* ---- JSON --------------------------------------------------------------------------------- */

static json_t *value_json(const struct sensitivity_value *v)
{
    return json_pack("{s:o, s:o, s:o}", "estimate", results_json_number(v->estimate), "low",
                     results_json_number(v->low), "high", results_json_number(v->high));
}

static json_t *at_json(const struct sensitivity_study *study, const struct sensitivity_table *table)
{
    json_t *at = json_object();
    for (int a = 0; a < study->r->axes; a++) {
        if (study->response.kept[a]) {
            const struct results_axis *axis = &study->r->axis[a];
            const size_t i = table->response->point[a];
            json_object_set_new(at, axis->name, results_json_value(axis, i));
        }
    }
    return at;
}

static json_t *paths_json(const struct sensitivity_study *study, size_t factor)
{
    json_t *paths = json_array();
    const char *path;
    for (int k = 0; (path = sensitivity_factor_path(study, factor, k)); k++)
        json_array_append_new(paths, json_string(path));
    return paths;
}

static json_t *factors_json(const struct sensitivity_study *study,
                            const struct sensitivity_table *table)
{
    json_t *list = json_array();
    for (size_t i = 0; i < study->factors; i++) {
        const size_t j = study->order[i];
        json_t *entry = json_pack("{s:s, s:o}", "path", sensitivity_factor_path(study, j, 0),
                                  "paths", paths_json(study, j));
        for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++) {
            if (table->s.measure[m]) {
                json_object_set_new(entry, sensitivity_words[m],
                                    value_json(&table->s.measure[m][j]));
            }
        }
        json_array_append_new(list, entry);
    }
    return list;
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
                                json_pack("[s, s]", sensitivity_factor_path(study, i, 0),
                                          sensitivity_factor_path(study, j, 0)));
            json_array_append_new(list, entry);
        }
    }
    return list;
}

static json_t *table_json(const struct sensitivity_study *study,
                          const struct sensitivity_table *table)
{
    const struct response_table *response = table->response;
    json_t *object = json_pack(
        "{s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o, s:b}", "at", at_json(study, table),
        "cases", (json_int_t)response->cases, "failed", (json_int_t)response->failed, "pending",
        (json_int_t)response->pending, "blocks", (json_int_t)table->blocks, "used",
        (json_int_t)table->s.blocks, "incomplete", (json_int_t)table->waiting,
        is_morris(study) ? "lost_effects" : "lost", (json_int_t)table->lost, "mean",
        results_json_number(table->s.mean), "deviation", results_json_number(table->s.deviation),
        "factors", factors_json(study, table), "policies_differ", table->moved);
    if (table->s.measure[SENSITIVITY_FIRST])
        json_object_set_new(object, "first_sum", value_json(&table->s.first_sum));
    if (table->s.second)
        json_object_set_new(object, "pairs", pairs_json(study, table));
    return object;
}

/* Intervals of saltelli and morris draw nothing. */
static json_t *drawn_json(const struct sensitivity_study *study, uint64_t number)
{
    return is_sobol(study) || is_morris(study) ? json_null() : json_integer((json_int_t)number);
}

bool sensitivity_print_json(const struct sensitivity_study *study)
{
    const struct sensitivity_request *request = &study->request;
    json_t *tables = json_array(), *over = json_array();
    char text[200];
    for (size_t t = 0; t < study->response.tables; t++)
        json_array_append_new(tables, table_json(study, &study->table[t]));
    for (int a = 0; a < study->r->sample; a++)
        if (!study->response.kept[a])
            json_array_append_new(over, json_string(study->r->axis[a].name));
    sensitivity_response_text(study, text, sizeof text);
    json_t *root = json_pack(
        "{s:o, s:s, s:s, s:I, s:I, s:s, s:s?, s:s?, s:s, s:o, s:s, s:f, s:o, s:o, s:o}", "file",
        json_string(study->r->file) ? json_string(study->r->file) : json_null(), "title",
        study->r->title, "method", doe_words[study->design->method], "count",
        (json_int_t)study->design->count, "block", (json_int_t)study->block, "response", text,
        "answer", request->answer, "of",
        request->of == RESULTS_KIND_COUNT ? NULL : results_kind_names[request->of], "unit",
        request->unit, "over", over, "failed_cases", policy_word(study), "level",
        request->bootstrap.level, "resamples", drawn_json(study, request->bootstrap.resamples),
        "seed", drawn_json(study, request->bootstrap.seed), "tables", tables);
    bool good = root && json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(root);
    putchar('\n');
    return good;
}

/* ---- comma-separated values --------------------------------------------------------------- */

void sensitivity_print_csv(const struct sensitivity_study *study)
{
    struct csv csv = {.file = stdout};
    const struct results *r = study->r;
    char text[200];

    for (int a = 0; a < r->axes; a++)
        if (study->response.kept[a])
            csv_text(&csv, r->axis[a].name);
    csv_text(&csv, "factor");
    for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++) {
        static const char *const ends[] = {"", "_low", "_high"};
        for (int e = 0; study->table[0].s.measure[m] && e < 3; e++) {
            snprintf(text, sizeof text, "%s%s", sensitivity_words[m], ends[e]);
            csv_text(&csv, text);
        }
    }
    csv_row(&csv, (const char *const[]){"response", "failed_cases", "blocks", "mean", "deviation"},
            5);
    sensitivity_response_text(study, text, sizeof text);
    for (size_t t = 0; t < study->response.tables; t++) {
        const struct sensitivity_table *table = &study->table[t];
        for (size_t i = 0; i < study->factors; i++) {
            const size_t j = study->order[i];
            for (int a = 0; a < r->axes; a++) {
                const size_t at = table->response->point[a];
                if (study->response.kept[a] && r->axis[a].word)
                    csv_text(&csv, r->axis[a].word[at]);
                else if (study->response.kept[a])
                    csv_number(&csv, r->axis[a].value[at]);
            }
            csv_text(&csv, sensitivity_factor_path(study, j, 0));
            for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++) {
                const struct sensitivity_value *v = table->s.measure[m];
                if (v) {
                    csv_number(&csv, v[j].estimate);
                    csv_number(&csv, v[j].low);
                    csv_number(&csv, v[j].high);
                }
            }
            csv_text(&csv, text);
            csv_text(&csv, policy_word(study));
            csv_number(&csv, (double)table->s.blocks);
            csv_number(&csv, table->s.mean);
            csv_number(&csv, table->s.deviation);
            csv_end_row(&csv);
        }
    }
}
