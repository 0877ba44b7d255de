/* test_exponent.c - the uncertainty exponent of fractals of known dimension and of smooth
 * boundaries, how often it is within its error, when there is none, and what is called fractal. */
#include "long.h"
#include "support.h"

#include "cases.h"

#include "analysis/basin/basin_map.h"

/* ---- maps of the unit square, somewhere in a plane --------------------------------------- */

/* What stands at a point; p[4]: random numbers of the map, evenly in (0, 1); c: the map's own. */
typedef int (*painter)(double x, double y, double c, const double *p);

/* Stripes: the gaps of Cantor's set of two parts of length c, coloured by their stage. */
static int stripes(double x, double y, double c, const double *p)
{
    (void)y;
    x += 0.1 * (p[0] - 0.5);
    for (int stage = 0; stage < 40; stage++) {
        if (x > c && x < 1 - c)
            return stage % 2;
        x = x <= c ? x / c : (x - 1 + c) / c;
        if (x < 0 || x > 1)
            return 0;
    }
    return 0;
}
static int turned_stripes(double x, double y, double c, const double *p)
{
    const double a = 2 * M_PI * p[1];
    return stripes(0.5 + 0.6 * ((x - 0.5) * cos(a) + (y - 0.5) * sin(a)), 0, c, p);
}

/* Squares cut into base^2, of which those that `keeps` names are cut on, and the others have the
 * colour of their stage: Vicsek's cross, dust, dust of nine. */
static bool cross(int i, int j)
{
    return i == 1 || j == 1;
}
static bool corners(int i, int j)
{
    return i != 1 && j != 1;
}
static bool nine(int i, int j)
{
    return i != 1 && j != 2;
}
static const struct {
    int base;
    bool (*keeps)(int i, int j);
} cut[] = {{3, cross}, {3, corners}, {4, nine}};

static int squares(double x, double y, double c, const double *p)
{
    const int base = cut[(int)c].base;
    x = 0.1 + 0.8 * x + 0.1 * (p[0] - 0.5);
    y = 0.1 + 0.8 * y + 0.1 * (p[1] - 0.5);
    for (int stage = 0; stage < 12; stage++) {
        const int i = (int)(x * base), j = (int)(y * base);
        if (!cut[(int)c].keeps(i, j))
            return (stage + 1) % 2;
        x = x * base - i;
        y = y * base - j;
    }
    return 0;
}

/* Graphs of Weierstrass's and Takagi's functions: dimensions 2 - c and 2 + log2 c. */
static int weierstrass(double x, double y, double c, const double *p)
{
    double sum = 0, all = 0;
    for (int k = 0; k < 16; k++) {
        sum += pow(2.3, -c * k) * cos(pow(2.3, k) * 6 * (x + p[0]) + 1.7 * k);
        all += pow(2.3, -c * k);
    }
    return y < 0.5 + 0.4 * sum / all;
}
static int takagi(double x, double y, double c, const double *p)
{
    double sum = 0, height = 1, place = 0.9 * x + 0.1 * p[0];
    for (int k = 0; k < 20; k++, height *= c, place *= 2)
        sum += height * fabs(place - round(place));
    return y < 0.2 + 0.5 * sum * (1 - c);
}

static int koch(double x, double y, double c, const double *p)
{
    (void)c;
    return below_koch(0.05 * p[0] + 0.95 * x, y - 0.5 - 0.2 * p[1], 12);
}

/* Basins of z^2 + c, somewhere about their middle: of infinity, and of each point of the cycle of
 * length `cycle`. The Julia set between them has the dimension 1.26835 for c = -1, 1.3934 for
 * Douady's rabbit (C. McMullen, Hausdorff dimension and conformal dynamics III, Am. J. Math. 120,
 * 1998). */
static const struct {
    double re, im;
    int cycle;
} square[] = {{-1, 0, 2}, {-0.122561166876654, 0.744861766619744, 3}};

static int julia(double x, double y, double c, const double *p)
{
    const int cycle = square[(int)c].cycle;
    double a = 2.6 * (x - 0.5) + 0.2 * (p[0] - 0.5), b = 2.6 * (y - 0.5) + 0.2 * (p[1] - 0.5);
    double least = INFINITY;
    int colour = 0;
    for (int k = 0; k < 600 + cycle; k++) {
        const double next = a * a - b * b + square[(int)c].re;
        b = 2 * a * b + square[(int)c].im;
        a = next;
        if (a * a + b * b > 16)
            return 0;
        /* Of the last ones the nearest to zero tells the phase. */
        if (k >= 600 && a * a + b * b < least) {
            least = a * a + b * b;
            colour = 1 + k % cycle;
        }
    }
    return colour > 2 ? 2 : colour; /* the outcomes are four */
}
static int line(double x, double y, double c, const double *p)
{
    const double a = 2 * M_PI * p[0];
    (void)c;
    return cos(a) * (x - 0.5) + sin(a) * (y - 0.5) < 0.2 * p[1] - 0.1;
}
static int along(double x, double y, double c, const double *p)
{
    (void)y, (void)c;
    return x < 0.3 + 0.4 * p[0];
}
static int disc(double x, double y, double c, const double *p)
{
    (void)c;
    return hypot(x - 0.5, y - 0.5) < 0.2 + 0.2 * p[0];
}
static int wave(double x, double y, double c, const double *p)
{
    return y < 0.5 + 0.2 * sin(c * (x + p[0]));
}
/* Of width c, straight or bent. */
static int band(double x, double y, double c, const double *p)
{
    const double a = 2 * M_PI * p[0];
    return fabs(cos(a) * (x - 0.5) + sin(a) * (y - 0.5) + 0.1 * p[1] - 0.05) < c / 2;
}
static int bent_band(double x, double y, double c, const double *p)
{
    return fabs(y - 0.5 - 0.2 * sin(6 * (x + p[0]))) < c / 2;
}
/* Three colours in turn, c of each along an edge. */
static int three(double x, double y, double c, const double *p)
{
    return (int)floor(3 * c * (x + 0.1 * y + p[0])) % 3;
}

/* A map of n x n cases. Freed by the caller. */
static uint8_t *paint(size_t n, painter colour, double c, const double *p, double *place)
{
    uint8_t *kind = room(n * n);
    for (size_t i = 0; i < n; i++)
        place[i] = ((double)i + 0.5) / (double)n;
    for (size_t i = 0; i < n * n; i++)
        kind[i] = (uint8_t)(RESULTS_STABILISED + colour(place[i / n], place[i % n], c, p));
    return kind;
}

struct measured {
    struct basin_exponent exponent;
    bool fractal;
    double s_bb;
};
enum { MOST = 1025 };

static struct measured measure(size_t n, painter colour, double c, const double *p)
{
    static double place[MOST];
    OWN uint8_t *kind = paint(n, colour, c, p, place);
    const struct basin_map map = {2, {n, n}, {place, place}, n * n, kind};
    struct basin_uncertainty u = {.scales = basin_map_scales(&map)};
    struct basin_entropy e = {0};
    basin_map_uncertainty(&map, &u);
    basin_map_entropy(&map, 5, &e);
    return (struct measured){basin_exponent(&u), basin_is_fractal(&e, &u),
                             basin_boundary_entropy(&e)};
}

/* ---- coverage ----------------------------------------------------------------------------- */

TEST(alphas_are_within_their_errors)
{
    static const struct {
        const char *name;
        painter colour;
        double c, alpha; /* alpha 0: that of c stripes */
    } maps[] = {
        {"stripes", stripes, 1 / 3.0, 0},
        {"stripes", stripes, 0.2, 0},
        {"stripes", stripes, 0.25, 0},
        {"stripes", stripes, 0.4, 0},
        {"stripes", stripes, 0.45, 0},
        {"turned stripes", turned_stripes, 0.25, 0},
        {"turned stripes", turned_stripes, 1 / 3.0, 0},
        {"turned stripes", turned_stripes, 0.4, 0},
        {"Vicsek", squares, 0, 0.53503},
        {"dust", squares, 1, 0.73814},
        {"dust of nine", squares, 2, 0.41504},
        {"Weierstrass", weierstrass, 0.3, 0.3},
        {"Weierstrass", weierstrass, 0.5, 0.5},
        {"Weierstrass", weierstrass, 0.7, 0.7},
        {"Takagi", takagi, 0.7, 0.51457},
        {"Takagi", takagi, 0.8, 0.32193},
        {"Koch", koch, 0, 0.73814},
        {"z^2 - 1", julia, 0, 0.73165},
        {"rabbit", julia, 1, 0.6066},
        {"line", line, 0, 1},
        {"along an axis", along, 0, 1},
        {"disc", disc, 0, 1},
        {"wave", wave, 12, 1},
        {"wave", wave, 40, 1},
        {"band", band, 0.1, 1},
        {"band", band, 0.05, 1},
        {"band", band, 0.02, 1},
        {"band", band, 0.01, 1},
        {"bent band", bent_band, 0.03, 1},
        {"three colours", three, 2, 1},
        {"three colours", three, 8, 1},
        {"three colours", three, 40, 1},
    };
    const bool patient = long_tests();
    const int tries = patient ? 40 : 3;
    int held[2] = {0}, given[2] = {0};
    uint64_t random = 3;
    for (size_t k = 0; k < COUNT(maps); k++) {
        const double alpha = maps[k].alpha > 0 ? maps[k].alpha : 1 + log(2) / log(maps[k].c);
        const bool smooth = alpha == 1;
        for (size_t n = 256; n <= (patient ? 1024 : 512); n *= 2) {
            double mean = 0, error = 0, far = 0;
            int own = 0, inside = 0, refused[BASIN_REFUSALS] = {0}, stars = 0;
            for (int t = 0; t < tries; t++) {
                double p[4];
                for (int i = 0; i < 4; i++)
                    p[i] = uniform(&random, 0, 1);
                const struct measured m = measure(n, maps[k].colour, maps[k].c, p);
                refused[m.exponent.refusal]++;
                stars += m.fractal;
                if (m.exponent.refusal != BASIN_FITTED) {
                    assert_true(isnan(m.exponent.alpha) && isnan(m.exponent.error));
                    continue;
                }
                own++;
                const double off = (m.exponent.alpha - alpha) / m.exponent.error;
                inside += fabs(off) <= 2 || fabs(m.exponent.alpha - alpha) < 1e-3;
                far = fmax(far, fabs(off));
                mean += m.exponent.alpha;
                error += m.exponent.error;
            }
            print_message("# %s %.2f, %zu places: alpha %.3f, found %.3f +- %.3f, %d of %d within "
                          "two (farthest %.1f), no alpha: %d wide, %d bent, %d else; %d stars\n",
                          maps[k].name, maps[k].c, n, alpha, mean / own, error / own, inside, own,
                          far, refused[BASIN_WIDE], refused[BASIN_BENT],
                          refused[BASIN_SMALL] + refused[BASIN_NONE] + refused[BASIN_FEW], stars);
            assert_true(inside >= 0.85 * own - 1);
            held[smooth] += inside;
            given[smooth] += own;
            assert_true(!smooth || stars == 0);
            assert_true(!smooth || own == 0 || fabs(mean / own - 1) < 0.25);
        }
    }
    print_message("# within two errors: %d of %d fractals, %d of %d smooth maps\n", held[0],
                  given[0], held[1], given[1]);
    assert_true(held[0] >= 0.93 * given[0] && held[1] >= 0.93 * given[1]);
}

/* Bands of any width: alpha is 1 within its error, or there is a reason for none, whatever the
 * resolution; the distances that reach their width are left out. No band is a fractal. */
TEST(thin_bands_are_smooth)
{
    static const double widths[] = {0.2, 0.1, 0.06, 0.03, 0.015};
    for (size_t w = 0; w < COUNT(widths); w++) {
        for (size_t n = 65; n <= 1025; n = 2 * n - 1) {
            int given = 0, held = 0;
            double farthest = 0;
            for (int t = 0; t < 4; t++) {
                const double p[4] = {0.13 + 0.21 * t, 0.3 * t};
                for (int bent = 0; bent < 2; bent++) {
                    const struct measured m = measure(n, bent ? bent_band : band, widths[w], p);
                    const double off = fabs(m.exponent.alpha - 1);
                    assert_false(m.fractal);
                    if (m.exponent.refusal != BASIN_FITTED)
                        continue;
                    given++;
                    held += off <= 2 * m.exponent.error + 1e-3;
                    farthest = fmax(farthest, off);
                    assert_true(n >= 96);
                }
            }
            print_message("# width %.3f, %zu places (%.0f cells): alpha for %d of 8 bands, %d "
                          "within two errors, at most %.3f off\n",
                          widths[w], n, widths[w] * (double)n, given, held, farthest);
            assert_true(held == given);
            assert_true(widths[w] * (double)n < 30 || given == 8);
            assert_true(widths[w] * (double)n < 15 || farthest < 0.1);
        }
    }
}

/* Smooth stripes of three colours that are thinner than a box are no fractal, though S_bb is above
 * log 2; three colours that meet in ever smaller squares are one. */
static int wada(double x, double y, double c, const double *p)
{
    (void)c;
    x = 0.05 + 0.9 * x + 0.05 * p[0];
    y = 0.05 + 0.9 * y + 0.05 * p[1];
    for (int stage = 0; stage < 9; stage++) {
        const int i = (int)(x * 3), j = (int)(y * 3);
        if (i == 1 && j == 1)
            return 2;
        if ((i == 1) != (j == 1) && (stage + i + j) % 2)
            return (i + j + stage) / 2 % 2;
        x = x * 3 - i;
        y = y * 3 - j;
    }
    return 0;
}

TEST(stars_are_for_fractals)
{
    const double p[4] = {0.3, 0.7};
    for (int per_side = 10; per_side <= 80; per_side *= 2) {
        const struct measured m = measure(512, three, per_side, p);
        print_message("# %d stripes of each colour: S_bb %.3f\n", per_side, m.s_bb);
        assert_true(per_side < 80 || m.s_bb > log(2));
        assert_false(m.fractal);
    }
    const struct measured m = measure(729, wada, 0, p);
    print_message("# squares: S_bb %.3f, alpha %.3f +- %.3f, %s\n", m.s_bb, m.exponent.alpha,
                  m.exponent.error, basin_refusal_words[m.exponent.refusal]);
    assert_true(m.fractal);
}
