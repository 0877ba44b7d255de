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

/* ---- a part, opened ----------------------------------------------------------------------- */

struct opened {
    struct scenario scenario;
    struct plan plan;
    struct store *store;
    bool planned;
};

static void close_part(struct opened *part)
{
    stance_message ignored;
    if (part->store)
        store_close(part->store, &ignored);
    if (part->planned)
        plan_free(&part->plan);
    scenario_free(&part->scenario);
    free(part);
}

/* NULL: one line in *message. */
static struct opened *open_part(const struct merge_part *part, stance_message *message)
{
    struct opened *opened = calloc(1, sizeof *opened);
    struct plan_error error;
    struct store_counts counts;
    if (!opened) {
        no_memory(message);
        return NULL;
    }
    bool good = merge_read_part(part, &opened->scenario, message) &&
                store_count(part->file, &counts, message);
    if (good && counts.cases != opened->scenario.cases) {
        good = complain(message, "%.100s: holds one case of a sweep (run --only), not the sweep",
                        part->file);
    }
    if (good && !plan_make(&opened->plan, &opened->scenario, false, 0, false, &error)) {
        good = complain(message, "%.60s: %.160s", part->file, error.message.text);
    } else if (good) {
        opened->planned = true;
        good = store_open_to_read(&opened->store, part->file, &opened->plan, message) &&
               store_read_designs(opened->store, &opened->plan, message);
    }
    if (!good) {
        close_part(opened);
        return NULL;
    }
    return opened;
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
static bool check_axes(struct merge *m, const struct merge_part *part,
                       const struct scenario *scenario, stance_message *message)
{
    const int shift = m->kind == MERGE_VALUE; /* the new axis is the first one */
    for (int a = 0; a < scenario->axes; a++) {
        const struct scenario_axis *axis = &scenario->axis[a];
        if ((!axis->log && !axis->sample) || (m->kind == MERGE_AXIS && a == m->axis))
            continue;
        const double distance = axis_distance(axis, &m->scenario.axis[a + shift]);
        if (distance > last_bits) {
            return complain(message, "%.70s: its points along %.50s are not those of %.70s",
                            part->file, axis->name, m->part[0].file);
        }
        m->designs_differ = m->designs_differ || distance > 0;
    }
    return true;
}

/* ---- designs ------------------------------------------------------------------------------ */

/* How far two designs are apart, relative to their largest number. Designs made on different
 * processors differ in last bits. */
static double distance_between(const struct resolved_design *a, const struct resolved_design *b)
{
    const double *x = (const double *)(const void *)a, *y = (const double *)(const void *)b;
    double scale = 0, distance = 0;
    for (size_t i = 0; i < sizeof *a / sizeof *x; i++) {
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
static bool take_designs(struct merge *m, const struct merge_part *part,
                         const struct opened *opened, struct plan *plan, bool *taken,
                         stance_message *message)
{
    for (size_t d = 0; d < opened->plan.designs; d++) {
        const struct resolved_design design = plan_design_at(&opened->plan, d);
        const size_t at = plan_design(plan, merge_row(m, part, plan_design_case(&opened->plan, d)));
        if (!taken[at]) {
            taken[at] = true;
            plan_design_put(plan, at, &design);
            plan->design_status[at] = opened->plan.design_status[d];
            continue;
        }
        const struct resolved_design other = plan_design_at(plan, at);
        const double distance = distance_between(&other, &design);
        if (plan->design_status[at] != opened->plan.design_status[d] || distance > last_bits) {
            return complain(message,
                            "%.100s: its controller design differs from that of another part",
                            part->file);
        }
        m->designs_differ = m->designs_differ || distance > 0;
    }
    return true;
}

static bool collect_designs(struct merge *m, struct plan *plan, bool *usage,
                            stance_message *message)
{
    bool *taken = calloc(plan->designs, sizeof *taken);
    bool good = taken || no_memory(message);
    for (size_t p = 0; good && p < m->parts; p++) {
        struct opened *opened = open_part(&m->part[p], message);
        good = opened != NULL;
        if (opened && opened->plan.record_rows != plan->record_rows) {
            complain(message,
                     "%.100s: its trajectories have another length than those of the whole",
                     m->part[p].file);
            *usage = true;
            good = false;
        }
        if (good) {
            good = check_axes(m, &m->part[p], &opened->scenario, message) &&
                   take_designs(m, &m->part[p], opened, plan, taken, message);
            *usage = !good;
        }
        if (opened)
            close_part(opened);
    }
    free(taken);
    return good;
}

/* ---- rows --------------------------------------------------------------------------------- */

struct moving {
    const struct merge *merge;
    const struct merge_part *part;
};

static uint64_t target_of(void *context, uint64_t row)
{
    const struct moving *moving = context;
    return merge_row(moving->merge, moving->part, row);
}

static bool copy_rows(struct merge *m, struct merge_part *part, const struct opened *opened,
                      struct store *store, stance_message *message)
{
    const uint64_t before = m->copied.copied + m->copied.same;
    struct moving moving = {m, part};
    const bool good = store_copy(opened->store, store, target_of, &moving, &m->copied, message);
    part->taken = m->copied.copied + m->copied.same - before;
    return good;
}

static bool copy_parts(struct merge *m, struct store *store, bool *usage, stance_message *message)
{
    int rank = 0;
    for (size_t p = 0; p < m->parts; p++) {
        struct opened *opened = open_part(&m->part[p], message);
        bool good = opened && copy_rows(m, &m->part[p], opened, store, message) &&
                    store_copy_timing(opened->store, store, &rank, message);
        if (opened)
            close_part(opened);
        if (good && m->copied.conflicting > 0) {
            complain(message,
                     "%.80s: %llu case%s from what another part has, the first is case %llu "
                     "of the whole",
                     m->part[p].file, (unsigned long long)m->copied.conflicting,
                     m->copied.conflicting == 1 ? " differs" : "s differ",
                     (unsigned long long)m->copied.conflict);
            *usage = true;
            good = false;
        }
        if (!good)
            return false;
    }
    return true;
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
static char *history(const struct merge *m)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    for (size_t p = 0; p < m->parts; p++) {
        const struct merge_part *part = &m->part[p];
        fprintf(out, "%s%s: %llu cases, %s, revision %s, %d rank%s on %s", p ? "\n" : "",
                part->file, (unsigned long long)part->taken, part->origin.date,
                part->origin.revision, part->origin.ranks, part->origin.ranks == 1 ? "" : "s",
                part->origin.hosts ? part->origin.hosts : "unknown");
    }
    return fclose(out) == 0 ? text : (free(text), NULL);
}

static bool annotate(const struct merge *m, struct store *store, stance_message *message)
{
    const char *const notes[] = {m->keyed ? keys_note : "", m->refined ? refined_note : "",
                                 m->designs_differ ? designs_note : ""};
    char note[800] = "";
    char *text = history(m);
    for (size_t i = 0; i < sizeof notes / sizeof notes[0]; i++)
        words_add(note, sizeof note, "%s%s", note[0] && notes[i][0] ? " " : "", notes[i]);
    bool good = (text || no_memory(message)) &&
                store_annotate(store, "merged_from", text, message) &&
                (!note[0] || store_annotate(store, "merge_note", note, message));
    free(text);
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

bool merge_write(struct merge *m, const char *file, bool *usage, stance_message *message)
{
    struct plan plan;
    struct plan_error error;
    int ranks = 0;

    *usage = false;
    for (size_t p = 0; p < m->parts; p++)
        ranks += m->part[p].origin.ranks > 0 ? m->part[p].origin.ranks : 1;
    if (!plan_make(&plan, &m->scenario, false, 0, false, &error)) {
        *message = error.message;
        return false;
    }
    const char *hosts = m->part[0].origin.hosts ? m->part[0].origin.hosts : "";
    bool good = collect_designs(m, &plan, usage, message) &&
                store_create(file, &plan, NULL, ranks, hosts, message);
    if (good) {
        struct store *store = NULL;
        good = store_open(&store, file, &plan, 1, message) &&
               copy_parts(m, store, usage, message) && annotate(m, store, message);
        if (good)
            good = store_close(store, message);
        else
            store_abandon(store);
        if (!good)
            unlink(file);
    }
    plan_free(&plan);
    return good;
}
