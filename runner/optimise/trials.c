/* trials.c - a plan of candidates, circumstances and starts, simulated without a file. */
#include "trials.h"

#include "engine/control/design.h"
#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/plan/allowed.h"
#include "runner/plan/design.h"
#include "runner/run/work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_SHORT 1e3

/* ---- making --------------------------------------------------------------------------------- */

/* What a start counts: even, or by a normal density about the middle of each range. */
static double density(const struct scenario *s, const double *value)
{
    double sum = 0;
    for (size_t j = 0; s->search.normal && j < s->sample.design.factors; j++) {
        const struct scenario_factor *const f = &s->sample.factor[j];
        const double from = f->value[0], to = f->value[(f->points - 1) * (size_t)f->paths];
        const double at = value[f->first];
        const double off = from < to ? ((at - from) / (to - from) - 0.5) / 0.25 : 0;
        sum += off * off;
    }
    return exp(-0.5 * sum);
}

/* The same as whole numbers. */
static int64_t *make_weights(const struct scenario *s, uint64_t starts, const double *value)
{
    const size_t paths = (size_t)s->axis[s->axes - 1].paths;
    int64_t *const weight = malloc(starts * sizeof *weight);
    double sum = 0;
    for (uint64_t i = 0; weight && i < starts; i++)
        sum += density(s, &value[i * paths]);
    for (uint64_t i = 0; weight && i < starts; i++)
        weight[i] = llround(TRIALS_WEIGHT / sum * density(s, &value[i * paths]));
    return weight;
}

bool trials_make(struct trials *t, const struct scenario *scenario, const struct parallel *parallel)
{
    *t = (struct trials){
        .scenario = scenario, .parallel = parallel, .circumstances = 1, .until = INFINITY};
    t->at = malloc(sizeof *t->at);
    struct scenario *const at = t->at;
    if (!at || scenario->axes == SCENARIO_MAX_AXES)
        return false;
    *at = *scenario;
    at->axis[at->axes - 1].value = NULL; /* points of its own */
    bool good = true;
    for (int k = 0; k < TRIALS_STARTS; k++) {
        const uint64_t count = trials_count(scenario, (enum trials_starts)k);
        struct scenario_axis *const sample = &at->axis[at->axes - 1];
        if (scenario_resample(at, count, trials_seed(scenario, (enum trials_starts)k))) {
            t->start[k] = sample->value; /* the axis loses them */
            sample->value = NULL;
        }
        t->weight[k] = t->start[k] ? make_weights(scenario, count, t->start[k]) : NULL;
        good = good && t->start[k] && t->weight[k];
    }
    for (int a = 0; a + 1 < scenario->axes; a++)
        t->circumstances *= scenario->axis[a].count;
    memmove(&at->axis[1], &at->axis[0], (size_t)scenario->axes * sizeof at->axis[0]);
    at->axis[0] = scenario->search.axis;
    at->axis[0].count = 1;
    at->axes = scenario->axes + 1;
    at->record_cases = RECORD_NONE;
    at->record_every = 0;
    return good;
}

void trials_free(struct trials *t)
{
    if (t->kernels.count > 0)
        kernels_give_back(&t->kernels);
    for (int k = 0; k < TRIALS_STARTS; k++) {
        free(t->start[k]);
        free(t->weight[k]);
    }
    free(t->label);
    free(t->worth);
    free(t->loop);
    free(t->at); /* what it points to is the scenario's */
    *t = (struct trials){0};
}

/* ---- loops ---------------------------------------------------------------------------------- */

/* How fast a loop that is not stable departs: above 0, below MOST_SHORT. */
static double instability(const struct design_report *r)
{
    double largest = 0;
    for (int i = 0; i < r->states; i++)
        largest = fmax(largest, r->closed_re[i]);
    const double excess = r->sampled ? r->radius - 1 : largest;
    return fmin(fmax(excess, 0), MOST_SHORT - 1);
}

/* Linear theory of a law that it knows: whether the loop is stable as it acts, and from which
 * sample time on it would not be. */
static void look_at_loop(const struct trials *t, uint64_t index, struct scenario *one,
                         struct design_report *report, struct trials_loop *loop)
{
    const double asked = t->scenario->search.critical;
    stance_message ignored;
    *loop = (struct trials_loop){.critical = NAN, .exists = 1, .stable = 1, .tried = 1};
    scenario_case_values(t->at, index, &one->base);
    if (!scenario_law(&one->base)->designed)
        return;
    loop->exists = design_loop(report, one, NULL, &ignored);
    loop->stable = loop->exists && report->stable;
    loop->tried = loop->stable;
    loop->short_of = !loop->exists ? MOST_SHORT : loop->stable ? 0 : 1 + instability(report);
    if (!loop->tried || one->base.sample_time <= 0)
        return;
    const double least = isnan(asked) ? 2 * one->base.sample_time : asked;
    const stance_plant plant = {report->states, report->inputs, report->A, report->B};
    if (stance_critical_sample_time(&plant, &(stance_sampling){.K = report->K}, DESIGN_LONGEST,
                                    &loop->critical) != STANCE_OK)
        loop->critical = NAN;
    loop->tried = least <= 0 || loop->critical >= least;
    loop->short_of = loop->tried ? 0 : isnan(loop->critical) ? 1 : 1 - loop->critical / least;
}

/* Each rank a block of them. */
static bool look_at_loops(struct trials *t, size_t candidates, uint64_t starts)
{
    const size_t pairs = candidates * t->circumstances;
    const size_t ranks = (size_t)t->parallel->size, rank = (size_t)t->parallel->rank;
    const size_t first = pairs * rank / ranks, end = pairs * (rank + 1) / ranks;
    struct scenario *const one = malloc(sizeof *one);
    struct design_report *const report = malloc(sizeof *report);
    if (one)
        *one = *t->scenario;
    for (size_t p = first; one && report && p < end; p++)
        look_at_loop(t, p * starts, one, report, &t->loop[p]);
    const bool good = one && report;
    free(one);
    free(report);
    parallel_gather_block(t->parallel, t->loop, sizeof *t->loop, first, end - first);
    parallel_broadcast(t->parallel, t->loop, pairs * sizeof *t->loop);
    return good;
}

/* ---- cases ---------------------------------------------------------------------------------- */

/* What is computed together. */
struct batch {
    struct trials *t;
    uint64_t starts, cases;
    const int64_t *weight;
};

static bool is_tried(void *context, uint64_t row)
{
    const struct batch *const batch = context;
    return batch->t->loop[row / batch->starts].tried;
}

static bool attend(void *context, double now)
{
    const struct batch *const batch = context;
    return batch->t->attend && batch->t->attend(batch->t->context, now);
}

/* What a recovered start is worth: 1 or an answer, less prices. */
static int64_t worth_of(const struct scenario_search *search, const stance_result *result)
{
    double worth = 1;
    for (int i = 0; i < STANCE_ANSWER_COUNT; i++) {
        const bool aim = search->aim == AIM_ANSWER && i == search->answer;
        if ((search->price[i] == 0 && !aim) || stance_answers[i].type == STANCE_UINT8)
            continue;
        double value = stance_answer_of(result, i);
        value = isnan(value) ? 0 : value;
        worth = aim ? worth - 1 + value : worth;
        worth -= search->price[i] * value;
    }
    return llround(TRIALS_WORTH * fmin(fmax(worth, -TRIALS_MOST_WORTH), TRIALS_MOST_WORTH));
}

static void end_case(void *context, uint64_t row, const stance_result *result)
{
    struct batch *const batch = context;
    struct trials *const t = batch->t;
    if (result->status == STANCE_DONE && trials_recovered(result->outcome + 1))
        t->worth[row / batch->starts] +=
            batch->weight[row % batch->starts] * worth_of(&t->scenario->search, result);
    batch->cases += result->failure != STANCE_FAILURE_INITIAL;
}

static enum trials_end simulate(struct trials *t, const struct plan *plan, uint64_t starts,
                                const int64_t *weight, stance_message *message)
{
    struct batch batch = {.t = t, .starts = starts, .weight = weight};
    struct work work = {.plan = plan,
                        .parallel = t->parallel,
                        .quiet = true,
                        .time_limit = t->until,
                        .beats = t->beats,
                        .ends = end_case,
                        .takes = is_tried,
                        .attend = t->parallel->rank == 0 ? attend : NULL,
                        .context = &batch,
                        .cycle = t->circumstances};
    parallel_restart(t->parallel);
    const bool good = work_run(&work, NULL, t->label, message);
    t->beats = work.beats;
    if (!parallel_agree(t->parallel, good, message->text, sizeof message->text))
        return TRIALS_BROKEN;
    uint64_t stopped = parallel_add(t->parallel, COUNTER_STOP, 0) != 0;
    parallel_sum(t->parallel, &stopped, 1);
    if (stopped)
        return TRIALS_STOPPED;
    const size_t pairs = plan->rows / starts;
    parallel_largest(t->parallel, t->label, plan->rows);
    parallel_sum(t->parallel, (uint64_t *)t->worth, (int)pairs);
    parallel_sum(t->parallel, &batch.cases, 1);
    t->cases += batch.cases;
    return TRIALS_DONE;
}

/* ---- a run ---------------------------------------------------------------------------------- */

static bool stop_designs(void *context)
{
    const struct trials *const t = context;
    const bool stop = work_stop_asked() || clock_seconds() > t->until;
    return parallel_add(t->parallel, COUNTER_STOP, stop) != 0 || stop;
}

static enum trials_end take_kernels(struct trials *t, const struct plan *plan,
                                    stance_message *message)
{
    if (t->has_kernels)
        return TRIALS_DONE;
    const struct kernels_choice all = {.always = true, .quiet = t->quiet};
    const double begin = clock_seconds();
    const enum exit_code code = kernels_take(&t->kernels, plan, &all, t->parallel, message);
    t->has_kernels = code == EXIT_DONE;
    t->compiling += clock_seconds() - begin;
    return code == EXIT_DONE          ? TRIALS_DONE
           : code == EXIT_INTERRUPTED ? TRIALS_STOPPED
                                      : TRIALS_BROKEN;
}

enum trials_end trials_run(struct trials *t, size_t candidates, double *value,
                           enum trials_starts which, uint64_t starts, stance_message *message)
{
    struct scenario *const at = t->at;
    struct scenario_axis *const sample = &at->axis[at->axes - 1];
    struct plan plan;
    struct plan_error error = {0};
    const size_t pairs = candidates * t->circumstances;
    at->axis[0].value = value;
    at->axis[0].count = candidates;
    sample->value = t->start[which];
    sample->count = starts;
    at->cases = pairs * starts;
    at->seed = trials_seed(t->scenario, which);
    bool good = plan_make(&plan, at, false, 0, false, &error);
    if (!good)
        *message = error.message;
    free(t->label);
    free(t->worth);
    free(t->loop);
    t->label = calloc(pairs * starts, 1);
    t->worth = calloc(pairs, sizeof *t->worth);
    t->loop = calloc(pairs, sizeof *t->loop);
    if (good && !(t->label && t->worth && t->loop))
        good = complain(message, "not enough memory for %zu candidates", candidates);
    if (!parallel_agree(t->parallel, good, message->text, sizeof message->text)) {
        plan_free(&plan);
        return TRIALS_BROKEN;
    }
    plan.stop = stop_designs;
    plan.stop_context = t;
    enum trials_end end = TRIALS_DONE;
    if (!plan_compute_designs(&plan, t->parallel, &error) && !error.message.text[0])
        end = TRIALS_STOPPED; /* where none exists all candidates are refused */
    parallel_broadcast(t->parallel, plan.design,
                       plan.designs * plan.design_size * sizeof *plan.design);
    parallel_broadcast(t->parallel, plan.design_status, plan.designs);
    if (end == TRIALS_DONE) {
        good = look_at_loops(t, candidates, starts) ||
               complain(message, "not enough memory for the loops");
        good = parallel_agree(t->parallel, good, message->text, sizeof message->text);
        end = good ? take_kernels(t, &plan, message) : TRIALS_BROKEN;
        if (end == TRIALS_DONE)
            end = simulate(t, &plan, starts, t->weight[which], message);
    }
    plan_free(&plan);
    at->axis[0].value = NULL;
    sample->value = NULL;
    return end;
}

/* ---- the denominator ------------------------------------------------------------------------ */

static double share_in(const struct trials *t, size_t circumstance, uint64_t starts)
{
    struct allowed allowed;
    stance_message ignored;
    uint64_t inside = 0;
    if (!allowed_make(&allowed, t->at, circumstance * starts, &ignored))
        return NAN;
    for (uint64_t i = 0; allowed.set && i < starts; i++)
        inside += allowed_case(&allowed, t->at, circumstance * starts + i);
    const double share = allowed.set ? (double)inside / (double)starts : NAN;
    allowed_free(&allowed);
    return share;
}

double linear_limit_overall(bool worst, size_t circumstances, const double *share, size_t *least)
{
    double sum = 0;
    *least = circumstances;
    for (size_t c = 0; c < circumstances; c++) {
        sum += share[c];
        if (!isnan(share[c]) && (*least == circumstances || share[c] < share[*least]))
            *least = c;
    }
    if (worst && circumstances > 1)
        return *least < circumstances ? share[*least] : NAN;
    *least = circumstances;
    return sum / (double)circumstances;
}

void linear_limit_shares(struct trials *t, double *value, uint64_t starts, double *share)
{
    struct scenario_axis *const candidate = &t->at->axis[0];
    struct scenario_axis *const sample = &t->at->axis[t->at->axes - 1];
    candidate->value = value;
    candidate->count = 1;
    sample->value = t->start[TRIALS_FRESH];
    sample->count = starts;
    for (size_t c = 0; c < t->circumstances; c++)
        share[c] = scenario_law(&t->scenario->base)->designed ? share_in(t, c, starts) : NAN;
    candidate->value = NULL;
    sample->value = NULL;
}
