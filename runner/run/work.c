/* work.c - a rank's part of the computing: the kernel's lanes take cases from blocks of rows that
 * are drawn as they run dry, and hand results back into them as they end.
 *
 * A block stays open until its last case has ended. Every open block but the one that is being
 * taken from has a case in a lane, so that there are never more of them than lanes and one; a
 * straggler keeps its block, not its lane's neighbours. What has ended is written when the block is
 * whole, and in between every second or so. Only the end of the job makes lanes wait.
 *
 * A kernel is of one method. Where methods are swept, streams follow each other: each takes the
 * rows of its method from the chunk in hand and, once none but its own are left of that, from the
 * next one. So lanes run empty once a chunk, and once more where a compiled kernel comes in the
 * middle: all have the same bits, so that it does not matter which has computed a row.
 */
#include "work.h"

#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/ranks/crash.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    MAX_METHODS = 32,
    BLOCKS_OF_METHODS = 16, /* open at once where methods are swept */
};

static const double at_once = 1; /* s: first rows do not wait, whoever needs the core */

/* ---- blocks and tasks --------------------------------------------------------------------- */

enum state { PENDING, RUNNING, ENDED, STORED }; /* at first all are pending */

/* Rows that were drawn together. */
struct block {
    struct block *next;
    struct store_block *rows;
    uint64_t first;          /* place in the schedule */
    size_t count;            /* rows */
    size_t open;             /* of these, not ended */
    size_t cursor;           /* where the stream looks for its next case */
    double write_at;         /* when what has ended is written next */
    int writes;              /* so far */
    uint8_t *state, *method; /* [count], behind it */
};

/* A case in a lane. */
struct task {
    stance_case input; /* first: by this the kernel names it */
    stance_result result;
    stance_trajectory trajectory;
    uint64_t place; /* of the trajectory in the file */
    struct block *block;
    size_t slot;
    int hand; /* place in the list of what is in hand, see crash.h */
    struct task *next, *next_idle;
};

/* All that the callbacks of a stream know. */
struct job {
    struct work *work;
    const struct plan *plan;
    struct schedule schedule;
    uint8_t *label; /* [places of the schedule], or NULL */
    const stance_kernel *kernel[MAX_METHODS];
    size_t capacity;                /* rows of a block */
    struct block *oldest;           /* open blocks in the order of drawing */
    struct block *at;               /* the one that the stream takes from; NULL: none has any */
    int method;                     /* of the stream */
    uint64_t pending;               /* rows of open blocks in state PENDING */
    int blocks;                     /* open */
    struct task *tasks, *idle_task; /* all; those that are in no lane */
    uint64_t ended, kept;           /* not yet told to the counters */
    double look_at;                 /* when next */
    double elsewhere;               /* s spent on what the file already holds, and for kernels */
    bool later;                     /* there are kernels that come later ... */
    bool all_drawn;                 /* ... and no rows that no rank has drawn */
    bool came;                      /* kernels that were to come later */
    bool leaving;                   /* no more cases: told to stop, or broken */
    bool broken;                    /* nothing can be written; *message says why */
    bool told;                      /* ... and the others know that we are to stop */
    bool lost;                      /* the file or its lock is; *message says why */
    stance_message *message;
    double start; /* of clock_seconds() */
};

/* No more, with the reason in *job->message. */
static void break_off(struct job *job)
{
    job->broken = job->leaving = true;
    parallel_add(job->work->parallel, COUNTER_STOP, 1);
}

static void out_of_memory(struct job *job, const char *what)
{
    complain(job->message, "not enough memory for %s", what);
    break_off(job);
}

/* Of rows from a place of the schedule on; NULL: no memory. */
static struct block *block_make(const struct job *job, uint64_t first, size_t count)
{
    const struct store *const store = job->work->store;
    struct block *block = calloc(1, sizeof *block + 2 * count);
    struct store_block *const rows = block && store ? store_block_make(store, count) : NULL;
    if (!block || (store && !rows)) {
        free(block);
        return NULL;
    }
    *block = (struct block){.rows = rows, .first = first, .count = count, .open = count};
    block->state = (uint8_t *)(block + 1);
    block->method = block->state + count;
    block->write_at = clock_seconds() + schedule_write_interval(job->work->parallel->size, 0);
    return block;
}

static void block_free(struct block *block)
{
    free(block->rows);
    free(block);
}

static struct task *task_take(struct job *job)
{
    struct task *task = job->idle_task;
    if (task) {
        job->idle_task = task->next_idle;
        return task;
    }
    task = calloc(1, sizeof *task);
    if (!task) {
        out_of_memory(job, "the cases");
        return NULL;
    }
    task->hand = -1;
    task->next = job->tasks;
    job->tasks = task;
    return task;
}

static void task_leave(struct job *job, struct task *task)
{
    crash_leave(task->hand);
    task->hand = -1;
    task->next_idle = job->idle_task;
    job->idle_task = task;
}

/* ---- results ------------------------------------------------------------------------------ */

void work_tally(struct work *work, stance_status status, stance_outcome outcome)
{
    work->sums.finished++;
    if (status == STANCE_FAILED)
        work->sums.failed++;
    else if ((int)outcome >= 0 && (int)outcome < STANCE_OUTCOME_COUNT)
        work->sums.outcome[outcome]++;
}

/* Counts the row at a place of the schedule. */
static void tally(struct job *job, uint64_t place, stance_status status, stance_outcome outcome)
{
    work_tally(job->work, status, outcome);
    if (job->label)
        job->label[place] = (uint8_t)(status == STANCE_FAILED ? WORK_FAILED : (int)outcome + 1);
}

static uint64_t row_at(const struct job *job, const struct block *block, size_t slot)
{
    return rows_at(&job->schedule.rows, block->first + slot);
}

/* Writes the rows of a block that have ended, in stretches of at least so many. */
static void write_block(struct job *job, struct block *block, size_t least)
{
    for (size_t slot = 0, n; slot < block->count && !job->broken; slot += n > 0 ? n : 1) {
        n = 0;
        while (slot + n < block->count && block->state[slot + n] == ENDED)
            n++;
        if (n < least)
            continue;
        const struct rows rows = rows_part(&job->schedule.rows, block->first + slot, n);
        if (job->work->store &&
            !store_write(job->work->store, block->rows, slot, &rows, job->message)) {
            break_off(job);
            return;
        }
        memset(block->state + slot, STORED, n);
    }
}

/* What has ended of blocks that have been open for long. */
static void write_ended(struct job *job, double now)
{
    for (struct block *block = job->oldest; block; block = block->next) {
        if (now >= block->write_at) {
            const double start = clock_seconds();
            write_block(job, block, ++block->writes % SCHEDULE_ALL == 0 ? 1 : SCHEDULE_STRETCH);
            const double end = clock_seconds();
            block->write_at = end + schedule_write_interval(job->work->parallel->size, end - start);
        }
    }
}

/* All that has ended. */
static void write_open(void *context)
{
    struct job *const job = context;
    for (struct block *block = job->oldest; block; block = block->next)
        write_block(job, block, 1);
}

/* Takes a block whose rows have all ended out of the list. */
static void close_block(struct job *job, struct block *block)
{
    struct block **link = &job->oldest;
    while (*link != block)
        link = &(*link)->next;
    *link = block->next;
    if (job->at == block)
        job->at = block->next;
    block_free(block);
    job->blocks--;
}

/* The result of a row, which was pending or in a lane. */
static void end_row(struct job *job, struct block *block, size_t slot, const stance_result *result)
{
    if (block->rows)
        store_put(block->rows, slot, result);
    else
        job->work->ends(job->work->context, row_at(job, block, slot), result);
    tally(job, block->first + slot, result->status, result->outcome);
    block->state[slot] = ENDED;
    job->work->sums.computed++;
    job->ended++;
    if (--block->open == 0) {
        write_block(job, block, 1);
        close_block(job, block);
    }
}

/* A task's trajectory, then its row. */
static void end_task(struct job *job, struct task *task)
{
    if (!task->input.trajectory ||
        store_write_trajectory(job->work->store, task->place, &task->trajectory, job->message))
        end_row(job, task->block, task->slot, &task->result);
    else
        break_off(job);
    task_leave(job, task);
}

static void case_done(void *context, const stance_case *input, stance_result *result)
{
    /* A task begins with its case, which was handed out as const but is not. */
    struct task *task = (struct task *)(uintptr_t)input;
    if (result->status == STANCE_DONE)
        result->evidence = STANCE_SIMULATED;
    end_task(context, task);
}

/* ---- drawing ------------------------------------------------------------------------------ */

static bool attend(void *context);

/* Counts a row that is marked done but does not verify; the lowest ones are named. */
static void note_damage(struct work *work, uint64_t row)
{
    uint64_t key = ~plan_case(work->plan, row);
    work->sums.damaged++;
    for (int k = 0; k < WORK_NAMED; k++) {
        if (key > work->damaged_case[k]) {
            const uint64_t higher = work->damaged_case[k];
            work->damaged_case[k] = key;
            key = higher;
        }
    }
}

bool work_verify(struct work *work, const struct rows *rows, struct store_found *found,
                 stance_message *message)
{
    if (!store_verify(work->store, rows, found, message))
        return false;
    for (size_t i = 0; i < rows->count; i++)
        if (!found[i].whole && found[i].status != STANCE_PENDING)
            note_damage(work, rows_at(rows, i));
    return true;
}

/* Rows that the file of a resumed run holds whole are as good as ended. */
static void keep_rows(struct job *job, struct block *block)
{
    const double start = clock_seconds();
    struct store_found found[STORE_ROWS];

    for (size_t slot = 0, n; slot < block->count && !job->broken; slot += n) {
        n = block->count - slot < STORE_ROWS ? block->count - slot : STORE_ROWS;
        const struct rows rows = rows_part(&job->schedule.rows, block->first + slot, n);
        if (!work_verify(job->work, &rows, found, job->message)) {
            break_off(job);
            return;
        }
        for (size_t i = 0; i < n; i++) {
            if (found[i].whole) {
                tally(job, block->first + slot + i, found[i].status, found[i].outcome);
                block->state[slot + i] = STORED;
                block->open--;
                job->kept++;
            }
        }
    }
    job->elsewhere += clock_seconds() - start;
}

/* So are those that are left out. */
static void leave_rows(struct job *job, struct block *block)
{
    for (size_t slot = 0; slot < block->count; slot++) {
        if (!job->work->takes(job->work->context, row_at(job, block, slot))) {
            block->state[slot] = STORED;
            block->open--;
        }
    }
}

/* The next rows of the chunk in hand, or of a new one. false: there are none, or no memory. */
static bool open_block(struct job *job)
{
    uint64_t first;
    size_t count = schedule_take(&job->schedule, job->capacity, &first);
    if (count == 0) {
        const int64_t k = parallel_add(job->work->parallel, COUNTER_CHUNK, 1);
        if (!schedule_draw(&job->schedule, (uint64_t)k))
            return false;
        count = schedule_take(&job->schedule, job->capacity, &first);
    }
    struct block *const block = block_make(job, first, count);
    if (!block) {
        out_of_memory(job, "the results");
        return false;
    }
    struct block **link = &job->oldest;
    while (*link)
        link = &(*link)->next;
    *link = block;
    job->blocks++;
    for (size_t slot = 0; slot < count; slot++)
        block->method[slot] = (uint8_t)plan_method(job->plan, row_at(job, block, slot));
    if (job->work->resume)
        keep_rows(job, block);
    if (job->work->takes)
        leave_rows(job, block);
    job->pending += block->open;
    job->at = job->at ? job->at : block;
    if (block->open == 0)
        close_block(job, block);
    return true;
}

/* The next pending row of the stream's method. */
static bool find_row(struct job *job, struct block **block, size_t *slot)
{
    for (;;) {
        for (; job->at; job->at = job->at->next) {
            for (struct block *b = job->at; b->cursor < b->count; b->cursor++) {
                if (b->state[b->cursor] == PENDING && b->method[b->cursor] == job->method) {
                    *block = b;
                    *slot = b->cursor++;
                    job->pending--;
                    return true;
                }
            }
        }
        /* Not while rows of other methods wait, but for the rest of a chunk as far as memory goes.
         */
        const bool may_draw = job->pending == 0 || (job->blocks < BLOCKS_OF_METHODS &&
                                                    job->schedule.next < job->schedule.end);
        if (!may_draw || attend(job) || !open_block(job) || job->leaving)
            return false;
    }
}

/* Whether this rank leaves its core to the compilers. */
static bool gives_way(const struct job *job)
{
    return job->later && !job->all_drawn && clock_seconds() - job->start > at_once &&
           objects_later_wait(job->work->kernels->later, job->work->parallel);
}

static bool next_case(void *context, const stance_case **input, stance_result **result)
{
    struct job *job = context;
    if (job->came || gives_way(job))
        return false;
    struct block *block;
    size_t slot;
    int method;

    while (!job->leaving && find_row(job, &block, &slot)) {
        struct task *task = task_take(job);
        if (!task)
            return false;
        const uint64_t row = row_at(job, block, slot);
        const bool exists = plan_resolve(job->plan, row, &task->input, &method);
        if (job->work->cycle > 0)
            task->input.grid_index %= job->work->cycle;
        task->block = block;
        task->slot = slot;
        const bool recorded = plan_recorded(job->plan, row, &task->place);
        task->input.trajectory = recorded ? &task->trajectory : NULL;
        if (recorded && !store_blank_trajectory(job->work->store, &task->trajectory)) {
            task_leave(job, task);
            out_of_memory(job, "trajectories");
            return false;
        }
        block->state[slot] = RUNNING;
        if (exists) {
            if (job->work->store)
                task->hand = crash_take(plan_case(job->plan, row));
            *input = &task->input;
            *result = &task->result;
            return true;
        }
        stance_result_clear(&task->result); /* what is stored for a case that does not exist */
        task->result.status = STANCE_FAILED;
        task->result.failure = STANCE_FAILURE_INITIAL;
        end_task(job, task);
    }
    return false;
}

/* ---- counters, progress, stops -------------------------------------------------------------- */

static void show_progress(struct job *job, double now)
{
    struct work *work = job->work;
    if (work->parallel->rank != 0 || !progress_due(&work->progress, now))
        return;
    char left[32] = "?", round[32] = "";
    uint64_t finished = (uint64_t)parallel_add(work->parallel, COUNTER_DONE, 0);
    uint64_t kept = (uint64_t)parallel_add(work->parallel, COUNTER_KEPT, 0);
    double rate = (double)(finished - kept) / (now - job->start);
    if (rate > 0)
        text_of_seconds(left, sizeof left, (double)(job->schedule.rows.count - finished) / rate);
    if (work->round > 0)
        snprintf(round, sizeof round, "round %d: ", work->round);
    progress_say(&work->progress, "%s%" PRIu64 " of %" PRIu64 " cases, %.0f cases/s, %s left",
                 round, finished, job->schedule.rows.count, rate, left);
}

/* Tells the counters what has ended. */
static void report(struct job *job)
{
    const struct parallel *parallel = job->work->parallel;
    if (job->kept > 0)
        parallel_add(parallel, COUNTER_KEPT, (int64_t)job->kept);
    if (job->ended + job->kept > 0)
        parallel_add(parallel, COUNTER_DONE, (int64_t)(job->ended + job->kept));
    job->ended = job->kept = 0;
}

static bool asked_to_stop(const struct work *work, double now)
{
    return work_stop_asked() || now - work->start > work->time_limit;
}

/* Cases that all ranks have computed in this round, as far as they have told. */
static uint64_t count_computed(const struct work *work)
{
    const int64_t done = parallel_add(work->parallel, COUNTER_DONE, 0);
    return (uint64_t)(done - parallel_add(work->parallel, COUNTER_KEPT, 0));
}

/* Rank 0's sign of life for the whole job. */
static void keep_pulse(struct job *job, double now)
{
    struct work *work = job->work;
    if (work->attend && !job->leaving && work->attend(work->context, now)) {
        job->leaving = true;
        parallel_add(work->parallel, COUNTER_STOP, 1);
    }
    if (!work->heartbeat || now < work->heartbeat->due || job->broken || job->lost)
        return;
    if (!heartbeat_beat(work->heartbeat, now, work->before + count_computed(work), work->round,
                        job->message)) {
        job->lost = job->leaving = true;
        parallel_add(work->parallel, COUNTER_STOP, 1);
    }
}

bool work_told_to_stop(const struct work *work)
{
    const bool asked = asked_to_stop(work, clock_seconds());
    return parallel_add(work->parallel, COUNTER_STOP, asked) != 0 || asked;
}

/* Rank 0 tells the others that the compilers have ended, also while it waits for them. */
static void look_for_kernels(struct job *job)
{
    const struct work *const work = job->work;
    uint64_t first, count;
    if (!job->later || job->came)
        return;
    job->all_drawn =
        !schedule_chunk(job->schedule.rows.count, work->parallel->size,
                        (uint64_t)parallel_add(work->parallel, COUNTER_CHUNK, 0), &first, &count);
    const bool ended = work->parallel->rank == 0 && objects_later_ended(work->kernels->later);
    job->came = parallel_add(work->parallel, COUNTER_KERNELS, ended) != 0 || ended;
}

/* Called about every millisecond: what must not wait for the end of a case. true: leave. On rank 0
 * it always looks at the counters, which live there, so that others get at them. */
static bool attend(void *context)
{
    struct job *job = context;
    const struct work *work = job->work;
    const double now = clock_seconds();
    const int ranks = work->parallel->size;

    if (job->leaving)
        return true;
    if (asked_to_stop(work, now)) {
        write_open(job); /* before others are told: rank 0 may not answer */
        parallel_add(work->parallel, COUNTER_STOP, 1);
        job->leaving = job->told = true;
        return true;
    }
    write_ended(job, now);
    if (now >= job->look_at) {
        report(job);
        parallel_beat(work->parallel, ++job->work->beats);
        job->leaving |= parallel_add(work->parallel, COUNTER_STOP, 0) != 0;
        look_for_kernels(job);
        job->look_at = now + schedule_look_interval(ranks);
    } else if (work->parallel->rank == 0) {
        job->leaving |= parallel_add(work->parallel, COUNTER_STOP, 0) != 0;
    }
    keep_pulse(job, now);
    show_progress(job, now);
    return job->leaving;
}

/* While other ranks still work. */
static void wait_for_others(void *context)
{
    struct job *job = context;
    const double now = clock_seconds();
    keep_pulse(job, now);
    const int lost = heartbeat_lost(job->work->heartbeat, now);
    if (lost > 0 && !job->told)
        fprintf(stderr, "stance run: rank %d has said nothing for %d s: stops without it\n", lost,
                (int)DEADLINE_LOST);
    bool stop = lost > 0 || asked_to_stop(job->work, now);
    look_for_kernels(job);
    if (!job->told && (stop || now >= job->look_at)) {
        job->look_at = now + schedule_look_interval(job->work->parallel->size);
        stop |= parallel_add(job->work->parallel, COUNTER_STOP, stop) != 0;
        if (stop)
            deadline_begin();
        job->told = stop;
    }
    show_progress(job, now);
}

/* The ranks come together again; rank 0 remembers what this was. */
static void meet(struct job *job)
{
    struct work *work = job->work;
    parallel_beat(work->parallel, HEARTBEAT_WAITS);
    parallel_meet(work->parallel, wait_for_others, job);
    if (work->parallel->rank == 0)
        work->before += count_computed(work);
}

/* ---- the whole ---------------------------------------------------------------------------- */

/* Method of the first row that waits; draws where none does. false: there are no more. */
static bool find_method(struct job *job)
{
    while (!attend(job)) {
        for (struct block *block = job->oldest; job->pending > 0 && block; block = block->next) {
            for (size_t slot = 0; slot < block->count; slot++) {
                if (block->state[slot] == PENDING) {
                    job->method = block->method[slot];
                    return true;
                }
            }
        }
        if (!open_block(job))
            return false;
    }
    return false;
}

static void take_kernels(struct job *job)
{
    for (int m = 0; m < MAX_METHODS && stance_methods()[m]; m++)
        job->kernel[m] = instruction_set_kernel(job->plan->scenario->scene, stance_methods()[m]);
}

/* Before a stream: kernels that have come are taken, and those that are to come waited for if they
 * come sooner then. false: leave. */
static bool await_kernels(struct job *job)
{
    const double start = clock_seconds();
    while (gives_way(job) && !job->came && !attend(job))
        usleep(1000);
    job->elsewhere += clock_seconds() - start;
    if (job->came) {
        kernels_change(job->work->kernels);
        take_kernels(job);
        job->later = job->came = false;
    }
    return !job->leaving;
}

static void job_free(struct job *job)
{
    for (struct block *block = job->oldest, *next; block; block = next) {
        next = block->next;
        block_free(block);
    }
    for (struct task *task = job->tasks, *next; task; task = next) {
        next = task->next;
        crash_leave(task->hand);
        free(task->trajectory.position);
        free(task);
    }
}

bool work_run(struct work *work, const struct rows *only, uint8_t *label, stance_message *message)
{
    const double start = clock_seconds();
    struct job job = {
        .work = work,
        .plan = work->plan,
        .schedule = schedule_make(work->plan->rows, work->parallel->size, only),
        .label = label,
        .message = message,
        .capacity = schedule_block_rows(work->store ? store_row_size(work->store) : 1),
        .start = start,
        .later = work->kernels && work->kernels->later,
    };
    uint64_t first, largest;
    if (schedule_chunk(job.schedule.rows.count, work->parallel->size, 0, &first, &largest))
        job.capacity = job.capacity < largest ? job.capacity : (size_t)largest;
    if (work->progress.from <= 0)
        work->progress = progress_begin(work->quiet);
    take_kernels(&job);
    deadline_rescue(write_open, &job);
    const stance_feed feed = {&job, next_case, case_done, attend};
    while (find_method(&job) && await_kernels(&job)) {
        for (struct block *block = job.oldest; block; block = block->next)
            block->cursor = 0;
        job.at = job.oldest;
        job.kernel[job.method]->stream(&feed); /* the plan saw to it that there is a kernel */
    }
    deadline_rescue(NULL, NULL);
    write_open(&job);
    if (job.leaving)
        deadline_begin();
    report(&job);
    work->seconds += clock_seconds() - start - job.elsewhere;
    meet(&job);
    progress_end(&work->progress);
    job_free(&job);
    return !job.broken && !job.lost;
}
