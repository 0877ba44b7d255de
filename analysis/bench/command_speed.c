/* command_speed.c - `stance bench plot`: draws the table that `make bench` writes. */
#include "speed.h"

#include "analysis/draw/plot.h"
#include "runner/base/command.h"

#include <stdio.h>
#include <string.h>

extern const struct command command_speed; /* below */

static int run(int argc, char **argv)
{
    bool help;
    const char *operand[1], *directory = NULL;
    size_t operands, count;
    const struct option_spec specs[] = {{"-o", true, &directory, 1, &count}};
    struct speed_table table;
    stance_message message;

    if (!command_options(&command_speed, argc, argv, specs, 1, operand, 1, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (operands != 1) {
        fprintf(stderr, "stance bench plot: one table is needed (stance bench plot -h explains)\n");
        return EXIT_USAGE;
    }
    if (!speed_read(operand[0], &table, &message)) {
        fprintf(stderr, "stance bench plot: %s\n", message.text);
        return EXIT_IO;
    }
    const char *slash = strrchr(operand[0], '/');
    const char *name = slash ? slash + 1 : operand[0];
    char stem[128], beside[256];
    snprintf(stem, sizeof stem, "%.*s", (int)strcspn(name, "."), name);
    snprintf(beside, sizeof beside, "%.*s", slash ? (int)(slash - operand[0]) : 1,
             slash ? operand[0] : ".");
    const bool good = speed_plot(&table, directory ? directory : beside, stem, &message);
    if (!good)
        fprintf(stderr, "stance bench plot: %s\n", message.text);
    speed_free(&table);
    return good ? EXIT_DONE : EXIT_IO;
}

const struct command command_speed = {
    "bench plot", "stance bench plot FILE.csv [-o DIRECTORY]", "picture of the speed benchmarks",
    run,
    "Draws a table of `make bench` or `stance bench --csv` as SVG and PNG beside the file, or in\n"
    "DIRECTORY: the biped's step in every instruction set beside the step written by hand and\n"
    "MuJoCo's, every method in every scene, and the wall time of the shipped map. Marks are "
    "medians,\n"
    "bars go from the lowest to the highest. What the table does not have is left out.\n"};
