/* bench.c - the workloads of the speed benchmarks, and their results as CSV. */
#include "bench.h"

#include "analysis/statistics/statistics.h"
#include "engine/control/design.h"
#include "runner/store/build_info.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>

enum { STEPS = 1000 };
static const double step = 1e-3; /* s */

/* ---- workloads ---------------------------------------------------------------------------- */

/* Numbers in [0, 1) that are the same everywhere and evenly spread however many are taken. */
static double even(int i, double ratio)
{
    return (i + 1) * ratio - floor((i + 1) * ratio);
}

/* Brings *c to an equilibrium and balances it there by gains with real poles. */
static bool balance(const stance_scene *scene, const stance_equilibrium_choice *choice,
                    stance_case *c)
{
    enum { STATES = 2 * STANCE_MAX_POSTURE };
    const int n = 2 * scene->postures, m = scene->actuators;
    stance_equilibrium equilibrium;
    stance_message ignored;
    double A[STATES * STATES], B[STATES * STANCE_MAX_ACTUATORS];
    double re[STATES], im[STATES] = {0}, K[STANCE_MAX_ACTUATORS * STATES];
    for (int i = 0; i < n; i++)
        re[i] = -3 - 0.3 * i;
    if (scene->equilibrium(scene, c->robot, choice, &equilibrium, NULL) != STANCE_OK ||
        scene->linearise(scene, c->robot, &equilibrium, A, B) != STANCE_OK ||
        stance_place(STANCE_ROBUST, &(stance_plant){n, m, A, B}, 0, &(stance_poles){re, im}, K,
                     NULL, &ignored) != STANCE_OK)
        return false;
    memcpy(c->position, equilibrium.position, sizeof c->position);
    memcpy(c->near.feedforward, equilibrium.torque, sizeof c->near.feedforward);
    for (int i = 0; i < m; i++)
        memcpy(c->near.gain[i], &K[i * n], (size_t)n * sizeof *K);
    for (int k = 0; k < scene->postures; k++)
        c->near.target[k] = equilibrium.position[scene->posture[k]];
    c->has_target = true;
    c->supports = choice->supports;
    return true;
}

bool bench_cases(const stance_scene *scene, const char *regime, stance_case *cases, int count)
{
    const stance_workload *workload = scene->workload;
    while (workload && workload->name && strcmp(workload->name, regime) != 0)
        workload++;
    stance_case base = {.friction = 0.8,
                        .contacts = (1U << scene->contacts) - 1,
                        .torque_limit = INFINITY,
                        .sample_every = 1,
                        .step = step,
                        .steps = STEPS,
                        .settle_angle = 0.05,
                        .settle_rate = 0.5,
                        .settle_hold = 0.5};
    stance_robot_fallback(scene, base.robot);
    base.robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9; /* never */
    stance_case_robot(scene, &base);
    if (!workload || !workload->name ||
        (workload->balance && !balance(scene, workload->balance, &base)))
        return false;
    for (int i = 0; i < count; i++) {
        cases[i] = base;
        workload->begin((double[2]){even(i, 0.6180339887498949), even(i, 0.7548776662466927)},
                        &cases[i]);
    }
    return true;
}

/* ---- measuring ---------------------------------------------------------------------------- */

double bench_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

struct bench_spread bench_spread(double *values, int n)
{
    statistics_sort(values, (size_t)n);
    return (struct bench_spread){(values[(n - 1) / 2] + values[n / 2]) / 2, values[0],
                                 values[n - 1]};
}

/* ---- CSV ---------------------------------------------------------------------------------- */

const char *const bench_column_names[BENCH_COLUMN_COUNT] = {
#define BENCH_COLUMN(NAME, name) #name,
    BENCH_COLUMNS(BENCH_COLUMN)
#undef BENCH_COLUMN
};

/* A line of fields, whatever is in them. */
static void put_line(FILE *out, const char *const *field)
{
    for (int k = 0; k < BENCH_COLUMN_COUNT; k++) {
        for (const char *text = field[k] ? field[k] : ""; *text; text++)
            putc(*text == ',' || *text == '"' || (unsigned char)*text < ' ' ? ' ' : *text, out);
        putc(k + 1 < BENCH_COLUMN_COUNT ? ',' : '\n', out);
    }
}

void bench_csv_head(FILE *out)
{
    put_line(out, bench_column_names);
}

/* What /proc/cpuinfo calls the processor, or else its architecture. */
static void find_processor(char *name, size_t size)
{
    FILE *list = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (list && fgets(line, sizeof line, list)) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon) {
            line[strcspn(line, "\n")] = '\0';
            snprintf(name, size, "%s", colon + 1 + (colon[1] == ' '));
            break;
        }
    }
    if (list)
        fclose(list);
}

void bench_csv_row(FILE *out, const struct bench_row *row)
{
    struct utsname machine = {.machine = "unknown", .nodename = "unknown"};
    char number[BENCH_HIGHEST + 1][32] = {{0}}, processor[256], date[16] = "";
    const int counts[][2] = {{BENCH_LANES, row->lanes},
                             {BENCH_RANKS, row->ranks},
                             {BENCH_CASES, row->cases},
                             {BENCH_REPEATS, row->repeats}};
    const time_t now = time(NULL);
    struct tm day;
    uname(&machine);
    snprintf(processor, sizeof processor, "%s", machine.machine);
    find_processor(processor, sizeof processor);
    if (gmtime_r(&now, &day))
        strftime(date, sizeof date, "%Y-%m-%d", &day);
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        if (counts[i][1] > 0)
            snprintf(number[counts[i][0]], sizeof number[0], "%d", counts[i][1]);
    if (row->step > 0)
        snprintf(number[BENCH_STEP], sizeof number[0], "%g", row->step);
    snprintf(number[BENCH_MEDIAN], sizeof number[0], "%.6g", row->value.median);
    snprintf(number[BENCH_LOWEST], sizeof number[0], "%.6g", row->value.lowest);
    snprintf(number[BENCH_HIGHEST], sizeof number[0], "%.6g", row->value.highest);
    put_line(out, (const char *const[BENCH_COLUMN_COUNT]){row->subject,
                                                          row->scene,
                                                          row->regime,
                                                          row->method,
                                                          row->isa,
                                                          number[BENCH_LANES],
                                                          number[BENCH_RANKS],
                                                          number[BENCH_STEP],
                                                          number[BENCH_CASES],
                                                          number[BENCH_REPEATS],
                                                          row->quantity,
                                                          row->unit,
                                                          number[BENCH_MEDIAN],
                                                          number[BENCH_LOWEST],
                                                          number[BENCH_HIGHEST],
                                                          build_revision,
                                                          build_compiler,
                                                          build_flags,
                                                          processor,
                                                          machine.nodename,
                                                          date});
}
