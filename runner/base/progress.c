/* progress.c - see progress.h. */
#include "progress.h"
#include "units.h"

#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

static const double on_terminal = 0.5, elsewhere = 60; /* s */
static const double little = 0.01; /* of the work, after which nothing is known */

static char *other;
static unsigned other_size;

void progress_redirect(char *text, unsigned size)
{
    other = text;
    other_size = size;
}

static bool to_terminal(void)
{
    return isatty(STDERR_FILENO) == 1;
}

static double interval(void)
{
    return other || to_terminal() ? on_terminal : elsewhere;
}

struct progress progress_begin(bool quiet)
{
    const double now = clock_seconds();
    return (struct progress){.quiet = quiet, .due = now + interval(), .from = now};
}

bool progress_due(const struct progress *progress, double now)
{
    return !progress->quiet && now >= progress->due;
}

void progress_say(struct progress *progress, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (other) {
        vsnprintf(other, other_size, format, arguments);
    } else {
        const bool terminal = to_terminal();
        char line[400];
        vsnprintf(line, sizeof line, format, arguments);
        fprintf(stderr, "%s%s%s", terminal ? "\r" : "", line, terminal ? "\033[K" : "\n");
        fflush(stderr);
        progress->shown = terminal;
    }
    va_end(arguments);
    progress->due = clock_seconds() + interval();
}

void progress_end(struct progress *progress)
{
    if (progress->shown)
        fputs("\r\033[K", stderr);
    progress->shown = false;
    if (other)
        other[0] = '\0';
}

const char *progress_left(const struct progress *progress, double done, char text[PROGRESS_LEFT])
{
    char time[32];
    text[0] = '\0';
    if (done > little && done <= 1) {
        text_of_seconds(time, sizeof time, (clock_seconds() - progress->from) * (1 / done - 1));
        snprintf(text, PROGRESS_LEFT, ", about %s left", time);
    }
    return text;
}
