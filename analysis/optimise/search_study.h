/* search_study.h - what the file of a search says: shares of the fresh starts, how sure they are,
 * how much the chosen candidate gains, and its loop; what is printed and drawn of it.
 *
 * The search file has a byte for each fresh start of each confirmed candidate. Shares have the
 * intervals of analysis/statistics/intervals.h, whose blocks are the starts. What a candidate gains
 * over the first one is judged pair by pair, by what became of the same start under both: with d_i
 * the difference of a start (its mean over circumstances), the difference of the shares is sum d_i
 * / (n + 2), its variance (sum d_i^2 + 1 - (sum d_i)^2 / (n + 2)) / (n + 2)^2 (Agresti and Min,
 * Statistics in Medicine 24, 2005: McNemar's table with half a pair more in each cell). Points of
 * lhs and Sobol' sequences are more even than independent ones: both are rather too wide.
 */
#ifndef STANCE_ANALYSIS_SEARCH_STUDY_H
#define STANCE_ANALYSIS_SEARCH_STUDY_H

#include "analysis/draw/look.h"
#include "analysis/statistics/intervals.h"
#include "analysis/table/report.h"
#include "runner/optimise/trials.h"
#include "runner/store/search_file.h"

/* In the place of a circumstance: as the search counts, the worst of them or their mean. */
#define SEARCH_OVERALL SIZE_MAX

struct search_study {
    struct search_file f;
    const char *file;
    char name[RESULTS_NAME]; /* without directory and .h5 */
    bool done;  /* fresh starts have been tried: there are `confirmed`, and a chosen one */
    bool plain; /* the objective is the share of starts */
    bool glued; /* so is what linear theory allows: allowed.h */
    struct scenario *first; /* NULL: this version does not read it */
    struct scenario *best;  /* of the chosen one; NULL: there is none */
};

/* False: one line in *message. */
bool search_study_open(struct search_study *study, const char *file, stance_message *message);
void search_study_close(struct search_study *study);

/* Of confirmed candidate k in a circumstance, or overall. */
struct search_share {
    double share;
    struct interval interval;
};
struct search_share search_share(const struct search_study *study, size_t k, size_t circumstance);
/* Whether a fresh start is recovered. */
static inline bool search_recovers(const struct search_study *study, size_t k, size_t circumstance,
                                   size_t start)
{
    const struct search_file *const f = &study->f;
    const size_t pair = k * f->length[SEARCH_CIRCUMSTANCE] + circumstance;
    return trials_recovered(f->confirmed_outcome[pair * f->length[SEARCH_START] + start]);
}

/* The chosen less the first candidate; of one circumstance, or of their mean. */
struct search_gain {
    double share;
    struct interval interval;
    uint64_t won, lost; /* pairs of a start and a circumstance */
};
struct search_gain search_gain(const struct search_study *study, size_t circumstance);

/* The circumstance that counts overall for a candidate: its worst one; SEARCH_OVERALL: all do. */
size_t search_worst(const struct search_study *study, size_t k);
/* The circumstances [*from, *to) that such a one stands for. */
void search_circumstances(const struct search_study *study, size_t circumstance, size_t *from,
                          size_t *to);

/* Share from which linear theory allows any controller to recover, about the equilibrium of
 * confirmed candidate k, overall: no more than in the worst circumstance, which *where names, or
 * the mean, NULL. NAN: it sets no bound. `where` may be NULL. */
double search_limit(const struct search_study *study, size_t k, const char **where);
/* Whether the chosen one was chosen by other starts than the fresh ones; by these in files of
 * earlier versions, whose share of it is too large. */
bool search_chosen_apart(const struct search_study *study);
/* Of each fresh start the share of the circumstances that count for the chosen candidate in which
 * linear theory allows any controller to recover, allowed[starts]. False: it sets no bound. */
bool search_allowed(const struct search_study *study, double *allowed);

/* "first candidate", "best of stage 2", "mean after stage 3". */
void search_name(const struct search_study *study, size_t k, char *text, size_t size);
/* What is maximised: "share of stabilised starts, in the worst of 6 circumstances". */
void search_aim(const struct search_study *study, char *text, size_t size);
/* Unit ("": none) and meaning of the path that is the axis's name, where the format has them. */
void search_describe(const struct search_study *study, struct results_axis *axis);

/* Stages, over all beginnings: the last generation of each, in their order. */
enum { SEARCH_STAGES = SCENARIO_MAX_STAGES * (SCENARIO_MAX_RESTARTS + 1) };
size_t search_stages(const struct search_study *study, size_t generation[SEARCH_STAGES]);
/* First candidate of a generation. */
static inline int64_t search_first(const struct search_file *f, size_t generation)
{
    return generation > 0 ? f->candidates[generation - 1] : 0;
}

/* ---- several searches that differ in a number of their scenarios ------------------------------
 */

/* A front of the domain against that number. */
struct search_front {
    size_t count;
    struct search_study *study;  /* [count], by what differs, rising */
    double *at;                  /* [count] what differs */
    struct results_axis against; /* its path, unit and text; value is `at` */
    char also[400];              /* other paths that differ, "a, b"; "" */
    bool glued;                  /* of some study */
};

/* Reads the files and finds what differs: of the numbers that all scenarios have the one with most
 * values, of several the first in the scenario; the seed and what a search may cost are none.
 * False: one line in *message, also where nothing differs or a search is not finished. */
bool search_front_open(struct search_front *front, const char *const *file, size_t count,
                       stance_message *message);
void search_front_close(struct search_front *front);

/* ---- `stance summary` and `stance plot` of the file of a search, or of several: their front ----
 */

/* The work of a `struct report`, and keys of its JSON. */
int search_summarise(struct report *report, stance_message *message);
extern const struct say_key search_keys[];

/* An exit code. */
int search_draw(struct look *look, const char *const *file, size_t files);
/* What it draws, for -h. */
#define SEARCH_PICTURES                                                                            \
    "  a search            NAME-convergence: the objective of every candidate, the best so\n"      \
    "  (stance optimise)   far, what fresh starts said of the first and the chosen one, and\n"     \
    "                      what linear theory allows any controller; under it the mean of\n"       \
    "                      the distribution, and its width\n"                                      \
    "  ... that is         NAME-starts: the share of fresh starts that the first and the\n"        \
    "  finished            chosen one recover, and that linear theory allows, along each\n"        \
    "                      coordinate of the starts\n"                                             \
    "  several searches    NAME-front of the first: shares of fresh starts against the number\n"   \
    "                      that differs in their scenarios (stance summary has its table)\n"

#endif
