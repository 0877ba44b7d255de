/* measure.c - repeats a group of cases and takes the median of its times. */
#include "measure.h"

#include "bench.h"

#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/plan/instruction_set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LEAST_REPETITIONS = 3, MOST_REPETITIONS = 101, LONG = 20 };

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double simulated(const stance_result *results, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += results[i].end_time;
    return sum;
}

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

/* Runs the cases once; *time is what that took. */
static bool run_quickly(const stance_kernel *kernel, const stance_case *cases,
                        stance_result *results, size_t n, double budget, double *time)
{
    const struct since begin = now();
    kernel->run(cases, results, n);
    *time = seconds(begin);
    return *time < LONG * budget;
}

static void repeat(const stance_kernel *kernel, const stance_case *cases, stance_result *results,
                   size_t n, double budget, struct measure_cost *cost)
{
    double time[MOST_REPETITIONS], spent = 0;
    int k = 0;
    if (run_quickly(kernel, cases, results, n, budget, &time[0]))
        spent = 0; /* that was the warming up */
    else
        spent = time[k++];
    while (k < 1 || (k < LEAST_REPETITIONS && spent < LONG * budget) ||
           (k < MOST_REPETITIONS && spent < budget)) {
        const struct since begin = now();
        kernel->run(cases, results, n);
        time[k] = seconds(begin);
        spent += time[k++];
    }
    qsort(time, (size_t)k, sizeof *time, ascending);
    const double scale = 1e6 / simulated(results, n);
    *cost = (struct measure_cost){time[k / 2] * scale, time[0] * scale, time[k - 1] * scale, k};
}

bool measure_rows(const struct plan *plan, uint64_t first, size_t count, double budget,
                  struct measure_cost *cost, stance_message *message)
{
    stance_case *cases = calloc(count, sizeof *cases);
    stance_result *results = calloc(count, sizeof *results);
    size_t n = 0;
    int method = 0;

    *cost = (struct measure_cost){NAN, NAN, NAN, 0};
    if (!cases || !results) {
        complain(message, "not enough memory");
        free(cases);
        free(results);
        return false;
    }
    for (size_t i = 0; i < count; i++)
        n += plan_resolve(plan, first + i, &cases[n], &method);
    const stance_kernel *kernel =
        n > 0 ? instruction_set_kernel(plan->scenario->scene, stance_methods()[method]) : NULL;
    if (kernel)
        repeat(kernel, cases, results, n, budget, cost);
    free(cases);
    free(results);
    return true;
}
