/* claim.h - what commands that write a results file on many ranks have in common before they
 * compute: durations, the scenario on every rank, the file for this job alone.
 */
#ifndef STANCE_RUN_CLAIM_H
#define STANCE_RUN_CLAIM_H

#include "runner/base/command.h"
#include "runner/ranks/parallel.h"
#include "runner/scenario/scenario.h"
#include "runner/store/lock.h"

/* The ranks of the job, which from now on attend to signals and say where they crash. false: a
 * launcher started several processes that are no ranks of each other; the first one has said so. */
bool claim_ranks(const char *who, struct parallel *parallel);

/* Collective: command_begin() on rank 0 first, which says what is wrong; the others need not. */
int claim_options(const struct parallel *parallel, const struct command *command, int argc,
                  char **argv, void *options);

/* Collective: rank 0's scenario, which it has read (`read`), is read from its text by the others.
 * false: it has not, or (*message is not empty) this rank cannot. What was read is freed then. */
bool claim_scenario(const struct parallel *parallel, struct scenario *s, const char *file,
                    bool read, stance_message *message);

/* Rank 0: the file may be written and nobody else writes it: the lock is taken. `force` replaces
 * one that exists, `resume` goes on with it; `own`: the file's directory is `results`, which is
 * made. false: *message says why. */
bool claim_file(const char *file, bool force, bool resume, bool own, struct lock *lock,
                bool *exists, stance_message *message);

/* Rank 0, on standard error: that the command stopped, and the one that goes on with it. `again`:
 * the option for that. argv[0] is the command's name. */
void claim_say_stopped(const struct parallel *parallel, int argc, char **argv, const char *again,
                       const char *what);

#endif
