/* sandbox.h - runs the reading of files that may be damaged where it can do no harm.
 *
 * HDF5 1.10 reports most damage, but some damaged headers and string heaps make it run past its
 * own buffers or in circles; libmujoco ends the process. A user's command is to end with a message
 * even then. */
#ifndef STANCE_BASE_SANDBOX_H
#define STANCE_BASE_SANDBOX_H

#include <stdbool.h>
#include <string.h>

/* Runs work(context), which returns an exit code, in a child process, and returns that code. A
 * child that crashes gives exit code EXIT_IO and the one line "FILES: damaged: ..."; `files` names
 * what it reads. What it writes to standard error comes out when it ends, line by line where
 * sandbox_own_line; until then seconds are counted there, or the child tells of its work
 * (progress.h). */
int sandbox(int (*work)(void *context), void *context, const char *files);

/* Begins and ends a part that takes a few seconds of computing at the most; a supervised process
 * that takes far more is ended as if it had crashed. */
void sandbox_limit(bool begin);

/* Whether a line is this program's: HDF5 prints some remarks by itself ("H5HF_op: Heap ID type not
 * supported yet!"), and the error that follows them is enough. */
static inline bool sandbox_own_line(const char *line)
{
    return strncmp(line, "H5", 2) != 0;
}

#endif
