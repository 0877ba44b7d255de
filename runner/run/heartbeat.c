/* heartbeat.c - see heartbeat.h. */
#include "heartbeat.h"

#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/plan/plan.h"
#include "runner/ranks/crash.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* A rate is of the time since the oldest sample that is younger than this. */
static const double rate_window = 60;

static double wall_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- the job's side ----------------------------------------------------------------------- */

/* Cases per second of late; negative: there is nothing to go by yet. */
static double recent_rate(const struct heartbeat *heartbeat)
{
    const unsigned n = heartbeat->samples, there = n < HEARTBEAT_SAMPLES ? n : HEARTBEAT_SAMPLES;
    const struct heartbeat_sample *const sample = heartbeat->sample,
                                         *const last = &sample[(n - 1) % HEARTBEAT_SAMPLES],
                                         *first = last;
    for (unsigned k = 2;
         k <= there && last->at - sample[(n - k) % HEARTBEAT_SAMPLES].at <= rate_window; k++)
        first = &sample[(n - k) % HEARTBEAT_SAMPLES];
    return n > 1 && last->at > first->at
               ? (double)(last->computed - first->computed) / (last->at - first->at)
               : -1;
}

/* Ranks that beat not long ago, or wait for others. */
static int count_alive(struct heartbeat *heartbeat, double now)
{
    const int ranks = heartbeat->parallel->size;
    int64_t *number = malloc((size_t)ranks * sizeof *number);
    int alive = 0;
    if (!number || !heartbeat->parallel->shared) {
        free(number);
        return ranks;
    }
    parallel_beats(heartbeat->parallel, number);
    const bool away = now - heartbeat->counted > HEARTBEAT_SILENCE; /* it was this rank then */
    heartbeat->counted = now;
    for (int rank = 0; rank < ranks; rank++) {
        if (number[rank] != heartbeat->beat[rank] || number[rank] == HEARTBEAT_WAITS || away ||
            rank == 0)
            heartbeat->beat_at[rank] = now;
        heartbeat->beat[rank] = number[rank];
        alive += now - heartbeat->beat_at[rank] < HEARTBEAT_SILENCE;
    }
    free(number);
    return alive;
}

int heartbeat_lost(const struct heartbeat *heartbeat, double now)
{
    for (int rank = 1; heartbeat && rank < heartbeat->parallel->size; rank++)
        if (now - heartbeat->beat_at[rank] >= DEADLINE_LOST)
            return rank;
    return 0;
}

static void write_note(const struct heartbeat *heartbeat, uint64_t computed, int round)
{
    char host[80];
    const double now = wall_clock();
    parallel_host(host, sizeof host);
    json_t *note = json_pack(
        "{s:s, s:i, s:s, s:f, s:f, s:i, s:i, s:i, s:I, s:f, s:f}", "host", host, "pid",
        (int)getpid(), "doing", heartbeat->doing, "start", heartbeat->start, "time", now, "ranks",
        heartbeat->parallel->size, "alive", heartbeat->alive, "round", round, "computed",
        (json_int_t)computed, "rate", recent_rate(heartbeat), "left", heartbeat->left);
    char *text = note ? json_dumps(note, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
    if (text)
        lock_write_note(heartbeat->lock, text);
    free(text);
    json_decref(note);
}

bool heartbeat_begin(struct heartbeat *heartbeat, struct lock *lock,
                     const struct parallel *parallel, const char *doing)
{
    const size_t ranks = (size_t)parallel->size;
    const double now = clock_seconds();
    *heartbeat = (struct heartbeat){.lock = lock, .parallel = parallel, .doing = doing, .left = -1};
    heartbeat->start = wall_clock();
    heartbeat->alive = parallel->size;
    heartbeat->beat = calloc(ranks, sizeof *heartbeat->beat);
    heartbeat->beat_at = malloc(ranks * sizeof *heartbeat->beat_at);
    if (!heartbeat->beat || !heartbeat->beat_at)
        return false;
    for (size_t rank = 0; rank < ranks; rank++)
        heartbeat->beat_at[rank] = now;
    heartbeat->counted = now;
    heartbeat->due = now + HEARTBEAT_INTERVAL;
    write_note(heartbeat, 0, 0);
    return true;
}

void heartbeat_end(struct heartbeat *heartbeat)
{
    free(heartbeat->beat);
    free(heartbeat->beat_at);
    *heartbeat = (struct heartbeat){0};
}

void heartbeat_guard(struct heartbeat *heartbeat, const char *file)
{
    struct stat information;
    if (stat(file, &information) == 0) {
        heartbeat->device = information.st_dev;
        heartbeat->inode = information.st_ino;
        snprintf(heartbeat->file, sizeof heartbeat->file, "%s", file);
    }
}

bool heartbeat_beat(struct heartbeat *heartbeat, double now, uint64_t computed, int round,
                    stance_message *message)
{
    if (now < heartbeat->due)
        return true;
    struct stat found;
    heartbeat->due = now + HEARTBEAT_INTERVAL;
    if (heartbeat->file[0] &&
        (stat(heartbeat->file, &found) != 0 || found.st_dev != heartbeat->device ||
         found.st_ino != heartbeat->inode))
        return complain(message, "%.150s: was removed, moved or replaced while it was written",
                        heartbeat->file);
    if (!lock_keep(heartbeat->lock, message))
        return false;
    heartbeat->sample[heartbeat->samples++ % HEARTBEAT_SAMPLES] =
        (struct heartbeat_sample){now, computed};
    heartbeat->alive = count_alive(heartbeat, now);
    write_note(heartbeat, computed, round);
    return true;
}

/* ---- the other side ----------------------------------------------------------------------- */

/* Somebody else's words, fit to be printed. */
static void copy_word(char *to, size_t size, const char *from)
{
    snprintf(to, size, "%s", from);
    for (; *to; to++)
        if ((unsigned char)*to < ' ' || (unsigned char)*to >= 0x7f)
            *to = '?';
}

static void take_note(struct heartbeat_note *note, const char *text)
{
    const char *host, *doing;
    double start, time;
    json_int_t computed;
    json_t *root = json_loads(text, JSON_DISABLE_EOF_CHECK, NULL);
    note->exists =
        root && json_unpack(root, "{s:s, s:s, s:F, s:F, s:i, s:i, s:i, s:I, s:F, s?F}", "host",
                            &host, "doing", &doing, "start", &start, "time", &time, "ranks",
                            &note->ranks, "alive", &note->alive, "round", &note->round, "computed",
                            &computed, "rate", &note->rate, "left", &note->left) == 0;
    if (note->exists) {
        copy_word(note->host, sizeof note->host, host);
        copy_word(note->doing, sizeof note->doing, doing);
        note->age = wall_clock() - time;
        note->age = note->age > 0 ? note->age : 0;
        note->spent = time - start;
        note->left = note->left >= 0 ? fmax(0, note->left - note->age) : -1;
        note->computed = (uint64_t)computed;
    }
    json_decref(root);
}

void heartbeat_read(const char *file, struct heartbeat_note *note)
{
    char text[LOCK_NOTE], host[80];
    *note = (struct heartbeat_note){.rate = -1, .left = -1};
    note->running = note->here = lock_is_held(file, text);
    take_note(note, text);
    parallel_host(host, sizeof host);
    /* The lock of another machine need not be seen here; a note that is renewed is. */
    if (!note->running && note->exists && strcmp(note->host, host) != 0)
        note->running = note->age < HEARTBEAT_SILENCE;
}
