/* refuse.c - see refuse.h. */
#include "refuse.h"

#include <stdarg.h>
#include <stdio.h>

stance_error stance_refuse(stance_message *message, stance_error error, const char *format, ...)
{
    if (message) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message->text, sizeof message->text, format, arguments);
        va_end(arguments);
    }
    return error;
}
