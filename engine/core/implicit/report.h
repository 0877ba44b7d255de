/* report.h - what a step tells of itself: its share of the answers, and what comes with it. */
#ifndef STANCE_CORE_IMPLICIT_REPORT_H
#define STANCE_CORE_IMPLICIT_REPORT_H

#include "motion.h"

/* By which steps an answer is told (STANCE_ANSWERS in stance.h), and code for those that are. */
enum told { TOLD_own, TOLD_each, TOLD_touching, TOLD_rare };
#define WHERE_TOLD_own(...)
#define WHERE_TOLD_each(...) __VA_ARGS__
#define WHERE_TOLD_touching(...) __VA_ARGS__
#define WHERE_TOLD_rare(...) __VA_ARGS__

/* What a step did; consists of lanes (choose_all). */
struct step_report {
#define TELL(name, type, how, told, unit, text) WHERE_TOLD_##told(lanes name;)
    STANCE_ANSWERS(TELL)
    lanes impulse[CONTACTS][2]; /* N s */
    lanes slip[CONTACTS];       /* m, where loaded */
    lanes torque[ACTUATORS];    /* N m, as applied at the end */
    lanes fell, fell_by;        /* s, when it fell, and by which cause, from 1; 0: it did not */
    lanes work;                 /* J, of actuators and other outer forces */
    lanes least[CONTACTS];      /* smallest normal force, N */
    lanes landed;               /* 1: a contact came to the ground */
    lanes failure;              /* stance_failure, or 0: the state tells */
};

/* Residuals of the contact laws at contact c, of forces (or impulses) r and velocities u, the
 * normal ones relative to what restitution asks for; part: of each contact. What friction there is
 * is its grip's, and said with the contact that holds it. */
HOT void report_residuals(struct step_report *report, int c, const mask *part, lanes friction,
                          const lanes (*force)[2], const lanes u[2])
{
    const lanes none = lanes_of(0), along = lanes_abs(u[1]);
    mask loaded = part[c] & mask_less(none, force[c][0]);
    const lanes normal = choose(loaded, lanes_abs(u[0]), lanes_max(-u[0], none));
    report->signorini_residual =
        lanes_max(choose(part[c], normal, none), report->signorini_residual);
    if (contact_unknowns(c) == 1)
        return;
    const lanes r[2] = {contact_load(c, force), force[c][1]}, bound = friction * r[0];
    loaded = contact_part(c, part) & mask_less(none, r[0]);
    const lanes beyond = lanes_abs(r[1]) / choose(loaded, r[0], lanes_of(1)) - friction;
    report->coulomb_residual =
        choose(loaded, lanes_max(beyond, report->coulomb_residual), report->coulomb_residual);
    const mask opposed =
        mask_less_equal((1 - 1e-9) * bound, lanes_abs(r[1])) & mask_less_equal(r[1] * u[1], none);
    report->dissipation_residual =
        choose(loaded & LANES_NOT(opposed), lanes_max(along, report->dissipation_residual),
               report->dissipation_residual);
}

/* No answer told. */
static inline void report_clear_answers(struct step_report *report)
{
    const lanes none = lanes_of(0);
    report->fell = report->fell_by = none;
#define UNTOLD(name, type, how, told, unit, text) WHERE_TOLD_##told(report->name = none;)
    STANCE_ANSWERS(UNTOLD)
}

/* A report of nothing, to add others to. */
static inline void report_clear(struct step_report *report)
{
    memset(report, 0, sizeof *report);
    EACH_CONTACT (c, 0)
        report->least[c] = lanes_of(INFINITY);
}
static inline void report_clear_where(mask m, struct step_report *report)
{
    struct step_report none;
    report_clear(&none);
    choose_all(m, &none, report, sizeof none);
}
/* The same in one lane. */
static inline void report_clear_lane(struct step_report *report, int lane)
{
    lane_clear(report, sizeof *report, lane);
    EACH_CONTACT (c, 0)
        lane_set(&report->least[c], lane, INFINITY);
}
/* Torques that are applied at some instant. */
HOT void report_torques(struct step_report *report, const lanes *torque)
{
    EACH (i, 0, SCENE_ACTUATORS)
        report->peak_torque = lanes_max(lanes_abs(torque[i]), report->peak_torque);
}
/* The largest friction so far and what grip c takes, of forces or impulses. */
HOT void report_friction(lanes *used, int c, const mask *part, const lanes (*r)[2])
{
    if (contact_unknowns(c) == 1)
        return;
    const lanes load = contact_load(c, r);
    const mask loaded = contact_part(c, part) & mask_less(lanes_of(0), load);
    const lanes ratio = lanes_abs(r[c][1]) / choose(loaded, load, lanes_of(1));
    *used = choose(loaded, lanes_max(ratio, *used), *used);
}

/* Forces of the contacts in `part`, N. */
static inline void report_forces(struct step_report *report, const mask *part,
                                 const lanes force[CONTACTS][2])
{
    const lanes none = lanes_of(0);
    EACH_CONTACT (c, 0) {
        const mask carries = part[c] & mask_less(none, force[c][0]);
        report->least[c] = lanes_min(choose(carries, force[c][0], none), report->least[c]);
        report_friction(&report->friction_used, c, part, force);
    }
}

/* Adds a part of a step to the whole. */
static inline void report_add(struct step_report *sum, const struct step_report *part)
{
    EACH_CONTACT (c, 0) {
        sum->slip[c] += part->slip[c];
        EACH (a, 0, 2)
            sum->impulse[c][a] += part->impulse[c][a];
    }
    EACH (i, 0, SCENE_ACTUATORS)
        sum->torque[i] = part->torque[i];
    const mask upright = mask_less_equal(sum->fell_by, lanes_of(0));
    sum->fell = choose(upright, part->fell, sum->fell);
    sum->fell_by = choose(upright, part->fell_by, sum->fell_by);
    sum->landed = lanes_max(part->landed, sum->landed);
    sum->work += part->work;
    EACH_CONTACT (c, 0)
        sum->least[c] = lanes_min(part->least[c], sum->least[c]);
#define ADD_SUM(name) sum->name += part->name;
#define ADD_MAX(name) sum->name = lanes_max(part->name, sum->name);
#define ADD_STEPS(name) ADD_MAX(name)
#define ADD(name, type, how, told, unit, text) WHERE_TOLD_##told(ADD_##how(name))
    STANCE_ANSWERS(ADD)
    sum->failure = part->failure;
}
static inline void report_add_where(mask m, struct step_report *sum, const struct step_report *part)
{
    struct step_report both = *sum;
    report_add(&both, part);
    choose_all(m, &both, sum, sizeof both);
}

#endif
