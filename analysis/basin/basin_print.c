/* basin_print.c - the tables of `stance basin`, for people and as CSV. */
#include "basin_print.h"

#include "analysis/table/csv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TABLE_ROWS = 40, LABEL = 16 };

double basin_dimension(const struct basin *basin, const struct basin_row *row)
{
    return basin->start_axes - basin_exponent(&row->uncertainty).alpha;
}

/* ---- text --------------------------------------------------------------------------------- */

/* What the points of a design make of the interval. */
static const char *interval_reason(enum doe_method method)
{
    switch (method) {
    case DOE_LHS:
        return "of independent points; conservative, as Latin hypercubes scatter less";
    case DOE_SOBOL:
        return "of independent points; conservative, mostly by far: Sobol' points scatter less";
    case DOE_SALTELLI:
        return "of the first and the last point of each block, as if independent; the others "
               "repeat them";
    default:
        return "of independent points";
    }
}

/* What rows are averaged over, where they are. */
static void print_averaged(const struct basin *b)
{
    enum { MOST = 64, WIDTH = 96 };
    const char *path[MOST];
    const size_t count = basin_averaged(b, path, MOST);
    size_t column = 0;
    for (size_t k = 0; k < count; k++) {
        const char *before = k == 0                                 ? "  averaged over "
                             : column + strlen(path[k]) + 2 > WIDTH ? ",\n    "
                                                                    : ", ";
        column = before[0] == ',' && before[1] == ' ' ? column : 0;
        column += (size_t)printf("%s%s", before, path[k]);
    }
    if (count > 0)
        putchar('\n');
    if (b->averaged >= 0) {
        printf("  (%zu sampled points, %s%s: +- has their scatter in it, bounds have not)\n",
               b->sample.points, doe_words[b->sample.method],
               b->sample.method == DOE_MORRIS ? ", on levels of the ranges" : "");
    }
}

static void print_sample(const struct basin *b)
{
    const struct basin_sample *sample = &b->sample;
    printf("\n\nStarts that end as %s, of %zu points (%s) over\n", results_kind_names[b->choice.of],
           sample->points, doe_words[sample->method]);
    for (size_t k = 0; k < sample->factors; k++) {
        const struct basin_factor *factor = &sample->factor[k];
        printf("  %-24s", factor->of->name);
        if (isnan(factor->from))
            puts(" not evenly over a range: no volume, shares alone");
        else
            printf(" %.6g ... %.6g %s\n", factor->from, factor->to, factor->of->unit);
    }
    if (isfinite(sample->box))
        printf("  a box of %.6g%s%s\n", b->box, b->unit[0] ? " " : "", b->unit);
    if (sample->others)
        puts("  averaged over what else is sampled");
    print_averaged(b);
    printf("  interval: %s\n", interval_reason(sample->method));
}

static void print_head(const struct basin *b)
{
    const struct results *r = b->r;
    uint64_t failed = 0, pending = 0;
    for (size_t k = 0; k < b->rows; k++) {
        failed += b->row[k].failed;
        pending += b->row[k].pending;
    }
    printf("%s\n%s: %llu cases", r->title[0] ? r->title : r->name, r->file,
           (unsigned long long)r->cases);
    if (failed + pending > 0) {
        printf(", %llu failed, %llu pending", (unsigned long long)failed,
               (unsigned long long)pending);
    }
    if (b->starts == BASIN_SAMPLE) {
        print_sample(b);
        return;
    }
    printf("\n\nStarts that end as %s, on a grid over\n", results_kind_names[b->choice.of]);
    for (int d = 0; d < b->start_axes; d++) {
        const struct results_axis *axis = &r->axis[b->start[d]];
        char first[64], last[64];
        results_value_text(axis, 0, false, first, sizeof first);
        results_value_text(axis, axis->count - 1, true, last, sizeof last);
        printf("  %-24s %s ... %s, %zu places\n", axis->name, first, last, axis->count);
    }
    printf("  a box of %.6g%s%s\n", b->box, b->unit[0] ? " " : "", b->unit);
    print_averaged(b);
}

static void print_labels(const struct basin *b, const struct basin_row *row)
{
    char text[128];
    fputs(" ", stdout);
    for (int k = 0; k < b->by_axes; k++) {
        const int a = b->by[k];
        results_value_text(&b->r->axis[a], row ? row->point[a] : 0, false, text, sizeof text);
        printf(" %*s", LABEL, row ? text : b->r->axis[a].name);
    }
}

/* A number in its column, "-" where there is none. */
static void print_number(int width, const char *format, double value)
{
    char text[64] = "-";
    if (isfinite(value))
        snprintf(text, sizeof text, format, value);
    printf(" %*s", width, text);
}

static void print_volume(const struct basin *b, const struct basin_row *row)
{
    char text[64];
    print_labels(b, row);
    print_number(9, "%.3f %%", 100 * row->volume / b->box);
    print_number(11, "%.5g", row->volume);
    print_number(9, "%.2g", row->reach);
    snprintf(text, sizeof text, "%.5g ... %.5g", row->low, row->high);
    printf("   %-25s %10llu of %-10llu", text, (unsigned long long)row->inside,
           (unsigned long long)row->cases);
    if (row->failed + row->pending > 0) {
        printf(" %llu failed, %llu pending", (unsigned long long)row->failed,
               (unsigned long long)row->pending);
    }
    putchar('\n');
}

static void print_shape(const struct basin *b, const struct basin_row *row)
{
    const struct basin_exponent exponent = basin_exponent(&row->uncertainty);
    const double s_bb = basin_boundary_entropy(&row->entropy);
    print_labels(b, row);
    print_number(9, "%.4f", basin_entropy(&row->entropy));
    print_number(9, "%.4f", s_bb);
    putchar(basin_is_fractal(&row->entropy, &row->uncertainty) ? '*' : ' ');
    printf(" %8llu of %-8llu", (unsigned long long)row->entropy.mixed,
           (unsigned long long)row->entropy.boxes);
    print_number(8, "%.3f", exponent.alpha);
    print_number(8, "%.3f", exponent.error);
    print_number(10, "%.3f", basin_dimension(b, row));
    print_number(9, "%.4f", row->has_distance ? row->distance.nearest : NAN);
    putchar('\n');
}

/* Row k of those shown: all, or some spread over them. */
static const struct basin_row *shown(const struct basin *b, size_t k, size_t rows)
{
    return &b->row[rows == b->rows || rows < 2 ? k : k * (b->rows - 1) / (rows - 1)];
}

static void print_left_out(const struct basin *b, size_t rows)
{
    if (rows < b->rows)
        printf("  (%zu of %zu rows; --csv and --json have them all)\n", rows, b->rows);
}

static void print_distance(const struct basin *b, const struct basin_row *row)
{
    const struct basin_distance *distance = &row->distance;
    if (!distance->inside) {
        printf("\nThe start nearest to the equilibrium is not %s.\n",
               results_kind_names[b->choice.of]);
        return;
    }
    puts("\nFrom the equilibrium to the end of the outcome");
    for (int d = 0; d < b->start_axes; d++) {
        const struct results_axis *axis = &b->r->axis[b->start[d]];
        printf("  along %-24s", axis->name);
        print_number(12, "%.6g", distance->low[d]);
        printf(" ...");
        print_number(12, "%.6g", distance->high[d]);
        printf(" %s\n", axis->unit);
    }
    if (isfinite(distance->nearest)) {
        printf("  nearest, offsets in units of their ranges: %.4g, at", distance->nearest);
        for (int d = 0; d < b->start_axes; d++) {
            const struct results_axis *axis = &b->r->axis[b->start[d]];
            printf("%s %s = %.4g %s", d ? "," : "", axis->name, distance->at[d], axis->unit);
        }
        putchar('\n');
    }
    puts("  (- where the outcome reaches the end of the axis, or a case that is not known)");
}

bool basin_print_text(const struct basin *b)
{
    const size_t rows = b->rows < TABLE_ROWS ? b->rows : TABLE_ROWS;
    char level[32];

    print_head(b);
    puts("\nVolume");
    snprintf(level, sizeof level, "+- %.4g %%", 100 * b->choice.level);
    print_labels(b, NULL);
    printf(" %9s %11s %9s   %-25s %10s\n", "share", "volume", level,
           b->starts == BASIN_GRID ? "bounds" : "interval", "cases");
    for (size_t k = 0; k < rows; k++)
        print_volume(b, shown(b, k, rows));
    if (b->starts == BASIN_SAMPLE) {
        print_left_out(b, rows);
        return true;
    }
    puts("\nBoundary");
    print_labels(b, NULL);
    printf(" %9s %9s  %8s of %-8s %8s %8s %10s %9s\n", "S_b", "S_bb", "mixed", "boxes", "alpha",
           "+- 1 sd", "dimension", "nearest");
    bool starred = false;
    size_t refused[BASIN_REFUSALS] = {0};
    for (size_t k = 0; k < rows; k++) {
        print_shape(b, shown(b, k, rows));
        const struct basin_row *row = shown(b, k, rows);
        starred = starred || basin_is_fractal(&row->entropy, &row->uncertainty);
        refused[basin_exponent(&row->uncertainty).refusal]++;
    }
    if (starred) {
        puts("  (* above log 2 by more than its interval, alpha below 1 by more than its own: "
             "fractal)");
    }
    for (int k = BASIN_FITTED + 1; k < BASIN_REFUSALS; k++) {
        if (refused[k] > 0) {
            printf("  (no alpha%s: %s)\n", rows > 1 ? " in some rows" : "",
                   basin_refusal_text((enum basin_refusal)k));
        }
    }
    print_left_out(b, rows);
    if (b->rows == 1 && b->row[0].has_distance)
        print_distance(b, &b->row[0]);
    return true;
}

/* ---- CSV ---------------------------------------------------------------------------------- */

static void put_value(struct csv *csv, const struct results_axis *axis, size_t i)
{
    if (axis->word)
        csv_text(csv, axis->word[i]);
    else
        csv_number(csv, axis->value[i]);
}

static void put_csv_row(struct csv *csv, const struct basin *b, const struct basin_row *row)
{
    const struct basin_exponent exponent = basin_exponent(&row->uncertainty);
    const double numbers[] = {
        (double)row->cases,
        (double)row->inside,
        (double)row->failed,
        (double)row->pending,
        row->volume / b->box,
        row->volume,
        row->reach,
        row->low,
        row->high,
        basin_entropy(&row->entropy),
        basin_boundary_entropy(&row->entropy),
        (double)row->entropy.boxes,
        (double)row->entropy.mixed,
        exponent.alpha,
        exponent.error,
        exponent.scales,
        basin_dimension(b, row),
        row->has_distance ? row->distance.nearest : NAN,
    };
    for (int k = 0; k < b->by_axes; k++)
        put_value(csv, &b->r->axis[b->by[k]], row->point[b->by[k]]);
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
        csv_number(csv, numbers[k]);
    csv_end_row(csv);
}

bool basin_print_csv(const struct basin *b)
{
    static const char *const names[] = {
        "cases",
        "inside",
        "failed",
        "pending",
        "share",
        "volume",
        "reach",
        "low",
        "high",
        "entropy",
        "boundary_entropy",
        "boxes",
        "mixed_boxes",
        "alpha",
        "alpha_error",
        "alpha_distances",
        "dimension",
        "nearest",
    };
    struct csv csv = {.file = stdout};
    for (int k = 0; k < b->by_axes; k++)
        csv_text(&csv, b->r->axis[b->by[k]].name);
    csv_row(&csv, names, sizeof names / sizeof names[0]);
    for (size_t k = 0; k < b->rows; k++)
        put_csv_row(&csv, b, &b->row[k]);
    return !ferror(stdout);
}

static bool put_crossing(void *context, const struct basin_slice *slice,
                         const struct basin_crossing *crossing)
{
    struct csv *csv = context;
    const struct basin *b = slice->basin;
    for (int a = 0, d = 0; a < b->r->axes; a++) {
        if (d == b->start_axes || b->start[d] != a) {
            put_value(csv, &b->r->axis[a], slice->point[a]);
            continue;
        }
        csv_number(csv, d == crossing->axis ? crossing->middle
                                            : slice->map.place[d][crossing->point[d]]);
        d++;
    }
    csv_text(csv, b->r->axis[b->start[crossing->axis]].name);
    csv_number(csv, crossing->half_width);
    csv_text(csv, results_kind_names[crossing->from]);
    csv_text(csv, results_kind_names[crossing->to]);
    csv_end_row(csv);
    return !ferror(csv->file);
}

bool basin_print_boundary(const struct basin *b)
{
    static const char *const names[] = {"along", "half_width", "from", "to"};
    struct csv csv = {.file = stdout};
    for (int a = 0; a < b->r->axes; a++)
        csv_text(&csv, b->r->axis[a].name);
    csv_row(&csv, names, sizeof names / sizeof names[0]);
    return basin_boundary(b, put_crossing, &csv);
}
