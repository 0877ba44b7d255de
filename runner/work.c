/* work.c - draw a chunk, cut it into slices, run them, write them, look whether to stop. */
#include "work.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    SLICE_SMALLEST = 16,
    TRAJECTORY_MEMORY = 1 << 26, /* bytes of trajectories in hand */
    MAX_METHODS = 32,
};
/* A slice is cut to about this time: stops are answered so fast, and the counters served. */
static const double slice_seconds = 0.3;
static const double progress_terminal = 0.5, progress_elsewhere = 60;

static volatile sig_atomic_t stop_asked;

static void ask_stop(int number)
{
    (void)number;
    stop_asked = 1;
}

void work_catch_signals(void)
{
    struct sigaction action = {.sa_handler = ask_stop, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGUSR1, &action, NULL);
    action.sa_flags |= SA_RESETHAND;
    sigaction(SIGINT, &action, NULL);
}

bool work_stop_asked(void)
{
    return stop_asked != 0;
}

/* ---- one slice ---------------------------------------------------------------------------- */

/* Memory for one slice, the same for all slices of a rank. */
struct bench {
    stance_case *cases, *grouped; /* [STORE_ROWS] */
    stance_result *results, *grouped_results;
    int *method; /* [STORE_ROWS]; -1: the case does not exist */
    bool *whole;
    double *samples; /* of the trajectories, [room][record_rows * elements] */
    stance_trajectory *trajectory;
    uint64_t *place; /* of each trajectory in the file */
    size_t room;     /* trajectories that fit */
    const stance_kernel *kernel[MAX_METHODS];
};

static void bench_free(struct bench *bench)
{
    free(bench->cases);
    free(bench->grouped);
    free(bench->results);
    free(bench->grouped_results);
    free(bench->method);
    free(bench->whole);
    free(bench->samples);
    free(bench->trajectory);
    free(bench->place);
}

/* Doubles of one recorded instant. */
static size_t instant_size(const stance_scene *scene)
{
    return 2 * (size_t)scene->coordinates + (size_t)scene->actuators + 3 * (size_t)scene->contacts;
}

static bool bench_make(struct bench *bench, const struct plan *plan)
{
    *bench = (struct bench){0};
    bench->cases = calloc(STORE_ROWS, sizeof *bench->cases);
    bench->grouped = calloc(STORE_ROWS, sizeof *bench->grouped);
    bench->results = calloc(STORE_ROWS, sizeof *bench->results);
    bench->grouped_results = calloc(STORE_ROWS, sizeof *bench->grouped_results);
    bench->method = calloc(STORE_ROWS, sizeof *bench->method);
    bench->whole = calloc(STORE_ROWS, sizeof *bench->whole);
    if (!bench->cases || !bench->grouped || !bench->results || !bench->grouped_results ||
        !bench->method || !bench->whole) {
        return false;
    }
    for (int m = 0; m < MAX_METHODS && stance_methods()[m]; m++) {
        bench->kernel[m] = stance_kernel_find(plan->scenario->scene, stance_methods()[m], NULL);
    }
    if (plan->record_rows == 0) {
        return true;
    }
    size_t size = (size_t)plan->record_rows * instant_size(plan->scenario->scene);
    bench->room = TRAJECTORY_MEMORY / (size * sizeof(double));
    bench->room = bench->room > STORE_ROWS ? STORE_ROWS : bench->room;
    bench->room = bench->room > plan->record_cases ? (size_t)plan->record_cases : bench->room;
    bench->room = bench->room < 1 ? 1 : bench->room;
    bench->samples = malloc(bench->room * size * sizeof *bench->samples);
    bench->trajectory = calloc(bench->room, sizeof *bench->trajectory);
    bench->place = calloc(bench->room, sizeof *bench->place);
    return bench->samples && bench->trajectory && bench->place;
}

/* Trajectory k, blank: NAN stays where a case ends before. */
static stance_trajectory *blank_trajectory(struct bench *bench, const struct plan *plan, size_t k)
{
    const stance_scene *scene = plan->scenario->scene;
    size_t rows = (size_t)plan->record_rows, size = rows * instant_size(scene);
    double *at = bench->samples + k * size;
    stance_trajectory *trajectory = &bench->trajectory[k];

    for (size_t i = 0; i < size; i++) {
        at[i] = NAN;
    }
    trajectory->interval = plan->record_interval;
    trajectory->rows = plan->record_rows;
    trajectory->position = at;
    trajectory->velocity = at += rows * (size_t)scene->coordinates;
    trajectory->torque = at += rows * (size_t)scene->coordinates;
    trajectory->force = at += rows * (size_t)scene->actuators;
    trajectory->gap = at + 2 * rows * (size_t)scene->contacts;
    return trajectory;
}

/* What is stored for a case that does not exist. */
static void fail_initially(stance_result *result)
{
    store_blank(result);
    result->status = STANCE_FAILED;
    result->failure = STANCE_FAILURE_INITIAL;
}

/* Runs the cases of one method among the n of the slice. */
static void run_method(struct bench *bench, int method, size_t n)
{
    size_t index[STORE_ROWS], count = 0;
    for (size_t i = 0; i < n; i++) {
        if (bench->method[i] == method) {
            bench->grouped[count] = bench->cases[i];
            index[count++] = i;
        }
    }
    if (count == 0 || !bench->kernel[method]) { /* the plan saw to it that there is a kernel */
        return;
    }
    memset(bench->grouped_results, 0, count * sizeof *bench->grouped_results);
    bench->kernel[method]->run(bench->grouped, bench->grouped_results, count);
    for (size_t i = 0; i < count; i++) {
        stance_result *result = &bench->results[index[i]];
        *result = bench->grouped_results[i];
        if (result->status == STANCE_DONE && result->evidence == STANCE_EVIDENCE_NONE) {
            result->evidence = STANCE_SIMULATED;
        }
    }
}

/* Rows are dealt with by their place among those to be computed. */
static uint64_t places(const struct work *work)
{
    return work->only ? work->only->count : work->plan->rows;
}

static uint64_t row_at(const struct work *work, uint64_t place)
{
    return work->only ? work->only->row[place] : place;
}

void work_tally(struct work *work, const stance_result *result)
{
    work->finished++;
    if (result->status == STANCE_FAILED) {
        work->failed++;
    } else if (result->outcome >= 0 && result->outcome < WORK_OUTCOMES) {
        work->outcome[result->outcome]++;
    }
}

static void tally(struct work *work, uint64_t place, const stance_result *result)
{
    work_tally(work, result);
    if (work->label) {
        bool failed = result->status == STANCE_FAILED;
        work->label[place] = (uint8_t)(failed ? WORK_OUTCOMES + 1 : result->outcome + 1);
    }
}

static bool write_rows(const struct work *work, uint64_t first, size_t n,
                       const stance_result *results, stance_message *message)
{
    return work->only ? store_write_list(work->store, work->only->row + first, n, results, message)
                      : store_write(work->store, first, n, results, message);
}

static bool verify_rows(const struct work *work, uint64_t first, size_t n, stance_result *results,
                        bool *whole, stance_message *message)
{
    return work->only
               ? store_verify_list(work->store, work->only->row + first, n, results, whole, message)
               : store_verify(work->store, first, n, results, whole, message);
}

/* Computes and writes the rows at places [first, first + *n); *n shrinks when their trajectories do
 * not fit. */
static bool compute_rows(struct work *work, struct bench *bench, uint64_t first, size_t *n,
                         stance_message *message)
{
    size_t recorded = 0, count = 0;

    for (; count < *n; count++) {
        uint64_t place;
        int method;
        const uint64_t row = row_at(work, first + count);
        bool record = plan_recorded(work->plan, row, &place);
        if (record && recorded == bench->room) {
            break;
        }
        if (!plan_resolve(work->plan, row, &bench->cases[count], &method)) {
            fail_initially(&bench->results[count]);
            method = -1;
        }
        bench->method[count] = method;
        bench->cases[count].trajectory = NULL;
        if (record) {
            bench->place[recorded] = place;
            bench->cases[count].trajectory = blank_trajectory(bench, work->plan, recorded++);
        }
    }
    *n = count;
    for (int m = 0; m < MAX_METHODS && stance_methods()[m]; m++) {
        run_method(bench, m, count);
    }
    for (size_t k = 0; k < recorded; k++) {
        if (!store_write_trajectory(work->store, bench->place[k], &bench->trajectory[k], message)) {
            return false;
        }
    }
    if (!write_rows(work, first, count, bench->results, message)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        tally(work, first + i, &bench->results[i]);
    }
    work->computed += count;
    return true;
}

/* Rows of a slice that a resume need not compute again are counted as they are; *n becomes the
 * length of the first stretch of equal kind, *kept says which kind. */
static bool keep_rows(struct work *work, struct bench *bench, uint64_t first, size_t *n, bool *kept,
                      stance_message *message)
{
    size_t length = 1;
    if (!verify_rows(work, first, *n, bench->results, bench->whole, message)) {
        return false;
    }
    while (length < *n && bench->whole[length] == bench->whole[0]) {
        length++;
    }
    *n = length;
    *kept = bench->whole[0];
    for (size_t i = 0; *kept && i < length; i++) {
        tally(work, first + i, &bench->results[i]);
    }
    return true;
}

/* ---- progress ----------------------------------------------------------------------------- */

struct progress {
    bool terminal;
    double start;
};

static void duration(char *text, size_t size, double seconds)
{
    if (!(seconds < 360000)) {
        snprintf(text, size, "%.0f h", seconds / 3600);
    } else {
        int s = (int)(seconds + 0.5);
        snprintf(text, size, "%d:%02d:%02d", s / 3600, s / 60 % 60, s % 60);
    }
}

static void show_progress(struct work *work, const struct progress *progress)
{
    double now = plan_clock();
    if (work->quiet || work->parallel->rank != 0 || now < work->progress_due) {
        return;
    }
    char left[32] = "?", round[32] = "";
    uint64_t finished = (uint64_t)parallel_add(work->parallel, COUNTER_DONE, 0);
    uint64_t kept = (uint64_t)parallel_add(work->parallel, COUNTER_KEPT, 0);
    double rate = (double)(finished - kept) / (now - progress->start);
    if (rate > 0) {
        duration(left, sizeof left, (double)(places(work) - finished) / rate);
    }
    if (work->round > 0) {
        snprintf(round, sizeof round, "round %d: ", work->round);
    }
    fprintf(stderr, "%s%s%" PRIu64 " of %" PRIu64 " cases, %.0f cases/s, %s left%s",
            progress->terminal ? "\r" : "", round, finished, places(work), rate, left,
            progress->terminal ? "\033[K" : "\n");
    fflush(stderr);
    work->progress_due = now + (progress->terminal ? progress_terminal : progress_elsewhere);
}

/* ---- the loop ----------------------------------------------------------------------------- */

bool work_told_to_stop(const struct work *work, double expected)
{
    if (stop_asked || plan_clock() - work->start + expected > work->time_limit) {
        parallel_add(work->parallel, COUNTER_STOP, 1);
        return true;
    }
    return parallel_add(work->parallel, COUNTER_STOP, 0) != 0;
}

/* Computes a chunk in slices. *stop: leave, this was not all. */
static bool run_chunk(struct work *work, struct bench *bench, struct progress *progress,
                      uint64_t first, uint64_t count, double *per_case, bool *stop,
                      stance_message *message)
{
    for (uint64_t end = first + count; first < end;) {
        double fits = *per_case > 0 ? slice_seconds / *per_case : SLICE_SMALLEST;
        size_t n = fits > STORE_ROWS       ? STORE_ROWS
                   : fits > SLICE_SMALLEST ? (size_t)fits
                                           : SLICE_SMALLEST;
        n = end - first < n ? (size_t)(end - first) : n;
        if ((*stop = work_told_to_stop(work, *per_case * (double)n))) {
            return true;
        }
        bool kept = false;
        if (work->resume && !keep_rows(work, bench, first, &n, &kept, message)) {
            return false;
        }
        double start = plan_clock();
        if (!kept) {
            if (!compute_rows(work, bench, first, &n, message)) {
                return false;
            }
            double spent = plan_clock() - start;
            work->seconds += spent;
            *per_case = spent / (double)n;
        }
        first += n;
        parallel_add(work->parallel, COUNTER_DONE, (int64_t)n);
        if (kept) {
            parallel_add(work->parallel, COUNTER_KEPT, (int64_t)n);
        }
        show_progress(work, progress);
    }
    return true;
}

static bool run_chunks(struct work *work, struct bench *bench, struct progress *progress,
                       stance_message *message)
{
    double per_case = 0;
    uint64_t first, count;
    bool stop = false;

    while (!stop) {
        int64_t k = parallel_add(work->parallel, COUNTER_CHUNK, 1);
        if (!plan_chunk(places(work), work->parallel->size, (uint64_t)k, &first, &count)) {
            break;
        }
        if (!run_chunk(work, bench, progress, first, count, &per_case, &stop, message)) {
            parallel_add(work->parallel, COUNTER_STOP, 1);
            return false;
        }
    }
    return true;
}

bool work_run(struct work *work, stance_message *message)
{
    struct bench bench;
    struct progress progress = {.terminal = isatty(STDERR_FILENO) == 1, .start = plan_clock()};
    if (work->progress_due <= 0) {
        work->progress_due =
            progress.start + (progress.terminal ? progress_terminal : progress_elsewhere);
    }

    bool good = bench_make(&bench, work->plan);
    if (!good) {
        snprintf(message->text, sizeof message->text, "not enough memory for %s",
                 bench.samples || work->plan->record_rows == 0 ? "the cases" : "trajectories");
        parallel_add(work->parallel, COUNTER_STOP, 1);
    }
    good = good && run_chunks(work, &bench, &progress, message);
    if (progress.terminal && !work->quiet && work->parallel->rank == 0) {
        fputs("\r\033[K", stderr);
    }
    bench_free(&bench);
    return good;
}
