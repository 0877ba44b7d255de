/* critical_print.h - critical values as text, JSON and CSV. */
#ifndef STANCE_CRITICAL_CRITICAL_PRINT_H
#define STANCE_CRITICAL_CRITICAL_PRINT_H

#include "critical.h"

#include "analysis/table/table.h"

enum { CRITICAL_SHOWN = 60 }; /* rows that people see */

extern const struct say_key critical_keys[]; /* of its JSON */
/* `within`: what the outcome was narrowed to, "" for nothing. False: memory or the output fails. */
bool critical_print(const struct critical *critical, const char *within, enum table_form form);

#endif
