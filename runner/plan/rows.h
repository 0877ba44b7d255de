/* rows.h - some rows of the results, by their flat indices in ascending order. */
#ifndef STANCE_PLAN_ROWS_H
#define STANCE_PLAN_ROWS_H

#include "shard.h"

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
