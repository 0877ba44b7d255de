/* schedule.c - guided self-scheduling: the chunks of a shared counter, and what a rank has in hand.
 *
 * Each batch of one chunk per rank takes half of what is left (Polychronopoulos and Kuck, IEEE
 * Trans. Computers C-36, 1987, with factoring as of Hummel, Schonberg and Flynn, CACM 35(8), 1992),
 * so that few draws are needed and the last chunks are small. A chunk follows from its number
 * alone: a fetch-and-add on one counter is all that ranks need to tell each other.
 */
#include "schedule.h"

enum { CHUNK_SMALLEST = 64 };

bool schedule_chunk(uint64_t rows, int ranks, uint64_t k, uint64_t *first, uint64_t *count)
{
    uint64_t workers = (uint64_t)ranks, smallest = rows / (8 * workers);
    smallest = smallest < SCHEDULE_BUNDLE  ? SCHEDULE_BUNDLE
               : smallest > CHUNK_SMALLEST ? CHUNK_SMALLEST
                                           : smallest;
    uint64_t begin = 0, batch = k / workers, member = k % workers;

    while (begin < rows) {
        uint64_t left = rows - begin, size = left / (2 * workers), batches = 1;
        if (size >= SCHEDULE_LARGEST) {
            /* As many batches as keep to the largest size, in one stride. */
            size = SCHEDULE_LARGEST;
            batches = (left / (2 * workers) - size) * 2 / size + 1;
        } else if (size <= smallest) {
            size = smallest;
            batches = UINT64_MAX;
        }
        if (batch < batches) {
            *first = begin + (batch * workers + member) * size;
            if (batch > rows || *first >= rows) {
                return false;
            }
            *count = rows - *first < size ? rows - *first : size;
            return true;
        }
        batch -= batches;
        begin += batches * workers * size;
    }
    return false;
}

struct schedule schedule_make(uint64_t rows, int ranks, const struct rows *only)
{
    return (struct schedule){
        .places = only ? only->count : rows,
        .ranks = ranks,
        .list = only ? only->row : NULL,
    };
}

bool schedule_draw(struct schedule *schedule, uint64_t k)
{
    uint64_t count;
    if (!schedule_chunk(schedule->places, schedule->ranks, k, &schedule->next, &count)) {
        schedule->next = schedule->end = 0;
        return false;
    }
    schedule->end = schedule->next + count;
    return true;
}

size_t schedule_take(struct schedule *schedule, size_t most, uint64_t *first)
{
    const uint64_t left = schedule->end - schedule->next;
    const size_t count = left < most ? (size_t)left : most;
    *first = schedule->next;
    schedule->next += count;
    return count;
}

uint64_t schedule_row(const struct schedule *schedule, uint64_t place)
{
    return schedule->list ? schedule->list[place] : place;
}
