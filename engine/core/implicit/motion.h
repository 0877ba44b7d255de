/* motion.h - where a system is, what does not change during its case, and what a step reports. */
#ifndef STANCE_CORE_IMPLICIT_MOTION_H
#define STANCE_CORE_IMPLICIT_MOTION_H

#include "engine/core/contact/impact.h"
#include "engine/core/law/law.h"

#define STEP_CLOSED 1e-12     /* m: a contact this close counts as closed */
#define MOTION_ROUNDING 1e-12 /* m or rad, of what positions are mended to */

/* What does not change during a case. */
struct setting {
    scene_body body;
    lanes friction;
    lanes restitution[CONTACTS]; /* of each contact */
    lanes moreau, limited;       /* 1 or 0: whose restitution, see impact.h */
    lanes may_touch[CONTACTS];   /* 1 or 0 */
    lanes prefer;                /* of several contact solutions, see contact_problem */
    struct law law;
};

/* Where a system is; consists of lanes (choose_all). */
struct motion {
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    lanes gap[CONTACTS];
    lanes approach[CONTACTS]; /* normal velocity */
    /* Impulses of the step that led here, N s; zero where there was none and where a contact came
     * to the ground in it. */
    lanes impulse[CONTACTS][2];
    scene_trig trig;           /* at s */
    lanes t;                   /* s */
    lanes integral[ACTUATORS]; /* what the law has summed, see law.h */
    lanes energy, kinetic;     /* J, of this state; where steps of step.h are taken */
};

/* Lanes where contact c, of those that may touch, is closed. */
HOT mask motion_closed(const struct setting *set, const lanes *gap, int c)
{
    return mask_less(lanes_of(0), set->may_touch[c]) &
           mask_less_equal(gap[c], lanes_of(STEP_CLOSED));
}

static inline struct state state_of(const struct motion *m)
{
    return (struct state){m->t, m->s, m->w, m->integral};
}

/* Contacts that are closed in any of the lanes m: is there anything to solve? */
static inline contact_set step_touching(const struct setting *set, const lanes *gap, mask m)
{
    contact_set touching = 0;
    EACH_CONTACT (c, 0)
        if (mask_any(m & motion_closed(set, gap, c)))
            touching |= contact_with(c);
    return touching;
}

/* What a margin to a fall says. Beyond by rounding alone, as where a stop ends the same angle, is
 * not beyond. */
HOT mask motion_beyond(int cause, lanes margin)
{
    (void)cause;
    return SCENE_FALLS_BEYOND(cause) ? mask_less(margin, lanes_of(-MOTION_ROUNDING))
                                     : mask_less_equal(margin, lanes_of(0));
}
/* Lanes that have fallen by a cause, counted from 0. */
HOT mask motion_falls(const struct setting *set, const lanes *s, const scene_trig *trig, int cause)
{
    lanes rate;
    const lanes margin = scene_fall_margin(&set->body, s, trig, s, cause, &rate);
    return motion_beyond(cause, margin);
}
/* ... by whatever cause. */
HOT mask motion_fallen(const struct setting *set, const lanes *s, const scene_trig *trig)
{
    mask fallen = MASK_NONE;
    EACH (k, 0, SCENE_CAUSES)
        fallen |= motion_falls(set, s, trig, k);
    return fallen;
}

/* Lanes whose angles stay in the range of sine and cosine for two more steps of length h. */
static inline mask motion_in_range(const struct motion *now, lanes h)
{
    lanes ahead[SCENE_COORDINATES];
    for (int i = 0; i < SCENE_COORDINATES; i++)
        ahead[i] = now->s[i] + 2 * h * now->w[i];
    return scene_angles_in_range(ahead);
}

/* Work of all that acts but gravity, springs and contacts, about the time t, over a displacement d
 * in a time h with rates w. */
HOT lanes motion_work(const scene_body *body, lanes h, lanes t, const scene_trig *trig,
                      const lanes *torque, const lanes *w, const lanes *d)
{
    return scene_work(body, h, t, trig, torque, d) - scene_damped(body, w, d);
}

/* The operator D of contacts in `touching` with these responses to unit impulses. */
HOT void motion_operator(const scene_body *body, const scene_trig *trig, contact_set touching,
                         const lanes (*response)[2][SCENE_COORDINATES], lanes (*D)[CONTACTS][2][2])
{
    EACH_IN (c, touching) {
        scene_rows rows;
        scene_contact_rows(body, trig, c, NULL, lanes_of(0), &rows);
        EACH_IN (k, touching)
            EACH (b, 0, 2) {
                lanes u[2];
                if (b >= contact_unknowns(k))
                    continue;
                scene_rows_velocity(body, c, &rows, response[k][b], u);
                D[c][k][0][b] = u[0], D[c][k][1][b] = u[1];
            }
    }
}

/* Fills in the energies of a motion. */
static inline void motion_energy(const struct setting *set, struct motion *m)
{
    m->kinetic = scene_kinetic(&set->body, &m->trig, m->w);
    m->energy = m->kinetic + scene_potential(&set->body, m->s, &m->trig);
}

#endif
