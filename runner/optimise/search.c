/* search.c - stages and generations: every rank goes through all of them, in step. What follows
 * from libraries that may differ between machines, coordinates and whether a stage is over, is rank
 * 0's. */
#include "search.h"
#include "cma.h"

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

#define SAVE_INTERVAL 1.0             /* s */
static const double remembered = 0.6; /* of what was known, each time more is */

/* run->message becomes that of the first rank that failed. */
static bool agree(struct run *run, bool good)
{
    return parallel_agree(&run->parallel, good, run->message.text, sizeof run->message.text);
}

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
    const struct scenario *const s = search->run->scenario;
    double elsewhere = 0;
    for (int e = 0; e < ELSEWHERE_MOST; e++)
        elsewhere += elsewhere_name(s, e) ? 1 : 0;
    const double starts =
        (double)trials_count(s, TRIALS_CHOICE) + (double)trials_count(s, TRIALS_FRESH);
    return (1 + 2.0 * search->stages) * (double)search->trials.circumstances * starts +
           elsewhere * COMPARED * (double)elsewhere_starts(s);
}

static void plan_stages(struct search *search)
{
    const struct scenario *const s = search->run->scenario;
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
    double behind = cases_at_end(search);
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

/* s; negative: not known yet. */
static double outlook_left(const struct outlook *outlook)
{
    if (!(outlook->cases > 0))
        return -1;
    const double each = outlook->seconds / outlook->cases;
    return outlook->ahead * each +
           fmax(0, outlook->now * each - (clock_seconds() - outlook->begun));
}

/* ---- signs of life -------------------------------------------------------------------------- */

/* Rank 0, about every millisecond. */
static bool attend(void *context, double now)
{
    struct search *const search = context;
    struct run *const run = search->run;
    struct heartbeat *const h = &run->heartbeat;
    const struct search_file *const f = &search->record;
    const size_t g = f->length[SEARCH_GENERATION], candidates = f->length[SEARCH_CANDIDATE];
    const bool says = progress_due(&run->progress, now);
    if (now < h->due && !says)
        return false;
    if (search->confirming)
        snprintf(search->doing, sizeof search->doing, "fresh starts");
    else if (g == 0)
        snprintf(search->doing, sizeof search->doing, "first generation");
    else
        snprintf(search->doing, sizeof search->doing, "generation %zu of at most %zu, best %.4g",
                 g + 1, search->generations, f->objective[f->best[g - 1]]);
    h->doing = search->doing;
    h->left = outlook_left(&search->outlook);
    if (!heartbeat_beat(h, now, candidates, 0, &run->message))
        return !run_fail_io(run);
    char time[32] = "", left[64] = "";
    text_of_seconds(time, sizeof time, h->left);
    if (h->left >= 0)
        snprintf(left, sizeof left, "; at most about %s left", time);
    if (says)
        progress_say(&run->progress, "%s%s", search->doing, left);
    return false;
}

/* Rank 0, after each generation and at the end. */
static bool save(struct search *search, bool last)
{
    struct run *const run = search->run;
    const double now = clock_seconds();
    if (!last && now < search->save_at)
        return true;
    search->record.seconds = search->before + now - run->start;
    if (!search_file_write(&search->record, run->file, &run->message))
        return false;
    heartbeat_guard(&run->heartbeat, run->file);
    const double end = clock_seconds();
    search->save_at = end + fmax(SAVE_INTERVAL, 20 * (end - now)); /* 5 % of the time at most */
    return true;
}

/* ---- making --------------------------------------------------------------------------------- */

static char **words_of(const struct scenario_axis *axis)
{
    char **const word = calloc((size_t)axis->paths + 1, sizeof *word);
    for (int k = 0; word && k < axis->paths; k++)
        word[k] = strdup(axis->path[k]);
    return word;
}

static bool make_record(struct search *search, const char *text)
{
    struct search_file *const f = &search->record;
    const struct scenario *const s = search->run->scenario;
    const struct scenario_axis *const sample = &s->axis[s->axes - 1];
    const size_t n = (size_t)search->space.n, compared = 1 + 2 * (size_t)search->stages;
    char date[40];
    time_t now = time(NULL);
    struct tm utc;
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    *f = (struct search_file){.length = {[SEARCH_CANDIDATE] = search->candidates,
                                         [SEARCH_PARAMETER] = n,
                                         [SEARCH_OTHER] = n,
                                         [SEARCH_CIRCUMSTANCE] = search->trials.circumstances,
                                         [SEARCH_KIND] = TRIAL_LABELS,
                                         [SEARCH_GENERATION] = search->generations,
                                         [SEARCH_CONFIRMED] = compared,
                                         [SEARCH_START] = s->search.confirm,
                                         [SEARCH_VARIED] = (size_t)sample->paths,
                                         [SEARCH_ELSEWHERE] = ELSEWHERE_MOST},
                              .parameter = words_of(&s->search.axis),
                              .varied = words_of(sample),
                              .title = strdup(s->title),
                              .scenario = strdup(text),
                              .first_scenario = strdup(s->text),
                              .revision = strdup(build_revision),
                              .date = strdup(date),
                              .chosen = -1,
                              .most_generations = (int64_t)search->generations,
                              .most_cases = scenario_search_cases(s),
                              .linear_limit = NAN};
    search->compare = calloc(compared * n, sizeof *search->compare);
    const bool good = search_file_room(f) && f->parameter && f->varied && f->title && f->scenario &&
                      f->first_scenario && f->revision && f->date && search->compare;
    for (size_t i = 0; good && i < TRIAL_LABELS; i++)
        f->kind[i] = strdup(search_kinds[i]);
    for (size_t i = 0; good && i < f->length[SEARCH_CIRCUMSTANCE]; i++)
        f->circumstance[i] = circumstance_text(s, i);
    f->length[SEARCH_CANDIDATE] = f->length[SEARCH_GENERATION] = f->length[SEARCH_CONFIRMED] = 0;
    f->length[SEARCH_START] = f->length[SEARCH_ELSEWHERE] = 0;
    return good;
}

/* The generations that an earlier part left. */
static bool take_over(struct search *search, const struct search_file *from)
{
    static const enum search_dimension stays[] = {SEARCH_PARAMETER, SEARCH_CIRCUMSTANCE,
                                                  SEARCH_KIND};
    struct search_file *const f = &search->record;
    bool same = from->length[SEARCH_CANDIDATE] <= search->candidates &&
                from->length[SEARCH_GENERATION] <= search->generations;
    for (size_t i = 0; i < sizeof stays / sizeof *stays; i++)
        same = same && from->length[stays[i]] == f->length[stays[i]];
    if (same) {
        search_file_copy(f, from, SEARCH_CANDIDATE);
        search_file_copy(f, from, SEARCH_GENERATION);
    }
    search->before = from->seconds;
    return same;
}

/* What may differ between machines, and what only rank 0 has, all ranks take from it. */
static void share(struct search *search)
{
    const struct scenario *const s = search->run->scenario;
    const struct parallel *const parallel = &search->run->parallel;
    struct search_file *const f = &search->record;
    const size_t paths = (size_t)s->axis[s->axes - 1].paths;
    for (int k = 0; k < TRIALS_STARTS; k++) {
        const uint64_t count = trials_count(s, (enum trials_starts)k);
        parallel_broadcast(parallel, search->trials.start[k], count * paths * sizeof(double));
        parallel_broadcast(parallel, search->trials.weight[k], count * sizeof(int64_t));
    }
    for (int a = 0; a + 1 < s->axes; a++) {
        const struct scenario_axis *const axis = &s->axis[a];
        if (axis->value)
            parallel_broadcast(parallel, axis->value,
                               axis->count * (size_t)axis->paths * sizeof *axis->value);
    }
    parallel_broadcast(parallel, &search->space, sizeof search->space); /* of logarithms */
    search->space.search = &s->search;
    parallel_broadcast(parallel, f->length, sizeof f->length);
    const size_t known = f->length[SEARCH_CANDIDATE];
    parallel_broadcast(parallel, f->score, known * sizeof *f->score);
    parallel_broadcast(parallel, f->coordinate,
                       known * f->length[SEARCH_PARAMETER] * sizeof *f->coordinate);
}

bool search_make(struct search *search, struct run *run, const char *text,
                 const struct search_file *origin)
{
    *search = (struct search){.run = run};
    bool good = trials_make(&search->trials, run->scenario, &run->parallel);
    search->trials.quiet = run->options.quiet;
    search->trials.until = run->start + run->options.time_limit;
    search->trials.attend = attend;
    search->trials.context = search;
    space_make(&search->space, run->scenario);
    plan_stages(search);
    good = (good && make_record(search, text)) || no_memory(&run->message);
    if (good && origin && !take_over(search, origin))
        good = complain(&run->message, "the file is of a search with other numbers");
    good = agree(run, good);
    if (good)
        share(search);
    return good;
}

void search_free(struct search *search)
{
    trials_free(&search->trials);
    search_file_free(&search->record);
    free(search->compare);
}

/* ---- trying --------------------------------------------------------------------------------- */

/* Coordinates, which rank 0's become, and their values. */
static enum trials_end try(struct search *search, size_t candidates, double *coordinate,
                           double *value, enum trials_starts which, uint64_t starts)
{
    const size_t n = (size_t)search->space.n, size = candidates * n * sizeof *value;
    struct outlook *const outlook = &search->outlook;
    const struct trials *const t = &search->trials;
    const double before = (double)t->cases, compiling = t->compiling;
    parallel_broadcast(&search->run->parallel, coordinate, size);
    for (size_t i = 0; i < candidates * n; i++)
        value[i] = space_value(&search->space, (int)(i % n), coordinate[i]);
    parallel_broadcast(&search->run->parallel, value, size);
    outlook_begin(outlook, (double)candidates * (double)t->circumstances * (double)starts);
    const enum trials_end end =
        trials_run(&search->trials, candidates, value, which, starts, &search->run->message);
    const double taken = clock_seconds() - outlook->begun - (t->compiling - compiling);
    outlook->seconds = remembered * outlook->seconds + taken;
    outlook->cases = remembered * outlook->cases + (double)t->cases - before;
    outlook->now = 0;
    return end;
}

/* ---- scores --------------------------------------------------------------------------------- */

/* Scales, in the order in which they stand, up to which all directions recover, the least over the
 * other circumstances; ties are broken by the directions that go further. */
static int64_t nearest_score(const struct search *search, size_t candidate, uint64_t starts,
                             double *objective)
{
    const struct trials *const t = &search->trials;
    const struct scenario *const s = search->run->scenario;
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
    const bool all =
        search->run->scenario->search.aim == AIM_NEAREST || search->run->scenario->search.worst;
    return refused > 0 && (all || refused == t->circumstances)
               ? INT64_MIN / 2 - llround(TRIALS_WORTH * sum)
               : 0;
}

static int64_t score_of(const struct search *search, size_t candidate, const double *coordinate,
                        enum trials_starts which, uint64_t starts, double *objective)
{
    const struct scenario_search *const s = &search->run->scenario->search;
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
    const char *why;   /* the last stage is over */
};

static enum trials_end try_generation(struct search *search, const struct course *at)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n, lambda = (size_t)at->stage->lambda;
    const uint64_t starts = search->run->scenario->search.grow[at->stage->stage];
    const size_t kinds = search->trials.circumstances * TRIAL_LABELS;
    double *const x = &f->coordinate[at->first * n];
    cma_ask(at->cma, x);
    if (at->cma->generation == 0) /* what it begins with is a candidate, too */
        memcpy(x, at->cma->mean, n * sizeof *x);
    const enum trials_end end =
        try(search, lambda, x, &f->value[at->first * n], TRIALS_SEARCH, starts);
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

/* Notes what the generation led to, and goes on to the next. */
static void note_generation(struct search *search, struct course *at)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n, g = at->generation;
    const int64_t before = at->best, end = (int64_t)at->first + at->stage->lambda;
    for (int64_t c = (int64_t)at->first; c < end; c++)
        if (at->best < 0 || f->score[c] > f->score[at->best])
            at->best = c;
    at->stale = at->best != before ? 0 : at->stale + 1;
    at->first = (size_t)end;
    at->generation++;
    if (search->run->parallel.rank != 0)
        return; /* the record is rank 0's: others need no memory for it */
    f->stage[g] = at->stage->stage;
    f->restart[g] = at->stage->restart;
    f->starts[g] = (int64_t)search->run->scenario->search.grow[at->stage->stage];
    f->candidates[g] = end;
    f->best[g] = at->best;
    f->step[g] = at->cma->step;
    memcpy(&f->mean[g * n], at->cma->mean, n * sizeof *f->mean);
    memcpy(&f->covariance[g * n * n], at->cma->covariance, n * n * sizeof *f->covariance);
}

static bool is_over(const struct search *search, struct course *at)
{
    const bool last = at->stage->stage + 1 == search->run->scenario->search.stages;
    const enum cma_stop stop = cma_stop(at->cma);
    /* Without a better candidate for so long there is no use in more. */
    const bool stale = last && at->stage->lambda > 0 &&
                       at->stale >= 10 + (size_t)(30 * search->space.n / at->stage->lambda);
    if (stop != CMA_GOES_ON)
        at->why = cma_stop_words[stop];
    else if (stale)
        at->why = "the best candidate stayed the same";
    bool over = stale || stop != CMA_GOES_ON;
    parallel_broadcast(&search->run->parallel, &over, sizeof over);
    return over;
}

/* Adds to what is compared at the end: a candidate, or (-1) a mean. */
static void compare_later(struct search *search, int64_t candidate, int64_t generation,
                          const double *coordinate)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n, k = search->compared;
    for (size_t i = 0; i < k; i++)
        if (candidate >= 0 && f->confirmed_candidate[i] == candidate)
            return;
    f->confirmed_candidate[k] = candidate;
    f->confirmed_generation[k] = generation;
    memcpy(&search->compare[k * n], coordinate, n * sizeof *coordinate);
    search->compared++;
}

static enum trials_end run_stage(struct search *search, struct course *at)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n, most = at->stage->generations;
    bool over = false;
    at->best = -1;
    at->stale = 0;
    at->why = "as many candidates as were asked for";
    for (size_t i = 0; i < most && !over; i++) {
        const bool new = at->generation >= at->known;
        search->outlook.ahead =
            at->stage->behind + at->stage->cases * (double)(most - i) / (double)most;
        const enum trials_end end = new ? try_generation(search, at) : TRIALS_DONE;
        if (end != TRIALS_DONE)
            return end;
        bool good =
            cma_tell(at->cma, &f->coordinate[at->first * n], &f->score[at->first]) ||
            complain(&search->run->message, "a generation is out of the numbers that can be");
        note_generation(search, at);
        if (good && new && search->run->parallel.rank == 0)
            good = save(search, false);
        if (!agree(search->run, good))
            return TRIALS_BROKEN;
        over = is_over(search, at);
    }
    const int64_t last = (int64_t)at->generation - 1;
    compare_later(search, at->best, last, &f->coordinate[(size_t)at->best * n]);
    compare_later(search, -1, last, at->cma->mean);
    return TRIALS_DONE;
}

/* Each beginning but the first begins with the best of the one before. */
static enum trials_end run_stages(struct search *search, struct course *at)
{
    const struct space *const space = &search->space;
    struct cma_start start = {space->n,
                              0,
                              space->first,
                              space->low,
                              space->high,
                              search->run->scenario->search.step,
                              .seed = search->run->scenario->seed};
    enum trials_end end = TRIALS_DONE;
    for (int k = 0; k < search->stages && end == TRIALS_DONE; k++) {
        at->stage = &search->stage[k];
        if (!at->cma || at->stage->stage == 0) {
            if (k > 0)
                start.mean = &search->record.coordinate[(size_t)at->best * (size_t)space->n];
            start.lambda = at->stage->lambda;
            start.restart = (uint64_t)at->stage->restart;
            cma_free(at->cma);
            at->cma = cma_make(&start);
            const bool good = at->cma || no_memory(&search->run->message);
            if (!agree(search->run, good) || !good)
                return TRIALS_BROKEN;
        }
        end = run_stage(search, at);
    }
    return end;
}

/* ---- the choice, and fresh starts ------------------------------------------------------------ */

/* The largest of several shares is too large as the share of what has it: one is chosen by starts
 * of its own, and what all of them recover is told of others. */
static enum trials_end confirm(struct search *search)
{
    struct search_file *const f = &search->record;
    const struct {
        enum trials_starts which;
        int64_t *score;
        double *objective;
    } by[] = {{TRIALS_CHOICE, f->choice_score, f->choice_objective},
              {TRIALS_FRESH, f->confirmed_score, f->confirmed_objective}};
    const size_t n = (size_t)search->space.n, circumstances = search->trials.circumstances;
    uint64_t starts = 0;
    search->confirming = true;
    search->outlook.ahead = cases_at_end(search);
    for (int b = 0; b < 2; b++) {
        starts = trials_count(search->run->scenario, by[b].which);
        const enum trials_end end =
            try(search, search->compared, search->compare, f->confirmed_value, by[b].which, starts);
        if (end != TRIALS_DONE)
            return end;
        for (size_t i = 0; i < search->compared; i++)
            by[b].score[i] = score_of(search, i, &search->compare[i * n], by[b].which, starts,
                                      &by[b].objective[i]);
    }
    f->chosen = 0;
    for (size_t i = 0; i < search->compared; i++) {
        const int64_t candidate = f->confirmed_candidate[i];
        if (f->choice_score[i] > f->choice_score[f->chosen])
            f->chosen = (int64_t)i;
        f->confirmed_training[i] = candidate >= 0 ? f->objective[candidate] : NAN;
        count_labels(search, i, starts, &f->confirmed_count[i * circumstances * TRIAL_LABELS],
                     &f->confirmed_critical[i * circumstances]);
    }
    for (size_t i = 0; i < search->compared * circumstances; i++)
        f->confirmed_allowed[i] = NAN;
    memcpy(f->confirmed_outcome, search->trials.label, search->compared * circumstances * starts);
    memcpy(f->start_value, search->trials.start[TRIALS_FRESH],
           starts * f->length[SEARCH_VARIED] * sizeof *f->start_value);
    return TRIALS_DONE;
}

/* The first and the chosen one. */
static enum trials_end try_elsewhere(struct search *search)
{
    struct search_file *const f = &search->record;
    const size_t n = (size_t)search->space.n;
    size_t *const places = &f->length[SEARCH_ELSEWHERE];
    enum trials_end end = TRIALS_DONE;
    double value[COMPARED * SCENARIO_MAX_PATHS], share[COMPARED] = {0};
    memcpy(value, f->confirmed_value, n * sizeof *value);
    memcpy(value + n, &f->confirmed_value[(size_t)f->chosen * n], n * sizeof *value);
    for (int e = 0; e < ELSEWHERE_MOST && end == TRIALS_DONE; e++) {
        const char *const name = elsewhere_name(search->run->scenario, e);
        if (!name)
            continue;
        outlook_begin(&search->outlook,
                      (double)(COMPARED * elsewhere_starts(search->run->scenario)));
        end = elsewhere_run(&search->trials, e, COMPARED, value, share, &search->run->message);
        f->elsewhere[*places] = strdup(name);
        f->elsewhere_first[*places] = share[0];
        f->elsewhere_chosen[*places] = share[1];
        *places += f->elsewhere[*places] != NULL;
    }
    while (end != TRIALS_DONE && *places > 0) { /* they are not told of */
        free(f->elsewhere[--*places]);
        f->elsewhere[*places] = NULL;
    }
    return end;
}

double search_limit_of(const struct search_file *f, bool worst, size_t k, const char **where)
{
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE];
    const double *const share = &f->confirmed_allowed[k * circumstances];
    double sum = 0, least = NAN;
    *where = NULL;
    for (size_t c = 0; c < circumstances; c++) {
        sum += share[c];
        if (worst && circumstances > 1 && !isnan(share[c]) && !(share[c] >= least)) {
            least = share[c];
            *where = f->circumstance[c];
        }
    }
    return worst && circumstances > 1 ? least : sum / (double)circumstances;
}

/* Rank 0: what linear theory allows the first and the chosen one, and that all is done. */
static void finish(struct search *search, const char *why)
{
    struct search_file *const f = &search->record;
    const uint64_t confirm = search->run->scenario->search.confirm;
    const uint64_t starts = confirm < MOST_ALLOWED ? confirm : MOST_ALLOWED;
    const size_t n = (size_t)search->space.n, circumstances = search->trials.circumstances;
    const size_t which[COMPARED] = {0, (size_t)f->chosen};
    const char *where;
    for (int i = 0; i < COMPARED; i++)
        linear_limit_shares(&search->trials, &f->confirmed_value[which[i] * n], starts,
                            &f->confirmed_allowed[which[i] * circumstances]);
    f->linear_limit = search_limit_of(f, search->run->scenario->search.worst, which[1], &where);
    f->length[SEARCH_CONFIRMED] = search->compared;
    f->length[SEARCH_START] = confirm;
    f->finished = 1;
    f->note = strdup(why);
}

/* ---- the whole ------------------------------------------------------------------------------ */

enum trials_end search_run(struct search *search)
{
    struct search_file *const f = &search->record;
    struct course at = {.known = f->length[SEARCH_GENERATION], .best = -1, .why = ""};
    compare_later(search, 0, -1, search->space.first);
    enum trials_end end = run_stages(search, &at);
    cma_free(at.cma);
    if (end == TRIALS_DONE)
        end = confirm(search);
    if (end == TRIALS_DONE)
        end = try_elsewhere(search);
    if (search->run->parallel.rank != 0)
        return end;
    if (end == TRIALS_DONE)
        finish(search, at.why);
    else
        f->chosen = -1;
    if (end != TRIALS_BROKEN && f->length[SEARCH_GENERATION] > 0 && !save(search, true))
        end = TRIALS_BROKEN;
    return end;
}
