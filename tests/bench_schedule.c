/* bench_schedule.c - how a job far larger than a finished run would go on more ranks than there are
 * here, by the scheduler's own functions on a simulated clock.
 *
 *     bench_schedule FILE [NAME=VALUE]...
 *
 * Takes what the cases of a finished run cost, spreads those costs over a job of `cases` cases in
 * the same order, and plays the run's own schedule (chunks of a shared counter, blocks of rows
 * written whole). Prints a line of CSV for each number of ranks. Efficiency is the share of the
 * ranks' time in which they compute; the rest is lost to the counter, to writes, and at the end,
 * when nothing is left to draw. Start-up (launching ranks, laying out the file) is not part of it.
 *
 * The machine's figures, each of which NAME=VALUE replaces, are round numbers from what is
 * published of systems of this size:
 *   latency        one-sided 8-byte operations take 1.5 to 2.5 us one way on InfiniBand and
 *                  Slingshot through a few switches (OSU micro-benchmarks' osu_fop_latency): 2.5 us
 *   service        a network card does 10^6 and more atomic operations a second on one address;
 *                  Gerstenberger, Besta and Hoefler (SC13, "foMPI") give 2.4 us for a fetch-and-add
 *                  in all: 1.5 us of that are taken as not overlapping with the next one
 *   visit          where the network cannot do it alone, rank 0 serves when its kernel asks whether
 *                  to leave: every thousand steps of a bundle, about a millisecond (0: it can)
 *   write_latency  a small write through a parallel file system's client, waited for: 1 ms
 *   write_rate     50,000 writes a second of all clients together: the lower end of what systems
 *                  with 100 GB/s reach in IO500's ior-hard-write, in writes of 47 kB
 *   bandwidth      100 GB/s
 * Likewise `cases` (1e10), `row_size`, the bytes kept of each (outcome, failure, end_time and
 * friction_used beside checksum and status), and `variables`, in which they are kept.
 */
#include "simulate.h"

#include "runner/store/results.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 8 };

static const int ranks[] = {16, 64, 256, 1024, 4096, 16384, 65536};
enum { COUNT = sizeof ranks / sizeof ranks[0] };

static struct simulated_machine machine = {
    .latency = 2.5e-6,
    .service = 1.5e-6,
    .visit = 1e-3,
    .write_latency = 1e-3,
    .write_rate = 50e3,
    .bandwidth = 100e9,
};
static double cases = 1e10, row_size = 23, variables = 6;

static const struct {
    const char *name;
    double *value, least;
} figures[] = {
    {"latency", &machine.latency, 0},
    {"service", &machine.service, 0},
    {"visit", &machine.visit, 0},
    {"write_latency", &machine.write_latency, 0},
    {"write_rate", &machine.write_rate, 1},
    {"bandwidth", &machine.bandwidth, 1},
    {"cases", &cases, 1},
    {"row_size", &row_size, 1},
    {"variables", &variables, 1},
};

static bool read_figure(const char *text)
{
    const size_t length = strcspn(text, "=");
    for (size_t i = 0; text[length] && i < sizeof figures / sizeof figures[0]; i++) {
        char *end;
        const double value = strtod(text + length + 1, &end);
        if (strlen(figures[i].name) == length && strncmp(figures[i].name, text, length) == 0 &&
            end > text + length + 1 && !*end && value >= figures[i].least && value <= 1e15) {
            *figures[i].value = value;
            return true;
        }
    }
    fprintf(stderr, "bench_schedule: not a figure of the machine or the job: %s\n", text);
    return false;
}

/* Seconds of each case of a finished run: its steps, at what a step took on the mean. */
static bool read_costs(const struct results *r, struct cost_map *map, stance_message *message)
{
    double *steps = NULL, longest, total, timed, sum = 0;
    size_t count;
    const uint64_t inner = r->axes > 0 ? r->axis[r->axes - 1].count : 1;

    if (!results_answer(r, "steps", &steps, message))
        return false;
    for (uint64_t i = 0; steps && i < r->cases; i++)
        sum += steps[i];
    bool good = sum > 0 && results_timing(r, &longest, &total, &timed, &count) &&
                (uint64_t)timed == r->cases && total > 0;
    for (uint64_t i = 0; good && i < r->cases; i++)
        steps[i] *= total / sum;
    good = good && cost_map_make(map, steps, r->cases / inner, inner, (uint64_t)cases);
    if (!good)
        snprintf(message->text, sizeof message->text,
                 "%.150s: not a whole run, in one go, whose answers include steps", r->file);
    free(steps);
    return good;
}

static bool simulate_all(const struct cost_map *map)
{
    puts("ranks,cases,seconds,efficiency,computing_seconds,drawing_seconds,writing_seconds,"
         "waiting_seconds,draws,writes,bytes");
    for (size_t k = 0; k < COUNT; k++) {
        const struct simulated_job job = {
            .cases = (uint64_t)cases,
            .ranks = ranks[k],
            .seconds = cost_map_seconds,
            .costs = map,
            .drain = map->longest * LANES, /* a lane's share of the bundle's time is for one case */
            .lanes = LANES,
            .variables = (int)variables,
            .row_size = (size_t)row_size,
        };
        struct simulation s;
        if (!simulate(&machine, &job, &s))
            return false;
        printf("%d,%" PRIu64 ",%.9g,%.6f,%.9g,%.9g,%.9g,%.9g,%" PRIu64 ",%" PRIu64 ",%.0f\n",
               ranks[k], s.cases, s.time, simulation_efficiency(&s, ranks[k]), s.computing,
               s.drawing, s.writing, s.waiting, s.draws, s.writes, s.bytes);
        fflush(stdout);
    }
    return true;
}

int main(int argc, char **argv)
{
    struct results r;
    struct cost_map map = {0};
    stance_message message = {"not enough memory"};
    for (int i = 2; i < argc; i++)
        if (!read_figure(argv[i]))
            return 2;
    if (argc < 2) {
        fputs("usage: bench_schedule FILE [NAME=VALUE]...\n", stderr);
        return 2;
    }
    store_prepare();
    bool good = results_open(&r, argv[1], &message);
    if (good) {
        good = read_costs(&r, &map, &message) && simulate_all(&map);
        results_close(&r);
    }
    cost_map_free(&map);
    if (!good)
        fprintf(stderr, "bench_schedule: %s\n", message.text);
    return good ? 0 : 3;
}
