/* plane_drives.c - motors and servos of the file as actuators. */
#include "plane_tree.h"

static const char *name_of(const struct spatial_actuator *actuator)
{
    return actuator->name[0] ? actuator->name : actuator->target;
}

/* Refuses what drives no link's joint, and tells what is left out. */
static bool check(struct plane_tree *t, const struct spatial_actuator *actuator)
{
    const int j = actuator->joint;
    const char *why = NULL;
    if (j < 0)
        why = "drives no joint that moves: take it out of the file";
    else if (actuator->drive == SPATIAL_GENERAL)
        why = "is neither a motor nor a position or velocity servo: write it as one of these";
    else if (t->held[j])
        spatial_note(t->model, "actuator %.60s is left out: its joint is welded, or moves no mass",
                     name_of(actuator));
    else if (t->model->joint[j].kind == SPATIAL_FREE)
        why = "drives a free joint: take it out of the file";
    return !why || plane_refuse(t, actuator->line, "actuator '%.40s' %s", name_of(actuator), why);
}

/* What either way has; of a range to one side the whole. */
static double limit_of(struct plane_tree *t, const struct spatial_actuator *actuator)
{
    const double down = -actuator->least, up = actuator->most;
    const double limit = fmin(down, up) > 0 ? fmin(down, up) : fmax(fabs(down), fabs(up));
    if (!actuator->limited)
        return INFINITY;
    if (fabs(down - up) > 1e-12 * (fabs(down) + fabs(up)) && isfinite(limit))
        spatial_note(t->model, "actuator %.60s gives %.6g to %.6g in the file, -%.6g to %.6g here",
                     name_of(actuator), 0 - down, up + 0.0, limit, limit);
    return limit;
}

static bool too_many(const struct plane_tree *t)
{
    char list[140] = "";
    int count = 0;
    for (int k = 0; k < t->links; k++) {
        bool driven = false;
        for (int a = 0; a < t->model->actuators; a++)
            driven = driven || t->model->actuator[a].joint == t->link[k].joint;
        if (driven)
            add_text(list, sizeof list, "%s%.20s", count++ ? ", " : "",
                     plane_joint_name(t, t->link[k].joint));
    }
    return plane_refuse(t, 0, "%d joints are driven; at most %d: --weld some of %s", count,
                        STANCE_MAX_ACTUATORS, list);
}

/* The actuator of a link's joint, if it has one: a motor, or a servo of places, of rates, or one of
 * each. `gain` is of that joint. */
static bool take(struct plane_tree *t, int k, double gain[2])
{
    stance_mechanism *const m = &t->robot->mechanism;
    const struct spatial_actuator *first = NULL, *second = NULL;
    const int n = m->actuators;
    for (int a = 0; a < t->model->actuators; a++) {
        const struct spatial_actuator *const actuator = &t->model->actuator[a];
        if (actuator->joint != t->link[k].joint)
            continue;
        if (first && (second || first->drive == SPATIAL_MOTOR || actuator->drive == SPATIAL_MOTOR ||
                      first->drive == actuator->drive))
            return plane_refuse(t, actuator->line,
                                "actuators '%.50s' and '%.50s' drive one joint: leave one of them",
                                name_of(first), name_of(actuator));
        *(first ? &second : &first) = actuator;
    }
    if (!first)
        return true;
    if (n == STANCE_MAX_ACTUATORS)
        return too_many(t);
    m->actuator[n].body = k;
    m->value.limit[n] = limit_of(t, first) + (second ? limit_of(t, second) : 0);
    gain[0] = first->kp + (second ? second->kp : 0);
    gain[1] = first->kd + (second ? second->kd : 0);
    plane_name_actuator(t, n, t->model->joint[t->link[k].joint].name, first->name);
    t->robot->map.actuator[n].actuator = (int)(first - t->model->actuator);
    t->robot->map.actuator[n].sign = t->link[k].sign;
    t->robot->map.actuators = ++m->actuators;
    return true;
}

static bool same(double a, double b)
{
    return fabs(a - b) <= 1e-9 * (fabs(a) + fabs(b));
}

/* The law `hold` has one stiffness and one damping for all. */
static void take_servos(struct plane_tree *t, const double (*gain)[2])
{
    struct plane_robot *const robot = t->robot;
    int servos = 0;
    robot->hold = robot->mechanism.actuators > 0;
    for (int a = 0; a < robot->mechanism.actuators; a++) {
        const bool servo =
            t->model->actuator[robot->map.actuator[a].actuator].drive != SPATIAL_MOTOR;
        servos += servo;
        robot->hold =
            robot->hold && servo && same(gain[a][0], gain[0][0]) && same(gain[a][1], gain[0][1]);
    }
    robot->kp = gain[0][0];
    robot->kd = gain[0][1];
    if (robot->hold)
        spatial_note(t->model, "the servos hold the initial posture (controller.target)");
    for (int a = 0; servos > 0 && !robot->hold && a < robot->mechanism.actuators; a++)
        if (gain[a][0] != 0 || gain[a][1] != 0)
            spatial_note(t->model,
                         "servo %s, kp %.6g, kd %.6g, is a motor here: `hold` has one gain for all",
                         robot->mechanism.actuator[a].name, gain[a][0] + 0.0, gain[a][1] + 0.0);
}

bool plane_drives(struct plane_tree *t)
{
    double gain[STANCE_MAX_ACTUATORS + 1][2] = {{0}};
    for (int a = 0; a < t->model->actuators; a++)
        if (!check(t, &t->model->actuator[a]))
            return false;
    for (int k = t->robot->map.free_root; k < t->links; k++)
        if (!take(t, k, gain[t->robot->mechanism.actuators]))
            return false;
    take_servos(t, gain);
    return true;
}
