/* test_schedule.c - the drawing of rows, the computing loop on lists of rows, and the simulator of
 * large jobs against schedules and sums made here. */
#include "runner/base/units.h"
#include "simulate.h"
#include "support.h"

#include "runner/plan/schedule.h"
#include "runner/run/work.h"

#include <unistd.h>

/* ---- drawing ------------------------------------------------------------------------------ */

/* Stretches tile each chunk; places stand for all rows, or for those of a list. */
TEST(test_stretches)
{
    const uint64_t row[5] = {3, 4, 9, 100, 1000};
    const struct rows only = {.row = row, .count = 5};
    uint64_t first, count, place;
    struct schedule schedule = schedule_make(1000, 3, NULL);
    assert_int_equal(schedule_take(&schedule, 10, &place), 0);
    for (uint64_t k = 0; schedule_chunk(1000, 3, k, &first, &count); k++) {
        uint64_t next = first;
        size_t n;
        assert_true(schedule_draw(&schedule, k));
        while ((n = schedule_take(&schedule, 5, &place)) > 0) {
            assert_int_equal(place, next);
            assert_true(n == 5 || next + n == first + count);
            next += n;
        }
        assert_int_equal(next, first + count);
        assert_int_equal(rows_at(&schedule.rows, first), first);
    }
    assert_false(schedule_draw(&schedule, 1000));
    assert_int_equal(schedule_take(&schedule, 10, &place), 0);
    schedule = schedule_make(5000, 1, &only);
    assert_true(schedule_draw(&schedule, 0));
    assert_int_equal(schedule_take(&schedule, 10, &place), 5);
    for (uint64_t i = 0; i < 5; i++)
        assert_int_equal(rows_at(&schedule.rows, place + i), row[i]);
}

/* ---- the computing loop ------------------------------------------------------------------- */

/* Rows of three methods in turn, some of robots that do not exist, a few recorded. */
static const char swept[] =
    "stance: 1\nscene: biped\nground: {friction: 0.8, contacts: [foot1]}\n"
    "initial:\n  equilibrium: {theta: -0.41, q2: 0.82}\n  support_foot: 1\n"
    "controller: {kind: state-feedback, design: place, sample_time: 0.001, torque_limit: 10,\n"
    "  poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6]}\n"
    "method: {step: 0.001}\nstop: {time: 0.2}\n"
    "sweep:\n  grid:\n    - {path: initial.offset.theta, from: -0.1, to: 0.05, count: 40}\n"
    "    - {path: robot.trunk_length, values: [0.535, 9]}\n"
    "    - {path: method.name, values: [implicit, capturing, midpoint]}\n"
    "record: {every: 0.1, cases: [0, 7, 100, 239]}\n";

struct fixture {
    struct scenario scenario;
    struct plan plan;
    struct parallel parallel;
    struct store *store;
    struct work work;
    char file[64];
};

static int make_fixture(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    struct plan_error error;
    stance_message message;
    store_prepare();
    *state = f;
    if (!f || !scenario_read(&f->scenario, "swept.yaml", swept, NULL, 0, stderr))
        return -1;
    f->parallel = parallel_alone();
    snprintf(f->file, sizeof f->file, "/tmp/stance-schedule-%d.h5", (int)getpid());
    unlink(f->file);
    if (!plan_make(&f->plan, &f->scenario, false, 0, false, &error) ||
        !plan_compute_designs(&f->plan, &f->parallel, &error) ||
        !store_create(f->file, &f->plan, NULL, 1, "here", &message) ||
        !store_open(&f->store, f->file, &f->plan, NULL, &message))
        return -1;
    f->work = (struct work){.plan = &f->plan,
                            .store = f->store,
                            .parallel = &f->parallel,
                            .quiet = true,
                            .start = clock_seconds(),
                            .time_limit = INFINITY};
    return 0;
}

static int free_fixture(void **state)
{
    struct fixture *f = *state;
    stance_message message;
    store_close(f->store, &message);
    unlink(f->file);
    plan_free(&f->plan);
    scenario_free(&f->scenario);
    free(f);
    return 0;
}
static CMFixtureFunction before_each = make_fixture, after_each = free_fixture;

/* Every row that was run has its label: those with a trunk of 9 m, which fail, and no others. */
static void run_rows(struct fixture *f, const struct rows *only)
{
    stance_message message;
    uint8_t label[240] = {0};
    const struct rows rows = only ? *only : (struct rows){.count = 240};
    parallel_share(&f->parallel);
    assert_true(work_run(&f->work, only, label, &message));
    parallel_unshare(&f->parallel);
    for (uint64_t i = 0; i < rows.count && f->work.time_limit > 0; i++)
        if (rows_at(&rows, i) / 3 % 2)
            assert_int_equal(label[i], WORK_FAILED);
        else
            assert_in_range(label[i], STANCE_STABILISED + 1, STANCE_UNDECIDED + 1);
    for (uint64_t i = f->work.time_limit > 0 ? rows.count : 0; i < 240; i++)
        assert_int_equal(label[i], 0);
}

static void assert_whole(struct fixture *f, const bool *expected)
{
    struct store_found found[240];
    stance_message message;
    assert_true(store_verify(f->store, &(struct rows){.count = 240}, found, &message));
    for (int row = 0; row < 240; row++) {
        assert_int_equal(found[row].whole, expected[row]);
        if (found[row].whole) /* every other row of three has a trunk of 9 m */
            assert_int_equal(found[row].status, row / 3 % 2 ? STANCE_FAILED : STANCE_DONE);
    }
}

/* A list of rows computes those and no others; what a file holds is kept by a resumed run. */
TEST(test_lists)
{
    struct fixture *f = *state;
    uint64_t row[60], n = 0, random = 5;
    bool whole[240] = {false};
    for (uint64_t i = 0; i < 240; i++)
        if (uniform(&random, 0, 1) < 0.2 || i == 100 || i / 8 == 3)
            row[n++] = i, whole[i] = true;
    run_rows(f, &(struct rows){.row = row, .count = n});
    assert_int_equal(f->work.sums.computed, n);
    assert_int_equal(f->work.sums.finished, n);
    assert_whole(f, whole);
    run_rows(f, &(struct rows){.row = row, .count = 0});
    assert_int_equal(f->work.sums.computed, n);
    f->work.resume = true;
    run_rows(f, NULL);
    assert_int_equal(f->work.sums.computed, 240);
    assert_int_equal(f->work.sums.finished, 240 + n); /* what was kept counts again */
    memset(whole, true, sizeof whole);
    assert_whole(f, whole);
}

/* Every case is in one shard, in ascending order; runs are what they say; sizes differ by a stripe
 * at most. */
TEST(test_shards)
{
    static const uint64_t sweeps[][2] = {{1, 1},      {7, 7},      {240, 1},       {240, 7},
                                         {65536, 16}, {65537, 16}, {65536, 60000}, {9000001, 3}};
    for (size_t i = 0; i < COUNT(sweeps); i++) {
        const uint64_t rows = sweeps[i][0], count = sweeps[i][1];
        OWN uint8_t *seen = calloc(rows, 1);
        uint64_t total = 0, least = rows, most = 0, stripe = 0;
        for (uint64_t k = 1; k <= count; k++) {
            const struct shard shard = shard_of(&(struct shard){.number = k, .count = count}, rows);
            const uint64_t share = shard_rows(&shard);
            const struct rows all = {.count = share, .shard = &shard};
            assert_true(share > 0);
            for (uint64_t place = 0; place < share; place++) {
                const uint64_t row = rows_at(&all, place);
                assert_true(row < rows && !seen[row]);
                assert_true(place == 0 || row > rows_at(&all, place - 1));
                seen[row] = 1;
                const struct rows part = rows_part(&all, place, 1);
                assert_int_equal(rows_at(&part, 0), row);
                if (place + 1 < share && shard_run(&shard, place) > 1)
                    assert_int_equal(rows_at(&all, place + 1), row + 1);
            }
            total += share;
            least = share < least ? share : least;
            most = share > most ? share : most;
            stripe = shard.stripe;
        }
        assert_int_equal(total, rows);
        assert_true(most - least <= stripe);
    }
}

/* On a grid of 256 x 256 whose cases cost more to one corner, or along the one axis or the other,
 * the dearest of N shards costs little more than the mean. */
TEST(test_even_shards)
{
    for (uint64_t count = 2; count <= 64; count++) {
        for (int slope = 0; slope < 3; slope++) {
            double most = 0, total = 0;
            for (uint64_t k = 1; k <= count; k++) {
                const struct shard shard =
                    shard_of(&(struct shard){.number = k, .count = count}, 65536);
                double cost = 0;
                for (uint64_t place = 0; place < shard_rows(&shard); place++) {
                    const uint64_t row = shard_row(&shard, place);
                    cost += slope == 0   ? (double)(row % 256)
                            : slope == 1 ? (double)(row / 256)
                                         : (double)(row % 256 * (row / 256));
                }
                most = fmax(most, cost);
                total += cost;
            }
            assert_true(most < 1.08 * total / (double)count);
        }
    }
}

TEST(test_shard_words)
{
    static const char *const bad[] = {
        "",          "0/4",  "5/4",  "a/b", "1/1e9",
        "1/1000001", "1/",   "/1",   "1",   "-1/2",
        "1/-2",      " 1/2", "1/2 ", "1/0", "99999999999999999999/99999999999999999999"};
    struct shard shard;
    char text[SHARD_TEXT];
    for (size_t i = 0; i < COUNT(bad); i++)
        assert_false(shard_parse(&shard, bad[i]));
    assert_true(shard_parse(&shard, "1000000/1000000"));
    shard_text(&shard, text);
    assert_string_equal(text, "1000000/1000000");
}

/* A shard computes its rows and no others. */
TEST(test_one_shard)
{
    struct fixture *f = *state;
    bool whole[240] = {false};
    const struct shard shard = shard_of(&(struct shard){.number = 3, .count = 7}, 240);
    const struct rows share = {.count = shard_rows(&shard), .shard = &shard};
    for (uint64_t place = 0; place < share.count; place++)
        whole[shard_row(&shard, place)] = true;
    run_rows(f, &share);
    assert_int_equal(f->work.sums.computed, share.count);
    assert_whole(f, whole);
}

/* Out of time before it begins: nothing is computed, and that is no error. */
TEST(test_stopped)
{
    struct fixture *f = *state;
    bool whole[240] = {false};
    f->work.time_limit = 0;
    run_rows(f, NULL);
    assert_int_equal(f->work.sums.finished, 0);
    assert_whole(f, whole);
}

/* ---- the simulator ------------------------------------------------------------------------ */

static const struct simulated_machine ideal = {.write_rate = INFINITY, .bandwidth = INFINITY};

/* seconds[0 ... ] of each case. */
static double sum_of(const void *costs, uint64_t first, uint64_t count)
{
    const double *seconds = costs;
    double sum = 0;
    for (uint64_t i = first; i < first + count; i++)
        sum += seconds[i];
    return sum;
}

enum { CASES = 30011 };

static double *random_costs(void)
{
    double *seconds = malloc(CASES * sizeof *seconds);
    uint64_t random = 1;
    assert_non_null(seconds);
    for (int i = 0; i < CASES; i++) /* neighbours are alike, as in a map */
        seconds[i] = 1e-4 * (1.2 + sin(1e-3 * i)) * uniform(&random, 0.5, 1.5);
    return seconds;
}

/* Chunk after chunk to the rank that is free first. */
static double list_schedule(const double *seconds, int ranks)
{
    double *free_at = calloc((size_t)ranks, sizeof *free_at), last = 0;
    uint64_t first, count;
    assert_non_null(free_at);
    for (uint64_t k = 0; schedule_chunk(CASES, ranks, k, &first, &count); k++) {
        int earliest = 0;
        for (int r = 1; r < ranks; r++)
            earliest = free_at[r] < free_at[earliest] ? r : earliest;
        free_at[earliest] += sum_of(seconds, first, count);
        last = fmax(last, free_at[earliest]);
    }
    free(free_at);
    return last;
}

/* Without costs of counter and writes the time is that of a list schedule; all cases are computed
 * once; the ranks' times add up. */
TEST(test_list_schedule)
{
    OWN double *seconds = random_costs();
    const double total = sum_of(seconds, 0, CASES);
    struct simulation s;
    for (int ranks = 1; ranks <= 1000; ranks = ranks * 3 + 1) {
        const struct simulated_job job = {.cases = CASES,
                                          .ranks = ranks,
                                          .seconds = sum_of,
                                          .costs = seconds,
                                          .variables = 3,
                                          .row_size = 20};
        const double expected = list_schedule(seconds, ranks);
        assert_true(simulate(&ideal, &job, &s));
        assert_true(fabs(s.time - expected) < 1e-12 * expected * CASES);
        assert_int_equal(s.cases, CASES);
        assert_true(s.bytes == 20.0 * CASES);
        assert_true(fabs(s.computing - total) < 1e-9 * total);
        assert_true(fabs(s.computing + s.drawing + s.writing + s.waiting - ranks * s.time) <
                    1e-9 * total);
        assert_true(fabs(simulation_efficiency(&s, ranks) - total / (ranks * expected)) < 1e-9);
    }
}

/* On one rank nothing queues: what draws and writes cost is a sum. */
TEST(test_one_rank)
{
    OWN double *seconds = random_costs();
    const double total = sum_of(seconds, 0, CASES);
    struct simulated_machine machine = {
        .latency = 1e-3, .write_latency = 1e-4, .write_rate = 1e3, .bandwidth = 1e6};
    struct simulated_job job = {.cases = CASES,
                                .ranks = 1,
                                .seconds = sum_of,
                                .costs = seconds,
                                .drain = 0.125,
                                .variables = 3,
                                .row_size = 20};
    struct simulation s;
    uint64_t chunks = 0, first, count;
    while (schedule_chunk(CASES, 1, chunks, &first, &count))
        chunks++;
    assert_true(simulate(&machine, &job, &s));
    assert_int_equal(s.draws, chunks + 1); /* the last one finds nothing */
    assert_int_equal(s.writes, 3 * chunks);
    assert_true(fabs(s.drawing - (double)s.draws * 2e-3) < 1e-9);
    assert_true(fabs(s.writing - ((double)s.writes * (1e-4 + 1e-3) + 20e-6 * CASES)) < 1e-9);
    assert_true(fabs(s.time - (total + s.drawing + s.writing + 0.125)) < 1e-9);
    job.lanes =
        4; /* writes in between: more of them, the same bytes, at most a 500th of the time */
    struct simulation with;
    machine.write_rate = 1e5;
    for (int i = 0; i < CASES; i++)
        seconds[i] *= 1e3;
    assert_true(simulate(&machine, &job, &with));
    assert_true(with.writes > s.writes && with.bytes == s.bytes);
    assert_true(with.writing < 1.1 * with.time / 500);
}

/* A counter that takes longer than the cases decides: one draw after the other. So does a file
 * system. */
TEST(test_queues)
{
    OWN double *seconds = calloc(CASES, sizeof *seconds);
    struct simulated_machine machine = ideal;
    const struct simulated_job job = {.cases = CASES,
                                      .ranks = 100,
                                      .seconds = sum_of,
                                      .costs = seconds,
                                      .variables = 3,
                                      .row_size = 20};
    struct simulation s;
    assert_non_null(seconds);
    machine.service = 1e-9; /* looks do not matter then */
    assert_true(simulate(&machine, &job, &s));
    assert_true(fabs(s.time - 1e-9 * (double)s.draws) < 1e-4 * s.time);
    machine.service = 0;
    machine.write_rate = 10;
    assert_true(simulate(&machine, &job, &s));
    assert_true(fabs(s.time - 0.1 * (double)s.writes) < 1e-6 * s.time);
    machine.write_rate = INFINITY;
    machine.bandwidth = 1e3;
    assert_true(simulate(&machine, &job, &s));
    assert_true(fabs(s.time - 0.02 * CASES) < 1e-6 * s.time);
}

/* A map of the same size gives each case its own cost; a larger one the same mean, in order. */
TEST(test_cost_map)
{
    double seconds[12], total = 0;
    struct cost_map map;
    for (int i = 0; i < 12; i++)
        total += seconds[i] = 1 + i * i;
    assert_true(cost_map_make(&map, seconds, 3, 4, 12));
    for (uint64_t i = 0; i < 12; i++)
        assert_true(fabs(cost_map_seconds(&map, i, 1) - seconds[i]) < 1e-12 * total);
    assert_true(map.longest == 122);
    cost_map_free(&map);
    assert_true(cost_map_make(&map, seconds, 3, 4, 1200000));
    assert_true(fabs(cost_map_seconds(&map, 0, 1200000) / 1200000 - total / 12) <
                3e-3 * total / 12);
    assert_true(fabs(cost_map_seconds(&map, 0, 1) - seconds[0]) < 1e-9);
    assert_true(fabs(cost_map_seconds(&map, (map.lines - 1) * map.of - 1, 1) - seconds[11]) < 1e-6);
    const double parts = cost_map_seconds(&map, 0, 777) + cost_map_seconds(&map, 777, 100000) +
                         cost_map_seconds(&map, 100777, 1200000 - 100777);
    assert_true(fabs(parts - cost_map_seconds(&map, 0, 1200000)) < 1e-9 * parts);
    cost_map_free(&map);
    assert_true(cost_map_make(&map, seconds, 1, 12, 10000000000)); /* one axis */
    assert_true(fabs(cost_map_seconds(&map, 0, 10000000000) / 1e10 - total / 12) < 1e-9 * total);
    cost_map_free(&map);
}

/* What large jobs rest on: 1e10 cases on 16,384 ranks are few draws, in whole blocks. */
TEST(test_large)
{
    const double seconds[1] = {1e-4};
    struct cost_map map;
    struct simulation s;
    assert_true(cost_map_make(&map, seconds, 1, 1, 10000000000));
    const struct simulated_job job = {.cases = 10000000000,
                                      .ranks = 16384,
                                      .seconds = cost_map_seconds,
                                      .costs = &map,
                                      .variables = 4,
                                      .row_size = 14};
    assert_true(simulate(&ideal, &job, &s));
    assert_int_equal(s.cases, 10000000000);
    assert_true(fabs(s.computing - 1e6) < 1e-3);
    assert_true(simulation_efficiency(&s, 16384) > 0.95);
    cost_map_free(&map);
}
