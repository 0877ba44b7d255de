/* bench_truths.c - published numbers and closed forms, and what every method makes of them.
 *
 * bench_truths [LIST] [--method NAME]... [--finer N] [--json] [--csv FILE] [-o DIR] and the options
 * of pictures: computes each truth of a list (of a folder: its truths.yaml; without one that of
 * scenarios/truth) with every method, and prints one table: the number that is known and its error
 * bar, how far off each method comes out, microseconds of one core per simulated second by method
 * in the same order, the source. In place of an error: why the case failed, or `none`. Steps are
 * the scenario's (--finer: N times as short) or a little less, so that equal ones fill its time.
 * Kernels of described mechanisms are those that read the structure at run time. -o draws the
 * errors.
 *
 * A row of a list (YAML, `truths:`) has
 *   truth, source   what it is, who says so
 *   scenario, set   a file beside the list; a list of PATH=VALUE
 *   read            a coordinate or rate at the end, an answer, or `energy`
 *   trace           instead: coordinates and rates. The sum of the derivatives of each at the end
 *                   by itself at the beginning (initial.state or initial.offset): of a cycle, begun
 *                   between its events, the sum of its eigenvalues
 *   border, between, level
 *                   instead of what is read, the place along the path `border`, between two
 *                   numbers, where it crosses `level` (0.5)
 *   value, bar      the number, and how far it may be off; 0: exact
 */
#include "analysis/bench/bench.h"
#include "analysis/draw/gnuplot.h"
#include "analysis/table/table.h"
#include "runner/plan/instruction_set.h"
#include "runner/plan/plan.h"
#include "runner/scenario/reader.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { TEXTS = 12, METHODS = 16 };

struct texts {
    const char *text[TEXTS];
    size_t count;
};

struct truth {
    const char *name, *source, *scenario, *read, *border;
    struct texts trace, set;
    double between[2], level, value, bar;
    struct mark mark;
};

/* What a method makes of it. */
struct reached {
    const stance_method *method;
    double step, value;       /* s; NAN: none */
    const char *why;          /* there is none; NULL: there is one */
    double evaluations, cost; /* per simulated second, microseconds of it; NAN: none */
};

static char list[1000];
static struct tree tree;
static struct truth *truths;
static struct reached *reached; /* [rows][methods] */
static size_t rows, methods;
static const stance_method *method[METHODS];

static _Noreturn void die(int code, const struct mark *mark, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (mark)
        fprintf(stderr, "%s:%d:%d: ", list, mark->line, mark->column);
    else
        fputs("bench_truths: ", stderr);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    putc('\n', stderr);
    exit(code);
}

/* ---- the list ------------------------------------------------------------------------------ */

static void take_texts(const struct tree_node *node, struct texts *out)
{
    if (node->kind != TREE_LIST || node->count > TEXTS)
        die(EXIT_USAGE, &node->mark, "a list of at most %d texts is needed", TEXTS);
    for (out->count = 0; out->count < node->count; out->count++)
        if (!(out->text[out->count] = node->item[out->count]->text))
            die(EXIT_USAGE, &node->item[out->count]->mark, "a text is needed");
}

static void take_numbers(const struct tree_node *node, double *out, size_t count)
{
    const struct tree_node *const *item =
        count == 1 ? &node : (const struct tree_node *const *)node->item;
    if (count > 1 && (node->kind != TREE_LIST || node->count != count))
        die(EXIT_USAGE, &node->mark, "a list of %zu numbers is needed", count);
    for (size_t i = 0; i < count; i++) {
        char *end = NULL;
        out[i] = item[i]->kind == TREE_SCALAR ? strtod(item[i]->text, &end) : NAN;
        if (!end || end == item[i]->text || *end || !isfinite(out[i]))
            die(EXIT_USAGE, &item[i]->mark, "a number is needed");
    }
}

static void take_row(struct truth *t, const struct tree_node *node)
{
    *t = (struct truth){.value = NAN, .bar = NAN, .level = 0.5, .mark = node->mark};
    const struct {
        const char *key, **text;
        struct texts *texts;
        double *number;
        size_t numbers;
    } known[] = {{"truth", .text = &t->name},
                 {"scenario", .text = &t->scenario},
                 {"set", .texts = &t->set},
                 {"read", .text = &t->read},
                 {"trace", .texts = &t->trace},
                 {"border", .text = &t->border},
                 {"between", .number = t->between, .numbers = 2},
                 {"level", .number = &t->level, .numbers = 1},
                 {"value", .number = &t->value, .numbers = 1},
                 {"bar", .number = &t->bar, .numbers = 1},
                 {"source", .text = &t->source}};
    enum { KEYS = sizeof known / sizeof known[0] };
    for (size_t i = 0; node->kind == TREE_MAP && i < node->count; i++) {
        const struct tree_node *const item = node->item[i];
        size_t k = 0;
        while (k < KEYS && strcmp(known[k].key, node->key[i].name) != 0)
            k++;
        if (k == KEYS)
            die(EXIT_USAGE, &node->key[i].mark, "unknown key '%s'", node->key[i].name);
        else if (known[k].texts)
            take_texts(item, known[k].texts);
        else if (known[k].number)
            take_numbers(item, known[k].number, known[k].numbers);
        else
            *known[k].text = item->text;
    }
    if (!t->name || !t->source || !t->scenario || isnan(t->value) || isnan(t->bar))
        die(EXIT_USAGE, &t->mark, "truth, scenario, value, bar and source are needed");
    if ((t->trace.count > 0) == (t->read != NULL))
        die(EXIT_USAGE, &t->mark, "either read or trace is needed");
    if (t->bar < 0)
        die(EXIT_USAGE, &t->mark, "bar is 0 (exact) or more");
    if (t->border && t->between[0] == t->between[1])
        die(EXIT_USAGE, &t->mark, "border needs between: [from, to]");
}

static void read_list(void)
{
    static struct problems problems;
    size_t length = 0;
    char *const text = scenario_text(list, &problems, &length);
    if (!text || !tree_check_text(text, length, &problems) ||
        !tree_parse(&tree, text, length, &problems)) {
        problems_print(&problems, list, NULL, stderr);
        exit(text ? EXIT_USAGE : EXIT_IO);
    }
    free(text);
    const struct tree_node *const all =
        tree.root->kind == TREE_MAP ? tree_find(tree.root, "truths") : NULL;
    if (!all || all->kind != TREE_LIST || all->count == 0)
        die(EXIT_USAGE, &tree.root->mark, "no truth is in the list");
    rows = all->count;
    truths = calloc(rows, sizeof *truths);
    reached = calloc(rows * METHODS, sizeof *reached);
    for (size_t i = 0; truths && reached && i < rows; i++)
        take_row(&truths[i], all->item[i]);
}

/* ---- one case with a method ---------------------------------------------------------------- */

/* Distance of the starts of a difference of four, whose error is its fourth power's; part of the
 * whole between two ends within which a border is found. */
static const double apart = 3e-4, narrow = 1e-8;
enum { FEW_STEPS = 10 }; /* that tell no cost */

static struct {
    const struct truth *truth;
    const stance_method *method;
    double step, finer;
    struct scenario scenario;
    stance_case input;
    stance_result result;
    double budget, cost; /* s: for measuring what the case costs; what it does */
} trial;

/* Reads the row's scenario with its settings and `more` (NULL: none); step 0: as it is there. */
static void read_scenario(const char *more)
{
    const char *set[TEXTS + 3], *const slash = strrchr(list, '/');
    char name[64], step[64], path[2000];
    size_t sets = trial.truth->set.count;
    memcpy(set, trial.truth->set.text, sizeof trial.truth->set.text);
    snprintf(name, sizeof name, "method.name=%s", trial.method->name);
    snprintf(step, sizeof step, "method.step=%.17g", trial.step);
    set[sets++] = name;
    if (trial.step > 0)
        set[sets++] = step;
    if (more)
        set[sets++] = more;
    snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash + 1 - list) : 0, list,
             trial.truth->scenario);
    if (!scenario_read(&trial.scenario, path, NULL, set, sets, stderr))
        exit(EXIT_USAGE);
    if (trial.scenario.axes > 0)
        die(EXIT_USAGE, &trial.truth->mark, "%s has a sweep; a truth is of one case", path);
}

/* Equal steps that fill the time, no longer than a `finer`-th of the scenario's. */
static void choose_step(const char *more)
{
    trial.step = 0;
    read_scenario(more);
    const struct scenario_values *const base = &trial.scenario.base;
    trial.step = base->stop_time / fmax(1, ceil(base->stop_time * trial.finer / base->step - 1e-9));
    scenario_free(&trial.scenario);
}

/* The quickest of the runs that the budget allows, one at least. */
static void simulate(const stance_kernel *kernel)
{
    double spent = 0;
    trial.cost = INFINITY;
    while (spent == 0 || spent < trial.budget) {
        const double begin = bench_clock();
        kernel->run(&trial.input, &trial.result, 1);
        const double time = fmax(bench_clock() - begin, 1e-9);
        trial.cost = fmin(trial.cost, time);
        spent += time;
    }
}

/* A coordinate's place, or a rate's beyond all coordinates; -1: neither. */
static int state_place(const char *name)
{
    const stance_scene *const scene = trial.scenario.scene;
    for (int k = 0; k < scene->coordinates; k++) {
        if (strcmp(name, scene->coordinate[k].name) == 0)
            return k;
        if (name[0] == 'v' && strcmp(name + 1, scene->coordinate[k].name) == 0)
            return scene->coordinates + k;
    }
    return -1;
}

static double answer(const stance_answer *a)
{
    const char *const at = (const char *)&trial.result + a->offset;
    double number;
    int64_t whole;
    memcpy(&number, at, a->type == STANCE_DOUBLE ? sizeof number : 0);
    memcpy(&whole, at, a->type == STANCE_INT64 ? sizeof whole : 0);
    return a->type == STANCE_DOUBLE  ? number
           : a->type == STANCE_INT64 ? (double)whole
                                     : *(const uint8_t *)at;
}

/* A case that failed has no number but its failure. */
static double read_off(const char *name)
{
    const stance_scene *const scene = trial.scenario.scene;
    const stance_result *const r = &trial.result;
    const int place = state_place(name), n = scene->coordinates;
    const bool failed = r->status != STANCE_DONE;
    for (size_t k = 0; k < STANCE_ANSWER_COUNT; k++)
        if (strcmp(name, stance_answers[k].name) == 0)
            return failed && k != STANCE_ANSWER_failure ? NAN : answer(&stance_answers[k]);
    if (place < 0 && strcmp(name, "energy") != 0)
        die(EXIT_USAGE, &trial.truth->mark, "nothing is called %s there", name);
    return failed      ? NAN
           : place < 0 ? scene->energy(scene, trial.input.robot, r->position, r->velocity)
           : place < n ? r->position[place]
                       : r->velocity[place - n];
}

/* What is read of the case with `more` set. */
static double number_of(const char *more, const char *name)
{
    const struct parallel alone = parallel_alone();
    static struct plan plan;
    struct plan_error error = {0};
    int ignored;
    read_scenario(more);
    const stance_kernel *const kernel = instruction_set_kernel(trial.scenario.scene, trial.method);
    if (!plan_make(&plan, &trial.scenario, true, 0, false, &error) ||
        !plan_compute_designs(&plan, &alone, &error))
        die(EXIT_USAGE, &trial.truth->mark, "%s", error.message.text);
    if (!plan_resolve(&plan, 0, &trial.input, &ignored) || !kernel)
        die(EXIT_USAGE, &trial.truth->mark, "the first case does not exist");
    simulate(kernel);
    const double read = read_off(name);
    plan_free(&plan);
    scenario_free(&trial.scenario);
    return read;
}

/* ---- the three kinds ------------------------------------------------------------------------ */

static double trace(void)
{
    static const double weight[] = {1. / 12, -8. / 12, 0, 8. / 12, -1. / 12};
    double sum = 0;
    for (size_t k = 0; k < trial.truth->trace.count; k++) {
        const char *const name = trial.truth->trace.text[k];
        char more[160];
        read_scenario(NULL);
        const struct scenario_values *const base = &trial.scenario.base;
        const int place = state_place(name);
        const bool given = base->state_given;
        if (place < 0)
            die(EXIT_USAGE, &trial.truth->mark, "no coordinate or rate is called %s", name);
        const double begin = (given ? base->state : base->offset)[place];
        scenario_free(&trial.scenario);
        for (int i = 0; i < 5; i++) {
            snprintf(more, sizeof more, "initial.%s.%s=%.17g", given ? "state" : "offset", name,
                     begin + (i - 2) * apart);
            sum += i == 2 ? 0 : weight[i] * number_of(more, name) / apart;
        }
    }
    return sum;
}

/* Whether what is read is above the level at a place of the border's path. Borders along stop.time
 * need equal steps that fill it. */
static bool above(double place)
{
    char more[160];
    snprintf(more, sizeof more, "%.100s=%.17g", trial.truth->border, place);
    choose_step(more);
    return number_of(more, trial.truth->read) > trial.truth->level;
}

/* Bisects; NAN where both ends are on one side. */
static double border(void)
{
    double at[2] = {trial.truth->between[0], trial.truth->between[1]};
    const double width = narrow * fabs(at[1] - at[0]);
    const bool end[2] = {above(at[0]), above(at[1])};
    while (end[0] != end[1] && fabs(at[1] - at[0]) > width) {
        const double middle = 0.5 * (at[0] + at[1]);
        at[above(middle) == end[1]] = middle;
    }
    return end[0] != end[1] ? 0.5 * (at[0] + at[1]) : NAN;
}

static void reach(struct reached *one, const struct truth *t)
{
    const stance_result *const r = &trial.result;
    trial.truth = t;
    trial.budget = 0.003;
    choose_step(NULL);
    one->method = trial.method;
    one->step = trial.step;
    one->value = number_of(NULL, t->read ? t->read : t->trace.text[0]);
    one->evaluations = (double)r->evaluations / r->end_time;
    one->cost = r->steps < FEW_STEPS ? NAN : 1e6 * trial.cost / r->end_time;
    trial.budget = 0;
    one->value = t->trace.count > 0 ? trace() : t->border ? border() : one->value;
    if (isnan(one->value))
        one->why = r->status == STANCE_FAILED ? stance_failure_name[r->failure] : "none";
}

/* ---- tables, and the picture ---------------------------------------------------------------- */

/* A line for each truth and method: for programs. */
static void add_long(struct table *t, const struct truth *row, const struct reached *one)
{
    TABLE_FACTS(
        t, {{.name = "truth"}, as_text(row->name)}, {{.name = "scenario"}, as_text(row->scenario)},
        {{.name = "value"}, as_number(row->value)}, {{.name = "bar"}, as_number(row->bar)},
        {{.name = "source"}, as_text(row->source)},
        {{.name = "method"}, as_text(one->method->name)}, {{.name = "step"}, as_number(one->step)},
        {{.name = "reached"}, as_number(one->value)},
        {{.name = "error"}, as_number(fabs(one->value - row->value))},
        {{.name = "why_none"}, as_text(one->why)},
        {{.name = "evaluations_per_second"}, as_number(one->evaluations)},
        {{.name = "microseconds_per_second"}, as_number(one->cost)});
    table_end_row(t);
}

/* A line for each truth: for people. */
static void add_wide(struct table *t, const struct truth *row, const struct reached *all)
{
    TABLE_FACTS(t,
                {{"truth", "truth", .width = 36, .left = true, .before = ""}, as_text(row->name)},
                {{"value", "value", "%.8g", .width = 11}, as_number(row->value)},
                {{"bar", "bar", "%.0e", .width = 6},
                 row->bar > 0 ? as_number(row->bar) : as_nothing("exact")});
    for (size_t m = 0; m < methods; m++) {
        char name[40];
        snprintf(name, sizeof name, "error %s", method[m]->name);
        TABLE_FACTS(
            t, {{name, method[m]->name, "%.0e", .width = 9, .group = "errors"},
                all[m].why ? as_nothing(all[m].why) : as_number(fabs(all[m].value - row->value))});
    }
    for (size_t m = 0; m < methods; m++) {
        char name[40], heading[40];
        snprintf(name, sizeof name, "cost %s", method[m]->name);
        snprintf(heading, sizeof heading, "%s%.5s", m ? "" : "us/s: ", method[m]->name);
        TABLE_FACTS(
            t, {{name, heading, "%.3g", .width = 8, .group = "costs", .before = m ? " " : "  "},
                as_number(all[m].cost)});
    }
    TABLE_FACTS(t, {{"source", "source", .before = "  ", .left = true}, as_text(row->source)});
    table_end_row(t);
}

static bool report(bool json, const char *csv)
{
    struct table lines = {0}, seen = {0};
    for (size_t i = 0; i < rows; i++) {
        add_wide(&seen, &truths[i], &reached[i * methods]);
        for (size_t m = 0; m < methods; m++)
            add_long(&lines, &truths[i], &reached[i * methods + m]);
    }
    FILE *const out = csv ? fopen(csv, "w") : NULL;
    bool good = !csv || (out && table_write_csv(&lines, out));
    if (out && fclose(out) != 0)
        good = false;
    if (json)
        good = table_write_json(table_json(&lines, false), stdout) && good;
    else
        good = table_write_text(&seen, stdout, "truth value bar errors/ costs/ source", 0) && good;
    table_free(&lines);
    table_free(&seen);
    return good && fflush(stdout) == 0;
}

/* Errors, a line of the picture for each truth. */
static bool draw(struct look *look, stance_message *message)
{
    static const double least = 1e-16, most = 1e2, nowhere = 500; /* others are drawn there */
    const struct plot_range all = {-16.4, 3};
    const struct plot plot = {.title = "Held against what is known from outside",
                              .directory = look->directory,
                              .stem = "truth",
                              .look = look,
                              .message = message};
    struct gnuplot g;
    if (!gnuplot_directory(look->directory) || !gnuplot_begin(&g, &plot, "", NULL))
        return false;
    gnuplot_say(&g, "Error of each method; grey: within the error bar of what is known. A cross at "
                    "the right end: no number");
    gnuplot_axis(&g, 'x', PLOT_LOG, all, "error, in the unit of what is read", "");
    gnuplot_axis(&g, 'y', PLOT_LIST, (struct plot_range){0.5 - (double)rows, 0.5}, "", "");
    gnuplot_set(&g, "chart_width = 560; y_words = %zu; array y_word[%zu]; array y_at[%zu]", rows,
                rows, rows);
    for (size_t i = 0; i < rows; i++) {
        gnuplot_tic(&g, truths[i].name, "y_word[%zu]", i + 1);
        gnuplot_set(&g, "y_at[%zu] = -%zu", i + 1, i);
    }
    gnuplot_panel(&g, fmax(17 * (double)rows + 12, 110), "");
    gnuplot_series(&g,
                   "using (%g):2:(%g):1:($2 - 0.5):($2 + 0.5) with boxxy fs solid noborder lc rgb "
                   "0xdedede",
                   all.low, all.low);
    for (size_t i = 0; i < rows; i++)
        GNUPLOT_ROW(&g, truths[i].bar > 0 ? log10(truths[i].bar) : NAN, -(double)i);
    for (size_t m = 0; m < methods; m++) {
        static const int markers[] = {7, 5, 9, 11, 13, 15, 2};
        const char *const hue = gnuplot_hue(m);
        gnuplot_legend(&g, hue, 0, markers[m % 7], method[m]->name, "");
        gnuplot_series(&g,
                       "using 1:2 with points lc rgb %s pt %d ps 0.8 notitle, '' using 3:2 with "
                       "points lc rgb %s pt 2 ps 0.7 lw 1.4",
                       hue, markers[m % 7], hue);
        for (size_t i = 0; i < rows; i++) {
            const double error = fabs(reached[i * methods + m].value - truths[i].value);
            GNUPLOT_ROW(&g, isnan(error) ? NAN : log10(fmin(fmax(error, least), most)),
                        0.1 * (0.5 * ((double)methods - 1) - (double)m) - (double)i,
                        isnan(error) ? log10(nowhere) : NAN);
        }
    }
    return gnuplot_end(&g);
}

/* ---- the program ---------------------------------------------------------------------------- */

/* Those named, or all. */
static void choose_methods(const char *const *name, size_t names)
{
    for (size_t m = 0; m < (names ? names : METHODS) && (names || stance_methods()[m]); m++) {
        method[methods] = names ? stance_method_find(name[m]) : stance_methods()[m];
        if (!method[methods++])
            die(EXIT_USAGE, NULL, "unknown method '%s'", name[m]);
    }
}

struct request {
    const char *given, *csv;
    struct option_texts methods;
    double finer;
    bool json;
    struct look look;
};

#define TO(member) OPTION_TO(struct request, member)
static const struct option options[] = {
    {"LIST", TO(given), .text = "a list"},
    {"--json", TO(json), .text = "the same as JSON"},
    {"--csv", "FILE", TO(csv), .text = "the same as a table"},
    {"--finer", "N", TO(finer), .low = 0.01, .high = 1e4, .text = "smaller steps"},
    {"--method", "NAME", TO(methods), .most = METHODS, .text = "that method"},
    {.at = offsetof(struct request, look), .rows = look_options},
    {0},
};

int main(int argc, char **argv)
{
    static const struct command self = {.name = "bench_truths",
                                        .summary = "every method held to what is known",
                                        .options = options,
                                        .help = "The head of tests/bench_truths.c explains."};
    struct request request = {.given = "scenarios/truth/truths.yaml", .finer = 1};
    struct stat status;
    look_begin(&request.look);
    const int code = command_begin(&self, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    if (!instruction_set_usable(self.name))
        return EXIT_USAGE;
    const char *const given = request.given;
    trial.finer = request.finer;
    choose_methods(request.methods.text, request.methods.count);
    const bool folder = stat(given, &status) == 0 && S_ISDIR(status.st_mode);
    snprintf(list, sizeof list, "%s%s", given, folder ? "/truths.yaml" : "");
    read_list();
    for (size_t i = 0; i < rows * methods; i++) {
        trial.method = method[i % methods];
        reach(&reached[i], &truths[i / methods]);
    }
    stance_message message = {""};
    if (!report(request.json, request.csv) ||
        (request.look.directory && !request.json && !draw(&request.look, &message)))
        die(EXIT_IO, NULL, "cannot be written: %s", message.text);
    free(truths);
    free(reached);
    tree_free(&tree);
    return EXIT_DONE;
}
