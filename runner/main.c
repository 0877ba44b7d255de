/* main.c - the program: finds the command and runs it. */
#include "runner/base/command.h"
#include "runner/base/words.h"
#include "runner/plan/instruction_set.h"
#include "runner/ranks/parallel.h"
#include "runner/store/build_info.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

extern const struct command command_check, command_design, command_build, command_run,
    command_export, command_status, command_summary, command_plot, command_compare,
    command_describe, command_bench, command_basin, command_merge, command_table,
    command_sensitivity, command_replay, command_ranges, command_optimise, command_view,
    command_gait, command_import, command_critical;

static const struct command *const commands[] = {
    &command_check,       &command_ranges, &command_design,  &command_build,    &command_run,
    &command_optimise,    &command_status, &command_summary, &command_plot,     &command_replay,
    &command_gait,        &command_view,   &command_compare, &command_basin,    &command_critical,
    &command_sensitivity, &command_merge,  &command_table,   &command_describe, &command_export,
    &command_import,      &command_bench,
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void print_usage(FILE *out)
{
    fputs("stance maps where a legged robot keeps its balance.\n\n"
          "usage: stance COMMAND [ARGUMENTS]\n\n",
          out);
    for (size_t i = 0; i < COMMANDS; i++)
        fprintf(out, "  %-12s %s\n", commands[i]->name, commands[i]->summary);
    fputs(
        "\nstance COMMAND -h, or stance help COMMAND, explains a command; stance --version says "
        "what was built;\nstance help --options lists all options, a line of fields between tabs "
        "each.\n"
        "Exit codes: 0 done, 1 some cases failed numerically (compare: files differ; import: the\n"
        "robot moves otherwise than the file's), 2 bad use or bad scenario, 3 input or output "
        "failed, 4 interrupted and resumable.\n"
        "The environment variable STANCE_ISA, if set, names the instruction set to compute with;\n"
        "results do not depend on it.\n",
        out);
}

static void print_version(void)
{
    char libraries[BUILD_LIBRARIES_SIZE], sets[INSTRUCTION_SETS_SIZE];
    stance_message message;
    build_libraries(libraries);
    instruction_set_names(sets);
    printf("stance %s (revision %s)\n%s\n%s\n%s\n", STANCE_VERSION, build_revision, build_compiler,
           build_flags, libraries);
    printf("instruction sets %s; in use: %s\n", sets,
           instruction_set_check(&message) ? instruction_set() : "none");
}

static int unknown_command(const char *word)
{
    const char *names[COMMANDS];
    for (size_t i = 0; i < COMMANDS; i++)
        names[i] = commands[i]->name;
    const char *near = nearest_word(word, names, COMMANDS), *suffix = strrchr(word, '.');
    const bool scenario = suffix && (!strcmp(suffix, ".yaml") || !strcmp(suffix, ".yml"));
    if (scenario || (suffix && strcmp(suffix, ".h5") == 0)) {
        fprintf(stderr, "stance: a command comes before the file; write stance %s %s\n",
                scenario ? "run" : "summary", word);
        return EXIT_USAGE;
    }
    fprintf(stderr, "stance: unknown command '%s'", word);
    if (near)
        fprintf(stderr, "; did you mean '%s'?\n", near);
    else
        fprintf(stderr, "; stance -h lists the commands\n");
    return EXIT_USAGE;
}

/* A caller may have closed standard streams: the next files to be opened would take their places,
 * and what is printed would end in them. What stands there instead can be read and is empty, so
 * that to print is an error. */
static bool hold_standard_streams(void)
{
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; stream++)
        if (fcntl(stream, F_GETFD) < 0 && errno == EBADF && open("/dev/null", O_RDONLY) != stream)
            return false;
    return true;
}

/* What was printed must have arrived, or the exit code says so. */
static int checked_output(int code)
{
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fputs("stance: cannot write to standard output\n", stderr);
        return code == EXIT_DONE || code == EXIT_CASES_FAILED ? EXIT_IO : code;
    }
    return code;
}

int main(int argc, char **argv)
{
    static char help_option[] = "-h";
    /* A write beyond the file size limit is to fail with an error, not to kill the process. */
    signal(SIGXFSZ, SIG_IGN);
    if (!hold_standard_streams())
        return EXIT_IO; /* nowhere to say why */
    if (argc < 2) {
        print_usage(stderr);
        return EXIT_USAGE;
    }
    const bool helps = strcmp(argv[1], "help") == 0;
    if (strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "--help") == 0 || (helps && argc == 2)) {
        print_usage(stdout);
        return checked_output(EXIT_DONE);
    }
    if (helps && strcmp(argv[2], "--options") == 0) { /* of runner/install */
        for (size_t i = 0; i < COMMANDS; i++)
            command_print_rows(commands[i]);
        return checked_output(EXIT_DONE);
    }
    if (helps) { /* stance help COMMAND: stance COMMAND -h */
        argv[1] = argv[2];
        argv[2] = help_option;
        argc = 3;
    }
    if (strcmp(argv[1], "--version") == 0) {
        print_version();
        return checked_output(EXIT_DONE);
    }
    /* Of commands that are not for several ranks the first one speaks. */
    if (!parallel_is_first() && strcmp(argv[1], command_run.name) != 0 &&
        strcmp(argv[1], command_optimise.name) != 0 && strcmp(argv[1], command_critical.name) != 0)
        return EXIT_DONE;
    for (size_t i = 0; i < COMMANDS; i++)
        if (strcmp(argv[1], commands[i]->name) == 0)
            return checked_output(commands[i]->run(argc - 1, argv + 1));
    return unknown_command(argv[1]);
}
