/* plates.h - ground in plates under the contacts: ground.h says what it is like.
 *
 * A contact is above the plate that it is over, its gap is from there, and the plate does not
 * change within a step: nothing else of a step knows that there are any. At the end of one it is
 * seen which contacts have come over another plate. An edge is no wall. What is above the new plate
 * has that from now on: what slid over an edge has lost what it stood on. What stands, and is
 * pushed against a riser, keeps the plate that it stood on, on which it comes down again should it
 * lift off, until it is above the surface; so does what drops off an edge and meets a riser before
 * it has landed, or it would lose all ground on steps of no height. What comes into a riser through
 * the air, as a foot that was not lifted high enough, has no ground until it is above the surface.
 * Floors are left for lower ones only, by which nothing gains energy.
 *
 * Where that makes a difference (it stands, or may have met the higher of both plates in the step)
 * the crossing has to be the end of a step. With methods whose steps may be of any length the step
 * is taken again as a shorter piece, up to where the way along the ground, a straight line in time,
 * meets the edge; what is left of the step follows, again up to there if need be. Of pieces that
 * short the line is exact: three are enough for PLATES_OVER. With the others such a step ends
 * beyond the edge, an error of order h as that of a landing; but what comes from above, and would
 * be inside the new plate or stand beside the old one, is taken back once, to land on the new one.
 */
#ifndef STANCE_CORE_LOOP_PLATES_H
#define STANCE_CORE_LOOP_PLATES_H

#include "bundle.h"
#include "engine/ground.h"

#if SCENE_PLATES

#define PLATES_NEAR 1e-9     /* m: what is so little below a surface is above it */
#define PLATES_SLACK 1e-13   /* m, of places: an edge is crossed when it is that far beyond ... */
#define PLATES_OVER 1e-12    /* ... and no piece ends further */
#define PLATES_BRIEF 0x1p-40 /* of a step: no piece is shorter */
#define PLATES_MOST 64       /* plates in one step that are looked at */

/* Places that lie on plates: contacts, then the points that may fall. */
HOT bool plates_has(int k)
{
    return k < CONTACTS ? k < OWN_CONTACTS && contact_grip(k) >= 0 : k - CONTACTS < tree_points;
}
#define EACH_PLACE(k)                                                                              \
    EACH (k, 0, SCENE_PLACES)                                                                      \
        if (!plates_has(k)) {                                                                      \
        } else

HOT lanes plates_along(const struct bundle *b, int k)
{
    const scene_body *const body = &b->set.body;
    return k < CONTACTS ? scene_along(body, b->now.s, &b->now.trig, k)
                        : tree_point_place(body, b->now.s, &b->now.trig, k - CONTACTS, 0);
}

/* Lanes where a place is beyond the plate that it was over. */
HOT mask plates_off(const struct bundle *b, int k, lanes x)
{
    const lanes slack = PLATES_SLACK * lanes_max(lanes_of(1), lanes_abs(x));
    return mask_less(x, b->plates.low[k] - slack) | mask_less(b->plates.high[k] + slack, x);
}

/* May a contact that touches, or may soon, come to an edge in the next step? Then it has to be one
 * that can be taken again. */
HOT mask plates_near(const struct bundle *b)
{
    mask near = MASK_NONE;
    EACH_CONTACT (c, 0) {
        if (contact_grip(c) < 0)
            continue;
        const lanes way = lanes_fma(lanes_of(4), b->plates.moved[c], lanes_of(1e-3));
        const lanes fall = lanes_fma(4 * b->h, lanes_abs(b->now.approach[c]), lanes_of(1e-3));
        const lanes room = lanes_min(b->plates.along[c] - b->plates.low[c],
                                     b->plates.high[c] - b->plates.along[c]);
        const lanes z = b->now.gap[c] + b->set.body.floor[c];
        const mask under = mask_less(z + fall, b->plates.bottom[c]) &
                           mask_less(b->now.gap[c], lanes_of(-STEP_CLOSED));
        const mask clear = under | mask_less(b->plates.top[c] + fall, z);
        const mask narrow = mask_less(b->plates.high[c] - b->plates.low[c], way);
        near |= mask_less(room, way) & (narrow | LANES_NOT(clear));
    }
    return b->live & near;
}

/* The lanes of m may move faster from now on than they did. */
COLD void plates_jump(struct bundle *b, mask m)
{
    EACH_PLACE (k)
        b->plates.moved[k] = choose(m, lanes_of(1), b->plates.moved[k]);
}

static void plates_at(const struct bundle *b, int lane, double x, struct ground *at)
{
    const stance_case *const c = b->which[lane];
    double from[STANCE_MAX_PLATES];
    for (int k = 0; k < c->body.plates; k++)
        from[k] = lane_get(&b->plates.from[k], lane);
    if (fabs(x) < 1e9) /* else it has left the numbers that tell plates apart */
        ground_at(c, from, c->body.plates, x, at);
    else
        *at = (struct ground){0, 1, -INFINITY, INFINITY};
}

/* Contact c stands at height `floor`, of a gap above it. */
static void plates_floor(struct bundle *b, int lane, int c, double z, double floor)
{
    lane_set(&b->set.body.floor[c], lane, floor);
    lane_set(&b->now.gap[c], lane, z - floor);
}

/* What a contact has for ground that is over `at`: see above. Whether it is another one than it
 * stood on, or stands on now. */
static bool plates_set(struct bundle *b, int lane, int c, const struct ground *at)
{
    const double z = lane_get(&b->now.gap[c], lane) + lane_get(&b->set.body.floor[c], lane);
    const bool above = z >= at->height - PLATES_NEAR;
    const bool stands = lane_get(&b->set.may_touch[c], lane) > 0 &&
                        lane_get(&b->plates.inside[c], lane) < PLATES_NO_GROUND &&
                        lane_get(&b->now.gap[c], lane) <= STEP_CLOSED;
    const double floor = lane_get(&b->set.body.floor[c], lane);
    const bool drops = z <= lane_get(&b->plates.dropped[c], lane) + PLATES_NEAR;
    lane_set(&b->plates.roof[c], lane, at->height);
    if (!above && (stands || drops || lane_get(&b->plates.inside[c], lane) == PLATES_STANDS)) {
        lane_set(&b->plates.inside[c], lane, PLATES_STANDS);
        return false;
    }
    const bool inside = lane_get(&b->plates.inside[c], lane) >= PLATES_NO_GROUND;
    plates_floor(b, lane, c, z, at->height);
    if (stands && at->height < floor - PLATES_NEAR)
        lane_set(&b->plates.dropped[c], lane, floor);
    lane_set(&b->plates.inside[c], lane, above ? 0 : PLATES_NO_GROUND);
    if (!above)
        lane_set(&b->set.may_touch[c], lane, 0);
    else if (inside && b->which[lane]->contacts >> c & 1 &&
             !(lane_get(&b->ahead[c], lane) > 0)) /* of those feet_choose says it */
        lane_set(&b->set.may_touch[c], lane, 1);
    if (tree_rough[c])
        lane_set(&b->set.body.rough[c], lane, b->which[lane]->body.rough[c] * at->factor);
    return stands || lane_get(&b->now.gap[c], lane) <= STEP_CLOSED;
}

/* Place k is where it is over another plate. Whether that changes what it stands on. */
static bool plates_step_on(struct bundle *b, int lane, int k)
{
    struct ground at;
    plates_at(b, lane, lane_get(&b->plates.along[k], lane), &at);
    lane_set(&b->plates.low[k], lane, at.low);
    lane_set(&b->plates.high[k], lane, at.high);
    if (k < CONTACTS) {
        struct ground left, right;
        plates_at(b, lane, nextafter(at.low, -INFINITY), &left);
        plates_at(b, lane, at.high, &right);
        lane_set(&b->plates.top[k], lane, fmax(at.height, fmax(left.height, right.height)));
        lane_set(&b->plates.bottom[k], lane, fmin(at.height, fmin(left.height, right.height)));
        return plates_set(b, lane, k, &at);
    }
    lane_set(&b->set.body.floor[k], lane, at.height);
    return false;
}

/* At the beginning of the cases in `fresh`, where pieces before a footfall are not laid yet. */
COLD void plates_begin(struct bundle *b, mask fresh)
{
    EACH_PLACE (k)
        b->plates.along[k] = choose(fresh, plates_along(b, k), b->plates.along[k]);
    plates_jump(b, fresh);
    b->plates.cut = choose(fresh, lanes_of(INFINITY), b->plates.cut);
    for (int lane = 0; lane < LANES; lane++) {
        const stance_case *const c = b->which[lane];
        if (!c || !mask_get(fresh, lane))
            continue;
        SCENE_BEGIN(c);
        for (int k = 0; k < c->body.plates; k++)
            lane_set(&b->plates.from[k], lane,
                     c->body.plate[k].footfall > 0 ? INFINITY : c->body.plate[k].from);
        EACH_PLACE (k) {
            if (k < CONTACTS) {
                lane_set(&b->plates.inside[k], lane, 0);
                lane_set(&b->plates.landing[k], lane, NAN);
                lane_set(&b->plates.dropped[k], lane, -INFINITY);
            }
            plates_step_on(b, lane, k);
        }
    }
}

/* `footfalls` have been, and the foot that stands is at x: what is laid before the next one is. */
COLD void plates_footfall(struct bundle *b, int lane, double footfalls, double x)
{
    const stance_case *const c = b->which[lane];
    bool laid = false;
    for (int k = 0; k < c->body.plates; k++)
        if (c->body.plate[k].footfall == footfalls + 1) {
            lane_set(&b->plates.from[k], lane, x + c->body.plate[k].from);
            laid = true;
        }
    EACH_PLACE (k)
        if (laid)
            plates_step_on(b, lane, k);
}

/* What comes out of a plate is above it. What has landed drops no more, nor what has risen. */
HOT void plates_inside(struct bundle *b, mask ok)
{
    mask changes = MASK_NONE;
    EACH_CONTACT (c, 0) {
        if (contact_grip(c) < 0)
            continue;
        const lanes z = b->now.gap[c] + b->set.body.floor[c];
        const mask in = ok & mask_less(lanes_of(0), b->plates.inside[c]);
        const mask ends = ok & (mask_less_equal(b->now.gap[c], lanes_of(STEP_CLOSED)) |
                                mask_less(b->plates.dropped[c] + PLATES_NEAR, z));
        b->plates.dropped[c] = choose(ends, lanes_of(-INFINITY), b->plates.dropped[c]);
        changes |= in & mask_less(b->plates.roof[c] + STEP_CLOSED, z);
        b->answer.through_ground =
            choose(in, lanes_max(b->plates.roof[c] - z, b->answer.through_ground),
                   b->answer.through_ground);
    }
    if (!mask_any(changes))
        return;
    for (int lane = 0; lane < LANES; lane++)
        for (int c = 0; c < CONTACTS && b->which[lane] && mask_get(changes, lane); c++) {
            SCENE_BEGIN(b->which[lane]);
            if (plates_has(c) && lane_get(&b->plates.inside[c], lane) > 0)
                plates_step_on(b, lane, c);
        }
}

/* The lanes of `ok` have moved on; some places may be over other plates now. */
HOT void plates_follow(struct bundle *b, mask ok)
{
    mask off = MASK_NONE, taken[CONTACTS];
    EACH_PLACE (k) {
        const lanes x = plates_along(b, k);
        b->plates.moved[k] = choose(ok, lanes_abs(x - b->plates.along[k]), b->plates.moved[k]);
        b->plates.along[k] = choose(ok, x, b->plates.along[k]);
        off |= ok & plates_off(b, k, x);
    }
    EACH_CONTACT (c, 0) { /* a step that was taken again began on what it was to land on */
        taken[c] = ok & mask_less(b->plates.landing[c], lanes_of(INFINITY));
        off |= taken[c];
        b->plates.landing[c] = choose(ok, lanes_of(NAN), b->plates.landing[c]);
    }
    plates_inside(b, ok);
    if (!mask_any(off))
        return;
    for (int lane = 0; lane < LANES; lane++) {
        if (!b->which[lane] || !mask_get(off, lane))
            continue;
        SCENE_BEGIN(b->which[lane]);
        bool changes = false;
        EACH_PLACE (k) {
            const mask gone = plates_off(b, k, b->plates.along[k]);
            if (mask_get(gone, lane) || (k < CONTACTS && mask_get(taken[k], lane)))
                changes |= plates_step_on(b, lane, k);
        }
        if (changes)
            advance_forget(&b->advance, mask_of_lane(lane));
    }
}

/* The highest and the lowest plate from x0 to x1; true: there are more than are looked at. */
static bool plates_between(const struct bundle *b, int lane, double x0, double x1, double *high,
                           double *low)
{
    double x = fmin(x0, x1);
    *high = -INFINITY, *low = INFINITY;
    for (int i = 0; i < PLATES_MOST; i++) {
        struct ground at;
        plates_at(b, lane, x, &at);
        *high = fmax(at.height, *high);
        *low = fmin(at.height, *low);
        if (!(at.high <= fmax(x0, x1)))
            return false;
        x = at.high;
    }
    return true;
}

/* Where a step leaves plates. */
struct plates_way {
    const struct motion *from; /* its beginning */
    double h;                  /* s, that it took */
};

/* Does it make a difference when contact c, now at x1, has crossed the edge that it has? */
static bool plates_matters(const struct bundle *b, int lane, int c, const struct plates_way *way,
                           double x1)
{
    const double floor = lane_get(&b->set.body.floor[c], lane);
    const double gap[2] = {lane_get(&way->from->gap[c], lane), lane_get(&b->now.gap[c], lane)};
    const double rate = way->h * fmax(fabs(lane_get(&way->from->approach[c], lane)),
                                      fabs(lane_get(&b->now.approach[c], lane)));
    double high, low;
    if (!(b->which[lane]->contacts >> c & 1))
        return false;
    if (plates_between(b, lane, lane_get(&b->plates.along[c], lane), x1, &high, &low))
        return true;
    high = fmax(floor, high);
    low = fmin(floor, low);
    if (high == low && !tree_rough[c])
        return false;
    const bool touches =
        lane_get(&b->set.may_touch[c], lane) > 0 && fmin(gap[0], gap[1]) <= STEP_CLOSED;
    const bool over = fmin(gap[0], gap[1]) + floor - rate > high;
    const bool under = fmax(gap[0], gap[1]) + floor + rate < low;
    return touches || !(over || under);
}

#ifdef ADVANCE_PIECES

#ifdef ADVANCE_MOVES /* lanes, of which `done` is where they are in their step */
static double advance_done(const struct advance *a, int lane)
{
    return lane_get(&a->done, lane);
}
static void advance_back(struct advance *a, const struct advance *before, mask m)
{
    choose_all(m, before, a, sizeof *a);
}
#endif

/* Lanes of those that have moved, from *from and *before, whose way has to end at an edge: they are
 * back where they were, and their next piece ends there. `ends`: of them those at the end of a
 * piece of length h. */
COLD mask plates_back(struct bundle *b, const struct motion *from, const struct advance *before,
                      lanes h, mask ends, mask failed)
{
    mask back = MASK_NONE;
    for (int lane = 0; lane < LANES; lane++) {
        if (!b->which[lane] || mask_get(failed, lane))
            continue;
        SCENE_BEGIN(b->which[lane]);
        const double begun = advance_done(before, lane), whole = lane_get(&h, lane);
        const double moved =
            (mask_get(ends, lane) ? whole : advance_done(&b->advance, lane)) - begun;
        const struct plates_way way = {from, moved};
        double first = INFINITY;
        EACH_CONTACT (c, 0) {
            if (contact_grip(c) < 0 || !(moved > 0))
                continue;
            const lanes along = plates_along(b, c);
            const double x0 = lane_get(&b->plates.along[c], lane), x1 = lane_get(&along, lane);
            const mask off = plates_off(b, c, along);
            if (!mask_get(off, lane) || !plates_matters(b, lane, c, &way, x1))
                continue;
            const bool up = x1 > x0;
            const double edge = lane_get(up ? &b->plates.high[c] : &b->plates.low[c], lane);
            const double size = fmax(1, fabs(edge)), beyond = (up ? 1 : -1) * (x1 - edge);
            const double aim = edge + (up ? 1 : -1) * size * (PLATES_SLACK + 0.5 * PLATES_OVER);
            if (beyond > size * (PLATES_SLACK + PLATES_OVER))
                first = fmin(first, moved * fmin(fmax((aim - x0) / (x1 - x0), 0), 1));
        }
        const double least = PLATES_BRIEF * lane_get(&b->h, lane);
        if (!(first < moved) || moved <= least)
            continue;
        lane_set(&b->plates.cut, lane, lane_get(&b->piece_from, lane) + begun + fmax(first, least));
        back |= mask_of_lane(lane);
    }
    if (!mask_any(back))
        return back;
    choose_all(back, from, &b->now, sizeof b->now);
    advance_back(&b->advance, before, back);
    return back;
}

#else

/* The same of steps that are what they are: those that are taken back, once, have the plate from
 * their beginning on that a contact comes down on, or beside whose edge it would stand. */
COLD mask plates_back(struct bundle *b, const struct motion *from, const struct advance *before,
                      lanes h, mask ends, mask failed)
{
    mask back = MASK_NONE;
    (void)before, (void)failed;
    for (int lane = 0; lane < LANES; lane++) {
        if (!b->which[lane] || !mask_get(ends, lane))
            continue;
        SCENE_BEGIN(b->which[lane]);
        const struct plates_way way = {from, lane_get(&h, lane)};
        EACH_CONTACT (c, 0) {
            if (contact_grip(c) < 0 || lane_get(&from->gap[c], lane) <= STEP_CLOSED ||
                lane_get(&b->plates.inside[c], lane) > 0 ||
                isfinite(lane_get(&b->plates.landing[c], lane))) /* again */
                continue;
            const lanes along = plates_along(b, c);
            const double x0 = lane_get(&b->plates.along[c], lane), x1 = lane_get(&along, lane);
            const double floor = lane_get(&b->set.body.floor[c], lane);
            const double z0 = lane_get(&from->gap[c], lane) + floor;
            const double z1 = lane_get(&b->now.gap[c], lane) + floor;
            const mask off = plates_off(b, c, along);
            struct ground at;
            if (!mask_get(off, lane) || !plates_matters(b, lane, c, &way, x1))
                continue;
            plates_at(b, lane, x1, &at);
            const double edge = lane_get(x1 > x0 ? &b->plates.high[c] : &b->plates.low[c], lane);
            const double there = z0 + (z1 - z0) * ((edge - x0) / (x1 - x0));
            if (z0 <= at.height || there < at.height - PLATES_NEAR ||
                (z1 > at.height && z1 > floor + STEP_CLOSED))
                continue;
            lane_set(&b->plates.landing[c], lane, at.height);
            back |= mask_of_lane(lane);
        }
    }
    if (!mask_any(back))
        return back;
    choose_all(back, from, &b->now, sizeof b->now);
    for (int lane = 0; lane < LANES; lane++)
        for (int c = 0; c < CONTACTS && mask_get(back, lane); c++) {
            const double height = lane_get(&b->plates.landing[c], lane);
            if (!isfinite(height))
                continue;
            const double z = lane_get(&b->now.gap[c], lane) + lane_get(&b->set.body.floor[c], lane);
            plates_floor(b, lane, c, z, height);
        }
    advance_forget(&b->advance, back);
    return back;
}

#endif
#endif
#endif
