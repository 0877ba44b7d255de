/* test_schema.c - the documentation of the scenario format and its JSON Schema agree with the
 * table.
 */
#include "support.h"

#include "runner/base/command.h"
#include "runner/scenario/schema_mechanism.h"

#define assert_near(found, wanted, tolerance) assert_true(fabs((found) - (wanted)) <= (tolerance))

static char errors[1 << 12];

/* ---- documentation -------------------------------------------------------------------------- */

static char described[1 << 19];

static bool describe(const char *path, bool json_schema)
{
    FILE *out = fmemopen(described, sizeof described, "w"),
         *failed = fmemopen(errors, sizeof errors, "w");
    assert_non_null(out);
    assert_non_null(failed);
    bool good = scenario_describe(path, json_schema, NULL, out, failed);
    fputc('\0', out);
    fputc('\0', failed);
    fclose(out);
    fclose(failed);
    return good;
}

/* The schema of a scene; freed by the caller. */
static struct schema *built_schema(const stance_scene *scene)
{
    struct schema *schema = room(sizeof *schema);
    assert_true(schema_build(schema, scene, NULL, true));
    return schema;
}

static bool begins(const char *text, const char *path)
{
    return strncmp(text, path, strlen(path)) == 0 && text[strlen(path)] == '\n';
}

/* What is described of a scene, alone or with others that have the same; NULL: nothing. */
static const char *section_of(const char *scene)
{
    char line[200], word[64];
    snprintf(word, sizeof word, " %.40s,", scene);
    for (const char *at = described; at; at = strstr(at + 1, "scene: ")) {
        const size_t length = strcspn(at, "\n");
        if (strncmp(at, "scene: ", 7) != 0)
            continue;
        snprintf(line, sizeof line, "%.*s,", (int)length, at);
        if (strstr(line, word))
            return at + length + 1;
    }
    return NULL;
}

TEST(every_path_is_described)
{
    for (int k = 0; stance_scenes()[k]; k++) {
        OWN struct schema *schema = built_schema(stance_scenes()[k]);
        char head[64], first[32];
        for (size_t i = 0; i < schema->count; i++) {
            const char *path = schema->field[i].path;
            assert_true(describe(path, false));
            const char *at = section_of(schema->scene->name);
            assert_true(begins(at ? at : described, path));
            snprintf(first, sizeof first, "%.20s", schema->field[i].text);
            assert_non_null(strstr(at ? at : described, first));
            assert_true(describe(NULL, false));
            snprintf(head, sizeof head, "scene: %.40s (", schema->scene->name);
            at = schema->field[i].by_scene ? strstr(described, head) : described;
            assert_true(at && strstr(at, path));
        }
    }
    assert_true(describe("sweep.grid[3].count", false));
    assert_false(describe("controler.kp", false));
    assert_string_equal(errors, "stance describe: unknown path 'controler.kp'; did you mean "
                                "'controller.kp'?\n");
}

/* Names of a robot of one's own are those of the pattern; what several scenes have alike is said
 * once. */
TEST(own_names_are_described)
{
    static const struct {
        const char *path, *begins;
    } paths[] = {
        {"robot.bodies.trunk", "scene: mechanism\nrobot.bodies.BODY\n"},
        {"robot.bodies.trunk.limits[1]", "scene: mechanism\nrobot.bodies.BODY.limits[]\n"},
        {"robot.contacts.toe.radius", "scene: mechanism\nrobot.contacts.CONTACT.radius\n"},
        {"initial.state.trunk", "scene: mechanism\ninitial.state.BODY\n"},
        {"initial.state.vtrunk", "scene: mechanism\ninitial.state.vBODY\n"},
        {"controller.weights.trunk", "scene: mechanism\ncontroller.weights.BODY\n"},
        {"controller.gains.hip.trunk", "scene: mechanism\ncontroller.gains.ACTUATOR.BODY\n"},
        {"ground.plates.step.height", "ground.plates.PLATE.height\n"},
        {"controller.poles[]", "scene: biped, mechanism\ncontroller.poles[]\n"},
        {"controller.poles[2]", "scene: biped, mechanism\ncontroller.poles[]\n"},
    };
    for (size_t i = 0; i < COUNT(paths); i++) {
        assert_true(describe(paths[i].path, false));
        assert_true(strncmp(described, paths[i].begins, strlen(paths[i].begins)) == 0);
        assert_null(strstr(described + 1, "scene: "));
    }
    assert_false(describe("robot.bodies.trunk.mas", false));
    assert_false(describe("robot.bodies.trunk.mass.x", false));
    assert_false(describe("controller.gains.hip.trunk[0]", false));
}

/* A scene's own keys are described for every scene that has them, and for no other. */
TEST(scenes_have_their_own_keys)
{
    assert_true(describe("robot", false));
    assert_non_null(strstr(described, "scene: biped\n"));
    assert_non_null(strstr(described, "Keys: leg_length, "));
    assert_non_null(strstr(described, "scene: ball\nrobot\n"));
    assert_non_null(strstr(described, "Keys: mass, radius, points\n"));
    assert_non_null(strstr(described, "Keys: mass, pull, pull_frequency, points, slope\n"));
    assert_non_null(strstr(described, "Keys: length, mass, inertia_ratio, points\n"));
    assert_true(describe("stop.fall_height", false));
    assert_non_null(strstr(described, "scene: biped\nstop.fall_height\n"));
    assert_null(strstr(described, "scene: ball\n"));
    assert_ptr_equal(schema_scene_with("robot.hip_mass"), stance_scene_find("biped"));
    assert_ptr_equal(schema_scene_with("controller.poles[2]"), stance_scene_find("biped"));
    assert_ptr_equal(schema_scene_with("robot.slope"), stance_scene_find("block"));
    assert_null(schema_scene_with("robot.hipmass"));
    OWN struct schema *schema = built_schema(stance_scene_find("rod"));
    static const char *const missing[] = {"initial.support_foot", "controller.poles",
                                          "controller.sample_time", "stop.fall_height"};
    for (size_t i = 0; i < COUNT(missing); i++) {
        assert_null(schema_find(schema, missing[i]));
        assert_non_null(schema_scene_with(missing[i]));
    }
}

/* What reads method.tolerance is named, with what it reads by default. */
TEST(tolerance_names_its_methods)
{
    assert_true(describe("method.tolerance", false));
    assert_non_null(strstr(described, "default: the method's own"));
    for (int i = 0; described[i]; i++)
        described[i] = described[i] == '\n' ? ' ' : described[i];
    for (int m = 0; stance_methods()[m]; m++) {
        char wanted[64];
        snprintf(wanted, sizeof wanted, "%.32s (default", stance_methods()[m]->name);
        assert_int_equal(strstr(described, wanted) != NULL, stance_methods()[m]->tolerance > 0);
    }
}

/* The JSON Schema of a path without indices; for stop.settle the branch that is a mapping. */
static json_t *json_at(json_t *root, const char *path)
{
    char name[64];
    for (const char *at = path; *at;) {
        size_t length = strcspn(at, ".");
        json_t *branches = json_object_get(root, "anyOf");
        snprintf(name, sizeof name, "%.*s", (int)length, at);
        root =
            branches && !json_object_get(root, "properties") ? json_array_get(branches, 1) : root;
        json_t *const any = json_object_get(json_object_get(root, "additionalProperties"), "anyOf");
        root = strcmp(name, PLATE_PATTERN) == 0
                   ? json_array_get(any, 0)
                   : json_object_get(json_object_get(root, "properties"), name);
        at += length + (at[length] == '.');
    }
    return root;
}

static void check_number_schema(const struct scenario_field *field, json_t *object)
{
    if (json_object_get(object, "anyOf")) /* or a word, or a complex number */
        object = json_array_get(json_object_get(object, "anyOf"), 0);
    assert_string_equal(json_string_value(json_object_get(object, "type")),
                        field->whole || field->type == FIELD_INTEGER ? "integer" : "number");
    json_t *low = json_object_get(object, field->low_open ? "exclusiveMinimum" : "minimum");
    json_t *high = json_object_get(object, "maximum");
    assert_near(json_number_value(low), field->low, 0);
    assert_near(json_number_value(high), field->high, 0);
}

static void check_scene_schema(json_t *root, const stance_scene *scene)
{
    OWN struct schema *schema = built_schema(scene);
    const char *names[SCHEMA_MAX_FIELDS];
    assert_non_null(root);
    assert_int_equal(json_object_size(json_object_get(root, "properties")),
                     schema_children(schema, "", names, SCHEMA_MAX_FIELDS));
    for (size_t i = 0; i < schema->count; i++) {
        const struct scenario_field *field = &schema->field[i];
        if (strchr(field->path, '['))
            continue;
        json_t *object = json_at(root, field->path);
        assert_non_null(object);
        const char *text = json_string_value(json_object_get(object, "description"));
        assert_true(text && strncmp(text, field->text, strlen(field->text)) == 0);
        if (field->type == FIELD_NUMBER || field->type == FIELD_INTEGER) {
            check_number_schema(field, object);
        } else if (strcmp(field->path, "scene") == 0) {
            json_t *word = json_array_get(json_object_get(object, "enum"), 0);
            assert_string_equal(json_string_value(word), scene->name);
        } else if (strcmp(json_string_value(json_object_get(object, "type")) ?: "", "boolean") ==
                   0) {
            assert_string_equal(field->words[1], "true");
        } else if (field->type == FIELD_WORD) {
            assert_int_equal(json_array_size(json_object_get(object, "enum")), field->word_count);
        } else if (field->type == FIELD_MAP) {
            /* A law has keys of its own, the ground pieces. */
            const bool ground = strcmp(field->path, "ground.plates") == 0,
                       own = strcmp(field->path, "controller") == 0 || ground;
            assert_true(own || json_is_false(json_object_get(object, "additionalProperties")));
            assert_int_equal(json_object_size(json_object_get(object, "properties")) + ground,
                             schema_children(schema, field->path, names, SCHEMA_MAX_FIELDS));
        }
        if (field->offset != NO_OFFSET && !field->fallback_text && !isnan(field->fallback)) {
            json_t *fallback = json_object_get(object, "default");
            assert_non_null(fallback);
            if (field->type == FIELD_NUMBER) {
                assert_near(json_number_value(fallback), field->fallback,
                            1e-14 * fabs(field->fallback));
            }
        }
    }
}

TEST(schema_agrees_with_the_table)
{
    json_error_t problem;
    assert_true(describe(NULL, true));
    JSON *root = json_loads(described, JSON_REJECT_DUPLICATES, &problem);
    json_t *scenes = json_object_get(root, "oneOf");
    assert_non_null(root);
    for (size_t k = 0; stance_scenes()[k]; k++)
        check_scene_schema(scenes ? json_array_get(scenes, k) : root, stance_scenes()[k]);
}
