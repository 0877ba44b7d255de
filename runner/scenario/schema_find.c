/* schema_find.c - looks up rows of the scenario format. */
#include "schema.h"
#include "tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct schema_use schema_uses[] = {
    [USE_CONTROL] = {"with a controller.kind other than none", "controller.kind", USE_ALWAYS},
    [USE_LAW] = {NULL, "controller.kind", USE_ALWAYS},
    [USE_FEEDBACK] = {"with controller.kind state-feedback", "controller.kind", USE_ALWAYS},
    [USE_PROGRAM] = {"with controller.kind program, or controller.far program", "controller.kind",
                     USE_CONTROL},
    [USE_FAR] = {"with a controller.far other than none", "controller.far", USE_FEEDBACK},
    [USE_PLACE] = {"with controller.design place or place-schur", "controller.design",
                   USE_FEEDBACK},
    [USE_LQR] = {"with controller.design lqr", "controller.design", USE_FEEDBACK},
    [USE_MODEL] = {"with a controller.design other than gains", "controller.design", USE_FEEDBACK},
    [USE_GAINS] = {"with controller.design gains", "controller.design", USE_FEEDBACK},
    [USE_EQUILIBRIUM] = {"with initial.equilibrium", "initial.state", USE_ALWAYS},
    [USE_STATE] = {"with initial.state", "initial.equilibrium", USE_ALWAYS},
    [USE_WALKS] = {"with stop.walks.steps above 0", "stop.walks.steps", USE_ALWAYS},
    [USE_SETTLE] = {"with a stop.settle other than off", "stop.settle", USE_ALWAYS},
    [USE_SALTELLI] = {"with method saltelli", "sweep.sample.method", USE_ALWAYS},
    [USE_MORRIS] = {"with method morris", "sweep.sample.method", USE_ALWAYS},
    [USE_SHARES] = {"with an optimise.maximise other than nearest", "optimise.maximise",
                    USE_ALWAYS},
    [USE_UNSOUGHT] = {"without optimise", "optimise", USE_ALWAYS},
};

bool schema_allows(enum field_use use, int law, const struct scenario_values *v)
{
    const stance_law *const own = stance_laws()[law], *const is = scenario_law(v);
    const bool allows[] = {
        [USE_ALWAYS] = true,
        [USE_CONTROL] = v->law != 0,
        [USE_LAW] = is == own || scenario_far(v) == own,
        [USE_FEEDBACK] = is->designed,
        [USE_PROGRAM] = is->program || scenario_far(v)->program,
        [USE_FAR] = scenario_far(v)->set != NULL,
        [USE_PLACE] = v->design == DESIGN_PLACE || v->design == DESIGN_PLACE_SCHUR,
        [USE_LQR] = v->design == DESIGN_LQR,
        [USE_MODEL] = v->design != DESIGN_GAINS,
        [USE_GAINS] = v->design == DESIGN_GAINS,
        [USE_EQUILIBRIUM] = !v->state_given,
        [USE_STATE] = v->state_given,
        [USE_WALKS] = v->walk_steps > 0,
        [USE_SETTLE] = v->settle,
    };
    const enum field_use within = schema_uses[use].within;
    return use > USE_SETTLE || (allows[use] && (!within || schema_allows(within, law, v)));
}

size_t schema_items(const struct scenario_field *field)
{
    return (field->items ? field->items : 1) * (field->columns ? field->columns : 1);
}

double schema_number(const struct scenario_field *field, const struct scenario_values *values,
                     size_t item)
{
    const char *const place = (const char *)values + field->offset;
    double number;
    int whole;
    if (field->type == FIELD_NUMBER) {
        memcpy(&number, place + item * sizeof number, sizeof number);
        return number;
    }
    memcpy(&whole, place, sizeof whole);
    return whole;
}

const char *schema_item_path(const struct scenario_field *field, size_t item, char path[128])
{
    const int length = (int)strcspn(field->path, "[");
    const size_t columns = field->columns;
    if (!field->path[length])
        snprintf(path, 128, "%s", field->path);
    else if (columns)
        snprintf(path, 128, "%.*s[%zu][%zu]", length, field->path, item / columns, item % columns);
    else
        snprintf(path, 128, "%.*s[%zu]%s", length, field->path, item, field->path + length + 2);
    return path;
}

bool schema_samples(const struct scenario_field *field, const struct scenario_values *values)
{
    if (field->offset == offsetof(struct scenario_values, law))
        return scenario_law(values)->samples;
    return field->samples && !(schema_number(field, values, 0) == field->fallback);
}

const struct scenario_field *schema_find(const struct schema *schema, const char *path)
{
    for (size_t i = 0; i < schema->count; i++)
        if (strcmp(schema->field[i].path, path) == 0)
            return &schema->field[i];
    return NULL;
}

const struct scenario_field *schema_parent(const struct schema *schema,
                                           const struct scenario_field *field)
{
    char path[sizeof field->path];
    snprintf(path, sizeof path, "%s", field->path);
    char *const end = strchr(path, '[') ? strchr(path, '[') : strrchr(path, '.');
    if (end)
        *end = '\0';
    return end ? schema_find(schema, path) : NULL;
}

const struct scenario_field *schema_find_concrete(const struct schema *schema, const char *path,
                                                  size_t index[2])
{
    char general[128] = "", name[TREE_MAX_NAME];
    size_t length = 0, indices = 0, number;

    index[0] = index[1] = 0;
    for (const char *at = path; at == path || *at;) {
        bool first = at == path;
        if (!tree_path_step(&at, first, name, &number))
            return NULL;
        int n = snprintf(general + length, sizeof general - length, "%s%s",
                         name[0] && !first ? "." : "", name[0] ? name : "[]");
        length += (size_t)n;
        if (length >= sizeof general)
            return NULL;
        if (!name[0]) {
            if (indices == 2)
                return NULL;
            index[indices++] = number;
        }
    }
    return schema_find(schema, general);
}

const struct schema *schema_of(const stance_scene *scene, const struct law_file *law,
                               struct schema **own)
{
    static struct schema *kept[SCHEMA_MAX_WORDS]; /* of no scene, then as stance_scenes() */
    const stance_scene *const *scenes = stance_scenes();
    size_t i = 0;
    *own = NULL;
    if (law && law->parameters > 0)
        i = SCHEMA_MAX_WORDS;
    else if (scene)
        while (i < SCHEMA_MAX_WORDS && (i == 0 || scenes[i - 1] != scene))
            i = i > 0 && !scenes[i - 1] ? SCHEMA_MAX_WORDS : i + 1;
    if (i < SCHEMA_MAX_WORDS && kept[i])
        return kept[i];
    struct schema *schema = malloc(sizeof *schema);
    if (!schema || !schema_build(schema, scene, law, false)) {
        free(schema);
        return NULL;
    }
    *(i < SCHEMA_MAX_WORDS ? &kept[i] : own) = schema;
    return schema;
}

const stance_scene *schema_scene_with(const char *path)
{
    struct schema *own;
    size_t index[2];
    for (const stance_scene *const *scene = stance_scenes(); *scene; scene++) {
        const struct schema *const schema = schema_of(*scene, NULL, &own);
        if (schema && (schema_find(schema, path) || schema_find_concrete(schema, path, index)))
            return *scene;
    }
    return NULL;
}

const char *schema_last_name(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot ? dot + 1 : path;
}

size_t schema_children(const struct schema *schema, const char *path, const char **names,
                       size_t room)
{
    size_t length = strlen(path), n = 0;
    for (size_t i = 0; i < schema->count && n < room; i++) {
        const char *child = schema->field[i].path;
        const char *rest = child + length + (length > 0);
        if (length > 0 && (strncmp(child, path, length) != 0 || child[length] != '.'))
            continue;
        if (!strpbrk(rest, ".["))
            names[n++] = rest;
    }
    return n;
}

const char *schema_range_text(const struct scenario_field *field, char *buffer, size_t size)
{
    if (field->low == field->high)
        snprintf(buffer, size, "%.9g", field->low);
    else if (isinf(field->low))
        snprintf(buffer, size, "any finite number");
    else if (field->high_open)
        snprintf(buffer, size, "less than %.9g, at least %.9g", field->high, field->low);
    else if (field->low_open)
        snprintf(buffer, size, "more than %.9g, at most %.9g", field->low, field->high);
    else
        snprintf(buffer, size, "%.9g ... %.9g", field->low, field->high);
    return buffer;
}
