/* motion.h - where a system is, what does not change during its case, and what a step reports. */
#ifndef STANCE_CORE_MOTION_H
#define STANCE_CORE_MOTION_H

#include "direct.h"
#include "law.h"

#define STEP_CLOSED 1e-12 /* m: a contact this close counts as closed */

/* What does not change during a case. */
struct setting {
    scene_body body;
    lanes friction, restitution;
    lanes may_touch[SCENE_CONTACTS]; /* 1 or 0 */
    lanes prefer;                    /* of several contact solutions, see contact_problem */
    struct law law;
};

/* Where a system is; consists of lanes (choose_all). */
struct motion {
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    lanes gap[SCENE_CONTACTS];
    lanes approach[SCENE_CONTACTS]; /* normal velocity */
    /* Impulses of the step that led here, N s; zero where there was none and where a contact came
     * to the ground in it. */
    lanes impulse[SCENE_CONTACTS][2];
    scene_trig trig;           /* at s */
    lanes t;                   /* s */
    lanes integral[ACTUATORS]; /* what the law has summed, see law.h */
    lanes energy, kinetic;     /* J, of this state; where steps of step.h are taken */
};

/* Contacts that are closed in any of the lanes m: is there anything to solve? */
static inline contact_set step_touching(const struct setting *set, const lanes *gap, mask m)
{
    contact_set touching = 0;
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (mask_any(m & mask_less(lanes_of(0), set->may_touch[c]) &
                     mask_less_equal(gap[c], lanes_of(STEP_CLOSED))))
            touching |= 1u << c;
    return touching;
}

/* Fills in the energies of a motion. */
static inline void motion_energy(const struct setting *set, struct motion *m)
{
    m->kinetic = scene_kinetic(&set->body, &m->trig, m->w);
    m->energy = m->kinetic + scene_potential(&set->body, m->s, &m->trig);
}

/* What a step did; consists of lanes (choose_all). */
struct step_report {
    lanes impulse[SCENE_CONTACTS][2]; /* N s */
    lanes slip[SCENE_CONTACTS];       /* m, where loaded */
    lanes torque[ACTUATORS];          /* N m, as applied at the end */
    lanes iterations, evaluations;
    lanes impact_energy, projection_energy; /* J */
    lanes work;                             /* J, of actuators and other outer forces */
    lanes signorini, coulomb, dissipation;  /* residuals of the contact laws, see stance_result */
    lanes friction;                         /* largest |rT| / rN */
    lanes least[SCENE_CONTACTS];            /* smallest normal force, N */
    lanes ambiguous, subdivided;            /* 0 or 1 */
    lanes landed;                           /* 1: a contact came to the ground */
    lanes events;
    lanes degraded; /* 1: the law acting inside the step was degraded, see decoupling.h */
    lanes failure;  /* stance_failure, or 0: the state tells */
};

/* Residuals of the contact laws at a contact with force (or impulse) r and velocity u, the normal
 * one relative to what restitution asks for. */
HOT void report_residuals(struct step_report *report, mask part, lanes friction, const lanes r[2],
                          const lanes u[2])
{
    const lanes none = lanes_of(0), bound = friction * r[0], along = lanes_abs(u[1]);
    const mask loaded = part & mask_less(none, r[0]);
    const lanes normal = choose(loaded, lanes_abs(u[0]), lanes_max(-u[0], none));
    report->signorini = lanes_max(choose(part, normal, none), report->signorini);
    const lanes beyond = lanes_abs(r[1]) / choose(loaded, r[0], lanes_of(1)) - friction;
    report->coulomb = choose(loaded, lanes_max(beyond, report->coulomb), report->coulomb);
    const mask opposed =
        mask_less_equal((1 - 1e-9) * bound, lanes_abs(r[1])) & mask_less_equal(r[1] * u[1], none);
    report->dissipation = choose(loaded & LANES_NOT(opposed), lanes_max(along, report->dissipation),
                                 report->dissipation);
}

/* A report of nothing, to add others to. */
static inline void report_clear(struct step_report *report)
{
    memset(report, 0, sizeof *report);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        report->least[c] = lanes_of(INFINITY);
}
/* The same in one lane. */
static inline void report_clear_lane(struct step_report *report, int lane)
{
    lanes *const all = (lanes *)report;
    for (size_t i = 0; i < sizeof *report / sizeof(lanes); i++)
        lane_set(&all[i], lane, 0);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        lane_set(&report->least[c], lane, INFINITY);
}
/* Forces of the contacts in `part`, N. */
static inline void report_forces(struct step_report *report, const mask *part,
                                 const lanes force[SCENE_CONTACTS][2])
{
    const lanes none = lanes_of(0);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask loaded = part[c] & mask_less(none, force[c][0]);
        const lanes ratio = lanes_abs(force[c][1]) / choose(loaded, force[c][0], lanes_of(1));
        report->friction = choose(loaded, lanes_max(ratio, report->friction), report->friction);
        report->least[c] = lanes_min(choose(loaded, force[c][0], none), report->least[c]);
    }
}

/* Adds a part of a step to the whole. */
static inline void report_add(struct step_report *sum, const struct step_report *part)
{
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        sum->slip[c] += part->slip[c];
        for (int a = 0; a < 2; a++)
            sum->impulse[c][a] += part->impulse[c][a];
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        sum->torque[i] = part->torque[i];
    sum->iterations += part->iterations;
    sum->evaluations += part->evaluations;
    sum->landed = lanes_max(part->landed, sum->landed);
    sum->events += part->events;
    sum->work += part->work;
    sum->impact_energy = lanes_max(part->impact_energy, sum->impact_energy);
    sum->projection_energy += part->projection_energy;
    sum->signorini = lanes_max(part->signorini, sum->signorini);
    sum->coulomb = lanes_max(part->coulomb, sum->coulomb);
    sum->dissipation = lanes_max(part->dissipation, sum->dissipation);
    sum->friction = lanes_max(part->friction, sum->friction);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        sum->least[c] = lanes_min(part->least[c], sum->least[c]);
    sum->ambiguous = lanes_max(part->ambiguous, sum->ambiguous);
    sum->subdivided = lanes_max(part->subdivided, sum->subdivided);
    sum->degraded = lanes_max(part->degraded, sum->degraded);
    sum->failure = part->failure;
}

#endif
