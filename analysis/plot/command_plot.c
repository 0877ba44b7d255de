/* command_plot.c - `stance plot FILE`: chooses the pictures that a file calls for. */
#include "analysis/draw/plot.h"
#include "analysis/sensitivity/sensitivity_study.h"
#include "runner/base/command.h"
#include "runner/base/sandbox.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_plot; /* below */

/* The directory of a file, or "." */
static void directory_of(const char *file, char *directory, size_t size)
{
    const char *slash = strrchr(file, '/');
    if (!slash)
        snprintf(directory, size, ".");
    else
        snprintf(directory, size, "%.*s", slash == file ? 1 : (int)(slash - file), file);
}

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
    if (r->single) {
        fprintf(stderr,
                "%s: holds one case without a trajectory; run its scenario with "
                "`--set record.cases=all --set record.every=0.01`, or with `--only %llu --trace`\n",
                r->file, (unsigned long long)index);
    } else {
        fprintf(stderr,
                "%s: has no trajectory of case %llu; `stance run SCENARIO --only %llu --trace` "
                "records one\n",
                r->file, (unsigned long long)index, (unsigned long long)index);
    }
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
    if (!plot_case(&own, place, index, &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    return EXIT_DONE;
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
        code = sensitivity_picture(&study, plot->directory, stem, &message) ? EXIT_DONE : EXIT_IO;
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

struct request {
    const char *file, *directory, *index, *answer, *of;
};

static int draw(void *context)
{
    const struct request *request = context;
    const char *directory = request->directory, *index_text = request->index;
    struct results r;
    stance_message message = {""};
    char own_directory[1024];
    uint64_t index = 0;
    int code;

    if (index_text && !parse_index(index_text, &index)) {
        fprintf(stderr, "stance plot: --case takes the number of a case, not '%s'\n", index_text);
        return EXIT_USAGE;
    }
    if (!results_open(&r, request->file, &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    if (!directory) {
        directory_of(request->file, own_directory, sizeof own_directory);
        directory = own_directory;
    }
    const struct plot plot = {&r, directory, r.name};
    if (!gnuplot_directory(directory)) {
        code = EXIT_IO;
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
    return code;
}

static int run(int argc, char **argv)
{
    const char *file = NULL, *directory = NULL, *index = NULL, *answer = NULL, *of = NULL;
    size_t given[4] = {0}, operands = 0;
    bool help = false;
    const struct option_spec specs[] = {
        {"-o", true, &directory, 1, &given[0]},
        {"--case", true, &index, 1, &given[1]},
        {"--answer", true, &answer, 1, &given[2]},
        {"--of", true, &of, 1, &given[3]},
    };

    if (!command_options(&command_plot, argc, argv, specs, sizeof specs / sizeof specs[0], &file, 1,
                         &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (operands == 0 || (directory && !directory[0])) {
        fprintf(stderr, "stance plot: %s is needed (stance plot -h explains)\n",
                operands == 0 ? "a results file" : "a directory");
        return EXIT_USAGE;
    }
    if ((index && answer) || (of && !answer)) {
        fprintf(stderr, "stance plot: %s\n",
                of && !answer ? "--of belongs to --answer" : "--case or --answer, not both");
        return EXIT_USAGE;
    }
    struct request request = {file, directory, index, answer, of};
    return sandbox(draw, &request, file);
}

const struct command command_plot = {
    "plot",
    "plot FILE [-o DIR] [--case N | --answer A [--of OUTCOME]]",
    "pictures (SVG and PNG)",
    run,
    "Draws with gnuplot what the file calls for, into DIR (made when missing; default: where the\n"
    "file is), and prints the path of every file written.\n"
    "\n"
#define HELP(name, help) help
    PLOT_PICTURES(HELP)
#undef HELP
        "  sampled factors     NAME-sensitivity: which factor decides (stance sensitivity -h)\n"
        "  one case with a     NAME-coordinates, -forces, -torques, -gaps against time, and "
        "-strip:\n"
        "  trajectory          stick figures; of a sweep: --case N, its files NAME-caseN-...\n"
        "\n"
        "  -o DIR         where the pictures go\n"
        "  STANCE_SCRIPTS=DIR in the environment keeps each picture's gnuplot script and data\n"
        "  --case N       the trajectory of case N (flat index) instead of the sweep\n"
        "  --answer A     NAME-A instead: the answer A (friction_used, fall_time or another "
        "number) of "
        "every\n"
        "                 case, as a map or along the one axis; sampled factors: "
        "NAME-A-sensitivity\n"
        "  --of OUTCOME   only of the cases that were stabilised, rested, fell or stayed "
        "undecided\n",
};
