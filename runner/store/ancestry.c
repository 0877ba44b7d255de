/* ancestry.c - see ancestry.h. */
#include "ancestry.h"

#include <stdio.h>
#include <stdlib.h>

bool ancestry_read(const struct results *r, struct ancestry *ancestry, stance_message *message)
{
    double *number = NULL;
    *ancestry = (struct ancestry){0};
    const size_t before = results_words(r, "history/date", ancestry->date, STORE_MOST_ANCESTORS);
    ancestry->scenarios = before + 1;
    snprintf(ancestry->date[before], sizeof ancestry->date[before], "%.31s", r->date);
    if (before > 0 && !results_answer(r, "scenario_number", &number, message))
        return false;
    for (uint64_t i = 0; number && i < r->cases; i++)
        if (number[i] >= 0 && number[i] <= (double)before) /* NAN: not done */
            ancestry->done[(size_t)number[i]]++;
    free(number);
    return true;
}
