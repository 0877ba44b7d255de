/* command_describe.c - `stance describe`: the scenario format, from the table that checks it. */
#include "scenario.h"

#include "runner/base/command.h"

extern const struct command command_describe; /* below */

struct request {
    const char *path, *of;
    bool schema;
};

static int run_describe(int argc, char **argv)
{
    struct request request = {0};
    const int code = command_begin(&command_describe, argc, argv, &request);

    if (code != COMMAND_GOES_ON)
        return code;
    struct scenario *const of = request.of ? scenario_new(request.of, NULL, NULL, 0, stderr) : NULL;
    if (request.of && !of)
        return EXIT_USAGE;
    const bool good = scenario_describe(request.path, request.schema, of, stdout, stderr);
    scenario_drop(of);
    return good ? EXIT_DONE : request.path ? EXIT_USAGE : EXIT_IO;
}

static const struct option options[] = {
    {"PATH", OPTION_TO(struct request, path), .text = "a path"},
    {"--of", "SCENARIO", OPTION_TO(struct request, of),
     .text = "of this one: with the names of its robot and the parameters of its law"},
    {"--schema", OPTION_TO(struct request, schema), .without = "PATH",
     .text = "JSON Schema (draft 2020-12), for editors"},
    {0},
};

const struct command command_describe = {
    "describe",
    "documents the scenario format",
    run_describe,
    options,
    "Without argument: every key with its type, range, unit and default. PATH: one key, such as "
    "controller.sample_time or sweep.grid[0].count.",
    NULL,
};
