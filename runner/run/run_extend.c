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

bool run_extend_check(struct run *run, const struct scenario *s)
{
    if (s->sample.given && s->sample.design.method != DOE_LHS)
        return true;
    return run_fail(run, EXIT_USAGE, "stance run: %.300s: --extend: %s", s->file,
                    s->sample.given
                        ? "points of method lhs depend on their number: begin a new file"
                        : "the scenario has no sweep.sample");
}

/* ---- the old file --------------------------------------------------------------------------- */

/* The scenario of the old file, as it is and with the new count. */
static bool read_old_scenario(struct run *run)
{
    const char *set = run->options.extend_set, *text = run->old.origin.scenario;
    struct scenario *larger = scenario_new(run->scenario->file, text, &set, 1, NULL);
    /* None: most likely another scenario, or one of another version. */
    const bool same = run_same_scenario(run, run->old.file, larger ? larger->text : text);
    const bool good =
        same && larger && (adopt_scenario(&run->old, &run->message) || run_fail_io(run));
    scenario_drop(larger);
    return good;
}

static bool look_into_old(struct run *run)
{
    const char *const file = run->old.file;
    const uint64_t count = run->options.extend_count;
    char directory[sizeof run->old_file];

    /* Nobody writes the file meanwhile: by a lock, or because nobody here could. */
    store_directory(file, directory, sizeof directory);
    if (access(directory, W_OK) == 0 && !lock_take_through(&run->old_lock, file, &run->message))
        return run_fail_io(run);
    run->failure.code = run_check_file(run, run_check_results, file);
    if (run->failure.code != EXIT_DONE)
        return false; /* it has been said why */
    if (!store_read_origin(file, &run->old.origin, &run->message))
        return run_fail_io(run);
    if (!read_old_scenario(run))
        return false;
    if (run->old.scenario->sample.design.count >= count)
        return run_fail(run, EXIT_USAGE,
                        "stance run: --extend %" PRIu64 ": %.300s has sweep.sample.count %" PRIu64
                        " already",
                        count, file, run->old.scenario->sample.design.count);
    if (run->old.origin.ancestors > 0) /* cases of other scenarios are none of the new file's */
        return run_fail(run, EXIT_USAGE,
                        "stance run: --extend: %.300s holds cases of several scenarios: begin a "
                        "new file",
                        file);
    run_warn_of_revision(run, file, run->old.origin.revision);
    if (!store_same_points(file, &run->old.origin, run->scenario, &run->message))
        return run_fail(run, EXIT_USAGE, "stance run: %s", run->message.text);
    for (int a = 0; a < run->scenario->axes; a++) { /* point by point of the sample */
        const struct scenario_axis *const old = &run->old.scenario->axis[a];
        if (old->value)
            memcpy(run->scenario->axis[a].value, old->value,
                   old->count * (size_t)old->paths * sizeof *old->value);
    }
    return true;
}

bool run_extend_open(struct run *run)
{
    const char *const from = run->options.from;
    const size_t size = sizeof run->old_file;
    struct stat first, second;

    run->old.file = run->old_file;
    if (from)
        snprintf(run->old_file, size, "%s", from);
    else
        snprintf(run->old_file, size, "results/%s.h5", run->scenario->name);
    if (from && strlen(from) >= size - 8)
        return run_fail(run, EXIT_IO, "stance run: the name of the results file is too long");
    if (strcmp(run->old_file, run->file) == 0 ||
        (stat(run->old_file, &first) == 0 && stat(run->file, &second) == 0 &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino))
        return run_fail(run, EXIT_USAGE,
                        "stance run: --extend makes a new file: -o and --from must differ");
    return look_into_old(run);
}

/* ---- what it holds --------------------------------------------------------------------------- */

/* Where a case or a design of the old file is in the new one. */
static uint64_t moved(const struct run *run, uint64_t place)
{
    const uint64_t old = doe_points(&run->old.scenario->sample.design);
    return place / old * doe_points(&run->scenario->sample.design) + place % old;
}

bool run_extend_designs(struct run *run)
{
    const struct scenario *const s = run->old.scenario;
    const bool sampled = s->axis[s->axes - 1].design;
    if (!adopt_open(&run->old, &run->message))
        return run_fail_io(run);
    for (size_t d = 0; d < run->old.plan.designs; d++)
        plan_take_design(&run->plan, sampled ? (size_t)moved(run, d) : d, &run->old.plan, d);
    return true;
}

/* Where a row goes that can be taken over with all that the new file has of it. */
static uint64_t target_of(void *context, uint64_t row)
{
    const struct run *run = context;
    const struct plan *old = &run->old.plan, *new = &run->plan;
    uint64_t place;
    const uint64_t to = moved(run, row);
    if (new->stop && row % (1 << 14) == 0)
        (void)new->stop(new->stop_context); /* a sign of life; a stop comes after this */
    return !plan_recorded(new, to, &place) ||
                   (plan_recorded(old, row, &place) && old->record_rows == new->record_rows)
               ? to
               : STORE_NOWHERE;
}

bool run_extend_copy(struct run *run)
{
    struct store_copied copied = {0};
    if (!store_copy(run->old.store, run->store, target_of, run, &copied, &run->message))
        return run_fail_io(run);
    if (copied.damaged > 0)
        fprintf(stderr,
                "stance run: %s: %" PRIu64 " case%s not as the checksum says: computed again\n",
                run->old.file, copied.damaged, copied.damaged == 1 ? " is" : "s are");
    return true;
}
