/* bench.h - what all speed benchmarks share: workloads, a clock, medians and rows of CSV.
 *
 * A workload is a scene in a regime: cases of one second in steps of 1 ms that stay in the regime,
 * spread evenly over some range of starts. The scene says which; torques are held for 1 ms.
 */
#ifndef STANCE_BENCH_BENCH_H
#define STANCE_BENCH_BENCH_H

#include "engine/stance.h"

#include <stdio.h>

/* The workload's cases, cases[count]: the first n of them are as evenly spread as all. False: there
 * is no such regime, or no gains for it. */
bool bench_cases(const stance_scene *scene, const char *regime, stance_case *cases, int count);

/* Seconds that this process has computed: what else runs on the machine takes no part in them. */
double bench_clock(void);

/* Of repeated measurements. */
struct bench_spread {
    double median, lowest, highest;
};
/* Sorts values[n], n > 0. */
struct bench_spread bench_spread(double *values, int n);
static inline struct bench_spread bench_scaled(struct bench_spread by, double scale)
{
    return (struct bench_spread){scale * by.median, scale * by.lowest, scale * by.highest};
}

/* A line of the table of results. Texts without commas and quotes; empty or 0: does not apply. */
struct bench_row {
    const char *subject; /* what was measured: stance, mujoco default, ... */
    const char *scene, *regime, *method, *isa;
    int lanes, ranks;
    double step; /* s */
    int cases, repeats;
    const char *quantity, *unit;
    struct bench_spread value;
};
/* The columns of the table of results. Every line ends in what program, compiler, processor,
 * machine and day it comes from. */
#define BENCH_COLUMNS(X)                                                                           \
    X(SUBJECT, subject)                                                                            \
    X(SCENE, scene)                                                                                \
    X(REGIME, regime)                                                                              \
    X(METHOD, method)                                                                              \
    X(ISA, isa)                                                                                    \
    X(LANES, lanes)                                                                                \
    X(RANKS, ranks)                                                                                \
    X(STEP, step_s)                                                                                \
    X(CASES, cases)                                                                                \
    X(REPEATS, repeats)                                                                            \
    X(QUANTITY, quantity)                                                                          \
    X(UNIT, unit)                                                                                  \
    X(MEDIAN, median)                                                                              \
    X(LOWEST, lowest)                                                                              \
    X(HIGHEST, highest)                                                                            \
    X(REVISION, revision)                                                                          \
    X(COMPILER, compiler)                                                                          \
    X(FLAGS, flags)                                                                                \
    X(PROCESSOR, processor)                                                                        \
    X(MACHINE, machine)                                                                            \
    X(DATE, date)

enum bench_column {
#define BENCH_COLUMN(NAME, name) BENCH_##NAME,
    BENCH_COLUMNS(BENCH_COLUMN)
#undef BENCH_COLUMN
        BENCH_COLUMN_COUNT,
};
extern const char *const bench_column_names[BENCH_COLUMN_COUNT];

/* The names, and a line. */
void bench_csv_head(FILE *out);
void bench_csv_row(FILE *out, const struct bench_row *row);

#endif
