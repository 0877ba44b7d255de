/* crash.c - see crash.h. */
#include "crash.h"
#include "parallel.h"

#include "runner/base/command.h"

#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
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

/* What the handler reads. */
static struct {
    char who[160];                            /* "stance run: rank 3 on node17 crashed" */
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
    while (*text && line->length < LINE_SIZE - 1)
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

static void add_cases(struct line *line)
{
    int cases = 0;
    for (int k = 0; k < MOST_CASES; k++) {
        const uint64_t after = last.case_after[k];
        cases += after > 0;
    }
    if (cases == 0) {
        add_text(line, last.doing ? " while " : "");
        add_text(line, last.doing ? last.doing : "");
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
    _exit(write(STDERR_FILENO, line.text, line.length) < 0 ? EXIT_IO : EXIT_USAGE);
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

static void install(const char *who)
{
    const stack_t stack = {.ss_sp = last.stack, .ss_size = sizeof last.stack};
    snprintf(last.who, sizeof last.who, "%s", who);
    sigaltstack(&stack, NULL);
    struct sigaction action = {.sa_sigaction = announce, .sa_flags = SA_SIGINFO | SA_ONSTACK};
    sigemptyset(&action.sa_mask);
    for (int k = 0; k < CRASHES; k++)
        sigaction(crashes[k].number, &action, &last.before[k]);
}

static void tick(int number)
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
    struct sigaction action = {.sa_handler = tick, .sa_flags = SA_RESTART | SA_ONSTACK};
    sigemptyset(&action.sa_mask);
    if (!last.who[0])
        install("stance crashed");
    sigaction(SIGVTALRM, &action, NULL);
    setitimer(ITIMER_VIRTUAL, &each, NULL);
    return &last.law;
}

void crash_watch(int rank)
{
    char host[80], who[sizeof last.who];
    parallel_host(host, sizeof host);
    snprintf(who, sizeof who, "stance run: rank %d on %s crashed", rank, host);
    install(who);
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
