/* refuse.h - errors with a sentence, within the engine. */
#ifndef STANCE_REFUSE_H
#define STANCE_REFUSE_H

#include "stance.h"

/* Writes the sentence, where there is room for one, and returns the error. */
stance_error stance_refuse(stance_message *message, stance_error error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
