/* design.h - control design: gains from a linearised scene, loops that sample, sets in which a
 * linear loop holds. The public header of an archive of its own, libstance_control.a.
 *
 * Conventions as in engine/stance.h.
 */
#ifndef STANCE_CONTROL_DESIGN_H
#define STANCE_CONTROL_DESIGN_H

#include "engine/stance.h"

enum {
    STANCE_PLANT_MOST = 32, /* states, inputs */
    STANCE_LOOP_MOST = STANCE_PLANT_MOST + STANCE_MAX_DELAY * STANCE_MAX_ACTUATORS,
};

/* x' = A x + B u: A[states][states], B[states][inputs], finite, of 1 to STANCE_PLANT_MOST each;
 * else everything below that is given one returns BAD_ARGUMENT. n and m are its states and inputs.
 */
typedef struct stance_plant {
    int states, inputs;
    const double *A, *B;
} stance_plant;

/* Singular values sv[n] (descending) of (B, AB, ..., A^(n-1)B), each column block scaled so that
 * the rank does not depend on the unit of time; rank counts sv > tolerance * sv[0]. */
stance_error stance_kalman(const stance_plant *plant, double *sv, int *rank);

/* Condition number (2-norm, SI units) of the matrix that takes torques to the accelerations of a
 * selection of coordinates (stance_selection), without reactions; INFINITY where it is singular:
 * there the decoupling law has no torques. position[coordinates]. */
stance_error stance_selection_condition(const stance_scene *scene, const double *robot,
                                        const double *position, int selection, double *condition);

/* One selection over postures spread through -pi ... pi (m for what slides), so many that they and
 * the selections together are `evaluations`. */
typedef struct stance_selection_report {
    bool singular;          /* the determinant changes sign: singular on a surface of postures */
    double ill_conditioned; /* share of the postures with a condition number above
                             * STANCE_ILL_CONDITIONED */
    double best;            /* smallest condition number */
} stance_selection_report;
stance_error stance_selection_survey(const stance_scene *scene, const double *robot,
                                     long evaluations, int selections,
                                     stance_selection_report *report);
/* ROBUST: after Kautsky, Nichols and Van Dooren (1985, method 0), iterated until the eigenvectors
 * no longer change; poles of multiplicity at most rank B. SCHUR: Varga's method (SLICOT SB01BD);
 * poles of any multiplicity; what it minimises is the gain of each of its steps, not the
 * sensitivity of the whole. */
typedef enum stance_placement { STANCE_ROBUST, STANCE_SCHUR } stance_placement;

/* n poles re + i im, conjugate pairs complete. */
typedef struct stance_poles {
    const double *re, *im;
} stance_poles;

/* Of robust eigenvectors: iterations, 2-norm condition number; 0 and NAN of others. */
typedef struct stance_robustness {
    int sweeps;
    double condition;
} stance_robustness;

/* K[m][n] with eig(A - B K) the poles or, T > 0, for a controller that samples every T seconds and
 * holds, eig(Ad(T) - Bd(T) K) = exp(pole T): pairs must turn less than half a turn in T; of several
 * equally robust gains the one that continues that of T = 0. robustness: out, may be NULL. */
stance_error stance_place(stance_placement how, const stance_plant *plant, double T,
                          const stance_poles *poles, double *K, stance_robustness *robustness,
                          stance_message *message);

/* Linear quadratic regulator: the K[m][n] for which u = -K x minimises the integral of
 * sum states[i] x_i^2 + sum torques[j] u_j^2 over all time. states[n] >= 0, torques[m] > 0.
 * T > 0: over inputs that change only every T seconds; plant and cost are discretised exactly, with
 * the cross term that this brings.
 * Errors: BAD_ARGUMENT (also: the weights do not see a mode that does not decay by itself),
 * UNCONTROLLABLE (no input reaches such a mode), NUMERICAL. */
stance_error stance_lqr(const stance_plant *plant, double T, const double *states,
                        const double *torques, double *K, stance_message *message);

/* Eigenvalues of A[n][n], n <= STANCE_LOOP_MOST, sorted by real then imaginary part. */
stance_error stance_eigenvalues(int n, const double *A, double *re, double *im);

/* Exact discretisation under a zero-order hold: Ad[n][n], Bd[n][m]. */
stance_error stance_discretise(const stance_plant *plant, double T, double *Ad, double *Bd);

/* How a loop u = -K x samples: every T seconds, and holds, the torques of a sample acting `delay`
 * samples later. Its state is x, or with a delay (x, the torques under way), of n + delay m. */
typedef struct stance_sampling {
    const double *K; /* [m][n] */
    double T;
    int delay;
} stance_sampling;

/* Eigenvalues z[n + delay m] of that loop, sorted as by stance_eigenvalues: of Ad(T) - Bd(T) K, and
 * with a delay of [Ad Bd 0; 0 0 1; -K 0 0]. */
stance_error stance_sampled_loop(const stance_plant *plant, const stance_sampling *loop, double *re,
                                 double *im);

/* By how much the states of that loop wander about zero, rms[n] at the samples, under white noise
 * of variances measured[n] on what is measured and `commanded` on each torque. T > 0. NUMERICAL
 * when the loop is not stable. */
stance_error stance_sampled_wander(const stance_plant *plant, const stance_sampling *loop,
                                   const double *measured, double commanded, double *rms);

/* The plant behind actuators u' = (command - u) / lag, lag > 0, as one of n + m states (x, u):
 * A1[n + m][n + m], B1[n + m][m], and K1[m][n + m] that sees x alone. */
void stance_lagged(const stance_plant *plant, const double *K, double lag, double *A1, double *B1,
                   double *K1);

/* Smallest sample time T* at which the sampled loop (its own T is not read) leaves the unit circle;
 * 0 when the continuous loop is unstable, INFINITY when none is found up to `longest` seconds. */
stance_error stance_critical_sample_time(const stance_plant *plant, const stance_sampling *loop,
                                         double longest, double *T);

/* P[n][n] of the Lyapunov function V = x' P x of a stable loop: for x' = F x with
 * dV/dt = -sum weight[i] x_i^2, or (sampled) for x+ = F x with V(x+) - V(x) equal to that.
 * weight[n] > 0. BAD_ARGUMENT when the loop is not stable. */
stance_error stance_lyapunov(int n, const double *loop, bool sampled, const double *weight,
                             double *P, stance_message *message);

/* Half spaces a_k' x <= d_k: a[count][n], d[count]. */
typedef struct stance_bounds {
    int count;
    const double *a, *d;
} stance_bounds;

/* Largest set x' P x <= level inside them: level = min d_k^2 / (a_k' P^-1 a_k), 0 where some
 * d_k <= 0, INFINITY where nothing binds. binding: the k that does, or -1. alone: how far x_i
 * reaches when all else is 0; extent: when all else is free. */
typedef struct stance_sublevel_set {
    double level;
    int binding;
    double alone[STANCE_PLANT_MOST], extent[STANCE_PLANT_MOST];
} stance_sublevel_set;
/* P[n][n] symmetric, positive definite. */
stance_error stance_sublevel(int n, const double *P, const stance_bounds *bounds,
                             stance_sublevel_set *set);

/* The states from which some torques within their limits bring a linear robot back, whatever the
 * controller: its null-controllable set (null_controllable.c). Of the states only what they have of
 * the unstable modes counts, and of what no torque moves and does not decay: that must be 0. */
enum { STANCE_NULL_MODES = 8 };
typedef struct stance_null_set stance_null_set;

/* Of the plant, low[m] <= u <= high[m] about the equilibrium's torques, low < 0 < high,
 * finite. *set: to be freed. Errors: BAD_ARGUMENT (a bound, more than STANCE_NULL_MODES unstable
 * modes that torques move), UNCONTROLLABLE (torques that hardly reach one), NUMERICAL, NO_MEMORY.
 */
stance_error stance_null_set_make(const stance_plant *plant, const double *low, const double *high,
                                  stance_null_set **set, stance_message *message);
void stance_null_set_free(stance_null_set *set);

/* How many real coordinates the unstable modes have that torques move, and their eigenvalues re + i
 * im in re and im (NULL: not asked for), each of STANCE_NULL_MODES. */
int stance_null_set_modes(const stance_null_set *set, double *re, double *im);
/* The same of what no torque moves and does not decay, each of as many as there are states. With
 * neither the set is everything. */
int stance_null_set_unreached(const stance_null_set *set, double *re, double *im);
/* Support function in these coordinates, and the point[modes] that eta[modes] touches. */
double stance_null_set_support(const stance_null_set *set, const double *eta, double *point);
/* The factor by which the set must grow to have the state x[n] on its boundary: 1 there, less
 * inside; INFINITY where no torque moves some of it. */
double stance_null_set_gauge(const stance_null_set *set, const double *x);
/* Is x[n] inside? Much faster. */
bool stance_null_set_holds(const stance_null_set *set, const double *x);

#endif
