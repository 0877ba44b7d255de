/* ground.c - ground in plates, for those who draw it. */
#include "ground.h"

void stance_ground_at(const stance_case *c, const double *from, double x, double *height,
                      double *high)
{
    struct ground at;
    ground_at(c, from, c->body.plates, x, &at);
    *height = at.height;
    *high = at.high;
}
