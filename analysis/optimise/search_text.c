/* search_text.c - a search for people. */
#include "search_summary.h"

#include "runner/base/units.h"
#include "runner/plan/allowed.h"
#include "runner/scenario/schema.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- what was sought ---------------------------------------------------------------------- */

static void print_head(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    char time[32];
    text_of_seconds(time, sizeof time, f->seconds);
    printf("%s\n%s: a search, %zu candidates in %zu generations, %s; revision %s, %s\n",
           f->title[0] ? f->title : study->name, study->file, f->length[SEARCH_CANDIDATE],
           f->length[SEARCH_GENERATION], time, f->revision, f->date);
}

/* "[0][3]" of a path is left out: what is varied together is told together. */
static size_t family(const char *path)
{
    return strcspn(path, "[");
}

static const struct scenario_varied *varied_of(const struct search_study *study, const char *path)
{
    const struct scenario *const s = study->first;
    for (int k = 0; s && k < s->search.axis.paths; k++)
        if (strcmp(s->search.axis.path[k], path) == 0)
            return &s->search.varied[k];
    return NULL;
}

static void print_range(const struct search_study *study, const char *path)
{
    const struct scenario_varied *const v = varied_of(study, path);
    if (!v || !v->bounded)
        return;
    struct results_axis axis = {.unit = ""};
    snprintf(axis.name, sizeof axis.name, "%s", path);
    search_describe(study, &axis);
    printf("  %g ... %g%s%s%s", v->low, v->high, axis.unit[0] ? " " : "", axis.unit,
           v->scale == SCALE_EVEN ? "" : ", by ratios");
}

static void print_varied(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const size_t n = f->length[SEARCH_PARAMETER];
    printf("\nVaried: %zu number%s\n", n, n == 1 ? "" : "s");
    for (size_t k = 0, next; k < n; k = next) {
        const size_t length = family(f->parameter[k]);
        for (next = k + 1; next < n && family(f->parameter[next]) == length &&
                           strncmp(f->parameter[next], f->parameter[k], length) == 0;)
            next++;
        if (next > k + 1)
            printf("  %.*s  %zu of them", (int)length, f->parameter[k], next - k);
        else
            printf("  %s", f->parameter[k]);
        print_range(study, f->parameter[k]);
        putchar('\n');
    }
}

/* "initial.offset.theta, q1, q2": what a path has in common with the one before is said once. */
static void print_starts(const struct search_file *f)
{
    fputs("Starts over ", stdout);
    for (size_t k = 0; k < f->length[SEARCH_VARIED]; k++) {
        const char *const path = f->varied[k], *const name = schema_last_name(path);
        const size_t length = (size_t)(name - path);
        const bool same =
            k > 0 && schema_last_name(f->varied[k - 1]) - f->varied[k - 1] == (ptrdiff_t)length &&
            strncmp(f->varied[k - 1], path, length) == 0;
        printf("%s%s", k ? ", " : "", same ? name : path);
    }
    putchar('\n');
}

static void print_aim(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    char aim[600];
    search_aim(study, aim, sizeof aim);
    printf("Maximised: %s\n", aim);
    if (study->first && study->first->search.given) {
        const double critical = study->first->search.critical;
        double least, longest;
        scenario_extent(study->first, offsetof(struct scenario_values, sample_time), &least,
                        &longest);
        if (longest == 0)
            ; /* nothing is sampled */
        else if (isnan(critical))
            puts("Required: a critical sample time of two sample times");
        else if (critical > 0)
            printf("Required: a critical sample time of %g s\n", critical);
    }
    print_starts(f);
}

/* ---- how it went -------------------------------------------------------------------------- */

/* One of the tables. */
static bool print_table(const struct search_study *study,
                        void (*make)(struct table *, const struct search_study *), const char *view)
{
    struct table t = {0};
    make(&t, study);
    const bool good = table_write_text(&t, stdout, view, 0);
    table_free(&t);
    return good;
}

static bool print_stages(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    puts("\nSearch");
    const bool good =
        print_table(study, search_table_stages,
                    f->restart[f->length[SEARCH_GENERATION] - 1] > 0
                        ? "beginning stage starts generations candidates best best_candidate step"
                        : "stage starts generations candidates best best_candidate step");
    if (f->finished)
        printf("  ended: %s\n", f->note);
    return good;
}

static void print_unfinished(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const int64_t best = search_best(study);
    const int64_t starts = f->starts[f->length[SEARCH_GENERATION] - 1];
    printf("\nNot finished: %zu of at most %" PRId64 " generations; best so far candidate %" PRId64
           ", ",
           f->length[SEARCH_GENERATION], f->most_generations, best);
    if (study->plain)
        printf("%.2f %%", 100 * f->objective[best]);
    else
        printf("%.6g", f->objective[best]);
    printf(" of the %" PRId64 " starts by which it was\n"
           "chosen (fewer of fresh ones). stance optimise SCENARIO --resume goes on\n",
           starts);
}

/* ---- what came out ------------------------------------------------------------------------ */

/* The limit is that of a posture, which may be varied, too. */
static void print_limit(const struct search_study *study)
{
    const size_t chosen = (size_t)study->f.chosen;
    const char *where, *first_where;
    const double allowed = search_limit(study, chosen, &where),
                 before = search_limit(study, 0, &first_where),
                 first = search_share(study, 0, SEARCH_OVERALL);
    if (!(allowed > 0))
        return;
    printf("  %.2f %% is what linear theory allows any controller %s%s: chosen %.1f %% of that",
           100 * allowed, where ? "in its worst circumstance,\n  " : "there", where ? where : "",
           100 * search_share(study, chosen, SEARCH_OVERALL) / allowed);
    if (before == allowed)
        printf(", first %.1f %%", 100 * first / before);
    else if (before > 0)
        printf(";\n  at the first one's posture it is %.2f %%, of which it has %.1f %%",
               100 * before, 100 * first / before);
    putchar('\n');
    if (study->glued)
        puts("  (" ALLOWED_GLUED ")");
}

static void print_counts(const struct search_study *study)
{
    const char *separator = "  of the chosen one's starts ";
    for (int label = 0; label < TRIAL_LABELS; label++) {
        const int64_t count = search_count(study, (size_t)study->f.chosen, label);
        if (count == 0 && label != STANCE_UNDECIDED + 1 && label != STANCE_RESTED + 1 &&
            label != TRIAL_FAILED)
            continue;
        printf("%s%" PRId64 " %s", separator, count,
               label == STANCE_STABILISED + 1 ? "recovered" : study->f.kind[label]);
        separator = ", ";
    }
    putchar('\n');
}

static bool print_confirmed(const struct search_study *study)
{
    printf("\nFrom %zu fresh starts, with 95 %% intervals\n", study->f.length[SEARCH_START]);
    const bool apart = search_chosen_apart(study);
    char view[90];
    snprintf(view, sizeof view, "mark which candidate share low high%s training gap%s",
             study->plain ? "" : " objective", apart ? " choice" : "");
    const bool good = print_table(study, search_table_confirmed, view);
    puts("  (training: objective of the starts by which the search went; gap: training - fresh;");
    puts(apart ? "  * chosen, for the largest choice: the objective of as many other starts)"
               : "  * chosen, by these very starts, as in files of earlier versions: too high)");
    const struct search_gain gain = search_gain(study, SEARCH_OVERALL);
    printf("  chosen - first%s: %+.2f points (%.2f ... %.2f), start by start: %" PRIu64
           " won, %" PRIu64 " lost\n",
           study->f.length[SEARCH_CIRCUMSTANCE] > 1 ? ", mean of the circumstances" : "",
           100 * gain.share, 100 * gain.interval.low, 100 * gain.interval.high, gain.won,
           gain.lost);
    print_limit(study);
    print_counts(study);
    return good;
}

static bool print_circumstances(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE];
    bool limited = false;
    if (circumstances == 1)
        return true;
    for (size_t c = 0; c < circumstances; c++)
        limited = limited || isfinite(f->confirmed_allowed[(size_t)f->chosen * circumstances + c]);
    puts("\nIn each circumstance");
    const bool good = print_table(
        study, search_table_circumstances,
        limited
            ? "circumstance first chosen chosen_low chosen_high gain gain_low gain_high allowed "
              "of_allowed critical_chosen"
            : "circumstance first chosen chosen_low chosen_high gain gain_low gain_high "
              "critical_chosen");
    if (limited)
        puts("  (allowed: from there linear theory allows any controller to recover)");
    return good;
}

/* ---- the chosen one ----------------------------------------------------------------------- */

/* Lines of a scenario. */
static void print_gains(const struct search_study *study)
{
    const stance_scene *const scene = study->best->scene;
    const int columns = 2 * scene->postures;
    puts("  controller:\n    design: gains\n    gains:");
    for (int i = 0; i < scene->actuators; i++) {
        for (int j = 0; j < columns; j++)
            printf("%s%.6g", j ? ", " : "      - [", study->best->base.gains[i * columns + j]);
        puts("]");
    }
}

static void print_loop(const struct search_study *study)
{
    const double critical =
        study->f.confirmed_critical[(size_t)study->f.chosen * study->f.length[SEARCH_CIRCUMSTANCE]];
    const double first = study->f.confirmed_critical[0];
    struct design_report *const loop = search_loop(study);
    if (loop) {
        fputs("  poles ", stdout);
        for (int i = 0; i < loop->states; i++) {
            printf("%s%.5g", i ? ", " : "", loop->closed_re[i]);
            if (loop->closed_im[i] != 0)
                printf("%+.5gi", loop->closed_im[i]);
        }
        puts(" 1/s");
        free(loop);
    }
    if (isinf(critical))
        fputs("  critical sample time: none up to 10 s", stdout);
    else if (!isnan(critical))
        printf("  critical sample time %.4g s", critical);
    if (isfinite(critical) && isfinite(first))
        printf(", of the first %.4g s", first);
    if (!isnan(critical))
        putchar('\n');
}

static void print_chosen(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const size_t n = f->length[SEARCH_PARAMETER];
    const bool gains = search_has_gains(study);
    char name[80];
    search_name(study, (size_t)f->chosen, name, sizeof name);
    printf("\nChosen: %s (with all digits in the -best.yaml beside the file)\n", name);
    if (gains)
        print_gains(study);
    for (size_t k = 0; k < n; k++)
        if (!gains || !search_is_gain(study, k))
            printf("  %s = %.6g\n", f->parameter[k], f->confirmed_value[(size_t)f->chosen * n + k]);
    print_loop(study);
}

bool search_print_text(const struct search_study *study)
{
    print_head(study);
    print_varied(study);
    print_aim(study);
    bool good = print_stages(study);
    if (!study->done) {
        print_unfinished(study);
        return good && !ferror(stdout);
    }
    good = print_confirmed(study) && good;
    good = print_circumstances(study) && good;
    if (study->f.length[SEARCH_ELSEWHERE] > 0) {
        puts("\nElsewhere, where nothing was sought");
        good = print_table(study, search_table_elsewhere, "where first chosen") && good;
    }
    print_chosen(study);
    return good && !ferror(stdout);
}
