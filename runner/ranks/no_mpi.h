/* no_mpi.h - stands for mpi.h in a build without MPI: what a rank that is alone never calls. */
#ifndef STANCE_RANKS_NO_MPI_H
#define STANCE_RANKS_NO_MPI_H

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

typedef int MPI_Win, MPI_Request, MPI_Comm;
typedef ptrdiff_t MPI_Aint;
enum { MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, MPI_THREAD_FUNNELED };
enum { MPI_BYTE, MPI_INT, MPI_INT64_T, MPI_UINT64_T, MPI_UINT8_T };
enum { MPI_SUM, MPI_MAX, MPI_MIN, MPI_REPLACE, MPI_NO_OP };
enum { MPI_IN_PLACE, MPI_INFO_NULL, MPI_STATUS_IGNORE };
enum { MPI_MAX_LIBRARY_VERSION_STRING = 64 };

static inline void never_called(int ignored, ...)
{
    (void)ignored;
    abort();
}

#define MPI_Init_thread(argc, argv, required, provided) never_called(required, provided)
#define MPI_Comm_rank(...) never_called(0, __VA_ARGS__)
#define MPI_Comm_size(...) never_called(0, __VA_ARGS__)
#define MPI_Comm_split_type(...) never_called(0, __VA_ARGS__)
#define MPI_Comm_free(...) never_called(0, __VA_ARGS__)
#define MPI_Initialized(flag) (*(flag) = 0)
#define MPI_Finalize() never_called(0)
#define MPI_Bcast(...) never_called(0, __VA_ARGS__)
#define MPI_Gather(...) never_called(0, __VA_ARGS__)
#define MPI_Send(...) never_called(0, __VA_ARGS__)
#define MPI_Recv(...) never_called(0, __VA_ARGS__)
#define MPI_Allreduce(...) never_called(0, __VA_ARGS__)
#define MPI_Barrier(...) never_called(0, __VA_ARGS__)
#define MPI_Ibarrier(...) never_called(0, __VA_ARGS__)
#define MPI_Test(...) never_called(0, __VA_ARGS__)
#define MPI_Win_allocate(...) never_called(0, __VA_ARGS__)
#define MPI_Win_free(...) never_called(0, __VA_ARGS__)
#define MPI_Win_lock_all(...) never_called(0, __VA_ARGS__)
#define MPI_Win_unlock_all(...) never_called(0, __VA_ARGS__)
#define MPI_Win_sync(...) never_called(0, __VA_ARGS__)
#define MPI_Win_flush(...) never_called(0, __VA_ARGS__)
#define MPI_Fetch_and_op(...) never_called(0, __VA_ARGS__)
#define MPI_Accumulate(...) never_called(0, __VA_ARGS__)
#define MPI_Get_accumulate(none, ...) never_called(0, __VA_ARGS__)
#define MPI_Get_library_version(name, length) (*(length) = sprintf(name, "no MPI"))

#endif
