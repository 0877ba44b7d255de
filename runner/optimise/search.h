/* search.h - a search for a better controller: generations of candidates, each tried from the same
 * starts, of which there are more from stage to stage; then the best of each stage and the means of
 * the distribution compared from fresh starts.
 *
 * Of the score of a candidate (trials.h) nothing but its order is used, ties go to the lower
 * number, and random numbers follow from the seed and their place: the search is a function of the
 * scenario. What it knows is in the record (search_file.h); told the generations that a record
 * holds whole, it goes on where that ends.
 */
#ifndef STANCE_OPTIMISE_SEARCH_H
#define STANCE_OPTIMISE_SEARCH_H

#include "candidate.h"
#include "trials.h"

#include "runner/run/run.h"
#include "runner/store/search_file.h"

/* Kinds of `count`: refused, the outcomes, failed. */
extern const char *const search_kinds[TRIAL_LABELS];

/* How long a search will go on: the cases that are planned, times what one took of late. (Better
 * candidates are refused less often and stay up for longer, so that what the search took on the
 * whole says too little. Stages that are over before their time drop out of the plan.) */
struct outlook {
    double ahead;          /* cases that are planned behind those in hand */
    double now, begun;     /* cases in hand, and when they were taken */
    double seconds, cases; /* of late: what so many simulated ones took */
};

/* A stage of a beginning: so many generations of so many candidates at most. */
struct search_stage {
    int restart, stage, lambda;
    size_t generations;
    double cases, behind; /* that it takes; that are planned behind it, the end included */
};

/* The same on every rank, but for what the record has beside scores and coordinates. */
struct search {
    struct run *run; /* whose scenario is the first candidate, gains written out */
    struct trials trials;
    struct space space;
    int stages; /* of all beginnings */
    struct search_stage stage[(SCENARIO_MAX_RESTARTS + 1) * SCENARIO_MAX_STAGES];
    size_t generations, candidates; /* most that there can be */
    struct search_file record;
    size_t compared; /* at the end, so far; known to the record once they have been */
    double *compare; /* [compared][paths], their coordinates */
    bool confirming; /* these are being tried */
    struct outlook outlook;
    double before;  /* s that earlier parts of the search took */
    double save_at; /* of clock_seconds() */
    char doing[80];
};

/* Collective. `origin`: what an earlier part of the search left, on rank 0, which is taken over;
 * NULL: none. text: the scenario as it was read. false: run->message says why. search_free is for
 * it either way. */
bool search_make(struct search *search, struct run *run, const char *text,
                 const struct search_file *origin);
void search_free(struct search *search);

/* Of confirmed candidate k, the share of fresh starts from which linear theory allows any
 * controller to recover, as a search counts: no more than in the circumstance *where that allows
 * least, if it is of the worst of several; else the mean, *where is NULL. NAN: it sets no bound. */
double search_limit_of(const struct search_file *f, bool worst, size_t k, const char **where);

/* Collective, with counters; rank 0 writes run->file, and says how far it is. BROKEN: run->message
 * says why, or the run has failed. */
enum trials_end search_run(struct search *search);

#endif
