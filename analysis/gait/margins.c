/* margins.c - the gait once more, with answers of walking, and its first step recorded. */
#include "gait.h"

#include "runner/base/message.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the first rows of a record: what the foot that stands carries at least; how high the foot that
 * swings is while it is ahead of the other one, and how deep before. */
static void look_at_feet(const struct return_map *map, const stance_trajectory *record,
                         int64_t rows, double direction, struct gait_margins *m)
{
    const stance_scene *const scene = map->scene;
    m->least_normal_force = INFINITY;
    for (int64_t k = 0; k < rows; k++) {
        const double *const q = record->position + k * scene->coordinates;
        const double *const v = record->velocity + k * scene->coordinates;
        const double gap = record->gap[k * scene->contacts + map->foot[1]];
        double foot[2][2], speed[2];
        for (int leg = 0; leg < 2; leg++)
            return_map_foot(map, q, v, leg, foot[leg], speed);
        if ((foot[1][0] - foot[0][0]) * direction > 0)
            m->clearance = fmax(m->clearance, gap);
        else
            m->under = fmax(m->under, -gap);
        if (k > 0) /* row 0 has nothing before it */
            m->least_normal_force = fmin(m->least_normal_force,
                                         record->force[2 * (k * scene->contacts + map->foot[0])]);
    }
}

/* The phase by the time of the first rows, least squares of powers of its part of their length. */
static void fit_clock(const struct return_map *map, const stance_trajectory *record, int64_t rows,
                      struct gait_margins *m)
{
    enum { N = STANCE_MAX_COEFFICIENTS };
    const double *const phase = map->base.outputs.phase[0];
    const double end = (double)rows * record->interval;
    bool follows = map->base.follows && rows >= 2 * N;
    double size = 0;
    for (int j = 0; j < map->scene->coordinates; j++)
        size += fabs(phase[j]);
    follows = follows && size > 0;
    double *const A = follows ? malloc((size_t)rows * (2 * N + 2) * sizeof *A) : NULL;
    m->clock_off = NAN;
    for (int i = 0; i < N; i++)
        m->clock[i] = NAN;
    if (!A)
        return;
    double *const powers = A + (size_t)rows * N, *const given = powers + (size_t)rows * N;
    double *const x = given + rows;
    for (int64_t k = 0; k < rows; k++) {
        double power = 1;
        given[k] = 0;
        for (int j = 0; j < map->scene->coordinates; j++)
            given[k] += phase[j] * record->position[k * map->scene->coordinates + j];
        for (int i = 0; i < N; i++, power *= (double)k / (double)rows)
            A[k * N + i] = powers[k * N + i] = power;
    }
    memcpy(x, given, (size_t)rows * sizeof *x);
    if (LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', (lapack_int)rows, N, 1, A, N, x, 1) == 0) {
        m->clock_off = 0;
        for (int64_t k = 0; k < rows; k++) {
            double off = -given[k];
            for (int i = 0; i < N; i++)
                off += powers[k * N + i] * x[i];
            m->clock_off = fmax(m->clock_off, fabs(off));
        }
        for (int i = 0; i < N; i++)
            m->clock[i] = x[i] / pow(end, i);
    }
    free(A);
}

bool gait_margins_find(const struct return_map *map, const struct gait *gait,
                       struct gait_margins *margins, stance_message *message)
{
    const stance_scene *const scene = map->scene;
    const size_t rows = (size_t)(gait->at.time / map->base.step) + 1;
    const size_t n = (size_t)scene->coordinates, contacts = (size_t)scene->contacts;
    const size_t width = 2 * n + (size_t)scene->actuators + 3 * contacts;
    double *const all = calloc(rows * width, sizeof *all);
    stance_trajectory record = {.interval = map->base.step, .rows = (int64_t)rows};
    stance_case c[2] = {map->base, map->base};
    stance_result r[2];
    if (!all)
        return complain(message, "out of memory");
    record.position = all, record.velocity = record.position + rows * n;
    record.gap = record.velocity + rows * n, record.force = record.gap + rows * contacts;
    record.torque = record.force + rows * 2 * contacts;
    c[0].trajectory = &record;
    c[0].footfalls = 1;
    c[1].walk_steps = INT32_MAX; /* answers of walking, and no end by it */
    c[1].walk_length = c[1].walk_time = 0;
    c[1].footfalls = map->steps + 1;
    bool good = true;
    for (int k = 0; good && k < 2; k++) {
        good = return_map_state(map, &gait->from, c[k].position, c[k].velocity);
        if (good)
            map->kernel->run(&c[k], &r[k], 1);
        good = good && r[k].status == STANCE_DONE && r[k].footfalls >= c[k].footfalls;
    }
    if (good) {
        const stance_result *const back = &gait->at.result;
        const int64_t whole = (int64_t)(r[0].end_time / c[0].step);
        double place[2], speed[2]; /* of the foot that stood */
        return_map_foot(map, back->position, back->velocity, (map->steps - 1) % 2, place, speed);
        *margins = (struct gait_margins){.cost = map->steps <= 4 ? r[1].cost_of_transport : NAN,
                                         .impact_friction = r[1].impact_friction,
                                         .lift = fmax(speed[1], 0)};
        look_at_feet(map, &record, whole, gait->at.length, margins);
        fit_clock(map, &record, whole, margins);
    } else {
        complain(message, "it does not take another step");
    }
    free(all);
    return good;
}
