/* accuracy.c - compares every method and step of a file with its most exact one. */
#include "accuracy.h"
#include "studies.h"

#include "runner/base/message.h"
#include "runner/plan/kernels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Below this the truth itself is in doubt: such errors are no part of a ladder. */
static const double least_error = 1e-11;

/* ---- rows --------------------------------------------------------------------------------- */

/* Cases of each row: all but the first axis. */
size_t accuracy_cases(const struct accuracy *a, const struct results *r)
{
    return a->rows > 0 ? (size_t)r->cases / a->rows : 0;
}

bool accuracy_fits(const struct scenario *s, stance_message *message)
{
    if (s->axes < 1 || s->sample.given || strcmp(s->axis[0].path[0], "method.name") != 0)
        return complain(message, "the first axis does not vary method.name");
    const size_t rows = s->axis[0].count;
    for (size_t k = 0; k < rows; k++) {
        struct scenario_values values;
        scenario_case_values(s, k * (s->cases / rows), &values);
        if (strcmp(stance_methods()[values.method]->name, "event-driven") == 0)
            return true;
    }
    return complain(message, "no row of event-driven to compare with");
}

static bool make_rows(struct accuracy *a, const struct scenario *s, const struct results *r,
                      stance_message *message)
{
    if (!accuracy_fits(s, message))
        return false;
    a->rows = s->axis[0].count;
    a->truth = a->rows;
    a->row = calloc(a->rows, sizeof *a->row);
    if (!a->row)
        return no_memory(message);
    const size_t n = accuracy_cases(a, r);
    for (size_t k = 0; k < a->rows; k++) {
        struct accuracy_row *row = &a->row[k];
        struct scenario_values values;
        scenario_case_values(s, k * n, &values);
        row->method = stance_methods()[values.method];
        row->step = values.step;
        row->tolerance = study_tolerance(row->method, &values);
        row->cases = n;
        if (a->truth == a->rows && strcmp(row->method->name, "event-driven") == 0)
            a->truth = k;
    }
    return true;
}

/* ---- answers ------------------------------------------------------------------------------ */

/* Of each row the largest value among its cases or (sum) their sum, NAN where it was not recorded;
 * sums become rates. And its failures. */
static bool read_answers(struct accuracy *a, const struct results *r, stance_message *message)
{
    static const struct {
        const char *name;
        size_t member;
        bool sum;
    } wanted[] = {
        {"end_time", offsetof(struct accuracy_row, time), true},
        {"signorini_residual", offsetof(struct accuracy_row, signorini), false},
        {"coulomb_residual", offsetof(struct accuracy_row, coulomb), false},
        {"dissipation_residual", offsetof(struct accuracy_row, dissipation), false},
        {"energy_gain", offsetof(struct accuracy_row, energy_gain), false},
        {"events", offsetof(struct accuracy_row, events), true},
        {"evaluations", offsetof(struct accuracy_row, evaluations), true},
    };
    const size_t n = accuracy_cases(a, r);
    for (size_t w = 0; w < sizeof wanted / sizeof *wanted; w++) {
        double *values;
        if (!results_answer(r, wanted[w].name, &values, message))
            return false;
        for (size_t k = 0; k < a->rows; k++) {
            double *const out = (void *)((char *)&a->row[k] + wanted[w].member);
            *out = values ? 0 : NAN;
            for (size_t i = 0; values && i < n; i++) {
                const double x = values[k * n + i];
                *out = isnan(x) ? *out : wanted[w].sum ? *out + x : fmax(*out, x);
            }
        }
        free(values);
    }
    for (size_t k = 0; k < a->rows; k++) {
        struct accuracy_row *const row = &a->row[k];
        row->events /= row->time;
        row->evaluations /= row->time;
        for (size_t i = k * n; i < (k + 1) * n; i++)
            if (r->kind[i] == RESULTS_FAILED)
                row->failure = row->failed++ == 0 && r->failure ? r->failure[i] : row->failure;
    }
    return true;
}

/* ---- trajectories ------------------------------------------------------------------------- */

void accuracy_trajectory(const struct results_trajectory *truth,
                         const struct results_trajectory *other, struct accuracy_row *row)
{
    const size_t m = truth->coordinates;
    const size_t rows = truth->rows < other->rows ? truth->rows : other->rows;
    double position = 0, velocity = 0;
    for (size_t i = 0; i < rows; i++) {
        double largest = 0;
        for (size_t c = 0; c < m; c++) {
            position =
                fmax(position, fabs(truth->position[i * m + c] - other->position[i * m + c]));
            largest = fmax(largest, fabs(truth->velocity[i * m + c] - other->velocity[i * m + c]));
        }
        velocity += largest / (double)rows;
    }
    row->position = fmax(row->position, position);
    row->velocity = fmax(row->velocity, velocity);
    row->compared++;
}

static bool compare_case(struct accuracy *a, const struct results *r, const uint64_t *list,
                         size_t i, stance_message *message)
{
    const size_t n = accuracy_cases(a, r);
    struct results_trajectory truth, other;
    const size_t at = a->truth * n + i;
    if (r->kind[list[at]] == RESULTS_FAILED || r->kind[list[at]] == RESULTS_PENDING)
        return true; /* no truth, no error */
    if (!results_trajectory(r, at, list[at], &truth, message))
        return false;
    bool good = true;
    for (size_t k = 0; good && k < a->rows; k++) {
        const size_t place = k * n + i;
        if (r->kind[list[place]] == RESULTS_FAILED || r->kind[list[place]] == RESULTS_PENDING)
            continue;
        good = results_trajectory(r, place, list[place], &other, message);
        if (good) {
            accuracy_trajectory(&truth, &other, &a->row[k]);
            results_trajectory_free(&other);
        }
    }
    results_trajectory_free(&truth);
    return good;
}

/* ---- outcomes ----------------------------------------------------------------------------- */

/* Do all neighbours of a cell of the truth have the cell's own outcome? Neighbours differ by one
 * along at least one of the axes after the first. */
static bool is_inside(const struct results *r, const uint8_t *truth, size_t cell)
{
    size_t point[SCENARIO_MAX_AXES] = {0}, rest = cell;
    for (int axis = r->axes - 1; axis >= 1; axis--) {
        point[axis] = rest % r->axis[axis].count;
        rest /= r->axis[axis].count;
    }
    int64_t neighbours = 1;
    for (int axis = 1; axis < r->axes; axis++)
        neighbours *= 3;
    for (int64_t k = 0; k < neighbours; k++) {
        size_t index = 0;
        bool exists = true;
        int64_t code = k;
        for (int axis = 1; axis < r->axes; axis++, code /= 3) {
            const int64_t x = (int64_t)point[axis] + code % 3 - 1;
            exists &= x >= 0 && x < (int64_t)r->axis[axis].count;
            index = index * r->axis[axis].count + (size_t)(exists ? x : 0);
        }
        if (exists && truth[index] != truth[cell])
            return false;
    }
    return true;
}

void accuracy_label(const struct accuracy *a, const struct results *r, size_t cell, uint8_t kind,
                    struct accuracy_row *row)
{
    const uint8_t *const truth = r->kind + a->truth * accuracy_cases(a, r);
    if (truth[cell] == RESULTS_FAILED || kind == RESULTS_FAILED)
        return;
    row->compared++;
    if (kind != truth[cell]) {
        row->differ++;
        row->inside += is_inside(r, truth, cell);
    }
}

/* ---- orders ------------------------------------------------------------------------------- */

/* Slope of y over x, by least squares. */
static double slope(const double *x, const double *y, size_t n)
{
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t i = 0; i < n; i++)
        sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i];
    return n < 2 ? NAN : ((double)n * sxy - sx * sy) / ((double)n * sxx - sx * sx);
}

static void fit_order(struct accuracy_order *order, const struct accuracy *a)
{
    double x[64], p[64], v[64];
    size_t n = 0;
    order->from = order->to = NAN;
    for (size_t k = 0; k < a->rows && n < 64; k++) {
        const struct accuracy_row *row = &a->row[k];
        const bool usable = row->method == order->method && k != a->truth && row->failed == 0 &&
                            row->position > least_error && row->velocity > least_error;
        if (usable) {
            const double at = order->by_tolerance ? row->tolerance : row->step;
            order->from = n == 0 ? at : fmax(order->from, at);
            order->to = n == 0 ? at : fmin(order->to, at);
            x[n] = log(at);
            p[n] = log(row->position);
            v[n++] = log(row->velocity);
        }
    }
    order->rows = n;
    order->position = order->from > order->to ? slope(x, p, n) : NAN;
    order->velocity = order->from > order->to ? slope(x, v, n) : NAN;
}

static void fit_orders(struct accuracy *a)
{
    for (size_t m = 0; stance_methods()[m] && a->orders < ACCURACY_METHODS; m++) {
        const stance_method *method = stance_methods()[m];
        double step[2] = {INFINITY, 0};
        bool present = false;
        for (size_t k = 0; k < a->rows; k++) {
            if (a->row[k].method == method && k != a->truth) {
                present = true;
                step[0] = fmin(step[0], a->row[k].step);
                step[1] = fmax(step[1], a->row[k].step);
            }
        }
        if (present) {
            struct accuracy_order *order = &a->order[a->orders++];
            /* One step and many tolerances: the ladder is that of the tolerance. */
            *order = (struct accuracy_order){.method = method, .by_tolerance = step[0] == step[1]};
            fit_order(order, a);
        }
    }
}

/* ---- all of it ---------------------------------------------------------------------------- */

static bool measure(struct accuracy *a, const struct scenario *s, const struct results *r,
                    double budget, stance_message *message)
{
    const struct parallel alone = parallel_alone();
    const struct kernels_choice choice = {.always = true}; /* what long runs compute with */
    struct plan plan;
    struct kernels kernels;
    const size_t n = accuracy_cases(a, r);
    if (!study_plan(&plan, s, message))
        return false;
    bool good = kernels_take(&kernels, &plan, &choice, &alone, message) == EXIT_DONE;
    if (good) {
        for (size_t k = 0; good && k < a->rows; k++)
            good = measure_rows(&plan, k * n, n, budget, &a->row[k].cost, message);
        kernels_give_back(&kernels);
    }
    plan_free(&plan);
    return good;
}

static bool compare(struct accuracy *a, const struct results *r, stance_message *message)
{
    uint64_t *list;
    size_t count;
    if (!results_recorded(r, &list, &count, message))
        return false;
    const size_t n = accuracy_cases(a, r);
    bool good = true;
    a->labels = count != r->cases;
    for (size_t k = 0; a->labels && k < a->rows; k++)
        for (size_t i = 0; i < n; i++)
            accuracy_label(a, r, i, r->kind[k * n + i], &a->row[k]);
    for (size_t i = 0; good && !a->labels && i < n; i++)
        good = compare_case(a, r, list, i, message);
    free(list);
    return good;
}

bool accuracy_make(struct accuracy *a, const struct results *r, double budget,
                   stance_message *message)
{
    const struct scenario *const s = r->read;
    *a = (struct accuracy){.rows = 0};
    if (!s)
        return complain(message, "this version cannot read the file's scenario");
    const bool good = make_rows(a, s, r, message) && read_answers(a, r, message) &&
                      compare(a, r, message) && measure(a, s, r, budget, message);
    if (good && !a->labels)
        fit_orders(a);
    if (!good)
        accuracy_free(a);
    return good;
}

void accuracy_free(struct accuracy *a)
{
    free(a->row);
    *a = (struct accuracy){.rows = 0};
}
