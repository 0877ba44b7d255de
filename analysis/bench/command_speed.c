/* command_speed.c - `stance bench plot`: draws the table that `make bench` writes. */
#include "speed.h"

#include "analysis/draw/plot.h"
#include "runner/base/command.h"

#include <stdio.h>
#include <string.h>

extern const struct command command_speed; /* below */

struct request {
    const char *file;
    struct look look;
};

static int run(int argc, char **argv)
{
    struct request request = {.file = NULL};
    struct speed_table table;
    stance_message message;
    look_begin(&request.look);
    const int begun = command_begin(&command_speed, argc, argv, &request);
    if (begun != COMMAND_GOES_ON)
        return begun;
    const char *const file = request.file;
    if (!speed_read(file, &table, &message)) {
        fprintf(stderr, "stance bench plot: %s\n", message.text);
        return EXIT_IO;
    }
    const char *const name = basename(file);
    char stem[128], own[1024];
    snprintf(stem, sizeof stem, "%.*s", (int)strcspn(name, "."), name);
    const struct plot plot = {.title = "Speed of the stepping kernels",
                              .directory = look_directory(&request.look, file, own, sizeof own),
                              .stem = stem,
                              .look = &request.look,
                              .message = &message};
    const bool there = gnuplot_directory(plot.directory);
    const bool good = there && speed_plot(&table, &plot);
    if (there && !good)
        fprintf(stderr, "stance bench plot: %s\n", message.text);
    speed_free(&table);
    return !good ? EXIT_IO : look_end(&request.look, &command_speed, file) ? EXIT_DONE : EXIT_USAGE;
}

static const struct option options[] = {
    {"FILE.csv", OPTION_TO(struct request, file), .low = 1, .text = "a table"},
    {.at = offsetof(struct request, look), .rows = look_options},
    {0},
};

const struct command command_speed = {
    "bench plot",
    "picture of the speed benchmarks",
    run,
    options,
    "Draws a table of `make bench` or `stance bench --csv` as SVG and PNG beside the file: the "
    "biped's step in every instruction set beside the step written by hand and MuJoCo's, every "
    "method in every scene, and the wall time of the shipped map. Marks are medians, bars go from "
    "the lowest to the highest. What the table does not have is left out.\n",
    NULL,
};
