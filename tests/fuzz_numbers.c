/* fuzz_numbers.c - what a results file says, as hashes. */
#include "fuzz_numbers.h"

#include "runner/base/checksum.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t add(uint32_t crc, const void *data, size_t size)
{
    return data ? checksum_crc32c(crc, data, size) : crc;
}

static bool hash_rows(const struct results *r, struct fuzz_numbers *numbers,
                      stance_message *message)
{
    static const char *const answers[] = {
#define ANSWER(name, ...) #name,
        STANCE_ANSWERS(ANSWER)
#undef ANSWER
    };
    numbers->cases = r->cases;
    numbers->row = calloc(r->cases, sizeof *numbers->row);
    numbers->kind = malloc(r->cases);
    if (!numbers->row || !numbers->kind)
        abort();
    memcpy(numbers->kind, r->kind, r->cases);
    for (size_t k = 0; k < sizeof answers / sizeof answers[0]; k++) {
        double *values;
        if (!results_answer(r, answers[k], &values, message))
            return false;
        for (uint64_t i = 0; values && i < r->cases; i++)
            numbers->row[i] = add(numbers->row[i], &values[i], sizeof *values);
        free(values);
    }
    return true;
}

static uint32_t hash_trajectory(const struct results_trajectory *t)
{
    const size_t n = t->rows * sizeof(double);
    uint32_t crc = add(0, &t->index, sizeof t->index);
    crc = add(crc, t->time, n);
    crc = add(crc, t->position, n * t->coordinates);
    crc = add(crc, t->velocity, n * t->coordinates);
    crc = add(crc, t->torque, n * t->actuators);
    crc = add(crc, t->force, 2 * n * t->contacts);
    crc = add(crc, t->gap, n * t->contacts);
    crc = add(crc, t->coordinate, t->coordinates * sizeof t->coordinate[0]);
    crc = add(crc, t->actuator, t->actuators * sizeof t->actuator[0]);
    return add(crc, t->contact, t->contacts * sizeof t->contact[0]);
}

static bool hash_trajectories(const struct results *r, struct fuzz_numbers *numbers,
                              stance_message *message)
{
    uint64_t *list;
    bool whole = results_recorded(r, &list, &numbers->trajectories, message);
    numbers->trajectory = calloc(numbers->trajectories + 1, sizeof *numbers->trajectory);
    for (size_t k = 0; whole && numbers->trajectory && k < numbers->trajectories; k++) {
        struct results_trajectory t;
        uint64_t row = r->single ? 0 : list[k];
        if (row >= r->cases) {
            snprintf(message->text, sizeof message->text, "a trajectory of no case");
            whole = false;
        } else if (r->kind[row] != RESULTS_PENDING) {
            whole = results_trajectory(r, k, list[k], &t, message);
            numbers->trajectory[k] = whole ? hash_trajectory(&t) : 0;
            results_trajectory_free(&t);
        }
    }
    free(list);
    return whole;
}

void fuzz_numbers_free(struct fuzz_numbers *numbers)
{
    free(numbers->row);
    free(numbers->kind);
    free(numbers->trajectory);
}

const char *fuzz_difference(const struct fuzz_numbers *a, const struct fuzz_numbers *b,
                            uint64_t *pending)
{
    *pending = 0;
    if (a->axes != b->axes || a->cases != b->cases)
        return "axes";
    for (uint64_t i = 0; i < a->cases; i++)
        if (a->kind[i] == RESULTS_PENDING)
            *pending += b->kind[i] != RESULTS_PENDING;
        else if (a->kind[i] != b->kind[i] || a->row[i] != b->row[i])
            return "rows";
    if (a->trajectories != b->trajectories)
        return "number of trajectories";
    for (size_t k = 0; k < a->trajectories && *pending == 0; k++)
        if (a->trajectory[k] != b->trajectory[k])
            return "trajectories";
    return a->designs != b->designs ? "designs" : a->scenario != b->scenario ? "scenario" : "";
}

bool fuzz_hash_file(const char *file, struct fuzz_numbers *numbers, stance_message *message)
{
    enum { MOST_NUMBERS = 1 << 16 };
    static const char *const designs[] = {"design/gain", "design/equilibrium_position",
                                          "design/equilibrium_torque", "design/start_position",
                                          "design/status"};
    struct results r;
    *numbers = (struct fuzz_numbers){0};
    if (!results_open(&r, file, message))
        return false;
    for (int a = 0; a < r.axes; a++) {
        const struct results_axis *axis = &r.axis[a];
        numbers->axes = add(numbers->axes, axis->name, strlen(axis->name) + 1);
        numbers->axes = add(numbers->axes, axis->unit, strlen(axis->unit) + 1);
        numbers->axes = add(numbers->axes, axis->value, axis->count * sizeof *axis->value);
        for (size_t i = 0; axis->word && i < axis->count; i++)
            numbers->axes = add(numbers->axes, axis->word[i], strlen(axis->word[i]) + 1);
    }
    numbers->scenario = add(0, r.scenario, strlen(r.scenario));
    double *values = calloc(MOST_NUMBERS, sizeof *values);
    for (size_t i = 0; values && i < sizeof designs / sizeof designs[0]; i++) {
        size_t n = results_numbers(&r, designs[i], values, MOST_NUMBERS);
        numbers->designs = add(numbers->designs, values, n * sizeof *values);
    }
    free(values);
    bool whole = hash_rows(&r, numbers, message) && hash_trajectories(&r, numbers, message);
    results_close(&r);
    return whole;
}
