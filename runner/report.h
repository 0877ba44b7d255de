/* report.h - what `check` and `run --dry-run` print about a plan. */
#ifndef STANCE_RUNNER_REPORT_H
#define STANCE_RUNNER_REPORT_H

#include "plan.h"

#include <stdio.h>

/* Needs the designs. `file`: where the results would go. */
void report_plan(const struct plan *plan, int ranks, const char *file, bool json, FILE *out);

/* "1.2 GB" and "3 min" for people. */
void report_bytes(char *text, size_t size, double bytes);
void report_seconds(char *text, size_t size, double seconds);

#endif
