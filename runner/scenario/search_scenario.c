/* search_scenario.c - the section optimise: what a search varies, by which bounds, and what it
 * maximises; and what that asks of the rest of the scenario.
 */
#include "reader.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_CIRCUMSTANCES 64

/* Units of the logarithm of a pole, a weight: a step of a tenth is 20 %, a factor of 2. */
static const double pole_unit = 2, weight_unit = 7;

/* ---- what varies ----------------------------------------------------------------------------- */

static struct scenario_varied *last_varied(struct axis_reader *a)
{
    return &a->r->s->search.varied[a->axis->paths - 1];
}

/* One more number: a path that the node stands for, or (NULL) the node itself. */
static bool add(struct axis_reader *a, const struct tree_node *at, const char *path,
                enum scenario_scale scale, double unit)
{
    struct scenario_axis *const axis = a->axis;
    struct tree_node node = *at;
    if (path) {
        node.kind = TREE_SCALAR;
        node.text = path;
    }
    if (axis->paths == SCENARIO_MAX_PATHS)
        return problem_add(&a->r->problems, at->mark, "%s: more than %d numbers", a->name,
                           SCENARIO_MAX_PATHS);
    if (!axis_read_path(a, &node))
        return false;
    const struct scenario_field *const field = a->swept[axis->paths - 1].field;
    if (axis->whole[axis->paths - 1])
        return problem_add(&a->r->problems, at->mark,
                           "%s: %s takes %s, which are not varied: search for each of them with "
                           "--set, or list them in sweep.grid",
                           a->name, node.text,
                           field->type == FIELD_WORD ? "words" : "whole numbers");
    *last_varied(a) = (struct scenario_varied){scale, field->low, field->high, unit, false};
    return true;
}

/* Paths that a word stands for: LIST[i], or with columns LIST[i][j]. */
static bool add_paths(struct axis_reader *a, const char *list, size_t rows, size_t columns,
                      enum scenario_scale scale, double unit)
{
    const size_t each = columns > 0 ? columns : 1;
    bool good = true;
    for (size_t i = 0; good && i < rows * each; i++) {
        char path[96];
        snprintf(path, sizeof path, "%s[%zu]", list, i / each);
        if (columns > 0)
            add_text(path, sizeof path, "[%zu]", i % each);
        good = add(a, a->node, path, scale, unit);
    }
    return good;
}

static bool add_gains(struct axis_reader *a)
{
    struct scenario *const s = a->r->s;
    const size_t m = (size_t)s->scene->actuators, n = 2 * (size_t)s->scene->postures;
    s->search.designed_gains = s->base.design != DESIGN_GAINS;
    if (m * n > SCENARIO_MAX_PATHS)
        return axis_complain(a, "there are more gains than the 48 numbers that can be varied");
    return s->search.designed_gains || add_paths(a, "controller.gains", m, n, SCALE_EVEN, NAN);
}

static bool add_poles(struct axis_reader *a)
{
    const struct scenario_values *const base = &a->r->s->base;
    const struct tree_node *const poles = reader_seen(a->r, "controller.poles")->node;
    double re[SCENARIO_MAX_POLES], im[SCENARIO_MAX_POLES];
    const int count = scenario_poles(base, re, im);
    bool good = true;
    if (base->design != DESIGN_PLACE && base->design != DESIGN_PLACE_SCHUR)
        return axis_complain(a, "poles are those of controller.design place or place-schur");
    for (int i = 0; i < count; i++)
        if (im[i] != 0)
            return axis_complain(a, "poles that are not real cannot be varied; give real ones");
    if (!poles || poles->kind != TREE_MAP)
        return add_paths(a, "controller.poles", (size_t)count, 0, SCALE_NEGATIVE_RATIO, pole_unit);
    for (size_t i = 0; good && i < poles->count; i++) {
        char path[96];
        reader_pole(a->r, poles, i, path);
        good = add(a, a->node, path, SCALE_NEGATIVE_RATIO, pole_unit);
    }
    return good;
}

static bool add_weights(struct axis_reader *a)
{
    const stance_scene *const scene = a->r->s->scene;
    if (a->r->s->base.design != DESIGN_LQR)
        return axis_complain(a, "weights are those of controller.design lqr");
    return add_paths(a, "controller.weights.states", 2 * (size_t)scene->postures, 0, SCALE_RATIO,
                     weight_unit) &&
           add_paths(a, "controller.weights.torques", (size_t)scene->actuators, 0, SCALE_RATIO,
                     weight_unit);
}

/* The parameters of the scenario's law that are numbers and may be swept. */
static bool add_law(struct axis_reader *a)
{
    const struct schema *const schema = a->r->schema;
    const struct scenario_values *const base = &a->r->s->base;
    const int before = a->axis->paths;
    const bool own = scenario_law(base)->program;
    bool good = true;
    for (size_t i = 0; good && i < schema->count; i++) {
        const struct scenario_field *const field = &schema->field[i];
        if (!(own ? field->use == USE_PROGRAM : field->use == USE_LAW && field->law == base->law) ||
            !field->sweep || field->type != FIELD_NUMBER || field->low == field->high)
            continue;
        for (size_t k = 0; good && k < schema_items(field); k++) {
            char path[128];
            const double value = schema_number(field, base, k);
            const bool ratio = field->low >= 0 && value > 0;
            if (isfinite(value)) /* not as it is by default, which is no number */
                good = add(a, a->node, schema_item_path(field, k, path),
                           ratio ? SCALE_RATIO : SCALE_EVEN, ratio ? weight_unit : NAN);
        }
    }
    return good && (a->axis->paths > before ||
                    axis_complain(a, "this controller.kind has no parameters that are numbers"));
}

static bool read_word(struct axis_reader *a)
{
    static bool (*const add[])(struct axis_reader *) = {add_gains, add_poles, add_weights, add_law};
    int word;
    return field_word(&a->r->problems, schema_find(a->r->schema, "optimise.vary"), a->name, a->node,
                      &word) &&
           add[word](a);
}

/* {path, from, to, spacing, unit} */
static bool read_entry(struct axis_reader *a)
{
    struct problems *const problems = &a->r->problems;
    const size_t before = problems->count + problems->lost;
    double from, to, unit, spacing;
    reader_check_keys(a->r, a->node, a->path, a->name);
    const struct tree_node *const path = tree_find(a->node, "path");
    if (problems->count + problems->lost != before)
        return false;
    if (!path)
        return axis_complain(a, "path is missing");
    if (!add(a, path, NULL, SCALE_EVEN, NAN))
        return false;
    struct scenario_varied *const varied = last_varied(a);
    const struct scenario_field *const field = a->swept[a->axis->paths - 1].field;
    const char *const name = a->axis->path[a->axis->paths - 1];
    bool good = axis_read_key(a, "from", &from);
    good = axis_read_key(a, "to", &to) && good;
    good = axis_read_key(a, "unit", &unit) && good;
    good = axis_read_key(a, "spacing", &spacing) && good;
    if (!good)
        return false;
    const bool bounded = !isnan(from) || !isnan(to), ratios = spacing != 0;
    const char *const wrong = bounded && isnan(from) ? "from is missing"
                              : bounded && isnan(to) ? "to is missing"
                              : !bounded && isnan(unit) && field->columns == 0
                                  ? "give from and to, or a unit"
                              : bounded && !(from < to)        ? "from must be less than to"
                              : bounded && ratios && from <= 0 ? "spacing log needs from above 0"
                                                               : NULL;
    if (wrong)
        return axis_complain(a, wrong);
    if (bounded && (!field_admits(problems, field, name, "from", path->mark, from) ||
                    !field_admits(problems, field, name, "to", path->mark, to)))
        return false;
    if (bounded && isnan(unit))
        unit = ratios ? log(to / from) : to - from;
    const double low = bounded ? from : varied->low;
    *varied = (struct scenario_varied){ratios ? SCALE_RATIO : SCALE_EVEN,
                                       ratios ? fmax(low, 0) : low, /* ratios keep the sign */
                                       bounded ? to : varied->high, unit, bounded};
    return true;
}

static bool read_vary(struct reader *r)
{
    struct scenario_search *const search = &r->s->search;
    const struct tree_node *const vary = reader_seen(r, "optimise.vary")->node;
    const bool list = vary && vary->kind == TREE_LIST;
    bool good = true;

    if (!vary ||
        (list && !field_list(&r->problems, "optimise.vary", "words and mappings", vary, 0, NULL)))
        return false;
    for (size_t i = 0; i < (list ? vary->count : 1); i++) {
        struct axis_reader a = {.r = r,
                                .axis = &search->axis,
                                .swept = r->sought,
                                .node = list ? vary->item[i] : vary,
                                .number = r->s->axes - 1,
                                .path = "optimise.vary[]"};
        snprintf(a.name, sizeof a.name, list ? "optimise.vary[%zu]" : "optimise.vary", i);
        good = (a.node->kind == TREE_MAP ? read_entry(&a) : read_word(&a)) && good;
    }
    search->axis.count = 1;
    return good;
}

/* ---- how the search goes -------------------------------------------------------------------- */

static bool read_grow(struct reader *r)
{
    struct scenario_search *const search = &r->s->search;
    const struct tree_node *const grow = reader_seen(r, "optimise.grow")->node;
    const uint64_t count = r->s->sample.design.count;
    bool good = true;
    if (!grow) {
        const uint64_t usual[] = {(count + 3) / 4, count, 4 * count};
        search->stages = 3;
        memcpy(search->grow, usual, sizeof usual);
        return true;
    }
    if (!field_list(&r->problems, "optimise.grow", "a list of numbers of starts", grow,
                    SCENARIO_MAX_STAGES, "stages"))
        return false;
    for (size_t i = 0; i < grow->count; i++) {
        char name[32];
        double number = 0;
        snprintf(name, sizeof name, "optimise.grow[%zu]", i);
        const bool fits = field_number(&r->problems, schema_find(r->schema, "optimise.grow[]"),
                                       name, grow->item[i], &number);
        search->grow[i] = fits ? (uint64_t)number : 0;
        good &= fits;
        if (good && i > 0 && search->grow[i] <= search->grow[i - 1])
            good = problem_add(&r->problems, grow->item[i]->mark,
                               "%s: %.0f is not more than the stage before has", name, number);
    }
    search->stages = (int)grow->count;
    return good;
}

static void read_prices(struct reader *r, bool *good)
{
    for (int i = 0; i < STANCE_ANSWER_COUNT; i++) {
        char path[96];
        snprintf(path, sizeof path, "optimise.price.%s", stance_answers[i].name);
        if (schema_find(r->schema, path))
            r->s->search.price[i] = reader_number(r, path, good);
    }
    r->s->search.gain_price = reader_number(r, "optimise.price.gain", good);
}

void search_read(struct reader *r)
{
    struct scenario_search *const search = &r->s->search;
    const struct seen *const seen = reader_seen(r, "optimise");

    if (!seen->node || seen->bad || !r->s->scene)
        return;
    search->given = true;
    bool good = read_vary(r);
    const double aim = reader_number(r, "optimise.maximise", &good),
                 confirm = reader_number(r, "optimise.confirm", &good);
    search->normal = reader_number(r, "optimise.weight", &good) != 0;
    search->worst = reader_number(r, "optimise.over", &good) == 0;
    search->critical = reader_number(r, "optimise.require.critical_sample_time", &good);
    search->candidates = (uint64_t)reader_number(r, "optimise.candidates", &good);
    search->restarts = (int)reader_number(r, "optimise.restarts", &good);
    search->step = reader_number(r, "optimise.first_step", &good);
    read_prices(r, &good);
    if (!r->s->sample.given || r->axes_bad) {
        if (!r->axes_bad)
            reader_refuse(r, "optimise", " needs sweep.sample: starts that all candidates get");
        return;
    }
    if (!read_grow(r) || !good)
        return;
    search->aim = aim < AIM_ANSWER ? (enum scenario_aim)aim : AIM_ANSWER;
    search->answer = (int)aim - AIM_ANSWER;
    search->confirm = isnan(confirm) ? 8 * search->grow[search->stages - 1] : (uint64_t)confirm;
}

/* ---- what that asks of the rest ------------------------------------------------------------- */

/* The starts: drawn so that more of them can be had, each by itself. */
static void check_starts(struct reader *r)
{
    const struct scenario *const s = r->s;
    const struct scenario_axis *const sample = &s->axis[s->axes - 1];
    const enum doe_method method = s->sample.design.method;
    bool starts = false;
    for (int k = 0; k < sample->paths; k++)
        starts = starts || scenario_is_start(sample->path[k]);
    if (!starts)
        reader_refuse(r, "sweep.sample",
                      ": optimise needs starts in it: initial.offset or initial.state");
    if (method != DOE_RANDOM && method != DOE_SOBOL && method != DOE_SPHERE)
        reader_refuse(r, "sweep.sample.method",
                      " %s has no meaning with optimise, whose starts grow in "
                      "number: sobol, random or sphere",
                      doe_words[method]);
    if (s->search.aim == AIM_NEAREST) {
        int k;
        const struct scenario_axis *const scale =
            scenario_axis_of(s, offsetof(struct scenario_values, offset_scale), &k);
        bool rises = scale != NULL;
        for (size_t i = 0; rises && i < scale->count; i++)
            rises = scenario_axis_value(scale, i, k) >
                    (i > 0 ? scenario_axis_value(scale, i - 1, k) : 0);
        if (method != DOE_SPHERE || !rises || scale->paths != 1 || scale->sample)
            reader_refuse(r, "optimise.maximise",
                          " nearest needs sweep.sample.method sphere and "
                          "initial.offset.scale, rising from above 0, alone on an axis of "
                          "sweep.grid");
    }
    if (8 * s->search.grow[s->search.stages - 1] > UINT64_C(1) << 26)
        reader_refuse(r, "optimise.grow", ": more starts than can be kept");
}

static void check_circumstances(struct reader *r)
{
    const struct scenario *const s = r->s;
    const size_t circumstances = (size_t)(s->cases / s->axis[s->axes - 1].count);
    for (int a = 0; a + 1 < s->axes; a++)
        for (int k = 0; k < s->axis[a].paths; k++)
            if (scenario_is_start(s->axis[a].path[k]))
                problem_add(&r->problems, r->swept[a][k].mark,
                            "sweep.grid[%d]: %s is a start: with optimise starts come from "
                            "sweep.sample, the grid has circumstances",
                            a, s->axis[a].path[k]);
    int k;
    const struct scenario_axis *const methods =
        scenario_axis_of(s, offsetof(struct scenario_values, method), &k);
    if (methods)
        problem_add(&r->problems, (struct mark){0, methods->line, methods->column},
                    "%s: optimise needs one method for all candidates", methods->path[k]);
    if (circumstances > MOST_CIRCUMSTANCES && s->search.aim != AIM_NEAREST)
        reader_refuse(r, "sweep.grid",
                      ": %zu circumstances are more than the %d that optimise compares",
                      circumstances, MOST_CIRCUMSTANCES);
    if (circumstances == 1 && reader_seen(r, "optimise.over")->node)
        reader_refuse(r, "optimise.over",
                      " needs circumstances, sweep.grid with more than one point");
}

/* What the first candidate is must be known, and lie within the bounds. */
static void check_first(struct reader *r)
{
    const struct scenario_search *const search = &r->s->search;
    for (int k = 0; k < search->axis.paths; k++) {
        const struct scenario_varied *const v = &search->varied[k];
        char wrong[160] = "";
        double is;
        memcpy(&is, (const char *)&r->s->base + search->axis.offset[k], sizeof is);
        if (scenario_is_start(search->axis.path[k]))
            snprintf(wrong, sizeof wrong,
                     "is a start, the same for all candidates: starts are those of sweep.sample");
        else if (search->axis.offset[k] == offsetof(struct scenario_values, sample_time) &&
                 !(v->low > 0))
            snprintf(wrong, sizeof wrong,
                     "needs a range from above 0: the shorter it is, the longer a candidate takes");
        else if (!isfinite(is))
            snprintf(wrong, sizeof wrong, "has no value to begin with: give it one");
        else if (is < v->low || is > v->high)
            snprintf(wrong, sizeof wrong,
                     "is %g in the first candidate, out of its range %g ... %g", is, v->low,
                     v->high);
        else if ((v->scale == SCALE_RATIO && is <= 0) ||
                 (v->scale == SCALE_NEGATIVE_RATIO && is >= 0))
            snprintf(wrong, sizeof wrong,
                     "is %g in the first candidate, of which there are no ratios", is);
        if (wrong[0])
            problem_add(&r->problems, r->sought[k].mark, "optimise.vary: %s %s",
                        search->axis.path[k], wrong);
    }
}

static void check_gains(struct reader *r)
{
    const struct scenario *const s = r->s;
    double limit[STANCE_MAX_ACTUATORS];
    /* The word among those that are varied, or the gains one by one. */
    bool any = s->search.designed_gains;
    for (int k = 0; k < s->search.axis.paths; k++)
        any = any || (strncmp(s->search.axis.path[k], "controller.gains[", 17) == 0 &&
                      isnan(s->search.varied[k].unit));
    if (!any)
        return;
    if (!scenario_law(&s->base)->designed) {
        reader_refuse(r, "optimise.vary", ": gains are those of a law that is designed (here: %s)",
                      scenario_law(&s->base)->name);
        return;
    }
    if (scenario_far(&s->base) != stance_laws()[0] && s->search.designed_gains)
        reader_refuse(r, "controller.far",
                      " has no meaning with optimise.vary gains: what acts far away "
                      "would stay as it is");
    stance_torque_limits(s->scene, s->base.robot, s->base.torque_limit, s->base.torque_limits,
                         limit);
    for (int i = 0; i < s->scene->actuators; i++)
        if (!isfinite(limit[i])) {
            reader_refuse(r, "optimise.vary",
                          ": gains have no unit without controller.torque_limit: give "
                          "one, or each gain by {path, from, to}");
            return;
        }
}

void search_check(struct reader *r)
{
    const struct scenario *const s = r->s;
    const struct scenario_search *const search = &s->search;

    if (!search->given || r->axes_bad || search->stages == 0 || r->problems.count > 0)
        return;
    if (!s->base.settle && s->base.walk_steps == 0)
        reader_refuse(r, "stop.settle",
                      " off has no meaning with optimise: stabilised starts are to end");
    if (search->aim == AIM_ANSWER && stance_answers[search->answer].type == STANCE_UINT8)
        reader_refuse(r, "optimise.maximise", ": %s is no number",
                      stance_answers[search->answer].name);
    if (search->critical > 0 && s->base.sample_time == 0)
        reader_refuse(r, "optimise.require.critical_sample_time",
                      " needs controller.sample_time above 0");
    check_starts(r);
    check_circumstances(r);
    check_first(r);
    r->s->search.axis.design = true; /* whatever it moves */
    check_gains(r);
}

/* ---- what it is, and takes ------------------------------------------------------------------ */

bool scenario_search_plain(const struct scenario *s)
{
    const struct scenario_search *const search = &s->search;
    bool plain = search->aim == AIM_SHARE && !search->normal && search->gain_price == 0;
    for (int i = 0; i < STANCE_ANSWER_COUNT; i++)
        plain = plain && search->price[i] == 0;
    return plain;
}

double scenario_search_until(const struct scenario *s, int stage)
{
    static const double three[] = {0.5, 0.85, 1};
    return s->search.stages == 3 ? three[stage] : (stage + 1.0) / s->search.stages;
}

double scenario_search_cases(const struct scenario *s)
{
    const struct scenario_search *const search = &s->search;
    const double circumstances = (double)s->cases / (double)s->axis[s->axes - 1].count;
    const double compared = 1 + 2.0 * search->stages * (search->restarts + 1);
    double starts = 2 * compared * (double)search->confirm; /* to choose by, and fresh ones */
    for (int k = 0; k < search->stages; k++) {
        const double part =
            scenario_search_until(s, k) - (k > 0 ? scenario_search_until(s, k - 1) : 0);
        starts +=
            part * (double)search->candidates * (search->restarts + 1) * (double)search->grow[k];
    }
    return starts * circumstances;
}
