/* test_slides - whole motions of mechanisms with joints that slide, by every method: see motions.h.
 */
#include "motions.h"

/* A bead on a rod that swings about its end, q its angle, l along (0.6, -0.8) of it from (0.1, 0),
 * with a spring and a geared motor's rotor. P = R(q) p, p = (0.1 + 0.6 l, -0.8 l):
 *   (I + m p.p) q'' + m (p x t) l'' + 2 m (p.t) l' q' = -m g (R p)_x,
 *   (m + J) l'' + m (p x t) q'' - m (p.t) q'^2 = -k (l - rest) - d l' - m g (R t)_z. */
static void bead_rate(double t, const double *x, double *rate)
{
    (void)t;
    const double m = 0.7, I = 0.3, J = 0.05, s = sin(x[0]), c = cos(x[0]);
    const double px = 0.1 + 0.6 * x[1], pz = -0.8 * x[1];
    const double along = 0.6 * px - 0.8 * pz, across = -0.8 * px - 0.6 * pz;
    const double A = I + m * (px * px + pz * pz), B = m * across, C = m + J;
    const double f = -2 * m * along * x[3] * x[2] - m * G * (c * px - s * pz);
    const double g =
        m * along * x[2] * x[2] - 20 * (x[1] - 0.4) - 0.3 * x[3] - m * G * (s * 0.6 - c * 0.8);
    rate[0] = x[2], rate[1] = x[3];
    rate[2] = (C * f - B * g) / (A * C - B * B);
    rate[3] = (A * g - B * f) / (A * C - B * B);
}
TEST(bead)
{
    ROBOT r = robot_of("body rod hinge - 1 0.3 0 0 0.4 1\n"
                       "body bead slide rod 0.7 0 0 0 0.1 0 axis 3 -4 stiffness 20 damping "
                       "0.3 rest 0.4 armature 0.05\n",
                       0.2);
    double x[MOST];
    r.c.position[0] = 1, r.c.position[1] = 0.6, r.c.velocity[0] = 2, r.c.velocity[1] = -1;
    start(&r, x);
    integrate(bead_rate, 4, 0, 0.8, NULL, x);
    arrives("bead on a rod", &r, 0.008, 0.8, x, 0);
}

/* A hopper of body M and shoe m, on a spring k along the leg: in flight, tilted by a, the length l
 * swings about its rest with k (1/m + 1/M), the centre of mass falls. Foot and body in one place
 * at l = 0. */
#define HOPPER                                                                                     \
    "body leg free - 4 0.1 0 0 0 0\nbody shoe slide leg 0.5 0.001 0 0 0 0 axis 0 -1 stiffness "    \
    "900 "
static const double sprung = 4, unsprung = 0.5;
TEST(hopper_in_flight)
{
    ROBOT r = robot_of(HOPPER "rest 0.5\n", 0.1);
    const double a = 0.3, T = 0.4, share = unsprung / (sprung + unsprung);
    const double swing = sqrt(900 * (1 / sprung + 1 / unsprung));
    r.c.position[1] = 2, r.c.position[2] = a, r.c.position[3] = 0.3;
    r.c.velocity[0] = 1, r.c.velocity[3] = 2;
    const double l = 0.5 - 0.2 * cos(swing * T) + 2 / swing * sin(swing * T);
    const double rate = 0.2 * swing * sin(swing * T) + 2 * cos(swing * T);
    /* The body is `share` of l before the centre of mass. */
    const double more = share * (l - 0.3);
    const double vx = 1 + share * 2 * sin(a), vz = -share * 2 * cos(a); /* of the centre of mass */
    const double end[MOST] = {
        vx * T - sin(a) * more,     2 + vz * T - G * T * T / 2 + cos(a) * more, a, l,
        vx - sin(a) * share * rate, vz - G * T + cos(a) * share * rate,         0, rate};
    arrives("hopper in flight", &r, 0.0004, T, end, 0);
}

/* The shoe comes to its stop: body and shoe go on together. */
TEST(slide_stops_in_flight)
{
    ROBOT r = robot_of("body leg free - 4 0.1 0 0 0 0\nbody shoe slide leg 0.5 0.001 0 0 0 0 "
                       "axis 0 -1 limits 0 0.25\n",
                       0);
    const double T = 0.4, v = 2, share = unsprung / (sprung + unsprung);
    r.c.position[1] = 3, r.c.position[3] = 0.05, r.c.velocity[3] = v;
    for (const stance_method *const *m = stance_methods(); *m; m++) {
        const stance_result end = run(&r, *m, 1e-3, T);
        near((*m)->name, "length", end.position[3], 0.25, 1e-9);
        near((*m)->name, "its rate", end.velocity[3], 0, 1e-9);
        near((*m)->name, "vz", end.velocity[1], -share * v - G * T, 1e-9);
        near((*m)->name, "z", end.position[1], 3 - share * v * T + share * 0.2 - G * T * T / 2,
             4e-3);
        near((*m)->name, "angle", end.position[2], 0, 1e-9);
        assert_true(end.max_penetration <= 1e-9);
    }
}

/* It hops upright: x = (height of the body, length, rates). In flight body and shoe accelerate by
 * the spring, F = k (rest - l) - d l'; the foot lands and stays, while m g + F > 0. */
static bool stands;
static double thrust(const double *x)
{
    return 900 * (0.5 - x[1]) - 6 * x[3];
}
static void hop_rate(double t, const double *x, double *rate)
{
    (void)t;
    rate[0] = x[2], rate[1] = x[3];
    rate[2] = -G + thrust(x) / sprung;
    rate[3] = rate[2] + (stands ? 0 : G + thrust(x) / unsprung);
}
static double until_hop(const double *x)
{
    return stands ? unsprung * G + thrust(x) : x[0] - x[1];
}
TEST(hopper_hops)
{
    const double T = 1.6;
    ROBOT r = robot_of(HOPPER "damping 6 rest 0.5\npoint foot shoe 0 0\n", 0);
    double x[MOST] = {0.75, 0.5, 0, 0};
    int events = 0;
    r.c.position[1] = x[0], r.c.position[3] = x[1];
    stands = false;
    for (double t = 0; t < T;) {
        t = integrate(hop_rate, 4, t, T, until_hop, x);
        if (t < T) {
            stands = !stands, events++;
            if (stands)
                x[3] = x[2], x[0] = x[1];
        }
    }
    print_message("# hopper: %d landings and lift-offs\n", events);
    assert_true(events >= 5);
    const double end[MOST] = {0, x[0], 0, x[1], 0, x[2], 0, x[3]};
    arrives("hopper hops", &r, 0.0005, T, end, 600);
}

/* Slides on slides and beyond hinges. */
TEST(slides_in_flight)
{
    flies("body base free - 3 0.1 0.05 0.1 0 0\n"
          "body boom slide base 1 0.02 0.1 0.02 0.1 0.3 axis 3 1 stiffness 40 rest 0.2\n"
          "body mast slide boom 0.7 0.03 0.05 0.2 0.2 0.1 axis -0.5 1 armature 0.2 stiffness 60\n"
          "body hand hinge mast 0.5 0.01 0.1 -0.2 0.05 0.3\n"
          "body nail slide hand 0.2 0.002 0.03 0.02 0.1 0.05 axis 1 0 stiffness 80\n",
          5.4, 0.5, 2);
}
