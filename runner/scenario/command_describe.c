/* command_describe.c - `stance describe`: the scenario format, from the table that checks it. */
#include "scenario.h"

#include "runner/base/command.h"

extern const struct command command_describe; /* below */

static int run_describe(int argc, char **argv)
{
    size_t schema = 0, operands;
    const struct option_spec options[] = {{"--schema", false, NULL, 0, &schema}};
    const char *path = NULL;
    const int code =
        command_begin(&command_describe, argc, argv, options, 1, "", &path, 0, 1, &operands);

    if (code != COMMAND_GOES_ON)
        return code;
    if (schema && operands)
        return command_usage(&command_describe, "--schema takes no PATH");
    if (scenario_describe(operands ? path : NULL, schema > 0, stdout, stderr))
        return EXIT_DONE;
    return operands ? EXIT_USAGE : EXIT_IO;
}

const struct command command_describe = {
    .name = "describe",
    .synopsis = "describe [--schema | PATH]",
    .summary = "documents the scenario format",
    .run = run_describe,
    .help = "Without argument: every key with its type, range, unit and default.\n"
            "  PATH      one key, such as controller.sample_time or sweep.grid[0].count\n"
            "  --schema  JSON Schema (draft 2020-12), for editors\n",
};
