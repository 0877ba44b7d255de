/* peer.h - another simulator computes our cases: the talk with the program that drives it.
 *
 * An adapter is a program beside the tests (tests/peer.h has what adapters share). It is started
 * without arguments, reads one request from standard input and answers on standard output, in lines
 * of words and numbers. The request, in any order, `end` last:
 *
 *   stance-peer 1                          version of this talk
 *   scene NAME, robot N x..., gravity G, friction MU, restitution E
 *   contacts B B ...                       1: this contact may touch the ground
 *   feedforward u..., gain K..., target p..., limit u..., sample T
 *       torque = feedforward - gain (posture - target, rates), within +-limit, held for T seconds;
 *       T = 0: it acts all the time
 *   time T, every D                        length of a case; instants are D apart
 *   labels B                               1: outcomes are asked for; 0: states at the instants
 *   settle ANGLE RATE HOLD, place P, fall_height H, supports B B ...    the outcome rule
 *   budget S, effort S                     repeat a setting for so long; leave out what takes
 * longer checks N (position velocity)...        states in flight cases N (position velocity)...
 * where the cases start end
 *
 * The answer:
 *
 *   peer NAME
 *   cannot WHY                             then `end`: it has no model of this
 *   setting STEP USUAL NAME                for each integrator, solver and step; USUAL 1: its
 * defaults acceleration I a...                    at check I, under the law's torques: all of them,
 * first state I K position velocity            of case I at instant K, from 0 on case I OUTCOME
 * TIME                    how it ended, and when; `done` where states are asked for, `failed` time
 * MEDIAN LOW HIGH N                 microseconds of the processor per simulated second end
 *
 * What is said is not believed: accelerations are compared with ours, and every case must be there.
 */
#ifndef STANCE_BENCH_PEER_H
#define STANCE_BENCH_PEER_H

#include "measure.h"

struct peer_task {
    const stance_scene *scene;
    const stance_case *cases; /* [count] that differ in their states alone */
    size_t count;
    double time, every; /* s */
    bool labels;
    double budget, effort; /* s */
    double patience;       /* s without a word after which it is given up */
};

enum { PEER_NAME = 64, PEER_REASON = 160, PEER_CHECKS = 64 };

/* One setting's answers. */
struct peer_setting {
    char name[PEER_NAME];
    bool usual;
    double step;   /* s */
    double off;    /* largest difference of accelerations, of the largest of each state */
    uint8_t *kind; /* [count] as of a results file */
    size_t *rows;  /* [count] instants told */
    double *state; /* [count][instants][2 coordinates]; NULL where labels are asked for */
    struct measure_cost cost;
};

struct peer_answer {
    char name[PEER_NAME], cannot[PEER_REASON]; /* "": it can */
    size_t instants, settings;
    struct peer_setting *setting;
};

/* Runs `program`. False: one line in *message; it is no longer running. */
bool peer_ask(const char *program, const struct peer_task *task, struct peer_answer *answer,
              stance_message *message);
void peer_answer_free(struct peer_answer *answer);

#endif
