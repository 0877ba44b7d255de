/* asked.c - commands that look at one scenario. */
#include "asked.h"
#include "instruction_set.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const struct option asked_options[] = {
    {"SCENARIO", OPTION_TO(struct asked, file), .low = 1, .text = "a scenario file"},
    {OPTION_SET(struct asked, sets)},
    {0},
};

const char *asked_method(size_t k)
{
    return stance_methods()[k] ? stance_methods()[k]->name : NULL;
}

int asked_work(const struct command *command, const struct asked *asked,
               int (*work)(const struct scenario *s, void *request), void *request)
{
    struct scenario *const s = calloc(1, sizeof *s);
    int code = EXIT_USAGE;
    if (!s) {
        fprintf(stderr, "stance %s: %s\n", command->name, strerror(ENOMEM));
        return EXIT_IO;
    }
    if (scenario_read(s, asked->file, NULL, asked->sets.text, asked->sets.count, stderr)) {
        code = work(s, request);
        scenario_free(s);
    } else if (access(asked->file, R_OK) != 0) {
        code = EXIT_IO;
    }
    free(s);
    return code;
}

int asked_run(const struct command *command, int argc, char **argv,
              int (*work)(const struct scenario *s, void *request), void *request)
{
    const int code = command_begin(command, argc, argv, request);
    if (code != COMMAND_GOES_ON)
        return code;
    return instruction_set_usable(command->name) ? asked_work(command, request, work, request)
                                                 : EXIT_USAGE;
}
