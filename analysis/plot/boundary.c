/* boundary.c - traces the lines and lets them bend least. */
#include "boundary.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>

/* ---- tracing ------------------------------------------------------------------------------ */

enum side { BOTTOM, RIGHT, TOP, LEFT };

/* A square of four neighbouring cases, the lowest of them (i, j), and one of its sides. */
struct place {
    size_t i, j;
    enum side side;
};

struct map {
    const uint8_t *inside;
    size_t nx, ny;
    uint8_t *met; /* of each side, horizontal ones first */
};

static bool is_inside(const struct map *m, size_t i, size_t j)
{
    return m->inside[j * m->nx + i] != 0;
}

/* The lower or left end of a side. */
static void begin_of(const struct place *p, size_t *i, size_t *j)
{
    *i = p->i + (p->side == RIGHT);
    *j = p->j + (p->side == TOP);
}

static bool is_horizontal(const struct place *p)
{
    return p->side == BOTTOM || p->side == TOP;
}

/* Whether the ends of a side differ. */
static bool is_crossed(const struct map *m, const struct place *p)
{
    size_t i, j;
    begin_of(p, &i, &j);
    const bool horizontal = is_horizontal(p);
    return is_inside(m, i, j) != is_inside(m, i + horizontal, j + !horizontal);
}

static uint8_t *met_at(const struct map *m, const struct place *p)
{
    size_t i, j;
    begin_of(p, &i, &j);
    return is_horizontal(p) ? &m->met[j * m->nx + i] : &m->met[(m->ny + j) * m->nx + i];
}

/* Where a line that comes in through a side of a square goes out. Of two cases inside across from
 * each other each keeps to its own corner. */
static enum side way_out(const struct map *m, const struct place *p)
{
    static const enum side round_lowest[] = {LEFT, TOP, RIGHT, BOTTOM};
    static const enum side round_next[] = {RIGHT, BOTTOM, LEFT, TOP};
    enum side out = p->side;
    int crossed = 0;
    for (int s = BOTTOM; s <= LEFT; s++) {
        const struct place other = {p->i, p->j, (enum side)s};
        if (is_crossed(m, &other)) {
            crossed++;
            out = other.side == p->side ? out : other.side;
        }
    }
    if (crossed == 4)
        out = is_inside(m, p->i, p->j) ? round_lowest[p->side] : round_next[p->side];
    return out;
}

/* The same side, of the square beyond it; false: there is none. */
static bool go_beyond(const struct map *m, struct place *p)
{
    static const enum side opposite[] = {TOP, LEFT, BOTTOM, RIGHT};
    p->i +=
        (size_t)(p->side == RIGHT) - (p->side == LEFT); /* before the first is beyond the last */
    p->j += (size_t)(p->side == TOP) - (p->side == BOTTOM);
    p->side = opposite[p->side];
    return p->i < m->nx - 1 && p->j < m->ny - 1;
}

/* Points are kept as the lower or left end of their side, and which way it goes. */
struct trace {
    struct map map;
    struct boundary *b;
    uint8_t *horizontal; /* [points] */
};

/* As many points as sides whose ends differ; and no more lines. */
static bool make_room(struct trace *t)
{
    const size_t nx = t->map.nx, ny = t->map.ny;
    size_t sides = 1;
    for (size_t j = 0; j < ny; j++) {
        for (size_t i = 0; i < nx; i++) {
            sides += i + 1 < nx && is_inside(&t->map, i, j) != is_inside(&t->map, i + 1, j);
            sides += j + 1 < ny && is_inside(&t->map, i, j) != is_inside(&t->map, i, j + 1);
        }
    }
    t->map.met = calloc(2 * nx * ny + 1, 1);
    t->horizontal = calloc(sides, 1);
    t->b->point = calloc(sides, sizeof *t->b->point);
    t->b->line = calloc(sides, sizeof *t->b->line);
    return t->map.met && t->horizontal && t->b->point && t->b->line;
}

/* The next point of the last line. */
static void add(struct trace *t, const struct place *p)
{
    struct boundary *const b = t->b;
    size_t i, j;
    begin_of(p, &i, &j);
    *met_at(&t->map, p) = 1;
    t->horizontal[b->points] = is_horizontal(p);
    b->point[b->points][0] = (double)i;
    b->point[b->points++][1] = (double)j;
    b->line[b->lines - 1].count++;
}

/* The line that comes into a square through a side; nothing where one went through already. */
static void follow(struct trace *t, struct place p)
{
    struct boundary *const b = t->b;
    if (!is_crossed(&t->map, &p) || *met_at(&t->map, &p))
        return;
    b->line[b->lines++] = (struct boundary_line){b->points, 0, false};
    for (bool goes_on = true; goes_on;) {
        add(t, &p);
        p.side = way_out(&t->map, &p);
        const struct place out = p;
        if (!go_beyond(&t->map, &p)) {
            goes_on = false;
            add(t, &out);
        } else if (*met_at(&t->map, &p)) {
            goes_on = false;
            b->line[b->lines - 1].closed = true;
        }
    }
}

/* Lines that end at the edges first: what is left then is closed. */
static void follow_all(struct trace *t)
{
    const size_t nx = t->map.nx, ny = t->map.ny;
    if (nx < 2 || ny < 2)
        return;
    for (size_t i = 0; i + 1 < nx; i++) {
        follow(t, (struct place){i, 0, BOTTOM});
        follow(t, (struct place){i, ny - 2, TOP});
    }
    for (size_t j = 0; j + 1 < ny; j++) {
        follow(t, (struct place){0, j, LEFT});
        follow(t, (struct place){nx - 2, j, RIGHT});
    }
    for (size_t j = 0; j + 1 < ny; j++)
        for (size_t i = 0; i + 1 < nx; i++)
            follow(t, (struct place){i, j, BOTTOM});
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
    const uint8_t *const horizontal = t->horizontal + line->first;
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
    struct trace t = {.map = {inside, nx, ny, NULL}, .b = b};
    const bool good = make_room(&t);
    if (good)
        follow_all(&t);
    for (size_t k = 0; good && k < b->lines; k++)
        relax(&t, &b->line[k]);
    free(t.map.met);
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
