/* heartbeat.h - signs of life of a running job, and whether its file is still its own.
 *
 * Every rank sets a number on rank 0 whenever it looks at the shared counters (parallel_beat); rank
 * 0 sees from them who lives, and every HEARTBEAT_INTERVAL seconds writes a note into the lock
 * file, one line of JSON: `stance status` reads it, on any machine that sees the file. That is a
 * message of eight bytes a rank and look, and one small write for the whole job. At the same times
 * rank 0 looks whether the results file still has its name: what is written into a file that was
 * removed or moved away is lost or not where it is sought.
 */
#ifndef STANCE_RUN_HEARTBEAT_H
#define STANCE_RUN_HEARTBEAT_H

#include "runner/base/units.h"
#include "runner/ranks/parallel.h"
#include "runner/store/lock.h"

#include <sys/types.h>

#define HEARTBEAT_INTERVAL 2.0 /* s */
#define HEARTBEAT_SILENCE                                                                          \
    30.0 /* s without a beat after which a rank is no longer counted as alive */

/* What a rank that waits for the others beats. */
enum { HEARTBEAT_WAITS = -1 };

enum { HEARTBEAT_SAMPLES = 32 };

struct heartbeat {
    struct lock *lock;
    const struct parallel *parallel;
    const char *doing; /* the job, in a word or two */
    double start;      /* s since 1970 */
    double due;        /* when to write next, of clock_seconds() */
    double left;       /* s until the end, where the job knows better than by its rate; negative */
    char file[1024];   /* "": not there yet */
    dev_t device;      /* of that file */
    ino_t inode;
    int64_t *beat;   /* [ranks] as last seen */
    double *beat_at; /* [ranks] when it last changed */
    double counted;  /* when that was last looked at */
    int alive;
    /* Cases computed, at the latest times. */
    struct heartbeat_sample {
        double at;
        uint64_t computed;
    } sample[HEARTBEAT_SAMPLES];
    unsigned samples;
};

/* On rank 0, with the lock taken; the first note is written. false: no memory. */
bool heartbeat_begin(struct heartbeat *heartbeat, struct lock *lock,
                     const struct parallel *parallel, const char *doing);
void heartbeat_end(struct heartbeat *heartbeat);
/* From now on the file must keep its name. */
void heartbeat_guard(struct heartbeat *heartbeat, const char *file);
/* Writes a note when it is time to (`now`: clock_seconds()). computed: cases, by this job; round of
 * a refined map, 0: none. false: the file is gone, or another process writes it. */
bool heartbeat_beat(struct heartbeat *heartbeat, double now, uint64_t computed, int round,
                    stance_message *message);

/* The first rank that has neither beaten nor waited for DEADLINE_LOST; 0: none, or no heartbeat. */
int heartbeat_lost(const struct heartbeat *heartbeat, double now);

/* ---- the other side ----------------------------------------------------------------------- */

struct heartbeat_note {
    bool running;  /* somebody is writing the file, as far as can be seen from here */
    bool here;     /* ... on this machine */
    bool exists;   /* a note was found: the rest is known */
    char host[80]; /* of rank 0 */
    char doing[40];
    double age;        /* s since the last sign of life */
    double spent;      /* s from the job's start to that */
    double rate;       /* computed cases per second of late; negative: not known yet */
    double left;       /* s from now on, as the job reckons; negative: it does not */
    uint64_t computed; /* cases, by this job */
    int ranks, alive, round;
};

/* What is known of the job that writes FILE, or wrote it last. */
void heartbeat_read(const char *file, struct heartbeat_note *note);

#endif
