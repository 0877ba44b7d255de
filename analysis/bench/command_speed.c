/* command_speed.c - `stance bench plot`: draws the table that `make bench` writes. */
#include "speed.h"

#include "analysis/draw/plot.h"
#include "runner/base/command.h"

#include <stdio.h>
#include <string.h>

extern const struct command command_speed; /* below */

static int run(int argc, char **argv)
{
    const char *file;
    struct look_options options = {0};
    struct look look;
    size_t operands;
    const struct option_spec specs[] = {LOOK_SPECS(options)};
    struct speed_table table;
    stance_message message;

    const int begun =
        command_begin(&command_speed, argc, argv, specs, sizeof specs / sizeof specs[0], "a table",
                      &file, 1, 1, &operands);
    if (begun != COMMAND_GOES_ON)
        return begun;
    if (!look_read(&command_speed, &options, &look))
        return EXIT_USAGE;
    if (!speed_read(file, &table, &message)) {
        fprintf(stderr, "stance bench plot: %s\n", message.text);
        return EXIT_IO;
    }
    const char *slash = strrchr(file, '/'), *name = slash ? slash + 1 : file;
    char stem[128], own[1024];
    snprintf(stem, sizeof stem, "%.*s", (int)strcspn(name, "."), name);
    const char *const directory = look_directory(&look, file, own, sizeof own);
    const bool there = gnuplot_directory(directory);
    const bool good = there && speed_plot(&table, &look, directory, stem, &message);
    if (there && !good)
        fprintf(stderr, "stance bench plot: %s\n", message.text);
    speed_free(&table);
    return !good ? EXIT_IO : look_end(&look, &command_speed, file) ? EXIT_DONE : EXIT_USAGE;
}

const struct command command_speed = {
    "bench plot", "stance bench plot FILE.csv [-o PLACE] [--format F,...] [--for column|page] ...",
    "picture of the speed benchmarks", run,
    "Draws a table of `make bench` or `stance bench --csv` as SVG and PNG beside the file: the\n"
    "biped's step in every instruction set beside the step written by hand and\n"
    "MuJoCo's, every method in every scene, and the wall time of the shipped map. Marks are "
    "medians,\n"
    "bars go from the lowest to the highest. What the table does not have is left out.\n"
    "\n" LOOK_HELP};
