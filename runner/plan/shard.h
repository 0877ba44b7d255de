/* shard.h - shards of a sweep: shares of its cases for runs that know nothing of each other.
 *
 * Cases go to the shards in stripes of neighbours. Each N stripes in a row go to all N shards, one
 * each, every time beginning with another: neighbours cost alike, and so do cases at the same place
 * of each line of a grid, so that neither blocks nor every Nth stripe would cost the same. Of a map
 * of 65,536 cases the dearest of 16 shards costs 1 % more than the mean, of blocks 5 %, of every
 * Nth stripe 29 %.
 */
#ifndef STANCE_PLAN_SHARD_H
#define STANCE_PLAN_SHARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct shard {
    uint64_t number, count; /* shard 1 ... count; count 0: none, the whole sweep */
    uint64_t rows, stripe;  /* of the sweep, and of a stripe of it; by shard_of */
};

enum { SHARD_MOST = 1000000, SHARD_TEXT = 24 };

/* "2/8"; false: these are no two numbers, or there is no such shard. Rows are not known yet. */
bool shard_parse(struct shard *shard, const char *text);
void shard_text(const struct shard *shard, char text[SHARD_TEXT]);
/* The same shard of a sweep of so many cases, no fewer than there are shards. */
struct shard shard_of(const struct shard *shard, uint64_t rows);

/* How many cases it has, at least one; the one at a place of it, ascending; how many of these
 * follow each other from that place on without a gap. */
uint64_t shard_rows(const struct shard *shard);
uint64_t shard_row(const struct shard *shard, uint64_t place);
uint64_t shard_run(const struct shard *shard, uint64_t place);

/* Some rows of the results, by their flat indices in ascending order. */
struct rows {
    const uint64_t *row;       /* [count], or NULL: `first` and those that follow it */
    uint64_t count, first;     /* of a shard they are places in it */
    const struct shard *shard; /* NULL: none */
};

static inline uint64_t rows_at(const struct rows *rows, uint64_t place)
{
    return rows->row     ? rows->row[place]
           : rows->shard ? shard_row(rows->shard, rows->first + place)
                         : rows->first + place;
}

/* Those at places [place, place + count). */
static inline struct rows rows_part(const struct rows *rows, uint64_t place, uint64_t count)
{
    return (struct rows){rows->row ? rows->row + place : NULL, count, rows->first + place,
                         rows->shard};
}

#endif
