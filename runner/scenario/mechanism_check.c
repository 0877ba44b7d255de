/* mechanism_check.c - what must hold of a mechanism's numbers together, whatever axes make of them.
 */
#include "mechanism.h"
#include "reader.h"
#include "schema_mechanism.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the inertia matrix scaled to unit diagonal: below it nothing resists some acceleration. */
#define LEAST_EIGENVALUE 1e-10
enum { POSTURES = 64 };

/* What is wrong with some numbers: of which key, and why. */
struct fault {
    char path[96], text[200];
};

#define FAULT(f, what, name, key, ...)                                                             \
    (snprintf((f)->path, sizeof(f)->path, what ".%.31s%s", name, key),                             \
     snprintf((f)->text, sizeof(f)->text, __VA_ARGS__), true)

/* ---- body by body ---------------------------------------------------------------------------- */

static bool body_fault(const stance_mechanism *m, const stance_mechanism_numbers *number, int b,
                       struct fault *f)
{
    const stance_body_numbers *const body = &number->body[b];
    const char *const name = m->body[b].name;
    if (body->inertia > 0 && !(body->mass > 0))
        return FAULT(f, "robot.bodies", name, ".inertia", "%.6g kg m^2, but no mass",
                     body->inertia);
    if (!(body->limits[0] < body->limits[1]))
        return FAULT(f, "robot.bodies", name, ".limits", "%.6g is not below %.6g", body->limits[0],
                     body->limits[1]);
    if (m->body[b].joint == STANCE_SLIDE && body->axis[0] == 0 && body->axis[1] == 0)
        return FAULT(f, "robot.bodies", name, ".axis", "[0, 0] has no direction");
    return false;
}

/* ---- the ground ------------------------------------------------------------------------------ */

/* The one before of those that are always there, or of those by footfall; -1: none. */
static int plate_before(const stance_mechanism *m, int i)
{
    int before = i - 1;
    while (before >= 0 && m->plate[before].by_footfall != m->plate[i].by_footfall)
        before--;
    return before;
}

/* A piece begins behind the one before it, or is laid later. */
static bool order_fault(const stance_mechanism *m, const stance_mechanism_numbers *number, int i,
                        struct fault *f)
{
    const stance_plate_numbers *const plate = &number->plate[i];
    const int before = plate_before(m, i);
    const stance_plate_numbers *const other = before < 0 ? NULL : &number->plate[before];
    if (other && plate->footfall < other->footfall)
        return FAULT(f, "ground.plates", m->plate[i].name, ".footfall",
                     "%.9g is before that of %.31s, %.9g: pieces stand in their order",
                     plate->footfall, m->plate[before].name, other->footfall);
    return other && plate->footfall == other->footfall && !(plate->from > other->from) &&
           FAULT(f, "ground.plates", m->plate[i].name, ".from",
                 "%.6g m is not beyond %.31s, at %.6g m: pieces stand in their order", plate->from,
                 m->plate[before].name, other->from);
}

static bool plate_fault(const stance_mechanism *m, const stance_mechanism_numbers *number, int i,
                        struct fault *f)
{
    const stance_plate_numbers *const plate = &number->plate[i];
    const char *const name = m->plate[i].name;
    if (m->plate[i].kind != STANCE_PLATE && !(plate->width > 0))
        return FAULT(f, "ground.plates", name, "", "width is missing: how wide each plate is");
    if (m->plate[i].kind == STANCE_ROUGH && plate->height < 0)
        return FAULT(f, "ground.plates", name, ".height",
                     "%.6g m; rough ground goes up and down by 0 m or more", plate->height);
    if (m->plate[i].by_footfall && !(plate->from > 0))
        return FAULT(f, "ground.plates", name, ".from",
                     "%.6g m is not ahead of the foot that stands before the footfall",
                     plate->from);
    return order_fault(m, number, i, f);
}

/* Over an edge what is round would turn about it. */
static bool round_fault(const stance_scene *scene, const stance_mechanism_numbers *number,
                        uint32_t contacts, struct fault *f)
{
    const stance_mechanism *const m = scene->mechanism;
    for (int e = 0; m->plates > 0 && e < m->elements; e++) {
        if (!(number->element[e].radius > 0) ||
            !(mechanism_contacts(scene, UINT32_C(1) << e) & contacts))
            continue;
        snprintf(f->path, sizeof f->path, "ground.plates");
        snprintf(f->text, sizeof f->text,
                 "%.31s is round and would turn about their edges, which is not modelled: make it "
                 "a point or a flat sole, or leave it out of ground.contacts",
                 m->element[e].name);
        return true;
    }
    return false;
}

/* ---- inertia --------------------------------------------------------------------------------- */

/* The motion that nothing resists: of coordinate i by 1, and of those before it, where Cholesky's
 * factors of their rows are in A. */
static void free_motion(int n, int i, const double *A, double *motion)
{
    for (int j = i - 1; j >= 0; j--) {
        motion[j] = -A[i * n + j];
        for (int k = j + 1; k < i; k++)
            motion[j] -= A[k * n + j] * motion[k];
        motion[j] /= A[j * n + j];
    }
    motion[i] = 1;
}

/* Cholesky's factors of the inertia matrix, scaled to unit diagonal, less LEAST_EIGENVALUE times
 * the identity: false where a pivot is not positive; in `motion`, of zeros before, what nothing
 * resists then. */
static bool resisted(int n, double *A, double *motion)
{
    double scale[STANCE_MAX_COORDINATES];
    for (int i = 0; i < n; i++) {
        if (!(A[i * n + i] > 0)) {
            motion[i] = 1;
            return false;
        }
        scale[i] = sqrt(A[i * n + i]);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = i == j ? 1 - LEAST_EIGENVALUE : A[i * n + j] / (scale[i] * scale[j]);
            for (int k = 0; k < j; k++)
                sum -= A[i * n + k] * A[j * n + k];
            if (i == j && !(sum > 0)) {
                free_motion(n, i, A, motion);
                return false;
            }
            A[i * n + j] = i == j ? sqrt(sum) : sum / A[j * n + j];
        }
    }
    return true;
}

/* Whose motion it is: the first body's that takes part, since those that hang from a body without
 * inertia turn back what it turns. -1: the robot's as a whole. */
static int culprit(const stance_scene *scene, const double *motion)
{
    for (int i = 0; i < scene->coordinates; i++)
        if (fabs(motion[i]) > 1e-3 && strcmp(scene->coordinate[i].name, "x") != 0 &&
            strcmp(scene->coordinate[i].name, "z") != 0)
            return i;
    return -1;
}

/* In postures spread evenly: multiples of roots of primes, modulo a turn. */
static bool inertia_fault(const stance_scene *scene, const double *robot, struct fault *f)
{
    static const double prime[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41};
    _Static_assert(sizeof prime / sizeof *prime >= STANCE_MAX_COORDINATES, "one for each");
    const int n = scene->coordinates;
    double position[STANCE_MAX_COORDINATES], motion[STANCE_MAX_COORDINATES] = {0};
    double A[STANCE_MAX_COORDINATES * STANCE_MAX_COORDINATES];
    for (int k = 0; k < POSTURES; k++) {
        for (int i = 0; i < n; i++)
            position[i] = 6.283185307179586 * fmod(k * sqrt(prime[i]), 1);
        scene->inertia(scene, robot, position, A);
        if (resisted(n, A, motion))
            continue;
        const int i = culprit(scene, motion);
        int b = 0;
        while (i >= 0 && (scene->mechanism->body[b].joint == STANCE_FIXED ||
                          stance_mechanism_coordinate(scene->mechanism, b) != i))
            b++;
        snprintf(f->path, sizeof f->path, "robot.bodies%s%s", i < 0 ? "" : ".",
                 i < 0 ? "" : scene->mechanism->body[b].name);
        snprintf(f->text, sizeof f->text, "%s",
                 i < 0 ? "nothing with mass resists motion"
                 : strcmp(scene->coordinate[i].unit, "m") == 0
                     ? "nothing with mass resists its sliding: give it, or what hangs from it, mass"
                     : "nothing resists its turning: give it inertia, or mass off its joint");
        return true;
    }
    return false;
}

static bool find_fault(const struct reader *r, const double *robot, struct fault *f)
{
    const stance_scene *const scene = r->s->scene;
    const stance_mechanism *const m = scene->mechanism;
    stance_mechanism_numbers number;
    stance_mechanism_expand(m, robot, &number);
    for (int b = 0; b < m->bodies; b++)
        if (body_fault(m, &number, b, f))
            return true;
    for (int e = 0; e < m->elements; e++) {
        const stance_element_numbers *const sole = &number.element[e];
        if (m->element[e].sole && sole->at[0] == sole->to[0] && sole->at[1] == sole->to[1])
            return FAULT(f, "robot.contacts", m->element[e].name, ".to",
                         "stands where from does: a sole has a length");
    }
    for (int p = 0; p < m->points; p++) {
        const stance_point_numbers *const point = &number.point[p];
        if (m->point[p].pushed == STANCE_FORCE && point->to < point->from)
            return FAULT(f, "robot.points", m->point[p].name, ".to",
                         "%.6g s is before from, %.6g s", point->to, point->from);
    }
    for (int i = 0; i < m->plates && r->problems.count == 0; i++) /* else one may be missing */
        if (plate_fault(m, &number, i, f))
            return true;
    if (round_fault(scene, &number, (uint32_t)r->s->base.contacts, f))
        return true;
    return inertia_fault(scene, robot, f);
}

/* ---- as they stand, and along axes ----------------------------------------------------------- */

static bool is_robot(size_t offset)
{
    return offset - offsetof(struct scenario_values, robot) <
           sizeof(double[STANCE_ROBOT_FALL_HEIGHT]);
}

/* A point of an axis, with path k of it in mind. */
struct corner {
    const struct scenario_axis *axis;
    int k;
    size_t point;
};

/* The points of an axis where a path has its first and its last, or its least and its largest
 * value. */
static void find_ends(const struct scenario_axis *axis, int k, size_t end[2])
{
    scenario_ends(axis->value ? axis->value + k : NULL, axis->count, (size_t)axis->paths, end);
}

/* The robot with what axes make of it at some points. False: a problem, reported of the last. */
static bool check_corner(struct reader *r, const double *first, const struct corner *corner,
                         int count)
{
    const struct corner *const last = &corner[count - 1];
    const size_t begin = offsetof(struct scenario_values, robot);
    const int a = (int)(last->axis - r->s->axis);
    double robot[STANCE_MAX_ROBOT];
    char with[300] = "", name[AXIS_NAME];
    struct fault fault;
    memcpy(robot, first, sizeof robot);
    for (int i = 0; i < count; i++) {
        const struct scenario_axis *const axis = corner[i].axis;
        for (int k = 0; k < axis->paths; k++)
            if (is_robot(axis->offset[k]))
                robot[(axis->offset[k] - begin) / sizeof *robot] =
                    scenario_axis_value(axis, corner[i].point, k);
        add_text(with, sizeof with, "%s%s = %.6g", i ? " and " : "", axis->path[corner[i].k],
                 scenario_axis_value(axis, corner[i].point, corner[i].k));
    }
    return !find_fault(r, robot, &fault) ||
           problem_add(&r->problems, r->swept[a][last->k].mark, "%s: with %s %s: %s",
                       axis_key(r->s, a, name), with, fault.path, fault.text);
}

/* The ends of all paths of the robot, at the first point of all other axes. */
static bool check_axes(struct reader *r, const double *first)
{
    bool any = false;
    for (int a = 0; a < r->s->axes; a++) {
        const struct scenario_axis *const axis = &r->s->axis[a];
        for (int k = 0; k < axis->paths; k++) {
            size_t end[2];
            if (!is_robot(axis->offset[k]))
                continue;
            any = true;
            find_ends(axis, k, end);
            for (int e = 0; e < 2; e++)
                if (!check_corner(r, first, &(struct corner){axis, k, end[e]}, 1))
                    return true;
        }
    }
    return any;
}

/* A number of two plates that both vary: the axes, and which path of each. */
static bool find_both(const struct reader *r, const int plate[2], const char *key,
                      struct corner both[2])
{
    for (int i = 0; i < 2; i++) {
        char path[96];
        snprintf(path, sizeof path, "ground.plates.%.31s.%s",
                 r->s->scene->mechanism->plate[plate[i]].name, key);
        const struct scenario_field *const field = schema_find(r->schema, path);
        both[i].axis = field ? scenario_axis_of(r->s, field->offset, &both[i].k) : NULL;
        if (!both[i].axis)
            return false;
    }
    return true;
}

/* The point of an axis where path l is least beyond path k; evenly between the ends of a range. */
static size_t nearest(const struct scenario_axis *axis, int k, int l)
{
    const size_t stride = axis->value || axis->count < 3 ? 1 : axis->count - 1;
    size_t near = 0;
    double least = INFINITY;
    for (size_t i = 0; i < axis->count; i += stride) {
        const double apart = scenario_axis_value(axis, i, l) - scenario_axis_value(axis, i, k);
        near = apart < least ? i : near;
        least = fmin(apart, least);
    }
    return near;
}

/* Where a number of two plates varies: on one axis where they are nearest to each other, on two at
 * all that their ends make. */
static bool check_both(struct reader *r, const double *first, struct corner both[2])
{
    size_t end[2][2];
    if (both[0].axis == both[1].axis) {
        both[0].point = both[1].point = nearest(both[0].axis, both[0].k, both[1].k);
        return check_corner(r, first, both, 2);
    }
    for (int i = 0; i < 2; i++)
        find_ends(both[i].axis, both[i].k, end[i]);
    for (int c = 0; c < 4; c++) {
        both[0].point = end[0][c & 1];
        both[1].point = end[1][c >> 1];
        if (!check_corner(r, first, both, 2))
            return false;
    }
    return true;
}

/* The order of plates, each with the one before it of its kind. */
static void check_order(struct reader *r, const double *first)
{
    static const char *const key[] = {"from", "footfall"};
    const stance_mechanism *const m = r->s->scene->mechanism;
    for (int i = 1; i < m->plates; i++) {
        struct corner both[2];
        const int pair[2] = {plate_before(m, i), i};
        for (int k = 0; pair[0] >= 0 && k < 2; k++)
            if (find_both(r, pair, key[k], both) && !check_both(r, first, both))
                return;
    }
}

/* The robot that the design believes in, where it is another one. */
static void check_model(struct reader *r, const struct scenario_values *values)
{
    double model[STANCE_MAX_ROBOT];
    struct fault fault;
    bool other = false;
    memcpy(model, values->robot, sizeof model);
    for (int i = 0; i < r->s->scene->robot_count; i++)
        if (!isnan(values->model[i])) {
            model[i] = values->model[i];
            other = true;
        }
    if (!other || !find_fault(r, model, &fault))
        return;
    char path[sizeof fault.path + 16];
    snprintf(path, sizeof path, "controller.model%.90s", fault.path + strlen("robot"));
    reader_refuse(r, path, ": %s", fault.text);
}

void mechanism_check(struct reader *r)
{
    struct scenario_values *const values = malloc(sizeof *values);
    struct fault fault;
    if (!values) {
        problem_no_memory(&r->problems);
        return;
    }
    memcpy(values, &r->s->base, sizeof *values);
    if (!r->axes_bad)
        scenario_case_values(r->s, 0, values);
    if ((r->axes_bad || !check_axes(r, values->robot)) && find_fault(r, values->robot, &fault))
        reader_refuse(r, fault.path, ": %s", fault.text);
    else
        check_model(r, values);
    if (!r->axes_bad && r->problems.count == 0)
        check_order(r, values->robot);
    free(values);
}
