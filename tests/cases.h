/* cases.h - cases that tests step, and a hash of what comes out. The engine alone is needed. */
#ifndef STANCE_TESTS_CASES_H
#define STANCE_TESTS_CASES_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "engine/mechanism.h"
#include "engine/stance.h"
#include "run_cases.h"

/* A scene of a test's own, which goes when its block ends. */
#define SCENE FREED(scene_gone) stance_scene
static inline void scene_gone(stance_scene *const *scene)
{
    stance_scene_free(*scene);
}

/* Uniform in [low, high) from splitmix64: the same everywhere. */
static inline double uniform(uint64_t *state, double low, double high)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return low + (high - low) * (double)(z >> 11) * 0x1p-53;
}

static inline const stance_scene *biped(void)
{
    return stance_scene_find("biped");
}

/* A case of the default robot without controller, 1 ms, one second, both feet, friction 0.8. */
static inline stance_case plain_case(void)
{
    stance_case c;
    memset(&c, 0, sizeof c);
    stance_robot_fallback(biped(), c.robot);
    c.scene = biped();
    c.friction = 0.8;
    c.contacts = 3;
    c.torque_limit = INFINITY;
    c.step = 1e-3;
    c.steps = 1000;
    c.settle_angle = 0.05, c.settle_rate = 0.5, c.settle_hold = 0.5;
    return c;
}

/* The gains K[2][6] of the biped as a case holds them, and back. */
static inline void put_gain(stance_case *c, const double *K)
{
    for (int i = 0; i < 12; i++)
        c->near.gain[i / 6][i % 6] = K[i];
}
static inline void get_gain(const stance_case *c, double *K)
{
    for (int i = 0; i < 12; i++)
        K[i] = c->near.gain[i / 6][i % 6];
}

/* The legs' servo: holds the joint angles that the case starts with. */
static inline void hold_legs(stance_case *c, double kp, double kd)
{
    for (int i = 0; i < 2; i++) {
        c->near.gain[i][1 + i] = kp;
        c->near.gain[i][4 + i] = kd;
        c->near.target[1 + i] = c->position[3 + i];
    }
}

static inline uint64_t hash(const void *data, size_t size, uint64_t h)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * 0x100000001b3u;
    return h;
}

/* Random states, launches, frictions (0 ... 2), servos, limits: half start with the lower foot on
 * the ground, half up to 0.2 m above it. */
static inline void random_case(uint64_t *seed, int i, double h, stance_case *c)
{
    *c = plain_case();
    c->friction = uniform(seed, 0, 2);
    for (int k = 2; k < 5; k++) {
        c->position[k] = uniform(seed, -M_PI, M_PI);
        c->velocity[k] = i % 3 == 0 ? uniform(seed, -20, 20) : uniform(seed, -5, 5);
    }
    for (int k = 0; k < 2; k++)
        c->velocity[k] = uniform(seed, -3, 3);
    double gap[2];
    biped()->gaps(biped(), c->robot, c->position, gap);
    c->position[1] += 1e-13 - fmin(gap[0], gap[1]) + (i % 2 ? 0 : uniform(seed, 0, 0.2));
    const double stiffness = uniform(seed, 0, 200);
    hold_legs(c, stiffness, stiffness / 20);
    c->torque_limit = i % 5 ? 50 : INFINITY;
    c->sample_every = i % 4 ? 1 : 0;
    c->step = h;
    c->steps = (int64_t)lround(0.25 / h);
    c->robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
}

/* The golden cases: given gains, given states, noise, both feet, restitution; no
 * number in them comes from libm or LAPACK. */
static inline void golden_case(uint64_t *seed, int i, stance_case *c)
{
    static const double gain[] = {318.97,  308.17,  -43.08, 83.55,  71.79,  -7.38,
                                  -277.81, -257.34, 35.56,  -73.42, -61.87, 6.96};
    random_case(seed, i, i % 7 ? 1e-3 : 1e-2, c);
    c->seed = 42, c->grid_index = (uint64_t)i;
    if (i % 3 == 0) {
        put_gain(c, gain);
        c->near.target[0] = -0.41, c->near.target[1] = 0.570127, c->near.target[2] = 0.82;
        c->near.feedforward[0] = -7.53135, c->near.feedforward[1] = 3.76567;
        c->position[2] = uniform(seed, -0.5, -0.36);
        c->position[3] = 0.570127, c->position[4] = 0.82;
        c->velocity[2] = c->velocity[3] = c->velocity[4] = 0;
        biped()->stand(biped(), c->robot, 1, c->position, c->velocity);
        c->has_target = c->settle = true;
        c->supports = 1;
        c->contacts = i % 2 ? 1 : 3;
        c->torque_limit = 10, c->noise = 0.1;
        c->sample_every = 1 + i % 4;
        c->steps = 3000;
        c->robot[STANCE_ROBOT_FALL_HEIGHT] = 0.2;
    }
    c->restitution = i % 5 == 4 ? 0.5 : 0;
    c->tolerance = 1e-8;
}

/* Random states of a scene without actuators, near the ground. */
static inline void scene_case(const stance_scene *scene, uint64_t *seed, stance_case *c)
{
    double gap[STANCE_MAX_CONTACTS], least = INFINITY;
    *c = plain_case();
    stance_robot_fallback(scene, c->robot);
    c->scene = scene;
    c->contacts = (1u << scene->contacts) - 1;
    for (int i = 0; i < scene->coordinates; i++) {
        c->position[i] = uniform(seed, -1, 1);
        c->velocity[i] = uniform(seed, -3, 3);
    }
    scene->gaps(scene, c->robot, c->position, gap);
    for (int k = 0; k < scene->contacts; k++)
        least = fmin(least, gap[k]);
    c->position[1] += uniform(seed, 1e-13, 0.2) - least;
    c->friction = uniform(seed, 0, 2);
    c->restitution = uniform(seed, 0, 0.5);
    c->steps = 250;
    c->robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
    c->tolerance = 1e-8;
}

/* Hash of a result's numbers by name: answers that are new have no part in it. */
static inline uint64_t hash_result(const stance_result *r, int coordinates, uint64_t h)
{
    const double numbers[] = {
        r->status,
        r->outcome,
        r->evidence,
        r->failure,
        r->end_time,
        r->settle_time,
        r->fall_time,
        (double)r->steps,
        (double)r->iterations,
        (double)r->events,
        (double)r->evaluations,
        (double)r->ambiguous_steps,
        (double)r->subdivided_steps,
        (double)r->degraded_samples,
        r->least_normal_force,
        r->max_penetration,
        r->slip_distance,
        r->peak_torque,
        r->friction_used,
        r->impact_energy,
        r->projection_energy,
        r->energy_gain,
        r->signorini_residual,
        r->coulomb_residual,
        r->dissipation_residual,
    };
    h = hash(numbers, sizeof numbers, h);
    h = hash(r->position, (size_t)coordinates * sizeof *r->position, h);
    return hash(r->velocity, (size_t)coordinates * sizeof *r->velocity, h);
}

/* Hash of the results of the first n golden cases of the biped, or, for another scene, of random
 * ones: given to the kernel in slices, in order or from the last to the first. 0: no memory. */
static inline uint64_t golden_hash(const stance_kernel *kernel, const stance_scene *scene, size_t n,
                                   bool backwards, size_t slice)
{
    stance_case *const cases = calloc(n, sizeof *cases);
    stance_result *const results = calloc(n, sizeof *results);
    uint64_t seed = 99, h = 0;
    if (cases && results) {
        for (size_t i = 0; i < n; i++) {
            stance_case *const c = &cases[backwards ? n - 1 - i : i];
            if (scene == biped())
                golden_case(&seed, (int)i, c);
            else
                scene_case(scene, &seed, c);
        }
        for (size_t i = 0; i < n; i += slice)
            run_cases(kernel, cases + i, results + i, i + slice <= n ? slice : n - i);
        h = 0xcbf29ce484222325u;
        for (size_t i = 0; i < n; i++)
            h = hash_result(&results[backwards ? n - 1 - i : i], scene->coordinates, h);
    }
    free(cases);
    free(results);
    return h;
}

/* Koch's snowflake, from its triangle inwards: is the point on the island's side of the curve over
 * the edge from (0, 0) to (1, 0)? The bumps point to negative y. */
static inline bool below_koch(double x, double y, int depth)
{
    const double high = sqrt(3) / 6; /* of the first bump */
    if (y >= 0)
        return true;
    if (depth == 0 || y < -high)
        return false;
    if (x < 1 / 3.0)
        return x >= 0 && below_koch(3 * x, 3 * y, depth - 1);
    if (x > 2 / 3.0)
        return x <= 1 && below_koch(3 * (1 - x), 3 * y, depth - 1);
    /* The sides of the bump, mirrored onto one: turned by 60 degrees and stretched threefold. */
    const double u = 3 * ((x < 0.5 ? x : 1 - x) - 1 / 3.0), v = 3 * y;
    return below_koch(0.5 * u - 0.5 * sqrt(3) * v, 0.5 * sqrt(3) * u + 0.5 * v, depth - 1);
}

#endif
