/* simulate.c - a discrete-event simulation: the rank whose next event is the earliest goes on.
 *
 * The counter and the file system are single servers with a queue: whoever comes is served when all
 * who came before have been. A rank asks for rows (`DRAWING`), then computes a block; every so
 * often it writes what has ended of it, and when it is whole the rest (`COMPUTING`).
 */
#include "simulate.h"

#include "runner/plan/schedule.h"

#include <math.h>
#include <stdlib.h>

struct rank {
    double time; /* of its next event */
    enum { DRAWING, COMPUTING } doing;
    struct schedule schedule;
    double left;     /* s of computing in the block in hand */
    double write_at; /* when what has ended is written next */
    int written;     /* how often it was, of this block */
    size_t rows;     /* of the block in hand */
};

struct world {
    const struct simulated_machine *machine;
    const struct simulated_job *job;
    struct simulation *s;
    struct rank *rank;
    int *heap, size; /* ranks, the earliest first */
    size_t block;    /* rows of the largest block */
    double service;  /* s per fetch-and-add, the ranks' looks between them included */
    double counter_free, file_free, ended;
    uint64_t draws;
};

/* ---- the queue of events ------------------------------------------------------------------ */

static bool earlier(const struct world *w, int a, int b)
{
    const double ta = w->rank[a].time, tb = w->rank[b].time;
    return ta < tb || (ta == tb && a < b);
}

/* The first rank of the heap has a later time now, or (gone) is replaced by the last one. */
static void sift(struct world *w)
{
    const int moving = w->heap[0];
    int at = 0;
    for (;;) {
        int child = 2 * at + 1;
        if (child >= w->size)
            break;
        if (child + 1 < w->size && earlier(w, w->heap[child + 1], w->heap[child]))
            child++;
        if (!earlier(w, w->heap[child], moving))
            break;
        w->heap[at] = w->heap[child];
        at = child;
    }
    w->heap[at] = moving;
}

/* ---- what a rank waits for ---------------------------------------------------------------- */

static void draw(struct world *w, struct rank *rank)
{
    const struct simulated_machine *m = w->machine;
    double arrival = rank->time + m->latency;
    if (m->visit > 0)
        arrival = ceil(arrival / m->visit) * m->visit;
    w->counter_free = fmax(arrival, w->counter_free) + w->service;
    const double back = w->counter_free + m->latency;
    w->s->drawing += back - rank->time;
    rank->time = back;
}

/* So many stretches of rows, each of all variables, and so many rows in them. */
static void write_rows(struct world *w, struct rank *rank, int stretches, size_t rows)
{
    const struct simulated_machine *m = w->machine;
    const double count = (double)stretches * w->job->variables;
    const double bytes = (double)rows * (double)w->job->row_size;
    w->file_free = fmax(rank->time, w->file_free) + count / m->write_rate + bytes / m->bandwidth;
    const double back = fmax(w->file_free, rank->time) + count * m->write_latency;
    w->s->writing += back - rank->time;
    w->s->writes += (uint64_t)count;
    w->s->bytes += bytes;
    rank->time = back;
}

/* ---- events ------------------------------------------------------------------------------- */

/* On to the end of the block or to the next write before it. */
static void compute(struct world *w, struct rank *rank)
{
    const double stop = w->job->lanes > 0 ? fmax(rank->write_at, rank->time) : INFINITY;
    const double span = fmin(rank->left, stop - rank->time);
    rank->left -= span;
    rank->time += span;
    w->s->computing += span;
    rank->doing = COMPUTING;
}

/* false: there are no more rows. */
static bool take_block(struct world *w, struct rank *rank)
{
    uint64_t first;
    rank->rows = schedule_take(&rank->schedule, w->block, &first);
    if (rank->rows == 0) {
        draw(w, rank);
        w->s->draws++;
        if (!schedule_draw(&rank->schedule, w->draws++))
            return false;
        rank->rows = schedule_take(&rank->schedule, w->block, &first);
    }
    rank->left = w->job->seconds(w->job->costs, first, rank->rows);
    rank->written = 0;
    rank->write_at = rank->time + schedule_write_interval(w->job->ranks, 0);
    w->s->cases += rank->rows;
    return true;
}

/* The rank's next event; false: it is done. */
static bool advance(struct world *w, struct rank *rank)
{
    if (rank->doing == COMPUTING && rank->left > 0) {
        /* The long stretches, and at times all between cases in hand; the bytes count later. */
        const bool all = ++rank->written % SCHEDULE_ALL == 0;
        const double start = rank->time;
        write_rows(w, rank, all ? 2 * w->job->lanes : 2, 0);
        rank->write_at = rank->time + schedule_write_interval(w->job->ranks, rank->time - start);
        compute(w, rank);
        return true;
    }
    if (rank->doing == COMPUTING) {
        write_rows(w, rank, 1, rank->rows);
        rank->doing = DRAWING;
        return true;
    }
    if (!take_block(w, rank)) {
        rank->time += w->job->drain;
        w->ended += rank->time;
        w->s->waiting += w->job->drain;
        w->s->time = fmax(w->s->time, rank->time);
        return false;
    }
    compute(w, rank);
    return true;
}

double simulation_efficiency(const struct simulation *s, int ranks)
{
    return s->time > 0 ? s->computing / (s->time * ranks) : 1;
}

bool simulate(const struct simulated_machine *machine, const struct simulated_job *job,
              struct simulation *simulation)
{
    const int ranks = job->ranks;
    /* Each look is two operations at most: what has ended, and whether to stop. */
    const double looks = 2.0 * ranks / schedule_look_interval(ranks) * machine->service;
    struct world w = {
        .machine = machine,
        .job = job,
        .s = simulation,
        .rank = calloc((size_t)ranks, sizeof *w.rank),
        .heap = calloc((size_t)ranks, sizeof *w.heap),
        .size = ranks,
        .block = schedule_block_rows(job->row_size),
        .service = machine->service / fmax(1 - looks, 1e-3),
    };
    *simulation = (struct simulation){0};
    for (int r = 0; w.rank && w.heap && r < ranks; r++) {
        w.rank[r].schedule = schedule_make(job->cases, ranks, NULL);
        w.heap[r] = r;
    }
    while (w.rank && w.heap && w.size > 0) {
        if (!advance(&w, &w.rank[w.heap[0]]))
            w.heap[0] = w.heap[--w.size];
        if (w.size > 0)
            sift(&w);
    }
    simulation->waiting += simulation->time * ranks - w.ended;
    const bool good = w.rank && w.heap;
    free(w.rank);
    free(w.heap);
    return good;
}

/* ---- costs -------------------------------------------------------------------------------- */

bool cost_map_make(struct cost_map *map, const double *seconds, uint64_t outer, uint64_t inner,
                   uint64_t cases)
{
    const double scale = sqrt((double)cases / (double)(outer * inner));
    *map = (struct cost_map){.outer = outer, .inner = inner};
    map->lines = outer == 1   ? 1
                 : inner == 1 ? cases
                              : (uint64_t)fmax(1, round((double)outer * scale));
    map->of = (cases + map->lines - 1) / map->lines;
    map->sum = malloc(outer * (inner + 1) * sizeof *map->sum);
    for (uint64_t o = 0; map->sum && o < outer; o++) {
        double *sum = map->sum + o * (inner + 1);
        sum[0] = 0;
        for (uint64_t i = 0; i < inner; i++) {
            const double cost = seconds[o * inner + i];
            sum[i + 1] = sum[i] + cost;
            map->longest = fmax(map->longest, cost);
        }
    }
    return map->sum != NULL;
}

void cost_map_free(struct cost_map *map)
{
    free(map->sum);
    map->sum = NULL;
}

/* Seconds of the first `i` cases of a line of the large job. */
static double line_sum(const struct cost_map *map, uint64_t line, uint64_t i)
{
    const double *sum = map->sum + line * map->outer / map->lines * (map->inner + 1);
    const double stretch = (double)map->of / (double)map->inner, at = (double)i / stretch;
    const uint64_t whole = (uint64_t)at < map->inner ? (uint64_t)at : map->inner - 1;
    return stretch * (sum[whole] + (at - (double)whole) * (sum[whole + 1] - sum[whole]));
}

double cost_map_seconds(const void *context, uint64_t first, uint64_t count)
{
    const struct cost_map *map = context;
    double total = 0;
    while (count > 0) {
        const uint64_t line = first / map->of, from = first % map->of;
        const uint64_t n = count < map->of - from ? count : map->of - from;
        total += line_sum(map, line, from + n) - line_sum(map, line, from);
        first += n;
        count -= n;
    }
    return total;
}
