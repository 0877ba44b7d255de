/* command_import.c - `stance import`: a robot from another program's file. */
#include "compare.h"
#include "plane.h"
#include "write.h"

#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/plan/asked.h"
#include "runner/plan/instruction_set.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

extern const struct command command_import; /* below */

struct request {
    const char *file, *output;
    unsigned plane; /* PLANES: not given */
    struct option_texts weld, sole;
    bool force;
    /* On the way. */
    struct spatial_model model;
    struct plane_robot robot;
    char *text;
    size_t size;
};

enum { PLANES = 3 };
#define NO_FILE "scenario"

static const char *plane_word(size_t k)
{
    static const char *const planes[PLANES + 1] = {"xz", "yz", "xy"};
    return planes[k];
}

static int fail(const char *text)
{
    fprintf(stderr, "stance import: %s\n", text);
    return EXIT_USAGE;
}

/* The first element of a file, as far as its beginning tells: what kind of file it is. */
static bool first_element(const char *path, char name[16], spatial_message *message)
{
    char begin[65536];
    FILE *const in = fopen(path, "rb");
    const size_t size = in ? fread(begin, 1, sizeof begin - 1, in) : 0;
    const bool good = in && !ferror(in);
    if (in)
        fclose(in);
    if (!good)
        return complain(message, "%.150s: it cannot be read", path);
    begin[size] = name[0] = 0;
    const char *s = strchr(begin, '<');
    while (s && (s[1] == '?' || s[1] == '!')) {
        s = strstr(s, strncmp(s, "<!--", 4) == 0 ? "-->" : ">");
        s = s ? strchr(s, '<') : NULL;
    }
    if (s)
        snprintf(name, 16, "%.*s", (int)strcspn(s + 1, " \t\r\n/>"), s + 1);
    return true;
}

static bool read_file(struct request *r, spatial_message *message)
{
    char name[16];
    if (!first_element(r->file, name, message))
        return false;
    if (strcmp(name, "mujoco") == 0 || strcmp(name, "mujocoinclude") == 0)
        return mjcf_read(r->file, &r->model, message);
    if (strcmp(name, "robot") == 0)
        return urdf_read(r->file, &r->model, message);
    if (strcmp(name, "sdf") == 0)
        return complain(message, "%.120s: SDF files are not read: export it as URDF or MJCF",
                        r->file);
    return complain(message, "%.120s: it is neither MJCF (<mujoco>) nor URDF (<robot>)", r->file);
}

/* At once, or not at all. */
static int put(const struct request *r)
{
    struct whole_file whole;
    if (!r->output)
        return fwrite(r->text, 1, r->size, stdout) == r->size ? EXIT_DONE : EXIT_IO;
    if (whole_file_begin(&whole, r->output) &&
        whole_file_end(&whole, fwrite(r->text, 1, r->size, whole.out) == r->size))
        return EXIT_DONE;
    fprintf(stderr, "stance import: cannot write %s: %s\n", r->output, strerror(errno));
    return EXIT_IO;
}

static void report(const struct request *r, const char *agreement)
{
    const stance_mechanism *const m = &r->robot.mechanism;
    const int root = r->robot.map.free_root;
    const int count[] = {m->bodies - root, m->elements, m->actuators};
    FILE *const out = r->output ? stdout : stderr;
    fprintf(out, "%s: %d bod%s in the plane%s, %d joint%s, %d contact%s, %d actuator%s\n",
            r->output ? r->output : r->file, m->bodies, m->bodies == 1 ? "y" : "ies",
            root ? ", free" : "", count[0], &"s"[count[0] == 1], count[1], &"s"[count[1] == 1],
            count[2], &"s"[count[2] == 1]);
    for (int n = 0; n < r->model.notes; n++)
        fprintf(out, "  - %s\n", r->model.note[n].text);
    fprintf(out, "%s\n", agreement);
}

/* With the scenario as a reader has it: does it move as the file's robot? */
static int finish(const struct scenario *s, const stance_case *c, void *asked)
{
    struct request *const r = asked;
    struct compare_report compared;
    spatial_message message;
    char sentence[1000];
    const bool known =
        import_compare(&r->model, r->file, &r->robot.map, s->scene, c, &compared, &message);
    if (known)
        compare_sentence(&compared, s->scene, sentence, sizeof sentence);
    else
        snprintf(sentence, sizeof sentence, "not compared with the file: %s", message.text);
    const int code = put(r);
    if (code == EXIT_DONE)
        report(r, sentence);
    if (code != EXIT_DONE || !known || compared.worst <= COMPARE_ADMITTED)
        return code;
    fail(sentence);
    return EXIT_CASES_FAILED;
}

/* What is written is what a reader takes. What it does not take is told of the robot, as nobody has
 * a scenario that has the line. */
static int refuse_scenario(const struct request *r, const char *problems)
{
    const struct plane_map *const map = &r->robot.map;
    char name[STANCE_NAME] = "";
    const char *hold = NULL;
    int place = 0, still = 0;
    sscanf(problems, NO_FILE ":%*d:%*d: %n", &place);
    const char *const text = problems + place;
    sscanf(text, "robot.bodies.%63[a-zA-Z0-9_]: nothing resists%n", name, &still);
    for (int k = 0; still > 0 && k < r->robot.mechanism.bodies; k++) {
        const int own = map->coordinate[k + 2 * map->free_root].joint;
        const struct spatial_joint *const joint =
            &r->model.joint[own < 0 ? map->root_joint[0] : own];
        if (strcmp(name, r->robot.mechanism.body[k].name) == 0)
            hold = joint->name[0] ? joint->name : r->model.body[joint->body].name;
    }
    fprintf(stderr, "stance import: %s: as a scenario: %.*s%s%s\n", r->file,
            (int)strcspn(text, "\n"), text, hold ? ", or hold it: --weld " : "", hold ? hold : "");
    return EXIT_USAGE;
}

static int import(struct request *r)
{
    const struct plane_wishes wishes = {.plane = plane_word(r->plane),
                                        .weld = r->weld.text,
                                        .welds = r->weld.count,
                                        .sole = r->sole.text,
                                        .soles = r->sole.count};
    spatial_message message;
    if (!read_file(r, &message) || !plane_make(&r->model, &wishes, &r->robot, &message))
        return fail(message.text);
    char *problems = NULL;
    FILE *const out = open_memstream(&r->text, &r->size), *const said = open_memstream(
                                                              &problems, &(size_t){0});
    if (out)
        import_write(out, &r->model, &r->robot);
    if (!out || fclose(out) != 0 || !said)
        return fail(strerror(ENOMEM));
    struct scenario *const s = scenario_new(NO_FILE, r->text, NULL, 0, said);
    fclose(said);
    const int code = s ? asked_first(&command_import, s, finish, r) : refuse_scenario(r, problems);
    free(problems);
    scenario_drop(s);
    return code;
}

static int work(void *asked)
{
    struct request *const r = asked;
    const int code = import(r);
    spatial_free(&r->model);
    plane_free(&r->robot);
    free(r->text);
    return code;
}

/* Both, before anything waits for them. */
static bool check_files(const struct request *r)
{
    enum { MOST = 16 << 20 };
    struct stat in, out;
    const char *wrong = NULL, *of = r->file, *mark = "";
    if (stat(r->file, &in) != 0 || access(r->file, R_OK) != 0)
        mark = ":", wrong = strerror(errno);
    else if (!S_ISREG(in.st_mode))
        wrong = S_ISDIR(in.st_mode) ? "is a directory" : "is no regular file";
    else if (in.st_size > MOST)
        wrong = "is larger than 16 MiB, the most a robot may take";
    else if (r->output && lstat(of = r->output, &out) == 0)
        wrong = S_ISDIR(out.st_mode)                           ? "is a directory"
                : !r->force                                    ? "exists; --force replaces it"
                : S_ISREG(out.st_mode) || S_ISLNK(out.st_mode) ? NULL
                                                               : "is no regular file";
    if (wrong)
        fprintf(stderr, "stance import: %s%s %s\n", of, mark, wrong);
    return !wrong;
}

static int run(int argc, char **argv)
{
    struct request request = {.plane = PLANES};
    const int code = command_begin(&command_import, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    if (request.output && strcmp(request.output, "-") == 0)
        request.output = NULL;
    if (!check_files(&request))
        return EXIT_IO;
    if (!instruction_set_usable(command_import.name)) /* for the first case */
        return EXIT_USAGE;
    return sandbox(work, &request, request.file);
}

#define TO(member) OPTION_TO(struct request, member)
static const struct option options[] = {
    {"FILE", TO(file), .low = 1, .text = "a robot: MJCF (MuJoCo), which libmujoco reads, or URDF"},
    {"-o", "FILE", TO(output), .text = "the scenario; without it, or with -, standard output"},
    {"--plane", .word = plane_word, TO(plane),
     .text =
         "axes of the file in which the robot moves; unasked the plane across its hinges, which "
         "gravity must be in"},
    {"--weld", "JOINT", TO(weld), .text = "hold a joint where it begins; may be repeated"},
    {"--sole", "LINK=X,Z,X,Z", TO(sole),
     .text = "a flat sole between two places of a link's frame, m, instead of its shapes; may be "
             "repeated"},
    {"--force", TO(force), .text = "replace FILE of -o"},
    {0},
};

const struct command command_import = {
    "import",
    "makes a scenario of a robot in another program's format",
    run,
    options,
    "Writes a scenario of a planar robot: bodies, joints with springs, dampers, armature and "
    "limits, contacts, motors, the ground, the initial state (of MJCF the first keyframe). "
    "Comments at its head say what is otherwise than in the file, and why. What has no "
    "counterpart is refused by its name. Where libmujoco is installed accelerations in random "
    "states are compared with those of an MJCF file, or of what was read of a URDF; exit code 1: "
    "they differ.\n",
    NULL};
