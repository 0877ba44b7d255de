/* merge.c - writes the merged file: designs, then rows, part after part. */
#include "merge.h"

#include "runner/base/message.h"
#include "runner/base/words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double last_bits = 1e-9; /* relative difference of designs that are the same */

static bool open_part(struct merge *m, struct adopted *part)
{
    struct store_counts counts;
    if (!adopt_scenario(part, &m->message) || !store_count(part->file, &counts, &m->message))
        return false;
    return counts.cases == part->scenario->cases
               ? adopt_open(part, &m->message)
               : complain(&m->message,
                          "%.100s: holds one case of a sweep (run --only), not the sweep",
                          part->file);
}

/* ---- axes --------------------------------------------------------------------------------- */

/* How far the values of two axes are apart, relative to the largest of each path. */
static double axis_distance(const struct scenario_axis *a, const struct scenario_axis *b)
{
    double most = 0;
    for (int k = 0; k < a->paths; k++) {
        double scale = 0, distance = 0;
        for (size_t i = 0; i < a->count; i++) {
            const double x = scenario_axis_value(a, i, k), y = scenario_axis_value(b, i, k);
            scale = isfinite(x) ? fmax(scale, fabs(x)) : scale;
            distance = x == y ? distance : fmax(distance, fabs(x - y));
        }
        most = distance > 0 ? fmax(most, distance / scale) : most;
    }
    return most;
}

/* The points of a sample or of a logarithmic axis are what the program that made the part computed:
 * equal scenarios of two versions need not have equal ones. */
static bool check_axes(struct merge *m, const struct adopted *part)
{
    const int shift = m->kind == MERGE_VALUE; /* the new axis is the first one */
    for (int a = 0; a < part->scenario->axes; a++) {
        const struct scenario_axis *axis = &part->scenario->axis[a];
        if ((!axis->log && !axis->sample) || (m->kind == MERGE_AXIS && a == m->axis))
            continue;
        const double distance = axis_distance(axis, &m->scenario->axis[a + shift]);
        if (distance > last_bits) {
            return complain(&m->message, "%.70s: its points along %.50s are not those of %.70s",
                            part->file, axis->name, m->part[0].of.file);
        }
        m->designs_differ = m->designs_differ || distance > 0;
    }
    return true;
}

/* ---- designs ------------------------------------------------------------------------------ */

/* How far two designs are apart, relative to their largest number. Designs made on different
 * processors differ in last bits. */
static double distance_between(const double *x, const double *y, size_t count)
{
    double scale = 0, distance = 0;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(x[i]) && isfinite(y[i])) {
            scale = fmax(scale, fabs(x[i]));
            distance = fmax(distance, fabs(x[i] - y[i]));
        } else if (isfinite(x[i]) != isfinite(y[i])) {
            return INFINITY;
        }
    }
    return distance > 0 ? distance / scale : 0;
}

/* Takes the designs that a part has into the merged plan, where they are not yet. */
static bool take_designs(struct merge *m, const struct merge_part *part, struct plan *plan,
                         bool *taken)
{
    const struct plan *const own = &part->of.plan;
    for (size_t d = 0; d < own->designs; d++) {
        const size_t at = plan_design(plan, merge_row(m, part, plan_design_case(own, d)));
        if (!taken[at]) {
            taken[at] = true;
            plan_take_design(plan, at, own, d);
            continue;
        }
        const double distance =
            distance_between(&plan->design[at * plan->design_size],
                             &own->design[d * plan->design_size], plan->design_size);
        if (plan->design_status[at] != own->design_status[d] || distance > last_bits) {
            return complain(&m->message,
                            "%.100s: its controller design differs from that of another part",
                            part->of.file);
        }
        m->designs_differ = m->designs_differ || distance > 0;
    }
    return true;
}

static bool collect_designs(struct merge *m, struct plan *plan)
{
    bool *taken = calloc(plan->designs, sizeof *taken);
    bool good = taken || no_memory(&m->message);
    for (size_t p = 0; good && p < m->parts; p++) {
        struct adopted *const part = &m->part[p].of;
        good = open_part(m, part);
        if (good) {
            good = (part->plan.record_rows == plan->record_rows ||
                    complain(&m->message,
                             "%.100s: its trajectories have another length than those of the whole",
                             part->file)) &&
                   check_axes(m, part) && take_designs(m, &m->part[p], plan, taken);
            m->usage = !good;
        }
        adopt_close(part);
    }
    free(taken);
    return good;
}

/* ---- rows --------------------------------------------------------------------------------- */

struct moving {
    struct merge *merge;
    const struct merge_part *part;
};

static uint64_t target_of(void *context, uint64_t row)
{
    const struct moving *moving = context;
    return merge_row(moving->merge, moving->part, row);
}

static bool copy_parts(struct merge *m, struct store *store)
{
    int rank = 0;
    bool good = true;
    for (size_t p = 0; good && p < m->parts; p++) {
        struct merge_part *const part = &m->part[p];
        const uint64_t before = m->copied.copied + m->copied.same;
        good = open_part(m, &part->of) &&
               store_copy(part->of.store, store, target_of, &(struct moving){m, part}, &m->copied,
                          &m->message) &&
               store_copy_timing(part->of.store, store, &rank, &m->message);
        part->taken = m->copied.copied + m->copied.same - before;
        adopt_close(&part->of);
        if (good && m->copied.conflicting > 0) {
            m->usage = true;
            good = complain(&m->message,
                            "%.80s: %llu case%s from what another part has, the first is case %llu "
                            "of the whole",
                            part->of.file, (unsigned long long)m->copied.conflicting,
                            m->copied.conflicting == 1 ? " differs" : "s differ",
                            (unsigned long long)m->copied.conflict);
        }
    }
    return good;
}

/* ---- where it comes from ------------------------------------------------------------------ */

static const char keys_note[] =
    "Random numbers (torque noise, probes) are keyed by the indices that cases had "
    "in their parts: one run of this scenario has other ones.";
static const char refined_note[] =
    "The parts were refined each for itself: one run of this scenario simulates other cases.";
static const char designs_note[] =
    "The parts' controller designs or computed axes differ in last bits; those of the first part "
    "that has them are in this file.";

/* One line for each part; freed by the caller. */
static char *history(struct merge *m)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    for (size_t p = 0; p < m->parts; p++) {
        const struct store_origin *o = &m->part[p].of.origin;
        fprintf(out, "%s%s: %llu cases, %s, revision %s, %d rank%s on %s", p ? "\n" : "",
                m->part[p].of.file, (unsigned long long)m->part[p].taken, o->date, o->revision,
                o->ranks, o->ranks == 1 ? "" : "s", o->hosts ? o->hosts : "unknown");
    }
    return fclose(out) == 0 ? text : (free(text), NULL);
}

static bool annotate(struct merge *m, struct store *store)
{
    const char *const notes[] = {m->keyed ? keys_note : "", m->refined ? refined_note : "",
                                 m->designs_differ ? designs_note : ""};
    char note[800] = "";
    char *text = history(m);
    for (size_t i = 0; i < sizeof notes / sizeof notes[0]; i++)
        words_add(note, sizeof note, "%s%s", note[0] && notes[i][0] ? " " : "", notes[i]);
    bool good = (text || no_memory(&m->message)) &&
                store_annotate(store, "merged_from", text, &m->message) &&
                (!note[0] || store_annotate(store, "merge_note", note, &m->message));
    free(text);
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

bool merge_write(struct merge *m, const char *file)
{
    struct plan plan;
    struct plan_error error;
    int ranks = 0;

    m->usage = false;
    for (size_t p = 0; p < m->parts; p++)
        ranks += m->part[p].of.origin.ranks > 0 ? m->part[p].of.origin.ranks : 1;
    if (!plan_make(&plan, m->scenario, false, 0, false, &error)) {
        m->message = error.message;
        return false;
    }
    const char *hosts = m->part[0].of.origin.hosts ? m->part[0].of.origin.hosts : "";
    bool good =
        collect_designs(m, &plan) && store_create(file, &plan, NULL, ranks, hosts, &m->message);
    if (good) {
        struct store *store = NULL;
        good = store_open(&store, file, &plan, 1, &m->message) && copy_parts(m, store) &&
               annotate(m, store);
        if (good)
            good = store_close(store, &m->message);
        else
            store_abandon(store);
        if (!good)
            unlink(file);
    }
    plan_free(&plan);
    return good;
}
