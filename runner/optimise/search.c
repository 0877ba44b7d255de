/* search.c - stages and generations; rank 0 decides, all try. */
#include "search.h"
#include "cma.h"
#include "elsewhere.h"

#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/base/words.h"
#include "runner/store/build_info.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define NAME_OF(NAME, name, ...) [(STANCE_##NAME) + 1] = #name,
const char *const search_kinds[TRIAL_LABELS] = {[TRIAL_REFUSED] = "refused",
                                                [TRIAL_FAILED] = "failed",
                                                [STANCE_NONE + 1] = "none",
                                                STANCE_OUTCOMES(NAME_OF)};
#undef NAME_OF

enum {
    COMPARED = 2,         /* elsewhere: the first and the chosen one */
    MOST_ALLOWED = 16384, /* starts that are held against linear theory */
};

static const double remembered = 0.6; /* of what was known, each time more is */

/* ---- words of the record -------------------------------------------------------------------- */

/* What a circumstance is: what differs from the scenario. */
static char *circumstance_text(const struct scenario *s, size_t c)
{
    char text[1000] = "", value[64];
    struct scenario_values values;
    const size_t points = s->axis[s->axes - 1].count;
    scenario_case_values(s, c * points, &values);
    for (int a = s->axes - 2; a >= 0; a--) {
        const struct scenario_axis *const axis = &s->axis[a];
        const size_t i = c % axis->count;
        c /= axis->count;
        for (int k = 0; k < axis->paths && strlen(text) + 200 < sizeof text; k++) {
            const size_t size = axis->integer[k] ? sizeof(int) : sizeof(double);
            if (memcmp((const char *)&values + axis->offset[k],
                       (const char *)&s->base + axis->offset[k], size) == 0)
                continue;
            scenario_axis_text(axis, i, k, value, sizeof value);
            words_add(text, sizeof text, "%s%s = %s", text[0] ? ", " : "", axis->path[k], value);
        }
    }
    return strdup(text[0] ? text : "as it is");
}

/* ---- what is planned, and how long that will be --------------------------------------------- */

/* Once all generations are through: the best, to choose and to report. */
static double cases_at_end(const struct search *search)
{
    const struct scenario *const s = search->scenario;
    double elsewhere = 0;
    for (int e = 0; e < ELSEWHERE_MOST; e++)
        elsewhere += elsewhere_exists(s, (enum elsewhere)e) ? 1 : 0;
    const double confirmed = 1 + 2.0 * s->search.stages * (s->search.restarts + 1);
    const double starts =
        (double)trials_count(s, TRIALS_CHOICE) + (double)trials_count(s, TRIALS_FRESH);
    return confirmed * (double)search->trials.circumstances * starts +
           elsewhere * COMPARED * (double)elsewhere_starts(s);
}

static void plan_stages(struct search *search)
{
    const struct scenario *const s = search->scenario;
    double behind = cases_at_end(search);
    for (int r = 0; r <= s->search.restarts; r++) {
        const int lambda = cma_default_lambda(search->space.n) << r;
        const double all = (double)s->search.candidates / lambda;
        for (int k = 0; k < s->search.stages; k++) {
            const double before = k > 0 ? round(scenario_search_until(s, k - 1) * all) : 0;
            const size_t generations =
                (size_t)fmax(1, round(scenario_search_until(s, k) * all) - before);
            search->stage[search->stages++] = (struct search_stage){
                r, k, lambda, generations,
                .cases = (double)generations * lambda * (double)search->trials.circumstances *
                         (double)s->search.grow[k]};
            search->generations += generations;
            search->candidates += generations * (size_t)lambda;
        }
    }
    for (int k = search->stages; k-- > 0; behind += search->stage[k].cases)
        search->stage[k].behind = behind;
}

/* Cases in hand, which were planned. */
static void outlook_begin(struct outlook *outlook, double cases)
{
    outlook->ahead = fmax(0, outlook->ahead - cases);
    outlook->now = cases;
    outlook->begun = clock_seconds();
}

/* They are done: so many were simulated; `apart` s were spent on something else. */
static void outlook_end(struct outlook *outlook, double simulated, double apart)
{
    const double taken = clock_seconds() - outlook->begun - apart;
    outlook->seconds = remembered * outlook->seconds + taken;
    outlook->cases = remembered * outlook->cases + simulated;
    outlook->now = 0;
}

double outlook_left(const struct outlook *outlook)
{
    if (!(outlook->cases > 0))
        return -1;
    const double each = outlook->seconds / outlook->cases;
    const double spent = outlook->now > 0 ? clock_seconds() - outlook->begun : 0;
    return outlook->ahead * each + fmax(0, outlook->now * each - spent);
}

/* ---- making --------------------------------------------------------------------------------- */

static bool make_record(struct search *search, const char *text)
{
    struct search_file *const f = &search->record;
    const struct scenario *const s = search->scenario;
    char date[40];
    time_t now = time(NULL);
    struct tm utc;
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    *f = (struct search_file){.chosen = -1,
                              .most_generations = (int64_t)search->generations,
                              .most_cases = scenario_search_cases(s),
                              .linear_limit = NAN};
    f->length[SEARCH_CANDIDATE] = search->candidates;
    f->length[SEARCH_PARAMETER] = f->length[SEARCH_OTHER] = (size_t)search->space.n;
    f->length[SEARCH_CIRCUMSTANCE] = search->trials.circumstances;
    f->length[SEARCH_KIND] = TRIAL_LABELS;
    f->length[SEARCH_GENERATION] = search->generations;
    f->length[SEARCH_CONFIRMED] = 1 + 2 * (size_t)search->stages;
    f->length[SEARCH_START] = s->search.confirm;
    f->length[SEARCH_VARIED] = (size_t)s->axis[s->axes - 1].paths;
    f->length[SEARCH_ELSEWHERE] = ELSEWHERE_MOST;
    f->title = strdup(s->title);
    f->scenario = strdup(text);
    f->first_scenario = strdup(s->text);
    f->revision = strdup(build_revision);
    f->date = strdup(date);
    const bool good = search_file_room(f) && f->title && f->scenario && f->first_scenario &&
                      f->revision && f->date;
    for (size_t i = 0; good && i < f->length[SEARCH_PARAMETER]; i++)
        f->parameter[i] = strdup(s->search.axis.path[i]);
    for (size_t i = 0; good && i < TRIAL_LABELS; i++)
        f->kind[i] = strdup(search_kinds[i]);
    for (size_t i = 0; good && i < f->length[SEARCH_VARIED]; i++)
        f->varied[i] = strdup(s->axis[s->axes - 1].path[i]);
    for (size_t c = 0; good && c < search->trials.circumstances; c++)
        f->circumstance[c] = circumstance_text(s, c);
    f->length[SEARCH_CANDIDATE] = f->length[SEARCH_GENERATION] = f->length[SEARCH_CONFIRMED] = 0;
    f->length[SEARCH_START] = f->length[SEARCH_ELSEWHERE] = 0;
    return good;
}

/* The generations that an earlier part left. */
static bool take_over(struct search *search, const struct search_file *from)
{
    struct search_file *const f = &search->record;
    const size_t c = from->length[SEARCH_CANDIDATE], g = from->length[SEARCH_GENERATION];
    if (c > search->candidates || g > search->generations ||
        from->length[SEARCH_PARAMETER] != (size_t)search->space.n ||
        from->length[SEARCH_CIRCUMSTANCE] != search->trials.circumstances ||
        from->length[SEARCH_KIND] != TRIAL_LABELS)
        return false;
    search_file_copy(f, from, SEARCH_CANDIDATE);
    search_file_copy(f, from, SEARCH_GENERATION);
    f->length[SEARCH_CANDIDATE] = c;
    f->length[SEARCH_GENERATION] = g;
    f->seconds = from->seconds;
    return true;
}

/* Points come from libraries and may differ between machines: all ranks take those of rank 0. */
static void share_points(struct search *search)
{
    const struct scenario *const s = search->scenario;
    const size_t paths = (size_t)s->axis[s->axes - 1].paths;
    for (int k = 0; k < TRIALS_STARTS; k++) {
        const uint64_t count = trials_count(s, (enum trials_starts)k);
        parallel_broadcast(search->parallel, search->trials.start[k],
                           count * paths * sizeof(double));
        parallel_broadcast(search->parallel, search->trials.weight[k], count * sizeof(int64_t));
    }
    for (int a = 0; a + 1 < s->axes; a++) {
        const struct scenario_axis *const axis = &s->axis[a];
        if (axis->value)
            parallel_broadcast(search->parallel, axis->value,
                               axis->count * (size_t)axis->paths * sizeof *axis->value);
    }
}

bool search_make(struct search *search, const struct scenario *scenario, const char *text,
                 const struct parallel *parallel, struct search_file *origin,
                 stance_message *message)
{
    *search = (struct search){.scenario = scenario, .parallel = parallel};
    bool good = trials_make(&search->trials, scenario, parallel);
    if (parallel_agree(parallel, good, message->text, sizeof message->text))
        share_points(search);
    else
        good = false;
    space_make(&search->space, scenario);
    plan_stages(search);
    if (good && parallel->rank == 0)
        good = make_record(search, text);
    if (!good)
        return no_memory(message);
    if (origin && parallel->rank == 0 && !take_over(search, origin))
        return complain(message, "the file is of a search with other numbers");
    return true;
}

void search_free(struct search *search)
{
    trials_free(&search->trials);
    search_file_free(&search->record);
}

/* ---- trying --------------------------------------------------------------------------------- */

/* What the other ranks are told: so many candidates, -1: it is over; which starts, or behind these
 * (TRIALS_STARTS + enum elsewhere) where else. */
struct order {
    int64_t candidates;
    uint64_t starts;
    int which;
};

static enum trials_end carry_out(struct search *search, const struct order *order, double *value,
                                 double *share, stance_message *message)
{
    const size_t candidates = (size_t)order->candidates;
    return order->which < TRIALS_STARTS
               ? trials_run(&search->trials, candidates, value, (enum trials_starts)order->which,
                            order->starts, message)
               : elsewhere_run(search->scenario, &search->trials,
                               (enum elsewhere)(order->which - TRIALS_STARTS), candidates, value,
                               share, message);
}

/* Rank 0: value[candidates][paths] are tried. */
static enum trials_end try(struct search *search, struct order order, double *value, double *share,
                           stance_message *message)
{
    const size_t size = (size_t)order.candidates * (size_t)search->space.n * sizeof *value;
    parallel_broadcast(search->parallel, &order, sizeof order);
    parallel_broadcast(search->parallel, value, size);
    return carry_out(search, &order, value, share, message);
}

/* The same of coordinates (NULL: values are known), from starts that are the scenario's. */
static enum trials_end try_all(struct search *search, size_t candidates, const double *coordinate,
                               double *value, enum trials_starts which, uint64_t starts,
                               stance_message *message)
{
    const size_t n = (size_t)search->space.n;
    const struct trials *const t = &search->trials;
    const double before = (double)t->cases, compiling = t->compiling;
    for (size_t i = 0; coordinate && i < candidates * n; i++)
        value[i] = space_value(&search->space, (int)(i % n), coordinate[i]);
    outlook_begin(&search->outlook, (double)candidates * (double)t->circumstances * (double)starts);
    const enum trials_end end =
        try(search, (struct order){(int64_t)candidates, starts, which}, value, NULL, message);
    outlook_end(&search->outlook, (double)t->cases - before, t->compiling - compiling);
    return end;
}

/* Other ranks: do as they are told until it is over. */
static enum trials_end follow(struct search *search, stance_message *message)
{
    enum trials_end end = TRIALS_DONE;
    double ignored[COMPARED];
    struct order order;
    for (;;) {
        parallel_broadcast(search->parallel, &order, sizeof order);
        if (order.candidates < 0)
            return end;
        const size_t size = (size_t)order.candidates * (size_t)search->space.n * sizeof(double);
        double *const value = malloc(size);
        if (!value)
            abort(); /* the others wait in the broadcast: MPI ends the job */
        parallel_broadcast(search->parallel, value, size);
        end = carry_out(search, &order, value, ignored, message);
        free(value);
    }
}

/* ---- scores --------------------------------------------------------------------------------- */

/* Scales, in the order in which they stand, up to which all directions recover, the least over the
 * other circumstances; ties are broken by the directions that go further. */
static int64_t nearest_score(const struct search *search, size_t candidate, uint64_t starts,
                             double *objective)
{
    const struct trials *const t = &search->trials;
    const struct scenario *const s = search->scenario;
    size_t stride = 1; /* so many circumstances lie between two scales */
    int k;
    const struct scenario_axis *const scale =
        scenario_axis_of(s, offsetof(struct scenario_values, offset_scale), &k);
    for (const struct scenario_axis *a = &s->axis[s->axes - 2]; a > scale; a--)
        stride *= a->count;
    const size_t circumstances = t->circumstances;
    const uint8_t *const label = &t->label[candidate * circumstances * starts];
    size_t nearest = scale->count;
    int64_t further = 0;
    for (size_t c = 0; c < circumstances; c++) {
        if (c / stride % scale->count != 0)
            continue;
        for (uint64_t i = 0; i < starts; i++) {
            size_t lead = 0;
            while (lead < scale->count && trials_recovered(label[(c + lead * stride) * starts + i]))
                lead++;
            nearest = lead < nearest ? lead : nearest;
            further += (int64_t)lead;
        }
    }
    *objective = nearest > 0 ? scenario_axis_value(scale, nearest - 1, 0) : 0;
    return ((int64_t)nearest << 40) + further;
}

/* Below all scores of candidates that are tried: by how much loops fall short in the circumstances
 * that make the candidate's score nothing, so that a search finds its way to those that are tried.
 * 0: none does. */
static int64_t refusal(const struct search *search, size_t candidate)
{
    const struct trials *const t = &search->trials;
    size_t refused = 0;
    double sum = 0;
    for (size_t c = 0; c < t->circumstances; c++) {
        const struct trials_loop *const loop = &t->loop[candidate * t->circumstances + c];
        refused += !loop->tried;
        sum += loop->tried ? 0 : loop->short_of;
    }
    const bool all = search->scenario->search.aim == AIM_NEAREST || search->scenario->search.worst;
    return refused > 0 && (all || refused == t->circumstances)
               ? INT64_MIN / 2 - llround(TRIALS_WORTH * sum)
               : 0;
}

static int64_t score_of(const struct search *search, size_t candidate, const double *coordinate,
                        enum trials_starts which, uint64_t starts, double *objective)
{
    const struct scenario_search *const s = &search->scenario->search;
    const struct trials *const t = &search->trials;
    const size_t circumstances = t->circumstances;
    int64_t whole = 0, score = s->worst ? INT64_MAX : 0;
    const int64_t refused = refusal(search, candidate);
    *objective = 0;
    if (refused)
        return refused;
    if (s->aim == AIM_NEAREST)
        return nearest_score(search, candidate, starts, objective);
    for (uint64_t i = 0; i < starts; i++)
        whole += t->weight[which][i];
    for (size_t c = 0; c < circumstances; c++) {
        const int64_t worth = t->worth[candidate * circumstances + c];
        if (!s->worst)
            score += worth / (int64_t)circumstances;
        else if (worth < score)
            score = worth;
    }
    const double one = TRIALS_WORTH * (double)whole;
    const double gain = s->gain_price * space_gain(&search->space, coordinate);
    score -= llround(fmin(gain, TRIALS_MOST_WORTH) * one);
    *objective = (double)score / one;
    return score;
}

static void count_labels(const struct search *search, size_t candidate, uint64_t starts,
                         int64_t *count, double *critical)
{
    const struct trials *const t = &search->trials;
    for (size_t c = 0; c < t->circumstances; c++) {
        const size_t pair = candidate * t->circumstances + c;
        for (uint64_t i = 0; i < starts; i++)
            count[c * TRIAL_LABELS + t->label[pair * starts + i]]++;
        critical[c] = t->loop[pair].critical;
    }
}

/* ---- generations ---------------------------------------------------------------------------- */

/* Where the search is. */
struct course {
    struct cma *cma;
    const struct search_stage *stage;
    size_t known;      /* generations that the record had */
    size_t generation; /* of all */
    size_t first;      /* candidate of this generation */
    int64_t best;      /* candidate of this stage; -1: none */
    size_t stale;      /* generations without a better one */
};

static enum trials_end try_generation(struct search *search, struct course *at,
                                      stance_message *message)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n, lambda = (size_t)at->stage->lambda;
    const uint64_t starts = search->scenario->search.grow[at->stage->stage];
    const size_t kinds = search->trials.circumstances * TRIAL_LABELS;
    double *const x = &f->coordinate[at->first * n];
    cma_ask(at->cma, x);
    if (cma_generation(at->cma) == 0) /* what it begins with is a candidate, too */
        memcpy(x, cma_mean(at->cma), n * sizeof *x);
    const enum trials_end end =
        try_all(search, lambda, x, &f->value[at->first * n], TRIALS_SEARCH, starts, message);
    if (end != TRIALS_DONE)
        return end;
    for (size_t i = 0; i < lambda; i++) {
        const size_t c = at->first + i;
        f->of_generation[c] = (int64_t)at->generation;
        f->score[c] = score_of(search, i, &x[i * n], TRIALS_SEARCH, starts, &f->objective[c]);
        count_labels(search, i, starts, &f->count[c * kinds],
                     &f->critical_sample_time[c * search->trials.circumstances]);
    }
    f->length[SEARCH_CANDIDATE] = at->first + lambda;
    f->length[SEARCH_GENERATION] = at->generation + 1;
    return end;
}

/* Notes what the generation led to. */
static void note_generation(struct search *search, struct course *at)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n, g = at->generation;
    const int64_t end = (int64_t)at->first + at->stage->lambda;
    bool better = false;
    for (int64_t c = (int64_t)at->first; c < end; c++) {
        if (at->best >= 0 && f->score[c] <= f->score[at->best])
            continue;
        at->best = c;
        better = true;
    }
    at->stale = better ? 0 : at->stale + 1;
    f->stage[g] = at->stage->stage;
    f->restart[g] = at->stage->restart;
    f->starts[g] = (int64_t)search->scenario->search.grow[at->stage->stage];
    f->candidates[g] = end;
    f->best[g] = at->best;
    f->step[g] = cma_step(at->cma);
    memcpy(&f->mean[g * n], cma_mean(at->cma), n * sizeof *f->mean);
    memcpy(&f->covariance[g * n * n], cma_covariance(at->cma), n * n * sizeof *f->covariance);
}

static bool is_over(const struct search *search, const struct course *at, const char **why)
{
    const bool last = at->stage->stage + 1 == search->scenario->search.stages;
    /* Without a better candidate for so long there is no use in more. */
    const bool stale = last && at->stale >= 10 + (size_t)(30 * search->space.n / at->stage->lambda);
    if (cma_stop(at->cma) != CMA_GOES_ON)
        *why = cma_stop_words[cma_stop(at->cma)];
    else if (stale)
        *why = "the best candidate stayed the same";
    return stale || cma_stop(at->cma) != CMA_GOES_ON;
}

/* Adds to what is compared at the end: a candidate, or (-1) a mean. */
static void confirm_later(struct search *search, int64_t candidate, int64_t generation,
                          const double *coordinate)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n, k = f->length[SEARCH_CONFIRMED];
    for (size_t i = 0; i < k; i++)
        if (candidate >= 0 && f->confirmed_candidate[i] == candidate)
            return;
    f->confirmed_candidate[k] = candidate;
    f->confirmed_generation[k] = generation;
    f->confirmed_training[k] = candidate >= 0 ? f->objective[candidate] : NAN;
    /* Coordinates for now; values once it is tried. */
    memcpy(&f->confirmed_value[k * n], coordinate, n * sizeof *coordinate);
    f->length[SEARCH_CONFIRMED]++;
}

/* A record of what is known so far; what is to be compared is not, before it has been. */
static bool keep(struct search *search, bool last, stance_message *message)
{
    struct search_file *const f = &search->record;
    const size_t confirmed = f->length[SEARCH_CONFIRMED];
    if (!f->finished)
        f->length[SEARCH_CONFIRMED] = 0;
    const bool good = !search->save || search->save(search->context, last, message);
    f->length[SEARCH_CONFIRMED] = confirmed;
    return good;
}

static enum trials_end run_stage(struct search *search, struct course *at, const char **why,
                                 stance_message *message)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n;
    const size_t most = at->stage->generations;
    bool over = false;
    at->best = -1;
    at->stale = 0;
    *why = "as many candidates as were asked for";
    for (size_t i = 0; i < most && !over; i++) {
        search->outlook.ahead =
            at->stage->behind + at->stage->cases * (double)(most - i) / (double)most;
        if (at->generation >= at->known) {
            const enum trials_end end = try_generation(search, at, message);
            if (end != TRIALS_DONE)
                return end;
        }
        if (!cma_tell(at->cma, &f->coordinate[at->first * n], &f->score[at->first])) {
            complain(message, "a generation is out of the numbers that can be");
            return TRIALS_BROKEN;
        }
        note_generation(search, at);
        at->first += (size_t)at->stage->lambda;
        at->generation++;
        if (at->generation > at->known && !keep(search, false, message))
            return TRIALS_BROKEN;
        over = is_over(search, at, why);
    }
    const int64_t last = (int64_t)at->generation - 1;
    confirm_later(search, at->best, last, &f->coordinate[(size_t)at->best * n]);
    confirm_later(search, -1, last, cma_mean(at->cma));
    return TRIALS_DONE;
}

/* From the best so far, of which there is none at first. */
static bool begin(const struct search *search, struct course *at, stance_message *message)
{
    const struct space *const space = &search->space;
    const double *const begin =
        at->best < 0 ? space->first
                     : &search->record.coordinate[(size_t)at->best * (size_t)space->n];
    cma_free(at->cma);
    at->cma =
        cma_make(space->n, at->stage->lambda, begin, search->scenario->search.step, space->low,
                 space->high, search->scenario->seed, (uint64_t)at->stage->restart);
    return at->cma || no_memory(message);
}

/* ---- the choice, and fresh starts ------------------------------------------------------------ */

/* The largest of several shares is too large as the share of what has it: one is chosen by starts
 * of its own, and what all of them recover is told of others. */
static enum trials_end try_confirmed(struct search *search, const double *coordinate,
                                     enum trials_starts which, stance_message *message)
{
    struct search_file *const f = &search->record;
    const bool fresh = which == TRIALS_FRESH;
    int64_t *const score = fresh ? f->confirmed_score : f->choice_score;
    double *const objective = fresh ? f->confirmed_objective : f->choice_objective;
    const uint64_t starts = trials_count(search->scenario, which);
    const size_t k = f->length[SEARCH_CONFIRMED], n = (size_t)search->space.n;
    const enum trials_end end =
        try_all(search, k, coordinate, f->confirmed_value, which, starts, message);
    for (size_t i = 0; end == TRIALS_DONE && i < k; i++)
        score[i] = score_of(search, i, &coordinate[i * n], which, starts, &objective[i]);
    return end;
}

static void note_fresh(struct search *search)
{
    struct search_file *const f = &search->record;
    const uint64_t starts = trials_count(search->scenario, TRIALS_FRESH);
    const size_t k = f->length[SEARCH_CONFIRMED], circumstances = search->trials.circumstances;
    for (size_t i = 0; i < k; i++) {
        count_labels(search, i, starts, &f->confirmed_count[i * circumstances * TRIAL_LABELS],
                     &f->confirmed_critical[i * circumstances]);
    }
    for (size_t i = 0; i < k * circumstances; i++)
        f->confirmed_allowed[i] = NAN;
    f->length[SEARCH_START] = starts;
    memcpy(f->confirmed_outcome, search->trials.label, k * circumstances * starts);
    memcpy(f->start_value, search->trials.start[TRIALS_FRESH],
           starts * f->length[SEARCH_VARIED] * sizeof *f->start_value);
}

static enum trials_end confirm(struct search *search, stance_message *message)
{
    struct search_file *const f = &search->record;
    const size_t size = f->length[SEARCH_CONFIRMED] * (size_t)search->space.n * sizeof(double);
    double *const coordinate = malloc(size);
    search->confirming = true;
    search->outlook.ahead = cases_at_end(search);
    if (!coordinate) {
        no_memory(message);
        return TRIALS_BROKEN;
    }
    memcpy(coordinate, f->confirmed_value, size);
    enum trials_end end = try_confirmed(search, coordinate, TRIALS_CHOICE, message);
    if (end == TRIALS_DONE) {
        f->chosen = 0;
        for (size_t i = 1; i < f->length[SEARCH_CONFIRMED]; i++)
            if (f->choice_score[i] > f->choice_score[f->chosen])
                f->chosen = (int64_t)i;
        end = try_confirmed(search, coordinate, TRIALS_FRESH, message);
    }
    if (end == TRIALS_DONE)
        note_fresh(search);
    free(coordinate);
    return end;
}

/* Of the first and of the chosen one. */
static void find_allowed(struct search *search)
{
    struct search_file *const f = &search->record;
    const uint64_t confirm = search->scenario->search.confirm;
    const uint64_t starts = confirm < MOST_ALLOWED ? confirm : MOST_ALLOWED;
    const size_t n = (size_t)search->space.n, circumstances = search->trials.circumstances;
    const size_t which[COMPARED] = {0, (size_t)f->chosen};
    for (int i = 0; i < COMPARED; i++)
        linear_limit_shares(&search->trials, &f->confirmed_value[which[i] * n], starts,
                            &f->confirmed_allowed[which[i] * circumstances]);
    size_t least;
    f->linear_limit = linear_limit_overall(search->scenario->search.worst, circumstances,
                                           &f->confirmed_allowed[which[1] * circumstances], &least);
}

static enum trials_end try_elsewhere(struct search *search, stance_message *message)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n;
    const double cases = (double)(COMPARED * elsewhere_starts(search->scenario));
    enum trials_end end = TRIALS_DONE;
    double value[COMPARED * SCENARIO_MAX_PATHS], share[COMPARED] = {0};
    memcpy(value, f->confirmed_value, n * sizeof *value);
    memcpy(value + n, &f->confirmed_value[(size_t)f->chosen * n], n * sizeof *value);
    for (int e = 0; e < ELSEWHERE_MOST && end == TRIALS_DONE; e++) {
        if (!elsewhere_exists(search->scenario, (enum elsewhere)e))
            continue;
        outlook_begin(&search->outlook, cases);
        end = try(search, (struct order){COMPARED, 0, TRIALS_STARTS + e}, value, share, message);
        const size_t k = f->length[SEARCH_ELSEWHERE];
        f->elsewhere[k] = end == TRIALS_DONE ? strdup(elsewhere_name((enum elsewhere)e)) : NULL;
        if (f->elsewhere[k]) {
            f->elsewhere_first[k] = share[0];
            f->elsewhere_chosen[k] = share[1];
            f->length[SEARCH_ELSEWHERE]++;
        }
    }
    return end;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static enum trials_end lead(struct search *search, stance_message *message)
{
    struct search_file *const f = &search->record;
    struct course at = {.known = f->length[SEARCH_GENERATION], .best = -1};
    const char *why = "";
    enum trials_end end = TRIALS_DONE;
    confirm_later(search, 0, -1, search->space.first);
    for (int k = 0; k < search->stages && end == TRIALS_DONE; k++) {
        at.stage = &search->stage[k];
        if (at.stage->stage > 0 || begin(search, &at, message))
            end = run_stage(search, &at, &why, message);
        else
            end = TRIALS_BROKEN;
    }
    cma_free(at.cma);
    f->confirmed_training[0] = f->length[SEARCH_CANDIDATE] > 0 ? f->objective[0] : NAN;
    if (end == TRIALS_DONE)
        end = confirm(search, message);
    if (end == TRIALS_DONE)
        end = try_elsewhere(search, message);
    if (end == TRIALS_DONE) {
        f->finished = 1;
        f->note = strdup(why);
        find_allowed(search);
    } else {
        f->length[SEARCH_CONFIRMED] = f->length[SEARCH_ELSEWHERE] = 0;
        f->chosen = -1;
    }
    if (end != TRIALS_BROKEN && f->length[SEARCH_GENERATION] > 0 && !keep(search, true, message))
        end = TRIALS_BROKEN;
    parallel_broadcast(search->parallel, &(struct order){-1, 0, 0}, sizeof(struct order));
    return end;
}

enum trials_end search_run(struct search *search, stance_message *message)
{
    return search->parallel->rank == 0 ? lead(search, message) : follow(search, message);
}
