/* rest.c - an equilibrium near a state, and the motion about it to first order: the equations are
 * in engine/rest.h. */
#include "engine/rest.h"

#include "engine/matrix.h"
#include "engine/rows.h"

#define ROUNDS 10
#define STILL 1e-8 /* m/s^2, rad/s^2: an acceleration that is none */
#define NEAR 1e-5  /* m, rad: half the width of the differences */
#define HOLDS 4096 /* times settle.hold: how long it has to hold */
#define WHOLE 2048 /* s, at least */
#define GROWTH 1e9 /* SI units: a disturbance that grows beyond this in that time does not hold */
#define MARGIN 2   /* for what is not linear */
#define FINE 32    /* of settle.hold: how closely the way to the equilibrium is looked at */
#define GONE 1e-3  /* of settle.angle and settle.rate: a deviation that is none */
#define BENT 0.05  /* of what a law adds to the torques: how far from linear that may be */
#define RAMP 0.5   /* of a sample: how long a torque of limited rate may take to come up */
#define ENDLESS 1e100

enum {
    N = STANCE_MAX_COORDINATES,
    M = STANCE_MAX_ACTUATORS,
    COLUMNS = 2 * N + M,                          /* places, rates, integrals, and ... */
    STATES = COLUMNS + (1 + STANCE_MAX_DELAY) * M /* ... torques, commands under way */
};

/* The neighbourhood of a state of rest. */
struct near {
    stance_rest *r;
    int n, m, d; /* coordinates, torques, ways */
    double s[N], integral[M];
    double torque[2 * M];                         /* and the rates of the integrals */
    double Z[N][STANCE_ROWS_STRIDE];              /* [way][coordinate], orthonormal */
    double K[N][N], B[N][M], law[2 * M][COLUMNS]; /* law: of torques, of rates of integrals */
};

static void command_at_rest(struct near *e)
{
    const double still[N] = {0};
    e->r->law(e->r, e->s, still, e->integral, e->torque, e->torque + e->m);
}

enum { ROWS = 2 * STANCE_MAX_CONTACTS };

/* The ways that standing contacts leave: what is orthogonal to their rows. */
static void find_ways(struct near *e)
{
    double row[ROWS][N], a[ROWS][STANCE_ROWS_STRIDE], creeps[ROWS];
    const int rows = e->r->rows(e->r, e->s, row, creeps);
    for (int i = 0; i < rows; i++)
        memcpy(a[i], row[i], sizeof row[i]);
    stance_rows_turn(rows, e->n, e->n, a);
    e->d = stance_rows_null(rows, e->n, a, e->Z);
}

/* Do contacts that carry stand in the motion? A bounce that is over within a step is none. */
static bool is_still(const stance_rest *r)
{
    double row[ROWS][N], creeps[ROWS];
    const int rows = r->rows(r, r->s, row, creeps);
    bool still = true;
    for (int i = 0; i < rows; i++)
        still &= fabs(matrix_dot(r->coordinates, row[i], r->w)) <= creeps[i];
    return still;
}

/* Accelerations along the ways. */
static void accelerate(const struct near *e, const double *s, const double *torque, double *out)
{
    double a[N];
    e->r->accelerate(e->r, s, torque, a);
    for (int k = 0; k < e->d; k++)
        out[k] = matrix_dot(e->n, e->Z[k], a);
}

/* Derivatives about the present place. */
static void linearise(struct near *e)
{
    const int n = e->n, m = e->m, d = e->d;
    double a[2][N] = {{0}};
    for (int j = 0; j < 2 * d + m; j++) {
        double command[2][2 * M];
        for (int side = 0; side < 2; side++) {
            const double by = side == 0 ? NEAR : -NEAR;
            double s[N], w[N], integral[M];
            for (int i = 0; i < n; i++) {
                s[i] = e->s[i] + (j < d ? by * e->Z[j][i] : 0);
                w[i] = j >= d && j < 2 * d ? by * e->Z[j - d][i] : 0;
            }
            for (int i = 0; i < m; i++)
                integral[i] = e->integral[i] + (j == 2 * d + i ? by : 0);
            e->r->law(e->r, s, w, integral, command[side], command[side] + m);
            if (j < d)
                accelerate(e, s, e->torque, a[side]);
        }
        for (int i = 0; i < 2 * m; i++)
            e->law[i][j] = (command[0][i] - command[1][i]) / (2 * NEAR);
        for (int k = 0; k < d && j < d; k++)
            e->K[k][j] = (a[0][k] - a[1][k]) / (2 * NEAR);
    }
    for (int j = 0; j < m; j++) {
        for (int side = 0; side < 2; side++) {
            double more[M];
            memcpy(more, e->torque, sizeof more);
            more[j] += side == 0 ? 1 : -1;
            accelerate(e, e->s, more, a[side]);
        }
        for (int k = 0; k < d; k++)
            e->B[k][j] = (a[0][k] - a[1][k]) / 2;
    }
}

/* One of Newton's iterations towards the equilibrium; returns how far the accelerations (and rates
 * of the integrals) were from zero. */
static double approach(struct near *e)
{
    const int m = e->m, d = e->d, unknowns = d + m;
    double a[N + M], x[N + M], A[N + M][STANCE_ROWS_STRIDE];
    command_at_rest(e);
    accelerate(e, e->s, e->torque, a);
    memcpy(a + d, e->torque + m, (size_t)m * sizeof *a);
    const double off = matrix_largest(unknowns, a);
    if (off <= STILL)
        return off;
    linearise(e);
    for (int i = 0; i < unknowns; i++) {
        for (int j = 0; j < unknowns; j++) {
            const int column = j < d ? j : j + d;
            A[i][j] = i < d ? (j < d ? e->K[i][j] : 0) : e->law[m + i - d][column];
            for (int k = 0; k < m && i < d; k++)
                A[i][j] += e->B[i][k] * e->law[k][column];
        }
        A[i][unknowns] = -a[i];
    }
    stance_rows_turn(unknowns, unknowns, unknowns + 1, A);
    stance_rows_solve(unknowns, unknowns, A, x);
    for (int k = 0; k < d; k++)
        for (int i = 0; i < e->n; i++)
            e->s[i] += e->Z[k][i] * x[k];
    for (int i = 0; i < m; i++)
        e->integral[i] += x[d + i];
    e->r->project(e->r, e->torque, e->s);
    return off;
}

/* A[n][n] becomes A B, one of them or both A. */
static void times(int n, double *A, const double *B)
{
    double product[STATES * STATES];
    matrix_multiply(n, n, n, A, B, product);
    memcpy(A, product, (size_t)(n * n) * sizeof *A);
}

/* A[n][n] becomes exp(A T): Taylor's series of a part of it, squared. */
static void exponential(int n, double *A, double T)
{
    double term[STATES * STATES] = {0}, sum[STATES * STATES];
    int squarings = 0;
    for (double size = n * matrix_largest(n * n, A) * T; size > 0.5 && squarings < 60; squarings++)
        size *= 0.5, T *= 0.5;
    for (int i = 0; i < n * n; i++)
        sum[i] = term[i] = i % (n + 1) == 0;
    for (int order = 1; order <= 14; order++) { /* 0.5^15 / 15! = 2e-17 */
        times(n, term, A);
        for (int i = 0; i < n * n; i++)
            sum[i] += term[i] *= T / order;
    }
    for (int k = 0; k < squarings; k++)
        times(n, sum, sum);
    memcpy(A, sum, (size_t)(n * n) * sizeof *A);
}

/* How places, rates and the torques of actuators that lag move by themselves, and by commands: x'
 * = F x with the commands last, held. Returns how many they are without the commands. */
static int plant(const struct near *e, double *F)
{
    const stance_rest *const r = e->r;
    const int d = e->d, m = e->m, n = 2 * d + (r->lags && r->lag > 0 ? m : 0), all = n + m;
    memset(F, 0, (size_t)(all * all) * sizeof *F);
    for (int i = 0; i < d; i++) {
        F[i * all + d + i] = 1;
        memcpy(F + (d + i) * all, e->K[i], (size_t)d * sizeof *F);
        memcpy(F + (d + i) * all + 2 * d, e->B[i], (size_t)m * sizeof *F);
    }
    for (int i = 2 * d; i < n; i++)
        F[i * all + i] = -1 / r->lag, F[i * all + i + m] = 1 / r->lag;
    return n;
}

/* The map from one sample (or step) to the next, about the equilibrium, of places, rates,
 * integrals, torques (of actuators that lag), commands under way; returns its size. */
static int map_of(const struct near *e, double *A)
{
    const stance_rest *const r = e->r;
    const int n = 2 * e->d, m = e->m, drive = n + m, queue = drive + (r->lags ? m : 0),
              size = r->samples ? queue + r->delay * m : drive;
    double F[STATES * STATES];
    const int moved = plant(e, F), all = moved + m;
    memset(A, 0, (size_t)(size * size) * sizeof *A);
    if (!r->samples) { /* B u in place of B, and the integrals for the inputs */
        for (int i = 0; i < drive; i++)
            for (int j = 0; j < drive; j++) {
                A[i * size + j] = i < n ? (j < n ? F[i * all + j] : 0) : e->law[m + i - n][j];
                for (int k = 0; k < m && i < n; k++)
                    A[i * size + j] += F[i * all + n + k] * e->law[k][j];
            }
        exponential(size, A, r->T);
        return size;
    }
    exponential(all, F, r->T);
    /* Where the command in force is found: in the queue, or (as rows) by the law. */
    for (int i = 0; i < moved; i++) {
        double *const row = A + (i < n ? i : i + m) * size;
        for (int j = 0; j < moved; j++)
            row[j < n ? j : j + m] = F[i * all + j];
        for (int k = 0; k < m; k++) {
            if (r->delay > 0)
                row[queue + k] = F[i * all + moved + k];
            for (int j = 0; j < drive && r->delay == 0; j++)
                row[j] += F[i * all + moved + k] * e->law[k][j];
        }
    }
    const bool at_once = r->lags && moved == n; /* a rate limit alone: see keeps_up */
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < drive; j++) {
            A[(n + i) * size + j] = r->T * e->law[m + i][j] + (j == n + i ? 1 : 0);
            if (r->delay > 0)
                A[(size - m + i) * size + j] = e->law[i][j];
            if (at_once && r->delay == 0)
                A[(drive + i) * size + j] = e->law[i][j];
        }
        if (at_once && r->delay > 0)
            A[(drive + i) * size + queue + i] = 1;
        for (int k = queue + i; k + m < size; k += m)
            A[k * size + k + m] = 1;
    }
    return size;
}

/* Does no disturbance grow beyond bounds? `time`: that A takes, `whole`: that it has to hold. A is
 * spoiled. */
static bool bounded(int n, double *A, double time, double whole)
{
    const double bound = GROWTH * fmax(1, matrix_largest(n * n, A));
    while (time < whole) {
        const double size = matrix_largest(n * n, A);
        if (!(size <= ENDLESS))
            return false;
        if (n * size < 0.5) /* it decays */
            return true;
        times(n, A, A);
        time *= 2;
    }
    return matrix_largest(n * n, A) <= bound;
}

/* Are the torques of the law what they are to first order at the deviation x? */
static bool straight(const struct near *e, const double *x, const double *torque)
{
    for (int i = 0; i < e->m; i++) {
        double change = 0, size = 0;
        for (int j = 0; j < 2 * e->d + e->m; j++) {
            const double part = e->law[i][j] * x[j];
            change += part, size += fabs(part);
        }
        if (!(fabs(torque[i] - (e->torque[i] + change)) <= BENT * size + STILL))
            return false;
    }
    return true;
}

/* Do actuators that lag give, at the deviation x, what the map takes them to give? `torque`, that
 * is commanded, becomes theirs. */
static bool keeps_up(const struct near *e, const double *x, double *torque)
{
    const stance_rest *const r = e->r;
    const double *const own = x + 2 * e->d + e->m, *const queue = own + e->m;
    const double most = fmax(r->rate * r->lag, RAMP * r->rate * r->T);
    bool keeps = true;
    for (int i = 0; i < e->m && r->lags; i++) {
        const double command = r->delay ? queue[i] : torque[i] - e->torque[i];
        keeps &= fabs(command - own[i]) <= most;
        torque[i] = e->torque[i] + own[i];
    }
    return keeps;
}

/* Are torques and commands under way, at x, too small to matter within settle.hold? */
static bool is_calm(const struct near *e, const double *x)
{
    const stance_rest *const r = e->r;
    const int first = 2 * e->d + e->m, more = ((r->lags ? 1 : 0) + r->delay) * e->m;
    double most = 0;
    for (int k = 0; k < e->d; k++)
        for (int i = 0; i < more; i++)
            most = fmax(most, fabs(e->B[k][i % e->m] * x[first + i]) * r->hold);
    return most <= r->speed;
}

/* Is all well at the deviation x (ways' places, rates, integrals, torques that lag, commands under
 * way) from the equilibrium? *gone: it is as good as none. */
static bool allows(const struct near *e, const double *x, bool *gone)
{
    const stance_rest *const r = e->r;
    double farthest = 0, fastest = 0, s[N], w[N], integral[M], torque[2 * M];
    for (int i = 0; i < e->n; i++) {
        double place = 0, speed = 0;
        for (int k = 0; k < e->d; k++)
            place += e->Z[k][i] * x[k], speed += e->Z[k][i] * x[e->d + k];
        s[i] = e->s[i] + place, w[i] = speed;
        farthest = fmax(farthest, fabs(place)), fastest = fmax(fastest, fabs(speed));
    }
    *gone = farthest <= GONE * r->angle && fastest <= GONE * r->speed && is_calm(e, x);
    if (!(farthest <= r->angle && fastest <= r->speed))
        return false;
    for (int i = 0; i < e->m; i++)
        integral[i] = e->integral[i] + x[2 * e->d + i];
    r->law(r, s, w, integral, torque, torque + e->m);
    if (!straight(e, x, torque) || !keeps_up(e, x, torque))
        return false;
    r->project(r, torque, s);
    return r->stays(r, s, torque);
}

/* Does the motion come to the equilibrium, or stay about it, for a time `whole`? A[n][n], of a
 * sample, is spoiled. */
static bool arrives(const struct near *e, int n, double *A, double whole)
{
    const stance_rest *const r = e->r;
    const int d = e->d, m = e->m;
    double x[STATES] = {0}, next[STATES], time = r->T;
    bool gone;
    for (int k = 0; k < d; k++)
        for (int i = 0; i < e->n; i++) {
            x[k] += e->Z[k][i] * (r->s[i] - e->s[i]);
            x[d + k] += e->Z[k][i] * r->w[i];
        }
    for (int i = 0; i < m; i++)
        x[2 * d + i] = r->integral[i] - e->integral[i];
    for (int i = 0; i < n - 2 * d - m; i++)
        x[2 * d + m + i] = r->under_way[i] - e->torque[i % m];
    for (int i = 0; i < n; i++)
        x[i] *= MARGIN;
    if (!allows(e, x, &gone))
        return false;
    for (; time * FINE < r->hold; time *= 2)
        times(n, A, A);
    for (double t = 0; t < whole && !gone; time *= 2) {
        for (int k = 0; k < 8 && !gone; k++, t += time) {
            matrix_multiply(n, n, 1, A, x, next);
            memcpy(x, next, (size_t)n * sizeof *x);
            if (!allows(e, x, &gone))
                return false;
        }
        times(n, A, A);
    }
    return true;
}

bool stance_rest_holds(stance_rest *r)
{
    struct near e = {.r = r, .n = r->coordinates, .m = r->actuators};
    double off = INFINITY, A[STATES * STATES], power[STATES * STATES];
    memcpy(e.s, r->s, sizeof e.s);
    memcpy(e.integral, r->integral, sizeof e.integral);
    command_at_rest(&e);
    r->project(r, e.torque, e.s); /* what bounces within a step lies on the ground */
    command_at_rest(&e);
    if (!r->stands(r, e.s, e.torque, false) || (r->comes && !is_still(r)))
        return false;
    for (int round = 0; round < ROUNDS && off > STILL; round++) {
        find_ways(&e);
        off = approach(&e);
        for (int i = 0; i < e.n; i++)
            if (!(fabs(e.s[i] - r->s[i]) <= r->angle))
                return false;
    }
    if (!(off <= STILL))
        return false;
    find_ways(&e);
    command_at_rest(&e);
    linearise(&e);
    if (!r->stands(r, e.s, e.torque, true))
        return false;
    if (e.d == 0)
        return true;
    const double whole = fmax(HOLDS * r->hold, WHOLE);
    const int size = map_of(&e, A);
    memcpy(power, A, (size_t)(size * size) * sizeof *A);
    return bounded(size, power, r->T, whole) && (!r->comes || arrives(&e, size, A, whole));
}
