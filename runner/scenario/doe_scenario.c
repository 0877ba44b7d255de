/* doe_scenario.c - sweep.sample: an experimental design in the unit cube, and where its factors
 * lead.
 *
 * A factor takes the unit interval to its values: a range linearly or by equal ratios, whole
 * numbers and listed values by equal parts. Several paths move together.
 */
#include "reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_NUMBERS 0x1p25 /* that a rank keeps: 256 MB */

/* ---- where a factor leads -------------------------------------------------------------------- */

/* Part of n equal ones of the unit interval in which u lies. */
static size_t part(double u, size_t n)
{
    const double place = u * (double)n;
    return place < (double)n ? (size_t)place : n - 1;
}

/* Value of path k of the factor. */
static double factor_value(const struct scenario_factor *f, bool integer, int k, double u)
{
    const size_t paths = (size_t)f->paths;
    if (f->listed)
        return f->value[part(u, f->points) * paths + (size_t)k];
    const double from = f->value[k], to = f->value[paths + (size_t)k];
    if (integer) {
        const double step = (double)part(u, (size_t)fabs(to - from) + 1);
        return from <= to ? from + step : from - step;
    }
    const double value = u >= 1 ? to : f->log ? from * pow(to / from, u) : from + u * (to - from);
    return fmin(fmax(value, fmin(from, to)), fmax(from, to)); /* rounding stays inside */
}

/* Values of all points. False: no memory. */
static bool make_values(struct scenario *s, struct scenario_axis *axis)
{
    const struct scenario_sample *sample = &s->sample;
    struct doe design = sample->design;
    double u[DOE_MAX_FACTORS];
    const size_t paths = (size_t)axis->paths;

    axis->value = malloc(axis->count * paths * sizeof *axis->value);
    const bool good = doe_begin(&design) && axis->value;
    for (size_t i = 0; good && i < axis->count; i++) {
        doe_unit(&design, i, u);
        for (size_t j = 0; j < design.factors; j++) {
            const struct scenario_factor *f = &sample->factor[j];
            for (int k = 0; k < f->paths; k++) {
                axis->value[i * paths + (size_t)(f->first + k)] =
                    factor_value(f, axis->whole[f->first + k], k, u[j]);
            }
        }
    }
    doe_end(&design);
    return good;
}

bool scenario_resample(struct scenario *s, uint64_t count, uint64_t seed)
{
    struct scenario_axis *axis = &s->axis[s->axes - 1];
    s->cases = s->cases / axis->count * count;
    free(axis->value);
    s->sample.design.count = axis->count = count;
    s->sample.design.seed = seed;
    return make_values(s, axis);
}

/* ---- factors --------------------------------------------------------------------------------- */

static bool read_range(struct axis_reader *a, struct scenario_factor *f)
{
    f->points = 2;
    f->value = calloc(2 * (size_t)f->paths, sizeof *f->value);
    if (!f->value)
        return problem_no_memory(&a->r->problems);
    double *const from = f->value, *const to = f->value + f->paths;
    double spacing;
    bool good = axis_read_ends(a, "give from and to, or values", from, to), differ = false;
    if (good && !tree_find(a->node, "to"))
        return axis_complain(a, "to is missing");
    good = axis_read_key(a, "spacing", &spacing) && good;
    f->log = spacing != 0;
    for (int k = 0; good && k < f->paths; k++) {
        differ = differ || from[k] != to[k];
        if (f->log && a->axis->whole[f->first + k])
            return axis_complain(a, "spacing log is for numbers that need not be whole");
        if (f->log && (from[k] <= 0 || to[k] <= 0))
            return axis_complain(a, "spacing log needs from and to above 0");
    }
    if (good && (a->rows ? !differ : !(from[0] < to[0])))
        return axis_complain(a, a->rows ? "from and to are the same point"
                                        : "from must be less than to");
    return good;
}

static bool read_factor(struct axis_reader *a, struct scenario_factor *f)
{
    if (!axis_begin(a, "a mapping with path, from, to"))
        return false;
    f->first = a->first;
    f->paths = a->axis->paths - f->first;
    for (int k = f->first; k < a->axis->paths; k++) {
        struct scenario_meaning *meaning = &a->axis->meaning[k];
        axis_describe(a, k, meaning->unit, meaning->text);
        const struct scenario_field *field = a->swept[k].field;
        char words[400];
        if (a->axis->enumeration[k] &&
            !(meaning->words =
                  strdup(words_join(words, sizeof words, " ", field->words, field->word_count))))
            return problem_no_memory(&a->r->problems);
    }
    const struct tree_node *values = tree_find(a->node, "values");
    f->listed = values != NULL;
    return values ? axis_read_list(a, values, &f->value, &f->points) : read_range(a, f);
}

/* ---- the design ------------------------------------------------------------------------------ */

static bool read_design(struct reader *r)
{
    struct doe *design = &r->s->sample.design;
    bool good = true;
    const double method = reader_number(r, "sweep.sample.method", &good),
                 count = reader_number(r, "sweep.sample.count", &good),
                 second = reader_number(r, "sweep.sample.second_order", &good),
                 levels = reader_number(r, "sweep.sample.levels", &good);

    design->method = isnan(method) ? DOE_METHODS : (enum doe_method)method;
    if (isnan(method) || isnan(count) || !good)
        return false; /* what is missing is said later */
    design->count = (uint64_t)count;
    design->second_order = second != 0;
    design->levels = design->method == DOE_MORRIS ? (int)levels : 0;
    design->seed = r->s->seed;
    return design->levels % 2 == 0 ||
           problem_add(&r->problems, reader_seen(r, "sweep.sample.levels")->node->mark,
                       "sweep.sample.levels: %d is not even", design->levels);
}

/* Directions are those of a space of numbers. */
static bool check_sphere(struct axis_reader *a, const struct scenario_factor *f)
{
    bool whole = false;
    for (int k = 0; k < f->paths; k++)
        whole = whole || a->axis->whole[f->first + k];
    if (f->listed || f->log || whole) {
        return axis_complain(a,
                             "method sphere needs linear ranges of numbers that need not be whole");
    }
    return true;
}

static bool read_factors(struct reader *r, struct scenario_axis *axis)
{
    struct scenario_sample *sample = &r->s->sample;
    const struct tree_node *vary = reader_seen(r, "sweep.sample.vary")->node;
    bool good = true;

    if (!vary || !field_list(&r->problems, "sweep.sample.vary", "a list of factors", vary,
                             DOE_MAX_FACTORS, "factors"))
        return false;
    sample->factor = calloc(vary->count, sizeof *sample->factor);
    axis->meaning = calloc(SCENARIO_MAX_PATHS, sizeof *axis->meaning);
    if (!sample->factor || !axis->meaning)
        return problem_no_memory(&r->problems);
    for (size_t j = 0; j < vary->count; j++) {
        struct axis_reader a = {.r = r,
                                .axis = axis,
                                .swept = r->swept[r->s->axes - 1],
                                .node = vary->item[j],
                                .number = r->s->axes - 1,
                                .path = "sweep.sample.vary[]"};
        snprintf(a.name, sizeof a.name, "sweep.sample.vary[%zu]", j);
        sample->design.factors = j + 1; /* as many as there are to free */
        good = read_factor(&a, &sample->factor[j]) &&
               (sample->design.method != DOE_SPHERE || check_sphere(&a, &sample->factor[j])) &&
               good;
    }
    axis->words = false; /* words are numbers here, with their meaning */
    return good;
}

static bool check_size(struct reader *r, const struct scenario_axis *axis)
{
    const struct doe *design = &r->s->sample.design;
    const size_t most = doe_most_factors(design->method);
    const double points = (double)design->count * (double)doe_block(design);

    if (design->factors > most) {
        return reader_refuse(r, "sweep.sample.vary",
                             ": method %s has at most %zu factors, here are %zu",
                             doe_words[design->method], most, design->factors);
    }
    const struct mark mark = reader_seen(r, "sweep.sample.count")->node->mark;
    if (points * axis->paths > MOST_NUMBERS)
        return problem_add(&r->problems, mark,
                           "sweep.sample.count: %.0f points of %d value%s each are more than the "
                           "2^25 numbers that can be kept in memory",
                           points, axis->paths, axis->paths == 1 ? "" : "s");
    return !(points > MOST_CASES / (double)r->s->cases) ||
           problem_add(&r->problems, mark,
                       "sweep.sample: its %.0f points make more than 2^53 cases with the grid",
                       points);
}

void doe_read(struct reader *r)
{
    struct scenario *s = r->s;
    const struct seen *seen = reader_seen(r, "sweep.sample");

    if (!seen->node || seen->bad || !s->scene)
        return;
    if (s->axes == SCENARIO_MAX_AXES) {
        reader_refuse(r, "sweep.sample", ": more than %d axes with the grid", SCENARIO_MAX_AXES);
        r->axes_bad = true;
        return;
    }
    struct scenario_axis *axis = &s->axis[s->axes++];
    axis->sample = true;
    axis->line = seen->key.line;
    axis->column = seen->key.column;
    snprintf(axis->name, sizeof axis->name, "sample");
    snprintf(axis->unit, sizeof axis->unit, "1");
    snprintf(axis->text, sizeof axis->text, "point of the design");
    s->sample.given = true;
    bool good = read_design(r);
    good = read_factors(r, axis) && good && check_size(r, axis);
    if (!good) {
        r->axes_bad = true;
        return;
    }
    axis->count = (size_t)doe_points(&s->sample.design);
    if (!make_values(s, axis)) {
        r->axes_bad = true;
        problem_no_memory(&r->problems);
        return;
    }
    s->cases *= axis->count;
}

void doe_free(struct scenario_sample *sample)
{
    for (size_t j = 0; sample->factor && j < sample->design.factors; j++)
        free(sample->factor[j].value);
    free(sample->factor);
    sample->factor = NULL;
}
