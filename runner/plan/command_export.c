/* command_export.c - `stance export`: a described mechanism for other programs. */
#include "mjcf.h"
#include "plan.h"

#include "runner/base/command.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const struct command command_export; /* below */

enum { MAX_SETS = 64 };

static int fail(const char *text)
{
    fprintf(stderr, "stance export: %s\n", text);
    return EXIT_USAGE;
}

static int write_model(const struct scenario *s, const stance_case *c, const char *path)
{
    FILE *const out = path ? fopen(path, "w") : stdout;
    if (out)
        mjcf_write(out, s->scene, c, s->title[0] ? s->title : s->name);
    const bool written = out && !ferror(out);
    if (path && (!written | (out && fclose(out) != 0))) {
        fprintf(stderr, "stance export: cannot write %s: %s\n", path, strerror(errno));
        return EXIT_IO;
    }
    return EXIT_DONE;
}

/* The first case; whether it exists is known when its design has been computed. */
static int export(const struct scenario *s, const char *path)
{
    const struct parallel alone = parallel_alone();
    struct plan plan;
    struct plan_error error;
    stance_case *const c = calloc(1, sizeof *c);
    int method, code = EXIT_USAGE;
    if (!c || !plan_make(&plan, s, true, 0, false, &error)) {
        free(c);
        return fail(c ? error.message.text : strerror(ENOMEM));
    }
    if (!plan_compute_designs(&plan, &alone, &error) || !plan_check_cases(&plan, &error))
        fail(error.message.text);
    else if (!plan_resolve(&plan, 0, c, &method))
        fail("the first case does not exist");
    else
        code = write_model(s, c, path);
    plan_free(&plan);
    free(c);
    return code;
}

static int run(int argc, char **argv)
{
    const char *sets[MAX_SETS], *file = NULL, *path = NULL;
    size_t set_count = 0, mjcf = 0, paths = 0, operands = 0;
    const struct option_spec specs[] = {
        {"--mjcf", false, NULL, 0, &mjcf},
        {"-o", true, &path, 1, &paths},
        {"--set", true, sets, MAX_SETS, &set_count},
    };
    int code =
        command_begin(&command_export, argc, argv, specs, 3, "a scenario", &file, 1, 1, &operands);
    if (code != COMMAND_GOES_ON)
        return code;
    if (!mjcf)
        return command_usage(&command_export, "say in which format: --mjcf");
    struct scenario *s = malloc(sizeof *s);
    if (!s) {
        fprintf(stderr, "stance export: %s\n", strerror(ENOMEM));
        return EXIT_IO;
    }
    code = EXIT_USAGE;
    if (scenario_read(s, file, NULL, sets, set_count, stderr)) {
        if (s->scene->mechanism)
            code = export(s, path);
        else
            fprintf(
                stderr,
                "%s: the scene %s is not described as bodies: only a mechanism can be exported\n",
                file, s->scene->name);
        scenario_free(s);
    } else if (access(file, R_OK) != 0) {
        code = EXIT_IO;
    }
    free(s);
    return code;
}

const struct command command_export = {
    "export",
    "export --mjcf SCENARIO [-o FILE] [--set PATH=VALUE]...",
    "writes a described mechanism as a model of another simulator",
    run,
    "Writes the first case of a scenario whose scene is `mechanism`, to FILE or to standard "
    "output.\n"
    "\n"
    "  --mjcf  for MuJoCo: bodies, joints with springs, dampers, armature and limits, contacts,\n"
    "          the ground and its slope, motors with their limits, the initial state as keyframe\n"
    "          `initial`. qpos and qvel are the scenario's coordinates and rates, by name, so\n"
    "          that accelerations may be compared as they are; the file says what is not in it\n"
    "          (control laws, pushes, restitution, falls).\n"
    "  -o      the file\n"
    "  --set   replaces a value, as everywhere\n",
};
