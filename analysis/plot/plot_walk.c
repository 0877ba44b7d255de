/* plot_walk.c - what walks: its footfalls, and its last two steps as stick figures over forces and
 * torques. */
#include "plot_case.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    STEPS = 2,    /* are drawn, ... */
    FIGURES = 10, /* ... each in so many parts */
};

/* ---- footfalls ---------------------------------------------------------------------------- */

static bool pushes(const struct results_trajectory *t, size_t row, size_t contact)
{
    return row > 0 && row < t->rows && t->force[2 * (row * t->contacts + contact)] > 0;
}

/* A contact that was free and has been hit since the row before; -1: none has. */
int walk_hit(const struct results_trajectory *t, size_t row)
{
    for (size_t k = 0; k < t->contacts && row > 1; k++)
        if (pushes(t, row, k) && !pushes(t, row - 1, k))
            return (int)k;
    return -1;
}

/* When a contact that pushes from a row on came down: where its gap, which curves, was bound for
 * the ground. */
double walk_landed(const struct results_trajectory *t, size_t row, size_t contact)
{
    double gap[3] = {0};
    for (size_t k = 0; k < 3; k++)
        gap[k] = t->gap[(row - (row > 3 ? k + 1 : 1)) * t->contacts + contact];
    const double fall = 2 * (gap[1] - gap[0]) - (gap[2] - gap[1]);
    const double part = gap[0] > 0 && fall > 0 ? fmin(1, gap[0] / fall) : 1;
    return t->time[row - 1] + part * (t->time[row] - t->time[row - 1]);
}

double walk_end(const struct plot_case *c)
{
    double *values = NULL;
    stance_message ignored = {""};
    const bool has = results_answer(c->plot->r, "end_time", &values, &ignored) && values;
    const double end = has ? values[c->plot->r->single ? 0 : c->t->index] : NAN;
    free(values);
    return isfinite(end) ? end : c->t->time[c->t->rows - 1];
}

/* When another foot came down than the one before, as the engine counts them, the last ones; a
 * start with both feet on the ground is one, too. Returns how many. */
size_t walk_footfalls(const struct plot_case *c, double time[WALK_FOOTFALLS])
{
    const struct results_trajectory *const t = c->t;
    const stance_scene *const scene = c->scenario ? c->scenario->scene : NULL;
    size_t count = 0, made = 0;
    int foot = -1, stands = -1;
    bool both = false;
    if (!scene || !scene->exchange.any || !t->force || !t->gap)
        return 0;
    for (int k = 0; k < plot_case_grounded(scene); k++)
        if (fabs(t->gap[k]) < 1e-7) { /* both ends of a sole are one foot */
            both = both || (stands >= 0 && scene->grip[k] != stands);
            stands = scene->grip[k];
        }
    if (both)
        time[count++] = t->time[0];
    for (size_t row = 1; row < t->rows; row++)
        for (size_t k = 0; k < (size_t)plot_case_grounded(scene); k++) {
            const int own = scene->grip[k];
            if (!pushes(t, row, k) || (foot >= 0 && (own == foot || pushes(t, row - 1, k))))
                continue;
            if (foot >= 0) {
                if (count == WALK_FOOTFALLS)
                    memmove(time, time + 1, --count * sizeof *time);
                time[count++] = walk_landed(t, row, k);
                made++;
            }
            foot = own;
        }
    if (count < WALK_FOOTFALLS && c->values.footfalls > 0 &&
        made + 1 == (size_t)c->values.footfalls)
        time[count++] = walk_end(c);
    return count;
}

/* ---- two steps ---------------------------------------------------------------------------- */

/* Figures stand on the axis of time, each about the place of its instant, in the scale of heights;
 * the ground falls along the page as it does along itself. chart.gp knows when it has a width how
 * large they can be, and which are left out so that they are not on top of each other. */
static const char fit[] =
    "fit_step = width*figure_time/(x_high - x_low); "
    "fit_drop = abs(figure_fall)*width; "
    "fit_scale = at_least(110, at_most(230, 2.6*fit_step*(figure_high - figure_low)/figure_wide))"
    "/(figure_high - figure_low); "
    "panel_own[1] = fit_scale*(figure_high - figure_low) + fit_drop; "
    "y1_low = figure_low - (figure_fall > 0 ? fit_drop/fit_scale : 0); "
    "y1_high = figure_high + (figure_fall < 0 ? fit_drop/fit_scale : 0); "
    "fit_wide = fit_scale*figure_wide; "
    "every = 0.45*fit_wide < fit_step ? 1 : 0.5*fit_wide < 2*fit_step ? 2 : 5; "
    "panel_heading[1] = 'A figure each '.(every == 1 ? 'tenth of a' : every == 2 ? 'fifth of a' : "
    "'half').' step'";
/* s of the axis that are as long as one m of height. */
static const char metre[] = "metre(_) = panel_high[1]/(y1_high - y1_low)*(x_high - x_low)/width";
#define FIGURE_PLACE_ALONE                                                                         \
    "(int(($4 - figure_begin)/figure_time + 0.5)%%every ? NaN : $4 + metre(0)*$1):"                \
    "($2 - figure_fall*($4 - x_low)/metre(0))"
#define FIGURE_PLACE FIGURE_PLACE_ALONE ":(" FIGURE_COLOUR ")"

/* What is under the feet of each figure. */
static void put_plates(struct case_page *page, const struct figure *figure)
{
    const int contacts = plot_case_grounded(page->c->scenario->scene);
    gnuplot_series(&page->g, "using " FIGURE_PLACE_ALONE " with lines lw 2 lc rgb 0xa0a0a0");
    for (int i = 0; i <= STEPS * FIGURES; i++) {
        struct plot_range x = PLOT_NOTHING;
        for (int k = 0; k < contacts; k++)
            plot_widen(&x, figure[i].contact[k][0]);
        const double more = 0.1 * (x.high - x.low) + 0.02;
        plot_ground(&page->g, page->c, figure[i].time,
                    (struct plot_range){x.low - more, x.high + more}, -figure[i].centre,
                    -figure[i].base);
    }
}

static void put_figures(struct case_page *page)
{
    static struct figure figure[STEPS * FIGURES + 1]; /* large; the process has but one command */
    struct gnuplot *const g = &page->g;
    const struct plot_case *const c = page->c;
    const double begin = page->mark[0], step = (page->mark[STEPS] - begin) / (STEPS * FIGURES);
    struct plot_range height = {0, 1e-9};
    double wide = 0;

    for (int i = 0; i <= STEPS * FIGURES; i++) {
        struct plot_range range[2] = {PLOT_NOTHING, height};
        figure_make(&figure[i], c, figure_row(c->t, begin + (i + 0.1) * step));
        figure[i].open = true;
        figure_widen(range, &figure[i], 0, figure[i].base);
        height = range[1];
        wide = fmax(wide, range[0].high - range[0].low);
    }
    const double tall = height.high - height.low, fall = figure_fall(c);
    gnuplot_set(g,
                "figure_fall = %#.17g; figure_low = %#.17g; figure_high = %#.17g; "
                "figure_wide = %#.17g; figure_time = %#.17g; figure_begin = %#.17g",
                fall, height.low - 0.05 * tall, height.high + 0.05 * tall, wide, step, begin);
    gnuplot_text(g, fit, "chart_fit");
    gnuplot_set(g, "%s", metre);
    gnuplot_panel(g, 200, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, height, "height", "m");
    const int contacts = figure_colours(g, c->scenario->scene);
    gnuplot_series(g, "using 1:($2 > 0 ? y1_high : y1_low) with lines dt 3 lw 1 lc rgb 0x606060");
    for (size_t k = 0; k < page->marks; k++)
        gnuplot_segment(g, page->mark[k], 0, page->mark[k], 1);
    if (c->floor) {
        put_plates(page, figure);
    } else {
        gnuplot_series(
            g, "using 1:(-figure_fall*($1 - x_low)/metre(0)) with lines lw 2 lc rgb 0xa0a0a0");
        gnuplot_segment(g, page->time.low, 0, page->time.high, 0);
    }
    for (int part = FIGURE_SEGMENTS; part <= FIGURE_POINTS; part++) {
        gnuplot_series(g, "using " FIGURE_PLACE " with %s lc rgb variable",
                       part == FIGURE_SEGMENTS ? "lines lw 1.8" : "points pt 7 ps 0.45");
        for (int i = 0; i <= STEPS * FIGURES; i++)
            figure_put(g, &figure[i], contacts, (enum figure_part)part, -figure[i].centre,
                       -figure[i].base);
    }
}

bool plot_steps(const struct plot_case *c, bool *drawn)
{
    static double time[WALK_FOOTFALLS];
    const size_t count = c->other ? 0 : walk_footfalls(c, time);
    const double *const first = time + (count > STEPS ? count - STEPS - 1 : 0);
    const double steps = count > STEPS ? first[STEPS] - first[0] : 0;
    const enum results_kind kind = c->plot->r->kind[c->plot->r->single ? 0 : c->t->index];
    /* It still steps at its end, with instants enough in steps that take so long. */
    *drawn = count > STEPS && (kind == RESULTS_WALKS || kind == RESULTS_UNDECIDED) &&
             walk_end(c) - first[STEPS] < steps &&
             steps > FIGURES * (c->t->time[1] - c->t->time[0]);
    if (!*drawn)
        return true;
    struct case_page page = {.c = c, .mark = first, .marks = STEPS + 1};
    char what[100];
    snprintf(what, sizeof what, "Two steps, of %.4g and %.4g s", page.mark[1] - page.mark[0],
             page.mark[2] - page.mark[1]);
    if (!plot_page_begin(&page, "strip", what))
        return *drawn = false;
    put_figures(&page);
    plot_page_forces(&page, 110);
    gnuplot_legend(&page.g, "0x303030", 0, 0, "body", "");
    if (c->t->torque)
        plot_page_torques(&page, 120);
    gnuplot_note(&page.g, "dotted, upright: footfalls");
    return (*drawn = gnuplot_end(&page.g));
}
