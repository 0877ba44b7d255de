/* command_export.c - `stance export`: a robot for other programs. */
#include "asked.h"
#include "mjcf.h"

#include <errno.h>
#include <string.h>

extern const struct command command_export; /* below */

struct request {
    struct asked asked;
    const char *path;
    bool mjcf;
};

static int write_model(const struct scenario *s, const stance_case *c, void *asked)
{
    const char *const path = ((const struct request *)asked)->path;
    FILE *const out = path ? fopen(path, "w") : stdout;
    if (out)
        mjcf_write(out, s->scene, c, s->title[0] ? s->title : s->name);
    const bool written = out && !ferror(out);
    if (s->scene->mechanism->plates > 0)
        fputs("stance export: warning: ground.plates are left out: the model's ground is their "
              "plane\n",
              stderr);
    if (path && (!written | (out && fclose(out) != 0))) {
        fprintf(stderr, "stance export: cannot write %s: %s\n", path, strerror(errno));
        return EXIT_IO;
    }
    return EXIT_DONE;
}

static int export(const struct scenario *s, void *asked)
{
    return asked_first(&command_export, s, write_model, asked);
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
             "laws, pushes, restitution, plates of the ground, falls)."},
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
