/* units.c - sizes and times for people. */
#include "units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

void text_of_bytes(char *text, size_t size, double bytes)
{
    static const char *const unit[] = {"B", "kB", "MB", "GB", "TB", "PB"};
    int u = 0;
    for (; bytes >= 1000 && u < 5; u++)
        bytes /= 1000;
    snprintf(text, size, u == 0 ? "%.0f %s" : "%.1f %s", bytes, unit[u]);
}

void text_of_seconds(char *text, size_t size, double seconds)
{
    if (seconds < 120)
        snprintf(text, size, "%.3g s", seconds);
    else if (seconds < 7200)
        snprintf(text, size, "%.0f min", seconds / 60);
    else
        snprintf(text, size, "%.1f h", seconds / 3600);
}

double seconds_of_text(const char *text)
{
    double total = 0;
    while (*text) {
        static const char letters[] = "smhd";
        static const double seconds[] = {1, 60, 3600, 86400};
        char *end;
        const double value = strtod(text, &end);
        const char *letter = *end ? strchr(letters, *end) : letters;
        if (end == text || !(value >= 0) || !isfinite(value) || !letter)
            return -1;
        total += value * seconds[letter - letters];
        text = *end ? end + 1 : end;
    }
    return total;
}

double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
