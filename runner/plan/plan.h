/* plan.h - what a run will compute: its rows, its distinct designs, its trajectories.
 *
 * Nothing here is as large as the number of cases: the parameters of a case are made when it is
 * drawn. Designs (equilibria and gains) are kept once per distinct combination of those axes that
 * they depend on.
 */
#ifndef STANCE_PLAN_PLAN_H
#define STANCE_PLAN_PLAN_H

#include "resolve.h"
#include "shard.h"

#include "runner/ranks/parallel.h"

struct plan {
    const struct scenario *scenario;
    bool single;          /* --only: the file holds one case */
    uint64_t single_case; /* its flat index */
    uint64_t rows;        /* cases in the file: 1, or all of the scenario's */
    struct shard shard;   /* --shard: those of them that are computed */

    size_t ancestors; /* scenarios that the file was made from before this one, see
                         adopt.h */

    bool methods_swept; /* some axis lists methods */

    size_t designs; /* distinct ones, row-major over the axes flagged `design` */
    double *design; /* [designs][design_size], see plan_design_at */
    size_t design_size;
    uint8_t *design_status; /* [designs] enum stance_status */
    size_t pending;         /* of these, for which there was no time */
    double design_seconds;  /* what computing all of them takes on one rank */

    /* s after which designs that are not yet computed stay pending; 0: all are computed. */
    double patience;

    /* Asked about every millisecond while designs are computed; NULL: never. */
    bool (*stop)(void *context);
    void *stop_context;

    double record_interval; /* s; 0: no trajectories */
    int64_t record_rows;    /* instants k * record_interval, k = 0 ... record_rows - 1 */
    uint64_t record_cases;  /* cases with a trajectory */
};

/* What is wrong with a scenario beyond its text, and where. */
struct plan_error {
    stance_message message;
    int line, column; /* 0: nowhere in particular */
};

/* One line on standard error. Returns EXIT_USAGE. */
int plan_error_print(const struct scenario *s, const struct plan_error *error);

/* The whole scenario, or (single) one case of it, with its trajectory if `trace`. Sets everything
 * but the designs. false: no memory, or a method without a kernel for this scene. */
bool plan_make(struct plan *plan, const struct scenario *scenario, bool single,
               uint64_t single_case, bool trace, struct plan_error *error);
void plan_free(struct plan *plan);

/* Makes it the plan of a shard of the sweep; false: it cannot be cut so. */
bool plan_cut(struct plan *plan, const struct shard *shard, struct plan_error *error);
/* The rows that are computed: all, or those of the shard. */
struct rows plan_share(const struct plan *plan);

/* Flat index of the case in a row of the file; design that a case uses, and the first case that
 * uses a design. */
uint64_t plan_case(const struct plan *plan, uint64_t row);
size_t plan_design(const struct plan *plan, uint64_t index);
uint64_t plan_design_case(const struct plan *plan, size_t design);
/* Place of a row among the recorded cases; false when it is not recorded. And the reverse. */
bool plan_recorded(const struct plan *plan, uint64_t row, uint64_t *place);
uint64_t plan_recorded_case(const struct plan *plan, uint64_t place);

/* `check` and `run --dry-run` return within seconds: what they give to designs and
 * to the cost, of which plan_cost may take five times as much. */
#define PLAN_PATIENCE_DESIGNS 1.5
#define PLAN_PATIENCE_COST 0.6

/* Whether cases may be simulated: not, where the scenario's law is not trusted (law.h). */
static inline bool plan_simulates(const struct plan *plan)
{
    return !plan->scenario->law.source || plan->scenario->program;
}

/* Collective: computes every design whose status is pending, each rank a block, and gathers them on
 * rank 0. With patience at least one a rank, those of cases that plan_cost tries and of the corners
 * first, then evenly spread. false on every rank when no design exists at all, or plan->stop said
 * true somewhere; the message is empty then. */
bool plan_compute_designs(struct plan *plan, const struct parallel *parallel,
                          struct plan_error *error);

/* Tries the initial states of the first, the last, the corners and up to 4096 other cases spread
 * evenly; where designs are pending, the first case of each that is not, too. Cases whose design
 * does not exist or is pending are left out. Needs the designs. */
bool plan_check_cases(const struct plan *plan, struct plan_error *error);

/* Design d, whatever its status; and into its place. */
struct resolved_design plan_design_at(const struct plan *plan, size_t d);
void plan_design_put(struct plan *plan, size_t d, const struct resolved_design *design);
/* Design d of another plan of the same scene, with its status. */
void plan_take_design(struct plan *plan, size_t place, const struct plan *from, size_t d);

/* Method of a row, as index into stance_methods(). */
int plan_method(const struct plan *plan, uint64_t row);
/* Parameters of a row; *method (may be NULL) as index into stance_methods(). false: the case does
 * not exist, because its design or its initial state does not. */
bool plan_resolve(const struct plan *plan, uint64_t row, stance_case *out, int *method);

/* Case i of PLAN_COST_CASES, which plan_cost tries, in an order that is spread evenly over the
 * sweep wherever it is cut. */
enum { PLAN_COST_CASES = 64 };
uint64_t plan_cost_case(const struct plan *plan, uint64_t i);

/* Seconds of a processor, measured on cases spread over the sweep for about `budget` seconds, and
 * five times that at most. Where they are not over by then *bound is set: no more than that. NAN:
 * even their beginnings take too long; negative: none of the cases tried can be computed. Needs the
 * designs. */
double plan_cost(const struct plan *plan, double budget, bool *bound);

#endif
