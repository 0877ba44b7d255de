/* bench_mujoco.c - robots in MuJoCo, timed beside the kernels.
 *
 * The same robot, law, friction and step, the same starts; case by case MuJoCo does its steps, then
 * the kernels theirs, round after round, all in processor time on one core, so that the ratios of
 * each round can be trusted.
 *
 * The biped of this program, in steps of 1 ms, has two settings of MuJoCo: its defaults (Newton's
 * solver, pyramidal cones, motors), and what is left when everything is taken away that the robot
 * can stand without: one sweep of projected Gauss-Seidel, torques applied as forces, all checks and
 * features off that can be. MuJoCo wants inertia in every body: the massless links get none, but
 * the feet, point masses, have 1e-9 kg m^2 about their centre, 2e-9 of what the leg makes of them.
 * Trunk and hip are one rigid body with its exact centre and inertia. Feet touch as spheres of a
 * tenth of a millimetre whose centres are where the feet are; the ground lies that much lower. That
 * the two models are one is checked before anything is timed: accelerations at random states with
 * random torques. Also reported: how far a foot is in the ground, and how fast a robot that stands
 * creeps along it.
 *
 * Others get to MuJoCo, with its defaults, by `stance export`'s writer; tests/test_export.c checks
 * that the two are one. Those of tests/robots are let go, from their starts, for 1.5 s in steps of
 * 2 ms by each method: they fall, strike stops, come to rest. RABBIT as
 * scenarios/mechanisms/rabbit.yaml describes it has the regulator of that file, torque limits and
 * friction, in steps of 1 ms: 1 s in flight, on one foot, on both, and on both with feet that leave
 * the ground at first. The kernels are those of the two widest instruction sets.
 *
 * Usage: bench_mujoco [ROBOT ...]: rows of bench.csv on standard output.
 */
#include "accelerations.h"
#include "analysis/bench/bench.h"
#include "mujoco_model.h"
#include "runner/plan/kernels.h"
#include "runner/plan/mjcf.h"

#include <math.h>

enum { MUJOCO_CASES = 32, CASES = 256, MOST_ROUNDS = 11, MOST_ISAS = 8, STATES = 200 };

enum setting { DEFAULT, TRIMMED, SETTINGS };
static const char *const setting_name[SETTINGS] = {"mujoco default", "mujoco trimmed"};

/* What differs from a scenario: settings, and how far above its start it begins. Without a file it
 * is the biped of this program. */
struct regime {
    const char *robot, *name, *file, *method;
    double lift; /* m */
    const char *const *set;
    size_t sets;
};

#define RABBIT_ALWAYS                                                                              \
    "stop={time: 1, settle: off}", "sweep.grid[0].from=-0.02", "sweep.grid[0].to=0.02",            \
        "sweep.grid[1].from=-0.05", "sweep.grid[1].to=0.05", "sweep.grid[0].count=16",             \
        "sweep.grid[1].count=16"
#define RABBIT_BOTH                                                                                \
    "ground.contacts=[foot1, foot2]", "initial.support=[foot1, foot2]",                            \
        "initial.equilibrium={thigh1: 0.4, shank1: -0.4, shank2: -0.3}", "controller.weights={}"
static const char *const on_one[] = {RABBIT_ALWAYS};
/* From as far off as on one foot, feet leave the ground and come back. */
static const char *const stepping[] = {RABBIT_ALWAYS, RABBIT_BOTH};
static const char *const on_two[] = {RABBIT_ALWAYS,
                                     RABBIT_BOTH,
                                     "sweep.grid[0].from=-0.002",
                                     "sweep.grid[0].to=0.002",
                                     "sweep.grid[1].from=-0.005",
                                     "sweep.grid[1].to=0.005"};
#define SET(list) list, sizeof(list) / sizeof *(list)
#define RABBIT "scenarios/mechanisms/rabbit.yaml"
static const struct regime regimes[] = {
    {"biped", "flight", .method = "implicit"},
    {"biped", "one foot", .method = "implicit"},
    {"biped", "two feet", .method = "implicit"},
    {"rabbit", "flight", RABBIT, "implicit", 1000, SET(on_one)},
    {"rabbit", "one foot", RABBIT, "implicit", 0, SET(on_one)},
    {"rabbit", "two feet", RABBIT, "implicit", 0, SET(on_two)},
    {"rabbit", "stepping", RABBIT, "implicit", 0, SET(stepping)},
};
static const char *const robots[] = {"cart_pole", "compass",  "biped",        "rabbit",
                                     "hopper",    "walker2d", "half_cheetah", "humanoid"};
static const char *const methods[] = {"midpoint", "capturing"};

struct beside {
    const struct regime *regime;
    const stance_scene *scene;
    struct scenario scenario; /* this, and what is made of it: of those described */
    struct plan plan;
    struct kernels compiled;
    const stance_kernel *kernel[MOST_ISAS]; /* wide to narrow */
    size_t isas;
    int settings, rounds;
    mjModel *model[SETTINGS];
    mjData *data[SETTINGS];
    int joint[STANCE_MAX_COORDINATES]; /* MuJoCo's index of each coordinate */
    double limit[STANCE_MAX_ACTUATORS];
    stance_case cases[CASES];
    stance_result results[CASES];
};

/* ---- the robots --------------------------------------------------------------------------- */

static bool take_biped(struct beside *b)
{
    const stance_case *const c = b->cases;
    b->scene = stance_scene_find("biped");
    b->settings = SETTINGS, b->rounds = MOST_ROUNDS;
    if (!bench_cases(b->scene, b->regime->name, b->cases, CASES))
        return false;
    struct mujoco_biped biped = {.robot = c->robot,
                                 .gravity = STANCE_GRAVITY,
                                 .step = c->step,
                                 .friction = c->friction,
                                 .point = 1e-9,
                                 .feet = {(int)(c->contacts & 1), (int)(c->contacts >> 1 & 1)},
                                 .actuator =
                                     "<actuator><motor joint='q1'/><motor joint='q2'/></actuator>"};
    b->model[DEFAULT] = mujoco_biped(&biped);
    biped.actuator = NULL;
    biped.option = "solver='PGS' iterations='1' tolerance='0' jacobian='dense'";
    biped.flag = "<flag equality='disable' frictionloss='disable' limit='disable' "
                 "passive='disable' actuation='disable' sensor='disable' "
                 "filterparent='disable' refsafe='disable' clampctrl='disable'/>";
    b->model[TRIMMED] = mujoco_biped(&biped);
    for (int i = 0; i < b->scene->coordinates; i++)
        b->joint[i] = i;
    while (b->isas < MOST_ISAS && stance_isa((int)b->isas)) {
        b->kernel[b->isas] = stance_kernel_find(b->scene, stance_method_find(b->regime->method),
                                                stance_isa((int)b->isas));
        b->isas++;
    }
    return true;
}

static bool take_described(struct beside *b)
{
    enum { MOST_SETS = 32, WIDEST = 2 };
    const struct regime *const regime = b->regime;
    char named[64], *xml = NULL;
    const char *sets[MOST_SETS] = {named}, *isa[WIDEST];
    size_t size = 0;
    snprintf(named, sizeof named, "method.name=%s", regime->method);
    for (size_t i = 0; i < regime->sets; i++)
        sets[1 + i] = regime->set[i];
    const struct parallel alone = parallel_alone();
    struct plan_error error = {.message.text = ""};
    stance_message message = {""};
    for (; b->isas < WIDEST && stance_isa((int)b->isas); b->isas++)
        isa[b->isas] = stance_isa((int)b->isas);
    if (!scenario_read(&b->scenario, regime->file, NULL, sets, 1 + regime->sets, stderr))
        return false;
    if (!plan_make(&b->plan, &b->scenario, false, 0, false, &error) ||
        !plan_compute_designs(&b->plan, &alone, &error) ||
        kernels_take(
            &b->compiled, &b->plan,
            &(struct kernels_choice){.isa = isa, .isas = b->isas, .always = true, .quiet = true},
            &alone, &message) != EXIT_DONE) {
        fprintf(stderr, "bench_mujoco: %s%s\n", error.message.text, message.text);
        return false;
    }
    b->scene = b->scenario.scene;
    b->settings = 1, b->rounds = 7;
    for (size_t k = 0; k < b->isas; k++) /* that are not compiled the program carries */
        b->kernel[k] =
            k < b->compiled.count
                ? b->compiled.kernel[k]
                : stance_kernel_find(b->scene, stance_method_find(regime->method), isa[k]);
    for (uint64_t row = 0; row < CASES; row++) {
        int method;
        /* 7 and 256 have no common divisor: the first ones are spread as evenly as all. */
        stance_case *const c = &b->cases[row * 7 % CASES];
        if (!plan_resolve(&b->plan, row, c, &method))
            return false;
        if (b->scene->coordinates > 1)
            c->position[1] += regime->lift;
    }
    FILE *const out = open_memstream(&xml, &size);
    if (!out)
        return false;
    mjcf_write(out, b->scene, b->cases, "robot");
    fclose(out);
    mjModel *const model = b->model[DEFAULT] = mujoco_model(xml);
    free(xml);
    if (!model)
        return false;
    model->opt.integrator = mjINT_EULER; /* the defaults */
    model->opt.cone = mjCONE_PYRAMIDAL;
    for (int i = 0; i < b->scene->coordinates; i++)
        b->joint[i] = mj_name2id(model, mjOBJ_JOINT, b->scene->coordinate[i].name);
    return true;
}

static bool take(struct beside *b)
{
    bool good = b->regime->file ? take_described(b) : take_biped(b);
    for (int s = 0; s < b->settings && good; s++) {
        b->data[s] = b->model[s] ? mj_makeData(b->model[s]) : NULL;
        good = b->data[s] != NULL;
    }
    if (good)
        stance_torque_limits(b->scene, b->cases->robot, b->cases->torque_limit,
                             b->cases->torque_limits, b->limit);
    return good;
}

static void give_back(struct beside *b)
{
    for (int s = 0; s < b->settings; s++) {
        mj_deleteData(b->data[s]);
        mj_deleteModel(b->model[s]);
    }
    if (b->regime->file) {
        kernels_give_back(&b->compiled);
        plan_free(&b->plan);
        scenario_free(&b->scenario);
    }
}

/* ---- simulating --------------------------------------------------------------------------- */

/* What was seen of the contacts on the way. */
struct watch {
    bool feet;          /* these are looked at: */
    double from;        /* s: creep counts from here */
    double penetration; /* m, largest */
    double creep;       /* m, of the feet that touch, since `from` */
    double previous[STANCE_MAX_CONTACTS];
    int contacts; /* summed over steps */
};

static void look(const struct beside *b, const mjData *data, struct watch *watch)
{
    double gap[STANCE_MAX_CONTACTS];
    b->scene->gaps(b->scene, b->cases->robot, data->qpos, gap);
    for (int foot = 0; foot < b->scene->contacts; foot++) {
        double point[2], speed[2];
        b->scene->contact_point(b->scene, b->cases->robot, data->qpos, data->qvel, foot, point,
                                speed);
        watch->penetration = fmax(watch->penetration, -gap[foot]);
        if (gap[foot] <= 0 && data->time > watch->from)
            watch->creep += fabs(point[0] - watch->previous[foot]);
        watch->previous[foot] = point[0];
    }
}

static void put_state(const struct beside *b, int setting, const stance_case *c)
{
    mj_resetData(b->model[setting], b->data[setting]);
    for (int i = 0; i < b->scene->coordinates; i++) {
        b->data[setting]->qpos[b->joint[i]] = c->position[i];
        b->data[setting]->qvel[b->joint[i]] = c->velocity[i];
    }
}

/* A case with the law of state feedback. */
static void simulate(const struct beside *b, int setting, const stance_case *c, struct watch *watch)
{
    const stance_scene *const scene = b->scene;
    const mjModel *const model = b->model[setting];
    mjData *const data = b->data[setting];
    const int p = scene->postures;
    /* Without motors torques are forces on the biped's legs. */
    double *const torque = setting == DEFAULT ? data->ctrl : data->qfrc_applied + 3;
    put_state(b, setting, c);
    for (int64_t k = 0; k < c->steps; k++) {
        double x[2 * STANCE_MAX_POSTURE];
        for (int j = 0; j < p; j++) {
            const int from = b->joint[scene->posture[j]];
            x[j] = data->qpos[from] - c->near.target[j];
            x[p + j] = data->qvel[from];
        }
        for (int i = 0; i < scene->actuators; i++) {
            double sum = c->near.feedforward[i];
            for (int j = 0; j < 2 * p; j++)
                sum -= c->near.gain[i][j] * x[j];
            torque[i] = fmax(fmin(sum, b->limit[i]), -b->limit[i]);
        }
        mj_step(model, data);
        watch->contacts += data->ncon;
        if (watch->feet)
            look(b, data, watch);
    }
}

/* ---- the same robot? ---------------------------------------------------------------------- */

static double random_in(uint64_t *state, double low, double high)
{
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * (double)(*state >> 11) * 0x1p-53;
}

/* Largest difference of the biped's accelerations in relation to the largest of each state. */
static double model_difference(const struct beside *b)
{
    uint64_t state = 1;
    double largest = 0;
    mjData *const data = b->data[DEFAULT];
    for (int n = 0; n < STATES; n++) {
        stance_case c = *b->cases;
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
        accelerations(b->scene, &c, ours);
        put_state(b, DEFAULT, &c);
        memcpy(data->ctrl, c.near.feedforward, 2 * sizeof(double));
        mj_forward(b->model[DEFAULT], data);
        for (int i = 0; i < 5; i++) {
            size = fmax(size, fabs(ours[i]));
            off = fmax(off, fabs(ours[i] - data->qacc[i]));
        }
        largest = fmax(largest, off / size);
    }
    return largest;
}

/* ---- measuring ---------------------------------------------------------------------------- */

static void report(struct bench_row row, const char *quantity, const char *unit,
                   struct bench_spread value)
{
    row.quantity = quantity;
    row.unit = unit;
    row.value = value;
    bench_csv_row(stdout, &row);
}

static void report_once(struct bench_row row, const char *quantity, const char *unit, double value)
{
    report(row, quantity, unit, (struct bench_spread){value, value, value});
}

/* Times all engines in turn, and tells MuJoCo's times and their ratios to ours. */
static void compare(struct beside *b)
{
    const struct regime *const regime = b->regime;
    double theirs[SETTINGS][MOST_ROUNDS], ours[MOST_ISAS][MOST_ROUNDS], failed = 0;
    struct watch watch;
    const double steps = (double)b->cases->steps;
    for (int r = -1; r < b->rounds; r++) { /* the first warms up */
        const int round = r < 0 ? 0 : r;
        for (int s = 0; s < b->settings; s++) {
            const double begin = bench_clock();
            watch = (struct watch){.feet = false};
            for (int i = 0; i < MUJOCO_CASES; i++)
                simulate(b, s, &b->cases[i], &watch);
            theirs[s][round] = 1e9 / (steps * MUJOCO_CASES) * (bench_clock() - begin);
        }
        for (size_t k = 0; k < b->isas; k++) {
            const double begin = bench_clock();
            b->kernel[k]->run(b->cases, b->results, CASES);
            ours[k][round] = 1e9 / (steps * CASES) * (bench_clock() - begin);
        }
    }
    for (int i = 0; i < CASES; i++)
        failed += b->results[i].status != STANCE_DONE;
    fprintf(stderr, "%s, %s: %.2f contacts a step, %g of %d cases of stance failed\n",
            regime->robot, regime->name, watch.contacts / (steps * MUJOCO_CASES), failed, CASES);
    struct bench_row row = {.scene = regime->robot,
                            .regime = regime->name,
                            .ranks = 1,
                            .step = b->cases->step,
                            .repeats = b->rounds};
    for (size_t k = 0; k < b->isas; k++) {
        double own[MOST_ROUNDS], ratio[MOST_ROUNDS];
        memcpy(own, ours[k], sizeof own);
        const struct bench_spread ns = bench_spread(own, b->rounds);
        row.method = regime->method;
        row.isa = b->kernel[k]->isa, row.lanes = b->kernel[k]->lanes;
        row.subject = "stance", row.cases = CASES;
        if (regime->file) /* the biped's are those of `stance bench` */
            report(row, "time per step", "ns", ns);
        row.cases = MUJOCO_CASES;
        for (int s = 0; s < b->settings; s++) {
            for (int r = 0; r < b->rounds; r++)
                ratio[r] = theirs[s][r] / ours[k][r];
            const struct bench_spread spread = bench_spread(ratio, b->rounds);
            row.subject = setting_name[s];
            report(row, "ratio to stance", "1", spread);
            fprintf(stderr, "%s, %s: %s / stance %s %-6s (%5.1f ns): %5.1f (%.1f ... %.1f)\n",
                    regime->robot, regime->name, row.subject, row.method, row.isa, ns.median,
                    spread.median, spread.lowest, spread.highest);
        }
    }
    row.isa = row.method = NULL, row.lanes = 0;
    for (int s = 0; s < b->settings; s++) {
        const struct bench_spread ns = bench_spread(theirs[s], b->rounds);
        row.subject = setting_name[s];
        report(row, "time per step", "ns", ns);
        if (!regime->file)
            report(row, "time per simulated second", "ns", bench_scaled(ns, 1 / row.step));
        fprintf(stderr, "%s, %s: %s %.0f ns a step (%.0f ... %.0f)\n", regime->robot, regime->name,
                row.subject, ns.median, ns.lowest, ns.highest);
    }
}

/* What the standing biped's contacts are worth: 10 s, creep over the last 5. */
static void inspect(const struct beside *b)
{
    stance_case c = *b->cases;
    const double half = 5;
    const char *const form = "%s: %s: penetration %.1e m, creep %.1e m/s, hip at %.3f m\n";
    struct bench_row row = {.scene = b->regime->robot,
                            .regime = b->regime->name,
                            .ranks = 1,
                            .step = c.step,
                            .cases = 1,
                            .repeats = 1};
    c.steps = (int64_t)(2 * half / c.step + 0.5);
    for (int s = 0; s < b->settings; s++) {
        struct watch watch = {.feet = true, .from = half};
        simulate(b, s, &c, &watch);
        row.subject = setting_name[s];
        report_once(row, "penetration", "m", watch.penetration);
        report_once(row, "creep", "m/s", watch.creep / half);
        report_once(row, "contacts per step", "1", (double)watch.contacts / (double)c.steps);
        fprintf(stderr, form, row.regime, row.subject, watch.penetration, watch.creep / half,
                b->data[s]->qpos[1]);
    }
    stance_result end, middle;
    row.subject = "stance", row.method = b->regime->method;
    row.isa = b->kernel[0]->isa, row.lanes = b->kernel[0]->lanes;
    b->kernel[0]->run(&c, &end, 1);
    c.steps /= 2;
    b->kernel[0]->run(&c, &middle, 1);
    const double creep = (end.slip_distance - middle.slip_distance) / half;
    report_once(row, "penetration", "m", end.max_penetration);
    report_once(row, "creep", "m/s", creep);
    fprintf(stderr, form, row.regime, row.subject, end.max_penetration, creep, end.position[1]);
}

/* False: it could not be made, or is another robot there. */
static bool run(const struct regime *regime)
{
    static struct beside b;
    b = (struct beside){.regime = regime};
    bool good = take(&b);
    if (good && regime == regimes) {
        const double off = model_difference(&b);
        fprintf(stderr, "accelerations at %d random states: within %.1e of ours (MuJoCo %s)\n",
                STATES, off, mj_versionString());
        good = off < 1e-6;
        report_once((struct bench_row){.subject = setting_name[DEFAULT],
                                       .scene = regime->robot,
                                       .regime = regime->name,
                                       .cases = STATES,
                                       .repeats = 1},
                    "difference of accelerations", "1", off);
    }
    if (good)
        compare(&b);
    if (good && !regime->file && regime != regimes)
        inspect(&b);
    if (!good)
        fprintf(stderr, "bench_mujoco: %s, %s: not the same robot, or it could not be made\n",
                regime->robot, regime->name);
    else
        give_back(&b);
    return good;
}

static bool asked(const char *robot, int count, char **names)
{
    bool found = count == 0;
    for (int i = 0; i < count; i++)
        found = found || strcmp(names[i], robot) == 0;
    return found;
}

int main(int argc, char **argv)
{
    bool good = true;
    for (size_t r = 0; r < sizeof regimes / sizeof *regimes; r++)
        if (asked(regimes[r].robot, argc - 1, argv + 1))
            good = good && run(&regimes[r]);
    for (size_t r = 0; r < sizeof robots / sizeof *robots; r++)
        for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
            char file[64];
            snprintf(file, sizeof file, "tests/robots/%s.yaml", robots[r]);
            const struct regime let_go = {robots[r], "let go", file, methods[m], 0, NULL, 0};
            if (asked(robots[r], argc - 1, argv + 1))
                good = good && run(&let_go);
        }
    return good ? 0 : 1;
}
