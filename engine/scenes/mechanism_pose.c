/* mechanism_pose.c - kinematics, inertia and energy of a mechanism in plain doubles; equations in
 * mechanism_pose.h. */
#include "engine/scenes/mechanism_pose.h"

#include "engine/matrix.h"

void stance_mechanism_expand(const stance_mechanism *m, const double *robot,
                             stance_mechanism_numbers *numbers)
{
    *numbers = m->value;
    if (m->carried)
        m->carried->set(robot, numbers);
    for (int i = m->carried ? m->carried->parameters : 0; i < m->numbers; i++)
        memcpy((char *)numbers + (size_t)m->number[i] * sizeof *robot, &robot[i], sizeof *robot);
}

void stance_torque_limits(const stance_scene *scene, const double *robot, double most,
                          const double *limits, double limit[STANCE_MAX_ACTUATORS])
{
    stance_mechanism_numbers number;
    stance_mechanism_expand(scene->mechanism, robot, &number);
    for (int i = 0; i < scene->actuators; i++)
        limit[i] = fmin(fmin(most, limits[i]), number.limit[i]);
}

static double along(const double a[2], const double b[2])
{
    return a[0] * b[0] + a[1] * b[1];
}

static void turned(double sine, double cosine, const double v[2], double out[2])
{
    out[0] = cosine * v[0] - sine * v[1];
    out[1] = sine * v[0] + cosine * v[1];
}

void stance_pose_point(const stance_pose *pose, int body, const double local[2], double point[2])
{
    turned(pose->sine[body], pose->cosine[body], local, point);
    point[0] += pose->origin[body][0];
    point[1] += pose->origin[body][1];
}

/* T of body b, whose axis is given in a frame turned so; it is where its slide has taken it. */
static void place_slide(stance_pose *pose, int b, double sine, double cosine)
{
    const double *const given = pose->number.body[b].axis;
    const double length = sqrt(along(given, given));
    turned(sine, cosine, (const double[]){given[0] / length, given[1] / length}, pose->axis[b]);
    for (int k = 0; k < 2; k++)
        pose->origin[b][k] += pose->position[pose->own[b]] * pose->axis[b][k];
}

static void place_root(stance_pose *pose)
{
    const stance_body_numbers *const root = &pose->number.body[0];
    const double *const q = pose->position;
    const bool free = pose->m->body[0].joint == STANCE_FREE;
    pose->own[0] = free ? 2 : 0;
    pose->coordinates = pose->own[0] + 1;
    pose->turns[0] = pose->m->body[0].joint != STANCE_SLIDE;
    pose->straight[0] = root->angle;
    pose->angle[0] = root->angle + (pose->turns[0] ? q[pose->own[0]] : 0);
    stance_sincos(pose->angle[0], &pose->sine[0], &pose->cosine[0]);
    memcpy(pose->pivot[0], free ? q : root->at, sizeof pose->pivot[0]);
    memcpy(pose->origin[0], pose->pivot[0], sizeof pose->origin[0]);
    if (free) {
        double arm[2];
        turned(pose->sine[0], pose->cosine[0], pose->number.reference, arm);
        for (int k = 0; k < 2; k++)
            pose->origin[0][k] -= arm[k];
    } else if (!pose->turns[0]) {
        place_slide(pose, 0, 0, 1);
    }
}

void stance_pose_at(const stance_mechanism *m, const double *robot, const double *position,
                    stance_pose *pose)
{
    memset(pose, 0, sizeof *pose);
    pose->m = m;
    stance_mechanism_expand(m, robot, &pose->number);
    pose->gravity = robot[STANCE_ROBOT_GRAVITY];
    stance_sincos(robot[STANCE_ROBOT_SLOPE], &pose->normal[0], &pose->normal[1]);
    pose->tangent[0] = pose->normal[1];
    pose->tangent[1] = -pose->normal[0];

    int count = m->body[0].joint == STANCE_FREE ? 3 : 1;
    for (int b = 1; b < m->bodies; b++)
        count += m->body[b].joint != STANCE_FIXED;
    memcpy(pose->position, position, (size_t)count * sizeof *position);
    place_root(pose);
    for (int b = 1; b < m->bodies; b++) {
        const int parent = m->body[b].parent;
        stance_pose_point(pose, parent, pose->number.body[b].at, pose->origin[b]);
        memcpy(pose->pivot[b], pose->origin[b], sizeof pose->pivot[b]);
        pose->turns[b] = m->body[b].joint == STANCE_HINGE;
        pose->own[b] = m->body[b].joint != STANCE_FIXED ? pose->coordinates++ : -1;
        pose->straight[b] = pose->straight[parent] + pose->number.body[b].angle;
        pose->angle[b] = pose->angle[parent] + pose->number.body[b].angle +
                         (pose->turns[b] ? position[pose->own[b]] : 0);
        stance_sincos(pose->angle[b], &pose->sine[b], &pose->cosine[b]);
        if (m->body[b].joint == STANCE_SLIDE)
            place_slide(pose, b, pose->sine[parent], pose->cosine[parent]);
    }
}

void stance_pose_jacobian(const stance_pose *pose, int body, const double point[2],
                          double J[2][STANCE_MAX_COORDINATES], double turn[STANCE_MAX_COORDINATES])
{
    memset(J, 0, sizeof(double[2][STANCE_MAX_COORDINATES]));
    memset(turn, 0, sizeof(double[STANCE_MAX_COORDINATES]));
    for (int b = body; b >= 0; b = pose->m->body[b].parent) {
        const int i = pose->own[b];
        if (pose->turns[b]) {
            J[0][i] = -(point[1] - pose->pivot[b][1]);
            J[1][i] = point[0] - pose->pivot[b][0];
            turn[i] = 1;
        } else if (i >= 0) {
            J[0][i] = pose->axis[b][0];
            J[1][i] = pose->axis[b][1];
        }
    }
    if (pose->m->body[0].joint == STANCE_FREE)
        J[0][0] = J[1][1] = 1;
}

static void touch_ground(const stance_pose *pose, int body, const double local[2], double radius,
                         stance_touch *touch)
{
    double J[2][STANCE_MAX_COORDINATES], turn[STANCE_MAX_COORDINATES], centre[2];
    stance_pose_point(pose, body, local, centre);
    stance_pose_jacobian(pose, body, centre, J, turn);
    *touch = (stance_touch){
        .body = body,
        .gap = along(centre, pose->normal) - radius,
        .point = {centre[0] - radius * pose->normal[0], centre[1] - radius * pose->normal[1]},
        .radius = radius,
    };
    for (int i = 0; i < pose->coordinates; i++) {
        const double column[2] = {J[0][i], J[1][i]};
        touch->row[0][i] = along(column, pose->normal);
        touch->row[1][i] = along(column, pose->tangent) + radius * turn[i];
    }
}

bool stance_pose_contact(const stance_pose *pose, int index, stance_touch *touch)
{
    stance_contact_place at;
    if (!stance_mechanism_contact(pose->m, index, &at))
        return false;
    if (at.element >= 0) {
        const stance_element_numbers *const n = &pose->number.element[at.element];
        touch_ground(pose, at.body, at.end ? n->to : n->at, n->radius, touch);
        touch->rough = pose->m->element[at.element].rough ? n->friction_factor : 1;
        return true;
    }
    const int own = pose->own[at.body];
    const double q = pose->position[own], *limits = pose->number.body[at.body].limits;
    *touch = (stance_touch){.body = at.body,
                            .stop = true,
                            .gap = at.end ? limits[1] - q : q - limits[0],
                            .point = {pose->origin[at.body][0], pose->origin[at.body][1]}};
    touch->row[0][own] = at.end ? -1 : 1;
    return true;
}

void stance_pose_inertia(const stance_pose *pose, double *A)
{
    const int n = pose->coordinates;
    double J[2][STANCE_MAX_COORDINATES], turn[STANCE_MAX_COORDINATES], centre[2];
    memset(A, 0, (size_t)(n * n) * sizeof *A);
    for (int b = 0; b < pose->m->bodies; b++) {
        const stance_body_numbers *const body = &pose->number.body[b];
        stance_pose_point(pose, b, body->centre, centre);
        stance_pose_jacobian(pose, b, centre, J, turn);
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) {
                A[i * n + j] += body->mass * (J[0][i] * J[0][j] + J[1][i] * J[1][j]) +
                                body->inertia * (turn[i] * turn[j]);
            }
        }
        if (pose->own[b] >= 0 && pose->m->body[b].joint != STANCE_FREE)
            A[pose->own[b] * (n + 1)] += body->armature;
    }
}

void stance_pose_sticking(const stance_scene *scene, const stance_pose *pose, uint32_t supports,
                          stance_sticking *sticking)
{
    stance_touch touch;
    sticking->rows = 0;
    for (int c = 0; stance_pose_contact(pose, c, &touch); c++) {
        bool gripped = touch.stop;
        for (int k = 0; k < sticking->rows; k++)
            gripped = gripped || scene->grip[sticking->contact[k]] == scene->grip[c];
        for (int k = 0; (supports >> c & 1) && k < (gripped ? 1 : 2); k++) {
            sticking->touch[sticking->rows] = touch;
            sticking->contact[sticking->rows] = c;
            sticking->direction[sticking->rows++] = k;
        }
    }
}

/* ---- forces ---------------------------------------------------------------------------------- */

/* A force at a point of a body: dQ only. */
static void stiffen(const stance_pose *pose, int body, const double point[2], const double force[2],
                    double dQ[][STANCE_MAX_COORDINATES])
{
    for (int b = body; b >= 0; b = pose->m->body[b].parent) {
        const int i = pose->own[b];
        const double *const T = pose->axis[b];
        const double arm[2] = {point[0] - pose->pivot[b][0], point[1] - pose->pivot[b][1]};
        const double lever = pose->turns[b] ? along(force, arm) : force[0] * T[1] - force[1] * T[0];
        if (i < 0)
            continue;
        if (pose->turns[b])
            dQ[i][i] -= lever;
        for (int up = pose->m->body[b].parent; up >= 0; up = pose->m->body[up].parent) {
            if (pose->turns[up]) {
                dQ[i][pose->own[up]] -= lever;
                dQ[pose->own[up]][i] -= lever;
            }
        }
    }
}

static void add_contact_forces(const stance_pose *pose, const stance_sticking *sticking,
                               const double *force, double *Q, double dQ[][STANCE_MAX_COORDINATES])
{
    for (int k = 0; k < sticking->rows; k++) {
        const stance_touch *const touch = &sticking->touch[k];
        const double *const row = touch->row[sticking->direction[k]];
        const double *const way = sticking->direction[k] ? pose->tangent : pose->normal;
        double centre[2], push[2];
        for (int i = 0; i < pose->coordinates; i++)
            Q[i] += row[i] * force[k];
        for (int i = 0; i < 2; i++) {
            centre[i] = touch->point[i] + touch->radius * pose->normal[i];
            push[i] = force[k] * way[i];
        }
        if (!touch->stop)
            stiffen(pose, touch->body, centre, push, dQ);
    }
}

void stance_pose_forces(const stance_pose *pose, const double *torque,
                        const stance_sticking *sticking, const double *force, double *Q,
                        double dQ[][STANCE_MAX_COORDINATES])
{
    const stance_mechanism *const m = pose->m;
    double J[2][STANCE_MAX_COORDINATES], turn[STANCE_MAX_COORDINATES], centre[2];
    memset(Q, 0, (size_t)pose->coordinates * sizeof *Q);
    memset(dQ, 0, (size_t)pose->coordinates * sizeof *dQ);
    for (int b = 0; b < m->bodies; b++) {
        const stance_body_numbers *const body = &pose->number.body[b];
        const double weight[2] = {0, -body->mass * pose->gravity};
        stance_pose_point(pose, b, body->centre, centre);
        stance_pose_jacobian(pose, b, centre, J, turn);
        for (int i = 0; i < pose->coordinates; i++)
            Q[i] += weight[1] * J[1][i];
        stiffen(pose, b, centre, weight, dQ);
        const int i = pose->own[b];
        if (i >= 0 && m->body[b].joint != STANCE_FREE) {
            Q[i] -= body->stiffness * (pose->position[i] - body->rest);
            dQ[i][i] -= body->stiffness;
        }
    }
    for (int a = 0; a < m->actuators; a++)
        Q[pose->own[m->actuator[a].body]] += torque[a];
    add_contact_forces(pose, sticking, force, Q, dQ);
}

/* ---- the functions of the scene -------------------------------------------------------------- */

void stance_mechanism_gaps(const stance_scene *scene, const double *robot, const double *position,
                           double *gap)
{
    stance_pose pose;
    stance_touch touch;
    stance_pose_at(scene->mechanism, robot, position, &pose);
    for (int c = 0; stance_pose_contact(&pose, c, &touch); c++)
        gap[c] = touch.gap;
}

void stance_mechanism_contact_point(const stance_scene *scene, const double *robot,
                                    const double *position, const double *velocity, int contact,
                                    double point[2], double speed[2])
{
    stance_pose pose;
    stance_touch touch;
    stance_pose_at(scene->mechanism, robot, position, &pose);
    if (!stance_pose_contact(&pose, contact, &touch))
        return;
    memcpy(point, touch.point, sizeof touch.point);
    speed[0] = matrix_dot(pose.coordinates, touch.row[1], velocity);
    speed[1] = matrix_dot(pose.coordinates, touch.row[0], velocity);
}

/* The lowest of the contacts `supports`; the first of them in *first. */
static double lowest(const stance_pose *pose, uint32_t supports, stance_touch *first)
{
    double least = INFINITY;
    stance_touch touch;
    for (int c = 0; stance_pose_contact(pose, c, &touch); c++) {
        if (!(supports >> c & 1) || touch.stop)
            continue;
        if (least == INFINITY)
            *first = touch;
        least = fmin(least, touch.gap);
    }
    return least;
}

void stance_mechanism_stand(const stance_scene *scene, const double *robot, uint32_t supports,
                            double *position, double *velocity)
{
    stance_pose pose;
    stance_touch first = {0};
    if (scene->mechanism->body[0].joint != STANCE_FREE)
        return;
    position[0] = position[1] = 0;
    stance_pose_at(scene->mechanism, robot, position, &pose);
    const double least = lowest(&pose, supports, &first);
    if (least == INFINITY)
        return;
    const double arm = fabs(first.point[0]) + fabs(first.point[1]);
    const double beyond = fmax(0, first.gap - least);
    for (int k = 0; k < 2; k++)
        position[k] = beyond * pose.normal[k] - first.point[k];
    /* Where sums round downwards a foot would start inside the ground: the next heights. */
    for (double step = 0x1p-55 * arm;; step *= 2) {
        stance_pose_at(scene->mechanism, robot, position, &pose);
        if (!(lowest(&pose, supports, &first) < 0))
            break;
        position[1] = fmax(nextafter(position[1], INFINITY), position[1] + step);
    }
    velocity[0] = velocity[1] = 0;
    const double up = matrix_dot(pose.coordinates, first.row[0], velocity),
                 on = matrix_dot(pose.coordinates, first.row[1], velocity);
    for (int k = 0; k < 2; k++)
        velocity[k] = 0 - (up * pose.normal[k] + on * pose.tangent[k]);
}

bool stance_mechanism_fallen(const stance_scene *scene, const double *robot, const double *position)
{
    const stance_mechanism *const m = scene->mechanism;
    stance_pose pose;
    bool down = false;
    stance_pose_at(m, robot, position, &pose);
    for (int p = 0; p < m->points; p++) {
        double point[2];
        stance_pose_point(&pose, m->point[p].body, pose.number.point[p].at, point);
        down |= m->point[p].falls && along(point, pose.normal) <= pose.number.point[p].lowest;
    }
    for (int b = 0; b < m->bodies; b++)
        down |= m->body[b].bounded && fabs(pose.angle[b]) > pose.number.body[b].turn;
    return down;
}

double stance_mechanism_energy(const stance_scene *scene, const double *robot,
                               const double *position, const double *velocity)
{
    const stance_mechanism *const m = scene->mechanism;
    stance_pose pose;
    double J[2][STANCE_MAX_COORDINATES], turn[STANCE_MAX_COORDINATES], centre[2], sum = 0;
    stance_pose_at(m, robot, position, &pose);
    for (int b = 0; b < m->bodies; b++) {
        const stance_body_numbers *const body = &pose.number.body[b];
        stance_pose_point(&pose, b, body->centre, centre);
        stance_pose_jacobian(&pose, b, centre, J, turn);
        const double speed[2] = {matrix_dot(pose.coordinates, J[0], velocity),
                                 matrix_dot(pose.coordinates, J[1], velocity)};
        const double spin = matrix_dot(pose.coordinates, turn, velocity);
        sum += body->mass * (0.5 * along(speed, speed) + pose.gravity * centre[1]) +
               0.5 * body->inertia * (spin * spin);
        if (pose.own[b] >= 0 && m->body[b].joint != STANCE_FREE) {
            const double stretch = position[pose.own[b]] - body->rest;
            const double fast = velocity[pose.own[b]];
            sum +=
                0.5 * body->armature * (fast * fast) + 0.5 * body->stiffness * (stretch * stretch);
        }
    }
    return sum;
}

void stance_mechanism_inertia(const stance_scene *scene, const double *robot,
                              const double *position, double *A)
{
    stance_pose pose;
    stance_pose_at(scene->mechanism, robot, position, &pose);
    stance_pose_inertia(&pose, A);
}
