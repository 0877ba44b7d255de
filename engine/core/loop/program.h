/* program.h - what a program (stance_program) is told at a sample.
 */
#ifndef STANCE_CORE_LOOP_PROGRAM_H
#define STANCE_CORE_LOOP_PROGRAM_H

#include "bundle.h"

/* Of all lanes: the scene's coordinates and their rates. Angles are the posture that a linear law
 * acts on, to the bit where the ground is level. near: the program does not act, as the linear law
 * of a case that switches does. */
struct program_measured {
    lanes q[SCENE_COORDINATES], v[SCENE_COORDINATES];
    mask near;
};

static inline void program_measure(const struct setting *set, bool switches, const lanes *s,
                                   const lanes *w, const scene_trig *trig,
                                   struct program_measured *is)
{
    lanes posture[POSTURES], rate[POSTURES];
    scene_coordinates(&set->body, trig, s, w, is->q, is->v);
    is->near = MASK_NONE;
    if (!switches)
        return;
    scene_posture(s, posture);
    scene_posture(w, rate);
    is->near = mask_less(lanes_of(0), set->law.switches) & law_near(&set->law, posture, rate);
}

/* sample[STANCE_SAMPLE_HEAD] of a lane ... */
static inline void program_known(const struct bundle *b, int lane, double *sample)
{
    const double t = lane_get(&b->n, lane) * lane_get(&b->h, lane);
    sample[STANCE_SAMPLE_TIME] = t;
    sample[STANCE_SAMPLE_PERIOD] = lane_get(&b->sample_every, lane) * lane_get(&b->h, lane);
    sample[STANCE_SAMPLE_SINCE] = t - lane_get(&b->set.law.footfall, lane);
    sample[STANCE_SAMPLE_FOOTFALLS] = lane_get(&b->answer.footfalls, lane);
    sample[STANCE_SAMPLE_FOOT] = lane_get(&b->stands, lane);
}

/* The first contact that a robot is to stand on; -1: there is none. */
static inline double program_first_foot(const struct bundle *b, int lane)
{
    for (int c = 0; c < OWN_CONTACTS; c++)
        if (lane_get(&b->mine[c], lane) > 0)
            return c;
    return -1;
}

/* ... and what follows behind: coordinates, rates, contacts. */
static inline void program_sample(const struct program_measured *is, const mask *closed, int lane,
                                  double *sample)
{
    double *at = sample + STANCE_SAMPLE_HEAD;
    for (int i = 0; i < OWN_COORDINATES; i++) {
        at[i] = lane_get(&is->q[i], lane);
        at[OWN_COORDINATES + i] = lane_get(&is->v[i], lane);
    }
    at += 2 * OWN_COORDINATES;
    for (int c = 0; c < OWN_CONTACTS; c++)
        at[c] = mask_get(closed[c], lane);
}

#endif
