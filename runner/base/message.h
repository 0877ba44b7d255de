/* message.h - why something failed: said where it is found out, and returned from there as false.
 */
#ifndef STANCE_BASE_MESSAGE_H
#define STANCE_BASE_MESSAGE_H

#include "engine/stance.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* What every report of a failure returns; inline, so that a static analyser sees that it is false.
 */
static inline bool as_false(void)
{
    return false;
}

/* Puts one line into a stance_message. Returns false. */
#define complain(message, ...)                                                                     \
    (snprintf((message)->text, sizeof(message)->text, __VA_ARGS__), as_false())

/* Adds to the end of a text of `size` bytes, as printf has it; what has no room is left out. */
#define add_text(text, size, ...) snprintf((text) + strlen(text), (size)-strlen(text), __VA_ARGS__)

static inline bool no_memory(stance_message *message)
{
    return complain(message, "not enough memory");
}

#endif
