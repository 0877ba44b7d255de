/* rest_linear.h - an equilibrium near a state, and the motion about it to first order: the
 * equations are in rest.h. */
#ifndef STANCE_CORE_LOOP_REST_LINEAR_H
#define STANCE_CORE_LOOP_REST_LINEAR_H

#include "matrix.h"
#include "program.h"

#define REST_ROUNDS 10
#define REST_STILL 1e-8 /* m/s^2, rad/s^2: an acceleration that is none */
#define REST_NEAR 1e-5  /* m, rad: half the width of the differences */
#define REST_HOLDS 4096 /* times settle.hold: how long it has to hold */
#define REST_WHOLE 2048 /* s, at least */
#define REST_GROWTH                                                                                \
    1e9 /* SI units: a disturbance that grows beyond this in that time does not hold */
#define REST_EDGE 1e-6  /* of a cone: what it is wider here */
#define REST_CREEP 1e-6 /* m/s: a contact this slow stands */
#define REST_MARGIN 2   /* for what is not linear */
#define REST_FINE 32    /* of settle.hold: how closely the way to the equilibrium is looked at */
#define REST_GONE 1e-3  /* of settle.angle and settle.rate: a deviation that is none */
#define REST_BENT 0.05  /* of what a law adds to the torques: how far from linear that may be */
#define REST_RAMP 0.5   /* of a sample: how long a torque of limited rate may take to come up */
#define REST_ENDLESS 1e100

enum { REST_INPUTS = SCENE_ACTUATORS, REST_STATES = MATRIX_ROOM };

/* The neighbourhood of a state of rest in one lane. */
struct rest {
    const struct setting *set;
    const stance_case *of;
    const double *known; /* of a program: STANCE_SAMPLE_HEAD numbers */
    int lane;
    double angle, speed, hold, T; /* what settle asks, and the time from sample to sample */
    lanes t;
    struct contact_state mode;
    lanes s[SCENE_COORDINATES], integral[ACTUATORS];
    int ways;                                       /* columns of Z ... */
    double Z[SCENE_COORDINATES][SCENE_COORDINATES]; /* ... [way][coordinate], orthonormal */
    /* By the ways' places, their rates, the integrals; and accelerations by torques. */
    double K[SCENE_COORDINATES][SCENE_COORDINATES], B[SCENE_COORDINATES][ACTUATORS];
    double C[3][ACTUATORS][REST_STATES], E[3][ACTUATORS][REST_STATES];
    double torque[ACTUATORS]; /* at the equilibrium */
    bool lags;                /* the actuators, with `lag` and `rate`, see actuator.h */
    double lag, rate;
    int delay;                     /* samples */
    double under_way[REST_STATES]; /* torques now, if they lag, and commands, the next one first */
};

static bool rest_fallen(const struct rest *r, const lanes *s)
{
    scene_trig trig;
    scene_trigonometry(s, &trig);
    return mask_get(motion_fallen(r->set, s, &trig), r->lane);
}

/* What a program that remembers nothing commands; the feet are those of the mode. */
COLD void rest_program(const struct rest *r, const lanes *s, const lanes *w, lanes *torque)
{
    const stance_program *const program = r->of->program;
    scene_trig trig;
    struct program_measured is;
    scene_trigonometry(s, &trig);
    program_measure(r->set, true, s, w, &trig, &is);
    double *const sample = mask_get(is.near, r->lane) ? NULL : program->begin(program, r->of);
    if (!sample)
        return;
    memcpy(sample, r->known, STANCE_SAMPLE_HEAD * sizeof *sample);
    program_sample(&is, r->mode.closed, r->lane, sample);
    const double *const command = program->act(program, r->of, sample);
    for (int i = 0; i < OWN_ACTUATORS; i++)
        lane_set(&torque[i], r->lane, command ? command[i] : NAN);
    program->end(program, sample);
}

/* Torques that the law commands, limited, and the rates of its integrals. */
COLD void rest_law(const struct rest *r, const lanes *s, const lanes *w, const lanes *integral,
                   lanes *torque, lanes *rate)
{
    struct dynamics e;
    const struct law *const law = &r->set->law;
    law_sampled(law, s, w, torque);
    for (int i = 0; i < ACTUATORS; i++)
        rate[i] = lanes_of(0);
    if (REST_INPUTS > 0 && mask_any(mask_less(lanes_of(0), law->decouples + law->switches))) {
        const struct state at = {r->t, s, w, integral};
        scene_trigonometry(s, &e.trig);
        const mask servos = law_command(r->set, LANES_ALL, &at, &r->mode, &e, torque);
        for (int i = 0; i < REST_INPUTS; i++)
            rate[i] = choose(servos, e.integral_rate[i], rate[i]);
    }
    if (REST_INPUTS > 0 && r->of->program)
        rest_program(r, s, w, torque);
    law_clip(law, torque);
}

/* Everything that holds at s with w = 0 and these torques; forces and accelerations in the mode. */
static void rest_evaluate(const struct rest *r, const lanes *s, const lanes *torque,
                          struct dynamics *e)
{
    lanes still[SCENE_COORDINATES];
    for (int i = 0; i < SCENE_COORDINATES; i++)
        still[i] = lanes_of(0);
    const struct state at = {.t = r->t, .s = s, .w = still};
    scene_trigonometry(s, &e->trig);
    dynamics_evaluate(r->set, &at, torque, CONTACT_ALL, false, e);
}

/* Accelerations along the ways. */
COLD void rest_accelerations(const struct rest *r, const lanes *s, const lanes *torque, double *out)
{
    struct dynamics e;
    rest_evaluate(r, s, torque, &e);
    between_solve(r->set, &r->mode, &e);
    for (int k = 0; k < r->ways; k++) {
        out[k] = 0;
        for (int i = 0; i < SCENE_COORDINATES; i++)
            out[k] += r->Z[k][i] * lane_get(&e.acceleration[i], r->lane);
    }
}

/* What the contacts do at s; false: some slide, or no forces hold them. */
COLD bool rest_mode(const struct rest *r, const lanes *s, const lanes *torque,
                    struct contact_state *mode)
{
    struct dynamics e;
    struct between_trouble trouble;
    lanes stood[CONTACTS];
    for (int c = 0; c < OWN_CONTACTS; c++)
        stood[c] = lanes_of(1);
    rest_evaluate(r, s, torque, &e);
    between_mode(r->set, &e, CONTACT_ALL, stood, mode, &trouble);
    bool stands = !mask_get(trouble.none | trouble.impact, r->lane);
    for (int c = 0; c < OWN_CONTACTS; c++)
        if (contact_grip(c) >= 0 && mask_get(mode->closed[c], r->lane) &&
            lane_get(&r->set->friction, r->lane) > 0)
            stands &= lane_get(&mode->slide[c], r->lane) == 0;
    return stands;
}

/* Adds v to an orthonormal family of n rows, unless it depends on them; returns how many there are.
 */
static int rest_add(double family[][SCENE_COORDINATES], int n, const double *v)
{
    double rest[SCENE_COORDINATES], before = 0, after = 0;
    memcpy(rest, v, sizeof rest);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        before += v[i] * v[i];
    for (int round = 0; round < 2; round++)
        for (int k = 0; k < n; k++) {
            double along = 0;
            for (int i = 0; i < SCENE_COORDINATES; i++)
                along += family[k][i] * rest[i];
            for (int i = 0; i < SCENE_COORDINATES; i++)
                rest[i] -= along * family[k][i];
        }
    for (int i = 0; i < SCENE_COORDINATES; i++)
        after += rest[i] * rest[i];
    if (!(after > MATRIX_RANK * before) || n == SCENE_COORDINATES)
        return n;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        family[n][i] = rest[i] / sqrt(after);
    return n + 1;
}

/* The ways that standing contacts leave: what is orthogonal to their rows. */
COLD void rest_ways(struct rest *r)
{
    double family[SCENE_COORDINATES][SCENE_COORDINATES];
    lanes rows[2][SCENE_COORDINATES];
    scene_trig trig;
    int n = 0;
    scene_trigonometry(r->s, &trig);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        if (!mask_get(r->mode.closed[c], r->lane))
            continue;
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            lanes unit[SCENE_COORDINATES], u[2];
            for (int k = 0; k < SCENE_COORDINATES; k++)
                unit[k] = lanes_of(k == i);
            scene_contact_velocity(&r->set->body, &trig, c, unit, u);
            rows[0][i] = u[0], rows[1][i] = u[1];
        }
        const bool sticks = contact_grip(c) >= 0 && lane_get(&r->set->friction, r->lane) > 0;
        for (int a = 0; a < (sticks ? 2 : 1); a++) {
            double row[SCENE_COORDINATES];
            for (int i = 0; i < SCENE_COORDINATES; i++)
                row[i] = lane_get(&rows[a][i], r->lane);
            n = rest_add(family, n, row);
        }
    }
    const int held = n;
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        double unit[SCENE_COORDINATES] = {0};
        unit[i] = 1;
        n = rest_add(family, n, unit);
    }
    r->ways = n - held;
    memcpy(r->Z, family[held], sizeof *family * (size_t)r->ways);
}

/* Difference of two sets of torques or rates, over the width of the differences. */
static void rest_slope(const struct rest *r, const lanes *high, const lanes *low, int column,
                       double (*out)[REST_STATES])
{
    for (int i = 0; i < REST_INPUTS; i++)
        out[i][column] =
            (lane_get(&high[i], r->lane) - lane_get(&low[i], r->lane)) / (2 * REST_NEAR);
}

/* Derivatives about the present place. */
COLD void rest_linearise(struct rest *r, const lanes *torque)
{
    for (int kind = 0; kind < 3; kind++) {
        const int columns = kind < 2 ? r->ways : REST_INPUTS;
        for (int j = 0; j < columns; j++) {
            lanes command[2][ACTUATORS], rate[2][ACTUATORS];
            double a[2][SCENE_COORDINATES];
            for (int side = 0; side < 2; side++) {
                const double by = side == 0 ? REST_NEAR : -REST_NEAR;
                lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES], integral[ACTUATORS];
                for (int i = 0; i < SCENE_COORDINATES; i++) {
                    s[i] = r->s[i] + (kind == 0 ? by * r->Z[j][i] : 0);
                    w[i] = lanes_of(kind == 1 ? by * r->Z[j][i] : 0);
                }
                for (int i = 0; i < ACTUATORS; i++)
                    integral[i] = r->integral[i] + (kind == 2 && i == j ? by : 0);
                rest_law(r, s, w, integral, command[side], rate[side]);
                if (kind == 0)
                    rest_accelerations(r, s, torque, a[side]);
            }
            rest_slope(r, command[0], command[1], j, r->C[kind]);
            rest_slope(r, rate[0], rate[1], j, r->E[kind]);
            for (int k = 0; k < r->ways && kind == 0; k++)
                r->K[k][j] = (a[0][k] - a[1][k]) / (2 * REST_NEAR);
        }
    }
    for (int j = 0; j < REST_INPUTS; j++) {
        double a[2][SCENE_COORDINATES];
        for (int side = 0; side < 2; side++) {
            lanes more[ACTUATORS];
            for (int i = 0; i < ACTUATORS; i++)
                more[i] = torque[i] + (i == j ? (side == 0 ? 1 : -1) : 0);
            rest_accelerations(r, r->s, more, a[side]);
        }
        for (int k = 0; k < r->ways; k++)
            r->B[k][j] = (a[0][k] - a[1][k]) / 2;
    }
}

/* One of Newton's iterations towards the equilibrium; *off: how far the accelerations (and rates of
 * the integrals) were from zero. */
COLD void rest_approach(struct rest *r, double *off)
{
    const int d = r->ways;
    lanes torque[ACTUATORS], rate[ACTUATORS], still[SCENE_COORDINATES];
    double b[REST_STATES], x[REST_STATES], a[SCENE_COORDINATES];
    small_matrix M;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        still[i] = lanes_of(0);
    rest_law(r, r->s, still, r->integral, torque, rate);
    rest_accelerations(r, r->s, torque, a);
    *off = 0;
    for (int i = 0; i < d + REST_INPUTS; i++) {
        b[i] = -(i < d ? a[i] : lane_get(&rate[i - d], r->lane));
        if (!(fabs(b[i]) <= *off)) /* a NAN, too; no fmax: gcc 12 for ARM fails on it */
            *off = b[i] == b[i] ? fabs(b[i]) : INFINITY;
    }
    if (*off <= REST_STILL)
        return;
    rest_linearise(r, torque);
    for (int i = 0; i < d + REST_INPUTS; i++)
        for (int j = 0; j < d + REST_INPUTS; j++) {
            const int kind = j < d ? 0 : 2, from = j < d ? j : j - d;
            M[i][j] = i < d ? (j < d ? r->K[i][j] : 0) : r->E[kind][i - d][from];
            for (int k = 0; k < REST_INPUTS && i < d; k++)
                M[i][j] += r->B[i][k] * r->C[kind][k][from];
        }
    matrix_solve(d + REST_INPUTS, M, b, x);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        double move = 0;
        for (int k = 0; k < d; k++)
            move += r->Z[k][i] * x[k];
        r->s[i] = r->s[i] + move;
    }
    for (int i = 0; i < REST_INPUTS; i++)
        r->integral[i] = r->integral[i] + x[d + i];
    struct dynamics e;
    rest_evaluate(r, r->s, torque, &e);
    between_project_position(r->set, r->mode.closed, r->s, &e);
}

/* The law as rows: of u and of I' by places, rates, integrals. */
static void rest_rows(const struct rest *r, small_matrix law)
{
    const int d = r->ways, m = REST_INPUTS;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < 2 * d + m; j++) {
            const int kind = j < d ? 0 : j < 2 * d ? 1 : 2, from = j - kind * d;
            law[i][j] = r->C[kind][i][from];
            law[m + i][j] = r->E[kind][i][from];
        }
}

/* How places, rates and the torques of actuators that lag move by themselves, and by commands: x'
 * = F x with the commands last, held. Returns how many they are without the commands. */
static int rest_plant(const struct rest *r, small_matrix F)
{
    const int d = r->ways, m = REST_INPUTS, n = 2 * d + (r->lags && r->lag > 0 ? m : 0);
    matrix_clear(n + m, F);
    for (int i = 0; i < d; i++) {
        F[i][d + i] = 1;
        for (int j = 0; j < d; j++)
            F[d + i][j] = r->K[i][j];
        for (int j = 0; j < m; j++)
            F[d + i][2 * d + j] = r->B[i][j];
    }
    for (int i = 2 * d; i < n; i++)
        F[i][i] = -1 / r->lag, F[i][i + m] = 1 / r->lag;
    return n;
}

/* The map from one sample (or step) to the next, about the equilibrium, of places, rates,
 * integrals, torques (of actuators that lag), commands under way; returns its size. */
COLD int rest_map(const struct rest *r, bool samples, small_matrix M)
{
    const int d = r->ways, n = 2 * d, m = REST_INPUTS, drive = n + m;
    const int queue = drive + (r->lags ? m : 0), size = queue + r->delay * m;
    small_matrix F, law;
    const int plant = rest_plant(r, F);
    rest_rows(r, law);
    matrix_clear(size, M);
    if (!samples) { /* B u in place of B, and the integrals for the inputs */
        for (int i = 0; i < n + m; i++)
            for (int j = 0; j < n + m; j++) {
                M[i][j] = i < n ? (j < n ? F[i][j] : 0) : law[m + i - n][j];
                for (int k = 0; k < m && i < n; k++)
                    M[i][j] += F[i][n + k] * law[k][j];
            }
        matrix_exponential(n + m, M, r->T);
        return n + m;
    }
    matrix_exponential(plant + m, F, r->T);
    /* Where the command in force is found: in the queue, or (as rows) by the law. */
    for (int i = 0; i < plant; i++) {
        const int row = i < n ? i : i + m;
        for (int j = 0; j < plant; j++)
            M[row][j < n ? j : j + m] = F[i][j];
        for (int k = 0; k < m; k++) {
            if (r->delay > 0)
                M[row][queue + k] = F[i][plant + k];
            for (int j = 0; j < drive && r->delay == 0; j++)
                M[row][j] += F[i][plant + k] * law[k][j];
        }
    }
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < drive; j++) {
            M[n + i][j] = r->T * law[m + i][j] + (j == n + i ? 1 : 0);
            if (r->delay > 0)
                M[size - m + i][j] = law[i][j];
            if (r->lags && plant == n && r->delay == 0) /* a rate limit alone: see rest_keeps_up */
                M[drive + i][j] = law[i][j];
        }
        if (r->lags && plant == n && r->delay > 0)
            M[drive + i][queue + i] = 1;
        for (int k = 0; k + 1 < r->delay; k++)
            M[queue + k * m + i][queue + (k + 1) * m + i] = 1;
    }
    return size;
}

/* Does no disturbance grow beyond bounds? `time`: that M takes, `whole`: that it has to hold. */
COLD bool rest_bounded(int n, small_matrix M, double time, double whole)
{
    const double bound = REST_GROWTH * fmax(1, matrix_largest(n, M));
    for (; time < whole; time *= 2) {
        const double size = matrix_largest(n, M);
        if (!(size <= REST_ENDLESS))
            return false;
        if (n * size < 0.5) /* it decays */
            return true;
        matrix_times(n, M, M, M);
    }
    return matrix_largest(n, M) <= bound;
}

#endif
