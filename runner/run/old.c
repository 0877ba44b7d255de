/* old.c - the file there was: a run goes on with it (--resume), with another scenario than its own
 * (--force-scenario), or takes its rows into a larger design (--extend).
 *
 * Points of a design do not depend on their number and random numbers are keyed by place on the
 * grid and point, so that a case of a smaller design is the case of the larger one with the same
 * point, to the bit. What libraries computed, and may give differently on another machine, goes
 * with the rows: values of axes and of the old points, and the designs that the old cases have
 * used.
 *
 * All of it on rank 0, which tells the others by the usual ways.
 */
#include "run.h"

#include "runner/base/command.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- whether it is of this scenario -------------------------------------------------------- */

enum { MOST_SHOWN = 12 };

struct telling {
    FILE *to;
    size_t count;
};

static const char *value_text(char text[SHOWN_SIZE], const struct tree_node *node)
{
    return !node                       ? "none"
           : node->kind == TREE_SCALAR ? shown(text, node->text)
           : node->kind == TREE_LIST   ? "a list"
                                       : "a mapping";
}

static void tell_difference(void *context, const char *path, const struct tree_node *before,
                            const struct tree_node *after)
{
    struct telling *const telling = context;
    char old[SHOWN_SIZE], new[SHOWN_SIZE];
    if (telling->count++ < MOST_SHOWN)
        fprintf(telling->to, "  %s: %s, now %s\n", path, value_text(old, before),
                value_text(new, after));
}

/* A file is of another scenario: says in what they differ. Returns false. */
static bool other_scenario(struct run *run, const char *file, const char *old)
{
    struct tree before = {0}, after = {0};
    char *list = NULL;
    size_t size = 0;
    struct telling telling = {.to = open_memstream(&list, &size)};
    const bool read = telling.to && adopt_tree(&before, file, old, &run->message) &&
                      adopt_tree(&after, file, run->scenario->text, &run->message);
    if (read)
        adopt_differ(before.root, after.root, "",
                     &(struct adopted_differences){tell_difference, &telling});
    const bool told = telling.to && fclose(telling.to) == 0 && read;
    fprintf(stderr, "stance run: %.200s was made from another scenario%s", file,
            file == run->file ? " (--force-scenario goes on with this one)" : "");
    if (!told)
        fprintf(stderr, ": %s\n", run->message.text);
    else if (telling.count == 0) /* other versions may write it otherwise */
        fputs(", in whose resolved text no value differs\n", stderr);
    else
        fprintf(stderr, "; %zu value%s of the resolved text differ%s:\n%s%s", telling.count,
                telling.count == 1 ? "" : "s", telling.count == 1 ? "s" : "", list,
                telling.count > MOST_SHOWN ? "  ...\n" : "");
    free(list);
    tree_free(&before);
    tree_free(&after);
    run->failure.code = EXIT_USAGE;
    return false;
}

/* A file keeps to the shard that it was made for, or to all cases. */
static bool same_shard(struct run *run)
{
    const struct shard *own = &run->old.origin.shard, *asked = &run->options.shard;
    char text[SHARD_TEXT];
    if (own->number == asked->number && own->count == asked->count)
        return true;
    shard_text(own, text);
    if (own->count == 0)
        return run_fail(run, EXIT_USAGE,
                        "stance run: %.200s is not of a shard: go on with it without --shard",
                        run->file);
    return run_fail(run, EXIT_USAGE,
                    "stance run: %.200s is of shard %s: go on with it by --shard %s, or merge it "
                    "with the others",
                    run->file, text, text);
}

/* The file that is gone on with. */
static bool is_own(struct run *run)
{
    struct scenario *const s = run->scenario;
    const char *const old = run->old.origin.scenario;
    if (euidaccess(run->file, W_OK) != 0)
        return run_fail(run, EXIT_IO, "stance run: %.150s: cannot write there: %s", run->file,
                        strerror(errno));
    if (!same_shard(run))
        return false;
    run->succeed = strcmp(old, s->text) != 0;
    if (run->succeed && !run->options.force_scenario)
        return other_scenario(run, run->file, old);
    return !run->succeed || changed_scenario_check_sweep(&run->old, s, &run->message) ||
           run_fail(run, EXIT_USAGE, "stance run: %s", run->message.text);
}

/* The file of a smaller design. */
static bool is_smaller(struct run *run)
{
    struct adopted *const old = &run->old;
    const char *set = run->options.extend_set, *text = old->origin.scenario;
    const uint64_t count = run->options.extend_count;
    struct scenario *larger = scenario_new(run->scenario->file, text, &set, 1, NULL);
    /* None: most likely another scenario, or one of another version. */
    const bool same = larger && strcmp(larger->text, run->scenario->text) == 0;
    if (!same)
        other_scenario(run, old->file, larger ? larger->text : text);
    scenario_drop(larger);
    if (!same)
        return false;
    if (!adopt_scenario(old, &run->message))
        return run_fail_io(run);
    if (old->scenario->sample.design.count >= count)
        return run_fail(run, EXIT_USAGE,
                        "stance run: --extend %" PRIu64 ": %.300s has sweep.sample.count %" PRIu64
                        " already",
                        count, old->file, old->scenario->sample.design.count);
    if (old->origin.ancestors > 0) /* cases of other scenarios are none of the new file's */
        return run_fail(run, EXIT_USAGE,
                        "stance run: --extend: %.300s holds cases of several scenarios: begin a "
                        "new file",
                        old->file);
    old->points = doe_points(&old->scenario->sample.design);
    old->all = doe_points(&run->scenario->sample.design);
    old->inner = 1;
    return true;
}

/* The axes of the run are the file's, point by point of a smaller sample. */
static bool take_axes(struct run *run, bool smaller)
{
    struct scenario *const s = run->scenario;
    for (int a = 0; smaller && a < s->axes; a++) {
        const struct scenario_axis *const old = &run->old.scenario->axis[a];
        if (old->value)
            memcpy(s->axis[a].value, old->value,
                   old->count * (size_t)old->paths * sizeof *old->value);
    }
    return smaller || store_read_axes(run->file, s->axis, s->axes, &run->message) ||
           run_fail_io(run);
}

static bool look_into(struct run *run, const char *file, bool smaller)
{
    const struct store_origin *const origin = &run->old.origin;
    run->old.file = file;
    run->failure.code = run_check_file(run, run_check_results, file);
    if (run->failure.code != EXIT_DONE)
        return false; /* it has been said why */
    if (!store_read_origin(file, &run->old.origin, &run->message))
        return run_fail_io(run);
    if (!(smaller ? is_smaller(run) : is_own(run)))
        return false;
    if (!store_same_points(file, origin, run->scenario, &run->message))
        return run_fail(run, EXIT_USAGE, "stance run: %s", run->message.text);
    if (!run->succeed)
        run_warn_of_revision(run, file, origin->revision);
    return take_axes(run, smaller);
}

/* ---- larger designs ------------------------------------------------------------------------- */

bool run_extend_check(struct run *run, const struct scenario *s)
{
    if (s->sample.given && s->sample.design.method != DOE_LHS)
        return true;
    return run_fail(run, EXIT_USAGE, "stance run: %.300s: --extend: %s", s->file,
                    s->sample.given
                        ? "points of method lhs depend on their number: begin a new file"
                        : "the scenario has no sweep.sample");
}

static bool open_smaller(struct run *run)
{
    const char *const from = run->options.from;
    const size_t size = sizeof run->old_file;
    char directory[sizeof run->old_file];

    if (from && strlen(from) >= size - 8)
        return run_fail(run, EXIT_IO, "stance run: the name of the results file is too long");
    if (from)
        snprintf(run->old_file, size, "%s", from);
    else
        snprintf(run->old_file, size, "results/%s.h5", run->scenario->name);
    if (strcmp(run->old_file, run->file) == 0 || same_file(run->old_file, run->file))
        return run_fail(run, EXIT_USAGE,
                        "stance run: --extend makes a new file: -o and --from must differ");
    /* Nobody writes the file meanwhile: by a lock, or because nobody here could. */
    store_directory(run->old_file, directory, sizeof directory);
    if (access(directory, W_OK) == 0 &&
        !lock_take(&run->old_lock, run->old_file, true, &run->message))
        return run_fail_io(run);
    return look_into(run, run->old_file, true);
}

bool run_old_open(struct run *run)
{
    return run->resume                     ? look_into(run, run->file, false)
           : run->options.extend_count > 0 ? open_smaller(run)
                                           : true;
}

/* ---- what it holds -------------------------------------------------------------------------- */

bool run_old_designs(struct run *run)
{
    if (!adopt_open(&run->old, &run->message))
        return run_fail_io(run);
    if (run->succeed && !changed_scenario_may_follow(&run->old, &run->plan, &run->message))
        return run_fail(run, EXIT_USAGE, "stance run: %s", run->message.text);
    adopt_designs(&run->old, &run->plan, NULL);
    return true;
}

struct taking {
    const struct adopted *old;
    struct adopted_rows rows;
};

static bool take_rows(void *context, struct store *store, stance_message *message)
{
    struct taking *const taking = context;
    return adopt_rows(taking->old, store, &taking->rows, message);
}

void run_old_rows(struct run *run, const char *hosts)
{
    struct taking taking = {.old = &run->old, .rows.may_stop = run->succeed};
    const struct adopted_filling filling = {
        take_rows, &taking, run->succeed ? &run->old.origin : NULL, run->parallel.size, hosts};
    char real[PATH_MAX]; /* a file that is gone on with through a link is the one that it names */
    const bool link = run->succeed && realpath(run->file, real);
    const bool good = adopt_make(link ? real : run->file, &run->plan, &filling, &run->message);
    const uint64_t damaged = taking.rows.damaged;
    if (taking.rows.stopped)
        run_stop_early(run, "stopped before the file could go on with another scenario");
    else if (!good)
        run_fail_io(run);
    else if (run->succeed)
        fprintf(stderr,
                "stance run: %.200s goes on with another scenario; %" PRIu64 " of its %" PRIu64
                " cases are done and stay as they are",
                run->file, taking.rows.copied, run->plan.rows);
    if (good && run->succeed && damaged > 0)
        fprintf(stderr, ", %" PRIu64 " did not verify", damaged);
    else if (good && damaged > 0)
        fprintf(stderr,
                "stance run: %s: %" PRIu64 " case%s not as the checksum says: computed again",
                run->old.file, damaged, damaged == 1 ? " is" : "s are");
    if (good && (run->succeed || damaged > 0))
        fputc('\n', stderr);
    adopt_close(&run->old);
    lock_release(&run->old_lock);
}
