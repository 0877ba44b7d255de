/* studies.c - finds, runs and reports the scenarios of `stance bench accuracy` and `failure`. */
#include "studies.h"

#include "runner/base/message.h"
#include "runner/plan/instruction_set.h"
#include "runner/run/run.h"

#include <errno.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { STEM = 256, FILE_NAME = 1024 };

/* ---- their scenarios ---------------------------------------------------------------------- */

bool study_plan(struct plan *plan, const struct scenario *s, stance_message *message)
{
    const struct parallel alone = parallel_alone();
    struct plan_error error = {0};
    if (!plan_make(plan, s, false, 0, false, &error))
        return complain(message, "%s", error.message.text);
    if (plan_compute_designs(plan, &alone, &error))
        return true;
    plan_free(plan);
    return complain(message, "%s", error.message.text);
}

double study_tolerance(const stance_method *method, const struct scenario_values *values)
{
    return !(method->tolerance > 0)   ? NAN
           : isnan(values->tolerance) ? method->tolerance
                                      : values->tolerance;
}

/* ---- where they are ----------------------------------------------------------------------- */

/* Those below the working directory, or beside the program; freed by the caller. */
static void find_studies(const char *kind, glob_t *found)
{
    static const char *const bases[] = {"", "../", "../share/stance/"};
    char program[900] = "", beside[2 * sizeof program] = "", pattern[2 * sizeof program + 100];
    const ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    const char *const slash = n > 0 ? strrchr(program, '/') : NULL;
    char *to = beside;
    for (const char *from = program; slash && from <= slash; *to++ = *from++)
        if (strchr("[]*?\\", *from)) /* as it stands, no pattern */
            *to++ = '\\';
    *found = (glob_t){.gl_pathc = 0};
    for (size_t k = 0; found->gl_pathc == 0 && k < sizeof bases / sizeof *bases; k++) {
        globfree(found);
        snprintf(pattern, sizeof pattern, "%s%sscenarios/%s/*.yaml", k > 0 ? beside : "", bases[k],
                 kind);
        glob(pattern, 0, NULL, found);
    }
}

/* ---- one after the other ------------------------------------------------------------------ */

struct request {
    const struct command *command;
    const struct study_kind *kind;
    const char *directory;
    struct look *look;
    bool json, reuse;
};

/* Before a long run for nothing; of a file that is there and is to be taken, whether it is the
 * scenario's. Returns an exit code. */
static int check_study(const struct request *request, const char *scenario, const char *there)
{
    struct scenario *s = scenario_new(scenario, NULL, NULL, 0, stderr);
    struct results r;
    stance_message message = {""};
    if (!s)
        return access(scenario, R_OK) == 0 ? EXIT_USAGE : EXIT_IO;
    int code = request->kind->fits(s, &message) ? EXIT_DONE : EXIT_USAGE;
    if (code == EXIT_DONE && there && results_open(&r, there, &message)) {
        if (strcmp(r.scenario, s->text) != 0) {
            complain(&message, "%.200s is of another scenario", there);
            code = EXIT_IO;
        }
        results_close(&r);
    } else if (code == EXIT_DONE && there) {
        code = EXIT_IO;
    }
    if (code != EXIT_DONE)
        fprintf(stderr, "stance %s: %.300s: %s\n", request->command->name, scenario, message.text);
    scenario_drop(s);
    return code;
}

/* What its files are called. */
static void name_study(const char *scenario, char stem[STEM])
{
    snprintf(stem, STEM, "%s", basename(scenario));
    char *const dot = strrchr(stem, '.');
    if (dot && dot > stem && strcmp(dot, ".yaml") == 0)
        *dot = '\0';
}

static void name_file(const struct request *request, const char *stem, char file[FILE_NAME])
{
    snprintf(file, FILE_NAME, "%s/%s.h5", request->directory, stem);
}

static int check_studies(const struct request *request, char *const *path, size_t count)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < count && code == EXIT_DONE; i++) {
        char stem[STEM], other[STEM], file[FILE_NAME];
        name_study(path[i], stem);
        for (size_t k = 0; k < i && code == EXIT_DONE; k++) {
            name_study(path[k], other);
            if (strcmp(stem, other) == 0) {
                fprintf(stderr, "stance %s: %.300s and %.300s would write the same files\n",
                        request->command->name, path[k], path[i]);
                code = EXIT_USAGE;
            }
        }
        name_file(request, stem, file);
        if (code == EXIT_DONE)
            code = check_study(request, path[i],
                               request->reuse && access(file, R_OK) == 0 ? file : NULL);
    }
    return code;
}

static int one_study(const struct request *request, const char *scenario, json_t *all)
{
    char file[FILE_NAME], stem[STEM];
    struct results r;
    json_t *object = NULL;
    stance_message message = {""};

    name_study(scenario, stem);
    name_file(request, stem, file);
    if (!request->reuse || access(file, R_OK) != 0) {
        char *argv[] = {"run", "--force", "--quiet", "-o", file, "--", (char *)scenario, NULL};
        const int code = command_run.run(7, argv);
        if (code != EXIT_DONE && code != EXIT_CASES_FAILED)
            return code;
    }
    /* Into the list `all`, or as text and pictures. */
    bool good = results_open(&r, file, &message);
    if (good) {
        const struct plot plot = {&r,       r.title, request->directory, stem, request->look,
                                  &message, false};
        good = request->kind->evaluate(&plot, request->json ? &object : NULL);
        results_close(&r);
    }
    if (good && object)
        json_array_append_new(all, object);
    fflush(stdout);
    if (!good) {
        fprintf(stderr, "stance %s: %.300s: %s\n", request->command->name, scenario, message.text);
        return EXIT_IO;
    }
    return EXIT_DONE;
}

static int all_studies(const struct request *request, char *const *path, size_t count)
{
    json_t *all = json_array();
    int code = check_studies(request, path, count);
    for (size_t i = 0; i < count && code == EXIT_DONE; i++)
        code = one_study(request, path[i], all);
    if (request->json && code == EXIT_DONE) {
        const bool good = table_write_json(TABLE_OBJECT({"studies", as_tree(all)}), stdout);
        return good ? EXIT_DONE : EXIT_IO;
    }
    json_decref(all);
    return code;
}

static bool make_directory(const char *path)
{
    if (mkdir(path, 0777) == 0 || errno == EEXIST)
        return true;
    fprintf(stderr, "%s: %s\n", path, strerror(errno));
    return false;
}

/* Names that no picture had are said. */
static int end(const struct request *request, int code)
{
    return code == EXIT_DONE && !request->json &&
                   !look_end(request->look, request->command, request->directory)
               ? EXIT_USAGE
               : code;
}

int studies_run(const struct command *command, const struct study_kind *kind, int argc, char **argv)
{
    struct studies asked = {.json = false};
    struct look *const look = &asked.look;
    char fallback[64];
    glob_t found;
    look_begin(look);
    const int begun = command_begin(command, argc, argv, &asked);
    if (begun != COMMAND_GOES_ON)
        return begun;
    if (!instruction_set_usable(command->name))
        return EXIT_USAGE;
    if (look->file)
        return command_usage(command, "-o takes a directory: there are several files");
    snprintf(fallback, sizeof fallback, "results/%s", kind->name);
    const struct request request = {
        command, kind, look->directory ? look->directory : fallback, look, asked.json, asked.reuse};
    if ((!look->directory && !make_directory("results")) || !make_directory(request.directory))
        return EXIT_IO;
    if (asked.scenarios.count > 0)
        return end(&request, all_studies(&request, (char *const *)asked.scenarios.text,
                                         asked.scenarios.count));
    find_studies(kind->name, &found);
    int code = EXIT_IO;
    if (found.gl_pathc > 0)
        code = end(&request, all_studies(&request, found.gl_pathv, found.gl_pathc));
    else
        fprintf(stderr,
                "stance %s: no scenarios/%s here nor beside the program; name the scenarios\n",
                command->name, kind->name);
    globfree(&found);
    return code;
}

const struct option studies_options[] = {
    {"SCENARIO...", OPTION_TO(struct studies, scenarios), .text = "scenarios"},
    {"-o", "DIR", LOOK_PLACE, .at = offsetof(struct studies, look),
     .text = "where the results files and pictures go, default results/accuracy, results/failure"},
    {"--reuse", OPTION_TO(struct studies, reuse),
     .text = "take results files of the same scenario that are there"},
    {.at = offsetof(struct studies, look), .rows = look_drawn},
    {"--json", OPTION_TO(struct studies, json),
     .text = "the same as JSON, without pictures: a list `studies` of"},
    {0},
};
