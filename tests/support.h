/* support.h - what several tests share beside cases.h: controllers, trajectories, JSON references.
 */
#ifndef STANCE_TESTS_SUPPORT_H
#define STANCE_TESTS_SUPPORT_H

#include <jansson.h>

#include "cases.h"
#include "tests.h"

#include "engine/control/design.h"

/* Arguments of control design, as they come. */
#define PLANT(...)                                                                                 \
    &(stance_plant)                                                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define POLES(...)                                                                                 \
    &(stance_poles)                                                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define SAMPLING(...)                                                                              \
    &(stance_sampling)                                                                             \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

static inline const stance_kernel *kernel_of(const char *method, const char *isa)
{
    return stance_kernel_find(biped(), stance_method_find(method), isa);
}

/* A case of any scene with its default body and all contacts, friction 0.5, that does not fall. */
static inline stance_case case_of_scene(const char *name, double step, double time)
{
    const stance_scene *const scene = stance_scene_find(name);
    stance_case c = plain_case();
    c.scene = scene;
    stance_robot_fallback(scene, c.robot);
    c.contacts = (1u << scene->contacts) - 1;
    c.friction = 0.5;
    c.step = step;
    c.steps = (int64_t)lround(time / step);
    c.tolerance = 1e-9;
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
    return c;
}

/* A servo of one coordinate that acts on, without limits of its own. */
static inline stance_servo servo_of(int coordinate, double setpoint, double ramp, double kp,
                                    double kd)
{
    return (stance_servo){.coordinate = coordinate,
                          .setpoint = setpoint,
                          .ramp = ramp,
                          .duration = INFINITY,
                          .kp = kp,
                          .kd = kd,
                          .integral_limit = INFINITY};
}

/* Of a case of any scene: the biped's where it names none. */
static inline stance_result run_one(const char *method, const stance_case *c)
{
    stance_result r;
    run_cases(stance_kernel_find(c->scene ? c->scene : biped(), stance_method_find(method), NULL),
              c, &r, 1);
    return r;
}

/* The same of one that must come to its end. */
static inline stance_result run_done(const char *method, const stance_case *c)
{
    const stance_result r = run_one(method, c);
    if (r.status != STANCE_DONE)
        fail_msg("%s: %s after %g s", method, stance_failure_text[r.failure], r.end_time);
    return r;
}

/* The second drop of tests/reference/drop.json, of 1.2 s. */
static inline stance_case second_drop(double h)
{
    static const double robot[5] = {0.5, 0.5, 1, 1, 3}, q[5] = {0, 1.5, -0.5, 0.9, -1};
    stance_case c = plain_case();
    memcpy(c.robot, robot, sizeof robot);
    memcpy(c.position, q, sizeof q);
    c.velocity[0] = 1;
    c.friction = 0.3;
    hold_legs(&c, 200, 20);
    c.step = h;
    c.steps = (int64_t)lround(1.2 / h);
    return c;
}

/* The equilibrium on foot 1 with these angles of trunk and free leg. */
static inline stance_equilibrium equilibrium_on_foot(const double *robot, double theta, double q2)
{
    const stance_equilibrium_choice choice = {1, {theta, NAN, q2}, 0};
    stance_equilibrium equilibrium;
    stance_message message;
    if (biped()->equilibrium(biped(), robot, &choice, &equilibrium, &message) != STANCE_OK)
        fail_msg("%s", message.text);
    return equilibrium;
}

/* That which a case's controller is for. */
static inline stance_equilibrium equilibrium_at(const stance_case *c)
{
    return equilibrium_on_foot(c->robot, c->near.target[0], c->near.target[2]);
}

/* Puts a case's robot on foot 1 as its only contact, tilted by `off` from that equilibrium, which
 * robust gains are to hold with poles `speed` times as fast as section 3.2's. */
static inline void put_in_balance(stance_case *c, double theta, double q2, double speed, double off)
{
    double re[6] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6}, im[6] = {0}, A[36], B[12], K[12];
    const stance_equilibrium equilibrium = equilibrium_on_foot(c->robot, theta, q2);
    stance_message message;
    for (int i = 0; i < 6; i++)
        re[i] *= speed;
    if (biped()->linearise(biped(), c->robot, &equilibrium, A, B) != STANCE_OK ||
        stance_place(STANCE_ROBUST, PLANT(6, 2, A, B), 0, POLES(re, im), K, NULL, &message) !=
            STANCE_OK)
        fail_msg("no balance controller");
    put_gain(c, K);
    memcpy(c->position, equilibrium.position, sizeof c->position);
    memcpy(c->near.feedforward, equilibrium.torque, sizeof c->near.feedforward);
    memcpy(c->near.target, equilibrium.position + 2, sizeof(double[3]));
    c->position[2] += off;
    biped()->stand(biped(), c->robot, 1, c->position, c->velocity);
    c->contacts = c->supports = 1;
    c->has_target = true;
}

/* Section 3.2's balance: robust gains, torques limited to 10 N m and held for 1 ms; tilted about
 * the foot by `theta`, turning at `vtheta`. */
static inline stance_case balance_case(double theta, double vtheta)
{
    stance_case c = plain_case();
    c.velocity[2] = vtheta;
    put_in_balance(&c, -0.41, 0.82, 1, theta);
    c.torque_limit = 10;
    c.sample_every = 1;
    c.steps = 8000;
    c.settle = true;
    return c;
}

/* A trajectory of `rows` rows, its buffers in one piece. */
static inline stance_trajectory trajectory_new(int64_t rows, double interval)
{
    const size_t n = (size_t)rows;
    double *const x = room(18 * n * sizeof *x);
    return (stance_trajectory){interval, rows, x, x + 5 * n, x + 10 * n, x + 12 * n, x + 16 * n};
}
static inline void trajectory_free(stance_trajectory *t)
{
    free(t->position);
}

/* A trajectory, and a JSON tree, that go when their block ends. */
#define TRAJECTORY FREED(trajectory_free) stance_trajectory
#define JSON FREED(json_gone) json_t
static inline void json_gone(json_t *const *tree)
{
    json_decref(*tree);
}

static inline double number_in(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}
static inline void numbers(const json_t *array, double *out, int n)
{
    for (int i = 0; i < n; i++)
        out[i] = json_number_value(json_array_get(array, (size_t)i));
}

static inline json_t *reference_load(const char *path)
{
    json_error_t error;
    json_t *root = json_load_file(path, 0, &error);
    if (!root)
        fail_msg("%s:%d: %s", path, error.line, error.text);
    return root;
}

#endif
