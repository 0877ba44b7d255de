/* results_trajectory.c - recorded trajectories of a results file. */
#include "results_private.h"
#include "store_private.h"

#include "runner/base/checksum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool results_recorded(const struct results *r, uint64_t **list, size_t *count,
                      stance_message *message)
{
    *list = NULL;
    *count = 0;
    if (!hdf_exists((hid_t)r->id, "trajectory/case"))
        return true;
    const struct results_variable v = results_variable(r, "trajectory/case");
    const size_t n = v.rank == 1 ? v.elements : 0;
    *list = n ? malloc(n * sizeof **list) : NULL;
    bool good = *list && v.class == H5T_INTEGER && hdf_read(v.id, KIND_uint64_t, *list);
    hdf_close(v.id);
    if (!good) {
        free(*list);
        *list = NULL;
        return results_failed(r, "trajectory/case", message);
    }
    *count = n;
    return true;
}

/* A variable of a trajectory, in the order of the table, and its numbers per instant. */
static double **track_of(struct results_trajectory *t, int v, size_t *width)
{
    double **const track[TRACKS] = {&t->position, &t->velocity, &t->torque, &t->force, &t->gap};
    const size_t lengths[OVERS] = {[OVER_NONE] = 1,
                                   [OVER_COORDINATE] = t->coordinates,
                                   [OVER_ACTUATOR] = t->actuators,
                                   [OVER_CONTACT] = t->contacts,
                                   [OVER_COMPONENT] = 2};
    *width = lengths[store_tracks[v].over[0]] * lengths[store_tracks[v].over[1]];
    return track[v];
}

/* One case of the variables (case, time, ...); NULL where there is none. */
static bool read_tracks(const struct results *r, struct results_trajectory *t, size_t place,
                        size_t rows, stance_message *message)
{
    uint32_t crc = 0, expected;
    for (int k = 0; k < TRACKS; k++) {
        const char *const path = store_tracks[k].name;
        size_t width;
        double **const track = track_of(t, k, &width);
        if (width == 0 || !hdf_exists((hid_t)r->id, path))
            continue;
        const struct results_variable v = results_variable(r, path);
        if (v.id < 0)
            return results_failed(r, path, message);
        const bool fits = rows > 0 && v.rank >= 3 && v.length[1] == rows && place < v.length[0] &&
                          v.elements > 0 && v.elements / v.length[0] == rows * width && v.number;
        *track = fits ? malloc(rows * width * sizeof **track) : NULL;
        const bool good = *track && hdf_move(v.id, hdf_type(KIND_double), place * rows * width,
                                             rows * width, HDF_READ, *track);
        hdf_close(v.id);
        if (!fits)
            return results_damaged(r, "a trajectory is not as its dimensions say", message);
        if (!good)
            return results_failed(r, path, message);
        crc = checksum_crc32c(crc, *track, rows * width * sizeof **track);
    }
    if (!t->position)
        return results_damaged(r, "the trajectories have no positions", message);
    const char *const path = store_tracks[TRACK_CHECKSUM].name;
    if (r->kind[r->single ? 0 : t->index] == RESULTS_PENDING || !hdf_exists((hid_t)r->id, path))
        return true;
    const hid_t sums = results_variable(r, path).id;
    const bool same =
        hdf_move(sums, H5T_STD_U32LE, place, 1, HDF_READ, &expected) && crc == expected;
    hdf_close(sums);
    return same || results_damaged(r, "a trajectory is not as its checksum says", message);
}

/* Rows before the first that is not a number: a case ends there. */
static size_t count_rows(const struct results_trajectory *t, size_t rows)
{
    for (size_t k = 0; k < rows; k++) {
        bool finite = isfinite(t->time[k]);
        for (size_t i = 0; i < t->coordinates; i++)
            finite = finite && isfinite(t->position[k * t->coordinates + i]);
        if (!finite)
            return k;
    }
    return rows;
}

bool results_trajectory(const struct results *r, size_t place, uint64_t index,
                        struct results_trajectory *t, stance_message *message)
{
    *t = (struct results_trajectory){.index = index};
    const struct results_variable instants = results_variable(r, "trajectory/time");
    const size_t rows = instants.rank == 1 ? instants.elements : 0;
    hdf_close(instants.id);
    t->coordinates =
        results_words(r, "trajectory/coordinate", t->coordinate, STANCE_MAX_COORDINATES);
    t->actuators = results_words(r, "trajectory/actuator", t->actuator, STANCE_MAX_ACTUATORS);
    t->contacts = results_words(r, "trajectory/contact", t->contact, STANCE_MAX_CONTACTS);
    t->time = rows ? malloc(rows * sizeof *t->time) : NULL;
    bool good = t->time && t->coordinates > 0 &&
                results_numbers(r, "trajectory/time", t->time, rows) == rows;
    if (!good)
        results_damaged(r, "the trajectories lack a dimension", message);
    good = good && read_tracks(r, t, place, rows, message) && t->position; /* it saw to that */
    if (good)
        t->rows = count_rows(t, rows);
    else
        results_trajectory_free(t);
    return good;
}

void results_trajectory_free(struct results_trajectory *t)
{
    free(t->time);
    free(t->position);
    free(t->velocity);
    free(t->torque);
    free(t->force);
    free(t->gap);
    *t = (struct results_trajectory){0};
}
