/* changed_scenario.c - see adopt.h. */
#include "adopt.h"

#include "runner/base/message.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- what may change ------------------------------------------------------------------------ */

static bool refuse(stance_message *message, const char *file, const char *what)
{
    return complain(message, "%.90s: --force-scenario cannot change %s: begin a new file (-o)",
                    file, what);
}

static bool same_axis(const struct scenario_axis *a, const struct scenario_axis *b)
{
    bool equal = a->paths == b->paths && a->count == b->count && a->words == b->words;
    for (int k = 0; equal && k < a->paths; k++) {
        equal = strcmp(a->path[k], b->path[k]) == 0 && (a->value != NULL) == (b->value != NULL) &&
                (a->value || (a->from == b->from && a->to == b->to));
        for (size_t i = 0; equal && a->value && i < a->count; i++) {
            const double x = scenario_axis_value(a, i, k), y = scenario_axis_value(b, i, k);
            equal = x == y;
        }
    }
    return equal;
}

/* Bit for bit, of structs whose memory was zero before they were filled in. */
static bool same_bits(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

/* A design changes for some words of a sweep only: its inputs are compared, not some designs. */
static bool same_designs(const struct scenario *a, const struct scenario *b)
{
    struct scenario_values x, y;
    int k;
    const bool sampled =
        a->base.design_time == DESIGN_SAMPLED ||
        scenario_axis_of(a, offsetof(struct scenario_values, design_time), &k) != NULL;
    memcpy(&x, &a->base, sizeof x);
    memcpy(&y, &b->base, sizeof y);
    return resolve_keep_design_inputs(a->scene, &x, sampled) &&
           resolve_keep_design_inputs(b->scene, &y, sampled) && same_bits(&x, &y, sizeof x);
}

static bool may_follow(const char *file, const struct plan *before, const struct plan *after,
                       stance_message *message)
{
    const struct scenario *a = before->scenario, *b = after->scenario;
    const struct scenario_refine *x = &a->refine, *y = &b->refine;
    const bool equal = same_bits(&a->base, &b->base, sizeof a->base) && a->seed == b->seed &&
                       x->given == y->given && x->start == y->start && x->margin == y->margin &&
                       x->probes == y->probes;
    bool recorded = before->record_rows == after->record_rows &&
                    before->record_interval == after->record_interval &&
                    before->record_cases == after->record_cases;
    for (uint64_t k = 0; recorded && after->record_rows > 0 && k < after->record_cases; k++)
        recorded = plan_recorded_case(before, k) == plan_recorded_case(after, k);
    return (a->answers == b->answers || refuse(message, file, "which answers are stored")) &&
           (recorded || refuse(message, file, "which trajectories are recorded, and when")) &&
           (equal || !(x->given || y->given) ||
            refuse(message, file, "the cases of a refined map, which follow from each other")) &&
           (equal || same_designs(a, b) ||
            refuse(message, file, "what its controller designs depend on"));
}

bool changed_scenario_check_sweep(struct adopted *old, const struct scenario *scenario,
                                  stance_message *message)
{
    const char *const file = old->file;
    if (!adopt_scenario(old, message))
        return refuse(message, file, "a scenario that this version cannot read");
    const struct doe *x = &old->scenario->sample.design, *y = &scenario->sample.design;
    const bool given = scenario->sample.given;
    /* The seed is among what its points are made from. */
    if (old->scenario->sample.given != given ||
        (given &&
         (x->method != y->method || x->count != y->count || x->factors != y->factors ||
          x->levels != y->levels || x->second_order != y->second_order || x->seed != y->seed)))
        return refuse(message, file, "sweep.sample or the seed of its points");
    bool equal =
        scenario_same_scene(old->scenario, scenario) && old->scenario->axes == scenario->axes;
    for (int k = 0; equal && k < scenario->axes; k++)
        equal = same_axis(&old->scenario->axis[k], &scenario->axis[k]);
    return equal || refuse(message, file, "the scene or the sweep");
}

/* ---- the successor -------------------------------------------------------------------------- */

/* Names without symbolic links: the file, and its successor until that takes the name. */
struct names {
    char real[PATH_MAX], made[PATH_MAX + 8];
};

static bool find_names(struct names *names, const char *file)
{
    if (!realpath(file, names->real))
        return false;
    snprintf(names->made, sizeof names->made, "%s.next", names->real);
    return true;
}

/* What a successor begins with, or nothing yet: whatever else has its name is somebody's own. */
static bool is_ours(const char *file)
{
    static const char signature[8] = "\211HDF\r\n\032\n";
    char begin[sizeof signature] = {0};
    const int descriptor = open(file, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    struct stat found;
    const bool regular =
        descriptor >= 0 && fstat(descriptor, &found) == 0 && S_ISREG(found.st_mode);
    const bool begun =
        regular && (found.st_size == 0 || (read(descriptor, begin, sizeof begin) == sizeof begin &&
                                           memcmp(begin, signature, sizeof begin) == 0));
    if (descriptor >= 0)
        close(descriptor);
    return begun;
}

void changed_scenario_clear(const char *file)
{
    struct names names;
    if (find_names(&names, file) && is_ours(names.made))
        unlink(names.made);
}

bool changed_scenario_make(struct adopted *old, struct plan *plan, int ranks, const char *hosts,
                           struct adopted_rows *rows, bool *refused, stance_message *message)
{
    struct names names;
    struct store *to = NULL;
    struct plan_error error = {0};

    *rows = (struct adopted_rows){.may_stop = true};
    *refused = false;
    if (!find_names(&names, old->file))
        return complain(message, "%.150s: %s", old->file, strerror(errno));
    if (old->origin.ancestors >= STORE_MOST_ANCESTORS)
        return refuse(message, old->file, "a file of so many scenarios");
    if (!adopt_open(old, message))
        return false;
    if (!may_follow(old->file, &old->plan, plan, message)) {
        *refused = true;
        return false;
    }
    adopt_designs(old, plan, NULL);
    bool good = plan_check_cases(plan, &error);
    if (!good)
        *message = error.message;
    unlink(names.made); /* of an attempt that was killed */
    good = good && store_create(names.made, plan, &old->origin, ranks, hosts, message);
    plan->ancestors = old->origin.ancestors + 1;
    good =
        good && store_open(&to, names.made, plan, 1, message) && adopt_rows(old, to, rows, message);
    if (good && rows->stopped) {
        message->text[0] = '\0';
        good = false;
    }
    if (good)
        good = store_close(to, message);
    else
        store_abandon(to);
    good = good && store_take_place(names.made, names.real, message);
    if (!good)
        unlink(names.made);
    return good;
}
