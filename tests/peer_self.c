/* peer_self.c - our own engine in the place of a peer: `midpoint`, through everything that a peer
 * goes through, must get the errors and labels that it has without. For tests.
 *
 * A case is simulated as a whole when it starts; its steps then only look on.
 */
#include "accelerations.h"
#include "peer.h"

static struct {
    const struct peer_request *request;
    const stance_kernel *kernel;
    double step, *position, *velocity, *force;
    int64_t row, rows;
} engine;

static const char *setting(const struct peer_request *r, int s, double *step, bool *usual)
{
    (void)r;
    static const double steps[] = {0.01, 0.005};
    *step = steps[s];
    *usual = s == 0;
    return "midpoint";
}

static bool begin(const struct peer_request *r, int s)
{
    bool usual;
    const stance_scene *const scene = stance_scene_find("biped");
    engine.request = r;
    engine.kernel = stance_kernel_find(scene, stance_method_find("midpoint"), "scalar");
    setting(r, s, &engine.step, &usual);
    engine.rows = (int64_t)(r->time / engine.step + 1.5);
    engine.position = calloc((size_t)engine.rows, 5 * sizeof(double));
    engine.velocity = calloc((size_t)engine.rows, 5 * sizeof(double));
    engine.force = calloc((size_t)engine.rows, 4 * sizeof(double));
    return engine.kernel && engine.position && engine.velocity && engine.force;
}

static void end(void)
{
    free(engine.position);
    free(engine.velocity);
    free(engine.force);
}

/* The case that the request describes. */
static stance_case make_case(const double *state)
{
    const struct peer_request *const r = engine.request;
    stance_case c = {.friction = r->friction, .restitution = r->restitution};
    stance_robot_fallback(stance_scene_find("biped"), c.robot);
    memcpy(c.robot, r->robot, sizeof(double) * (size_t)r->robots);
    stance_case_robot(stance_scene_find("biped"), &c);
    memcpy(c.position, state, 5 * sizeof(double));
    memcpy(c.velocity, state + 5, 5 * sizeof(double));
    for (int i = 0; i < 2; i++) {
        c.contacts |= (uint32_t)r->feet[i] << i;
        c.near.feedforward[i] = r->feedforward[i];
        memcpy(c.near.gain[i], r->gain[i], sizeof r->gain[i]);
    }
    memcpy(c.near.target, r->target, sizeof r->target);
    c.torque_limit = r->limit[0];
    c.step = engine.step;
    c.steps = engine.rows - 1;
    c.sample_every = (int64_t)(r->sample / engine.step + 0.5);
    c.settle_angle = c.settle_rate = c.settle_hold = 1;
    c.tolerance = 1;
    return c;
}

static void start(const double *state)
{
    stance_trajectory trajectory = {.interval = engine.step,
                                    .rows = engine.rows,
                                    .position = engine.position,
                                    .velocity = engine.velocity,
                                    .force = engine.force};
    double torque[2], gap[2];
    stance_case c = make_case(state);
    stance_result result;
    double *const others = calloc((size_t)engine.rows, sizeof torque + sizeof gap);
    trajectory.torque = others;
    trajectory.gap = others + 2 * engine.rows;
    c.trajectory = &trajectory;
    engine.kernel->run(&c, &result, 1);
    free(others);
    for (int64_t k = result.steps + 1; k < engine.rows; k++) { /* it fell: there it lies */
        memcpy(engine.position + 5 * k, result.position, 5 * sizeof(double));
        memcpy(engine.velocity + 5 * k, result.velocity, 5 * sizeof(double));
    }
    engine.row = 0;
}

static void acceleration(const double *state, const double torque[2], double a[5])
{
    stance_case c = make_case(state);
    memset(c.near.gain, 0, sizeof c.near.gain);
    memcpy(c.near.feedforward, torque, 2 * sizeof(double));
    c.torque_limit = INFINITY;
    accelerations(stance_scene_find("biped"), &c, a);
}

static bool step(const double *torque)
{
    (void)torque; /* the kernel has the same law */
    engine.row++;
    return true;
}

static void state(double *state, double load[PEER_CONTACTS])
{
    memcpy(state, engine.position + 5 * engine.row, 5 * sizeof(double));
    memcpy(state + 5, engine.velocity + 5 * engine.row, 5 * sizeof(double));
    for (int c = 0; c < PEER_CONTACTS; c++)
        load[c] = engine.force[4 * engine.row + 2 * c];
}

int main(void)
{
    const struct peer_engine self = {"self", NULL,         2,     setting, begin,
                                     end,    acceleration, start, step,    state};
    return peer_main(&self);
}
