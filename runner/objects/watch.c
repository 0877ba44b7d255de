/* watch.c - see watch.h. */
#include "watch.h"

#include "runner/base/units.h"

#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <time.h>

static const struct timespec pause_between = {.tv_nsec = 20000000};
static const int ends[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM};
enum { ENDS = sizeof ends / sizeof ends[0] };

static struct sigaction before[ENDS];
static volatile sig_atomic_t came;

static void note(int number)
{
    came = number;
}

/* A handler that somebody else has set tells `stop`; without that all are held back. */
void watch_begin(struct watch *watch)
{
    const struct sigaction action = {.sa_handler = note};
    came = 0;
    for (int k = 0; k < ENDS; k++) {
        sigaction(ends[k], NULL, &before[k]);
        if (before[k].sa_handler == SIG_DFL || (!watch->stop && before[k].sa_handler != SIG_IGN))
            sigaction(ends[k], &action, NULL);
    }
}

bool watch_wait(struct watch *watch)
{
    nanosleep(&pause_between, NULL);
    const double now = clock_seconds();
    if (progress_due(&watch->progress, now))
        progress_say(&watch->progress, "%s, %.0f s", watch->doing,
                     floor(now - watch->progress.from));
    watch->stopped = watch->stopped || came != 0 || (watch->stop && watch->stop(watch->context));
    return watch->stopped;
}

void watch_end(struct watch *watch)
{
    progress_end(&watch->progress);
    for (int k = 0; k < ENDS; k++)
        sigaction(ends[k], &before[k], NULL);
    if (came)
        raise(came);
}
