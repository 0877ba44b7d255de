/* command_bench.c - `stance bench`: nanoseconds per case-step on one core, for each scene, regime,
 * method and instruction set.
 *
 * The kernels of a workload are measured in turn, round after round, so that whatever else the
 * machine does meets all of them; medians are printed, and their ratios are what can be trusted.
 */
#include "bench.h"

#include "runner/base/command.h"
#include "runner/plan/instruction_set.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* `stance bench`, below, and `stance bench accuracy`, `failure` and `plot`. */
extern const struct command command_bench, command_accuracy, command_failure, command_speed;

enum { MOST_CASES = 512, FEWEST_CASES = 16, MOST_REPEATS = 99, MOST_KERNELS = 64 };
static const double wanted_time = 0.02; /* s, of one measurement */

/* What is asked for; NULL: all. */
struct selection {
    const char *scene, *regime, *method;
    int repeats, cases; /* cases 0: as many as take wanted_time */
    bool csv;
    json_t *rows; /* NULL: text */
};

/* One kernel in one workload. */
struct measurement {
    const stance_kernel *kernel;
    int cases;
    double time[MOST_REPEATS];          /* s, of all cases once */
    double steps, simulated;            /* of all cases once: steps, seconds */
    double iterations;                  /* Newton iterations per step */
    int failed;                         /* cases */
    struct bench_spread ns, per_second; /* per step, and per simulated second */
};

static double run_once(struct measurement *m, stance_case *cases, stance_result *results)
{
    for (int i = 0; i < m->cases; i++)
        cases[i].tolerance = m->kernel->method->tolerance;
    const double begin = bench_clock();
    m->kernel->run(cases, results, (size_t)m->cases);
    return bench_clock() - begin;
}

/* Warms up, and finds how many cases a measurement takes. */
static void prepare(struct measurement *m, const struct selection *what, stance_case *cases,
                    stance_result *results)
{
    m->cases = what->cases ? what->cases : FEWEST_CASES;
    const double time = run_once(m, cases, results);
    if (!what->cases) {
        const double wanted = floor(wanted_time / time) * FEWEST_CASES;
        m->cases = (int)fmax(FEWEST_CASES, fmin(wanted, MOST_CASES));
    }
}

static void take_spread(struct measurement *m, const stance_result *results, int repeats)
{
    double iterations = 0;
    m->steps = m->simulated = m->failed = 0;
    for (int i = 0; i < m->cases; i++) {
        m->steps += (double)results[i].steps;
        m->simulated += results[i].end_time;
        iterations += (double)results[i].iterations;
        m->failed += results[i].status == STANCE_FAILED;
    }
    m->iterations = iterations / m->steps;
    const struct bench_spread time = bench_spread(m->time, repeats);
    const double step = 1e9 / m->steps, second = 1e9 / m->simulated;
    m->ns = (struct bench_spread){step * time.median, step * time.lowest, step * time.highest};
    m->per_second =
        (struct bench_spread){second * time.median, second * time.lowest, second * time.highest};
}

static void report(const struct selection *what, const char *regime, const stance_case *c,
                   const struct measurement *m, double scalar_ns)
{
    const stance_kernel *const k = m->kernel;
    const char *const scene = k->scene->name;
    if (what->rows) {
        json_array_append_new(
            what->rows,
            json_pack("{s:s, s:s, s:s, s:s, s:i, s:f, s:f, s:f, s:f, s:f, s:o, s:i, s:i, s:f}",
                      "scene", scene, "regime", regime, "method", k->method->name, "isa", k->isa,
                      "lanes", k->lanes, "ns_per_step", m->ns.median, "ns_min", m->ns.lowest,
                      "ns_max", m->ns.highest, "ns_per_second", m->per_second.median,
                      "iterations_per_step", m->iterations, "speedup_over_scalar",
                      isnan(scalar_ns) ? json_null() : json_real(scalar_ns / m->ns.median),
                      "failed", m->failed, "cases", m->cases, "steps", m->steps));
    } else if (what->csv) {
        struct bench_row row = {"stance",        scene, regime,  k->method->name, k->isa,
                                k->lanes,        1,     c->step, m->cases,        what->repeats,
                                "time per step", "ns",  m->ns};
        bench_csv_row(stdout, &row);
        row.quantity = "time per simulated second";
        row.value = m->per_second;
        bench_csv_row(stdout, &row);
        if (m->failed) {
            row.quantity = "cases failed", row.unit = "1";
            row.value = (struct bench_spread){m->failed, m->failed, m->failed};
            bench_csv_row(stdout, &row);
        }
    } else {
        printf("%-6s %-9s %-12s %-7s %5d  %9.1f  %9.1f %9.1f  %12.0f  %10.2f ", scene, regime,
               k->method->name, k->isa, k->lanes, m->ns.median, m->ns.lowest, m->ns.highest,
               m->per_second.median, m->iterations);
        if (isnan(scalar_ns))
            printf("%9s", "-");
        else
            printf("%9.2f", scalar_ns / m->ns.median);
        printf(m->failed ? "  %d of %d cases failed\n" : "\n", m->failed, m->cases);
    }
    fflush(stdout);
}

/* The kernels for one scene, by method, narrow to wide. */
static int find_kernels(const struct selection *what, const stance_scene *scene,
                        struct measurement *m)
{
    const char *const only = instruction_set_asked(), *isa[16], *word;
    int isas = 0, count = 0;
    for (int rank = 0; isas < 16 && (word = stance_isa(rank)) != NULL; rank++)
        if (!only || strcmp(only, word) == 0)
            isa[isas++] = word;
    for (const stance_method *const *method = stance_methods(); *method; method++) {
        const stance_kernel *previous = NULL;
        if (what->method && strcmp(what->method, (*method)->name) != 0)
            continue;
        for (int i = isas - 1; i >= 0 && count < MOST_KERNELS; i--) {
            const stance_kernel *k = stance_kernel_find(scene, *method, isa[i]);
            if (k && k != previous)
                m[count++].kernel = k;
            previous = k;
        }
    }
    return count;
}

/* Time per step of the one-lane kernel of the first one's method, NAN without one. */
static double one_lane(const struct measurement *m, int count)
{
    for (int i = 0; i < count && m[i].kernel->method == m[0].kernel->method; i++)
        if (m[i].kernel->lanes == 1)
            return m[i].ns.median;
    return NAN;
}

static bool bench_workload(const struct selection *what, const stance_scene *scene,
                           const char *regime)
{
    stance_case *cases = calloc(MOST_CASES, sizeof *cases);
    stance_result *results = calloc(MOST_CASES, sizeof *results);
    struct measurement *m = calloc(MOST_KERNELS, sizeof *m);
    const bool good = cases && results && m && bench_cases(scene, regime, cases, MOST_CASES);
    const int count = good ? find_kernels(what, scene, m) : 0;
    for (int i = 0; i < count; i++)
        prepare(&m[i], what, cases, results);
    for (int r = 0; r < what->repeats; r++)
        for (int i = 0; i < count; i++) {
            m[i].time[r] = run_once(&m[i], cases, results);
            if (r == what->repeats - 1)
                take_spread(&m[i], results, what->repeats);
        }
    double scalar_ns = NAN;
    for (int i = 0; i < count; i++) {
        if (i == 0 || m[i].kernel->method != m[i - 1].kernel->method)
            scalar_ns = one_lane(m + i, count - i);
        report(what, regime, cases, &m[i], scalar_ns);
    }
    free(cases);
    free(results);
    free(m);
    if (!good)
        fprintf(stderr, "stance bench: the cases of %s, %s could not be made\n", scene->name,
                regime);
    return good;
}

static int bench(const struct selection *what)
{
    bool any = false;
    if (what->csv)
        bench_csv_head(stdout);
    else if (!what->rows)
        printf("instruction set in use: %s\n"
               "%-6s %-9s %-12s %-7s %5s  %9s  %9s %9s  %12s  %10s %9s\n",
               instruction_set(), "scene", "regime", "method", "isa", "lanes", "ns / step",
               "lowest", "highest", "ns / sim. s", "iterations", "x scalar");
    for (const stance_scene *const *scene = stance_scenes(); *scene; scene++) {
        if (what->scene && strcmp(what->scene, (*scene)->name) != 0)
            continue;
        for (const stance_workload *w = (*scene)->workload; w->name; w++) {
            if (what->regime && strcmp(what->regime, w->name) != 0)
                continue;
            any = true;
            if (!bench_workload(what, *scene, w->name))
                return EXIT_CASES_FAILED;
        }
    }
    if (!any) {
        fprintf(stderr, "stance bench: no such scene, or no such regime of it: %s, %s\n",
                what->scene ? what->scene : "any", what->regime ? what->regime : "any");
        return EXIT_USAGE;
    }
    return EXIT_DONE;
}

/* A whole number from 1 to `most`; *value stays when the option was not given. */
static bool take_number(const char *option, const char *text, long most, int *value)
{
    if (text) {
        char *end;
        const long number = strtol(text, &end, 10);
        if (*end || end == text || number < 1 || number > most) {
            fprintf(stderr, "stance bench: %s takes a whole number from 1 to %ld\n", option, most);
            return false;
        }
        *value = (int)number;
    }
    return true;
}

static int run(int argc, char **argv)
{
    bool help;
    if (argc > 1 && strcmp(argv[1], "accuracy") == 0)
        return command_accuracy.run(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "failure") == 0)
        return command_failure.run(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "plot") == 0)
        return command_speed.run(argc - 1, argv + 1);
    struct selection what = {.repeats = 5};
    const char *operand[1], *repeats = NULL, *cases = NULL;
    size_t operands, json = 0, csv = 0, count[5] = {0};
    const struct option_spec specs[] = {{"--json", false, NULL, 0, &json},
                                        {"--csv", false, NULL, 0, &csv},
                                        {"--repeats", true, &repeats, 1, &count[0]},
                                        {"--cases", true, &cases, 1, &count[1]},
                                        {"--scene", true, &what.scene, 1, &count[2]},
                                        {"--regime", true, &what.regime, 1, &count[3]},
                                        {"--method", true, &what.method, 1, &count[4]}};
    if (!command_options(&command_bench, argc, argv, specs, sizeof specs / sizeof specs[0], operand,
                         0, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (!instruction_set_usable("bench"))
        return EXIT_USAGE;
    if (!take_number("--repeats", repeats, MOST_REPEATS, &what.repeats) ||
        !take_number("--cases", cases, MOST_CASES, &what.cases))
        return EXIT_USAGE;
    if (what.method && !stance_method_find(what.method)) {
        fprintf(stderr, "stance bench: unknown method '%s'\n", what.method);
        return EXIT_USAGE;
    }
    what.csv = csv > 0;
    what.rows = json ? json_array() : NULL;
    const int code = bench(&what);
    if (what.rows) {
        json_dumpf(what.rows, stdout, JSON_INDENT(1));
        putchar('\n');
        json_decref(what.rows);
    }
    return code;
}

const struct command command_bench = {
    "bench",
    "stance bench [--scene NAME] [--regime NAME] [--method NAME] [--repeats N] [--cases N]\n"
    "                    [--csv | --json]",
    "speed of the stepping kernels on one core", run,
    "Prints nanoseconds per case-step - the median of N rounds (default 5), the lowest and the\n"
    "highest -, nanoseconds per simulated second, Newton iterations per step and the speed-up "
    "over\n"
    "one lane, for each method and instruction set, in steps of 1 ms. The regimes are\n"
    "  ball    flight, sliding\n"
    "  block   at rest, sliding\n"
    "  rod     flight, one end, two ends\n"
    "  biped   flight    nothing near the ground\n"
    "          one foot  linear balance control, torques held for 1 ms\n"
    "          two feet  standing with the legs held\n"
    "\n"
    "--scene, --regime, --method: only these. STANCE_ISA in the environment: only that "
    "instruction\n"
    "set. --cases N: cases of 1 s in each measurement (at most 512); default: what takes 20 ms. "
    "All\n"
    "of them run once more to warm up.\n"
    "\n"
    "`make bench` measures all of this, the whole program and other engines, and draws it with\n"
    "`stance bench plot`. `stance bench accuracy -h` and `failure -h` tell of the studies of\n"
    "error against cost and of where methods fail.\n"
    "\n"
    "--csv: columns as in results/bench.csv.\n"
    "--json: a list of objects with keys scene, regime, method, isa, lanes, ns_per_step, ns_min,\n"
    "ns_max, ns_per_second, iterations_per_step, speedup_over_scalar (null without a scalar\n"
    "kernel), failed, cases, steps (of one measurement).\n"};
