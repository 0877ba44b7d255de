/* peer_mujoco.c - MuJoCo on the charts of `stance bench accuracy`.
 *
 * The biped as in bench_mujoco.c: hinges, trunk and hip one rigid body with its exact centre and
 * inertia, feet as spheres of a tenth of a millimetre above a ground that lies as much lower. The
 * feet, which are point masses, have 1e-12 kg m^2, without which MuJoCo takes no body. A servo in
 * each hip is a spring and a damper of the joint, which MuJoCo's integrators treat as well as they
 * can; any other law that acts all the time is evaluated wherever MuJoCo evaluates forces.
 */
#include "mujoco_model.h"
#include "peer.h"

struct setting {
    const char *name;
    int integrator, solver, cone;
    double stiff;     /* solref's time constant in steps; 0: MuJoCo's 0.02 s */
    double impedance; /* solimp's both ends; 0: MuJoCo's 0.9 ... 0.95 over 1 mm */
    double impratio;
    int noslip; /* iterations */
    bool maps;  /* no other has been both as cheap and as exact; a map tries these alone */
};
static const struct setting settings[] = {
    {"default", mjINT_EULER, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 0, 0, 1, 0, true},
    {"RK4", mjINT_RK4, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 0, 0, 1, 0, false},
    {"Euler, stiff", mjINT_EULER, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 2, 0.9999, 1, 0, true},
    {"Euler, stiff, elliptic", mjINT_EULER, mjSOL_NEWTON, mjCONE_ELLIPTIC, 2, 0.9999, 1, 0, true},
    {"Euler, stiff, elliptic, impratio 100", mjINT_EULER, mjSOL_NEWTON, mjCONE_ELLIPTIC, 2, 0.99,
     100, 0, false},
    {"Euler, stiff, CG", mjINT_EULER, mjSOL_CG, mjCONE_PYRAMIDAL, 2, 0.9999, 1, 0, false},
    {"Euler, stiff, PGS", mjINT_EULER, mjSOL_PGS, mjCONE_PYRAMIDAL, 2, 0.9999, 1, 0, false},
    {"Euler, stiff, noslip", mjINT_EULER, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 2, 0.9999, 1, 10, false},
    {"Euler, stiff 4", mjINT_EULER, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 4, 0.9999, 1, 0, false},
    {"implicit, stiff", mjINT_IMPLICIT, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 2, 0.9999, 1, 0, true},
    {"RK4, stiff", mjINT_RK4, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 2, 0.9999, 1, 0, false},
    {"RK4, stiff 4", mjINT_RK4, mjSOL_NEWTON, mjCONE_PYRAMIDAL, 4, 0.9999, 1, 0, false},
};
static const double steps[] = {4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5};
enum { SETTINGS = sizeof settings / sizeof *settings, STEPS = sizeof steps / sizeof *steps };

static struct {
    const struct peer_request *request;
    mjModel *model;
    mjData *data;
    bool servo;
} engine;

/* ---- the model ---------------------------------------------------------------------------- */

static mjModel *make_model(const struct peer_request *r, const struct setting *s, double step)
{
    char option[100], contact[200] = "", servo[2][200] = {"", ""};
    snprintf(option, sizeof option, "impratio='%.17g' noslip_iterations='%d'", s->impratio,
             s->noslip);
    if (s->stiff > 0)
        snprintf(contact, sizeof contact, "solref='%.17g 1'", s->stiff * step);
    if (s->impedance > 0)
        snprintf(contact + strlen(contact), sizeof contact - strlen(contact),
                 " solimp='%.17g %.17g 0.001'", s->impedance, s->impedance);
    for (int i = 0; i < 2 && engine.servo; i++)
        snprintf(servo[i], sizeof servo[i], "stiffness='%.17g' springref='%.17g' damping='%.17g'",
                 r->gain[i][1 + i], r->target[1 + i], r->gain[i][4 + i]);
    return mujoco_biped(&(struct mujoco_biped){.robot = r->robot,
                                               .gravity = r->gravity,
                                               .step = step,
                                               .friction = r->friction,
                                               .option = option,
                                               .contact = contact,
                                               .joint = {servo[0], servo[1]},
                                               .point = 1e-12,
                                               .feet = {r->feet[0], r->feet[1]}});
}

/* ---- the engine --------------------------------------------------------------------------- */

static void law(const mjModel *model, mjData *data)
{
    (void)model;
    peer_torque(engine.request, data->qpos, data->qvel, data->qfrc_applied + 3);
}

static const char *setting(const struct peer_request *r, int s, double *step, bool *usual)
{
    *step = steps[s % STEPS];
    *usual = s / STEPS == 0;
    if (r->labels && !settings[s / STEPS].maps)
        return NULL;
    return settings[s / STEPS].name;
}

static bool begin(const struct peer_request *r, int s)
{
    const struct setting *const chosen = &settings[s / STEPS];
    engine.request = r;
    engine.servo = peer_is_servo(r);
    engine.model = make_model(r, chosen, steps[s % STEPS]);
    if (!engine.model)
        return false;
    engine.model->opt.integrator = chosen->integrator;
    engine.model->opt.solver = chosen->solver;
    engine.model->opt.cone = chosen->cone;
    engine.data = mj_makeData(engine.model);
    mjcb_control = !engine.servo && r->sample <= 0 ? law : NULL;
    return engine.data != NULL;
}

static void end(void)
{
    mj_deleteData(engine.data);
    mj_deleteModel(engine.model);
}

static void start(const double *state)
{
    mj_resetData(engine.model, engine.data);
    memcpy(engine.data->qpos, state, 5 * sizeof(double));
    memcpy(engine.data->qvel, state + 5, 5 * sizeof(double));
}

static void acceleration(const double *state, const double torque[2], double a[5])
{
    start(state);
    if (!engine.servo)
        memcpy(engine.data->qfrc_applied + 3, torque, 2 * sizeof(double));
    mj_forward(engine.model, engine.data);
    memcpy(a, engine.data->qacc, 5 * sizeof(double));
}

/* What MuJoCo warns of is that a state was reset: it goes on from elsewhere. */
static bool step(const double *torque)
{
    if (torque)
        memcpy(engine.data->qfrc_applied + 3, torque, 2 * sizeof(double));
    mj_step(engine.model, engine.data);
    return engine.data->warning[mjWARN_BADQPOS].number == 0 &&
           engine.data->warning[mjWARN_BADQVEL].number == 0 &&
           engine.data->warning[mjWARN_BADQACC].number == 0;
}

static void state(double *state, double load[PEER_CONTACTS])
{
    memcpy(state, engine.data->qpos, 5 * sizeof(double));
    memcpy(state + 5, engine.data->qvel, 5 * sizeof(double));
    load[0] = load[1] = 0;
    for (int i = 0; i < engine.data->ncon; i++) {
        const int foot = engine.data->contact[i].geom2 - 1; /* the ground is geom 0 */
        double force[6] = {0};
        mj_contactForce(engine.model, engine.data, i, force);
        if (foot >= 0 && foot < PEER_CONTACTS)
            load[foot] += force[0];
    }
}

static void warned(const char *text)
{
    (void)text; /* counted in mjData, see step */
}

int main(void)
{
    char name[64];
    snprintf(name, sizeof name, "MuJoCo %s", mj_versionString());
    mju_user_warning = warned;
    const struct peer_engine mujoco = {
        name, NULL, SETTINGS * STEPS, setting, begin, end, acceleration, start, step, state};
    return peer_main(&mujoco);
}
