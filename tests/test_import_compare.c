/* test_import_compare.c - what the comparison of an imported robot with its file sees: each number
 * that moves the robot, off by a millionth; and what has no effect in the plane, which it does not.
 *
 * Skipped without libmujoco.
 */
#include "support.h"

#include "runner/import/compare.h"
#include "runner/plan/mjcf.h"

struct robot {
    struct spatial_model model;
    struct plane_robot plane;
    stance_scene *scene;
    stance_case c;
};

static void begin(struct robot *r, const char *path)
{
    spatial_message message = {""};
    stance_message fault = {""};
    const struct plane_wishes wishes = {.plane = NULL};
    memset(r, 0, sizeof *r);
    if (!urdf_read(path, &r->model, &message) ||
        !plane_make(&r->model, &wishes, &r->plane, &message) ||
        stance_mechanism_scene(&r->plane.mechanism, &r->scene, &fault) != STANCE_OK)
        fail_msg("%s%s", message.text, fault.text);
    for (int i = 0; i < r->scene->robot_count; i++)
        r->c.robot[i] = r->scene->robot[i].fallback;
    r->c.robot[STANCE_ROBOT_GRAVITY] = r->plane.gravity;
    r->c.step = r->plane.step > 0 ? r->plane.step : 1e-3;
    r->c.torque_limit = INFINITY;
}

static void end(struct robot *r)
{
    stance_scene_free(r->scene);
    plane_free(&r->plane);
    spatial_free(&r->model);
}

/* How far off they are; NAN: there is no libmujoco. */
static double off(struct robot *r)
{
    struct compare_report report;
    spatial_message message = {""};
    if (!import_compare(&r->model, "", &r->plane.map, r->scene, &r->c, &report, &message)) {
        if (!strstr(message.text, "libmujoco"))
            fail_msg("%s", message.text);
        return NAN;
    }
    assert_int_equal(report.states, 100);
    assert_in_range(report.state, 1, 100);
    assert_in_range(report.coordinate, 0, r->scene->coordinates - 1);
    return report.worst;
}

static bool same(double worst)
{
    return worst <= COMPARE_ADMITTED;
}

/* Where *number is another one, the robots differ, or do not. */
static void differs(struct robot *r, const char *what, double *number, double other, bool seen)
{
    const double was = *number;
    *number = other;
    if (same(off(r)) == seen)
        fail_msg("%s %.17g in place of %.17g: seen where it should not, or not seen: %g", what,
                 other, was, off(r));
    *number = was;
}

#define SEEN(what) differs(&r, #what, &(what), (what) * (1 + 1e-6), true)
#define NOT_SEEN(what) differs(&r, #what, &(what), (what) + 0.01, false)

TEST(bodies_and_joints)
{
    struct robot r;
    begin(&r, "tests/robots/spring_hopper.urdf");
    struct spatial_body *const body = r.model.body;
    struct spatial_joint *const joint = r.model.joint;
    if (isnan(off(&r))) {
        end(&r);
        skip();
    }
    assert_true(same(off(&r)));
    for (int b = 0; b < r.model.bodies; b++) {
        SEEN(body[b].mass);
        SEEN(body[b].inertia[1][1]);
        SEEN(body[b].centre[2]);
        NOT_SEEN(body[b].centre[1]);
        NOT_SEEN(body[b].inertia[0][0]);
        NOT_SEEN(body[b].at[1]);
    }
    SEEN(body[2].at[2]);
    SEEN(joint[3].armature);
    SEEN(joint[4].stiffness);
    SEEN(joint[4].spring_reference);
    SEEN(joint[4].damping);
    SEEN(r.model.gravity[2]);
    differs(&r, "root_angle", &r.plane.map.root_angle, 1e-6, true);
    SEEN(r.plane.map.coordinate[3].sign);
    differs(&r, "sign", &r.plane.map.actuator[0].sign, -r.plane.map.actuator[0].sign, true);
    assert_true(same(off(&r)));
    end(&r);
}

/* Products of inertia with the normal, and in the plane. */
TEST(tensors)
{
    struct robot r;
    begin(&r, "tests/robots/turned_leg.urdf");
    struct spatial_body *const body = r.model.body;
    if (isnan(off(&r))) {
        end(&r);
        skip();
    }
    const double products[] = {1e-3, -2e-3, 0.05};
    for (int b = 0; b < r.model.bodies; b++) {
        const bool down = body[b].rotation[2][0] == -1; /* the shank, about its z */
        for (int k = 0; k < 3 && !down; k++) {
            body[b].inertia[1][0] = body[b].inertia[0][1] = products[k];
            body[b].inertia[1][2] = body[b].inertia[2][1] = -products[k];
            body[b].inertia[2][0] = body[b].inertia[0][2] = 2 * products[k];
            assert_true(same(off(&r)));
        }
        if (down) {
            SEEN(body[b].inertia[2][2]);
            SEEN(body[b].centre[1]);
        }
    }
    differs(&r, "axis", &r.model.joint[1].axis[1], -1, true);
    end(&r);
}

TEST(sentences)
{
    char text[400];
    struct compare_report report = {
        .itself = true, .states = 100, .worst = 3.1e-13, .state = 17, .coordinate = 2};
    const stance_scene *const biped = stance_scene_find("biped");
    assert_non_null(strstr(compare_sentence(&report, biped, text, sizeof text),
                           "agree with the file's to 3.1e-13 (relative, largest at state 17"));
    assert_non_null(strstr(text, biped->coordinate[2].name));
    report.worst = 2e-9;
    assert_non_null(strstr(compare_sentence(&report, biped, text, sizeof text), "DIFFER"));
    report.worst = NAN;
    assert_non_null(strstr(compare_sentence(&report, biped, text, sizeof text), "DIFFER"));
}
