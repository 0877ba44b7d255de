/* command_basin.c - `stance basin FILE`: how large the basin is, how sure that is, and what its
 * boundary looks like; as text, JSON or CSV. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"
#include "analysis/table/report.h"
#include "runner/base/message.h"

#include <string.h>

extern const struct command command_basin; /* below */

enum { MOST_BY = SCENARIO_MAX_AXES, MOST_SIDE = 1000 };

struct request {
    bool of_given, boundary;
    struct basin_choice choice;
};

/* Without --of: what the study is about. Where nothing was stabilised but something rested, that.
 */
static enum results_kind outcome_of(const struct results *r)
{
    struct statistics_counts counts;
    statistics_count(r, -1, 0, &counts);
    return counts.kind[RESULTS_STABILISED] == 0 && counts.kind[RESULTS_RESTED] > 0
               ? RESULTS_RESTED
               : RESULTS_STABILISED;
}

static int show_rays(const struct report *report, const struct results *r,
                     struct basin_sample *sample, stance_message *message)
{
    const struct request *request = report->request;
    struct basin_rays rays;
    if (request->choice.by_count > 0) {
        basin_sample_free(sample);
        complain(message,
                 "stance basin: --by has no meaning for rays: there is a row for every parameter");
        return EXIT_USAGE;
    }
    if (!basin_rays_make(&rays, r, request->choice.of, sample, message))
        return EXIT_IO;
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

    if (!basin_make(&basin, r, &request->choice, sample, &usage, message))
        return usage ? EXIT_USAGE : EXIT_IO;
    usage = request->boundary && basin.starts != BASIN_GRID;
    const bool good =
        usage               ? complain(message,
                                       "stance basin: --boundary needs starts on a grid; those of %.150s are a "
                                                     "sample",
                                       report->file)
        : request->boundary ? basin_print_boundary(&basin)
                            : basin_print(&basin, report->form);
    basin_free(&basin);
    return good ? EXIT_DONE : usage ? EXIT_USAGE : EXIT_IO;
}

static int work(struct report *report, const struct results *r, stance_message *message)
{
    struct request *request = report->request;
    struct basin_sample sample;

    if (!request->of_given)
        request->choice.of = outcome_of(r);
    if (memchr(r->kind, RESULTS_DONE, r->cases)) {
        complain(message, "%.150s: holds no outcomes (record.answers left them out)", report->file);
        return EXIT_USAGE;
    }
    if (!basin_sample_make(&sample, r, message))
        return EXIT_IO;
    return (basin_is_rays(r, &sample) ? show_rays : show_basin)(report, r, &sample, message);
}

static int run(int argc, char **argv)
{
    const char *by[MOST_BY], *of = NULL, *level = NULL, *side = NULL;
    size_t given[3] = {0}, boundary = 0;
    double cases = 5;
    int code;
    struct request request = {.choice = {.by = by, .level = 0.95}};
    struct basin_choice *choice = &request.choice;
    struct report report = {.command = &command_basin, .work = work, .request = &request};
    const struct option_spec specs[] = {
        {"--by", true, by, MOST_BY, &choice->by_count}, {"--of", true, &of, 1, &given[0]},
        {"--level", true, &level, 1, &given[1]},        {"--box", true, &side, 1, &given[2]},
        {"--boundary", false, NULL, 0, &boundary},
    };

    if (!report_options(&report, argc, argv, specs, sizeof specs / sizeof specs[0], &code))
        return code;
    if (boundary && report.form == TABLE_AS_JSON) {
        fputs("stance basin: --boundary prints CSV, not JSON\n", stderr);
        return EXIT_USAGE;
    }
    if (!report_outcome(&report, of, &choice->of) ||
        !report_number(&report, "--level", level, 0.5, 0.999999, false, &choice->level) ||
        !report_number(&report, "--box", side, 2, MOST_SIDE, true, &cases))
        return EXIT_USAGE;
    request.of_given = of != NULL;
    request.boundary = boundary > 0;
    choice->side = (size_t)cases;
    return report_run(&report);
}

const struct command command_basin = {
    "basin",
    "basin FILE [--by PATH]... [--of OUTCOME] [--level L] [--box N] [--boundary | --json | --csv]",
    "how large a basin is, how sure that is, and what its boundary is like",
    run,
    "The starts are the axes initial.offset.* and initial.state.*, or a sample of these; every\n"
    "other axis is a parameter. For each point of the parameters: how many of the starts end in\n"
    "the outcome, and what share of the box of starts that is. Rows are averages over a sample of\n"
    "parameters (stance sensitivity tells what it says of each), and with --by over all other\n"
    "parameters. Cases inferred by sweep.refine or stop.capture count as simulated ones do.\n"
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
    "            morris that of whole blocks, as if drawn independently\n"
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
    "  nearest   from the equilibrium to the nearest point out of the outcome, each offset in\n"
    "            units of its axis's range\n"
    "\n"
    "A file of rays (a grid axis initial.offset.scale, and sweep.sample of method sphere over\n"
    "offsets, mostly with sweep.refine) tells how far from the equilibrium the outcome reaches in\n"
    "every direction: smallest, median and largest scale at which a ray loses it for the first\n"
    "time, and for a single row the offsets at which the first one does. --boundary lists the "
    "rays.\n"
    "\n"
    "  --by PATH      a row for each value of this parameter alone; may be repeated; an axis of\n"
    "                 starts named here is a parameter\n"
    "  --of OUTCOME   stabilised (default; or rested, where nothing else was), rested, fell or\n"
    "                 undecided\n"
    "  --boundary     instead, as CSV: a point of the boundary for each pair of neighbours with\n"
    "                 different outcomes, midway between them along the axis `along`, with half\n"
    "                 their distance as `half_width` and both outcomes\n"
    "  --csv          a row of numbers for each row of the tables\n"
    "  --json         the same as JSON, with the keys\n"
    "    outcome, level, box_side, design (grid, or the sample's method), starts: [paths],\n"
    "    parameters: [paths], averaged: [paths], box, unit\n"
    "    rows           [{at: {path: value}, cases, inside, failed, pending, share, volume, reach\n"
    "                   (the likely error at the level), low, high, cells, crossed, entropy,\n"
    "                   boundary_entropy, boxes, mixed_boxes, fractal, alpha, alpha_error,\n"
    "                   alpha_distances (number of those fitted), alpha_missing (why there is\n"
    "                   none: small, none, wide, bent, few), dimension,\n"
    "                   distances: [cells], uncertain: [share], nearest, nearest_at: {path: "
    "value},\n"
    "                   extent: {path: [low, high]}}]; null where there is none\n"
    "    and of rays: outcome, starts, rays (number), rows [{at, crossing, open, outside,\n"
    "                   smallest, median, largest, first_ray, first_bracket: [low, high],\n"
    "                   first_at: {path: value}}]\n",
};
