/* bench_tables.c - the biped by its hand-written header and by a description's tables: what a
 * description costs.
 *
 * scenarios/mechanisms/pushed.yaml describes the paper's biped. The workloads of the built-in
 * scene, one second in steps of 1 ms, run by both, round after round, in processor time on one
 * core; their ends must agree.
 */
#include "analysis/bench/bench.h"
#include "runner/plan/kernels.h"

#include <math.h>
#include <string.h>

enum { CASES = 256, ROUNDS = 15, MOST_ISAS = 2 };

static const char *const methods[] = {"implicit", "midpoint"};

struct described {
    struct scenario scenario;
    struct plan plan;
    struct kernels kernels;
    size_t isas;
    stance_case cases[CASES];
    stance_result results[CASES];
};

static bool take(struct described *d, const char *method)
{
    const struct parallel alone = parallel_alone();
    const char *isa[MOST_ISAS];
    char set[64];
    const char *const sets[] = {set, "robot.points.hip={body: trunk, lowest: 0.1}", "sweep={}"};
    struct plan_error error = {.message.text = ""};
    stance_message message = {""};
    snprintf(set, sizeof set, "method.name=%s", method);
    for (d->isas = 0; d->isas < MOST_ISAS && stance_isa((int)d->isas); d->isas++)
        isa[d->isas] = stance_isa((int)d->isas);
    if (!scenario_read(&d->scenario, "scenarios/mechanisms/pushed.yaml", NULL, sets,
                       sizeof sets / sizeof *sets, stderr))
        return false;
    if (!plan_make(&d->plan, &d->scenario, false, 0, false, &error) ||
        !plan_compute_designs(&d->plan, &alone, &error) ||
        kernels_take(&d->kernels, &d->plan, &(struct kernels_choice){NULL, isa, 0, d->isas}, &alone,
                     true, &message) != EXIT_DONE) {
        fprintf(stderr, "bench_tables: %s%s\n", error.message.text, message.text);
        return false;
    }
    return true;
}

/* The built-in scene's case as one of the description, whose x and z are the hip's. */
static bool same_case(const struct described *d, const stance_case *built_in, stance_case *c)
{
    const double lt = built_in->robot[1], *const q = built_in->position,
                 *const v = built_in->velocity;
    stance_case own;
    int method;
    if (!plan_resolve(&d->plan, 0, &own, &method))
        return false;
    *c = *built_in;
    c->scene = own.scene;
    c->tree = own.tree;
    c->body = own.body;
    memcpy(c->robot, own.robot, sizeof c->robot);
    c->position[0] = q[0] + lt * sin(q[2]);
    c->position[1] = q[1] - lt * cos(q[2]);
    c->velocity[0] = v[0] + lt * cos(q[2]) * v[2];
    c->velocity[1] = v[1] + lt * sin(q[2]) * v[2];
    return true;
}

static void compare(struct described *d, const stance_scene *biped, const char *regime,
                    const char *method)
{
    static stance_case cases[CASES];
    static stance_result results[CASES];
    if (!bench_cases(biped, regime, cases, CASES))
        return;
    for (int i = 0; i < CASES; i++)
        if (!same_case(d, &cases[i], &d->cases[i]))
            return;
    for (size_t k = 0; k < d->isas; k++) {
        const stance_kernel *const header =
            stance_kernel_find(biped, stance_method_find(method), stance_isa((int)k));
        const double steps = (double)cases[0].steps;
        double time[2][ROUNDS], ratio[ROUNDS];
        for (int r = -1; r < ROUNDS; r++) { /* the first warms up */
            const int round = r < 0 ? 0 : r;
            double begin = bench_clock();
            header->run(cases, results, CASES);
            time[0][round] = 1e9 / (steps * CASES) * (bench_clock() - begin);
            begin = bench_clock();
            d->kernels.kernel[k]->run(d->cases, d->results, CASES);
            time[1][round] = 1e9 / (steps * CASES) * (bench_clock() - begin);
            ratio[round] = time[1][round] / time[0][round];
        }
        double off = 0;
        for (int i = 0; i < CASES; i++)
            for (int a = 2; a < 5; a++)
                off = fmax(off, fabs(results[i].position[a] - d->results[i].position[a]));
        struct bench_row row = {.subject = "tables",
                                .scene = "biped",
                                .regime = regime,
                                .method = method,
                                .isa = header->isa,
                                .lanes = header->lanes,
                                .ranks = 1,
                                .step = cases[0].step,
                                .cases = CASES,
                                .repeats = ROUNDS,
                                .quantity = "ratio to the header",
                                .unit = "1",
                                .value = bench_spread(ratio, ROUNDS)};
        bench_csv_row(stdout, &row);
        fprintf(stderr,
                "biped, %-8s %-8s %-6s  header %5.1f ns, tables %5.1f ns, ratio %.3f (%.3f ... "
                "%.3f), angles agree to %.0e\n",
                regime, method, header->isa, bench_spread(time[0], ROUNDS).median,
                bench_spread(time[1], ROUNDS).median, row.value.median, row.value.lowest,
                row.value.highest, off);
    }
}

int main(void)
{
    static struct described d;
    const stance_scene *const biped = stance_scene_find("biped");
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        if (!take(&d, methods[m]))
            return 1;
        for (const stance_workload *w = biped->workload; w->name; w++)
            compare(&d, biped, w->name, methods[m]);
        kernels_give_back(&d.kernels);
        plan_free(&d.plan);
        scenario_free(&d.scenario);
    }
    return 0;
}
