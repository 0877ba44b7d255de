/* report.c - see report.h. */
#include "report.h"

#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/store/search_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_OPTIONS = 24 };

bool report_options(struct report *report, int argc, char **argv, const struct option_spec *specs,
                    size_t count, int *code)
{
    const char *name = report->command->name;
    struct option_spec all[MOST_OPTIONS];
    size_t json = 0, csv = 0;
    bool help = false;
    for (size_t k = 0; k < count; k++)
        all[k] = specs[k];
    if (!report->one_form) {
        all[count++] = (struct option_spec){"--json", false, NULL, 0, &json};
        all[count++] = (struct option_spec){"--csv", false, NULL, 0, &csv};
    }
    *code = EXIT_USAGE;
    if (!command_options(report->command, argc, argv, all, count, report->files,
                         report->search ? REPORT_FILES : 1, &report->count, &help))
        return false;
    const size_t operands = report->count;
    report->file = report->files[0];
    report->form = table_form(json, csv);
    if (help)
        *code = EXIT_DONE;
    else if (operands == 0)
        fprintf(stderr, "stance %s: a results file is needed (stance %s -h explains)\n", name,
                name);
    else if (json && csv)
        fprintf(stderr, "stance %s: --json or --csv, not both\n", name);
    return !help && operands > 0 && !(json && csv);
}

static int open_and_work(void *context)
{
    struct report *report = context;
    struct results r;
    stance_message message = {""};
    int code = EXIT_IO;
    if (report->search && search_file_is(report->file)) {
        code = report->search(report, &message);
    } else if (report->count > 1) {
        code = EXIT_USAGE;
        complain(&message,
                 "stance %s: one results file; several can be of searches (stance optimise)",
                 report->command->name);
    } else if (results_open(&r, report->file, &message)) {
        code = report->work(report, &r, &message);
        results_close(&r);
    }
    if (message.text[0])
        fprintf(stderr, "%s\n", message.text);
    else if (code == EXIT_IO)
        fprintf(stderr, "stance %s: %s\n", report->command->name,
                fflush(stdout) != 0 || ferror(stdout) ? "the output could not be written"
                                                      : "not enough memory");
    return code;
}

int report_run(struct report *report)
{
    return sandbox(open_and_work, report, report->file);
}

bool report_number(const struct report *report, const char *option, const char *text, double low,
                   double high, bool whole, double *value)
{
    char *end;
    if (!text)
        return true;
    errno = 0;
    const double number = strtod(text, &end);
    const bool good = end != text && !*end && !errno && number >= low && number <= high &&
                      (!whole || number == floor(number));
    if (good)
        *value = number;
    else
        fprintf(stderr, "stance %s: %s takes a %snumber from %.10g to %.10g, not '%.40s'\n",
                report->command->name, option, whole ? "whole " : "", low, high, text);
    return good;
}

bool report_outcome(const struct report *report, const char *text, enum results_kind *of)
{
    const size_t k =
        text ? command_word(report->command, "--of", text, results_kind_names, RESULTS_OUTCOMES)
             : *of;
    if (k == RESULTS_OUTCOMES && text)
        return false;
    *of = (enum results_kind)k;
    return true;
}
