/* search_tables.c - the tables of a search, for people and for programs. */
#include "search_summary.h"

#include "runner/base/message.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_STAGES = SCENARIO_MAX_STAGES * (SCENARIO_MAX_RESTARTS + 1) };

/* ---- stages ------------------------------------------------------------------------------- */

void search_table_stages(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    size_t last[MOST_STAGES], first = 0;
    const size_t stages = search_stages(study, last, MOST_STAGES);
    for (size_t i = 0; i < stages; i++) {
        const size_t g = last[i];
        TABLE_FACTS(t,
                    {{"beginning", "beginning", .width = 9}, as_whole((uint64_t)f->restart[g] + 1)},
                    {{"stage", "stage", .width = 5}, as_whole((uint64_t)f->stage[g] + 1)},
                    {{"starts", "starts", .width = 8}, as_whole((uint64_t)f->starts[g])},
                    {{"generations", "generations", .width = 9}, as_whole(g + 1 - first)},
                    {{"candidates", "candidates", .width = 9},
                     as_whole((uint64_t)(f->candidates[g] - search_first(f, first)))},
                    {{"best", "best", .format = study->plain ? "%.2f %%" : NULL, .width = 9,
                      .percent = study->plain},
                     as_number(f->objective[f->best[g]])},
                    {{"best_candidate", "candidate", .width = 9}, as_whole((uint64_t)f->best[g])},
                    {{"step", "last step", "%.3g", .width = 9}, as_number(f->step[g])});
        table_end_row(t);
        first = g + 1;
    }
}

/* ---- fresh starts ------------------------------------------------------------------------- */

void search_table_confirmed(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const char *const format = study->plain ? "%.2f" : NULL;
    char name[80];
    for (size_t k = 0; study->done && k < f->length[SEARCH_CONFIRMED]; k++) {
        const bool chosen = (int64_t)k == f->chosen;
        search_name(study, k, name, sizeof name);
        TABLE_FACTS(
            t, {{"mark", "", .hidden = TABLE_VIEW_ONLY, .width = 1}, as_text(chosen ? "*" : " ")},
            {{"which", "", .left = true}, as_text(name)},
            {{"candidate", "candidate", .width = 9},
             f->confirmed_candidate[k] < 0 ? as_nothing(NULL)
                                           : as_whole((uint64_t)f->confirmed_candidate[k])},
            {{"share", study->plain ? "share %" : "recovered %", "%.2f", .width = 7,
              .percent = true},
             as_number(search_share(study, k, SEARCH_OVERALL))},
            SEARCH_INTERVAL("low", "high", search_interval(study, k, SEARCH_OVERALL)),
            {{"objective", "objective", .width = 9}, as_number(f->confirmed_objective[k])},
            {{"training", "training", .format = format, .width = 8, .percent = study->plain},
             as_number(f->confirmed_training[k])},
            {{"gap", "gap", study->plain ? "%+.2f" : "%+.6g", .width = 6, .percent = study->plain},
             as_number(f->confirmed_training[k] - f->confirmed_objective[k])},
            {{"choice", "choice", .format = format, .width = 7, .percent = study->plain},
             as_number(f->choice_objective[k])},
            {{"chosen", .hidden = TABLE_NO_CSV}, as_truth(chosen)});
        table_end_row(t);
    }
}

/* ---- circumstances ------------------------------------------------------------------------ */

void search_table_circumstances(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE], chosen = (size_t)f->chosen;
    for (size_t c = 0; study->done && c < circumstances; c++) {
        const struct search_gain gain = search_gain(study, c);
        const double share = search_share(study, chosen, c),
                     allowed = f->confirmed_allowed[chosen * circumstances + c];
        TABLE_FACTS(
            t, {{"circumstance", "", .left = true}, as_text(f->circumstance[c])},
            {{"first", "first %", "%.2f", .width = 7, .percent = true},
             as_number(search_share(study, 0, c))},
            {{"chosen", "chosen %", "%.2f", .width = 8, .percent = true}, as_number(share)},
            SEARCH_INTERVAL("chosen_low", "chosen_high", search_interval(study, chosen, c)),
            {{"gain", "gained", "%+.2f", .width = 7, .percent = true}, as_number(gain.share)},
            SEARCH_INTERVAL("gain_low", "gain_high", gain.interval),
            {{"won", .heading = NULL}, as_whole(gain.won)},
            {{"lost", .heading = NULL}, as_whole(gain.lost)},
            {{"allowed", "allowed %", "%.2f", .width = 9, .percent = true}, as_number(allowed)},
            {{"of_allowed", "of that", "%.1f", .width = 7, .percent = true},
             as_number(share / allowed)},
            {{"critical_first", "T* first (s)", "%.4g", .width = 12},
             as_number(f->confirmed_critical[c])},
            {{"critical_chosen", "T* chosen (s)", "%.4g", .width = 13},
             as_number(f->confirmed_critical[chosen * circumstances + c])});
        table_end_row(t);
    }
}

/* ---- elsewhere ---------------------------------------------------------------------------- */

void search_table_elsewhere(struct table *t, const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    for (size_t e = 0; study->done && e < f->length[SEARCH_ELSEWHERE]; e++) {
        TABLE_FACTS(t, {{"where", "", .left = true}, as_text(f->elsewhere[e])},
                    {{"first", "first %", "%.2f", .width = 8, .percent = true},
                     as_number(f->elsewhere_first[e])},
                    {{"chosen", "chosen %", "%.2f", .width = 9, .percent = true},
                     as_number(f->elsewhere_chosen[e])});
        table_end_row(t);
    }
}
