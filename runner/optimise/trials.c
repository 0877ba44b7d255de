/* trials.c - a plan of candidates, circumstances and starts, simulated without a file. */
#include "trials.h"

#include "engine/control/design.h"
#include "engine/mechanism.h"
#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/plan/allowed.h"
#include "runner/plan/design.h"
#include "runner/run/work.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define MOST_SHORT 1e3
enum { MOST_STARTS = 8192 }; /* elsewhere */
static const double mass_error = 0.05, less_friction = 0.5;

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
    double excess = r->sampled ? r->radius - 1 : 0;
    for (int i = 0; !r->sampled && i < r->states; i++)
        excess = fmax(excess, r->closed_re[i]);
    return fmin(fmax(excess, 0), MOST_SHORT - 1);
}

/* Linear theory of a law that it knows: whether the loop is stable as it acts, and from which
 * sample time on it would not be. */
static void look_at_loop(const struct trials *t, uint64_t index, struct scenario *one,
                         struct design_report *report, struct trials_loop *loop)
{
    const double asked = t->scenario->search.critical;
    stance_message ignored;
    *loop = (struct trials_loop){.critical = NAN, .tried = 1};
    scenario_case_values(t->at, index, &one->base);
    const double sample_time = one->base.sample_time;
    if (!scenario_law(&one->base)->designed)
        return;
    const bool exists = design_loop(report, one, NULL, &ignored);
    loop->tried = exists && report->stable;
    if (!loop->tried)
        loop->short_of = exists ? 1 + instability(report) : MOST_SHORT;
    if (!loop->tried || sample_time <= 0)
        return;
    const double least = isnan(asked) ? 2 * sample_time : asked;
    const stance_plant plant = {report->states, report->inputs, report->A, report->B};
    if (stance_critical_sample_time(&plant, &(stance_sampling){.K = report->K}, DESIGN_LONGEST,
                                    &loop->critical) != STANCE_OK)
        loop->critical = NAN;
    loop->tried = least <= 0 || loop->critical >= least;
    if (!loop->tried)
        loop->short_of = isnan(loop->critical) ? 1 : 1 - loop->critical / least;
}

/* Each rank a block of them. */
static bool look_at_loops(struct trials *t, size_t candidates)
{
    const size_t pairs = candidates * t->circumstances;
    const size_t ranks = (size_t)t->parallel->size, rank = (size_t)t->parallel->rank;
    const size_t first = pairs * rank / ranks, end = pairs * (rank + 1) / ranks;
    struct scenario *const one = malloc(sizeof *one);
    struct design_report *const report = malloc(sizeof *report);
    if (one)
        *one = *t->scenario;
    for (size_t p = first; one && report && p < end; p++)
        look_at_loop(t, p * t->starts, one, report, &t->loop[p]);
    const bool good = one && report;
    free(one);
    free(report);
    parallel_gather_block(t->parallel, t->loop, sizeof *t->loop, first, end - first);
    parallel_broadcast(t->parallel, t->loop, pairs * sizeof *t->loop);
    return good;
}

/* ---- cases ---------------------------------------------------------------------------------- */

static bool is_tried(void *context, uint64_t row)
{
    const struct trials *const t = context;
    return t->loop[row / t->starts].tried;
}

static bool attend(void *context, double now)
{
    const struct trials *const t = context;
    return t->attend && t->attend(t->context, now);
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
    struct trials *const t = context;
    if (result->status == STANCE_DONE && trials_recovered(result->outcome + 1))
        t->worth[row / t->starts] +=
            t->counts[row % t->starts] * worth_of(&t->scenario->search, result);
    t->own_cases += result->failure != STANCE_FAILURE_INITIAL;
}

static enum trials_end simulate(struct trials *t, const struct plan *plan, stance_message *message)
{
    struct work work = {.plan = plan,
                        .parallel = t->parallel,
                        .quiet = true,
                        .time_limit = t->until,
                        .beats = t->beats,
                        .ends = end_case,
                        .takes = is_tried,
                        .attend = t->parallel->rank == 0 ? attend : NULL,
                        .context = t,
                        .cycle = t->circumstances};
    t->own_cases = 0;
    parallel_restart(t->parallel);
    const bool good = work_run(&work, NULL, t->label, message);
    t->beats = work.beats;
    if (!parallel_agree(t->parallel, good, message->text, sizeof message->text))
        return TRIALS_BROKEN;
    uint64_t stopped = parallel_add(t->parallel, COUNTER_STOP, 0) != 0;
    parallel_sum(t->parallel, &stopped, 1);
    if (stopped)
        return TRIALS_STOPPED;
    parallel_largest(t->parallel, t->label, plan->rows);
    parallel_sum(t->parallel, (uint64_t *)t->worth, (int)(plan->rows / t->starts));
    parallel_sum(t->parallel, &t->own_cases, 1);
    t->cases += t->own_cases;
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

/* What is tried, from which starts. */
static void take_points(struct trials *t, size_t candidates, double *value,
                        enum trials_starts which, uint64_t starts)
{
    struct scenario *const at = t->at;
    struct scenario_axis *const sample = &at->axis[at->axes - 1];
    at->axis[0].value = value;
    at->axis[0].count = candidates;
    sample->value = t->start[which];
    sample->count = starts;
    at->cases = candidates * t->circumstances * starts;
    at->seed = trials_seed(t->scenario, which);
    t->starts = starts;
    t->counts = t->weight[which];
}

/* Room for what comes out of so many pairs of a candidate and a circumstance. */
static bool make_room(struct trials *t, size_t pairs)
{
    free(t->label);
    free(t->worth);
    free(t->loop);
    t->label = calloc(pairs * t->starts, 1);
    t->worth = calloc(pairs, sizeof *t->worth);
    t->loop = calloc(pairs, sizeof *t->loop);
    return t->label && t->worth && t->loop;
}

static enum trials_end run_plan(struct trials *t, struct plan *plan, size_t candidates,
                                stance_message *message)
{
    struct plan_error error = {0};
    plan->stop = stop_designs;
    plan->stop_context = t;
    /* Where no design exists all candidates are refused. */
    if (!plan_compute_designs(plan, t->parallel, &error) && !error.message.text[0])
        return TRIALS_STOPPED;
    parallel_broadcast(t->parallel, plan->design,
                       plan->designs * plan->design_size * sizeof *plan->design);
    parallel_broadcast(t->parallel, plan->design_status, plan->designs);
    const bool good = look_at_loops(t, candidates) || no_memory(message);
    if (!parallel_agree(t->parallel, good, message->text, sizeof message->text))
        return TRIALS_BROKEN;
    const enum trials_end end = take_kernels(t, plan, message);
    return end == TRIALS_DONE ? simulate(t, plan, message) : end;
}

enum trials_end trials_run(struct trials *t, size_t candidates, double *value,
                           enum trials_starts which, uint64_t starts, stance_message *message)
{
    struct plan plan;
    struct plan_error error = {0};
    take_points(t, candidates, value, which, starts);
    bool good = plan_make(&plan, t->at, false, 0, false, &error);
    if (!good)
        *message = error.message;
    else if (!make_room(t, candidates * t->circumstances))
        good = complain(message, "not enough memory for %zu candidates", candidates);
    good = parallel_agree(t->parallel, good, message->text, sizeof message->text);
    const enum trials_end end = good ? run_plan(t, &plan, candidates, message) : TRIALS_BROKEN;
    plan_free(&plan);
    return end;
}

/* ---- the denominator ------------------------------------------------------------------------ */

double linear_limit_add(const struct scenario *s, size_t circumstance, double *inside)
{
    const size_t starts = s->axis[s->axes - 1].count;
    struct allowed allowed;
    stance_message ignored;
    uint64_t count = 0;
    if (!scenario_law(&s->base)->designed ||
        !allowed_make(&allowed, s, circumstance * starts, &ignored))
        return NAN;
    const bool exists = allowed.set != NULL;
    for (size_t i = 0; exists && i < starts; i++) {
        const bool in = allowed_case(&allowed, s, circumstance * starts + i);
        count += in;
        if (inside)
            inside[i] += in;
    }
    allowed_free(&allowed);
    return exists ? (double)count / (double)starts : NAN;
}

void linear_limit_shares(struct trials *t, double *value, uint64_t starts, double *share)
{
    take_points(t, 1, value, TRIALS_FRESH, starts);
    for (size_t c = 0; c < t->circumstances; c++)
        share[c] = linear_limit_add(t->at, c, NULL);
}

/* ---- elsewhere ------------------------------------------------------------------------------- */

enum { CONTACTS, FRICTION, LATER, SLOWER, HEAVIER, LIGHTER };
static const char *const name[ELSEWHERE_MOST] = {
    [CONTACTS] = "with every contact on the ground",
    [FRICTION] = "with half the friction",
    [LATER] = "one sample later",
    [SLOWER] = "with twice the sample time",
    [HEAVIER] = "with masses 5 % larger than the controller knows",
    [LIGHTER] = "with masses 5 % smaller than the controller knows"};

/* Whether anything swept or varied lies in [offset, offset + size) of the values. */
static bool moves(const struct scenario *s, size_t offset, size_t size)
{
    for (int a = 0; a <= s->axes; a++) {
        const struct scenario_axis *const axis = a < s->axes ? &s->axis[a] : &s->search.axis;
        for (int k = 0; k < axis->paths; k++)
            if (axis->offset[k] >= offset && axis->offset[k] < offset + size)
                return true;
    }
    return false;
}
#define MOVES(s, member) moves(s, offsetof(struct scenario_values, member), sizeof(s)->base.member)

/* The robot's masses, and the model's where they were the robot's. */
static bool change_masses(const struct scenario *s, double factor, struct scenario_values *to)
{
    const stance_carried *const carried = s->scene->mechanism->carried;
    bool any = false;
    for (int i = 0; carried && i < carried->parameters; i++) {
        if (strcmp(s->scene->robot[i].unit, "kg") != 0)
            continue;
        any = true;
        to->model[i] = isnan(to->model[i]) ? to->robot[i] : to->model[i];
        to->robot[i] *= factor;
    }
    return any && !MOVES(s, robot) && !MOVES(s, model);
}

/* The values there; false: the scenario says nothing of it, or is there itself. */
static bool change(const struct scenario *s, int where, struct scenario_values *to)
{
    const struct scenario_values *const base = &s->base;
    *to = *base;
    switch (where) {
    case CONTACTS:
        to->contacts = (1 << s->scene->contacts) - 1;
        return base->contacts != to->contacts;
    case FRICTION:
        to->friction *= less_friction;
        return base->friction > 0 && base->contacts && !MOVES(s, friction);
    case LATER:
        to->delay++;
        return base->sample_time > 0 && base->delay < STANCE_MAX_DELAY && !MOVES(s, delay);
    case SLOWER:
        to->sample_time *= 2;
        return base->sample_time > 0 && !MOVES(s, sample_time);
    default:
        return change_masses(s, 1 + (where == HEAVIER ? mass_error : -mass_error), to);
    }
}

const char *elsewhere_name(const struct scenario *s, int where)
{
    struct scenario_values ignored;
    return change(s, where, &ignored) ? name[where] : NULL;
}

uint64_t elsewhere_starts(const struct scenario *s)
{
    return s->search.confirm < MOST_STARTS ? s->search.confirm : MOST_STARTS;
}

enum trials_end elsewhere_run(const struct trials *with, int where, size_t candidates,
                              double *value, double *share, stance_message *message)
{
    const struct scenario *const s = with->scenario;
    const uint64_t starts = elsewhere_starts(s);
    struct scenario *const there = malloc(sizeof *there);
    struct trials trials = {0};
    enum trials_end end = TRIALS_BROKEN;
    if (there) {
        *there = *s; /* what it points to stays the scenario's */
        change(s, where, &there->base);
        there->axis[0] = s->axis[s->axes - 1];
        there->axes = 1;
        there->cases = there->axis[0].count;
        there->search.grow[there->search.stages - 1] = 1;
        there->search.confirm = starts;
        there->search.critical = 0;
    }
    const bool good = (there && trials_make(&trials, there, with->parallel)) || no_memory(message);
    if (parallel_agree(with->parallel, good, message->text, sizeof message->text) && good) {
        trials.has_kernels = true; /* those of `with` */
        trials.attend = with->attend;
        trials.context = with->context;
        trials.until = with->until;
        trials.beats = with->beats;
        end = trials_run(&trials, candidates, value, TRIALS_FRESH, starts, message);
    }
    for (size_t c = 0; end == TRIALS_DONE && c < candidates; c++) {
        uint64_t recovered = 0;
        for (uint64_t i = 0; i < starts; i++)
            recovered += trials_recovered(trials.label[c * starts + i]);
        share[c] = (double)recovered / (double)starts;
    }
    trials_free(&trials);
    free(there);
    return end;
}
