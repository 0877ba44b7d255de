/* plot_along.c - a gait followed along a number: multipliers, speed and the times of its steps,
 * with those that the robot comes to from slightly off it. */
#include "gait.h"

#include "analysis/draw/gnuplot.h"
#include "runner/scenario/schema.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct picture {
    struct gnuplot g;
    const struct along *along;
    const struct along_gait *gait;
    size_t count;
};

/* The next panel, with a line where each flip or fold is. */
static void put_panel(struct picture *p, double height, struct plot_range range, const char *name,
                      const char *unit)
{
    gnuplot_panel(&p->g, height, "");
    gnuplot_axis(&p->g, 'y', PLOT_LINEAR, plot_roomy(range, 0.06), name, unit);
    range = plot_roomy(range, 0.059); /* what ends outside is not drawn */
    gnuplot_series(&p->g, "using 1:2 with lines dt 3 lw 1.4 lc rgb 0x606060");
    for (size_t k = 0; k < p->count; k++)
        if (p->gait[k].place)
            gnuplot_segment(&p->g, p->gait[k].value, range.low, p->gait[k].value, range.high);
}

static double step_time(const struct picture *p, const struct along_gait *gait)
{
    return gait->period / p->along->steps;
}

static double speed(const struct picture *p, const struct along_gait *gait)
{
    (void)p;
    return gait->length / gait->period;
}

/* A panel with a number of each gait as a line, dashed where the gait does not hold; `range` holds
 * what else is drawn. */
static void put_gaits(struct picture *p, double height, struct plot_range range, const char *name,
                      const char *unit,
                      double (*number)(const struct picture *, const struct along_gait *))
{
    for (size_t k = 0; k < p->count; k++)
        plot_widen(&range, number(p, &p->gait[k]));
    put_panel(p, height, range, name, unit);
    for (int stable = 1; stable >= 0; stable--) {
        gnuplot_series(&p->g, "using 1:2 with lines dt %d lw 1.8 lc rgb hue[1]", stable ? 1 : 2);
        for (size_t k = 0; k < p->count; k++) {
            const struct along_gait *const gait = &p->gait[k];
            if (gait->stable == stable || gait->place)
                GNUPLOT_ROW(&p->g, gait->value, number(p, gait));
            else
                gnuplot_gap(&p->g);
        }
    }
}

static void put_times(struct picture *p)
{
    struct plot_range range = PLOT_NOTHING;
    for (size_t k = 0; k < p->count; k++)
        for (int i = 0; i < p->gait[k].settled; i++)
            plot_widen(&range, p->gait[k].time[i]);
    put_gaits(p, 220, range, "time of a step", "s", step_time);
    gnuplot_series(&p->g, "using 1:2 with points pt 7 ps 0.35 lc rgb hue[2]");
    for (size_t k = 0; k < p->count; k++)
        for (int i = 0; i < p->gait[k].settled; i++)
            GNUPLOT_ROW(&p->g, p->gait[k].value, p->gait[k].time[i]);
}

static void put_multipliers(struct picture *p, struct plot_range along)
{
    struct plot_range range = {-1, 1};
    for (size_t k = 0; k < p->count; k++)
        for (int i = 0; i < p->gait[k].n; i++)
            plot_widen(&range, p->gait[k].re[i]);
    put_panel(p, 220, range, "multipliers of a step", "");
    gnuplot_series(&p->g, "using 1:2 with lines lw 1 lc rgb 0x606060");
    for (int sign = -1; sign <= 1; sign += 2)
        gnuplot_segment(&p->g, along.low, sign, along.high, sign);
    for (int paired = 0; paired < 2; paired++) {
        gnuplot_series(&p->g, "using 1:2 with points pt %d ps 0.6 lc rgb %s", paired ? 6 : 7,
                       paired ? "hue[4]" : "hue[1]");
        for (size_t k = 0; k < p->count; k++)
            for (int i = 0; i < p->gait[k].n; i++) {
                const double re = p->gait[k].re[i], im = p->gait[k].im[i];
                if (im >= 0 && (im > 0) == paired)
                    GNUPLOT_ROW(&p->g, p->gait[k].value, paired ? hypot(re, im) : re);
            }
    }
}

static const char *unit_of(const struct scenario *s, const char *path)
{
    static char unit[24];
    struct schema *own = NULL;
    size_t index[2];
    const struct schema *const schema = schema_of(s->scene, &s->law, &own);
    const struct scenario_field *const field =
        schema ? schema_find_concrete(schema, path, index) : NULL;
    snprintf(unit, sizeof unit, "%s", field && strcmp(field->unit, "1") != 0 ? field->unit : "");
    free(own);
    return unit;
}

int along_draw(const struct scenario *s, const struct along *along, const struct along_gait *gait,
               size_t count)
{
    stance_message message = {""};
    const struct plot plot = {.title = s->title[0] ? s->title : s->name,
                              .directory = ".",
                              .stem = s->name,
                              .look = along->look,
                              .message = &message};
    struct picture p = {.along = along, .gait = gait, .count = count};
    struct plot_range range = PLOT_NOTHING;
    bool good = gnuplot_begin(&p.g, &plot, "along");
    if (good) {
        for (size_t k = 0; k < count; k++)
            plot_widen(&range, gait[k].value);
        range = plot_roomy(range, 0.02);
        gnuplot_say(&p.g, "Gaits of %d step%s, and what it comes to from slightly off each",
                    along->steps, along->steps == 1 ? "" : "s");
        gnuplot_axis(&p.g, 'x', PLOT_LINEAR, range, along->path, unit_of(s, along->path));
        put_times(&p);
        put_gaits(&p, 110, PLOT_NOTHING, "speed", "m/s", speed);
        put_multipliers(&p, range);
        gnuplot_legend(&p.g, "hue[1]", 1, 0, "gait that holds", "");
        gnuplot_legend(&p.g, "hue[1]", 2, 0, "gait that does not", "");
        gnuplot_legend(&p.g, "hue[2]", 0, 7, "settled steps", "");
        gnuplot_about(&p.g, "16 after %d footfalls; none: it falls", ALONG_WALKED);
        gnuplot_legend(&p.g, "hue[1]", 0, 7, "real multiplier", "");
        gnuplot_legend(&p.g, "hue[4]", 0, 6, "complex ones", "");
        gnuplot_about(&p.g, "their modulus");
        for (size_t k = 0; k < count && p.g.panels; k++)
            if (gait[k].place)
                gnuplot_note(&p.g, "dotted: %s at %.7g", gait[k].place, gait[k].value);
        good = gnuplot_end(&p.g);
    }
    if (!good)
        fprintf(stderr, "stance gait: %s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}
