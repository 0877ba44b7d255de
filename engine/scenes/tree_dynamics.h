/* tree_dynamics.h - inertia and forces of a tree, and the step's matrix: part of tree_lanes.h. */
#ifndef STANCE_SCENES_TREE_DYNAMICS_H
#define STANCE_SCENES_TREE_DYNAMICS_H

/* k of an angle, or kappa of a joint that slides, in its frame; `straight`: it has no x. */
HOT bool tree_first(const scene_body *b, const scene_trig *trig, int i, lanes first[2])
{
    const int frame = tree_slides(i) ? tree_above[i] : i;
    bool straight = tree_straight[i];
    first[0] = b->moment[i][0], first[1] = b->moment[i][1];
    TREE_UNROLL
    for (int k = 0; k < tree_slide_count; k++) {
        const int j = tree_sliding[k];
        const bool beyond = j == i || tree_through[j][i] >= 0;
        if (tree_above[j] != frame || !(beyond || tree_through[i][j] >= 0))
            continue;
        const lanes moved = b->inertia[beyond ? j : i] * trig->sine[j];
        straight = straight && tree_straight_joint[j];
        for (int axis = 0; axis < 2; axis++)
            first[axis] = lanes_fma(moved, b->joint[j][axis], first[axis]);
    }
    return straight;
}
/* K_i. */
HOT void tree_moment(const scene_body *b, const scene_trig *trig, int i, lanes K[2])
{
    lanes k[2];
    if (tree_slides(i)) {
        tree_slide_arm(b, trig, i, k);
        K[0] = b->inertia[i] * k[0], K[1] = b->inertia[i] * k[1];
        return;
    }
    const bool straight = tree_first(b, trig, i, k);
    tree_turn(straight, trig->sine[i], trig->cosine[i], k, K);
}
/* I_i. */
HOT lanes tree_inertia(const scene_body *b, const scene_trig *trig, int i)
{
    lanes sum = b->inertia[i];
    TREE_UNROLL
    for (int k = 0; k < tree_slide_count; k++) {
        const int j = tree_sliding[k];
        lanes kappa[2];
        if (tree_above[j] != i)
            continue;
        tree_first(b, trig, j, kappa);
        for (int axis = 0; axis < 2; axis++)
            sum =
                lanes_fma(trig->sine[j] * b->joint[j][axis], b->moment[j][axis] + kappa[axis], sum);
    }
    return sum;
}
/* C_ji and S_ji; K: that of i. */
HOT void tree_couple(const scene_body *b, const scene_trig *trig, int j, int i, const lanes K[2],
                     lanes *C, lanes *S)
{
    const int through = tree_through[i][j];
    lanes D[2];
    if (tree_slides(i) && tree_above[i] == j) {
        const bool straight = tree_first(b, trig, i, D) && tree_straight_joint[i];
        const lanes *const t = b->joint[i];
        *C = lanes_of(0);
        *S = -(D[1] * t[1]);
        if (!straight) {
            *C = lanes_fms(D[0], t[1], D[1] * t[0]);
            *S = -lanes_fma(D[0], t[0], D[1] * t[1]);
        }
        return;
    }
    if (tree_slides(j))
        tree_slide_arm(b, trig, j, D);
    else
        tree_arm(b, trig, tree_straight_joint[through], b->joint[through], j, tree_through[i], D);
    *C = lanes_fma(D[0], K[0], D[1] * K[1]);
    *S = lanes_fms(D[0], K[1], D[1] * K[0]);
}
/* a_i'^2, or N_i of a joint that slides. */
HOT lanes tree_centrifugal(const lanes *w, int i)
{
    const lanes rate = w[TREE_BASE + i];
    if (tree_slides(i))
        return 2 * (tree_frame_rate(w, i) * rate);
    return rate * rate;
}

/* A vector in the plane along the base's coordinates, added to x with a factor. */
HOT void tree_base_add(const scene_body *b, lanes factor, const lanes v[2], lanes *x)
{
    if (tree_free) {
        x[0] = lanes_fma(factor, v[0], x[0]);
        x[1] = lanes_fma(factor, v[1], x[1]);
    } else if (tree_rail) {
        x[0] = lanes_fma(factor, lanes_fma(b->rail[0], v[0], b->rail[1] * v[1]), x[0]);
    }
}
/* Component `axis` of the motion x of the base. */
HOT lanes tree_base(const scene_body *b, const lanes *x, int axis)
{
    if (tree_free)
        return x[axis]; // NOLINT: responses are set, which clang loses sight of in lagrange.c
    if (tree_rail)
        return b->rail[axis] * x[0];
    return lanes_of(0);
}

/* Adds a torque (or a force on the rail) in joint i with a factor. */
HOT void tree_drive(int i, lanes torque, lanes *x)
{
    const int at = i < 0 ? 0 : TREE_BASE + i;
    x[at] = x[at] + torque;
    if (i >= 0 && tree_against(i) >= 0)
        x[TREE_BASE + tree_against(i)] = x[TREE_BASE + tree_against(i)] - torque;
}

#include "engine/scenes/tree_pushes.h"

/* Torques of actuators, springs and dampers at place s with rates w, times h, taken from x. */
HOT void tree_resist(const scene_body *b, lanes h, const lanes *s, const lanes *w,
                     const lanes *torque, lanes *x)
{
    TREE_UNROLL
    for (int i = 0; i < tree_actuators; i++)
        tree_drive(tree_actuator[i], -(h * torque[i]), x);
    TREE_UNROLL
    for (int k = 0; k < tree_springs; k++) {
        const int i = tree_spring[k];
        const lanes bent = tree_joint(s, i) - b->spring[k][2];
        const lanes pull = lanes_fma(b->spring[k][0], bent, b->spring[k][1] * tree_joint(w, i));
        tree_drive(i, h * pull, x);
    }
}

/* c + a b or, `less`, c - a b. */
HOT lanes tree_add(bool less, lanes a, lanes b, lanes c)
{
    if (less)
        return lanes_fnma(a, b, c);
    return lanes_fma(a, b, c);
}

/* A step's equation at a guess: over h, about the time t, at the place s with angles `trig` and
 * velocity w; change = velocity at the end minus velocity before the step. NULL: the forces alone,
 * whatever h is. */
typedef struct scene_guess {
    lanes h, t;
    const lanes *s;
    const scene_trig *trig;
    const lanes *w, *change;
} scene_guess;

/* residual = A(u) change - h (forces without contact). */
HOT void scene_residual(const scene_body *b, const scene_guess *at, const lanes *torque,
                        lanes *residual)
{
    const lanes h = at->h, *const w = at->w, *const change = at->change;
    const scene_trig *const trig = at->trig;
    const bool step = change != NULL; /* then forces count less */
    tree_pad(residual);
    lanes pull[2], sum[2] = {lanes_of(0), lanes_of(0)}, turned[TREE_SLOTS(TREE_ANGLES)];
    for (int axis = 0; axis < 2; axis++) {
        pull[axis] = b->gravity[axis];
        if (step)
            pull[axis] = lanes_fma(h, b->gravity[axis], tree_base(b, change, axis));
    }
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        lanes K[2];
        tree_moment(b, trig, i, K);
        turned[i] = tree_centrifugal(w, i);
        if (step)
            turned[i] = h * turned[i];
        for (int axis = 0; axis < 2; axis++)
            sum[axis] = tree_add(step, K[axis], turned[i], sum[axis]);
        if (!step) {
            residual[TREE_BASE + i] = lanes_fms(K[1], pull[0], K[0] * pull[1]);
            continue;
        }
        const lanes c = change[TREE_BASE + i];
        sum[0] = lanes_fnma(K[1], c, sum[0]);
        sum[1] = lanes_fma(K[0], c, sum[1]);
        residual[TREE_BASE + i] =
            lanes_fma(tree_inertia(b, trig, i), c, lanes_fms(K[0], pull[1], K[1] * pull[0]));
    }
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        TREE_UNROLL
        for (int j = 0; j < i; j++) {
            if (!tree_coupled[i][j])
                continue;
            lanes K[2], C, S;
            tree_moment(b, trig, i, K);
            tree_couple(b, trig, j, i, K, &C, &S);
            lanes *const ri = &residual[TREE_BASE + i], *const rj = &residual[TREE_BASE + j];
            *ri = tree_add(!step, S, turned[j], *ri);
            *rj = tree_add(step, S, turned[i], *rj);
            if (!step)
                continue;
            *ri = lanes_fma(C, change[TREE_BASE + j], *ri);
            *rj = lanes_fma(C, change[TREE_BASE + i], *rj);
        }
    }
    TREE_UNROLL
    for (int k = 0; k < tree_rotors && step; k++) {
        const int i = tree_rotor[k];
        lanes *const ri = &residual[TREE_BASE + (i < 0 ? 0 : i)];
        if (i >= 0 && tree_slides(i)) {
            *ri = lanes_fma(b->rotor[k], change[TREE_BASE + i], *ri);
        } else if (i >= 0 &&
                   tree_above[i] >= 0) { /* its share of the diagonal is in the inertias */
            lanes *const rj = &residual[TREE_BASE + tree_above[i]];
            *ri = lanes_fnma(b->rotor[k], change[TREE_BASE + tree_above[i]], *ri);
            *rj = lanes_fnma(b->rotor[k], change[TREE_BASE + i], *rj);
        }
    }
    if (tree_free) {
        for (int axis = 0; axis < 2; axis++)
            residual[axis] = tree_add(!step, b->mass, pull[axis], sum[axis]);
    } else if (tree_rail) {
        lanes along = lanes_fma(b->rail[0], b->lift[0], b->rail[1] * b->lift[1]);
        if (step)
            along = lanes_fma(h, along, change[0]);
        residual[0] =
            tree_add(!step, b->mass, along, lanes_fma(b->rail[0], sum[0], b->rail[1] * sum[1]));
    }
    tree_resist(b, step ? h : lanes_of(-1), at->s, w, torque, residual);
    TREE_UNROLL
    for (int p = 0; p < tree_pushes; p++) {
        lanes force[2];
        tree_push_force(b, p, at->t, force);
        tree_push_add(b, trig, p, force, step ? -h : lanes_of(1), residual);
    }
}

/* R(a_j) times the arm; -E T of a joint that slides. `tangential`: of the row of friction, which a
 * sole has at its lower end. */
HOT void tree_reach(const scene_body *b, const scene_trig *trig, int c, int j, bool tangential,
                    lanes out[2])
{
    const int through = tree_path[c][j];
    if (tree_slides(j)) {
        tree_slide_arm(b, trig, j, out);
        return;
    }
    if (through != TREE_OWN) {
        tree_arm(b, trig, tree_straight_joint[through], b->joint[through], j, tree_path[c], out);
        return;
    }
    tree_arm(b, trig, tree_straight_end[c], b->end[c], j, tree_path[c], out);
    if (!tangential || scene_other[c] < 0 || scene_grip[c] != scene_grip[scene_other[c]])
        return;
    lanes other[2];
    tree_arm(b, trig, tree_straight_end[scene_other[c]], b->end[scene_other[c]], j, tree_path[c],
             other);
    /* Of ends that are level the first one; both contacts see the same. */
    const mask lower =
        scene_other[c] < c ? mask_less(out[1], other[1]) : mask_less_equal(out[1], other[1]);
    out[0] = choose(lower, out[0], other[0]);
    out[1] = choose(lower, out[1], other[1]);
}

HOT bool tree_is_stop(int c)
{
    return tree_kind[c] == STANCE_TREE_LOW || tree_kind[c] == STANCE_TREE_HIGH;
}
HOT double tree_sign(int c)
{
    return tree_kind[c] == STANCE_TREE_LOW ? 1 : -1;
}

/* May J_ik be something else than zero, k < i a coordinate? */
HOT bool tree_meets(int i, int k)
{
    return k < TREE_BASE ? k < tree_base_size : tree_near[i][k - TREE_BASE];
}

/* Eliminates the angles and inverts what is left of the base; m->row holds J_ij and J_ip, m->column
 * J_ji and J_pi, pivot J_ii, base J_pp. inertia, not NULL: J is its, symmetric, and m->row is not
 * yet set. */
HOT void tree_eliminate(const scene_body *inertia, lanes *pivot, lanes base[2][2], scene_matrix *m)
{
    TREE_UNROLL
    for (int i = tree_angles - 1; i >= 0; i--) {
        if (inertia && tree_alone[i])
            m->inverse[i] = inertia->inverse[i];
        else
            m->inverse[i] = 1 / pivot[i];
        lanes row[SCENE_COORDINATES];
        TREE_UNROLL
        for (int k = 0; k < TREE_BASE + i; k++)
            if (tree_meets(i, k)) {
                row[k] = m->inverse[i] * (inertia ? m->column[i][k] : m->row[i][k]);
                m->row[i][k] = row[k];
            }
        TREE_UNROLL
        for (int j = 0; j < i; j++) {
            if (!tree_near[i][j])
                continue;
            const lanes factor = m->column[i][TREE_BASE + j];
            pivot[j] = lanes_fnma(factor, row[TREE_BASE + j], pivot[j]);
            TREE_UNROLL
            for (int k = 0; k < TREE_BASE + j; k++)
                if (tree_meets(i, k)) {
                    if (!inertia)
                        m->row[j][k] = lanes_fnma(factor, row[k], m->row[j][k]);
                    m->column[j][k] =
                        lanes_fnma(m->column[i][k], row[TREE_BASE + j], m->column[j][k]);
                }
        }
        for (int j = 0; j < tree_base_size; j++)
            for (int k = 0; k < (inertia ? j + 1 : tree_base_size); k++)
                base[j][k] = lanes_fnma(m->column[i][j], row[k], base[j][k]);
    }
    if (tree_free) {
        if (inertia)
            base[0][1] = base[1][0];
        const lanes reciprocal = 1 / lanes_fms(base[0][0], base[1][1], base[0][1] * base[1][0]);
        m->base[0][0] = base[1][1] * reciprocal;
        m->base[0][1] = -base[0][1] * reciprocal;
        m->base[1][0] = -base[1][0] * reciprocal;
        m->base[1][1] = base[0][0] * reciprocal;
    } else if (tree_rail) {
        m->base[0][0] = 1 / base[0][0];
    }
}

/* x = J0^-1 b; path: NULL, or b is zero at angles j with path[j] < 0. */
HOT void tree_solve(const scene_matrix *m, const int *path, const lanes *b, lanes *x)
{
    lanes y[SCENE_COORDINATES];
    tree_pad(x);
    TREE_UNROLL
    for (int k = 0; k < SCENE_COORDINATES; k++)
        y[k] = b[k];
    TREE_UNROLL
    for (int i = tree_angles - 1; i >= 0; i--) {
        if (path && path[i] < 0)
            continue;
        y[TREE_BASE + i] = m->inverse[i] * y[TREE_BASE + i];
        TREE_UNROLL
        for (int k = 0; k < TREE_BASE + i; k++)
            if (tree_meets(i, k))
                y[k] = lanes_fnma(m->column[i][k], y[TREE_BASE + i], y[k]);
    }
    if (tree_free) {
        x[0] = lanes_fma(m->base[0][0], y[0], m->base[0][1] * y[1]);
        x[1] = lanes_fma(m->base[1][0], y[0], m->base[1][1] * y[1]);
    } else if (tree_rail) {
        x[0] = m->base[0][0] * y[0];
    }
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        lanes sum = path && path[i] < 0 ? lanes_of(0) : y[TREE_BASE + i];
        TREE_UNROLL
        for (int k = 0; k < TREE_BASE + i; k++)
            if (tree_meets(i, k))
                sum = lanes_fnma(m->row[i][k], x[k], sum);
        x[TREE_BASE + i] = sum;
    }
}

/* Inverse of a small matrix, by elimination with pivots of its columns. */
HOT void tree_invert(lanes a[TREE_SLOTS(TREE_ACTUATORS)][TREE_SLOTS(TREE_ACTUATORS)],
                     lanes inverse[TREE_SLOTS(TREE_ACTUATORS)][TREE_SLOTS(TREE_ACTUATORS)])
{
    const int N = tree_actuators;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            inverse[i][j] = lanes_of(i == j);
    for (int k = 0; k < N; k++) {
        for (int r = k + 1; r < N; r++) {
            const mask larger = mask_less(lanes_abs(a[k][k]), lanes_abs(a[r][k]));
            for (int j = 0; j < N; j++) {
                const lanes x = a[k][j], y = inverse[k][j];
                a[k][j] = choose(larger, a[r][j], x);
                a[r][j] = choose(larger, x, a[r][j]);
                inverse[k][j] = choose(larger, inverse[r][j], y);
                inverse[r][j] = choose(larger, y, inverse[r][j]);
            }
        }
        const lanes reciprocal = 1 / a[k][k];
        for (int j = 0; j < N; j++) {
            a[k][j] = a[k][j] * reciprocal;
            inverse[k][j] = inverse[k][j] * reciprocal;
        }
        for (int r = 0; r < N; r++) {
            if (r == k)
                continue;
            const lanes factor = a[r][k];
            for (int j = 0; j < N; j++) {
                a[r][j] = lanes_fnma(factor, a[k][j], a[r][j]);
                inverse[r][j] = lanes_fnma(factor, inverse[k][j], inverse[r][j]);
            }
        }
    }
}

/* What the law answers to the rates x: its torques' change. */
HOT void tree_gain(const scene_matrix *m, const lanes *x, lanes *torque)
{
    lanes rate[TREE_SLOTS(SCENE_POSTURE)];
    scene_posture(x, rate);
    for (int i = 0; i < tree_actuators; i++) {
        torque[i] = lanes_of(0);
        for (int j = 0; j < tree_postures; j++)
            torque[i] = lanes_fma(m->gain[i][j], rate[j], torque[i]);
    }
}

/* J = J0 - h B G: (J0 - h B G)^-1 = J0^-1 + Y (1 - G Y)^-1 G J0^-1 with Y = J0^-1 h B. */
HOT void
tree_close_loop(lanes h,
                const lanes torque_rate[TREE_SLOTS(TREE_ACTUATORS)][TREE_SLOTS(SCENE_POSTURE)],
                scene_matrix *m)
{
    lanes open[TREE_SLOTS(TREE_ACTUATORS)][TREE_SLOTS(TREE_ACTUATORS)];
    for (int i = 0; i < tree_actuators; i++) {
        lanes load[SCENE_COORDINATES];
        for (int j = 0; j < tree_postures; j++)
            m->gain[i][j] = torque_rate[i][j];
        for (int k = 0; k < SCENE_COORDINATES; k++)
            load[k] = lanes_of(0);
        tree_drive(tree_actuator[i], h, load);
        tree_solve(m, NULL, load, m->answer[i]);
    }
    for (int j = 0; j < tree_actuators; j++) {
        lanes torque[TREE_SLOTS(TREE_ACTUATORS)];
        tree_gain(m, m->answer[j], torque);
        for (int i = 0; i < tree_actuators; i++)
            open[i][j] = lanes_of(i == j) - torque[i];
    }
    tree_invert(open, m->loop);
}
HOT void tree_answer(const scene_matrix *m, lanes *x)
{
    lanes torque[TREE_SLOTS(TREE_ACTUATORS)];
    tree_gain(m, x, torque);
    for (int i = 0; i < tree_actuators; i++) {
        lanes answer = lanes_of(0);
        for (int j = 0; j < tree_actuators; j++)
            answer = lanes_fma(m->loop[i][j], torque[j], answer);
        for (int k = 0; k < SCENE_COORDINATES; k++)
            x[k] = lanes_fma(m->answer[i][k], answer, x[k]);
    }
}

/* x = J^-1 b. */
HOT void scene_solve(const scene_matrix *m, bool coupled, const lanes *b, lanes *x)
{
    tree_solve(m, NULL, b, x);
    if (coupled)
        tree_answer(m, x);
}

/* Where the columns of angles have more for the joints that slide in their frames, and rows and
 * columns what is bent. */
HOT void tree_factor_slides(const scene_body *b, const scene_guess *at, lanes twice, lanes lever,
                            const lanes *bend, lanes *pivot, scene_matrix *m)
{
    const scene_trig *const trig = at->trig;
    const lanes h = at->h, *const w = at->w, *const change = at->change;
    lanes rush[TREE_SLOTS(TREE_ANGLES)], twist[TREE_SLOTS(TREE_ANGLES)];
    TREE_UNROLL
    for (int k = 0; k < tree_slide_count; k++) {
        const int i = tree_sliding[k], f = tree_above[i];
        if (f < 0)
            continue;
        lanes K[2];
        tree_moment(b, trig, i, K);
        rush[i] = lanes_fma(lever, change[TREE_BASE + i], twice * w[TREE_BASE + i]);
        twist[i] = lever * (h * tree_centrifugal(w, i));
        const lanes column[2] = {lanes_fms(K[1], twist[i], K[0] * rush[i]),
                                 lanes_fnma(K[0], twist[i], -(K[1] * rush[i]))};
        if (tree_free) {
            for (int axis = 0; axis < 2; axis++)
                m->column[f][axis] = m->column[f][axis] + column[axis];
        } else if (tree_rail) {
            m->column[f][0] =
                lanes_fma(b->rail[0], column[0], lanes_fma(b->rail[1], column[1], m->column[f][0]));
        }
        m->row[i][TREE_BASE + f] = m->row[i][TREE_BASE + f] + bend[i];
        m->column[i][TREE_BASE + f] =
            lanes_fma(b->inertia[i], twist[i], m->column[i][TREE_BASE + f] + bend[i]);
    }
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        TREE_UNROLL
        for (int j = 0; j < i; j++) {
            const int f = tree_above[i], g = tree_above[j];
            if (!tree_coupled[i][j] || !(tree_slides(i) || tree_slides(j)))
                continue;
            lanes K[2], C, S;
            tree_moment(b, trig, i, K);
            tree_couple(b, trig, j, i, K, &C, &S);
            if (tree_slides(j) && g >= 0) {
                lanes *const entry = &m->row[i][TREE_BASE + g];
                *entry = lanes_fma(S, rush[j], lanes_fnma(C, twist[j], *entry));
            }
            if (tree_slides(i) && f >= 0) {
                lanes *const entry = j == f  ? &pivot[f]
                                     : j > f ? &m->row[j][TREE_BASE + f]
                                             : &m->column[f][TREE_BASE + j];
                *entry = lanes_fnma(S, rush[i], lanes_fnma(C, twist[i], *entry));
            }
        }
    }
}

/* How a step's equation answers: d(evaluation velocity)/d(velocity) = the method's theta;
 * d(evaluation angle)/d(velocity), s; the same for the angles that the contact directions are taken
 * at, with the angles there and the impulses r[contact][2] of the last iterate; and
 * torque_rate[i][j] = d torque_i / d(rate of posture j) in all, of a law that acts inside the step.
 */
typedef struct scene_slopes {
    double rate;
    lanes lever, contact_lever;
    const scene_trig *contact_trig;
    const lanes (*r)[2];
    const lanes (*torque_rate)[TREE_SLOTS(SCENE_POSTURE)];
} scene_slopes;

/* Factors J = d residual / d velocity; `coupled`: a law acts inside the step. */
HOT void scene_factor(const scene_body *b, const scene_guess *at, const scene_slopes *by,
                      bool coupled, scene_matrix *m)
{
    const scene_trig *const trig = at->trig;
    const lanes h = at->h, lever = by->lever, *const w = at->w, *const change = at->change;
    const lanes twice = 2 * by->rate * h;
    lanes pivot[TREE_SLOTS(TREE_ANGLES)], along[TREE_SLOTS(TREE_ANGLES)],
        across[TREE_SLOTS(TREE_ANGLES)], bend[TREE_SLOTS(TREE_ANGLES)], pull[2], base[2][2];
    for (int axis = 0; axis < 2; axis++)
        pull[axis] = lanes_fma(h, b->gravity[axis], tree_base(b, change, axis));
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        lanes K[2];
        const lanes turning = w[TREE_BASE + i];
        tree_moment(b, trig, i, K);
        along[i] = lanes_fnma(lever * h, turning * turning, lanes_of(1));
        across[i] = lanes_fma(lever, change[TREE_BASE + i], twice * turning);
        if (tree_slides(i)) {
            along[i] = tree_above[i] < 0 ? lanes_of(1) : along[tree_above[i]];
            across[i] = tree_above[i] < 0 ? lanes_of(0) : across[tree_above[i]];
        }
        const lanes row[2] = {-K[1], K[0]};
        const lanes column[2] = {lanes_fnma(K[1], along[i], -(K[0] * across[i])),
                                 lanes_fms(K[0], along[i], K[1] * across[i])};
        if (tree_free) {
            for (int axis = 0; axis < 2; axis++)
                m->row[i][axis] = row[axis], m->column[i][axis] = column[axis];
        } else if (tree_rail) {
            m->row[i][0] = lanes_fma(b->rail[0], row[0], b->rail[1] * row[1]);
            m->column[i][0] = lanes_fma(b->rail[0], column[0], b->rail[1] * column[1]);
        }
        pivot[i] = lanes_fnma(lever, lanes_fma(K[0], pull[0], K[1] * pull[1]),
                              tree_slides(i) ? lanes_of(0) : tree_inertia(b, trig, i));
        if (tree_slides(i))
            bend[i] = pivot[i], pivot[i] = b->inertia[i] * along[i];
        TREE_UNROLL
        for (int j = 0; j < i; j++)
            if (tree_near[i][j])
                m->row[i][TREE_BASE + j] = m->column[i][TREE_BASE + j] = lanes_of(0);
    }
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        TREE_UNROLL
        for (int j = 0; j < i; j++) {
            if (!tree_coupled[i][j])
                continue;
            lanes K[2], C, S;
            lanes *const bi = tree_slides(i) ? &bend[i] : &pivot[i];
            lanes *const bj = tree_slides(j) ? &bend[j] : &pivot[j];
            tree_moment(b, trig, i, K);
            tree_couple(b, trig, j, i, K, &C, &S);
            m->row[i][TREE_BASE + j] = lanes_fma(C, along[j], S * across[j]);
            m->column[i][TREE_BASE + j] = lanes_fms(C, along[i], S * across[i]);
            *bi = lanes_fma(
                lever, lanes_fms(C, h * tree_centrifugal(w, j), S * change[TREE_BASE + j]), *bi);
            *bj = lanes_fma(
                lever, lanes_fma(C, h * tree_centrifugal(w, i), S * change[TREE_BASE + i]), *bj);
        }
    }
    TREE_UNROLL
    for (int c = 0; c < tree_contacts; c++) {
        if (tree_is_stop(c))
            continue;
        TREE_UNROLL
        for (int j = 0; j < tree_angles; j++) {
            if (tree_path[c][j] < 0)
                continue;
            lanes reach[2], grip[2];
            tree_reach(b, by->contact_trig, c, j, false, reach);
            tree_reach(b, by->contact_trig, c, j, true, grip);
            lanes turned = reach[1] * by->r[c][0];
            if (scene_grip[c] == c)
                turned = lanes_fma(grip[0], by->r[c][1], turned);
            lanes *const bj = tree_slides(j) ? &bend[j] : &pivot[j];
            *bj = lanes_fma(by->contact_lever, turned, *bj);
        }
    }
    for (int j = 0; j < 2; j++)
        for (int k = 0; k < 2; k++)
            base[j][k] = j == k ? b->mass : lanes_of(0);
    TREE_UNROLL
    for (int k = 0; k < tree_rotors; k++) {
        const int i = tree_rotor[k];
        if (i >= 0 && tree_slides(i)) {
            pivot[i] = pivot[i] + b->rotor[k];
        } else if (i >= 0 && tree_above[i] >= 0) {
            lanes *const row = &m->row[i][TREE_BASE + tree_above[i]];
            lanes *const column = &m->column[i][TREE_BASE + tree_above[i]];
            *row = *row - b->rotor[k], *column = *column - b->rotor[k];
        }
    }
    TREE_UNROLL
    for (int k = 0; k < tree_springs; k++) {
        const int i = tree_spring[k];
        const lanes stiff = h * lanes_fma(b->spring[k][0], lever, b->spring[k][1] * by->rate);
        if (i < 0) {
            base[0][0] = base[0][0] + stiff;
            continue;
        }
        pivot[i] = pivot[i] + stiff;
        if (tree_against(i) >= 0) {
            lanes *const row = &m->row[i][TREE_BASE + tree_above[i]];
            lanes *const column = &m->column[i][TREE_BASE + tree_above[i]];
            pivot[tree_above[i]] = pivot[tree_above[i]] + stiff;
            *row = *row - stiff, *column = *column - stiff;
        }
    }
    TREE_UNROLL
    for (int p = 0; p < tree_pushes; p++) {
        TREE_UNROLL
        for (int j = 0; j < tree_angles; j++) {
            lanes reach[2];
            if (tree_push_path[p][j] < 0 || tree_push_swings[p]) /* Newton does without */
                continue;
            tree_push_reach(b, trig, p, j, reach);
            const lanes turned = lanes_fma(reach[0], b->pull[p][0], reach[1] * b->pull[p][1]);
            lanes *const bj = tree_slides(j) ? &bend[j] : &pivot[j];
            *bj = lanes_fma(lever * h, turned, *bj);
        }
    }
    if (tree_slide_count > 0)
        tree_factor_slides(b, at, twice, lever, bend, pivot, m);
    tree_eliminate(NULL, pivot, base, m);
    if (coupled)
        tree_close_loop(h, by->torque_rate, m);
}

/* J = A, the inertia alone. */
HOT void scene_inertia(const scene_body *b, const scene_trig *trig, scene_matrix *m)
{
    lanes pivot[TREE_SLOTS(TREE_ANGLES)], base[2][2];
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        lanes K[2];
        tree_moment(b, trig, i, K);
        if (tree_free) {
            m->column[i][0] = -K[1];
            m->column[i][1] = K[0];
        } else if (tree_rail) {
            m->column[i][0] = lanes_fms(b->rail[1], K[0], b->rail[0] * K[1]);
        }
        pivot[i] = tree_inertia(b, trig, i);
        TREE_UNROLL
        for (int j = 0; j < i; j++) {
            if (!tree_near[i][j])
                continue;
            lanes C = lanes_of(0), S;
            if (tree_coupled[i][j])
                tree_couple(b, trig, j, i, K, &C, &S);
            m->column[i][TREE_BASE + j] = C;
        }
    }
    TREE_UNROLL
    for (int k = 0; k < tree_rotors; k++) {
        const int i = tree_rotor[k];
        if (i >= 0 && tree_slides(i)) {
            pivot[i] = pivot[i] + b->rotor[k];
        } else if (i >= 0 && tree_above[i] >= 0) {
            lanes *const column = &m->column[i][TREE_BASE + tree_above[i]];
            *column = *column - b->rotor[k];
        }
    }
    for (int j = 0; j < 2; j++)
        for (int k = 0; k < 2; k++)
            base[j][k] = j == k ? b->mass : lanes_of(0);
    tree_eliminate(b, pivot, base, m);
}

/* x = A^-1 B e_i for a unit of torque i, of m from scene_inertia. */
HOT void scene_actuator_response(const scene_matrix *m, int i, lanes *x)
{
    lanes load[SCENE_COORDINATES];
    for (int k = 0; k < SCENE_COORDINATES; k++)
        load[k] = lanes_of(0);
    tree_drive(tree_actuator[i], lanes_of(1), load);
    tree_solve(m, NULL, load, x);
}

#endif
