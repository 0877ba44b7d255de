/* trials.h - candidates of a search tried: each from all its starts in all circumstances, on all
 * ranks, in memory.
 *
 * What comes out are a byte for each case and whole numbers that are summed, so that it does not
 * depend on ranks, lanes or order.
 */
#ifndef STANCE_OPTIMISE_TRIALS_H
#define STANCE_OPTIMISE_TRIALS_H

#include "runner/plan/kernels.h"
#include "runner/run/heartbeat.h"

/* Labels of a case: not simulated, outcome + 1, failed. */
enum { TRIAL_REFUSED = 0, TRIAL_FAILED = STANCE_OUTCOME_COUNT + 1, TRIAL_LABELS };

/* The starts: those of the search; those by which one of the best is chosen, made with a seed that
 * no scenario can have; and those by which nothing was, made with the next one. */
enum trials_starts { TRIALS_SEARCH, TRIALS_CHOICE, TRIALS_FRESH, TRIALS_STARTS };

enum trials_end { TRIALS_DONE, TRIALS_STOPPED, TRIALS_BROKEN };

/* What is known of a candidate's loop in a circumstance before it is simulated. */
struct trials_loop {
    double critical; /* s, critical sample time without delay; INFINITY; NAN: not known */
    double short_of; /* by how much a loop that is not tried falls short, the less the nearer */
    uint8_t tried;
};

struct trials {
    const struct scenario *scenario; /* the first candidate, whose search is given */
    const struct parallel *parallel;
    struct scenario *at; /* with the axes candidate, circumstances ..., start */
    size_t circumstances;
    double *start[TRIALS_STARTS];   /* points of the sample axis */
    int64_t *weight[TRIALS_STARTS]; /* [starts], their sum TRIALS_WEIGHT but for rounding */
    struct kernels kernels;
    bool has_kernels, quiet;
    /* Of the last run, [candidates][circumstances][starts] and [candidates][circumstances], on
     * every rank. */
    uint8_t *label;
    int64_t *worth; /* sum over recovered starts of weight times value, in TRIALS_WORTH */
    struct trials_loop *loop;
    uint64_t cases; /* simulated so far, by all ranks */
    /* Of the run at hand: starts, what each counts, cases of this rank. */
    size_t starts;
    const int64_t *counts;
    uint64_t own_cases;
    double compiling; /* s, that the kernels took */
    /* Told about every millisecond, on rank 0: true, to stop. */
    bool (*attend)(void *context, double now);
    void *context;
    double until;  /* of clock_seconds() */
    int64_t beats; /* this rank's sign of life */
};

/* Whole numbers: of the weights of all starts, and what stands for a worth of 1. A start is worth
 * at most TRIALS_MOST_WORTH, either sign, so that sums stay within 64 bits. */
#define TRIALS_WEIGHT 0x1p24
#define TRIALS_WORTH 0x1p20
#define TRIALS_MOST_WORTH 5e4

/* Collective in what it makes: the same on every rank. False: no memory. */
bool trials_make(struct trials *trials, const struct scenario *scenario,
                 const struct parallel *parallel);
void trials_free(struct trials *trials);

/* Collective, with counters: tries `candidates` with value[candidates][paths] (of scenario's
 * search.axis, the same on every rank) from the first `starts` of the starts. BROKEN: *message says
 * why. */
enum trials_end trials_run(struct trials *trials, size_t candidates, double *value,
                           enum trials_starts which, uint64_t starts, stance_message *message);

/* Whether a label is of a start that ended as is looked for: stabilised, or it walks. */
static inline bool trials_recovered(int label)
{
    return label == STANCE_STABILISED + 1 || label == STANCE_WALKS + 1;
}

/* Of one of the three: how many there are at most, and their seed. */
static inline uint64_t trials_count(const struct scenario *s, enum trials_starts which)
{
    return which == TRIALS_SEARCH ? s->search.grow[s->search.stages - 1] : s->search.confirm;
}

static inline uint64_t trials_seed(const struct scenario *s, enum trials_starts which)
{
    return which == TRIALS_SEARCH   ? s->seed
           : which == TRIALS_CHOICE ? s->seed ^ ((uint64_t)1 << 63)
                                    : s->seed + 1;
}

/* The denominator of a search, from which starts linear theory allows any controller to recover
 * (engine/control/null_controllable.c). Adds 1 to inside[starts], or NULL, of each of these, the
 * points of the scenario's last axis, in a circumstance, a point of the axes before it; returns
 * their share, NAN: linear theory sets no bound there. */
double linear_limit_add(const struct scenario *s, size_t circumstance, double *inside);
/* Share of the first `starts` fresh starts of the candidate value[paths] in each circumstance,
 * share[circumstances]; NAN: linear theory sets no bound there. */
void linear_limit_shares(struct trials *trials, double *value, uint64_t starts, double *share);

/* ---- elsewhere ------------------------------------------------------------------------------- */

/* What an optimum costs where it was not sought: with contacts that the scenario leaves out, on
 * less friction, later, with other masses. */
enum { ELSEWHERE_MOST = 6 };
/* The name of such a place beside the scenario; NULL: it says nothing of that itself. */
const char *elsewhere_name(const struct scenario *s, int where);
/* Fresh starts that are tried there. */
uint64_t elsewhere_starts(const struct scenario *s);
/* Collective: share[candidates] of these that recover, value[candidates][paths]; `with` has the
 * kernels. */
enum trials_end elsewhere_run(const struct trials *with, int where, size_t candidates,
                              double *value, double *share, stance_message *message);

#endif
