/* balance.c - the library: from how far a tilt does a linear regulator recover a robot on one foot?
 *
 *   cc balance.c $(pkg-config --cflags --libs stance) -o balance && ./balance
 *
 * The equilibrium of the paper's example, gains by the linear quadratic regulator, then 19 starts
 * in one call: as `stance run` would compute them, to the bit.
 */
#include <engine/control/design.h>
#include <engine/stance.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STATES = 6, TORQUES = 2, CASES = 19 };

int main(void)
{
    static stance_case cases[CASES];
    static stance_result results[CASES];
    const stance_scene *const biped = stance_scene_find("biped");
    const stance_kernel *const kernel =
        stance_kernel_find(biped, stance_method_find("capturing"), NULL);
    const stance_equilibrium_choice choice = {.supports = 1, .posture = {-0.41, NAN, 0.82}};
    double A[STATES * STATES], B[STATES * TORQUES], K[TORQUES * STATES];
    const stance_plant plant = {STATES, TORQUES, A, B};
    double states[STATES] = {1, 1, 1, 1, 1, 1}, torques[TORQUES] = {1, 1};
    stance_equilibrium rest;
    stance_message message = {""};

    stance_case c = {.friction = 0.8,
                     .contacts = 1, /* foot 1 may touch the ground */
                     .torque_limit = 10,
                     .step = 0.001,
                     .steps = 8000,
                     .sample_every = 1,
                     .tolerance = kernel->method->tolerance,
                     .settle = true,
                     .has_target = true,
                     .supports = 1,
                     .settle_angle = 0.05,
                     .settle_rate = 0.5,
                     .settle_hold = 0.5};
    stance_robot_fallback(biped, c.robot);
    stance_case_robot(biped, &c);
    stance_error error = biped->equilibrium(biped, c.robot, &choice, &rest, &message);
    if (error == STANCE_OK)
        error = biped->linearise(biped, c.robot, &rest, A, B);
    if (error == STANCE_OK)
        error = stance_lqr(&plant, 0, states, torques, K, &message);
    if (error != STANCE_OK) {
        fprintf(stderr, "%s %s\n", stance_error_text(error), message.text);
        return 1;
    }

    memcpy(c.position, rest.position, sizeof c.position);
    memcpy(c.near.feedforward, rest.torque, sizeof c.near.feedforward);
    for (int i = 0; i < biped->postures; i++)
        c.near.target[i] = rest.position[biped->posture[i]];
    for (int i = 0; i < TORQUES * STATES; i++)
        c.near.gain[i / STATES][i % STATES] = K[i];
    for (int k = 0; k < CASES; k++) {
        cases[k] = c;
        cases[k].position[2] += -0.12 + 0.01 * k; /* theta */
        biped->stand(biped, c.robot, c.supports, cases[k].position, cases[k].velocity);
    }
    kernel->run(cases, results, CASES);
    for (int k = 0; k < CASES; k++)
        printf("theta %+.2f rad: %-10s after %.3f s\n", -0.12 + 0.01 * k,
               stance_outcome_name[results[k].outcome], results[k].end_time);
    return 0;
}
