/* bounds.c - a range as the image of all real numbers, see bounds.h. */
#include "bounds.h"

#include <math.h>
#include <stdbool.h>

/* Whether u and x are the same there. */
static bool plain(const struct bounds *b, double u)
{
    return b->low + b->margin <= u && u <= b->high - b->margin;
}

/* Of u from the nearest vertex of the lower bound, or of the upper one where it is the only one;
 * then there is one vertex: remainder by infinity changes nothing. */
static double from_vertex(const struct bounds *b, double u)
{
    const double vertex = isinf(b->low) ? b->high + b->margin : b->low - b->margin;
    return remainder(u - vertex, 2 * (b->high - b->low + 2 * b->margin));
}

double bounds_image(const struct bounds *b, double u)
{
    if (plain(b, u))
        return u;
    const double d = fabs(from_vertex(b, u)), span = b->high - b->low, a = b->margin;
    const double rest = span + 2 * a - d; /* to the other bound's vertex */
    if (rest < 2 * a)
        return b->high - fmin(rest * rest / (4 * a), span);
    const double inward = d < 2 * a ? d * d / (4 * a) : d - a;
    return isinf(b->low) ? b->high - inward : b->low + fmin(inward, span);
}

double bounds_preimage(const struct bounds *b, double x, double beside)
{
    if (bounds_image(b, beside) == x)
        return beside;
    if (plain(b, x) && plain(b, beside))
        return x;
    const double r = from_vertex(b, beside), span = b->high - b->low, a = b->margin;
    const double inward = isinf(b->low) ? b->high - x : x - b->low;
    double d = inward < a ? 2 * sqrt(a * inward) : inward + a;
    if (b->high - x < a && !isinf(b->low))
        d = span + 2 * a - 2 * sqrt(a * (b->high - x));
    return beside - r + copysign(d, r);
}
