/* test_runner.c - options, checksums, plan, results file and lock, each alone and on one rank. */
#include "runner/base/words.h"
#include "support.h"

#include "runner/base/checksum.h"
#include "runner/base/command.h"
#include "runner/base/sandbox.h"
#include "runner/plan/plan.h"
#include "runner/plan/schedule.h"
#include "runner/store/lock.h"
#include "runner/store/store.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#define SCENARIO FREED(scenario_free) struct scenario
#define PLAN FREED(plan_free) struct plan

/* ---- checksums ---------------------------------------------------------------------------- */

/* RFC 3720, appendix B.4, and the check value of the CRC catalogues. */
TEST(test_crc32c)
{
    uint8_t zeros[32] = {0}, ones[32], rising[32];
    memset(ones, 0xff, sizeof ones);
    for (int i = 0; i < 32; i++)
        rising[i] = (uint8_t)i;
    assert_int_equal(checksum_crc32c(0, zeros, 32), 0x8a9136aa);
    assert_int_equal(checksum_crc32c(0, ones, 32), 0x62a8ab43);
    assert_int_equal(checksum_crc32c(0, rising, 32), 0x46dd794e);
    assert_int_equal(checksum_crc32c(0, "123456789", 9), 0xe3069283);
    assert_int_equal(checksum_crc32c(checksum_crc32c(0, "1234", 4), "56789", 5), 0xe3069283);
    uint8_t bytes[100]; /* one at a time no instruction for eight is used */
    for (size_t size = 0; size < sizeof bytes; size++) {
        uint32_t crc = 0;
        bytes[size] = (uint8_t)(size * size * 37 + 11);
        for (size_t i = 0; i <= size; i++)
            crc = checksum_crc32c(crc, &bytes[i], 1);
        assert_int_equal(checksum_crc32c(0, bytes, size + 1), crc);
    }
}

/* FIPS 180-4's examples, and the lengths around a block's end by what they continue to. */
TEST(test_sha256)
{
    static char million[1000000];
    static const struct {
        const char *of, *wanted;
    } known[] = {{"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
                 {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
                 {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
                  "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"}};
    char text[CHECKSUM_SHA256_TEXT];
    for (size_t k = 0; k < COUNT(known); k++) {
        checksum_sha256(known[k].of, strlen(known[k].of), text);
        assert_string_equal(text, known[k].wanted);
    }
    memset(million, 'a', sizeof million);
    checksum_sha256(million, sizeof million, text);
    assert_string_equal(text, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

/* ---- words and options -------------------------------------------------------------------- */

TEST(test_nearest_word)
{
    static const char *const known[] = {"check",    "design",      "run",
                                        "status",   "summary",     "sample_time",
                                        "friction", "restitution", "contacts"},
                             *const axes[] = {"z", "vz", "gain"};
    static const struct {
        const char *word, *nearest;
    } of[] = {{"chekc", "check"}, /* a swap is one edit */
              {"stats", "status"},
              {"sampletime", "sample_time"},
              {"ru", "run"},
              {"xyz", NULL},
              {"", NULL},
              {"telescope", NULL},
              {"fricton", "friction"},
              {"rfiction", "friction"},
              {"restituti", "restitution"},
              {"gravity", NULL}};
    for (size_t k = 0; k < COUNT(of); k++) {
        const char *const found = nearest_word(of[k].word, known, COUNT(known));
        assert_true(of[k].nearest ? found && strcmp(found, of[k].nearest) == 0 : !found);
    }
    assert_null(nearest_word("zzz", axes, 3)); /* two of three letters are too many */
    assert_null(nearest_word("x", axes, 3));
    assert_string_equal(nearest_word("gian", axes, 3), "gain");
}

static int nothing(int argc, char **argv)
{
    (void)argc, (void)argv;
    return 0;
}

struct tried {
    struct option_texts sets, files, colours;
    const char *output;
    bool force, resume;
    uint64_t cases;
    double level;
    int colour;
};

static const char *colour_word(size_t k)
{
    static const char *const words[] = {"red", "green", NULL};
    return words[k];
}

/* Every kind of row; what is wrong with each, and with some beside others. */
TEST(test_options)
{
#define TRIED(member) OPTION_TO(struct tried, member)
    static const struct option more[] = {
        {"--cases", "N", TRIED(cases), .low = 2, .high = 9, .text = "some"},
        {"--level", "L", TRIED(level), .low = 0.5, .high = 1, .needs = "--cases or --colour"},
        {"--colour", TRIED(colour), .word = colour_word},
        {"--colours", "C,...", TRIED(colours), .word = colour_word, .listed = true},
        {0},
    };
    static const struct option options[] = {
        {"FILE...", TRIED(files), .low = 1, .high = 2, .text = "a file"},
        {"--set", "PATH=VALUE", TRIED(sets), .most = 2},
        {"-o", "FILE", TRIED(output)},
        {"--force", TRIED(force)},
        {"--resume", TRIED(resume), .without = "--force FILE..."},
        {.rows = more},
        {0},
    };
    const struct command command = {"try", "tries", nothing, options, NULL, NULL};
    struct tried t = {.level = 0.75};
    char *good[] = {"try", "--set=a=1", "file",      "--set", "b=2",
                    "-o",  "out",       "--cases=9", "--",    "--force"};
    assert_int_equal(command_begin(&command, 10, good, &t), COMMAND_GOES_ON);
    assert_int_equal(t.sets.count, 2);
    assert_string_equal(t.sets.text[0], "a=1");
    assert_string_equal(t.sets.text[1], "b=2");
    assert_string_equal(t.output, "out");
    assert_false(t.force);
    assert_int_equal(t.files.count, 2);
    assert_string_equal(t.files.text[1], "--force");
    assert_int_equal(t.cases, 9);
    assert_true(t.level == 0.75);
    char *words[] = {"try", "a", "--colour", "green", "--level", "1", "--colours=red,green"};
    assert_int_equal(command_begin(&command, 7, words, &t), COMMAND_GOES_ON);
    assert_int_equal(t.colours.count, 2);
    assert_string_equal(t.colours.text[1], "green");
    assert_int_equal(t.colour, 1);
    assert_true(t.level == 1);
    char *bad[][5] = {
        {"try", "--st", "a"},          {"try", "a", "b", "c"},
        {"try", "-o", "a", "-oa"},     {"try", "a", "-o"},
        {"try", "a", "--force=1"},     {"try"},
        {"try", "a", "-o=b"},          {"try", "-o", "a", "-o", "b"},
        {"try", "a", "--cases=1"},     {"try", "a", "--cases=10"},
        {"try", "a", "--cases=3x"},    {"try", "a", "--cases", "18446744073709551615"},
        {"try", "a", "--colour=b"},    {"try", "a", "--level=1"},
        {"try", "a", "--resume"},      {"try", "a", "--cases=2", "--level=nan"},
        {"try", "a", "--colours=red,"}};
    int silent = dup(STDERR_FILENO);
    assert_non_null(freopen("/dev/null", "w", stderr));
    for (size_t i = 0; i < COUNT(bad); i++) {
        int count = 0;
        while (count < 5 && bad[i][count])
            count++;
        assert_int_equal(command_begin(&command, count, bad[i], &t), EXIT_USAGE);
    }
    fflush(stderr);
    dup2(silent, STDERR_FILENO);
    close(silent);
}

/* ---- the plan ----------------------------------------------------------------------------- */

/* Chunks tile the rows, in order, without overlap, in whole bundles of lanes; none is larger than a
 * eighth of a rank's share, the last ones are a 32nd of it at most. */
TEST(test_chunks)
{
    const uint64_t sizes[] = {1, 2, 7, 8, 63, 64, 65, 1000, 4096, 65536, 1000003, 40000000};
    for (size_t i = 0; i < COUNT(sizes); i++) {
        for (int ranks = 1; ranks <= 1024; ranks = ranks * 3 + 1) {
            uint64_t next = 0, first, count, k = 0, before = UINT64_MAX;
            for (; schedule_chunk(sizes[i], ranks, k, &first, &count); k++) {
                assert_int_equal(first, next);
                const uint64_t share = sizes[i] / (uint64_t)ranks;
                assert_in_range(count, 1, SCHEDULE_LARGEST);
                assert_true(count <= share / 8 + 8);
                assert_true(count <= before);
                assert_true(count % 8 == 0 || first + count == sizes[i]);
                before = count;
                next = first + count;
                assert_true(k < 2 * sizes[i]);
            }
            assert_int_equal(next, sizes[i]);
            assert_true(before <= sizes[i] / (uint64_t)ranks / 32 + 8);
            assert_false(schedule_chunk(sizes[i], ranks, k + 1, &first, &count));
            assert_false(schedule_chunk(sizes[i], ranks, UINT32_MAX, &first, &count));
        }
    }
    uint64_t first, count;
    assert_true(schedule_chunk((uint64_t)1 << 40, 7, 1000003, &first, &count));
    assert_int_equal(first, (uint64_t)1000003 * SCHEDULE_LARGEST);
}

static const char swept[] =
    "stance: 1\nscene: biped\nground: {friction: 0.8, contacts: [foot1]}\n"
    "initial:\n  equilibrium: {theta: -0.41, q2: 0.82}\n  support_foot: 1\n"
    "controller: {kind: state-feedback, design: place, sample_time: 0.001, torque_limit: 10,\n"
    "  poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6]}\n"
    "method: {name: implicit, step: 0.001}\nstop: {time: 0.5}\n"
    "sweep:\n  grid:\n    - {path: initial.offset.theta, values: [0, 0.01, 0.02]}\n"
    "    - {path: robot.trunk_mass, values: [1.7, 1.8]}\n"
    "    - {path: initial.offset.vtheta, values: [0, 0.1, 0.2, 0.3, 0.4]}\n"
    "    - {path: robot.trunk_length, values: [0.535, 9]}\n"
    "record: {every: 0.1, cases: [3, 17, 59]}\n";

struct fixture {
    struct scenario scenario;
    struct plan plan;
    struct parallel alone;
    char file[64];
};

static int make_fixture(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    struct plan_error error;
    store_prepare();
    *state = f;
    if (!f || !scenario_read(&f->scenario, "swept.yaml", swept, NULL, 0, stderr))
        return -1;
    f->alone = parallel_alone();
    snprintf(f->file, sizeof f->file, "/tmp/stance-test-%d.h5", (int)getpid());
    return plan_make(&f->plan, &f->scenario, false, 0, false, &error) &&
                   plan_compute_designs(&f->plan, &f->alone, &error)
               ? 0
               : -1;
}

static int free_fixture(void **state)
{
    struct fixture *f = *state;
    unlink(f->file);
    plan_free(&f->plan);
    scenario_free(&f->scenario);
    free(f);
    return 0;
}
static CMFixtureFunction before_tests = make_fixture, after_tests = free_fixture;

/* Axes 1 and 3 decide on the design; robots with a trunk of 9 m have no such equilibrium. */
TEST(test_designs)
{
    struct fixture *f = *state;
    const struct plan *plan = &f->plan;
    assert_int_equal(plan->rows, 60);
    assert_int_equal(plan->designs, 4);
    for (uint64_t a = 0, index = 0; a < 3; a++)
        for (uint64_t b = 0; b < 2; b++)
            for (uint64_t c = 0; c < 5; c++)
                for (uint64_t d = 0; d < 2; d++, index++) {
                    stance_case out;
                    int method;
                    assert_int_equal(plan_design(plan, index), 2 * b + d);
                    assert_int_equal(plan_resolve(plan, index, &out, &method), d == 0);
                    if (d == 0) {
                        assert_true(out.robot[3] == (b ? 1.8 : 1.7));
                        assert_true(fabs(out.velocity[2] - 0.1 * (double)c) < 1e-15);
                    }
                }
    for (int d = 0; d < 4; d++)
        assert_int_equal(plan->design_status[d], d % 2 ? STANCE_FAILED : STANCE_DONE);
    /* Two robots, two different gains. */
    const struct resolved_design first = plan_design_at(plan, 0), other = plan_design_at(plan, 2);
    assert_true(first.gain[0][0] != other.gain[0][0]);
}

TEST(test_recorded)
{
    struct fixture *f = *state;
    uint64_t place;
    assert_int_equal(f->plan.record_rows, 6);
    assert_int_equal(f->plan.record_cases, 3);
    for (uint64_t row = 0; row < 60; row++)
        assert_int_equal(plan_recorded(&f->plan, row, &place), row == 3 || row == 17 || row == 59);
    assert_true(plan_recorded(&f->plan, 17, &place));
    assert_int_equal(place, 1);
    assert_int_equal(plan_recorded_case(&f->plan, 2), 59);
}

TEST(test_checks)
{
    struct fixture *f = *state;
    struct plan_error error = {0};
    bool bound;
    assert_true(plan_check_cases(&f->plan, &error));
    assert_true(plan_cost(&f->plan, 0.05, &bound) > 0);
    f->scenario.base.offset[1] = -0.2; /* under the ground */
    assert_false(plan_check_cases(&f->plan, &error));
    assert_int_equal(error.line, 4);
    assert_non_null(strstr(error.message.text, "ground"));
    f->scenario.base.offset[1] = 0;
}

/* Without time one design is computed, the one that the cost is told from; the others stay pending
 * and nobody is told that they do not exist. Later they are made up for. */
TEST(test_impatient)
{
    struct fixture *f = *state;
    PLAN plan;
    struct plan_error error = {0};
    bool bound;
    assert_true(plan_make(&plan, &f->scenario, false, 0, false, &error));
    plan.patience = 1e-12;
    assert_true(plan_compute_designs(&plan, &f->alone, &error));
    assert_int_equal(plan.pending, 3);
    assert_int_equal(plan.design_status[0], STANCE_DONE);
    assert_true(plan.design_seconds > 0);
    assert_true(plan_check_cases(&plan, &error));
    assert_true(plan_cost(&plan, 0.05, &bound) > 0);
    f->scenario.base.offset[1] = -0.2; /* under the ground */
    assert_false(plan_check_cases(&plan, &error));
    f->scenario.base.offset[1] = 0;
    for (int d = 1; d < 4; d++)
        assert_int_equal(plan.design_status[d], STANCE_PENDING);
    plan.patience = 0;
    assert_true(plan_compute_designs(&plan, &f->alone, &error));
    assert_int_equal(plan.pending, 0);
    assert_memory_equal(plan.design_status, f->plan.design_status, 4);
    for (int d = 0; d < 4; d += 2)
        assert_memory_equal(&plan.design[d * plan.design_size],
                            &f->plan.design[d * plan.design_size],
                            plan.design_size * sizeof *plan.design);
}

/* ---- the results file --------------------------------------------------------------------- */

/* A result whose numbers say which row it is of. */
static stance_result numbered(uint64_t row)
{
    stance_result r = {.status = STANCE_DONE,
                       .outcome = STANCE_FELL,
                       .evidence = STANCE_SIMULATED,
                       .end_time = (double)row,
                       .settle_time = NAN,
                       .fall_time = 0.5,
                       .steps = (int64_t)row * 1000000007,
                       .iterations = -1,
                       .peak_torque = 1e-300,
                       .events = (int64_t)row - 7,
                       .evaluations = (int64_t)row << 40,
                       .energy_gain = 1e300,
                       .signorini_residual = 0.5,
                       .coulomb_residual = -0.0,
                       .dissipation_residual = INFINITY};
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        r.position[i] = (double)row + 0.1 * i, r.velocity[i] = -(double)row;
    return r;
}

/* Through a block, from its third slot on. */
static void store_results(struct store *store, struct rows rows, const stance_result *results)
{
    stance_message message;
    struct store_block *block = store_block_make(store, rows.count + 2);
    assert_non_null(block);
    for (size_t i = 0; i < rows.count; i++)
        store_put(block, i + 2, &results[i]);
    assert_true(store_write(store, block, 2, &rows, &message));
    free(block);
}

static void write_rows(struct store *store, uint64_t first, size_t n)
{
    stance_result results[STORE_ROWS];
    for (size_t i = 0; i < n; i++)
        results[i] = numbered(first + i);
    store_results(store, (struct rows){.count = n, .first = first}, results);
}

static void assert_whole(struct store *store, uint64_t first, size_t n, bool expected)
{
    struct store_found found[STORE_ROWS];
    stance_message message;
    assert_true(store_verify(store, &(struct rows){.count = n, .first = first}, found, &message));
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(found[i].whole, expected);
        if (expected)
            assert_int_equal(found[i].outcome, STANCE_FELL);
    }
}

/* The file anew, as that plan makes it. */
static struct store *opened(const struct fixture *f, const struct plan *plan)
{
    struct store *store;
    stance_message message;
    unlink(f->file);
    assert_true(store_create(f->file, plan, NULL, 1, "here", &message));
    assert_true(store_open(&store, f->file, plan, NULL, &message));
    return store;
}

/* Ranges of all lengths over a grid of 3 x 2 x 5 x 2: written rows are whole, others stay pending
 * (trajectories, which these rows lack, are tested from outside). */
TEST(test_rows)
{
    struct fixture *f = *state;
    struct store_counts counts;
    stance_message message;
    struct plan plan = f->plan;
    plan.record_rows = 0, plan.record_cases = 0;
    for (uint64_t first = 0; first < 60; first++) {
        const size_t n = 1 + (size_t)(first * 37 % (60 - first));
        struct store *const store = opened(f, &plan);
        assert_whole(store, 0, 60, false);
        write_rows(store, first, n);
        assert_whole(store, first, n, true);
        assert_whole(store, 0, (size_t)first, false);
        assert_whole(store, first + n, 60 - (size_t)first - n, false);
        assert_true(store_close(store, &message));
        assert_true(store_count(f->file, &counts, &message));
        assert_int_equal(counts.cases, 60);
        assert_int_equal(counts.done, n);
        assert_int_equal(counts.failed, 0);
    }
}

/* Lists of rows, scattered and in one stretch: those are whole, and no others were touched. */
TEST(test_listed_rows)
{
    struct fixture *f = *state;
    stance_message message;
    struct plan plan = f->plan;
    plan.record_rows = 0, plan.record_cases = 0;
    struct store *const store = opened(f, &plan);
    for (uint64_t third = 0; third < 3; third++) {
        const uint64_t begin = 20 * third, step = 7 - 3 * third;
        stance_result results[20];
        uint64_t rows[20];
        size_t n = 0;
        for (uint64_t row = begin; row < begin + 20; row += step) {
            results[n] = numbered(row);
            rows[n++] = row;
        }
        store_results(store, (struct rows){.row = rows, .count = n}, results);
        for (uint64_t row = begin; row < 60; row++)
            assert_whole(store, row, 1, row < begin + 20 && (row - begin) % step == 0);
    }
    assert_true(store_close(store, &message));
}

TEST(test_designs_stored)
{
    struct fixture *f = *state;
    stance_message message;
    PLAN copy = f->plan;
    copy.design = calloc(4, copy.design_size * sizeof *copy.design);
    copy.design_status = calloc(4, 1);
    struct store *const store = opened(f, &f->plan);
    assert_true(store_read_designs(store, &copy, &message));
    assert_true(store_close(store, &message));
    assert_memory_equal(copy.design_status, f->plan.design_status, 4);
    for (int d = 0; d < 4; d += 2)
        assert_memory_equal(&copy.design[d * copy.design_size],
                            &f->plan.design[d * copy.design_size],
                            copy.design_size * sizeof *copy.design);
    assert_true(isnan(plan_design_at(&copy, 1).gain[0][0]));
}

/* A scene without actuators and designs: rows with trajectories, whole when both are. */
TEST(test_plain_scene)
{
    static const char ball[] =
        "stance: 1\nscene: ball\nground: {restitution: 0.5}\ninitial: {state: {z: 0.6}}\n"
        "stop: {time: 0.5, settle: off}\n"
        "sweep: {grid: [{path: robot.radius, values: [0, 0.1, 0.2]}]}\n"
        "record: {every: 0.1, cases: all}\n";
    const struct fixture *f = *state;
    SCENARIO s;
    PLAN plan;
    struct plan_error error;
    stance_message message;
    struct store_found found[3];
    stance_result results[3];
    const double nothing = NAN;
    double data[6 * 7];
    assert_true(scenario_read(&s, "ball.yaml", ball, NULL, 0, stderr));
    assert_true(plan_make(&plan, &s, false, 0, false, &error));
    assert_true(plan_compute_designs(&plan, &f->alone, &error));
    assert_int_equal(plan.designs, 1);
    assert_true(plan_check_cases(&plan, &error));
    struct store *const store = opened(f, &plan);
    for (int i = 0; i < 42; i++)
        data[i] = nothing;
    for (uint64_t row = 0; row < 3; row++) {
        stance_trajectory t = {0.1, 6, data, data + 12, NULL, data + 24, data + 36};
        stance_case c;
        int method;
        assert_true(plan_resolve(&plan, row, &c, &method));
        c.trajectory = &t;
        stance_kernel_find(s.scene, stance_methods()[method], NULL)->run(&c, &results[row], 1);
        assert_int_equal(results[row].status, STANCE_DONE);
        assert_true(data[1] == 0.6 && data[36] == 0.6 - c.robot[1]); /* z and the gap at 0 */
        assert_true(store_write_trajectory(store, row, &t, &message));
    }
    store_results(store, (struct rows){.count = 2, .first = 0}, results);
    assert_true(store_verify(store, &(struct rows){.count = 3, .first = 0}, found, &message));
    assert_true(found[0].whole && found[1].whole && !found[2].whole);
    data[41] += 1;
    assert_true(store_write_trajectory(
        store, 2, &(stance_trajectory){0.1, 6, data, data + 12, NULL, data + 24, data + 36},
        &message));
    store_results(store, (struct rows){.count = 1, .first = 2}, &results[2]);
    assert_true(store_verify(store, &(struct rows){.count = 3, .first = 0}, found, &message));
    assert_true(found[2].whole); /* its checksum is of what was written */
    assert_true(store_close(store, &message));
}

TEST(test_origin)
{
    struct fixture *f = *state;
    struct store_origin origin;
    stance_message message;
    FILE *file;
    unlink(f->file);
    assert_true(store_create(f->file, &f->plan, NULL, 3, "here", &message));
    assert_false(store_create(f->file, &f->plan, NULL, 3, "here", &message)); /* ... and stays */
    assert_true(store_read_origin(f->file, &origin, &message));
    assert_string_equal(origin.scenario, f->scenario.text);
    store_origin_free(&origin);
    /* Cut short, or something else altogether. */
    assert_int_equal(truncate(f->file, 3000), 0);
    assert_false(store_read_origin(f->file, &origin, &message));
    assert_non_null(strstr(message.text, f->file));
    file = fopen(f->file, "w");
    fputs("not HDF5", file);
    fclose(file);
    assert_false(store_read_origin(f->file, &origin, &message));
    assert_false(store_read_origin("/nowhere/file.h5", &origin, &message));
    assert_non_null(strstr(message.text, "No such file"));
}

/* A file as it was made passes; a bit of the scenario's text or of an axis does not. */
TEST(test_check)
{
    struct fixture *f = *state;
    stance_message message;
    static char bytes[1 << 21];
    const double value = 1.8; /* of an axis, and of nothing else */
    unlink(f->file);
    assert_true(store_create(f->file, &f->plan, NULL, 1, "here", &message));
    assert_true(store_check(f->file, true, &message));
    FILE *file = fopen(f->file, "r+b");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    char *place = memmem(bytes, size, &value, sizeof value);
    assert_non_null(place);
    fseek(file, place - bytes, SEEK_SET);
    fputc(place[0] ^ 1, file);
    fclose(file);
    for (int resume = 0; resume < 2; resume++) {
        assert_false(store_check(f->file, resume, &message));
        assert_non_null(strstr(message.text, ": damaged: robot.trunk_mass is not as"));
    }
    assert_false(store_check("/nowhere/file.h5", true, &message));
}

/* ---- supervision -------------------------------------------------------------------------- */

static int work_of(void *signal_number)
{
    fputs("said\n", stderr);
    if (*(int *)signal_number)
        raise(*(int *)signal_number);
    return EXIT_CASES_FAILED;
}

/* What a child says comes out, unless it crashes: whoever handles the signal in the parent. */
TEST(test_sandbox)
{
    const struct fixture *f = *state;
    int numbers[] = {0, SIGSEGV, SIGABRT, SIGXCPU};
    char text[200], path[80];
    snprintf(path, sizeof path, "%s.said", f->file);
    for (int k = 0; k < 4; k++) {
        int kept = dup(STDERR_FILENO), file = open(path, O_CREAT | O_TRUNC | O_RDWR, 0600);
        dup2(file, STDERR_FILENO);
        int code = sandbox(work_of, &numbers[k], "FILE");
        fflush(stderr);
        dup2(kept, STDERR_FILENO);
        close(kept);
        text[pread(file, text, sizeof text - 1, 0)] = '\0';
        close(file);
        assert_int_equal(code, k ? EXIT_IO : EXIT_CASES_FAILED);
        assert_string_equal(
            text, k ? "FILE: damaged: the library that reads it cannot cope with it\n" : "said\n");
    }
    unlink(path);
}

/* ---- the lock ----------------------------------------------------------------------------- */

TEST(test_lock)
{
    struct fixture *f = *state;
    struct lock lock, second;
    char found[LOCK_NOTE];
    stance_message message;
    assert_false(lock_is_held(f->file, found));
    assert_true(lock_take(&lock, f->file, false, &message));
    lock_write_note(&lock, "a long note");
    lock_write_note(&lock, "a note");
    assert_true(lock_is_held(f->file, found));
    assert_int_equal(strspn(found, "a note"), strlen(found) - 1); /* blanks and a line's end */
    assert_memory_equal(found, "a note ", 7);
    assert_false(lock_take(&second, f->file, false, &message));
    assert_non_null(strstr(message.text, "another process"));
    /* Its file is removed: it is taken anew, unless another was quicker. */
    unlink(lock.file);
    assert_true(lock_keep(&lock, &message));
    assert_true(lock_is_held(f->file, found));
    unlink(lock.file);
    assert_true(lock_take(&second, f->file, false, &message));
    assert_false(lock_keep(&lock, &message));
    assert_non_null(strstr(message.text, "another process"));
    lock_release(&second);
    assert_false(lock_is_held(f->file, found));
    assert_int_not_equal(access(second.file, F_OK), 0);
    /* The death of its owner releases it. */
    pid_t child = fork();
    if (child == 0) {
        lock_take(&lock, f->file, false, &message);
        _exit(0);
    }
    waitpid(child, NULL, 0);
    assert_int_equal(access(lock.file, F_OK), 0);
    assert_false(lock_is_held(f->file, found));
    assert_true(lock_take(&lock, f->file, false, &message));
    lock_release(&lock);
    assert_false(lock_take(&lock, "/nowhere/file.h5", false, &message));
    assert_non_null(strstr(message.text, "No such file"));
}
