/* parallel.h - the ranks of a job and what they tell each other.
 *
 * parallel.c is the one file that includes mpi.h. Built without STANCE_MPI, or before
 * parallel_start, there is one rank and everything here is trivial. A failure of MPI itself ends
 * the job (MPI's default handler): no rank could tell the others.
 */
#ifndef STANCE_RANKS_PARALLEL_H
#define STANCE_RANKS_PARALLEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Numbers that all ranks share while cases are computed; they live on rank 0. */
enum parallel_counter {
    COUNTER_CHUNK,
    COUNTER_STOP,
    COUNTER_DONE,
    COUNTER_KEPT,
    COUNTER_KERNELS,
    COUNTERS
};

struct parallel {
    int rank, size;
    bool shared; /* the counters are in use */
};

/* One rank, without starting MPI. */
struct parallel parallel_alone(void);
/* Starts MPI, once in a process, when a launcher (mpirun, srun) started it; else one rank. */
struct parallel parallel_start(void);
/* Whether this process is the first or only one of its launcher, before MPI starts. */
bool parallel_is_first(void);
/* Programs that this one starts from now on are no ranks of its launcher. */
void parallel_leave_launcher(void);
/* Whether srun started this process as one of several (*first: the first of them) without the MPI
 * that would make them ranks. */
bool parallel_misses_launcher(bool *first);
/* Ends MPI; every rank must come here. */
void parallel_finish(struct parallel *parallel);

/* Collective: `size` bytes of rank 0 reach every rank. */
void parallel_broadcast(const struct parallel *parallel, void *data, size_t size);
/* Collective: `size` bytes of each rank, in order of rank, in memory of ranks * size on rank 0, to
 * be freed; NULL elsewhere. */
void *parallel_gather(const struct parallel *parallel, const void *data, size_t size);
/* Collective: the caller's block [first, first + count) of an array of `element` bytes reaches
 * rank 0's array; the blocks of all ranks must tile it in order of rank. */
void parallel_gather_block(const struct parallel *parallel, void *array, size_t element,
                           size_t first, size_t count);
/* Collective: sums each of n numbers over the ranks, in place, on every rank. */
void parallel_sum(const struct parallel *parallel, uint64_t *number, int n);
/* Collective: the largest of each of n bytes over the ranks, in place, on every rank. */
void parallel_largest(const struct parallel *parallel, uint8_t *byte, size_t n);
/* Collective: true when every rank says true. Else `text` (of `size` bytes, the same on every
 * rank) becomes that of the lowest rank that said false. */
bool parallel_agree(const struct parallel *parallel, bool good, char *text, size_t size);

/* Collective: begin and end the use of the counters, all zero at first; one use at a time. */
void parallel_share(struct parallel *parallel);
void parallel_unshare(struct parallel *parallel);
/* Not collective: adds to a counter and returns what it held before; adding 0 reads it. */
int64_t parallel_add(const struct parallel *parallel, enum parallel_counter which, int64_t value);
/* Collective: all counters but COUNTER_STOP are zero again. */
void parallel_restart(const struct parallel *parallel);

/* Beside the counters each rank has a number that tells rank 0 that it lives. Not collective: sets
 * it. And on rank 0 alone: reads those of all ranks, number[size]. */
void parallel_beat(const struct parallel *parallel, int64_t number);
void parallel_beats(const struct parallel *parallel, int64_t *number);
/* Collective: waits until every rank has come here; meanwhile calls wait(context) every millisecond
 * or so. */
void parallel_meet(const struct parallel *parallel, void (*wait)(void *context), void *context);

/* Collective: do all ranks share a host? */
bool parallel_on_one_host(const struct parallel *parallel);
/* Name of this machine. */
void parallel_host(char *name, size_t size);
/* Name and version of the MPI library, or "no MPI". */
void parallel_library(char *text, size_t size);

#endif
