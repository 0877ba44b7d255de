/* test_export.c - `stance export --mjcf`: MuJoCo, where it is installed, finds in the model what
 * the engine finds in the scene: inertia, accelerations, gaps, initial state.
 *
 * Accelerations are those of the kernels' algebra without contacts, against qacc_smooth.
 */
#include "mechanism_algebra.h"
/* After it, which says how many lanes there are. */
#include "mechanism_text.h"
#include "reading.h"

#ifdef STANCE_MUJOCO
#include "tests.h"
#endif

#include "runner/plan/mjcf.h"
#include "runner/plan/plan.h"

#ifdef STANCE_MUJOCO
#include "mujoco_model.h"

enum { STATES = 200, STATES_RABBIT = 2000 };

struct twin {
    const stance_scene *scene;
    mjModel *model;
    mjData *data;
    int joint[STANCE_MAX_COORDINATES]; /* MuJoCo's index of each coordinate */
};

static void twin_make(struct twin *t, const stance_scene *scene, const stance_case *c)
{
    OWN char *xml = NULL;
    size_t size = 0;
    FILE *const out = open_memstream(&xml, &size);
    assert_non_null(out);
    mjcf_write(out, scene, c, "<one & 'two'>");
    fclose(out);
    t->scene = scene;
    t->model = mujoco_model(xml);
    assert_non_null(t->model);
    t->data = mj_makeData(t->model);
    assert_int_equal(t->model->nq, scene->coordinates);
    for (int i = 0; i < scene->coordinates; i++) {
        t->joint[i] = mj_name2id(t->model, mjOBJ_JOINT, scene->coordinate[i].name);
        assert_true(t->joint[i] >= 0);
    }
}

static void twin_free(struct twin *t)
{
    mj_deleteData(t->data);
    mj_deleteModel(t->model);
}

static void twin_state(struct twin *t, const double *q, const double *v, const double *torque)
{
    mj_resetData(t->model, t->data);
    for (int i = 0; i < t->scene->coordinates; i++) {
        t->data->qpos[t->joint[i]] = q[i];
        t->data->qvel[t->joint[i]] = v[i];
    }
    memcpy(t->data->ctrl, torque, (size_t)t->scene->actuators * sizeof *torque);
    mj_forward(t->model, t->data);
}

/* Largest differences seen, in relation to the largest number of each state. */
struct off {
    double acceleration, inertia, gap;
};

static void differ(double *off, const double *ours, const double *theirs, int count, double floor)
{
    double size = floor, most = 0;
    for (int i = 0; i < count; i++) {
        size = fmax(size, fabs(ours[i]));
        most = fmax(most, fabs(ours[i] - theirs[i]));
    }
    *off = fmax(*off, most / size);
}

static void compare(struct twin *t, const double *robot, const double *q, const double *v,
                    const double *torque, struct off *off)
{
    enum { N = STANCE_MAX_COORDINATES };
    const int n = t->scene->coordinates;
    double ours[SCENE_COORDINATES], own[SCENE_COORDINATES], theirs[N], A[2][N * N], dense[N * N];
    double gap[2][STANCE_MAX_CONTACTS];
    struct algebra at;
    int grounds = 0;
    twin_state(t, q, v, torque);
    algebra_at(t->scene, robot, q, v, &at);
    algebra_accelerate(&at, torque, own, ours);
    t->scene->inertia(t->scene, robot, q, A[0]);
    mj_fullM(t->model, dense, t->data->qM);
    for (int i = 0; i < n; i++) {
        theirs[i] = t->data->qacc_smooth[t->joint[i]];
        for (int j = 0; j < n; j++)
            A[1][i * n + j] = dense[t->joint[i] * n + t->joint[j]];
    }
    differ(&off->acceleration, ours, theirs, n, 0);
    differ(&off->inertia, A[0], A[1], n * n, 0);
    /* What touches: spheres above a plane, geom 0. */
    const double *const plane = t->data->geom_xmat, *const from = t->data->geom_xpos;
    t->scene->gaps(t->scene, robot, q, gap[0]);
    for (int c = 0; c < t->scene->contacts; c++) {
        const int g = mj_name2id(t->model, mjOBJ_GEOM, t->scene->contact_name[c]);
        if (g < 0) /* a stop */
            continue;
        const double *const centre = t->data->geom_xpos + 3 * g;
        gap[0][grounds] = gap[0][c];
        gap[1][grounds] = -t->model->geom_size[3 * g];
        for (int k = 0; k < 3; k++)
            gap[1][grounds] += plane[3 * k + 2] * (centre[k] - from[k]);
        grounds++;
    }
    differ(&off->gap, gap[0], gap[1], grounds, 1);
}

static void compare_states(const char *name, const stance_scene *scene, const stance_case *c,
                           int states)
{
    struct twin t;
    struct off off = {0};
    uint64_t seed = 1;
    twin_make(&t, scene, c);
    for (int n = 0; n < states; n++) {
        double q[SCENE_COORDINATES] = {0}, v[SCENE_COORDINATES] = {0};
        double torque[STANCE_MAX_ACTUATORS];
        for (int i = 0; i < scene->coordinates; i++) {
            q[i] = uniform(&seed, -2, 2);
            v[i] = uniform(&seed, -5, 5);
        }
        for (int a = 0; a < scene->actuators; a++) {
            const double limit = fmin(fmin(c->torque_limit, scene->mechanism->value.limit[a]), 50);
            torque[a] = uniform(&seed, -limit, limit);
        }
        compare(&t, c->robot, q, v, torque, &off);
    }
    print_message("# %s, %d states: accelerations %.1e, inertia %.1e, gaps %.1e\n", name, states,
                  off.acceleration, off.inertia, off.gap);
    assert_true(off.acceleration < 1e-12 && off.inertia < 1e-12 && off.gap < 1e-12);
    /* The keyframe. */
    mj_resetDataKeyframe(t.model, t.data, mj_name2id(t.model, mjOBJ_KEY, "initial"));
    for (int i = 0; i < scene->coordinates; i++) {
        assert_true(t.data->qpos[t.joint[i]] == c->position[i]);
        assert_true(t.data->qvel[t.joint[i]] == c->velocity[i]);
    }
    for (int a = 0; a < scene->actuators; a++)
        assert_true(t.data->ctrl[a] == c->near.feedforward[a]);
    assert_true(t.model->opt.timestep == c->step);
    twin_free(&t);
}

TEST(shipped)
{
    static const char *const names[] = {"cart_pole", "acrobot",      "rabbit",      "flat_feet",
                                        "pushed",    "rolling_disc", "compass_gait"};
    const struct parallel alone = parallel_alone();
    for (size_t k = 0; k < COUNT(names); k++) {
        static struct scenario s;
        PLAN plan;
        struct plan_error error;
        stance_case c;
        int method;
        char file[80];
        snprintf(file, sizeof file, "scenarios/mechanisms/%s.yaml", names[k]);
        if (!read_as(&s, file, NULL, NULL, 0))
            fail_msg("%s", errors);
        assert_true(plan_make(&plan, &s, true, 0, false, &error));
        assert_true(plan_compute_designs(&plan, &alone, &error));
        assert_true(plan_resolve(&plan, 0, &c, &method));
        compare_states(names[k], s.scene, &c,
                       strcmp(names[k], "rabbit") == 0 ? STATES_RABBIT : STATES);
    }
}

/* What is not shipped: a tree with springs, rotors, a fixed body and a reference of its own on a
 * slope; one that is pinned; a tilted rail with a rotor; a chain. */
TEST(others)
{
    static const struct {
        const char *name, *text;
        double gravity, slope;
    } list[] = {
        {"tree on a slope",
         "body base free - 3 0.1 0.05 0.1 0 0\n"
         "body arm hinge base 1 0.02 0.1 0.2 0.1 0.3 stiffness 30 rest 0.4 damping 0.7\n"
         "body leg1 hinge base 2 0.05 0.03 -0.2 -0.1 -0.1 armature 0.2 damping 0.3\n"
         "body hand hinge arm 0.3 0.004 0.1 -0.02 0.3 0.1 armature 0.05 stiffness 5 rest -0.3\n"
         "body pack fixed base 0.8 0.03 -0.1 0.05 -0.1 0.2\n"
         "body leg2 hinge base 2 0.05 0.03 -0.2 0.15 -0.1 limits -1 inf\n"
         "point foot1 leg1 0 -0.5\n"
         "disc foot2 leg2 0.02 -0.45 0.06\n"
         "reference 0.2 -0.1\n"
         "actuator hip1 leg1 60\n"
         "actuator hip2 leg2 60\n",
         9.81, -0.15},
        {"pinned tree",
         "body post hinge - 2 0.1 0.1 0.3 0 0.2 stiffness 80 rest 0.1 damping 2\n"
         "body plate fixed post 1 0.02 0.1 0 0.1 0.6\n"
         "body left hinge plate 1 0.02 -0.2 0.05 -0.2 0.1 armature 0.1\n"
         "body right hinge plate 1.5 0.03 0.25 0 0.2 0.1 stiffness 20 rest 0.3\n"
         "body end hinge left 0.5 0.01 -0.1 0.1 -0.4 0.1 damping 0.05\n"
         "point tip end -0.2 0.2\n"
         "actuator shoulder left 30\n"
         "actuator wrist end 10\n",
         5, 0},
        {"tilted rail",
         "body cart slide - 1 0 0 0 0.3 0.2 axis 2 0.7 armature 0.3 damping 0.4 stiffness 3\n"
         "body pole hinge cart 0.1 0.00833 0.02 0.5 0 0.1 damping 0.01\n"
         "body ball hinge pole 0.2 0 0.1 0.2 0 1\n"
         "point tip ball 0.2 0.4\n"
         "actuator push cart 20\n",
         9.81, 0.2},
        {"chain of 6",
         "body a free - 1 0.02 0 0.25 0 0\n"
         "body b hinge a 0.5 0.01 0.02 0.25 0 0.5\n"
         "body c hinge b 0.4 0.008 0.03 0.25 0 0.5\n"
         "body d hinge c 0.3 0.006 0.04 0.25 0 0.5\n"
         "body e hinge d 0.2 0.004 0.05 0.25 0 0.5\n"
         "body f hinge e 0.1 0.002 0.06 0.25 0 0.5\n"
         "sole flat f -0.1 0.5 0.2 0.5\n"
         "actuator m f 40\n",
         1.62, 0},
    };
    for (size_t k = 0; k < COUNT(list); k++) {
        SCENE *scene = mechanism_scene(list[k].text);
        stance_case c = {.friction = 0.5, .step = 1e-3, .contacts = ~0u, .torque_limit = INFINITY};
        stance_robot_fallback(scene, c.robot);
        c.scene = scene;
        c.robot[STANCE_ROBOT_GRAVITY] = list[k].gravity;
        c.robot[STANCE_ROBOT_SLOPE] = list[k].slope;
        for (int i = 0; i < scene->coordinates; i++)
            c.position[i] = 0.1 * (i + 1), c.velocity[i] = -0.3 * i;
        compare_states(list[k].name, scene, &c, STATES);
    }
}

#else

int main(void)
{
    puts("1..1\nok 1 - models against MuJoCo # SKIP libmujoco-dev is not installed\n"
         "## skipped: libmujoco-dev is not installed, no exported model was compared with MuJoCo");
    return 0;
}

#endif
