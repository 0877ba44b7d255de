/* json.h - numbers, counts and places for programs: what all of `--json` shares. */
#ifndef STANCE_TABLE_JSON_H
#define STANCE_TABLE_JSON_H

#include "runner/store/results.h"

#include <jansson.h>

/* New references, NULL: no memory. JSON knows no NAN and no infinity: they are null. */
json_t *results_json_number(double value);
json_t *results_json_whole(uint64_t value);
/* Point i of an axis: its word or its number. */
json_t *results_json_value(const struct results_axis *axis, size_t i);

#endif
