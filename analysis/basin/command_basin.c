/* command_basin.c - `stance basin FILE`: how large the basin is, how sure that is, and what its
 * boundary looks like; as text, JSON or CSV. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"
#include "analysis/table/report.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_basin; /* below */

enum { MOST_WITHIN = 8, MOST_BY = SCENARIO_MAX_AXES, MOST_SIDE = 1000 };

struct request {
    bool of_given, boundary, allowed;
    size_t descents;                   /* of rays */
    double threshold;                  /* 0: none */
    const char *along, *lost, *answer; /* paths, an answer; NULL: not asked for */
    const char *within[MOST_WITHIN];
    size_t withins;
    char within_text[256];
    struct basin_choice choice;
};

static int show_rays(const struct report *report, const struct results *r,
                     struct basin_sample *sample, stance_message *message)
{
    const struct request *request = report->request;
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
        complain(message, "stance basin: rays have no use for %s", wrong);
        return EXIT_USAGE;
    }
    if (!basin_rays_make(&rays, r, request->choice.of, sample, message))
        return EXIT_IO;
    if (request->descents > 0 && !basin_rays_descend(&rays, request->descents, message)) {
        basin_rays_free(&rays);
        return EXIT_IO;
    }
    const bool good = request->boundary ? basin_rays_print_boundary(&rays)
                                        : basin_rays_print(&rays, report->form);
    basin_rays_free(&rays);
    return good ? EXIT_DONE : EXIT_IO;
}

static int show_basin(const struct report *report, const struct results *r,
                      struct basin_sample *sample, stance_message *message)
{
    const struct request *request = report->request;
    struct basin basin;
    bool usage = false;

    if (request->descents > 0) {
        basin_sample_free(sample);
        complain(message,
                 "stance basin: --descend goes on from rays, and %.150s has none (stance basin -h)",
                 report->file);
        return EXIT_USAGE;
    }
    if (!basin_make(&basin, r, &request->choice, sample, &usage, message))
        return usage ? EXIT_USAGE : EXIT_IO;
    usage = request->boundary && basin.starts != BASIN_GRID;
    const bool good =
        request->threshold > 0 ? basin_print_threshold(&basin, request->along, request->threshold,
                                                       report->form, &usage, message)
        : request->allowed     ? basin_print_allowed(&basin, report->form, &usage, message)
        : request->answer
            ? basin_print_answer(&basin, request->answer, report->form, &usage, message)
        : usage             ? complain(message,
                                       "stance basin: --boundary needs starts on a grid; those of %.150s are a "
                                                   "sample",
                                       report->file)
        : request->boundary ? basin_print_boundary(&basin)
                            : basin_print(&basin, report->form);
    basin_free(&basin);
    return good ? EXIT_DONE : usage ? EXIT_USAGE : EXIT_IO;
}

static int show_loss(const struct report *report, const struct results *r, stance_message *message)
{
    const struct request *request = report->request;
    bool usage = false;
    const bool good =
        basin_print_loss(r, request->lost, request->choice.of, report->form, &usage, message);
    return good ? EXIT_DONE : usage ? EXIT_USAGE : EXIT_IO;
}

static int show(struct report *report, const struct results *r, stance_message *message)
{
    const struct request *request = report->request;
    struct basin_sample sample;
    if (request->lost)
        return show_loss(report, r, message);
    if (!basin_sample_make(&sample, r, message))
        return EXIT_IO;
    return (basin_is_rays(r, &sample) ? show_rays : show_basin)(report, r, &sample, message);
}

/* "2", "2..", "1..2": the largest, the least, both; false: none of these. */
static bool read_bounds(const char *text, double bound[2])
{
    const char *const dots = strstr(text, "..");
    char least[64], *end = least;
    bound[0] = -INFINITY, bound[1] = INFINITY;
    snprintf(least, sizeof least, "%.*s", dots ? (int)(dots - text) : 0, text);
    if (least[0])
        bound[0] = strtod(least, &end);
    bool good = *end == '\0' && !isnan(bound[0]);
    text = dots ? dots + 2 : text;
    if (*text) {
        char *stop;
        bound[1] = strtod(text, &stop);
        good = good && stop > text && *stop == '\0' && !isnan(bound[1]);
    }
    return good && (isfinite(bound[0]) || isfinite(bound[1])) && bound[0] <= bound[1];
}

/* "settle_time <= 2", "0.1 <= ...": how it is said. */
static void bounds_text(const char *name, const double bound[2], char *text, size_t size)
{
    char least[40] = "", most[40] = "";
    if (isfinite(bound[0]))
        snprintf(least, sizeof least, "%g <= ", bound[0]);
    if (isfinite(bound[1]))
        snprintf(most, sizeof most, " <= %g", bound[1]);
    if (least[0] && !most[0])
        snprintf(text, size, "%s >= %g", name, bound[0]);
    else
        snprintf(text, size, "%s%s%s", least, name, most);
}

/* Cases with the outcome but with another number than --within allows become undecided: they are
 * not what was asked for. */
static int keep_within(struct results *r, struct request *request, stance_message *message)
{
    size_t used = 0;
    for (size_t k = 0; k < request->withins; k++) {
        const char *equals = strchr(request->within[k], '=');
        char name[96], text[180];
        double *value = NULL, bound[2];
        snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - request->within[k]) : 0,
                 request->within[k]);
        if (!equals || !read_bounds(equals + 1, bound) ||
            !basin_numbers(r, name, &value, message) || !value) {
            complain(message,
                     "stance basin: --within takes ANSWER=MOST or ANSWER=LEAST.. of a number that "
                     "the file stores, as settle_time=2, not '%.60s'",
                     request->within[k]);
            return EXIT_USAGE;
        }
        for (uint64_t i = 0; i < r->cases; i++)
            if (r->kind[i] == request->choice.of && !(bound[0] <= value[i] && value[i] <= bound[1]))
                r->kind[i] =
                    request->choice.of == RESULTS_UNDECIDED ? RESULTS_FELL : RESULTS_UNDECIDED;
        free(value);
        bounds_text(name, bound, text, sizeof text);
        if (used < sizeof request->within_text)
            used +=
                (size_t)snprintf(request->within_text + used, sizeof request->within_text - used,
                                 "%s%s", k ? ", " : "", text);
    }
    request->choice.within = request->within_text;
    return EXIT_DONE;
}

/* On a copy of what became of the cases. */
static int work_within(struct report *report, const struct results *r, stance_message *message)
{
    struct results own = *r;
    own.kind = malloc(r->cases + 1);
    if (!own.kind) {
        statistics_no_memory(r, message);
        return EXIT_IO;
    }
    memcpy(own.kind, r->kind, r->cases);
    int code = keep_within(&own, report->request, message);
    if (code == EXIT_DONE)
        code = show(report, &own, message);
    free(own.kind);
    return code;
}

static int work(struct report *report, const struct results *r, stance_message *message)
{
    struct request *request = report->request;

    if (!request->of_given)
        request->choice.of = statistics_judged(r);
    if (memchr(r->kind, RESULTS_DONE, r->cases)) {
        complain(message, "%.150s: holds no outcomes (record.answers left them out)", report->file);
        return EXIT_USAGE;
    }
    return request->withins > 0 ? work_within(report, r, message) : show(report, r, message);
}

/* "PATH=SIZE" */
static bool read_weights(const char *const *text, struct basin_choice *choice)
{
    for (size_t k = 0; k < choice->weights; k++) {
        struct basin_weight *weight = &choice->weight[k];
        const char *equals = strchr(text[k], '=');
        char *end;
        snprintf(weight->path, sizeof weight->path, "%.*s", equals ? (int)(equals - text[k]) : 0,
                 text[k]);
        weight->size = equals ? strtod(equals + 1, &end) : 0;
        if (!equals || *end || !(weight->size > 0) || !isfinite(weight->size)) {
            fprintf(stderr,
                    "stance basin: --weight takes PATH=SIZE with a positive SIZE, as "
                    "initial.offset.theta=0.01, not '%.60s'\n",
                    text[k]);
            return false;
        }
    }
    return true;
}

/* Of what --of names the path (with --threshold), and the outcome, NULL where none is. */
static const char *take_path(const char *const *of, size_t count, bool threshold, const char **path)
{
    const char *outcome = NULL;
    for (size_t k = 0; k < count; k++) {
        bool is_path = threshold;
        for (int i = 0; i < RESULTS_OUTCOMES; i++)
            is_path = is_path && strcmp(of[k], results_kind_names[i]) != 0;
        *(is_path || strchr(of[k], '.') ? path : &outcome) = of[k];
    }
    return outcome;
}

static bool is_consistent(const struct request *request, bool threshold)
{
    const int asked = threshold + (request->lost != NULL) + (request->answer != NULL) +
                      (request->choice.rank > 0) + (request->descents > 0) + request->boundary +
                      request->allowed;
    const char *wrong =
        asked > 1 ? "--threshold, --lost, --rank, --answer, --allowed, --descend and --boundary "
                    "are one at a "
                    "time"
        : threshold && !request->along ? "--threshold needs --of PATH, along which it is crossed"
        : !threshold && request->along ? "--of PATH goes with --threshold; else it names an outcome"
        : threshold && request->threshold == 1
            ? "--threshold 1 is where it begins; --lost PATH has the first start that is lost"
            : NULL;
    if (wrong)
        fprintf(stderr, "stance basin: %s\n", wrong);
    return !wrong;
}

static int run(int argc, char **argv)
{
    const char *by[MOST_BY], *of[2] = {NULL}, *level = NULL, *side = NULL, *weight[BASIN_WEIGHTS],
                             *descend = NULL, *threshold = NULL, *rank = NULL;
    size_t ofs = 0, given[7] = {0}, boundary = 0, allowed = 0;
    double cases = 5, descents = 0, ranks = 0;
    int code;
    struct request request = {.choice = {.by = by, .level = 0.95}};
    struct basin_choice *choice = &request.choice;
    struct report report = {.command = &command_basin, .work = work, .request = &request};
    const struct option_spec specs[] = {
        {"--by", true, by, MOST_BY, &choice->by_count},
        {"--of", true, of, 2, &ofs},
        {"--level", true, &level, 1, &given[1]},
        {"--box", true, &side, 1, &given[2]},
        {"--boundary", false, NULL, 0, &boundary},
        {"--allowed", false, NULL, 0, &allowed},
        {"--descend", true, &descend, 1, &given[3]},
        {"--threshold", true, &threshold, 1, &given[4]},
        {"--lost", true, &request.lost, 1, &given[0]},
        {"--rank", true, &rank, 1, &given[5]},
        {"--answer", true, &request.answer, 1, &given[6]},
        {"--within", true, request.within, MOST_WITHIN, &request.withins},
        {"--weight", true, weight, BASIN_WEIGHTS, &choice->weights},
    };

    if (!report_options(&report, argc, argv, specs, sizeof specs / sizeof specs[0], &code))
        return code;
    if (boundary && report.form == TABLE_AS_JSON) {
        fputs("stance basin: --boundary prints CSV, not JSON\n", stderr);
        return EXIT_USAGE;
    }
    const char *outcome = take_path(of, ofs, threshold != NULL, &request.along);
    if (!report_outcome(&report, outcome, &choice->of) ||
        !report_number(&report, "--threshold", threshold, 1e-6, 1e6, false, &request.threshold) ||
        !report_number(&report, "--rank", rank, 1, 1e9, true, &ranks) ||
        !report_number(&report, "--level", level, 0.5, 0.999999, false, &choice->level) ||
        !report_number(&report, "--box", side, 2, MOST_SIDE, true, &cases) ||
        !report_number(&report, "--descend", descend, 1, DESCEND_STARTS, true, &descents) ||
        !read_weights(weight, choice))
        return EXIT_USAGE;
    request.of_given = outcome != NULL;
    choice->rank = (size_t)ranks;
    request.boundary = boundary > 0;
    request.allowed = allowed > 0;
    request.descents = (size_t)descents;
    if (!is_consistent(&request, threshold != NULL))
        return EXIT_USAGE;
    choice->side = (size_t)cases;
    return report_run(&report);
}

const struct command command_basin = {
    "basin",
    "basin FILE [--by PATH]... [--of OUTCOME] [--within ANSWER=BOUND]... [--level L] [--box N]\n"
    "           [--weight PATH=SIZE]... [--threshold T --of PATH | --lost PATH | --rank N |\n"
    "           --answer A | --allowed | --descend N | --boundary] [--time-limit TIME]\n"
    "           [--json | --csv]",
    "how large a basin is, how sure that is, and what its boundary is like",
    run,
    "The starts are the axes initial.offset.* and initial.state.*, or a sample of these; every\n"
    "other axis is a parameter. For each point of the parameters: how many of the starts end in\n"
    "the outcome, and what share of the box of starts that is. Rows are averages over a sample of\n"
    "parameters (stance sensitivity tells what it says of each), and with --by over all other\n"
    "parameters. Cases inferred by sweep.refine count as simulated ones do.\n"
    "\n"
    "  volume    the box reaches from the first to the last place of each axis; cases on its edge\n"
    "            count by the part of their cell that lies in it (so the share is not quite that\n"
    "            of the summary, which counts all cases alike)\n"
    "  +-        likely error at the level L (0.95), conservative: it held in 95 to 100 % of maps\n"
    "            with boundaries along an axis, slanted or round. The error of a grid is no\n"
    "            binomial one, as its points are no sample: in each cell that the boundary "
    "crosses\n"
    "            the volume is off by an evenly distributed part, the same in cells along which\n"
    "            the boundary runs parallel to an axis or in step with the lattice\n"
    "            (analysis/basin/basin_map.h); the mean over parameters of a grid has the mean "
    "error.\n"
    "            Over a sample of parameters with the scatter of its points, of saltelli and\n"
    "            morris that of whole blocks, as if drawn independently; where few points differ\n"
    "            from the others, the longer side of what is likely either way\n"
    "  bounds    certain if the boundary is resolved (no cell whose corners agree is crossed): "
    "the\n"
    "            volume of the cells inside, and of those not outside. Cases that failed or are\n"
    "            pending count as outside in the one and as inside in the other\n"
    "            Of sampled starts: an interval at the level L, Wilson's where each point is in "
    "or\n"
    "            out, with failed and pending cases outside for its lower end and inside for its\n"
    "            upper one; a point counts once, however many cases it has. Where not all starts "
    "vary evenly over a range, each\n"
    "            by a factor of its own, there is no volume: box is 1, and shares stand instead\n"
    "  S_b, S_bb basin entropy and boundary basin entropy (Daza et al. 2016): mean over boxes of\n"
    "            --box N (5) cases along each start, and over those with several outcomes. S_bb\n"
    "            above log 2 = 0.693 implies a fractal boundary where boxes are small beside the\n"
    "            domains; stripes of three outcomes thinner than a box exceed it, too. So a star\n"
    "            marks it only where its interval is above and alpha's below 1. Small boxes\n"
    "            estimate it low (two outcomes at random in 25 cases: 0.673)\n"
    "  alpha     uncertainty exponent (Grebogi et al. 1983): the share of cases that have another\n"
    "            outcome within e cells along some start grows as e^alpha; 1 for a smooth\n"
    "            boundary. The boundary's dimension is that of the starts - alpha. Of the "
    "distances\n"
    "            1, 2, 4 ... up to a twelfth of the shortest axis (96 cases along it give the "
    "four\n"
    "            that are needed) the longest are left out as long as shares over distances, both\n"
    "            logarithmic, are not straight; where nothing is straight there is no alpha, but\n"
    "            the reason. Its error has in it how much parts of the map and distances differ\n"
    "  cut       faces of the box on which starts have the outcome: the share is then the box's,\n"
    "            and another box has another one (theta-+: at both ends of theta). Of sampled\n"
    "            starts where some lie within 5 % of the end of a range\n"
    "\n"
    "Where the box has the equilibrium in it (all offsets zero), what does not depend on the box:\n"
    "\n"
    "  connected the volume of the part of the outcome that hangs together with the equilibrium,\n"
    "            from neighbour to neighbour along the axes, with its error and bounds as above\n"
    "  bounded   yes: that part reaches no face of the box and no case that is not known\n"
    "  nearest   from the equilibrium to the nearest point out of the outcome, each offset in\n"
    "            units of a disturbance of the size that --weight gives it (else 1 of its unit);\n"
    "            the smaller one where a face of the box is nearer is told, too (nearest_least)\n"
    "  median    where rays in 1024 directions, even in these units, first lose the outcome; "
    "those\n"
    "  leaving   that leave the box before, or come to a case that is not known, count as longer\n"
    "            (median_least: as long as they could be followed)\n"
    "\n"
    "A file of rays (a grid axis initial.offset.scale, and sweep.sample of method sphere over\n"
    "offsets, mostly with sweep.refine) tells how far from the equilibrium the outcome reaches in\n"
    "every direction: smallest, median and largest scale at which a ray loses it for the first\n"
    "time, and for a single row the offsets at which the first one does. --boundary lists the "
    "rays.\n"
    "The smallest over some directions is an upper bound: --descend N simulates further cases of "
    "the\n"
    "file's scenario to go from the shortest ray and N - 1 others, spread evenly, downhill to the\n"
    "nearest end (analysis/basin/basin_descend.h; a few hundred to a few thousand cases each). "
    "How\n"
    "many of them agree, and how large a dip would have been missed, tells how sure that is.\n"
    "\n"
    "  --by PATH      a row for each value of this parameter alone; may be repeated; an axis of\n"
    "                 starts named here is a parameter\n"
    "Single questions, each with --json and --csv, too:\n"
    "\n"
    "  --threshold T --of PATH   where along this parameter the share first falls below T times\n"
    "                 what it is at the first value (T above 1: rises above), the share taken as\n"
    "                 linear between values, with an interval at the level L (Fieller's; from the\n"
    "                 likely errors, of a sample from its points, which all values share)\n"
    "  --lost PATH    of the starts that have the outcome at one end of this parameter how many\n"
    "                 lose it first at each value, and one of the first that do. From the end\n"
    "                 where more have it, or with PATH=VALUE from that end\n"
    "  --rank N       of a sample of parameters, the N points with the largest volumes, each with\n"
    "                 its values, share and bounds\n"
    "  --answer A     smallest, median, 90 and 99 %, and largest of a stored number (settle_time,\n"
    "                 peak_torque ...) over the starts with the outcome, and in which case\n"
    "\n"
    "  --allowed      the share of starts from which linear theory allows some controller to\n"
    "                 recover with these torques, while the contacts stand (stance design has its\n"
    "                 reach; stance plot --allowed draws it), as if they were glued: of several\n"
    "                 the bound does not know where their centre of pressure may be. None of the\n"
    "                 starts with a part that no torque moves and that does not decay. Of these "
    "the\n"
    "                 share with the\n"
    "                 outcome; and the share of starts with the outcome outside of it. How many "
    "of\n"
    "                 those slipped (by more than 1e-6 m), lifted a foot, or did neither, as the\n"
    "                 file's slip_distance, footfalls and least_normal_force say (else unknown): "
    "a\n"
    "                 robot far from where it is linear may do what linear theory does not allow.\n"
    "                 farthest: by how much the set would have to grow to have such a start in it\n"
    "\n"
    "  --within A=BOUND   counts as the outcome only where the number A is at most BOUND, in all\n"
    "                 of the above: settle_time=2 is the domain of stability within 2 s; with\n"
    "                 BOUND LEAST.. at least that (least_normal_force=5..), with LEAST..MOST\n"
    "                 between them; may be repeated\n"
    "  --of OUTCOME   stabilised (default; or rested, where nothing else was), rested, fell or\n"
    "                 undecided\n"
    "  --weight PATH=SIZE   distances count this start in units of SIZE; may be repeated\n"
    "  --descend N    of rays: N descents to the nearest end, 1 to 64\n"
    "  --boundary     instead, as CSV: a point of the boundary for each pair of neighbours with\n"
    "                 different outcomes, midway between them along the axis `along`, with half\n"
    "                 their distance as `half_width` and both outcomes\n"
    "  --time-limit TIME  end after 90s, 55m, 1h30m ... of wall time, with exit code 4\n"
    "  --csv          a row of numbers for each row of the tables\n"
    "  --json         the same as JSON, with the keys\n"
    "    outcome, within, level, box_side, design (grid, or the sample's method), starts: "
    "[paths],\n"
    "    parameters: [paths], averaged: [paths], box, unit, weights: {path: size}\n"
    "    rows           [{at: {path: value}, cases, inside, failed, pending, share, volume, reach\n"
    "                   (the likely error at the level), low, high, cells, crossed, entropy,\n"
    "                   boundary_entropy, boxes, mixed_boxes, fractal, alpha, alpha_error,\n"
    "                   alpha_distances (number of those fitted), alpha_missing (why there is\n"
    "                   none: small, none, wide, bent, few), dimension,\n"
    "                   distances: [cells], uncertain: [share], cut: [{path, end: lower or\n"
    "                   upper, at}], connected, connected_reach, connected_low, connected_high,\n"
    "                   bounded, connected_cut: [as cut], nearest, nearest_least, median,\n"
    "                   median_least, leaving (share), nearest_at: {path: value},\n"
    "                   extent: {path: [low, high]}}]; null where there is none\n"
    "    of --threshold: outcome, threshold, of, unit, level, within, rows [{at, first_share,\n"
    "                   last_share, value (null: not crossed), low, high (null: beyond the last\n"
    "                   value), before, after (values between which it is)}]\n"
    "    of --lost: outcome, of, starts, unknown, kept, lost (values between which the first are\n"
    "                   lost), first (case), first_at: {path: value}, rows [{value, lost,\n"
    "                   lost_so_far, share}]\n"
    "    of --allowed: outcome, rows [{at, starts, allowed, used, outside (shares), why (there is\n"
    "                   no such set), unreached (modes that no torque moves and that do not\n"
    "                   decay), glued (several contacts carry), slipped, lifted, neither, "
    "unknown:\n"
    "                   {starts, farthest (null: no growth suffices), case}}]\n"
    "    of --answer: outcome, answer, rows [{at, cases, smallest, median, q90, q99, largest,\n"
    "                   largest_case}]\n"
    "    and of rays: outcome, starts, rays (number), rows [{at, crossing, open, outside,\n"
    "                   nearest: {scale, bracket: [low, high], at: {path: value}, of_ranges:\n"
    "                   {path: in units of half the range}, starts, agree, unseen (share of\n"
    "                   directions), simulations, failed}, smallest, median, largest, first_ray, "
    "first_bracket: [low, high],\n"
    "                   first_at: {path: value}}]\n",
};
