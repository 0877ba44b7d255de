/* known_basin.c - how far from its target a linear law brings the robot back: the largest ellipsoid
 * that simulations from its boundary confirm.
 *
 * The basin of attraction of an equilibrium has no holes: it can be deformed into all of space
 * (Wilson, Trans. AMS 139, 1969). So where everything on the boundary of an ellipsoid about the
 * equilibrium comes back, everything inside does, and the boundary alone needs to be tried. That
 * holds for flows without noise; some simulations from inside are made for what it leaves out.
 *
 * Points are uniform on the boundary in the metric of P: x = sqrt(c) L^-T u, P = L L', u uniform on
 * the unit sphere, from normal numbers (Box and Muller) of a counter-based generator: they depend
 * on seed, batch and number of the point, not on how many there are or who computes them.
 *
 * The search per shape: the radius doubles or halves until one level passes and the next does not,
 * then that interval is halved; the shape with the largest volume then shrinks in small steps until
 * everything passes. Whatever fails ends its batch, so that only good levels cost much.
 */
#include "control.h"

#include <Random123/philox.h>
#include <lapacke.h>
#include <string.h>

enum {
    STATES = 2 * STANCE_MAX_POSTURE,
    SQUARE = STATES * STATES,
    CHUNK = 128,  /* simulations at a time */
    SCREEN = 256, /* of the first look at a level */
    SCREEN_MORE = 2048,
    DOUBLINGS = 12,
    HALVINGS = 4,
    SHRINKINGS = 60,
};
#define SHRINK 0.97 /* of the radius, when a batch fails */

struct search {
    const stance_known_basin_search *ask;
    int n;
    double inverse[SQUARE]; /* columns of L^-T, row-major upper triangle */
    uint64_t batch;         /* number of the batch: no two use the same random numbers */
    int64_t simulations;
    double longest; /* s, in the batch */
    bool stopped;
    stance_case *cases;
    stance_result *results;
};

/* ---- points ---------------------------------------------------------------------------------- */

static double unit_interval(uint64_t bits)
{
    return ((double)(bits >> 11) + 0.5) * 0x1p-53;
}

/* u[n] uniform on the unit sphere; returns a further number, uniform in (0, 1). */
static double sphere(const struct search *s, uint64_t point, double *u)
{
    const philox4x64_key_t key = {{s->ask->base.seed, 0x63617074757265}};
    double value[16], sum = 0;

    for (uint64_t k = 0; k < 4; k++) {
        const philox4x64_ctr_t counter = {{point, s->batch, k, 0}};
        const philox4x64_ctr_t random = philox4x64(counter, key);
        for (int i = 0; i < 4; i++)
            value[4 * k + (uint64_t)i] = unit_interval(random.v[i]);
    }
    for (int i = 0; i < s->n; i++) {
        const double radius = sqrt(-2 * log(value[i]));
        u[i] = radius * cos(2 * M_PI * value[8 + i]);
        sum += u[i] * u[i];
    }
    for (int i = 0; i < s->n; i++)
        u[i] /= sqrt(sum);
    return value[15];
}

/* The case that begins at a point of the boundary of radius sqrt(c), or evenly spread in radius
 * inside. false: a contact would begin inside the ground. */
static bool begin(const struct search *s, uint64_t point, double radius, bool inside,
                  stance_case *c)
{
    const stance_scene *scene = s->ask->scene;
    const int n = s->n, postures = n / 2;
    double u[STATES], x[STATES] = {0}, gap[STANCE_MAX_CONTACTS];

    const double inner = sphere(s, point, u);
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            x[i] += radius * (inside ? inner : 1) * s->inverse[i * n + j] * u[j];
    *c = s->ask->base;
    memset(c->position, 0, sizeof c->position);
    memset(c->velocity, 0, sizeof c->velocity);
    for (int k = 0; k < postures; k++) {
        c->position[scene->posture[k]] = c->near.target[k] + x[k];
        c->velocity[scene->posture[k]] = x[postures + k];
    }
    scene->stand(scene, c->robot, c->supports, c->position, c->velocity);
    c->basin_known = false;
    c->trajectory = NULL;
    c->grid_index = UINT64_MAX - point; /* noise that no case of a sweep has */
    c->sample_index = s->batch + 1;
    scene->gaps(scene, c->robot, c->position, gap);
    for (int i = 0; i < scene->contacts; i++)
        if ((c->contacts & ~c->supports) >> i & 1 && !(gap[i] > 0))
            return false;
    return true;
}

/* ---- batches --------------------------------------------------------------------------------- */

/* Cases at hand for the kernel. */
struct hand {
    struct search *search;
    size_t next, size;
};

static bool hand_next(void *context, const stance_case **c, stance_result **result)
{
    struct hand *hand = context;
    if (hand->next == hand->size)
        return false;
    *c = &hand->search->cases[hand->next];
    *result = &hand->search->results[hand->next++];
    return true;
}

static void hand_done(void *context, const stance_case *c, stance_result *result)
{
    (void)c, (void)result;
    ((struct hand *)context)->search->simulations++;
}

static bool hand_leave(void *context)
{
    const stance_known_basin_search *ask = ((struct hand *)context)->search->ask;
    return ask->leave && ask->leave(ask->context);
}

/* Simulates points of a level; false as soon as one does not end as it should, or when stopped. */
static bool batch(struct search *s, double radius, int64_t count, bool inside)
{
    s->batch++;
    for (int64_t first = 0; first < count && !s->stopped; first += CHUNK) {
        const size_t size = (size_t)(count - first < CHUNK ? count - first : CHUNK);
        for (size_t i = 0; i < size; i++)
            if (!begin(s, (uint64_t)first + i, radius, inside, &s->cases[i]))
                return false;
        struct hand hand = {s, 0, size};
        s->stopped =
            !s->ask->kernel->stream(&(stance_feed){&hand, hand_next, hand_done, hand_leave});
        if (s->stopped)
            return false;
        for (size_t i = 0; i < size; i++) {
            if (s->results[i].status != STANCE_DONE || s->results[i].outcome != STANCE_STABILISED)
                return false;
            s->longest = fmax(s->longest, s->results[i].end_time);
        }
    }
    return !s->stopped;
}

/* ---- one shape ------------------------------------------------------------------------------- */

/* Prepares for a P; *log_volume: of x' P x <= 1 up to a constant. false: P is not positive
 * definite. */
static bool take_shape(struct search *s, const double *P, double *log_volume)
{
    const int n = s->n;
    double lower[SQUARE];

    memcpy(lower, P, (size_t)n * (size_t)n * sizeof *P);
    if (!matrix_finite((size_t)n * (size_t)n, P) ||
        LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', n, lower, n) != 0 ||
        LAPACKE_dtrtri(LAPACK_ROW_MAJOR, 'L', 'N', n, lower, n) != 0)
        return false;
    *log_volume = 0;
    for (int i = 0; i < n; i++) {
        *log_volume += log(lower[i * n + i]);
        for (int j = 0; j < n; j++)
            s->inverse[j * n + i] = j <= i ? lower[i * n + j] : 0;
    }
    return true;
}

/* Largest radius that a first look lets pass; 0: none. */
static double screen(struct search *s)
{
    double radius = 1, good = 0, bad = 0;

    for (int k = 0; k < DOUBLINGS && !s->stopped && !(good > 0 && bad > 0); k++) {
        if (batch(s, radius, SCREEN, false)) {
            good = radius;
            radius = 2 * radius;
        } else {
            bad = radius;
            radius = radius / 2;
        }
    }
    for (int k = 0; good > 0 && bad > 0 && !s->stopped && k < HALVINGS; k++) {
        radius = sqrt(good * bad);
        if (batch(s, radius, SCREEN, false))
            good = radius;
        else
            bad = radius;
    }
    return good;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bool makes_sense(const stance_known_basin_search *ask)
{
    const stance_case *c = &ask->base;
    return ask->scene && ask->kernel &&
           (ask->kernel->scene == ask->scene || ask->scene->mechanism) && ask->scene->stand &&
           ask->scene->postures > 0 && ask->shapes >= 1 && ask->shapes <= STANCE_MAX_SHAPES &&
           ask->boundary >= 1 && ask->interior >= 0 && c->settle && c->has_target && c->supports &&
           !(c->supports >> ask->scene->contacts) && c->delay == 0 && c->lag == 0 &&
           c->torque_rate == 0 && !c->decouples && !c->switches;
}

/* Sets are tried until one passes, and how many that takes is not known beforehand: 0.05 / m for
 * the m-th would let one of three slip through in 8.9 %, and of many in any share, as 1 + 1/2 + 1/3
 * ... has no end. So the m-th may only be wrong in 0.05 * 6 / (pi m)^2 of cases: all of them
 * together in 0.05, whenever the search ends and however the sets depend on what came before, for
 * each has simulations of its own. */
double stance_known_basin_share(int64_t batches, int64_t boundary)
{
    const double m = (double)batches;
    return 1 - pow(0.05 * 6 / (M_PI * M_PI * m * m), 1 / (double)boundary);
}

/* The full batches, from `radius` on. */
static void confirm(struct search *s, double radius, stance_known_basin *set)
{
    const stance_known_basin_search *ask = s->ask;
    const int n = s->n;

    for (int k = 0; k < SHRINKINGS && !set->exists && !s->stopped; k++, radius *= SHRINK) {
        s->longest = 0;
        if (!batch(s, radius, ask->boundary < SCREEN_MORE ? ask->boundary : SCREEN_MORE, false))
            continue;
        radius *= SHRINK;
        set->batches++;
        set->exists =
            batch(s, radius, ask->boundary, false) && batch(s, radius, ask->interior, true);
        if (set->exists)
            break;
    }
    set->level = radius * radius;
    set->time = s->longest;
    set->boundary = ask->boundary;
    set->interior = ask->interior;
    set->share = stance_known_basin_share(set->batches, ask->boundary);
    for (int i = 0; i < n * n; i++)
        set->form[i] = ask->P[set->shape][i] / set->level;
}

stance_error stance_known_basin_estimate(const stance_known_basin_search *search,
                                         stance_known_basin *set)
{
    struct search s = {.ask = search};
    double best = -INFINITY, best_radius = 0, log_volume = 0;

    *set = (stance_known_basin){.exists = false};
    if (!makes_sense(search))
        return STANCE_BAD_ARGUMENT;
    s.n = 2 * search->scene->postures;
    s.cases = calloc(CHUNK, sizeof *s.cases);
    s.results = calloc(CHUNK, sizeof *s.results);
    if (!s.cases || !s.results) {
        free(s.cases);
        free(s.results);
        return STANCE_NO_MEMORY;
    }
    for (int k = 0; k < search->shapes && !s.stopped; k++) {
        set->volume[k] = NAN;
        const double radius = take_shape(&s, search->P[k], &log_volume) ? screen(&s) : 0;
        if (radius > 0)
            set->volume[k] = log_volume + s.n * log(radius);
        if (set->volume[k] > best) {
            best = set->volume[k];
            best_radius = radius;
            set->shape = k;
        }
    }
    if (best_radius > 0 && !s.stopped) {
        take_shape(&s, search->P[set->shape], &log_volume);
        confirm(&s, best_radius, set);
    }
    set->simulations = s.simulations;
    free(s.cases);
    free(s.results);
    return s.stopped ? STANCE_STOPPED : STANCE_OK;
}
