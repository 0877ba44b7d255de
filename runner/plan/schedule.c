/* schedule.c - guided self-scheduling: the chunks of a shared counter, and what a rank has in hand.
 *
 * As long as there is plenty, chunks are as large as one write to the file should be; then each
 * batch of one chunk per rank takes half of what is left (factoring: Hummel, Schonberg and Flynn,
 * CACM 35(8), 1992, after Polychronopoulos and Kuck, IEEE Trans. Computers C-36, 1987), so that the
 * last chunks are small. A chunk follows from its number alone: a fetch-and-add on one counter is
 * all that ranks need to tell each other. The sizes are what tests/bench_schedule.c tells of.
 */
#include "schedule.h"

enum {
    CHUNKS_OF_SHARE = 8,
    LAST_OF_SHARE = 512,
    LAST_AT_MOST = 32,
    BLOCK_BYTES = 1 << 21,
    BLOCK_LEAST = 256
};
static const double look_least = 0.05, look_per_rank = 2e-4;
static const double write_least = 1, write_per_rank = 1e-3, write_share = 500;

static uint64_t clamp(uint64_t value, uint64_t least, uint64_t most)
{
    return value < least ? least : value > most ? most : value;
}

static uint64_t whole_bundles(uint64_t rows)
{
    return (rows + SCHEDULE_BUNDLE - 1) / SCHEDULE_BUNDLE * SCHEDULE_BUNDLE;
}

bool schedule_chunk(uint64_t rows, int ranks, uint64_t k, uint64_t *first, uint64_t *count)
{
    const uint64_t workers = (uint64_t)ranks, share = rows / workers;
    /* What many ranks write last should not be too many small pieces. */
    const uint64_t most = clamp(share / LAST_AT_MOST, SCHEDULE_BUNDLE, SCHEDULE_SMALLEST);
    const uint64_t smallest = whole_bundles(
        clamp(2 * workers, clamp(share / LAST_OF_SHARE, SCHEDULE_BUNDLE, most), most));
    const uint64_t largest =
        whole_bundles(clamp(share / CHUNKS_OF_SHARE, smallest, SCHEDULE_LARGEST));
    uint64_t begin = 0, batch = k / workers, member = k % workers;

    while (begin < rows) {
        uint64_t left = rows - begin, size = whole_bundles(left / (2 * workers)), batches = 1;
        if (size > largest) {
            /* As many batches as keep to the largest size, in one stride. */
            batches = (left / (2 * workers) - largest) * 2 / largest + 1;
            size = largest;
        } else if (size <= smallest) {
            size = smallest;
            batches = UINT64_MAX;
        }
        if (batch < batches) {
            *first = begin + (batch * workers + member) * size;
            if (batch > rows || *first >= rows)
                return false;
            *count = rows - *first < size ? rows - *first : size;
            return true;
        }
        batch -= batches;
        begin += batches * workers * size;
    }
    return false;
}

size_t schedule_block_rows(size_t row_size)
{
    return (size_t)clamp(BLOCK_BYTES / row_size, BLOCK_LEAST, SCHEDULE_LARGEST);
}

static double interval(double least, double per_rank, int ranks)
{
    return per_rank * ranks > least ? per_rank * ranks : least;
}

double schedule_look_interval(int ranks)
{
    return interval(look_least, look_per_rank, ranks);
}

double schedule_write_interval(int ranks, double spent)
{
    const double least = interval(write_least, write_per_rank, ranks);
    return spent * write_share > least ? spent * write_share : least;
}

struct schedule schedule_make(uint64_t rows, int ranks, const struct rows *only)
{
    return (struct schedule){
        .rows = only ? *only : (struct rows){.count = rows},
        .ranks = ranks,
    };
}

bool schedule_draw(struct schedule *schedule, uint64_t k)
{
    uint64_t count;
    if (!schedule_chunk(schedule->rows.count, schedule->ranks, k, &schedule->next, &count)) {
        schedule->next = schedule->end = 0;
        return false;
    }
    schedule->end = schedule->next + count;
    return true;
}

size_t schedule_take(struct schedule *schedule, size_t most, uint64_t *first)
{
    const struct rows *rows = &schedule->rows;
    uint64_t left = schedule->end - schedule->next;
    if (rows->shard && shard_run(rows->shard, schedule->next) < left)
        left = shard_run(rows->shard, schedule->next); /* one write for each variable */
    const size_t count = left < most ? (size_t)left : most;
    *first = schedule->next;
    schedule->next += count;
    return count;
}
