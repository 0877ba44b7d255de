/* motions.h - runs of mechanisms by every method, and what they are held to: closed forms, and
 * equations of motion written by hand for each, integrated by the classical Runge-Kutta method in
 * steps so short that their error is that of rounding, with events found by bisection.
 *
 * A method without control of its error must come nearer with its order as the step is halved; one
 * with a tolerance must keep within a hundred times that.
 */
#ifndef STANCE_TESTS_MOTIONS_H
#define STANCE_TESTS_MOTIONS_H

#include "cases.h"
#include "mechanism_text.h"
#include "tests.h"

#include "engine/tree.h"

#define G STANCE_GRAVITY

/* ---- robots and runs --------------------------------------------------------------------------*/

struct robot {
    stance_scene *scene;
    stance_case c;
};

/* A robot whose scene goes when its block ends. */
#define ROBOT FREED(robot_gone) struct robot
static inline void robot_gone(struct robot *r)
{
    stance_scene_free(r->scene);
}

/* Put together in pieces: pushes have no line in a text. */
static inline struct robot robot_of(const char *text, double slope)
{
    struct robot r = {.scene = mechanism_scene(text)};
    stance_robot_fallback(r.scene, r.c.robot);
    r.c.scene = r.scene;
    r.c.robot[STANCE_ROBOT_SLOPE] = slope;
    r.c.contacts = (1u << r.scene->contacts) - 1;
    r.c.friction = 1;
    r.c.torque_limit = INFINITY;
    return r;
}

/* To time T, in steps of h; event-driven and capturing as exactly as their defaults are. */
static inline stance_result attempt(const struct robot *r, const stance_method *method, double h,
                                    double T)
{
    stance_result end;
    stance_case c = r->c;
    c.scene = r->scene;
    c.tree = r->scene->tree;
    c.step = h;
    c.steps = (int64_t)lround(T / h);
    c.tolerance = method->tolerance;
    stance_tree_numbers_make(r->scene->tree, r->scene->mechanism, c.robot, &c.body);
    stance_kernel_find(r->scene, method, NULL)->run(&c, &end, 1);
    return end;
}
static inline stance_result run(const struct robot *r, const stance_method *method, double h,
                                double T)
{
    const stance_result end = attempt(r, method, h, T);
    if (end.status != STANCE_DONE)
        fail_msg("%s, step %g: %s", method->name, h, stance_failure_text[end.failure]);
    return end;
}

static inline void near(const char *method, const char *what, double got, double wanted,
                        double tolerance)
{
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%s: %s is %.15g in place of %.15g, off by %.3g, admitted %.3g", method, what, got,
                 wanted, fabs(got - wanted), tolerance);
}

/* ---- the independent integration --------------------------------------------------------------*/

enum { MOST = 2 * STANCE_MAX_COORDINATES };

/* rate = f(t, x), x = (q, v) */
typedef void motion(double t, const double *x, double *rate);

static inline void runge_kutta(motion *f, int n, double t, double h, double *x)
{
    double k[4][MOST], y[MOST];
    f(t, x, k[0]);
    for (int stage = 1; stage < 4; stage++) {
        const double part = stage < 3 ? h / 2 : h;
        for (int i = 0; i < n; i++)
            y[i] = x[i] + part * k[stage - 1][i];
        f(t + part, y, k[stage]);
    }
    for (int i = 0; i < n; i++)
        x[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* From t on until T, or until `event` < 0: returns the time. */
static inline double integrate(motion *f, int n, double t, double T,
                               double (*event)(const double *x), double *x)
{
    const int steps = 1 + (int)((T - t) * 2e4);
    const double h = (T - t) / steps;
    for (int k = 0; k < steps; k++) {
        double next[MOST], low = 0, high = h;
        memcpy(next, x, sizeof next);
        runge_kutta(f, n, t + k * h, h, next);
        if (event && event(next) < 0) {
            while (high - low > 1e-15) {
                const double half = (low + high) / 2;
                memcpy(next, x, sizeof next);
                runge_kutta(f, n, t + k * h, half, next);
                *(event(next) < 0 ? &high : &low) = half;
            }
            runge_kutta(f, n, t + k * h, high, x);
            return t + k * h + high;
        }
        memcpy(x, next, sizeof next);
    }
    return T;
}

/* Largest difference of a state at the end from x = (q, v). */
static inline double off(const struct robot *r, const stance_result *end, const double *x)
{
    const int n = r->scene->coordinates;
    double worst = 0;
    for (int i = 0; i < n; i++)
        worst = fmax(worst, fmax(fabs(end->position[i] - x[i]), fabs(end->velocity[i] - x[n + i])));
    return worst;
}

/* Every method comes to x at T with its order; h is the longest of the steps. `first`: 0 for smooth
 * motions; where events are passed, which implicit steps know to order 1 and somewhere in a step,
 * the largest error over h that is admitted. */
static inline void arrives(const char *what, const struct robot *r, double h, double T,
                           const double *x, double first)
{
    for (const stance_method *const *m = stance_methods(); *m; m++) {
        enum { HALVINGS = 4 };
        double error[HALVINGS + 1], worst = 0;
        if (!stance_kernel_find(r->scene, *m, NULL))
            continue;
        const int last = (*m)->tolerance > 0 ? 0 : HALVINGS;
        for (int k = 0; k <= last; k++) {
            const stance_result end = run(r, *m, ldexp(h, -k), T);
            error[k] = off(r, &end, x);
            worst = fmax(worst, error[k] / ldexp(h, -k));
        }
        if (last == 0) {
            print_message("# %s, %s: %.1e of its tolerance\n", what, (*m)->name,
                          error[0] / (*m)->tolerance);
            assert_true(error[0] <= 100 * (*m)->tolerance);
            continue;
        }
        const double order = log2(error[0] / error[last]) / last;
        print_message("# %s, %s: order %.2f, error %.1e, at most %.1f h\n", what, (*m)->name, order,
                      error[last], worst);
        if (error[last] <= 1e-11)
            continue;
        if (first > 0 && (*m)->order_smooth <= 2)
            assert_true(worst <= first);
        else
            assert_true(order > (*m)->order_smooth - 0.2);
    }
}

static inline void start(struct robot *r, double *x)
{
    const int n = r->scene->coordinates;
    for (int i = 0; i < n; i++)
        x[i] = r->c.position[i], x[n + i] = r->c.velocity[i];
}

/* A robot of such a mass in flight, from a random state within these bounds: momentum as gravity
 * gives it, energy. */
static inline void flies(const char *text, double mass, double places, double rates)
{
    ROBOT r = robot_of(text, 0.2);
    const int n = r.scene->coordinates;
    double A[STANCE_MAX_COORDINATES * STANCE_MAX_COORDINATES];
    uint64_t seed = 5;
    for (int i = 0; i < n; i++) {
        r.c.position[i] = uniform(&seed, -places, places);
        r.c.velocity[i] = uniform(&seed, -rates, rates);
    }
    const double energy = r.scene->energy(r.scene, r.c.robot, r.c.position, r.c.velocity);
    for (const stance_method *const *m = stance_methods(); *m; m++) {
        if ((*m)->order_smooth < 4)
            continue;
        const stance_result end = run(&r, *m, 1e-3, 0.5);
        double momentum[2] = {0, -mass * G * 0.5};
        for (int k = 0; k < 2; k++)
            for (int late = 0; late < 2; late++) {
                const double *const v = late ? end.velocity : r.c.velocity;
                r.scene->inertia(r.scene, r.c.robot, late ? end.position : r.c.position, A);
                for (int i = 0; i < n; i++)
                    momentum[k] += (late ? -1 : 1) * A[k * n + i] * v[i];
            }
        near((*m)->name, "forward momentum", momentum[0], 0, 1e-6);
        near((*m)->name, "momentum upwards", momentum[1], 0, 1e-6);
        near((*m)->name, "energy", r.scene->energy(r.scene, r.c.robot, end.position, end.velocity),
             energy, 1e-6 * fabs(energy));
    }
}

#endif
