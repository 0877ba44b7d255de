/* test_tree.c - the tree's algebra in lanes (engine/scenes/tree_*.h) against the same mechanism in
 * the user's coordinates (engine/scenes/mechanism*.c), and its derivatives against differences, on
 * random trees in random states.
 */
#include "random_mechanism.h"
#include "tests.h"

#include "engine/scenes/mechanism_pose.h"
#include "engine/tree.h"

#define METHOD_THETA 1.0
#define STANCE_LANES 1
#define STANCE_SCENE runtime
#define STANCE_ISA scalar
#include "engine/core/loop/kernel.h"
/* In this order. */
#include "engine/scenes/runtime_lanes.h"

enum { TREES = 200, STATES = 20 };

/* ---- one mechanism in one state --------------------------------------------------------------*/

struct trial {
    stance_scene *scene;
    double robot[STANCE_MAX_ROBOT];
    stance_tree_numbers number;
    scene_body body;
    double q[STANCE_MAX_COORDINATES], v[STANCE_MAX_COORDINATES];
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    scene_trig trig;
};

static void random_state_of(struct trial *t)
{
    const int n = t->scene->coordinates;
    for (int i = 0; i < n; i++) {
        t->q[i] = between(-2, 2);
        t->v[i] = between(-3, 3);
    }
    scene_enter(&t->number, t->q, t->v, t->s, t->w);
    scene_trigonometry(t->s, &t->trig);
}

static void begin(struct trial *t, const stance_mechanism *m)
{
    stance_message message = {{0}};
    const stance_error error = stance_mechanism_scene(m, &t->scene, &message);
    if (error != STANCE_OK)
        fail_msg("%s", message.text);
    stance_robot_fallback(t->scene, t->robot);
    t->robot[STANCE_ROBOT_SLOPE] = sometimes(0.5) ? 0 : between(-0.5, 0.5);
    stance_tree_numbers_make(t->scene->tree, t->scene->mechanism, t->robot, &t->number);
    tree_now = t->scene->tree;
    memset(&t->body, 0, sizeof t->body);
    scene_load_body(&t->body, 0, &t->number);
    for (int p = 0; p < tree_pushes; p++)
        for (int axis = 0; axis < 2; axis++)
            t->body.pull[p][axis] = between(-20, 20);
}

/* In the places of the room that the structure has. */
static bool in_use(int k)
{
    return k < TREE_BASE ? k < tree_base_size : k - TREE_BASE < tree_angles;
}

static void near(double got, double wanted, double tolerance, const char *what)
{
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%s: %.17g in place of %.17g, off by %.3g, admitted %.3g", what, got, wanted,
                 fabs(got - wanted), tolerance);
}

/* The body of a joint. */
static int body_of(const struct trial *t, int joint)
{
    const stance_mechanism *const m = t->scene->mechanism;
    for (int b = 0; b < m->bodies; b++)
        if (m->body[b].joint != STANCE_FIXED && (b > 0 || !tree_rail) && joint-- == 0)
            return b;
    return -1;
}

/* ---- against the user's coordinates -----------------------------------------------------------*/

static double energy_of(const struct trial *t)
{
    return t->scene->energy(t->scene, t->robot, t->q, t->v);
}

static void compare_energy(struct trial *t)
{
    static const double still[STANCE_MAX_COORDINATES];
    double zero[SCENE_COORDINATES], q0[STANCE_MAX_COORDINATES] = {0};
    double s0[SCENE_COORDINATES];
    scene_trig trig0;
    const double kinetic = energy_of(t) - t->scene->energy(t->scene, t->robot, t->q, still);
    near(scene_kinetic(&t->body, &t->trig, t->w), kinetic, 1e-12 * (1 + fabs(energy_of(t))),
         "kinetic energy");
    scene_enter(&t->number, q0, still, s0, zero);
    scene_trigonometry(s0, &trig0);
    const double change =
        scene_potential(&t->body, t->s, &t->trig) - scene_potential(&t->body, s0, &trig0);
    near(change, energy_of(t) - kinetic - t->scene->energy(t->scene, t->robot, q0, still),
         1e-12 * (1 + fabs(energy_of(t))), "potential energy");
}

static void compare_contacts(const struct trial *t)
{
    double gap[STANCE_MAX_CONTACTS];
    const stance_tree *const tree = t->scene->tree;
    assert_int_equal(tree->contacts, t->scene->contacts);
    t->scene->gaps(t->scene, t->robot, t->q, gap);
    for (int c = 0; c < t->scene->contacts; c++) {
        double point[2], speed[2], other[2], there[2], u[2];
        assert_int_equal(tree->grip[c], t->scene->grip[c]);
        near(scene_gap(&t->body, t->s, &t->trig, c), gap[c], 1e-13 * 10, "gap");
        if (tree->grip[c] < 0)
            continue;
        scene_contact_velocity(&t->body, &t->trig, c, t->w, u);
        t->scene->contact_point(t->scene, t->robot, t->q, t->v, c, point, speed);
        near(u[0], speed[1], 1e-12 * 20, "normal velocity");
        if (tree->other[c] >= 0 && gap[tree->other[c]] < gap[c]) {
            t->scene->contact_point(t->scene, t->robot, t->q, t->v, tree->other[c], there, other);
            speed[0] = other[0];
        }
        near(u[1], speed[0], 1e-12 * 20, "tangential velocity");
    }
}

/* How far from a fall at s + ahead w. */
static double fall_margin(const struct trial *t, int cause, double ahead, double *rate)
{
    double s[SCENE_COORDINATES];
    scene_trig trig;
    for (int k = 0; k < SCENE_COORDINATES; k++)
        s[k] = t->s[k] + ahead * t->w[k];
    scene_trigonometry(s, &trig);
    return scene_fall_margin(&t->body, s, &trig, t->w, cause, rate);
}
/* What has fallen, and what not, of points that may be anywhere. */
static int down;
static void compare_falls(const struct trial *t)
{
    bool fallen = false;
    for (int cause = 0; cause < SCENE_CAUSES; cause++) {
        const double e = 1e-5;
        double rate, other;
        const double margin = fall_margin(t, cause, 0, &rate);
        fallen = fallen || (SCENE_FALLS_BEYOND(cause) ? margin < 0 : margin <= 0);
        near((fall_margin(t, cause, e, &other) - fall_margin(t, cause, -e, &other)) / (2 * e), rate,
             1e-6, "rate of a fall");
    }
    assert_int_equal(fallen, t->scene->fallen(t->scene, t->robot, t->q));
    down += fallen;
}

static void compare_coordinates(const struct trial *t)
{
    double q[SCENE_COORDINATES], v[SCENE_COORDINATES], lane_q[SCENE_COORDINATES],
        lane_v[SCENE_COORDINATES];
    scene_leave(&t->number, t->s, t->w, q, v);
    scene_coordinates(&t->body, &t->trig, t->s, t->w, lane_q, lane_v);
    for (int i = 0; i < t->scene->coordinates; i++) {
        near(q[i], t->q[i], 1e-14 * 10, "coordinate");
        near(v[i], t->v[i], 1e-14 * 20, "rate");
        near(lane_q[i], t->q[i], 1e-14 * 10, "coordinate in lanes");
        near(lane_v[i], t->v[i], 1e-14 * 20, "rate in lanes");
    }
}

/* ---- derivatives ------------------------------------------------------------------------------*/

/* A x at a place. */
static void inertia_times(const struct trial *t, const double *s, const double *x, double *out)
{
    static const double none[SCENE_COORDINATES];
    scene_trig trig;
    scene_trigonometry(s, &trig);
    scene_residual(&t->body, &(scene_guess){0, 0, s, &trig, none, x}, none, out);
}

/* F = -dA/dt w + dT/ds - dV/ds + torques, by differences of the energies. */
static void compare_forces(const struct trial *t)
{
    const double e = 1e-5;
    double torque[SCENE_ACTUATORS], force[SCENE_COORDINATES], ahead[SCENE_COORDINATES],
        behind[SCENE_COORDINATES], s[2][SCENE_COORDINATES], load[SCENE_COORDINATES] = {0};
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        torque[i] = between(-20, 20);
    for (int i = 0; i < t->scene->actuators; i++)
        tree_drive(tree_actuator[i], torque[i], load);
    for (int k = 0; k < tree_springs; k++)
        tree_drive(tree_spring[k], -t->body.spring[k][1] * tree_joint(t->w, tree_spring[k]), load);
    for (int p = 0; p < tree_pushes; p++)
        tree_push_add(&t->body, &t->trig, p, t->body.pull[p], 1, load);
    scene_residual(&t->body, &(scene_guess){.s = t->s, .trig = &t->trig, .w = t->w}, torque, force);
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        s[0][k] = t->s[k] - e * t->w[k];
        s[1][k] = t->s[k] + e * t->w[k];
    }
    inertia_times(t, s[0], t->w, behind);
    inertia_times(t, s[1], t->w, ahead);
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        double lagrangian[2];
        if (!in_use(k)) {
            near(force[k], 0, 0, "force in unused room");
            continue;
        }
        for (int side = 0; side < 2; side++) {
            double place[SCENE_COORDINATES];
            scene_trig trig;
            memcpy(place, t->s, sizeof place);
            place[k] += side ? e : -e;
            scene_trigonometry(place, &trig);
            lagrangian[side] =
                scene_kinetic(&t->body, &trig, t->w) - scene_potential(&t->body, place, &trig);
        }
        const double wanted =
            (lagrangian[1] - lagrangian[0]) / (2 * e) - (ahead[k] - behind[k]) / (2 * e) + load[k];
        near(force[k], wanted, 1e-6 * (1 + fabs(energy_of(t))), "force");
    }
}

struct step {
    double h, theta, s0[SCENE_COORDINATES], w0[SCENE_COORDINATES];
    double torque[SCENE_ACTUATORS], r[SCENE_CONTACTS][2];
    double gain[SCENE_ACTUATORS][SCENE_POSTURE]; /* torques answer rates at the end */
};

/* P(w) of core/implicit/step.h, with torques that answer. */
static void equation(const struct trial *t, const struct step *p, const double *w, double *out)
{
    double v[SCENE_COORDINATES], u[SCENE_COORDINATES], change[SCENE_COORDINATES];
    double torque[SCENE_ACTUATORS], rate[SCENE_POSTURE];
    scene_trig trig;
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        v[k] = (1 - p->theta) * p->w0[k] + p->theta * w[k];
        u[k] = p->s0[k] + p->h * p->theta * v[k];
        change[k] = w[k] - p->w0[k];
    }
    scene_posture(w, rate);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        torque[i] = p->torque[i];
        for (int j = 0; j < SCENE_POSTURE; j++)
            torque[i] += p->gain[i][j] * rate[j];
    }
    scene_trigonometry(u, &trig);
    scene_residual(&t->body, &(scene_guess){p->h, 0, u, &trig, v, change}, torque, out);
    for (int c = 0; c < t->scene->contacts; c++)
        for (int k = 0; k < SCENE_COORDINATES; k++) {
            double unit[SCENE_COORDINATES] = {0}, velocity[2];
            unit[k] = 1;
            if (!in_use(k))
                continue;
            scene_contact_velocity(&t->body, &trig, c, unit, velocity);
            out[k] -= velocity[0] * p->r[c][0];
            if (scene_grip[c] == c)
                out[k] -= velocity[1] * p->r[c][1];
        }
}

static void factor(const struct trial *t, const struct step *p, const scene_guess *at, bool coupled,
                   scene_matrix *J)
{
    const double lever = p->h * (p->theta * p->theta);
    const scene_slopes by = {p->theta,
                             lever,
                             lever,
                             at->trig,
                             (const double(*)[2])p->r,
                             (const double(*)[SCENE_POSTURE])p->gain};
    scene_factor(&t->body, at, &by, coupled, J);
}

/* The factored matrix takes differences of the equation back to the direction. */
static void compare_matrix(const struct trial *t, double theta, bool coupled)
{
    const double e = 1e-6;
    struct step p = {.h = between(1e-4, 2e-2), .theta = theta};
    double w[SCENE_COORDINATES], d[SCENE_COORDINATES], side[2][SCENE_COORDINATES],
        moved[2][SCENE_COORDINATES], change[SCENE_COORDINATES], v[SCENE_COORDINATES],
        u[SCENE_COORDINATES], slope[SCENE_COORDINATES], x[SCENE_COORDINATES];
    memcpy(p.s0, t->s, sizeof p.s0);
    memcpy(p.w0, t->w, sizeof p.w0);
    for (int i = 0; i < t->scene->actuators; i++) {
        p.torque[i] = between(-10, 10);
        for (int j = 0; j < tree_postures && coupled; j++)
            p.gain[i][j] = between(-30, 10);
    }
    for (int c = 0; c < t->scene->contacts; c++)
        for (int a = 0; a < 2; a++)
            p.r[c][a] = scene_grip[c] == c || a == 0 ? between(-1, 3) * p.h : 0;
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        w[k] = in_use(k) ? t->w[k] + between(-0.5, 0.5) : 0;
        d[k] = in_use(k) ? between(-1, 1) : 0;
        moved[0][k] = w[k] - e * d[k], moved[1][k] = w[k] + e * d[k];
        change[k] = w[k] - p.w0[k];
        v[k] = (1 - theta) * p.w0[k] + theta * w[k];
        u[k] = p.s0[k] + p.h * theta * v[k];
    }
    for (int k = 0; k < 2; k++)
        equation(t, &p, moved[k], side[k]);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        slope[k] = (side[1][k] - side[0][k]) / (2 * e);
    scene_trig trig;
    scene_matrix J;
    scene_trigonometry(u, &trig);
    factor(t, &p, &(scene_guess){p.h, 0, u, &trig, v, change}, coupled, &J);
    scene_solve(&J, coupled, slope, x);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        near(x[k], d[k], coupled ? 2e-5 : 2e-6, coupled ? "coupled step matrix" : "step matrix");
}

/* What Newton's step leaves of a distance in flight is within the bound of the stop rule, as long
 * as no slide is beyond its limits. */
static double worst_curvature;
static void compare_curvature(const struct trial *t, double theta)
{
    struct step p = {.h = between(2e-4, 5e-3), .theta = theta};
    double w[SCENE_COORDINATES], change[SCENE_COORDINATES], v[SCENE_COORDINATES],
        u[SCENE_COORDINATES], wanted[SCENE_COORDINATES], here[SCENE_COORDINATES],
        d[SCENE_COORDINATES], size = 0;
    const double way = between(0.01, 1);
    for (int i = 0; i < tree_angles; i++) {
        const double *const limits = t->scene->mechanism->value.body[body_of(t, i)].limits;
        const double place = t->s[TREE_BASE + i];
        if (tree_slides(i) && !(place > limits[0] && place < limits[1]))
            return;
    }
    memcpy(p.s0, t->s, sizeof p.s0);
    memcpy(p.w0, t->w, sizeof p.w0);
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        w[k] = in_use(k) ? t->w[k] + way * between(-1, 1) : 0;
        change[k] = w[k] - p.w0[k];
        v[k] = (1 - theta) * p.w0[k] + theta * w[k];
        u[k] = p.s0[k] + p.h * theta * v[k];
    }
    equation(t, &p, t->w, wanted);
    equation(t, &p, w, here);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        wanted[k] -= here[k];
    scene_trig trig;
    scene_matrix J;
    scene_trigonometry(u, &trig);
    factor(t, &p, &(scene_guess){p.h, 0, u, &trig, v, change}, false, &J);
    scene_solve(&J, false, wanted, d);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        size += fabs(d[k]);
    /* The bound is of first order in h: gravity and pushes bend in third. */
    const double bound =
        (theta * theta * t->number.curvature[0] * p.h + 1e4 * p.h * p.h * p.h) * (size * size);
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        const double left = fabs(w[k] + d[k] - t->w[k]);
        if (left > 1e-10)
            worst_curvature = fmax(worst_curvature, left / bound);
        near(left, 0, bound + 1e-10, "left by Newton");
    }
}

static void compare_inertia(const struct trial *t)
{
    scene_matrix A;
    double b[SCENE_COORDINATES], x[SCENE_COORDINATES], back[SCENE_COORDINATES];
    scene_inertia(&t->body, &t->trig, &A);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        b[k] = in_use(k) ? between(-5, 5) : 0;
    scene_solve(&A, false, b, x);
    inertia_times(t, t->s, x, back);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        near(back[k], b[k], 1e-11, "A A^-1 b");
    for (int c = 0; c < t->scene->contacts; c++) {
        double response[2][SCENE_COORDINATES];
        scene_contact_response(&t->body, &A, false, &t->trig, c, response);
        for (int a = 0; a < (scene_grip[c] == c ? 2 : 1); a++) {
            inertia_times(t, t->s, response[a], back);
            for (int k = 0; k < SCENE_COORDINATES; k++) {
                double unit[SCENE_COORDINATES] = {0}, u[2] = {0, 0};
                unit[k] = 1;
                if (in_use(k))
                    scene_contact_velocity(&t->body, &t->trig, c, unit, u);
                near(back[k], u[a], 1e-11, "A A^-1 H^T");
            }
        }
    }
}

/* What follows from a small displacement, and accelerations that velocities cause. */
static void compare_changes(const struct trial *t)
{
    const double e = 1e-4;
    double d[SCENE_COORDINATES], place[SCENE_COORDINATES];
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        d[k] = in_use(k) ? e * between(-1, 1) : 0;
        place[k] = t->s[k] + d[k];
    }
    scene_trig trig;
    scene_trigonometry(place, &trig);
    double behind[SCENE_COORDINATES];
    scene_trig trig_behind;
    for (int k = 0; k < SCENE_COORDINATES; k++)
        behind[k] = t->s[k] - d[k];
    scene_trigonometry(behind, &trig_behind);
    const double added = 0.5 * (scene_energy(&t->body, place, t->w, &trig) -
                                scene_energy(&t->body, behind, t->w, &trig_behind));
    near(scene_energy_change(&t->body, t->s, &t->trig, t->w, d), added,
         1e-8 * (1 + fabs(energy_of(t))), "energy change");
    for (int c = 0; c < t->scene->contacts; c++) {
        const double change =
            scene_gap(&t->body, place, &trig, c) - scene_gap(&t->body, t->s, &t->trig, c);
        const double bound = scene_gap_change_error(&t->body, &t->trig, c, d);
        near(scene_gap_change(&t->body, &t->trig, c, d), change, bound + 1e-14, "gap change");
        double u[2][2], a[2], ends[2][SCENE_COORDINATES], above[2] = {1, 1};
        for (int side = 0; side < 2; side++) {
            scene_trig there;
            for (int k = 0; k < SCENE_COORDINATES; k++)
                ends[side][k] = t->s[k] + (side ? e : -e) * 0.1 * t->w[k];
            scene_trigonometry(ends[side], &there);
            scene_contact_velocity(&t->body, &there, c, t->w, u[side]);
            if (scene_other[c] >= 0)
                above[side] = scene_gap(&t->body, ends[side], &there, c) -
                              scene_gap(&t->body, ends[side], &there, scene_other[c]);
        }
        scene_contact_curvature(&t->body, &t->trig, c, t->w, a);
        for (int axis = 0; axis < 2; axis++)
            if (axis == 0 || (scene_grip[c] == c && above[0] * above[1] > 0)) /* one lower end */
                near(a[axis], (u[1][axis] - u[0][axis]) / (0.2 * e), 1e-5, "curvature");
    }
}

/* Pushes work over the ways of their points. */
static void compare_pushes(const struct trial *t)
{
    const stance_mechanism *const m = t->scene->mechanism;
    const double e = 1e-5, slope = t->robot[STANCE_ROBOT_SLOPE];
    double work = 0, none[SCENE_ACTUATORS] = {0}, q[2][STANCE_MAX_COORDINATES];
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < t->scene->coordinates; i++)
            q[side][i] = t->q[i] + (side ? e : -e) * t->v[i];
    for (int p = 0; p < m->points; p++) {
        double at[2][2];
        for (int side = 0; side < 2; side++) {
            stance_pose pose;
            stance_pose_at(m, t->robot, q[side], &pose);
            stance_pose_point(&pose, m->point[p].body, m->value.point[p].at, at[side]);
        }
        const double x = (at[1][0] - at[0][0]) / (2 * e), z = (at[1][1] - at[0][1]) / (2 * e);
        work += t->body.pull[p][0] * (cos(slope) * x - sin(slope) * z) +
                t->body.pull[p][1] * (sin(slope) * x + cos(slope) * z);
    }
    near(scene_work(&t->body, 1, 0, &t->trig, none, t->w), work, 1e-7 * (1 + fabs(work)),
         "work of pushes");
}

static void trees_of(double slides)
{
    static stance_mechanism m;
    worst_curvature = 0, down = 0;
    for (int tree = 0; tree < TREES; tree++) {
        struct trial t;
        dice = 1000003u * (uint64_t)tree + 7;
        random_mechanism(&m, whole(1, STANCE_MAX_ANGLES), slides, 3);
        for (int p = 0; p < m.points; p++) {
            m.point[p].falls = sometimes(0.5);
            m.value.point[p].lowest = between(-2, 1);
        }
        begin(&t, &m);
        for (int k = 0; k < STATES; k++) {
            random_state_of(&t);
            compare_coordinates(&t);
            compare_energy(&t);
            compare_contacts(&t);
            compare_falls(&t);
            compare_forces(&t);
            compare_inertia(&t);
            compare_changes(&t);
            compare_pushes(&t);
            for (int i = 0; i < 4; i++)
                compare_matrix(&t, i / 2 ? 1 : 0.5, i % 2);
            for (int i = 0; i < 4; i++)
                compare_curvature(&t, i / 2 ? 1 : 0.5);
        }
        stance_scene_free(t.scene);
    }
    print_message("# Newton leaves %.2g of its bound; %d states are down\n", worst_curvature, down);
    assert_in_range(down, 100, TREES * STATES - 100);
}

TEST(trees)
{
    trees_of(0);
}
TEST(trees_that_slide)
{
    trees_of(0.4);
}

/* The structure that kernels are compiled for ahead is that of the biped that the program carries,
 * and of whoever describes the same. */
TEST(structure_ahead)
{
    const stance_scene *const biped = stance_scene_find("biped");
    const stance_method *const midpoint = stance_method_find("midpoint");
    static char wanted[STANCE_TREE_TEXT], text[STANCE_TREE_TEXT + 400];
    SCENE *same;
    FILE *const file = fopen("engine/scenes/biped_lanes.h", "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    stance_tree_text(biped->tree, true, wanted);
    assert_string_equal(strstr(text, "*/\n") + 3, wanted);
    OK(stance_mechanism_scene(biped->mechanism, &same, NULL));
    assert_true(stance_kernel_ahead(stance_kernel_find(same, midpoint, NULL)));
    assert_false(stance_kernel_ahead(stance_kernel_find(stance_scene_find("rod"), midpoint, NULL)));
}
