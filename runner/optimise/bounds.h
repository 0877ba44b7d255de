/* bounds.h - a range as the image of all real numbers.
 *
 * Where the best lies on a bound, a normal distribution that is cut or clipped there is repelled
 * from it and loses its width before the other coordinates have arrived. So the search goes on in u
 * without bounds, and x(u) is within them (as pycma does, N. Hansen). More than a margin from the
 * bounds x is u; nearer it is a parabola with its vertex on the bound
 *
 *   x = low + (u - low + margin)^2 / (4 margin),    low - margin <= u <= low + margin
 *
 * and beyond the vertex, where u is low - margin or high + margin, the same mirrored, and so on.
 * The slope of x(u) is continuous: what grows towards a bound has a smooth optimum in u.
 */
#ifndef STANCE_OPTIMISE_BOUNDS_H
#define STANCE_OPTIMISE_BOUNDS_H

/* low < high; -INFINITY, INFINITY: none. margin: above 0, at most half of high - low. Finite ones
 * up to 1e100. */
struct bounds {
    double low, high, margin;
};

/* x(u), low ... high. u finite. */
double bounds_image(const struct bounds *b, double u);
/* A number whose image is x, low ... high: `beside` if it is one, otherwise on the same side of all
 * vertices. */
double bounds_preimage(const struct bounds *b, double x, double beside);

#endif
