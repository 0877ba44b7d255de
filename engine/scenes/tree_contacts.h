/* tree_contacts.h - contacts of a tree: points, discs, soles, capsules, stops of joints. See
 * tree_lanes.h, which includes this.
 *
 * A disc's friction acts at its lowest point: its row is the centre's and its radius times the rate
 * of its body. A sole's acts at its lower end; with both on the ground the rows are the same. The
 * ends of a capsule are discs that share their friction as those of a sole. A stop is a row of its
 * joint, without friction.
 *
 * Where the coefficient of friction is k times the ground's, tangential velocities here are k times
 * the true ones and forces one k-th, so that power is what it is: |r_T| <= k mu r_N becomes
 * |r_T / k| <= mu r_N, and every law of contact holds with the ground's mu. */
#ifndef STANCE_SCENES_TREE_CONTACTS_H
#define STANCE_SCENES_TREE_CONTACTS_H

HOT lanes tree_roughly(const scene_body *b, int c, lanes tangential)
{
    if (tree_rough[c])
        return b->rough[c] * tangential;
    return tangential;
}

/* The true slip, of a tangential velocity or way. */
HOT lanes scene_slip(const scene_body *b, int c, lanes tangential)
{
    if (tree_rough[c])
        return tangential / b->rough[c];
    return tangential;
}

/* x[direction] = J^-1 H_c^T e_direction for normal (0) and tangential (1) impulses at contact c. */
HOT void scene_contact_response(const scene_body *b, const scene_matrix *m, bool coupled,
                                const scene_trig *trig, int c, lanes x[2][SCENE_COORDINATES])
{
    for (int direction = 0; direction < 2; direction++) {
        lanes load[SCENE_COORDINATES];
        for (int k = 0; k < SCENE_COORDINATES; k++)
            load[k] = lanes_of(0);
        if (direction == 1 && scene_grip[c] != c) {
            for (int k = 0; k < SCENE_COORDINATES; k++)
                x[1][k] = lanes_of(0);
            continue;
        }
        if (tree_is_stop(c)) {
            tree_drive(tree_body[c], lanes_of(tree_sign(c)), load);
        } else {
            const lanes unit[2] = {lanes_of(direction == 1), lanes_of(direction == 0)};
            if (tree_free)
                load[0] = unit[0], load[1] = unit[1];
            else if (tree_rail)
                load[0] = b->rail[1 - direction];
            TREE_UNROLL
            for (int j = 0; j < tree_angles; j++) {
                if (tree_path[c][j] < 0)
                    continue;
                lanes reach[2];
                tree_reach(b, trig, c, j, direction == 1, reach);
                load[TREE_BASE + j] = direction == 0 ? reach[0] : -reach[1];
                if (direction == 1 && tree_kind[c] == STANCE_TREE_DISC &&
                    tree_path[c][j] == TREE_OWN)
                    load[TREE_BASE + j] = load[TREE_BASE + j] + b->end[c][2];
            }
        }
        for (int k = 0; k < SCENE_COORDINATES && direction == 1; k++)
            load[k] = tree_roughly(b, c, load[k]);
        tree_solve(m, tree_loads[c], load, x[direction]);
        if (coupled)
            tree_answer(m, x[direction]);
    }
}

/* What the rates of the angles on its way do to the velocity of contact c, normal [0] and
 * tangential [1] (the true one, of a disc that of its centre); w: NULL, or H + lever dH/ds w, as of
 * angles that move by `lever` times a change of rates. Not of a stop. */
typedef struct scene_rows {
    lanes of[2][TREE_SLOTS(TREE_ANGLES)];
} scene_rows;
HOT void scene_contact_rows(const scene_body *b, const scene_trig *trig, int c, const lanes *w,
                            lanes lever, scene_rows *rows)
{
    lanes(*const H)[TREE_SLOTS(TREE_ANGLES)] = rows->of;
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        H[0][j] = H[1][j] = lanes_of(0);
        if (tree_is_stop(c) || tree_path[c][j] < 0)
            continue;
        lanes reach[2], grip[2];
        tree_reach(b, trig, c, j, false, reach);
        tree_reach(b, trig, c, j, true, grip);
        H[0][j] = reach[0], H[1][j] = -grip[1];
        if (w) {
            const lanes turn = lever * (tree_slides(j) ? tree_frame_rate(w, j) : w[TREE_BASE + j]);
            H[0][j] = lanes_fnma(turn, reach[1], H[0][j]);
            H[1][j] = lanes_fnma(turn, grip[0], H[1][j]);
        }
        if (w && tree_slides(j) && tree_above[j] >= 0) { /* E T (a' dl + l' da) */
            const lanes turn = lever * w[TREE_BASE + j];
            H[0][tree_above[j]] = lanes_fnma(turn, reach[1], H[0][tree_above[j]]);
            H[1][tree_above[j]] = lanes_fnma(turn, reach[0], H[1][tree_above[j]]);
        }
    }
}
/* Velocity of contact c with the rates w, by its rows: normal, tangential (of the grip; 0 at a
 * stop). */
HOT void scene_rows_velocity(const scene_body *b, int c, const scene_rows *rows, const lanes *w,
                             lanes u[2])
{
    if (tree_is_stop(c)) {
        u[0] = tree_sign(c) * tree_joint(w, tree_body[c]);
        u[1] = lanes_of(0);
        return;
    }
    u[0] = tree_base(b, w, 1);
    u[1] = tree_base(b, w, 0);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        if (tree_path[c][j] < 0)
            continue;
        u[0] = lanes_fma(w[TREE_BASE + j], rows->of[0][j], u[0]);
        u[1] = lanes_fma(w[TREE_BASE + j], rows->of[1][j], u[1]);
        if (tree_kind[c] == STANCE_TREE_DISC && tree_path[c][j] == TREE_OWN)
            u[1] = lanes_fma(w[TREE_BASE + j], b->end[c][2], u[1]);
    }
    u[1] = tree_roughly(b, c, u[1]);
}
HOT void scene_contact_velocity(const scene_body *b, const scene_trig *trig, int c, const lanes *w,
                                lanes u[2])
{
    scene_rows rows;
    scene_contact_rows(b, trig, c, NULL, lanes_of(0), &rows);
    scene_rows_velocity(b, c, &rows, w, u);
}

/* Acceleration of contact c (normal, tangential) when the coordinates do not accelerate. */
HOT void scene_contact_curvature(const scene_body *b, const scene_trig *trig, int c, const lanes *w,
                                 lanes a[2])
{
    a[0] = a[1] = lanes_of(0);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        if (tree_is_stop(c) || tree_path[c][j] < 0)
            continue;
        lanes reach[2], grip[2];
        const lanes turning = tree_centrifugal(w, j);
        tree_reach(b, trig, c, j, false, reach);
        tree_reach(b, trig, c, j, true, grip);
        a[0] = lanes_fnma(turning, reach[1], a[0]);
        a[1] = lanes_fnma(turning, grip[0], a[1]);
    }
    a[1] = tree_roughly(b, c, a[1]);
}

/* Where a contact is along an axis of the ground: 0 along it, 1 normal to it. */
HOT lanes tree_place(const scene_body *b, const lanes *s, const scene_trig *trig, int c, int axis)
{
    lanes place = tree_base(b, s, axis);
    if (tree_top[c] >= 0)
        place = place + (tree_top[c] == TREE_OWN ? b->end[c][axis] : b->joint[tree_top[c]][axis]);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        if (tree_path[c][j] < 0)
            continue;
        if (tree_slides(j)) { /* in the arms of its frame, if there is one */
            if (tree_above[j] < 0)
                place = lanes_fma(trig->sine[j], b->joint[j][axis], place);
            continue;
        }
        lanes reach[2];
        tree_reach(b, trig, c, j, false, reach);
        place = place + reach[axis];
    }
    return place;
}
HOT lanes scene_gap(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    if (tree_is_stop(c))
        return tree_sign(c) * (tree_joint(s, tree_body[c]) - b->end[c][0]);
    lanes gap = tree_place(b, s, trig, c, 1);
    if (tree_kind[c] == STANCE_TREE_DISC)
        gap = gap - b->end[c][2];
    if (tree_plates > 0)
        gap = gap - b->floor[c];
    return gap;
}
/* Where it is along the ground, m; no stop. */
HOT lanes scene_along(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    return tree_place(b, s, trig, c, 0);
}
/* Gap after a small displacement d of s, to second order. */
HOT lanes scene_gap_change(const scene_body *b, const scene_trig *trig, int c, const lanes *d)
{
    if (tree_is_stop(c))
        return tree_sign(c) * tree_joint(d, tree_body[c]);
    lanes sum = tree_base(b, d, 1);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        if (tree_path[c][j] < 0)
            continue;
        lanes reach[2];
        const lanes a = d[TREE_BASE + j];
        lanes turned = 0.5 * a;
        if (tree_slides(j))
            turned = tree_frame_rate(d, j);
        tree_reach(b, trig, c, j, false, reach);
        sum = lanes_fma(a, lanes_fnma(turned, reach[1], reach[0]), sum);
    }
    return sum;
}
/* Bound on what scene_gap_change leaves out. */
HOT lanes scene_gap_change_error(const scene_body *b, const scene_trig *trig, int c, const lanes *d)
{
    lanes sum = lanes_of(0);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        const int through = tree_path[c][j];
        if (tree_is_stop(c) || through < 0)
            continue;
        const lanes a = lanes_abs(d[TREE_BASE + j]);
        if (tree_slides(j)) { /* |e| of its frame is longer by |l|, and E T turns on */
            const lanes turned = lanes_abs(tree_frame_rate(d, j));
            const lanes more = lanes_fma(lanes_abs(trig->sine[j]), turned, a);
            sum = lanes_fma(turned * turned, more, sum);
            continue;
        }
        const lanes *const arm = through == TREE_OWN ? b->end[c] : b->joint[through];
        sum = lanes_fma(lanes_abs(arm[0]) + lanes_abs(arm[1]), a * a * a, sum);
    }
    return sum;
}

#endif
