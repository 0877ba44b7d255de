/* test_analysis.c - statistics, reading of results, summary, comparison and pictures, against files
 * that make_sample_results.py makes from formulas. */
#include "scratch.h"
#include "support.h"

#include "analysis/draw/gnuplot.h"
#include "analysis/draw/plot.h"
#include "runner/base/command.h"
#include "runner/store/compare.h"

#include <fcntl.h>

extern const struct command command_summary, command_compare, command_plot;

/* ---- files and commands ------------------------------------------------------------------- */

static char output[1 << 18], errors[1 << 14]; /* of the last command */

static const char *sample(const char *name)
{
    static char paths[4][400];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, 400, "%s/%s.h5", scratch, name);
    return path;
}

static int make_samples(void **state)
{
    char command[700];
    const char *python = getenv("PYTHON");
    if (scratch_make(state) != 0)
        return -1;
    snprintf(command, sizeof command, "%s tests/make_sample_results.py %s",
             python ? python : "/usr/bin/python3", scratch);
    return system(command);
}

static CMFixtureFunction before_tests = make_samples, after_tests = scratch_remove;

static void read_back(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

/* Runs a command with what it prints going to `output` and `errors`; its exit code. */
static int run_command(const struct command *command, const char *a, const char *b, const char *c,
                       const char *d)
{
    char *argv[] = {(char *)command->name, (char *)a, (char *)b, (char *)c, (char *)d, NULL};
    char out[300], err[300];
    int argc = 1, kept[2] = {dup(1), dup(2)};
    while (argv[argc])
        argc++;
    snprintf(out, sizeof out, "%s/stdout", scratch);
    snprintf(err, sizeof err, "%s/stderr", scratch);
    fflush(stdout);
    fflush(stderr);
    int files[2] = {open(out, O_CREAT | O_TRUNC | O_WRONLY, 0600),
                    open(err, O_CREAT | O_TRUNC | O_WRONLY, 0600)};
    for (int k = 0; k < 2; k++)
        dup2(files[k], k + 1);
    int code = command->run(argc, argv);
    fflush(stdout);
    fflush(stderr);
    for (int k = 0; k < 2; k++) {
        dup2(kept[k], k + 1);
        close(kept[k]);
        close(files[k]);
    }
    read_back(out, output, sizeof output);
    read_back(err, errors, sizeof errors);
    return code;
}

static void assert_contains(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("'%s' is not in\n%s", part, text);
}

static void assert_one_line(const char *text)
{
    const char *end = strchr(text, '\n');
    if (!end || end == text || end[1] != '\0')
        fail_msg("not one line: '%s'", text);
}

/* Runs a command on a sample with up to two arguments more: its exit code, and what stands in the
 * output, or after '!' does not, or after '^' stands in the errors. */
static void says(const struct command *command, int code, const char *name, const char *b,
                 const char *c, const char *const *text)
{
    assert_int_equal(run_command(command, sample(name), b, c, NULL), code);
    for (; *text; text++) {
        const char *const part = *text + (**text == '!' || **text == '^');
        if (**text != '!')
            assert_contains(**text == '^' ? errors : output, part);
        else if (strstr(output, part))
            fail_msg("'%s' is in\n%s", part, output);
    }
}
#define SAYS(command, code, name, b, c, ...)                                                       \
    says(&command_##command, code, name, b, c, (const char *const[]){__VA_ARGS__, NULL})

static void assert_near(double found, double wanted, double tolerance)
{
    if (!(fabs(found - wanted) <= tolerance))
        fail_msg("%.17g is not %.17g +- %g", found, wanted, tolerance);
}

#define RESULTS FREED(results_close) struct results
static void open_sample(struct results *r, const char *name)
{
    stance_message message = {""};
    if (!results_open(r, sample(name), &message))
        fail_msg("%s", message.text);
}

/* The formula behind the maps, as the sample script computes it. */
static double level(double theta, double rate, double scale)
{
    return pow(scale * theta / 0.05, 2) + pow(scale * rate / 0.4, 2);
}

/* ---- statistics --------------------------------------------------------------------------- */

/* The ends of Wilson's interval solve (k/n - p)^2 = z^2 p (1 - p) / n. */
TEST(test_wilson)
{
    static const uint64_t counts[][2] = {{1, 10}, {5, 10}, {9, 10}, {30, 1000}, {65535, 65536}};
    static const double z = 1.959963984540054;
    double end[2];
    for (size_t i = 0; i < COUNT(counts); i++) {
        double n = (double)counts[i][1], share = (double)counts[i][0] / n;
        statistics_wilson_of(z, share, n, &end[0], &end[1]);
        assert_true(0 < end[0] && end[0] < share && share < end[1] && end[1] < 1);
        for (int k = 0; k < 2; k++)
            assert_near(pow(share - end[k], 2), z * z * end[k] * (1 - end[k]) / n, 1e-15);
    }
    /* None of n: up to z^2 / (n + z^2), exactly from 0. */
    statistics_wilson_of(z, 0, 10, &end[0], &end[1]);
    assert_true(end[0] == 0);
    assert_near(end[1], z * z / (10 + z * z), 1e-15);
    statistics_wilson_of(z, 1, 10, &end[0], &end[1]);
    assert_true(end[1] == 1);
    assert_near(statistics_deviations(0.95), z, 1e-14);
}

TEST(test_quantiles)
{
    double values[] = {5, NAN, 1, 4, 2, 3, NAN}, none[] = {NAN, NAN};
    double infinite[] = {1, 2, INFINITY};
    struct statistics_numbers numbers;
    statistics_summarise(values, 7, &numbers);
    assert_int_equal(numbers.n, 5);
    assert_true(numbers.low == 1 && numbers.median == 3 && numbers.high == 5 && numbers.sum == 15);
    assert_near(numbers.q90, 4.6, 1e-15);
    assert_near(numbers.q99, 4.96, 1e-15);
    statistics_summarise(none, 2, &numbers);
    assert_true(numbers.n == 0 && isnan(numbers.median));
    statistics_summarise(infinite, 3, &numbers);
    assert_true(numbers.median == 2 && isinf(numbers.high));
}

/* ---- reading ------------------------------------------------------------------------------ */

TEST(test_reading)
{
    struct results r;
    stance_message message;
    double *settle, *missing;
    size_t point[SCENARIO_MAX_AXES], stabilised = 0;
    open_sample(&r, "basin");
    assert_int_equal(r.axes, 2);
    assert_int_equal(r.cases, 41 * 31);
    assert_string_equal(r.name, "basin");
    assert_string_equal(r.axis[1].name, "initial.offset.vtheta");
    assert_string_equal(r.axis[1].unit, "rad/s");
    assert_true(r.axis[0].offset && !r.single);
    assert_true(results_answer(&r, "settle_time", &settle, &message));
    assert_true(results_answer(&r, "no_such_answer", &missing, &message));
    assert_null(missing);
    for (uint64_t i = 0; i < r.cases; i++) {
        results_point(&r, i, point);
        double l = level(r.axis[0].value[point[0]], r.axis[1].value[point[1]], 1);
        if (fabs(l - 1) < 1e-9) /* on the edge: either */
            continue;
        assert_int_equal(r.kind[i], l < 1 ? RESULTS_STABILISED : RESULTS_FELL);
        if (l < 1)
            assert_near(settle[i], 1 + l, 1e-12);
        else
            assert_true(isnan(settle[i]));
        stabilised += r.kind[i] == RESULTS_STABILISED;
    }
    assert_true(stabilised > 250);
    free(settle);
    results_close(&r);
}

TEST(test_pending_and_failed)
{
    RESULTS r;
    struct statistics_counts counts;
    stance_message message;
    OWN double *end;
    open_sample(&r, "partial");
    statistics_count(&r, -1, 0, &counts);
    assert_int_equal(counts.kind[RESULTS_PENDING], 18);
    assert_int_equal(counts.kind[RESULTS_FAILED], 2);
    assert_int_equal(counts.done, 40);
    assert_int_equal(r.failure[2 * 6 + 1], STANCE_FAILURE_NEWTON);
    assert_true(results_answer(&r, "end_time", &end, &message));
    for (uint64_t i = 0; i < r.cases; i++) /* rubbish and failures never count as numbers */
        assert_int_equal(isnan(end[i]),
                         r.kind[i] == RESULTS_PENDING || r.kind[i] == RESULTS_FAILED);
}

TEST(test_trajectory)
{
    RESULTS r;
    struct results_trajectory t;
    stance_message message;
    OWN uint64_t *list;
    size_t count;
    open_sample(&r, "only");
    assert_true(r.single);
    assert_int_equal(r.index, 17);
    assert_true(results_recorded(&r, &list, &count, &message));
    assert_int_equal(count, 1);
    assert_int_equal(list[0], 17);
    assert_true(results_trajectory(&r, 0, 17, &t, &message));
    assert_int_equal(t.rows, 81); /* 0.8 s in steps of 0.01 s, both ends; then NAN */
    assert_string_equal(t.coordinate[2], "theta");
    assert_string_equal(t.contact[1], "foot2");
    for (size_t k = 0; k < t.rows; k++)
        assert_near(t.position[k * 5 + 2], -0.41 + 0.1 * exp(-t.time[k]), 1e-14);
    results_trajectory_free(&t);
    assert_false(results_trajectory(&r, 5, 17, &t, &message));
}

/* Six digits, and more only where neighbours are nearer than that; letters whole or '?'. */
TEST(test_texts)
{
    double values[] = {-0.026086956521739119, 1, 1.0000001, 1.0000002, 2e9};
    struct results_axis axis = {.unit = "rad", .count = 5, .value = values};
    static const char *const wanted[] = {"-0.026087 rad", "1 rad", "1.0000001 rad", "1.0000002 rad",
                                         "2e+09 rad"};
    char text[64] = "\xc3\xa9\tb\xff\xe2\x82";
    results_clean(text);
    assert_string_equal(text, "\xc3\xa9 b???");
    for (size_t i = 0; i < 5; i++) {
        results_value_text(&axis, i, true, text, sizeof text);
        assert_string_equal(text, wanted[i]);
    }
    axis.count = 1;
    results_value_text(&axis, 0, false, text, sizeof text);
    assert_string_equal(text, "-0.026087");
}

/* ---- extents and shares ------------------------------------------------------------------- */

/* The ellipse crosses the axes at 0.05 rad and 0.4 rad/s: the extent ends within half a cell. */
TEST(test_extents)
{
    const size_t origin[SCENARIO_MAX_AXES] = {0};
    struct statistics_extent extent;
    RESULTS r;
    open_sample(&r, "basin");
    assert_true(statistics_extent(&r, 0, origin, &extent) && extent.any);
    assert_near(extent.low, -0.05, 0.5 * 0.005 + 1e-12);
    assert_near(extent.high, 0.05, 0.5 * 0.005 + 1e-12);
    assert_false(extent.low_open || extent.high_open || extent.low_unknown);
    assert_true(statistics_extent(&r, 1, origin, &extent) && extent.any);
    assert_near(extent.high, 0.4, 0.5 * 0.04 + 1e-12);
    assert_true(fabs(r.axis[0].value[extent.point[0]]) < 1e-12);
    results_close(&r);

    open_sample(&r, "nothing"); /* all of it stabilised: to both ends of the axis */
    assert_true(statistics_extent(&r, 0, origin, &extent) && extent.any);
    assert_true(extent.low_open && extent.high_open);
    assert_near(extent.low, -0.1, 1e-15);
    assert_near(extent.high, 0.1, 1e-15);
    results_close(&r);

    open_sample(&r, "partial"); /* theta >= 0.05 is pending, (-0.05, -0.12) failed */
    assert_true(statistics_extent(&r, 0, origin, &extent) && extent.any);
    assert_true(extent.high_unknown && extent.low_unknown);
    assert_near(extent.high, 0.04, 1e-12);
    results_close(&r);

    open_sample(&r, "unfinished"); /* the case where they begin is pending, then failed */
    for (int k = 0; k < 2; k++) {
        assert_true(statistics_extent(&r, 0, origin, &extent) && !extent.any);
        assert_true(extent.high_unknown && extent.low_unknown && isnan(extent.low));
        assert_int_equal(extent.kind, k ? RESULTS_FAILED : RESULTS_PENDING);
        r.kind[4 * 6 + 2] = RESULTS_FAILED;
    }
    r.kind[4 * 6 + 2] = RESULTS_FELL;
    assert_true(statistics_extent(&r, 0, origin, &extent) && !extent.any && !extent.low_unknown);
    results_close(&r);

    open_sample(&r, "line"); /* not an axis of offsets */
    assert_false(statistics_extent(&r, 0, origin, &extent));
}

static json_t *summary_of(const char *name)
{
    json_error_t error;
    assert_int_equal(run_command(&command_summary, sample(name), "--json", NULL, NULL), EXIT_DONE);
    json_t *root = json_loads(output, 0, &error);
    if (!root)
        fail_msg("%s: line %d: %s", name, error.line, error.text);
    return root;
}

static double number_at(const json_t *root, const char *a, const char *b, const char *c)
{
    const json_t *at = json_object_get(root, a);
    at = b ? json_object_get(at, b) : at;
    at = c ? json_object_get(at, c) : at;
    assert_true(json_is_number(at));
    return json_number_value(at);
}

TEST(test_parameter)
{
    static const double scales[] = {100, 3, 2, 1, 1};
    JSON *root = summary_of("friction");
    const json_t *const parameters = json_object_get(root, "parameters"),
                        *const parameter = json_array_get(parameters, 0),
                        *const values = json_object_get(parameter, "values");
    assert_int_equal(json_array_size(parameters), 1); /* the other axes are offsets */
    assert_int_equal(json_array_size(values), 5);
    for (size_t f = 0; f < 5; f++) {
        double inside = 0, edge = 0;
        for (int i = 0; i < 21; i++)
            for (int j = 0; j < 11; j++) {
                double l = level(-0.1 + 0.01 * i, -0.6 + 0.12 * j, scales[f]);
                inside += l < 1 - 1e-9;
                edge += fabs(l - 1) <= 1e-9;
            }
        const json_t *const value = json_array_get(values, f);
        const double found = number_at(value, "stabilised", NULL, NULL);
        assert_true(inside <= found && found <= inside + edge);
        assert_true(number_at(value, "done", NULL, NULL) == 231);
    }
    /* from scale 2 to scale 1 */
    const json_t *const third = json_array_get(values, 2);
    assert_true(number_at(parameter, "steepest", "from", NULL) ==
                number_at(third, "value", NULL, NULL));
}

/* ---- the commands ------------------------------------------------------------------------- */

TEST(test_summary_text)
{
    SAYS(summary, EXIT_DONE, "partial", NULL, NULL, "Half done\n", "Outcomes of the 40 cases done",
         "not computed yet", "newton: ", "contact: ", "torque_limit 10 N m");
    assert_string_equal(errors, "");
    SAYS(summary, EXIT_DONE, "line", NULL, NULL,
         "between 0.01 s (stabilised) and 0.0177828 s (fell)");
    SAYS(summary, EXIT_DONE, "only", NULL, NULL, "Outcome: fell", "offset.vtheta 0.08 rad/s");
    SAYS(summary, EXIT_DONE, "sparse", NULL, NULL, "not stored in this file", "!nan");
    SAYS(summary, EXIT_DONE, "unfinished", NULL, NULL,
         "theta  unknown: the case nearest to the equilibrium (-0.01 rad) is not computed yet",
         "!stabilised,");
    SAYS(summary, EXIT_DONE, "unlucky", NULL, NULL, "?                         ?\n");
}

TEST(test_summary_json)
{
    static const char *const names[] = {"friction", "line",   "methods", "one",  "nothing",
                                        "sparse",   "single", "bare",    "title"};
    JSON *root = summary_of("basin");
    assert_true(number_at(root, "cases", "total", NULL) == 1271);
    double stabilised = number_at(root, "outcomes", "stabilised", "count");
    assert_true(number_at(root, "outcomes", "stabilised", "share") == stabilised / 1271);
    /* A grid is no sample. */
    assert_true(json_is_null(
        json_object_get(json_object_get(json_object_get(root, "outcomes"), "stabilised"), "high")));
    assert_near(number_at(root, "cost", "cases_per_second", NULL), 250.0 / 3, 1e-12);
    assert_near(number_at(root, "cost", "iterations_per_step", NULL), 2.5, 1e-12);
    assert_near(number_at(root, "numbers", "max_penetration", "largest"), 1.271e-6, 1e-18);
    assert_true(number_at(root, "fixed", "controller.torque_limit", NULL) == 10);
    const json_t *extents = json_object_get(root, "extents");
    assert_int_equal(json_array_size(extents), 2);
    json_decref(root);
    root = summary_of("unfinished");
    const json_t *extent = json_array_get(json_object_get(root, "extents"), 0);
    assert_true(json_is_null(json_object_get(extent, "stabilised")));
    assert_true(json_is_true(json_object_get(extent, "low_unknown")));
    assert_string_equal(json_string_value(json_object_get(extent, "outcome")), "pending");
    json_decref(root);
    for (size_t i = 0; i < COUNT(names); i++)
        json_decref(summary_of(names[i]));
    root = summary_of("only");
    assert_true(number_at(root, "case", "index", NULL) == 17);
    assert_near(number_at(root, "case", "final_state", "theta"), -0.41, 0);
    assert_true(json_is_null(json_object_get(json_object_get(root, "case"), "settle_time")));
}

/* Without a controller the share is that of cases at rest, and what the scene lacks is not told. */
TEST(test_summary_of_a_plain_scene)
{
    SAYS(summary, EXIT_DONE, "ball", NULL, NULL, "Rested against ground.restitution",
         "!Stabilised against", "!fall_height", "tolerance 1e-08 m, rad",
         "initial: the initial state or the controller does not exist",
         "\nLargest residuals: Signorini 4e-12 m/s, energy gained 3e-09 J\n",
         "2.7 evaluations per step", "events, changes of contact mode: 14, in 3 of the cases");
    assert_string_equal(errors, "");
    JSON *root = summary_of("ball");
    assert_true(number_at(root, "failures", "initial", NULL) == 1);
    assert_true(number_at(root, "cost", "events", NULL) == 14);
    assert_true(number_at(root, "cost", "events_cases", NULL) == 3);
    assert_near(number_at(root, "numbers", "energy_gain", "largest"), 3e-9, 0);
    assert_true(number_at(root, "numbers", "settle_time", "count") == 0);
    const json_t *parameter = json_array_get(json_object_get(root, "parameters"), 0);
    assert_string_equal(json_string_value(json_object_get(parameter, "share_of")), "rested");
    const json_t *first = json_array_get(json_object_get(parameter, "values"), 0);
    assert_true(number_at(first, "rested", NULL, NULL) == 1);
    assert_true(number_at(first, "share", NULL, NULL) == 1);
    /* Files of before know nothing of residuals and events. */
    SAYS(summary, EXIT_DONE, "basin", NULL, NULL, "!residual", "!events");
}

TEST(test_compare)
{
    SAYS(compare, EXIT_DONE, "basin", sample("basin"), NULL, "identical\n");
    /* One number in its last bits; host and timing do not count. */
    SAYS(compare, EXIT_CASES_FAILED, "basin", sample("changed"), NULL,
         "end_time: 1 of 1271 cases differ", "case 97 (initial.offset.theta = -0.085 rad, ",
         "!hosts", "!timing");
    /* Pending rows hold anything. */
    SAYS(compare, EXIT_DONE, "partial", sample("rubbish"), NULL, "identical");
    SAYS(compare, EXIT_CASES_FAILED, "single", sample("bare"), NULL,
         "trajectory: only in the first file");
    SAYS(compare, EXIT_CASES_FAILED, "basin", sample("bytes"), NULL,
         "attribute title: 'An ellipse' | 'An ?ellipse'\n");
    SAYS(compare, EXIT_CASES_FAILED, "bytes", sample("basin"), "--json", "'An ?ellipse'");
    SAYS(summary, EXIT_DONE, "bytes", NULL, NULL, "An ?ellipse\n");
    assert_true(strncmp(output, "An ?ellipse\n", 12) == 0);
    SAYS(compare, EXIT_CASES_FAILED, "basin", sample("changed"), "--json", "differences");
    JSON *root = json_loads(output, 0, NULL);
    assert_non_null(root);
    assert_true(json_is_false(json_object_get(root, "identical")));
    /* The first is the checksum of that case. */
    const json_t *difference = json_array_get(json_object_get(root, "differences"), 1);
    assert_string_equal(json_string_value(json_object_get(difference, "name")), "end_time");
    assert_true(number_at(difference, "differing", NULL, NULL) == 1);
}

/* ---- bad files ---------------------------------------------------------------------------- */

static void expect_bad(const char *path)
{
    const struct command *const commands[] = {&command_summary, &command_plot};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(run_command(commands[k], path, NULL, NULL, NULL), EXIT_IO);
        assert_string_equal(output, "");
        assert_one_line(errors);
    }
    assert_int_equal(run_command(&command_compare, sample("basin"), path, NULL, NULL), EXIT_IO);
    assert_one_line(errors);
}

TEST(test_foreign_files)
{
    expect_bad(sample("foreign"));
    expect_bad(sample("no_such_file"));
    expect_bad("tests/test_analysis.c");
    expect_bad(scratch);
    expect_bad("/dev/null");
    assert_int_equal(run_command(&command_summary, NULL, NULL, NULL, NULL), EXIT_USAGE);
    assert_int_equal(run_command(&command_compare, sample("basin"), NULL, NULL, NULL), EXIT_USAGE);
    assert_int_equal(run_command(&command_plot, sample("single"), "--case", "x", NULL), EXIT_USAGE);
}

static size_t load(const char *path, char **bytes)
{
    struct stat information;
    assert_int_equal(stat(path, &information), 0);
    FILE *file = fopen(path, "rb");
    *bytes = malloc((size_t)information.st_size + 1);
    assert_non_null(file);
    assert_non_null(*bytes);
    size_t size = fread(*bytes, 1, (size_t)information.st_size, file);
    (*bytes)[size] = '\0';
    fclose(file);
    return size;
}

static void save(const char *path, const char *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* Cut short or with bytes changed: a summary or one line, never a crash. */
TEST(test_damaged_files)
{
    char *bytes, *copy, path[400];
    size_t size = load(sample("partial"), &bytes);
    uint64_t random = 1;
    copy = room(size);
    snprintf(path, sizeof path, "%s", sample("damaged"));
    for (int k = 0; k < 60; k++) {
        memcpy(copy, bytes, size);
        size_t length = size;
        if (k % 3 == 0)
            length = (size_t)uniform(&random, 0, (double)size);
        for (int i = 0; k % 3 && i < 6 * (k % 3) - 5; i++)
            copy[(size_t)uniform(&random, 0, (double)size)] = (char)uniform(&random, 0, 256);
        save(path, copy, length);
        int code = run_command(&command_summary, path, NULL, NULL, NULL);
        if (code == EXIT_IO)
            assert_one_line(errors);
        else
            assert_int_equal(code, EXIT_DONE);
        assert_true(k % 3 || code == EXIT_IO);
    }
    free(bytes);
    free(copy);
}

/* ---- pictures ----------------------------------------------------------------------------- */

static void expect_picture(const char *directory, const char *name)
{
    char path[700], *bytes;
    snprintf(path, sizeof path, "%s/%s.svg", directory, name);
    assert_contains(output, path);
    size_t size = load(path, &bytes);
    assert_true(size > 2000 && strncmp(bytes, "<?xml", 5) == 0 && strstr(bytes, "</svg>"));
    free(bytes);
    snprintf(path, sizeof path, "%s/%s.png", directory, name);
    assert_contains(output, path);
    size = load(path, &bytes);
    assert_true(size > 2000 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0);
    free(bytes);
}

static void expect_plot(const char *name, const char *directory)
{
    if (run_command(&command_plot, sample(name), "-o", directory, NULL) != EXIT_DONE)
        fail_msg("%s: %s", name, errors);
}

TEST(test_pictures)
{
    static const char *const maps[] = {"basin", "partial", "friction", "methods", "one", "title"};
    static const char *const curves[] = {"friction", "methods", "line"};
    static const char *const cases[] = {"coordinates", "forces", "torques", "gaps", "strip"};
    char directory[400], name[64];
    snprintf(directory, sizeof directory, "%s/it's a \"place\"", scratch);
    for (size_t i = 0; i < COUNT(maps); i++) {
        expect_plot(maps[i], directory);
        snprintf(name, sizeof name, "%s-map", maps[i]);
        expect_picture(directory, name);
        snprintf(name, sizeof name, "%s-settle_time", maps[i]);
        expect_picture(directory, name);
    }
    for (size_t i = 0; i < COUNT(curves); i++) {
        expect_plot(curves[i], directory);
        snprintf(name, sizeof name, "%s-curve", curves[i]);
        expect_picture(directory, name);
    }
    expect_plot("single", directory);
    for (size_t i = 0; i < COUNT(cases); i++) {
        snprintf(name, sizeof name, "single-%s", cases[i]);
        expect_picture(directory, name);
    }
    expect_plot("nothing", directory); /* no times: a map alone, and a word about it */
    expect_picture(directory, "nothing-map");
    assert_null(strstr(output, "settle_time"));
    assert_one_line(errors);
}

/* A title reaches the picture as it is; nothing in it is run. */
TEST(test_title)
{
    char path[400], *bytes;
    expect_plot("title", scratch);
    snprintf(path, sizeof path, "%s/title-map.svg", scratch);
    load(path, &bytes);
    assert_contains(bytes, "a_b^{c} \\n `touch pwned` @x $y {/*3 z} \xce\xb8");
    assert_contains(bytes, "&lt;b> &amp; ");
    free(bytes);
    assert_int_not_equal(access("pwned", F_OK), 0);
}

TEST(test_text)
{
    char text[200], path[400];
    snprintf(path, sizeof path, "%s/text", scratch);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    gnuplot_quote(file, "it's\ta\nbyte \xff \xc3\xa9");
    fclose(file);
    read_back(path, text, sizeof text);
    assert_string_equal(text, "'it''s a byte ? \xc3\xa9'");
}

/* The data that are kept: every cell has the kind and the time of its case, at its place. */
TEST(test_cells)
{
    char path[480], kept[400], *bytes;
    RESULTS r;
    snprintf(kept, sizeof kept, "%s/kept", scratch);
    mkdir(kept, 0700);
    setenv("STANCE_SCRIPTS", kept, 1);
    int code = run_command(&command_plot, sample("basin"), "-o", scratch, NULL);
    unsetenv("STANCE_SCRIPTS");
    assert_int_equal(code, EXIT_DONE);

    open_sample(&r, "basin");
    snprintf(path, sizeof path, "%s/basin-map/cells1", kept);
    assert_int_equal(load(path, &bytes), 41 * 31);
    for (int j = 0; j < 31; j++)
        for (int i = 0; i < 41; i++)
            assert_int_equal(bytes[j * 41 + i], r.kind[i * 31 + j]);
    free(bytes);
    snprintf(path, sizeof path, "%s/basin-settle_time/cells1", kept);
    assert_int_equal(load(path, &bytes), 41 * 31 * 8);
    for (int j = 0; j < 31; j++)
        for (int i = 0; i < 41; i++) {
            double time, l = level(-0.1 + 0.005 * i, -0.6 + 0.04 * j, 1);
            memcpy(&time, bytes + 8 * (j * 41 + i), 8);
            if (fabs(l - 1) > 1e-9)
                assert_true(l < 1 ? fabs(time - 1 - l) < 1e-12 : isnan(time));
        }
    free(bytes);
    /* The map spans the outer edges of the cells. */
    snprintf(path, sizeof path, "%s/basin-map/data.gp", kept);
    load(path, &bytes);
    double low, high;
    const char *range = strstr(bytes, "x_low = ");
    assert_non_null(range);
    assert_int_equal(sscanf(range, "x_low = %lf x_high = %lf", &low, &high), 2);
    assert_near(low, -0.1025, 1e-12);
    assert_near(high, 0.1025, 1e-12);
    free(bytes);
}

TEST(test_plot_errors)
{
    char old[4000];
    snprintf(old, sizeof old, "%s", getenv("PATH"));
    setenv("PATH", "/nowhere", 1);
    int code = run_command(&command_plot, sample("basin"), "-o", scratch, NULL);
    setenv("PATH", old, 1);
    assert_int_equal(code, EXIT_IO);
    assert_one_line(errors);
    assert_contains(errors, "gnuplot-nox");
    SAYS(plot, EXIT_IO, "basin", "-o", "/dev/null/x", "^/dev/null/x");
    assert_one_line(errors);
    SAYS(plot, EXIT_IO, "basin", "-o", sample("one"), "^one.h5");
    assert_one_line(errors);
    SAYS(plot, EXIT_USAGE, "bare", NULL, NULL, "^stance replay");
    SAYS(plot, EXIT_USAGE, "basin", "--case", "99999", "^99999");
    assert_one_line(errors);
    SAYS(plot, EXIT_USAGE, "basin", "--case", "5", "^--case 5");
}

/* ---- scales ------------------------------------------------------------------------------- */

static struct results_axis axis_of(double *values, size_t n)
{
    return (struct results_axis){.name = "ground.friction", .count = n, .value = values};
}

TEST(test_scales)
{
    double even[] = {0.3, 0.2, 0.1}, decades[] = {0.01, 0.1, 1, 10}, odd[] = {1, 2, 4, 5},
           one[] = {7};
    struct plot_axis along;
    struct results_axis axis = axis_of(even, 3);
    plot_axis_make(&along, &axis);
    assert_int_equal(along.scale, PLOT_LINEAR);
    assert_true(along.falling);
    assert_int_equal(plot_axis_index(&along, 0), 2); /* the lowest cell is the last value */
    assert_near(along.range.low, 0.05, 1e-15);
    assert_near(along.range.high, 0.35, 1e-15);
    axis = axis_of(decades, 4);
    plot_axis_make(&along, &axis);
    assert_int_equal(along.scale, PLOT_LOG);
    assert_near(along.range.low, -2.5, 1e-12);
    axis = axis_of(odd, 4);
    plot_axis_make(&along, &axis);
    assert_int_equal(along.scale, PLOT_LIST);
    plot_axis_make_curve(&along, &axis);
    assert_int_equal(along.scale, PLOT_LINEAR);
    axis = axis_of(one, 1);
    plot_axis_make(&along, &axis);
    assert_int_equal(along.scale, PLOT_LIST);
}
