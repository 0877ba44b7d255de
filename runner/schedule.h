/* schedule.h - which rows a rank computes next: chunks of the guided schedule, in stretches.
 *
 * No clock, no messages: the number of each chunk comes from a counter that the ranks share, or
 * from a simulated one (bench schedule).
 */
#ifndef STANCE_RUNNER_SCHEDULE_H
#define STANCE_RUNNER_SCHEDULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Some rows of the file, ascending. */
struct rows {
    const uint64_t *row;
    uint64_t count;
};

/* Chunk k of the guided schedule of `rows` places on `ranks` ranks: sizes shrink from at most
 * SCHEDULE_LARGEST to a few bundles of lanes, always whole bundles but for the last; a batch of one
 * chunk per rank takes half of what is left. Pure function; chunks tile the places. false beyond
 * the last chunk. */
enum { SCHEDULE_BUNDLE = 8, SCHEDULE_LARGEST = 4096 };
bool schedule_chunk(uint64_t rows, int ranks, uint64_t k, uint64_t *first, uint64_t *count);

/* What one rank has drawn: places of the schedule, numbered from 0, which stand for all rows of the
 * file in order, or for those of a list. */
struct schedule {
    uint64_t places;
    int ranks;
    const uint64_t *list; /* [places], or NULL: place i is row i */
    uint64_t next, end;   /* what is left of the chunk in hand */
};

/* `only` NULL: all `rows`. */
struct schedule schedule_make(uint64_t rows, int ranks, const struct rows *only);
/* Takes chunk k in hand; false: there is none. */
bool schedule_draw(struct schedule *schedule, uint64_t k);
/* The next stretch of the chunk in hand, of at most `most` places; 0: nothing is left of it. */
size_t schedule_take(struct schedule *schedule, size_t most, uint64_t *first);
/* Row of the file that a place stands for. */
uint64_t schedule_row(const struct schedule *schedule, uint64_t place);

#endif
