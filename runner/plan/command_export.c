/* command_export.c - `stance export`: a robot for other programs. */
#include "asked.h"
#include "mjcf.h"
#include "plan.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_export; /* below */

struct request {
    struct asked asked;
    const char *path;
    bool mjcf;
};

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
static int export(const struct scenario *s, void *asked)
{
    const struct request *const request = asked;
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
        code = write_model(s, c, request->path);
    plan_free(&plan);
    free(c);
    return code;
}

static int run(int argc, char **argv)
{
    struct request request = {.path = NULL};
    return asked_run(&command_export, argc, argv, export, &request);
}

static const struct option options[] = {
    {"--mjcf", OPTION_TO(struct request, mjcf), .low = 1,
     .text = "for MuJoCo: bodies, joints with springs, dampers, armature and limits, contacts, "
             "the ground and its slope, motors with their limits, the initial state as keyframe "
             "`initial`. qpos and qvel are the scenario's coordinates and rates, by name, so that "
             "accelerations may be compared as they are; the file says what is not in it (control "
             "laws, pushes, restitution, falls)."},
    {"-o", "FILE", OPTION_TO(struct request, path), .text = "the file"},
    {.rows = asked_options},
    {0},
};

const struct command command_export = {
    "export",
    "writes a robot as a model of another simulator",
    run,
    options,
    "Writes the first case of a scenario, to FILE or to standard output.",
    NULL};
