/* summary.c - collects what `stance summary` prints. */
#include "summary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double summary_share(const struct summary *summary, const struct statistics_counts *counts)
{
    return counts->done ? (double)counts->kind[summary->judged] / (double)counts->done : NAN;
}

bool summary_has_outcomes(const struct summary *summary)
{
    return summary->counts.done == 0 || summary->counts.kind[RESULTS_DONE] < summary->counts.done;
}

const char *summary_failure_name(int failure)
{
    static const char *const names[] = {
#define FAILURE_NAME(NAME, name, text) #name,
        STANCE_FAILURES(FAILURE_NAME)
#undef FAILURE_NAME
    };
    return failure >= 0 && failure < (int)(sizeof names / sizeof names[0]) ? names[failure]
                                                                           : "unknown";
}

const char *summary_failure_text(int failure)
{
    static const char *const texts[] = {
#define FAILURE_TEXT(NAME, name, text) text,
        STANCE_FAILURES(FAILURE_TEXT)
#undef FAILURE_TEXT
    };
    return failure > 0 && failure < (int)(sizeof texts / sizeof texts[0])
               ? texts[failure]
               : "the file does not say why";
}

/* ---- the answers -------------------------------------------------------------------------- */

static bool collect_numbers(struct summary *summary, const struct results *r,
                            stance_message *message)
{
    static const struct summary_numbers wanted[SUMMARY_NUMBER_COUNT] = {
#define SUMMARY_NUMBER(name, kind, unit) [SUMMARY_##name] = {#name, unit, kind, false, {0}},
        SUMMARY_NUMBERS(SUMMARY_NUMBER)
#undef SUMMARY_NUMBER
    };
    for (int k = 0; k < SUMMARY_NUMBER_COUNT; k++) {
        struct summary_numbers *numbers = &summary->numbers[k];
        double *values;
        *numbers = wanted[k];
        numbers->of = numbers->of == RESULTS_STABILISED ? summary->judged : numbers->of;
        if (!results_answer(r, numbers->name, &values, message)) {
            return false;
        }
        if (!values) {
            continue;
        }
        for (uint64_t i = 0; numbers->of != RESULTS_KIND_COUNT && i < r->cases; i++) {
            values[i] = r->kind[i] == numbers->of ? values[i] : NAN;
        }
        numbers->stored = true;
        statistics_summarise(values, (size_t)r->cases, &numbers->numbers);
        free(values);
    }
    return true;
}

static bool collect_count(struct summary_count *count, const struct results *r, const char *name,
                          stance_message *message)
{
    double *values;
    if (!results_answer(r, name, &values, message)) {
        return false;
    }
    for (uint64_t i = 0; values && i < r->cases; i++) {
        if (values[i] > 0) { /* false for NAN, too */
            count->sum += values[i];
            count->cases++;
        }
    }
    count->stored = values != NULL;
    free(values);
    return true;
}

static void collect_failures(struct summary *summary, const struct results *r)
{
    for (uint64_t i = 0; i < r->cases; i++) {
        if (r->kind[i] == RESULTS_FAILED) {
            int failure = r->failure ? r->failure[i] : 0;
            summary->failures[failure < SUMMARY_FAILURES ? failure : 0]++;
        }
    }
}

static bool collect_axes(struct summary *summary, const struct results *r, stance_message *message)
{
    const size_t origin[SCENARIO_MAX_AXES] = {0};
    for (int a = 0; !r->single && a < r->axes; a++) {
        summary->parameters += !r->axis[a].offset;
    }
    for (int a = 0; !r->single && a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        if (axis->offset) {
            summary->has_extent[a] =
                summary->parameters == 0 && statistics_extent(r, a, origin, &summary->extent[a]);
            continue;
        }
        struct statistics_counts *counts = malloc(axis->count * sizeof *counts);
        if (!counts) {
            snprintf(message->text, sizeof message->text, "%.100s: not enough memory", r->file);
            return false;
        }
        summary->by_value[a] = counts;
        statistics_count_axis(r, a, counts);
        double largest = 0;
        for (size_t i = 0; i + 1 < axis->count; i++) {
            double change =
                fabs(summary_share(summary, &counts[i + 1]) - summary_share(summary, &counts[i]));
            if (change > largest) {
                largest = change;
                summary->steepest[a] = i;
            }
        }
    }
    return true;
}

/* ---- what does not vary ------------------------------------------------------------------- */

static bool is_varied(const struct results *r, const struct scenario *s, const char *path)
{
    for (int a = 0; a < s->axes; a++) {
        for (int k = 0; k < s->axis[a].paths; k++) {
            if (strcmp(s->axis[a].path[k], path) == 0) {
                return !r->single;
            }
        }
    }
    for (int a = 0; a < r->axes; a++) {
        if (strcmp(r->axis[a].name, path) == 0) {
            return true;
        }
    }
    return false;
}

/* State of one collection of fields. */
struct collection {
    struct summary *summary;
    const struct results *r;
    const struct scenario *s;
};

static struct summary_field *add_field(struct collection *c, const char *path)
{
    if (c->summary->fields == SUMMARY_FIELDS || is_varied(c->r, c->s, path)) {
        return NULL;
    }
    struct summary_field *field = &c->summary->field[c->summary->fields++];
    snprintf(field->path, sizeof field->path, "%s", path);
    field->unit[0] = '\0';
    field->number = NAN;
    return field;
}

static void add_number(struct collection *c, const char *path, double number, const char *unit)
{
    struct summary_field *field = isnan(number) ? NULL : add_field(c, path);
    if (field) {
        snprintf(field->text, sizeof field->text, "%.6g", number);
        snprintf(field->unit, sizeof field->unit, "%s", strcmp(unit, "1") == 0 ? "" : unit);
        field->number = number;
    }
}

static void add_text(struct collection *c, const char *path, const char *text)
{
    struct summary_field *field = add_field(c, path);
    if (field) {
        snprintf(field->text, sizeof field->text, "%s", text);
    }
}

static void add_initial(struct collection *c, const struct scenario_values *v)
{
    const stance_scene *scene = c->s->scene;
    double start[STANCE_MAX_COORDINATES];
    char path[96];
    /* The whole posture, when all cases share it; else what the scenario gives. */
    bool whole = results_numbers(c->r, "design/start_position", start, STANCE_MAX_COORDINATES) ==
                 (size_t)scene->coordinates;
    for (int i = 0; v->equilibrium.given && i < scene->postures; i++) {
        const stance_quantity *q = &scene->coordinate[scene->posture[i]];
        snprintf(path, sizeof path, "initial.equilibrium.%s", q->name);
        add_number(c, path, whole ? start[scene->posture[i]] : v->equilibrium.posture[i], q->unit);
    }
    if (v->support_foot > 0) {
        add_number(c, "initial.support_foot", v->support_foot, "");
    }
    for (int i = 0; i < 2 * scene->coordinates; i++) {
        const stance_quantity *q = &scene->coordinate[i % scene->coordinates];
        bool rate = i >= scene->coordinates, state = v->state_given;
        char unit[32];
        snprintf(path, sizeof path, "initial.%s.%s%s", state ? "state" : "offset", rate ? "v" : "",
                 q->name);
        snprintf(unit, sizeof unit, "%.20s%s", q->unit, rate ? "/s" : "");
        double number = state ? v->state[i] : v->offset[i];
        add_number(c, path, number == 0 ? NAN : number, unit);
    }
}

static void add_controller(struct collection *c, const struct scenario_values *v)
{
    static const char *const laws[] = {"none", "hold", "state-feedback", "decoupling"};
    static const char *const designs[] = {"place", "gains"};
    add_text(c, "controller.kind", v->law >= 0 && v->law < 4 ? laws[v->law] : "unknown");
    if (v->law == LAW_NONE) {
        return;
    }
    if (v->law == LAW_STATE_FEEDBACK) {
        add_text(c, "controller.design",
                 v->design >= 0 && v->design < 2 ? designs[v->design] : "unknown");
    } else {
        add_number(c, "controller.kp", v->kp, "N m/rad");
        add_number(c, "controller.kd", v->kd, "N m s/rad");
    }
    add_number(c, "controller.sample_time", v->sample_time, "s");
    add_number(c, "controller.torque_limit", v->torque_limit, "N m");
    add_number(c, "controller.noise", v->noise, "N m");
}

static void add_fields(struct collection *c, const struct scenario_values *v)
{
    const stance_scene *scene = c->s->scene;
    const stance_method *const *methods = stance_methods();
    char text[160] = "", path[96];

    for (int i = 0; i < scene->robot_count; i++) {
        snprintf(path, sizeof path, "robot.%s", scene->robot[i].name);
        add_number(c, path, v->robot[i], scene->robot[i].unit);
    }
    add_number(c, "ground.friction", v->friction, "");
    add_number(c, "ground.restitution", v->restitution, "");
    for (int i = 0; i < scene->contacts; i++) {
        size_t used = strlen(text);
        if (v->contacts >> i & 1) {
            snprintf(text + used, sizeof text - used, "%s%s", used ? " " : "",
                     scene->contact_name[i]);
        }
    }
    add_text(c, "ground.contacts", text);
    add_initial(c, v);
    add_controller(c, v);
    int count = 0;
    while (methods[count]) {
        count++;
    }
    add_text(c, "method.name",
             v->method >= 0 && v->method < count ? methods[v->method]->name : "unknown");
    add_number(c, "method.step", v->step, "s");
    if (v->method >= 0 && v->method < count && methods[v->method]->tolerance > 0) {
        add_number(c, "method.tolerance",
                   isnan(v->tolerance) ? methods[v->method]->tolerance : v->tolerance, "m, rad");
    }
    add_number(c, "stop.time", v->stop_time, "s");
    if (v->settle) {
        add_number(c, "stop.settle.angle", scene->postures ? v->settle_angle : NAN, "rad");
        add_number(c, "stop.settle.rate", v->settle_rate, "rad/s");
        add_number(c, "stop.settle.hold", v->settle_hold, "s");
    }
    add_number(c, "stop.fall_height", scene->height ? v->fall_height : NAN, "");
    if (v->capture) {
        add_text(c, "stop.capture", "estimated");
    }
}

static void collect_fields(struct summary *summary, const struct results *r,
                           const struct scenario *s)
{
    struct collection collection = {summary, r, s};
    struct scenario_values values = s->base;
    if (r->single && s->axes > 0 && r->index < s->cases) {
        scenario_case_values(s, r->index, &values);
    }
    add_fields(&collection, &values);
}

/* ---- all of it ---------------------------------------------------------------------------- */

bool summary_make(struct summary *summary, const struct results *r, stance_message *message)
{
    struct scenario s;
    /* A scenario of another version cannot be read: the summary goes without. */
    const bool readable = results_scenario(r, &s);
    *summary = (struct summary){.judged = RESULTS_STABILISED};
    if (readable && s.base.law != LAW_STATE_FEEDBACK) {
        summary->judged = RESULTS_RESTED;
    }
    statistics_count(r, -1, 0, &summary->counts);
    collect_failures(summary, r);
    bool good = collect_numbers(summary, r, message) &&
                collect_count(&summary->steps, r, "steps", message) &&
                collect_count(&summary->iterations, r, "iterations", message) &&
                collect_count(&summary->evaluations, r, "evaluations", message) &&
                collect_count(&summary->events, r, "events", message) &&
                collect_count(&summary->ambiguous, r, "ambiguous_steps", message) &&
                collect_count(&summary->subdivided, r, "subdivided_steps", message) &&
                collect_axes(summary, r, message);
    if (good) {
        summary->timed = results_timing(r, &summary->longest, &summary->total,
                                        &summary->timed_cases, &summary->ranks);
        if (readable) {
            collect_fields(summary, r, &s);
        }
    } else {
        summary_free(summary);
    }
    if (readable) {
        scenario_free(&s);
    }
    return good;
}

void summary_free(struct summary *summary)
{
    for (int a = 0; a < SCENARIO_MAX_AXES; a++) {
        free(summary->by_value[a]);
    }
    *summary = (struct summary){0};
}
