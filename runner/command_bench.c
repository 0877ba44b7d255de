/* command_bench.c - `stance bench`: nanoseconds per case-step on one core, for each regime, method
 * and instruction set. Medians of repeated runs; the ratios are what can be trusted on a noisy
 * machine.
 *
 * Regimes, all with the default robot and a step of 1 ms: flight (nothing near the ground), one
 * foot (the balance of section 3.2 inside its domain, torques held for 1 ms), two feet (standing
 * with the legs held by a sampled servo).
 */
#include "command.h"
#include "instruction_set.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CASES = 512, MAX_REPEATS = 99 };

enum regime { FLIGHT, ONE_FOOT, TWO_FEET, REGIMES };
static const char *const regime_name[REGIMES] = {"flight", "one foot", "two feet"};

struct measurement {
    double ns, ns_low, ns_high; /* per case-step: median, minimum, maximum */
    double iterations;          /* Newton iterations per step */
    int failed;
};

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Numbers in [0, 1) that are the same everywhere. */
static double spread(int i, int k)
{
    const double x = (i + 1) * (k == 0 ? 0.6180339887498949 : 0.7548776662466927);
    return x - floor(x);
}

/* The balance workload: what the other regimes start from. */
static bool base_case(const stance_scene *scene, stance_case *c)
{
    const stance_equilibrium_choice choice = {0, {-0.41, NAN, 0.82}, false};
    static const double re[6] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6}, im[6] = {0};
    stance_equilibrium equilibrium;
    double A[36], B[12];
    memset(c, 0, sizeof *c);
    for (int i = 0; i < scene->robot_count; i++)
        c->robot[i] = scene->robot[i].fallback;
    if (scene->equilibrium(c->robot, &choice, &equilibrium, NULL) != STANCE_OK ||
        scene->linearise(c->robot, &equilibrium, A, B) != STANCE_OK ||
        stance_place(6, 2, A, B, re, im, &c->gain[0][0], NULL, NULL, NULL) != STANCE_OK)
        return false;
    memcpy(c->position, equilibrium.position, sizeof c->position);
    memcpy(c->feedforward, equilibrium.torque, sizeof c->feedforward);
    for (int i = 0; i < scene->postures; i++)
        c->target[i] = equilibrium.position[scene->posture[i]];
    c->friction = 0.8;
    c->contacts = 1;
    c->torque_limit = 10;
    c->sample_every = 1;
    c->step = 1e-3;
    c->steps = 1000;
    c->support = 0;
    c->has_target = true;
    c->settle_angle = 0.05, c->settle_rate = 0.5, c->settle_hold = 0.5;
    c->fall_height = -1e9; /* never */
    return true;
}

static void make_case(const stance_scene *scene, const stance_case *base, enum regime regime, int i,
                      stance_case *c)
{
    *c = *base;
    if (regime == FLIGHT) {
        c->contacts = 3;
        c->position[1] += 1000;
        for (int k = 2; k < 5; k++)
            c->velocity[k] = 4 * spread(i, k % 2) - 2;
    } else if (regime == ONE_FOOT) {
        c->position[2] += -0.09 + 0.1 * spread(i, 0);
        scene->stand(c->robot, 0, c->position, c->velocity);
    } else {
        const double leg = 0.5;
        memset(c->gain, 0, sizeof c->gain);
        memset(c->feedforward, 0, sizeof c->feedforward);
        c->contacts = 3;
        c->torque_limit = 100;
        c->has_target = false;
        for (int k = 0; k < 2; k++) {
            c->gain[k][1 + k] = 200, c->gain[k][4 + k] = 10;
            c->target[1 + k] = k ? -leg : leg;
            c->position[3 + k] = c->target[1 + k];
        }
        c->position[2] = -0.02 * spread(i, 0); /* the other foot up to a centimetre high */
        scene->stand(c->robot, 0, c->position, c->velocity);
    }
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void measure(const stance_kernel *kernel, const stance_case *cases, stance_result *results,
                    int repeats, struct measurement *m)
{
    double time[MAX_REPEATS] = {0};
    for (int r = -1; r < repeats; r++) { /* the first warms up */
        const double begin = seconds();
        kernel->run(cases, results, CASES);
        if (r >= 0)
            time[r] = seconds() - begin;
    }
    double steps = 0, iterations = 0;
    m->failed = 0;
    for (int i = 0; i < CASES; i++) {
        steps += (double)results[i].steps;
        iterations += (double)results[i].iterations;
        m->failed += results[i].status == STANCE_FAILED;
    }
    qsort(time, (size_t)repeats, sizeof *time, ascending);
    m->ns = 1e9 * time[repeats / 2] / steps;
    m->ns_low = 1e9 * time[0] / steps;
    m->ns_high = 1e9 * time[repeats - 1] / steps;
    m->iterations = iterations / steps;
}

static void report(json_t *rows, const stance_kernel *k, enum regime regime,
                   const struct measurement *m, double scalar_ns)
{
    const double speedup = scalar_ns / m->ns;
    if (rows) {
        json_t *const row =
            json_pack("{s:s, s:s, s:s, s:b, s:i, s:f, s:f, s:f, s:f, s:o, s:i}", "regime",
                      regime_name[regime], "method", k->method->name, "isa", k->isa, "in_use",
                      k == instruction_set_kernel(k->scene, k->method), "lanes", k->lanes,
                      "ns_per_step", m->ns, "ns_min", m->ns_low, "ns_max", m->ns_high,
                      "iterations_per_step", m->iterations, "speedup_over_scalar",
                      isnan(speedup) ? json_null() : json_real(speedup), "failed", m->failed);
        json_array_append_new(rows, row);
        return;
    }
    printf("%-9s  %-12s %-7s %5d  %9.1f  %8.1f %8.1f  %10.2f  ", regime_name[regime],
           k->method->name, k->isa, k->lanes, m->ns, m->ns_low, m->ns_high, m->iterations);
    if (isnan(speedup))
        printf("%9s\n", "-");
    else
        printf("%9.2f\n", speedup);
    fflush(stdout);
}

/* A method with each instruction set of this machine, or with the one that is asked for alone. */
static void bench_method(const stance_method *method, enum regime regime, stance_case *cases,
                         stance_result *results, int repeats, json_t *rows)
{
    static const char *const isas[] = {"scalar", "sse2", "neon", "avx2", "avx512"};
    const stance_scene *const scene = stance_scene_find("biped");
    double scalar_ns = NAN;
    struct measurement m;

    for (int i = 0; i < CASES; i++)
        cases[i].tolerance = method->tolerance;
    if (instruction_set_asked()) {
        const stance_kernel *const k = instruction_set_kernel(scene, method);
        measure(k, cases, results, repeats, &m);
        report(rows, k, regime, &m, k->lanes == 1 ? m.ns : NAN);
        return;
    }
    for (size_t i = 0; i < sizeof isas / sizeof *isas; i++) {
        const stance_kernel *const k = stance_kernel_find(scene, method, isas[i]);
        if (!k || strcmp(k->isa, isas[i]) != 0) /* else the scalar one again */
            continue;
        measure(k, cases, results, repeats, &m);
        if (i == 0)
            scalar_ns = m.ns;
        report(rows, k, regime, &m, scalar_ns);
    }
}

static int bench(int repeats, json_t *rows)
{
    const stance_scene *const scene = stance_scene_find("biped");
    stance_case base, *cases = calloc(CASES, sizeof *cases);
    stance_result *results = calloc(CASES, sizeof *results);
    int code = EXIT_DONE;
    if (!cases || !results || !base_case(scene, &base)) {
        fprintf(stderr, "stance bench: the benchmark's cases could not be made\n");
        code = EXIT_CASES_FAILED;
        goto done;
    }
    if (!rows)
        printf("instruction set in use: %s\n"
               "regime     method       isa     lanes  ns / step  (min      max)     iterations  "
               "x scalar\n",
               instruction_set());
    for (enum regime regime = 0; regime < REGIMES; regime++) {
        for (int i = 0; i < CASES; i++)
            make_case(scene, &base, regime, i, &cases[i]);
        for (const stance_method *const *method = stance_methods(); *method; method++)
            bench_method(*method, regime, cases, results, repeats, rows);
    }
done:
    free(cases);
    free(results);
    return code;
}

static int run(int argc, char **argv)
{
    bool help;
    if (argc > 1 && strcmp(argv[1], "accuracy") == 0)
        return command_accuracy.run(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "failure") == 0)
        return command_failure.run(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "schedule") == 0)
        return command_schedule.run(argc - 1, argv + 1);
    const char *operand[1], *repeat_text[1];
    size_t operands, json_count = 0, repeat_count = 0;
    const struct option_spec specs[] = {{"--json", false, NULL, 0, &json_count},
                                        {"--repeats", true, repeat_text, 1, &repeat_count}};
    if (!command_options(&command_bench, argc, argv, specs, 2, operand, 0, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (!instruction_set_usable("bench"))
        return EXIT_USAGE;
    int repeats = 5;
    if (repeat_count) {
        char *end;
        const long value = strtol(repeat_text[0], &end, 10);
        if (*end || value < 1 || value > MAX_REPEATS) {
            fprintf(stderr, "stance bench: --repeats takes a whole number from 1 to %d\n",
                    MAX_REPEATS);
            return EXIT_USAGE;
        }
        repeats = (int)value;
    }
    json_t *rows = json_count ? json_array() : NULL;
    const int code = bench(repeats, rows);
    if (rows) {
        json_dumpf(rows, stdout, JSON_INDENT(1));
        putchar('\n');
        json_decref(rows);
    }
    return code;
}

const struct command command_bench = {
    "bench",
    "stance bench [--repeats N] [--json]",
    "speed of the stepping kernels on one core",
    run,
    "Prints nanoseconds per case-step: the median of N runs (default 5), the extremes, Newton\n"
    "iterations per step and the speed-up over one lane, for the regimes\n"
    "  flight    nothing near the ground\n"
    "  one foot  linear balance control, torques held for 1 ms\n"
    "  two feet  standing with the legs held\n"
    "for each method and each instruction set of this machine (or the one that the environment\n"
    "variable STANCE_ISA names), 512 cases of 1000 steps of 1 ms.\n"
    "\n"
    "`stance bench accuracy -h`, `failure -h` and `schedule -h` tell of the studies of error "
    "against\n"
    "cost, of where methods fail, and of jobs on thousands of ranks.\n"
    "\n"
    "--json: a list of objects with keys regime, method, isa, in_use (by `stance run`), lanes,\n"
    "ns_per_step, ns_min, ns_max, iterations_per_step, speedup_over_scalar (null: scalar was not\n"
    "measured), failed.\n",
};
