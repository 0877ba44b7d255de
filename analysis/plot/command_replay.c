/* command_replay.c - `stance replay FILE`: cases of a results file again, with their trajectories
 * drawn. `stance run --only CASE --trace` computes them, from the scenario inside the file. */
#include "plot_case.h"

#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/plan/asked.h"
#include "runner/plan/law.h"
#include "runner/ranks/parallel.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;
extern const struct command command_replay; /* below */

enum { MOST_CASES = 2, MOST_SETS = 32 };

struct request {
    const char *file;
    bool trust;
    struct numbers {
        uint64_t number[MOST_CASES];
        size_t count;
    } cases;
    struct option_texts nears, sets;
    struct look look;
};

static size_t asked_cases(const struct request *request)
{
    return request->cases.count + request->nears.count;
}

static bool bad(const char *what, const char *text)
{
    fprintf(stderr, "stance replay: %s '%.100s' (stance replay -h explains)\n", what, text);
    return false;
}

/* ---- which case --------------------------------------------------------------------------- */

/* Whether a path is meant: all of it, or what stands after one of its dots. */
static bool is_meant(const char *path, const char *name)
{
    const size_t length = strlen(path), own = strlen(name);
    return own <= length && strcmp(path + length - own, name) == 0 &&
           (own == length || path[length - own - 1] == '.');
}

/* The distances of values, or of words, from NAME=VALUE. */
static bool add_distances(const struct results_axis *of, const char *name, const char *text,
                          double *distance)
{
    char *end;
    struct plot_range range;
    if (of->word) {
        const size_t word =
            command_word(&command_replay, name, text, (const char *const *)of->word, of->count);
        for (size_t i = 0; i < of->count; i++)
            distance[i] += i != word;
        return word < of->count;
    }
    const double wanted = strtod(text, &end);
    if (end == text || *end || !isfinite(wanted))
        return bad("--near takes NAME=NUMBER, not", text);
    const bool wide = plot_range_of(&range, of->value, of->count) && range.high > range.low;
    for (size_t i = 0; i < of->count; i++) {
        const double off = (of->value[i] - wanted) / (wide ? range.high - range.low : 1);
        distance[i] += off * off;
    }
    return true;
}

/* One NAME=VALUE: of an axis, of what is varied, or of a further path of an axis, which moves along
 * with its first one; the file's scenario has the numbers of these. distance[axes]: how far its
 * points are from all that was asked for, squares, in units of the ranges; NULL: nothing was. */
static bool take_part(const struct results *r, const char *name, const char *text,
                      double **distance)
{
    const struct scenario *const s = r->read;
    const struct results_axis *of = NULL;
    struct results_axis along = {.count = 0};
    int axis = -1, path = 0, found = 0;
    for (int a = 0; a < r->axes; a++)
        if (a != r->sample && is_meant(r->axis[a].name, name))
            of = &r->axis[a], axis = a, found++;
    for (int k = 0; k < r->varied; k++)
        if (is_meant(r->vary[k].of.name, name)) {
            if (r->vary[k].word)
                return bad("--near takes NAME=NUMBER, not", name);
            of = &r->vary[k].of, axis = r->sample, found++;
        }
    for (int a = 0; !of && s && a < s->axes && a < r->axes; a++)
        for (int k = 1; k < s->axis[a].paths; k++)
            if (a != r->sample && !s->axis[a].enumeration[k] && is_meant(s->axis[a].path[k], name))
                axis = a, path = k, found++;
    if (found != 1)
        return bad(found ? "--near: several paths end with"
                         : "--near: nothing is varied that ends with",
                   name);
    const size_t count = r->axis[axis].count;
    if (!of) {
        along = (struct results_axis){.count = count, .value = malloc(count * sizeof(double))};
        for (size_t i = 0; along.value && i < count; i++)
            along.value[i] = scenario_axis_value(&s->axis[axis], i % s->axis[axis].count, path);
    }
    double *const own = distance[axis] ? distance[axis] : calloc(count, sizeof *own);
    distance[axis] = own;
    const bool good =
        own && (of || along.value) && add_distances(of ? of : &along, name, text, own);
    free(along.value);
    return good;
}

/* "theta=0.02,vtheta=-0.1": the case nearest to that, offsets that are not named at the
 * equilibrium, all else at its first value. */
static bool find_near(const struct results *r, const char *text, uint64_t *index)
{
    double *distance[SCENARIO_MAX_AXES] = {NULL};
    char *const copy = strdup(text), *rest = copy;
    bool good = copy != NULL;
    for (char *part; good && (part = strsep(&rest, ","));) {
        char *const equals = strchr(part, '=');
        if (equals)
            *equals = '\0';
        good = equals && equals > part ? take_part(r, part, equals + 1, distance)
                                       : bad("--near takes NAME=VALUE,..., not", text);
    }
    *index = 0;
    for (int a = 0; a < r->axes; a++) {
        const double *const far = distance[a];
        size_t point = r->axis[a].offset && !far ? statistics_nearest_zero(&r->axis[a]) : 0;
        for (size_t i = 1; far && i < r->axis[a].count; i++)
            point = far[i] < far[point] ? i : point;
        *index = *index * r->axis[a].count + point;
        free(distance[a]);
    }
    free(copy);
    return good;
}

static bool find_case(const struct results *r, const struct request *request, size_t k,
                      uint64_t *index)
{
    char text[600];
    if (k < request->cases.count) {
        *index = request->cases.number[k];
        if (!r->single && *index >= r->cases) {
            snprintf(text, sizeof text, "%" PRIu64, *index);
            return bad("the file has no case", text);
        }
        return true;
    }
    if (r->single) {
        *index = r->index;
        return true;
    }
    if (!find_near(r, request->nears.text[k - request->cases.count], index))
        return false;
    results_case_text(r, *index, text, sizeof text);
    fprintf(stderr, "case %llu, %s: %s\n", (unsigned long long)*index, text,
            results_kind_names[r->kind[*index]]);
    return true;
}

/* A law of the user's own, which is in the file, is to be trusted. */
static bool check_law(const struct results *r, const struct request *request)
{
    return request->trust || !r->read || asked_law(r->read);
}

/* A case has its own values of what is varied: --set would change nothing. */
static bool check_sets(const struct results *r, const struct request *request)
{
    for (size_t k = 0; k < request->sets.count; k++) {
        const char *const set = request->sets.text[k];
        const size_t length = strcspn(set, "=");
        for (int a = 0; a < r->axes + r->varied; a++) {
            const char *const name = a < r->axes ? r->axis[a].name : r->vary[a - r->axes].of.name;
            if (strncmp(name, set, length) == 0 && !name[length])
                return bad("--near chooses among the values that the file has; --set cannot", set);
        }
    }
    return true;
}

/* ---- computing it again ------------------------------------------------------------------- */

/* A case that was computed again, in a directory of its own. */
struct replay {
    char directory[256], scenario[600], file[600];
    uint64_t index;
    struct results r;
    struct plot plot;
    struct plot_case c;
    bool opened, loaded;
};

/* This program again: its exit code, or -1. */
static int run_again(const struct request *request, const struct replay *replay)
{
    char index[32];
    const char *arguments[17 + 2 * MOST_SETS] = {"stance", "run",        replay->scenario,
                                                 "--only", index,        "--trace",
                                                 "-o",     replay->file, "--quiet"};
    size_t count = 9;
    pid_t child;
    int status;
    parallel_leave_launcher();
    snprintf(index, sizeof index, "%llu", (unsigned long long)replay->index);
    if (request->trust)
        arguments[count++] = "--trust";
    for (size_t k = 0; k < request->sets.count; k++) {
        arguments[count++] = "--set";
        arguments[count++] = request->sets.text[k];
    }
    if (posix_spawn(&child, "/proc/self/exe", NULL, NULL, (char *const *)arguments, environ) != 0)
        return -1;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int compute(const struct results *r, const struct request *request, struct replay *replay,
                   stance_message *message)
{
    const char *base = getenv("TMPDIR");
    snprintf(replay->directory, sizeof replay->directory, "%s/stance-replay-XXXXXX",
             base && base[0] && strlen(base) < 200 ? base : "/tmp");
    if (!mkdtemp(replay->directory)) {
        replay->directory[0] = '\0';
        complain(message, "stance replay: cannot make a directory: %s", strerror(errno));
        return EXIT_IO;
    }
    snprintf(replay->scenario, sizeof replay->scenario, "%.250s/%.255s.yaml", replay->directory,
             r->name);
    snprintf(replay->file, sizeof replay->file, "%.250s/%.255s.h5", replay->directory, r->name);
    FILE *out = fopen(replay->scenario, "wx");
    const bool wrote = out && fputs(r->scenario, out) >= 0;
    if (!out || fclose(out) != 0 || !wrote) {
        complain(message, "%.150s: cannot be written: %s", replay->scenario, strerror(errno));
        return EXIT_IO;
    }
    const int code = run_again(request, replay);
    if (code != EXIT_DONE && code != EXIT_CASES_FAILED) {
        complain(message, "%.150s: case %llu cannot be computed again", r->file,
                 (unsigned long long)replay->index);
        return code < 0 ? EXIT_IO : code;
    }
    if (!results_open(&replay->r, replay->file, message))
        return EXIT_IO;
    replay->opened = true;
    const enum results_kind was = r->kind[r->single ? 0 : replay->index], is = replay->r.kind[0];
    if (was != RESULTS_PENDING && was != is)
        fprintf(stderr, "case %llu: was %s in the file, and is %s now\n",
                (unsigned long long)replay->index, results_kind_names[was], results_kind_names[is]);
    return EXIT_DONE;
}

static void clean_up(struct replay *replay)
{
    if (replay->loaded)
        plot_case_free(&replay->c);
    if (replay->opened)
        results_close(&replay->r);
    char lock[sizeof replay->file + 8];
    snprintf(lock, sizeof lock, "%s.lock", replay->file);
    unlink(replay->scenario);
    unlink(replay->file);
    unlink(lock);
    if (replay->directory[0])
        rmdir(replay->directory);
}

/* ---- the command -------------------------------------------------------------------------- */

/* One file each of GIF and SVG; what prints does not move. */
static bool is_animated(const struct look *look)
{
    return look->format[LOOK_GIF] || (look->picture && strcmp(look->picture, "animation") == 0);
}

static int draw(const struct request *request, struct replay *replays, size_t count)
{
    for (size_t k = count; k-- > 0;) {
        struct replay *const replay = &replays[k];
        replay->plot.r = &replay->r;
        if (!plot_case_load(&replay->c, &replay->plot, 0, replay->index))
            return EXIT_IO;
        replay->loaded = true;
        replay->c.other = k + 1 < count ? &replays[k + 1].c : NULL;
    }
    return (is_animated(&request->look) ? plot_animation : plot_case)(&replays[0].c) ? EXIT_DONE
                                                                                     : EXIT_IO;
}

static int replay(const struct request *request, struct look *look, const struct results *r,
                  stance_message *message)
{
    static struct replay replays[MOST_CASES]; /* large; the process has but one command */
    char directory[1024], stem[400];
    const size_t count = asked_cases(request) > 0 ? asked_cases(request) : 1;
    const char *const where = look_directory(look, request->file, directory, sizeof directory);
    int code = EXIT_DONE;
    snprintf(stem, sizeof stem, "%.200s", r->name);
    if (!check_sets(r, request) || !check_law(r, request))
        return EXIT_USAGE;
    for (size_t k = 0; k < count; k++) {
        if (!find_case(r, request, k, &replays[k].index))
            return EXIT_USAGE;
        replays[k].plot = (struct plot){NULL, NULL, where, stem, look, message, false};
        add_text(stem, sizeof stem, "-case%llu", (unsigned long long)replays[k].index);
    }
    if (!gnuplot_directory(where))
        return EXIT_IO;
    for (size_t k = 0; code == EXIT_DONE && k < count; k++)
        code = compute(r, request, &replays[k], message);
    if (code == EXIT_DONE)
        code = draw(request, replays, count);
    for (size_t k = 0; k < count; k++)
        clean_up(&replays[k]);
    return code;
}

static int work(void *context)
{
    struct request *request = context;
    struct results r;
    stance_message message = {""};
    int code = EXIT_IO;
    if (results_open(&r, request->file, &message)) {
        if (!r.single && asked_cases(request) == 0)
            code = command_usage(&command_replay, "--case N or --near NAME=VALUE,... says which");
        else
            code = replay(request, &request->look, &r, &message);
        results_close(&r);
    }
    if (message.text[0])
        fprintf(stderr, "%s\n", message.text);
    if (code == EXIT_DONE && !look_end(&request->look, &command_replay, request->file))
        code = EXIT_USAGE;
    return code;
}

static int run(int argc, char **argv)
{
    struct request request = {.file = NULL};
    struct look *const look = &request.look;
    look_begin(look);
    const int code = command_begin(&command_replay, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    if (asked_cases(&request) > MOST_CASES)
        return command_usage(&command_replay, "two cases at the most");
    if (is_animated(look)) {
        if (!look->formatted && !look->file && !look->directory)
            look->format[LOOK_PNG] = look->format[LOOK_PDF] = false;
        if (look->format[LOOK_PNG] || look->format[LOOK_PDF])
            return command_usage(&command_replay, "an animation is svg or gif");
    }
    return sandbox(work, &request, request.file);
}

static bool read_case(const char *text, void *cases)
{
    struct numbers *const n = cases;
    char *end;
    n->number[n->count++] = strtoull(text, &end, 10);
    return text[0] >= '0' && text[0] <= '9' && !*end && errno == 0;
}

#define TO(member) OPTION_TO(struct request, member)
static const struct option options[] = {
    {"FILE", TO(file), .low = 1, .text = "a results file"},
    {"--case", "N", TO(cases), .most = MOST_CASES, .read = read_case,
     .takes = "the number of a case",
     .text = "the case with this flat index; of a file of one case that one"},
    {"--near", "NAME=VALUE,...", TO(nears), .most = MOST_CASES,
     .text = "the case nearest to these values: initial.offset.theta=0.02, or theta=0.02 where no "
             "other path ends so; paths that move along an axis are names, too. Offsets that are "
             "not named are those of the equilibrium, all else has its first value"},
    {"--set", "PATH=VALUE", TO(sets), .most = MOST_SETS,
     .text = "with a value of the scenario replaced, as `run` has it; may be repeated"},
    {OPTION_TRUST(struct request, trust)},
    {.at = offsetof(struct request, look), .rows = look_options},
    {0},
};

const struct command command_replay = {
    "replay",
    "one case of a results file again, drawn: curves, stick figures, animation",
    run,
    options,
    "Computes a case again, from the scenario inside the file, and draws its coordinates, forces, "
    "torques and gaps against time, its stick figures, and of what steps its angles against their "
    "rates: NAME-caseN-coordinates ... beside the file. Two cases are overlaid, the second dashed, "
    "its stick figures grey. -o FILE.gif: an "
    "animation in real time instead; --picture animation draws it as SVG, for browsers.",
    NULL,
};
