/* warnings.c - see warnings.h. Linear theory about the equilibrium, as `stance design` has it. */
#include "warnings.h"

#include "design.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIED = 64 }; /* cases, evenly spread */

enum trouble { UNSTABLE, WEAK, SLIPPERY, TROUBLES };

/* Of each trouble: how many cases have it, and of the first one the case and what is wrong. */
struct troubles {
    size_t count[TROUBLES];
    uint64_t first[TROUBLES];
    char what[TROUBLES][200];
};

static bool first_of(struct troubles *t, enum trouble trouble, uint64_t index)
{
    if (t->count[trouble]++ > 0)
        return false;
    t->first[trouble] = index;
    return true;
}

static void look_at_torques(const struct design_report *r, uint64_t index, struct troubles *t)
{
    const stance_scene *const scene = r->scenario->scene;
    double limit[STANCE_MAX_ACTUATORS];
    stance_torque_limits(scene, r->scenario->base.robot, r->scenario->base.torque_limit, limit);
    for (int i = 0; i < scene->actuators; i++) {
        const double needed = fabs(r->equilibrium.torque[i]);
        if (needed > limit[i] && first_of(t, WEAK, index))
            snprintf(t->what[WEAK], sizeof t->what[WEAK],
                     "the equilibrium takes %.3g of %.40s, which gives %.3g at most", needed,
                     scene->actuator_name[i], limit[i]);
        if (needed > limit[i])
            return;
    }
}

/* At the equilibrium, where contacts stick. */
static void look_at_friction(const struct design_report *r, uint64_t index, struct troubles *t)
{
    enum { STATES = 2 * STANCE_MAX_POSTURE };
    const stance_scene *const scene = r->scenario->scene;
    double force[STANCE_MAX_CONTACTS][2];
    double by_state[STANCE_MAX_CONTACTS * 2 * DESIGN_STATES];
    double by_torque[STANCE_MAX_CONTACTS * 2 * DESIGN_INPUTS];
    if (!scene->contact_force ||
        scene->contact_force(scene, r->model, &r->equilibrium, &force[0][0], by_state, by_torque) !=
            STANCE_OK)
        return;
    for (int c = 0, k = 0; c < scene->contacts; c++) {
        if (!(r->equilibrium.supports >> c & 1))
            continue;
        const double used = fabs(force[k][1]) / force[k][0];
        k++;
        if (!(used > r->scenario->base.friction * (1 + 1e-9)) || !(force[k - 1][0] > 0))
            continue;
        if (first_of(t, SLIPPERY, index))
            snprintf(t->what[SLIPPERY], sizeof t->what[SLIPPERY],
                     "standing on %.40s takes friction %.3g, there is %.3g", scene->contact_name[c],
                     used, r->scenario->base.friction);
        return;
    }
}

static void look_at(const struct scenario *s, uint64_t index, struct troubles *t)
{
    struct scenario *const at = malloc(sizeof *at);
    struct design_report *const r = malloc(sizeof *r);
    stance_message message = {""};
    if (at && r) {
        *at = *s;
        scenario_case_values(s, index, &at->base);
        if (scenario_law(&at->base)->designed && design_loop(r, at, &message)) {
            if (!r->stable && first_of(t, UNSTABLE, index) && r->sampled > 0)
                snprintf(t->what[UNSTABLE], sizeof t->what[UNSTABLE],
                         "the loop is unstable: spectral radius %.3g at a sample time of %.3g s%s",
                         r->radius, at->base.sample_time, r->delay ? ", a sample late" : "");
            else if (!r->stable && !t->what[UNSTABLE][0])
                snprintf(t->what[UNSTABLE], sizeof t->what[UNSTABLE],
                         "the loop is unstable: an eigenvalue is not on the left");
            look_at_torques(r, index, t);
            look_at_friction(r, index, t);
        }
    }
    free(at);
    free(r);
}

/* Initial angles of the first and the last case that are more than a turn. */
static void look_at_angles(const struct plan *plan, const char *who, FILE *out)
{
    const stance_scene *const scene = plan->scenario->scene;
    stance_case *const c = malloc(sizeof *c);
    bool said = c == NULL;
    for (int end = 0; end < 2 && !said; end++) {
        int method;
        if (!plan_resolve(plan, end ? plan->rows - 1 : 0, c, &method))
            continue;
        for (int i = 0; i < scene->coordinates && !said; i++) {
            said = strcmp(scene->coordinate[i].unit, "rad") == 0 && fabs(c->position[i]) > 2 * M_PI;
            if (said)
                fprintf(out,
                        "%s: warning: %s begins at %g rad, more than a turn: is that %g "
                        "degrees? angles are in radians\n",
                        who, scene->coordinate[i].name, c->position[i], c->position[i]);
        }
    }
    free(c);
}

void warnings_print(const struct plan *plan, const char *who, FILE *out)
{
    const uint64_t tried = plan->rows < TRIED ? plan->rows : TRIED;
    struct troubles t = {{0}, {0}, {""}};
    for (uint64_t k = 0; k < tried && plan->scenario->scene->linearise; k++) {
        const uint64_t row =
            tried < 2 ? 0 : (uint64_t)((double)(plan->rows - 1) * (double)k / (double)(tried - 1));
        const uint64_t index = plan_case(plan, row);
        if (plan->design_status[plan_design(plan, index)] == STANCE_DONE)
            look_at(plan->scenario, index, &t);
    }
    for (int k = 0; k < TROUBLES; k++) {
        if (t.count[k] == 0)
            continue;
        fprintf(out, "%s: warning: %s", who, t.what[k]);
        if (tried > 1 && t.count[k] < tried)
            fprintf(out, " (case %" PRIu64 "; so it is in %zu of %" PRIu64 " cases%s)", t.first[k],
                    t.count[k], tried, tried < plan->rows ? ", evenly spread" : "");
        fputc('\n', out);
    }
    look_at_angles(plan, who, out);
}
