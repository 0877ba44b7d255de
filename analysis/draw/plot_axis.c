/* plot_axis.c - scales, tics and labels of axes; the colours and legends of outcomes. */
#include "plot.h"

#include "analysis/statistics/statistics.h"

#include <math.h>
#include <string.h>

const char *const plot_colours[RESULTS_KIND_COUNT] = {
    [RESULTS_STABILISED] = "#0072b2", [RESULTS_RESTED] = "#56b4e9", [RESULTS_FELL] = "#e69f00",
    [RESULTS_UNDECIDED] = "#cc79a7",  [RESULTS_DONE] = "#009e73",   [RESULTS_FAILED] = "#000000",
    [RESULTS_PENDING] = "#e4e4e4",
};

/* ---- scales ------------------------------------------------------------------------------- */

/* value[i] or its logarithm, from the lowest. */
static double raw(const struct results_axis *axis, bool logarithm, size_t i)
{
    return logarithm ? log10(axis->value[i]) : axis->value[i];
}

static bool is_positive(const struct results_axis *axis)
{
    for (size_t i = 0; i < axis->count; i++)
        if (axis->value[i] <= 0)
            return false;
    return true;
}

static bool is_even(const struct results_axis *axis, bool logarithm)
{
    double first = raw(axis, logarithm, 0);
    double step = (raw(axis, logarithm, axis->count - 1) - first) / (double)(axis->count - 1);
    for (size_t i = 0; i < axis->count; i++)
        if (!(fabs(raw(axis, logarithm, i) - first - (double)i * step) <= 1e-5 * fabs(step)))
            return false;
    return step != 0;
}

static void make_even(struct plot_axis *along, bool logarithm)
{
    const struct results_axis *axis = along->axis;
    double first = raw(axis, logarithm, 0), last = raw(axis, logarithm, axis->count - 1);
    along->scale = logarithm ? PLOT_LOG : PLOT_LINEAR;
    along->falling = last < first;
    along->first = along->falling ? last : first;
    along->step = fabs(last - first) / (double)(axis->count - 1);
}

static void set_edges(struct plot_axis *along)
{
    along->low = along->first - 0.5 * along->step;
    along->high = along->first + ((double)along->axis->count - 0.5) * along->step;
}

void plot_axis_make(struct plot_axis *along, const struct results_axis *axis)
{
    *along = (struct plot_axis){.axis = axis, .scale = PLOT_LIST, .step = 1};
    if (!axis->word && axis->count > 1) {
        if (is_even(axis, false))
            make_even(along, false);
        else if (axis->count > 2 && is_positive(axis) && is_even(axis, true))
            make_even(along, true);
    }
    set_edges(along);
}

/* Unevenness of the spacing: standard deviation of the steps over their mean. */
static double unevenness(const struct results_axis *axis, bool logarithm)
{
    double sum = 0, squares = 0, n = (double)(axis->count - 1);
    for (size_t i = 1; i < axis->count; i++) {
        double step = fabs(raw(axis, logarithm, i) - raw(axis, logarithm, i - 1));
        sum += step;
        squares += step * step;
    }
    return sum > 0 ? sqrt(fmax(0, squares / n - sum * sum / (n * n))) / (sum / n) : 0;
}

void plot_axis_make_curve(struct plot_axis *along, const struct results_axis *axis)
{
    plot_axis_make(along, axis);
    if (along->scale != PLOT_LIST || axis->word || axis->count < 2)
        return;
    bool logarithm = is_positive(axis) && unevenness(axis, true) < 0.5 * unevenness(axis, false);
    along->scale = logarithm ? PLOT_LOG : PLOT_LINEAR;
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < axis->count; i++) {
        low = fmin(low, raw(axis, logarithm, i));
        high = fmax(high, raw(axis, logarithm, i));
    }
    double margin = high > low ? 0.03 * (high - low) : 0.5;
    along->low = low - margin;
    along->high = high + margin;
}

double plot_axis_place(const struct plot_axis *along, size_t i)
{
    return along->scale == PLOT_LIST ? (double)i : raw(along->axis, along->scale == PLOT_LOG, i);
}

size_t plot_axis_index(const struct plot_axis *along, size_t k)
{
    return along->falling ? along->axis->count - 1 - k : k;
}

/* ---- tics --------------------------------------------------------------------------------- */

double plot_round_step(double low, double high, int tics)
{
    static const double mantissas[] = {1, 2, 5, 10};
    double least = (high - low) / (tics > 1 ? tics : 1);
    if (!(least > 0) || !isfinite(least))
        return 1;
    double power = pow(10, floor(log10(least)));
    for (size_t i = 0; i < sizeof mantissas / sizeof mantissas[0]; i++)
        if (mantissas[i] * power >= least * (1 - 1e-9))
            return mantissas[i] * power;
    return 10 * power;
}

void plot_value_tics(FILE *script, double low, double high, double height)
{
    int tics = height < 160 ? 4 : (int)(height / 36);
    fprintf(script, "set ytics nomirror %.10g\n", plot_round_step(low, high, tics));
}

/* One tic with its text; a per cent sign would begin a format. */
static void put_tic(FILE *script, const char *text, double place, bool *first, bool labels)
{
    char escaped[160];
    size_t n = 0;
    for (; labels && *text && n + 3 < sizeof escaped; text++) {
        escaped[n++] = *text;
        if (*text == '%')
            escaped[n++] = '%';
    }
    escaped[n] = '\0';
    fputs(*first ? "" : ", ", script);
    gnuplot_text(script, escaped, 0);
    fprintf(script, " %.17g", place);
    *first = false;
}

static void list_tics(const struct plot_axis *along, FILE *script, int tics, bool labels)
{
    size_t every = (along->axis->count + (size_t)tics - 1) / (size_t)tics;
    bool first = true;
    char text[64];
    for (size_t i = 0; i < along->axis->count; i += every) {
        results_value_text(along->axis, i, false, text, sizeof text);
        put_tic(script, text, (double)i, &first, labels);
    }
}

static void log_tics(const struct plot_axis *along, FILE *script, int tics, bool labels)
{
    static const double mantissas[] = {1, 2, 5};
    double decades = along->high - along->low;
    int per_decade = decades * 3 <= tics ? 3 : 1;
    int every = (int)ceil(decades / tics);
    bool first = true;
    char text[32];
    for (int power = (int)floor(along->low); power <= (int)ceil(along->high); power++) {
        for (int m = 0; m < per_decade; m++) {
            double place = power + log10(mantissas[m]);
            if (place >= along->low && place <= along->high && (every <= 1 || power % every == 0)) {
                snprintf(text, sizeof text, "%g", mantissas[m] * pow(10, power));
                put_tic(script, text, place, &first, labels);
            }
        }
    }
    if (first) { /* a short axis between two of them */
        snprintf(text, sizeof text, "%.3g", pow(10, 0.5 * (along->low + along->high)));
        put_tic(script, text, 0.5 * (along->low + along->high), &first, labels);
    }
}

void plot_axis_tics(const struct plot_axis *along, FILE *script, char which, int tics, bool labels)
{
    fprintf(script, "set %crange [%.17g:%.17g]\n", which, along->low, along->high);
    if (along->scale == PLOT_LINEAR) {
        fprintf(script, "set %ctics %.10g\nset format %c '%s'\n", which,
                plot_round_step(along->low, along->high, tics), which, labels ? "%.10g" : "");
        return;
    }
    fprintf(script, "set %ctics (", which);
    if (along->scale == PLOT_LOG)
        log_tics(along, script, tics, labels);
    else
        list_tics(along, script, tics, labels);
    fputs(")\n", script);
}

/* ---- labels ------------------------------------------------------------------------------- */

/* Cuts a text to so many columns, with dots where something is lost. */
static void cut(char *text, size_t columns)
{
    if (strlen(text) > columns && columns > 3) {
        size_t end = columns - 3;
        while (end > 0 && ((unsigned char)text[end] & 0xc0) == 0x80)
            end--; /* not within a letter */
        memcpy(text + end, "...", sizeof "...");
    }
}

void plot_axis_label(const struct results_axis *axis, struct gnuplot *g, double x, double y,
                     double length, bool turned)
{
    char text[RESULTS_TEXT + 8], path[sizeof axis->name + sizeof axis->unit + 4];
    size_t columns = (size_t)(length / 6.9);

    snprintf(text, sizeof text, "%s", axis->text);
    snprintf(path, sizeof path, axis->unit[0] ? "%s (%s)" : "%s", axis->name, axis->unit);
    cut(text, columns);
    cut(path, columns);
    double dx = turned ? 17 : 0, dy = turned ? 0 : 17;
    gnuplot_label(g, x, y, text[0] ? text : path, "center", 11, turned);
    if (text[0])
        gnuplot_label(g, x + dx, y + dy, path, "center", 11, turned);
}

void plot_failed_text(const struct results *r, char *text, size_t size)
{
    struct statistics_counts counts;
    const size_t used = strlen(text);
    statistics_count(r, -1, 0, &counts);
    if (counts.kind[RESULTS_FAILED] > 0 && used < size) {
        snprintf(text + used, size - used, ", %llu failed in all",
                 (unsigned long long)counts.kind[RESULTS_FAILED]);
    }
}

double plot_kind_legend(const struct plot *plot, struct gnuplot *g, double x, double y)
{
    struct statistics_counts counts;
    double top = y;
    char text[64];
    statistics_count(plot->r, -1, 0, &counts);
    for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
        if (counts.kind[k] > 0) {
            double share = 100 * (double)counts.kind[k] / (double)plot->r->cases;
            snprintf(text, sizeof text, share < 0.05 ? "%s  %.2g %%" : "%s  %.1f %%",
                     results_kind_names[k], share);
            gnuplot_legend(g, x, y, plot_colours[k], text);
            y += 24;
        }
    }
    return y - top;
}
