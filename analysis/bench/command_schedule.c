/* command_schedule.c - `stance bench schedule`: how a job far larger than a finished run would go
 * on more ranks than there are here, by the scheduler's own functions on a simulated clock.
 *
 * The machine's figures are round numbers from what is published of systems of this size:
 *   latency        one-sided 8-byte operations take 1.5 to 2.5 us one way on InfiniBand and
 *                  Slingshot through a few switches (OSU micro-benchmarks' osu_fop_latency): 2.5 us
 *   service        a network card does 10^6 and more atomic operations a second on one address;
 *                  Gerstenberger, Besta and Hoefler (SC13, "foMPI") give 2.4 us for a fetch-and-add
 *                  in all: 1.5 us of that are taken as not overlapping with the next one
 *   visit          where the network cannot do it alone, rank 0 serves when its kernel asks whether
 *                  to leave: every thousand steps of a bundle, about a millisecond
 *   write_latency  a small write through a parallel file system's client, waited for: 1 ms
 *   write_rate     50,000 writes a second of all clients together: the lower end of what systems
 *                  with 100 GB/s reach in IO500's ior-hard-write, in writes of 47 kB
 *   bandwidth      100 GB/s
 */
#include "runner/base/command.h"
#include "schedule_picture.h"

#include "analysis/draw/gnuplot.h"
#include "analysis/table/json.h"
#include "runner/base/units.h"
#include "runner/store/results.h"
#include "runner/store/store.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

extern const struct command command_schedule; /* below */

enum { LANES = 8, CHECKSUM_AND_STATUS = 5 };
#define MOST_CASES 1e15

static const struct simulated_machine usual = {
    .latency = 2.5e-6,
    .service = 1.5e-6,
    .visit = 1e-3,
    .write_latency = 1e-3,
    .write_rate = 50e3,
    .bandwidth = 100e9,
};

static const struct {
    const char *name;
    size_t offset;
} figures[] = {
    {"latency", offsetof(struct simulated_machine, latency)},
    {"service", offsetof(struct simulated_machine, service)},
    {"visit", offsetof(struct simulated_machine, visit)},
    {"write_latency", offsetof(struct simulated_machine, write_latency)},
    {"write_rate", offsetof(struct simulated_machine, write_rate)},
    {"bandwidth", offsetof(struct simulated_machine, bandwidth)},
};
enum { FIGURES = sizeof figures / sizeof figures[0] };

/* ---- options ------------------------------------------------------------------------------ */

static bool usage(const char *text, const char *word)
{
    fprintf(stderr, "stance bench schedule: %s %s (stance bench schedule -h explains)\n", text,
            word);
    return false;
}

static bool read_cases(const char *text, struct schedule_study *study)
{
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end || !(value >= 1 && value <= MOST_CASES) || value != floor(value))
        return usage("--cases takes a whole number up to 1e15, not", text);
    study->cases = (uint64_t)value;
    return true;
}

static bool read_ranks(const char *text, struct schedule_study *study)
{
    const char *at = text;
    study->count = 0;
    do {
        char *end;
        const long value = strtol(at, &end, 10);
        if (end == at || value < 1 || value > 1 << 20 || study->count == SCHEDULE_STUDY_MOST ||
            (*end && *end != ','))
            return usage("--ranks takes up to 16 numbers such as 64,1024,16384, not", text);
        study->ranks[study->count++] = (int)value;
        at = *end ? end + 1 : end;
    } while (*at);
    return true;
}

static bool read_figure(const char *text, struct simulated_machine *machine)
{
    const char *equals = strchr(text, '=');
    for (size_t i = 0; equals && i < FIGURES; i++) {
        char *end;
        const double value = strtod(equals + 1, &end);
        if (strlen(figures[i].name) == (size_t)(equals - text) &&
            strncmp(figures[i].name, text, (size_t)(equals - text)) == 0 && end > equals + 1 &&
            !*end && (value > 0 || (value == 0 && i < 4))) {
            memcpy((char *)machine + figures[i].offset, &value, sizeof value);
            return true;
        }
    }
    return usage("--machine takes latency, service, visit, write_latency (s), write_rate (1/s) or "
                 "bandwidth (B/s) with =NUMBER, not",
                 text);
}

/* Bytes and number of the variables that a comma-separated list of answers stands for. */
static bool read_answers(const char *text, struct schedule_study *study)
{
    study->row_size = CHECKSUM_AND_STATUS;
    study->variables = 2;
    study->answers = text;
    for (const char *at = text; *at;) {
        const size_t length = strcspn(at, ",");
        size_t i = 0, n = STANCE_ANSWER_COUNT;
        while (i < n && !(strlen(stance_answers[i].name) == length &&
                          strncmp(stance_answers[i].name, at, length) == 0))
            i++;
        if (i == n)
            return usage("--answers takes names of numbers per case, separated by commas, not", at);
        study->row_size += stance_answers[i].size;
        study->variables++;
        at += length + (at[length] == ',');
    }
    return true;
}

/* ---- costs -------------------------------------------------------------------------------- */

/* Seconds of each case of a finished run: its steps, at what a step took on the mean. */
static bool read_costs(struct schedule_study *study, const struct results *r, struct cost_map *map,
                       stance_message *message)
{
    double *steps = NULL, longest, total, cases, sum = 0;
    size_t ranks;
    const uint64_t inner = r->axes > 0 ? r->axis[r->axes - 1].count : 1;

    if (!results_answer(r, "steps", &steps, message))
        return false;
    for (uint64_t i = 0; steps && i < r->cases; i++)
        sum += steps[i];
    if (!steps || !(sum > 0) || !results_timing(r, &longest, &total, &cases, &ranks) ||
        (uint64_t)cases != r->cases || !(total > 0)) {
        snprintf(message->text, sizeof message->text,
                 "%.150s: not a whole run, in one go, whose answers include steps", r->file);
        free(steps);
        return false;
    }
    study->step_time = total / sum;
    study->case_time = total / (double)r->cases;
    for (uint64_t i = 0; i < r->cases; i++)
        steps[i] *= study->step_time;
    const bool good = cost_map_make(map, steps, r->cases / inner, inner, study->cases);
    if (!good)
        snprintf(message->text, sizeof message->text, "not enough memory");
    free(steps);
    return good;
}

static bool simulate_all(struct schedule_study *study, const struct cost_map *map,
                         stance_message *message)
{
    for (size_t k = 0; k < study->count; k++) {
        const struct simulated_job job = {
            .cases = study->cases,
            .ranks = study->ranks[k],
            .seconds = cost_map_seconds,
            .costs = map,
            .drain = map->longest * LANES, /* a lane's share of the bundle's time is for one case */
            .lanes = LANES,
            .variables = study->variables,
            .row_size = study->row_size,
        };
        if (!simulate(&study->machine, &job, &study->result[k])) {
            snprintf(message->text, sizeof message->text, "not enough memory");
            return false;
        }
    }
    return true;
}

/* ---- output ------------------------------------------------------------------------------- */

static void print_text(const struct schedule_study *study, const struct results *r)
{
    char bytes[32], time[32];
    text_of_bytes(bytes, sizeof bytes, (double)study->cases * (double)study->row_size);
    printf("%s\n%.3g cases like those of %s, %.3g us each (%.3g ns per step of a case),\n"
           "keeping %s: %zu bytes in %d variables, %s in all\n",
           r->title, (double)study->cases, r->file, 1e6 * study->case_time, 1e9 * study->step_time,
           study->answers, study->row_size, study->variables, bytes);
    for (size_t i = 0; i < FIGURES; i++) {
        double value;
        memcpy(&value, (const char *)&study->machine + figures[i].offset, sizeof value);
        printf("%s%s %g", i ? ", " : "machine: ", figures[i].name, value);
    }
    printf("\n  ranks       time  efficiency   lost to: counter    writes   the end     draws     "
           "writes\n");
    for (size_t k = 0; k < study->count; k++) {
        const struct simulation *s = &study->result[k];
        const double all = s->time * study->ranks[k];
        text_of_seconds(time, sizeof time, s->time);
        printf("%7d %10s %9.2f %% %16.3f %% %7.3f %% %7.3f %% %9" PRIu64 " %10" PRIu64 "\n",
               study->ranks[k], time, 100 * simulation_efficiency(s, study->ranks[k]),
               100 * s->drawing / all, 100 * s->writing / all, 100 * s->waiting / all, s->draws,
               s->writes);
    }
    printf("Start-up is not in it: launching the ranks and laying out the file.\n");
    fflush(stdout);
}

static json_t *study_json(const struct schedule_study *study, const struct results *r)
{
    json_t *rows = json_array(), *machine = json_object();
    for (size_t i = 0; i < FIGURES; i++) {
        double value;
        memcpy(&value, (const char *)&study->machine + figures[i].offset, sizeof value);
        json_object_set_new(machine, figures[i].name, results_json_number(value));
    }
    for (size_t k = 0; k < study->count; k++) {
        const struct simulation *s = &study->result[k];
        json_array_append_new(
            rows,
            json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:I}", "ranks", study->ranks[k],
                      "seconds", results_json_number(s->time), "efficiency",
                      results_json_number(simulation_efficiency(s, study->ranks[k])), "computing",
                      results_json_number(s->computing), "drawing", results_json_number(s->drawing),
                      "writing", results_json_number(s->writing), "waiting",
                      results_json_number(s->waiting), "draws", (json_int_t)s->draws, "writes",
                      (json_int_t)s->writes));
    }
    return json_pack("{s:s, s:I, s:o, s:o, s:I, s:i, s:o, s:o}", "file", r->file, "cases",
                     (json_int_t)study->cases, "seconds_per_case",
                     results_json_number(study->case_time), "seconds_per_step",
                     results_json_number(study->step_time), "bytes_per_case",
                     (json_int_t)study->row_size, "variables", study->variables, "machine", machine,
                     "rows", rows);
}

static void put_table(const struct schedule_study *study, FILE *out)
{
    fputs("ranks,cases,seconds,efficiency,computing_seconds,drawing_seconds,writing_seconds,"
          "waiting_seconds,draws,writes,bytes\n",
          out);
    for (size_t k = 0; k < study->count; k++) {
        const struct simulation *s = &study->result[k];
        fprintf(out, "%d,%" PRIu64 ",%.9g,%.6f,%.9g,%.9g,%.9g,%.9g,%" PRIu64 ",%" PRIu64 ",%.0f\n",
                study->ranks[k], s->cases, s->time, simulation_efficiency(s, study->ranks[k]),
                s->computing, s->drawing, s->writing, s->waiting, s->draws, s->writes, s->bytes);
    }
}

static bool write_table(const struct schedule_study *study, const char *directory,
                        stance_message *message)
{
    char path[1100];
    snprintf(path, sizeof path, "%s/schedule.csv", directory);
    FILE *out = fopen(path, "w");
    bool good = false;
    if (out) {
        put_table(study, out);
        good = !ferror(out);
        good = fclose(out) == 0 && good;
    }
    if (good)
        printf("%s\n", path);
    else
        snprintf(message->text, sizeof message->text, "%.150s: %s", path, strerror(errno));
    return good;
}

/* ---- the command -------------------------------------------------------------------------- */

static bool report(struct schedule_study *study, const struct results *r, const char *directory,
                   bool json, stance_message *message)
{
    struct cost_map map = {0};
    bool good = read_costs(study, r, &map, message) && simulate_all(study, &map, message);
    if (good && json) {
        json_t *object = study_json(study, r);
        good = json_dumpf(object, stdout, JSON_INDENT(2)) == 0;
        putchar('\n');
        json_decref(object);
    } else if (good) {
        print_text(study, r);
        good = write_table(study, directory, message) &&
               schedule_picture(study, directory, "schedule", message);
    }
    cost_map_free(&map);
    return good;
}

static bool make_directory(const char *path)
{
    if (mkdir(path, 0777) == 0 || errno == EEXIST)
        return true;
    fprintf(stderr, "%s: %s\n", path, strerror(errno));
    return false;
}

static int run(int argc, char **argv)
{
    const char *file, *directory = "results/schedule", *cases = "1e10";
    const char *ranks = "16,64,256,1024,4096,16384,65536";
    const char *answers = "outcome,failure,end_time,friction_used", *machine[FIGURES * 2];
    size_t given[6] = {0}, operands;
    struct schedule_study study = {.machine = usual};
    struct results r;
    stance_message message = {""};
    bool help;
    const struct option_spec specs[] = {
        {"--cases", true, &cases, 1, &given[0]},
        {"--ranks", true, &ranks, 1, &given[1]},
        {"--answers", true, &answers, 1, &given[2]},
        {"-o", true, &directory, 1, &given[3]},
        {"--json", false, NULL, 0, &given[4]},
        {"--machine", true, machine, sizeof machine / sizeof machine[0], &given[5]},
    };
    if (!command_options(&command_schedule, argc, argv, specs, sizeof specs / sizeof specs[0],
                         &file, 1, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (operands == 0) {
        usage("a results file must be given, such as", "results/basin_one_foot.h5");
        return EXIT_USAGE;
    }
    bool good =
        read_cases(cases, &study) && read_ranks(ranks, &study) && read_answers(answers, &study);
    for (size_t i = 0; good && i < given[5]; i++)
        good = read_figure(machine[i], &study.machine);
    if (!good)
        return EXIT_USAGE;
    if (!given[4] && ((!given[3] && !make_directory("results")) || !make_directory(directory)))
        return EXIT_IO;
    if (!results_open(&r, file, &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    good = report(&study, &r, directory, given[4] > 0, &message);
    results_close(&r);
    if (!good)
        fprintf(stderr, "%s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}

const struct command command_schedule = {
    "bench schedule",
    "bench schedule FILE [--cases N] [--ranks N,N,...] [--answers NAME,NAME,...]\n"
    "           [--machine FIGURE=NUMBER]... [-o DIR] [--json]",
    "how a job of any size would go on thousands of ranks, simulated",
    run,
    "Takes what the cases of a finished run cost, spreads those costs over a job of N cases "
    "(default\n"
    "1e10) in the same order, and plays the run's own schedule (chunks of a shared counter, "
    "blocks\n"
    "of rows written whole) on a simulated clock. Efficiency is the share of the ranks' time in\n"
    "which they compute; the rest is lost to the counter, to writes, and at the end, when nothing\n"
    "is left to draw. Start-up is not part of it.\n"
    "\n"
    "  --cases N          size of the job\n"
    "  --ranks N,N,...    default 16,64,256,1024,4096,16384,65536\n"
    "  --answers LIST     what is kept of a case beside checksum and status, as record.answers;\n"
    "                     default outcome,failure,end_time,friction_used\n"
    "  --machine FIGURE=NUMBER   latency (s, to the counter; 2.5e-6), service (s per draw, one\n"
    "                     after the other; 1.5e-6), visit (s between times at which rank 0 serves\n"
    "                     the counter, 0: the network does it; 1e-3), write_latency (s; 1e-3),\n"
    "                     write_rate (1/s, all ranks; 5e4), bandwidth (B/s, all ranks; 1e11)\n"
    "  -o DIR             where schedule.csv and the picture go, default results/schedule\n"
    "  --json             file, cases, seconds_per_case, seconds_per_step, bytes_per_case,\n"
    "                     variables, machine, and rows of ranks, seconds, efficiency; computing,\n"
    "                     drawing, writing, waiting (s, summed over the ranks), draws, writes\n",
};
