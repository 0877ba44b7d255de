/* schema.c - the scenario format: how a scene's names fill its table. */
#include "schema.h"
#include "schema_laws.h"
#include "schema_mechanism.h"
#include "schema_rows.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* ---- writing the table out for a scene ------------------------------------------------------- */

struct scenario_field *schema_add(struct schema *schema, const struct scenario_field *row,
                                  const char *name, ...)
{
    if (schema->count == SCHEMA_MAX_FIELDS)
        return NULL;
    struct scenario_field *field = &schema->field[schema->count++];
    const size_t stem = strcspn(row->path, "*"), room = sizeof field->path - stem;
    *field = *row;
    if (!row->path[stem])
        return field;
    va_list arguments;
    va_start(arguments, name);
    const int length = vsnprintf(field->path + stem, room, name, arguments);
    va_end(arguments);
    return length >= 0 && (size_t)length < room ? field : NULL;
}

bool schema_group(struct scenario_field *field, enum field_type type, const char *text, ...)
{
    if (!field)
        return false;
    va_list arguments;
    va_start(arguments, text);
    vsnprintf(field->text, sizeof field->text, text, arguments);
    va_end(arguments);
    field->type = type;
    field->sweep = field->design = false;
    field->offset = NO_OFFSET;
    return true;
}

void schema_fill(char *text, size_t size, const char *format, const char *other)
{
    const char *const place = strstr(format, "%s");
    const int before = place ? (int)(place - format) : (int)strlen(format);
    snprintf(text, size, "%.*s%.120s%s", before, format, place ? other : "",
             place ? place + 2 : "");
}

/* A row for each of some quantities: parameters of the body, coordinates and rates, angles. */
static bool add_quantities(struct schema *schema, const struct row *row)
{
    const stance_scene *const scene = schema->scene;
    if (!scene)
        return false; /* never: such rows are by_scene */
    const stance_carried *const carried = scene->mechanism->carried;
    const bool robot = row->family == FAMILY_ROBOT, posture = row->family == FAMILY_POSTURE,
               offset = row->family == FAMILY_OFFSET;
    const int n = scene->coordinates, parameters = carried ? carried->parameters : 0,
              count = robot     ? parameters
                      : posture ? scene->postures
                                : 2 * n;
    for (int i = 0; i < count; i++) {
        const stance_quantity *const q = robot     ? &scene->robot[i]
                                         : posture ? &scene->coordinate[scene->posture[i]]
                                                   : &scene->coordinate[i % n];
        const bool rate = !robot && !posture && i >= n;
        struct scenario_field *const field =
            schema_add(schema, &row->field, "%s%s", rate ? "v" : "", q->name);
        char text[sizeof field->text];
        if (!field)
            return false;
        snprintf(field->unit, sizeof field->unit, "%s%s", q->unit, rate ? "/s" : "");
        snprintf(text, sizeof text, "%s%s", rate ? "rate of " : "", q->text);
        schema_fill(field->text, sizeof field->text, row->field.text, text);
        field->offset += (size_t)i * sizeof(double);
        field->low = rate ? -1e6 : offset ? q->low - q->high : q->low;
        field->high = rate ? 1e6 : offset ? q->high - q->low : q->high;
        if (!rate && !offset && !isnan(row->field.fallback))
            field->fallback = q->fallback;
    }
    return !robot || schema_add_mechanism(schema, &row->field);
}

/* Weights, poles and gains, by the names of what they are of. */
static bool add_named(struct schema *schema, const struct row *row)
{
    const stance_scene *const scene = schema->scene;
    if (!scene)
        return false; /* never: such rows are by_scene */
    const bool gains = row->family == FAMILY_GAINS, inputs = row->family == FAMILY_INPUTS;
    const int p = scene->postures, columns = inputs ? 1 : 2 * p,
              rows = gains || inputs ? scene->actuators : 1;
    for (int k = 0; k < rows * columns; k++) {
        const int i = k / columns, j = k % columns;
        const stance_quantity *const q = &scene->coordinate[inputs ? 0 : scene->posture[j % p]];
        const char *const actuator = gains || inputs ? scene->actuator_name[i] : "";
        const bool rate = j >= p,
                   slides = (gains || inputs) &&
                            strcmp(scene->coordinate[scene->actuated[i]].unit, "m") == 0;
        char name[SCENARIO_NAME], text[160], unit[24];
        if (inputs) {
            snprintf(unit, sizeof unit, slides ? "1/N^2" : "1/(N m)^2");
            snprintf(text, sizeof text, "the torque of %.100s", actuator);
        } else {
            scenario_state_name(scene, j, name);
            snprintf(text, sizeof text, "%s%.100s", rate ? "rate of " : "", q->text);
            snprintf(unit, sizeof unit, rate ? "s^2/%.8s^2" : "1/%.8s^2", q->unit);
        }
        if (gains) {
            snprintf(unit, sizeof unit, rate ? "%.8s s/%.8s" : "%.8s/%.8s", slides ? "N" : "N m",
                     q->unit);
            if (j == 0 && !schema_group(schema_add(schema, &row->field, "%s", actuator), FIELD_MAP,
                                        "gains of %.100s", actuator))
                return false;
        }
        struct scenario_field *const field = schema_add(schema, &row->field, "%s%s%s", actuator,
                                                        gains ? "." : "", inputs ? "" : name);
        if (!field)
            return false;
        if (schema_find(schema, field->path) != field) { /* a coordinate that is called `states`: */
            schema->count--;                             /* in the list alone */
            continue;
        }
        field->offset += (size_t)k * sizeof(double);
        if (!row->field.unit[0])
            memcpy(field->unit, unit, sizeof unit);
        schema_fill(field->text, sizeof field->text, row->field.text, text);
    }
    return true;
}

/* Which methods read method.tolerance, and what it is by default there. */
static const char *describe_tolerance(char *text, size_t size)
{
    text[0] = '\0';
    for (const stance_method *const *method = stance_methods(); *method; method++)
        if ((*method)->tolerance > 0)
            add_text(text, size, "%s%s (default %.3g)",
                     text[0] ? ", " : "Read by the methods that control their error: ",
                     (*method)->name, (*method)->tolerance);
    add_text(text, size, "%s",
             text[0] ? ". It has no effect with the others." : "No method of this build reads it.");
    return text;
}

static void set_words(struct scenario_field *field, const char *const *words, size_t count)
{
    field->words = words;
    field->word_count = count;
}

/* Rows that stay one field, whose words or sizes are the scene's. */
static bool add_single(struct schema *schema, const struct row *row)
{
    const stance_scene *scene = schema->scene;
    const stance_mechanism *const m = scene ? scene->mechanism : NULL;
    /* Of any mechanism they are not known. */
    const size_t postures = scene && !schema->pattern ? (size_t)scene->postures : 0;
    const size_t actuators = scene && !schema->pattern ? (size_t)scene->actuators : 0;
    struct scenario_field *field = schema_add(schema, &row->field, NULL);
    if (!field)
        return false;
    switch (row->family) {
    case FAMILY_SCENES:
        set_words(field, schema->scenes, schema->scene_count);
        break;
    case FAMILY_METHODS:
        set_words(field, schema->methods, schema->method_count);
        for (size_t i = 0; i < schema->method_count; i++)
            if (strcmp(schema->methods[i], "capturing") == 0)
                field->fallback = (double)i; /* what the charts of scenarios/accuracy recommend */
        break;
    case FAMILY_KINDS:
        set_words(field, schema->laws, schema->law_count);
        field->more = schema_describe_laws(schema);
        break;
    case FAMILY_FAR:
        set_words(field, schema->far_laws, schema->far_law_count);
        break;
    case FAMILY_TOLERANCE:
        field->more = describe_tolerance(schema->tolerance, sizeof schema->tolerance);
        break;
    case FAMILY_CONTACTS:
        for (int i = 0; m && i < m->elements; i++)
            schema->elements[i] = m->element[i].name;
        set_words(field, m ? schema->elements : NULL, m ? (size_t)m->elements : 0);
        break;
    case FAMILY_FOOT:
        field->low = 1;
        field->high = scene ? scene->contacts : 0;
        break;
    case FAMILY_BRANCH:
        if (!scene || scenario_numbers_feet(scene))
            break;
        field->type = FIELD_INTEGER;
        set_words(field, NULL, 0);
        field->high = 1000;
        snprintf(field->text, sizeof field->text,
                 "which of several solutions, those with the centre of mass higher up first");
        break;
    case FAMILY_POLES:
        field->items = 2 * postures;
        field->fewer = scene && !scenario_numbers_feet(scene) && field->type == FIELD_POLES;
        break;
    case FAMILY_MATRIX:
        field->columns = 2 * postures; /* fall through */
    case FAMILY_ACTUATORS:
        field->items = actuators;
        break;
    default:
        break;
    }
    return true;
}

/* Whether a scene has what the rows of a path are about: a controller where something acts. */
static bool scene_has(const stance_scene *scene, const char *path)
{
    const bool acts = scene->actuators > 0, touches = scene->mechanism->elements > 0;
    const bool numbered = scenario_numbers_feet(scene);
    /* On rails that nothing else moves, nothing can stand. */
    const bool stands =
        !(scene->mechanism->carried && scene->mechanism->body[0].joint == STANCE_SLIDE);
    const bool along = scene->mechanism->carried && scene->mechanism->carried->along_slope;
    const struct {
        const char *begins;
        bool has;
    } needs[] = {
        {"controller.kind", true},
        {"controller.", acts},
        {"optimise", acts},
        {"ground.contacts", touches},
        {"initial.equilibrium", stands},
        {"initial.offset", stands},
        {"initial.support_foot", numbered},
        {"initial.support", touches && stands && !numbered},
        {"ground.slope", !along},
        {"robot.slope", along},
        {"stop.fall_height", numbered},
    };
    for (size_t i = 0; i < sizeof needs / sizeof needs[0]; i++)
        if (strncmp(path, needs[i].begins, strlen(needs[i].begins)) == 0)
            return needs[i].has;
    return true;
}

/* A row as it stands, with what it has from the mapping that it stands in. */
static bool add_row(struct schema *schema, struct row row)
{
    struct scenario_field *const field = &row.field;
    if (schema->scene && !scene_has(schema->scene, field->path))
        return true;
    const struct scenario_field *const in = schema_parent(schema, field);
    if (in) {
        field->by_scene |= in->by_scene;
        field->use = field->use ? field->use : in->use;
    }
    if (field->by_scene && !schema->scene) {
        /* The key is known all the same; what stands below it is not looked at. */
        return strpbrk(field->path, "*[") || schema_add(schema, field, NULL) != NULL;
    }
    switch (row.family) {
    case FAMILY_ROBOT:
    case FAMILY_STATE:
    case FAMILY_OFFSET:
    case FAMILY_POSTURE:
        return add_quantities(schema, &row);
    case FAMILY_PLATES:
        return schema_add_plates(schema, field);
    case FAMILY_PARAMETERS:
        return schema_add_laws(schema, field);
    case FAMILY_STATES:
    case FAMILY_INPUTS:
    case FAMILY_GAINS:
        return add_named(schema, &row);
    default:
        return add_single(schema, &row);
    }
}

bool schema_build(struct schema *schema, const stance_scene *scene, const struct law_file *law,
                  bool documents)
{
    memset(schema, 0, offsetof(struct schema, field));
    schema->documents = documents;
    schema->scene = scene;
    schema->pattern = scene && scene->mechanism->numbers == 0;
    for (size_t i = 0; i < SCHEMA_MAX_WORDS - 1 && stance_scenes()[i]; i++)
        schema->scenes[schema->scene_count++] = stance_scenes()[i]->name;
    schema->scenes[schema->scene_count++] = MECHANISM_WORD;
    for (size_t i = 0; i < SCHEMA_MAX_WORDS && stance_methods()[i]; i++)
        schema->methods[schema->method_count++] = stance_methods()[i]->name;
    for (const stance_law *const *is = stance_laws(); *is; is++) {
        schema->laws[schema->law_count++] = (*is)->name;
        if ((*is)->acts_far)
            schema->far_laws[schema->far_law_count++] = (*is)->name;
    }
    for (size_t i = 0; i < schema_row_count; i++)
        if (!add_row(schema, schema_rows[i]) ||
            (law && strcmp(schema_rows[i].field.path, "controller.data") == 0 &&
             !law_file_rows(schema, law)))
            return false;
    return true;
}
