/* search_summary.c - what the file of a search says, and several, as facts and a text. */
#include "search_study.h"

#include "runner/base/units.h"
#include "runner/plan/allowed.h"
#include "runner/plan/design.h"
#include "runner/scenario/schema.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- what was sought ---------------------------------------------------------------------- */

/* "[0][3]" of a path is left out: what is varied together is told together. */
static size_t family(const char *path)
{
    return strcspn(path, "[");
}

static void add_range(const struct search_study *study, const char *path, json_t *facts)
{
    const struct scenario *const s = study->first;
    struct results_axis axis = {.unit = ""};
    for (int k = 0; s && k < s->search.axis.paths; k++) {
        const struct scenario_varied *const v = &s->search.varied[k];
        if (strcmp(s->search.axis.path[k], path) != 0 || !v->bounded)
            continue;
        snprintf(axis.name, sizeof axis.name, "%s", path);
        search_describe(study, &axis);
        say_add(facts, "range", "  %g ... %g%s%s%s", v->low, v->high, axis.unit[0] ? " " : "",
                axis.unit, v->scale == SCALE_EVEN ? "" : ", by ratios");
    }
}

static json_t *families(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const size_t n = f->length[SEARCH_PARAMETER];
    json_t *const list = json_array();
    for (size_t k = 0, next; k < n; k = next) {
        const size_t length = family(f->parameter[k]);
        char name[128];
        for (next = k + 1; next < n && family(f->parameter[next]) == length &&
                           strncmp(f->parameter[next], f->parameter[k], length) == 0;)
            next++;
        snprintf(name, sizeof name, "%.*s", (int)length, f->parameter[k]);
        json_t *const facts =
            TABLE_OBJECT({"of", as_text(next > k + 1 ? name : f->parameter[k])},
                         {"more", as_whole(next - k - 1)}, {"many", as_whole(next - k)});
        add_range(study, f->parameter[k], facts);
        json_array_append_new(list, facts);
    }
    return list;
}

/* ---- what came out ------------------------------------------------------------------------ */

/* The limit is that of a posture, which may be varied, too: the first one has its own. */
static json_t *limit(const struct search_study *study)
{
    const size_t chosen = (size_t)study->f.chosen;
    const char *where;
    const double allowed = search_limit(study, chosen, &where),
                 before = search_limit(study, 0, NULL);
    if (!(allowed > 0))
        return NULL;
    return TABLE_OBJECT(
        {"allowed", as_number(allowed)}, {"where", as_text(where)},
        {"chosen", as_number(search_share(study, chosen, SEARCH_OVERALL).share / allowed)},
        {"first", as_number(search_share(study, 0, SEARCH_OVERALL).share / before)},
        {"before", as_number(before)}, {"differs", as_truth(before != allowed)});
}

static void add_counts(const struct search_study *study, json_t *facts)
{
    const struct search_file *const f = &study->f;
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE],
                 first = (size_t)f->chosen * circumstances;
    json_t *const counts = json_object();
    for (int label = 0; label < TRIAL_LABELS; label++) {
        int64_t count = 0;
        for (size_t c = 0; c < circumstances; c++)
            count += f->confirmed_count[(first + c) * TRIAL_LABELS + (size_t)label];
        table_put(counts, f->kind[label], as_whole((uint64_t)count));
        if (count > 0 || label == STANCE_UNDECIDED + 1 || label == STANCE_RESTED + 1 ||
            label == TRIAL_FAILED)
            say_add(facts, ".counts", "%s%lld %s", json_object_get(facts, ".counts") ? ", " : "",
                    (long long)count,
                    label == STANCE_STABILISED + 1 ? "recovered" : f->kind[label]);
    }
    table_put(facts, "starts", as_tree(counts));
}

/* ---- the chosen one ----------------------------------------------------------------------- */

/* The values of all parameters; for people those that are no entry of controller.gains. */
static void add_values(const struct search_study *study, json_t *facts)
{
    static const char entry[] = "controller.gains[";
    const struct search_file *const f = &study->f;
    const size_t n = f->length[SEARCH_PARAMETER];
    json_t *const values = json_object(), *const told = json_object(), *gains = NULL;
    for (size_t k = 0; k < n; k++) {
        const double value = f->confirmed_value[(size_t)f->chosen * n + k];
        const bool gain = study->best && strncmp(f->parameter[k], entry, strlen(entry)) == 0;
        table_put(values, f->parameter[k], as_number(value));
        if (!gain)
            table_put(told, f->parameter[k], as_number(value));
        else if (!gains)
            gains = json_array();
    }
    const int columns = gains ? 2 * study->best->scene->postures : 0;
    for (int i = 0; gains && i < study->best->scene->actuators; i++) {
        json_t *const row = json_array();
        for (int j = 0; j < columns; j++)
            table_append(row, as_number(study->best->base.gains[i * columns + j]));
        json_array_append_new(gains, row);
    }
    table_put(facts, "values", as_tree(values));
    table_put(facts, ".values", as_tree(told));
    table_put(facts, "gains", as_tree(gains));
}

/* Of the loop, where linear theory knows it. */
static void add_poles(const struct search_study *study, json_t *facts)
{
    stance_message ignored;
    struct design_report *const loop =
        study->best && scenario_law(&study->best->base)->designed ? malloc(sizeof *loop) : NULL;
    if (loop && design_loop(loop, study->best, NULL, &ignored))
        design_put_complex(facts, ".poles", loop->states, loop->closed_re, loop->closed_im);
    else
        table_put(facts, "poles", as_tree(NULL));
    free(loop);
}

static json_t *chosen(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const struct search_gain gain = search_gain(study, SEARCH_OVERALL);
    const double first = f->confirmed_critical[0],
                 critical =
                     f->confirmed_critical[(size_t)f->chosen * f->length[SEARCH_CIRCUMSTANCE]];
    char name[80];
    search_name(study, (size_t)f->chosen, name, sizeof name);
    json_t *const facts = TABLE_OBJECT({"which", as_text(name)});
    add_counts(study, facts);
    TABLE_PUT(facts, {"gain", as_number(gain.share)}, {"gain_low", as_number(gain.interval.low)},
              {"gain_high", as_number(gain.interval.high)}, {"won", as_whole(gain.won)},
              {"lost", as_whole(gain.lost)});
    add_values(study, facts);
    add_poles(study, facts);
    if (isinf(critical))
        say_add(facts, ".critical", ": none up to 10 s");
    else if (!isnan(critical))
        say_add(facts, ".critical", " %.4g s", critical);
    if (isfinite(critical) && isfinite(first))
        say_add(facts, ".critical", ", of the first %.4g s", first);
    return facts;
}

/* ---- tables ------------------------------------------------------------------------------- */

/* A share, of which people see per cent. */
#define SHARE(X, name, heading, wide, share)                                                       \
    X(name, "", as_number(share), heading, "%.2f", wide, .percent = true)
/* Its interval, which people see as one cell: "(22.3 ... 23.6)". */
#define INTERVAL(X, least, most, interval)                                                         \
    X(least, "", as_number((interval).low), "", "(%.2f", .before = " ", .left = true, .empty = "", \
      .percent = true)                                                                             \
    X(most, "", as_number((interval).high), .format = "%.2f)", .joined = true, .before = " ... ",  \
      .percent = true)

/* What the tables say of a row; names that are no members are of the functions behind. */
#define STAGE(X)                                                                                   \
    X("beginning", "", as_whole((uint64_t)f->restart[g] + 1), "beginning", .width = 9)             \
    X("stage", "", as_whole((uint64_t)f->stage[g] + 1), "stage", .width = 5)                       \
    X("starts", "", as_whole((uint64_t)f->starts[g]), "starts", .width = 8)                        \
    X("generations", "", as_whole(g + 1 - first), "generations", .width = 9)                       \
    X("candidates", "", as_whole((uint64_t)(f->candidates[g] - search_first(f, first))),           \
      "candidates", .width = 9)                                                                    \
    X("best", "", as_number(f->objective[f->best[g]]), "best",                                     \
      .format = study->plain ? "%.2f %%" : NULL, .width = 9, .percent = study->plain)              \
    X("best_candidate", "", as_whole((uint64_t)f->best[g]), "candidate", .width = 9)               \
    X("step", "", as_number(f->step[g]), "last step", "%.3g", .width = 9)
static const struct say_key stage_keys[] = {STAGE(TABLE_KEY){0}};

static void put_stages(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    size_t last[SEARCH_STAGES], first = 0;
    const size_t stages = search_stages(study, last);
    for (size_t i = 0; i < stages; i++) {
        const size_t g = last[i];
        TABLE_FACTS(t, STAGE(TABLE_FACT));
        table_end_row(t);
        first = g + 1;
    }
}

#define CONFIRMED(X)                                                                               \
    X("mark", NULL, as_text(chosen ? "*" : " "), "", .hidden = TABLE_VIEW_ONLY, .width = 1)        \
    X("which", "", as_text(name), "", .left = true)                                                \
    X("candidate", "null: a mean",                                                                 \
      f->confirmed_candidate[k] < 0 ? as_nothing(NULL)                                             \
                                    : as_whole((uint64_t)f->confirmed_candidate[k]),               \
      "candidate", .width = 9)                                                                     \
    SHARE(X, "share", study->plain ? "share %" : "recovered %", 7, share.share)                    \
    INTERVAL(X, "low", "high", share.interval)                                                     \
    X("objective", "", as_number(f->confirmed_objective[k]), "objective", .width = 9)              \
    X("training", "", as_number(f->confirmed_training[k]), "training", format, .width = 8,         \
      .percent = study->plain)                                                                     \
    X("gap", "", as_number(f->confirmed_training[k] - f->confirmed_objective[k]), "gap",           \
      study->plain ? "%+.2f" : "%+.6g", .width = 6, .percent = study->plain)                       \
    X("choice", "", as_number(f->choice_objective[k]), "choice", format, .width = 7,               \
      .percent = study->plain)                                                                     \
    X("chosen", "", as_truth(chosen), .hidden = TABLE_NO_CSV)
static const struct say_key confirmed_keys[] = {CONFIRMED(TABLE_KEY){0}};

static void put_confirmed(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const char *const format = study->plain ? "%.2f" : NULL;
    char name[80];
    for (size_t k = 0; study->done && k < f->length[SEARCH_CONFIRMED]; k++) {
        const bool chosen = (int64_t)k == f->chosen;
        const struct search_share share = search_share(study, k, SEARCH_OVERALL);
        search_name(study, k, name, sizeof name);
        TABLE_FACTS(t, CONFIRMED(TABLE_FACT));
        table_end_row(t);
    }
}

#define CIRCUMSTANCE(X)                                                                            \
    X("circumstance", "", as_text(f->circumstance[c]), "", .left = true)                           \
    SHARE(X, "first", "first %", 7, search_share(study, 0, c).share)                               \
    SHARE(X, "chosen", "chosen %", 8, chosen.share)                                                \
    INTERVAL(X, "chosen_low", "chosen_high", chosen.interval)                                      \
    X("gain", "", as_number(gain.share), "gained", "%+.2f", .width = 7, .percent = true)           \
    INTERVAL(X, "gain_low", "gain_high", gain.interval)                                            \
    X("won", "", as_whole(gain.won), .heading = NULL)                                              \
    X("lost", "", as_whole(gain.lost), .heading = NULL)                                            \
    SHARE(X, "allowed", "allowed %", 9, allowed)                                                   \
    X("of_allowed", "", as_number(chosen.share / allowed), "of that", "%.1f", .width = 7,          \
      .percent = true)                                                                             \
    X("critical_first", "", as_number(f->confirmed_critical[c]), "T* first (s)", "%.4g",           \
      .width = 12)                                                                                 \
    X("critical_chosen", "", as_number(f->confirmed_critical[of_chosen + c]), "T* chosen (s)",     \
      "%.4g", .width = 13)
static const struct say_key circumstance_keys[] = {CIRCUMSTANCE(TABLE_KEY){0}};

static void put_circumstances(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE],
                 of_chosen = (size_t)f->chosen * circumstances;
    for (size_t c = 0; study->done && c < circumstances; c++) {
        const struct search_gain gain = search_gain(study, c);
        const struct search_share chosen = search_share(study, (size_t)f->chosen, c);
        const double allowed = f->confirmed_allowed[of_chosen + c];
        TABLE_FACTS(t, CIRCUMSTANCE(TABLE_FACT));
        table_end_row(t);
    }
}

#define ELSEWHERE(X)                                                                               \
    X("where", "", as_text(f->elsewhere[e]), "", .left = true)                                     \
    SHARE(X, "first", "first %", 8, f->elsewhere_first[e])                                         \
    SHARE(X, "chosen", "chosen %", 9, f->elsewhere_chosen[e])
static const struct say_key elsewhere_keys[] = {ELSEWHERE(TABLE_KEY){0}};

static void put_elsewhere(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    for (size_t e = 0; study->done && e < f->length[SEARCH_ELSEWHERE]; e++) {
        TABLE_FACTS(t, ELSEWHERE(TABLE_FACT));
        table_end_row(t);
    }
}

/* ---- all of it ---------------------------------------------------------------------------- */

#define HEAD(X)                                                                                    \
    X("file", "", as_text(study->file))                                                            \
    X("title", "", as_text(f->title))                                                              \
    X("revision", "", as_text(f->revision))                                                        \
    X("date", "", as_text(f->date))                                                                \
    X("seconds", "", as_number(f->seconds))                                                        \
    X("finished", "", as_truth(f->finished))                                                       \
    X("note", "why it ended", as_text(f->finished ? f->note : NULL))                               \
    X("generations", "", as_whole(last + 1))                                                       \
    X("most_generations", "", as_whole((uint64_t)f->most_generations))                             \
    X("candidates", "", as_whole(f->length[SEARCH_CANDIDATE]))                                     \
    X("best", "", as_whole((uint64_t)best))                                                        \
    X("best_objective", "of the last stage, of the starts of the search",                          \
      as_number(f->objective[best]))                                                               \
    X("maximised", "", as_text(aim))                                                               \
    X("varied", "paths",                                                                           \
      as_tree(table_list((const char *const *)f->parameter, f->length[SEARCH_PARAMETER])))         \
    X("starts_over", "paths",                                                                      \
      as_tree(table_list((const char *const *)f->varied, f->length[SEARCH_VARIED])))
#define LIMIT(X)                                                                                   \
    X("linear_limit",                                                                              \
      "share of the fresh starts from which linear theory allows any controller to recover, "      \
      "counted like share",                                                                        \
      as_number(allowed))                                                                          \
    X("linear_limit_in", "the circumstance", as_text(where))                                       \
    X("linear_limit_glued",                                                                        \
      "several contacts carry, and the bound does not know where their centre of pressure may be", \
      as_truth(study->glued))

static const struct say_key own_keys[] = {
    HEAD(TABLE_KEY){"stages", "", stage_keys},
    {"fresh_starts", "how many", NULL},
    {"confirmed",
     "share: of fresh starts that are stabilised, in the worst circumstance or the mean of them, "
     "as the search counts; choice: the objective of as many other starts, by which one is chosen",
     confirmed_keys},
    LIMIT(TABLE_KEY){"circumstances",
                     "gain: chosen - first, start by start, of which so many were won and lost; "
                     "critical: sample time, s",
                     circumstance_keys},
    {"elsewhere", "", elsewhere_keys},
    {"chosen",
     "{which, starts: {what became of them: count}, gain, gain_low, gain_high, won, lost, values: "
     "{path: value}, gains: [[...]], poles: [[re, im]]}",
     NULL},
    {0}};

static bool give(json_t *facts, const char *key, const struct search_study *study,
                 void (*make)(struct table *, const struct search_study *), const char *view)
{
    struct table t = {0};
    make(&t, study);
    return table_give(facts, key, &t, view, 0);
}

static bool add_tables(const struct search_study *study, json_t *facts)
{
    const struct search_file *const f = &study->f;
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE];
    const bool apart = search_chosen_apart(study),
               begins = f->restart[f->length[SEARCH_GENERATION] - 1] > 0;
    const char *where = NULL;
    bool limited = false;
    char view[120];
    for (size_t c = 0; study->done && c < circumstances; c++)
        limited = limited || isfinite(f->confirmed_allowed[(size_t)f->chosen * circumstances + c]);
    snprintf(view, sizeof view, "%sstage starts generations candidates best best_candidate step",
             begins ? "beginning " : "");
    bool good = give(facts, "stages", study, put_stages, view);
    table_put(facts, "fresh_starts", as_whole(f->length[SEARCH_START]));
    snprintf(view, sizeof view, "mark which candidate share low high%s training gap%s",
             study->plain ? "" : " objective", apart ? " choice" : "");
    good = give(facts, "confirmed", study, put_confirmed, view) && good;
    const double allowed = study->done ? search_limit(study, (size_t)f->chosen, &where) : NAN;
    TABLE_PUT(facts, LIMIT(TABLE_MEMBER){".limit", as_tree(study->done ? limit(study) : NULL)},
              {".limited", as_truth(limited)}, {".apart", as_truth(apart)},
              {".several", as_truth(circumstances > 1)});
    snprintf(view, sizeof view,
             "circumstance first chosen chosen_low chosen_high gain gain_low gain_high%s "
             "critical_chosen",
             limited ? " allowed of_allowed" : "");
    return give(facts, "circumstances", study, put_circumstances, view) &&
           give(facts, "elsewhere", study, put_elsewhere, "where first chosen") && good;
}

static bool add_facts(const struct search_study *study, json_t *facts)
{
    const struct search_file *const f = &study->f;
    const size_t last = f->length[SEARCH_GENERATION] - 1;
    const int64_t best = f->best[last];
    char aim[600], time[32];
    search_aim(study, aim, sizeof aim);
    text_of_seconds(time, sizeof time, f->seconds);
    TABLE_PUT(facts, HEAD(TABLE_MEMBER){".name", as_text(f->title[0] ? f->title : study->name)},
              {".time", as_text(time)}, {".numbers", as_whole(f->length[SEARCH_PARAMETER])},
              {".varied", as_tree(families(study))},
              {".starts", as_whole((uint64_t)f->starts[last])}, {".done", as_truth(study->done)});
    say_add(facts, ".best", study->plain ? "%.2f %%" : "%.6g",
            (study->plain ? 100 : 1) * f->objective[best]);
    const struct scenario *const s = study->first;
    double least, longest = 0; /* sample times, of which a grid may have several */
    if (s && s->search.given)
        scenario_extent(s, offsetof(struct scenario_values, sample_time), &least, &longest);
    const bool samples = longest != 0;
    if (samples && isnan(s->search.critical))
        say_add(facts, ".required", "two sample times");
    else if (samples && s->search.critical > 0)
        say_add(facts, ".required", "%g s", s->search.critical);
    const bool good = add_tables(study, facts);
    table_put(facts, "chosen", as_tree(study->done ? chosen(study) : NULL));
    return good;
}

static const char text[] =
    "{.name}\n{file}: a search, {candidates} candidates in {generations} generations, {.time}; "
    "revision {revision}, {date}\n"
    "\nVaried: {.numbers} number{.numbers#s}\n"
    "[.varied*:  {of}[more:  {many} of them]{range}\n]"
    "Maximised: {maximised}\n"
    "[.required:Required: a critical sample time of {.required}\n]"
    "Starts over [starts_over*, :{value}]\n"
    "\nSearch\n{.stages}[finished:  ended: {note}\n]"
    "[!.done:\nNot finished: {generations} of at most {most_generations} generations; best so far "
    "candidate {best}, {.best} of the {.starts} starts by which it was\n"
    "chosen (fewer of fresh ones). stance optimise SCENARIO --resume goes on\n|"
    "\nFrom {fresh_starts} fresh starts, with 95 % intervals\n{.confirmed}"
    "  (training: objective of the starts by which the search went; gap: training - fresh;\n"
    "[.apart:  * chosen, for the largest choice: the objective of as many other starts)"
    "|  * chosen, by these very starts, as in files of earlier versions: too high)]\n"
    "[chosen:  chosen - first[.several:, mean of the circumstances]: {gain*%+.2f} points "
    "({gain_low*%.2f} ... {gain_high*%.2f}), start by start: {won} won, {lost} lost\n]"
    "[.limit:  {allowed*%.2f} % is what linear theory allows any controller "
    "[where:in its worst circumstance,\n  {where}|there]: chosen {chosen*%.1f} % of that"
    "[before:, first {first*%.1f} %[differs: of its posture's {before*%.2f} %]]\n"
    "[linear_limit_glued:  (" ALLOWED_GLUED ")\n]]"
    "[chosen:  of the chosen one's starts {.counts}\n]"
    "[.several:\nIn each circumstance\n{.circumstances}"
    "[.limited:  (allowed: from there linear theory allows any controller to recover)\n]]"
    "[elsewhere:\nElsewhere, where nothing was sought\n{.elsewhere}]"
    "[chosen:\nChosen: {which} (with all digits in the -best.yaml beside the file)\n"
    "[gains:  controller:\n    design: gains\n    gains:\n"
    "[gains*:      - \\[[value*, :{value%.6g}]\\]\n]]"
    "[.values*:  {key} = {value%.6g}\n]"
    "[.poles:  poles{.poles} 1/s\n]"
    "[.critical:  critical sample time{.critical}\n]]]";

static int summarise(const struct report *report, stance_message *message)
{
    struct search_study study;
    struct table t = {0};
    json_t *const facts = json_object();
    if (!search_study_open(&study, report->file, message)) {
        json_decref(facts);
        return EXIT_IO;
    }
    put_confirmed(&t, &study);
    const bool made = add_facts(&study, facts);
    search_study_close(&study);
    return table_say(report->form, facts, text, &t) && made ? EXIT_DONE : EXIT_IO;
}

/* ---- several ------------------------------------------------------------------------------ */

/* Of a search, behind the number that differs, under its path. */
#define FRONT(X)                                                                                   \
    SHARE(X, "first", "first %", 8, first.share)                                                   \
    INTERVAL(X, "first_low", "first_high", first.interval)                                         \
    SHARE(X, "chosen", "chosen %", 8, chosen.share)                                                \
    INTERVAL(X, "chosen_low", "chosen_high", chosen.interval)                                      \
    SHARE(X, "allowed", "allowed %", 9, allowed)                                                   \
    X("of_allowed", "", as_number(chosen.share / allowed), "of that", "%.1f", .width = 7,          \
      .percent = true)                                                                             \
    X("glued", "as linear_limit_glued", as_truth(study->glued), .hidden = TABLE_NO_CSV)            \
    X("critical_chosen", "",                                                                       \
      as_number(f->confirmed_critical[(size_t)f->chosen * f->length[SEARCH_CIRCUMSTANCE]]),        \
      "T* chosen (s)", "%.4g", .width = 13)                                                        \
    X("file", "", as_text(study->file), "file", .width = 4, .left = true, .before = "  ")
#define FRONT_HEAD(X)                                                                              \
    X("title", "", as_text(front.study[0].f.title))                                                \
    X("against", "", as_text(axis->name))                                                          \
    X("unit", "", as_text(axis->unit[0] ? axis->unit : NULL))                                      \
    X("also", "other paths that differ", as_text(front.also[0] ? front.also : NULL))

static const struct say_key front_row_keys[] = {{"PATH", "", NULL}, FRONT(TABLE_KEY){0}},
                            front_keys[] = {FRONT_HEAD(TABLE_KEY){"searches", "", front_row_keys},
                                            {0}};
const struct say_key search_keys[] = {
    {NULL, "of a search", own_keys}, {NULL, "of several", front_keys}, {0}};

static const char front_text[] =
    "{title}\n{.count} searches against {against}[unit: ({unit})][.text:: {.text}]\n"
    "[also:also different: {also}\n]\n{.searches}"
    "(of fresh starts, with 95 % intervals; allowed: by linear theory to any controller)\n"
    "[.glued:(" ALLOWED_GLUED ")\n]";

int search_summarise(struct report *report, stance_message *message)
{
    struct search_front front;
    struct table t = {0};
    char view[300];
    if (report->files.count < 2)
        return summarise(report, message);
    if (!search_front_open(&front, report->files.text, report->files.count, message))
        return EXIT_IO;
    const struct results_axis *const axis = &front.against;
    for (size_t i = 0; i < front.count; i++) {
        const struct search_study *const study = &front.study[i];
        const struct search_file *const f = &study->f;
        const struct search_share first = search_share(study, 0, SEARCH_OVERALL),
                                  chosen = search_share(study, (size_t)f->chosen, SEARCH_OVERALL);
        const double allowed = search_limit(study, (size_t)f->chosen, NULL);
        TABLE_FACTS(
            &t, {{axis->name, schema_last_name(axis->name), .width = 10}, as_number(front.at[i])},
            FRONT(TABLE_FACT));
        table_end_row(&t);
    }
    json_t *const facts =
        TABLE_OBJECT(FRONT_HEAD(TABLE_MEMBER){".count", as_whole(front.count)},
                     {".text", as_text(axis->text)}, {".glued", as_truth(front.glued)});
    snprintf(view, sizeof view,
             "%s first first_low first_high chosen chosen_low chosen_high allowed of_allowed "
             "critical_chosen file",
             axis->name);
    const bool good =
        table_say(report->form, table_show(facts, "searches", &t, view, 0), front_text, &t);
    search_front_close(&front);
    return good ? EXIT_DONE : EXIT_IO;
}
