/* summary_fields.c - the fields of the scenario that a sweep leaves alone, for `stance summary`. */
#include "summary.h"

#include "runner/base/problem.h"
#include "runner/scenario/schema.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_varied(const struct results *r, const struct scenario *s, const char *path)
{
    for (int a = 0; a < s->axes; a++) {
        for (int k = 0; k < s->axis[a].paths; k++)
            if (strcmp(s->axis[a].path[k], path) == 0)
                return !r->single;
    }
    for (int a = 0; a < r->axes; a++)
        if (strcmp(r->axis[a].name, path) == 0)
            return true;
    return false;
}

/* State of one collection of fields. */
struct collection {
    struct summary *summary;
    const struct results *r;
    const struct scenario *s;
    const struct schema *schema;
};

static struct summary_field *add_field(struct collection *c, const char *path)
{
    if (c->summary->fields == SUMMARY_FIELDS || is_varied(c->r, c->s, path))
        return NULL;
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
    if (field)
        snprintf(field->text, sizeof field->text, "%s", text);
}

/* Contacts of the ground by name; stops of joints are none. */
static void add_contacts(struct collection *c, const char *path, int contacts)
{
    const stance_scene *const scene = c->s->scene;
    const char *names[STANCE_MAX_CONTACTS];
    char text[sizeof c->summary->field->text];
    size_t count = 0;
    for (int i = 0; i < scene->contacts; i++)
        if ((contacts >> i & 1) && !(scene->grip && scene->grip[i] < 0))
            names[count++] = scene->contact_name[i];
    if (count > 0)
        add_text(c, path, words_join(text, sizeof text, " ", names, count));
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
    if (v->support_foot > 0)
        add_number(c, "initial.support_foot", v->support_foot, "");
    if (v->support)
        add_contacts(c, "initial.support", v->support);
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

/* How a field that stands for nothing, a zero or an absent limit, is told. */
enum telling { ALWAYS, WHERE_GIVEN };

/* A field of the scenario's table: a word, a whole number or a number. NAN is left out. */
static void add_entry(struct collection *c, const char *path, const struct scenario_values *v,
                      enum telling telling)
{
    const struct scenario_field *field = schema_find(c->schema, path);
    if (!field || field->offset == NO_OFFSET)
        return;
    const char *base = (const char *)v + field->offset;
    double number;
    int word;
    if (field->type == FIELD_NUMBER) {
        memcpy(&number, base, sizeof number);
    } else {
        memcpy(&word, base, sizeof word);
        number = word;
    }
    if (field->type == FIELD_WORD) {
        add_text(c, path,
                 word >= 0 && (size_t)word < field->word_count ? field->words[word] : "unknown");
    } else if (telling == ALWAYS || (number != 0 && isfinite(number))) {
        if (isinf(number))
            add_text(c, path, "none");
        else
            add_number(c, path, number, field->unit);
    }
}

/* What a law is told: of parameters by coordinates those of the selection that it controls. Where
 * that is varied the loops of all coordinates may act, and nothing is told. */
static void add_law(struct collection *c, const struct scenario_values *v, const stance_law *law)
{
    const stance_scene *const scene = c->s->scene;
    char path[96];
    int selected[STANCE_MAX_ACTUATORS], selection = -1;

    for (int p = 0; p < law->parameters; p++) {
        const stance_parameter *const parameter = &law->parameter[p];
        const enum telling telling = parameter->told ? ALWAYS : WHERE_GIVEN;
        snprintf(path, sizeof path, "controller.%s", parameter->of.name);
        if (parameter->per == STANCE_PER_SELECTION && !is_varied(c->r, c->s, path))
            memcpy(&selection, scenario_law_value(v, law->name, parameter->of.name),
                   sizeof selection);
        if (parameter->per == STANCE_PER_LAW || parameter->per == STANCE_PER_SELECTION)
            add_entry(c, path, v, telling);
        const bool posture = parameter->per == STANCE_PER_POSTURE, told = parameter->told;
        const int *const of = posture                                         ? scene->posture
                              : told && parameter->per == STANCE_PER_ACTUATOR ? scene->actuated
                              : parameter->per == STANCE_PER_COORDINATE &&
                                      stance_selection(scene, selection, selected)
                                  ? selected
                                  : NULL;
        for (int k = 0; of && k < (posture ? scene->postures : scene->actuators); k++) {
            snprintf(path, sizeof path, "controller.%s.%s", parameter->of.name,
                     scene->coordinate[of[k]].name);
            add_entry(c, path, v, telling);
        }
    }
}

/* The linear law, and what acts far from its target. */
static void add_feedback(struct collection *c, const struct scenario_values *v)
{
    add_entry(c, "controller.design", v, ALWAYS);
    if (v->design != DESIGN_GAINS)
        add_entry(c, "controller.design_time", v, ALWAYS);
    if (scenario_far(v)->set) {
        add_entry(c, "controller.far", v, ALWAYS);
        add_entry(c, "controller.near.angle", v, ALWAYS);
        add_entry(c, "controller.near.rate", v, ALWAYS);
    }
}

static void add_controller(struct collection *c, const struct scenario_values *v)
{
    add_entry(c, "controller.kind", v, ALWAYS);
    if (v->law == 0)
        return;
    if (scenario_law(v)->designed)
        add_feedback(c, v);
    add_law(c, v, scenario_law(v));
    add_law(c, v, scenario_far(v));
    add_entry(c, "controller.sample_time", v, ALWAYS);
    static const char *const given[] = {"controller.delay", "controller.lag",
                                        "controller.torque_rate", "controller.angle_noise",
                                        "controller.rate_noise"};
    char path[96];
    for (size_t k = 0; k < sizeof given / sizeof *given; k++)
        add_entry(c, given[k], v, WHERE_GIVEN);
    add_entry(c, "controller.torque_limit", v, ALWAYS);
    for (int i = 0; i < c->s->scene->actuators; i++) {
        snprintf(path, sizeof path, "controller.torque_limits[%d]", i);
        if (isfinite(v->torque_limits[i]))
            add_number(c, path, v->torque_limits[i], "N m");
    }
    add_entry(c, "controller.noise", v, ALWAYS);
}

static void add_fields(struct collection *c, const struct scenario_values *v)
{
    const stance_scene *scene = c->s->scene;
    const stance_method *const *methods = stance_methods();
    char path[96];

    for (int i = 0; i < scene->robot_count; i++) {
        snprintf(path, sizeof path, "robot.%s", scene->robot[i].name);
        add_number(c, path, v->robot[i], scene->robot[i].unit);
    }
    add_number(c, "ground.friction", v->friction, "");
    add_number(c, "ground.restitution", v->restitution, "");
    add_number(c, "ground.slope", scene->mechanism ? v->robot[STANCE_ROBOT_SLOPE] : NAN, "rad");
    add_number(c, "ground.gravity", scene->mechanism ? v->robot[STANCE_ROBOT_GRAVITY] : NAN,
               "m/s^2");
    if (v->impacts != STANCE_IMPACTS_LIMITED)
        add_text(c, "ground.law", v->impacts == STANCE_IMPACTS_NEWTON ? "newton" : "moreau");
    if (v->prefer)
        add_text(c, "ground.prefer", "most-energy");
    if (v->lands)
        add_text(c, "ground.lands", "ahead");
    add_contacts(c, "ground.contacts", v->contacts);
    add_initial(c, v);
    add_controller(c, v);
    int count = 0;
    while (methods[count])
        count++;
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
        add_number(c, "stop.settle.place", scene->postures ? v->settle_place : NAN, "m");
    }
    add_number(c, "stop.fall_height", scene->fallen && !scene->mechanism ? v->fall_height : NAN,
               "");
}

void summary_collect_fields(struct summary *summary, const struct results *r,
                            const struct scenario *s)
{
    struct schema *schema = malloc(sizeof *schema);
    struct scenario_values values = s->base;
    if (r->single && s->axes > 0 && r->index < s->cases)
        scenario_case_values(s, r->index, &values);
    if (schema && schema_build(schema, s->scene)) {
        struct collection collection = {summary, r, s, schema};
        add_fields(&collection, &values);
    }
    free(schema);
}
