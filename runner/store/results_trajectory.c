/* results_trajectory.c - recorded trajectories of a results file. */
#include "results_private.h"

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

/* One case of a variable (case, time, ...) of `width` numbers per instant; *values NULL when the
 * variable does not exist. */
static bool read_track(const struct results *r, const char *path, size_t place, size_t rows,
                       size_t width, double **values, stance_message *message)
{
    if (width == 0 || !hdf_exists((hid_t)r->id, path))
        return true;
    const struct results_variable v = results_variable(r, path);
    if (v.id < 0)
        return results_failed(r, path, message);
    const bool fits = rows > 0 && v.rank >= 3 && v.length[1] == rows && place < v.length[0] &&
                      v.elements > 0 && v.elements / v.length[0] == rows * width && v.number;
    *values = fits ? malloc(rows * width * sizeof **values) : NULL;
    const bool good = *values && hdf_move(v.id, hdf_type(KIND_double), place * rows * width,
                                          rows * width, HDF_READ, *values);
    hdf_close(v.id);
    return !fits ? results_damaged(r, "a trajectory is not as its dimensions say", message)
                 : good || results_failed(r, path, message);
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

/* A trajectory of `rows` instants is as its checksum says, where it has one. */
static bool is_whole(const struct results *r, const struct results_trajectory *t, size_t place,
                     size_t rows)
{
    const struct {
        const double *values;
        size_t width;
    } part[] = {{t->position, t->coordinates},
                {t->velocity, t->coordinates},
                {t->torque, t->actuators},
                {t->force, 2 * t->contacts},
                {t->gap, t->contacts}};
    uint32_t crc = 0, expected;

    for (size_t k = 0; k < sizeof part / sizeof part[0]; k++)
        if (part[k].values)
            crc = checksum_crc32c(crc, part[k].values, rows * part[k].width * sizeof(double));
    return !hdf_exists((hid_t)r->id, "trajectory/checksum") ||
           (store_trajectory_checksum(r->id, place, &expected) && crc == expected);
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
    good = good || results_damaged(r, "the trajectories lack a dimension", message);
    good =
        good &&
        read_track(r, "trajectory/position", place, rows, t->coordinates, &t->position, message) &&
        read_track(r, "trajectory/velocity", place, rows, t->coordinates, &t->velocity, message) &&
        read_track(r, "trajectory/torque", place, rows, t->actuators, &t->torque, message) &&
        read_track(r, "trajectory/force", place, rows, 2 * t->contacts, &t->force, message) &&
        read_track(r, "trajectory/gap", place, rows, t->contacts, &t->gap, message);
    if (good && !t->position)
        good = results_damaged(r, "the trajectories have no positions", message);
    if (good && r->kind[r->single ? 0 : index] != RESULTS_PENDING && !is_whole(r, t, place, rows))
        good = results_damaged(r, "a trajectory is not as its checksum says", message);
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
