/* return_map.c - the section, and where cases return to it. */
#include "gait.h"

#include "engine/tree.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST 100    /* s, until the last footfall */
#define NEAR 1e-7      /* m: a foot on the ground */
#define FAR 1e6        /* m: behind all feet */
#define SYMMETRIC 1e-9 /* of the energy, and so on: legs that are alike */
#define SLIDES 1e-6    /* m/s */

/* Reads coordinates or rates as the other leg sees them. */
static void exchange(const stance_scene *scene, const double *x, double *out)
{
    for (int i = 0; i < scene->coordinates; i++) {
        double sum = 0;
        for (int k = 0; k < scene->coordinates; k++)
            sum += scene->exchange.coordinate[i][k] * x[k];
        out[i] = sum;
    }
}

/* The gap of the second leg's foot, of a robot that stands on the first one's. */
static double gap_of(const struct return_map *map, const double *posture)
{
    double position[STANCE_MAX_COORDINATES], velocity[STANCE_MAX_COORDINATES] = {0};
    double gap[STANCE_MAX_CONTACTS];
    memcpy(position, posture, sizeof position);
    map->scene->stand(map->scene, map->base.robot, 1u << map->foot[0], position, velocity);
    map->scene->gaps(map->scene, map->base.robot, position, gap);
    return gap[map->foot[1]];
}

/* Its derivative by coordinate i. */
static double slope_of(const struct return_map *map, const double *posture, int i)
{
    const double d = 1e-6;
    double q[STANCE_MAX_COORDINATES];
    memcpy(q, posture, sizeof q);
    q[i] = posture[i] + d;
    const double above = gap_of(map, q);
    q[i] = posture[i] - d;
    return (above - gap_of(map, q)) / (2 * d);
}

bool return_map_state(const struct return_map *map, const struct return_point *at, double *position,
                      double *velocity)
{
    const stance_scene *const scene = map->scene;
    const int p = scene->postures, left = scene->posture[map->follows];
    memcpy(position, map->posture, sizeof map->posture);
    memset(velocity, 0, STANCE_MAX_COORDINATES * sizeof *velocity);
    for (int j = 0, i = 0; j < p; j++) {
        if (j != map->follows)
            position[scene->posture[j]] = at->z[i++];
        velocity[scene->posture[j]] = at->z[p - 1 + j];
    }
    double gap = 1;
    for (int round = 0; round < 30 && fabs(gap) > 1e-15; round++) {
        gap = gap_of(map, position) - at->behind;
        const double slope = slope_of(map, position, left);
        if (!(fabs(slope) > 1e-6))
            return false;
        position[left] -= gap / slope;
    }
    scene->stand(scene, map->base.robot, 1u << map->foot[0], position, velocity);
    return fabs(gap) < 1e-12;
}

void return_map_foot(const struct return_map *map, const double *position, const double *velocity,
                     int foot, double place[2], double speed[2])
{
    const double *const robot = map->base.robot;
    double sine, cosine, x[2], v[2];
    stance_sincos(robot[STANCE_ROBOT_SLOPE], &sine, &cosine);
    map->scene->contact_point(map->scene, robot, position, velocity, map->foot[foot], x, v);
    place[0] = cosine * x[0] - sine * x[1], place[1] = sine * x[0] + cosine * x[1];
    speed[0] = cosine * v[0] - sine * v[1], speed[1] = sine * v[0] + cosine * v[1];
}

char *return_map_initial(const struct return_map *map, const struct return_point *at, double height)
{
    const stance_scene *const scene = map->scene;
    double position[STANCE_MAX_COORDINATES], velocity[STANCE_MAX_COORDINATES];
    char *set = NULL;
    size_t size = 0;
    FILE *const out = open_memstream(&set, &size);
    if (!out)
        return NULL;
    return_map_state(map, at, position, velocity);
    const int left = scene->posture[map->follows];
    if (height != 0)
        position[left] += height / slope_of(map, position, left);
    fputs("initial={state: {", out);
    for (int rate = 0; rate < 2; rate++)
        for (int j = 0; j < scene->postures; j++) {
            const int k = scene->posture[j];
            fprintf(out, "%s%s%s: %.15g", rate + j ? ", " : "", rate ? "v" : "",
                    scene->coordinate[k].name, rate ? velocity[k] : position[k]);
        }
    if (scenario_numbers_feet(scene))
        fprintf(out, "}, support_foot: %d}", map->foot[0] + 1);
    else
        fprintf(out, "}, support: [%s]}", scene->contact_name[map->foot[0]]);
    if (fclose(out) == 0)
        return set;
    free(set);
    return NULL;
}

/* The section's coordinates of a state in which the second leg landed, or the first one. */
static void section_of(const struct return_map *map, const double *position, const double *velocity,
                       bool second, double *z, double *posture)
{
    const stance_scene *const scene = map->scene;
    double q[STANCE_MAX_COORDINATES], v[STANCE_MAX_COORDINATES];
    memcpy(q, position, sizeof q);
    memcpy(v, velocity, sizeof v);
    if (second) {
        exchange(scene, position, q);
        exchange(scene, velocity, v);
    }
    if (posture)
        memcpy(posture, q, sizeof q);
    for (int j = 0, i = 0; j < scene->postures; j++) {
        if (j != map->follows)
            z[i++] = q[scene->posture[j]];
        z[scene->postures - 1 + j] = v[scene->posture[j]];
    }
}

const char *return_map_name(const struct return_map *map, int i, char name[STANCE_NAME + 2])
{
    const int p = map->scene->postures, rate = i >= p - 1;
    const int j = rate ? i - (p - 1) : i + (i >= map->follows);
    snprintf(name, STANCE_NAME + 2, "%s%s", rate ? "v" : "",
             map->scene->coordinate[map->scene->posture[j]].name);
    return name;
}

/* Whether a case made its footfalls. */
static bool returned(const struct return_map *map, const stance_case *c, const stance_result *r,
                     stance_message *message)
{
    const long now = r->footfalls == STANCE_NO_COUNT ? 0 : (long)r->footfalls,
               made = map->made + now;
    if (r->status == STANCE_DONE && r->outcome != STANCE_FELL && now >= c->footfalls)
        return true;
    const char *const cause =
        r->outcome == STANCE_FELL && r->fall_cause > 0 ? map->scene->cause[r->fall_cause - 1] : "";
    return complain(message,
                    r->status != STANCE_DONE ? "a run failed after %ld footfall%s%s%s"
                    : r->outcome == STANCE_FELL
                        ? "it falls after %ld footfall%s%s%s; give a start that "
                          "walks (--settle 1 looks near the "
                          "start, --along follows a gait away from one)"
                        : "it makes %ld footfall%s in 100 s and no more%s%s",
                    made, made == 1 ? "" : "s", cause[0] ? ", by " : "", cause);
}

/* Ground under the foot behind, where it is not that under the other one: before all pieces that
 * there are, up to half-way between the feet. */
static bool lay_behind(const struct return_map *map, double behind, stance_case *c,
                       stance_message *message)
{
    stance_tree_numbers *const body = &c->body;
    double place[2][2], speed[2];
    if (behind == 0 || body->plates == 0)
        return true;
    if (body->plates > STANCE_MAX_PLATES - 2)
        return complain(message,
                        "ground.plates has too many pieces: two more are laid, for the foot "
                        "behind");
    for (int k = 0; k < 2; k++)
        return_map_foot(map, c->position, c->velocity, k, place[k], speed);
    memmove(body->plate + 2, body->plate, (size_t)body->plates * sizeof *body->plate);
    memmove(body->plate_kind + 2, body->plate_kind,
            (size_t)body->plates * sizeof *body->plate_kind);
    const double from[2] = {-FAR, 0.5 * (place[0][0] + place[1][0])};
    const bool ahead = place[1][0] < place[0][0];
    for (int k = 0; k < 2; k++) {
        const double height = (k == 0) == ahead ? behind : 0;
        body->plate_kind[k] = STANCE_PLATE;
        body->plate[k] =
            (stance_plate_numbers){.from = from[k], .height = height, .friction_factor = 1};
    }
    body->plates += 2;
    return true;
}

bool return_map_take(const struct return_map *map, size_t count, const struct return_point *from,
                     struct return_point *to, stance_message *message)
{
    stance_case *const cases = calloc(count, sizeof *cases);
    stance_result *const results = malloc(count * sizeof *results);
    bool good = (cases && results) || complain(message, "out of memory");
    for (size_t i = 0; good && i < count; i++) {
        cases[i] = map->base;
        cases[i].footfalls = map->steps;
        good =
            return_map_state(map, &from[i], cases[i].position, cases[i].velocity) ||
            complain(message, "both feet are not on the ground at once: no such posture is near");
        good = good && lay_behind(map, from[i].behind, &cases[i], message);
    }
    if (good)
        map->kernel->run(cases, results, count);
    for (size_t i = 0; good && i < count; i++) {
        double begin[2], end[2], speed[2], posture[STANCE_MAX_COORDINATES];
        const stance_result *const r = &results[i];
        const bool second = map->steps % 2;
        good = returned(map, &cases[i], r, message);
        if (!good)
            break;
        section_of(map, r->position, r->velocity, second, to[i].z, posture);
        to[i].behind = gap_of(map, posture);
        return_map_foot(map, r->position, r->velocity, second, end, speed);
        good = hypot(speed[0], speed[1]) <= SLIDES ||
               complain(message, "the foot that lands slides: no gait on feet that stick; give "
                                 "more ground.friction");
        return_map_foot(map, cases[i].position, cases[i].velocity, 0, begin, speed);
        to[i].time = r->end_time;
        to[i].length = end[0] - begin[0];
        to[i].result = *r;
    }
    free(cases);
    free(results);
    return good;
}

/* Where the torques of a linear law do not depend on which leg is which. */
static bool law_alike(const stance_scene *scene, const stance_case *c,
                      const double (*q)[STANCE_MAX_COORDINATES],
                      const double (*v)[STANCE_MAX_COORDINATES])
{
    const stance_exchange *const e = &scene->exchange;
    double torque[2][STANCE_MAX_ACTUATORS], limit[STANCE_MAX_ACTUATORS], off = 0, size = 1;
    stance_torque_limits(scene, c->robot, c->torque_limit, c->torque_limits, limit);
    for (int i = 0; i < scene->actuators; i++)
        if (limit[i] != limit[e->actuator[i]])
            return false;
    if (c->follows)
        return true;
    if (c->decouples || c->switches || c->bends)
        return false;
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < scene->actuators; i++) {
            torque[side][i] = c->near.feedforward[i];
            for (int j = 0; j < scene->postures; j++) {
                const int k = scene->posture[j];
                torque[side][i] -= c->near.gain[i][j] * (q[side][k] - c->near.target[j]) +
                                   c->near.gain[i][scene->postures + j] * v[side][k];
            }
        }
    for (int i = 0; i < scene->actuators; i++) {
        off = fmax(off, fabs(torque[1][i] - e->sign[i] * torque[0][e->actuator[i]]));
        size = fmax(size, fabs(torque[0][i]));
    }
    return off <= SYMMETRIC * size;
}

/* The contacts of one leg are to the ground what those of the other one are, legs exchanged. */
static bool feet_alike(const stance_scene *scene, const stance_case *c,
                       const double (*q)[STANCE_MAX_COORDINATES])
{
    double gap[2][STANCE_MAX_CONTACTS];
    bool same = true;
    for (int side = 0; side < 2; side++)
        scene->gaps(scene, c->robot, q[side], gap[side]);
    for (int a = 0, b = -1; a < scene->contacts; a++) {
        if (!(scene->exchange.leg[0] >> a & 1))
            continue;
        do /* its counterpart: the legs have them in the same order */
            b++;
        while (b < scene->contacts && !(scene->exchange.leg[1] >> b & 1));
        if (b >= scene->contacts)
            return false;
        same = same && fabs(gap[0][a] - gap[1][b]) <= SYMMETRIC &&
               fabs(gap[0][b] - gap[1][a]) <= SYMMETRIC && c->body.rough[a] == c->body.rough[b] &&
               (c->contacts >> a & 1) == (c->contacts >> b & 1);
    }
    return same;
}

/* Nothing tells one leg from the other: energy, feet, law. */
static bool alike(const stance_scene *scene, const stance_case *c)
{
    double q[2][STANCE_MAX_COORDINATES] = {{0}}, v[2][STANCE_MAX_COORDINATES] = {{0}};
    for (int i = 0; i < scene->coordinates; i++) {
        q[0][i] = 0.1 + 0.37 * i;
        v[0][i] = 0.7 - 0.29 * i;
    }
    exchange(scene, q[0], q[1]);
    exchange(scene, v[0], v[1]);
    const double e = scene->energy(scene, c->robot, q[0], v[0]);
    return fabs(scene->energy(scene, c->robot, q[1], v[1]) - e) <= SYMMETRIC * (1 + fabs(e)) &&
           feet_alike(scene, c, (const double(*)[STANCE_MAX_COORDINATES])q) &&
           law_alike(scene, c, (const double(*)[STANCE_MAX_COORDINATES])q,
                     (const double(*)[STANCE_MAX_COORDINATES])v);
}

/* Does anything happen at a time of its own? */
static bool timed(const stance_case *c)
{
    bool any = false;
    for (int p = 0; p < c->tree->pushes; p++)
        any |= c->body.push[p][2] != 0 || c->body.push[p][3] != 0;
    for (int i = 0; i < c->scene->actuators && c->decouples && !c->follows; i++)
        any |= c->servo[i].ki != 0 || c->servo[i].ramp != 0;
    return any;
}

static bool check(const stance_case *c, const stance_kernel *kernel, int steps,
                  stance_message *message)
{
    const char *const method = kernel->method->name;
    const bool noisy = c->noise != 0 || c->angle_noise != 0 || c->rate_noise != 0,
               late =
                   c->delay > 0 || c->lag > 0 || (c->torque_rate > 0 && isfinite(c->torque_rate));
    bool uneven = false;
    if (c->scene->exchange.any && strcmp(method, "capturing") != 0 &&
        strcmp(method, "event-driven") != 0)
        return complain(message,
                        "%s puts footfalls at the end of a step; give method.name capturing or "
                        "event-driven",
                        method);
    for (int k = 0; k < c->body.plates; k++)
        uneven |= c->body.plate[k].footfall == 0 && c->body.plate[k].height != 0;
    const char *const wrong =
        !c->scene->exchange.any ? "no two legs of the robot are alike in structure"
        : noisy ? "a gait with noise has no cycle: set controller.noise, angle_noise and "
                  "rate_noise to 0"
        : late  ? "controller.delay, lag and torque_rate remember the step before, which the "
                  "section does not"
        : c->restitution > 0 ? "a foot that rebounds is not on the ground after its footfall: set "
                               "ground.restitution to 0"
        : uneven   ? "on uneven ground no step is as the one before: leave out ground.plates, but "
                     "for one with footfall: 1 and height: 0 that --sensitivity varies"
        : timed(c) ? "a gait has no time of its own: pushes, ramps and integrals of a run begin "
                     "once, not at each footfall"
        : steps % 2 != 0 && !alike(c->scene, c)
            ? "the legs, or what drives them, differ: a gait repeats after an even number of "
              "steps; give --steps 2"
            : NULL;
    return !wrong || complain(message, "%s", wrong);
}

bool return_map_settle(const struct return_map *map, const struct return_point *from, size_t first,
                       size_t count, double *time)
{
    struct return_map one = *map;
    struct return_point at = *from;
    stance_message ignored;
    one.steps = alike(map->scene, &map->base) ? 1 : map->steps;
    for (size_t k = 0, made = 0; k < count; made += (size_t)one.steps) {
        at.behind = 0;
        if (!return_map_take(&one, 1, &at, &at, &ignored))
            return false;
        if (made >= first)
            time[k++] = at.time / one.steps;
    }
    return true;
}

static void take_case(struct return_map *map, const stance_case *c)
{
    map->base = *c;
    map->base.settle = map->base.has_target = false;
    map->base.walk_steps = map->base.walk_enough = 0;
    map->base.trajectory = NULL;
    map->base.steps = (int64_t)(LONGEST / c->step);
}

bool return_map_change(struct return_map *map, const stance_case *c, stance_message *message)
{
    if (!check(c, map->kernel, map->steps, message))
        return false;
    map->scene = c->scene;
    take_case(map, c);
    return true;
}

/* Which leg landed: its foot on the ground is the slowest one there. */
static bool lands_second(const stance_scene *scene, const stance_case *c, const stance_result *r)
{
    double gap[STANCE_MAX_CONTACTS], point[2], speed[2], least[2] = {INFINITY, INFINITY};
    scene->gaps(scene, c->robot, r->position, gap);
    for (int k = 0; k < scene->contacts; k++)
        for (int leg = 0; leg < 2; leg++)
            if (scene->grip[k] >= 0 && scene->exchange.leg[leg] >> k & 1 && fabs(gap[k]) < NEAR) {
                scene->contact_point(scene, c->robot, r->position, r->velocity, k, point, speed);
                least[leg] = fmin(least[leg], hypot(speed[0], speed[1]));
            }
    return least[1] < least[0];
}

bool return_map_begin(struct return_map *map, const stance_case *c, const stance_kernel *kernel,
                      int steps, int settle, struct return_point *from, stance_message *message)
{
    const stance_scene *const scene = c->scene;
    stance_case first;
    stance_result r;
    double gap[STANCE_MAX_CONTACTS], largest = 0;
    if (!check(c, kernel, steps, message))
        return false;
    *map = (struct return_map){.scene = scene, .kernel = kernel, .steps = steps};
    take_case(map, c);
    first = map->base;
    first.footfalls = 1;
    for (bool again = true; again; first.footfalls++) { /* legs that differ keep their places */
        kernel->run(&first, &r, 1);
        if (!returned(map, &first, &r, message))
            return false;
        again = steps % 2 == 0 && first.footfalls == 1 && lands_second(scene, c, &r);
    }
    scene->gaps(scene, c->robot, r.position, gap);
    for (int leg = 0; leg < 2; leg++) {
        int feet = 0;
        for (int k = 0; k < scene->contacts; k++)
            if (scene->grip[k] >= 0 && scene->exchange.leg[leg] >> k & 1 && fabs(gap[k]) < NEAR)
                map->foot[leg] = k, feet++;
        if (feet != 1)
            return complain(message,
                            "at a footfall one contact of each leg, no more, has to be on the "
                            "ground, which is the same plane in each step of a gait");
    }
    const bool second = lands_second(scene, c, &r);
    map->n = 2 * scene->postures - 1;
    section_of(map, r.position, r.velocity, second, from->z, map->posture);
    for (int j = 0; j < scene->postures; j++) {
        const double slope = fabs(slope_of(map, map->posture, scene->posture[j]));
        if (slope > largest)
            largest = slope, map->follows = j;
    }
    section_of(map, r.position, r.velocity, second, from->z, NULL);
    if (!(largest > 1e-6))
        return complain(message, "no angle lifts a foot");
    from->behind = 0;
    for (map->made = 1; map->made < settle; map->made += steps) {
        if (!return_map_take(map, 1, from, from, message))
            return false;
        from->behind = 0;
    }
    map->made = 0;
    return true;
}
