/* measure.c - repeats a group of cases and takes the median of its times. */
#include "measure.h"

#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/plan/instruction_set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LEAST_REPETITIONS = 3, MOST_REPETITIONS = 101, LONG = 20 };

/* Seconds since then: of the processor, which others take no part in, once it is long enough for
 * the ticks in which some systems count those; else of the clock. */
struct since {
    double clock, processor;
};
static struct since now(void)
{
    return (struct since){clock_seconds(), bench_clock()};
}
static double seconds(struct since begin)
{
    const double processor = bench_clock() - begin.processor;
    return processor >= 0.1 ? processor : clock_seconds() - begin.clock;
}

/* Runs the cases once; what that took. */
static double run_once(const stance_kernel *kernel, const stance_case *cases,
                       stance_result *results, size_t n)
{
    const struct since begin = now();
    kernel->run(cases, results, n);
    return seconds(begin);
}

static void repeat(const stance_kernel *kernel, const stance_case *cases, stance_result *results,
                   size_t n, double budget, struct bench_spread *cost)
{
    double time[MOST_REPETITIONS], spent = 0, simulated = 0;
    int k = 0;
    time[0] = run_once(kernel, cases, results, n);
    if (time[0] >= LONG * budget) /* else that was the warming up */
        spent = time[k++];
    while (k < 1 || (k < LEAST_REPETITIONS && spent < LONG * budget) ||
           (k < MOST_REPETITIONS && spent < budget)) {
        time[k] = run_once(kernel, cases, results, n);
        spent += time[k++];
    }
    for (size_t i = 0; i < n; i++)
        simulated += results[i].end_time;
    *cost = bench_scaled(bench_spread(time, k), 1e6 / simulated);
}

bool measure_rows(const struct plan *plan, uint64_t first, size_t count, double budget,
                  struct bench_spread *cost, stance_message *message)
{
    stance_case *cases = calloc(count, sizeof *cases);
    stance_result *results = calloc(count, sizeof *results);
    size_t n = 0;
    int method = 0;

    *cost = (struct bench_spread){NAN, NAN, NAN};
    const bool good = (cases && results) || no_memory(message);
    for (size_t i = 0; good && i < count; i++)
        n += plan_resolve(plan, first + i, &cases[n], &method);
    const stance_kernel *kernel =
        n > 0 ? instruction_set_kernel(plan->scenario->scene, stance_methods()[method]) : NULL;
    if (kernel)
        repeat(kernel, cases, results, n, budget, cost);
    free(cases);
    free(results);
    return good;
}
