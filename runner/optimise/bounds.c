/* bounds.c - a range as the image of all real numbers, see bounds.h. */
#include "bounds.h"

#include <math.h>
#include <stdbool.h>

static bool none(const struct bounds *b)
{
    return isinf(b->low) && isinf(b->high);
}

/* Of u from the nearest image of the lower bound, or of the upper one where it is the only one;
 * then there is one image: remainder by infinity changes nothing. */
static double from_image(const struct bounds *b, double u)
{
    const double image = isinf(b->low) ? b->high + b->margin : b->low - b->margin;
    return remainder(u - image, 2 * (b->high - b->low + 2 * b->margin));
}

double bounds_image(const struct bounds *b, double u)
{
    if (none(b))
        return u;
    const double d = fabs(from_image(b, u)), span = b->high - b->low, a = b->margin;
    const double rest = span + 2 * a - d; /* to the image of the other bound */
    if (rest < 2 * a)
        return b->high - fmin(rest * rest / (4 * a), span);
    const double inward = d < 2 * a ? d * d / (4 * a) : d - a;
    return isinf(b->low) ? b->high - inward : b->low + fmin(inward, span);
}

double bounds_preimage(const struct bounds *b, double x, double beside)
{
    if (bounds_image(b, beside) == x)
        return beside;
    if (none(b))
        return x;
    const double r = from_image(b, beside), span = b->high - b->low, a = b->margin;
    const double inward = isinf(b->low) ? b->high - x : x - b->low;
    double d = inward < a ? 2 * sqrt(a * inward) : inward + a;
    if (b->high - x < a && !isinf(b->low))
        d = span + 2 * a - 2 * sqrt(a * (b->high - x));
    return beside - r + copysign(d, r);
}
