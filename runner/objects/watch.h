/* watch.h - what goes on while a compiler is at work: whoever started it may want to stop, and
 * wants to know that something goes on.
 */
#ifndef STANCE_OBJECTS_WATCH_H
#define STANCE_OBJECTS_WATCH_H

#include "runner/base/progress.h"

struct watch {
    bool (*stop)(void *context); /* NULL: signals alone stop */
    void *context;
    const char *doing; /* what is being compiled, for the progress */
    struct progress progress;
    bool stopped;
};

/* Begins: signals that would end this process now stop the work first, as nobody else would end
 * the compiler. */
void watch_begin(struct watch *watch);
/* Waits for some milliseconds. Whether to stop; from then on always. */
bool watch_wait(struct watch *watch);
/* Ends: a signal that has come in between does what it would have done. */
void watch_end(struct watch *watch);

#endif
