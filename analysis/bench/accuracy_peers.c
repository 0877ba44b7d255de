/* accuracy_peers.c - rows of other simulators, and what is cheaper than what. */
#include "accuracy.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the cases that are asked for --------------------------------------------------------- */

struct asked {
    stance_case *cases;
    size_t *cell; /* [count] which of a row's cases */
    size_t count;
};

static void asked_free(struct asked *asked)
{
    free(asked->cases);
    free(asked->cell);
}

/* Is cell i of a grid whose every stride-th point along each axis after the first is taken? */
static bool is_taken(const struct results *r, size_t i, size_t stride)
{
    for (int axis = r->axes - 1; axis >= 1; axis--) {
        if (i % r->axis[axis].count % stride != stride / 2)
            return false;
        i /= r->axis[axis].count;
    }
    return true;
}

static size_t count_taken(const struct results *r, size_t n, size_t stride)
{
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        count += is_taken(r, i, stride);
    return count;
}

static bool choose_cases(struct asked *asked, const struct accuracy *a, const struct results *r,
                         const struct plan *plan, size_t starts, stance_message *message)
{
    const size_t n = accuracy_cases(a, r);
    size_t stride = 1;
    int method;
    while (stride < n && count_taken(r, n, stride) > starts)
        stride++;
    asked->cases = calloc(n, sizeof *asked->cases);
    asked->cell = calloc(n, sizeof *asked->cell);
    if (!asked->cases || !asked->cell)
        return no_memory(message);
    for (size_t i = 0; i < n; i++)
        if (is_taken(r, i, stride) && r->kind[a->truth * n + i] != RESULTS_FAILED &&
            plan_resolve(plan, a->truth * n + i, &asked->cases[asked->count], &method))
            asked->cell[asked->count++] = i;
    return asked->count > 0 || complain(message, "no case that peers could be asked for");
}

static bool same(const double *a, const double *b, size_t n)
{
    size_t i = 0;
    while (i < n && a[i] == b[i])
        i++;
    return i == n;
}

static bool same_law(const stance_linear_law *a, const stance_linear_law *b)
{
    return same(a->feedforward, b->feedforward, STANCE_MAX_ACTUATORS) &&
           same(a->gain[0], b->gain[0], sizeof a->gain / sizeof(double)) &&
           same(a->target, b->target, STANCE_MAX_POSTURE);
}

/* Why nobody is asked; NULL: the talk has words for it. */
static const char *unspeakable(const struct asked *asked)
{
    const stance_case *const first = asked->cases;
    bool alike = true, linear = true;
    for (size_t i = 0; i < asked->count; i++) {
        const stance_case *const c = &asked->cases[i];
        alike &= same(c->robot, first->robot, STANCE_MAX_ROBOT) &&
                 same_law(&c->near, &first->near) && c->friction == first->friction &&
                 c->restitution == first->restitution && c->contacts == first->contacts &&
                 c->torque_limit == first->torque_limit && c->sample_every == first->sample_every;
        linear &= !c->decouples && !c->switches && !c->bends && !c->tree && !c->lands_ahead &&
                  !(c->angle_noise > 0 || c->rate_noise > 0 || c->noise > 0 || c->lag > 0) &&
                  c->delay == 0 && !(c->torque_rate > 0 && isfinite(c->torque_rate));
    }
    return !alike    ? "starts that differ in more than their states"
           : !linear ? "a law or a robot that peers are not told of"
                     : NULL;
}

/* ---- their answers ------------------------------------------------------------------------ */

/* Into *row; a setting's states, case by case, beside those of the truth. */
static bool compare_states(const struct accuracy *a, const struct results *r,
                           const struct asked *asked, const struct peer_answer *answer,
                           const struct peer_setting *s, struct accuracy_row *row,
                           stance_message *message)
{
    uint64_t *list;
    size_t recorded;
    if (!results_recorded(r, &list, &recorded, message))
        return false;
    const size_t n = accuracy_cases(a, r);
    bool good = true;
    for (size_t i = 0; good && i < asked->count; i++) {
        const size_t place = a->truth * n + asked->cell[i];
        struct results_trajectory truth;
        if (s->kind[i] == RESULTS_FAILED)
            continue;
        if (!(good = results_trajectory(r, place, list[place], &truth, message)))
            break;
        const size_t m = truth.coordinates;
        double *const split = calloc(2 * m * answer->instants, sizeof *split);
        good = split || no_memory(message);
        if (split) {
            const struct results_trajectory other = {.rows = s->rows[i],
                                                     .coordinates = m,
                                                     .position = split,
                                                     .velocity = split + m * answer->instants};
            for (size_t k = 0; k < s->rows[i]; k++) {
                const double *const state = s->state + (i * answer->instants + k) * 2 * m;
                memcpy(other.position + k * m, state, m * sizeof *state);
                memcpy(other.velocity + k * m, state + m, m * sizeof *state);
            }
            accuracy_trajectory(&truth, &other, row);
        }
        free(split);
        results_trajectory_free(&truth);
    }
    free(list);
    return good;
}

static bool add_row(struct accuracy *a, const struct results *r, const struct asked *asked,
                    const struct peer_answer *answer, const struct peer_setting *s,
                    stance_message *message)
{
    struct accuracy_row row = {.peer = a->peers,
                               .usual = s->usual,
                               .step = s->step,
                               .tolerance = NAN,
                               .cases = asked->count,
                               .cost = s->cost,
                               .signorini = NAN,
                               .coulomb = NAN,
                               .dissipation = NAN,
                               .penetration = NAN,
                               .energy_gain = NAN,
                               .events = NAN,
                               .evaluations = NAN};
    memcpy(row.setting, s->name, sizeof row.setting);
    for (size_t i = 0; i < asked->count; i++) {
        row.failed += s->kind[i] == RESULTS_FAILED;
        if (a->labels)
            accuracy_label(a, r, asked->cell[i], s->kind[i], &row);
    }
    if (!a->labels && !compare_states(a, r, asked, answer, s, &row, message))
        return false;
    struct accuracy_row *const more = realloc(a->row, (a->all + 1) * sizeof *more);
    if (!more)
        return no_memory(message);
    a->row = more;
    a->row[a->all++] = row;
    return true;
}

static bool ask_one(struct accuracy *a, const struct results *r, const struct peer_task *task,
                    const struct asked *asked, const char *program, stance_message *message)
{
    struct accuracy_peer *const peer = &a->peer[a->peers];
    struct peer_answer answer;
    if (!peer_ask(program, task, &answer, message))
        return false;
    *peer = (struct accuracy_peer){.settings = answer.settings};
    memcpy(peer->name, answer.name, sizeof peer->name);
    memcpy(peer->cannot, answer.cannot, sizeof peer->cannot);
    bool good = true;
    for (size_t s = 0; good && s < answer.settings; s++) {
        good = add_row(a, r, asked, &answer, &answer.setting[s], message);
        peer->off = fmax(peer->off, answer.setting[s].off);
    }
    a->peers++;
    peer_answer_free(&answer);
    return good;
}

/* ---- fronts ------------------------------------------------------------------------------- */

double accuracy_error(const struct accuracy *a, const struct accuracy_row *row)
{
    if (row->compared == 0 || row->failed > 0)
        return NAN;
    if (!a->labels)
        return row->position > 0 ? row->position : NAN;
    return fmax((double)row->differ, 1) / (double)row->compared;
}

static bool same_maker(const struct accuracy_row *x, const struct accuracy_row *y)
{
    return x->method == y->method && (x->method || x->peer == y->peer);
}

static void mark_fronts(struct accuracy *a)
{
    for (size_t k = 0; k < a->all; k++) {
        const double error = accuracy_error(a, &a->row[k]), cost = a->row[k].cost.median;
        bool front = error > 0 && cost > 0 && k != a->truth;
        for (size_t j = 0; front && j < a->all; j++) {
            const double other = accuracy_error(a, &a->row[j]);
            const double price = a->row[j].cost.median;
            const bool worse =
                price <= cost && other <= error && (price < cost || other < error || j < k);
            front = j == k || j == a->truth || !same_maker(&a->row[j], &a->row[k]) || !worse;
        }
        a->row[k].front = front;
    }
}

const struct accuracy_row *accuracy_best(const struct accuracy *a, size_t peer, bool usual)
{
    const struct accuracy_row *best = NULL;
    for (size_t k = a->rows; k < a->all; k++) {
        const struct accuracy_row *const row = &a->row[k];
        const double error = accuracy_error(a, row);
        if (row->peer == peer && (row->usual || !usual) && error > 0 &&
            (!best || error < accuracy_error(a, best) ||
             (error == accuracy_error(a, best) && row->cost.median < best->cost.median)))
            best = row;
    }
    return best;
}

/* y at x on the straight line through two points, in logarithms. */
static double between(double x, double x0, double y0, double x1, double y1)
{
    return exp(log(y0) + (log(y1) - log(y0)) * (log(x) - log(x0)) / (log(x1) - log(x0)));
}

struct accuracy_against accuracy_compare(const struct accuracy *a, const struct accuracy_row *best,
                                         const stance_method *method)
{
    struct accuracy_against against = {NAN, false, NAN, false};
    const double error = accuracy_error(a, best), cost = best->cost.median;
    const struct accuracy_row *worse = NULL, *better = NULL, *below = NULL, *above = NULL;
    for (size_t k = 0; k < a->rows; k++) {
        const struct accuracy_row *const row = &a->row[k];
        if (row->method != method || !row->front)
            continue;
        const double e = accuracy_error(a, row), c = row->cost.median;
        if (e > error && (!worse || c > worse->cost.median))
            worse = row;
        if (e <= error && (!better || c < better->cost.median))
            better = row;
        if (c <= cost && (!below || c > below->cost.median))
            below = row;
        if (c > cost && (!above || c < above->cost.median))
            above = row;
    }
    if (better) {
        const double price = worse ? between(error, accuracy_error(a, worse), worse->cost.median,
                                             accuracy_error(a, better), better->cost.median)
                                   : better->cost.median;
        against.cheaper = cost / price;
        against.at_least = !worse;
    }
    if (below) {
        against.error = above ? between(cost, below->cost.median, accuracy_error(a, below),
                                        above->cost.median, accuracy_error(a, above))
                              : accuracy_error(a, below);
        against.at_most = !above;
    }
    return against;
}

/* ---- all of it ---------------------------------------------------------------------------- */

bool accuracy_ask(struct accuracy *a, const struct results *r, const struct accuracy_asking *asking,
                  stance_message *message)
{
    struct scenario *const s = calloc(1, sizeof *s);
    struct parallel alone = parallel_alone();
    struct plan plan;
    struct plan_error error = {0};
    struct asked asked = {0};
    if (!s || !results_scenario(r, s) || !plan_make(&plan, s, false, 0, false, &error)) {
        free(s);
        return complain(message, "the file's scenario cannot be planned: %.100s",
                        error.message.text);
    }
    bool good =
        plan_compute_designs(&plan, &alone, &error) || complain(message, "%s", error.message.text);
    good = good && choose_cases(&asked, a, r, &plan, asking->starts, message);
    const char *const why = good ? unspeakable(&asked) : NULL;
    for (size_t p = 0; good && p < asking->programs && why; p++) {
        struct accuracy_peer *const peer = &a->peer[a->peers++];
        snprintf(peer->name, sizeof peer->name, "%s", asking->program[p]);
        snprintf(peer->cannot, sizeof peer->cannot, "%s", why);
    }
    const stance_case *const c = asked.cases;
    for (size_t p = 0; good && p < asking->programs && !why; p++) {
        const struct peer_task task = {
            .scene = s->scene,
            .cases = c,
            .count = asked.count,
            .time = (double)c->steps * c->step,
            .every = a->labels ? c->step : plan.record_interval,
            .labels = a->labels,
            .budget = asking->budget,
            .effort = asking->effort,
            .patience = asking->patience,
        };
        good = ask_one(a, r, &task, &asked, asking->program[p], message);
    }
    asked_free(&asked);
    plan_free(&plan);
    scenario_free(s);
    free(s);
    if (good)
        mark_fronts(a);
    return good;
}
