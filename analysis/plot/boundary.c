/* boundary.c - traces the lines and lets them bend least. */
#include "boundary.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>

/* ---- tracing ------------------------------------------------------------------------------ */

/* Sides between neighbouring cases, from each case (i, j) the one to the right, number j nx + i,
 * and after all these the one upwards. A line crosses sides whose ends differ, and goes from one to
 * the next through a square of four cases. */
struct trace {
    const uint8_t *inside;
    size_t nx, ny;
    size_t (*next)[2]; /* of each side, one more than the sides where a line goes on; 0: none */
    bool *met;
    bool *horizontal; /* [points] whether a point may move along x */
    struct boundary *b;
};

static bool is_crossed(const struct trace *t, size_t side)
{
    const bool up = side >= t->nx * t->ny;
    const size_t from = up ? side - t->nx * t->ny : side;
    return t->inside[from] != t->inside[from + (up ? t->nx : 1)];
}

static void join(struct trace *t, size_t a, size_t b)
{
    t->next[a][t->next[a][0] > 0] = b + 1;
    t->next[b][t->next[b][0] > 0] = a + 1;
}

/* Of the square whose lowest case is (i, j). Of two cases inside across from each other each keeps
 * to its own corner. */
static void join_square(struct trace *t, size_t i, size_t j)
{
    const size_t from = j * t->nx + i, up = t->nx * t->ny + from;
    const size_t side[] = {from, up, from + t->nx, up + 1}; /* below, left, above, right */
    size_t crossed[4], count = 0;
    for (int k = 0; k < 4; k++)
        if (is_crossed(t, side[k]))
            crossed[count++] = side[k];
    if (count == 2) {
        join(t, crossed[0], crossed[1]);
    } else if (count == 4) {
        const int other = t->inside[from] ? 1 : 3;
        join(t, side[0], side[other]);
        join(t, side[2], side[4 - other]);
    }
}

/* The line from a side on, if it is crossed and new. */
static void follow(struct trace *t, size_t side)
{
    struct boundary *const b = t->b;
    struct boundary_line line = {.first = b->points, .closed = t->next[side][1] > 0};
    if (t->met[side] || t->next[side][0] == 0)
        return;
    for (size_t at = side + 1; at > 0;) {
        const size_t here = at - 1, all = t->nx * t->ny;
        const bool up = here >= all;
        const size_t from = up ? here - all : here, row = from / t->nx;
        t->met[here] = true;
        t->horizontal[b->points] = !up;
        b->point[b->points][0] = (double)(from % t->nx);
        b->point[b->points++][1] = (double)row;
        at = 0;
        for (int k = 1; k >= 0 && at == 0; k--)
            if (t->next[here][k] > 0 && !t->met[t->next[here][k] - 1])
                at = t->next[here][k];
    }
    line.count = b->points - line.first;
    b->line[b->lines++] = line;
}

static bool trace_lines(struct trace *t)
{
    const size_t all = 2 * t->nx * t->ny;
    t->next = calloc(all, sizeof *t->next);
    t->met = calloc(all, sizeof *t->met);
    t->horizontal = calloc(all, sizeof *t->horizontal);
    t->b->point = calloc(all, sizeof *t->b->point);
    t->b->line = calloc(all, sizeof *t->b->line);
    if (!t->next || !t->met || !t->horizontal || !t->b->point || !t->b->line)
        return false;
    for (size_t j = 0; j + 1 < t->ny; j++)
        for (size_t i = 0; i + 1 < t->nx; i++)
            join_square(t, i, j);
    for (int closed = 0; closed < 2; closed++) /* those that end at the map's edges first */
        for (size_t side = 0; side < all; side++)
            if (closed || t->next[side][1] == 0)
                follow(t, side);
    return true;
}

/* ---- bending ------------------------------------------------------------------------------ */

enum { MOST_SWEEPS = 2000 };
static const double most_work = 4e7; /* points times sweeps */
static const double margin = 0.05;   /* from the cases */

/* Difference of the unit tangents before and after point k of a line, its own length, neighbours
 * and theirs. */
struct bend {
    double e[2], before, after; /* reciprocal lengths */
};

static struct bend bend_at(double (*point)[2], size_t before, size_t k, size_t after)
{
    const double least = 0.2; /* neighbours may all but meet in a corner */
    struct bend b;
    b.before =
        1 / fmax(least, hypot(point[k][0] - point[before][0], point[k][1] - point[before][1]));
    b.after = 1 / fmax(least, hypot(point[after][0] - point[k][0], point[after][1] - point[k][1]));
    for (int c = 0; c < 2; c++)
        b.e[c] =
            (point[after][c] - point[k][c]) * b.after - (point[k][c] - point[before][c]) * b.before;
    return b;
}

/* A step of Newton's for one point along its side, the lengths as they are. */
static double step_of(double (*point)[2], const struct boundary_line *line, size_t k, int c)
{
    const size_t n = line->count;
    double slope = 0, curvature = 0;
    for (int shift = -1; shift <= 1; shift++) {
        /* The bend at k + shift, which point k is after, at or before; ends have none. */
        const long at = (long)k + shift;
        if (!line->closed && (at < 1 || at + 1 >= (long)n))
            continue;
        const size_t m = (size_t)(at + (long)n) % n;
        const struct bend b = bend_at(point, (m + n - 1) % n, m, (m + 1) % n);
        const double weight = shift < 0 ? b.after : shift > 0 ? b.before : -(b.before + b.after);
        slope += weight * b.e[c];
        curvature += weight * weight;
    }
    return curvature > 0 ? -slope / curvature : 0;
}

static void relax(const struct trace *t, const struct boundary_line *line)
{
    double(*const point)[2] = t->b->point + line->first;
    const bool *const horizontal = t->horizontal + line->first;
    const double share = most_work / (double)(t->b->points + 1);
    const int sweeps = share < MOST_SWEEPS ? (int)share + 1 : MOST_SWEEPS;
    for (size_t k = 0; k < line->count; k++)
        point[k][horizontal[k] ? 0 : 1] += 0.5;
    if (line->count < 4)
        return;
    for (int sweep = 0; sweep < sweeps; sweep++) {
        for (size_t k = 0; k < line->count; k++) {
            const int c = horizontal[k] ? 0 : 1;
            const double low = floor(point[k][c]) + margin;
            point[k][c] =
                fmin(low + 1 - 2 * margin, fmax(low, point[k][c] + step_of(point, line, k, c)));
        }
    }
}

bool boundary_trace(struct boundary *b, const uint8_t *inside, size_t nx, size_t ny,
                    stance_message *message)
{
    *b = (struct boundary){0};
    struct trace t = {.inside = inside, .nx = nx, .ny = ny, .b = b};
    const bool good = trace_lines(&t);
    for (size_t k = 0; good && k < b->lines; k++)
        relax(&t, &b->line[k]);
    free(t.next);
    free(t.met);
    free(t.horizontal);
    if (!good)
        boundary_free(b);
    return good || no_memory(message);
}

void boundary_free(struct boundary *b)
{
    free(b->point);
    free(b->line);
    *b = (struct boundary){0};
}
