/* feet.h - which contacts may land, and how often another foot has.
 *
 * Where landing is for feet that are ahead (stance_case.lands_ahead), set.may_touch says which
 * contacts are in play until the end of the next step: those on the ground stay so; one in the air
 * is where no other foot carries behind which, or beside which, it is along the ground; one that
 * has gone through the ground, which it may have done while it was not in play, is not before it is
 * in the air again. Both ends of a sole are one foot.
 */
#ifndef STANCE_CORE_LOOP_FEET_H
#define STANCE_CORE_LOOP_FEET_H

#include "plates.h"
#include "walk.h"

#define FEET_DEEPEST 1e-9 /* m: what begins deeper in the ground is not in play */

/* Contacts of another foot that are on the ground, of those in play. */
static inline mask feet_down(const struct bundle *b, int c)
{
    return motion_closed(&b->set, b->now.gap, c);
}

/* Those that have landed there: what they struck is past. */
#define FEET_REST 1e-9 /* m/s */
static inline mask feet_landed(const struct bundle *b, int c)
{
    return feet_down(b, c) & mask_less_equal(lanes_of(-FEET_REST), b->now.approach[c]);
}

/* The foot that contact c belongs to: a sole is one. */
HOT int feet_of(int c)
{
    return contact_grip(c) >= 0 && scene_other[c] >= 0 && scene_other[c] < c ? scene_other[c]
                                                                             : contact_grip(c);
}

/* The leg that contact c belongs to stands from now on, in the lanes of `where`. */
COLD void feet_stand(struct bundle *b, mask where, int c)
{
    for (int lane = 0; lane < LANES; lane++) {
        const stance_case *const of = b->which[lane];
        if (!of || !mask_get(where, lane))
            continue;
        SCENE_BEGIN(of);
        const stance_exchange *const exchange = &of->scene->exchange;
        const int leg = (int)(exchange->leg[1] >> c & 1);
        if (!exchange->any || !((exchange->leg[0] | exchange->leg[1]) >> c & 1) ||
            leg == (int)lane_get(&b->leg, lane))
            continue;
        lane_set(&b->leg, lane, leg);
#ifdef SCENE_SERVOS
        bundle_load_outputs(&b->set.law, lane, of, leg);
#endif
    }
}

/* Contact c stands: what of the ground is laid ahead of it. */
static void feet_lay(struct bundle *b, int lane, int c)
{
#if SCENE_PLATES
    SCENE_BEGIN(b->which[lane]);
    const lanes along = scene_along(&b->set.body, b->now.s, &b->now.trig, c);
    plates_footfall(b, lane, lane_get(&b->answer.footfalls, lane), lane_get(&along, lane));
#else
    (void)b, (void)lane, (void)c;
#endif
}

/* At the beginning of the cases in `fresh`. */
COLD void feet_begin(struct bundle *b, mask fresh)
{
    EACH_CONTACT (c, 0) {
        const mask under = fresh & mask_less(lanes_of(0), b->ahead[c]) &
                           mask_less(b->now.gap[c], lanes_of(-FEET_DEEPEST));
        b->set.may_touch[c] = choose(under, lanes_of(0), b->set.may_touch[c]);
    }
    /* Of feet on the ground one that neither lifts nor falls stands, of these the first. */
    for (int rests = 0; rests < 2; rests++)
        for (int c = OWN_CONTACTS; c-- > 0;) {
            if (contact_grip(c) < 0)
                continue;
            mask stands = fresh & feet_down(b, c);
            if (rests)
                stands &= mask_less_equal(lanes_abs(b->now.approach[c]), lanes_of(FEET_REST));
            feet_stand(b, stands, c);
            b->stands = choose(stands, lanes_of(c), b->stands);
        }
    for (int lane = 0; lane < LANES; lane++)
        if (b->which[lane] && mask_get(fresh, lane) && lane_get(&b->stands, lane) >= 0)
            feet_lay(b, lane, (int)lane_get(&b->stands, lane));
}

/* Which are in play from now on, in the lanes of `live`. */
HOT void feet_choose(struct bundle *b, mask live)
{
    if (!bundle_some(b->choosy))
        return;
    lanes along[CONTACTS];
    mask down[CONTACTS];
    EACH_CONTACT (c, 0) {
        down[c] = contact_grip(c) < 0 ? MASK_NONE : feet_down(b, c);
        along[c] = contact_grip(c) < 0 ? lanes_of(0)
                                       : scene_along(&b->set.body, b->now.s, &b->now.trig, c);
    }
    EACH_CONTACT (c, 0) {
        mask behind = MASK_NONE;
        EACH_CONTACT (k, 0)
            if (feet_of(k) != feet_of(c))
                behind |= down[k] & mask_less_equal(along[c], along[k]);
        const mask lands = mask_less(lanes_of(STEP_CLOSED), b->now.gap[c]) & LANES_NOT(behind);
        b->set.may_touch[c] = choose(live & mask_less(lanes_of(0), b->ahead[c]),
                                     lanes_where(down[c] | lands), b->set.may_touch[c]);
    }
}

/* Counts the feet that have come to the ground since `before`, what feet_landed said then. */
COLD void feet_count(struct bundle *b, mask live, const mask *before)
{
    EACH_CONTACT (c, 0) {
        const int foot = feet_of(c);
        if (foot < 0)
            continue;
        const mask other =
            live & feet_landed(b, c) & LANES_NOT(before[c]) &
            (mask_less(b->foot, lanes_of(foot)) | mask_less(lanes_of(foot), b->foot));
        b->answer.footfalls += lanes_where(other);
        b->foot = choose(other, lanes_of(foot), b->foot);
        b->set.law.footfall = choose(other, b->now.t, b->set.law.footfall);
        if (mask_any(other)) {
            feet_stand(b, other, c);
            walk_footfall(b, other, c);
            for (int lane = 0; lane < LANES; lane++)
                if (mask_get(other, lane))
                    feet_lay(b, lane, c);
        }
    }
}

#endif
