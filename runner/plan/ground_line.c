/* ground_line.c - see ground_line.h. Footfalls are found as the engine counts them: a foot comes
 * down that is not the one that came down last. */
#include "ground_line.h"

#include <math.h>
#include <string.h>

enum { MEAN_PLACES = 64 };
#define FARTHEST 1e9 /* m, that heights are told of */
#define NEAR 1e-7    /* m: a foot on the ground */
#define REST 1e-6    /* m/s: neither lifts nor falls */

void ground_case(const struct scenario *s, const struct scenario_values *values, uint64_t index,
                 stance_case *c)
{
    *c = (stance_case){.seed = s->seed, .contacts = (uint32_t)values->contacts};
    memcpy(c->robot, values->robot, sizeof c->robot);
    scenario_case_keys(s, index, &c->grid_index, &c->sample_index);
    stance_case_robot(s->scene, c);
}

double ground_along(const stance_case *c, const double *position, const double *velocity,
                    int contact, double *rises)
{
    double place[2], speed[2];
    c->scene->contact_point(c->scene, c->robot, position, velocity, contact, place, speed);
    *rises = speed[1];
    return place[0] * c->body.slope[2] - place[1] * c->body.slope[1];
}

void ground_gaps(const stance_case *c, const double *position, double gap[STANCE_MAX_CONTACTS])
{
    const double rest[STANCE_MAX_COORDINATES] = {0};
    double height, end, ignored;
    struct ground_pieces pieces;
    c->scene->gaps(c->scene, c->robot, position, gap);
    ground_pieces_find(c, NULL, &pieces);
    for (int k = 0; c->body.plates > 0 && k < c->scene->contacts; k++) {
        const double place =
            c->scene->grip[k] < 0 ? NAN : ground_along(c, position, rest, k, &ignored);
        if (!(fabs(place) < FARTHEST))
            continue; /* the stop of a joint, or nowhere */
        stance_ground_at(c, pieces.from, place, &height, &end);
        gap[k] -= height;
    }
}

/* ---- pieces by footfall ---------------------------------------------------------------------- */

/* On the ground: at the beginning, or with a force since the row before. */
static bool is_down(const stance_case *c, const struct ground_motion *m, size_t row, int contact)
{
    const size_t k = row * (size_t)c->scene->contacts + (size_t)contact;
    return row > 0 ? m->force[2 * k] > 0 : fabs(m->gap[k]) < NEAR;
}

static double place_of(const stance_case *c, const struct ground_motion *m, size_t row, int contact,
                       double *rises)
{
    const size_t k = row * (size_t)c->scene->coordinates;
    return ground_along(c, m->position + k, m->velocity + k, contact, rises);
}

/* What is laid once so many footfalls have been, before the next one. */
static void lay(const stance_case *c, const struct ground_motion *m, double footfalls, size_t row,
                int contact, struct ground_pieces *pieces)
{
    double ignored;
    for (int i = 0; i < c->body.plates; i++) {
        if (c->body.plate[i].footfall != footfalls + 1)
            continue;
        pieces->from[i] = place_of(c, m, row, contact, &ignored) + c->body.plate[i].from;
        pieces->laid[i] = row > 0 ? m->time[row] : -INFINITY;
    }
}

/* The contact that stands at the beginning: of those on the ground the first that neither lifts nor
 * falls, or the first; -1: none is. */
static int first_stand(const stance_case *c, const struct ground_motion *m)
{
    const stance_scene *const scene = c->scene;
    int first = -1;
    for (int k = scene->contacts; k-- > 0;) {
        double rises, of_first = INFINITY;
        if (scene->grip[k] < 0 || !(c->contacts >> k & 1) || !is_down(c, m, 0, k))
            continue;
        place_of(c, m, 0, k, &rises);
        if (first >= 0)
            place_of(c, m, 0, first, &of_first);
        if (fabs(rises) < REST || !(fabs(of_first) < REST))
            first = k;
    }
    return first;
}

void ground_pieces_find(const stance_case *c, const struct ground_motion *m,
                        struct ground_pieces *pieces)
{
    const stance_scene *const scene = c->scene;
    double footfalls = 0;
    for (int i = 0; i < c->body.plates; i++) {
        const bool always = !(c->body.plate[i].footfall > 0);
        pieces->from[i] = always ? c->body.plate[i].from : INFINITY;
        pieces->laid[i] = always ? -INFINITY : INFINITY;
    }
    if (!m || m->rows == 0 || c->body.plates == 0 || !m->force || !m->gap)
        return;
    const int stands = first_stand(c, m);
    int foot = -1;
    if (stands >= 0)
        lay(c, m, 0, 0, stands, pieces);
    for (size_t row = 1; row < m->rows; row++)
        for (int k = 0; k < scene->contacts; k++) {
            if (scene->grip[k] < 0 || scene->grip[k] == foot || !is_down(c, m, row, k) ||
                is_down(c, m, row - 1, k))
                continue;
            foot = scene->grip[k];
            lay(c, m, ++footfalls, row, k, pieces);
        }
}

/* ---- its line -------------------------------------------------------------------------------- */

/* Where they begin that are there at a time. */
static void pieces_at(const stance_case *c, const struct ground_pieces *pieces, double time,
                      double from[STANCE_MAX_PLATES])
{
    for (int i = 0; i < c->body.plates; i++)
        from[i] = pieces->laid[i] <= time ? pieces->from[i] : INFINITY;
}

static void put(const stance_case *c, double place, double height, double point[2])
{
    point[0] = place * c->body.slope[2] + height * c->body.slope[1];
    point[1] = height * c->body.slope[2] - place * c->body.slope[1];
}

size_t ground_line(const stance_case *c, const struct ground_pieces *pieces, double time,
                   double low, double high, double (*point)[2], size_t room)
{
    double from[STANCE_MAX_PLATES], height, end;
    size_t count = 0;
    pieces_at(c, pieces, time, from);
    for (double x = low; x < high && count + 2 <= room; x = end) {
        stance_ground_at(c, from, x, &height, &end);
        end = count + 4 > room ? high : fmin(end, high);
        put(c, x, height, point[count++]);
        put(c, end, height, point[count++]);
    }
    return count;
}

double ground_mean(const stance_case *c, const struct ground_pieces *pieces, double time,
                   double low, double high)
{
    double from[STANCE_MAX_PLATES], sum = 0, height, end;
    pieces_at(c, pieces, time, from);
    for (int i = 0; i < MEAN_PLACES; i++) {
        stance_ground_at(c, from, low + (high - low) * (i + 0.5) / MEAN_PLACES, &height, &end);
        sum += height / MEAN_PLACES;
    }
    return sum;
}
