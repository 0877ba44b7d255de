/* fuzz_results.c - damaged results files as commands meet them.
 *
 *   fuzz_results [-seconds S] [-runs N] [-from NUMBER] FILE...    damages each in turn
 *   fuzz_results -replay GOOD DAMAGED...                          tries files that are damaged
 *
 * A worker process damages a good file in memory (damage.c), writes it to shared memory's file
 * system and runs summary, status, plot (but for gnuplot), compare and what a resume reads, all in
 * itself and under the sanitizers; of some, what writes: a run that goes on to the end, also by
 * another scenario, a larger design from it, a merge with the good file. The HDF5 library crashes
 * on damaged files: the commands read in a process of their own for that (runner/base/sandbox.h)
 * and here a new worker goes on. Allowed are therefore crashes and loops within the library while
 * it is supervised. Findings are
 *   - anything a sanitizer says of code of ours, or an allocation of ours out of all proportion,
 *   - a crash or a loop where nothing supervises: in a run that goes on after its check,
 *   - an error that is not one line and exit code 3 (2 from plot and runs),
 *   - numbers that differ from those of the good file without an error, unless checksums were
 *     forged to make them so.
 */
#include "analysis/draw/gnuplot.h"
#include "damage.h"
#include "fuzz_numbers.h"
#include "runner/base/command.h"
#include "runner/base/sandbox.h"
#include "runner/plan/plan.h"
#include "runner/ranks/parallel.h"
#include "runner/store/results.h"
#include "runner/store/store.h"

#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <hdf5.h>
#include <math.h>
#include <sanitizer/allocator_interface.h>
#include <sanitizer/lsan_interface.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

extern const struct command command_summary, command_status, command_plot, command_compare,
    command_basin, command_sensitivity, command_run, command_merge;

enum {
    FILES_PER_WORKER = 500,
    MOST_FILES = 64,
    MOST_MICROSECONDS = 400000, /* of one file, which takes a hundredth of it */
    MOST_ALLOCATED = 64 << 20,
    MOST_FINDINGS = 20,
    ROOM = 4 << 20,
};

/* Where a worker is. */
enum stage {
    STAGE_SUMMARY,
    STAGE_BASIN,
    STAGE_SENSITIVITY,
    STAGE_STATUS,
    STAGE_PLOT,
    STAGE_COMPARE,
    STAGE_CHECK,
    STAGE_RESUME,
    STAGE_NUMBERS,
    STAGE_MERGE,
    STAGE_RUN,
    STAGES
};
static const char *const stage_names[STAGES] = {
    "summary",           "basin",  "sensitivity", "status", "plot", "compare",
    "check of a resume", "resume", "numbers",     "merge",  "run"};

enum verdict { HARMLESS, DETECTED, FLAGGED, DIFFERENT, VERDICTS };

/* What workers and their starter share. */
static struct shared {
    uint64_t next, tried, forged;
    uint64_t verdicts[2][VERDICTS]; /* by accident, forged */
    uint64_t crashes, loops, large, astray, written;
    enum stage stage;
    bool is_forged, supervised;
    char text[200]; /* what was done to the file */
    char name[64];
} * shared;

static struct damage_file good[MOST_FILES];
static char good_path[MOST_FILES][1024];
static struct store_origin good_origin[MOST_FILES];
static struct fuzz_numbers expected[MOST_FILES];
static size_t goods;
static char directory[64], path[128], out_path[128], scenario_path[128], log_path[128];
static int log_file = -1;
static unsigned findings;

/* ---- the program's edges ------------------------------------------------------------------ */

/* Commands work here instead of in a process of their own. */
int __wrap_sandbox(int (*work)(void *context), void *context, const char *files);
int __wrap_sandbox(int (*work)(void *context), void *context, const char *files)
{
    const bool before = shared->supervised;
    (void)files;
    shared->supervised = true;
    const int code = work(context);
    shared->supervised = before;
    return code;
}

/* One rank, without MPI; crashes are looked at here. */
struct parallel __wrap_parallel_start(void);
struct parallel __wrap_parallel_start(void)
{
    return parallel_alone();
}
void __wrap_parallel_finish(struct parallel *parallel);
void __wrap_parallel_finish(struct parallel *parallel)
{
    parallel_unshare(parallel);
}
void __wrap_crash_watch(int rank);
void __wrap_crash_watch(int rank)
{
    (void)rank;
}

void __wrap_sandbox_limit(bool begin);
void __wrap_sandbox_limit(bool begin)
{
    (void)begin; /* the timer of the worker is stricter */
}

bool __wrap_gnuplot_end(struct gnuplot *g);
bool __wrap_gnuplot_end(struct gnuplot *g)
{
    const bool drawn = !g->missing;
    gnuplot_abandon(g);
    return drawn;
}

/* ---- findings inside a worker --------------------------------------------------------------- */

static void finding(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));
static void finding(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("finding: ", stderr);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    fflush(stderr);
    abort();
}

/* The first function on the way here that belongs to neither the sanitizer nor the C library: is
 * it the HDF5 library's? */
static bool called_by_library(void)
{
    void *frame[24];
    Dl_info info;
    int n = backtrace(frame, 24);
    for (int i = 1; i < n; i++) {
        if (!dladdr(frame[i], &info) || !info.dli_fname || strstr(info.dli_fname, "clang_rt") ||
            strstr(info.dli_fname, "/libc.so"))
            continue;
        if (!strstr(info.dli_fname, "fuzz_results"))
            return true;
        if (i > 2) /* beyond this function and the hook: the caller of malloc */
            return false;
    }
    return false;
}

static void watch_allocation(const volatile void *memory, size_t size)
{
    if (memory && size > MOST_ALLOCATED && shared) {
        if (!called_by_library())
            finding("%zu bytes allocated", size);
        shared->large++;
    }
}

static void ignore_release(const volatile void *memory)
{
    (void)memory;
}

/* Where the program stood when it crashed, as the sanitizer would say it, in a fiftieth of the
 * time. */
static void crashed(int number)
{
    enum { SKIPPED = 2 }; /* this and what called it */
    void *frame[40];
    Dl_info info;
    const int n = backtrace(frame, 40);
    dprintf(STDERR_FILENO, "signal %d\n", number);
    for (int i = SKIPPED; i < n; i++)
        dprintf(STDERR_FILENO, "    #%d %p (%s)\n", i - SKIPPED, frame[i],
                dladdr(frame[i], &info) && info.dli_fname ? info.dli_fname : "?");
    signal(SIGABRT, SIG_DFL);
    abort();
}

static void watch_crashes(void)
{
    static uint8_t room[1 << 16];
    static const int numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL};
    const stack_t stack = {.ss_sp = room, .ss_size = sizeof room};
    struct sigaction action = {.sa_handler = crashed, .sa_flags = SA_ONSTACK | (int)SA_RESETHAND};
    void *frame[1];
    backtrace(frame, 1); /* loads what it needs while the heap is whole */
    sigaltstack(&stack, NULL);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        sigaction(numbers[i], &action, NULL);
}

/* ---- one damaged file ----------------------------------------------------------------------- */

/* What was said since the last time; sanitizers' own remarks left out. */
static unsigned lines_said(char *first, size_t size)
{
    static char said[1 << 16];
    fflush(stderr);
    ssize_t n = pread(log_file, said, sizeof said - 1, 0);
    unsigned lines = 0;
    said[n > 0 ? n : 0] = '\0';
    first[0] = '\0';
    for (char *line = said, *end; *line; line = end) {
        end = line + strcspn(line, "\n");
        end += *end == '\n';
        /* nor warnings, which may stand before what there is to say */
        if (sandbox_own_line(line) && strncmp(line, "==", 2) != 0 &&
            strncmp(line, "stance: warning:", 16) != 0) {
            if (lines++ == 0)
                snprintf(first, size, "%.*s", (int)(end - line), line);
        }
    }
    if (ftruncate(log_file, 0) != 0)
        abort();
    lseek(log_file, 0, SEEK_SET);
    return lines;
}

static int run_command(enum stage stage, const struct command *command, int argc, char **argv)
{
    char first[1000];
    shared->stage = stage;
    int code = command->run(argc, argv);
    unsigned lines = lines_said(first, sizeof first);
    /* A run shows where scenarios differ. */
    const bool many = stage == STAGE_RUN && code == EXIT_USAGE;
    bool fits = many || (code == EXIT_IO || code == EXIT_USAGE ? lines == 1 : lines <= 1);
    for (const unsigned char *s = (const unsigned char *)first; *s; s++)
        fits = fits && (*s >= 0x20 || (*s == '\n' && !s[1])) && *s != 0x7f;
    if (!fits || code < 0 || code > EXIT_IO)
        finding("%s: exit code %d with %u lines: %s", stage_names[stage], code, lines, first);
    return code;
}

/* `seconds`: 0: as long as a file usually may. */
static void limit_time(int seconds)
{
    const struct itimerval limit = {
        .it_value = {.tv_sec = seconds, .tv_usec = seconds ? 0 : MOST_MICROSECONDS}};
    setitimer(ITIMER_PROF, &limit, NULL); /* SIGPROF ends the worker */
}

/* What `run --resume` reads before it writes. False: it stops with a reason. */
static bool resume(size_t which, stance_message *message)
{
    struct store_origin origin;
    struct store_counts counts;
    struct scenario *s = malloc(sizeof *s);
    struct plan plan;
    struct plan_error error;
    struct store *store;
    uint64_t only = 0;

    shared->stage = STAGE_CHECK;
    bool fine = s && store_check(path, true, message);
    shared->stage = STAGE_RESUME;
    shared->supervised = false;
    limit_time(10); /* for certain */
    if (!fine || !store_read_origin(path, &origin, message)) {
        free(s);
        return false;
    }
    bool same = strcmp(origin.scenario, good_origin[which].scenario) == 0;
    store_origin_free(&origin);
    snprintf(message->text, sizeof message->text, "made from another scenario");
    if (!same || !scenario_read(s, "scenario", good_origin[which].scenario, NULL, 0, stderr)) {
        free(s);
        return false;
    }
    fine = store_read_axes(path, s->axis, s->axes, message);
    fine = fine && store_count(path, &counts, message);
    bool single = strstr(good[which].name, "case") != NULL;
    fine = fine && plan_make(&plan, s, single, only, single, &error);
    if (fine) {
        fine = store_open(&store, path, &plan, NULL, message) &&
               store_read_designs(store, &plan, message);
        for (uint64_t row = 0; fine && row < plan.rows; row += STORE_ROWS) {
            struct store_found found[STORE_ROWS];
            uint64_t n = plan.rows - row < STORE_ROWS ? plan.rows - row : STORE_ROWS;
            const struct rows rows = {.first = row, .count = n};
            fine = store_verify(store, &rows, found, message);
        }
        if (store && fine)
            fine = store_close(store, message);
        else
            store_abandon(store);
        plan_free(&plan);
    }
    scenario_free(s);
    free(s);
    return fine;
}

static void write_file(const char *name, const void *data, size_t size)
{
    int file = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || write(file, data, size) != (ssize_t)size)
        abort();
    close(file);
}

static void write_scenario(size_t which, bool other_title)
{
    const char *text = good_origin[which].scenario;
    char *whole = malloc(strlen(text) + 64), *title = strstr(text, "\ntitle: ");
    if (!whole || !title)
        abort();
    const size_t n = other_title ? (size_t)(title - text) + 8 : strlen(text);
    sprintf(whole, "%.*s%s", (int)n, text, other_title ? "Another, of " : "");
    if (other_title)
        strcat(whole, title + 8);
    write_file(scenario_path, whole, strlen(whole));
    free(whole);
}

/* Whether a larger design has the smaller one's rows; of those that the good file has done. */
static bool begins_with(const struct fuzz_numbers *large, const struct fuzz_numbers *small)
{
    bool same = large->cases > small->cases;
    for (uint64_t i = 0; same && i < small->cases; i++)
        same = large->kind[i] == small->kind[i] && large->row[i] == small->row[i];
    return same;
}

/* What writes: what comes of it must be what the good file says, or an error. */
static void try_writing(size_t which, unsigned turn)
{
    enum { GO_ON, GO_ON_OTHERWISE, MERGE, EXTEND };
    const bool single = strstr(good[which].name, "case") != NULL;
    const bool sampled = strstr(good[which].name, "sampled") != NULL;
    char *merge[] = {"merge", out_path, path, good_path[which], "--force", NULL};
    char *extend[] = {"run", scenario_path, "--extend", "8",       "--from",
                      path,  "-o",          out_path,   "--quiet", NULL};
    char *go_on[12] = {"run", scenario_path, "-o", path, "--resume", "--quiet"};
    struct fuzz_numbers numbers;
    stance_message message = {""};
    uint64_t pending = 0;
    int code, n = 6;

    if (turn == EXTEND && !sampled)
        turn = GO_ON;
    write_scenario(which, turn == GO_ON_OTHERWISE);
    unlink(out_path);
    if (turn == GO_ON_OTHERWISE)
        go_on[n++] = "--force-scenario";
    if (single)
        go_on[n++] = "--only", go_on[n++] = "0", go_on[n++] = "--trace";
    shared->supervised = false;
    limit_time(10);
    if (turn == MERGE)
        code = run_command(STAGE_MERGE, &command_merge, 5, merge);
    else if (turn == EXTEND)
        code = run_command(STAGE_RUN, &command_run, 9, extend);
    else
        code = run_command(STAGE_RUN, &command_run, n, go_on);
    shared->written += code == EXIT_DONE;
    if (code != EXIT_DONE || shared->is_forged)
        return;
    if (!fuzz_hash_file(turn == MERGE || turn == EXTEND ? out_path : path, &numbers, &message))
        finding("what was written cannot be read: %s", message.text);
    numbers.scenario = expected[which].scenario;
    const char *what = turn == EXTEND ? begins_with(&numbers, &expected[which]) ? "" : "rows"
                                      : fuzz_difference(&numbers, &expected[which], &pending);
    fuzz_numbers_free(&numbers);
    if (what[0] || pending)
        finding("written, but %s", what[0] ? what : "with cases pending");
}

/* All but the costly commands, which every fourth file is tried with. */
static void try_file(size_t which)
{
    struct fuzz_numbers numbers = {0};
    stance_message message = {""};
    shared->supervised = true;
    char first[1000];
    char *arguments[] = {"", path, good_path[which], NULL};
    char *plot[] = {"plot", path, "-o", directory, NULL};
    char *outline[] = {"plot", path, path, "--outline", "--allowed", "-o", directory, NULL};
    char *allowed[] = {"basin", path, "--allowed", NULL};
    char *json[] = {"", path, "--json", NULL};
    const uint64_t turn = shared->next / goods % 4;
    uint64_t pending;

    int code =
        run_command(STAGE_SUMMARY, &command_summary, turn & 1 ? 3 : 2, turn & 1 ? json : arguments);
    bool detected = code == EXIT_IO;
    if (turn == 3)
        run_command(STAGE_STATUS, &command_status, 2, arguments);
    if (code != EXIT_IO && turn == 3) {
        run_command(STAGE_PLOT, &command_plot, 4, plot);
        run_command(STAGE_PLOT, &command_plot, 7, outline);
        run_command(STAGE_COMPARE, &command_compare, 3, arguments);
    }
    if (code != EXIT_IO && turn == 2) {
        run_command(STAGE_BASIN, &command_basin, 2, arguments);
        run_command(STAGE_BASIN, &command_basin, 3, allowed);
        run_command(STAGE_SENSITIVITY, &command_sensitivity, 2, arguments);
    }
    shared->stage = STAGE_NUMBERS;
    detected = detected || !fuzz_hash_file(path, &numbers, &message);
    const char *what = detected ? "" : fuzz_difference(&numbers, &expected[which], &pending);
    enum verdict verdict = detected ? DETECTED : what[0] ? DIFFERENT : pending ? FLAGGED : HARMLESS;
    fuzz_numbers_free(&numbers);
    if (verdict == DIFFERENT && !shared->is_forged)
        finding("silently different: %s", what);
    message.text[0] = '\0';
    if (!resume(which, &message) && message.text[0] == '\0')
        finding("a resume stops without a reason");
    lines_said(first, sizeof first);
    if (turn == 1)
        try_writing(which, (unsigned)(shared->next / goods / 4 % 4));
    shared->verdicts[shared->is_forged][verdict]++;
}

/* ---- workers -------------------------------------------------------------------------------- */

static void prepare_worker(void)
{
    log_file = open(log_path, O_RDWR | O_CREAT | O_TRUNC | O_APPEND, 0600);
    int nowhere = open("/dev/null", O_WRONLY);
    if (log_file < 0 || nowhere < 0)
        abort();
    dup2(nowhere, STDOUT_FILENO);
    dup2(log_file, STDERR_FILENO);
    store_prepare();
    H5set_free_list_limits(-1, -1, -1, -1, -1, -1); /* to give memory back takes half of the time */
    watch_crashes();
    __sanitizer_install_malloc_and_free_hooks(watch_allocation, ignore_release);
}

/* Damages and tries file after file up to number `end`. */
static void work(uint64_t end)
{
    uint8_t *data = malloc(ROOM);
    prepare_worker();
    for (; data && shared->next < end; shared->next++) {
        const size_t which = shared->next % goods;
        size_t size;
        limit_time(0);
        snprintf(shared->name, sizeof shared->name, "%s", good[which].name);
        shared->is_forged =
            damage_make(&good[which], shared->next / goods, data, ROOM, &size, shared->text);
        shared->tried++;
        shared->forged += shared->is_forged;
        write_file(path, data, size);
        try_file(which);
    }
    limit_time(0);
    free(data);
    if (__lsan_do_recoverable_leak_check())
        finding("leaks among the files up to %llu", (unsigned long long)end);
    _exit(0);
}

/* What a worker that died has said: whether the HDF5 library is to blame. */
static bool is_library(const char *said)
{
    if (strstr(said, "runtime error:") || strstr(said, "finding:"))
        return false;
    for (const char *frame = strstr(said, "    #"); frame; frame = strstr(frame + 1, "\n    #")) {
        size_t length = strcspn(frame + 1, "\n");
        char line[512];
        snprintf(line, sizeof line, "%.*s", (int)(length < 500 ? length : 500), frame + 1);
        if (strstr(line, "clang_rt") || strstr(line, "libc.so"))
            continue;
        return strstr(line, "libhdf5") != NULL;
    }
    return false;
}

static void report(const char *what, const char *said, const uint8_t *data, size_t size)
{
    char name[64];
    snprintf(name, sizeof name, "finding-%llu.h5", (unsigned long long)shared->next);
    FILE *out = fopen(name, "wb");
    if (out) {
        fwrite(data, 1, size, out);
        fclose(out);
    }
    fprintf(stderr, "%s: %s in %s, number %llu, %s (%s), kept as %s\n%.3000s\n", shared->name, what,
            stage_names[shared->stage], (unsigned long long)shared->next,
            shared->is_forged ? "forged" : "by accident", shared->text, name, said);
    findings++;
}

/* Reads what the worker said and what it was given. */
static size_t read_all(const char *name, void *data, size_t room)
{
    FILE *in = fopen(name, "rb");
    size_t n = in ? fread(data, 1, room, in) : 0;
    if (in)
        fclose(in);
    return n;
}

/* A worker has died: where the library may crash or loop, that is counted; else it is a finding.
 */
static bool is_finding(int status)
{
    static char said[1 << 16];
    said[read_all(log_path, said, sizeof said - 1)] = '\0';
    const bool loop = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF;
    if (!shared->supervised || (!loop && !is_library(said)))
        return true;
    shared->loops += loop;
    shared->crashes += !loop;
    shared->verdicts[shared->is_forged][DETECTED]++;
    return false;
}

/* Tries one file in a process of its own, as commands do: one that went before may have led the
 * library astray. Returns the worker's status. */
static int try_alone(void)
{
    const struct shared before = *shared;
    int status;
    pid_t child = fork();
    if (child == 0)
        work(shared->next + 1);
    if (child < 0 || waitpid(child, &status, 0) < 0)
        abort();
    const enum stage stage = shared->stage;
    const bool supervised = shared->supervised;
    *shared = before;
    shared->stage = stage;
    shared->supervised = supervised;
    return status;
}

static void judge(int status, bool alone)
{
    static char said[1 << 16];
    static uint8_t data[ROOM];
    if (!is_finding(status))
        return;
    said[read_all(log_path, said, sizeof said - 1)] = '\0';
    if (!alone && !strstr(said, "finding: leaks")) {
        status = try_alone();
        if (status == 0) {
            shared->astray++;
            return;
        }
        if (!is_finding(status))
            return;
    }
    said[read_all(log_path, said, sizeof said - 1)] = '\0';
    size_t size = read_all(path, data, sizeof data);
    shared->verdicts[shared->is_forged][strstr(said, "silently") ? DIFFERENT : DETECTED]++;
    report(WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF ? "endless" : "wrong", said, data,
           size);
}

static double seconds_now(void)
{
    struct timeval now;
    gettimeofday(&now, NULL);
    return (double)now.tv_sec + 1e-6 * (double)now.tv_usec;
}

static void campaign(double seconds, uint64_t runs, uint64_t from)
{
    const double begin = seconds_now();
    shared->next = from;
    while (findings < MOST_FINDINGS && seconds_now() - begin < seconds &&
           shared->next - from < runs) {
        uint64_t end = shared->next + FILES_PER_WORKER;
        end = end - from < runs ? end : from + runs;
        int status;
        pid_t child = fork();
        if (child == 0)
            work(end);
        if (child < 0 || waitpid(child, &status, 0) < 0)
            abort();
        if (status != 0) {
            judge(status, false);
            shared->next++;
        }
    }
    const struct shared *c = shared;
    printf("%llu damaged files in %.0f s, %llu of them with checksums forged to fit\n",
           (unsigned long long)c->tried, seconds_now() - begin, (unsigned long long)c->forged);
    for (int forged = 0; forged < 2; forged++) {
        printf("  %-12s harmless %llu, detected %llu, cases pending %llu, different %llu\n",
               forged ? "forged" : "by accident", (unsigned long long)c->verdicts[forged][HARMLESS],
               (unsigned long long)c->verdicts[forged][DETECTED],
               (unsigned long long)c->verdicts[forged][FLAGGED],
               (unsigned long long)c->verdicts[forged][DIFFERENT]);
    }
    printf("  written anew %llu; supervised: %llu crashes and %llu loops of the HDF5 library, %llu "
           "large "
           "allocations of it,\n  %llu files read wrongly only after others had led it astray; "
           "findings %u\n",
           (unsigned long long)c->written, (unsigned long long)c->crashes,
           (unsigned long long)c->loops, (unsigned long long)c->large,
           (unsigned long long)c->astray, findings);
}

/* ---- the program ---------------------------------------------------------------------------- */

static bool add_good(const char *file)
{
    stance_message message = {""};
    snprintf(good_path[goods], sizeof good_path[0], "%s", file);
    if (!damage_load(&good[goods], file) || !fuzz_hash_file(file, &expected[goods], &message) ||
        !store_read_origin(file, &good_origin[goods], &message)) {
        fprintf(stderr, "%s: no good file: %s\n", file, message.text);
        return false;
    }
    goods++;
    return true;
}

static void replay(const char *file)
{
    struct damage_file damaged;
    if (!damage_load(&damaged, file)) {
        fprintf(stderr, "%s: cannot be read\n", file);
        findings++;
        return;
    }
    int status;
    shared->is_forged = true;
    snprintf(shared->name, sizeof shared->name, "%s", damaged.name);
    pid_t child = fork();
    if (child == 0) {
        prepare_worker();
        limit_time(0);
        write_file(path, damaged.data, damaged.size);
        try_file(0);
        _exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0)
        abort();
    if (status != 0)
        judge(status, true);
    free(damaged.data);
    free(damaged.block);
}

const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "symbolize=0:abort_on_error=1:handle_segv=0:handle_sigbus=0:handle_sigfpe=0:handle_"
           "sigill=0:handle_abort=0:allocator_may_return_null=1:"
           "max_allocation_size_mb=2048:hard_rss_limit_mb=3000:quarantine_size_mb=1:allocator_"
           "release_to_os_interval_ms=-1:"
           "detect_stack_use_after_return=0:disable_coredump=1";
}
const char *__ubsan_default_options(void);
const char *__ubsan_default_options(void)
{
    return "print_stacktrace=1";
}
/* The library does not release all that it has when it fails. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libhdf5\nleak:libopen\nleak:libmpi\n";
}

int main(int argc, char **argv)
{
    double seconds = 60;
    uint64_t runs = UINT64_MAX / 4, from = 0;
    bool replays = false;
    int i = 1;

    for (; i < argc && argv[i][0] == '-'; i++) {
        if (strcmp(argv[i], "-replay") == 0) {
            replays = true;
        } else if (i + 1 < argc && strcmp(argv[i], "-seconds") == 0) {
            seconds = atof(argv[++i]);
        } else if (i + 1 < argc && strcmp(argv[i], "-runs") == 0) {
            runs = strtoull(argv[++i], NULL, 10);
        } else if (i + 1 < argc && strcmp(argv[i], "-from") == 0) {
            from = strtoull(argv[++i], NULL, 10);
        } else {
            fprintf(stderr, "%s: unknown option\n", argv[i]);
            return EXIT_USAGE;
        }
    }
    const struct rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    snprintf(directory, sizeof directory, "/dev/shm/fuzz-XXXXXX");
    if (shared == MAP_FAILED || i == argc || !mkdtemp(directory)) {
        fprintf(stderr, "fuzz_results: cannot begin\n");
        return EXIT_USAGE;
    }
    setenv("TMPDIR", directory, 1);
    snprintf(path, sizeof path, "%s/file.h5", directory);
    snprintf(out_path, sizeof out_path, "%s/out.h5", directory);
    snprintf(scenario_path, sizeof scenario_path, "%s/scenario.yaml", directory);
    snprintf(log_path, sizeof log_path, "%s/log", directory);
    store_prepare();
    if (replays) {
        bool begun = add_good(argv[i++]);
        for (; begun && i < argc; i++)
            replay(argv[i]);
        findings += !begun;
    } else {
        for (; i < argc && goods < MOST_FILES; i++)
            findings += !add_good(argv[i]);
        if (findings == 0)
            campaign(seconds, runs, from);
    }
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", directory);
    return system(command) != 0 || findings > 0;
}
