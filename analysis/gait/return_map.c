/* return_map.c - the section, and where cases return to it. */
#include "return_map.h"

#include "engine/tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST 100    /* s, until the last footfall */
#define NEAR 1e-7      /* m: a foot on the ground */
#define FAR 1e6        /* m: behind all feet */
#define SYMMETRIC 1e-9 /* of the energy, and so on: legs that are alike */
#define SLIDES 1e-6    /* m/s */

static bool refuse(stance_message *message, const char *text)
{
    snprintf(message->text, sizeof message->text, "%s", text);
    return false;
}

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

bool return_map_state(const struct return_map *map, const double *z, double *position,
                      double *velocity)
{
    const stance_scene *const scene = map->scene;
    const int p = scene->postures, left = scene->posture[map->follows];
    memcpy(position, map->posture, sizeof map->posture);
    memset(velocity, 0, STANCE_MAX_COORDINATES * sizeof *velocity);
    for (int j = 0, i = 0; j < p; j++) {
        if (j != map->follows)
            position[scene->posture[j]] = z[i++];
        velocity[scene->posture[j]] = z[p - 1 + j];
    }
    double gap = 1;
    for (int round = 0; round < 30 && fabs(gap) > 1e-15; round++) {
        gap = gap_of(map, position) - map->behind;
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

void return_map_lift(const struct return_map *map, double height, double *position)
{
    const int left = map->scene->posture[map->follows];
    if (height != 0)
        position[left] += height / slope_of(map, position, left);
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

/* Whether a case made its footfalls, after `before` others. */
static bool returned(const struct return_map *map, const stance_case *c, const stance_result *r,
                     long before, stance_message *message)
{
    const long now = r->footfalls == STANCE_NO_COUNT ? 0 : (long)r->footfalls, made = before + now;
    if (r->status == STANCE_DONE && r->outcome != STANCE_FELL && now >= c->footfalls)
        return true;
    const char *const cause =
        r->outcome == STANCE_FELL && r->fall_cause > 0 ? map->scene->cause[r->fall_cause - 1] : "";
    snprintf(message->text, sizeof message->text,
             r->status != STANCE_DONE    ? "a run failed after %ld footfall%s%s%s"
             : r->outcome == STANCE_FELL ? "it falls after %ld footfall%s%s%s; give a start that "
                                           "walks (--settle 1 looks near the "
                                           "start, --along follows a gait away from one)"
                                         : "it makes %ld footfall%s in 100 s and no more%s%s",
             made, made == 1 ? "" : "s", cause[0] ? ", by " : "", cause);
    return false;
}

/* Ground under the foot behind, where it is not that under the other one: before all pieces that
 * there are, up to half-way between the feet. */
static bool lay_behind(const struct return_map *map, stance_case *c, stance_message *message)
{
    stance_tree_numbers *const body = &c->body;
    double place[2][2], speed[2];
    if (map->behind == 0 || body->plates == 0)
        return true;
    if (body->plates > STANCE_MAX_PLATES - 2)
        return refuse(message, "ground.plates has too many pieces: two more are laid, for the foot "
                               "behind");
    for (int k = 0; k < 2; k++)
        return_map_foot(map, c->position, c->velocity, k, place[k], speed);
    memmove(body->plate + 2, body->plate, (size_t)body->plates * sizeof *body->plate);
    memmove(body->plate_kind + 2, body->plate_kind,
            (size_t)body->plates * sizeof *body->plate_kind);
    const double from[2] = {-FAR, 0.5 * (place[0][0] + place[1][0])};
    const bool ahead = place[1][0] < place[0][0];
    for (int k = 0; k < 2; k++) {
        const double height = (k == 0) == ahead ? map->behind : 0;
        body->plate_kind[k] = STANCE_PLATE;
        body->plate[k] =
            (stance_plate_numbers){.from = from[k], .height = height, .friction_factor = 1};
    }
    body->plates += 2;
    return true;
}

static bool take(const struct return_map *map, size_t count, const double (*z)[RETURN_MAP_MOST],
                 long before, struct return_point *point, stance_message *message)
{
    stance_case *const cases = calloc(count, sizeof *cases);
    stance_result *const results = malloc(count * sizeof *results);
    bool good = (cases && results) || refuse(message, "out of memory");
    for (size_t i = 0; good && i < count; i++) {
        cases[i] = map->base;
        cases[i].footfalls = map->steps;
        good = return_map_state(map, z[i], cases[i].position, cases[i].velocity) ||
               refuse(message, "both feet are not on the ground at once: no such posture is near");
        good = good && lay_behind(map, &cases[i], message);
    }
    if (good)
        map->kernel->run(cases, results, count);
    for (size_t i = 0; good && i < count; i++) {
        double from[2], end[2], speed[2];
        good = returned(map, &cases[i], &results[i], before, message);
        if (!good)
            break;
        const bool second = map->steps % 2;
        double posture[STANCE_MAX_COORDINATES];
        section_of(map, results[i].position, results[i].velocity, second, point[i].z, posture);
        point[i].behind = gap_of(map, posture);
        return_map_foot(map, results[i].position, results[i].velocity, second, end, speed);
        if (hypot(speed[0], speed[1]) > SLIDES) {
            good =
                refuse(message, "the foot that lands slides: no gait on feet that stick; give more "
                                "ground.friction");
            break;
        }
        return_map_foot(map, cases[i].position, cases[i].velocity, 0, from, speed);
        point[i].time = results[i].end_time;
        point[i].length = end[0] - from[0];
        point[i].result = results[i];
    }
    free(cases);
    free(results);
    return good;
}

bool return_map_take(const struct return_map *map, size_t count, const double (*z)[RETURN_MAP_MOST],
                     struct return_point *point, stance_message *message)
{
    return take(map, count, z, 0, point, message);
}

/* The foot of a leg that is on the ground; -1: none, or several. */
static int foot_of(const stance_scene *scene, uint32_t leg, const double *gap)
{
    int foot = -1, count = 0;
    for (int c = 0; c < scene->contacts; c++)
        if (scene->grip[c] >= 0 && leg >> c & 1 && fabs(gap[c]) < NEAR)
            foot = c, count++;
    return count == 1 ? foot : -1;
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
    if (!c->scene->exchange.any)
        return refuse(message, "no two legs of the robot are alike in structure");
    if (strcmp(method, "capturing") != 0 && strcmp(method, "event-driven") != 0) {
        snprintf(message->text, sizeof message->text,
                 "%s puts footfalls at the end of a step; give method.name capturing or "
                 "event-driven",
                 method);
        return false;
    }
    if (c->noise != 0 || c->angle_noise != 0 || c->rate_noise != 0)
        return refuse(message, "a gait with noise has no cycle: set controller.noise, angle_noise "
                               "and rate_noise to 0");
    if (c->delay > 0 || c->lag > 0 || (c->torque_rate > 0 && isfinite(c->torque_rate)))
        return refuse(message, "controller.delay, lag and torque_rate remember the step before, "
                               "which the section does not");
    if (c->restitution > 0)
        return refuse(message, "a foot that rebounds is not on the ground after its footfall: set "
                               "ground.restitution to 0");
    for (int k = 0; k < c->body.plates; k++)
        if (c->body.plate[k].footfall == 0 && c->body.plate[k].height != 0)
            return refuse(message, "on uneven ground no step is as the one before: leave out "
                                   "ground.plates, but for one with footfall: 1 and height: 0 that "
                                   "--sensitivity varies");
    if (timed(c))
        return refuse(message,
                      "a gait has no time of its own: pushes, ramps and integrals of a run "
                      "begin once, not at each footfall");
    return steps % 2 == 0 || alike(c->scene, c) ||
           refuse(message, "the legs, or what drives them, differ: a gait repeats after an even "
                           "number of steps; give --steps 2");
}

bool return_map_settle(const struct return_map *map, const double *z, size_t first, size_t count,
                       double *time)
{
    struct return_map one = *map;
    struct return_point next;
    stance_message ignored;
    double from[1][RETURN_MAP_MOST];
    one.steps = alike(map->scene, &map->base) ? 1 : map->steps;
    memcpy(from[0], z, sizeof from[0]);
    for (size_t k = 0, made = 0; k < count; made += (size_t)one.steps) {
        if (!take(&one, 1, (const double(*)[RETURN_MAP_MOST])from, 0, &next, &ignored))
            return false;
        memcpy(from[0], next.z, sizeof from[0]);
        if (made >= first)
            time[k++] = next.time / one.steps;
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
                      int steps, int settle, double *z, stance_message *message)
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
        if (!returned(map, &first, &r, 0, message))
            return false;
        again = steps % 2 == 0 && first.footfalls == 1 && lands_second(scene, c, &r);
    }
    scene->gaps(scene, c->robot, r.position, gap);
    for (int leg = 0; leg < 2; leg++) {
        map->foot[leg] = foot_of(scene, scene->exchange.leg[leg], gap);
        if (map->foot[leg] < 0)
            return refuse(message,
                          "at a footfall one contact of each leg, no more, has to be on the "
                          "ground, which is the same plane in each step of a gait");
    }
    const bool second = lands_second(scene, c, &r);
    map->n = 2 * scene->postures - 1;
    section_of(map, r.position, r.velocity, second, z, map->posture);
    for (int j = 0; j < scene->postures; j++) {
        const double slope = fabs(slope_of(map, map->posture, scene->posture[j]));
        if (slope > largest)
            largest = slope, map->follows = j;
    }
    section_of(map, r.position, r.velocity, second, z, NULL);
    if (!(largest > 1e-6))
        return refuse(message, "no angle lifts a foot");
    for (int made = 1; made < settle; made += steps) {
        struct return_point next;
        double from[1][RETURN_MAP_MOST];
        memcpy(from[0], z, sizeof from[0]);
        if (!take(map, 1, (const double(*)[RETURN_MAP_MOST])from, made, &next, message))
            return false;
        memcpy(z, next.z, sizeof next.z);
    }
    return true;
}
