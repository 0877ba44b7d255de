/* command_plot.c - `stance plot FILE`: chooses the pictures that a file calls for. */
#include "plot_case.h"

#include "analysis/optimise/search_study.h"
#include "analysis/sensitivity/sensitivity_study.h"
#include "runner/base/problem.h"
#include "runner/base/sandbox.h"
#include "runner/store/search_file.h"

#include <stdlib.h>

extern const struct command command_plot; /* below */

/* Each draws, and returns an exit code; why it failed is put into the message, or has been said. */

/* ---- one case ----------------------------------------------------------------------------- */

static int draw_case(const struct plot *plot, uint64_t index, bool given)
{
    stance_message *const message = plot->message;
    const struct results *r = plot->r;
    const unsigned long long number = index;
    uint64_t *list;
    size_t count, place = 0;
    char stem[400];

    if (!r->single && index >= r->cases) {
        complain(message, "%.150s: has no case %llu: the last is %llu", r->file, number,
                 (unsigned long long)r->cases - 1);
        return EXIT_USAGE;
    }
    if (!results_recorded(r, &list, &count, message))
        return EXIT_IO;
    while (place < count && list[place] != index)
        place++;
    free(list);
    if (place == count) {
        fprintf(stderr,
                "%s: has no trajectory of case %llu; `stance replay %s --case %llu` computes it\n",
                r->file, number, r->file, number);
        return EXIT_USAGE;
    }
    if (r->kind[r->single ? 0 : index] == RESULTS_PENDING) {
        complain(message, "%.150s: case %llu has not been computed yet", r->file, number);
        return EXIT_USAGE;
    }
    struct plot own = *plot;
    snprintf(stem, sizeof stem, "%.300s-case%llu", plot->stem, number);
    own.stem = given && !r->single ? stem : plot->stem;
    struct plot_case c;
    if (!plot_case_load(&c, &own, place, index))
        return EXIT_IO;
    const bool good = plot_case(&c);
    plot_case_free(&c);
    return good ? EXIT_DONE : EXIT_IO;
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
    int code = sensitivity_study_make(&study, plot->r, &request, plot->message);
    if (code == EXIT_DONE) {
        code = sensitivity_picture(&study, plot) ? EXIT_DONE : EXIT_IO;
        sensitivity_study_free(&study);
    }
    if (code == EXIT_USAGE)
        fprintf(stderr, "%s\n", plot->message->text);
    return code == EXIT_USAGE ? EXIT_DONE : code;
}

/* ---- a sweep ------------------------------------------------------------------------------ */

static bool (*const pictures[])(const struct plot *) = {
#define PICTURE(name, help) plot_##name,
    PLOT_PICTURES(PICTURE)
#undef PICTURE
};

static int draw_sweep(const struct plot *plot)
{
    const struct results *r = plot->r;
    uint64_t *list;
    size_t count;

    for (size_t k = 0; k < sizeof pictures / sizeof pictures[0]; k++)
        if (!pictures[k](plot))
            return EXIT_IO;
    if (!results_recorded(r, &list, &count, plot->message))
        return EXIT_IO;
    if (count > 0)
        fprintf(stderr, "trajectories of %zu case%s are recorded: --case %llu draws %s\n", count,
                count == 1 ? "" : "s", (unsigned long long)list[0],
                count == 1 ? "it" : "the first");
    free(list);
    return sensitivity_study_fits(r) ? draw_sensitivity(plot, NULL) : EXIT_DONE;
}

static int draw_answer(const struct plot *plot, const char *name, enum results_kind of)
{
    struct plot_answer answer;
    plot_answer_find(name, &answer);
    answer.of = of;
    if (plot->r->single) {
        complain(plot->message, "%.150s: holds one case; stance summary prints its numbers",
                 plot->r->file);
        return EXIT_USAGE;
    }
    if (sensitivity_study_fits(plot->r))
        return draw_sensitivity(plot, &answer);
    return (plot->r->axes < 2 ? plot_answer_curve : plot_answer_map)(plot, &answer) ? EXIT_DONE
                                                                                    : EXIT_IO;
}

/* ---- the command -------------------------------------------------------------------------- */

enum { MOST_FILES = 12 };

struct request {
    struct option_texts files, sets;
    uint64_t index; /* of a case; OPTION_NONE: not asked for */
    const char *answer;
    enum results_kind of;
    bool outline, allowed, model;
    struct look look;
};

/* The outlines of all files. */
static int draw_outlines(const struct request *request, const struct plot *first)
{
    static struct results r[MOST_FILES]; /* large; the process has but one command */
    struct plot plots[MOST_FILES] = {*first};
    size_t opened = 1;
    bool good = true;
    while (good && opened < request->files.count) {
        plots[opened] = *first;
        plots[opened].r = &r[opened];
        good = results_open(&r[opened], request->files.text[opened], first->message);
        opened += good;
    }
    good = good && plot_outline(plots, (int)request->files.count, request->of);
    while (opened > 1)
        results_close(&r[--opened]);
    return good ? EXIT_DONE : EXIT_IO;
}

/* Of a results file. */
static int draw_results(struct request *request, stance_message *message)
{
    const bool indexed = request->index != OPTION_NONE;
    struct results r;
    char own_directory[1024];
    int code = EXIT_IO;

    if (!results_open(&r, request->files.text[0], message))
        return EXIT_IO;
    const char *const directory =
        look_directory(&request->look, request->files.text[0], own_directory, sizeof own_directory);
    const struct plot plot = {
        &r, NULL, directory, r.name, &request->look, message, request->allowed};
    if (request->allowed && !request->outline && (r.single || r.sample >= 0 || r.axes < 2)) {
        complain(message, "%.150s: has no map: --allowed belongs to maps over two starts", r.file);
        code = EXIT_USAGE;
    } else if (gnuplot_directory(directory)) {
        code = request->outline      ? draw_outlines(request, &plot)
               : request->answer     ? draw_answer(&plot, request->answer, request->of)
               : indexed || r.single ? draw_case(&plot, indexed ? request->index : r.index, indexed)
                                     : draw_sweep(&plot);
    }
    results_close(&r);
    return code;
}

static int draw(void *context)
{
    struct request *request = context;
    const struct option_texts *const files = &request->files;
    const bool search = search_file_is(files->text[0]);
    stance_message message = {""};
    if (search && (request->index != OPTION_NONE || request->answer || request->outline))
        return command_usage(&command_plot, "a search has no cases: none of --case, --answer and "
                                            "--outline; its best scenario, once it is run, has");
    if (!search && files->count > 1 && !request->outline)
        return command_usage(&command_plot, "several files are drawn in one frame by --outline");
    const int code = search ? search_draw(&request->look, files->text, files->count)
                            : draw_results(request, &message);
    if (code != EXIT_DONE && message.text[0])
        fprintf(stderr, "%s\n", message.text);
    return code == EXIT_DONE && !look_end(&request->look, &command_plot, files->text[0])
               ? EXIT_USAGE
               : code;
}

static int run(int argc, char **argv)
{
    struct request request = {.index = OPTION_NONE, .of = RESULTS_KIND_COUNT};
    char names[1000];
    look_begin(&request.look);
    const int code = command_begin(&command_plot, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    const struct option_texts *const files = &request.files;
    if (request.model && files->count > 1)
        return command_usage(&command_plot, "--model takes one scenario");
    if (request.look.format[LOOK_GIF])
        return command_usage(&command_plot,
                             "stance replay draws animations; pictures are svg, png or pdf");
    if (request.model)
        return plot_model(&command_plot, files->text[0], &request.sets, &request.look);
    return sandbox(draw, &request,
                   word_list(names, sizeof names, (const char *const *)files->text, files->count));
}

#define TO(member) OPTION_TO(struct request, member)
static const struct option options[] = {
    {"FILE...", TO(files), .low = 1, .high = MOST_FILES, .text = "a results file"},
    {.text =
#define HELP(name, help) help
         PLOT_PICTURES(HELP) SEARCH_PICTURES
#undef HELP
     "  sampled factors     NAME-sensitivity: which factor decides (stance sensitivity -h)\n"
     "  one case with a     NAME-coordinates, -forces, -torques, -gaps against time, and -strip:\n"
     "  trajectory          stick figures; of a sweep: --case N, its files NAME-caseN-...\n"
     "  ... that steps      NAME-phase: each angle against its rate, legs that are alike in one\n"
     "                      panel; a gait closes, after two steps at the latest where it repeats\n"
     "                      after one. NAME-strip of one that walks at its end: its last two\n"
     "                      steps over forces and torques"},
    {"--outline", TO(outline),
     .text = "NAME-outline instead: where cases were stabilised, a line for each of up to 12 "
             "files and each value of their other axes, in one frame with a legend"},
    {"--answer", "A", TO(answer), .word = plot_answer_word, .without = "--outline",
     .text = "NAME-A instead: the answer A (friction_used, fall_time or another number) of every "
             "case, as a map or along the one axis; sampled factors: NAME-A-sensitivity"},
    {"--case", "N", TO(index), .takes = "the number of a case", .without = "--outline --answer",
     .text = "the trajectory of case N (flat index) instead of the sweep"},
    {"--of", "OUTCOME", TO(of), .word = results_outcome_word, .needs = "--answer or --outline",
     .text = "only of the cases that were stabilised, walk, rested, fell or stayed undecided"},
    {"--allowed", TO(allowed), .without = "--case",
     .text = "in maps and outlines over two starts, too: the line within which linear theory "
             "allows some controller to recover with these torques, while the contacts stand "
             "(stance basin -h), of each panel's own design and limits"},
    {"--model", TO(model), .without = "--outline --answer --case --allowed",
     .text = "of a scenario instead of a results file: NAME-model, the robot where its first case "
             "begins, with coordinates and their signs, actuators, contacts; into this directory"},
    {"--set", "PATH=VALUE", TO(sets), .needs = "--model",
     .text = "replace a value of that scenario; may be repeated"},
    {.at = offsetof(struct request, look), .rows = look_options},
    {0},
};

const struct command command_plot = {
    "plot",
    "pictures (SVG, PNG, PDF)",
    run,
    options,
    "Draws with gnuplot what the file calls for, beside the file or where -o says, and prints the "
    "path of every file written.\n\n",
    NULL,
};
