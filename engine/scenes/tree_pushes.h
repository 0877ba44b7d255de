/* tree_pushes.h - what the world does to points of a tree: forces and when they act. See
 * tree_lanes.h; tree_dynamics.h includes this. Blows are struck in tree_lanes.h. */
#ifndef STANCE_SCENES_TREE_PUSHES_H
#define STANCE_SCENES_TREE_PUSHES_H

/* R(a_j) times the arm of push p in frame j; -E T of a joint that slides. */
HOT void tree_push_reach(const scene_body *b, const scene_trig *trig, int p, int j, lanes out[2])
{
    const int through = tree_push_path[p][j];
    if (tree_slides(j))
        tree_slide_arm(b, trig, j, out);
    else
        tree_arm(b, trig, through != TREE_OWN && tree_straight_joint[through],
                 through == TREE_OWN ? b->push[p] : b->joint[through], j, tree_push_path[p], out);
}
/* The force of push p at time t. */
HOT void tree_push_force(const scene_body *b, int p, lanes t, lanes out[2])
{
    out[0] = b->pull[p][0], out[1] = b->pull[p][1];
    if (!tree_push_swings[p])
        return;
    const double round_bits = 0x1.8p52; /* adding it rounds to a whole number of periods */
    const lanes periods = b->push[p][6] * (t - b->push[p][4]);
    const lanes phase = periods - ((periods + round_bits) - round_bits);
    lanes sine, cosine;
    lanes_sincos(0x1.921fb54442d18p+2 * phase, &sine, &cosine); /* 2 pi */
    out[0] = out[0] * sine, out[1] = out[1] * sine;
}
/* Adds what a force at the point of push p is as a generalised one, times a factor, to x. */
HOT void tree_push_add(const scene_body *b, const scene_trig *trig, int p, const lanes force[2],
                       lanes factor, lanes *x)
{
    tree_base_add(b, factor, force, x);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        lanes reach[2];
        if (tree_push_path[p][j] < 0)
            continue;
        tree_push_reach(b, trig, p, j, reach);
        const lanes turning = lanes_fms(reach[0], force[1], reach[1] * force[0]);
        x[TREE_BASE + j] = lanes_fma(factor, turning, x[TREE_BASE + j]);
    }
}

/* Pushes from t to t + h: each acts by its mean over that, so that what it gives in all is exact
 * wherever its ends fall. */
HOT void scene_push(scene_body *b, lanes t, lanes h)
{
    TREE_UNROLL
    for (int p = 0; p < tree_pushes; p++) {
        const lanes first = lanes_max(b->push[p][4], t), last = lanes_min(b->push[p][5], t + h);
        lanes share = lanes_max(last - first, lanes_of(0)) / h;
        if (tree_push_swings[p]) /* for ever, at t = INFINITY, too */
            share =
                choose(mask_less(b->push[p][5], lanes_of(INFINITY)) | mask_less(t, b->push[p][4]),
                       share, lanes_of(1));
        for (int axis = 0; axis < 2; axis++) {
            b->pull[p][axis] = share * b->push[p][2 + axis];
            if (tree_push_impulse[p])
                b->pull[p][axis] = lanes_of(0);
        }
    }
}
/* Time from t to the next instant at which a push begins or ends or a blow falls, where it is more
 * than `least` away from t and from t + h; else h. */
HOT lanes scene_push_edge(const scene_body *b, lanes t, lanes h, lanes least)
{
    lanes next = h;
    TREE_UNROLL
    for (int p = 0; p < tree_pushes; p++)
        for (int end = 4; end < 6; end++) {
            const lanes off = b->push[p][end] - t;
            const mask inside = mask_less(least, off) & mask_less(off, h - least);
            next = choose(inside, lanes_min(off, next), next);
        }
    return next;
}
/* Time after which nothing pushes any more but one force, if any, that swings for ever: what rests
 * under it is told by its phases. */
HOT lanes scene_pushed_until(const scene_body *b)
{
    lanes until = lanes_of(0), endless = lanes_of(0);
    for (int p = 0; p < tree_pushes; p++) {
        const mask ends = mask_less(b->push[p][5], lanes_of(INFINITY));
        endless = choose(ends, endless, endless + 1);
        until = lanes_max(choose(ends, b->push[p][5], b->push[p][4]), until);
    }
    return choose(mask_less(lanes_of(1), endless), lanes_of(INFINITY), until);
}
/* When it begins to swing, s. */
HOT lanes scene_swings_from(const scene_body *b)
{
    lanes from = lanes_of(0);
    for (int p = 0; p < tree_pushes; p++)
        if (tree_push_swings[p])
            from = lanes_max(b->push[p][4], from);
    return from;
}
/* The longest step, s, that resolves how forces change with time: an eighth of a period. */
HOT lanes scene_longest_step(const scene_body *b)
{
    lanes longest = lanes_of(INFINITY);
    for (int p = 0; p < tree_pushes; p++)
        if (tree_push_swings[p])
            longest = lanes_min(longest, 0.125 / b->push[p][6]);
    return longest;
}

#endif
