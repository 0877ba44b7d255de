/* search_plot.c - the pictures of the file of a search, and of several.
 *
 * convergence: a search as it went, over the candidates in their order what each was worth, the
 * mean of the distribution that they are drawn from, and how wide it is. Of the mean its change
 * from the first candidate is drawn, in the coordinates that the search moves, each number in its
 * unit: of a gain what takes the whole torque from the edge of the starts, of what moves by ratios
 * its logarithm. The width along a coordinate is its standard deviation, the step times the root of
 * the covariance.
 *
 * starts: where a search has won, along each coordinate of the fresh starts, in parts of equally
 * many, the share that the first candidate and the chosen one recover, and from which linear theory
 * allows any controller to. All others of a part's coordinates are spread over their ranges: these
 * are shares, not a section through the domain.
 *
 * front: what searches have reached against a number that their scenarios differ in.
 */
#include "search_study.h"

#include "analysis/draw/plot.h"
#include "runner/plan/allowed.h"
#include "runner/scenario/schema.h"

#include <math.h>
#include <string.h>

enum {
    MOST_NAMED = 14,    /* numbers of the distribution */
    MOST_DRAWN = 40000, /* candidates */
    MOST_PANELS = 18,   /* coordinates of the starts, each in so many parts, */
    PARTS = 12,
    LEAST = 20, /* of so many starts at least */
};

/* ---- curves that the pictures share ------------------------------------------------------- */

/* The first candidate, the chosen one, what linear theory allows. */
enum curve { FIRST, CHOSEN, ALLOWED, CURVES };
static const struct style {
    const char *colour, *name;
    int dash, point;
} styles[CURVES] = {{"hue[2]", "first candidate", 2, 5},
                    {"hue[1]", "chosen", 1, 7},
                    {"hue[3]", "allowed by linear theory", 4, 9}};

struct row {
    double x;
    struct search_share at;
};

/* The curves in the last panel, with the intervals of their shares and points of a size. */
static void put_curves(struct gnuplot *g, struct row *const row[CURVES], size_t rows, bool allowed,
                       double size)
{
    for (int k = allowed ? ALLOWED : CHOSEN; k >= 0; k--) {
        gnuplot_series(g,
                       "using 1:2 with lines lc rgb %s dt %d lw 2 notitle, '' using 1:2:3:4 with "
                       "yerrorbars lc rgb %s pt %d ps %g lw 1.4",
                       styles[k].colour, styles[k].dash, styles[k].colour, styles[k].point, size);
        for (const struct row *r = row[k]; r < row[k] + rows; r++)
            GNUPLOT_ROW(g, r->x, 100 * r->at.share, 100 * r->at.interval.low,
                        100 * r->at.interval.high);
    }
}

/* Their legend, a number behind each name as the format has it, NULL: none; of NAN there is no
 * curve. glued: what is allowed is so for contacts as if glued. */
static void put_legend(struct gnuplot *g, const char *format, const double number[CURVES],
                       bool glued)
{
    char text[40] = "";
    for (int k = 0; k < CURVES; k++) {
        if (isnan(number[k]))
            continue;
        if (format)
            snprintf(text, sizeof text, format, number[k]);
        gnuplot_legend(g, styles[k].colour, styles[k].dash, 0, styles[k].name, text);
    }
    if (glued && !isnan(number[ALLOWED]))
        gnuplot_note(g, "allowed: " ALLOWED_GLUED);
}

/* ---- convergence: what the candidates were worth ------------------------------------------- */

struct course {
    struct gnuplot g;
    const struct search_study *study;
    double scale;      /* 100: objectives are per cent */
    double at[CURVES]; /* what fresh starts said; NAN: nothing */
};

/* Dots, and over all that is known of them the best so far as steps, stages apart. */
static void put_candidates(struct course *page)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_CANDIDATE], every = (n + MOST_DRAWN - 1) / MOST_DRAWN;
    gnuplot_series(&page->g, "using 1:2 with points pt 7 ps %g lc rgb grey", 0.8 * gnuplot_dot(n));
    for (size_t i = 0; i < n; i += every)
        GNUPLOT_ROW(&page->g, (double)i + 1, page->scale * f->objective[i]);
    for (int k = CURVES; k-- > 0;) {
        gnuplot_series(&page->g, "using 1:2 with lines lc rgb %s dt %d lw 2.2", styles[k].colour,
                       styles[k].dash);
        gnuplot_segment(&page->g, 0, page->at[k], (double)n, page->at[k]);
    }
    gnuplot_series(&page->g, "using 1:2 with lines lc rgb 0x000000 lw 2");
    for (size_t g = 0; g < f->length[SEARCH_GENERATION]; g++) {
        const double best = page->scale * f->objective[f->best[g]];
        if (g > 0 && (f->stage[g] != f->stage[g - 1] || f->restart[g] != f->restart[g - 1]))
            gnuplot_gap(&page->g);
        GNUPLOT_ROW(&page->g, (double)search_first(f, g), best);
        GNUPLOT_ROW(&page->g, (double)f->candidates[g], best);
    }
}

static void put_stages(struct course *page)
{
    const struct search_file *const f = &page->study->f;
    size_t last[SEARCH_STAGES];
    const size_t stages = search_stages(page->study, last);
    gnuplot_set(&page->g, "stretches = %zu", stages);
    gnuplot_arrays(&page->g, stages, "stretch_from stretch_to stretch_text");
    for (size_t i = 0; i < stages; i++) {
        char text[40];
        snprintf(text, sizeof text, "%lld starts", (long long)f->starts[last[i]]);
        gnuplot_set(&page->g, "stretch_from[%zu] = %lld; stretch_to[%zu] = %lld", i + 1,
                    i > 0 ? (long long)f->candidates[last[i - 1]] : 0LL, i + 1,
                    (long long)f->candidates[last[i]]);
        gnuplot_text(&page->g, text, "stretch_text[%zu]", i + 1);
    }
}

/* The axis of objectives. Prices have no lower bound: candidates that are far worse than the first
 * are left out there. */
static struct plot_range shown(const struct course *page)
{
    const struct search_file *const f = &page->study->f;
    struct plot_range range = PLOT_NOTHING, all;
    for (int k = 0; k < CURVES; k++)
        if (k != ALLOWED)
            plot_widen(&range, page->at[k]);
    if (range.low > range.high)
        plot_widen(&range, page->scale * f->objective[0]);
    const double low = range.low;
    plot_widen(&range, fmax(low, page->at[ALLOWED]));
    plot_range_of(&all, f->objective, f->length[SEARCH_CANDIDATE]);
    range.high = fmax(range.high, page->scale * all.high);
    range.low = fmax(fmin(low, page->scale * all.low), low - (range.high - low));
    if (page->study->plain)
        range.low = 0;
    const double room = range.high > range.low ? 0.06 * (range.high - range.low) : 1;
    return (struct plot_range){page->study->plain ? 0 : range.low - room, range.high + room};
}

/* What fresh starts said, and its legend. */
static void find_lines(struct course *page)
{
    const struct search_study *const study = page->study;
    const struct search_file *const f = &study->f;
    page->at[FIRST] = page->at[CHOSEN] = page->at[ALLOWED] = NAN;
    if (study->done) {
        page->at[FIRST] = page->scale * f->confirmed_objective[0];
        page->at[CHOSEN] = page->scale * f->confirmed_objective[f->chosen];
    }
    if (study->done && study->plain)
        page->at[ALLOWED] = page->scale * search_limit(study, (size_t)f->chosen, NULL);
    put_legend(&page->g, study->plain ? "%.1f %%" : "%.4g", page->at, study->glued);
}

/* ---- ... the distribution ------------------------------------------------------------------ */

/* "hip1 vq2" of a gain, else the last part of the path. */
static void name_number(const struct search_study *study, size_t k, char *text, size_t size)
{
    const char *const path = study->f.parameter[k];
    const stance_scene *const scene = study->first ? study->first->scene : NULL;
    int row, column;
    if (scene && sscanf(path, "controller.gains[%d][%d]", &row, &column) == 2 && row >= 0 &&
        row < scene->actuators && column >= 0 && column < 2 * scene->postures)
        snprintf(text, size, "%s %s%s", scene->actuator_name[row],
                 column < scene->postures ? "" : "v",
                 scene->coordinate[scene->posture[column % scene->postures]].name);
    else
        snprintf(text, size, "%s", schema_last_name(path));
}

static double change(const struct search_file *f, size_t generation, size_t k)
{
    return f->mean[generation * f->length[SEARCH_PARAMETER] + k] - f->coordinate[k];
}

/* A number of each generation as a line of the last panel; k: of the distribution, or the step. */
enum number { MEAN, WIDTH, STEP };
static double number_of(const struct search_file *f, size_t g, size_t k, enum number number)
{
    const size_t n = f->length[SEARCH_PARAMETER];
    return number == MEAN   ? change(f, g, k)
           : number == STEP ? log10(f->step[g])
                            : log10(f->step[g] * sqrt(f->covariance[(g * n + k) * n + k]));
}

static void put_line(struct course *page, size_t k, enum number number, const char *style)
{
    const struct search_file *const f = &page->study->f;
    gnuplot_series(&page->g, "using 1:2 with lines %s", style);
    for (size_t g = 0; g < f->length[SEARCH_GENERATION]; g++)
        GNUPLOT_ROW(&page->g, (double)f->candidates[g], number_of(f, g, k, number));
}

/* The panel of the mean, its lines with a hue and dashes each while they can be told apart, then
 * with their names in the order in which they end, the lowest first; that of the width. */
static void put_distribution(struct course *page)
{
    static const char thin[] = "lc rgb grey lw 0.8";
    struct gnuplot *const g = &page->g;
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_PARAMETER], generations = f->length[SEARCH_GENERATION];
    struct statistics_place *const end = gnuplot_room(g, n, sizeof *end);
    struct plot_range range[] = {PLOT_NOTHING, PLOT_NOTHING};
    char style[80];
    for (size_t i = 0; i < generations * n; i++) {
        plot_widen(&range[MEAN], number_of(f, i / n, i % n, MEAN));
        plot_widen(&range[WIDTH], number_of(f, i / n, i % n, WIDTH));
        plot_widen(&range[WIDTH], number_of(f, i / n, 0, STEP));
    }
    gnuplot_panel(g, 224, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, plot_roomy(range[MEAN], 0.05), "change of the mean", "");
    for (size_t k = 0; k < n; k++) {
        snprintf(style, sizeof style, "lc rgb %s dt %zu lw 1.8", gnuplot_hue(k), k / 7 % 5 + 1);
        put_line(page, k, MEAN, n <= MOST_NAMED ? style : thin);
    }
    for (size_t k = 0; end && k < n; k++)
        end[k] = (struct statistics_place){change(f, generations - 1, k), k};
    if (end && n <= MOST_NAMED) {
        size_t longest = 0;
        statistics_order(end, n);
        gnuplot_arrays(g, n, "end_at end_text end_colour");
        for (size_t k = 0; k < n; k++) {
            char text[100];
            name_number(page->study, end[k].index, text, sizeof text);
            const char *const label = look_label(g->plot->look, text);
            longest = strlen(label) > longest ? strlen(label) : longest;
            gnuplot_set(g, "end_colour[%zu] = %s", k + 1, gnuplot_hue(end[k].index));
            gnuplot_number(g, end[k].value, "end_at[%zu]", k + 1);
            gnuplot_text(g, label, "end_text[%zu]", k + 1);
        }
        gnuplot_set(g, "ends = %zu; end_panel = panels; longest_end = %zu", n, longest);
    }
    gnuplot_panel(g, 112, "");
    gnuplot_axis(g, 'y', PLOT_LOG,
                 range[WIDTH].low <= range[WIDTH].high
                     ? (struct plot_range){range[WIDTH].low - 0.05, range[WIDTH].high + 0.05}
                     : (struct plot_range){-1, 0},
                 "st. dev.", "");
    for (size_t k = 0; k < n; k++)
        put_line(page, k, WIDTH, thin);
    put_line(page, 0, STEP, "lc rgb 0x000000 lw 2");
}

static bool plot_convergence(const struct search_study *study, const struct plot *plot)
{
    const struct search_file *const f = &study->f;
    struct course page = {.study = study, .scale = study->plain ? 100 : 1};
    struct gnuplot *const g = &page.g;
    if (!gnuplot_begin(g, plot, "convergence"))
        return false;
    gnuplot_say(g, "%zu candidates in %zu ", f->length[SEARCH_CANDIDATE],
                f->length[SEARCH_GENERATION]);
    if (study->done)
        gnuplot_say(g, "generations; lines: of %zu fresh starts", f->length[SEARCH_START]);
    else
        gnuplot_say(g, "of at most %lld generations, not finished", (long long)f->most_generations);
    gnuplot_set(g, "chart_width = 560");
    gnuplot_axis(g, 'x', PLOT_LINEAR, (struct plot_range){0, (double)f->length[SEARCH_CANDIDATE]},
                 "candidate", "");
    gnuplot_legend(g, "grey", 0, 7, "candidate", "");
    gnuplot_legend(g, "0x000000", 1, 0, "best so far of its stage", "");
    find_lines(&page);
    put_stages(&page);
    gnuplot_panel(g, 280, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, shown(&page),
                 study->plain ? "recovered starts (%)" : "objective", "");
    put_candidates(&page);
    put_distribution(&page);
    return gnuplot_end(g);
}

/* ---- starts --------------------------------------------------------------------------------- */

struct parts {
    struct gnuplot g;
    const struct search_study *study;
    double *allowed;                /* of each start; NULL: linear theory sets no bound */
    struct statistics_place *order; /* of the starts along a coordinate */
    size_t circumstance;
    double most; /* per cent */
};

/* The share of the circumstances that count in which candidate k recovers from a start. */
static double recovered(const struct parts *page, size_t k, size_t start)
{
    size_t from, to, count = 0;
    search_circumstances(page->study, page->circumstance, &from, &to);
    for (size_t c = from; c < to; c++)
        count += search_recovers(page->study, k, c, start);
    return (double)count / (double)(to - from);
}

/* The middle of the starts from ... to in their order, and of each curve its share. */
static void make_part(struct parts *page, size_t from, size_t to, struct row row[CURVES])
{
    struct interval_draws draws[CURVES] = {{0}};
    double middle = 0;
    for (size_t i = from; i < to; i++) {
        const size_t start = page->order[i].index;
        middle += page->order[i].value / (double)(to - from);
        interval_add(&draws[FIRST], recovered(page, 0, start), 1);
        interval_add(&draws[CHOSEN], recovered(page, (size_t)page->study->f.chosen, start), 1);
        if (page->allowed)
            interval_add(&draws[ALLOWED], page->allowed[start], 1);
    }
    for (int k = 0; k < CURVES; k++) {
        const struct interval interval = interval_of(&draws[k], 0.95);
        row[k] = (struct row){middle, {draws[k].k / draws[k].m, interval}};
        page->most = fmax(page->most, isnan(interval.high) ? 0 : 100 * interval.high);
    }
}

static void put_panel(struct parts *page, size_t column)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_START], parts = n / PARTS >= LEAST ? PARTS
                                                      : n / LEAST > 2    ? n / LEAST
                                                                         : 2;
    const char *const path = f->varied[column], *const label = look_label(page->g.plot->look, path);
    struct row row[CURVES][PARTS], of[CURVES];
    struct results_axis axis = {.unit = ""};
    size_t rows = 0;
    for (size_t i = 0; i < n; i++) {
        const double at = f->start_value[i * f->length[SEARCH_VARIED] + column];
        page->order[i] = (struct statistics_place){isnan(at) ? INFINITY : at, i}; /* damaged */
    }
    statistics_order(page->order, n);
    for (size_t p = 0; p < parts; p++) {
        if (p * n / parts == (p + 1) * n / parts)
            continue;
        make_part(page, p * n / parts, (p + 1) * n / parts, of);
        for (int k = 0; k < CURVES; k++)
            row[k][rows] = of[k];
        rows++;
    }
    snprintf(axis.name, sizeof axis.name, "%s", path);
    search_describe(page->study, &axis);
    gnuplot_panel(&page->g, 168, "");
    gnuplot_axis(
        &page->g, 'x', PLOT_LINEAR,
        plot_roomy((struct plot_range){page->order[0].value, page->order[n - 1].value}, 0.04),
        label == path ? schema_last_name(path) : label, axis.unit);
    put_curves(&page->g, (struct row *const[]){row[FIRST], row[CHOSEN], row[ALLOWED]}, rows,
               page->allowed, 0.4);
}

static bool plot_starts(const struct search_study *study, const struct plot *plot)
{
    const struct search_file *const f = &study->f;
    const size_t starts = f->length[SEARCH_START], varied = f->length[SEARCH_VARIED],
                 panels = varied < MOST_PANELS ? varied : MOST_PANELS;
    struct parts page = {.study = study};
    struct gnuplot *const g = &page.g;
    if (!study->done || varied == 0)
        return true;
    if (!gnuplot_begin(g, plot, "starts"))
        return false;
    page.circumstance = search_worst(study, (size_t)f->chosen);
    page.allowed = gnuplot_room(g, starts, sizeof *page.allowed);
    page.order = gnuplot_room(g, starts, sizeof *page.order);
    if (!page.allowed || !page.order)
        return gnuplot_end(g);
    if (!search_allowed(study, page.allowed))
        page.allowed = NULL;
    gnuplot_say(g, "%zu fresh starts", starts);
    if (f->length[SEARCH_CIRCUMSTANCE] > 1 && page.circumstance == SEARCH_OVERALL)
        gnuplot_say(g, ", mean of %zu circumstances", f->length[SEARCH_CIRCUMSTANCE]);
    else if (f->length[SEARCH_CIRCUMSTANCE] > 1)
        gnuplot_say(g, ", in the worst circumstance of the chosen one: %.200s",
                    f->circumstance[page.circumstance]);
    gnuplot_set(g, "columns = 3; chart_width = 210; scaled = 1");
    gnuplot_axis(g, 'y', PLOT_LINEAR, (struct plot_range){0, 100}, "share of the starts (%)", "");
    for (size_t k = 0; k < panels; k++)
        put_panel(&page, k);
    gnuplot_number(g, fmin(104, 1.04 * page.most + 1), "y_high");
    double allowed = page.allowed ? 0 : NAN;
    for (size_t i = 0; page.allowed && i < starts; i++)
        allowed += page.allowed[i] / (double)starts;
    const double of_first = search_share(study, 0, page.circumstance).share,
                 of_chosen = search_share(study, (size_t)f->chosen, page.circumstance).share;
    put_legend(g, "%.1f %%", (const double[]){100 * of_first, 100 * of_chosen, 100 * allowed},
               study->glued);
    gnuplot_note(g, "bars: 95 %% intervals");
    if (panels < varied)
        gnuplot_note(g, "%zu of the %zu coordinates are drawn", panels, varied);
    return gnuplot_end(g);
}

/* ---- front ---------------------------------------------------------------------------------- */

static bool plot_front(const struct search_front *front, const struct plot *plot)
{
    struct gnuplot g;
    struct plot_axis along;
    struct row *row[CURVES];
    double most = 0;
    bool limited = true, had = true;
    if (!gnuplot_begin(&g, plot, "front"))
        return false;
    for (int c = 0; c < CURVES; c++)
        had = (row[c] = gnuplot_room(&g, front->count, sizeof *row[c])) && had;
    if (!had)
        return gnuplot_end(&g);
    gnuplot_say(&g, "%zu searches, each with its fresh starts; bars: 95 %% intervals%s%s",
                front->count, front->also[0] ? "; also different: " : "", front->also);
    plot_axis_make_curve(&along, &front->against);
    plot_axis_write(&along, &g, 'x');
    for (size_t i = 0; i < front->count; i++) {
        const struct search_study *const study = &front->study[i];
        const size_t chosen = (size_t)study->f.chosen;
        const double x = plot_axis_place(&along, i), limit = search_limit(study, chosen, NULL);
        row[FIRST][i] = (struct row){x, search_share(study, 0, SEARCH_OVERALL)};
        row[CHOSEN][i] = (struct row){x, search_share(study, chosen, SEARCH_OVERALL)};
        row[ALLOWED][i] = (struct row){x, {limit, {limit, limit}}};
        limited = limited && isfinite(limit);
        for (int c = 0; c < CURVES; c++) /* which is none of NAN */
            most = fmax(most, 100 * row[c][i].at.interval.high);
    }
    gnuplot_set(&g, "chart_width = 480; scaled = 1");
    gnuplot_panel(&g, 336, "");
    gnuplot_axis(&g, 'y', PLOT_LINEAR, (struct plot_range){0, fmin(104, 1.04 * most + 1)},
                 "recovered starts (%)", "");
    put_curves(&g, row, front->count, limited, 0.7);
    put_legend(&g, NULL, (const double[]){0, 0, limited ? 0 : NAN}, front->glued);
    return gnuplot_end(&g);
}

/* ---- all of them ---------------------------------------------------------------------------- */

int search_draw(struct look *look, const char *const *file, size_t files)
{
    struct search_front front;
    struct search_study study;
    stance_message message = {""};
    char own[1024];
    struct plot plot = {.directory = look_directory(look, file[0], own, sizeof own),
                        .look = look,
                        .message = &message};
    if (!gnuplot_directory(plot.directory))
        return EXIT_IO;
    const bool opened = files == 1 ? search_study_open(&study, file[0], &message)
                                   : search_front_open(&front, file, files, &message);
    const struct search_study *const first = files == 1 ? &study : front.study;
    bool good = opened;
    if (opened) {
        plot.title = first->f.title[0] ? first->f.title : first->name;
        plot.stem = first->name;
        good = files == 1 ? plot_convergence(&study, &plot) && plot_starts(&study, &plot)
                          : plot_front(&front, &plot);
    }
    if (opened && files == 1)
        search_study_close(&study);
    else if (opened)
        search_front_close(&front);
    if (!good)
        fprintf(stderr, "%s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}
