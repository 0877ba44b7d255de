/* search_study.c - see search_study.h. */
#include "search_study.h"

#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/optimise/search.h"
#include "runner/plan/allowed.h"
#include "runner/scenario/schema.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- opening ------------------------------------------------------------------------------ */

bool search_study_open(struct search_study *study, const char *file, stance_message *message)
{
    *study = (struct search_study){.file = file};
    struct search_file *const f = &study->f;
    sandbox_limit(true);
    const bool good = search_file_read(f, file, message);
    sandbox_limit(false);
    if (!good)
        return false;
    /* Labels are numbers in the file, and words. */
    bool same = f->length[SEARCH_KIND] == TRIAL_LABELS;
    for (size_t i = 0; same && i < TRIAL_LABELS; i++)
        same = strcmp(f->kind[i], search_kinds[i]) == 0;
    if (!same) {
        search_study_close(study);
        return complain(message, "%.150s: has other outcomes than this version knows", file);
    }
    results_stem(file, study->name);
    study->done = f->finished && f->chosen >= 0 && f->length[SEARCH_START] > 0;
    study->first = f->first_scenario ? scenario_new(file, f->first_scenario, NULL, 0, NULL) : NULL;
    if (study->first && study->done) {
        char *const text = best_text(f);
        study->best = text ? scenario_new(file, text, NULL, 0, NULL) : NULL;
        free(text);
    }
    study->glued = study->first && allowed_glued_in(study->first);
    study->plain =
        !study->first || !study->first->search.given || scenario_search_plain(study->first);
    return true;
}

void search_study_close(struct search_study *study)
{
    scenario_drop(study->first);
    scenario_drop(study->best);
    study->first = study->best = NULL;
    search_file_free(&study->f);
}

/* ---- shares ------------------------------------------------------------------------------- */

static bool counts_worst(const struct search_study *study)
{
    return study->first && study->first->search.worst && study->f.length[SEARCH_CIRCUMSTANCE] > 1;
}

size_t search_worst(const struct search_study *study, size_t k)
{
    const size_t circumstances = study->f.length[SEARCH_CIRCUMSTANCE];
    size_t worst = 0;
    if (!counts_worst(study))
        return circumstances > 1 ? SEARCH_OVERALL : 0;
    for (size_t c = 1; c < circumstances; c++)
        if (search_share(study, k, c).share < search_share(study, k, worst).share)
            worst = c;
    return worst;
}

void search_circumstances(const struct search_study *study, size_t circumstance, size_t *from,
                          size_t *to)
{
    const bool all = circumstance == SEARCH_OVERALL;
    *from = all ? 0 : circumstance;
    *to = all ? study->f.length[SEARCH_CIRCUMSTANCE] : circumstance + 1;
}

struct search_share search_share(const struct search_study *study, size_t k, size_t circumstance)
{
    struct interval_draws draws = {0};
    size_t from, to;
    if (circumstance == SEARCH_OVERALL)
        circumstance = search_worst(study, k);
    search_circumstances(study, circumstance, &from, &to);
    for (size_t i = 0; i < study->f.length[SEARCH_START]; i++) {
        double recovered = 0;
        for (size_t c = from; c < to; c++)
            recovered += search_recovers(study, k, c, i);
        interval_add(&draws, recovered, (double)(to - from));
    }
    return (struct search_share){draws.k / draws.m, interval_of(&draws, 0.95)};
}

struct search_gain search_gain(const struct search_study *study, size_t circumstance)
{
    struct search_gain gain = {0};
    const size_t chosen = (size_t)study->f.chosen, n = study->f.length[SEARCH_START];
    double sum = 0, squares = 0;
    size_t from, to;
    search_circumstances(study, circumstance, &from, &to);
    for (size_t i = 0; i < n; i++) {
        int difference = 0;
        for (size_t c = from; c < to; c++) {
            const bool before = search_recovers(study, 0, c, i),
                       after = search_recovers(study, chosen, c, i);
            gain.won += after && !before;
            gain.lost += before && !after;
            difference += after - before;
        }
        const double d = difference / (double)(to - from);
        sum += d;
        squares += d * d;
    }
    const double pairs = (double)n + 2, at = sum / pairs,
                 sd = sqrt((squares + 1 - sum * at) / (pairs * pairs)),
                 half = statistics_deviations(0.95) * sd;
    gain.share = sum / (double)n;
    gain.interval = (struct interval){fmax(-1, at - half), fmin(1, at + half)};
    return gain;
}

double search_limit(const struct search_study *study, size_t k, const char **where)
{
    const char *ignored;
    return search_limit_of(&study->f, counts_worst(study), k, where ? where : &ignored);
}

bool search_chosen_apart(const struct search_study *study)
{
    return study->done && !isnan(study->f.choice_objective[study->f.chosen]);
}

/* ---- what linear theory allows ------------------------------------------------------------ */

/* Whether the scenario's last axis has what the file's starts are over. */
static bool has_starts(const struct scenario *s, const struct search_file *f)
{
    const struct scenario_axis *const axis = &s->axis[s->axes - 1];
    bool same = s->axes > 0 && s->sample.given && axis->value &&
                (size_t)axis->paths == f->length[SEARCH_VARIED];
    for (int k = 0; same && k < axis->paths; k++)
        same = strcmp(axis->path[k], f->varied[k]) == 0;
    return same;
}

bool search_allowed(const struct search_study *study, double *allowed)
{
    const struct search_file *const f = &study->f;
    const size_t starts = f->length[SEARCH_START];
    size_t from, to;
    if (!study->best || !has_starts(study->best, f))
        return false;
    search_circumstances(study, search_worst(study, (size_t)f->chosen), &from, &to);
    /* What it points to stays that of `best`; the points are the file's. */
    struct scenario *const fresh = malloc(sizeof *fresh);
    bool good = fresh != NULL;
    if (good) {
        *fresh = *study->best;
        fresh->axis[fresh->axes - 1].value = f->start_value;
        fresh->axis[fresh->axes - 1].count = starts;
    }
    memset(allowed, 0, starts * sizeof *allowed);
    for (size_t c = from; good && c < to; c++)
        good = !isnan(linear_limit_add(fresh, c, allowed));
    for (size_t i = 0; good && i < starts; i++)
        allowed[i] /= (double)(to - from);
    free(fresh);
    return good;
}

/* ---- words -------------------------------------------------------------------------------- */

void search_name(const struct search_study *study, size_t k, char *text, size_t size)
{
    const struct search_file *const f = &study->f;
    const int64_t g = f->confirmed_generation[k];
    if (g < 0) {
        snprintf(text, size, "first candidate");
        return;
    }
    snprintf(text, size, "%s stage %lld", f->confirmed_candidate[k] < 0 ? "mean after" : "best of",
             (long long)f->stage[g] + 1);
    if (f->restart[f->length[SEARCH_GENERATION] - 1] > 0)
        add_text(text, size, " of beginning %lld", (long long)f->restart[g] + 1);
}

void search_aim(const struct search_study *study, char *text, size_t size)
{
    if (!study->first || !study->first->search.given) {
        snprintf(text, size, "what its scenario says, which this version does not read");
        return;
    }
    const struct scenario_search *const s = &study->first->search;
    const size_t circumstances = study->f.length[SEARCH_CIRCUMSTANCE];
    FILE *const to = fmemopen(text, size, "w");
    if (!to)
        return;
    const char *const how = study->first->base.walk_steps > 0 ? "walk" : "are stabilised";
    if (s->aim == AIM_SHARE)
        fprintf(to, "share of the starts that %s", how);
    else if (s->aim == AIM_NEAREST)
        fprintf(to, "scale up to which all directions %s", how);
    else
        fprintf(to, "%s of the starts that %s", stance_answers[s->answer].name, how);
    if (s->normal)
        fputs(", those near the middle counting more", to);
    for (int i = 0; i < STANCE_ANSWER_COUNT; i++)
        if (s->price[i] != 0)
            fprintf(to, ", less %g of each %s", s->price[i], stance_answers[i].name);
    if (s->gain_price != 0)
        fprintf(to, ", less %g of the gains", s->gain_price);
    if (circumstances > 1)
        fprintf(to,
                s->worst ? ", in the worst of %zu circumstances" : ", mean of %zu circumstances",
                circumstances);
    fclose(to);
}

void search_describe(const struct search_study *study, struct results_axis *axis)
{
    const struct scenario *const s = study->first;
    struct schema *const schema = s ? malloc(sizeof *schema) : NULL;
    size_t index[2];
    const struct scenario_field *const field =
        schema && schema_build(schema, s->scene, &s->law, false)
            ? schema_find_concrete(schema, axis->name, index)
            : NULL;
    if (field) {
        snprintf(axis->unit, sizeof axis->unit, "%s",
                 strcmp(field->unit, "1") == 0 ? "" : field->unit);
        snprintf(axis->text, sizeof axis->text, "%s", field->text);
    }
    free(schema);
}

size_t search_stages(const struct search_study *study, size_t generation[SEARCH_STAGES])
{
    const struct search_file *const f = &study->f;
    const size_t generations = f->length[SEARCH_GENERATION];
    size_t stages = 0;
    for (size_t g = 0; g < generations && stages < SEARCH_STAGES; g++)
        if (g + 1 == generations || f->stage[g + 1] != f->stage[g] ||
            f->restart[g + 1] != f->restart[g])
            generation[stages++] = g;
    return stages;
}
