/* accuracy.h - error against cost of methods and steps, from one results file.
 *
 * The file comes from a scenario whose first axis varies method.name together with method.step
 * (and method.tolerance); its other axes vary the start. The row that is taken for the truth is
 * the first one of `event-driven`. With trajectories recorded the errors are those of positions
 * and velocities; without them, those of the outcomes. Other simulators may add rows, see peer.h.
 */
#ifndef STANCE_BENCH_ACCURACY_H
#define STANCE_BENCH_ACCURACY_H

#include "analysis/draw/look.h"
#include "measure.h"
#include "peer.h"

#include "runner/store/results.h"

/* One method, step and tolerance; or one setting of a peer. */
struct accuracy_row {
    const stance_method *method; /* NULL: a peer's */
    size_t peer;                 /* which one */
    char setting[PEER_NAME];     /* of a peer: integrator, solver and so on ... */
    bool usual;                  /* ... which are its defaults */
    bool front;                  /* nothing of the same maker is as cheap and as exact */
    double step, tolerance;      /* s; as used, NAN where the method does not control its error */
    uint64_t cases, failed;      /* failed: of these cases, numerically */
    int failure;                 /* enum stance_failure of the first of them */
    uint64_t compared;           /* cases compared with the truth */
    double position;             /* m, rad: largest difference at any recorded instant */
    double velocity;             /* m/s, rad/s: mean over time of the largest difference (L1) */
    uint64_t differ;             /* outcomes unlike the truth's ... */
    uint64_t inside; /* ... in cells whose neighbours all have the truth's own outcome */
    struct measure_cost cost;
    double signorini, coulomb, dissipation, penetration, energy_gain; /* largest of the cases */
    double events, evaluations;                                       /* per simulated second */
};

/* Order of convergence of a method: slope of log error over log step (or tolerance). */
struct accuracy_order {
    const stance_method *method;
    bool by_tolerance;
    size_t rows;               /* of the ladder that it was fitted on; below 2 there is no slope */
    double from, to;           /* ends of the ladder: s, or tolerance */
    double position, velocity; /* slopes; NAN: none */
};

/* Another simulator. */
struct accuracy_peer {
    char name[PEER_NAME], cannot[PEER_REASON]; /* "": it can */
    size_t settings;
    double off; /* largest difference of accelerations from ours, of the largest of each state */
};

enum { ACCURACY_METHODS = 16, ACCURACY_PEERS = 4 };

struct accuracy {
    bool labels;        /* outcomes are compared, not trajectories */
    size_t rows, truth; /* of our methods */
    size_t all;         /* with those of peers, which come after them */
    struct accuracy_row *row;
    size_t peers;
    struct accuracy_peer peer[ACCURACY_PEERS];
    size_t orders;
    struct accuracy_order order[ACCURACY_METHODS];
};

/* Whether its results would be of this kind. false: *message says why not. */
bool accuracy_fits(const struct scenario *s, stance_message *message);

/* Reads the answers and measures what every row costs, for about `budget` seconds each. False when
 * the file is not of this kind, or its truth failed altogether. */
bool accuracy_make(struct accuracy *a, const struct results *r, double budget,
                   stance_message *message);
void accuracy_free(struct accuracy *a);

/* What peers are asked. */
struct accuracy_asking {
    const char *program[ACCURACY_PEERS];
    size_t programs;
    size_t starts;                   /* at most; of a map an evenly spread part of its cells */
    double budget, effort, patience; /* s, see struct peer_task */
};

/* Adds the rows of peers, with the same errors by the same rules. Marks the fronts. */
bool accuracy_ask(struct accuracy *a, const struct results *r, const struct accuracy_asking *asking,
                  stance_message *message);

/* The error that the rows of a chart compete in: of positions, or the share of cells unlike, of
 * which less than one cannot be told. NAN: none. */
double accuracy_error(const struct accuracy *a, const struct accuracy_row *row);

/* One against another. The row of a peer that counts: the smallest error, of its defaults or of all
 * its settings. NULL: it has none. */
const struct accuracy_row *accuracy_best(const struct accuracy *a, size_t peer, bool usual);
/* How a method does beside that row, both from its front, interpolated between logarithms. */
struct accuracy_against {
    double cheaper; /* the row's cost over the method's for as small an error; NAN: it has none */
    bool at_least;  /* its cheapest row is better than that */
    double error;   /* at the row's cost; NAN: it has none as cheap */
    bool at_most;   /* its dearest row is cheaper than that */
};
struct accuracy_against accuracy_compare(const struct accuracy *a, const struct accuracy_row *best,
                                         const stance_method *method);

/* Shared by what compares our rows and peers': into *row. */
void accuracy_trajectory(const struct results_trajectory *truth,
                         const struct results_trajectory *other, struct accuracy_row *row);
void accuracy_label(const struct accuracy *a, const struct results *r, size_t cell, uint8_t kind,
                    struct accuracy_row *row);
size_t accuracy_cases(const struct accuracy *a, const struct results *r);

/* DIRECTORY/STEM.svg and .png: error against cost, a line for each method. */
bool accuracy_plot(const struct accuracy *a, const struct results *r, struct look *look,
                   const char *directory, const char *stem, stance_message *message);

#endif
