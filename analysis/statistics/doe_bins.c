/* doe_bins.c - see doe_bins.h. */
#include "doe_bins.h"

#include <math.h>
#include <stdlib.h>

struct place {
    double value;
    size_t point;
};

static int by_value(const void *left, const void *right)
{
    const struct place *a = left, *b = right;
    return a->value != b->value ? (a->value > b->value) - (a->value < b->value)
                                : (a->point > b->point) - (a->point < b->point);
}

static size_t count_values(const struct place *place, size_t n)
{
    size_t values = 1;
    for (size_t i = 1; i < n; i++)
        values += place[i].value != place[i - 1].value;
    return values;
}

static void add(struct statistics_counts *to, const struct statistics_counts *counts)
{
    for (int kind = 0; kind < RESULTS_KIND_COUNT; kind++)
        to->kind[kind] += counts->kind[kind];
    to->done += counts->done;
}

static bool find_intervals(struct doe_bins *bins, const struct results *r, const uint32_t *part)
{
    struct interval interval[SAMPLE_BINS];
    bool good = true;
    for (int kind = 0; good && kind < RESULTS_KIND_COUNT; kind++) {
        if (kind == RESULTS_PENDING || kind == RESULTS_FAILED)
            continue;
        good = intervals_find(r, (enum results_kind)kind, -1, part, bins->count, interval);
        for (size_t b = 0; good && b < bins->count; b++)
            bins->bin[b].of_kind[kind] = interval[b];
    }
    return good;
}

bool doe_bins_make(struct doe_bins *bins, const struct results *r, int k, size_t most,
                   stance_message *message)
{
    const struct results_varied *v = &r->vary[k];
    const size_t n = v->of.count;
    struct place *place = malloc(n * sizeof *place);
    struct statistics_counts *counts = malloc(n * sizeof *counts);
    uint32_t *part = malloc(n * sizeof *part); /* the bin of each point */

    *bins = (struct doe_bins){0};
    most = most < 2 ? 2 : most;
    if (!place || !counts || !part) {
        free(place);
        free(counts);
        free(part);
        return statistics_no_memory(r, message);
    }
    statistics_count_axis(r, r->sample, counts);
    for (size_t i = 0; i < n; i++)
        place[i] = (struct place){v->of.value[i], i};
    qsort(place, n, sizeof *place, by_value);
    const size_t values = count_values(place, n);
    bins->listed = values <= (v->word ? SAMPLE_BINS : most);
    for (size_t b = 0, begin = 0; begin < n; b++) {
        size_t end = (b + 1) * n / most;
        if (bins->listed) {
            for (end = begin + 1; end < n && place[end].value == place[begin].value; end++) {
            }
        } else if (end <= begin) {
            continue;
        }
        struct doe_bin *bin = &bins->bin[bins->count++];
        bin->low = place[begin].value;
        bin->high = place[end - 1].value;
        bin->centre = place[begin + (end - begin) / 2].value;
        for (size_t i = begin; i < end; i++) {
            add(&bin->counts, &counts[place[i].point]);
            part[place[i].point] = (uint32_t)(bins->count - 1);
        }
        begin = end;
    }
    const bool good = find_intervals(bins, r, part);
    free(place);
    free(counts);
    free(part);
    if (!good)
        statistics_no_memory(r, message);
    return good;
}
