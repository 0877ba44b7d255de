/* shard.c - see shard.h. */
#include "shard.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    STRIPES = 256,        /* of a shard at least, where there are cases enough: see shard.h */
    LARGEST_STRIPE = 4096 /* rows: what a file leaves out are whole blocks of the disk */
};

static bool parse_number(const char **text, char end, uint64_t *number)
{
    char *rest;
    errno = 0;
    *number = strtoull(*text, &rest, 10);
    if (**text < '0' || **text > '9' || *rest != end || errno != 0)
        return false;
    *text = rest + 1;
    return true;
}

bool shard_parse(struct shard *shard, const char *text)
{
    *shard = (struct shard){0};
    return parse_number(&text, '/', &shard->number) && parse_number(&text, '\0', &shard->count) &&
           shard->number >= 1 && shard->number <= shard->count && shard->count <= SHARD_MOST;
}

void shard_text(const struct shard *shard, char text[SHARD_TEXT])
{
    snprintf(text, SHARD_TEXT, "%" PRIu64 "/%" PRIu64, shard->number, shard->count);
}

struct shard shard_of(const struct shard *shard, uint64_t rows)
{
    const uint64_t stripe = rows / (shard->count * STRIPES);
    return (struct shard){
        .number = shard->number,
        .count = shard->count,
        .rows = rows,
        .stripe = stripe < 1                ? 1
                  : stripe > LARGEST_STRIPE ? LARGEST_STRIPE
                                            : stripe,
    };
}

/* The first row of the shard's stripe among the `turn`th `count` stripes. */
static uint64_t first_row(const struct shard *shard, uint64_t turn)
{
    /* Whose the first stripe of a turn is: multiples of the golden ratio, which spread most evenly.
     */
    const uint64_t begins = (turn * 0x9e3779b97f4a7c15 >> 32) * shard->count >> 32;
    const uint64_t member = (begins + shard->number - 1) % shard->count;
    return (turn * shard->count + member) * shard->stripe;
}

uint64_t shard_rows(const struct shard *shard)
{
    const uint64_t turns = shard->rows / (shard->count * shard->stripe); /* whole ones */
    const uint64_t first = first_row(shard, turns);
    const uint64_t left = first < shard->rows ? shard->rows - first : 0;
    return turns * shard->stripe + (left < shard->stripe ? left : shard->stripe);
}

uint64_t shard_row(const struct shard *shard, uint64_t place)
{
    return first_row(shard, place / shard->stripe) + place % shard->stripe;
}

uint64_t shard_run(const struct shard *shard, uint64_t place)
{
    return shard->stripe - place % shard->stripe;
}
