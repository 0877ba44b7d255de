/* command_status.c - `stance status`: how far a run is, seen from another process. */
#include "command.h"
#include "lock.h"
#include "report.h"
#include "store.h"
#include "supervise.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

struct state {
    struct store_counts counts;
    bool running;
    bool refined; /* a map whose boundary is being sought: the cases left are not all simulated */
    double rate, left; /* cases/s and s; negative: unknown */
};

static double wall_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool is_refined(const char *file)
{
    struct store_origin origin;
    stance_message ignored;
    struct scenario *s = calloc(1, sizeof *s);
    FILE *nowhere = fopen("/dev/null", "w");
    bool refined = false;

    if (s && nowhere && store_read_origin(file, &origin, &ignored)) {
        if (scenario_read(s, file, origin.scenario, NULL, 0, nowhere)) {
            refined = s->refine.given;
            scenario_free(s);
        }
        store_origin_free(&origin);
    }
    if (nowhere) {
        fclose(nowhere);
    }
    free(s);
    return refined;
}

static bool read_state(const char *file, struct state *state, stance_message *message)
{
    struct lock_note note;
    *state = (struct state){.running = lock_is_held(file, &note), .rate = -1, .left = -1};
    if (!store_count(file, &state->counts, message) || !store_check(file, false, message)) {
        return false;
    }
    uint64_t finished = state->counts.done + state->counts.failed;
    double spent = wall_clock() - note.start;
    if (state->running && note.start > 0 && finished > note.finished && spent > 0) {
        state->rate = (double)(finished - note.finished) / spent;
        state->refined = is_refined(file);
        if (!state->refined) {
            state->left = (double)(state->counts.cases - finished) / state->rate;
        }
    }
    return true;
}

static void print_json(const char *file, const struct state *state)
{
    const struct store_counts *c = &state->counts;
    json_t *root = json_pack(
        "{s:s, s:I, s:I, s:I, s:I, s:b, s:o, s:o}", "file", file, "cases", (json_int_t)c->cases,
        "done", (json_int_t)c->done, "failed", (json_int_t)c->failed, "pending",
        (json_int_t)(c->cases - c->done - c->failed), "running", state->running, "rate",
        state->rate < 0 ? json_null() : json_real(state->rate), "seconds_left",
        state->left < 0 ? json_null() : json_real(state->left));
    json_dumpf(root, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(root);
}

static void print_text(const char *file, const struct state *state)
{
    const struct store_counts *c = &state->counts;
    uint64_t pending = c->cases - c->done - c->failed;
    char left[32];

    printf("%s: %" PRIu64 " of %" PRIu64 " cases done, %" PRIu64 " failed, %" PRIu64 " pending; %s",
           file, c->done, c->cases, c->failed, pending,
           state->running ? "running"
           : pending      ? "not running (stance run --resume goes on)"
                          : "complete");
    if (state->rate >= 0) {
        printf(", %.0f cases/s", state->rate);
    }
    if (state->left >= 0) {
        report_seconds(left, sizeof left, state->left);
        printf(", %s left", left);
    } else if (state->refined) {
        printf(", refining: most of the others will be inferred");
    }
    putchar('\n');
}

struct request {
    const char *file;
    bool json;
};

static int say(void *context)
{
    const struct request *request = context;
    struct state state;
    stance_message message = {""};

    store_prepare();
    supervise_limit(true);
    bool good = read_state(request->file, &state, &message);
    supervise_limit(false);
    if (!good) {
        fprintf(stderr, "stance status: %s\n", message.text);
        return EXIT_IO;
    }
    if (request->json) {
        print_json(request->file, &state);
    } else {
        print_text(request->file, &state);
    }
    return EXIT_DONE;
}

static int run_status(int argc, char **argv)
{
    const char *file;
    size_t json = 0, operands;
    bool help;
    const struct option_spec specs[] = {{"--json", false, NULL, 0, &json}};

    if (!command_options(&command_status, argc, argv, specs, 1, &file, 1, &operands, &help)) {
        return EXIT_USAGE;
    }
    if (help) {
        return EXIT_DONE;
    }
    if (operands != 1) {
        fprintf(stderr, "stance status: a results file must be given (stance status -h "
                        "explains)\n");
        return EXIT_USAGE;
    }
    struct request request = {file, json > 0};
    return supervise(say, &request, file);
}

const struct command command_status = {
    "status",
    "status FILE [--json]",
    "how far a run is: done, failed, pending, rate and time left",
    run_status,
    "Reads the results file, which a run may be writing.\n"
    "\n"
    "  --json   the same as JSON, with the keys\n"
    "    file                           as given\n"
    "    cases, done, failed, pending   numbers of cases\n"
    "    running                        whether a run is writing the file now\n"
    "    rate, seconds_left             cases per second and seconds; null when unknown,\n"
    "                                   as seconds_left is while a map is refined\n",
};
