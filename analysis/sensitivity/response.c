/* response.c - means over the cases of each sample point. */
#include "response.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/command.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void response_free(struct response *response)
{
    for (size_t t = 0; response->table && t < response->tables; t++) {
        free(response->table[t].y);
        free(response->table[t].waiting);
    }
    free(response->table);
    *response = (struct response){0};
}

static bool make_tables(struct response *response, const struct results *r)
{
    response->tables = 1;
    for (int a = 0; a < r->axes; a++)
        response->tables *= response->kept[a] ? r->axis[a].count : 1;
    response->table = calloc(response->tables, sizeof *response->table);
    for (size_t t = 0; response->table && t < response->tables; t++) {
        struct response_table *table = &response->table[t];
        table->y = calloc(response->points, sizeof *table->y);
        table->waiting = calloc(response->points, sizeof *table->waiting);
        if (!table->y || !table->waiting)
            return false;
        size_t rest = t;
        for (int a = r->axes - 1; a >= 0; a--) {
            if (response->kept[a]) {
                table->point[a] = rest % r->axis[a].count;
                rest /= r->axis[a].count;
            }
        }
    }
    return response->table != NULL;
}

/* What a case adds to the mean of its point; NAN: nothing. */
static double value_of(const struct response_choice *choice, enum results_kind kind, double answer)
{
    if (choice->fallen && kind == RESULTS_FAILED)
        kind = RESULTS_FELL;
    if (kind == RESULTS_FAILED || kind == RESULTS_PENDING)
        return NAN;
    if (!choice->answer)
        return kind == choice->of;
    return choice->of == RESULTS_KIND_COUNT || kind == choice->of ? answer : NAN;
}

/* Means into y; numbers[tables * points]: of cases in them, zero at first. */
static void take_means(struct response *response, const struct results *r,
                       const struct response_choice *choice, const double *answers,
                       uint32_t *numbers)
{
    const size_t points = response->points;
    for (uint64_t i = 0; i < r->cases; i += points) {
        size_t point[SCENARIO_MAX_AXES], t = 0; /* the table of this grid point */
        results_point(r, i, point);
        for (int a = 0; a < r->axes; a++)
            t = response->kept[a] ? t * r->axis[a].count + point[a] : t;
        struct response_table *table = &response->table[t];
        table->cases += points;
        for (size_t p = 0; p < points; p++) {
            const enum results_kind kind = (enum results_kind)r->kind[i + p];
            const double value = value_of(choice, kind, answers ? answers[i + p] : NAN);
            table->failed += kind == RESULTS_FAILED;
            table->pending += kind == RESULTS_PENDING;
            table->waiting[p] = table->waiting[p] || kind == RESULTS_PENDING;
            if (isfinite(value)) /* a mean as it comes, which does not overflow or cancel */
                table->y[p] += (value - table->y[p]) / ++numbers[t * points + p];
        }
    }
    for (size_t t = 0; t < response->tables; t++) {
        struct response_table *table = &response->table[t];
        for (size_t p = 0; p < points; p++) {
            table->missing += !table->waiting[p] && numbers[t * points + p] == 0;
            if (table->waiting[p] || numbers[t * points + p] == 0)
                table->y[p] = NAN;
        }
    }
}

/* The answers, NAN where a refined map has not simulated a case. Returns an exit code. */
static int read_answers(const struct results *r, const char *name, double **answers,
                        stance_message *message)
{
    uint64_t inferred;
    bool *which = NULL;
    *answers = NULL;
    int code = statistics_inferred(r, &inferred, &which, message) &&
                       results_answer(r, name, answers, message)
                   ? EXIT_DONE
                   : EXIT_IO;
    if (code == EXIT_DONE && !*answers) {
        complain(message, "%.150s: does not store %.60s", r->file, name);
        code = EXIT_USAGE;
    }
    for (uint64_t i = 0; code == EXIT_DONE && which && i < r->cases; i++)
        (*answers)[i] = which[i] ? NAN : (*answers)[i];
    free(which);
    return code;
}

int response_make(struct response *response, const struct results *r,
                  const struct response_choice *choice, const bool *kept, stance_message *message)
{
    double *answers = NULL;
    *response = (struct response){.points = r->axis[r->sample].count};
    memcpy(response->kept, kept, (size_t)r->sample * sizeof *kept);
    for (uint64_t i = 0; choice->of != RESULTS_KIND_COUNT && i < r->cases; i++)
        if (r->kind[i] == RESULTS_DONE) {
            complain(message, "%.200s: does not store outcomes", r->file);
            return EXIT_USAGE;
        }
    int code = choice->answer ? read_answers(r, choice->answer, &answers, message) : EXIT_DONE;
    if (code != EXIT_DONE)
        return code;
    bool good = make_tables(response, r);
    uint32_t *numbers = good ? calloc(response->tables * response->points, sizeof *numbers) : NULL;
    if (numbers) {
        take_means(response, r, choice, answers, numbers);
    } else {
        statistics_no_memory(r, message);
        response_free(response);
        code = EXIT_IO;
    }
    free(numbers);
    free(answers);
    return code;
}
