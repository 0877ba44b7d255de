/* doe_bins.c - see doe_bins.h. */
#include "doe_bins.h"

#include <stdlib.h>

bool doe_bins_make(struct doe_bins *bins, const struct results *r, int k, size_t most,
                   stance_message *message)
{
    const struct results_varied *v = &r->vary[k];
    const size_t n = v->of.count;
    struct statistics_place *place = statistics_ordered(v->of.value, n);
    struct statistics_counts *counts = malloc(n * sizeof *counts);
    uint32_t *part = malloc(n * sizeof *part); /* the bin of each point */

    bool good = place && counts && part;
    size_t values = 1;

    *bins = (struct doe_bins){0};
    most = most < 2 ? 2 : most;
    if (good)
        statistics_count_axis(r, r->sample, counts);
    for (size_t i = 1; good && i < n; i++)
        values += place[i].value != place[i - 1].value;
    bins->listed = values <= (v->word ? SAMPLE_BINS : most);
    for (size_t b = 0, begin = 0; good && begin < n; b++) {
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
            const struct statistics_counts *own = &counts[place[i].index];
            for (int kind = 0; kind < RESULTS_KIND_COUNT; kind++)
                bin->counts.kind[kind] += own->kind[kind];
            bin->counts.done += own->done;
            part[place[i].index] = (uint32_t)(bins->count - 1);
        }
        begin = end;
    }
    for (int kind = 0; good && kind < RESULTS_OUTCOMES; kind++) {
        struct interval interval[SAMPLE_BINS];
        good = intervals_find(r, (enum results_kind)kind, -1, part, bins->count, interval);
        for (size_t b = 0; good && b < bins->count; b++)
            bins->bin[b].of_kind[kind] = interval[b];
    }
    free(place);
    free(counts);
    free(part);
    return good || statistics_no_memory(r, message);
}
