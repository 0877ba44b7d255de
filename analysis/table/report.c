/* report.c - see report.h. */
#include "report.h"

#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/store/search_file.h"

#include <stdio.h>

static int open_and_work(void *context)
{
    struct report *report = context;
    struct results r;
    stance_message message = {""};
    int code = EXIT_IO;
    if (report->search && search_file_is(report->file)) {
        code = report->search(report, &message);
    } else if (report->files.count > 1) {
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
    report->file = report->files.text[0];
    return sandbox(open_and_work, report, report->file);
}
