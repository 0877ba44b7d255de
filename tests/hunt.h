/* hunt.h - cases that look for numbers that depend on the neighbours: robots of ordinary and of
 * extreme proportions, for a few steps each, standing, landing or flying. */
#ifndef STANCE_TESTS_HUNT_H
#define STANCE_TESTS_HUNT_H

#include "cases.h"

/* Uniform in the logarithm. */
static inline double spread(uint64_t *seed, double low, double high)
{
    return low * pow(high / low, uniform(seed, 0, 1));
}

/* A servo, held or acting inside the step, its strength in units of the robot's own weight. */
static inline void hunt_law(uint64_t *seed, bool extreme, double moment, double time,
                            stance_case *c)
{
    const double kind = uniform(seed, 0, 1);
    c->sample_every = kind < 0.8 ? 1 + (int64_t)uniform(seed, 0, 3) : 0;
    if (kind < 0.4)
        return;
    const double kp = moment * (extreme ? spread(seed, 1e-2, 1e5) : spread(seed, 0.1, 100));
    hold_legs(c, kp, kp * time * spread(seed, 1e-3, 1));
    for (int i = 1; i < 3; i++)
        c->near.target[i] += uniform(seed, -0.1, 0.1) * (kind < 0.6);
    if (kind > 0.7)
        c->torque_limit = moment * spread(seed, 1e-2, 1e2);
    if (kind > 0.9 && c->sample_every > 0)
        c->noise = 0.01 * moment;
    if (c->sample_every > 0 && uniform(seed, 0, 1) < 0.3) { /* actuators and sensors */
        c->delay = (int64_t)uniform(seed, 0, 4);
        c->lag = uniform(seed, 0, 1) < 0.5 ? 0 : time * spread(seed, 1e-3, 1);
        c->torque_rate = uniform(seed, 0, 1) < 0.5 ? 0 : moment / time * spread(seed, 1e-2, 1e2);
        c->angle_noise = uniform(seed, 0, 1) < 0.5 ? 0 : spread(seed, 1e-6, 1e-2);
    }
}

/* A robot near the ground: on one foot, on both (`kind` of state), or above. */
static inline void hunt_biped(uint64_t *seed, bool extreme, stance_case *c)
{
    const stance_scene *const scene = stance_scene_find("biped");
    for (int i = 0; i < 5; i++)
        if (extreme)
            c->robot[i] = spread(seed, 1e-3, 1e3);
        else
            c->robot[i] *= uniform(seed, 0, 1) < 0.5 ? 1 : spread(seed, 0.3, 3);
    const double length = fmax(c->robot[0], extreme ? 1e-3 * c->robot[1] : c->robot[1]);
    const double time = sqrt(length / STANCE_GRAVITY);
    const double kind = uniform(seed, 0, 1);
    for (int i = 2; i < 5; i++)
        c->position[i] = kind < 0.7 ? uniform(seed, -1, 1) : uniform(seed, -M_PI, M_PI);
    if (uniform(seed, 0, 1) < 0.3) { /* both feet at one height, by turns the legs parallel */
        const double spread_legs = uniform(seed, 0, 1) < 0.2 ? 0 : uniform(seed, -1, 1);
        c->position[3] = -c->position[2] + spread_legs;
        c->position[4] = -c->position[2] - spread_legs;
        if (uniform(seed, 0, 1) < 0.7) /* or nearly so: the other foot comes to the ground soon */
            c->position[4] += (uniform(seed, 0, 1) < 0.5 ? -1 : 1) * spread(seed, 1e-15, 1e-5);
    }
    if (kind > 0.3)
        for (int i = 0; i < 5; i++)
            c->velocity[i] = (uniform(seed, 0, 1) < 0.5 ? -1 : 1) *
                             spread(seed, extreme ? 1e-6 : 1e-3, extreme ? 30 : 3) *
                             (i < 2 ? length / time : 1 / time);
    double gap[2];
    scene->gaps(scene, c->robot, c->position, gap);
    c->position[1] -= fmin(gap[0], gap[1]);
    if (kind < 0.5)
        scene->stand(scene, c->robot, 1u << (gap[0] < gap[1] ? 0 : 1), c->position, c->velocity);
    else
        c->position[1] += length * (kind < 0.6 ? 0 : spread(seed, 1e-6, 1e-1));
    scene->gaps(scene, c->robot, c->position, gap);
    c->position[1] -= fmin(fmin(gap[0], gap[1]), 0);
    c->step = extreme ? time * spread(seed, 1e-5, 0.3) : spread(seed, 1e-4, 2e-2);
    hunt_law(seed, extreme, length * STANCE_GRAVITY * (2 * c->robot[2] + c->robot[3] + c->robot[4]),
             time, c);
}

static inline void hunt_case(const stance_scene *scene, uint64_t *seed, bool extreme,
                             stance_case *c)
{
    if (strcmp(scene->name, "biped") == 0) {
        *c = plain_case();
        hunt_biped(seed, extreme, c);
    } else {
        scene_case(scene, seed, c);
        c->step = spread(seed, 1e-5, extreme ? 0.1 : 1e-2);
    }
    const double rough = uniform(seed, 0, 1);
    c->friction = rough < 0.15 ? 0 : extreme ? spread(seed, 1e-3, 10) : uniform(seed, 0, 2);
    c->restitution = uniform(seed, 0, 1) < 0.6 ? 0 : uniform(seed, 0, 1);
    c->contacts = (1u << scene->contacts) - 1;
    if (uniform(seed, 0, 1) < 0.2)
        c->contacts = 1;
    c->steps = 2 + (int64_t)uniform(seed, 0, 12);
    c->robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
    c->tolerance = spread(seed, 1e-8, 1e-3);
    c->seed = 3, c->grid_index = *seed;
}

#endif
