/* progress.h - what somebody who waits is told: on a terminal a line that is written over, twice a
 * second; elsewhere a line a minute.
 */
#ifndef STANCE_BASE_PROGRESS_H
#define STANCE_BASE_PROGRESS_H

#include <stdbool.h>

struct progress {
    bool quiet;  /* nothing is said */
    bool shown;  /* there is a line that is to be written over */
    double due;  /* of clock_seconds(): when to say something next */
    double from; /* when it began */
};

/* From now on. */
struct progress progress_begin(bool quiet);
/* Whether something is to be said now. */
bool progress_due(const struct progress *progress, double now);
/* Says it: one line without its end. In a sandbox the process that waits for it says it. */
void progress_say(struct progress *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* What is printed next stands in its place. */
void progress_end(struct progress *progress);

/* What is left of so much work, of which `done` of 1 took until now: "about 3 min left"; nothing
 * while too little is known. */
enum { PROGRESS_LEFT = 48 };
const char *progress_left(const struct progress *progress, double done, char text[PROGRESS_LEFT]);

/* From now on what is said goes into text[size], which another process reads. */
void progress_redirect(char *text, unsigned size);

#endif
