/* units.h - sizes and times: as text for people, and of the clock. */
#ifndef STANCE_BASE_UNITS_H
#define STANCE_BASE_UNITS_H

#include <stddef.h>

/* "1.2 GB" and "3 min". */
void text_of_bytes(char *text, size_t size, double bytes);
void text_of_seconds(char *text, size_t size, double seconds);

/* Seconds from "90", "90s", "55m", "1h30m", "2d"; negative when it is none of these. */
double seconds_of_text(const char *text);

/* Seconds of a clock that never jumps. */
double clock_seconds(void);

#endif
