/* schema_laws.c - the rows of the scenario format that the laws bring. */
#include "schema_laws.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Names of the selections of coordinates, in stance_selection's order. */
static size_t name_selections(struct schema *schema)
{
    size_t count = 0;
    while (count < STANCE_MAX_SELECTIONS &&
           scenario_selection_name(schema->scene, (int)count, schema->selection[count])) {
        schema->selections[count] = schema->selection[count];
        count++;
    }
    return count;
}

/* Writes a text in which %s may stand for another. */
static void fill_in(char *text, size_t size, const char *format, const char *other)
{
    const char *place = strstr(format, "%s");
    if (place)
        snprintf(text, size, "%.*s%.120s%s", (int)(place - format), format, other, place + 2);
    else
        snprintf(text, size, "%s", format);
}

/* The row of a law's parameter: of all of it, or (coordinate not NULL) of its number `place`. */
static bool add_number(struct schema *schema, const struct scenario_field *row, int law,
                       int parameter, const stance_quantity *coordinate, int place)
{
    const stance_parameter *const p = &stance_laws()[law]->parameter[parameter];
    const bool list = p->per == STANCE_PER_TERM;
    const bool one = p->per == STANCE_PER_LAW || p->per == STANCE_PER_SELECTION || list;
    char name[64];
    snprintf(name, sizeof name, "%s%s%s", p->of.name, coordinate ? "." : "",
             coordinate ? coordinate->name : "");
    struct scenario_field *const field = schema_add(schema, row, "", name);
    if (!field)
        return false;
    field->law = law;
    field->by_scene = p->per != STANCE_PER_LAW || p->output > 0;
    if (!one && !coordinate) { /* the mapping of all its numbers */
        field->type = FIELD_MAP;
        field->sweep = false;
        field->offset = NO_OFFSET;
        snprintf(field->text, sizeof field->text, "%s", p->all);
        return true;
    }
    const bool its = p->of.unit[0] == '\0' && coordinate; /* unit and range are the coordinate's */
    field->required = p->required;
    field->offset =
        offsetof(struct scenario_values, law_value) +
        (size_t)((stance_law_first(stance_laws()[law]) + parameter) * STANCE_LAW_ROOM + place) *
            sizeof(double);
    fill_in(field->unit, sizeof field->unit, its ? "%s" : p->of.unit,
            coordinate ? coordinate->unit : "");
    fill_in(field->text, sizeof field->text, p->of.text, coordinate ? coordinate->text : "");
    field->low = its ? coordinate->low : p->of.low;
    field->high = its ? coordinate->high : p->of.high;
    field->low_open = p->positive;
    field->fallback = p->of.fallback;
    field->fallback_text = p->unlimited ? "none" : p->fallback_text;
    field->more = p->more;
    field->quiet = !p->told;
    if (p->unlimited) {
        field->words = schema_none;
        field->word_count = 1;
    }
    if (list) {
        field->items = STANCE_MAX_COEFFICIENTS;
        field->fewer = true;
        struct scenario_field *const item = schema_add(schema, row, name, "[]");
        if (!item)
            return false;
        struct scenario_field whole = *field;
        snprintf(whole.path, sizeof whole.path, "%s", item->path);
        *item = whole; /* its numbers; the list: */
        field->type = FIELD_NUMBERS;
        field->sweep = false;
        field->offset = NO_OFFSET;
        snprintf(field->text, sizeof field->text, "%s", p->all);
    }
    if (p->per == STANCE_PER_SELECTION) {
        field->type = FIELD_WORD;
        field->words = schema->selections;
        field->word_count = name_selections(schema);
    }
    if (p->per == STANCE_PER_SELECTION &&
        field->word_count == 0) { /* the law is refused, or of any */
        field->type = FIELD_TEXT;
        field->words = NULL;
        field->sweep = false;
        field->offset = NO_OFFSET;
    }
    return true;
}

/* As many outputs as actuators; of any mechanism as many as may be. */
static int outputs_of(const struct schema *schema)
{
    return !schema->scene ? 0 : schema->pattern ? STANCE_MAX_ACTUATORS : schema->scene->actuators;
}

/* The rows of the mappings that hold a law's parameters. */
static bool add_groups(struct schema *schema, const struct scenario_field *row, int law)
{
    const stance_law *const of = stance_laws()[law];
    const int outputs = outputs_of(schema);
    for (int g = 0; of->group && of->group[g][0]; g++) {
        const char *const name = of->group[g][0], *const star = strchr(name, '*');
        for (int i = 1; i <= (star ? outputs : 1); i++) {
            char path[64];
            snprintf(path, sizeof path, star ? "%.*sy%d" : "%.*s",
                     star ? (int)(star - name) : (int)strlen(name), name, i);
            struct scenario_field *const field = schema_add(schema, row, "", path);
            if (!field)
                return false;
            field->law = law;
            field->by_scene = true;
            field->type = FIELD_MAP;
            field->sweep = false;
            field->offset = NO_OFFSET;
            snprintf(field->text, sizeof field->text, "%s", of->group[g][1]);
        }
    }
    return true;
}

static bool add_parameter(struct schema *schema, const struct scenario_field *row, int law,
                          int parameter)
{
    const stance_scene *const scene = schema->scene;
    const stance_per per = stance_laws()[law]->parameter[parameter].per;
    const int output = stance_laws()[law]->parameter[parameter].output;
    if (output > outputs_of(schema))
        return true;
    const int count = !scene                         ? 0
                      : per == STANCE_PER_ACTUATOR   ? scene->actuators
                      : per == STANCE_PER_POSTURE    ? scene->postures
                      : per == STANCE_PER_COORDINATE ? scene->coordinates
                                                     : 0;
    if (per == STANCE_PER_SELECTION && !scene) {
        struct scenario_field known = *row; /* the key is known all the same */
        known.by_scene = true;
        return schema_add(schema, &known, "", stance_laws()[law]->parameter[parameter].of.name);
    }
    bool good = add_number(schema, row, law, parameter, NULL, 0);
    for (int i = 0; good && i < count; i++) {
        const int k = per == STANCE_PER_ACTUATOR  ? scene->actuated[i]
                      : per == STANCE_PER_POSTURE ? scene->posture[i]
                                                  : i;
        good = add_number(schema, row, law, parameter, &scene->coordinate[k], i);
    }
    return good;
}

bool schema_add_laws(struct schema *schema, const struct scenario_field *row)
{
    for (int law = 0; stance_laws()[law]; law++) {
        if (!add_groups(schema, row, law))
            return false;
        for (int p = 0; p < stance_laws()[law]->parameters; p++)
            if (!add_parameter(schema, row, law, p))
                return false;
    }
    return true;
}

const char *schema_describe_laws(struct schema *schema)
{
    size_t used = 0;
    schema->kinds[0] = '\0';
    for (const stance_law *const *law = stance_laws(); *law && used < sizeof schema->kinds; law++)
        if ((*law)->text)
            used += (size_t)snprintf(schema->kinds + used, sizeof schema->kinds - used, "%s%s: %s.",
                                     used ? " " : "", (*law)->name, (*law)->text);
    return schema->kinds;
}
