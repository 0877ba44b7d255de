/* summary_sample.c - what `stance summary` prints of a sample. */
#include "summary.h"

#include <math.h>
#include <string.h>

static const char *judged_word(const struct summary *summary)
{
    return summary->judged == RESULTS_RESTED ? "Rested" : "Stabilised";
}

void summary_print_varied(const struct results *r, int width)
{
    char first[128], last[128];
    for (int k = 0; k < r->varied; k++) {
        const struct results_varied *v = &r->vary[k];
        size_t low = 0, high = 0;
        for (size_t i = 1; i < v->of.count; i++) {
            low = v->of.value[i] < v->of.value[low] ? i : low;
            high = v->of.value[i] > v->of.value[high] ? i : high;
        }
        results_varied_text(v, low, false, first, sizeof first);
        results_varied_text(v, high, true, last, sizeof last);
        printf("    %-*s  %s ... %s%s%s\n", width, v->of.name, first, last,
               v->of.text[0] ? "; " : "", v->of.text);
    }
}

/* "0.1 ... 0.3", a value or a word. */
static void bin_text(const struct results_varied *v, const struct doe_bins *bins,
                     const struct doe_bin *bin, char *text, size_t size)
{
    double value = bin->low;
    struct results_varied one = *v;
    if (bins->listed) {
        one.of.value = &value;
        results_varied_text(&one, 0, false, text, size);
    } else {
        snprintf(text, size, "%.4g ... %.4g", bin->low, bin->high);
    }
}

static void print_bins(const struct summary *summary, const struct results *r, int k)
{
    const struct results_varied *v = &r->vary[k];
    const struct doe_bins *bins = &summary->bins[k];
    char text[160];

    for (size_t b = 0; b < bins->count; b++) {
        const struct statistics_counts *counts = &bins->bin[b].counts;
        const uint64_t judged = counts->kind[summary->judged];
        bin_text(v, bins, &bins->bin[b], text, sizeof text);
        printf("  %-32s %24s %9llu", b == 0 ? v->of.name : "", text,
               (unsigned long long)counts->done);
        if (counts->done == 0) {
            puts("         -   none done");
            continue;
        }
        const struct interval *interval = &bins->bin[b].of_kind[summary->judged];
        printf("  %7.3f %%   %.3f ... %.3f %%\n", 100 * (double)judged / (double)counts->done,
               100 * interval->low, 100 * interval->high);
    }
}

static void print_rays(const struct summary *summary, const struct results *r)
{
    const struct summary_rays *rays = summary->rays;
    const struct results_axis *axis = &r->axis[summary->ray_axis];
    const struct statistics_numbers *n = &rays->numbers;
    char text[128];

    printf("\nWhere the stabilised set through the equilibrium ends along %s\n", axis->name);
    if (n->n > 0) {
        printf("  smallest %.6g, median %.6g, largest %.6g %s%sof %zu points", n->low, n->median,
               n->high, axis->unit, axis->unit[0] ? " " : "", n->n);
        if (rays->open > 0) {
            printf(", of which %zu reach%s the end of the axis", rays->open,
                   rays->open == 1 ? "es" : "");
        }
        printf("\n  the smallest at point %zu:", rays->nearest);
        for (int k = 0; k < r->varied; k++) {
            double value = summary_nearest(rays, r, k);
            struct results_varied one = r->vary[k];
            one.of.value = &value;
            results_varied_text(&one, 0, true, text, sizeof text);
            printf("%s %s = %s", k ? "," : "", one.of.name, text);
        }
        putchar('\n');
    }
    if (rays->none > 0) {
        printf(
            "  none at %zu points, where the case nearest to the equilibrium is not stabilised\n",
            rays->none);
    }
    if (rays->unknown > 0)
        printf("  unknown at %zu points, where cases are pending or failed\n", rays->unknown);
}

void summary_print_sample(const struct summary *summary, const struct results *r)
{
    if (summary->rays)
        print_rays(summary, r);
    if (!summary->bins)
        return;
    printf("\n%s against what the sample varies, in parts of equally many points\n  %-32s %24s %9s "
           "%10s   %s\n",
           judged_word(summary), "", "values", "done", "share", "95 % interval");
    for (int k = 0; k < r->varied; k++)
        print_bins(summary, r, k);
    if (r->axes > 1)
        puts("  (intervals: cases of a point are not independent; what scatters are points)");
}
