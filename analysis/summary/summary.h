/* summary.h - what `stance summary` knows of a results file before it prints it. */
#ifndef STANCE_SUMMARY_SUMMARY_H
#define STANCE_SUMMARY_SUMMARY_H

#include "analysis/statistics/doe_bins.h"
#include "analysis/statistics/faces.h"
#include "analysis/table/table.h"
#include "runner/store/results.h"

/* The answers that are summarised: name, kind of the cases looked at (RESULTS_KIND_COUNT: all that
 * are done; RESULTS_STABILISED: those that the study judges by, see struct summary), unit. */
#define SUMMARY_NUMBERS(X)                                                                         \
    X(settle_time, RESULTS_STABILISED, "s")                                                        \
    X(friction_used, RESULTS_STABILISED, "")                                                       \
    X(least_normal_force, RESULTS_STABILISED, "N")                                                 \
    X(excursion, RESULTS_STABILISED, "rad")                                                        \
    X(slip_distance, RESULTS_STABILISED, "m")                                                      \
    X(fall_time, RESULTS_FELL, "s")                                                                \
    X(peak_torque, RESULTS_KIND_COUNT, "N m")                                                      \
    X(max_penetration, RESULTS_KIND_COUNT, "m")                                                    \
    X(through_ground, RESULTS_KIND_COUNT, "m")                                                     \
    X(impact_energy, RESULTS_KIND_COUNT, "J")                                                      \
    X(projection_energy, RESULTS_KIND_COUNT, "J")                                                  \
    SUMMARY_RESIDUALS(X)

/* How far the cases are from the laws that they ought to obey: of these the largest matters. */
#define SUMMARY_RESIDUALS(X)                                                                       \
    X(signorini_residual, RESULTS_KIND_COUNT, "m/s")                                               \
    X(coulomb_residual, RESULTS_KIND_COUNT, "")                                                    \
    X(dissipation_residual, RESULTS_KIND_COUNT, "m/s")                                             \
    X(energy_gain, RESULTS_KIND_COUNT, "J")                                                        \
    X(energy_drift, RESULTS_KIND_COUNT, "J")

enum {
#define SUMMARY_NUMBER(name, kind, unit) SUMMARY_##name,
    SUMMARY_NUMBERS(SUMMARY_NUMBER)
#undef SUMMARY_NUMBER
        SUMMARY_NUMBER_COUNT,
    SUMMARY_FIRST_RESIDUAL = SUMMARY_signorini_residual,
};

struct summary_numbers {
    const char *name, *unit;
    enum results_kind of; /* RESULTS_KIND_COUNT: all that are done */
    bool stored;
    struct statistics_numbers numbers;
};

#define SUMMARY_THROUGH 1e-9 /* m: less is rounding of what lies on the ground */

/* Counts per case that make up the cost: name, name in JSON of the cases that have any, text. Those
 * that are signs of trouble come last and are told even if there are none. */
#define SUMMARY_COUNTS(X)                                                                          \
    X(steps, NULL, NULL)                                                                           \
    X(iterations, NULL, NULL)                                                                      \
    X(evaluations, NULL, NULL)                                                                     \
    X(events, "events_cases", "events, changes of contact mode")                                   \
    X(limited_impacts, "limited_cases", "impacts with less restitution than asked for")            \
    X(degraded_samples, "degraded_cases",                                                          \
      "samples at which decoupling could not do what it promises")                                 \
    X(subdivided_steps, "subdivided_cases", "steps that had to be subdivided")                     \
    X(ambiguous_steps, "ambiguous_cases", "steps with several contact solutions")

enum {
#define SUMMARY_COUNT(name, cases, text) SUMMARY_##name,
    SUMMARY_COUNTS(SUMMARY_COUNT)
#undef SUMMARY_COUNT
        SUMMARY_COUNT_COUNT,
};

/* A count per case: its sum over the cases that are done, and how many cases have any. */
struct summary_count {
    const char *name, *cases_name, *text;
    bool stored;
    double sum;
    uint64_t cases;
};

/* Ends of the stabilised set along an axis, a number for each point of a sample: n points where
 * they are known, of which `open` reach the end of the axis. */
struct summary_rays {
    struct statistics_numbers numbers;
    size_t nearest; /* point of the smallest */
    double scale;   /* of the offsets that the sample varies, there */
    size_t open, none, unknown;
};

/* What path k of a sample is at the smallest end: an offset times the scale. */
double summary_nearest(const struct summary_rays *rays, const struct results *r, int k);

/* A field that the sweep leaves alone. */
struct summary_field {
    char path[96], unit[16], text[160];
    double number; /* where it is one, else NAN */
};
enum { SUMMARY_FIELDS = 192, SUMMARY_FAILURES = 16 };

struct summary {
    struct statistics_counts counts;
    struct interval of_kind[RESULTS_KIND_COUNT]; /* of their shares */
    /* What the cases are judged by: STABILISED, or where no controller has a target RESTED. */
    enum results_kind judged;
    struct faces faces;                  /* of the box of starts */
    face_set cut;                        /* those on which cases of the kind judged by lie */
    uint64_t failures[SUMMARY_FAILURES]; /* by enum stance_failure */
    uint64_t first_failed;               /* flat index of the first such case */
    uint32_t touching; /* of a file of one case that failed: contacts closed then, a bit each */
    char contact[STANCE_MAX_CONTACTS][STANCE_NAME]; /* and their names */
    /* By what cases fell, as the file names it: none of them, then the scene's causes. */
    char cause[STANCE_MAX_WORDS][STANCE_NAME];
    uint64_t fallen_by[STANCE_MAX_WORDS];
    struct summary_numbers numbers[SUMMARY_NUMBER_COUNT];
    /* Cases in which a contact that the scenario leaves out went through the ground; of these
     * those that the study is judged by. */
    uint64_t through, through_judged;
    struct summary_count count[SUMMARY_COUNT_COUNT];
    uint64_t inferred; /* from neighbours, in a refined map */
    bool timed;
    double longest, total, timed_cases; /* s, s, 1 */
    size_t ranks;
    bool has_extent[SCENARIO_MAX_AXES];
    struct statistics_extent extent[SCENARIO_MAX_AXES];
    /* Axes that are not offsets: the counts of every value, and where the share of cases of the
     * kind judged by changes most: from `steepest` to the next value. */
    struct statistics_counts *by_value[SCENARIO_MAX_AXES];
    struct interval *interval[SCENARIO_MAX_AXES]; /* of the share judged by, for every value */
    size_t steepest[SCENARIO_MAX_AXES];
    int parameters; /* how many such axes; the points of a sample are none */
    /* By the values of each path that a sample varies, [varied]. */
    struct doe_bins *bins;
    /* Of a sample beside one axis of offsets: where along this axis the stabilised set through the
     * equilibrium ends, over all points. NULL: neither. */
    int ray_axis;
    struct summary_rays *rays;
    /* Two such axes, no more: the counts of every pair of their values, pair_counts[first axis's
     * count][second's]; else NULL. */
    int pair[2];
    struct statistics_counts *pair_counts;
    size_t fields;
    struct summary_field field[SUMMARY_FIELDS];
    struct ancestry ancestry;
};

/* Reads what it needs. A failure leaves nothing allocated. */
bool summary_make(struct summary *summary, const struct results *r, stance_message *message);
void summary_free(struct summary *summary);

/* Fills in the fields that do not vary; of what memory does not suffice for there are none. */
void summary_collect_fields(struct summary *summary, const struct results *r,
                            const struct scenario *s);

/* False when cases are done but the file stores no outcomes: record.answers left them out. */
bool summary_has_outcomes(const struct summary *summary);

/* What the cases of a scenario are judged by: STABILISED, or where no controller has a target
 * RESTED. */
enum results_kind summary_judged(const struct scenario *s);

/* Share of the cases of the kind judged by among those done; NAN when there are none. */
double summary_share(const struct summary *summary, const struct statistics_counts *counts);

/* Name and text of a failure, from the engine's table. */
const char *summary_failure_name(int failure);
const char *summary_failure_text(int failure);

/* "Stabilised" or "Rested": what the cases are judged by. */
const char *summary_judged_word(const struct summary *summary);

/* Tables, freed by the caller: the outcomes; what they are at every value of a parameter (with CSV
 * of all, after those of all cases); parts of what path k of a sample varies; the numbers. */
void summary_outcomes(struct table *t, const struct summary *summary);
void summary_values(struct table *t, const struct summary *summary, const struct results *r,
                    int axis, enum table_form form);
void summary_parts(struct table *t, const struct summary *summary, const struct results *r, int k);
void summary_answers(struct table *t, const struct summary *summary, enum table_form form);

/* The state in which a file of one case ends: name[], state[]; how many, 0 if that is not known. */
size_t summary_final_state(const struct results *r, char name[][SCENARIO_NAME], double *state);

/* Print it; false when memory or the output fails. */
bool summary_print_text(const struct summary *summary, const struct results *r);
bool summary_print_json(const struct summary *summary, const struct results *r);
bool summary_print_csv(const struct summary *summary, const struct results *r);

#endif
