/* changed_scenario.c - see changed_scenario.h. */
#include "changed_scenario.h"

#include "runner/base/message.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- the difference between two texts ------------------------------------------------------- */

enum { MOST_LINES = 2000, MOST_SHOWN = 12, SHOWN_COLUMNS = 120 };

struct lines {
    char *text, **line; /* in it, each with its end */
    size_t count;
};

static struct lines split(const char *text)
{
    struct lines lines = {strdup(text), malloc((strlen(text) + 1) * sizeof *lines.line), 0};
    for (char *rest = lines.line ? lines.text : NULL; rest && *rest;)
        lines.line[lines.count++] = strsep(&rest, "\n");
    return lines;
}

static void show(FILE *to, size_t number, char sign, const char *line)
{
    const bool cut = strlen(line) > SHOWN_COLUMNS;
    if (to && number < MOST_SHOWN)
        fprintf(to, "  %c %.*s%s\n", sign, SHOWN_COLUMNS, line, cut ? "..." : "");
}

/* As few lines as can be, unless there are so many that between the first and the last difference
 * all count as different. */
size_t changed_scenario_differences(FILE *to, const char *before, const char *after)
{
    struct lines old = split(before), new = split(after);
    size_t begin = 0, n = old.count, m = new.count, differing = 0;
    while (begin < n && begin < m && strcmp(old.line[begin], new.line[begin]) == 0)
        begin++;
    while (n > begin && m > begin && strcmp(old.line[n - 1], new.line[m - 1]) == 0) {
        n--;
        m--;
    }
    const size_t a = n - begin, b = m - begin;
    char *const *const x = old.line + begin, *const *const y = new.line + begin;
    /* common[i][j]: most lines that x[i ...] and y[j ...] have in common, in order. */
    uint16_t *common =
        a <= MOST_LINES && b <= MOST_LINES ? calloc((a + 1) * (b + 1), sizeof *common) : NULL;
    for (size_t i = a; common && i-- > 0;) {
        for (size_t j = b; j-- > 0;) {
            const uint16_t down = common[(i + 1) * (b + 1) + j],
                           right = common[i * (b + 1) + j + 1];
            common[i * (b + 1) + j] = strcmp(x[i], y[j]) == 0
                                          ? (uint16_t)(common[(i + 1) * (b + 1) + j + 1] + 1)
                                      : down > right ? down
                                                     : right;
        }
    }
    for (size_t i = 0, j = 0; i < a || j < b;) {
        if (common && i < a && j < b && strcmp(x[i], y[j]) == 0) {
            i++;
            j++;
        } else if (i < a && (j == b || !common ||
                             common[(i + 1) * (b + 1) + j] >= common[i * (b + 1) + j + 1])) {
            show(to, differing++, '-', x[i++]);
        } else {
            show(to, differing++, '+', y[j++]);
        }
    }
    free(common);
    free(old.text);
    free(old.line);
    free(new.text);
    free(new.line);
    if (to && differing > MOST_SHOWN)
        fprintf(to, "  ... and %zu more\n", differing - MOST_SHOWN);
    return differing;
}

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

static bool same_axes(const struct scenario *a, const struct scenario *b)
{
    bool equal = scenario_same_scene(a, b) && a->axes == b->axes;
    for (int k = 0; equal && k < a->axes; k++)
        equal = same_axis(&a->axis[k], &b->axis[k]);
    return equal;
}

/* The seed is among what its points are made from. */
static bool same_sample(const struct scenario *a, const struct scenario *b)
{
    const struct doe *x = &a->sample.design, *y = &b->sample.design;
    return a->sample.given == b->sample.given &&
           (!a->sample.given ||
            (x->method == y->method && x->count == y->count && x->factors == y->factors &&
             x->levels == y->levels && x->second_order == y->second_order && x->seed == y->seed));
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

static bool same_cases(const struct scenario *a, const struct scenario *b)
{
    return same_bits(&a->base, &b->base, sizeof a->base) && a->seed == b->seed &&
           a->refine.given == b->refine.given && a->refine.start == b->refine.start &&
           a->refine.margin == b->refine.margin && a->refine.probes == b->refine.probes;
}

static bool same_record(const struct plan *a, const struct plan *b)
{
    bool equal = a->record_rows == b->record_rows && a->record_interval == b->record_interval &&
                 a->record_cases == b->record_cases;
    for (uint64_t k = 0; equal && a->record_rows > 0 && k < a->record_cases; k++)
        equal = plan_recorded_case(a, k) == plan_recorded_case(b, k);
    return equal;
}

static bool may_follow(const char *file, const struct plan *before, const struct plan *after,
                       stance_message *message)
{
    const struct scenario *a = before->scenario, *b = after->scenario;
    const bool equal = same_cases(a, b);
    return (a->answers == b->answers || refuse(message, file, "which answers are stored")) &&
           (same_record(before, after) ||
            refuse(message, file, "which trajectories are recorded, and when")) &&
           (equal || !(a->refine.given || b->refine.given) ||
            refuse(message, file, "the cases of a refined map, which follow from each other")) &&
           (equal || same_designs(a, b) ||
            refuse(message, file, "what its controller designs depend on"));
}

bool changed_scenario_check_sweep(const char *file, const struct store_origin *origin,
                                  const struct scenario *scenario, stance_message *message)
{
    struct scenario *old = calloc(1, sizeof *old);
    bool good = false;

    if (!old) {
        no_memory(message);
    } else if (!scenario_read(old, file, origin->scenario, NULL, 0, NULL)) {
        refuse(message, file, "a scenario that this version cannot read");
    } else {
        good = (same_sample(old, scenario) ||
                refuse(message, file, "sweep.sample or the seed of its points")) &&
               (same_axes(old, scenario) || refuse(message, file, "the scene or the sweep"));
        scenario_free(old);
    }
    free(old);
    return good;
}

/* ---- the successor -------------------------------------------------------------------------- */

struct making {
    const char *file;
    char real[PATH_MAX], made[PATH_MAX + 8]; /* without symbolic links; the successor until then */
    const struct store_origin *origin;
    struct plan *plan;
    struct changed_scenario_counts *counts;
    stance_message *message;
    bool stopped;
};

static bool system_failed(const struct making *making, const char *what)
{
    return complain(making->message, "%.150s: cannot %s: %s", making->file, what, strerror(errno));
}

/* A row keeps its place; once told to stop none is copied. */
static uint64_t same_row(void *context, uint64_t row)
{
    struct making *making = context;
    const struct plan *plan = making->plan;
    if (row % STORE_ROWS == 0 && plan->stop && plan->stop(plan->stop_context))
        making->stopped = true;
    return making->stopped ? STORE_NOWHERE : row;
}

/* Copies the rows that verify. */
static bool copy_rows(struct making *making, struct store *from, struct store *to)
{
    struct store_copied copied = {0};
    const bool good = store_copy(from, to, same_row, making, &copied, making->message);
    *making->counts = (struct changed_scenario_counts){copied.copied, copied.damaged, false};
    if (making->stopped)
        making->message->text[0] = '\0';
    return good && !making->stopped;
}

/* To the disk, then under the old one's name. */
static bool take_place(const struct making *making)
{
    char directory[PATH_MAX];
    struct stat before;
    int descriptor = open(making->made, O_RDWR | O_CLOEXEC);
    /* Whoever may write the old file may write this one, as far as the system lets us see to it. */
    if (descriptor >= 0 && stat(making->real, &before) == 0 &&
        fchown(descriptor, before.st_uid, before.st_gid) == 0)
        (void)fchmod(descriptor, before.st_mode & 0777);
    if (descriptor < 0 || fsync(descriptor) != 0 || close(descriptor) != 0)
        return system_failed(making, "bring its successor to the disk");
    if (rename(making->made, making->real) != 0)
        return system_failed(making, "replace it by its successor");
    snprintf(directory, sizeof directory, "%s", making->real);
    descriptor = open(dirname(directory), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        (void)fsync(descriptor); /* some file systems cannot; then the rename takes its time */
        close(descriptor);
    }
    return true;
}

static bool make(struct making *making, struct plan *before, int ranks, const char *hosts)
{
    struct plan *plan = making->plan;
    struct store *from = NULL, *to = NULL;
    struct plan_error error = {0};
    stance_message *message = making->message;

    bool good = store_open(&from, making->real, before, 1, message) &&
                store_read_designs(from, plan, message);
    if (good && !plan_check_cases(plan, &error)) {
        *message = error.message;
        good = false;
    }
    unlink(making->made); /* of an attempt that was killed */
    good = good && store_create(making->made, plan, making->origin, ranks, hosts, message);
    plan->ancestors = before->ancestors + 1;
    good = good && store_open(&to, making->made, plan, 1, message) && copy_rows(making, from, to);
    if (good) {
        good = store_close(to, message);
        to = NULL;
    }
    store_abandon(to);
    stance_message ignored;
    if (from && !store_close(from, &ignored))
        good = good && system_failed(making, "close it");
    good = good && take_place(making);
    if (!good)
        unlink(making->made);
    return good;
}

static void name_made(struct making *making)
{
    snprintf(making->made, sizeof making->made, "%s.next", making->real);
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
    struct making making = {.file = file};
    if (!realpath(file, making.real))
        return;
    name_made(&making);
    if (is_ours(making.made))
        unlink(making.made);
}

bool changed_scenario_make(const char *file, const struct store_origin *origin, struct plan *plan,
                           int ranks, const char *hosts, struct changed_scenario_counts *counts,
                           stance_message *message)
{
    struct making making = {
        .file = file, .origin = origin, .plan = plan, .counts = counts, .message = message};
    struct scenario *old = calloc(1, sizeof *old);
    struct plan before = {0};
    struct plan_error error = {0};
    bool good = false;

    *counts = (struct changed_scenario_counts){0};
    if (!old || !realpath(file, making.real)) {
        system_failed(&making, "prepare its successor");
    } else if (origin->ancestors >= STORE_MOST_ANCESTORS) {
        refuse(message, file, "a file of so many scenarios");
    } else if (!scenario_read(old, file, origin->scenario, NULL, 0, NULL)) {
        refuse(message, file, "a scenario that this version cannot read");
    } else {
        name_made(&making);
        if (!plan_make(&before, old, plan->single, plan->single_case, plan->record_rows > 0,
                       &error)) {
            *message = error.message;
        } else if (!may_follow(file, &before, plan, message)) {
            counts->refused = true;
        } else {
            before.ancestors = origin->ancestors;
            good = make(&making, &before, ranks, hosts);
        }
        plan_free(&before);
        scenario_free(old);
    }
    free(old);
    return good;
}
