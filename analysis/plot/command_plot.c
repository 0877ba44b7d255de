/* command_plot.c - `stance plot FILE`: chooses the pictures that a file calls for. */
#include "plot_case.h"
#include "plot_model.h"

#include "analysis/optimise/search_pictures.h"
#include "analysis/sensitivity/sensitivity_study.h"
#include "runner/base/command.h"
#include "runner/base/sandbox.h"
#include "runner/store/search_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_plot; /* below */

static bool parse_index(const char *text, uint64_t *index)
{
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    *index = value;
    return text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0;
}

/* ---- one case ----------------------------------------------------------------------------- */

/* Says how a trajectory comes about. */
static void explain_recording(const struct results *r, uint64_t index)
{
    fprintf(stderr,
            "%s: has no trajectory of case %llu; `stance replay %s --case %llu` computes it\n",
            r->file, (unsigned long long)index, r->file, (unsigned long long)index);
}

static int draw_case(const struct plot *plot, uint64_t index, bool given)
{
    const struct results *r = plot->r;
    uint64_t *list;
    size_t count, place = 0;
    stance_message message = {""};
    char stem[400];

    if (!r->single && index >= r->cases) {
        fprintf(stderr, "%s: has no case %llu: the last is %llu\n", r->file,
                (unsigned long long)index, (unsigned long long)r->cases - 1);
        return EXIT_USAGE;
    }
    if (!results_recorded(r, &list, &count, &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    while (place < count && list[place] != index)
        place++;
    free(list);
    if (place == count) {
        explain_recording(r, index);
        return EXIT_USAGE;
    }
    if (r->kind[r->single ? 0 : index] == RESULTS_PENDING) {
        fprintf(stderr, "%s: case %llu has not been computed yet\n", r->file,
                (unsigned long long)index);
        return EXIT_USAGE;
    }
    struct plot own = *plot;
    snprintf(stem, sizeof stem, "%.300s-case%llu", plot->stem, (unsigned long long)index);
    own.stem = given && !r->single ? stem : plot->stem;
    struct plot_case c;
    bool good = plot_case_load(&c, &own, place, index, &message);
    if (good) {
        good = plot_case(&c, &message);
        plot_case_free(&c);
    }
    if (!good)
        fprintf(stderr, "%s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}

/* ---- a sweep ------------------------------------------------------------------------------ */

static bool (*const pictures[])(const struct plot *, stance_message *) = {
#define PICTURE(name, help) plot_##name,
    PLOT_PICTURES(PICTURE)
#undef PICTURE
};

static int draw_sweep(const struct plot *plot)
{
    const struct results *r = plot->r;
    uint64_t *list;
    size_t count;
    stance_message message = {""};

    bool good = true;
    for (size_t k = 0; good && k < sizeof pictures / sizeof pictures[0]; k++)
        good = pictures[k](plot, &message);
    good = good && results_recorded(r, &list, &count, &message);
    if (!good) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    if (count > 0) {
        fprintf(stderr, "trajectories of %zu case%s are recorded: --case %llu draws %s\n", count,
                count == 1 ? "" : "s", (unsigned long long)list[0],
                count == 1 ? "it" : "the first");
    }
    free(list);
    return EXIT_DONE;
}

/* ---- a sampled study ---------------------------------------------------------------------- */

/* The picture for which `stance sensitivity` has options; what a file is too short for is said.
 * answer NULL: of the share of cases that end well. */
static int draw_sensitivity(const struct plot *plot, const struct plot_answer *answer)
{
    const struct sensitivity_request request = {
        .answer = answer ? answer->name : NULL,
        .unit = answer ? answer->unit : "",
        .of = answer ? answer->of : RESULTS_KIND_COUNT,
        .bootstrap = SENSITIVITY_BOOTSTRAP,
    };
    struct sensitivity_study study;
    stance_message message = {""};
    char stem[400];
    int code = sensitivity_study_make(&study, plot->r, &request, &message);
    if (code == EXIT_DONE) {
        snprintf(stem, sizeof stem, "%.300s%s%s-sensitivity", plot->stem, answer ? "-" : "",
                 answer ? answer->name : "");
        code = sensitivity_picture(&study, plot->look, plot->directory, stem, &message) ? EXIT_DONE
                                                                                        : EXIT_IO;
        sensitivity_study_free(&study);
    }
    if (code != EXIT_DONE)
        fprintf(stderr, "%s\n", message.text);
    return code == EXIT_USAGE ? EXIT_DONE : code;
}

/* ---- an answer ---------------------------------------------------------------------------- */

/* What --answer and --of ask for; false with a message when there is no such. */
static bool choose_answer(const char *name, const char *of, struct plot_answer *answer)
{
    if (!plot_answer_find(&command_plot, name, answer))
        return false;
    if (of)
        answer->of = command_word(&command_plot, "--of", of, results_kind_names, RESULTS_OUTCOMES);
    return !of || answer->of < RESULTS_OUTCOMES;
}

static int draw_answer(const struct plot *plot, const char *name, const char *of)
{
    struct plot_answer answer;
    stance_message message = {""};
    if (!choose_answer(name, of, &answer))
        return EXIT_USAGE;
    if (plot->r->single) {
        fprintf(stderr, "%s: holds one case; stance summary prints its numbers\n", plot->r->file);
        return EXIT_USAGE;
    }
    if (sensitivity_study_fits(plot->r))
        return draw_sensitivity(plot, &answer);
    if (!(plot->r->axes < 2 ? plot_answer_curve(plot, &answer, &message)
                            : plot_answer_map(plot, &answer, &message))) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    return EXIT_DONE;
}

/* ---- the command -------------------------------------------------------------------------- */

enum { MOST_FILES = 12 };

struct request {
    const char *file[MOST_FILES], *index, *answer, *of;
    size_t files, outline, allowed;
    struct look look;
};

/* The outlines of all files. */
static int draw_outlines(struct request *request, const struct plot *first)
{
    static struct results r[MOST_FILES]; /* large; the process has but one command */
    struct plot plots[MOST_FILES] = {*first};
    stance_message message = {""};
    size_t opened = 1;
    enum results_kind of = RESULTS_KIND_COUNT;
    if (request->of) {
        of = command_word(&command_plot, "--of", request->of, results_kind_names, RESULTS_OUTCOMES);
        if (of == RESULTS_OUTCOMES)
            return EXIT_USAGE;
    }
    bool good = true;
    while (good && opened < request->files) {
        good = results_open(&r[opened], request->file[opened], &message);
        if (good) {
            plots[opened] = *first;
            plots[opened].r = &r[opened];
            opened++;
        }
    }
    good = good && plot_outline(plots, (int)request->files, of, &message);
    while (opened > 1)
        results_close(&r[--opened]);
    if (!good)
        fprintf(stderr, "%s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}

/* Of the file of a search. */
static int draw_search(struct request *request)
{
    if (request->index || request->answer || request->outline)
        return command_usage(&command_plot, "a search has no cases: none of --case, --answer and "
                                            "--outline; its best scenario, once it is run, has");
    const int code = search_draw(&request->look, request->file, request->files);
    return code == EXIT_DONE && !look_end(&request->look, &command_plot, request->file[0])
               ? EXIT_USAGE
               : code;
}

static int draw(void *context)
{
    struct request *request = context;
    const char *index_text = request->index;
    struct results r;
    stance_message message = {""};
    char own_directory[1024];
    uint64_t index = 0;
    int code;

    if (index_text && !parse_index(index_text, &index)) {
        fprintf(stderr, "stance plot: --case takes the number of a case, not '%s'\n", index_text);
        return EXIT_USAGE;
    }
    if (search_file_is(request->file[0]))
        return draw_search(request);
    if (request->files > 1 && !request->outline)
        return command_usage(&command_plot, "several files are drawn in one frame by --outline");
    if (!results_open(&r, request->file[0], &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    const char *const directory =
        look_directory(&request->look, request->file[0], own_directory, sizeof own_directory);
    const struct plot plot = {&r, directory, r.name, &request->look, request->allowed > 0};
    if (request->allowed && !request->outline && (r.single || r.sample >= 0 || r.axes < 2)) {
        fprintf(stderr, "%s: has no map: --allowed belongs to maps over two starts\n", r.file);
        code = EXIT_USAGE;
    } else if (!gnuplot_directory(directory)) {
        code = EXIT_IO;
    } else if (request->outline) {
        code = draw_outlines(request, &plot);
    } else if (request->answer) {
        code = draw_answer(&plot, request->answer, request->of);
    } else if (index_text || r.single) {
        code = draw_case(&plot, index_text ? index : r.index, index_text != NULL);
    } else {
        code = draw_sweep(&plot);
        if (code == EXIT_DONE && sensitivity_study_fits(&r))
            code = draw_sensitivity(&plot, NULL);
    }
    results_close(&r);
    if (code == EXIT_DONE && !look_end(&request->look, &command_plot, request->file[0]))
        code = EXIT_USAGE;
    return code;
}

/* The names of all files, for messages. */
static const char *files_text(const struct request *request, char *text, size_t size)
{
    size_t used = 0;
    for (size_t f = 0; f < request->files && used < size; f++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", f ? ", " : "", request->file[f]);
    return text;
}

static int run(int argc, char **argv)
{
    struct request request = {0};
    struct look_options options = {0};
    enum { MAX_SETS = 64 };
    const char *sets[MAX_SETS];
    size_t given[3] = {0}, model = 0, set_count = 0;
    const struct option_spec specs[] = {
        {"--case", true, &request.index, 1, &given[0]},
        {"--answer", true, &request.answer, 1, &given[1]},
        {"--of", true, &request.of, 1, &given[2]},
        {"--outline", false, NULL, 0, &request.outline},
        {"--allowed", false, NULL, 0, &request.allowed},
        {"--model", false, NULL, 0, &model},
        {"--set", true, sets, MAX_SETS, &set_count},
        LOOK_SPECS(options),
    };
    char text[1000];
    const int begun =
        command_begin(&command_plot, argc, argv, specs, sizeof specs / sizeof specs[0],
                      "a results file", request.file, 1, MOST_FILES, &request.files);
    if (begun != COMMAND_GOES_ON)
        return begun;
    if (!look_read(&command_plot, &options, &request.look))
        return EXIT_USAGE;
    if (set_count > 0 && model == 0)
        return command_usage(&command_plot, "--set belongs to --model");
    if (model > 0 && (request.index || request.answer || request.outline || request.allowed ||
                      request.files > 1))
        return command_usage(&command_plot, "--model takes one scenario, and none of --case, "
                                            "--answer, --outline and --allowed");
    if (request.allowed && request.index)
        return command_usage(&command_plot, "--allowed belongs to maps, not to --case");
    if (request.look.format[LOOK_GIF])
        return command_usage(&command_plot,
                             "stance replay draws animations; pictures are svg, png or pdf");
    if (!!request.index + !!request.answer + (request.outline > 0) > 1)
        return command_usage(&command_plot, "one of --case, --answer and --outline");
    if (request.of && !request.answer && !request.outline)
        return command_usage(&command_plot, "--of belongs to --answer or --outline");
    if (model > 0)
        return plot_model(request.file[0], sets, set_count, &request.look);
    return sandbox(draw, &request, files_text(&request, text, sizeof text));
}

const struct command command_plot = {
    "plot",
    "plot FILE... [--outline [--of OUTCOME] | --answer A [--of OUTCOME] | --case N]\n"
    "           [--allowed] [-o PLACE] [--format F,...]\n"
    "           [--picture P] [--for column|page] [--size W[xH]] [--font NAME[,PT]]\n"
    "           [--title TEXT] [--labels NAME=TEXT]... [--colours NAME=#rrggbb|grey]...\n"
    "       stance plot --model SCENARIO [--set PATH=VALUE]... [-o PLACE] [--format F,...]",
    "pictures (SVG, PNG, PDF)",
    run,
    "Draws with gnuplot what the file calls for, beside the file or where -o says, and prints the\n"
    "path of every file written.\n"
    "\n"
#define HELP(name, help) help
    PLOT_PICTURES(HELP) SEARCH_PICTURES(HELP) SEARCH_FRONT_HELP
#undef HELP
    "  sampled factors     NAME-sensitivity: which factor decides (stance sensitivity -h)\n"
    "  one case with a     NAME-coordinates, -forces, -torques, -gaps against time, and "
    "-strip:\n"
    "  trajectory          stick figures; of a sweep: --case N, its files NAME-caseN-...\n"
    "\n"
    "  --outline      NAME-outline instead: where cases were stabilised, a line for each of up "
    "to\n"
    "                 12 files and each value of their other axes, in one frame with a legend\n"
    "  --allowed      in maps and outlines over two starts, too: the line within which linear\n"
    "                 theory allows some controller to recover with these torques, while the\n"
    "                 contacts stand (stance basin -h), of each panel's own design and limits\n"
    "  --model        of a scenario: NAME-model, the robot where its first case begins, with\n"
    "                 coordinates and their signs, actuators, contacts; into this directory\n"
    "  --set          replaces a value of that scenario\n"
    "  --case N       the trajectory of case N (flat index) instead of the sweep\n"
    "  --answer A     NAME-A instead: the answer A (friction_used, fall_time or another "
    "number) of "
    "every\n"
    "                 case, as a map or along the one axis; sampled factors: "
    "NAME-A-sensitivity\n"
    "  --of OUTCOME   only of the cases that were stabilised, rested, fell or stayed "
    "undecided\n" LOOK_HELP,
};
