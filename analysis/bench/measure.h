/* measure.h - what a group of cases costs on one core, measured without reading or writing files.
 */
#ifndef STANCE_BENCH_MEASURE_H
#define STANCE_BENCH_MEASURE_H

#include "bench.h"

#include "runner/plan/plan.h"

/* Runs the `count` rows from `first` on, all of one method, for about `budget` seconds and at
 * least three times - once when that takes more than twenty times the budget - whole lanes at a
 * time as in a sweep: microseconds of one core per simulated second of one
 * case, NAN where nothing was simulated. Needs the designs. false: no memory. */
bool measure_rows(const struct plan *plan, uint64_t first, size_t count, double budget,
                  struct bench_spread *cost, stance_message *message);

#endif
