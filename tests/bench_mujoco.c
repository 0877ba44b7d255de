/* bench_mujoco.c - the biped of this program in MuJoCo, timed beside the kernels.
 *
 * The same robot, law, friction and step of 1 ms, the same starts; case by case MuJoCo does its
 * steps, then the kernels theirs, round after round, all in processor time on one core, so that the
 * ratios of each round can be trusted. Two settings of MuJoCo: its defaults (Newton's solver,
 * pyramidal cones, motors), and what is left when everything is taken away that the robot can stand
 * without: one sweep of projected Gauss-Seidel, torques applied as forces, all checks and features
 * off that can be.
 *
 * MuJoCo wants inertia in every body: the massless links get none, but the feet, point masses, have
 * 1e-9 kg m^2 about their centre, 2e-9 of what the leg makes of them. Trunk and hip are one rigid
 * body with its exact centre and inertia. Feet touch as spheres of a tenth of a millimetre whose
 * centres are where the feet are; the ground lies that much lower. That the two models are one is
 * checked before anything is timed: accelerations at random states with random torques.
 *
 * Also reported: how far a foot is in the ground, and how fast a robot that stands creeps along it.
 */
#include "accelerations.h"
#include "analysis/bench/bench.h"
#include "mujoco_model.h"

#include <math.h>

enum { CASES = 32, ROUNDS = 11, STATES = 200 };

enum setting { DEFAULT, TRIMMED, SETTINGS };
static const char *const setting_name[SETTINGS] = {"mujoco default", "mujoco trimmed"};

/* ---- the model ---------------------------------------------------------------------------- */

static mjModel *make_model(const stance_case *c, enum setting setting)
{
    struct mujoco_biped biped = {.robot = c->robot,
                                 .gravity = STANCE_GRAVITY,
                                 .step = c->step,
                                 .friction = c->friction,
                                 .point = 1e-9,
                                 .feet = {1, 1}};
    if (setting == DEFAULT) {
        biped.actuator = "<actuator><motor joint='q1'/><motor joint='q2'/></actuator>";
    } else {
        biped.option = "solver='PGS' iterations='1' tolerance='0' jacobian='dense'";
        biped.flag = "<flag equality='disable' frictionloss='disable' limit='disable' "
                     "passive='disable' actuation='disable' sensor='disable' "
                     "filterparent='disable' refsafe='disable' clampctrl='disable'/>";
    }
    return mujoco_biped(&biped);
}

/* ---- the same robot? ---------------------------------------------------------------------- */

static double random_in(uint64_t *state, double low, double high)
{
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * (double)(*state >> 11) * 0x1p-53;
}

/* Largest difference of accelerations in relation to the largest of each state. */
static double model_difference(const mjModel *model, mjData *data, const stance_scene *scene,
                               const stance_case *base)
{
    uint64_t state = 1;
    double largest = 0;
    for (int n = 0; n < STATES; n++) {
        stance_case c = *base;
        double ours[STANCE_MAX_COORDINATES], size = 0, off = 0;
        memset(c.near.gain, 0, sizeof c.near.gain);
        c.position[1] = 100;
        for (int i = 0; i < 5; i++) {
            if (i > 1)
                c.position[i] = random_in(&state, -3, 3);
            c.velocity[i] = random_in(&state, -2, 2);
        }
        for (int i = 0; i < 2; i++)
            c.near.feedforward[i] = random_in(&state, -10, 10);
        accelerations(scene, &c, ours);
        mj_resetData(model, data);
        memcpy(data->qpos, c.position, 5 * sizeof(double));
        memcpy(data->qvel, c.velocity, 5 * sizeof(double));
        memcpy(data->ctrl, c.near.feedforward, 2 * sizeof(double));
        mj_forward(model, data);
        for (int i = 0; i < 5; i++) {
            size = fmax(size, fabs(ours[i]));
            off = fmax(off, fabs(ours[i] - data->qacc[i]));
        }
        largest = fmax(largest, off / size);
    }
    return largest;
}

/* ---- simulating --------------------------------------------------------------------------- */

/* What was seen of the feet on the way; NULL where nobody looks. */
struct watch {
    double from;        /* s: creep counts from here */
    double penetration; /* m, largest */
    double creep;       /* m, of the feet that touch, since `from` */
    int contacts;       /* summed over steps */
};

static void start(const mjModel *model, mjData *data, const stance_case *c)
{
    mj_resetData(model, data);
    memcpy(data->qpos, c->position, 5 * sizeof(double));
    memcpy(data->qvel, c->velocity, 5 * sizeof(double));
}

static void look(const mjData *data, const stance_scene *scene, const stance_case *c,
                 double previous[2], struct watch *watch)
{
    double gap[STANCE_MAX_CONTACTS];
    scene->gaps(scene, c->robot, data->qpos, gap);
    watch->contacts += data->ncon;
    for (int foot = 0; foot < scene->contacts; foot++) {
        double point[2], speed[2];
        scene->contact_point(scene, c->robot, data->qpos, data->qvel, foot, point, speed);
        watch->penetration = fmax(watch->penetration, -gap[foot]);
        if (gap[foot] <= 0 && data->time > watch->from)
            watch->creep += fabs(point[0] - previous[foot]);
        previous[foot] = point[0];
    }
}

static void simulate(const mjModel *model, mjData *data, const stance_scene *scene,
                     const stance_case *c, struct watch *watch)
{
    double previous[2] = {0};
    double *const torque = model->nu > 0 ? data->ctrl : data->qfrc_applied + 3;
    start(model, data, c);
    for (int64_t k = 0; k < c->steps; k++) {
        const double *const q = data->qpos + 2, *const v = data->qvel + 2;
        for (int i = 0; i < 2; i++) {
            double sum = c->near.feedforward[i];
            for (int j = 0; j < 3; j++)
                sum -=
                    c->near.gain[i][j] * (q[j] - c->near.target[j]) + c->near.gain[i][3 + j] * v[j];
            torque[i] = fmax(fmin(sum, c->torque_limit), -c->torque_limit);
        }
        mj_step(model, data);
        if (watch)
            look(data, scene, c, previous, watch);
    }
}

static double time_mujoco(const mjModel *model, mjData *data, const stance_scene *scene,
                          const stance_case *cases)
{
    const double begin = bench_clock();
    for (int i = 0; i < CASES; i++)
        simulate(model, data, scene, &cases[i], NULL);
    return bench_clock() - begin;
}

static double time_kernel(const stance_kernel *kernel, const stance_case *cases,
                          stance_result *results, int count)
{
    const double begin = bench_clock();
    kernel->run(cases, results, (size_t)count);
    return bench_clock() - begin;
}

/* The feet that may touch. */
static void allow_contacts(mjModel *model, const stance_case *c)
{
    for (int foot = 0; foot < 2; foot++)
        model->geom_contype[1 + foot] = model->geom_conaffinity[1 + foot] =
            (int)(c->contacts >> foot & 1);
}

/* ---- measuring ---------------------------------------------------------------------------- */

enum { MOST_KERNELS = 8, KERNEL_CASES = 256 };

struct engines {
    const stance_scene *scene;
    mjModel *model[SETTINGS];
    mjData *data[SETTINGS];
    const stance_kernel *kernel[MOST_KERNELS]; /* implicit, wide to narrow */
    int kernels;
};

static bool begin_engines(struct engines *e, const stance_case *base)
{
    const char *isa;
    e->scene = stance_scene_find("biped");
    for (e->kernels = 0; e->kernels < MOST_KERNELS && (isa = stance_isa(e->kernels)) != NULL;)
        e->kernel[e->kernels++] = stance_kernel_find(e->scene, stance_method_find("implicit"), isa);
    for (int s = 0; s < SETTINGS; s++) {
        e->model[s] = make_model(base, (enum setting)s);
        e->data[s] = e->model[s] ? mj_makeData(e->model[s]) : NULL;
        if (!e->data[s])
            return false;
    }
    return true;
}

static void end_engines(struct engines *e)
{
    for (int s = 0; s < SETTINGS; s++) {
        if (e->data[s])
            mj_deleteData(e->data[s]);
        if (e->model[s])
            mj_deleteModel(e->model[s]);
    }
}

static void report(struct bench_row row, const char *quantity, const char *unit,
                   struct bench_spread value)
{
    row.quantity = quantity;
    row.unit = unit;
    row.value = value;
    bench_csv_row(stdout, &row);
}

static struct bench_spread once(double value)
{
    return (struct bench_spread){value, value, value};
}

/* Times all engines in turn, and tells MuJoCo's times and their ratios to ours. */
static void compare(const struct engines *e, const char *regime, const stance_case *cases)
{
    static stance_result results[KERNEL_CASES];
    double theirs[SETTINGS][ROUNDS], ours[MOST_KERNELS][ROUNDS];
    const double steps = CASES * (double)cases[0].steps;
    for (int s = 0; s < SETTINGS; s++)
        allow_contacts(e->model[s], &cases[0]);
    for (int r = -1; r < ROUNDS; r++) { /* the first warms up */
        const int round = r < 0 ? 0 : r;
        for (int s = 0; s < SETTINGS; s++)
            theirs[s][round] = 1e9 / steps * time_mujoco(e->model[s], e->data[s], e->scene, cases);
        for (int k = 0; k < e->kernels; k++)
            ours[k][round] = 1e9 * CASES / (steps * KERNEL_CASES) *
                             time_kernel(e->kernel[k], cases, results, KERNEL_CASES);
    }
    for (int s = 0; s < SETTINGS; s++) {
        struct bench_row row = {.subject = setting_name[s],
                                .scene = "biped",
                                .regime = regime,
                                .method = "implicit",
                                .ranks = 1,
                                .step = cases[0].step,
                                .cases = CASES,
                                .repeats = ROUNDS};
        double copy[ROUNDS], ratio[ROUNDS];
        for (int k = 0; k < e->kernels; k++) {
            for (int r = 0; r < ROUNDS; r++)
                ratio[r] = theirs[s][r] / ours[k][r];
            row.isa = e->kernel[k]->isa, row.lanes = e->kernel[k]->lanes;
            const struct bench_spread spread = bench_spread(ratio, ROUNDS);
            report(row, "ratio to stance", "1", spread);
            memcpy(copy, ours[k], sizeof copy);
            const double ns = bench_spread(copy, ROUNDS).median;
            fprintf(stderr, "%-8s  %s / stance implicit %-6s (%5.1f ns): %5.1f (%.1f ... %.1f)\n",
                    regime, setting_name[s], row.isa, ns, spread.median, spread.lowest,
                    spread.highest);
        }
        row.isa = row.method = NULL, row.lanes = 0;
        const struct bench_spread ns = bench_spread(theirs[s], ROUNDS);
        report(row, "time per step", "ns", ns);
        const double rate = 1 / cases[0].step;
        report(row, "time per simulated second", "ns", bench_scaled(ns, rate));
        fprintf(stderr, "%-8s  %s %.0f ns a step (%.0f ... %.0f)\n", regime, setting_name[s],
                ns.median, ns.lowest, ns.highest);
    }
}

/* What the contacts are worth: 10 s, creep over the last 5. */
static void inspect(const struct engines *e, const char *regime, const stance_case *start_case)
{
    stance_case c = *start_case;
    const double half = 5;
    for (int s = 0; s < SETTINGS; s++) {
        struct watch watch = {.from = half};
        const struct bench_row row = {.subject = setting_name[s],
                                      .scene = "biped",
                                      .regime = regime,
                                      .ranks = 1,
                                      .step = c.step,
                                      .cases = 1,
                                      .repeats = 1};
        c.steps = (int64_t)(2 * half / c.step + 0.5);
        simulate(e->model[s], e->data[s], e->scene, &c, &watch);
        report(row, "penetration", "m", once(watch.penetration));
        report(row, "creep", "m/s", once(watch.creep / half));
        report(row, "contacts per step", "1", once((double)watch.contacts / (double)c.steps));
        fprintf(stderr,
                "%-8s  %s: penetration %.1e m, creep %.1e m/s, contacts per step %.2f, "
                "hip at %.3f m\n",
                regime, setting_name[s], watch.penetration, watch.creep / half,
                (double)watch.contacts / (double)c.steps, e->data[s]->qpos[1]);
    }
    stance_result end, middle;
    const struct bench_row row = {.subject = "stance",
                                  .scene = "biped",
                                  .regime = regime,
                                  .method = "implicit",
                                  .isa = e->kernel[0]->isa,
                                  .lanes = e->kernel[0]->lanes,
                                  .ranks = 1,
                                  .step = c.step,
                                  .cases = 1,
                                  .repeats = 1};
    e->kernel[0]->run(&c, &end, 1);
    c.steps /= 2;
    e->kernel[0]->run(&c, &middle, 1);
    const double creep = (end.slip_distance - middle.slip_distance) / half;
    report(row, "penetration", "m", once(end.max_penetration));
    report(row, "creep", "m/s", once(creep));
    fprintf(stderr, "%-8s  stance: penetration %.1e m, creep %.1e m/s, hip at %.3f m\n", regime,
            end.max_penetration, creep, end.position[1]);
}

int main(void)
{
    static stance_case cases[KERNEL_CASES];
    static const char *const regimes[] = {"flight", "one foot", "two feet"};
    struct engines e = {0};
    const stance_scene *const scene = stance_scene_find("biped");

    int code = !bench_cases(scene, "flight", cases, 1) || !begin_engines(&e, cases);
    if (code == 0) {
        const double off = model_difference(e.model[DEFAULT], e.data[DEFAULT], scene, cases);
        fprintf(stderr, "accelerations at %d random states: within %.1e of ours (MuJoCo %s)\n",
                STATES, off, mj_versionString());
        code = off < 1e-6 ? 0 : 1;
        report((struct bench_row){.subject = setting_name[DEFAULT],
                                  .scene = "biped",
                                  .regime = "flight",
                                  .cases = STATES,
                                  .repeats = 1},
               "difference of accelerations", "1", once(off));
    }
    for (size_t r = 0; r < sizeof regimes / sizeof regimes[0] && code == 0; r++) {
        code = !bench_cases(scene, regimes[r], cases, KERNEL_CASES);
        if (code == 0) {
            compare(&e, regimes[r], cases);
            if (r > 0)
                inspect(&e, regimes[r], &cases[0]);
        }
    }
    if (code != 0)
        fprintf(stderr, "bench_mujoco: the two robots are not the same, or could not be made\n");
    end_engines(&e);
    return code;
}
