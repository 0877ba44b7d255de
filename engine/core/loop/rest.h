/* rest.h - is there an equilibrium close by that holds?
 *
 * Slow is not at rest: a robot that topples over may take its time. `rested` and `stabilised` ask
 * for an equilibrium: with w = 0, contacts that stand (gap closed, forces inside the cones, what
 * the law commands within its limits) and no acceleration,
 *
 *   A w' = F(s, 0, t) + B torque(s, 0, I) + H^T lambda = 0,
 *
 * no further from the state than settle.angle, found by Newton's iteration along the ways that the
 * standing contacts leave (the null space Z of their H, s = s* + Z x on the ground); and that it
 * holds. About it, with central differences,
 *
 *   x'' = K x + B u,    u = C x + C' x' + C" I,    I' = E x + E' x' + E" I,
 *
 * I the integrals of a law that has them. Where a torque is at its limit its row of C is zero: that
 * is what the limit makes of it. A law that samples every T seconds and holds gives the map
 *
 *   (x, x')+ = Phi (x, x') + Gamma u,   I+ = I + T I',   [Phi Gamma; 0 1] = exp([0 1 0; K 0 B; 0 0
 * 0] T)
 *
 * with the u of the sample before where there is a delay; one that acts all the time the
 * exponential of the closed loop. It holds where nothing has fallen and no reference of a servo
 * still moves, when a disturbance has not grown by more than REST_GROWTH after REST_HOLDS times
 * settle.hold, REST_WHOLE at least, by squaring the map again and again: what swings without
 * damping, as a free leg does, holds, too; what grows, however slowly, does not. Forces that change
 * with time are looked at eight times a period, at their crests among these. Noise is left out.
 *
 * `rested` says that the motion has come there. Contacts that carry stand, to REST_CREEP, and the
 * map takes the present deviation (x, x', I) to nothing, or round and round, without leaving
 * settle.angle and settle.rate on the way, the forces inside the cones, no other contact closing,
 * nothing falling, the law as linear as it was taken for (REST_BENT: no limit, no other law):
 * looked at eight times an octave of time. What slid to rest has its force on the edge of the cone,
 * up to rounding: cones are wider by REST_EDGE.
 */
#ifndef STANCE_CORE_LOOP_REST_H
#define STANCE_CORE_LOOP_REST_H

#include "matrix.h"

#define REST_ROUNDS 10
#define REST_STILL 1e-8 /* m/s^2, rad/s^2: an acceleration that is none */
#define REST_NEAR 1e-5  /* m, rad: half the width of the differences */
#define REST_HOLDS 4096 /* times settle.hold: how long it has to hold */
#define REST_WHOLE 2048 /* s, at least */
#define REST_GROWTH 1e9 /* of a disturbance in that time, SI units */
#define REST_EDGE 1e-6  /* of a cone: what it is wider here */
#define REST_CREEP 1e-6 /* m/s: a contact this slow stands */
#define REST_MARGIN 2   /* for what is not linear */
#define REST_FINE 32    /* of settle.hold: how closely the way to the equilibrium is looked at */
#define REST_GONE 1e-3  /* of settle.angle and settle.rate: a deviation that is none */
#define REST_BENT 0.05  /* of what a law adds to the torques: how far from linear that may be */
#define REST_ENDLESS 1e100

enum { REST_INPUTS = SCENE_ACTUATORS, REST_STATES = MATRIX_ROOM };

/* The neighbourhood of a state of rest in one lane. */
struct rest {
    const struct setting *set;
    int lane;
    double angle, rate, hold, T; /* what settle asks, and the time from sample to sample */
    lanes fall_height;
    lanes t;
    struct contact_state mode;
    lanes s[SCENE_COORDINATES], integral[ACTUATORS];
    int ways;                                       /* columns of Z ... */
    double Z[SCENE_COORDINATES][SCENE_COORDINATES]; /* ... [way][coordinate], orthonormal */
    /* By the ways' places, their rates, the integrals; and accelerations by torques. */
    double K[SCENE_COORDINATES][SCENE_COORDINATES], B[SCENE_COORDINATES][ACTUATORS];
    double C[3][ACTUATORS][REST_STATES], E[3][ACTUATORS][REST_STATES];
    double torque[ACTUATORS]; /* at the equilibrium */
};

static bool rest_fallen(const struct rest *r, const lanes *s)
{
    scene_trig trig;
    scene_trigonometry(s, &trig);
    return mask_get(motion_fallen(&r->set->body, s, &trig, r->fall_height), r->lane);
}

/* Torques that the law commands, limited, and the rates of its integrals. */
COLD void rest_law(const struct rest *r, const lanes *s, const lanes *w, const lanes *integral,
                   lanes *torque, lanes *rate)
{
    struct dynamics e;
    const struct law *const law = &r->set->law;
    law_torque(law, s, w, torque);
    for (int i = 0; i < ACTUATORS; i++)
        rate[i] = lanes_of(0);
    if (REST_INPUTS > 0 && mask_any(mask_less(lanes_of(0), law->decouples + law->switches))) {
        scene_trigonometry(s, &e.trig);
        const mask servos =
            law_command(r->set, LANES_ALL, r->t, s, w, integral, &r->mode, &e, torque);
        for (int i = 0; i < REST_INPUTS; i++)
            rate[i] = choose(servos, e.integral_rate[i], rate[i]);
    }
    law_clip(law, torque);
}

/* Everything that holds at s with w = 0 and these torques; forces and accelerations in the mode. */
static void rest_evaluate(const struct rest *r, const lanes *s, const lanes *torque,
                          struct dynamics *e)
{
    lanes still[SCENE_COORDINATES];
    for (int i = 0; i < SCENE_COORDINATES; i++)
        still[i] = lanes_of(0);
    scene_trigonometry(s, &e->trig);
    dynamics_evaluate(r->set, r->t, s, still, torque, CONTACT_ALL, false, e);
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
    for (int c = 0; c < SCENE_CONTACTS; c++)
        stood[c] = lanes_of(1);
    rest_evaluate(r, s, torque, &e);
    between_mode(r->set, &e, CONTACT_ALL, stood, mode, &trouble);
    bool stands = !mask_get(trouble.none | trouble.impact, r->lane);
    for (int c = 0; c < SCENE_CONTACTS; c++)
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
    for (int c = 0; c < SCENE_CONTACTS; c++) {
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
        *off = fmax(*off, b[i] == b[i] ? fabs(b[i]) : INFINITY);
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

/* The map from one sample (or step) to the next, about the equilibrium; returns its size. */
COLD int rest_map(const struct rest *r, bool samples, bool late, double T, small_matrix M)
{
    const int d = r->ways, n = 2 * d, m = REST_INPUTS;
    small_matrix F;
    memset(F, 0, sizeof F);
    memset(M, 0, sizeof(small_matrix));
    for (int i = 0; i < d; i++) {
        F[i][d + i] = 1;
        for (int j = 0; j < d; j++)
            F[d + i][j] = r->K[i][j];
        for (int j = 0; j < m; j++)
            F[d + i][n + j] = r->B[i][j];
    }
    /* The law: rows of u and of I' by places, rates, integrals. */
    small_matrix law;
    memset(law, 0, sizeof law);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n + m; j++) {
            const int kind = j < d   ? 0
                             : j < n ? 1
                                     : 2,
                      from = j - (kind == 0   ? 0
                                  : kind == 1 ? d
                                              : n);
            law[i][j] = r->C[kind][i][from];
            law[m + i][j] = r->E[kind][i][from];
        }
    if (!samples) { /* B u in place of B, and the integrals for the inputs */
        for (int i = 0; i < n + m; i++)
            for (int j = 0; j < n + m; j++) {
                M[i][j] = i < n ? (j < n ? F[i][j] : 0) : law[m + i - n][j];
                for (int k = 0; k < m && i < n; k++)
                    M[i][j] += F[i][n + k] * law[k][j];
            }
        matrix_exponential(n + m, M, T);
        return n + m;
    }
    matrix_exponential(n + m, F, T);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n + m; j++) {
            M[i][j] = j < n ? F[i][j] : 0;
            for (int k = 0; k < m && !late; k++)
                M[i][j] += F[i][n + k] * law[k][j];
        }
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n + m; j++) {
            M[n + i][j] = T * law[m + i][j] + (j == n + i ? 1 : 0);
            if (late)
                M[n + m + i][j] = law[i][j];
        }
    for (int i = 0; i < n && late; i++)
        for (int k = 0; k < m; k++)
            M[i][n + m + k] = F[i][n + k];
    return late ? n + 2 * m : n + m;
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

/* Do contacts that carry stand? A bounce that is over within a step of length h is none. */
COLD bool rest_stands(const struct rest *r, const lanes *s, const lanes *w, double h)
{
    const double bounce = fmax(STANCE_GRAVITY * h, REST_CREEP);
    scene_trig trig;
    bool stands = true;
    scene_trigonometry(s, &trig);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes u[2];
        if (!mask_get(r->mode.closed[c], r->lane))
            continue;
        scene_contact_velocity(&r->set->body, &trig, c, w, u);
        stands &= fabs(lane_get(&u[0], r->lane)) <= bounce;
        if (contact_grip(c) >= 0 && lane_get(&r->set->friction, r->lane) > 0)
            stands &= fabs(lane_get(&u[1], r->lane)) <= REST_CREEP;
    }
    return stands;
}

/* Are the torques of the law what they are to first order at the deviation x? */
static bool rest_straight(const struct rest *r, const double *x, const lanes *torque)
{
    for (int i = 0; i < REST_INPUTS; i++) {
        double change = 0, size = 0;
        for (int j = 0; j < 2 * r->ways + REST_INPUTS; j++) {
            const int kind = j < r->ways ? 0 : j < 2 * r->ways ? 1 : 2;
            const double part = r->C[kind][i][j - kind * r->ways] * x[j];
            change += part, size += fabs(part);
        }
        const double bent = lane_get(&torque[i], r->lane) - (r->torque[i] + change);
        if (!(fabs(bent) <= REST_BENT * size + REST_STILL))
            return false;
    }
    return true;
}

/* Is all well at the deviation x (ways' places, rates, integrals) from the equilibrium? *gone: it
 * is as good as none. */
COLD bool rest_allows(const struct rest *r, const double *x, bool *gone)
{
    const int d = r->ways;
    double farthest = 0, fastest = 0;
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES], integral[ACTUATORS];
    lanes torque[ACTUATORS], rates[ACTUATORS];
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        double place = 0, speed = 0;
        for (int k = 0; k < d; k++)
            place += r->Z[k][i] * x[k], speed += r->Z[k][i] * x[d + k];
        s[i] = r->s[i] + place, w[i] = lanes_of(speed);
        farthest = fmax(farthest, fabs(place)), fastest = fmax(fastest, fabs(speed));
    }
    *gone = farthest <= REST_GONE * r->angle && fastest <= REST_GONE * r->rate;
    if (!(farthest <= r->angle && fastest <= r->rate))
        return false;
    for (int i = 0; i < ACTUATORS; i++)
        integral[i] = r->integral[i] + (i < REST_INPUTS ? x[2 * d + i] : 0);
    struct dynamics e;
    struct contact_state mode;
    rest_law(r, s, w, integral, torque, rates);
    if (!rest_straight(r, x, torque))
        return false;
    rest_evaluate(r, s, torque, &e);
    between_project_position(r->set, r->mode.closed, s, &e);
    if (rest_fallen(r, s) || !rest_mode(r, s, torque, &mode))
        return false;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        if (mask_get(r->mode.closed[c] & LANES_NOT(mode.closed[c]), r->lane))
            return false;
        if (!mask_get(r->mode.closed[c], r->lane) && lane_get(&r->set->may_touch[c], r->lane) > 0 &&
            !(lane_get(&e.gap[c], r->lane) >= -STEP_CLOSED))
            return false;
    }
    return true;
}

/* Does the motion from (s, w) come to the equilibrium, or stay about it, for a time `whole`? M, of
 * a sample, is spoiled. */
COLD bool rest_arrives(const struct rest *r, const lanes *s, const lanes *w, const lanes *integral,
                       int n, small_matrix M, double whole)
{
    const int d = r->ways;
    double x[REST_STATES] = {0}, time = r->T;
    bool gone;
    for (int k = 0; k < d; k++)
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            x[k] += r->Z[k][i] * (lane_get(&s[i], r->lane) - lane_get(&r->s[i], r->lane));
            x[d + k] += r->Z[k][i] * lane_get(&w[i], r->lane);
        }
    for (int i = 0; i < REST_INPUTS; i++)
        x[2 * d + i] = lane_get(&integral[i], r->lane) - lane_get(&r->integral[i], r->lane);
    for (int i = 2 * d + REST_INPUTS; i < n; i++) /* torques of the sample before */
        for (int j = 0; j < 2 * d + REST_INPUTS; j++) {
            const int kind = j < d ? 0 : j < 2 * d ? 1 : 2;
            x[i] += r->C[kind][i - 2 * d - REST_INPUTS][j - kind * d] * x[j];
        }
    for (int i = 0; i < n; i++)
        x[i] *= REST_MARGIN;
    if (!rest_allows(r, x, &gone))
        return false;
    for (; time * REST_FINE < r->hold; time *= 2)
        matrix_times(n, M, M, M);
    for (double t = 0; t < whole && !gone; time *= 2) {
        for (int k = 0; k < 8 && !gone; k++, t += time) {
            double next[REST_STATES] = {0};
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++)
                    next[i] += M[i][j] * x[j];
            memcpy(x, next, sizeof x);
            if (!rest_allows(r, x, &gone))
                return false;
        }
        matrix_times(n, M, M, M);
    }
    return true;
}

/* Does a reference of the servos still move? */
static bool rest_moves(const struct bundle *b, int lane)
{
    const struct law *const law = &b->set.law;
    const double t = lane_get(&b->n, lane) * lane_get(&b->h, lane);
    bool moves = false;
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        moves |=
            lane_get(&law->servo[i].ramp, lane) != 0 && t < lane_get(&law->servo[i].duration, lane);
    return moves && lane_get(&law->decouples, lane) > 0; /* else servos have no part */
}

/* Is there an equilibrium near s that holds, for the case in a lane; and, w not NULL, does the
 * motion come there? */
COLD bool rest_holds(const struct bundle *b, int lane, const lanes *s, const lanes *w,
                     const lanes *integral)
{
    struct rest r;
    struct setting wider = b->set;
    double off = INFINITY;
    lanes still[SCENE_COORDINATES], torque[ACTUATORS], rate[ACTUATORS];
    const double h = lane_get(&b->h, lane), every = lane_get(&b->sample_every, lane);
    memset(&r, 0, sizeof r);
    r.angle = 1 / lane_get(&b->angle_scale, lane), r.rate = 1 / lane_get(&b->rate_scale, lane);
    r.T = every > 0 ? every * h : h;
    r.fall_height = b->fall_height;
    r.hold = fmax(lane_get(&b->settle_steps, lane) * h, r.T);
    scene_push(&wider.body, lanes_of(INFINITY), b->h); /* nothing pushes any more */
    wider.friction = wider.friction * (1 + REST_EDGE);
    r.set = &wider;
    r.lane = lane;
    r.t = b->steps * b->h;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        r.s[i] = s[i], still[i] = lanes_of(0);
    for (int i = 0; i < ACTUATORS; i++)
        r.integral[i] = integral[i];
    scene_trig trig;
    scene_trigonometry(r.s, &trig);
    const lanes low = lanes_of(fmax(STANCE_GRAVITY * h * h, STEP_CLOSED));
    for (int c = 0; c < SCENE_CONTACTS; c++) { /* for laws that ask what the contacts do */
        const lanes near =
            choose(mask_less(lanes_of(0), b->set.restitution[c]), low, lanes_of(STEP_CLOSED));
        r.mode.closed[c] = mask_less(lanes_of(0), b->set.may_touch[c]) &
                           mask_less_equal(scene_gap(&b->set.body, r.s, &trig, c), near);
        r.mode.slide[c] = lanes_of(0);
    }
    rest_law(&r, r.s, still, r.integral, torque, rate);
    struct dynamics e;
    rest_evaluate(&r, r.s, torque, &e); /* what bounces within a step lies on the ground */
    between_project_position(r.set, r.mode.closed, r.s, &e);
    rest_law(&r, r.s, still, r.integral, torque, rate);
    if (!rest_mode(&r, r.s, torque, &r.mode) || (w && !rest_stands(&r, s, w, h)))
        return false;
    for (int round = 0; round < REST_ROUNDS && off > REST_STILL; round++) {
        rest_ways(&r);
        rest_approach(&r, &off);
        for (int i = 0; i < SCENE_COORDINATES; i++)
            if (!(fabs(lane_get(&r.s[i], lane) - lane_get(&s[i], lane)) <= r.angle))
                return false;
    }
    if (!(off <= REST_STILL))
        return false;
    rest_ways(&r);
    rest_law(&r, r.s, still, r.integral, torque, rate);
    rest_linearise(&r, torque);
    for (int i = 0; i < REST_INPUTS; i++)
        r.torque[i] = lane_get(&torque[i], lane);
    if (rest_fallen(&r, r.s) || (w && rest_moves(b, lane)))
        return false;
    /* Forces that hold it, at all times: of those that change, from their phase 0 on. */
    const lanes part = scene_longest_step(&b->set.body);
    const int parts = isfinite(lane_get(&part, lane)) ? 8 : 1;
    for (int k = 0; k < parts; k++) {
        if (parts > 1)
            r.t = k * part;
        if (!rest_mode(&r, r.s, torque, &r.mode))
            return false;
    }
    if (r.ways == 0)
        return true;
    small_matrix M, power;
    const double whole = fmax(REST_HOLDS * r.hold, REST_WHOLE);
    const int n = rest_map(&r, every > 0, lane_get(&b->delayed, lane) > 0, r.T, M);
    memcpy(power, M, sizeof power);
    return rest_bounded(n, power, r.T, whole) &&
           (!w || rest_arrives(&r, s, w, integral, n, M, whole));
}

/* ---- what becomes of a verdict ------------------------------------------------------------- */

/* What is known of the target: circumstances of a case, and whether its equilibrium holds. */
enum {
    REST_SETTING = sizeof(struct setting) / sizeof(lanes),
    REST_KEY = REST_SETTING + 6 + CONTACTS
};

/* The case in a lane, whatever its start: what rest_target depends on. */
static void rest_key(const struct bundle *b, int lane, double *key)
{
    const lanes *const set = (const lanes *)&b->set;
    const lanes rest[] = {b->h,       b->steps,       b->sample_every,
                          b->delayed, b->angle_scale, b->settle_steps};
    enum { REST_MINE = REST_SETTING + sizeof rest / sizeof *rest };
    _Static_assert(REST_MINE + CONTACTS == REST_KEY, "room for all");
    for (int i = 0; i < REST_SETTING; i++)
        key[i] = lane_get(&set[i], lane);
    for (int i = REST_SETTING; i < REST_MINE; i++)
        key[i] = lane_get(&rest[i - REST_SETTING], lane);
    for (int i = 0; i < CONTACTS; i++)
        key[REST_MINE + i] = lane_get(&b->mine[i], lane);
}

/* Is there an equilibrium at the target, on the supports, that holds? Of cases that differ in
 * their starts alone it is asked once. */
COLD bool rest_target(struct bundle *b, int lane)
{
    const stance_case *const c = b->which[lane];
    const stance_scene *const scene = SCENE_OF(c);
    double key[REST_KEY], q[SCENE_COORDINATES] = {0}, v[SCENE_COORDINATES] = {0};
    double s1[SCENE_COORDINATES], w1[SCENE_COORDINATES];
    rest_key(b, lane, key);
    if (b->target_known && memcmp(key, b->target_key, sizeof key) == 0)
        return b->target_holds;
    lanes s[SCENE_COORDINATES], integral[ACTUATORS];
    for (int i = 0; i < scene->postures; i++)
        q[scene->posture[i]] = c->near.target[i];
    if (c->supports)
        scene->stand(scene, c->robot, c->supports, q, v);
    scene_enter(SCENE_NUMBERS(c), q, v, s1, w1);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lanes_of(s1[i]);
    for (int i = 0; i < ACTUATORS; i++)
        integral[i] = lanes_of(0);
    memcpy(b->target_key, key, sizeof key);
    b->target_known = true;
    return b->target_holds = rest_holds(b, lane, s, NULL, integral);
}

/* Lanes of a verdict without those where nothing holds: their window opens anew. */
COLD void rest_confirm(struct bundle *b, mask *rested, mask *stabilised)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (!b->which[lane])
            continue;
        if (mask_get(*rested, lane) && !rest_holds(b, lane, b->now.s, b->now.w, b->now.integral)) {
            *rested &= LANES_NOT(mask_of_lane(lane));
            lane_set(&b->resting.begin, lane, -1);
        }
        if (mask_get(*stabilised, lane) && !rest_target(b, lane)) {
            *stabilised &= LANES_NOT(mask_of_lane(lane));
            lane_set(&b->settled.begin, lane, -1);
        }
    }
}

#endif
