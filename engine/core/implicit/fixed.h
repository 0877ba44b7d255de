/* fixed.h - advances by fixed implicit steps: the quick way where a step is ordinary, else with all
 * that step.h can do; a step that does not converge is tried with each torque free or at its limit
 * in turn, then taken in parts.
 *
 * One of the ways to get from one step's end to the next (`advance`, see stream.h).
 */
#ifndef STANCE_CORE_IMPLICIT_FIXED_H
#define STANCE_CORE_IMPLICIT_FIXED_H

#include "ordinary_step.h"

/* Cases may change lanes. */
#define ADVANCE_MOVES

/* Motions know their energy. */
#define ADVANCE_TELLS_ENERGY

/* A law that is not linear acts once a step, on the state at its beginning. */
#define ADVANCE_SAMPLES_LAWS

#define FIXED_MAX_SUBDIVISION 6 /* a step is halved at most this often ... */
#define FIXED_FREEZE_AFTER 6    /* ... and in the last attempt the geometry freezes here */

struct advance {
    struct ordinary quick;
};

static void advance_load(struct advance *a, int lane, const stance_case *c)
{
    (void)c;
    ordinary_forget(&a->quick, mask_of_lane(lane));
}
static void advance_forget(struct advance *a, mask m)
{
    ordinary_forget(&a->quick, m);
}

/* One step. Where Newton's iteration does not end because a torque that acts inside the step comes
 * and goes at its limit, each torque is taken for free or for being at either end of its range, one
 * way after the other, until a solution agrees with what was assumed. */
COLD mask fixed_step(const struct step *step, mask run, struct motion *to,
                     struct step_report *report)
{
    const lanes *const limit = step->set->law.limit;
    mask good = take_step(step, run, to, report), limited = MASK_NONE;
    for (int i = 0; i < OWN_ACTUATORS; i++)
        limited |= mask_less(limit[i], lanes_of(INFINITY));
    mask failed = run & limited & LANES_NOT(good);
    if (OWN_ACTUATORS == 0 || !step->coupled || !mask_any(failed))
        return good;
    int ways = 1;
    EACH (i, 0, OWN_ACTUATORS)
        ways *= 3;
    for (int way = 0; way < ways && mask_any(failed); way++) {
        static const int ends[3] = {0, 1, -1};
        int corner[ACTUATORS], rest = way;
        struct motion next = *step->from;
        struct step_report part;
        struct step at = *step;
        for (int i = 0; i < ACTUATORS; i++, rest /= 3)
            corner[i] = ends[rest % 3];
        at.corner = corner;
        const mask found = take_step(&at, failed, &next, &part);
        part.iterations += report->iterations;
        choose_all(found, &next, to, sizeof next);
        choose_all(found, &part, report, sizeof part);
        report->iterations = choose(failed & LANES_NOT(found), part.iterations, report->iterations);
        good |= found;
        failed &= LANES_NOT(found);
    }
    return good;
}

/* Lanes that did not converge: the step again in 2, 4, ... equal parts. */
COLD mask fixed_subdivide(const struct step *step, mask run, struct motion *to,
                          struct step_report *total)
{
    mask failed = run;
    for (int level = 1; level <= FIXED_MAX_SUBDIVISION && mask_any(failed); level++) {
        const int parts = 1 << level;
        struct motion here = *step->from;
        struct step part_of = *step;
        struct step_report sum;
        part_of.from = &here;
        part_of.h = step->h / parts;
        if (level == FIXED_MAX_SUBDIVISION)
            part_of.freeze_after = FIXED_FREEZE_AFTER;
        report_clear(&sum);
        sum.iterations = total->iterations;
        mask good = failed;
        for (int k = 0; k < parts && mask_any(good); k++) {
            struct step_report part;
            struct motion next = here;
            good &= fixed_step(&part_of, good, &next, &part);
            here = next;
            report_add(&sum, &part);
        }
        sum.subdivided_steps = lanes_of(1);
        choose_all(good, &here, to, sizeof here);
        choose_all(good, &sum, total, sizeof sum);
        total->iterations = choose(failed, sum.iterations, total->iterations);
        failed &= LANES_NOT(good);
    }
    return run & LANES_NOT(failed);
}

/* One ordinary step in all lanes, of which all have the contacts in `touching` closed; false: it is
 * not ordinary in all, or not all have, and nothing has happened. */
#define ADVANCE_ORDINARY
static bool advance_was_ordinary(const struct advance *a, int lane)
{
    return lane_get(&a->quick.known, lane) > 0;
}
HOT bool advance_ordinary(struct advance *a, const struct step *step, mask live,
                          contact_set touching, struct motion *now, struct step_report *report)
{
    struct iterate it;
    mask apart = MASK_NONE;
    EACH_IN (c, touching)
        apart |= live & LANES_NOT(motion_closed(step->set, now->gap, c));
    if (mask_any(apart))
        return false;
    const mask good = ordinary_try(&a->quick, step, live, touching, true, &it, report);
    if (mask_any(live & LANES_NOT(good)))
        return false;
    ordinary_keep(&a->quick, &it, step->h, true, good, now);
    return true;
}

COLD mask advance(struct advance *a, const struct step *step, mask live, struct motion *now,
                  struct step_report *report, mask *failed)
{
    struct iterate it;
    const contact_set touching = step_touching(step->set, now->gap, live);
    const mask ok = ordinary_try(&a->quick, step, live, touching, false, &it, report);
    ordinary_keep(&a->quick, &it, step->h, false, ok, now);
    mask arrived = ok;
    const mask other = live & LANES_NOT(ok);
    *failed = MASK_NONE;
    if (mask_any(other)) {
        struct step_report slow;
        struct motion next = *now;
        mask there = fixed_step(step, other, &next, &slow);
        const mask stuck = other & LANES_NOT(there);
        if (mask_any(stuck))
            there |= fixed_subdivide(step, stuck, &next, &slow);
        choose_all(other, &slow, report, sizeof slow);
        choose_all(there, &next, now, sizeof next);
        *failed = other & LANES_NOT(there);
        arrived |= there;
        ordinary_forget(&a->quick, other);
    }
    return arrived;
}

#endif
