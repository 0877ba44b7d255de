/* merge.c - writes the merged file: designs, then rows, part after part. */
#include "merge.h"

#include "runner/base/message.h"
#include "runner/base/words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double last_bits = 1e-9; /* relative difference of designs that are the same */

const char *const merge_notes[MERGE_NOTES] = {
    [MERGE_KEYED] = "Random numbers (torque noise, probes) are keyed by the indices that cases had "
                    "in their parts: one run of this scenario has other ones.",
    [MERGE_REFINED] =
        "The parts were refined each for itself: one run of this scenario simulates other cases.",
    [MERGE_DESIGNS] = "The parts' controller designs or computed axes differ in last bits; those "
                      "of the first part that has them are in this file.",
};

/* ---- what must be the same ---------------------------------------------------------------- */

/* The points of a sample or of a logarithmic axis are what the program that made the part computed:
 * equal scenarios of two versions need not have equal ones. */
static bool check_axes(struct merge *m, const struct adopted *part)
{
    const int shift = m->kind == MERGE_VALUE; /* the new axis is the first one */
    for (int a = 0; a < part->scenario->axes; a++) {
        const struct scenario_axis *const axis = &part->scenario->axis[a],
                                          *const whole = &m->scenario->axis[a + shift];
        const size_t paths = (size_t)axis->paths;
        if ((!axis->log && !axis->sample) || (m->kind == MERGE_AXIS && a == m->axis))
            continue;
        for (size_t k = 0; k < paths; k++) {
            const double distance =
                adopt_distance(axis->value + k, whole->value + k, axis->count, paths);
            if (distance > last_bits)
                return complain(&m->message, "%.70s: its points along %.50s are not those of %.70s",
                                part->file, axis->name, m->part[0].of.file);
            m->noted[MERGE_DESIGNS] |= distance > 0;
        }
    }
    return true;
}

/* Designs made on different processors differ in last bits. */
static bool take_designs(struct merge *m, struct adopted *part, struct plan *plan, bool *taken)
{
    if (part->plan.record_rows != plan->record_rows)
        return complain(&m->message,
                        "%.100s: its trajectories have another length than those of the whole",
                        part->file);
    if (!check_axes(m, part))
        return false;
    const double distance = adopt_designs(part, plan, taken);
    m->noted[MERGE_DESIGNS] |= distance > 0;
    return distance <= last_bits ||
           complain(&m->message, "%.100s: its controller design differs from that of another part",
                    part->file);
}

static bool collect_designs(struct merge *m, struct plan *plan)
{
    bool *taken = calloc(plan->designs, sizeof *taken);
    bool good = taken || no_memory(&m->message);
    for (size_t p = 0; good && p < m->parts; p++) {
        struct adopted *const part = &m->part[p].of;
        good = adopt_scenario(part, &m->message) && adopt_open(part, &m->message);
        if (good)
            m->usage = !(good = take_designs(m, part, plan, taken));
        adopt_close(part);
    }
    free(taken);
    return good;
}

/* ---- rows --------------------------------------------------------------------------------- */

static bool copy_parts(struct merge *m, struct store *store)
{
    struct adopted_rows *const rows = &m->rows;
    int rank = 0;
    bool good = true;
    for (size_t p = 0; good && p < m->parts; p++) {
        struct adopted *const part = &m->part[p].of;
        const uint64_t before = rows->copied + rows->same;
        good = adopt_scenario(part, &m->message) && adopt_open(part, &m->message) &&
               adopt_rows(part, store, rows, &m->message) &&
               store_copy_timing(part->store, store, &rank, &m->message);
        m->part[p].taken = rows->copied + rows->same - before;
        adopt_close(part);
        if (good && rows->conflicting > 0) {
            m->usage = true;
            good = complain(&m->message,
                            "%.80s: %llu case%s from what another part has, the first is case %llu "
                            "of the whole",
                            part->file, (unsigned long long)rows->conflicting,
                            rows->conflicting == 1 ? " differs" : "s differ",
                            (unsigned long long)rows->conflict);
        }
    }
    return good;
}

/* Where it comes from, a line for each part, and what is not as in one run. */
static bool annotate(struct merge *m, struct store *store)
{
    char note[800] = "", *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (size_t p = 0; out && p < m->parts; p++) {
        const struct store_origin *o = &m->part[p].of.origin;
        fprintf(out, "%s%s: %llu cases, %s, revision %s, %d rank%s on %s", p ? "\n" : "",
                m->part[p].of.file, (unsigned long long)m->part[p].taken, o->date, o->revision,
                o->ranks, o->ranks == 1 ? "" : "s", o->hosts ? o->hosts : "unknown");
    }
    for (int k = 0; k < MERGE_NOTES; k++)
        if (m->noted[k])
            words_add(note, sizeof note, "%s%s", note[0] ? " " : "", merge_notes[k]);
    bool good = (out && fclose(out) == 0) || no_memory(&m->message);
    good = good && store_annotate(store, "merged_from", text, &m->message) &&
           (!note[0] || store_annotate(store, "merge_note", note, &m->message));
    free(text);
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

static bool fill(void *context, struct store *store, stance_message *message)
{
    struct merge *const m = context;
    if (!copy_parts(m, store) || !annotate(m, store))
        return false;
    m->usage = m->rows.copied == 0;
    return !m->usage ||
           complain(message, "none of the %zu files has a case that is computed", m->parts);
}

bool merge_write(struct merge *m, const char *file)
{
    const struct store_origin *const first = &m->part[0].of.origin;
    struct adopted_filling filling = {fill, m, .hosts = first->hosts ? first->hosts : ""};
    struct plan plan;
    struct plan_error error;

    m->usage = false;
    for (size_t p = 0; p < m->parts; p++)
        filling.ranks += m->part[p].of.origin.ranks > 0 ? m->part[p].of.origin.ranks : 1;
    if (!plan_make(&plan, m->scenario, false, 0, false, &error)) {
        m->message = error.message;
        return false;
    }
    const bool good = collect_designs(m, &plan) && adopt_make(file, &plan, &filling, &m->message);
    plan_free(&plan);
    return good;
}
