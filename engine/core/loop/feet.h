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

#include "bundle.h"

#define FEET_DEEPEST 1e-9 /* m: what begins deeper in the ground is not in play */

/* Contacts of another foot that are on the ground, of those in play. */
static inline mask feet_down(const struct bundle *b, int c)
{
    return mask_less(lanes_of(0), b->set.may_touch[c]) &
           mask_less_equal(b->now.gap[c], lanes_of(STEP_CLOSED));
}

/* At the beginning of the cases in `fresh`. */
COLD void feet_begin(struct bundle *b, mask fresh)
{
    EACH_CONTACT (c, 0) {
        const mask under = fresh & mask_less(lanes_of(0), b->ahead[c]) &
                           mask_less(b->now.gap[c], lanes_of(-FEET_DEEPEST));
        b->set.may_touch[c] = choose(under, lanes_of(0), b->set.may_touch[c]);
    }
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
            if (contact_grip(k) != contact_grip(c))
                behind |= down[k] & mask_less_equal(along[c], along[k]);
        const mask lands = mask_less(lanes_of(STEP_CLOSED), b->now.gap[c]) & LANES_NOT(behind);
        b->set.may_touch[c] =
            choose(live & mask_less(lanes_of(0), b->ahead[c]),
                   choose(down[c] | lands, lanes_of(1), lanes_of(0)), b->set.may_touch[c]);
    }
}

/* Counts the feet that have come to the ground since `before`, what feet_down said then. */
COLD void feet_count(struct bundle *b, mask live, const mask *before)
{
    EACH_CONTACT (c, 0) {
        const int foot = contact_grip(c);
        if (foot < 0)
            continue;
        const mask other =
            live & feet_down(b, c) & LANES_NOT(before[c]) &
            (mask_less(b->foot, lanes_of(foot)) | mask_less(lanes_of(foot), b->foot));
        b->answer.footfalls += choose(other, lanes_of(1), lanes_of(0));
        b->foot = choose(other, lanes_of(foot), b->foot);
    }
}

#endif
