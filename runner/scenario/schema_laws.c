/* schema_laws.c - the rows of the scenario format that the laws bring. */
#include "schema_laws.h"

#include "runner/base/message.h"

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

/* The row of a law's parameter: of all of it, or (coordinate not NULL) of its number `place`. */
static bool add_number(struct schema *schema, const struct scenario_field *row, int law,
                       int parameter, const stance_quantity *coordinate, int place)
{
    const stance_parameter *const p = &stance_laws()[law]->parameter[parameter];
    const bool list = p->per == STANCE_PER_TERM, chosen = p->per == STANCE_PER_SELECTION;
    struct scenario_field own = *row;
    own.law = law;
    own.by_scene = p->per != STANCE_PER_LAW || p->output > 0;
    if (p->per != STANCE_PER_LAW && !chosen && !list && !coordinate)
        return schema_group(schema_add(schema, &own, "%s", p->of.name), FIELD_MAP, "%s", p->all);
    const bool its = p->of.unit[0] == '\0' && coordinate; /* unit and range are the coordinate's */
    own.required = p->required;
    own.offset =
        offsetof(struct scenario_values, law_value) +
        (size_t)((stance_law_first(stance_laws()[law]) + parameter) * STANCE_LAW_ROOM + place) *
            sizeof(double);
    schema_fill(own.unit, sizeof own.unit, its ? "%s" : p->of.unit,
                coordinate ? coordinate->unit : "");
    schema_fill(own.text, sizeof own.text, p->of.text, coordinate ? coordinate->text : "");
    own.low = its ? coordinate->low : p->of.low;
    own.high = its ? coordinate->high : p->of.high;
    own.low_open = p->positive;
    own.fallback = p->of.fallback;
    own.fallback_text = p->unlimited ? "none" : p->fallback_text;
    own.more = p->more;
    own.quiet = !p->told;
    own.words = p->unlimited ? schema_none : NULL;
    own.word_count = p->unlimited;
    if (list) {
        own.items = STANCE_MAX_COEFFICIENTS;
        own.fewer = true;
        return schema_group(schema_add(schema, &own, "%s", p->of.name), FIELD_NUMBERS, "%s",
                            p->all) &&
               schema_add(schema, &own, "%s[]", p->of.name);
    }
    if (chosen) {
        own.type = FIELD_WORD;
        own.words = schema->selections;
        own.word_count = name_selections(schema);
    }
    if (chosen && own.word_count == 0) { /* the law is refused, or of any */
        own.type = FIELD_TEXT;
        own.words = NULL;
        own.sweep = false;
        own.offset = NO_OFFSET;
    }
    return schema_add(schema, &own, "%s%s%s", p->of.name, coordinate ? "." : "",
                      coordinate ? coordinate->name : "");
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
    struct scenario_field own = *row;
    own.law = law;
    own.by_scene = true;
    for (int g = 0; of->group && of->group[g][0]; g++) {
        const char *const name = of->group[g][0];
        const int stem = (int)strcspn(name, "*"), count = name[stem] ? outputs_of(schema) : 1;
        char number[16] = "";
        for (int i = 1; i <= count; i++) {
            if (name[stem])
                snprintf(number, sizeof number, "y%d", i);
            if (!schema_group(schema_add(schema, &own, "%.*s%s", stem, name, number), FIELD_MAP,
                              "%s", of->group[g][1]))
                return false;
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
        return schema_add(schema, &known, "%s", stance_laws()[law]->parameter[parameter].of.name);
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
    schema->kinds[0] = '\0';
    for (const stance_law *const *law = stance_laws(); *law; law++)
        if ((*law)->text)
            add_text(schema->kinds, sizeof schema->kinds, "%s%s: %s.", schema->kinds[0] ? " " : "",
                     (*law)->name, (*law)->text);
    return schema->kinds;
}
