/* command_truth.c - `stance bench truth`: what each method makes of numbers that are known from
 * outside. */
#include "studies.h"
#include "truth.h"

#include "runner/plan/instruction_set.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

extern const struct command command_truth; /* below */

enum { MOST_METHODS = 16 };

struct request {
    enum table_form form;
    double finer, budget;
    const char *csv; /* a file for the table; NULL: none */
    const char *directory;
    struct look *look;
    const stance_method *method[MOST_METHODS];
    size_t methods;
};

/* ---- tables ---------------------------------------------------------------------------------- */

static struct table_value error_of(const struct truth_row *row, const struct truth_reached *one)
{
    return one->why ? as_nothing(one->why) : as_number(fabs(one->value - row->value));
}

/* A line for each truth and method: for programs. */
static void add_long(struct table *t, const struct truth_row *row, const struct truth_reached *one)
{
    TABLE_FACTS(
        t, {{.name = "truth"}, as_text(row->name)}, {{.name = "scenario"}, as_text(row->scenario)},
        {{.name = "value"}, as_number(row->value)}, {{.name = "bar"}, as_number(row->bar)},
        {{.name = "source"}, as_text(row->source)},
        {{.name = "method"}, as_text(one->method->name)}, {{.name = "step"}, as_number(one->step)},
        {{.name = "reached"}, as_number(one->value)},
        {{.name = "error"}, as_number(fabs(one->value - row->value))},
        {{.name = "why_none"}, one->why ? as_text(one->why) : as_nothing(NULL)},
        {{.name = "evaluations_per_second"}, as_number(one->evaluations)},
        {{.name = "microseconds_per_second"}, as_number(one->cost)});
    table_end_row(t);
}

/* A line for each truth: for people. */
static void add_wide(struct table *t, const struct truth_row *row, const struct truth_reached *all,
                     size_t methods)
{
    TABLE_FACTS(t,
                {{"truth", "truth", .width = 36, .left = true, .before = ""}, as_text(row->name)},
                {{"value", "value", "%.8g", .width = 11}, as_number(row->value)},
                {{"bar", "bar", "%.0e", .width = 6},
                 row->bar > 0 ? as_number(row->bar) : as_nothing("exact")});
    for (size_t m = 0; m < methods; m++) {
        char name[40];
        snprintf(name, sizeof name, "error %s", all[m].method->name);
        TABLE_FACTS(t, {{name, all[m].method->name, "%.0e", .width = 9, .group = "errors"},
                        error_of(row, &all[m])});
    }
    for (size_t m = 0; m < methods; m++) {
        char name[40], heading[40];
        snprintf(name, sizeof name, "cost %s", all[m].method->name);
        snprintf(heading, sizeof heading, "%s%.5s", m ? "" : "us/s: ", all[m].method->name);
        TABLE_FACTS(
            t, {{name, heading, "%.3g", .width = 8, .group = "costs", .before = m ? " " : "  "},
                as_number(all[m].cost)});
    }
    TABLE_FACTS(t, {{"source", "source", .before = "  ", .left = true}, as_text(row->source)});
    table_end_row(t);
}

static bool write_csv(const struct table *t, const char *path)
{
    FILE *const out = fopen(path, "w");
    const bool written = out && table_write_csv(t, out);
    if (!written | (out && fclose(out) != 0)) {
        fprintf(stderr, "stance bench truth: cannot write %s: %s\n", path, strerror(errno));
        return false;
    }
    return true;
}

static bool report(const struct request *q, const struct truth_list *list,
                   const struct truth_reached *all)
{
    struct table rows = {0}, seen = {0};
    bool good = true;
    for (size_t i = 0; i < list->rows; i++) {
        add_wide(&seen, &list->row[i], &all[i * q->methods], q->methods);
        for (size_t m = 0; m < q->methods; m++)
            add_long(&rows, &list->row[i], &all[i * q->methods + m]);
    }
    if (q->csv)
        good = write_csv(&rows, q->csv);
    if (good && q->form == TABLE_AS_JSON)
        good = table_write_json(table_json(&rows, false), stdout);
    else if (good)
        good = table_write_text(&seen, stdout, "truth value bar errors/ costs/ source", 0);
    table_free(&rows);
    table_free(&seen);
    return good && fflush(stdout) == 0;
}

/* ---- the command ----------------------------------------------------------------------------- */

static int reach_all(const struct request *q, const struct truth_list *list,
                     struct truth_reached *all)
{
    for (size_t i = 0; i < list->rows; i++) {
        for (size_t m = 0; m < q->methods; m++) {
            stance_message message = {""};
            if (!truth_reach(&all[i * q->methods + m], &list->row[i], q->method[m], q->finer,
                             q->budget, &message)) {
                if (message.text[0])
                    fprintf(stderr, "%s:%d:%d: %s\n", list->file, list->row[i].mark.line,
                            list->row[i].mark.column, message.text);
                return EXIT_USAGE;
            }
        }
    }
    return EXIT_DONE;
}

static int whole(const struct request *q, const char *file)
{
    struct truth_list list;
    stance_message message = {""};
    if (!truth_list_read(&list, file))
        return EXIT_USAGE;
    struct truth_reached *const all = calloc(list.rows * q->methods + 1, sizeof *all);
    int code = all ? reach_all(q, &list, all) : EXIT_IO;
    if (code == EXIT_DONE && !report(q, &list, all))
        code = EXIT_IO;
    if (code == EXIT_DONE && q->directory && q->form == TABLE_AS_TEXT &&
        !truth_plot(&list, all, q->methods, q->look, q->directory, &message)) {
        fprintf(stderr, "stance bench truth: %s\n", message.text);
        code = EXIT_IO;
    }
    free(all);
    truth_list_free(&list);
    return code;
}

/* The list that is named, in a folder that is, or where the one that ships is. */
static bool find_list(const char *given, char *path, size_t size)
{
    struct stat status;
    if (given) {
        const bool folder = stat(given, &status) == 0 && S_ISDIR(status.st_mode);
        snprintf(path, size, "%s%s", given, folder ? "/truths.yaml" : "");
        return true;
    }
    for (size_t k = 0; studies_place(k, "truth/truths.yaml", path, size); k++)
        if (access(path, R_OK) == 0)
            return true;
    return false;
}

/* Those named, or all. */
static bool choose_methods(struct request *q, const char *const *name, size_t names)
{
    const size_t most = names ? names : MOST_METHODS;
    for (size_t m = 0; m < most && (names || stance_methods()[m]); m++) {
        const stance_method *const one = names ? stance_method_find(name[m]) : stance_methods()[m];
        if (!one) {
            fprintf(stderr, "stance bench truth: unknown method '%s'\n", name[m]);
            return false;
        }
        q->method[q->methods++] = one;
    }
    return true;
}

static int run(int argc, char **argv)
{
    const char *given[1], *csv = NULL, *finer = NULL, *method[MOST_METHODS];
    char found[TRUTH_PATH];
    struct look_options options = {0};
    struct look look;
    size_t operands, count[4] = {0};
    bool help;
    const struct option_spec specs[] = {{"--json", false, NULL, 0, &count[0]},
                                        {"--csv", true, &csv, 1, &count[1]},
                                        {"--finer", true, &finer, 1, &count[2]},
                                        {"--method", true, method, MOST_METHODS, &count[3]},
                                        LOOK_SPECS(options)};
    if (!command_options(&command_truth, argc, argv, specs, sizeof specs / sizeof specs[0], given,
                         1, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (!instruction_set_usable(command_truth.name) || !look_read(&command_truth, &options, &look))
        return EXIT_USAGE;
    struct request q = {
        .form = table_form(count[0], 0), .finer = 1, .budget = 0.003, .csv = csv, .look = &look};
    char *end = NULL;
    if (finer && (!((q.finer = strtod(finer, &end)) >= 0.01) || *end || q.finer > 1e4))
        return command_usage(&command_truth, "--finer takes a number from 0.01 to 10000");
    if (look.file)
        return command_usage(&command_truth, "-o takes a directory: there are several files");
    q.directory = look.directory;
    if (!choose_methods(&q, method, count[3]))
        return EXIT_USAGE;
    if (!find_list(operands ? given[0] : NULL, found, sizeof found)) {
        fputs("stance bench truth: no scenarios/truth here nor beside the program; name the list\n",
              stderr);
        return EXIT_IO;
    }
    if (access(found, R_OK) != 0) {
        fprintf(stderr, "stance bench truth: %s: %s\n", found, strerror(errno));
        return EXIT_IO;
    }
    return whole(&q, found);
}

const struct command command_truth = {
    "bench truth",
    "bench truth [LIST] [--method NAME]... [--finer N] [--json] [--csv FILE]\n"
    "           [-o DIR] [--format F,...] [--for column|page] ...",
    "every method held to published numbers and closed forms",
    run,
    "Computes each truth of a list (of a folder: its truths.yaml; by default that of\n"
    "scenarios/truth) with every method, and prints one table: the number that is known and its\n"
    "error bar, how far off each method comes out, microseconds of one core per simulated second\n"
    "by method in the same order, the source. In place of an error: why the case failed, or\n"
    "`none`. Steps are the scenario's or a little less, so that equal ones fill its time. Kernels\n"
    "of described mechanisms are those that read the structure at run time.\n"
    "\n"
    "A row of a list (YAML, `truths:`) has\n"
    "  truth, source   what it is, who says so\n"
    "  scenario, set   a file beside the list; a list of PATH=VALUE\n"
    "  read            a coordinate or rate at the end, an answer, or `energy`\n"
    "  trace           instead: coordinates and rates. The sum of the derivatives of each at the\n"
    "                  end by itself at the beginning (initial.state or initial.offset): of a\n"
    "                  cycle, begun between its events, the sum of its eigenvalues\n"
    "  border, between, level\n"
    "                  instead of what is read, the place along the path `border`, between two\n"
    "                  numbers, where it crosses `level` (0.5)\n"
    "  value, bar      the number, and how far it may be off\n"
    "\n"
    "  --method NAME  only this one; repeatable\n"
    "  --finer N  steps N times as short, 0.01 to 10000\n"
    "  --csv FILE the table, a line for each truth and method\n"
    "  -o DIR     draws the errors into DIR, truth.svg and truth.png\n" LOOK_HELP_DRAWN
    "  --json     a list of objects with keys truth, scenario, value, bar, source, method, step,\n"
    "             reached, error, why_none, evaluations_per_second, microseconds_per_second\n",
};
