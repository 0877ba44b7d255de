/* deadline.c - see deadline.h. */
#include "deadline.h"
#include "parallel.h"

#include "runner/base/command.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double longest = 1e9; /* s, what alarm() takes on any system */
static volatile sig_atomic_t prepared;
static char last_words[240];

static void ring(int number)
{
    (void)number;
    if (write(STDERR_FILENO, last_words, strlen(last_words)) < 0) {
        /* Nobody hears it. */
    }
    _exit(EXIT_INTERRUPTED);
}

void deadline_prepare(int rank)
{
    struct sigaction action = {.sa_handler = ring};
    char host[100];
    parallel_host(host, sizeof host);
    snprintf(last_words, sizeof last_words,
             "stance run: rank %d on %s: told to stop, and in %d s not every rank has come: left; "
             "what is marked done is whole, --resume goes on\n",
             rank, host, (int)DEADLINE_PATIENCE);
    sigemptyset(&action.sa_mask);
    prepared = sigaction(SIGALRM, &action, NULL) == 0;
}

void deadline_begin(void)
{
    if (prepared)
        alarm(DEADLINE_PATIENCE);
}

void deadline_limit(double seconds)
{
    if (prepared && seconds < longest)
        alarm((unsigned)(seconds > 0 ? seconds : 0) + 1 + DEADLINE_PATIENCE);
}
