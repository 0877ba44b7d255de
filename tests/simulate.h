/* simulate.h - how a large job would go: the schedule of runner/plan/schedule.h on a simulated
 * clock.
 *
 * Every rank takes its rows by the same functions as a run, computes them in the time that the
 * cases of a finished run took, and waits for the shared counter and for the file system, each of
 * which serves one request after the other. What a rank does not wait for in a run (other cases of
 * its lanes) it does not wait for here, and conversely: it computes nothing while it writes.
 */
#ifndef STANCE_TESTS_SIMULATE_H
#define STANCE_TESTS_SIMULATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct simulated_machine {
    double latency;       /* s, one way between a rank and the counter */
    double service;       /* s that a fetch-and-add occupies the counter */
    double visit;         /* s between the moments at which the counter's rank serves; 0: at once */
    double write_latency; /* s that a rank waits for a write of its own */
    double write_rate;    /* writes per s of all ranks together, may be INFINITY */
    double bandwidth;     /* bytes per s of all ranks together, may be INFINITY */
};

struct simulated_job {
    uint64_t cases;
    int ranks;
    /* Seconds of computing of cases first ... first + count - 1 on one rank. */
    double (*seconds)(const void *costs, uint64_t first, uint64_t count);
    const void *costs;
    double drain;    /* s for which the cases in hand go on when no more can be drawn */
    int lanes;       /* of a bundle; 0: what has ended of open blocks is not written in between */
    int variables;   /* writes per stretch of rows */
    size_t row_size; /* bytes of all variables */
};

struct simulation {
    double time;                        /* s until the last rank is done */
    double computing, drawing, writing; /* s, summed over the ranks */
    double waiting;                     /* s at the end, lanes running empty included; likewise */
    uint64_t cases, draws, writes;
    double bytes;
};

/* Share of the ranks' time in which they compute. */
double simulation_efficiency(const struct simulation *simulation, int ranks);

/* false: no memory. */
bool simulate(const struct simulated_machine *machine, const struct simulated_job *job,
              struct simulation *simulation);

/* Costs of a job of any size like those of a grid of outer x inner cases that were run: each
 * neighbourhood of the grid becomes a larger one, in the same order. */
struct cost_map {
    uint64_t outer, inner;
    double *sum;        /* [outer][inner + 1] seconds of the first cases of each line */
    double longest;     /* s, of one case */
    uint64_t lines, of; /* of the large job: its lines, and their cases */
};
/* seconds[outer * inner] of each case. false: no memory. */
bool cost_map_make(struct cost_map *map, const double *seconds, uint64_t outer, uint64_t inner,
                   uint64_t cases);
void cost_map_free(struct cost_map *map);
/* For simulated_job.seconds; additive to rounding. */
double cost_map_seconds(const void *map, uint64_t first, uint64_t count);

#endif
