/* search_file.h - the file of a search for a better controller: HDF5 that follows netCDF-4.
 *
 * One table says what it holds: dimensions, variables over them, words. The file is small and is
 * written anew, under another name until it is whole, whenever it is to hold more, so that it is
 * whole at any time. The cases of candidates are counted, not kept: those of the searches that ship
 * are 0.4 to 3.3 million, and as rows of a results file, 12 bytes each at least and 370 as usual,
 * would take up to a GB; the fresh starts of what is compared have a byte each. Variables have
 * checksums as those of results files (file_checksums.h).
 * Attributes: Conventions, title, search_version, git_revision, date, scenario (text, with the
 * section optimise), first_scenario (the first candidate, gains written out), chosen,
 * most_generations, most_cases, finished, wall_time, linear_limit (share of the fresh starts from
 * which linear theory allows any controller to recover, in the worst circumstance or their mean as
 * the search counts; none: it tells none), note (why the search ended).
 */
#ifndef STANCE_STORE_SEARCH_FILE_H
#define STANCE_STORE_SEARCH_FILE_H

#include "engine/stance.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Dimensions: their name; their points are numbered, or have the words of a member of struct
 * search_file; text. */
#define SEARCH_DIMENSIONS(X)                                                                       \
    X(CANDIDATE, "candidate", NUMBERS, "number of the candidate")                                  \
    X(PARAMETER, "parameter", WORDS(parameter), NULL)                                              \
    X(OTHER, "parameter_other", WORDS(parameter), NULL)                                            \
    X(CIRCUMSTANCE, "circumstance", WORDS(circumstance), NULL)                                     \
    X(KIND, "kind", WORDS(kind), NULL)                                                             \
    X(GENERATION, "generation", NUMBERS, "number of the generation")                               \
    X(CONFIRMED, "confirmed", NUMBERS, "number of the candidate that was tried from fresh starts") \
    X(START, "start", NUMBERS, "number of the fresh start")                                        \
    X(VARIED, "varied", WORDS(varied), NULL)                                                       \
    X(ELSEWHERE, "elsewhere", WORDS(elsewhere), NULL)

enum search_dimension {
#define SEARCH_DIMENSION(NAME, ...) SEARCH_##NAME,
    SEARCH_DIMENSIONS(SEARCH_DIMENSION)
#undef SEARCH_DIMENSION
        SEARCH_DIMENSION_COUNT,
    SEARCH_NO = -1,
};

/* Variables: name, type, the dimensions it is over (SEARCH_NO: none), unit, text. */
#define SEARCH_VARIABLES(X)                                                                        \
    X(value, double, CANDIDATE, PARAMETER, NO, NULL, "what the candidate is, in each's unit")      \
    X(coordinate, double, CANDIDATE, PARAMETER, NO, "1", "the same as the search sees it")         \
    X(of_generation, int64_t, CANDIDATE, NO, NO, "1", "generation that the candidate is of")       \
    X(count, int64_t, CANDIDATE, CIRCUMSTANCE, KIND, "1", "starts by what became of them")         \
    X(critical_sample_time, double, CANDIDATE, CIRCUMSTANCE, NO, "s",                              \
      "critical sample time of the loop without delay")                                            \
    X(score, int64_t, CANDIDATE, NO, NO, "1", "what is compared, a whole number")                  \
    X(objective, double, CANDIDATE, NO, NO, "1", "the same, of each start")                        \
    X(stage, int64_t, GENERATION, NO, NO, "1", "stage of the search")                              \
    X(starts, int64_t, GENERATION, NO, NO, "1", "starts that its candidates were tried from")      \
    X(restart, int64_t, GENERATION, NO, NO, "1", "beginning, of several, that it belongs to")      \
    X(candidates, int64_t, GENERATION, NO, NO, "1", "candidates up to its end")                    \
    X(mean, double, GENERATION, PARAMETER, NO, "1", "mean of the distribution, a coordinate")      \
    X(step, double, GENERATION, NO, NO, "1", "step of the distribution")                           \
    X(covariance, double, GENERATION, PARAMETER, OTHER, "1", "covariance, of step 1")              \
    X(best, int64_t, GENERATION, NO, NO, "1", "best candidate of the stage so far")                \
    X(confirmed_candidate, int64_t, CONFIRMED, NO, NO, "1", "which candidate; -1: a mean")         \
    X(confirmed_generation, int64_t, CONFIRMED, NO, NO, "1",                                       \
      "generation up to which it is best, "                                                        \
      "or mean; -1: the first")                                                                    \
    X(confirmed_value, double, CONFIRMED, PARAMETER, NO, NULL, "what it is, in each's unit")       \
    X(confirmed_count, int64_t, CONFIRMED, CIRCUMSTANCE, KIND, "1",                                \
      "fresh starts by what became of them")                                                       \
    X(confirmed_critical, double, CONFIRMED, CIRCUMSTANCE, NO, "s",                                \
      "critical sample time of its loop without delay")                                            \
    X(confirmed_score, int64_t, CONFIRMED, NO, NO, "1",                                            \
      "worth of the fresh starts, a whole number")                                                 \
    X(confirmed_objective, double, CONFIRMED, NO, NO, "1", "the same, of each fresh start")        \
    X(confirmed_training, double, CONFIRMED, NO, NO, "1",                                          \
      "objective of the starts of the search; NAN: it had none")                                   \
    X(confirmed_allowed, double, CONFIRMED, CIRCUMSTANCE, NO, "1",                                 \
      "share of the fresh starts that linear theory allows any controller")                        \
    X(start_value, double, START, VARIED, NO, NULL, "fresh starts, in each's unit")                \
    X(confirmed_outcome, uint8_t, CONFIRMED, CIRCUMSTANCE, START, "1",                             \
      "what became of each fresh start, a place in `kind`")                                        \
    X(elsewhere_first, double, ELSEWHERE, NO, NO, "1",                                             \
      "share of fresh starts that the first candidate recovers there")                             \
    X(elsewhere_chosen, double, ELSEWHERE, NO, NO, "1",                                            \
      "share of fresh starts that the chosen one recovers there")                                  \
    X(choice_score, int64_t, CONFIRMED, NO, NO, "1",                                               \
      "by which one is chosen, a whole number, of starts of its own")                              \
    X(choice_objective, double, CONFIRMED, NO, NO, "1", "the same, of each such start")
/* The last two are of files since one is chosen by starts of its own: read from older ones, where
 * it is chosen by the fresh starts, they are nothing (0, NAN). */
enum { SEARCH_ADDED = 2 };

struct search_file {
    size_t length[SEARCH_DIMENSION_COUNT]; /* 0: variables over it are left out */
    char **parameter, **circumstance, **kind, **varied, **elsewhere; /* words of dimensions */
#define SEARCH_FIELD(name, type, ...) type *name;
    SEARCH_VARIABLES(SEARCH_FIELD)
#undef SEARCH_FIELD
    char *title, *scenario, *first_scenario, *revision, *date, *note;
    int64_t chosen;           /* place among `confirmed`; -1: none yet */
    int64_t most_generations; /* that the search may have */
    double most_cases;        /* that it may simulate */
    int finished;
    double linear_limit, seconds; /* s, of all ranks' wall time, over all parts of the search */
};

/* Room for the lengths that *f has, all zeros, and for words that it has not; what is written later
 * has at most these. false: no memory. */
bool search_file_room(struct search_file *f);
/* Length and variables of candidates or generations, of a file that has as many of all else. */
void search_file_copy(struct search_file *f, const struct search_file *from,
                      enum search_dimension first);
void search_file_free(struct search_file *f);

/* Whether a file is one of a search, as far as can be seen; no message. */
bool search_file_is(const char *file);
bool search_file_write(const struct search_file *f, const char *file, stance_message *message);
/* Verifies checksums; everything in *f is new, and freed by search_file_free. All texts but the
 * scenarios are clean (results.h). */
bool search_file_read(struct search_file *f, const char *file, stance_message *message);

#endif
