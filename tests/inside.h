/* inside.h - for tests that include a method's kernel, one lane wide, and call its own functions.
 */
#ifndef STANCE_TESTS_INSIDE_H
#define STANCE_TESTS_INSIDE_H

#include "support.h"

/* A biped that stands on the contacts in `on` - none, the first foot, or both - at random, in a
 * bundle of its own. */
static void random_motion(uint64_t *seed, uint32_t on, double least_friction, double most_friction,
                          double h, struct bundle *b)
{
    stance_case c = {.step = h, .steps = 1, .torque_limit = 10};
    const stance_scene *const scene = stance_scene_find("biped");
    static const stance_feed feed;
    static stance_case kept;
    static stance_result result;
    stance_robot_fallback(scene, c.robot);
    for (int k = 0; k < scene->robot_count; k++)
        c.robot[k] = scene->robot[k].fallback * uniform(seed, 0.7, 1.4);
    c.contacts = on;
    c.friction = uniform(seed, least_friction, most_friction);
    c.tolerance = 1e-8;
    c.position[1] = 2;
    c.position[2] = uniform(seed, -0.6, 0.6);
    c.position[3] = uniform(seed, 0.2, 0.8), c.position[4] = uniform(seed, -0.8, -0.2);
    for (int k = 2; k < 5; k++)
        c.velocity[k] = uniform(seed, -2, 2);
    if (c.contacts)
        scene->stand(scene, c.robot, 1, c.position, c.velocity);
    memset(b, 0, sizeof *b);
    b->feed = &feed;
    stance_case_robot(scene, &c);
    kept = c;
    bundle_load(b, 0, &kept, &result);
    bundle_begin(b, true);
}

#endif
