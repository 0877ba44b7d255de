/* bench_mujoco_rabbit.c - RABBIT as scenarios/mechanisms/rabbit.yaml describes it, timed beside
 * MuJoCo, which gets it by `stance export`'s writer; tests/test_export.c checks that the two are
 * one.
 *
 * The same regulator, torque limits (joints have none), friction and steps of 1 ms, the same
 * starts: 1 s in flight, on one foot, on both, and on both with feet that leave the ground at
 * first. MuJoCo's settings are its defaults; case by case it does its steps, then the kernels of
 * the two widest instruction sets theirs, round after round, in processor time on one core.
 */
#include "analysis/bench/bench.h"
#include "mujoco_model.h"
#include "runner/plan/kernels.h"
#include "runner/plan/mjcf.h"

#include <math.h>

enum { MUJOCO_CASES = 32, CASES = 256, ROUNDS = 7, MOST_ISAS = 2 };

/* What differs from the scenario: settings, and how far above its start it begins. */
static const struct regime {
    const char *name;
    double lift; /* m */
    const char *const set[8];
    size_t sets;
} regimes[] = {
    {"flight", 1000, {NULL}, 0},
    {"one foot", 0, {NULL}, 0},
    {"two feet",
     0,
     {"ground.contacts=[foot1, foot2]", "initial.support=[foot1, foot2]",
      "initial.equilibrium={thigh1: 0.4, shank1: -0.4, shank2: -0.3}", "controller.weights={}",
      "sweep.grid[0].from=-0.002", "sweep.grid[0].to=0.002", "sweep.grid[1].from=-0.005",
      "sweep.grid[1].to=0.005"},
     8},
    {"stepping", /* from as far off as on one foot: feet leave the ground and come back */
     0,
     {"ground.contacts=[foot1, foot2]", "initial.support=[foot1, foot2]",
      "initial.equilibrium={thigh1: 0.4, shank1: -0.4, shank2: -0.3}", "controller.weights={}"},
     4},
};

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
    static const char *const always[] = {"method={name: implicit, step: 0.001}",
                                         "stop={time: 1, settle: off}",
                                         "sweep.grid[0].from=-0.02",
                                         "sweep.grid[0].to=0.02",
                                         "sweep.grid[1].from=-0.05",
                                         "sweep.grid[1].to=0.05",
                                         "sweep.grid[0].count=16",
                                         "sweep.grid[1].count=16"};
    enum { ALWAYS = sizeof always / sizeof *always };
    const struct parallel alone = parallel_alone();
    const char *sets[ALWAYS + 8], *isa[MOST_ISAS];
    struct plan_error error = {.message.text = ""};
    stance_message message = {""};
    memcpy(sets, always, sizeof always);
    memcpy(sets + ALWAYS, regime->set, sizeof regime->set);
    for (b->isas = 0; b->isas < MOST_ISAS && stance_isa((int)b->isas); b->isas++)
        isa[b->isas] = stance_isa((int)b->isas);
    if (!scenario_read(&b->scenario, "scenarios/mechanisms/rabbit.yaml", NULL, sets,
                       ALWAYS + regime->sets, stderr))
        return false;
    if (!plan_make(&b->plan, &b->scenario, false, 0, false, &error) ||
        !plan_compute_designs(&b->plan, &alone, &error) ||
        kernels_take(
            &b->kernels, &b->plan,
            &(struct kernels_choice){.isa = isa, .isas = b->isas, .always = true, .quiet = true},
            &alone, &message) != EXIT_DONE) {
        fprintf(stderr, "bench_mujoco_rabbit: %s%s\n", error.message.text, message.text);
        return false;
    }
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
    mjcf_write(out, b->scenario.scene, b->cases, "RABBIT");
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

static void compare(struct beside *b, const char *regime)
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
                            .scene = "rabbit",
                            .regime = regime,
                            .ranks = 1,
                            .step = b->cases[0].step,
                            .cases = MUJOCO_CASES,
                            .repeats = ROUNDS};
    fprintf(stderr, "rabbit, %-8s  %.2f contacts a step, %g of %d cases of stance failed\n", regime,
            contacts, failed, CASES);
    for (size_t k = 0; k < b->isas; k++) {
        double ratio[ROUNDS];
        for (int r = 0; r < ROUNDS; r++)
            ratio[r] = theirs[r] / ours[k][r];
        row.method = "implicit";
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
                "rabbit, %-8s  mujoco default / stance implicit %-6s (%5.1f ns): %5.1f (%.1f ... "
                "%.1f)\n",
                regime, row.isa, bench_spread(ours[k], ROUNDS).median, spread.median, spread.lowest,
                spread.highest);
    }
    row.isa = row.method = NULL, row.lanes = 0;
    report(row, "time per step", "ns", theirs);
    fprintf(stderr, "rabbit, %-8s  mujoco default %.0f ns a step\n", regime,
            bench_spread(theirs, ROUNDS).median);
}

int main(void)
{
    static struct beside b;
    for (size_t r = 0; r < sizeof regimes / sizeof *regimes; r++) {
        if (!take(&b, &regimes[r]) || !make_model(&b))
            return 1;
        compare(&b, regimes[r].name);
        mj_deleteData(b.data);
        mj_deleteModel(b.model);
        kernels_give_back(&b.kernels);
        plan_free(&b.plan);
        scenario_free(&b.scenario);
    }
    return 0;
}
