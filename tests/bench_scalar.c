/* bench_scalar.c - the implicit step written by hand for one robot at a time, and timed beside the
 * one-lane kernel.
 *
 * What an engineer would write who needs nothing but this: the biped on one foot, theta = 1, linear
 * law sampled each step, in plain C. The equations are those of engine/scenes/tree_lanes.h and
 * engine/core/implicit/step.h: hip and absolute angles, the angles eliminated from Newton's matrix,
 * a 2 x 2 Schur complement, one contact in closed form (open, stick, slip). As in the kernels,
 * Newton starts from the velocity that the last two changes point to and from the last impulses.
 * What it may do and a general kernel may not: sines of later iterates come from turning those of
 * the first by a small angle, zeros in the contact's columns are known, there is one contact.
 *
 * What it leaves out, and the kernel does: other contacts, restitution, noise, delay, switching;
 * the answers but the final state (largest residuals, friction used, slip, torque, energies,
 * ambiguity); judging whether the robot fell or stands; the check that a step gained no energy, and
 * its subdivision where Newton fails; recording; ranges of angles.
 *
 * Final states are compared with those of the kernel, which leaves an error of 1e-11 of the
 * velocity in each step (ORDINARY_ERROR); a robot that topples makes of any difference a larger
 * one. Each case may differ by 1e-9, and for each step by what such an error at its start makes of
 * it.
 */
#include "analysis/bench/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CASES = 128, ROUNDS = 31, MOST_ITERATIONS = 25 };

static const double converged = 1e-7;  /* last correction of Newton's iteration, as the kernels */
static const double on_ground = 1e-13; /* m */
static const double nudge = 1e-11;     /* rad, rad/s */

enum { TRUNK, LEG, FREE, ANGLES };

struct robot {
    double mass, leg, trunk, friction;
    double coupling[ANGLES], inertia[ANGLES];
};

struct state {
    double p[2], angle[ANGLES]; /* hip (x, z); trunk, leg that stands, other leg */
    double v[2], rate[ANGLES];
    double sine[ANGLES], cosine[ANGLES];
    double dv[2], drate[ANGLES];   /* changes of the velocities in the step before ... */
    double dv1[2], drate1[ANGLES]; /* ... and in the one before that */
    double normal, tangential;     /* impulses of that step, N s */
};

/* To 1e-16 for |x| < 1e5: reduction by multiples of pi/2 in two parts, Taylor's series. */
static inline void sine_cosine(double x, double *sine, double *cosine)
{
    const double n = nearbyint(x * 0.63661977236758134);
    const double r = (x - n * 1.5707963267341256) - n * 6.0771005065061922e-11, t = r * r;
    const double s =
        r + r * t *
                (-1. / 6 + t * (1. / 120 + t * (-1. / 5040 +
                                                t * (1. / 362880 + t * (-1. / 39916800 +
                                                                        t * (1. / 6227020800.))))));
    const double c =
        1 -
        t * (0.5 - t * (1. / 24 -
                        t * (1. / 720 - t * (1. / 40320 -
                                             t * (1. / 3628800 - t * (1. / 479001600. -
                                                                      t * (1. / 87178291200.)))))));
    switch ((int)n & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
    }
}

/* Turns sine and cosine by a small angle. */
static inline void turn(double x, double *sine, double *cosine)
{
    const double half = 0.5 * x * x, third = x - x * half * (1. / 3);
    const double s = *sine, c = *cosine;
    *sine = s + (c * third - s * half);
    *cosine = c - (s * third + c * half);
}
static const double small_angle = 1e-4; /* its fourth power is nothing */

/* Impulse of the contact with free velocity u (normal, tangential) and Delassus operator D. */
static inline void contact(const double D[2][2], const double u[2], double friction, double *normal,
                           double *tangential)
{
    *normal = *tangential = 0;
    if (u[0] >= 0)
        return;
    const double reciprocal = 1 / (D[0][0] * D[1][1] - D[0][1] * D[1][0]);
    const double n = (D[0][1] * u[1] - D[1][1] * u[0]) * reciprocal;
    const double t = (D[1][0] * u[0] - D[0][0] * u[1]) * reciprocal;
    if (n >= 0 && fabs(t) <= friction * n) {
        *normal = n, *tangential = t;
        return;
    }
    const double edge = t > 0 ? friction : -friction;
    *normal = fmax(-u[0] / (D[0][0] + edge * D[0][1]), 0);
    *tangential = edge * *normal;
}

/* One step of length h under the torques tau on (trunk, leg, other leg). False: Newton's iteration
 * did not converge. */
static bool step(const struct robot *b, struct state *s, const double tau[ANGLES], double h)
{
    const double hg = h * STANCE_GRAVITY;
    const double v0[2] = {s->v[0], s->v[1]};
    const double rate0[ANGLES] = {s->rate[0], s->rate[1], s->rate[2]};
    double v[2], rate[ANGLES], sine[ANGLES], cosine[ANGLES];
    double lift[2 + ANGLES] = {0}; /* response to a normal impulse */
    double normal = s->normal, tangential = s->tangential, correction = INFINITY;
    bool active = s->p[1] - b->leg * s->cosine[LEG] <= 1e-12;

    for (int i = 0; i < 2; i++)
        v[i] = v0[i] + 2 * s->dv[i] - s->dv1[i];
    for (int a = 0; a < ANGLES; a++) {
        rate[a] = rate0[a] + 2 * s->drate[a] - s->drate1[a];
        sine_cosine(s->angle[a] + h * rate[a], &sine[a], &cosine[a]);
    }
    if (!active)
        normal = tangential = 0;
    for (int k = 0; correction > converged; k++) {
        if (k == MOST_ITERATIONS)
            return false;
        /* Residual and matrix: rows of the angles, columns of the hip, the angles' diagonal. */
        const double dx = v[0] - v0[0], dz = v[1] - v0[1] + hg;
        double x = b->mass * dx, z = b->mass * dz, row[ANGLES][2], column[ANGLES][2];
        double residual[ANGLES], inverse[ANGLES];
        for (int a = 0; a < ANGLES; a++) {
            const double kc = b->coupling[a] * cosine[a], ks = b->coupling[a] * sine[a];
            const double w = rate[a], dw = w - rate0[a], centrifugal = h * (w * w);
            const double across = h * (dw + 2 * w), along = 1 - h * centrifugal;
            x += kc * dw - ks * centrifugal;
            z += ks * dw + kc * centrifugal;
            residual[a] = b->inertia[a] * dw + (kc * dx + ks * dz) - h * tau[a];
            row[a][0] = kc, row[a][1] = ks;
            column[a][0] = kc * along - ks * across;
            column[a][1] = ks * along + kc * across;
            inverse[a] = b->inertia[a] + h * (kc * dz - ks * dx);
        }
        const double ls = b->leg * sine[LEG], lc = b->leg * cosine[LEG];
        inverse[LEG] -= h * (lc * normal - ls * tangential);
        double xx = b->mass, xz = 0, zx = 0, zz = b->mass;
        for (int a = 0; a < ANGLES; a++) {
            inverse[a] = 1 / inverse[a];
            const double y0 = inverse[a] * row[a][0], y1 = inverse[a] * row[a][1];
            xx -= column[a][0] * y0, zx -= column[a][1] * y0;
            xz -= column[a][0] * y1, zz -= column[a][1] * y1;
        }
        const double reciprocal = 1 / (xx * zz - xz * zx);
        const double S[2][2] = {{zz * reciprocal, -xz * reciprocal},
                                {-zx * reciprocal, xx * reciprocal}};
        /* Free correction. */
        double d[2 + ANGLES];
        for (int a = 0; a < ANGLES; a++) {
            x -= column[a][0] * (inverse[a] * residual[a]);
            z -= column[a][1] * (inverse[a] * residual[a]);
        }
        d[0] = -(S[0][0] * x + S[0][1] * z);
        d[1] = -(S[1][0] * x + S[1][1] * z);
        for (int a = 0; a < ANGLES; a++)
            d[2 + a] = -inverse[a] * (residual[a] + row[a][0] * d[0] + row[a][1] * d[1]);
        /* The foot: velocity, its derivative, responses to impulses along z and x. */
        if (active) {
            const double swing = h * rate[LEG], slope[2] = {ls + swing * lc, lc - swing * ls};
            double response[2][2 + ANGLES], D[2][2];
            for (int j = 0; j < 2; j++) {
                const double arm = inverse[LEG] * (j == 0 ? ls : lc);
                const double px = (j == 0 ? 0 : 1) - column[LEG][0] * arm;
                const double pz = (j == 0 ? 1 : 0) - column[LEG][1] * arm;
                double *const r = response[j];
                r[0] = S[0][0] * px + S[0][1] * pz;
                r[1] = S[1][0] * px + S[1][1] * pz;
                for (int a = 0; a < ANGLES; a++)
                    r[2 + a] = -inverse[a] * (row[a][0] * r[0] + row[a][1] * r[1]);
                r[2 + LEG] += arm;
                D[0][j] = r[1] + slope[0] * r[2 + LEG];
                D[1][j] = r[0] + slope[1] * r[2 + LEG];
            }
            const double u[2] = {v[1] + ls * rate[LEG] + d[1] + slope[0] * d[2 + LEG],
                                 v[0] + lc * rate[LEG] + d[0] + slope[1] * d[2 + LEG]};
            /* The residual knows nothing of the last impulses: these are whole ones. */
            contact((const double(*)[2])D, u, b->friction, &normal, &tangential);
            for (int i = 0; i < 2 + ANGLES; i++) {
                d[i] += response[0][i] * normal + response[1][i] * tangential;
                lift[i] = response[0][i];
            }
        }
        /* Update; sines and cosines of the new angles. */
        double speed = 1;
        correction = 0;
        for (int i = 0; i < 2; i++) {
            v[i] += d[i];
            correction += fabs(d[i]);
            speed = fmax(speed, fabs(v[i]));
        }
        for (int a = 0; a < ANGLES; a++) {
            rate[a] += d[2 + a];
            correction += fabs(d[2 + a]);
            speed = fmax(speed, fabs(rate[a]));
            if (h * fabs(d[2 + a]) < small_angle)
                turn(h * d[2 + a], &sine[a], &cosine[a]);
            else
                sine_cosine(s->angle[a] + h * rate[a], &sine[a], &cosine[a]);
        }
        correction /= speed;
        if (!active && s->p[1] + h * v[1] - b->leg * cosine[LEG] <= 0) {
            active = true;
            correction = INFINITY;
        }
    }

    for (int i = 0; i < 2; i++) {
        s->p[i] += h * v[i];
        s->dv1[i] = s->dv[i];
        s->dv[i] = v[i] - v0[i];
        s->v[i] = v[i];
    }
    for (int a = 0; a < ANGLES; a++) {
        s->angle[a] += h * rate[a];
        s->drate1[a] = s->drate[a];
        s->drate[a] = rate[a] - rate0[a];
        s->rate[a] = rate[a];
    }
    /* What the velocity law left of the gap is removed along the response to a normal impulse. */
    double gap = s->p[1] - b->leg * cosine[LEG];
    while (active && (normal > 0 ? fabs(gap) : -gap) > on_ground) {
        const double multiplier = -gap / (lift[1] + b->leg * sine[LEG] * lift[2 + LEG]);
        for (int i = 0; i < 2; i++)
            s->p[i] += multiplier * lift[i];
        for (int a = 0; a < ANGLES; a++) {
            s->angle[a] += multiplier * lift[2 + a];
            if (fabs(multiplier * lift[2 + a]) < small_angle)
                turn(multiplier * lift[2 + a], &sine[a], &cosine[a]);
            else
                sine_cosine(s->angle[a], &sine[a], &cosine[a]);
        }
        gap = s->p[1] - b->leg * cosine[LEG];
    }
    for (int a = 0; a < ANGLES; a++)
        s->sine[a] = sine[a], s->cosine[a] = cosine[a];
    s->normal = normal, s->tangential = tangential;
    return true;
}

/* Runs a case to its end; position and velocity as in stance_result. */
static bool simulate(const stance_case *c, double *position, double *velocity)
{
    const double l = c->robot[0], lt = c->robot[1], m = c->robot[2], mt = c->robot[3];
    const struct robot b = {.mass = mt + c->robot[4] + 2 * m,
                            .leg = l,
                            .trunk = lt,
                            .friction = c->friction,
                            .coupling = {-mt * lt, m * l, m * l},
                            .inertia = {mt * lt * lt, m * l * l, m * l * l}};
    struct state s = {0};
    for (int a = 0; a < ANGLES; a++) {
        s.angle[a] = c->position[2] + (a ? c->position[2 + a] : 0);
        s.rate[a] = c->velocity[2] + (a ? c->velocity[2 + a] : 0);
        sine_cosine(s.angle[a], &s.sine[a], &s.cosine[a]);
    }
    s.p[0] = c->position[0] + lt * s.sine[TRUNK];
    s.p[1] = c->position[1] - lt * s.cosine[TRUNK];
    s.v[0] = c->velocity[0] + lt * s.cosine[TRUNK] * s.rate[TRUNK];
    s.v[1] = c->velocity[1] + lt * s.sine[TRUNK] * s.rate[TRUNK];
    for (int64_t k = 0; k < c->steps; k++) {
        const double x[6] = {s.angle[0] - c->near.target[0],
                             s.angle[1] - s.angle[0] - c->near.target[1],
                             s.angle[2] - s.angle[0] - c->near.target[2],
                             s.rate[0],
                             s.rate[1] - s.rate[0],
                             s.rate[2] - s.rate[0]};
        double torque[2];
        for (int i = 0; i < 2; i++) {
            torque[i] = c->near.feedforward[i];
            for (int j = 0; j < 6; j++)
                torque[i] -= c->near.gain[i][j] * x[j];
            torque[i] = fmax(fmin(torque[i], c->torque_limit), -c->torque_limit);
        }
        const double tau[ANGLES] = {-(torque[0] + torque[1]), torque[0], torque[1]};
        if (!step(&b, &s, tau, c->step))
            return false;
    }
    position[0] = s.p[0] - lt * s.sine[TRUNK];
    position[1] = s.p[1] + lt * s.cosine[TRUNK];
    velocity[0] = s.v[0] - lt * s.cosine[TRUNK] * s.rate[TRUNK];
    velocity[1] = s.v[1] - lt * s.sine[TRUNK] * s.rate[TRUNK];
    for (int a = 0; a < ANGLES; a++) {
        position[2 + a] = s.angle[a] - (a ? s.angle[0] : 0);
        velocity[2 + a] = s.rate[a] - (a ? s.rate[0] : 0);
    }
    return true;
}

static double run_by_hand(const stance_case *cases, stance_result *results)
{
    const double begin = bench_clock();
    for (int i = 0; i < CASES; i++)
        if (!simulate(&cases[i], results[i].position, results[i].velocity))
            results[i].position[0] = NAN; /* found by the comparison */
    return bench_clock() - begin;
}

static double run_kernel(const stance_kernel *kernel, const stance_case *cases,
                         stance_result *results)
{
    const double begin = bench_clock();
    kernel->run(cases, results, CASES);
    return bench_clock() - begin;
}

/* Largest difference of final states; INFINITY where one is not finite. */
static double apart(const stance_result *a, const stance_result *b)
{
    double largest = 0;
    for (int k = 0; k < STANCE_MAX_COORDINATES; k++) {
        const double x = fabs(a->position[k] - b->position[k]);
        const double v = fabs(a->velocity[k] - b->velocity[k]);
        largest = isfinite(x + v) ? fmax(largest, fmax(x, v)) : INFINITY;
    }
    return largest;
}

int main(void)
{
    static stance_case cases[CASES];
    static stance_result by_hand[CASES], by_kernel[CASES], moved[CASES];
    const stance_scene *const scene = stance_scene_find("biped");
    const stance_kernel *const kernel =
        stance_kernel_find(scene, stance_method_find("implicit"), "scalar");
    double hand[ROUNDS], machine[ROUNDS], ratio[ROUNDS];

    if (!kernel || !bench_cases(scene, "one foot", cases, CASES)) {
        fprintf(stderr, "bench_scalar: no scalar kernel, or no cases for it\n");
        return 1;
    }
    const double steps = CASES * (double)cases[0].steps;
    for (int r = -1; r < ROUNDS; r++) { /* the first warms up */
        const double a = run_by_hand(cases, by_hand), b = run_kernel(kernel, cases, by_kernel);
        if (r >= 0)
            hand[r] = 1e9 * a / steps, machine[r] = 1e9 * b / steps, ratio[r] = b / a;
    }
    double off = 0, allowed = 0; /* the worst, and by its share of what is allowed */
    for (int i = 0; i < CASES; i++)
        for (int k = 2; k < 2 + ANGLES; k++)
            cases[i].position[k] += nudge, cases[i].velocity[k] += nudge;
    run_by_hand(cases, moved);
    for (int i = 0; i < CASES; i++) {
        const double d = apart(&by_hand[i], &by_kernel[i]);
        const double may = 1e-9 + (double)cases[i].steps * apart(&by_hand[i], &moved[i]);
        off = fmax(off, d),
        allowed = d < INFINITY && may < INFINITY ? fmax(allowed, d / may) : INFINITY;
    }
    struct bench_row row = {"scalar by hand",
                            "biped",
                            "one foot",
                            "implicit",
                            "scalar",
                            1,
                            1,
                            cases[0].step,
                            CASES,
                            ROUNDS,
                            "time per step",
                            "ns",
                            bench_spread(hand, ROUNDS)};
    const struct bench_spread kernel_ns = bench_spread(machine, ROUNDS),
                              ratios = bench_spread(ratio, ROUNDS);
    fprintf(
        stderr,
        "by hand %.1f ns a step, one-lane kernel %.1f: ratio %.2f (%.2f ... %.2f), final states "
        "within %.1e, the worst at %.2f of what is allowed\n",
        row.value.median, kernel_ns.median, ratios.median, ratios.lowest, ratios.highest, off,
        allowed);
    bench_csv_row(stdout, &row);
    row.subject = "stance";
    row.quantity = "ratio to scalar by hand", row.unit = "1", row.value = ratios;
    bench_csv_row(stdout, &row);
    row.quantity = "difference from scalar by hand", row.unit = "m rad m/s rad/s";
    row.value = (struct bench_spread){off, off, off};
    bench_csv_row(stdout, &row);
    if (!(allowed <= 1)) {
        fprintf(stderr, "bench_scalar: final states differ by %.1e\n", off);
        return 1;
    }
    return 0;
}
