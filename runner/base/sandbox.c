/* sandbox.c - one child process per command that reads a results file. */
#include "sandbox.h"
#include "command.h"
#include "progress.h"
#include "units.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_SECONDS = 10, FIRST_SECONDS = 3, WORDS = 320 };

void sandbox_limit(bool begin)
{
    struct rlimit limit;
    struct rusage usage;
    if (getrlimit(RLIMIT_CPU, &limit) != 0 || getrusage(RUSAGE_SELF, &usage) != 0)
        return; /* goes without */
    limit.rlim_cur = limit.rlim_max;
    rlim_t end = (rlim_t)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) + MOST_SECONDS;
    if (begin && (limit.rlim_max == RLIM_INFINITY || end < limit.rlim_max))
        limit.rlim_cur = end;
    setrlimit(RLIMIT_CPU, &limit);
}

static const int crashes[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGSYS, SIGXCPU};
enum { CRASHES = sizeof crashes / sizeof crashes[0] };

/* The child. What it says goes to `messages`, so that a dying library can be hushed. */
static void work_and_exit(int (*work)(void *context), void *context, int messages, pid_t parent)
{
    const struct rlimit none = {0, 0};
    /* No work goes on without the command; nor does a compiler that was started for it, so that
     * the end is asked for. */
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent)
        _exit(EXIT_IO);
    setrlimit(RLIMIT_CORE, &none);
    for (int k = 0; k < CRASHES; k++)
        signal(crashes[k], SIG_DFL); /* handlers of MPI or of a test would go on in the child */
    if (messages >= 0)
        dup2(messages, STDERR_FILENO);
    int code = work(context);
    if ((fflush(stdout) != 0 || ferror(stdout)) &&
        (code == EXIT_DONE || code == EXIT_CASES_FAILED)) {
        fputs("stance: cannot write to standard output\n", stderr);
        code = EXIT_IO;
    }
    fflush(stderr);
    _exit(code);
}

static void pass_on(FILE *messages)
{
    char *line = NULL;
    size_t size = 0;
    rewind(messages);
    while (getline(&line, &size, messages) > 0)
        if (sandbox_own_line(line))
            fputs(line, stderr);
    free(line);
}

/* Waits for the child, the only holder of the other end of `alive`. From the third second on it
 * is said what the child says of its work, or how many there were. */
static void wait_for(pid_t child, int alive, const char *words, int *status)
{
    struct pollfd end = {.fd = alive, .events = POLLIN};
    struct progress progress = progress_begin(false);
    progress.due += FIRST_SECONDS;
    while (alive >= 0 && poll(&end, 1, 500) <= 0) {
        const double now = clock_seconds();
        if (progress_due(&progress, now))
            words &&words[0] ? progress_say(&progress, "%.300s", words)
                             : progress_say(&progress, "%.0f s", floor(now - progress.from));
    }
    while (waitpid(child, status, 0) < 0 && errno == EINTR) {
    }
    progress_end(&progress);
}

int sandbox(int (*work)(void *context), void *context, const char *files)
{
    int alive[2] = {-1, -1};
    int status = 0, descriptor = memfd_create("messages", MFD_CLOEXEC);
    FILE *messages = descriptor < 0 ? NULL : fdopen(descriptor, "r");
    pid_t parent = getpid();
    char *const words =
        mmap(NULL, WORDS, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    const bool told = words != MAP_FAILED;

    fflush(stdout);
    fflush(stderr);
    if (pipe2(alive, O_CLOEXEC) != 0)
        alive[0] = alive[1] = -1;
    pid_t child = fork();
    if (child == 0) {
        if (told)
            progress_redirect(words, WORDS);
        work_and_exit(work, context, messages ? descriptor : -1, parent);
    }
    if (child < 0) {
        fprintf(stderr, "stance: no process can be started: %s\n", strerror(errno));
        status = EXIT_IO;
    }
    if (alive[1] >= 0)
        close(alive[1]);
    if (child > 0)
        wait_for(child, alive[0], told ? words : NULL, &status);
    if (told)
        munmap(words, WORDS);
    if (alive[0] >= 0)
        close(alive[0]);
    bool crashed = false;
    for (int k = 0; child > 0 && WIFSIGNALED(status) && k < CRASHES; k++)
        crashed = crashed || crashes[k] == WTERMSIG(status);
    if (crashed)
        fprintf(stderr, "%s: damaged: the library that reads it cannot cope with it\n", files);
    else if (messages)
        pass_on(messages);
    if (messages)
        fclose(messages);
    if (child < 0 || crashed)
        return EXIT_IO;
    if (WIFSIGNALED(status)) { /* interrupted, or its reader has gone: so is this process */
        signal(WTERMSIG(status), SIG_DFL);
        raise(WTERMSIG(status));
        return EXIT_IO;
    }
    return WEXITSTATUS(status);
}
