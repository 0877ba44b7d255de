/* bounds.h - a range as the image of all real numbers.
 *
 * Where the best lies on a bound, a normal distribution that is cut there or clipped is repelled
 * from it and loses its width before the other coordinates have arrived. So the search goes on
 * without bounds, in u, and x(u) is within them (the default of pycma, N. Hansen): u where both are
 * 2 margins away from the bounds' images, a parabola nearer, and mirrored beyond, with an image of
 * the bound at low - margin (high + margin):
 *
 *   x = low + (u - low + margin)^2 / (4 margin)     for |u - low + margin| < 2 margin
 *
 * x(u) has a continuous slope, 0 at the bounds only: what grows towards a bound has a smooth
 * optimum there.
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
 * images of the bounds. */
double bounds_preimage(const struct bounds *b, double x, double beside);

#endif
