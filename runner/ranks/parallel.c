/* parallel.c - the one file that talks to MPI; without STANCE_MPI it does for one rank.
 *
 * A single rank never needs MPI, so that `stance run` alone works where MPI cannot start: MPI is
 * initialised only when a launcher started this process.
 */
#include "parallel.h"

#include "crash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#ifdef STANCE_MPI
#include <mpi.h>
#else
#include "no_mpi.h"
#endif

/* [COUNTERS], then [ranks] numbers of theirs; of several ranks in a window, on rank 0, else none.
 */
static int64_t alone[COUNTERS + 1], *counter = alone;
static MPI_Win window;

struct parallel parallel_alone(void)
{
    return (struct parallel){.rank = 0, .size = 1};
}

void parallel_host(char *name, size_t size)
{
    if (gethostname(name, size) != 0)
        snprintf(name, size, "unknown");
    name[size - 1] = '\0';
}

/* ---- MPI ---------------------------------------------------------------------------------- */

/* MPI counts in int: longer messages go in pieces. */
enum { PIECE = 1 << 28 };

/* Launchers tell a process its rank in one of these. */
static const char *const rank_told[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
enum { RANK_TOLD = sizeof rank_told / sizeof rank_told[0] };

static bool is_one(const char *name)
{
    const char *number = getenv(name);
    return number && strcmp(number, "1") == 0;
}

/* srun tells the one task of a step its rank, too, and need not know this MPI. */
static bool is_only_rank(void)
{
    return is_one("PMI_SIZE") || (is_one("SLURM_STEP_NUM_TASKS") && !getenv("PMI_SIZE") &&
                                  !getenv("OMPI_COMM_WORLD_SIZE"));
}

static bool was_launched(void)
{
    bool told = false;
#ifdef STANCE_MPI
    for (size_t i = 0; i < RANK_TOLD; i++)
        told = told || getenv(rank_told[i]);
#endif
    return told && !is_only_rank();
}

bool parallel_is_first(void)
{
    bool first = true;
    for (size_t i = 0; was_launched() && i < RANK_TOLD; i++) {
        const char *rank = getenv(rank_told[i]);
        first = first && (!rank || strcmp(rank, "0") == 0);
    }
    return first;
}

void parallel_leave_launcher(void)
{
    for (size_t i = 0; i < RANK_TOLD; i++)
        unsetenv(rank_told[i]);
}

/* Within one machine shared memory is all that Open MPI needs; its search for networks takes a
 * fifth of a second. What the user has set stands.
 * Windows between machines are made of messages in Open MPI 4: they work over every network, and
 * what goes through them is little. Its window for remote memory fails over TCP, and Debian's
 * configuration leaves no other. Within one machine windows are shared memory. */
static void choose_networks(void)
{
    const char *all = getenv("OMPI_COMM_WORLD_SIZE"), *here = getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
    if (all && here && strcmp(all, here) == 0)
        setenv("OMPI_MCA_pml", "ob1", 0);
#if defined(OMPI_MAJOR_VERSION) && OMPI_MAJOR_VERSION < 5
    setenv("OMPI_MCA_osc", "sm,pt2pt", 0);
#endif
}

bool parallel_misses_launcher(bool *first)
{
    const char *tasks = getenv("SLURM_STEP_NUM_TASKS"), *task = getenv("SLURM_PROCID");
    *first = !task || strcmp(task, "0") == 0;
#ifdef STANCE_MPI
    return tasks && atoi(tasks) > 1 && !was_launched();
#else
    return (void)tasks, false; /* each is a run of its own */
#endif
}

struct parallel parallel_start(void)
{
    struct parallel parallel = parallel_alone();
    if (was_launched()) {
        choose_networks();
        deadline_launch(true);
        int provided; /* MPI is called by one thread; another compiles */
        MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided);
        deadline_launch(false);
        MPI_Comm_rank(MPI_COMM_WORLD, &parallel.rank);
        MPI_Comm_size(MPI_COMM_WORLD, &parallel.size);
    }
    return parallel;
}

void parallel_finish(struct parallel *parallel)
{
    int started = 0;
    parallel_unshare(parallel);
    MPI_Initialized(&started);
    if (started)
        MPI_Finalize();
}

static int piece_of(size_t left)
{
    return left < PIECE ? (int)left : PIECE;
}

void parallel_broadcast(const struct parallel *parallel, void *data, size_t size)
{
    char *bytes = data;
    for (size_t at = 0; parallel->size > 1 && at < size; at += PIECE)
        MPI_Bcast(bytes + at, piece_of(size - at), MPI_BYTE, 0, MPI_COMM_WORLD);
}

void *parallel_gather(const struct parallel *parallel, const void *data, size_t size)
{
    void *const all = parallel->rank == 0 ? malloc((size_t)parallel->size * size) : NULL;
    if (parallel->rank == 0 && !all)
        abort(); /* the others wait in the gather: MPI ends the job */
    if (parallel->size > 1)
        MPI_Gather(data, (int)size, MPI_BYTE, all, (int)size, MPI_BYTE, 0, MPI_COMM_WORLD);
    else if (all)
        memcpy(all, data, size);
    return all;
}

void parallel_gather_block(const struct parallel *parallel, void *array, size_t element,
                           size_t first, size_t count)
{
    char *bytes = array;
    for (int rank = 1; rank < parallel->size; rank++) {
        uint64_t block[2] = {first * element, count * element};
        if (parallel->rank == rank)
            MPI_Send(block, 2, MPI_UINT64_T, 0, 0, MPI_COMM_WORLD);
        else if (parallel->rank == 0)
            MPI_Recv(block, 2, MPI_UINT64_T, rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        else
            continue;
        for (uint64_t at = 0; at < block[1]; at += PIECE) {
            char *piece = bytes + block[0] + at;
            if (parallel->rank == rank) {
                MPI_Send(piece, piece_of(block[1] - at), MPI_BYTE, 0, 1, MPI_COMM_WORLD);
            } else {
                MPI_Recv(piece, piece_of(block[1] - at), MPI_BYTE, rank, 1, MPI_COMM_WORLD,
                         MPI_STATUS_IGNORE);
            }
        }
    }
}

void parallel_sum(const struct parallel *parallel, uint64_t *number, int n)
{
    if (parallel->size > 1)
        MPI_Allreduce(MPI_IN_PLACE, number, n, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
}

void parallel_largest(const struct parallel *parallel, uint8_t *byte, size_t n)
{
    for (size_t at = 0; parallel->size > 1 && at < n; at += PIECE) {
        MPI_Allreduce(MPI_IN_PLACE, byte + at, piece_of(n - at), MPI_UINT8_T, MPI_MAX,
                      MPI_COMM_WORLD);
    }
}

static void barrier(const struct parallel *parallel)
{
    if (parallel->size > 1)
        MPI_Barrier(MPI_COMM_WORLD);
}

bool parallel_agree(const struct parallel *parallel, bool good, char *text, size_t size)
{
    if (parallel->size == 1)
        return good;
    int lowest = good ? parallel->size : parallel->rank;
    MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (lowest == parallel->size)
        return true;
    MPI_Bcast(text, (int)size, MPI_BYTE, lowest, MPI_COMM_WORLD);
    return false;
}

bool parallel_on_one_host(const struct parallel *parallel)
{
    int here = 1;
    if (parallel->size == 1)
        return true;
    MPI_Comm host;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, parallel->rank, MPI_INFO_NULL, &host);
    MPI_Comm_size(host, &here);
    MPI_Comm_free(&host);
    return here == parallel->size;
}

void parallel_share(struct parallel *parallel)
{
    const size_t size = (COUNTERS + (size_t)parallel->size) * sizeof *counter;
    parallel->shared = true;
    if (parallel->size > 1) {
        MPI_Win_allocate(parallel->rank == 0 ? (MPI_Aint)size : 0, sizeof *counter, MPI_INFO_NULL,
                         MPI_COMM_WORLD, &counter, &window);
        MPI_Win_lock_all(0, window);
    }
    if (parallel->rank == 0)
        memset(counter, 0, size);
    if (parallel->size > 1)
        MPI_Win_sync(window);
    barrier(parallel);
}

void parallel_unshare(struct parallel *parallel)
{
    if (parallel->shared && parallel->size > 1) {
        MPI_Win_unlock_all(window);
        MPI_Win_free(&window);
        counter = alone;
    }
    parallel->shared = false;
}

/* One-sided, so nobody serves the counters. Some networks move them on only while rank 0 is
 * inside MPI: rank 0 must come here often, too. Should rank 0's machine be cut off, this never
 * returns: see crash.h. (Open MPI 4's request for the same, which could be given up, is not
 * atomic in windows made of messages: two ranks got the same number.) */
int64_t parallel_add(const struct parallel *parallel, enum parallel_counter which, int64_t value)
{
    int64_t before = 0;
    if (parallel->size == 1)
        return (counter[which] += value) - value;
    deadline_waits(true);
    MPI_Fetch_and_op(&value, &before, MPI_INT64_T, 0, (MPI_Aint)which, MPI_SUM, window);
    MPI_Win_flush(0, window);
    deadline_waits(false);
    return before;
}

void parallel_beat(const struct parallel *parallel, int64_t number)
{
    if (parallel->size == 1) {
        counter[COUNTERS] = number;
        return;
    }
    deadline_waits(true);
    MPI_Accumulate(&number, 1, MPI_INT64_T, 0, COUNTERS + (MPI_Aint)parallel->rank, 1, MPI_INT64_T,
                   MPI_REPLACE, window);
    MPI_Win_flush(0, window);
    deadline_waits(false);
}

void parallel_beats(const struct parallel *parallel, int64_t *number)
{
    const int n = parallel->size;
    if (n == 1) {
        number[0] = counter[COUNTERS];
        return;
    }
    MPI_Get_accumulate(NULL, 0, MPI_INT64_T, number, n, MPI_INT64_T, 0, COUNTERS, n, MPI_INT64_T,
                       MPI_NO_OP, window);
    MPI_Win_flush(0, window);
}

void parallel_meet(const struct parallel *parallel, void (*wait)(void *context), void *context)
{
    enum { SHORTEST = 20000, LONGEST = 1000000 }; /* ns */
    struct timespec pause = {.tv_nsec = SHORTEST};
    MPI_Request request;
    int done = 0;

    if (parallel->size == 1)
        return;
    MPI_Ibarrier(MPI_COMM_WORLD, &request);
    for (MPI_Test(&request, &done, MPI_STATUS_IGNORE); !done;
         MPI_Test(&request, &done, MPI_STATUS_IGNORE)) {
        wait(context);
        nanosleep(&pause, NULL);
        pause.tv_nsec = pause.tv_nsec < LONGEST / 2 ? 2 * pause.tv_nsec : LONGEST;
    }
}

void parallel_library(char *text, size_t size)
{
    char name[MPI_MAX_LIBRARY_VERSION_STRING];
    int length;
    MPI_Get_library_version(name, &length);
    name[strcspn(name, ",\n")] = '\0';
    snprintf(text, size, "%s", name);
}

void parallel_restart(const struct parallel *parallel)
{
    barrier(parallel); /* every rank has drawn its last */
    for (int which = 0; parallel->rank == 0 && which < COUNTERS; which++)
        if (which != COUNTER_STOP)
            parallel_add(parallel, which, -parallel_add(parallel, which, 0));
    barrier(parallel);
}
