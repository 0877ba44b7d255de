/* deadline.c - see deadline.h. */
#include "deadline.h"
#include "parallel.h"

#include "runner/base/command.h"

#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

enum {
    RESCUE = 10, /* s, that a rescue may take */
    PAUSE = 5,   /* s between ticks: the process did not run in between */
};

static const double longest = 1e9;               /* s: what is later is never */
static volatile int64_t due = INT64_MAX, ticked; /* s of the monotonic clock */
static volatile sig_atomic_t waiting; /* 0, or ticks of this wait from 1: a job may be suspended */
static void (*volatile rescue)(void *context);
static void *volatile rescue_context;
static volatile sig_atomic_t rescued;
static bool prepared;
static char told[300], lost[300];

/* A look each second, or none any more. */
static bool look(void (*handler)(int number), int flags)
{
    const bool on = handler != SIG_DFL;
    const struct itimerval each = {{on, 0}, {on, 0}};
    struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART | flags};
    sigemptyset(&action.sa_mask);
    return (on || setitimer(ITIMER_REAL, &each, NULL) == 0) &&
           sigaction(SIGALRM, &action, NULL) == 0 &&
           (!on || setitimer(ITIMER_REAL, &each, NULL) == 0);
}

static pid_t launcher;
static volatile sig_atomic_t looked;

static void look_for_launcher(int number)
{
    static const char late[] =
        "stance: MPI has not started on all ranks: left; nothing was begun\n";
    (void)number;
    if (getppid() != launcher)
        _exit(EXIT_FAILURE); /* nothing has been begun, and nobody waits for the code */
    if (++looked > DEADLINE_START)
        _exit(write(STDERR_FILENO, late, sizeof late - 1) < 0 ? EXIT_FAILURE : EXIT_INTERRUPTED);
}

void deadline_launch(bool begin)
{
    launcher = getppid();
    look(begin ? look_for_launcher : SIG_DFL, 0);
}

static int64_t now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec;
}

static void tick(int number)
{
    const int64_t t = now();
    if (t - ticked > PAUSE && due < INT64_MAX)
        due += t - ticked; /* a job that was suspended goes on where it was */
    ticked = t;
    const bool late = t >= due, waits = waiting > DEADLINE_LOST;
    waiting += waiting > 0 && !waits;
    (void)number;
    if (!late && (!waits || rescued))
        return;
    void (*const last)(void *) = waiting ? rescue : NULL;
    if (last) { /* once: should it get stuck, the next tick after its time ends the process */
        rescue = NULL;
        rescued = 1;
        due = t + RESCUE;
        last(rescue_context);
    }
    const char *const words = waits ? lost : told;
    if (write(STDERR_FILENO, words, strlen(words)) < 0) {
        /* Nobody hears it. */
    }
    _exit(EXIT_INTERRUPTED);
}

void deadline_prepare(int rank)
{
    char host[100];
    parallel_host(host, sizeof host);
    snprintf(told, sizeof told,
             "stance run: rank %d on %s: told to stop, and in %d s not every rank has come: left; "
             "what its file, if there is one, marks as done is whole: --resume goes on\n",
             rank, host, (int)DEADLINE_PATIENCE);
    snprintf(
        lost, sizeof lost,
        "stance run: rank %d on %s: rank 0 has not answered for %d s: left; what is marked done "
        "is whole, --resume goes on\n",
        rank, host, (int)DEADLINE_LOST);
    ticked = now();
    prepared = look(tick, SA_NODEFER);
}

void deadline_begin(void)
{
    if (prepared)
        due = now() + DEADLINE_PATIENCE;
}

void deadline_limit(double seconds)
{
    if (prepared && seconds < longest)
        due = now() + (int64_t)(seconds > 0 ? seconds : 0) + 1 + DEADLINE_PATIENCE;
}

void deadline_waits(void)
{
    waiting = 1;
}

void deadline_comes(void)
{
    waiting = 0;
}

void deadline_rescue(void (*last)(void *context), void *context)
{
    rescue = NULL;
    rescue_context = context;
    rescue = last;
}
