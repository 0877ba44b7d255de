/* json.c - see json.h. */
#include "json.h"

#include <math.h>

json_t *results_json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *results_json_whole(uint64_t value)
{
    return json_integer((json_int_t)value);
}

json_t *results_json_value(const struct results_axis *axis, size_t i)
{
    return axis->word ? json_string(axis->word[i]) : results_json_number(axis->value[i]);
}
