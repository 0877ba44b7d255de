/* tree_lanes.h - the algebra of any planar tree of rigid bodies for the stepping core, one robot in
 * each lane.
 *
 * Inside, the coordinates are s = (p, a_1 ... a_n): the place of the base and the absolute angles
 * of the bodies that turn, in the ground's axes (x along it, z normal to it; a slope turns
 * gravity). Every material point is p + sum R(a_j) e_j over its path from the root, a sum of
 * functions of one angle each. With R' = E R, E (x, z) = (-z, x), and
 *
 *   M, k_i, I_i   mass of all; first and second moment of body i about its joint, with what hangs
 *                 beyond lumped at its joints,
 *   d_ji          where in frame j the joint is through which i hangs (j above i),
 *   K_i = R(a_i) k_i,   D_ji = R(a_j) d_ji,   C_ji = D_ji . K_i,   S_ji = (E D_ji) . K_i
 *
 * Lagrange's equations are, g minus gravity,
 *
 *   row p:  M (p'' + g) + sum_i ( E K_i a_i'' - K_i a_i'^2 ) = F
 *   row i:  I_i a_i'' + (E K_i).(p'' + g) + sum_{j above i} ( C_ji a_j'' + S_ji a_j'^2 )
 *                                         + sum_{l below i} ( C_il a_l'' - S_il a_l'^2 ) = tau_i,
 *
 * without products of different rates (kinetic energy M p'^2/2 + sum I a'^2/2 + a' (E K).p' +
 * sum C_ji a_j' a_i'). The derivative of a step's equation P = A(u) (w - w0) - h F(u, v) - H^T r by
 * w, with v = (1 - theta) w0 + theta w, u = s0 + h theta v, lever = h theta^2, c = w - w0,
 * along_i = 1 - lever h v_i^2, across_i = lever c_i + 2 theta h v_i, is
 *
 *   J_pp = M,   J_ip = (E K_i)^T,   J_pi = E K_i along_i - K_i across_i,
 *   J_ij = C along_j + S across_j,   J_ji = C along_i - S across_i            (j above i),
 *   J_ii = I_i - lever K_i.(c_p + h g) + lever ( sum_{j above} (C h v_j^2 - S c_j)
 *          + sum_{l below} (C h v_l^2 + S c_l) ) + contact lever sum over contacts (R e_i).f:
 *
 * directions of contacts only touch the diagonal, which is why the angles are absolute.
 *
 * A joint i that slides, by l_i along t_i in frame f and without turning against it, has l_i for
 * its coordinate and moves what hangs beyond, of mass m_i, by T_i = R(a_f) t_i. With
 *
 *   k_f = k_f0 + sum_{i in f} m_i l_i t_i,   d_fl = d_fl0 + sum_{i in f, above l} l_i t_i,
 *   kappa_i = kappa_i0 + sum_{j in f} m_ij l_j t_j   (m_ij: the mass that both move)   the first
 *       moment about the origin of f of what it moves,   I_f = I_f0 + sum_i l_i t_i.(kappa_i0 +
 *       kappa_i)
 *
 * such a joint is in all equations above as an angle with
 *
 *   K_i = -m_i E T_i,   D_il = -E T_i,   I_i = m_i,   C_fi = kappa_i x t_i,   S_fi = -kappa_i.t_i,
 *   a_i'^2 replaced by N_i = 2 a_f' l_i', of Coriolis:
 *
 * what it moves gets -E K_i/m_i and E N_i of accelerations. In the derivative along_i and across_i
 * are those of f (1 and 0 where the base does not turn), and what follows from d2P/da_f dl_i = E
 * T_i instead of d2P/da^2 = -R e stands off the diagonal: what the sum J_ii has above for angles,
 *
 *   bend_i = lever ( -K_i.(c_p + h g) + sum_{j above} (C h N_j - S c_j) + sum_{l below} (C h N_l +
 *            S c_l) ) + contact lever sum over contacts (-E T_i).f,
 *
 * is added to J_if, and with lever m_i h N_i to J_fi, while J_ii = m_i along_f. Besides, with
 * rush_i = lever c_i + 2 theta h l_i', twist_i = lever h N_i, the column of a_f has
 *
 *   J_pf += -K_i rush_i - E K_i twist_i,   J_jf += -S_ji rush_i - C_ji twist_i   (j above i),
 *   J_lf += S_il rush_i - C_il twist_i     (l below i).
 *
 * Forces of a joint that slides act on l_i alone. Nothing fills in, as f and what hangs beyond are
 * coupled anyway.
 *
 * A spring
 * and damper of a hinge adds h (lever' k + theta d) [1 -1; -1 1], a geared rotor [1 -1; -1 1] times
 * its inertia. J is eliminated from the leaves to the root, the base last: A_ij is not zero only
 * along a branch, and what hangs on a body couples its ancestors already, so nothing fills in. A
 * law that acts inside the step adds -h B G of the rank of its actuators (Woodbury).
 *
 * What is structure comes as tables of integers (engine/tree.h), that the compiler folds; the
 * numbers are lanes. Sources: R. Featherstone, Rigid Body Dynamics Algorithms (2008), 6.4 for the
 * elimination; the rest is derived above.
 */
#ifndef STANCE_SCENES_TREE_LANES_H
#define STANCE_SCENES_TREE_LANES_H

#include "engine/core/lanes/lanes.h"
#include "engine/core/lanes/sincos.h"
#include "engine/stance.h"
#include "engine/tree.h"

enum {
    SCENE_COORDINATES = TREE_BASE + TREE_ANGLES,
    SCENE_CONTACTS = TREE_CONTACTS,
    SCENE_ACTUATORS = TREE_ACTUATORS,
    SCENE_ANGLES = TREE_ANGLES,
    TREE_OWN = STANCE_TREE_OWN,
#ifndef TREE_RUNTIME
    SCENE_POSTURE = TREE_ANGLES + (TREE_BASE == 1),
    /* The structure: here constants, see runtime_lanes.h. */
    tree_base_size = TREE_BASE,
    tree_angles = TREE_ANGLES,
    tree_contacts = TREE_CONTACTS,
    tree_actuators = TREE_ACTUATORS,
    tree_springs = TREE_SPRINGS,
    tree_rotors = TREE_ROTORS,
    tree_points = TREE_POINTS,
    tree_turns = TREE_TURNS,
    tree_pushes = TREE_PUSHES,
    tree_slide_count = TREE_SLIDES,
    tree_plates = TREE_PLATES,
#endif
    /* What lies on the ground's plates: contacts, then the points that may fall. */
    SCENE_PLACES = TREE_PLATES ? TREE_SLOTS(TREE_CONTACTS) + TREE_POINTS : 1,
};
#define tree_free (tree_base_size == 2)
#define tree_rail (tree_base_size == 1)
#define tree_postures (tree_rail + tree_angles)
/* Torques may drive as many coordinates: see core/mode/decoupling.h. */
#if TREE_SERVOS
#define SCENE_SERVOS
#endif
#define SCENE_SLIDES(a) tree_slides(a)
#define SCENE_PUSHES TREE_PUSHES
#define SCENE_PLATES TREE_PLATES

#ifdef TREE_RUNTIME
#define TREE_UNROLL
#else
#define TREE_UNROLL _Pragma("GCC unroll 16")
#endif

/* stance_tree_numbers as lanes. */
typedef struct scene_body {
    lanes mass;
    lanes gravity[2];   /* minus gravity, m/s^2, in the ground's axes */
    lanes slope[3];     /* angle, sine, cosine */
    lanes lift[2];      /* the same as a rail feels it, which may have an armature */
    lanes rail[2];      /* its direction */
    lanes reference[2]; /* of the root's frame: what the user's x and z are of */
    lanes curvature[3]; /* see scene_curvature */
    lanes moment[TREE_SLOTS(TREE_ANGLES)][2]; /* k; of a slide kappa, both where l = 0 */
    lanes inertia[TREE_SLOTS(TREE_ANGLES)];   /* I, rotors included; of a slide the mass ... */
    lanes inverse[TREE_SLOTS(TREE_ANGLES)];   /* ... and 1 / that */
    lanes joint[TREE_SLOTS(TREE_ANGLES)][2];  /* of a body, in the frame above; a slide's axis */
    lanes rotor[TREE_SLOTS(TREE_ROTORS)];
    lanes spring[TREE_SLOTS(TREE_SPRINGS)][3]; /* stiffness, damping, angle at rest */
    lanes end[TREE_SLOTS(TREE_CONTACTS)][3];   /* place in its body, radius; of a stop: limit */
    lanes rough[TREE_SLOTS(TREE_CONTACTS)];    /* see tree_contacts.h */
    lanes point[TREE_SLOTS(TREE_POINTS)][2];   /* points that may fall, in their bodies ... */
    lanes lowest[TREE_SLOTS(TREE_POINTS)];     /* ... and how far, m */
    lanes turn[TREE_SLOTS(TREE_TURNS)][2];     /* rad, that a body may turn; its angle at 0 */
    lanes push[TREE_SLOTS(TREE_PUSHES)][7];    /* place in its frame; force or impulse; from, to;
                                                * frequency */
    lanes pull[TREE_SLOTS(TREE_PUSHES)][2];    /* N, in the present step: see scene_push */
    lanes floor[SCENE_PLACES];                 /* m, of what is under a place, see plates.h */
} scene_body;

/* Of a joint that slides the displacement in place of the sine. */
typedef struct scene_trig {
    lanes sine[TREE_SLOTS(TREE_ANGLES)], cosine[TREE_SLOTS(TREE_ANGLES)];
} scene_trig;

/* The step's matrix J, factored: J = L D U with unit U. */
typedef struct scene_matrix {
    lanes row[TREE_SLOTS(TREE_ANGLES)][SCENE_COORDINATES];    /* of U */
    lanes column[TREE_SLOTS(TREE_ANGLES)][SCENE_COORDINATES]; /* of L D */
    lanes inverse[TREE_SLOTS(TREE_ANGLES)];                   /* of D */
    lanes base[2][2];                                         /* inverse of what is left there */
    /* A law inside the step: J0^-1 h B, and what turns torques into those that it answers with. */
    lanes answer[TREE_SLOTS(TREE_ACTUATORS)][SCENE_COORDINATES];
    lanes gain[TREE_SLOTS(TREE_ACTUATORS)][TREE_SLOTS(SCENE_POSTURE)];
    lanes loop[TREE_SLOTS(TREE_ACTUATORS)][TREE_SLOTS(TREE_ACTUATORS)];
} scene_matrix;

/* A lane of an array of lanes from one of numbers. */
static inline void tree_load(lanes *v, int lane, const double *number, int n)
{
    for (int i = 0; i < n; i++)
        lane_set(&v[i], lane, number[i]);
}
static inline void scene_load_body(scene_body *b, int lane, const stance_tree_numbers *number)
{
#define LOAD(field)                                                                                \
    tree_load((lanes *)&b->field, lane, (const double *)&number->field,                            \
              (int)(sizeof b->field / sizeof(lanes)))
    LOAD(mass), LOAD(gravity), LOAD(slope), LOAD(lift), LOAD(rail), LOAD(reference);
    LOAD(curvature), LOAD(moment), LOAD(inertia), LOAD(inverse), LOAD(joint), LOAD(rotor),
        LOAD(spring);
    LOAD(end), LOAD(rough), LOAD(point), LOAD(lowest), LOAD(turn), LOAD(push);
#undef LOAD
    for (size_t i = 0; i < sizeof b->pull / sizeof(lanes); i++) /* not that of the case before */
        lane_set((lanes *)b->pull + i, lane, 0);
    for (int k = 0; k < SCENE_PLACES; k++)
        lane_set(&b->floor[k], lane, 0);
}

/* What the structure lacks of the room that there is: nothing, unless it is read at run time. */
HOT void tree_pad(lanes *x)
{
#ifdef TREE_RUNTIME
    for (int i = 0; i < SCENE_COORDINATES; i++)
        x[i] = lanes_of(0);
#else
    (void)x;
#endif
}
HOT void tree_pad_posture(lanes *x)
{
#ifdef TREE_RUNTIME
    for (int i = 0; i < SCENE_POSTURE; i++)
        x[i] = lanes_of(0);
#else
    (void)x;
#endif
}
HOT void tree_pad_trig(scene_trig *trig)
{
#ifdef TREE_RUNTIME
    for (int i = 0; i < SCENE_ANGLES; i++)
        trig->sine[i] = lanes_of(0), trig->cosine[i] = lanes_of(1);
#else
    (void)trig;
#endif
}

/* ---- coordinates ----------------------------------------------------------------------------- */

/* R(a) v with sines known; straight: v has no first component. */
HOT void tree_turn(bool straight, lanes sine, lanes cosine, const lanes v[2], lanes out[2])
{
    if (straight) {
        out[0] = -(sine * v[1]);
        out[1] = cosine * v[1];
        return;
    }
    out[0] = lanes_fms(cosine, v[0], sine * v[1]);
    out[1] = lanes_fma(sine, v[0], cosine * v[1]);
}

/* Does joint i slide? */
HOT bool tree_slides(int i)
{
    return TREE_SLIDES && tree_slide[i];
}
/* The angle that the coordinate of joint i is measured against, or -1. */
HOT int tree_against(int i)
{
    return tree_slides(i) ? -1 : tree_above[i];
}
/* Is the coordinate an angle against the ground's normal? */
HOT bool tree_upright(int i)
{
    return tree_above[i] < 0 && !tree_slides(i);
}
/* Angle or place of joint i (-1: the rail) in these absolute coordinates, or its rate. */
HOT lanes tree_joint(const lanes *s, int i)
{
    if (i < 0)
        return s[0];
    if (tree_against(i) < 0)
        return s[TREE_BASE + i];
    return s[TREE_BASE + i] - s[TREE_BASE + tree_against(i)];
}
/* The rate of the frame that joint i slides in. */
HOT lanes tree_frame_rate(const lanes *w, int i)
{
    return tree_above[i] < 0 ? lanes_of(0) : w[TREE_BASE + tree_above[i]];
}

/* T of joint i, which slides. */
HOT void tree_axis(const scene_body *b, const scene_trig *trig, int i, lanes T[2])
{
    const int j = tree_above[i];
    T[0] = b->joint[i][0], T[1] = b->joint[i][1];
    if (j >= 0)
        tree_turn(tree_straight_joint[i], trig->sine[j], trig->cosine[j], b->joint[i], T);
}
/* -E T of joint i: as which a slide is in a sum over the arms of angles. */
HOT void tree_slide_arm(const scene_body *b, const scene_trig *trig, int i, lanes out[2])
{
    lanes T[2];
    tree_axis(b, trig, i, T);
    out[0] = T[1], out[1] = -T[0];
}
/* R(a_j) times an arm of frame j that the joints of `row` lengthen which slide in it: those >= 0.
 */
HOT void tree_arm(const scene_body *b, const scene_trig *trig, bool straight, const lanes arm[2],
                  int j, const int *row, lanes out[2])
{
    lanes v[2] = {arm[0], arm[1]};
    TREE_UNROLL
    for (int k = 0; k < tree_slide_count; k++) {
        const int i = tree_sliding[k];
        if (tree_above[i] != j || row[i] < 0)
            continue;
        straight = straight && tree_straight_joint[i];
        for (int axis = 0; axis < 2; axis++)
            v[axis] = lanes_fma(trig->sine[i], b->joint[i][axis], v[axis]);
    }
    tree_turn(straight, trig->sine[j], trig->cosine[j], v, out);
}

/* The user's coordinates q = (x, z of the reference point, upright; the root's angle, upright;
 * relative angles) and rates to s, s', and back. */
static inline void scene_enter(const stance_tree_numbers *number, const double *q, const double *v,
                               double *s, double *w)
{
    const double *const slope = number->slope, *const reference = number->reference;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = i < tree_base_size ? q[i] : 0, w[i] = i < tree_base_size ? v[i] : 0;
    for (int i = 0; i < tree_angles; i++) {
        const int up = tree_against(i);
        s[TREE_BASE + i] = q[tree_base_size + i] + (tree_upright(i) ? slope[0]
                                                    : up < 0        ? 0
                                                                    : s[TREE_BASE + up]);
        w[TREE_BASE + i] = v[tree_base_size + i] + (up < 0 ? 0 : w[TREE_BASE + up]);
    }
    if (tree_free) {
        double sine, cosine;
        angle_sincos(s[TREE_BASE], &sine, &cosine);
        const double x = cosine * reference[0] - sine * reference[1];
        const double z = sine * reference[0] + cosine * reference[1];
        s[0] = slope[2] * q[0] - slope[1] * q[1] - x;
        s[1] = slope[1] * q[0] + slope[2] * q[1] - z;
        w[0] = slope[2] * v[0] - slope[1] * v[1] + z * w[TREE_BASE];
        w[1] = slope[1] * v[0] + slope[2] * v[1] - x * w[TREE_BASE];
    }
}
static inline void scene_leave(const stance_tree_numbers *number, const double *s, const double *w,
                               double *q, double *v)
{
    const double *const slope = number->slope, *const reference = number->reference;
    for (int i = 0; i < tree_base_size; i++)
        q[i] = s[i], v[i] = w[i];
    for (int i = 0; i < tree_angles; i++) {
        const int up = tree_against(i);
        q[tree_base_size + i] = s[TREE_BASE + i] - (tree_upright(i) ? slope[0]
                                                    : up < 0        ? 0
                                                                    : s[TREE_BASE + up]);
        v[tree_base_size + i] = w[TREE_BASE + i] - (up < 0 ? 0 : w[TREE_BASE + up]);
    }
    if (tree_free) {
        double sine, cosine;
        angle_sincos(s[TREE_BASE], &sine, &cosine);
        const double x = cosine * reference[0] - sine * reference[1];
        const double z = sine * reference[0] + cosine * reference[1];
        const double place[2] = {s[0] + x, s[1] + z},
                     rate[2] = {w[0] - z * w[TREE_BASE], w[1] + x * w[TREE_BASE]};
        q[0] = slope[2] * place[0] + slope[1] * place[1];
        q[1] = slope[2] * place[1] - slope[1] * place[0];
        v[0] = slope[2] * rate[0] + slope[1] * rate[1];
        v[1] = slope[2] * rate[1] - slope[1] * rate[0];
    }
}

HOT void tree_trigonometry(const lanes *s, int a, scene_trig *trig)
{
    if (tree_slides(a))
        trig->sine[a] = s[TREE_BASE + a], trig->cosine[a] = lanes_of(0);
    else
        lanes_sincos(s[TREE_BASE + a], &trig->sine[a], &trig->cosine[a]);
}
HOT void scene_trigonometry(const lanes *s, scene_trig *trig)
{
    tree_pad_trig(trig);
    TREE_UNROLL
    for (int a = 0; a < tree_angles; a++)
        tree_trigonometry(s, a, trig);
}
/* The part that contacts need. */
HOT void scene_contact_trigonometry(const lanes *s, scene_trig *trig)
{
    tree_pad_trig(trig);
    TREE_UNROLL
    for (int a = 0; a < tree_angles; a++)
        if (tree_carries[a])
            tree_trigonometry(s, a, trig);
}
HOT void scene_choose_trig(mask m, const scene_trig *a, const scene_trig *b, scene_trig *trig)
{
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) {
        if (!tree_carries[i])
            continue;
        trig->sine[i] = choose(m, a->sine[i], b->sine[i]);
        trig->cosine[i] = choose(m, a->cosine[i], b->cosine[i]);
    }
}
/* Angles within the range of lanes_sincos. */
HOT mask scene_angles_in_range(const lanes *s)
{
    mask in = LANES_ALL;
    for (int a = 0; a < tree_angles; a++)
        if (!tree_slides(a))
            in &= mask_less_equal(lanes_abs(s[TREE_BASE + a]), lanes_of(SINCOS_LARGEST_ANGLE));
    return in;
}

/* All coordinates but the place of a free base, or their rates; angles without one above from the
 * ground's normal. */
HOT void scene_posture(const lanes *s, lanes *posture)
{
    tree_pad_posture(posture);
    if (tree_rail)
        posture[0] = s[0];
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++)
        posture[tree_rail + i] = tree_joint(s, i);
}
/* Coordinates that have this posture, all else zero. */
HOT void scene_of_posture(const lanes *posture, lanes *s)
{
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lanes_of(0);
    if (tree_rail)
        s[0] = posture[0];
    TREE_UNROLL
    for (int i = 0; i < tree_angles; i++) { /* a joint comes after what it is measured against */
        s[TREE_BASE + i] = posture[tree_rail + i];
        if (tree_against(i) >= 0)
            s[TREE_BASE + i] = s[TREE_BASE + i] + s[TREE_BASE + tree_against(i)];
    }
}
/* What the user's posture is to be raised by for that. */
static inline double scene_posture_origin(const stance_tree_numbers *number, int i)
{
    return i >= tree_rail && tree_upright(i - tree_rail) ? number->slope[0] : 0;
}

/* q and its rates: what scene_leave gives, without sines of its own. */
HOT void scene_coordinates(const scene_body *b, const scene_trig *trig, const lanes *s,
                           const lanes *w, lanes *q, lanes *v)
{
    tree_pad(q);
    tree_pad(v);
    for (int i = 0; i < tree_base_size; i++)
        q[i] = s[i], v[i] = w[i];
    for (int i = 0; i < tree_angles; i++) {
        q[tree_base_size + i] = tree_joint(s, i);
        v[tree_base_size + i] = tree_joint(w, i);
        if (tree_upright(i))
            q[tree_base_size + i] = q[tree_base_size + i] - b->slope[0];
    }
    if (tree_free) {
        lanes r[2];
        tree_turn(false, trig->sine[0], trig->cosine[0], b->reference, r);
        const lanes place[2] = {s[0] + r[0], s[1] + r[1]};
        const lanes rate[2] = {w[0] - r[1] * w[TREE_BASE], w[1] + r[0] * w[TREE_BASE]};
        q[0] = b->slope[2] * place[0] + b->slope[1] * place[1];
        q[1] = b->slope[2] * place[1] - b->slope[1] * place[0];
        v[0] = b->slope[2] * rate[0] + b->slope[1] * rate[1];
        v[1] = b->slope[2] * rate[1] - b->slope[1] * rate[0];
    }
}
/* How q moves with s: dq/ds x. */
HOT void scene_coordinate_rates(const scene_body *b, const scene_trig *trig, const lanes *x,
                                lanes *rate)
{
    tree_pad(rate);
    for (int i = 0; i < tree_base_size; i++)
        rate[i] = x[i];
    for (int i = 0; i < tree_angles; i++)
        rate[tree_base_size + i] = tree_joint(x, i);
    if (tree_free) {
        lanes r[2];
        tree_turn(false, trig->sine[0], trig->cosine[0], b->reference, r);
        const lanes u[2] = {x[0] - r[1] * x[TREE_BASE], x[1] + r[0] * x[TREE_BASE]};
        rate[0] = b->slope[2] * u[0] + b->slope[1] * u[1];
        rate[1] = b->slope[2] * u[1] - b->slope[1] * u[0];
    }
}
/* q'' where s'' = 0. */
HOT void scene_coordinate_curvature(const scene_body *b, const scene_trig *trig, const lanes *w,
                                    lanes *curvature)
{
    for (int i = 0; i < SCENE_COORDINATES; i++)
        curvature[i] = lanes_of(0);
    if (tree_free) {
        lanes r[2];
        tree_turn(false, trig->sine[0], trig->cosine[0], b->reference, r);
        const lanes turn = w[TREE_BASE] * w[TREE_BASE];
        curvature[0] = -(turn * (b->slope[2] * r[0] + b->slope[1] * r[1]));
        curvature[1] = -(turn * (b->slope[2] * r[1] - b->slope[1] * r[0]));
    }
}

#include "engine/scenes/tree_dynamics.h"
/* What is built on that. */
#include "engine/scenes/tree_contacts.h"
#include "engine/scenes/tree_energy.h"

/* Lanes where an impulse is due at t: its instant is `within` of it; *w changes by what it gives.
 */
HOT mask scene_strike(const scene_body *b, const scene_trig *trig, lanes t, lanes within, lanes *w)
{
    mask struck = MASK_NONE;
    scene_matrix A;
    for (int p = 0; p < tree_pushes; p++) {
        const lanes off = b->push[p][4] - t;
        const mask due = mask_less(-within, off) & mask_less_equal(off, within);
        if (!tree_push_impulse[p] || !mask_any(due))
            continue;
        lanes load[SCENE_COORDINATES], x[SCENE_COORDINATES];
        for (int k = 0; k < SCENE_COORDINATES; k++)
            load[k] = lanes_of(0);
        tree_push_add(b, trig, p, &b->push[p][2], lanes_of(1), load);
        scene_inertia(b, trig, &A);
        scene_solve(&A, false, load, x);
        for (int k = 0; k < SCENE_COORDINATES; k++)
            w[k] = choose(due, w[k] + x[k], w[k]);
        struck |= due;
    }
    return struck;
}

/* How joint j moves point p, which hangs from it: as tree_reach. */
HOT void tree_point_reach(const scene_body *b, const scene_trig *trig, int p, int j, lanes reach[2])
{
    const int through = tree_point_path[p][j];
    if (tree_slides(j))
        tree_slide_arm(b, trig, j, reach);
    else
        tree_arm(b, trig, through != TREE_OWN && tree_straight_joint[through],
                 through == TREE_OWN ? b->point[p] : b->joint[through], j, tree_point_path[p],
                 reach);
}
/* Where it is along an axis of the ground, as tree_place. */
HOT lanes tree_point_place(const scene_body *b, const lanes *s, const scene_trig *trig, int p,
                           int axis)
{
    const int top = tree_point_top[p];
    lanes place = tree_base(b, s, axis);
    if (top >= 0)
        place = place + (top == TREE_OWN ? b->point[p][axis] : b->joint[top][axis]);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        lanes reach[2];
        if (tree_point_path[p][j] < 0)
            continue;
        if (tree_slides(j)) {
            if (tree_above[j] < 0)
                place = lanes_fma(trig->sine[j], b->joint[j][axis], place);
            continue;
        }
        tree_point_reach(b, trig, p, j, reach);
        place = place + reach[axis];
    }
    return place;
}

/* Down by a cause: a point lower than it may be, or, after the points, a body turned further. How
 * far it is from that, and how fast that changes. */
#define SCENE_CAUSES (tree_points + tree_turns)
#define SCENE_FALLS_BEYOND(cause) ((cause) >= tree_points) /* exactly there it has not fallen */
HOT lanes scene_fall_margin(const scene_body *b, const lanes *s, const scene_trig *trig,
                            const lanes *w, int cause, lanes *rate)
{
    if (cause >= tree_points) {
        const int k = cause - tree_points, at = TREE_BASE + tree_turning[k];
        const lanes angle = s[at] - b->slope[0] + b->turn[k][1];
        *rate = choose(mask_less(angle, lanes_of(0)), w[at], -w[at]);
        return b->turn[k][0] - lanes_abs(angle);
    }
    *rate = tree_base(b, w, 1);
    TREE_UNROLL
    for (int j = 0; j < tree_angles; j++) {
        lanes reach[2];
        if (tree_point_path[cause][j] < 0)
            continue;
        tree_point_reach(b, trig, cause, j, reach);
        *rate = lanes_fma(w[TREE_BASE + j], reach[0], *rate);
    }
    const lanes height = tree_point_place(b, s, trig, cause, 1);
    if (tree_plates > 0)
        return height - b->floor[TREE_SLOTS(TREE_CONTACTS) + cause] - b->lowest[cause];
    return height - b->lowest[cause];
}
/* Largest of the rates: the reference point's, the root's, the joints'. */
HOT lanes scene_largest_rate(const scene_body *b, const lanes *w, const scene_trig *trig)
{
    lanes largest = lanes_of(0);
    if (tree_free) {
        lanes r[2];
        tree_turn(false, trig->sine[0], trig->cosine[0], b->reference, r);
        largest = lanes_max(lanes_abs(lanes_fnma(w[TREE_BASE], r[1], w[0])),
                            lanes_abs(lanes_fma(w[TREE_BASE], r[0], w[1])));
    } else if (tree_rail) {
        largest = lanes_abs(w[0]);
    }
    for (int i = 0; i < tree_angles; i++)
        largest = lanes_max(lanes_abs(tree_joint(w, i)), largest);
    return largest;
}

/* K of which a correction d of the velocities leaves an error of at most K h |d|^2 in a step's
 * equation: see engine/tree.c. */
HOT lanes scene_curvature(const scene_body *b)
{
    const double squared = METHOD_THETA * METHOD_THETA;
    return lanes_max(lanes_fma(lanes_of(squared), b->curvature[0], b->curvature[1]),
                     squared * b->curvature[2]);
}

#endif
