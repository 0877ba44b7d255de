/* bench.c - the workloads of the speed benchmarks, and their results as CSV. */
#include "bench.h"

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
    double A[STATES * STATES], B[STATES * STANCE_MAX_ACTUATORS];
    double re[STATES], im[STATES] = {0}, K[STANCE_MAX_ACTUATORS * STATES];
    for (int i = 0; i < n; i++)
        re[i] = -3 - 0.3 * i;
    if (scene->equilibrium(c->robot, choice, &equilibrium, NULL) != STANCE_OK ||
        scene->linearise(c->robot, &equilibrium, A, B) != STANCE_OK ||
        stance_place(n, m, A, B, re, im, K, NULL, NULL, NULL) != STANCE_OK)
        return false;
    memcpy(c->position, equilibrium.position, sizeof c->position);
    memcpy(c->near.feedforward, equilibrium.torque, sizeof c->near.feedforward);
    for (int i = 0; i < m; i++)
        memcpy(c->near.gain[i], &K[i * n], (size_t)n * sizeof *K);
    for (int k = 0; k < scene->postures; k++)
        c->near.target[k] = equilibrium.position[scene->posture[k]];
    c->has_target = true;
    return true;
}

bool bench_cases(const stance_scene *scene, const char *regime, stance_case *cases, int count)
{
    const stance_workload *workload = scene->workload;
    while (workload->name && strcmp(workload->name, regime) != 0)
        workload++;
    stance_case base = {.friction = 0.8,
                        .contacts = (1U << scene->contacts) - 1,
                        .torque_limit = INFINITY,
                        .sample_every = 1,
                        .step = step,
                        .steps = STEPS,
                        .settle_angle = 0.05,
                        .settle_rate = 0.5,
                        .settle_hold = 0.5,
                        .fall_height = -1e9 /* never */};
    for (int k = 0; k < scene->robot_count; k++)
        base.robot[k] = scene->robot[k].fallback;
    if (!workload->name || (workload->balance && !balance(scene, workload->balance, &base)))
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

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct bench_spread bench_spread(double *values, int n)
{
    qsort(values, (size_t)n, sizeof *values, ascending);
    return (struct bench_spread){(values[(n - 1) / 2] + values[n / 2]) / 2, values[0],
                                 values[n - 1]};
}

/* ---- CSV ---------------------------------------------------------------------------------- */

void bench_csv_head(FILE *out)
{
    fputs("subject,scene,regime,method,isa,lanes,ranks,step_s,cases,repeats,quantity,unit,median,"
          "lowest,highest,revision,compiler,flags,processor,machine,date\n",
          out);
}

/* As a field of its own, whatever is in it. */
static void put_text(FILE *out, const char *text)
{
    for (; *text; text++)
        putc(*text == ',' || *text == '"' || (unsigned char)*text < ' ' ? ' ' : *text, out);
}

static void put_count(FILE *out, int count)
{
    if (count > 0)
        fprintf(out, "%d", count);
    putc(',', out);
}

/* What /proc/cpuinfo calls the processor, or else its architecture. */
static void put_processor(FILE *out, const char *architecture)
{
    FILE *list = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (list && fgets(line, sizeof line, list)) {
        char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon) {
            line[strcspn(line, "\n")] = '\0';
            put_text(out, colon + 1 + (colon[1] == ' '));
            architecture = "";
            break;
        }
    }
    if (list)
        fclose(list);
    put_text(out, architecture);
}

void bench_csv_row(FILE *out, const struct bench_row *row)
{
    const char *const words[] = {row->subject, row->scene, row->regime, row->method, row->isa};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        put_text(out, words[i] ? words[i] : "");
        putc(',', out);
    }
    put_count(out, row->lanes);
    put_count(out, row->ranks);
    if (row->step > 0)
        fprintf(out, "%g", row->step);
    putc(',', out);
    put_count(out, row->cases);
    put_count(out, row->repeats);
    fprintf(out, "%s,%s,%.6g,%.6g,%.6g,", row->quantity, row->unit, row->value.median,
            row->value.lowest, row->value.highest);

    struct utsname machine = {.machine = "unknown", .nodename = "unknown"};
    uname(&machine);
    const char *const build[] = {build_revision(), build_compiler(), build_flags()};
    for (size_t i = 0; i < sizeof build / sizeof build[0]; i++) {
        put_text(out, build[i]);
        putc(',', out);
    }
    put_processor(out, machine.machine);
    putc(',', out);
    put_text(out, machine.nodename);
    const time_t now = time(NULL);
    struct tm day;
    char date[16] = "";
    if (gmtime_r(&now, &day))
        strftime(date, sizeof date, "%Y-%m-%d", &day);
    fprintf(out, ",%s\n", date);
}
