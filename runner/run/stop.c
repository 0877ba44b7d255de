/* stop.c - signals that ask for a stop, see work.h. */
#include "work.h"

#include "runner/ranks/deadline.h"

#include <signal.h>

static volatile sig_atomic_t stop_asked;

static void ask_stop(int number)
{
    (void)number;
    stop_asked = 1;
    deadline_begin();
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
