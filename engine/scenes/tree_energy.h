/* tree_energy.h - energies of a tree, and work. See tree_lanes.h, which includes this. */
#ifndef STANCE_SCENES_TREE_ENERGY_H
#define STANCE_SCENES_TREE_ENERGY_H

/* Kinetic energy of a velocity change x: x^T A x / 2. */
HOT lanes scene_kinetic(const scene_body *b, const scene_trig *trig, const lanes *x)
{
    lanes sum = lanes_of(0);
    if (tree_free)
        sum = (0.5 * b->mass) * lanes_fma(x[0], x[0], x[1] * x[1]);
    else if (tree_rail)
        sum = (0.5 * b->mass) * (x[0] * x[0]);
    const lanes p[2] = {tree_base(b, x, 0), tree_base(b, x, 1)};
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        lanes K[2];
        const lanes xi = x[TREE_BASE + i];
        tree_moment(b, trig, i, K);
        lanes drawn =
            lanes_fma(0.5 * tree_inertia(b, trig, i), xi, lanes_fms(K[0], p[1], K[1] * p[0]));
        TREE_UNROLL
        for (int j = 0; j < i; j++) {
            if (!tree_coupled[i][j])
                continue;
            lanes C, S;
            tree_couple(b, trig, j, i, K, &C, &S);
            drawn = lanes_fma(C, x[TREE_BASE + j], drawn);
        }
        sum = lanes_fma(xi, drawn, sum);
    }
    TREE_UNROLL
    for (int k = 0; k < tree_rotors; k++) {
        const int i = tree_rotor[k], j = i < 0 ? -1 : tree_against(i);
        if (i >= 0 && tree_slides(i))
            sum = lanes_fma(0.5 * b->rotor[k], x[TREE_BASE + i] * x[TREE_BASE + i], sum);
        else if (j >= 0)
            sum = lanes_fnma(b->rotor[k], x[TREE_BASE + i] * x[TREE_BASE + j], sum);
    }
    return sum;
}

/* Potential energy at s, up to a constant. */
HOT lanes scene_potential(const scene_body *b, const lanes *s, const scene_trig *trig)
{
    lanes moment[2] = {lanes_of(0), lanes_of(0)}, sum = lanes_of(0);
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        lanes K[2];
        if (tree_slides(i)) { /* in the moment of its frame, if there is one */
            const lanes moved = b->inertia[i] * trig->sine[i];
            for (int axis = 0; axis < 2 && tree_above[i] < 0; axis++)
                moment[axis] = lanes_fma(moved, b->joint[i][axis], moment[axis]);
            continue;
        }
        tree_moment(b, trig, i, K);
        moment[0] = moment[0] + K[0];
        moment[1] = moment[1] + K[1];
    }
    TREE_UNROLL
    for (int k = 0; k < tree_springs; k++) {
        const lanes bent = tree_joint(s, tree_spring[k]) - b->spring[k][2];
        sum = lanes_fma(0.5 * b->spring[k][0], bent * bent, sum);
    }
    for (int axis = 0; axis < 2; axis++) {
        sum = lanes_fma(b->gravity[axis], moment[axis], sum);
        sum = lanes_fma(b->mass * b->lift[axis], tree_base(b, s, axis), sum);
    }
    return sum;
}
/* Kinetic and potential energy at s with velocity w. */
HOT lanes scene_energy(const scene_body *b, const lanes *s, const lanes *w, const scene_trig *trig)
{
    return scene_kinetic(b, trig, w) + scene_potential(b, s, trig);
}
/* a' da of an angle; a' dl + l' da of a joint that slides. */
HOT lanes tree_bent(const lanes *w, const lanes *d, int i)
{
    const lanes wi = w[TREE_BASE + i], di = d[TREE_BASE + i];
    if (tree_slides(i))
        return lanes_fma(tree_frame_rate(w, i), di, wi * tree_frame_rate(d, i));
    return wi * di;
}
/* Mechanical energy that a small displacement d adds at velocity w, first order. */
HOT lanes scene_energy_change(const scene_body *b, const lanes *s, const scene_trig *trig,
                              const lanes *w, const lanes *d)
{
    const lanes p[2] = {tree_base(b, w, 0), tree_base(b, w, 1)};
    lanes sum =
        b->mass * lanes_fma(b->lift[0], tree_base(b, d, 0), b->lift[1] * tree_base(b, d, 1));
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        lanes K[2];
        const lanes wi = w[TREE_BASE + i], di = d[TREE_BASE + i];
        tree_moment(b, trig, i, K);
        /* d/da of a' (E K).p' + g.K; what slides moves on with a' dl + l' da in place of a' da */
        const lanes drawn = lanes_fma(K[0], p[0], K[1] * p[1]);
        const lanes lifted = lanes_fms(K[0], b->gravity[1], K[1] * b->gravity[0]);
        if (tree_slides(i))
            sum = lanes_fma(di, lifted, lanes_fnma(tree_bent(w, d, i), drawn, sum));
        else
            sum = lanes_fma(di, lanes_fnma(wi, drawn, lifted), sum);
        TREE_UNROLL
        for (int j = 0; j < i; j++) {
            if (!tree_coupled[i][j])
                continue;
            lanes C, S; /* d C_ji / d a_i = -S, / d a_j = S: C = D . K */
            tree_couple(b, trig, j, i, K, &C, &S);
            const lanes wj = w[TREE_BASE + j];
            if (tree_slides(i) || tree_slides(j))
                sum = lanes_fma(S, lanes_fms(wi, tree_bent(w, d, j), wj * tree_bent(w, d, i)), sum);
            else
                sum = lanes_fma(S * (wi * wj), d[TREE_BASE + j] - di, sum);
        }
    }
    TREE_UNROLL
    for (int k = 0; k < tree_springs; k++) {
        const int i = tree_spring[k];
        const lanes bent = tree_joint(s, i) - b->spring[k][2];
        sum = lanes_fma(b->spring[k][0] * bent, tree_joint(d, i), sum);
    }
    return sum;
}
/* What dampers take over a displacement d with rates w. */
HOT lanes scene_damped(const scene_body *b, const lanes *w, const lanes *d)
{
    lanes sum = lanes_of(0);
    TREE_UNROLL
    for (int k = 0; k < tree_springs; k++)
        sum = lanes_fma(b->spring[k][1] * tree_joint(w, tree_spring[k]),
                        tree_joint(d, tree_spring[k]), sum);
    return sum;
}
/* What actuator i moves, rad or m, of coordinates, rates or a displacement. */
HOT lanes scene_actuated(const lanes *x, int i)
{
    return tree_joint(x, tree_actuator[i]);
}
/* Work of the torques and of pushes over a displacement d. */
HOT lanes scene_work(const scene_body *b, lanes h, lanes t, const scene_trig *trig,
                     const lanes *torque, const lanes *d)
{
    (void)h;
    lanes sum = lanes_of(0);
    TREE_UNROLL
    for (int i = 0; i < tree_actuators; i++)
        sum = lanes_fma(torque[i], scene_actuated(d, i), sum);
    TREE_UNROLL
    for (int p = 0; p < tree_pushes; p++) {
        lanes force[SCENE_COORDINATES], pull[2];
        for (int k = 0; k < SCENE_COORDINATES; k++)
            force[k] = lanes_of(0);
        tree_push_force(b, p, t, pull);
        tree_push_add(b, trig, p, pull, lanes_of(1), force);
        for (int k = 0; k < SCENE_COORDINATES; k++)
            sum = lanes_fma(force[k], d[k], sum);
    }
    return sum;
}

#endif
