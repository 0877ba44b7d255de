/* candidate.c - units and bounds of what a search varies; the first candidate and the best as
 * texts.
 *
 * The unit of a gain is what takes the whole torque from the edge of the starts: torque limit over
 * half-width of its coordinate in sweep.sample. Of a coordinate that is not sampled the widest of
 * its kind, angles or rates, stands in, or `usual`.
 */
#include "candidate.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/plan/design.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const double usual[2] = {0.1, 0.5}; /* rad, rad/s */

/* ---- numbers --------------------------------------------------------------------------------- */

/* Half-width of the starts in coordinate i of the scene, rates behind; 0: it is not sampled. */
static double half_width(const struct scenario *s, int i)
{
    const struct scenario_axis *const axis = &s->axis[s->axes - 1];
    const size_t place = (s->base.state_given ? offsetof(struct scenario_values, state)
                                              : offsetof(struct scenario_values, offset)) +
                         (size_t)i * sizeof(double);
    double width = 0;
    for (size_t j = 0; s->sample.given && j < s->sample.design.factors; j++) {
        const struct scenario_factor *const f = &s->sample.factor[j];
        for (int k = 0; k < f->paths; k++) {
            double least = INFINITY, most = -INFINITY;
            for (size_t p = 0; p < f->points; p++) {
                least = fmin(least, f->value[p * (size_t)f->paths + (size_t)k]);
                most = fmax(most, f->value[p * (size_t)f->paths + (size_t)k]);
            }
            if (axis->offset[f->first + k] == place)
                width = fmax(width, (most - least) / 2);
        }
    }
    return width;
}

/* The same of an angle or a rate that need not be sampled: the widest of its kind stands in. */
static double width_of(const struct scenario *s, int coordinate, bool rate)
{
    const int n = s->scene->coordinates, first = rate ? n : 0;
    double width = half_width(s, first + coordinate);
    for (int i = 0, own = width > 0; !own && i < n; i++)
        width = fmax(width, half_width(s, first + i));
    return width > 0 ? width : usual[rate];
}

static double gain_unit(const struct scenario *s, size_t actuator, size_t column)
{
    const size_t postures = (size_t)s->scene->postures;
    const bool rate = column >= postures;
    const int coordinate = s->scene->posture[column % postures];
    double limit[STANCE_MAX_ACTUATORS];
    stance_torque_limits(s->scene, s->base.robot, s->base.torque_limit, s->base.torque_limits,
                         limit);
    return limit[actuator] / width_of(s, coordinate, rate);
}

/* Of a law's parameter: for each coordinate of the posture that of a gain, of its angle or, in
 * s/rad and the like, its rate; else 1. So a bend by 1 N m is as wide as a gain. */
static double law_unit(const struct scenario *s, int k)
{
    const size_t offset = s->search.axis.offset[k] - offsetof(struct scenario_values, law_value);
    const size_t number = offset / sizeof(double), place = number % STANCE_LAW_ROOM;
    if (offset >= sizeof s->base.law_value) /* of a law of the user's own */
        return 1;
    int law = 0, parameter = (int)(number / STANCE_LAW_ROOM);
    while (parameter >= stance_laws()[law]->parameters)
        parameter -= stance_laws()[law++]->parameters;
    const stance_parameter *const p = &stance_laws()[law]->parameter[parameter];
    const size_t rate = p->of.unit[0] == 's' ? (size_t)s->scene->postures : 0;
    double unit = 0;
    for (size_t i = 0; p->per == STANCE_PER_POSTURE && i < (size_t)s->scene->actuators; i++)
        unit = fmax(unit, gain_unit(s, i, rate + place));
    return unit > 0 && isfinite(unit) ? unit : 1;
}

static double coordinate_of(enum scenario_scale scale, double unit, double value)
{
    return (scale == SCALE_EVEN ? value : log(fabs(value))) / unit;
}

void space_make(struct space *space, const struct scenario *s)
{
    const struct scenario_search *const search = &s->search;
    const size_t columns = 2 * (size_t)s->scene->postures;
    const size_t gains = offsetof(struct scenario_values, gains);
    *space = (struct space){.search = search, .n = search->axis.paths};
    for (int i = 0; i < space->n; i++) {
        const struct scenario_varied *const v = &search->varied[i];
        const size_t offset = search->axis.offset[i], place = (offset - gains) / sizeof(double);
        double value;
        memcpy(&value, (const char *)&s->base + offset, sizeof value);
        space->gain[i] = offset >= gains && offset < gains + sizeof s->base.gains;
        const double unit = !isnan(v->unit)  ? v->unit
                            : space->gain[i] ? gain_unit(s, place / columns, place % columns)
                                             : law_unit(s, i);
        const double first = coordinate_of(v->scale, unit, value);
        const double a = coordinate_of(v->scale, unit, v->low),
                     b = coordinate_of(v->scale, unit, v->high); /* of 0 -INFINITY by ratios */
        space->unit[i] = unit;
        space->first[i] = first;
        space->low[i] = fmin(fmin(a, b), first);
        space->high[i] = fmax(fmax(a, b), first);
    }
}

double space_value(const struct space *space, int k, double y)
{
    const struct scenario_varied *const v = &space->search->varied[k];
    const double size = y * space->unit[k];
    const double value = v->scale == SCALE_EVEN    ? size
                         : v->scale == SCALE_RATIO ? exp(size)
                                                   : -exp(size);
    return fmin(fmax(value, v->low), v->high); /* rounding stays inside */
}

double space_gain(const struct space *space, const double *y)
{
    double sum = 0;
    int gains = 0;
    for (int k = 0; k < space->n; k++) {
        gains += space->gain[k];
        sum += space->gain[k] ? y[k] * y[k] : 0;
    }
    return gains > 0 ? sqrt(sum / gains) : 0;
}

/* ---- scenarios ------------------------------------------------------------------------------- */

/* "controller.gains=[[...], ...]", over the posture's angles and rates. */
enum { GAINS_TEXT = SCENARIO_MAX_GAINS * 28 + 32 };
static void gains_text(const struct design_report *r, char text[GAINS_TEXT])
{
    const struct scenario *const s = r->scenario;
    const int columns = 2 * s->scene->postures;
    double gain[SCENARIO_MAX_GAINS] = {0};
    for (int i = 0; i < r->inputs; i++)
        for (int j = 0; j < r->states; j++)
            gain[i * columns + resolve_state(s->scene, &r->equilibrium, j)] =
                r->K[i * r->states + j];
    char *to = stpcpy(text, "controller.gains=");
    for (int k = 0; k < r->inputs * columns; k++)
        to += sprintf(to, "%s%.17g", k % columns ? ", " : k ? "], [" : "[[", gain[k]);
    stpcpy(to, "]]");
}

char *best_first(const struct scenario *s, stance_message *message)
{
    static const char *const drop[] = {"controller.poles", "controller.weights",
                                       "controller.design_time"};
    char gains[GAINS_TEXT], *text = NULL;
    const char *const set[] = {"controller.design=gains", gains};
    struct design_report *const report = s->search.designed_gains ? malloc(sizeof *report) : NULL;
    if (report && !design_loop(report, s, NULL, message)) {
        free(report);
        return NULL;
    }
    if (report) {
        gains_text(report, gains);
        text = scenario_rewrite(s->text, drop, sizeof drop / sizeof *drop, set, 2);
    } else if (!s->search.designed_gains) {
        text = strdup(s->text);
    }
    free(report);
    if (!text)
        no_memory(message);
    return text;
}

char *best_text(const struct search_file *f)
{
    enum { ROOM = 160 };
    static const char *const drop[] = {"optimise"};
    const size_t n = f->length[SEARCH_PARAMETER];
    char *const set = calloc(n, ROOM);
    const char **const list = calloc(n, sizeof *list);
    char *text = NULL;
    for (size_t i = 0; set && list && i < n; i++) {
        snprintf(&set[i * ROOM], ROOM, "%.110s=%.17g", f->parameter[i],
                 f->confirmed_value[(size_t)f->chosen * n + i]);
        list[i] = &set[i * ROOM];
    }
    if (set && list)
        text = scenario_rewrite(f->first_scenario, drop, 1, list, n);
    free(set);
    free(list);
    return text;
}

bool best_write(const struct search_file *f, const char *file, stance_message *message)
{
    struct whole_file whole;
    char *const text = best_text(f);
    if (!text)
        return no_memory(message);
    bool good = whole_file_begin(&whole, file);
    if (good) {
        fprintf(whole.out,
                "# The best of %zu candidates of stance optimise: its objective, of fresh starts,\n"
                "# is %.6g; that of the first candidate %.6g.\n%s",
                f->length[SEARCH_CANDIDATE], f->confirmed_objective[f->chosen],
                f->confirmed_objective[0], text);
        good = whole_file_end(&whole, true);
    }
    free(text);
    return good || complain(message, "%.150s: cannot write: %s", file, strerror(errno));
}
