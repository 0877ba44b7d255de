/* bench_mujoco_robots.c - robots of several kinds timed beside MuJoCo, which gets them by `stance
 * export`'s writer; tests/test_export.c checks that the two are one.
 *
 * Those of tests/robots are let go, from their starts, for 1.5 s in steps of 2 ms by each method:
 * they fall, strike stops, come to rest. RABBIT as scenarios/mechanisms/rabbit.yaml describes it
 * has the regulator of that file, torque limits and friction, in steps of 1 ms: 1 s in flight, on
 * one foot, on both, and on both with feet that leave the ground at first. MuJoCo's settings are
 * its defaults; case by case it does its steps, then the kernels of the two widest instruction sets
 * theirs, round after round, in processor time on one core.
 *
 * Usage: bench_mujoco_robots [ROBOT ...]: rows of bench.csv on standard output.
 */
#include "analysis/bench/bench.h"
#include "mujoco_model.h"
#include "runner/plan/kernels.h"
#include "runner/plan/mjcf.h"

#include <math.h>

enum { MUJOCO_CASES = 32, CASES = 256, ROUNDS = 7, MOST_ISAS = 2 };

/* What differs from a scenario: settings, and how far above its start it begins. */
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
static const struct regime rabbit[] = {
    {"rabbit", "flight", RABBIT, "implicit", 1000, SET(on_one)},
    {"rabbit", "one foot", RABBIT, "implicit", 0, SET(on_one)},
    {"rabbit", "two feet", RABBIT, "implicit", 0, SET(on_two)},
    {"rabbit", "stepping", RABBIT, "implicit", 0, SET(stepping)},
};
static const char *const robots[] = {"cart_pole", "compass",  "biped",        "rabbit",
                                     "hopper",    "walker2d", "half_cheetah", "humanoid"};
static const char *const methods[] = {"midpoint", "capturing"};

struct beside {
    struct scenario scenario;
    struct plan plan;
    struct kernels kernels;
    size_t isas;
    mjModel *model;
    mjData *data;
    int joint[STANCE_MAX_COORDINATES]; /* MuJoCo's index of each coordinate */
    stance_case cases[CASES];
    stance_result results[CASES];
};

static bool take(struct beside *b, const struct regime *regime)
{
    enum { MOST_SETS = 32 };
    char named[64];
    const char *sets[MOST_SETS] = {named}, *isa[MOST_ISAS];
    snprintf(named, sizeof named, "method.name=%s", regime->method);
    for (size_t i = 0; i < regime->sets; i++)
        sets[1 + i] = regime->set[i];
    const struct parallel alone = parallel_alone();
    struct plan_error error = {.message.text = ""};
    stance_message message = {""};
    for (b->isas = 0; b->isas < MOST_ISAS && stance_isa((int)b->isas); b->isas++)
        isa[b->isas] = stance_isa((int)b->isas);
    if (!scenario_read(&b->scenario, regime->file, NULL, sets, 1 + regime->sets, stderr))
        return false;
    if (!plan_make(&b->plan, &b->scenario, false, 0, false, &error) ||
        !plan_compute_designs(&b->plan, &alone, &error) ||
        kernels_take(
            &b->kernels, &b->plan,
            &(struct kernels_choice){.isa = isa, .isas = b->isas, .always = true, .quiet = true},
            &alone, &message) != EXIT_DONE) {
        fprintf(stderr, "bench_mujoco_robots: %s%s\n", error.message.text, message.text);
        return false;
    }
    for (size_t k = b->kernels.count; k < b->isas; k++) /* the program carries it */
        b->kernels.kernel[k] =
            stance_kernel_find(b->scenario.scene, stance_method_find(regime->method), isa[k]);
    for (uint64_t row = 0; row < CASES; row++) {
        int method;
        /* 7 and 256 have no common divisor: the first ones are spread as evenly as all. */
        stance_case *const c = &b->cases[row * 7 % CASES];
        if (!plan_resolve(&b->plan, row, c, &method))
            return false;
        if (b->scenario.scene->coordinates > 1)
            c->position[1] += regime->lift;
    }
    return true;
}

static bool make_model(struct beside *b)
{
    char *xml = NULL;
    size_t size = 0;
    FILE *const out = open_memstream(&xml, &size);
    if (!out)
        return false;
    mjcf_write(out, b->scenario.scene, b->cases, "robot");
    fclose(out);
    b->model = mujoco_model(xml);
    free(xml);
    if (!b->model)
        return false;
    b->model->opt.integrator = mjINT_EULER; /* the defaults */
    b->model->opt.cone = mjCONE_PYRAMIDAL;
    b->data = mj_makeData(b->model);
    for (int i = 0; i < b->scenario.scene->coordinates; i++)
        b->joint[i] = mj_name2id(b->model, mjOBJ_JOINT, b->scenario.scene->coordinate[i].name);
    return b->data != NULL;
}

/* Simulates a case with the law of state feedback; returns the contacts, summed over steps. */
static int simulate(struct beside *b, const stance_case *c)
{
    const stance_scene *const scene = b->scenario.scene;
    const int n = scene->coordinates, p = scene->postures;
    int contacts = 0;
    mj_resetData(b->model, b->data);
    for (int i = 0; i < n; i++) {
        b->data->qpos[b->joint[i]] = c->position[i];
        b->data->qvel[b->joint[i]] = c->velocity[i];
    }
    for (int64_t k = 0; k < c->steps; k++) {
        double x[2 * STANCE_MAX_POSTURE];
        for (int j = 0; j < p; j++) {
            const int from = b->joint[scene->posture[j]];
            x[j] = b->data->qpos[from] - c->near.target[j];
            x[p + j] = b->data->qvel[from];
        }
        for (int i = 0; i < scene->actuators; i++) { /* MuJoCo clips them */
            double sum = c->near.feedforward[i];
            for (int j = 0; j < 2 * p; j++)
                sum -= c->near.gain[i][j] * x[j];
            b->data->ctrl[i] = sum;
        }
        mj_step(b->model, b->data);
        contacts += b->data->ncon;
    }
    return contacts;
}

static void report(struct bench_row row, const char *quantity, const char *unit, double *values)
{
    row.quantity = quantity;
    row.unit = unit;
    row.value = bench_spread(values, ROUNDS);
    bench_csv_row(stdout, &row);
}

static void compare(struct beside *b, const struct regime *regime)
{
    double theirs[ROUNDS], ours[MOST_ISAS][ROUNDS], contacts = 0, failed = 0;
    const double steps = (double)b->cases[0].steps;
    for (int r = -1; r < ROUNDS; r++) { /* the first warms up */
        const int round = r < 0 ? 0 : r;
        double begin = bench_clock();
        contacts = 0;
        for (int i = 0; i < MUJOCO_CASES; i++)
            contacts += simulate(b, &b->cases[i]) / (steps * MUJOCO_CASES);
        theirs[round] = 1e9 / (steps * MUJOCO_CASES) * (bench_clock() - begin);
        for (size_t k = 0; k < b->isas; k++) {
            begin = bench_clock();
            b->kernels.kernel[k]->run(b->cases, b->results, CASES);
            ours[k][round] = 1e9 / (steps * CASES) * (bench_clock() - begin);
        }
    }
    for (int i = 0; i < CASES; i++)
        failed += b->results[i].status != STANCE_DONE;
    struct bench_row row = {.subject = "mujoco default",
                            .scene = regime->robot,
                            .regime = regime->name,
                            .ranks = 1,
                            .step = b->cases[0].step,
                            .cases = MUJOCO_CASES,
                            .repeats = ROUNDS};
    fprintf(stderr, "%s, %s: %.2f contacts a step, %g of %d cases of stance failed\n",
            regime->robot, regime->name, contacts, failed, CASES);
    for (size_t k = 0; k < b->isas; k++) {
        double ratio[ROUNDS];
        for (int r = 0; r < ROUNDS; r++)
            ratio[r] = theirs[r] / ours[k][r];
        row.method = regime->method;
        row.isa = b->kernels.kernel[k]->isa;
        row.lanes = b->kernels.kernel[k]->lanes;
        report(row, "ratio to stance", "1", ratio);
        const struct bench_spread spread = row.value = bench_spread(ratio, ROUNDS);
        row.subject = "stance";
        row.cases = CASES;
        report(row, "time per step", "ns", ours[k]);
        row.subject = "mujoco default";
        row.cases = MUJOCO_CASES;
        fprintf(stderr,
                "%s, %s: mujoco default / stance %s %-6s (%5.1f ns): %5.1f (%.1f ... %.1f)\n",
                regime->robot, regime->name, regime->method, row.isa,
                bench_spread(ours[k], ROUNDS).median, spread.median, spread.lowest, spread.highest);
    }
    row.isa = row.method = NULL, row.lanes = 0;
    report(row, "time per step", "ns", theirs);
    fprintf(stderr, "%s, %s: mujoco default %.0f ns a step\n", regime->robot, regime->name,
            bench_spread(theirs, ROUNDS).median);
}

static bool run(struct beside *b, const struct regime *regime)
{
    if (!take(b, regime) || !make_model(b))
        return false;
    compare(b, regime);
    mj_deleteData(b->data);
    mj_deleteModel(b->model);
    kernels_give_back(&b->kernels);
    plan_free(&b->plan);
    scenario_free(&b->scenario);
    return true;
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
    static struct beside b;
    bool good = true;
    for (size_t r = 0; r < sizeof rabbit / sizeof *rabbit && asked("rabbit", argc - 1, argv + 1);
         r++)
        good = good && run(&b, &rabbit[r]);
    for (size_t r = 0; r < sizeof robots / sizeof *robots; r++)
        for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
            char file[64];
            snprintf(file, sizeof file, "tests/robots/%s.yaml", robots[r]);
            const struct regime let_go = {robots[r], "let go", file, methods[m], 0, NULL, 0};
            if (asked(robots[r], argc - 1, argv + 1))
                good = good && run(&b, &let_go);
        }
    return good ? 0 : 1;
}
