/* chart.c - what scripts are told of a picture: texts, numbers, data blocks, panels, axes, series,
 * legend. */
#include "gnuplot.h"

#include "runner/store/results.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* As printf has it: to the data; to the end of a text. */
#define PUT_FORMATTED(g, format)                                                                   \
    do {                                                                                           \
        va_list arguments;                                                                         \
        va_start(arguments, format);                                                               \
        vfprintf((g)->data, format, arguments);                                                    \
        va_end(arguments);                                                                         \
    } while (0)
#define ADD_FORMATTED(text, format)                                                                \
    do {                                                                                           \
        va_list arguments;                                                                         \
        va_start(arguments, format);                                                               \
        vsnprintf((text) + strlen(text), sizeof(text) - strlen(text), format, arguments);          \
        va_end(arguments);                                                                         \
    } while (0)

/* ---- texts and numbers -------------------------------------------------------------------- */

/* In single quotes gnuplot expands nothing; a quote itself is doubled. */
void gnuplot_quote(FILE *out, const char *text)
{
    putc('\'', out);
    while (*text) {
        int length = results_letter(text);
        if ((unsigned char)*text <= ' ' || *text == 0x7f)
            putc(' ', out);
        else if (length == 0)
            putc('?', out);
        else if (*text == '\'')
            fputs("''", out);
        else
            fwrite(text, 1, (size_t)length, out);
        text += length > 0 ? length : 1;
    }
    putc('\'', out);
}

static void close_block(struct gnuplot *g)
{
    if (g->rows == 0)
        fputs("NaN NaN NaN NaN NaN NaN NaN NaN\n", g->data);
    if (g->rows >= 0)
        fputs("EOD\n", g->data);
    g->rows = -1;
}

void gnuplot_say(struct gnuplot *g, const char *format, ...)
{
    ADD_FORMATTED(g->subtitle, format);
}

void gnuplot_set(struct gnuplot *g, const char *format, ...)
{
    close_block(g);
    PUT_FORMATTED(g, format);
    putc('\n', g->data);
}

void gnuplot_arrays(struct gnuplot *g, size_t size, const char *names)
{
    for (size_t length; *names; names += length + (names[length] == ' ')) {
        length = strcspn(names, " ");
        gnuplot_set(g, "array %.*s[%zu]", (int)length, names, size);
    }
}

void gnuplot_text(struct gnuplot *g, const char *text, const char *name, ...)
{
    close_block(g);
    PUT_FORMATTED(g, name);
    fputs(" = ", g->data);
    gnuplot_quote(g->data, text);
    putc('\n', g->data);
}

void gnuplot_number(struct gnuplot *g, double value, const char *name, ...)
{
    close_block(g);
    PUT_FORMATTED(g, name);
    if (isfinite(value))
        fprintf(g->data, " = %#.17g\n", value); /* always real: gnuplot divides integers */
    else
        fputs(" = NaN\n", g->data);
}

/* ---- rows --------------------------------------------------------------------------------- */

void gnuplot_row(struct gnuplot *g, const double *values, size_t count)
{
    g->rows = 1;
    for (size_t i = 0; i < count; i++) {
        fputs(i ? " " : "", g->data);
        if (isfinite(values[i]))
            fprintf(g->data, "%.17g", values[i]);
        else
            fputs("NaN", g->data);
    }
    putc('\n', g->data);
}

void gnuplot_segment(struct gnuplot *g, double x, double y, double x_end, double y_end)
{
    GNUPLOT_ROW(g, x, y);
    GNUPLOT_ROW(g, x_end, y_end);
    gnuplot_gap(g);
}

void gnuplot_gap(struct gnuplot *g)
{
    putc('\n', g->data);
}

/* ---- panels ------------------------------------------------------------------------------- */

void plot_widen(struct plot_range *range, double value)
{
    if (isfinite(value)) {
        range->low = fmin(range->low, value);
        range->high = fmax(range->high, value);
    }
}

bool plot_range_of(struct plot_range *range, const double *values, size_t n)
{
    *range = PLOT_NOTHING;
    for (size_t i = 0; i < n; i++)
        plot_widen(range, values[i]);
    return range->low <= range->high;
}

struct plot_range plot_roomy(struct plot_range range, double part)
{
    const double room = range.high > range.low ? part * (range.high - range.low) : 0.5;
    return range.low <= range.high ? (struct plot_range){range.low - room, range.high + room}
                                   : (struct plot_range){0, 1};
}

const char *gnuplot_axis(struct gnuplot *g, char which, enum plot_scale scale,
                         struct plot_range range, const char *name, const char *unit)
{
    static const char *const scales[] = {
        [PLOT_LINEAR] = "linear", [PLOT_LOG] = "log", [PLOT_LIST] = "list"};
    char *const axis = g->axis, label[400];
    snprintf(axis, sizeof g->axis, g->panels ? "%c%d" : "%c", which, g->panels);
    snprintf(label, sizeof label, unit[0] ? "%s (%s)" : "%s", name, unit);
    gnuplot_text(g, "", "%s_text", axis);
    gnuplot_text(g, label, "%s_path", axis);
    gnuplot_set(g, "%s_scale = '%s'\n%s_low = %#.17g\n%s_high = %#.17g", axis, scales[scale], axis,
                range.low, axis, range.high);
    gnuplot_set(g, g->panels ? "panel_%c[panels] = '%s'" : "shared_%c = '%s'", which, axis);
    if (scale == PLOT_LIST)
        gnuplot_set(g, "%s_words = 0; array %s_word[%d]; array %s_at[%d]", axis, axis,
                    GNUPLOT_MOST_WORDS, axis, GNUPLOT_MOST_WORDS);
    return axis;
}

void gnuplot_word(struct gnuplot *g, double place, const char *text)
{
    char escaped[160]; /* a per cent sign would begin a format */
    size_t n = 0;
    for (; *text && n + 3 < sizeof escaped; text++) {
        escaped[n++] = *text;
        if (*text == '%')
            escaped[n++] = '%';
    }
    escaped[n] = '\0';
    gnuplot_set(g, "%1$s_words = %1$s_words + 1; %1$s_at[%1$s_words] = %2$#.17g", g->axis, place);
    gnuplot_text(g, escaped, "%1$s_word[%1$s_words]", g->axis);
}

void gnuplot_panel(struct gnuplot *g, double height, const char *heading)
{
    g->panels++;
    gnuplot_set(g,
                "panels = panels + 1; panel_own[panels] = %g; panel_x[panels] = 'x'; "
                "panel_y[panels] = shared_y; eval new_panel",
                height);
    if (heading[0])
        gnuplot_text(g, heading, "panel_heading[panels]");
}

void gnuplot_series(struct gnuplot *g, const char *style, ...)
{
    const int number = ++g->series;
    close_block(g);
    fprintf(g->data, "panel_plot[panels] = panel_plot[panels].\", '$series%d' ", number);
    PUT_FORMATTED(g, style);
    fprintf(g->data, " notitle\"\n$series%d << EOD\n", number);
    g->rows = 0;
}

/* ---- legend ------------------------------------------------------------------------------- */

const char *gnuplot_hue(size_t k)
{
    static const char *const hues[] = {"hue[1]", "hue[2]", "hue[3]", "hue[4]",
                                       "hue[5]", "hue[6]", "hue[7]"};
    return hues[k % (sizeof hues / sizeof *hues)];
}

int gnuplot_mark(size_t k)
{
    static const int types[] = {7, 5, 9, 11, 15, 13};
    return types[k % (sizeof types / sizeof *types)];
}

double gnuplot_dot(size_t n)
{
    return n > 4000 ? 0.25 : n > 400 ? 0.4 : n > 100 ? 0.6 : 0.8;
}

void gnuplot_cross(struct gnuplot *g, double x, double y)
{
    gnuplot_series(g, "using 1:2 with points pt 1 ps 1.6 lw 4.5 lc rgb 'white' notitle, '' using "
                      "1:2 with points pt 1 ps 1.4 lw 2 lc rgb 0x000000");
    GNUPLOT_ROW(g, x, y);
}

void gnuplot_colour(struct gnuplot *g, const char *colour, const char *name)
{
    const char *value = look_colour(g->plot->look, name);
    if (value)
        gnuplot_set(g, "%s = 0x%s", colour, value + 1);
}

void gnuplot_legend(struct gnuplot *g, const char *colour, int dash, int point, const char *name,
                    const char *more)
{
    char text[400];
    gnuplot_colour(g, colour, name);
    snprintf(text, sizeof text, "%s%s%s", look_label(g->plot->look, name), more[0] ? "  " : "",
             more);
    gnuplot_set(g,
                "legends = legends + 1; legend_colour[legends] = %s; legend_dash[legends] = %d; "
                "legend_point[legends] = %d",
                colour, dash, point);
    gnuplot_text(g, text, "legend_text[legends]");
    gnuplot_set(g, "legend_about[legends] = ''");
}

void gnuplot_about(struct gnuplot *g, const char *format, ...)
{
    char text[200] = "";
    ADD_FORMATTED(text, format);
    gnuplot_text(g, text, "about");
    gnuplot_set(g, "legend_about[legends] = legend_about[legends].\"\\n\".wrap(about, 44)");
}

void gnuplot_note(struct gnuplot *g, const char *format, ...)
{
    char text[400] = "";
    ADD_FORMATTED(text, format);
    gnuplot_text(g, text, "notes = notes + 1; note[notes]");
}
