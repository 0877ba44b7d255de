/* basin_ranges.c - see basin_ranges.h. */
#include "basin_ranges.h"

#include "runner/base/message.h"
#include "runner/base/units.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 0.04   /* relative, of the bracket of an end */
#define GROWTH 1.5   /* of the distance until the outcome is lost */
#define NOTHING 1e-6 /* windows of settling that are no distance any more */
#define MARGIN 1.1   /* of the ranges */
#define EVEN 0.6     /* a shorter side of this part of the longer one: the range is symmetric */

/* Simulations that the end of a ray takes, about. */
#define PER_RAY 11

/* Directions that are drawn in a round: so many for each dimension, and at most. */
enum { ROUNDS = 3, DRAWN = 16, MOST_DRAWN = 64, RAYS = MOST_DRAWN + 2 * STARTS_MOST, HALVES = 40 };

/* ---- axes --------------------------------------------------------------------------------- */

/* Which coordinate of the start stands there: places, then rates; -1: another number. */
static int coordinate_at(const struct scenario *s, size_t offset)
{
    const size_t begin = s->base.state_given ? offsetof(struct scenario_values, state)
                                             : offsetof(struct scenario_values, offset);
    const size_t i = (offset - begin) / sizeof(double);
    return offset >= begin && i < 2 * (size_t)s->scene->coordinates ? (int)i : -1;
}

static bool add_field(struct ranges *r, struct ranges_axis *axis, const char *path, size_t offset,
                      double along)
{
    const int i = coordinate_at(r->s, offset), n = r->s->scene->coordinates;
    const struct scenario_values *base = &r->s->base;
    if (i < 0 || r->fields == STARTS_MOST || !isfinite(along))
        return false;
    struct starts_field *const field = &r->field[r->fields++];
    *field = (struct starts_field){.offset = offset,
                                   .axis = r->axes,
                                   .centre = base->state_given ? base->state[i] : 0,
                                   .along = along};
    snprintf(field->path, sizeof field->path, "%s", path);
    const double size = fmax(fabs(along), 1e-300);
    const char *const unit = r->s->scene->coordinate[i % n].unit;
    const double most = i >= n                     ? RANGES_RATE
                        : strcmp(unit, "rad") == 0 ? RANGES_ANGLE
                                                   : RANGES_PLACE;
    axis->limit = fmin(axis->limit, most / size);
    axis->window = fmin(axis->window, (i >= n ? base->settle_rate : base->settle_angle) / size);
    if (axis->fields++ == 0)
        snprintf(axis->unit, sizeof axis->unit, "%s%s", unit, i >= n ? "/s" : "");
    return true;
}

/* An axis along which paths[count] move from one row to another; none where it moves anything else
 * than starts, or nothing. */
static void add_axis(struct ranges *r, const struct scenario_axis *of, int first, int paths,
                     const double *from, const double *to, size_t points)
{
    struct ranges_axis axis = {.first = r->fields,
                               .limit = INFINITY,
                               .window = INFINITY,
                               .count = points,
                               .sampled = of->sample};
    double unit = 0;
    for (int k = 0; k < paths && unit == 0; k++)
        unit = fabs(to[k] - from[k]);
    bool good = unit > 0;
    for (int k = 0; k < paths && good; k++)
        good = add_field(r, &axis, of->path[first + k], of->offset[first + k],
                         (to[k] - from[k]) / unit);
    axis.possible[0] = axis.possible[1] = axis.limit;
    if (good)
        r->axis[r->axes++] = axis;
    else
        r->fields = axis.first;
}

static void add_swept(struct ranges *r)
{
    const struct scenario *s = r->s;
    double from[SCENARIO_MAX_PATHS] = {0}, to[SCENARIO_MAX_PATHS] = {0};
    for (int a = 0; a < s->axes; a++) {
        const struct scenario_axis *axis = &s->axis[a];
        if (axis->sample || axis->words)
            continue;
        for (int k = 0; k < axis->paths; k++) {
            from[k] = scenario_axis_value(axis, 0, k);
            to[k] = scenario_axis_value(axis, axis->count - 1, k);
        }
        add_axis(r, axis, 0, axis->paths, from, to, axis->count);
    }
    for (size_t j = 0; s->sample.given && j < s->sample.design.factors; j++) {
        const struct scenario_factor *f = &s->sample.factor[j];
        add_axis(r, &s->axis[s->axes - 1], f->first, f->paths, f->value,
                 f->value + (f->points - 1) * (size_t)f->paths, 0);
    }
    r->symmetric = s->sample.given && s->sample.design.method == DOE_SPHERE;
}

/* The angle of a coordinate and its rate. */
static void add_coordinate(struct ranges *r, int i)
{
    const struct scenario *s = r->s;
    const size_t begin = s->base.state_given ? offsetof(struct scenario_values, state)
                                             : offsetof(struct scenario_values, offset);
    for (int rate = 0; rate < 2; rate++) {
        char path[96];
        struct ranges_axis axis = {.first = r->fields, .limit = INFINITY, .window = INFINITY};
        snprintf(path, sizeof path, "initial.%s.%s%s", s->base.state_given ? "state" : "offset",
                 rate ? "v" : "", s->scene->coordinate[i].name);
        if (add_field(r, &axis, path,
                      begin + (size_t)(i + rate * s->scene->coordinates) * sizeof(double), 1)) {
            axis.possible[0] = axis.possible[1] = axis.limit;
            r->axis[r->axes++] = axis;
        }
    }
}

/* The postures, but for those that the contacts of the equilibrium hold. */
static void add_postures(struct ranges *r, const struct scenario_values *values)
{
    const stance_scene *scene = r->s->scene;
    double model[STANCE_MAX_ROBOT];
    stance_equilibrium equilibrium;
    stance_message ignored;
    const bool known = resolve_equilibrium(scene, values, model, &equilibrium, &ignored);
    for (int k = 0; k < scene->postures; k++) {
        bool free = !known;
        for (int p = 0; known && p < equilibrium.freedoms; p++)
            free = free || equilibrium.freedom[p] == scene->posture[k];
        if (free)
            add_coordinate(r, scene->posture[k]);
    }
}

/* ---- rays --------------------------------------------------------------------------------- */

/* The axes that starts are asked for along. */
static void take_axes(const struct ranges *r, struct starts *starts)
{
    memcpy(starts->field, r->field, sizeof starts->field);
    starts->fields = r->fields;
    starts->axes = r->axes;
}

/* How far there are starts along axis a alone, up or down: the ranges end there. */
static void limit_ranges(struct ranges *r, struct starts *starts, int a, int up)
{
    struct ranges_axis *axis = &r->axis[a];
    double x[STARTS_MOST] = {0}, low = 0, high = axis->possible[up];
    for (int halves = 0; halves <= HALVES; halves++) {
        const double size = halves ? 0.5 * (low + high) : high;
        x[a] = up ? size : -size;
        *(starts_possible(starts, x) ? &low : &high) = size;
        if (low == high)
            break;
    }
    axis->possible[up] = low;
}

/* Finds their ends: from `first` on by that factor until lost, then by halves. */
static bool end_rays(struct ranges *r, struct starts *starts, struct descend_ray *ray, size_t count,
                     double first, double growth)
{
    const struct descend_set set = {r->axes, UINT64_C(1) << r->of, starts_run, starts};
    const struct descend_way way = {first, growth - 1, false, WIDTH, NOTHING * first};
    for (size_t k = 0; k < count; k++) {
        ray[k].most = INFINITY;
        for (int a = 0; a < r->axes; a++)
            if (ray[k].v[a] != 0)
                ray[k].most = fmin(ray[k].most, r->axis[a].limit / fabs(ray[k].v[a]));
        ray[k].beyond = RANGES_OPEN;
    }
    r->rays += count;
    return descend_rays(&set, &way, ray, count);
}

static double middle(const struct descend_ray *ray)
{
    return isfinite(ray->high) ? 0.5 * (ray->low + ray->high) : ray->low;
}

/* Down and up along every axis. ray[2 axes]. */
static bool along_axes(struct ranges *r, struct starts *starts, struct descend_ray *ray)
{
    memset(ray, 0, 2 * (size_t)r->axes * sizeof *ray);
    for (int k = 0; k < 2 * r->axes; k++)
        ray[k].v[k / 2] = (k % 2 ? 1 : -1) * r->axis[k / 2].window;
    const bool good = end_rays(r, starts, ray, 2 * (size_t)r->axes, 1, 2);
    for (int k = 0; k < 2 * r->axes && good && r->held == 0; k++) {
        r->axis[k / 2].alone[k % 2] = middle(&ray[k]) * ray[k].v[k / 2];
        r->axis[k / 2].beyond[k % 2] = ray[k].beyond;
    }
    return good;
}

static void take_reach(struct ranges *r, const struct descend_ray *ray, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        const bool open = !isfinite(ray[k].high);
        r->open += open;
        for (int a = 0; a < r->axes; a++) {
            struct ranges_axis *axis = &r->axis[a];
            const double x = (open ? ray[k].low : ray[k].high) * ray[k].v[a];
            axis->reach[0] = fmin(axis->reach[0], x);
            axis->reach[1] = fmax(axis->reach[1], x);
            if (open && fabs(x) >= axis->limit * (1 - 1e-9))
                axis->open[x > 0] = true;
        }
    }
}

/* L of C = L L', in place, lower; a direction that has no extent gets none. */
static void factorise(int n, double *C)
{
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            double sum = C[i * n + j];
            for (int k = 0; k < j; k++)
                sum -= C[i * n + k] * C[j * n + k];
            if (i == j)
                C[i * n + j] = sum > 0 ? sqrt(sum) : 0;
            else
                C[i * n + j] = C[j * n + j] > 0 ? sum / C[j * n + j] : 0;
        }
        for (int i = 0; i < j; i++)
            C[i * n + j] = 0;
    }
}

/* Rounds of rays about one equilibrium, that of `starts`. */
static bool shoot(struct ranges *r, struct starts *starts)
{
    const int n = r->axes;
    struct descend_ray ray[RAYS];
    double C[STARTS_MOST * STARTS_MOST] = {0}, L[STARTS_MOST * STARTS_MOST], u[STARTS_MOST];
    const uint64_t drawn = n * DRAWN < MOST_DRAWN ? (uint64_t)(n * DRAWN) : MOST_DRAWN;
    struct doe directions = {
        .method = DOE_SPHERE, .count = ROUNDS * drawn, .factors = (size_t)n, .seed = r->s->seed};
    bool good = along_axes(r, starts, ray) && doe_begin(&directions);
    size_t count = 2 * (size_t)n;
    for (int round = 0; round < ROUNDS && good && n > 1; round++) {
        memset(C, 0, sizeof C);
        for (size_t k = 0; k < count; k++)
            for (int i = 0; i < n * n; i++)
                C[i] += n / (double)count * middle(&ray[k]) * middle(&ray[k]) * ray[k].v[i / n] *
                        ray[k].v[i % n];
        take_reach(r, ray, count);
        memcpy(L, C, sizeof L);
        factorise(n, L);
        count = 0;
        for (uint64_t k = 0; k < drawn; k++, count++) {
            doe_unit(&directions, (uint64_t)round * drawn + k, u);
            for (int i = 0; i < n; i++) {
                ray[count].v[i] = 0;
                for (int j = 0; j <= i; j++)
                    ray[count].v[i] += L[i * n + j] * (2 * u[j] - 1);
            }
        }
        for (int a = 0; a < n; a++)
            for (int up = 0; up < 2 && C[a * n + a] > 0; up++, count++)
                for (int i = 0; i < n; i++)
                    ray[count].v[i] = (up ? 1 : -1) * C[i * n + a] / sqrt(C[a * n + a]);
        good = end_rays(r, starts, ray, count, 0.25, GROWTH);
    }
    if (good)
        take_reach(r, ray, count);
    doe_end(&directions);
    return good;
}

/* ---- what is proposed --------------------------------------------------------------------- */

/* The next number of two digits, up or down. */
static double round_to(double x, bool up)
{
    const double unit = pow(10, floor(log10(x)) - 1), n = x / unit;
    return (up ? ceil(n * (1 - 1e-9)) : floor(n * (1 + 1e-9))) * unit;
}

/* A range that holds x from -down to up, of which there are starts; the equilibrium is one of its
 * points. */
static struct ranges_range propose(const struct ranges *r, const struct ranges_axis *axis,
                                   double down, double up)
{
    static const size_t usual[] = {257, 129, 33, 17};
    const size_t few = r->axes <= 4 ? usual[r->axes - 1] : 9;
    const size_t count = axis->count > 2 && axis->count < 1000000 ? axis->count | 1 : few;
    const double longer = fmax(down, up), margin = 0.5 * (MARGIN - 1) * (down + up),
                 possible = fmin(axis->possible[0], axis->possible[1]);
    struct ranges_range range = {.points = axis->sampled ? 0 : count};
    if (r->symmetric || (fmin(down, up) >= EVEN * longer && possible >= longer)) {
        range.to = round_to(MARGIN * longer, true);
        if (range.to > possible)
            range.to = possible > 0 ? round_to(possible, false) : 0;
        range.from = -range.to;
        return range;
    }
    const double step = round_to((down + up + 2 * margin) / (double)(count - 1), true),
                 below = fmin(ceil((down + margin) / step), floor(axis->possible[0] / step));
    double above = fmin(ceil((up + margin) / step), floor(axis->possible[1] / step));
    if (fmod(below + above, 2) > 0 && (above + 1) * step <= axis->possible[1])
        above++;
    range.from = -below * step;
    range.to = above * step;
    if (!axis->sampled)
        range.points = (size_t)(below + above) + 1;
    return range;
}

bool ranges_resolve(const struct ranges *r)
{
    for (int a = 0; a < r->axes; a++) {
        const struct ranges_axis *axis = &r->axis[a];
        const double cell =
            (axis->whole.to - axis->whole.from) / fmax(1, (double)axis->whole.points - 1);
        if (!axis->sampled && axis->alone[1] - axis->alone[0] < RANGES_CELLS * cell)
            return false;
    }
    return true;
}

enum ranges_cut ranges_cut(const struct ranges_axis *axis, int up)
{
    const double end = up ? axis->whole.to : -axis->whole.from,
                 reach = up ? axis->reach[1] : -axis->reach[0];
    if (axis->open[up])
        return RANGES_NOT_FOLLOWED;
    return end >= reach                       ? RANGES_HELD
           : axis->possible[up] < axis->limit ? RANGES_NO_START
                                              : RANGES_NOT_FOLLOWED;
}

/* Of the whole ranges at one point of the other axes. */
static bool measure_share(struct ranges *r, struct starts *starts)
{
    const size_t n = (size_t)r->axes;
    double *x = malloc(RANGES_STARTS * n * sizeof *x), u[STARTS_MOST];
    uint8_t end[RANGES_STARTS];
    struct doe points = {
        .method = DOE_SOBOL, .count = RANGES_STARTS, .factors = n, .seed = r->s->seed};
    size_t inside = 0;
    bool good = x && doe_begin(&points);
    for (size_t i = 0; good && i < RANGES_STARTS; i++) {
        doe_unit(&points, i, u);
        for (size_t a = 0; a < n; a++)
            x[i * n + a] =
                r->axis[a].whole.from + u[a] * (r->axis[a].whole.to - r->axis[a].whole.from);
    }
    good = good && starts_run(starts, RANGES_STARTS, x, end);
    for (size_t i = 0; good && i < RANGES_STARTS; i++) {
        inside += end[i] == r->of;
        r->impossible += end[i] == STARTS_IMPOSSIBLE;
    }
    const double share = (double)inside / RANGES_STARTS;
    r->share[0] = fmin(r->share[0], share);
    r->share[1] = fmax(r->share[1], share);
    doe_end(&points);
    free(x);
    return good;
}

/* ---- progress ------------------------------------------------------------------------------- */

/* About how many simulations there will be. */
static double simulations(const struct ranges *r)
{
    const double n = r->axes > 0 ? r->axes : 2, rounds = n > 1 ? ROUNDS : 0;
    const double rays = 2 * n + rounds * (fmin(n * DRAWN, MOST_DRAWN) + 2 * n);
    return (double)r->parameters * (PER_RAY * rays + RANGES_STARTS);
}

static void tell(void *context, uint64_t more)
{
    struct ranges *const r = context;
    char left[PROGRESS_LEFT];
    const double done = (double)(r->simulated + more), all = simulations(r);
    if (progress_due(&r->progress, clock_seconds()))
        progress_say(&r->progress, "%.0f of about %.0f simulations%s", done, fmax(done, all),
                     progress_left(&r->progress, fmin(1, done / all), left));
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* Case at point `left` of the parameters alone, axes that move anything else than starts, and how
 * many points they have. */
static uint64_t parameter_case(const struct scenario *s, uint64_t left, uint64_t *points)
{
    uint64_t index = 0, stride = 1;
    *points = 1;
    for (int a = s->axes - 1; a >= 0; a--) {
        const struct scenario_axis *const axis = &s->axis[a];
        const size_t count = axis->count;
        bool other = axis->words;
        for (int k = 0; k < axis->paths; k++)
            other = other || (coordinate_at(s, axis->offset[k]) < 0 &&
                              axis->offset[k] != offsetof(struct scenario_values, offset_scale));
        if (other) {
            index += stride * (left % count);
            left /= count;
            *points *= count;
        }
        stride *= count;
    }
    return index;
}

/* Begins at parameters k of r->parameters, evenly spread. *end: what becomes of the equilibrium. */
static bool begin(struct ranges *r, struct starts *starts, size_t k, uint8_t *end,
                  stance_message *message)
{
    static const double nowhere[STARTS_MOST] = {0};
    uint64_t points;
    parameter_case(r->s, 0, &points);
    const uint64_t at =
        r->parameters < 2
            ? 0
            : (uint64_t)((double)(points - 1) * (double)k / (double)(r->parameters - 1));
    if (!starts_begin(starts, r->s, parameter_case(r->s, at, &points), message))
        return false;
    if (r->chosen)
        memset(starts->values.offset, 0, sizeof starts->values.offset);
    take_axes(r, starts);
    return starts_run(starts, 1, nowhere, end) || no_memory(message);
}

/* How soon the outcome is lost along an angle and its rate, axes k and k + 1, in windows. */
static double nearness(const struct descend_ray *ray, int k)
{
    double near = INFINITY;
    for (int j = 2 * k; j < 2 * k + 4; j++)
        near = fmin(near, middle(&ray[j]));
    return near;
}

/* Of all postures the one that matters most becomes the axes. */
static bool choose(struct ranges *r, struct starts *starts)
{
    struct descend_ray ray[RAYS];
    int first = 0;
    take_axes(r, starts);
    if (!along_axes(r, starts, ray))
        return false;
    for (int k = 0; k < r->axes; k += 2)
        first = nearness(ray, k) < nearness(ray, first) ? k : first;
    for (int k = 0; k < 2 && first > 0; k++) {
        const struct ranges_axis axis = r->axis[k];
        const struct starts_field field = r->field[k];
        r->axis[k] = r->axis[first + k];
        r->field[k] = r->field[first + k];
        r->axis[first + k] = axis;
        r->field[first + k] = field;
        r->axis[k].first = r->field[k].axis = k;
        r->axis[first + k].first = r->field[first + k].axis = first + k;
    }
    for (int f = 0; f < r->fields; f++)
        memcpy((char *)&starts->values + r->field[f].offset, &r->field[f].centre, sizeof(double));
    r->looked = r->axes;
    r->axes = r->fields = 2;
    take_axes(r, starts);
    return true;
}

const char *ranges_end(uint8_t end)
{
    static const char *const name[] = {"failed", "no start", "not lost"};
    return end < STARTS_FAILED ? stance_outcome_name[end] : name[end - STARTS_FAILED];
}

/* Why there are no ranges though there are designs: the equilibrium itself has that end. */
static bool complain_of(const struct ranges *r, uint8_t end, const stance_message *why,
                        stance_message *message)
{
    const char *is = ranges_end(end), *of = ranges_end(r->of),
               *start = r->s->base.state_given ? "initial.state" : "the equilibrium";
    if (end == STARTS_IMPOSSIBLE)
        return complain(message, "%s itself is no start: %.180s", start, why->text);
    if (end == STARTS_FAILED)
        return complain(message, "the simulation from %s itself failed numerically", start);
    if (!r->s->base.settle && r->of == STANCE_STABILISED)
        return complain(message,
                        "%s itself ends as %s, as stop.settle is \"off\": set it, or "
                        "ask for another outcome with --of",
                        start, is);
    return complain(message,
                    "%s itself ends as %s, so no domain of %s starts is about it "
                    "(stance design tells how the loop stands; --of %s asks for those)",
                    start, is, of, is);
}

/* Rays at one point of the parameters; `held` stays where there is nothing to shoot from. */
static bool look(struct ranges *r, struct starts *starts, size_t k, uint8_t *end,
                 stance_message *message)
{
    if (!begin(r, starts, k, end, message))
        return message->text[0] && strcmp(message->text, "not enough memory") != 0;
    bool good = true;
    if (*end == r->of) {
        if (r->axes == 0) {
            add_postures(r, &starts->values);
            if (r->axes == 0)
                return complain(message, "the contacts hold all of the posture");
            good = choose(r, starts);
        }
        for (int side = 0; good && side < 2 * r->axes; side++)
            limit_ranges(r, starts, side / 2, side % 2);
        good = good && shoot(r, starts);
        r->held++;
    }
    r->simulated += starts->simulated;
    r->failed += starts->failed;
    return good || no_memory(message);
}

static bool share_of_all(struct ranges *r, struct starts *starts, stance_message *message)
{
    uint8_t end;
    bool good = true;
    r->share[0] = 1;
    for (size_t k = 0; good && k < r->parameters; k++) {
        if (!begin(r, starts, k, &end, message) || end != r->of)
            continue;
        good = measure_share(r, starts);
        r->simulated += starts->simulated;
        r->failed += starts->failed;
    }
    return good || no_memory(message);
}

static bool find(struct ranges *r, struct starts *starts, stance_message *message)
{
    uint8_t end = STANCE_NONE;
    bool good = true;
    for (size_t k = 0; good && k < r->parameters; k++)
        good = look(r, starts, k, &end, message);
    if (!good || (r->held == 0 && end == STANCE_NONE))
        return false; /* there is no design: the message says why */
    if (r->held == 0)
        return complain_of(r, end, &starts->why, message);
    for (int a = 0; a < r->axes; a++) {
        struct ranges_axis *axis = &r->axis[a];
        if (!(axis->reach[1] - axis->reach[0] > 4 * NOTHING * axis->window))
            return complain(message, "no start beside the equilibrium is %s along %s",
                            ranges_end(r->of), r->field[axis->first].path);
        axis->whole = propose(r, axis, -axis->reach[0], axis->reach[1]);
        axis->close = propose(r, axis, fmin(-axis->reach[0], -2 * axis->alone[0]),
                              fmin(axis->reach[1], 2 * axis->alone[1]));
    }
    return share_of_all(r, starts, message);
}

bool ranges_make(struct ranges *r, const struct scenario *s, uint8_t of, stance_message *message)
{
    uint64_t points;
    parameter_case(s, 0, &points);
    *r = (struct ranges){.s = s, .of = of};
    r->parameters = points < RANGES_PARAMETERS ? (size_t)points : RANGES_PARAMETERS;
    add_swept(r);
    r->looked = r->axes;
    r->chosen = r->axes == 0;
    if (r->chosen && s->scene->postures == 0)
        return complain(message,
                        "the scene %s has no posture to depart from, and no axis of the sweep is "
                        "over initial.offset or initial.state",
                        s->scene->name);
    struct starts *starts = malloc(sizeof *starts);
    r->progress = progress_begin(false);
    if (starts)
        *starts = (struct starts){.tell = tell, .context = r};
    const bool good = starts ? find(r, starts, message) : no_memory(message);
    progress_end(&r->progress);
    free(starts);
    return good;
}
