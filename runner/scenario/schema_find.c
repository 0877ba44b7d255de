/* schema_find.c - looks up rows of the scenario format. */
#include "schema.h"
#include "tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const schema_use_text[] = {
    [USE_CONTROL] = "a controller.kind other than none",
    [USE_FEEDBACK] = "controller.kind state-feedback",
    [USE_FAR] = "a controller.far other than none",
    [USE_PLACE] = "controller.design place or place-schur",
    [USE_LQR] = "controller.design lqr",
    [USE_MODEL] = "a controller.design other than gains",
    [USE_GAINS] = "controller.design gains",
    [USE_EQUILIBRIUM] = "initial.equilibrium",
    [USE_STATE] = "initial.state",
    [USE_SETTLE] = "a stop.settle other than off",
};

const struct scenario_field *schema_find(const struct schema *schema, const char *path)
{
    for (size_t i = 0; i < schema->count; i++)
        if (strcmp(schema->field[i].path, path) == 0)
            return &schema->field[i];
    return NULL;
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

const struct schema *schema_of(const stance_scene *scene, struct schema **own)
{
    static struct schema *kept[SCHEMA_MAX_WORDS]; /* of no scene, then as stance_scenes() */
    const stance_scene *const *scenes = stance_scenes();
    size_t i = 0;
    *own = NULL;
    if (scene)
        while (i < SCHEMA_MAX_WORDS && (i == 0 || scenes[i - 1] != scene))
            i = i > 0 && !scenes[i - 1] ? SCHEMA_MAX_WORDS : i + 1;
    if (i < SCHEMA_MAX_WORDS && kept[i])
        return kept[i];
    struct schema *schema = malloc(sizeof *schema);
    if (!schema || !schema_build(schema, scene)) {
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
        const struct schema *const schema = schema_of(*scene, &own);
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
