/* compare.c - both robots in MuJoCo: the scene by `stance export`'s writer, which tests hold to the
 * engine (tests/test_export.c), and the file, or what was read of it as bodies in space.
 *
 * Mass matrix, bias and passive forces are enough: nothing of MuJoCo is solved, so that massless
 * links and point masses, whose mass matrix is singular until the plane has merged them, are
 * compared, too. MuJoCo's reader refuses these and moments that no body can have; so they are put
 * into the model that it has made of others.
 */
#include "compare.h"
#include "mujoco_library.h"

#include "runner/base/message.h"

#ifdef MUJOCO_HEADER

#include "space.h"

#include "runner/plan/mjcf.h"

#include <errno.h>
#include <lapacke.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

enum { STATES = 100, N = STANCE_MAX_COORDINATES, DEEPEST = 200 };

/* A model in MuJoCo, its state, and of that the dense mass matrix and the forces. */
struct twin {
    const struct mujoco *mj;
    mjModel *m;
    mjData *d;
    double *mass, *force;
};

struct comparison {
    const struct spatial_model *model;
    const struct plane_map *map;
    const stance_scene *scene;
    struct twin file, ours;
    bool itself;       /* the file is MuJoCo's, not what was read of it */
    int *joint;        /* MuJoCo's of each of the model's */
    int coordinate[N]; /* MuJoCo's joint of each of the scene's */
    int root;          /* MuJoCo's body of a free root */
    double *ways;      /* [N][nv]: how the file's coordinates move in the plane; S' */
    uint64_t random;
};

/* ---- models ---------------------------------------------------------------------------------- */

static void twin_free(struct twin *t)
{
    if (t->d)
        t->mj->mj_deleteData(t->d);
    if (t->m)
        t->mj->mj_deleteModel(t->m);
    free(t->mass);
    free(t->force);
}

static bool twin_load(struct twin *t, const char *path, const char *of, stance_message *message)
{
    char why[200] = "";
    t->m = mujoco_load(t->mj, path, why, sizeof why);
    if (!t->m) {
        why[strcspn(why, "\n")] = '\0';
        return complain(message, "MuJoCo does not read %s: %.150s", of, why);
    }
    const size_t n = (size_t)t->m->nv;
    t->d = t->mj->mj_makeData(t->m);
    t->mass = calloc(n * n + 1, sizeof *t->mass);
    t->force = calloc(n + 1, sizeof *t->force);
    /* A fluid is left out of scenarios, with a note. */
    t->m->opt.density = t->m->opt.viscosity = 0;
    return (t->d && t->mass && t->force) || no_memory(message);
}

/* Reads what was written to a file that has no name, and closes it. */
static bool twin_read(struct twin *t, FILE *out, const char *of, stance_message *message)
{
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", fileno(out));
    const bool written = fflush(out) == 0 && !ferror(out);
    const bool good = written ? twin_load(t, path, of, message)
                              : complain(message, "not compared: %s", strerror(errno));
    fclose(out);
    return good;
}

static FILE *nameless(stance_message *message)
{
    const int fd = memfd_create("model.xml", MFD_CLOEXEC);
    FILE *const out = fd >= 0 ? fdopen(fd, "w+") : NULL;
    if (!out) {
        complain(message, "not compared: %s", strerror(errno));
        if (fd >= 0)
            close(fd);
    }
    return out;
}

/* ---- what was read, as MJCF ------------------------------------------------------------------ */

struct writer {
    FILE *out;
    const struct spatial_model *model;
    bool too_deep;
};

static void numbers(FILE *out, const char *key, const double *value, int count)
{
    fprintf(out, " %s='", key);
    for (int i = 0; i < count; i++)
        fprintf(out, "%s%.17g", i ? " " : "", value[i]);
    fputc('\'', out);
}

static void write_joint(const struct writer *w, int j)
{
    static const char *const word[] = {"hinge", "slide", "free", "ball"};
    const struct spatial_joint *const joint = &w->model->joint[j];
    fprintf(w->out, "<joint name='%d' type='%s'", j, word[joint->kind]);
    if (joint->kind == SPATIAL_HINGE || joint->kind == SPATIAL_SLIDE) {
        numbers(w->out, "axis", joint->axis, 3);
        numbers(w->out, "pos", joint->at, 3);
        numbers(w->out, "ref", &joint->reference, 1);
        numbers(w->out, "damping", &joint->damping, 1);
        numbers(w->out, "armature", &joint->armature, 1);
        numbers(w->out, "stiffness", &joint->stiffness, 1);
        numbers(w->out, "springref", &joint->spring_reference, 1);
    }
    fputs("/>\n", w->out);
}

/* Turned moments that any body may have: those of the model follow, in put_inertia. */
static void write_body(struct writer *w, int b, int depth)
{
    const struct spatial_body *const body = &w->model->body[b];
    double axes[6];
    if ((w->too_deep = w->too_deep || depth > DEEPEST))
        return;
    space_column(body->rotation, 0, axes);
    space_column(body->rotation, 1, axes + 3);
    fprintf(w->out, "<body name='%d'", b);
    numbers(w->out, "pos", body->at, 3);
    numbers(w->out, "xyaxes", axes, 6);
    fputs(">\n<inertial", w->out);
    numbers(w->out, "pos", body->centre, 3);
    fprintf(w->out, " mass='%.17g' fullinertia='2 3 4 0.1 0.2 0.3'/>\n", fmax(body->mass, 1e-9));
    for (int j = 0; j < w->model->joints; j++)
        if (w->model->joint[j].body == b)
            write_joint(w, j);
    for (int child = b + 1; child < w->model->bodies; child++)
        if (w->model->body[child].parent == b)
            write_body(w, child, depth + 1);
    fputs("</body>\n", w->out);
}

static void write_motors(const struct writer *w)
{
    for (int a = 0; a < w->model->actuators; a++) {
        const struct spatial_actuator *const motor = &w->model->actuator[a];
        if (motor->joint < 0)
            continue;
        fprintf(w->out, "<motor name='%d' joint='%d'", a, motor->joint);
        numbers(w->out, "gear", &motor->gear, 1);
        fputs("/>\n", w->out);
    }
}

static void write_model(struct writer *w)
{
    fputs("<mujoco><compiler angle='radian' inertiafromgeom='false'/><option", w->out);
    numbers(w->out, "gravity", w->model->gravity, 3);
    fputs("/>\n<worldbody>\n", w->out);
    for (int b = 0; b < w->model->bodies; b++)
        if (w->model->body[b].parent < 0)
            write_body(w, b, 0);
    fputs("</worldbody>\n<actuator>\n", w->out);
    write_motors(w);
    fputs("</actuator></mujoco>\n", w->out);
}

/* Of a rotation, by its largest component. */
static void quaternion(const double r[3][3], double *q)
{
    const double trace = r[0][0] + r[1][1] + r[2][2];
    int i = 0;
    for (int k = 1; k < 3; k++)
        i = r[k][k] > r[i][i] ? k : i;
    if (trace > r[i][i]) {
        const double s = 2 * sqrt(1 + trace);
        q[0] = s / 4;
        for (int k = 0; k < 3; k++)
            q[1 + k] = (r[(k + 2) % 3][(k + 1) % 3] - r[(k + 1) % 3][(k + 2) % 3]) / s;
    } else {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double s = 2 * sqrt(1 + r[i][i] - r[j][j] - r[k][k]);
        q[0] = (r[k][j] - r[j][k]) / s;
        q[1 + i] = s / 4;
        q[1 + j] = (r[i][j] + r[j][i]) / s;
        q[1 + k] = (r[i][k] + r[k][i]) / s;
    }
}

/* Principal moments and axes, to all digits: MuJoCo's own turning ends at angles of 1e-6. */
static bool put_inertia(const struct twin *t, const struct spatial_body *body, int at)
{
    double vector[9], turn[3][3], third[3];
    memcpy(vector, body->inertia, sizeof vector);
    if (LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', 3, vector, 3, t->m->body_inertia + 3 * at) != 0)
        return false;
    memcpy(turn, vector, sizeof turn);
    const double x[3] = {turn[0][0], turn[1][0], turn[2][0]};
    const double y[3] = {turn[0][1], turn[1][1], turn[2][1]};
    space_cross(x, y, third); /* right-handed */
    for (int i = 0; i < 3; i++)
        turn[i][2] = third[i];
    quaternion(turn, t->m->body_iquat + 4 * at);
    t->m->body_mass[at] = body->mass;
    t->m->body_sameframe[at] = 0;
    return true;
}

static bool load_model(struct comparison *o, stance_message *message)
{
    struct writer w = {.out = nameless(message), .model = o->model};
    char name[16];
    if (!w.out)
        return false;
    write_model(&w);
    if (w.too_deep) {
        fclose(w.out);
        return complain(message, "not compared: links hang on each other more than %d deep",
                        DEEPEST);
    }
    if (!twin_read(&o->file, w.out, "what was read of the file", message))
        return false;
    for (int b = 0; b < o->model->bodies; b++) {
        snprintf(name, sizeof name, "%d", b);
        if (!put_inertia(&o->file, &o->model->body[b],
                         o->file.mj->mj_name2id(o->file.m, mjOBJ_BODY, name)))
            return complain(message, "not compared: no principal axes of %s",
                            o->model->body[b].name);
    }
    snprintf(name, sizeof name, "%d", o->map->root_body);
    o->root = o->file.mj->mj_name2id(o->file.m, mjOBJ_BODY, name);
    for (int j = 0; j < o->model->joints; j++) {
        snprintf(name, sizeof name, "%d", j);
        o->joint[j] = o->file.mj->mj_name2id(o->file.m, mjOBJ_JOINT, name);
    }
    return true;
}

/* Motors that the scene has give what they are told; all else in the file gives nothing. */
static void still(struct comparison *o)
{
    mjModel *const m = o->file.m;
    for (int i = 0; i < m->nu; i++) {
        bool driven = false;
        for (int a = 0; a < o->map->actuators; a++) {
            const int of = o->map->actuator[a].actuator;
            driven = driven || (of == i && o->model->actuator[of].drive == SPATIAL_MOTOR);
        }
        for (int k = 0; !driven && k < 6; k++)
            m->actuator_gear[6 * i + k] = 0;
    }
}

/* What scenarios leave out with a note: ranges of motors that are not the same both ways, dampers
 * and rotors of a free joint. */
static void leave_out(const struct comparison *o)
{
    mjModel *const m = o->file.m;
    m->opt.disableflags |= mjDSBL_CLAMPCTRL;
    for (int a = 0; a < m->nu; a++)
        m->actuator_forcelimited[a] = 0;
    for (int dof = 0; dof < m->nv; dof++) {
        const int j = m->dof_jntid[dof];
        if (m->jnt_type[j] != mjJNT_FREE)
            continue;
        m->dof_damping[dof] = m->dof_armature[dof] = 0;
        m->jnt_stiffness[j] = 0;
    }
}

/* The file itself, whose joints are the model's, one by one. */
static bool load_file(struct comparison *o, const char *path, stance_message *message)
{
    if (!twin_load(&o->file, path, path, message))
        return false;
    for (int j = 0; j < o->model->joints; j++)
        o->joint[j] = j;
    o->root = o->map->root_body + 1;
    still(o);
    if (o->file.m->njnt != o->model->joints)
        return complain(message, "not compared: %s has other joints than when it was read", path);
    leave_out(o);
    return true;
}

static bool load_ours(struct comparison *o, const stance_case *c, stance_message *message)
{
    FILE *const out = nameless(message);
    if (!out)
        return false;
    mjcf_write(out, o->scene, c, "robot");
    if (!twin_read(&o->ours, out, "the scenario's robot", message))
        return false;
    for (int i = 0; i < o->scene->coordinates; i++)
        o->coordinate[i] =
            o->ours.mj->mj_name2id(o->ours.m, mjOBJ_JOINT, o->scene->coordinate[i].name);
    return true;
}

/* ---- states ---------------------------------------------------------------------------------- */

/* Evenly in [low, high): splitmix64. */
static double uniform(struct comparison *o, double low, double high)
{
    uint64_t z = o->random += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return low + (high - low) * ((double)((z ^ z >> 31) >> 11) * 0x1p-53);
}

/* Stops of one side have the other end of their range where no coordinate comes. */
static double position(struct comparison *o, int joint)
{
    const mjModel *const m = o->ours.m;
    double low = -1, high = 1;
    if (m->jnt_limited[joint]) {
        low = m->jnt_range[2 * joint], high = m->jnt_range[2 * joint + 1];
        if (low < -4)
            low = fmin(-1, high - 1);
        if (high > 4)
            high = fmax(1, low + 1);
    }
    return uniform(o, low, high);
}

static void random_torques(struct comparison *o, double *torque)
{
    for (int a = 0; a < o->scene->actuators; a++) {
        const bool limited = o->ours.m->actuator_ctrllimited[a];
        const double most = limited ? o->ours.m->actuator_ctrlrange[2 * a + 1] : 10;
        torque[a] = uniform(o, -most, most);
    }
}

/* Mass matrix and forces (applied, passive, less bias) of the state in `d`. */
static void evaluate(struct twin *t)
{
    const struct mujoco *const mj = t->mj;
    mj->mj_kinematics(t->m, t->d);
    mj->mj_comPos(t->m, t->d);
    mj->mj_crb(t->m, t->d);
    mj->mj_fullM(t->m, t->mass, t->d->qM);
    mj->mj_transmission(t->m, t->d);
    mj->mj_comVel(t->m, t->d);
    mj->mj_passive(t->m, t->d);
    mj->mj_fwdActuation(t->m, t->d);
    mj->mj_rne(t->m, t->d, 0, t->d->qfrc_bias);
    for (int i = 0; i < t->m->nv; i++)
        t->force[i] = t->d->qfrc_applied[i] + t->d->qfrc_actuator[i] + t->d->qfrc_passive[i] -
                      t->d->qfrc_bias[i];
}

/* Symmetric A x = b; x in place of b. */
static bool solve(int n, double *A, double *b)
{
    return LAPACKE_dposv(LAPACK_ROW_MAJOR, 'L', n, 1, A, n, b, 1) == 0;
}

/* Accelerations of the scene's coordinates, by the scene. */
static bool accelerate_ours(struct comparison *o, const double *q, const double *v,
                            const double *torque, double *a)
{
    struct twin *const t = &o->ours;
    const int n = o->scene->coordinates;
    double A[N * N];
    t->mj->mj_resetData(t->m, t->d);
    for (int i = 0; i < n; i++) {
        t->d->qpos[o->coordinate[i]] = q[i];
        t->d->qvel[o->coordinate[i]] = v[i];
    }
    memcpy(t->d->ctrl, torque, (size_t)o->scene->actuators * sizeof *torque);
    evaluate(t);
    for (int i = 0; i < n; i++) {
        a[i] = t->force[o->coordinate[i]];
        for (int k = 0; k < n; k++)
            A[i * n + k] = t->mass[o->coordinate[i] * n + o->coordinate[k]];
    }
    return solve(n, A, a);
}

static int address(const struct comparison *o, int joint)
{
    return o->file.m->jnt_dofadr[o->joint[joint]];
}

/* A joint of the file, of one way or free, at its coordinate. */
static void put_joint(struct comparison *o, int j, double position, double velocity)
{
    o->file.d->qpos[o->file.m->jnt_qposadr[o->joint[j]]] = position;
    o->file.d->qvel[address(o, j)] = velocity;
}

static void put_free(struct comparison *o, int j, const double place[3],
                     const double rotation[3][3])
{
    double *const qpos = o->file.d->qpos + o->file.m->jnt_qposadr[o->joint[j]];
    memcpy(qpos, place, 3 * sizeof *place);
    quaternion(rotation, qpos + 3);
}

/* What no coordinate moves is where the file's robot begins. */
static void put_held(struct comparison *o)
{
    for (int j = 0; j < o->model->joints; j++) {
        const struct spatial_joint *const joint = &o->model->joint[j];
        if (joint->kind == SPATIAL_FREE)
            put_free(o, j, joint->start_place, joint->start_rotation);
        else
            put_joint(o, j, joint->start, 0);
    }
}

/* A free root of the file somewhere in the plane: turned about its normal, with in-plane rates. */
static void put_root(struct comparison *o)
{
    const struct plane_map *const map = o->map;
    for (int k = 0; k < map->root_joints; k++) {
        const int j = map->root_joint[k];
        const struct spatial_joint *const joint = &o->model->joint[j];
        if (joint->kind == SPATIAL_FREE) {
            const int nv = o->file.m->nv;
            double turn[3][3], *const qvel = o->file.d->qvel;
            space_rotation(map->normal, uniform(o, -1, 1), turn);
            space_product(turn, o->model->body[joint->body].rotation, turn);
            put_free(o, j, joint->start_place, turn);
            for (int way = 0; way < 3; way++) {
                const double rate = uniform(o, -2, 2);
                for (int i = 0; i < nv; i++)
                    qvel[i] += rate * o->ways[way * nv + i];
            }
        } else {
            const double position = joint->start + uniform(o, -1, 1);
            put_joint(o, j, position, uniform(o, -2, 2));
        }
    }
}

/* Torques of motors by their controls, of servos at the joint. */
static void put_torque(struct comparison *o, int a, double torque)
{
    const int of = o->map->actuator[a].actuator;
    const struct spatial_actuator *const actuator = &o->model->actuator[of];
    const double force = o->map->actuator[a].sign * torque;
    char name[16];
    snprintf(name, sizeof name, "%d", of);
    const int own = o->itself ? of : o->file.mj->mj_name2id(o->file.m, mjOBJ_ACTUATOR, name);
    if (actuator->drive == SPATIAL_MOTOR)
        o->file.d->ctrl[own] = force / actuator->gear;
    else
        o->file.d->qfrc_applied[address(o, actuator->joint)] += force;
}

/* The ways of the plane in the file's coordinates, in the order of the scene's. A free joint has
 * the world's axes for places and the body's for turning, of which the normal is fixed in both. */
static void make_ways(struct comparison *o)
{
    const struct plane_map *const map = o->map;
    const int nv = o->file.m->nv;
    for (int i = 0; i < map->coordinates; i++)
        if (map->coordinate[i].joint >= 0)
            o->ways[i * nv + address(o, map->coordinate[i].joint)] = 1;
    for (int k = 0; k < map->root_joints; k++) {
        const struct spatial_joint *const joint = &o->model->joint[map->root_joint[k]];
        const int at = address(o, map->root_joint[k]);
        if (joint->kind != SPATIAL_FREE) {
            o->ways[k * nv + at] = 1;
            continue;
        }
        memcpy(o->ways + at, map->ahead, sizeof map->ahead);
        memcpy(o->ways + nv + at, map->up, sizeof map->up);
        for (int i = 0; i < 3; i++)
            for (int m = 0; m < 3; m++)
                o->ways[2 * nv + at + 3 + i] +=
                    o->model->body[joint->body].rotation[m][i] * map->normal[m];
    }
}

/* u' M w of the file. */
static double product(const struct comparison *o, const double *u, const double *w)
{
    const int nv = o->file.m->nv;
    double sum = 0;
    for (int i = 0; i < nv; i++)
        for (int k = 0; u[i] != 0 && k < nv; k++)
            sum += u[i] * o->file.mass[i * nv + k] * w[k];
    return sum;
}

/* Accelerations of the file's coordinates in the plane's ways, into `d`. */
static bool accelerate_file(struct comparison *o, const double *torque, double *a)
{
    const struct twin *const t = &o->file;
    const int n = o->scene->coordinates, nv = t->m->nv;
    double A[N * N];
    for (int k = 0; k < o->map->actuators; k++)
        put_torque(o, k, torque[k]);
    evaluate(&o->file);
    for (int i = 0; i < n; i++) {
        a[i] = 0;
        for (int k = 0; k < nv; k++)
            a[i] += o->ways[i * nv + k] * t->force[k];
        for (int k = 0; k < n; k++)
            A[i * n + k] = product(o, o->ways + i * nv, o->ways + k * nv);
    }
    if (!solve(n, A, a))
        return false;
    for (int k = 0; k < nv; k++) {
        t->d->qacc[k] = 0;
        for (int i = 0; i < n; i++)
            t->d->qacc[k] += o->ways[i * nv + k] * a[i];
    }
    return true;
}

/* In the plane: along x and z, about its normal. */
static void in_plane(const struct plane_map *map, const double linear[3], const double angular[3],
                     double out[3])
{
    out[0] = space_dot(linear, map->ahead);
    out[1] = space_dot(linear, map->up);
    out[2] = space_dot(angular, map->normal);
}

/* x, z and angle of a free root, their rates and accelerations, as the file's body has them. */
static void root_motion(const struct comparison *o, double *q, double *v, double *a)
{
    const struct twin *const t = &o->file;
    const struct plane_map *const map = o->map;
    double rotation[3][3], turn[3][3], then[3][3], arm[3], place[3], at[6], side[3], pull[3];
    memcpy(rotation, t->d->xmat + 9 * o->root, sizeof rotation);
    space_turn(rotation, map->root_at, arm);
    for (int i = 0; i < 3; i++) {
        place[i] = t->d->xpos[3 * o->root + i] + arm[i] - map->origin[i];
        for (int k = 0; k < 3; k++)
            then[i][k] = map->root_rotation[k][i];
    }
    space_product(rotation, then, turn);
    space_turn(turn, map->ahead, side);
    in_plane(map, place, place, q);
    q[2] = map->root_angle + atan2(space_dot(side, map->up), space_dot(side, map->ahead));
    t->mj->mj_objectVelocity(t->m, t->d, mjOBJ_XBODY, o->root, at, 0);
    space_cross(at, arm, side); /* angular is first */
    for (int i = 0; i < 3; i++)
        place[i] = at[3 + i] + side[i];
    in_plane(map, place, at, v);
    space_cross(at, side, pull);
    t->mj->mj_rnePostConstraint(t->m, t->d);
    t->mj->mj_objectAcceleration(t->m, t->d, mjOBJ_XBODY, o->root, at, 0);
    space_cross(at, arm, side);
    for (int i = 0; i < 3; i++) /* MuJoCo's world accelerates upwards in place of gravity */
        place[i] = at[3 + i] + t->m->opt.gravity[i] + side[i] + pull[i];
    in_plane(map, place, at, a);
}

/* A state, and its accelerations by the file. */
static bool random_state(struct comparison *o, double *q, double *v, double *torque, double *a)
{
    const struct plane_map *const map = o->map;
    o->file.mj->mj_resetData(o->file.m, o->file.d);
    put_held(o);
    put_root(o);
    for (int i = 0; i < map->coordinates; i++) {
        if (map->coordinate[i].joint < 0)
            continue;
        const double sign = map->coordinate[i].sign;
        q[i] = position(o, o->coordinate[i]);
        v[i] = uniform(o, -2, 2);
        put_joint(o, map->coordinate[i].joint, sign * q[i] + map->coordinate[i].offset,
                  sign * v[i]);
    }
    random_torques(o, torque);
    if (!accelerate_file(o, torque, a))
        return false;
    for (int i = 0; i < map->coordinates; i++)
        a[i] *= map->coordinate[i].joint < 0 ? 1 : map->coordinate[i].sign;
    if (map->free_root)
        root_motion(o, q, v, a);
    return true;
}

static bool compare_state(struct comparison *o, int state, struct compare_report *report)
{
    double q[N] = {0}, v[N] = {0}, torque[STANCE_MAX_ACTUATORS] = {0}, ours[N], file[N], size = 0;
    if (!random_state(o, q, v, torque, file) || !accelerate_ours(o, q, v, torque, ours))
        return false;
    for (int i = 0; i < o->scene->coordinates; i++)
        size = fmax(size, fabs(file[i]));
    for (int i = 0; i < o->scene->coordinates; i++) {
        const double off = size > 0 ? fabs(ours[i] - file[i]) / size : fabs(ours[i]);
        if (!(off <= report->worst)) {
            report->worst = off;
            report->state = state + 1;
            report->coordinate = i;
        }
    }
    return true;
}

static bool compare_states(struct comparison *o, struct compare_report *report,
                           stance_message *message)
{
    o->ways = calloc(N * ((size_t)o->file.m->nv + 1), sizeof *o->ways);
    if (!o->ways)
        return no_memory(message);
    make_ways(o);
    for (; report->states < STATES; report->states++)
        if (!compare_state(o, report->states, report))
            return complain(message, "not compared: the mass matrix is singular at state %d",
                            report->states + 1);
    return true;
}

bool import_compare(const struct spatial_model *model, const char *path,
                    const struct plane_map *map, const stance_scene *scene, const stance_case *c,
                    struct compare_report *report, stance_message *message)
{
    struct mujoco mj;
    *report = (struct compare_report){.state = 1};
    if (!mujoco_open(&mj, message))
        return false;
    struct comparison o = {.model = model,
                           .map = map,
                           .scene = scene,
                           .file.mj = &mj,
                           .ours.mj = &mj,
                           .joint = calloc((size_t)model->joints + 1, sizeof *o.joint),
                           .itself = strcmp(model->format, "MJCF") == 0,
                           .random = 1};
    const bool good = (o.joint || no_memory(message)) &&
                      (o.itself ? load_file(&o, path, message) : load_model(&o, message)) &&
                      load_ours(&o, c, message) && compare_states(&o, report, message);
    twin_free(&o.file);
    twin_free(&o.ours);
    free(o.joint);
    free(o.ways);
    mujoco_close(&mj);
    return good;
}

#else

bool import_compare(const struct spatial_model *model, const char *path,
                    const struct plane_map *map, const stance_scene *scene, const stance_case *c,
                    struct compare_report *report, stance_message *message)
{
    struct mujoco none;
    (void)model, (void)path, (void)map, (void)scene, (void)c, (void)report;
    return mujoco_open(&none, message);
}

#endif

const char *compare_sentence(const struct compare_report *report, const stance_scene *scene,
                             char *text, size_t size)
{
    const char *const name = scene->coordinate[report->coordinate].name;
    if (report->worst <= COMPARE_ADMITTED)
        snprintf(text, size,
                 "%d random states: accelerations agree with the file's to %.2g (relative, largest "
                 "at state %d, coordinate %s)",
                 report->states, report->worst, report->state, name);
    else
        snprintf(
            text, size,
            "%d random states: accelerations DIFFER from the file's by up to %.2g (relative, at "
            "state %d, coordinate %s), more than rounding does unless masses differ by many orders",
            report->states, report->worst, report->state, name);
    return text;
}
