/* command_basin.c - `stance basin FILE`: how large the basin is, how sure that is, and what its
 * boundary looks like; as text, JSON or CSV. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_basin; /* below */

enum { MOST_SIDE = 1000 };

struct request {
    struct report report;
    struct option_texts of, by, within;
    bool boundary, allowed;
    uint64_t descents;                 /* of rays */
    double threshold;                  /* 0: none */
    const char *along, *lost, *answer; /* paths, an answer; NULL: not asked for */
    char within_text[256];
    struct basin_choice choice;
};

static int show_rays(const struct report *report, const struct results *r,
                     struct basin_sample *sample, stance_message *message)
{
    const struct request *request = (const struct request *)report;
    struct basin_rays rays;
    const char *wrong = request->choice.by_count > 0  ? "--by: there is a row for every parameter"
                        : request->choice.weights > 0 ? "--weight: their ranges weigh the offsets"
                        : request->choice.rank > 0    ? "--rank: what they sample are directions"
                        : request->threshold > 0      ? "--threshold: they have no share"
                        : request->answer             ? "--answer: they have no cases inside"
                        : request->allowed            ? "--allowed: they have no share"
                                                      : NULL;
    if (wrong) {
        basin_sample_free(sample);
        return refuse(message, "stance basin: rays have no use for %s", wrong);
    }
    if (!basin_rays_make(&rays, r, request->choice.of, sample, message))
        return EXIT_IO;
    int code =
        report_code(!request->descents || basin_rays_descend(&rays, request->descents, message));
    if (code == EXIT_DONE)
        code = request->boundary ? report_code(basin_rays_print_boundary(&rays))
                                 : basin_rays_print(&rays, report->form);
    basin_rays_free(&rays);
    return code;
}

static int show_basin(const struct report *report, const struct results *r,
                      struct basin_sample *sample, stance_message *message)
{
    const struct request *request = (const struct request *)report;
    const enum table_form form = report->form;
    struct basin basin;
    bool usage;
    int code;

    if (request->descents > 0) {
        basin_sample_free(sample);
        return refuse(
            message,
            "stance basin: --descend goes on from rays, and %.150s has none (stance basin -h)",
            report->file);
    }
    if (!basin_make(&basin, r, &request->choice, sample, &usage, message))
        return usage ? EXIT_USAGE : EXIT_IO;
    if (request->threshold > 0)
        code = basin_print_threshold(&basin, request->along, request->threshold, form, message);
    else if (request->allowed)
        code = basin_print_allowed(&basin, form, message);
    else if (request->answer)
        code = basin_print_answer(&basin, request->answer, form, message);
    else if (request->boundary && basin.sampled)
        code = refuse(message,
                      "stance basin: --boundary needs starts on a grid; those of %.150s are a "
                      "sample",
                      report->file);
    else
        code = report_code(request->boundary ? basin_print_boundary(&basin)
                                             : basin_print(&basin, form));
    basin_free(&basin);
    return code;
}

/* On a copy of what became of the cases, of which --within may leave less. */
static int work(struct report *report, const struct results *r, stance_message *message)
{
    struct request *request = (struct request *)report;
    struct basin_choice *const choice = &request->choice;
    struct basin_sample sample;
    struct results own;

    if (choice->of == RESULTS_KIND_COUNT)
        choice->of = statistics_judged(r);
    int code =
        basin_within_make(&own, r, &(struct basin_within){"basin", &request->within, choice->of},
                          request->within_text, sizeof request->within_text, message);
    choice->within = request->within_text[0] ? request->within_text : NULL;
    if (code == EXIT_DONE && request->lost)
        code = basin_print_loss(&own, request->lost, choice->of, report->form, message);
    else if (code == EXIT_DONE)
        code = !basin_sample_make(&sample, &own, message) ? EXIT_IO
               : basin_is_rays(&own, &sample) ? show_rays(report, &own, &sample, message)
                                              : show_basin(report, &own, &sample, message);
    free(own.kind);
    return code;
}

/* "PATH=SIZE" */
static bool read_weight(const char *text, void *request)
{
    struct basin_choice *const choice = request;
    struct basin_weight *const weight = &choice->weight[choice->weights++];
    const char *const equals = strchr(text, '=');
    char *end;
    snprintf(weight->path, sizeof weight->path, "%.*s", equals ? (int)(equals - text) : 0, text);
    weight->size = equals ? strtod(equals + 1, &end) : 0;
    return equals && !*end && weight->size > 0 && isfinite(weight->size);
}

/* What --of names: the path (with --threshold), or the outcome; false: neither, as is said. */
static bool take_of(struct request *request)
{
    for (size_t k = 0; k < request->of.count; k++) {
        const char *const of = request->of.text[k];
        bool is_path = request->threshold > 0;
        for (int i = 0; i < RESULTS_OUTCOMES; i++)
            is_path = is_path && strcmp(of, results_kind_names[i]) != 0;
        if (is_path || strchr(of, '.')) {
            request->along = of;
            continue;
        }
        request->choice.of =
            command_word(&command_basin, "--of", of, results_kind_names, RESULTS_OUTCOMES);
        if (request->choice.of == RESULTS_OUTCOMES)
            return false;
    }
    return true;
}

static int run(int argc, char **argv)
{
    struct request request = {
        .report = {.command = &command_basin, .work = work},
        .choice = {.of = RESULTS_KIND_COUNT, .side = 5, .level = 0.95},
    };
    const int code = command_begin(&command_basin, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    request.choice.by = request.by.text;
    request.choice.by_count = request.by.count;
    if (!take_of(&request))
        return EXIT_USAGE;
    const char *const wrong =
        request.threshold > 0 && !request.along
            ? "--threshold needs --of PATH, along which it is crossed"
        : !(request.threshold > 0) && request.along
            ? "--of PATH goes with --threshold; else it names an outcome"
        : request.threshold == 1
            ? "--threshold 1 is where it begins; --lost PATH has the first start that is lost"
            : NULL;
    return wrong ? command_usage(&command_basin, wrong) : report_run(&request.report);
}

static const struct say_key keys[] = {
    {NULL, "", basin_keys},
    {NULL, "of --threshold:", basin_threshold_keys},
    {NULL, "of --lost:", basin_loss_keys},
    {NULL, "of --allowed:", basin_allowed_keys},
    {NULL, "of --answer:", basin_answer_keys},
    {NULL, "and of rays:", basin_rays_keys},
    {0},
};

#define TO(member) OPTION_TO(struct request, member)
#define QUESTIONS "--threshold --lost --rank --answer --allowed --descend --boundary"
static const struct option options[] = {
    {REPORT_FILE},
    {"--by", "PATH", TO(by), .most = SCENARIO_MAX_AXES,
     .text = "a row for each value of this parameter alone; may be repeated; an axis of starts "
             "named here is a parameter"},
    {"--of", "OUTCOME", TO(of), .most = 2,
     .text = "stabilised (default; or walks, where any does, or rested, where nothing else was), "
             "walks, "
             "rested, fell or undecided"},
    {"--within", "ANSWER=BOUND", TO(within), .most = 8,
     .text = "counts as the outcome only where the number is at most BOUND, in all of the above: "
             "settle_time=2 is the domain of stability within 2 s; with BOUND LEAST.. at least "
             "that (least_normal_force=5..), with LEAST..MOST between them; may be repeated"},
    {"--level", "L", TO(choice.level), .low = 0.5, .high = 0.999999,
     .text = "of likely errors and intervals, default 0.95"},
    {"--box", "N", TO(choice.side), .low = 2, .high = MOST_SIDE,
     .text = "cases along each start in the boxes of basin entropy, default 5"},
    {"--weight", "PATH=SIZE", TO(choice), .most = BASIN_WEIGHTS, .read = read_weight,
     .takes = "PATH=SIZE with a positive SIZE, as initial.offset.theta=0.01",
     .text = "distances count this start in units of SIZE; may be repeated"},
    {.text = "Single questions, each with --json and --csv, too:"},
    {"--threshold", "T", TO(threshold), .low = 1e-6, .high = 1e6, .without = QUESTIONS,
     .needs = "--of",
     .text = "with --of PATH: where along this parameter the share, linear between values, first "
             "falls below T times what it is at the first value (T above 1: rises above), with "
             "an interval at the level L (Fieller's)"},
    {"--lost", "PATH", TO(lost), .without = QUESTIONS,
     .text = "how many of the starts that have the outcome at the end of this parameter where more "
             "have it (PATH=VALUE: at that end) lose it first at each value, and one of the first"},
    {"--rank", "N", TO(choice.rank), .low = 1, .high = 1e9, .without = QUESTIONS,
     .text = "of a sample of parameters, the N points with the largest volumes, each with its "
             "values, share and bounds"},
    {"--answer", "A", TO(answer), .without = QUESTIONS,
     .text = "smallest, median, 90 and 99 %, and largest of a stored number (settle_time, "
             "peak_torque ...) over the starts with the outcome, and in which case"},
    {"--allowed", TO(allowed), .without = QUESTIONS,
     .text = "the share of starts from which linear theory allows some controller to recover with "
             "these torques while the contacts stand, as if glued; of these the share with the "
             "outcome; and the share of starts with it outside of that set, which a robot far "
             "from where it is linear may reach: how many of those slipped (by more than 1e-6 m), "
             "lifted a foot, or did neither, as the file's slip_distance, footfalls and "
             "least_normal_force say, and how much the set would have to grow to have the "
             "farthest in it. None with a part that no torque moves and that does not decay"},
    {"--descend", "N", TO(descents), .low = 1, .high = DESCEND_STARTS, .without = QUESTIONS,
     .text = "of rays: N descents to the nearest end"},
    {"--boundary", TO(boundary), .without = QUESTIONS " --json",
     .text = "instead, as CSV: a point of the boundary midway between each two neighbours with "
             "different outcomes, `along` an axis, half their distance as `half_width`; of rays "
             "where each ends"},
    {OPTION_TIME_LIMIT},
    {REPORT_CSV, .text = "a row of numbers for each row of the tables"},
    {REPORT_JSON, .keys = keys, .text = "the same as JSON, with the keys"},
    {0},
};

const struct command command_basin = {
    "basin",
    "how large a basin is, how sure that is, and what its boundary is like",
    run,
    options,
    "The starts are the axes initial.offset.* and initial.state.*, or a sample of these; every "
    "other axis is a parameter. For each point of the parameters: how many of the starts end in "
    "the outcome, and what share of the box of starts that is. Rows are averages over a sample of "
    "parameters, and with --by over all other parameters. Cases inferred by sweep.refine count as "
    "simulated ones do, but have no numbers: --within refuses them.\n"
    "\n"
    "  volume    the box reaches from the first to the last place of each axis; cases on its edge "
    "count by the part of their cell that lies in it (the summary counts all cases alike). Where "
    "not all sampled starts vary evenly over a range there is no volume: box is 1\n"
    "  +-        likely error at the level L (0.95), conservative: of a grid from where the "
    "boundary may run in the cells that it crosses (analysis/basin/basin_map.h), over a sample of "
    "parameters with the scatter of its points or blocks; the longer side of what is likely\n"
    "  bounds    certain if no cell whose corners agree is crossed: the volume of the cells "
    "inside, and of those not outside; failed and pending cases count as outside in the one and "
    "as inside in the other. Of sampled starts an interval at the level L, Wilson's where each "
    "point is in or out\n"
    "  S_b, S_bb basin entropy and boundary basin entropy (Daza et al. 2016): mean over boxes of "
    "--box N (5) cases along each start, and over those with several outcomes. S_bb above log 2 = "
    "0.693 implies a fractal boundary, or stripes thinner than a box: a star marks it only where "
    "its interval is above and alpha's below 1\n"
    "  alpha     uncertainty exponent (Grebogi et al. 1983): the share of cases that have another "
    "outcome within e cells grows as e^alpha, 1 for a smooth boundary, whose dimension is that of "
    "the starts - alpha. Where shares over distances (four at least: 96 cases along each axis) are "
    "not straight in logarithms there is none, but the reason\n"
    "  cut       faces of the box on which starts have the outcome: the share is then the box's "
    "(theta-+: at both ends of theta). Of sampled starts within 5 % of the end of a range\n"
    "\n"
    "Where the box has the equilibrium in it (all offsets zero), what does not depend on the "
    "box:\n"
    "\n"
    "  connected the volume of what hangs together with the equilibrium, from neighbour to "
    "neighbour along the axes, with its error and bounds as above\n"
    "  bounded   yes: that part reaches no face of the box and no case that is not known\n"
    "  nearest   from the equilibrium to the nearest point out of the outcome, each offset in "
    "units of a disturbance of the size that --weight gives it (else 1 of its unit); where a face "
    "of the box is nearer, that is told, too (nearest_least)\n"
    "  median    where rays in 1024 directions, even in these units, first lose the outcome\n"
    "  leaving   share of those that leave the box before, or come to a case that is not known: "
    "they count as longer (median_least: as long as they could be followed)\n"
    "\n"
    "A file of rays (a grid axis initial.offset.scale, and sweep.sample of method sphere over "
    "offsets) tells at which scale the outcome is lost for the first time in every direction. The "
    "smallest is an upper bound: --descend N simulates further cases of the file's scenario from "
    "the shortest ray and N - 1 others, spread evenly, downhill to the nearest end "
    "(analysis/basin/basin_descend.h), and tells how many agree and how large a dip would have "
    "been missed.\n",
    NULL,
};
