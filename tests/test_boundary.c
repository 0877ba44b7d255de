/* test_boundary.c - outlines run between all neighbours that differ, each once, and close to
 * boundaries that are known. */
#include "support.h"

#include "analysis/plot/boundary.h"

enum { SIDE = 48 };

static stance_message message;

/* Each point lies between two neighbours that differ; there is one between any two. Returns how
 * many lines there are. */
static size_t check_sides(const uint8_t *inside, size_t nx, size_t ny, struct boundary *b)
{
    OWN uint8_t *met = calloc(2 * nx * ny, 1);
    size_t counted = 0, listed = 0;
    assert_true(boundary_trace(b, inside, nx, ny, &message));
    for (size_t l = 0; l < b->lines; l++) {
        assert_int_equal(b->line[l].first, listed);
        assert_true(b->line[l].count >= 2);
        listed += b->line[l].count;
        for (size_t k = 0; k < b->line[l].count; k++) {
            const double *p = b->point[b->line[l].first + k];
            const size_t i = (size_t)floor(p[0]), j = (size_t)floor(p[1]);
            const bool across = p[1] == (double)j;
            assert_true(across != (p[0] == (double)i));
            assert_true(i + across < nx && j + !across < ny);
            assert_true(!inside[j * nx + i] != !inside[(j + !across) * nx + i + across]);
            uint8_t *here = &met[across ? j * nx + i : (ny + j) * nx + i];
            assert_int_equal(*here, 0);
            *here = 1;
            const bool edge = i == 0 || j == 0 || i + 1 + across >= nx || j + 2 - across >= ny;
            if (!b->line[l].closed && (k == 0 || k + 1 == b->line[l].count))
                assert_true(edge);
        }
    }
    assert_int_equal(listed, b->points);
    for (size_t j = 0; nx > 1 && ny > 1 && j < ny; j++) {
        for (size_t i = 0; i < nx; i++) {
            counted += i + 1 < nx && !inside[j * nx + i] != !inside[j * nx + i + 1];
            counted += j + 1 < ny && !inside[j * nx + i] != !inside[(j + 1) * nx + i];
        }
    }
    assert_int_equal(counted, b->points);
    return b->lines;
}

TEST(lines_run_between_neighbours)
{
    uint8_t inside[SIDE * SIDE];
    struct boundary b;
    srand(7);
    for (int map = 0; map < 300; map++) {
        const size_t nx = 1 + (size_t)rand() % 12, ny = 1 + (size_t)rand() % 12;
        const int share = rand() % 5;
        for (size_t k = 0; k < nx * ny; k++)
            inside[k] = rand() % 4 < share;
        check_sides(inside, nx, ny, &b);
        boundary_free(&b);
    }
}

/* Largest distance of the lines of a map from where `level` is 0, which grows by 1 in a cell. */
static double worst(double (*level)(double x, double y), size_t lines, bool closed)
{
    uint8_t inside[SIDE * SIDE];
    struct boundary b;
    double most = 0;
    for (size_t j = 0; j < SIDE; j++)
        for (size_t i = 0; i < SIDE; i++)
            inside[j * SIDE + i] = level((double)i, (double)j) < 0;
    assert_int_equal(check_sides(inside, SIDE, SIDE, &b), lines);
    for (size_t l = 0; l < b.lines; l++)
        assert_int_equal(b.line[l].closed, closed);
    for (size_t k = 0; k < b.points; k++)
        most = fmax(most, fabs(level(b.point[k][0], b.point[k][1])));
    boundary_free(&b);
    return most;
}

static double slope; /* of the next one */
static double half_plane(double x, double y)
{
    return (y - 20.3 - slope * (x - 24)) / hypot(1, slope);
}
static double disc(double x, double y)
{
    return hypot(x - 23.2, y - 22.7) - 15.3;
}
static double ring(double x, double y)
{
    return fabs(hypot(x - 23.2, y - 22.7) - 13.3) - 4;
}
static double dot(double x, double y)
{
    return hypot(x - 20, y - 20) - 0.5;
}

TEST(lines_are_smooth)
{
    static const double slopes[] = {0, 0.03, 0.13, 0.37, 0.5, 0.83};
    for (size_t k = 0; k < COUNT(slopes); k++) {
        slope = slopes[k];
        const double off = worst(half_plane, 1, false);
        print_message("# slope %g: off by %.3f cells\n", slope, off);
        assert_true(off < (slope < 0.1 ? 0.6 : 0.3)); /* few steps tell little of a slight slope */
    }
    const double off = worst(disc, 1, true);
    print_message("# disc: off by %.3f cells\n", off);
    assert_true(off < 0.3);
    const double two = worst(ring, 2, true);
    print_message("# ring: off by %.3f cells\n", two);
    assert_true(two < 0.35);
    assert_true(worst(dot, 1, true) < 0.5);
}
