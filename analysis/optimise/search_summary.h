/* search_summary.h - `stance summary` of the file of a search: its tables, as text, CSV and JSON.
 */
#ifndef STANCE_ANALYSIS_SEARCH_SUMMARY_H
#define STANCE_ANALYSIS_SEARCH_SUMMARY_H

#include "search_study.h"

#include "analysis/table/report.h"

/* The work of a `struct report` on the file of a search, or on several: a front (search_front.h).
 */
int search_summarise(struct report *report, stance_message *message);

/* A fact of a table: a share, of which people see per cent. */
#define SEARCH_SHARE(name, heading, wide, share)                                                   \
    {                                                                                              \
        {name, heading, "%.2f", .width = wide, .percent = true}, as_number(share)                  \
    }
/* Two facts of a table that people see as one cell: "(22.3 ... 23.6 %)". */
#define SEARCH_INTERVAL(least, most, interval)                                                     \
    {{least, "", .format = "(%.2f", .before = " ", .left = true, .empty = "", .percent = true},    \
     as_number((interval).low)},                                                                   \
    {                                                                                              \
        {most, .format = "%.2f)", .joined = true, .before = " ... ", .percent = true},             \
            as_number((interval).high)                                                             \
    }

/* What `stance summary -h` says of it. */
#define SEARCH_SUMMARY_HELP                                                                        \
    "\n"                                                                                           \
    "Of the file of a search (stance optimise): what was varied and maximised, its stages; the "   \
    "first, the best and the means from fresh starts, with 95 % intervals and the gap to the "     \
    "starts by which they were chosen; circumstances, and what the chosen one costs elsewhere; "   \
    "its gains, as a scenario takes them, poles and critical sample time. A search that is not "   \
    "finished tells how far it is.\n"                                                              \
    "  --csv    a row for each candidate that was tried from fresh starts: which, candidate, "     \
    "share, low, high, objective, training, gap, choice\n"                                         \
    "  --json   keys\n"                                                                            \
    "    file, title, revision, date, seconds, finished, note (why it ended)\n"                    \
    "    generations, most_generations, candidates\n"                                              \
    "    best, best_objective   of the last stage, of the starts of the search\n"                  \
    "    maximised, varied, starts_over   in words, paths\n"                                       \
    "    stages       [{beginning, stage, starts, generations, candidates, best, "                 \
    "best_candidate, step}]\n"                                                                     \
    "    fresh_starts how many\n"                                                                  \
    "    confirmed    [{which, candidate (null: a mean), share, low, high, objective, training, "  \
    "gap, choice, chosen}]; share: of fresh starts that are stabilised, in the worst "             \
    "circumstance or the mean of them, as the search counts; choice: the objective of as many "    \
    "other starts, by which one is chosen\n"                                                       \
    "    linear_limit share of the fresh starts from which linear theory allows any controller\n"  \
    "                 to recover, counted like share; linear_limit_in: the circumstance;\n"        \
    "                 linear_limit_glued: several contacts carry, and the bound does not know\n"   \
    "                 where their centre of pressure may be\n"                                     \
    "    circumstances  [{circumstance, first, chosen, chosen_low, chosen_high, gain, "            \
    "gain_low,\n"                                                                                  \
    "                 gain_high, won, lost, allowed, of_allowed, critical_first,\n"                \
    "                 critical_chosen}]; gain: chosen - first, start by start, of which so "       \
    "many\n"                                                                                       \
    "                 were won and lost; critical: sample time, s\n"                               \
    "    elsewhere    [{where, first, chosen}]\n"                                                  \
    "    chosen       {which, starts: {what became of them: count}, gain, gain_low, gain_high, "   \
    "won, lost, values: {path: value}, gains: [[...]], poles: [[re, im]]}\n"                       \
    "Of several searches of a scenario, up to 12, the front: a row for each against the number "   \
    "that differs, of several the one with most values (stance plot draws it).\n"                  \
    "  --json   {title, against, unit, also (other paths that differ), searches: [{PATH, first, "  \
    "first_low, first_high, chosen, chosen_low, chosen_high, allowed, of_allowed, glued (as "      \
    "linear_limit_glued), critical_chosen, file}]}; --csv the rows\n"

#endif
