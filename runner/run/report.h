/* report.h - what `check` and `run --dry-run` print about a plan. */
#ifndef STANCE_RUN_REPORT_H
#define STANCE_RUN_REPORT_H

#include "runner/plan/plan.h"

/* Needs the designs. `file`: where the results would go. What is very much is said on standard
 * error, by `who`. */
void report_plan(const struct plan *plan, int ranks, const char *file, bool json, const char *who);

#endif
