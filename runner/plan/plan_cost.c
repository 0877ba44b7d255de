/* plan_cost.c - what the cases of a plan will take, from a few of them.
 *
 * Cases end early, most of them, and nobody knows when; a few that go on take most of the time. So
 * cases that are spread over the sweep run for a while, and of those that have not ended as many as
 * the budget allows run for twice as long, from the beginning; and so on. With w, the share of all
 * that was still under way when a round began, what came to light in it counts for w of all cases:
 *
 *     mean = sum over rounds of w x (mean of what its cases took beyond the round before)
 *
 * is without bias however few of them are left, and where the last one ends it is the whole cost.
 * Where time is up before, the rest is taken to go on to its end: a bound. All that a round runs is
 * at least half as long as the longest, and lanes are filled with repeated cases, so that few of
 * them idle, as in a run. Processor time is measured: others on this machine do not matter.
 */
#include "plan.h"

#include "instruction_set.h"

#include "runner/base/units.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TRIED = PLAN_COST_CASES, WIDEST = 8 };
#define SHORTEST 16 /* steps of the first round */

static double processor_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct tried {
    stance_case input;
    stance_result result, again; /* of its repetitions */
    int method;
    int64_t asked; /* steps to its end */
    double took;   /* s, as far as it has been run */
};

struct trial {
    struct tried *tried;
    size_t which[TRIED];        /* those that go on, spread wherever it is cut ... */
    struct tried *order[TRIED]; /* ... and those that run, of one method */
    double seconds, steps;      /* of the last round */
    double until;               /* of clock_seconds() */
};

/* Cases order[count], and again from the first on until lanes are filled. */
struct lane_feed {
    struct trial *trial;
    size_t count, fed, most;
};

static bool feed_next(void *context, const stance_case **c, stance_result **result)
{
    struct lane_feed *const feed = context;
    if (feed->fed == feed->most)
        return false;
    struct tried *const t = feed->trial->order[feed->fed % feed->count];
    *c = &t->input;
    *result = feed->fed < feed->count ? &t->result : &t->again;
    feed->fed++;
    return true;
}

static void feed_done(void *context, const stance_case *c, stance_result *result)
{
    (void)context, (void)c, (void)result;
}

static bool feed_leave(void *context)
{
    const struct lane_feed *const feed = context;
    return clock_seconds() > feed->trial->until;
}

/* Cases order[count] of a method. Adds to *more what they took beyond what they did before. false:
 * time was up. */
static bool run_method(const stance_kernel *kernel, struct trial *trial, size_t count, double *more)
{
    const size_t lanes = (size_t)(kernel->lanes < WIDEST ? kernel->lanes : WIDEST);
    struct lane_feed feed = {trial, count, 0, (count + lanes - 1) / lanes * lanes};
    double steps = 0;
    const double begin = processor_seconds();
    if (!kernel->stream(&(stance_feed){&feed, feed_next, feed_done, feed_leave}))
        return false;
    const double seconds = processor_seconds() - begin;
    for (size_t k = 0; k < feed.most; k++)
        steps += (double)trial->order[k % count]->result.steps;
    trial->seconds += seconds;
    trial->steps += steps;
    for (size_t i = 0; i < count; i++) {
        struct tried *const t = trial->order[i];
        /* One that ends where it begins takes no step, but some time all the same. */
        const double took =
            steps > 0 ? seconds * (double)t->result.steps / steps : seconds / (double)feed.most;
        *more += fmax(0, took - t->took);
        t->took = took;
    }
    return true;
}

/* The first `count` cases of which[], up to `cap` steps, method by method. */
static bool run_round(const struct plan *plan, struct trial *trial, size_t count, int64_t cap,
                      double *more)
{
    bool good = true;
    *more = trial->seconds = trial->steps = 0;
    for (int m = 0; good && stance_methods()[m]; m++) {
        size_t n = 0;
        for (size_t i = 0; i < count; i++) {
            struct tried *const t = &trial->tried[trial->which[i]];
            t->input.steps = t->asked < cap ? t->asked : cap;
            if (t->method == m)
                trial->order[n++] = t;
        }
        good =
            n == 0 || run_method(instruction_set_kernel(plan->scenario->scene, stance_methods()[m]),
                                 trial, n, more);
    }
    return good;
}

/* s, of the last round. */
static double per_step(const struct trial *trial)
{
    return trial->steps > 0 ? trial->seconds / trial->steps : 0;
}

/* Those of the first `count` that go on; the others are dropped. */
static size_t keep_going(struct trial *trial, size_t count)
{
    size_t left = 0;
    for (size_t i = 0; i < count; i++) {
        const struct tried *const t = &trial->tried[trial->which[i]];
        if (t->result.status == STANCE_DONE && t->result.steps >= t->input.steps &&
            t->input.steps < t->asked)
            trial->which[left++] = trial->which[i];
    }
    return left;
}

/* The cases, in an order that is spread wherever it is cut; *begun: of those tried, that have a
 * start. Returns how many were tried. */
static size_t list_cases(const struct plan *plan, struct trial *trial, size_t *begun)
{
    size_t tried = 0;
    *begun = 0;
    for (uint64_t i = 0; i < TRIED && (i == 0 || plan->rows > 1); i++) {
        struct tried *const t = &trial->tried[*begun];
        const uint64_t row = plan->single ? 0 : plan_cost_case(plan, i);
        if (plan->design_status[plan_design(plan, plan_case(plan, row))] == STANCE_PENDING)
            continue;
        tried++;
        if (!plan_resolve(plan, row, &t->input, &t->method))
            continue;
        t->asked = t->input.steps;
        trial->which[*begun] = *begun;
        (*begun)++;
    }
    return tried;
}

/* How many of those that are left the time allows to be followed to their ends. */
static size_t affordable(const struct trial *trial, size_t left, double seconds, int64_t cap)
{
    double longest = 0;
    for (size_t i = 0; i < left; i++)
        longest = fmax(longest, (double)trial->tried[trial->which[i]].asked);
    const double all = fmax(2 * longest - (double)cap / 2, (double)cap) * per_step(trial);
    const double most = all > 0 ? seconds / all : INFINITY;
    return most >= (double)left ? left
           : most < WIDEST      ? (left < WIDEST ? left : WIDEST)
                                : (size_t)most;
}

double plan_cost(const struct plan *plan, double budget, bool *bound)
{
    enum { LATEST = 5 };
    const double start = clock_seconds();
    struct trial trial = {.tried = calloc(TRIED, sizeof *trial.tried),
                          .until = start + LATEST * budget};
    size_t begun = 0, left;
    double share = 1, mean = 0, more = 0;
    *bound = false;
    const size_t tried = trial.tried ? list_cases(plan, &trial, &begun) : 0;
    left = begun;
    if (tried > 0)
        share = (double)begun / (double)tried;
    for (int64_t cap = SHORTEST; left > 0; cap *= 2) {
        const double remains = budget - (clock_seconds() - start);
        const size_t count = cap == SHORTEST ? left : affordable(&trial, left, remains, cap);
        const bool fits = cap == SHORTEST || (double)count * (double)cap * per_step(&trial) <
                                                 trial.until - clock_seconds();
        if (!fits || !run_round(plan, &trial, count, cap, &more)) {
            if (cap == SHORTEST)
                break; /* nothing is known */
            *bound = true;
            for (size_t i = 0; i < left; i++) {
                const struct tried *const t = &trial.tried[trial.which[i]];
                mean +=
                    share / (double)left * fmax(0, (double)t->asked * per_step(&trial) - t->took);
            }
            break;
        }
        mean += share * more / (double)count;
        left = keep_going(&trial, count);
        share *= (double)left / (double)count;
    }
    free(trial.tried);
    const bool known = mean > 0 || left == 0;
    return begun == 0 ? -1 : known ? mean * (double)plan->rows : NAN;
}
