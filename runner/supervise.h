/* supervise.h - runs the reading of files that may be damaged where it can do no harm.
 *
 * HDF5 1.10 reports most damage, but some damaged headers and string heaps make it run past its
 * own buffers or in circles. A user's command is to end with a message even then. */
#ifndef STANCE_RUNNER_SUPERVISE_H
#define STANCE_RUNNER_SUPERVISE_H

#include <stdbool.h>

/* Runs work(context), which returns an exit code, in a child process, and returns that code. A
 * child that crashes gives exit code EXIT_IO and the one line "FILES: damaged: ..."; `files` names
 * what it reads. What it writes to standard error comes out when it ends. */
int supervise(int (*work)(void *context), void *context, const char *files);

/* Begins and ends a part that takes a few seconds of computing at the most; a supervised process
 * that takes far more is ended as if it had crashed. */
void supervise_limit(bool begin);

#endif
