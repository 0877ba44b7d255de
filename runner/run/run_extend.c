/* run_extend.c - `stance run --extend`: a larger design from a smaller one, whose rows are taken
 * over.
 *
 * Points of a design do not depend on their number and random numbers are keyed by place on the
 * grid and point, so that a case of the old file is the case of the new file with the same point,
 * to the bit. What libraries computed, and may give differently on another machine, goes with the
 * rows: values of axes and of the old points, and the designs that the old cases have used.
 *
 * All of it on rank 0, which tells the others by the usual ways.
 */
#include "run.h"

#include "runner/base/command.h"
#include "runner/store/build_info.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct extension {
    char file[1024]; /* the old one */
    struct lock lock;
    struct scenario *scenario;
    struct plan plan;
    uint64_t old_points, points; /* of the sample */
};

bool run_extend_check(struct run *run)
{
    const struct scenario *s = run->scenario;
    if (s->sample.given && s->sample.design.method != DOE_LHS)
        return true;
    return run_fail(run, EXIT_USAGE, "stance run: %.300s: --extend: %s", s->file,
                    s->sample.given
                        ? "points of method lhs depend on their number: begin a new file"
                        : "the scenario has no sweep.sample");
}

/* ---- the old file --------------------------------------------------------------------------- */

static bool is_same_file(const char *a, const char *b)
{
    struct stat first, second;
    return strcmp(a, b) == 0 || (stat(a, &first) == 0 && stat(b, &second) == 0 &&
                                 first.st_dev == second.st_dev && first.st_ino == second.st_ino);
}

/* The scenario of the old file, as it is and with the new count. */
static bool read_old_scenario(struct run *run, struct extension *e, const char *text)
{
    const char *set = run->options.extend_set;
    struct scenario *larger = calloc(1, sizeof *larger);
    bool good = false;

    e->scenario = calloc(1, sizeof *e->scenario);
    if (!larger || !e->scenario) {
        run_fail(run, EXIT_IO, "stance run: not enough memory");
    } else if (!scenario_read(larger, run->scenario->file, text, &set, 1, NULL)) {
        /* Most likely another scenario, or one of another version. */
        run_same_scenario(run, e->file, text);
    } else {
        good = run_same_scenario(run, e->file, larger->text);
        good = good && scenario_read(e->scenario, run->scenario->file, text, NULL, 0, NULL);
        scenario_free(larger);
    }
    if (!good) {
        free(e->scenario);
        e->scenario = NULL;
    }
    free(larger);
    return good;
}

/* Values of the old file's axes into the new scenario, point by point of the sample. */
static bool take_axes(struct run *run, struct extension *e, stance_message *message)
{
    for (int a = 0; a < e->scenario->axes; a++) {
        struct scenario_axis *old = &e->scenario->axis[a], *new = &run->scenario->axis[a];
        if (!store_read_axis(e->file, old, message))
            return false;
        if (old->value)
            memcpy(new->value, old->value, old->count * (size_t)old->paths * sizeof *old->value);
    }
    return true;
}

static bool look_into_old(struct run *run, struct extension *e)
{
    struct store_origin origin;
    char directory[sizeof e->file];

    /* Nobody writes the file meanwhile: by a lock, or because nobody here could. */
    store_directory(e->file, directory, sizeof directory);
    if (access(directory, W_OK) == 0 && !lock_take_through(&e->lock, e->file, &run->message))
        return run_fail_io(run);
    run->failure.code = run_check_file(run, run_check_results, e->file);
    if (run->failure.code != EXIT_DONE)
        return false; /* it has been said why */
    if (!store_read_origin(e->file, &origin, &run->message))
        return run_fail_io(run);
    bool good = read_old_scenario(run, e, origin.scenario);
    if (good && e->scenario->sample.design.count >= run->options.extend_count)
        good = run_fail(run, EXIT_USAGE,
                        "stance run: --extend %" PRIu64 ": %.300s has sweep.sample.count %" PRIu64
                        " already",
                        run->options.extend_count, e->file, e->scenario->sample.design.count);
    if (good && origin.ancestors > 0) /* cases of other scenarios are none of the new file's */
        good = run_fail(run, EXIT_USAGE,
                        "stance run: --extend: %.300s holds cases of several scenarios: begin a "
                        "new file",
                        e->file);
    if (good)
        run_warn_of_revision(run, e->file, origin.revision);
    if (good && !store_same_points(e->file, &origin, run->scenario, &run->message))
        good = run_fail(run, EXIT_USAGE, "stance run: %s", run->message.text);
    good = good && (take_axes(run, e, &run->message) || run_fail_io(run));
    store_origin_free(&origin);
    return good;
}

void run_extend_open(struct run *run)
{
    const struct options *o = &run->options;
    struct extension *e = run->extension = calloc(1, sizeof *e);

    if (!e) {
        run_fail(run, EXIT_IO, "stance run: not enough memory");
        return;
    }
    e->lock.descriptor = -1;
    if (o->from)
        snprintf(e->file, sizeof e->file, "%s", o->from);
    else
        snprintf(e->file, sizeof e->file, "results/%s.h5", run->scenario->name);
    if (o->from && strlen(o->from) >= sizeof e->file - 8) {
        run_fail(run, EXIT_IO, "stance run: the name of the results file is too long");
    } else if (is_same_file(e->file, run->file)) {
        run_fail(run, EXIT_USAGE,
                 "stance run: --extend makes a new file: -o and --from must differ");
    } else if (look_into_old(run, e)) {
        e->old_points = doe_points(&e->scenario->sample.design);
        e->points = doe_points(&run->scenario->sample.design);
    }
}

void run_extend_close(struct run *run)
{
    struct extension *e = run->extension;
    if (e) {
        plan_free(&e->plan);
        if (e->scenario)
            scenario_free(e->scenario);
        free(e->scenario);
        lock_release(&e->lock);
        free(e);
    }
    run->extension = NULL;
}

/* ---- what it holds --------------------------------------------------------------------------- */

/* Where a case or a design of the old file is in the new one. */
static uint64_t moved(const struct extension *e, uint64_t place)
{
    return place / e->old_points * e->points + place % e->old_points;
}

bool run_extend_designs(struct run *run, stance_message *message)
{
    struct extension *e = run->extension;
    struct plan *new = &run->plan;
    struct plan_error error = {0};
    struct store *store = NULL;
    const bool sampled = e->scenario->axis[e->scenario->axes - 1].design;

    if (!plan_make(&e->plan, e->scenario, false, 0, false, &error)) {
        *message = error.message;
        return false;
    }
    bool good = store_open_to_read(&store, e->file, &e->plan, message) &&
                store_read_designs(store, &e->plan, message);
    for (size_t d = 0; good && d < e->plan.designs; d++) {
        const size_t to = sampled ? (size_t)moved(e, d) : d;
        const struct resolved_design design = plan_design_at(&e->plan, d);
        plan_design_put(new, to, &design);
        new->design_status[to] = e->plan.design_status[d];
    }
    stance_message ignored;
    return store && store_close(store, good ? message : &ignored) && good;
}

/* Where a row goes that can be taken over with all that the new file has of it. */
static uint64_t target_of(void *context, uint64_t row)
{
    const struct run *run = context;
    const struct extension *e = run->extension;
    const struct plan *new = &run->plan;
    uint64_t place;
    const uint64_t to = moved(e, row);
    if (new->stop && row % (1 << 14) == 0)
        (void)new->stop(new->stop_context); /* a sign of life; a stop comes after this */
    return !plan_recorded(new, to, &place) ||
                   (plan_recorded(&e->plan, row, &place) && e->plan.record_rows == new->record_rows)
               ? to
               : STORE_NOWHERE;
}

bool run_extend_copy(struct run *run, stance_message *message)
{
    struct extension *e = run->extension;
    struct store_copied copied = {0};
    struct store *old = NULL;

    bool good = store_open_to_read(&old, e->file, &e->plan, message) &&
                store_copy(old, run->store, target_of, run, &copied, message);
    stance_message ignored;
    good = old && store_close(old, good ? message : &ignored) && good;
    if (good && copied.damaged > 0) {
        fprintf(stderr,
                "stance run: %s: %" PRIu64 " case%s not as the checksum says: computed again\n",
                e->file, copied.damaged, copied.damaged == 1 ? " is" : "s are");
    }
    return good;
}
