/* outlook.c - see outlook.h. */
#include "outlook.h"

#include "runner/base/units.h"

#include <math.h>

static const double remembered = 0.6; /* of what was known, each time more is */

void outlook_begin(struct outlook *outlook, double cases)
{
    outlook->ahead = fmax(0, outlook->ahead - cases);
    outlook->now = cases;
    outlook->begun = clock_seconds();
}

void outlook_end(struct outlook *outlook, double simulated, double apart)
{
    const double taken = clock_seconds() - outlook->begun - apart;
    outlook->seconds = remembered * outlook->seconds + taken;
    outlook->cases = remembered * outlook->cases + simulated;
    outlook->now = 0;
}

double outlook_left(const struct outlook *outlook)
{
    if (!(outlook->cases > 0))
        return -1;
    const double each = outlook->seconds / outlook->cases;
    const double spent = outlook->now > 0 ? clock_seconds() - outlook->begun : 0;
    return outlook->ahead * each + fmax(0, outlook->now * each - spent);
}
