/* schedule.h - which rows a rank computes next: chunks of the guided schedule, in stretches.
 *
 * No clock, no messages: the number of each chunk comes from a counter that the ranks share, or
 * from a simulated one (tests/bench_schedule.c).
 */
#ifndef STANCE_PLAN_SCHEDULE_H
#define STANCE_PLAN_SCHEDULE_H

#include "shard.h"

#include <stdbool.h>

enum {
    SCHEDULE_BUNDLE = 8, /* the widest bundle of lanes: chunks are whole ones but for the last */
    SCHEDULE_LARGEST = 1 << 17,  /* largest chunk */
    SCHEDULE_SMALLEST = 1 << 15, /* most that the last chunks may hold */
};

/* Chunk k of the guided schedule of `rows` places on `ranks` ranks. Chunks are the same size, an
 * eighth of a rank's share but at most SCHEDULE_LARGEST, as long as two per rank are left; then a
 * batch of one per rank takes half of what is left, down to 1/512 of a share, on many ranks twice
 * as many places as there are ranks, but 1/32 of a share at most; always 8 to SCHEDULE_SMALLEST.
 * Pure function; chunks tile the places. false beyond the last chunk. */
bool schedule_chunk(uint64_t rows, int ranks, uint64_t k, uint64_t *first, uint64_t *count);

/* What one rank has drawn: places of the schedule, numbered from 0, each of which stands for a row
 * of the file. */
struct schedule {
    struct rows rows; /* in the order of their places */
    int ranks;
    uint64_t next, end; /* what is left of the chunk in hand */
};

/* `only` NULL: all `rows`. */
struct schedule schedule_make(uint64_t rows, int ranks, const struct rows *only);
/* Takes chunk k in hand; false: there is none. */
bool schedule_draw(struct schedule *schedule, uint64_t k);
/* The next stretch of the chunk in hand, of at most `most` places, of a shard of one stripe; 0:
 * nothing is left of it. */
size_t schedule_take(struct schedule *schedule, size_t most, uint64_t *first);
/* Rows of the largest block that a rank keeps in memory and writes at once, of rows of that many
 * bytes. */
size_t schedule_block_rows(size_t row_size);
/* Seconds between a rank's looks at the shared counters: the more ranks there are, the longer, for
 * they all meet in one place. */
double schedule_look_interval(int ranks);
/* Seconds after which what has ended of a block is written though the block is not whole. `spent`:
 * seconds that this took the last time (0: there was none); such writes take 1/500 of the time at
 * most. They leave out stretches of less than SCHEDULE_STRETCH rows, but for every SCHEDULE_ALL-th
 * of a block. */
enum { SCHEDULE_STRETCH = 32, SCHEDULE_ALL = 10 };
double schedule_write_interval(int ranks, double spent);

#endif
