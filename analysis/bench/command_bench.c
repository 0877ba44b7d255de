/* command_bench.c - `stance bench`: nanoseconds per case-step on one core, for each scene, regime,
 * method and instruction set.
 *
 * The kernels of a workload are measured in turn, round after round, so that whatever else the
 * machine does meets all of them; medians are printed, and their ratios are what can be trusted.
 */
#include "bench.h"

#include "analysis/table/table.h"
#include "runner/plan/asked.h"
#include "runner/plan/instruction_set.h"

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
    uint64_t repeats, cases; /* cases 0: as many as take wanted_time */
    enum table_form form;
    struct table rows;
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
    m->ns = bench_scaled(time, 1e9 / m->steps);
    m->per_second = bench_scaled(time, 1e9 / m->simulated);
}

static void add_row(struct table *t, const char *scene, const char *regime,
                    const struct measurement *m, double scalar_ns)
{
    const stance_kernel *const k = m->kernel;
    char remark[48];
    snprintf(remark, sizeof remark, "%d of %d cases failed", m->failed, m->cases);
    TABLE_FACTS(
        t, {{"scene", "scene", .width = 6, .left = true, .before = ""}, as_text(scene)},
        {{"regime", "regime", .width = 9, .left = true}, as_text(regime)},
        {{"method", "method", .width = 12, .left = true}, as_text(k->method->name)},
        {{"isa", "isa", .width = 7, .left = true}, as_text(k->isa)},
        {{"lanes", "lanes", .width = 5}, as_whole((uint64_t)k->lanes)},
        {{"ns_per_step", "ns / step", "%.1f", .before = "  ", .width = 9}, as_number(m->ns.median)},
        {{"ns_min", "lowest", "%.1f", .before = "  ", .width = 9}, as_number(m->ns.lowest)},
        {{"ns_max", "highest", "%.1f", .width = 9}, as_number(m->ns.highest)},
        {{"ns_per_second", "ns / sim. s", "%.0f", .before = "  ", .width = 12},
         as_number(m->per_second.median)},
        {{"iterations_per_step", "iterations", "%.2f", .before = "  ", .width = 10},
         as_number(m->iterations)},
        {{"speedup_over_scalar", "x scalar", "%.2f", .width = 9},
         as_number(scalar_ns / m->ns.median)},
        {{.name = "failed"}, as_whole((uint64_t)m->failed)},
        {{.name = "cases"}, as_whole((uint64_t)m->cases)}, {{.name = "steps"}, as_number(m->steps)},
        {{"remark", .hidden = TABLE_VIEW_ONLY, .before = "  ", .empty = ""},
         as_nothing(m->failed ? remark : NULL)});
    table_end_row(t);
}

static void report(struct selection *what, const char *scene, const char *regime,
                   const stance_case *c, const struct measurement *m, double scalar_ns)
{
    const stance_kernel *const k = m->kernel;
    if (what->form != TABLE_AS_CSV) {
        add_row(&what->rows, scene, regime, m, scalar_ns);
    } else {
        struct bench_row row = {
            "stance",        scene, regime,  k->method->name, k->isa,
            k->lanes,        1,     c->step, m->cases,        (int)what->repeats,
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
    }
    if (what->form == TABLE_AS_TEXT) {
        table_write_text(&what->rows, stdout,
                         "scene regime method isa lanes ns_per_step ns_min ns_max ns_per_second "
                         "iterations_per_step speedup_over_scalar remark",
                         0);
        table_clear(&what->rows);
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
            /* Not the one that reads structures at run time in place of one that is not built. */
            const bool stands_in =
                k && !stance_kernel_ahead(k) &&
                stance_kernel_ahead(stance_kernel_find(scene, *method, stance_isa(0)));
            if (k && k != previous && !stands_in)
                m[count++].kernel = k;
            previous = k;
        }
    }
    return count;
}

static bool bench_workload(struct selection *what, const stance_scene *scene, const char *regime)
{
    stance_case *cases = calloc(MOST_CASES, sizeof *cases);
    stance_result *results = calloc(MOST_CASES, sizeof *results);
    struct measurement *m = calloc(MOST_KERNELS, sizeof *m);
    const bool good = cases && results && m && bench_cases(scene, regime, cases, MOST_CASES);
    const int count = good ? find_kernels(what, scene, m) : 0;
    for (int i = 0; i < count; i++) { /* warms up, and finds how many cases a measurement takes */
        m[i].cases = what->cases ? (int)what->cases : FEWEST_CASES;
        const double wanted = floor(wanted_time / run_once(&m[i], cases, results)) * FEWEST_CASES;
        if (!what->cases)
            m[i].cases = (int)fmax(FEWEST_CASES, fmin(wanted, MOST_CASES));
    }
    const int repeats = (int)what->repeats;
    for (int r = 0; r < repeats; r++)
        for (int i = 0; i < count; i++) {
            m[i].time[r] = run_once(&m[i], cases, results);
            if (r == repeats - 1)
                take_spread(&m[i], results, repeats);
        }
    for (int i = 0; i < count; i++) {
        double scalar_ns = NAN; /* of the method's first kernel with one lane */
        for (int k = count - 1; k >= 0; k--)
            if (m[k].kernel->method == m[i].kernel->method && m[k].kernel->lanes == 1)
                scalar_ns = m[k].ns.median;
        report(what, scene->name, regime, cases, &m[i], scalar_ns);
    }
    free(cases);
    free(results);
    free(m);
    if (!good)
        fprintf(stderr, "stance bench: the cases of %s, %s could not be made\n", scene->name,
                regime);
    return good;
}

static int bench(struct selection *what)
{
    bool any = false;
    if (what->form == TABLE_AS_CSV)
        bench_csv_head(stdout);
    else if (what->form == TABLE_AS_TEXT)
        printf("instruction set in use: %s\n", instruction_set());
    for (const stance_scene *const *scene = stance_scenes(); *scene; scene++) {
        if (what->scene && strcmp(what->scene, (*scene)->name) != 0)
            continue;
        for (const stance_workload *w = (*scene)->workload; w && w->name; w++) {
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

static int run(int argc, char **argv)
{
    struct selection what = {.repeats = 5};
    if (argc > 1 && strcmp(argv[1], "truth") == 0)
        return command_usage(&command_bench, "truths are computed by `make truths` in the source "
                                             "tree, not here");
    int code = command_begin(&command_bench, argc, argv, &what);
    if (code != COMMAND_GOES_ON)
        return code;
    if (!instruction_set_usable("bench"))
        return EXIT_USAGE;
    code = bench(&what);
    if (what.form == TABLE_AS_JSON && !table_write_json(table_json(&what.rows, false), stdout))
        code = EXIT_IO;
    table_free(&what.rows);
    return code;
}

#define TO(member) OPTION_TO(struct selection, member)
static const struct option options[] = {
    {.part = &command_accuracy},
    {.part = &command_failure},
    {.part = &command_speed},
    {"--scene", "NAME", TO(scene), .text = "only this one"},
    {"--regime", "NAME", TO(regime), .text = "only this one"},
    {"--method", "NAME", TO(method), .word = asked_method,
     .text = "only this one. STANCE_ISA in the environment: only that instruction set"},
    {"--repeats", "N", TO(repeats), .low = 1, .high = MOST_REPEATS, .text = "rounds, default 5"},
    {"--cases", "N", TO(cases), .low = 1, .high = MOST_CASES,
     .text = "cases of 1 s in each measurement; default: what takes 20 ms. All of them run once "
             "more to warm up"},
    {TABLE_CSV(struct selection, form), .text = "columns as in results/bench.csv"},
    {TABLE_JSON(struct selection, form),
     .text = "a list of objects with keys scene, regime, method, isa, lanes, ns_per_step, ns_min, "
             "ns_max, ns_per_second, iterations_per_step, speedup_over_scalar (null without a "
             "scalar kernel), failed, cases, steps (of one measurement)"},
    {0},
};

const struct command command_bench = {
    "bench",
    "speed of the stepping kernels on one core",
    run,
    options,
    "Prints nanoseconds per case-step - the median of N rounds (default 5), the lowest and the "
    "highest -, nanoseconds per simulated second, Newton iterations per step and the speed-up "
    "over one lane, for each method and instruction set, in steps of 1 ms. The regimes of the "
    "biped, "
    "for which kernels are built in, are\n"
    "  flight    nothing near the ground\n"
    "  one foot  linear balance control, torques held for 1 ms\n"
    "  two feet  standing with the legs held\n",
    "`make bench` measures all of this, the whole program and other engines, and draws it with "
    "`stance bench plot`. More: `stance bench accuracy -h`, error against cost; `stance bench "
    "failure -h`, where methods fail; `stance bench plot -h`, the picture.",
};
