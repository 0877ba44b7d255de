/* schema.c - the scenario format: how a scene's names fill its table. */
#include "schema.h"
#include "schema_laws.h"
#include "schema_mechanism.h"
#include "schema_rows.h"
#include "tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- writing the table out for a scene ------------------------------------------------------- */

struct scenario_field *schema_add(struct schema *schema, const struct scenario_field *row,
                                  const char *prefix, const char *name)
{
    if (schema->count == SCHEMA_MAX_FIELDS)
        return NULL;
    struct scenario_field *field = &schema->field[schema->count++];
    *field = *row;
    const char *star = strchr(row->path, '*');
    if (star) {
        int n = snprintf(field->path, sizeof field->path, "%.*s%s%s", (int)(star - row->path),
                         row->path, prefix, name);
        if (n < 0 || (size_t)n >= sizeof field->path)
            return NULL;
    }
    return field;
}

/* Unit, range and text of a quantity of the scene. */
static void describe_quantity(struct scenario_field *field, const struct row *row,
                              const stance_quantity *quantity, const char *rate)
{
    char text[sizeof field->text];
    const char *format = row->field.text;
    const char *place = strstr(format, "%s");

    snprintf(field->unit, sizeof field->unit, "%s%s", quantity->unit, rate[0] ? "/s" : "");
    snprintf(text, sizeof text, "%s%s", rate, quantity->text);
    if (place) {
        snprintf(field->text, sizeof field->text, "%.*s%.120s", (int)(place - format), format,
                 text);
    } else {
        snprintf(field->text, sizeof field->text, "%s", text);
    }
    field->low = quantity->low;
    field->high = quantity->high;
}

static bool add_robot(struct schema *schema, const struct row *row)
{
    const stance_carried *const carried = schema->scene ? schema->scene->mechanism->carried : NULL;
    if (!schema->scene)
        return true;
    for (int i = 0; carried && i < carried->parameters; i++) {
        const stance_quantity *quantity = &schema->scene->robot[i];
        struct scenario_field *field = schema_add(schema, &row->field, "", quantity->name);
        if (!field)
            return false;
        describe_quantity(field, row, quantity, "");
        field->offset += (size_t)i * sizeof(double);
        field->fallback = field->fallback_text ? NAN : quantity->fallback;
    }
    return schema_add_mechanism(schema, &row->field);
}

static bool add_states(struct schema *schema, const struct row *row)
{
    if (!schema->scene)
        return true;
    const int n = schema->scene->coordinates;
    for (int i = 0; i < 2 * n; i++) {
        const stance_quantity *quantity = &schema->scene->coordinate[i % n];
        const bool rate = i >= n;
        struct scenario_field *field =
            schema_add(schema, &row->field, rate ? "v" : "", quantity->name);
        if (!field)
            return false;
        describe_quantity(field, row, quantity, rate ? "rate of " : "");
        field->offset += (size_t)i * sizeof(double);
        if (rate) {
            field->low = -1e6;
            field->high = 1e6;
        } else if (row->family == FAMILY_STATE) {
            field->fallback = quantity->fallback;
        } else if (row->family == FAMILY_OFFSET) {
            field->low = quantity->low - quantity->high;
            field->high = quantity->high - quantity->low;
        }
    }
    return true;
}

static bool add_postures(struct schema *schema, const struct row *row)
{
    if (!schema->scene)
        return true;
    const stance_scene *scene = schema->scene;
    for (int i = 0; i < scene->postures; i++) {
        const stance_quantity *quantity = &scene->coordinate[scene->posture[i]];
        struct scenario_field *field = schema_add(schema, &row->field, "", quantity->name);
        if (!field)
            return false;
        describe_quantity(field, row, quantity, "");
        field->offset += (size_t)i * sizeof(double);
        field->fallback = NAN;
    }
    return true;
}

/* A weight, a pole or a gain by the name of what it is of; `unit` where the row has none. */
static bool add_item(struct schema *schema, const struct row *row, const char *prefix,
                     const char *name, size_t place, const char *unit, const char *text)
{
    char path[sizeof row->field.path];
    const size_t stem = strcspn(row->field.path, "*");
    snprintf(path, sizeof path, "%.*s%s%s", (int)stem, row->field.path, prefix, name);
    if (schema_find(schema, path)) /* a coordinate that is called `states`: in the list alone */
        return true;
    struct scenario_field *const field = schema_add(schema, &row->field, prefix, name);
    if (!field)
        return false;
    field->offset += place * sizeof(double);
    if (!row->field.unit[0])
        snprintf(field->unit, sizeof field->unit, "%s", unit);
    const char *const format = row->field.text, *const at = strstr(format, "%s");
    snprintf(field->text, sizeof field->text, "%.*s%.120s", (int)(at - format), format, text);
    return true;
}

/* The unit of what is so much `of` (N m) per unit of a state. */
static void unit_per(char unit[24], const char *of, const char *state, bool rate)
{
    snprintf(unit, 24, rate ? "%.8s s/%.8s" : "%.8s/%.8s", of, state);
}

static bool add_named(struct schema *schema, const struct row *row)
{
    const stance_scene *const scene = schema->scene;
    const int states = 2 * scene->postures;
    char name[SCENARIO_NAME], text[160], unit[24];
    for (int i = 0; i < scene->actuators && row->family == FAMILY_INPUTS; i++) {
        const char *const of = scene->coordinate[scene->actuated[i]].unit;
        snprintf(unit, sizeof unit, "1/%s", strcmp(of, "m") == 0 ? "N^2" : "(N m)^2");
        snprintf(text, sizeof text, "the torque of %.100s", scene->actuator_name[i]);
        if (!add_item(schema, row, "", scene->actuator_name[i], (size_t)i, unit, text))
            return false;
    }
    for (int i = 0; i < (row->family == FAMILY_GAINS ? scene->actuators : 1); i++) {
        char actuator[STANCE_NAME + 8] = "";
        if (row->family == FAMILY_INPUTS)
            break;
        if (row->family == FAMILY_GAINS) {
            struct scenario_field *const map =
                schema_add(schema, &row->field, "", scene->actuator_name[i]);
            if (!map)
                return false;
            map->type = FIELD_MAP;
            map->sweep = false;
            map->offset = NO_OFFSET;
            snprintf(map->text, sizeof map->text, "gains of %.100s", scene->actuator_name[i]);
            snprintf(actuator, sizeof actuator, "%s.", scene->actuator_name[i]);
        }
        for (int j = 0; j < states; j++) {
            const stance_quantity *const q =
                &scene->coordinate[scene->posture[j % scene->postures]];
            const bool rate = j >= scene->postures;
            const bool slides = row->family == FAMILY_GAINS &&
                                strcmp(scene->coordinate[scene->actuated[i]].unit, "m") == 0;
            if (row->family == FAMILY_GAINS)
                unit_per(unit, slides ? "N" : "N m", q->unit, rate);
            else
                snprintf(unit, sizeof unit, rate ? "s^2/%.8s^2" : "1/%.8s^2", q->unit);
            snprintf(text, sizeof text, "%s%.100s", rate ? "rate of " : "", q->text);
            if (!add_item(schema, row, actuator, scenario_state_name(scene, j, name),
                          (size_t)i * (size_t)states + (size_t)j, unit, text))
                return false;
        }
    }
    return true;
}

/* Which methods read method.tolerance, and what it is by default there. */
static const char *describe_tolerance(char *text, size_t size)
{
    size_t used = 0, count = 0;
    for (const stance_method *const *method = stance_methods(); *method && used < size; method++) {
        if ((*method)->tolerance > 0) {
            used += (size_t)snprintf(text + used, size - used, "%s%s (default %.3g)",
                                     count++ ? ", "
                                             : "Read by the methods that control their "
                                               "error: ",
                                     (*method)->name, (*method)->tolerance);
        }
    }
    if (used < size) {
        snprintf(text + used, size - used,
                 count ? ". It has no effect with the others."
                       : "No method of this build reads it.");
    }
    return text;
}

/* Rows that stay one field, whose words or sizes are the scene's. */
static bool add_single(struct schema *schema, const struct row *row)
{
    const stance_scene *scene = schema->scene;
    /* Of any mechanism they are not known. */
    const size_t postures = scene && !schema->pattern ? (size_t)scene->postures : 0;
    const size_t actuators = scene && !schema->pattern ? (size_t)scene->actuators : 0;
    struct scenario_field *field = schema_add(schema, &row->field, "", "");
    if (!field)
        return false;
    if (row->family == FAMILY_SCENES) {
        field->words = schema->scenes;
        field->word_count = schema->scene_count;
    } else if (row->family == FAMILY_METHODS) {
        field->words = schema->methods;
        field->word_count = schema->method_count;
        for (size_t i = 0; i < schema->method_count; i++)
            if (strcmp(schema->methods[i], "capturing") == 0)
                field->fallback = (double)i; /* what the charts of scenarios/accuracy recommend */
    } else if (row->family == FAMILY_KINDS) {
        field->words = schema->laws;
        field->word_count = schema->law_count;
        field->more = schema_describe_laws(schema);
    } else if (row->family == FAMILY_FAR) {
        field->words = schema->far_laws;
        field->word_count = schema->far_law_count;
    } else if (row->family == FAMILY_TOLERANCE) {
        field->more = describe_tolerance(schema->tolerance, sizeof schema->tolerance);
    } else if (!scene) {
        return true; /* what follows is the scene's */
    } else if (row->family == FAMILY_CONTACTS) {
        const stance_mechanism *const m = scene->mechanism;
        for (int i = 0; i < m->elements; i++)
            schema->elements[i] = m->element[i].name;
        field->words = schema->elements;
        field->word_count = (size_t)m->elements;
    } else if (row->family == FAMILY_FOOT) {
        field->low = 1;
        field->high = scene->contacts;
        field->fallback = NAN;
    } else if (row->family == FAMILY_BRANCH && !scenario_numbers_feet(scene)) {
        field->type = FIELD_INTEGER;
        field->words = NULL;
        field->word_count = 0;
        field->high = 1000;
        snprintf(field->text, sizeof field->text,
                 "which of several solutions, those with the centre of mass higher up first");
    } else if (row->family == FAMILY_POLES) {
        field->items = 2 * postures;
        field->fewer = !scenario_numbers_feet(scene) && field->type == FIELD_POLES;
    } else if (row->family == FAMILY_ACTUATORS) {
        field->items = actuators;
    } else if (row->family == FAMILY_MATRIX) {
        field->items = actuators;
        field->columns = 2 * postures;
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

static bool add_row(struct schema *schema, const struct row *row)
{
    if (schema->scene && !scene_has(schema->scene, row->field.path))
        return true;
    if (row->field.by_scene && !schema->scene) {
        /* The key is known all the same; what stands below it is not looked at. */
        return strpbrk(row->field.path, "*[") || schema_add(schema, &row->field, "", "") != NULL;
    }
    switch (row->family) {
    case FAMILY_ROBOT:
        return add_robot(schema, row);
    case FAMILY_PLATES:
        return schema_add_plates(schema, &row->field);
    case FAMILY_STATE:
    case FAMILY_OFFSET:
        return add_states(schema, row);
    case FAMILY_PARAMETERS:
        return schema_add_laws(schema, &row->field);
    case FAMILY_POSTURE:
        return add_postures(schema, row);
    case FAMILY_STATES:
    case FAMILY_INPUTS:
    case FAMILY_GAINS:
        return !schema->scene || add_named(schema, row);
    default:
        return add_single(schema, row);
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
        if (!add_row(schema, &schema_rows[i]) ||
            (law && strcmp(schema_rows[i].field.path, "controller.data") == 0 &&
             !law_file_rows(schema, law)))
            return false;
    return true;
}
