/* pulse.c - see pulse.h. */
#include "pulse.h"

#include "plan.h"

#include <jansson.h>
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
static double recent_rate(const struct pulse *pulse)
{
    if (pulse->samples < 2) {
        return -1;
    }
    const struct pulse_sample *last = &pulse->sample[(pulse->samples - 1) % PULSE_SAMPLES];
    const struct pulse_sample *first = last;
    const unsigned there = pulse->samples < PULSE_SAMPLES ? pulse->samples : PULSE_SAMPLES;
    for (unsigned k = 1; k < there; k++) {
        const struct pulse_sample *sample =
            &pulse->sample[(pulse->samples - 1 - k) % PULSE_SAMPLES];
        if (last->at - sample->at > rate_window) {
            break;
        }
        first = sample;
    }
    return last->at > first->at
               ? (double)(last->computed - first->computed) / (last->at - first->at)
               : -1;
}

/* Ranks that beat not long ago, or wait for others. */
static int count_alive(struct pulse *pulse, double now)
{
    const int ranks = pulse->parallel->size;
    int64_t *number = malloc((size_t)ranks * sizeof *number);
    int alive = 0;
    if (!number || !pulse->parallel->shared) {
        free(number);
        return ranks;
    }
    parallel_beats(pulse->parallel, number);
    for (int rank = 0; rank < ranks; rank++) {
        if (number[rank] != pulse->beat[rank] || number[rank] == PULSE_WAITS || rank == 0) {
            pulse->beat_at[rank] = now;
        }
        pulse->beat[rank] = number[rank];
        alive += now - pulse->beat_at[rank] < PULSE_SILENCE;
    }
    free(number);
    return alive;
}

static void write_note(const struct pulse *pulse, uint64_t computed, int round)
{
    char host[80];
    const double now = wall_clock();
    parallel_host(host, sizeof host);
    json_t *note = json_pack("{s:s, s:i, s:s, s:f, s:f, s:i, s:i, s:i, s:I, s:I, s:f}", "host",
                             host, "pid", (int)getpid(), "doing", pulse->doing, "start",
                             pulse->start, "time", now, "ranks", pulse->parallel->size, "alive",
                             pulse->alive, "round", round, "kept", (json_int_t)pulse->kept,
                             "computed", (json_int_t)computed, "rate", recent_rate(pulse));
    char *text = note ? json_dumps(note, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
    if (text) {
        lock_write_note(pulse->lock, text);
    }
    free(text);
    json_decref(note);
}

bool pulse_begin(struct pulse *pulse, struct lock *lock, const struct parallel *parallel,
                 const char *doing)
{
    const size_t ranks = (size_t)parallel->size;
    const double now = plan_clock();
    *pulse = (struct pulse){.lock = lock, .parallel = parallel, .doing = doing};
    pulse->start = wall_clock();
    pulse->alive = parallel->size;
    pulse->beat = calloc(ranks, sizeof *pulse->beat);
    pulse->beat_at = malloc(ranks * sizeof *pulse->beat_at);
    if (!pulse->beat || !pulse->beat_at) {
        return false;
    }
    for (size_t rank = 0; rank < ranks; rank++) {
        pulse->beat_at[rank] = now;
    }
    pulse->due = now + PULSE_INTERVAL;
    write_note(pulse, 0, 0);
    return true;
}

void pulse_end(struct pulse *pulse)
{
    free(pulse->beat);
    free(pulse->beat_at);
    *pulse = (struct pulse){0};
}

void pulse_guard(struct pulse *pulse, const char *file)
{
    struct stat information;
    if (stat(file, &information) == 0) {
        pulse->device = information.st_dev;
        pulse->inode = information.st_ino;
        snprintf(pulse->file, sizeof pulse->file, "%s", file);
    }
}

static bool has_file(const struct pulse *pulse, stance_message *message)
{
    struct stat information;
    if (!pulse->file[0] ||
        (stat(pulse->file, &information) == 0 && information.st_dev == pulse->device &&
         information.st_ino == pulse->inode)) {
        return true;
    }
    snprintf(message->text, sizeof message->text,
             "%.150s: was removed, moved or replaced while it was written", pulse->file);
    return false;
}

bool pulse_beat(struct pulse *pulse, double now, uint64_t finished, uint64_t computed, int round,
                stance_message *message)
{
    if (now < pulse->due) {
        return true;
    }
    pulse->due = now + PULSE_INTERVAL;
    if (!has_file(pulse, message) || !lock_keep(pulse->lock, message)) {
        return false;
    }
    pulse->kept = finished - computed;
    pulse->sample[pulse->samples++ % PULSE_SAMPLES] = (struct pulse_sample){now, computed};
    pulse->alive = count_alive(pulse, now);
    write_note(pulse, computed, round);
    return true;
}

/* ---- the other side ----------------------------------------------------------------------- */

/* Somebody else's words, fit to be printed. */
static void copy_word(char *to, size_t size, const char *from)
{
    snprintf(to, size, "%s", from);
    for (; *to; to++) {
        if ((unsigned char)*to < ' ' || (unsigned char)*to >= 0x7f) {
            *to = '?';
        }
    }
}

static void take_note(struct pulse_note *note, const char *text)
{
    const char *host, *doing;
    double start, time;
    json_int_t kept, computed;
    json_t *root = json_loads(text, JSON_DISABLE_EOF_CHECK, NULL);
    note->exists =
        root && json_unpack(root, "{s:s, s:s, s:F, s:F, s:i, s:i, s:i, s:I, s:I, s:F}", "host",
                            &host, "doing", &doing, "start", &start, "time", &time, "ranks",
                            &note->ranks, "alive", &note->alive, "round", &note->round, "kept",
                            &kept, "computed", &computed, "rate", &note->rate) == 0;
    if (note->exists) {
        copy_word(note->host, sizeof note->host, host);
        copy_word(note->doing, sizeof note->doing, doing);
        note->age = wall_clock() - time;
        note->age = note->age > 0 ? note->age : 0;
        note->spent = time - start;
        note->kept = (uint64_t)kept;
        note->computed = (uint64_t)computed;
    }
    json_decref(root);
}

void pulse_read(const char *file, struct pulse_note *note)
{
    char text[LOCK_NOTE], host[80];
    *note = (struct pulse_note){.rate = -1};
    note->running = note->here = lock_is_held(file, text);
    take_note(note, text);
    parallel_host(host, sizeof host);
    /* The lock of another machine need not be seen here; a note that is renewed is. */
    if (!note->running && note->exists && strcmp(note->host, host) != 0) {
        note->running = note->age < PULSE_SILENCE;
    }
}
