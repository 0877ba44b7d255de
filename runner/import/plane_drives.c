/* plane_drives.c - motors and servos of the file as actuators. */
#include "plane_tree.h"

#include <math.h>

/* What drives a link's joint. */
struct drive {
    int motor, servo, rate; /* index into the model's actuators; -1: none */
};

static int link_of_joint(const struct plane_tree *t, int j)
{
    for (int k = 0; k < t->links; k++)
        if (t->link[k].joint == j && t->link[k].kind != STANCE_FREE)
            return k;
    return -1;
}

static const char *name_of(const struct plane_tree *t, int a)
{
    const struct spatial_actuator *const actuator = &t->model->actuator[a];
    return actuator->name[0] ? actuator->name : actuator->target;
}

/* The link that an actuator drives; -1: left out, with a note; -2: refused. */
static int target(struct plane_tree *t, int a)
{
    const struct spatial_actuator *const actuator = &t->model->actuator[a];
    const char *const name = name_of(t, a);
    const int j = actuator->joint;
    const int link = j < 0 ? -1 : link_of_joint(t, j);
    const char *why = NULL;
    if (j < 0)
        why = "drives no joint that moves: take it out of the file";
    else if (actuator->drive == SPATIAL_GENERAL)
        why = "is neither a motor nor a position or velocity servo: write it as one of these";
    else if (!t->welded[j] && link < 0)
        why = "drives a free joint, or one of a link without mass: take it out of the file";
    if (why) {
        plane_say(t, actuator->line, "actuator '%.40s' %s", name, why);
        return -2;
    }
    if (link < 0)
        spatial_note(t->model, "actuator %.60s is left out: its joint is welded", name);
    return link;
}

static bool gather(struct plane_tree *t, struct drive *drive)
{
    for (int a = 0; a < t->model->actuators; a++) {
        const int k = target(t, a);
        if (k == -2)
            return false;
        if (k < 0)
            continue;
        const spatial_drive kind = t->model->actuator[a].drive;
        int *const list[] = {&drive[k].motor, &drive[k].servo, &drive[k].rate};
        int *const place = list[kind == SPATIAL_MOTOR ? 0 : kind == SPATIAL_POSITION ? 1 : 2];
        int other = -1; /* a servo of places and one of rates are one */
        for (int i = 0; i < 3; i++)
            if (*list[i] >= 0 && (place == list[i] || place == list[0] || i == 0))
                other = *list[i];
        if (other >= 0)
            return plane_refuse(t, t->model->actuator[a].line,
                                "actuators '%.50s' and '%.50s' drive one joint: leave one of them",
                                name_of(t, other), name_of(t, a));
        *place = a;
    }
    return true;
}

/* What either way has; of a range to one side the whole. */
static double limit_of(struct plane_tree *t, int a)
{
    const struct spatial_actuator *const actuator = &t->model->actuator[a];
    const double down = -actuator->least, up = actuator->most;
    if (!actuator->limited)
        return INFINITY;
    const double limit = fmin(down, up) > 0 ? fmin(down, up) : fmax(fabs(down), fabs(up));
    if (fabs(down - up) > 1e-12 * (fabs(down) + fabs(up)) && isfinite(limit))
        spatial_note(t->model, "actuator %.60s gives %.6g to %.6g in the file, -%.6g to %.6g here",
                     name_of(t, a), 0 - down, up + 0.0, limit, limit);
    return limit;
}

static bool too_many(const struct plane_tree *t, const struct drive *drive, int count)
{
    char list[140] = "";
    int n = 0;
    for (int k = 0; k < t->links; k++)
        if (drive[k].motor >= 0 || drive[k].servo >= 0 || drive[k].rate >= 0)
            add_text(list, sizeof list, "%s%.20s", n++ ? ", " : "",
                     plane_joint_name(t, t->link[k].joint));
    return plane_refuse(t, 0, "%d joints are driven; at most %d: --weld some of %s", count,
                        STANCE_MAX_ACTUATORS, list);
}

static bool same(double a, double b)
{
    return fabs(a - b) <= 1e-9 * (fabs(a) + fabs(b));
}

/* The law `hold` has one stiffness and one damping for all. */
static void take_servos(struct plane_tree *t, const double (*gain)[2], int servos)
{
    struct plane_robot *const robot = t->robot;
    const int count = robot->mechanism.actuators;
    bool alike = servos == count;
    for (int a = 1; a < count; a++)
        alike = alike && same(gain[a][0], gain[0][0]) && same(gain[a][1], gain[0][1]);
    if (servos == 0)
        return;
    robot->hold = alike;
    if (alike) {
        robot->kp = gain[0][0];
        robot->kd = gain[0][1];
        spatial_note(t->model, "the servos hold the initial posture (controller.target)");
        return;
    }
    for (int a = 0; a < count; a++)
        if (gain[a][0] != 0 || gain[a][1] != 0)
            spatial_note(t->model,
                         "servo %s, kp %.6g, kd %.6g, is a motor here: `hold` has one gain for all",
                         robot->mechanism.actuator[a].name, gain[a][0] + 0.0, gain[a][1] + 0.0);
}

/* An actuator of the scenario from those of one joint. */
static void take(struct plane_tree *t, int k, const struct drive *drive, double gain[2])
{
    stance_mechanism *const m = &t->robot->mechanism;
    const struct spatial_actuator *const list = t->model->actuator;
    const int n = m->actuators, first = drive->motor >= 0   ? drive->motor
                                        : drive->servo >= 0 ? drive->servo
                                                            : drive->rate;
    m->actuator[n].body = k;
    m->value.limit[n] = limit_of(t, first);
    gain[0] = gain[1] = 0;
    if (drive->servo >= 0) {
        gain[0] = list[drive->servo].kp;
        gain[1] = list[drive->servo].kd;
    }
    if (drive->rate >= 0)
        gain[1] += list[drive->rate].kd;
    if (drive->servo >= 0 && drive->rate >= 0)
        m->value.limit[n] += limit_of(t, drive->rate);
    plane_name_actuator(t, n, t->model->joint[t->link[k].joint].name, list[first].name);
    t->robot->map.actuator[n].actuator = first;
    t->robot->map.actuator[n].sign = t->link[k].sign;
    t->robot->map.actuators = ++m->actuators;
}

bool plane_drives(struct plane_tree *t)
{
    struct drive drive[STANCE_MAX_BODIES];
    double gain[STANCE_MAX_ACTUATORS][2];
    int count = 0, servos = 0;
    for (int k = 0; k < t->links; k++)
        drive[k] = (struct drive){-1, -1, -1};
    if (!gather(t, drive))
        return false;
    for (int k = 0; k < t->links; k++)
        count += drive[k].motor >= 0 || drive[k].servo >= 0 || drive[k].rate >= 0;
    if (count > STANCE_MAX_ACTUATORS)
        return too_many(t, drive, count);
    for (int k = 0; k < t->links; k++)
        if (drive[k].motor >= 0 || drive[k].servo >= 0 || drive[k].rate >= 0) {
            servos += drive[k].motor < 0;
            take(t, k, &drive[k], gain[t->robot->mechanism.actuators]);
        }
    take_servos(t, gain, servos);
    return true;
}
