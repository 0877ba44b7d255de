/* critical.c - critical values of a results file, a row for each point of its other axes. */
#include "critical.h"

#include "analysis/basin/basin.h"
#include "runner/base/command.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- which axis, and which of its values --------------------------------------------------- */

/* The one axis that sweep.refine refines; -1: none, or several. */
static int refined_axis(const struct results *r)
{
    const struct scenario *const s = r->single ? NULL : r->read;
    int found = -1, axes = 0;
    for (int a = 0; s && s->refine.given && a < s->axes && a < r->axes; a++)
        if (s->axis[a].refined)
            axes++, found = a;
    return axes == 1 ? found : -1;
}

bool critical_is_refined(const struct results *r)
{
    return refined_axis(r) >= 0;
}

static bool find_axis(struct critical *c, const char *of, double ends[2], stance_message *message)
{
    const struct results *const r = c->r;
    char path[96] = "", meant[128];
    ends[0] = ends[1] = NAN;
    if (of && strchr(of, '=') && !option_range(of, path, ends))
        return complain(message,
                        "stance critical: --of takes PATH or PATH=FROM..TO, two different finite "
                        "numbers, not '%.60s'",
                        of);
    if (of && !path[0])
        snprintf(path, sizeof path, "%.95s", of);
    /* Without one the only axis of the grid, else the refined one. */
    int axes = 0;
    c->along = -1;
    for (int a = 0; a < r->axes; a++)
        if (a != r->sample && (of ? strcmp(r->axis[a].name, path) == 0 : r->axis[a].count > 1))
            axes++, c->along = a;
    if (!of && axes != 1)
        c->along = refined_axis(r);
    if (c->along < 0 && !of)
        return complain(message,
                        r->axes > (r->sample >= 0)
                            ? "stance critical: %.150s has several axes: --of PATH says along which"
                            : "stance critical: %.150s has no axis of a grid to go along",
                        r->file);
    return (c->along >= 0 && statistics_is_monotone(&r->axis[c->along])) ||
           complain(message,
                    "stance critical: --of needs the PATH of an axis of the grid whose values rise "
                    "or fall, not '%.60s'%s",
                    path, c->along < 0 ? basin_meant(r, path, meant) : "");
}

/* Those from the first to the second of two ends, in that order; NAN: all, as they stand. */
static bool take_values(struct critical *c, const double ends[2], stance_message *message)
{
    const struct results_axis *const axis = &c->r->axis[c->along];
    const bool all = isnan(ends[0]);
    const bool turned = !all && (ends[1] > ends[0]) != (axis->value[1] > axis->value[0]);
    const double last = axis->value[axis->count - 1], least = fmin(axis->value[0], last),
                 most = fmax(axis->value[0], last), over = 1e-9 * (most - least);
    if (!all && (fmin(ends[0], ends[1]) < least - over || fmax(ends[0], ends[1]) > most + over))
        return complain(message, "stance critical: --of: %s goes from %.6g to %.6g in this file",
                        axis->name, axis->value[0], last);
    c->order = malloc(axis->count * sizeof *c->order);
    c->value = malloc(axis->count * sizeof *c->value);
    if (!c->order || !c->value)
        return statistics_no_memory(c->r, message);
    for (size_t k = 0; k < axis->count; k++) {
        const size_t i = turned ? axis->count - 1 - k : k;
        /* An end that is given with few digits may be a hair off the value that is meant. */
        const double hair = 1e-9 * fabs(ends[1] - ends[0]), value = axis->value[i];
        if (!all &&
            (value < fmin(ends[0], ends[1]) - hair || value > fmax(ends[0], ends[1]) + hair))
            continue;
        c->order[c->count] = i;
        c->value[c->count++] = value;
    }
    return c->count > 1 || complain(message, "stance critical: --of: %s has %zu value%s there",
                                    axis->name, c->count, c->count == 1 ? "" : "s");
}

/* ---- rows --------------------------------------------------------------------------------- */

/* Room for the counts of a line, and of what became of the points at one value. */
struct walk {
    struct critical *c;
    bool *inferred; /* [cases], NULL: none is */
    struct critical_line line;
    uint64_t first, step, next; /* case at the axis's first point; to its next one; of the sample */
};

static void count_line(struct walk *w)
{
    const struct critical *const c = w->c;
    const struct critical_line *const line = &w->line;
    const size_t size = c->count * sizeof *line->gone;
    memset(line->gone, 0, size);
    memset(line->maybe, 0, size);
    memset(line->out, 0, size);
    for (uint32_t p = 0; p < c->points; p++) {
        bool gone = false, maybe = false;
        for (size_t i = 0; i < c->count; i++) {
            const uint8_t kind = c->r->kind[w->first + c->order[i] * w->step + p * w->next];
            const bool out = kind != c->of,
                       known = kind != RESULTS_PENDING && kind != RESULTS_FAILED;
            gone = gone || (out && known);
            maybe = maybe || out;
            line->gone[i] += gone;
            line->maybe[i] += maybe;
            line->out[i] += out;
        }
    }
}

static enum results_kind most_become(const struct walk *w, size_t place)
{
    uint32_t count[RESULTS_KIND_COUNT] = {0};
    enum results_kind most = w->c->of;
    for (uint32_t p = 0; place < w->c->count && p < w->c->points; p++)
        count[w->c->r->kind[w->first + w->c->order[place] * w->step + p * w->next]]++;
    count[w->c->of] = 0;
    for (int k = 0; k < RESULTS_DONE; k++)
        most = count[k] > count[most] ? (enum results_kind)k : most;
    return most;
}

/* The widest gap between values simulated, of any point of the sample, up to a place. */
static double widest_gap(const struct walk *w, size_t last)
{
    const struct critical *const c = w->c;
    double widest = 0;
    for (uint32_t p = 0; p < c->points; p++) {
        size_t before = 0;
        for (size_t i = 1; i <= last && i < c->count; i++) {
            const uint64_t k = w->first + c->order[i] * w->step + p * w->next;
            if ((w->inferred && w->inferred[k]) || c->r->kind[k] == RESULTS_PENDING)
                continue;
            widest = fmax(widest, fabs(c->value[i] - c->value[before]));
            before = i;
        }
    }
    return widest;
}

static bool keep_islands(struct walk *w, struct critical_row *row)
{
    struct critical *const c = w->c;
    struct critical_island island;
    row->island = c->islands;
    for (size_t at = row->value.after; critical_next_island(&w->line, &c->choice, &at, &island);
         row->islands++) {
        if ((c->islands & (c->islands + 1)) == 0) { /* full: 0, 1, 3, 7 ... */
            void *const more = realloc(c->island, 2 * (c->islands + 1) * sizeof island);
            if (!more)
                return false;
            c->island = more;
        }
        c->island[c->islands++] = island;
    }
    return true;
}

static bool find_rows(struct walk *w)
{
    struct critical *const c = w->c;
    for (size_t k = 0; k < c->rows; k++) {
        struct critical_row *const row = &c->row[k];
        w->first = statistics_row(c->r, c->by, c->by_axes, k, row->point);
        count_line(w);
        row->value = critical_find(&w->line, &c->choice);
        if (c->blocks)
            row->value.low = row->value.high = row->value.least_share = NAN;
        row->to = most_become(w, row->value.after);
        row->unseen = widest_gap(w, row->value.after);
        if (!keep_islands(w, row))
            return false;
    }
    return true;
}

static bool make_rows(struct critical *c, stance_message *message)
{
    const struct results *const r = c->r;
    uint64_t inferred;
    struct walk w = {.c = c, .step = statistics_stride(r, c->along), .next = 1};
    w.line = (struct critical_line){.count = c->count,
                                    .value = c->value,
                                    .points = c->points,
                                    .gone = calloc(c->count, sizeof *w.line.gone),
                                    .maybe = calloc(c->count, sizeof *w.line.maybe),
                                    .out = calloc(c->count, sizeof *w.line.out)};
    c->row = calloc(c->rows, sizeof *c->row);
    bool good = statistics_inferred(r, &inferred, &w.inferred, message);
    if (good && !(c->row && w.line.gone && w.line.maybe && w.line.out && find_rows(&w)))
        good = statistics_no_memory(r, message);
    free(w.line.gone);
    free(w.line.maybe);
    free(w.line.out);
    free(w.inferred);
    return good;
}

bool critical_make(struct critical *c, const struct results *r, const char *path,
                   enum results_kind of, const struct critical_choice *choice, bool *usage,
                   stance_message *message)
{
    double ends[2];
    *c = (struct critical){.r = r,
                           .of = of,
                           .choice = *choice,
                           .sampled = r->sample >= 0,
                           .blocks = r->sample >= 0 && r->block > 1,
                           .points = r->sample >= 0 ? (uint32_t)r->axis[r->sample].count : 1,
                           .rows = 1};
    *usage = !find_axis(c, path, ends, message) || !take_values(c, ends, message);
    for (int a = 0; !*usage && a < r->axes; a++)
        if (a != c->along && a != r->sample)
            c->by[c->by_axes++] = a, c->rows *= r->axis[a].count;
    if (!*usage && make_rows(c, message))
        return true;
    critical_free(c);
    return false;
}

void critical_free(struct critical *c)
{
    free(c->order);
    free(c->value);
    free(c->row);
    free(c->island);
    *c = (struct critical){0};
}
