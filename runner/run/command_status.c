/* command_status.c - `stance status`: how far a run is, seen from another process. */
#include "heartbeat.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/base/say.h"
#include "runner/base/units.h"
#include "runner/store/search_file.h"
#include "runner/store/store.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const struct command command_status; /* below */

struct state {
    struct store_counts counts;
    struct heartbeat_note note;
    struct search_file search; /* where `searches`: what there is is candidates, not cases */
    bool searches;
    bool refined; /* a map whose boundary is being sought: the cases left are not all simulated */
    struct shard shard;      /* whose cases alone are counted; count 0: none */
    double rate, mean, left; /* cases/s of late, since the job's start, and s; NAN: unknown */
};

static uint64_t count_pending(const struct state *state)
{
    return state->counts.cases - state->counts.done - state->counts.failed;
}

/* What the file says of the run: which cases are its own, and how it finds them. */
static void read_origin(const char *file, struct state *state)
{
    struct store_origin origin;
    stance_message ignored;

    if (store_read_origin(file, &origin, &ignored)) {
        if (origin.shard.count > 0 && origin.shard.count <= state->counts.cases) {
            state->shard = shard_of(&origin.shard, state->counts.cases);
            state->counts.cases = shard_rows(&state->shard);
        }
        struct scenario *const s =
            count_pending(state) > 0 ? scenario_new(file, origin.scenario, NULL, 0, NULL) : NULL;
        state->refined = s && s->refine.given;
        scenario_drop(s);
        store_origin_free(&origin);
    }
}

/* What a note has as a negative number is unknown. */
static double known(double number)
{
    return number >= 0 ? number : NAN;
}

static bool read_state(const char *file, struct state *state, stance_message *message)
{
    *state = (struct state){.rate = NAN, .mean = NAN, .left = NAN};
    heartbeat_read(file, &state->note);
    const struct heartbeat_note *note = &state->note;
    if (note->here && access(file, F_OK) != 0) {
        return complain(message, "%.150s: not there yet: a run is %s", file,
                        note->exists ? note->doing : "starting");
    }
    if (search_file_is(file)) {
        state->searches = search_file_read(&state->search, file, message);
        if (state->searches && note->running)
            state->left = known(note->left);
        return state->searches;
    }
    if (!store_count(file, &state->counts, message) || !store_check(file, false, message))
        return false;
    read_origin(file, state);
    if (note->running && note->exists) {
        state->rate = known(note->rate);
        if (note->spent > 0 && note->computed > 0)
            state->mean = (double)note->computed / note->spent;
        if (!state->refined && state->rate > 0)
            state->left = (double)count_pending(state) / state->rate;
    }
    return true;
}

/* ---- what is said ------------------------------------------------------------------------- */

static json_t *number_or_null(double number)
{
    return isfinite(number) ? json_real(number) : json_null();
}

static json_t *seconds_text(double seconds)
{
    char text[32];
    text_of_seconds(text, sizeof text, seconds);
    return isnan(seconds) ? json_null() : json_string(text);
}

static json_t *run_facts(const char *file, const struct state *state)
{
    const struct store_counts *c = &state->counts;
    const struct heartbeat_note *note = &state->note;
    char shard[SHARD_TEXT];
    shard_text(&state->shard, shard);
    return json_pack(
        "{s:o, s:s?, s:I, s:I, s:I, s:o, s:o, s:o, s:o, s:b, s:b, s:s}", "file",
        json_string_nocheck(file), "shard", state->shard.count > 0 ? shard : NULL, "cases",
        (json_int_t)c->cases, "done", (json_int_t)c->done, "failed", (json_int_t)c->failed,
        "pending", state->refined ? json_null() : json_integer((json_int_t)count_pending(state)),
        "rate", number_or_null(state->rate), "mean_rate", number_or_null(state->mean), "round",
        note->running && note->exists && note->round > 0 ? json_integer(note->round) : json_null(),
        ".refined", state->refined, ".complete", count_pending(state) == 0, ".command", "run");
}

static const char run_text[] =
    "{file}: [shard:shard {shard}, ]{done} of {cases} cases done, {failed} failed, "
    "[.refined:others to be simulated or inferred as the map is refined|{pending} pending]; ";

static json_t *search_facts(const char *file, const struct state *state)
{
    const struct search_file *f = &state->search;
    const size_t last = f->length[SEARCH_GENERATION] - 1;
    const double best = f->objective[f->best[last]],
                 chosen = f->chosen < 0 ? NAN : f->confirmed_objective[f->chosen];
    return json_pack("{s:o, s:b, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o, s:b, s:I, s:s, s:b, s:s}",
                     "file", json_string_nocheck(file), "finished", f->finished, "generations",
                     (json_int_t)last + 1, "most_generations", (json_int_t)f->most_generations,
                     "candidates", (json_int_t)f->length[SEARCH_CANDIDATE], "starts",
                     (json_int_t)f->starts[last], "best", (json_int_t)f->best[last],
                     "best_objective", number_or_null(best), "chosen_objective",
                     number_or_null(chosen), ".best", number_or_null(f->chosen < 0 ? best : chosen),
                     ".chosen", f->chosen >= 0, ".fresh", (json_int_t)f->length[SEARCH_START],
                     ".note", f->note, ".complete", f->finished, ".command", "optimise");
}

static const char search_text[] =
    "{file}: generation {generations} of at most {most_generations}, {candidates} candidates, "
    "best {.best%.4g} of [.chosen:{.fresh} fresh|{starts}] starts; ";

/* What is known of the job. */
static json_t *job_facts(const struct state *state)
{
    const struct heartbeat_note *note = &state->note;
    const bool silent = note->age >= HEARTBEAT_SILENCE;
    const double age = note->exists ? note->age : NAN;
    const bool usual =
        strcmp(note->doing, "computing") == 0 || strncmp(note->doing, "generation", 10) == 0;
    json_t *const facts = json_pack(
        "{s:b, s:o, s:n, s:n, s:s?, s:n, s:o, s:b, s:b, s:b, s:i, s:i, s:o, s:b, s:o}", "running",
        note->running, "seconds_left", number_or_null(state->left), "ranks", "ranks_alive", "host",
        note->exists ? note->host : NULL, "doing", "last_sign", number_or_null(age), ".here",
        note->here, ".silent", silent, ".unusual", !usual, ".lost",
        silent ? 0 : note->ranks - note->alive, ".patience", (int)HEARTBEAT_SILENCE, ".age",
        seconds_text(age), ".rated", !isnan(state->rate), ".left", seconds_text(state->left));
    if (note->exists && note->running)
        json_object_update_new(facts, json_pack("{s:i, s:i, s:s}", "ranks", note->ranks,
                                                "ranks_alive", note->alive, "doing", note->doing));
    return facts;
}

/* A job that ended by itself took its note along. */
static const char job_text[] =
    "[running:running"
    "[ranks: on {ranks} rank{ranks#s}[!.here: of {host}]"
    "[.lost>0:, of which {.lost} gave no sign of life for {.patience} s]"
    "[.silent:, no sign of life for {.age}][.unusual:, {doing}]]"
    "[.rated:, {rate%.0f} cases/s][.left:, {.left} left]"
    "|[.complete:[.note:finished: {.note}|complete]|not running"
    "[host: (the last sign of life was {.age} ago, on {host})] (stance {.command} --resume goes on)"
    "]]\n";

struct request {
    struct option_texts files;
    const char *file; /* the one at hand */
    bool json, watch;
};

/* Beside the exit codes, for --watch; s. */
enum { STILL_RUNNING = 100, WATCH_INTERVAL = 5 };

static int say(void *context)
{
    const struct request *request = context;
    struct state state;
    stance_message message = {""};

    store_prepare();
    sandbox_limit(true);
    bool good = read_state(request->file, &state, &message);
    sandbox_limit(false);
    if (!good) {
        fprintf(stderr, "stance status: %s\n", message.text);
        return EXIT_IO;
    }
    json_t *facts = (state.searches ? search_facts : run_facts)(request->file, &state);
    char text[1000];
    json_object_update_new(facts, job_facts(&state));
    snprintf(text, sizeof text, "%s%s", state.searches ? search_text : run_text, job_text);
    good = say_facts(facts, request->json, text, stdout);
    if (state.searches)
        search_file_free(&state.search);
    return !good ? EXIT_IO : request->watch && state.note.running ? STILL_RUNNING : EXIT_DONE;
}

/* All files, once; STILL_RUNNING: at least one is being written. */
static int say_all(struct request *request)
{
    int worst = EXIT_DONE, running = 0;
    const bool list = request->json && request->files.count > 1;
    for (size_t i = 0; i < request->files.count; i++) {
        request->file = request->files.text[i];
        if (list)
            fputs(i ? ",\n" : "[\n", stdout);
        fflush(stdout);
        const int code = sandbox(say, request, request->file);
        if (list && code != EXIT_DONE && code != STILL_RUNNING)
            fputs("null", stdout);
        running += code == STILL_RUNNING;
        worst = code != STILL_RUNNING && code > worst ? code : worst;
    }
    if (list)
        fputs("]\n", stdout);
    return running > 0 ? STILL_RUNNING : worst;
}

static int run_status(int argc, char **argv)
{
    struct request request = {.json = false};
    int code = command_begin(&command_status, argc, argv, &request);
    if (code == COMMAND_GOES_ON)
        while ((code = say_all(&request)) == STILL_RUNNING)
            sleep(WATCH_INTERVAL);
    return code;
}

static const struct option options[] = {
    {"FILE...", OPTION_TO(struct request, files), .low = 1, .text = "a results file"},
    {"--watch", OPTION_TO(struct request, watch),
     .text = "again every 5 s, as long as the file is being written"},
    {"--json", OPTION_TO(struct request, json),
     .text = "the same as JSON, of several files a list (null: cannot be read), with the keys"},
    {0},
};

const struct command command_status = {
    "status",
    "how far a run or a search is: what is done, time left, ranks alive",
    run_status,
    options,
    "Reads the results file, which a run may be writing, and FILE.lock, where the run gives a "
    "sign of life every other second, from any machine that sees them. A run elsewhere counts as "
    "running until it was silent for 30 s. The rate is that of the last minute.",
    "    file                     as given\n"
    "    shard                    K/N of a shard's file, of whose share all is told; else null\n"
    "    cases, done, failed      numbers of cases\n"
    "    pending                  the others; null where a map is refined and not complete, for "
    "most of them will not be simulated\n"
    "    running                  whether a run is writing the file now\n"
    "    rate, mean_rate          cases per second, of late and since the run's start\n"
    "    seconds_left             of the run; null while a map is refined\n"
    "    ranks, ranks_alive       of the run; alive: heard of during the last 30 s\n"
    "    host                     of its rank 0\n"
    "    doing, round             what it is at; of a refined map, which round\n"
    "    last_sign                seconds since its last sign of life\n"
    "  of the file of a search (stance optimise) with\n"
    "    file, finished, generations, most_generations, candidates\n"
    "    starts, best, best_objective   of the last generation how many its candidates have, the\n"
    "                             best one of its stage so far\n"
    "    chosen_objective         of fresh starts, once it is finished\n"
    "    running, seconds_left (at most), ranks, ranks_alive, host, doing, last_sign\n"
    "  What is unknown is null. A run that was killed leaves host and last_sign behind.\n",
};
