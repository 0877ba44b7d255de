/* compare.c - both robots in MuJoCo: the scene by `stance export`'s writer, which tests hold to the
 * engine (tests/test_export.c), and the file, or what was read of it as bodies in space.
 *
 * Mass matrix, bias and passive forces are enough: nothing of MuJoCo is solved, so that massless
 * links and point masses, whose mass matrix is singular until the plane has merged them, are
 * compared, too. MuJoCo's reader refuses these and moments that no body can have; so all numbers
 * are put into the model that it has made of others.
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

enum { STATES = 100, N = STANCE_MAX_COORDINATES };

/* A model in MuJoCo, and its state. */
struct twin {
    mjModel *m;
    mjData *d;
    double *mass; /* [nv][nv] */
    double *ways; /* [coordinates][nv]: how its own coordinates move with the scene's; S' */
};

struct comparison {
    const struct spatial_model *model;
    const struct plane_map *map;
    const stance_scene *scene;
    struct mujoco mj;
    struct twin file, ours;
    bool itself; /* the file is MuJoCo's, not what was read of it */
    uint64_t random;
};

/* ---- models --------------------------------------------------------------------------------- */

static void twin_free(const struct comparison *o, struct twin *t)
{
    if (t->d)
        o->mj.mj_deleteData(t->d);
    if (t->m)
        o->mj.mj_deleteModel(t->m);
    free(t->mass);
    free(t->ways);
}

/* Without contacts, stops, and a fluid, which is left out of scenarios with a note. */
static bool twin_load(const struct comparison *o, struct twin *t, const char *path, const char *of,
                      spatial_message *message)
{
    char why[200] = "";
    t->m = mujoco_load(&o->mj, path, why, sizeof why);
    if (!t->m)
        return complain(message, "MuJoCo does not read %s: %.*s", of, (int)strcspn(why, "\n"), why);
    t->m->opt.density = t->m->opt.viscosity = 0;
    t->m->opt.disableflags |= mjDSBL_CONSTRAINT;
    t->d = o->mj.mj_makeData(t->m);
    t->mass = spatial_room((size_t)t->m->nv, (size_t)t->m->nv * sizeof *t->mass);
    t->ways = spatial_room((size_t)t->m->nv, N * sizeof *t->ways);
    return t->d || complain(message, "not enough memory");
}

/* The same of what has been written to a file without a name, which it closes. */
static bool twin_read(const struct comparison *o, struct twin *t, FILE *out, const char *of,
                      spatial_message *message)
{
    char path[64];
    if (!out || fflush(out) != 0 || ferror(out))
        return complain(message, "not compared: %s", strerror(errno));
    snprintf(path, sizeof path, "/proc/self/fd/%d", fileno(out));
    const bool good = twin_load(o, t, path, of, message);
    fclose(out);
    return good;
}

/* Bodies and joints in the model's order, with moments that any body may have. */
static void write_tree(FILE *out, const struct spatial_model *model)
{
    static const char *const word[] = {"hinge", "slide", "free", "ball"};
    int above = -1;
    fputs("<mujoco><worldbody>", out);
    for (int b = 0, j = 0; b < model->bodies; above = b++) {
        for (; above != model->body[b].parent; above = model->body[above].parent)
            fputs("</body>", out);
        fputs("<body><inertial mass='1' pos='1 2 3' fullinertia='2 3 4 0.1 0.2 0.3'/>", out);
        for (; j < model->joints && model->joint[j].body == b; j++)
            fprintf(out, "<joint type='%s'/>", word[model->joint[j].kind]);
    }
    for (; above >= 0; above = model->body[above].parent)
        fputs("</body>", out);
    fputs("</worldbody></mujoco>", out);
}

static void quaternion(const struct comparison *o, double R[3][3], double *out)
{
    double flat[9];
    memcpy(flat, R, sizeof flat);
    o->mj.mju_mat2Quat(out, flat);
}

/* Principal moments and axes, to all digits: MuJoCo's own turning ends at angles of 1e-6. */
static bool put_inertia(const struct comparison *o, const struct spatial_body *body, int at)
{
    double axes[3][3], turned[3][3];
    memcpy(axes, body->inertia, sizeof axes);
    if (LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', 3, axes[0], 3,
                      o->file.m->body_inertia + 3 * at) != 0)
        return false;
    for (int i = 0; i < 3; i++)
        space_column(axes, i, turned[i]);
    space_cross(turned[0], turned[1], turned[2]); /* right-handed */
    for (int i = 0; i < 3; i++)
        space_column(turned, i, axes[i]);
    quaternion(o, axes, o->file.m->body_iquat + 4 * at);
    return true;
}

static bool load_model(struct comparison *o, spatial_message *message)
{
    FILE *const out = tmpfile();
    if (out)
        write_tree(out, o->model);
    if (!twin_read(o, &o->file, out, "what was read of the file", message))
        return false;
    for (int j = 0; j < o->model->joints; j++)
        mujoco_joint(o->file.m, j, &o->model->joint[j], true);
    for (int b = 0; b < o->model->bodies; b++) {
        struct spatial_body *const body = &o->model->body[b];
        mujoco_body(o->file.m, b + 1, body, true);
        quaternion(o, body->rotation, o->file.m->body_quat + 4 * (b + 1));
        if (!put_inertia(o, body, b + 1))
            return complain(message, "not compared: no principal axes of %s", body->name);
    }
    return true;
}

/* The file itself, less what scenarios leave out with a note: ranges of motors that are not the
 * same both ways, dampers and rotors of a free joint; motors drive. What is no motor gives nothing.
 */
static bool load_file(struct comparison *o, const char *path, spatial_message *message)
{
    if (!twin_load(o, &o->file, path, path, message))
        return false;
    mjModel *const m = o->file.m;
    if (m->njnt != o->model->joints || m->nu != o->model->actuators)
        return complain(message, "not compared: %s has other joints than when it was read", path);
    m->opt.disableflags = (m->opt.disableflags | mjDSBL_CLAMPCTRL) & ~mjDSBL_ACTUATION;
    for (int a = 0; a < m->nu; a++) {
        m->actuator_forcelimited[a] = 0;
        for (int k = 0; k < 6; k++)
            m->actuator_gear[6 * a + k] *= o->model->actuator[a].drive == SPATIAL_MOTOR;
    }
    for (int dof = 0; dof < m->nv; dof++)
        if (m->jnt_type[m->dof_jntid[dof]] == mjJNT_FREE)
            m->dof_damping[dof] = m->dof_armature[dof] = m->jnt_stiffness[m->dof_jntid[dof]] = 0;
    return true;
}

static bool load_ours(struct comparison *o, const stance_case *c, spatial_message *message)
{
    FILE *const out = tmpfile();
    if (out)
        mjcf_write(out, o->scene, c, "robot");
    if (!twin_read(o, &o->ours, out, "the scenario's robot", message))
        return false;
    for (int i = 0; i < o->scene->coordinates; i++)
        o->ours.ways[i * o->ours.m->nv +
                     o->mj.mj_name2id(o->ours.m, mjOBJ_JOINT, o->scene->coordinate[i].name)] = 1;
    return true;
}

/* A free joint has the world's axes for places and the body's for turning, of which the normal is
 * fixed in both. */
static void make_ways(struct comparison *o)
{
    const struct plane_map *const map = o->map;
    const mjModel *const m = o->file.m;
    for (int i = 0; i < map->coordinates; i++) {
        const int root = map->root_joints == 3 ? map->root_joint[i % 3] : -1,
                  joint = map->coordinate[i].joint < 0 ? root : map->coordinate[i].joint;
        if (joint >= 0)
            o->file.ways[i * m->nv + m->jnt_dofadr[joint]] =
                map->coordinate[i].joint < 0 ? 1 : map->coordinate[i].sign;
    }
    if (map->root_joints == 1) {
        double *const at = o->file.ways + m->jnt_dofadr[map->root_joint[0]];
        memcpy(at, map->ahead, sizeof map->ahead);
        memcpy(at + m->nv, map->up, sizeof map->up);
        for (int i = 0; i < 9; i++)
            at[2 * m->nv + 3 + i % 3] +=
                o->model->body[map->root_body].rotation[i / 3][i % 3] * map->normal[i / 3];
    }
}

/* ---- states --------------------------------------------------------------------------------- */

/* Evenly in [low, high): splitmix64. */
static double uniform(struct comparison *o, double low, double high)
{
    uint64_t z = o->random += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return low + (high - low) * ((double)((z ^ z >> 31) >> 11) * 0x1p-53);
}

/* Within the joint's stops, or within 1 of where there are none. */
static double position(struct comparison *o, int coordinate)
{
    const int body = coordinate - (o->map->free_root ? 2 : 0);
    const double *const limits = o->scene->mechanism->value.body[body].limits;
    const double low = isfinite(limits[0]) ? limits[0] : fmin(-1, limits[1] - 1);
    return uniform(o, low, isfinite(limits[1]) ? limits[1] : fmax(1, low + 1));
}

static void put_free(const struct comparison *o, const struct spatial_joint *joint, double *qpos,
                     double rotation[3][3])
{
    memcpy(qpos, joint->start_place, sizeof joint->start_place);
    quaternion(o, rotation, qpos + 3);
}

/* The file's robot where it begins, but for its coordinates in the plane, those of a root (which is
 * turned about the normal), and their rates. */
static void put_state(struct comparison *o, double *q, double *v)
{
    const struct plane_map *const map = o->map;
    const mjModel *const m = o->file.m;
    double *const qpos = o->file.d->qpos, turn[3][3];
    o->mj.mj_resetData(m, o->file.d);
    for (int j = 0; j < o->model->joints; j++) {
        struct spatial_joint *const joint = &o->model->joint[j];
        qpos[m->jnt_qposadr[j]] = joint->start;
        if (joint->kind == SPATIAL_FREE)
            put_free(o, joint, qpos + m->jnt_qposadr[j], joint->start_rotation);
    }
    for (int k = 0; k < map->root_joints; k++) {
        const struct spatial_joint *const joint = &o->model->joint[map->root_joint[k]];
        const double by = uniform(o, -1, 1);
        qpos[m->jnt_qposadr[map->root_joint[k]]] += by;
        if (joint->kind == SPATIAL_FREE) {
            space_rotation(map->normal, by, turn);
            space_product(turn, o->model->body[joint->body].rotation, turn);
            put_free(o, joint, qpos + m->jnt_qposadr[map->root_joint[k]], turn);
        }
    }
    for (int i = 0; i < map->coordinates; i++) {
        const int joint = map->coordinate[i].joint;
        if (joint >= 0) {
            q[i] = position(o, i);
            qpos[m->jnt_qposadr[joint]] = map->coordinate[i].sign * q[i];
        }
        v[i] = uniform(o, -2, 2);
        for (int k = 0; k < m->nv; k++)
            o->file.d->qvel[k] += o->file.ways[i * m->nv + k] * v[i];
    }
}

/* The same torques for both: of a file's motors by their controls, else at the joint. */
static void put_torques(struct comparison *o)
{
    for (int a = 0; a < o->map->actuators; a++) {
        const int of = o->map->actuator[a].actuator;
        const struct spatial_actuator *const actuator = &o->model->actuator[of];
        const double limit = o->scene->mechanism->value.limit[a],
                     most = isfinite(limit) ? limit : 10, torque = uniform(o, -most, most),
                     force = o->map->actuator[a].sign * torque;
        o->ours.d->ctrl[a] = torque;
        if (o->itself && actuator->drive == SPATIAL_MOTOR)
            o->file.d->ctrl[of] = force / actuator->gear;
        else
            o->file.d->qfrc_applied[o->file.m->jnt_dofadr[actuator->joint]] += force;
    }
}

/* Accelerations in the ways of the scene's coordinates: S' M S a = S' f. */
static bool accelerate(const struct comparison *o, struct twin *t, double *a)
{
    const int n = o->scene->coordinates, nv = t->m->nv;
    const mjData *const d = t->d;
    double A[N * N] = {0};
    o->mj.mj_fwdPosition(t->m, t->d);
    o->mj.mj_fwdVelocity(t->m, t->d);
    o->mj.mj_fwdActuation(t->m, t->d);
    o->mj.mj_fullM(t->m, t->mass, d->qM);
    for (int i = 0; i < n; i++) {
        a[i] = 0;
        for (int k = 0; k < nv; k++) {
            const double way = t->ways[i * nv + k];
            a[i] += way * (d->qfrc_applied[k] + d->qfrc_actuator[k] + d->qfrc_passive[k] -
                           d->qfrc_bias[k]);
            for (int m = 0; way != 0 && m < n * nv; m++)
                A[i * n + m / nv] += way * t->mass[k * nv + m % nv] * t->ways[m];
        }
    }
    if (LAPACKE_dposv(LAPACK_ROW_MAJOR, 'L', n, 1, A, n, a, 1) != 0)
        return false;
    for (int k = 0; k < nv; k++) {
        d->qacc[k] = 0;
        for (int i = 0; i < n; i++)
            d->qacc[k] += t->ways[i * nv + k] * a[i];
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
    const int root = map->root_body + 1;
    double R[3][3], axes[3][3], arm[3], side[3], inward[3], across[3], rate[6], pull[6];
    memcpy(R, t->d->xmat + 9 * root, sizeof R);
    space_turn(R, map->root_at, arm);
    o->mj.mj_rnePostConstraint(t->m, t->d);
    o->mj.mj_objectVelocity(t->m, t->d, mjOBJ_XBODY, root, rate, 0); /* angular is first */
    o->mj.mj_objectAcceleration(t->m, t->d, mjOBJ_XBODY, root, pull, 0);
    space_cross(rate, arm, side);
    space_cross(rate, side, inward);
    space_cross(pull, arm, across);
    for (int i = 0; i < 3; i++) { /* MuJoCo's world accelerates upwards in place of gravity */
        arm[i] += t->d->xpos[3 * root + i] - map->origin[i];
        rate[3 + i] += side[i];
        pull[3 + i] += t->m->opt.gravity[i] + across[i] + inward[i];
        axes[0][i] = map->ahead[i], axes[1][i] = map->up[i], axes[2][i] = map->normal[i];
    }
    in_plane(map, arm, arm, q);
    in_plane(map, rate + 3, rate, v);
    in_plane(map, pull + 3, pull, a);
    space_product(axes, R, R);
    q[2] = map->root_angle + space_turned(R);
}

static bool compare_state(struct comparison *o, struct compare_report *report)
{
    const int n = o->scene->coordinates, nv = o->ours.m->nv;
    double q[N] = {0}, v[N] = {0}, ours[N], file[N], size = 0;
    o->mj.mj_resetData(o->ours.m, o->ours.d);
    put_state(o, q, v);
    put_torques(o);
    if (!accelerate(o, &o->file, file))
        return false;
    if (o->map->free_root)
        root_motion(o, q, v, file);
    for (int i = 0; i < n * nv; i++) {
        o->ours.d->qpos[i % nv] += o->ours.ways[i] * q[i / nv];
        o->ours.d->qvel[i % nv] += o->ours.ways[i] * v[i / nv];
    }
    if (!accelerate(o, &o->ours, ours))
        return false;
    report->states++;
    for (int i = 0; i < n; i++)
        size = fmax(size, fabs(file[i]));
    for (int i = 0; i < n; i++) {
        const double off = fabs(ours[i] - file[i]) / (size > 0 ? size : 1);
        if (!(off <= report->worst)) {
            report->worst = off;
            report->state = report->states;
            report->coordinate = i;
        }
    }
    return true;
}

bool import_compare(const struct spatial_model *model, const char *path,
                    const struct plane_map *map, const stance_scene *scene, const stance_case *c,
                    struct compare_report *report, spatial_message *message)
{
    struct comparison o = {.model = model,
                           .map = map,
                           .scene = scene,
                           .itself = strcmp(model->format, "MJCF") == 0,
                           .random = 1};
    *report = (struct compare_report){.state = 1, .itself = o.itself};
    if (!mujoco_open(&o.mj, message))
        return false;
    bool good = (o.itself ? load_file(&o, path, message) : load_model(&o, message)) &&
                load_ours(&o, c, message);
    if (good) {
        memcpy(o.file.m->opt.gravity, model->gravity, sizeof model->gravity); /* as it was taken */
        make_ways(&o);
    }
    while (good && report->states < STATES)
        good = compare_state(&o, report) ||
               complain(message, "not compared: the mass matrix is singular at state %d",
                        report->states + 1);
    twin_free(&o, &o.file);
    twin_free(&o, &o.ours);
    mujoco_close(&o.mj);
    return good;
}

#else

bool import_compare(const struct spatial_model *model, const char *path,
                    const struct plane_map *map, const stance_scene *scene, const stance_case *c,
                    struct compare_report *report, spatial_message *message)
{
    struct mujoco none;
    (void)model, (void)path, (void)map, (void)scene, (void)c, (void)report;
    return mujoco_open(&none, message);
}

#endif

const char *compare_sentence(const struct compare_report *report, const stance_scene *scene,
                             char *text, size_t size)
{
    const bool agree = report->worst <= COMPARE_ADMITTED;
    snprintf(
        text, size,
        "%d random states: accelerations %s %s %s %.2g (relative, %sat state %d, coordinate %s)%s",
        report->states, agree ? "agree with" : "DIFFER from",
        report->itself ? "the file's" : "those of what was read of the file",
        agree ? "to" : "by up to", report->worst, agree ? "largest " : "", report->state,
        scene->coordinate[report->coordinate].name,
        agree ? "" : ", more than rounding does unless masses differ by many orders");
    return text;
}
