/* elsewhere.c - the scenario with one thing changed, and some candidates tried in it. */
#include "elsewhere.h"

#include "engine/mechanism.h"
#include "runner/base/message.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_STARTS = 8192 };
static const double mass_error = 0.05, less_friction = 0.5;

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
    if (parallel_agree(with->parallel, good, message->text, sizeof message->text)) {
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
