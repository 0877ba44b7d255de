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
/* The names of the columns, and a line. Every line ends in what program, compiler, processor,
 * machine and day it comes from. */
void bench_csv_head(FILE *out);
void bench_csv_row(FILE *out, const struct bench_row *row);

#endif
