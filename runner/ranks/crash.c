/* crash.c - see crash.h. */
#include "crash.h"
#include "parallel.h"

#include "runner/base/command.h"
#include "runner/base/units.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/time.h>
#include <unistd.h>

enum { MOST_CASES = 64, STACK_SIZE = 1 << 16, LINE_SIZE = 2048 };

static const struct {
    int number;
    const char *name;
} crashes[] = {{SIGSEGV, "SIGSEGV"},
               {SIGBUS, "SIGBUS"},
               {SIGFPE, "SIGFPE"},
               {SIGILL, "SIGILL"},
               {SIGABRT, "SIGABRT"}};
enum { CRASHES = sizeof crashes / sizeof crashes[0] };

/* What the handlers read. */
static struct {
    char who[160];                            /* "stance run: rank 3 on node17", or "stance" */
    const char *volatile doing;               /* NULL: nothing that has a name */
    volatile uint64_t case_after[MOST_CASES]; /* index + 1; 0: the place is free */
    struct sigaction before[CRASHES];
    char stack[STACK_SIZE];
    struct crash_law law;
    uint64_t calls; /* of it, at the last tick */
    int ticks;      /* in the same call */
} last;

/* ---- the line, by hand: printf is not for signal handlers ----------------------------------- */

struct line {
    char text[LINE_SIZE];
    size_t length;
};

static void add_text(struct line *line, const char *text)
{
    while (text && *text && line->length < LINE_SIZE - 1)
        line->text[line->length++] = *text++;
}

static void add_number(struct line *line, uint64_t number)
{
    char digits[24];
    size_t at = sizeof digits - 1;
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    add_text(line, digits + at);
}

/* Nothing goes on after that; `unheard` where nobody can hear it. */
__attribute__((noreturn)) static void leave(const struct line *line, int code, int unheard)
{
    _exit(write(STDERR_FILENO, line->text, line->length) < 0 ? unheard : code);
}

static void add_cases(struct line *line)
{
    int cases = 0;
    for (int k = 0; k < MOST_CASES; k++) {
        const uint64_t after = last.case_after[k];
        cases += after > 0;
    }
    if (cases == 0) {
        add_text(line, last.doing ? " while " : NULL);
        add_text(line, last.doing);
        return;
    }
    const char *before = cases == 1 ? ", case " : ", cases ";
    for (int k = 0; k < MOST_CASES; k++) {
        const uint64_t after = last.case_after[k];
        if (after > 0) {
            add_text(line, before);
            add_number(line, after - 1);
            before = ", ";
        }
    }
    add_text(line, " in hand; what is marked done is whole, --resume goes on");
}

/* A law's last words are its own: nobody need look for a fault elsewhere. */
void crash_law_fault(const char *file, const char *what, uint64_t index)
{
    struct line line = {.length = 0};
    add_text(&line, "stance: the law ");
    add_text(&line, file);
    add_text(&line, what);
    add_text(&line, " in case ");
    add_number(&line, index);
    add_text(&line, "; what a file marks as done is whole\n");
    leave(&line, EXIT_USAGE, EXIT_IO);
}

static void announce(int number, siginfo_t *info, void *context)
{
    (void)info, (void)context;
    struct line line = {.length = 0};
    if (last.law.file)
        crash_law_fault(last.law.file,
                        number == SIGILL    ? " reached beyond an array"
                        : number == SIGSEGV ? " crashed (SIGSEGV)"
                        : number == SIGFPE  ? " crashed (SIGFPE)"
                                            : " crashed",
                        last.law.index);
    add_text(&line, last.who);
    add_text(&line, " crashed");
    for (int k = 0; k < CRASHES; k++) {
        if (crashes[k].number == number) {
            add_text(&line, " (");
            add_text(&line, crashes[k].name);
            add_text(&line, ")");
            sigaction(number, &last.before[k], NULL);
        }
    }
    add_cases(&line);
    add_text(&line, "\n");
    if (write(STDERR_FILENO, line.text, line.length) < 0)
        _exit(128 + number); /* nobody can hear it */
    raise(number);           /* blocked until this handler returns, then its next owner's */
}

static void install(void)
{
    const stack_t stack = {.ss_sp = last.stack, .ss_size = sizeof last.stack};
    sigaltstack(&stack, NULL);
    struct sigaction action = {.sa_sigaction = announce, .sa_flags = SA_SIGINFO | SA_ONSTACK};
    sigemptyset(&action.sa_mask);
    for (int k = 0; k < CRASHES; k++)
        sigaction(crashes[k].number, &action, &last.before[k]);
}

/* Has a signal handled from now on. */
static bool handle(int number, void (*handler)(int number), int flags)
{
    struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART | flags};
    sigemptyset(&action.sa_mask);
    return sigaction(number, &action, NULL) == 0;
}

static void look_at_law(int number)
{
    (void)number;
    last.ticks = last.law.file && last.law.calls == last.calls ? last.ticks + 1 : 0;
    last.calls = last.law.calls;
    if (last.ticks >= CRASH_PATIENCE)
        crash_law_fault(last.law.file, " has not returned for 10 s of processor time",
                        last.law.index);
}

struct crash_law *crash_law_watch(void)
{
    const struct itimerval each = {{1, 0}, {1, 0}};
    if (!last.who[0]) {
        snprintf(last.who, sizeof last.who, "stance");
        install();
    }
    handle(SIGVTALRM, look_at_law, SA_ONSTACK);
    setitimer(ITIMER_VIRTUAL, &each, NULL);
    return &last.law;
}

void crash_watch(int rank)
{
    char host[100];
    parallel_host(host, sizeof host);
    snprintf(last.who, sizeof last.who, "stance run: rank %d on %s", rank, host);
    install();
}

void crash_stage(const char *doing)
{
    last.doing = doing;
}

int crash_take(uint64_t index)
{
    for (int k = 0; k < MOST_CASES; k++) {
        if (last.case_after[k] == 0) {
            last.case_after[k] = index + 1;
            return k;
        }
    }
    return -1;
}

void crash_leave(int place)
{
    if (place >= 0)
        last.case_after[place] = 0;
}

/* ---- the latest end of one rank of several -------------------------------------------------- */

enum {
    RESCUE = 10, /* s, that a rescue may take */
    PAUSE = 5,   /* s between ticks: the process did not run in between */
};

static const double longest = 1e9;               /* s: what is later is never */
static volatile int64_t due = INT64_MAX, ticked; /* s of the monotonic clock */
static volatile sig_atomic_t waiting; /* 0, or ticks of this wait from 1: a job may be suspended */
static void (*volatile rescue)(void *context);
static void *volatile rescue_context;
static volatile sig_atomic_t rescued;
static bool prepared;

/* A look each second, or none any more. */
static bool look(void (*handler)(int number), int flags)
{
    const bool on = handler != SIG_DFL;
    const struct itimerval each = {{on, 0}, {on, 0}};
    return (on || setitimer(ITIMER_REAL, &each, NULL) == 0) && handle(SIGALRM, handler, flags) &&
           (!on || setitimer(ITIMER_REAL, &each, NULL) == 0);
}

static pid_t launcher;
static volatile sig_atomic_t looked;

static void look_for_launcher(int number)
{
    struct line line = {.length = 0};
    (void)number;
    if (getppid() != launcher)
        _exit(EXIT_FAILURE); /* nothing has been begun, and nobody waits for the code */
    if (++looked <= DEADLINE_START)
        return;
    add_text(&line, "stance: MPI has not started on all ranks: left; nothing was begun\n");
    leave(&line, EXIT_INTERRUPTED, EXIT_FAILURE);
}

void deadline_launch(bool begin)
{
    launcher = getppid();
    look(begin ? look_for_launcher : SIG_DFL, 0);
}

static int64_t now(void)
{
    return (int64_t)clock_seconds();
}

static void tick(int number)
{
    const int64_t t = now();
    if (t - ticked > PAUSE && due < INT64_MAX)
        due += t - ticked; /* a job that was suspended goes on where it was */
    ticked = t;
    const bool late = t >= due, waits = waiting > DEADLINE_LOST;
    waiting += waiting > 0 && !waits;
    (void)number;
    if (!late && (!waits || rescued))
        return;
    void (*const hurry)(void *) = waiting ? rescue : NULL;
    if (hurry) { /* once: should it get stuck, the next tick after its time ends the process */
        rescue = NULL;
        rescued = 1;
        due = t + RESCUE;
        hurry(rescue_context);
    }
    struct line line = {.length = 0};
    add_text(&line, last.who);
    add_text(&line, waits ? ": rank 0 has not answered for " : ": told to stop, and in ");
    add_number(&line, waits ? DEADLINE_LOST : DEADLINE_PATIENCE);
    add_text(&line, waits ? " s: left; what is marked done is whole, --resume goes on\n"
                          : " s not every rank has come: left; what its file, if there is one, "
                            "marks as done is whole: --resume goes on\n");
    leave(&line, EXIT_INTERRUPTED, EXIT_INTERRUPTED);
}

void deadline_prepare(void)
{
    ticked = now();
    prepared = look(tick, SA_NODEFER);
}

void deadline_begin(void)
{
    if (prepared)
        due = now() + DEADLINE_PATIENCE;
}

void deadline_limit(double seconds)
{
    if (prepared && seconds < longest)
        due = now() + (int64_t)(seconds > 0 ? seconds : 0) + 1 + DEADLINE_PATIENCE;
}

void deadline_waits(bool begin)
{
    waiting = begin;
}

void deadline_rescue(void (*hurry)(void *context), void *context)
{
    rescue = NULL;
    rescue_context = context;
    rescue = hurry;
}
