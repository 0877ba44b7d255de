/* schema_mechanism.c - the rows of the scenario format that describe a mechanism. */
#include "schema_mechanism.h"
#include "schema_laws.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MEMBERS(counted, member, belongs, number)                                                  \
    offsetof(stance_mechanism, counted), offsetof(stance_mechanism, member[0].name),               \
        offsetof(stance_mechanism, member[0].belongs), sizeof(((stance_mechanism *)0)->member[0]), \
        offsetof(stance_mechanism_numbers, number),                                                \
        sizeof(((stance_mechanism_numbers *)0)->number[0])
const struct part_kind part_kinds[PARTS] = {
    [PART_BODY] = {"robot", "bodies", "body", STANCE_MAX_BODIES,
                   MEMBERS(bodies, body, parent, body), "rigid bodies, each with its joint"},
    [PART_CONTACT] = {"robot", "contacts", "contact", STANCE_MAX_ELEMENTS,
                      MEMBERS(elements, element, body, element),
                      "what may touch the ground: points, discs, soles"},
    [PART_POINT] = {"robot", "points", "point", STANCE_MAX_NAMED,
                    MEMBERS(points, point, body, point), "points of bodies that have a name"},
    [PART_ACTUATOR] = {"robot", "actuators", "actuator", STANCE_MAX_ACTUATORS,
                       MEMBERS(actuators, actuator, body, limit), "motors in joints"},
    [PART_PLATE] = {"ground", "plates", "piece of the ground", STANCE_MAX_PLATES,
                    MEMBERS(plates, plate, kind, plate), NULL},
};

/* In the order of stance_joint. */
static const char *const joint_words[] = {"free", "hinge", "slide", "fixed"};
/* In the order of stance_ground_kind. */
static const char *const ground_words[] = {"plate", "stairs", "rough"};

/* ---- the table ------------------------------------------------------------------------------- */

enum {
    SLIDES = 1 << STANCE_SLIDE,
    MOVES = SLIDES | 1 << STANCE_HINGE,
    HANGS = MOVES | 1 << STANCE_FIXED,
    ANY = HANGS | 1 << STANCE_FREE,
    ROUGH = 1 << STANCE_ROUGH,
    SEVERAL = ROUGH | 1 << STANCE_STAIRS,
    ALL = SEVERAL | 1 << STANCE_PLATE,
};

/* Loose bounds that keep nonsense out where physics gives none. */
#define LARGE 1e9
#define FAR 1e6
#define TURN 1e4 /* rad, beyond which sines are not defined */

#define RANGE(least, largest) .low = (least), .high = (largest)
#define IN(record, member) .offset = offsetof(record, member)
#define BODY(member) .type = FIELD_NUMBER, IN(stance_body_numbers, member)
#define BODY_TWO(member) .type = FIELD_NUMBERS, .items = 2, IN(stance_body_numbers, member)
#define ELEMENT(member) IN(stance_element_numbers, member)
#define POINT(member) IN(stance_point_numbers, member)
#define PLATE(member) .type = FIELD_NUMBER, IN(stance_plate_numbers, member)
#define TWO .type = FIELD_NUMBERS, .items = 2
#define WORD_ROW .fallback = NAN

/* One member a line would make the table hard to read. */
/* clang-format off */
const struct part_key part_keys[] = {
    {PART_BODY, {.path = "joint", .type = FIELD_WORD, .required = true, WORD_ROW,
        .words = joint_words, .word_count = 4, .text = "what it may do against its parent",
        .more = "A root (one body has no parent) is free, turns on a hinge in the world, or slides "
                "along a rail and does not turn. Any other turns on a hinge, slides along an axis "
                "of its parent and keeps the parent's angle, or is fixed to it. Its angle, "
                "counter-clockwise, or its displacement is called as the body is; 0: its frame has "
                "the parent's direction but for `angle`, or stands where its joint is."},
        .joints = ANY},
    {PART_BODY, {.path = "coordinate", .type = FIELD_TEXT, WORD_ROW,
        .fallback_text = "the body's name", .text = "what the joint's angle or displacement is called",
        .more = "Of a free root its angle; x and z are always called so."}, .joints = MOVES | 1 << STANCE_FREE},
    {PART_BODY, {.path = "parent", .type = FIELD_WORD, WORD_ROW,
        .fallback_text = "none, it is the root", .text = "the body that it hangs from"},
        .joints = HANGS, .names_body = true},
    {PART_BODY, {.path = "like", .type = FIELD_WORD, WORD_ROW, .fallback_text = "none",
        .text = "another body whose numbers it has, where it has not its own",
        .more = "A copy: varying the one leaves the other as it is. What a root has as `at` is not "
                "copied."}, .joints = ANY, .names_body = true},
    {PART_BODY, {.path = "at", BODY_TWO(at), .unit = "m", RANGE(-FAR, FAR),
        .fallback_text = "[0, 0]", .text = "its joint, x and z in the parent's frame",
        .more = "Of a root in the world's. It is the origin of the body's own frame, from where what "
                "slides takes it along."}, .joints = HANGS},
    {PART_BODY, {.path = "axis", BODY_TWO(axis), .unit = "1", RANGE(-FAR, FAR),
        .fallback_text = "[1, 0]", .text = "direction in which it slides, of any length",
        .more = "x and z in the parent's frame; of a root in the world's."}, .joints = SLIDES},
    {PART_BODY, {.path = "angle", BODY(angle), .unit = "rad", RANGE(-TURN, TURN),
        .text = "how its frame is turned against the parent's where its coordinate is 0",
        .more = "Counter-clockwise; of a root against the world's."}, .joints = ANY},
    {PART_BODY, {.path = "mass", BODY(mass), .unit = "kg", RANGE(0, LARGE), .text = "mass"},
        .joints = ANY},
    {PART_BODY, {.path = "inertia", BODY(inertia), .unit = "kg m^2", RANGE(0, LARGE),
        .text = "moment of inertia about its centre of mass"}, .joints = ANY},
    {PART_BODY, {.path = "centre", BODY_TWO(centre), .unit = "m", RANGE(-FAR, FAR),
        .fallback_text = "[0, 0]", .text = "its centre of mass, x and z in its frame"},
        .joints = ANY},
    {PART_BODY, {.path = "stiffness", BODY(stiffness), .unit = "N m/rad", RANGE(0, LARGE),
        .text = "stiffness of a spring in the joint"}, .joints = MOVES, .slide_unit = "N/m"},
    {PART_BODY, {.path = "damping", BODY(damping), .unit = "N m s/rad", RANGE(0, LARGE),
        .text = "damping of the joint"}, .joints = MOVES, .slide_unit = "N s/m"},
    {PART_BODY, {.path = "rest", BODY(rest), .unit = "rad", RANGE(-TURN, TURN),
        .text = "where the spring is slack"}, .joints = MOVES, .slide_unit = "m"},
    {PART_BODY, {.path = "armature", BODY(armature), .unit = "kg m^2", RANGE(0, LARGE),
        .text = "inertia of a geared rotor, as the joint feels it"}, .joints = MOVES,
        .slide_unit = "kg"},
    {PART_BODY, {.path = "limits", BODY_TWO(limits), .unit = "rad", RANGE(-TURN, TURN),
        .words = schema_none, .word_count = 1, .fallback_text = "[none, none]",
        .text = "stops of the joint, the lower one first",
        .more = "Struck without rebound, whatever ground.restitution is."},
        .joints = MOVES, .slide_unit = "m"},
    {PART_BODY, {.path = "turn", BODY(turn), .unit = "rad", RANGE(0, TURN), .low_open = true,
        .fallback = NAN, .fallback_text = "none",
        .text = "angle from upright beyond which the robot has fallen",
        .more = "Its fall_cause is then the body. implicit, midpoint and lagrange look at the ends of "
                "steps only."},
        .joints = 1 << STANCE_FREE | 1 << STANCE_HINGE},

    {PART_CONTACT, {.path = "body", .type = FIELD_WORD, .required = true, WORD_ROW,
        .text = "the body that it belongs to"}, .names_body = true, .of_sole = true,
        .of_point = true},
    {PART_CONTACT, {.path = "at", TWO, ELEMENT(at), .unit = "m", RANGE(-FAR, FAR),
        .text = "the point or the disc's centre, x and z in the body's frame",
        .more = "Give this, or from and to: then it is a flat sole or, with a radius, a capsule, which "
                "carries at both ends and slips as one."}, .of_point = true},
    {PART_CONTACT, {.path = "from", TWO, ELEMENT(at), .unit = "m", RANGE(-FAR, FAR),
        .text = "one end of a flat sole, or of a capsule's axis"}, .of_sole = true},
    {PART_CONTACT, {.path = "to", TWO, ELEMENT(to), .unit = "m", RANGE(-FAR, FAR),
        .text = "its other end"}, .of_sole = true},
    {PART_CONTACT, {.path = "radius", .type = FIELD_NUMBER, ELEMENT(radius), .unit = "m",
        RANGE(0, FAR), .text = "radius of a disc, as a wheel or a round foot, or of a capsule; 0: a point, a flat sole"},
        .of_sole = true, .of_point = true},
    {PART_CONTACT, {.path = "friction_factor", .type = FIELD_NUMBER, ELEMENT(friction_factor), .unit = "1",
        RANGE(0.01, 100), .fallback = 1, .text = "its coefficient of friction: so many times ground.friction",
        .more = "friction_used counts in the ground's friction: as its force divided by this."},
        .of_sole = true, .of_point = true},

    {PART_POINT, {.path = "body", .type = FIELD_WORD, .required = true, WORD_ROW,
        .text = "the body that it belongs to"}, .names_body = true},
    {PART_POINT, {.path = "at", TWO, POINT(at), .unit = "m", RANGE(-FAR, FAR),
        .fallback_text = "[0, 0]", .text = "where it is, x and z in the body's frame"},
        .pushes = 0},
    {PART_POINT, {.path = "lowest", .type = FIELD_NUMBER, POINT(lowest), .unit = "m",
        RANGE(-FAR, FAR), .fallback = NAN, .fallback_text = "none",
        .text = "height above the ground at which the robot has fallen",
        .more = "0: where the point touches the ground. The height is normal to the ground. Its "
                "fall_cause is then the point. implicit, midpoint and lagrange look at the ends of "
                "steps only."},
        .pushes = 0},
    {PART_POINT, {.path = "force", TWO, POINT(force), .unit = "N", RANGE(-LARGE, LARGE),
        .text = "force, [0] along the ground, [1] normal",
        .more = "The world pushes the point with it from `from` to `to`. Each "
                "step gets the mean over it, so that the whole is exact."},
        .pushes = 1 << STANCE_FORCE},
    {PART_POINT, {.path = "impulse", TWO, POINT(force), .unit = "N s", RANGE(-LARGE, LARGE),
        .text = "impulse, [0] along the ground, [1] normal",
        .more = "The world strikes the point with it at the step that begins nearest to `from`; the "
                "contact laws see the velocity that it leaves."},
        .pushes = 1 << STANCE_IMPULSE},
    {PART_POINT, {.path = "from", .type = FIELD_NUMBER, POINT(from), .unit = "s", RANGE(0, LARGE),
        .text = "when the push begins, or the impulse falls"},
        .pushes = 1 << STANCE_FORCE | 1 << STANCE_IMPULSE},
    {PART_POINT, {.path = "to", .type = FIELD_NUMBER, POINT(to), .unit = "s", RANGE(0, LARGE),
        .fallback_text = "none where it swings", .text = "when the push ends"},
        .pushes = 1 << STANCE_FORCE},
    {PART_POINT, {.path = "frequency", .type = FIELD_NUMBER, POINT(frequency), .unit = "Hz",
        RANGE(0, FAR), .fallback_text = "none: it is constant",
        .text = "how often the force swings",
        .more = "It is then sin(2 pi frequency (t - from)) of `force`."},
        .pushes = 1 << STANCE_FORCE},

    {PART_ACTUATOR, {.path = "body", .type = FIELD_WORD, .required = true, WORD_ROW,
        .text = "the body whose joint it drives",
        .more = "A torque on the body and its opposite on the parent; on one that slides a force."},
        .names_body = true},
    {PART_ACTUATOR, {.path = "limit", .type = FIELD_NUMBER, .unit = "N m",
        RANGE(0, LARGE), .low_open = true, .fallback = INFINITY, .fallback_text = "none",
        .words = schema_none, .word_count = 1, .text = "largest torque",
        .more = "Where controller.torque_limit is smaller, that one holds."}, .slide_unit = "N"},

    {PART_PLATE, {.path = "kind", .type = FIELD_WORD, .fallback = STANCE_PLATE,
        .words = ground_words, .word_count = 3, .text = "what begins there",
        .more = "plate: one plate. stairs: plates of `width`, each `height` above the one before, "
                "the first above what is before the piece. rough: plates of `width`, each at random "
                "up to `height` above or below what is before the piece."}, .grounds = ALL},
    {PART_PLATE, {.path = "from", PLATE(from), .required = true, .unit = "m", RANGE(-FAR, FAR),
        .fallback = NAN, .text = "where it begins, along the ground",
        .more = "It ends where the next one begins. With `footfall`: so far ahead (+x) of the foot "
                "that stands then."}, .grounds = ALL},
    {PART_PLATE, {.path = "footfall", PLATE(footfall), .whole = true, .unit = "1", RANGE(1, LARGE),
        .fallback = NAN, .fallback_text = "none, it is always there",
        .text = "footfall before which it is laid: of the first one is 1"}, .grounds = ALL},
    {PART_PLATE, {.path = "height", PLATE(height), .unit = "m", RANGE(-FAR, FAR),
        .text = "height above the plane of the ground, normal to it; of stairs and rough see kind"}, .grounds = ALL},
    {PART_PLATE, {.path = "width", PLATE(width), .unit = "m", RANGE(1e-6, FAR), .fallback = NAN,
        .fallback_text = "must be given", .text = "width of each plate of stairs or rough ground"},
        .grounds = SEVERAL},
    {PART_PLATE, {.path = "count", PLATE(count), .whole = true, .unit = "1", RANGE(1, LARGE),
        .fallback = INFINITY, .fallback_text = "none, they do not end", .words = schema_none,
        .word_count = 1, .text = "how many plates stairs or rough ground has",
        .more = "Behind them the last stair goes on; behind rough ground what was before it."},
        .grounds = SEVERAL},
    {PART_PLATE, {.path = "seed", PLATE(seed), .whole = true, .unit = "1", RANGE(0, 1e15),
        .fallback = NAN, .fallback_text = "none, another ground at each point of sweep.sample",
        .text = "which rough ground",
        .more = "The same in every case that has it. Else it follows from the study's seed and the "
                "number of the sample's point: the same along axes of the grid."}, .grounds = ROUGH},
    {PART_PLATE, {.path = "friction_factor", PLATE(friction_factor), .unit = "1",
        RANGE(0.01, 100), .fallback = 1, .text = "coefficient of friction there: so many times ground.friction",
        .more = "By the contact's own friction_factor, too."}, .grounds = ALL},
};
/* clang-format on */
const size_t part_key_count = sizeof part_keys / sizeof part_keys[0];

/* ---- parts ----------------------------------------------------------------------------------- */

const struct part_key *part_key(enum part part, const char *name)
{
    const struct part_key *key = part_keys;
    while (key->part != part || strcmp(key->field.path, name) != 0)
        key++;
    return key;
}

int part_count(const stance_mechanism *m, enum part part)
{
    return *(const int *)(const void *)((const char *)m + part_kinds[part].count);
}

const char *part_name(const stance_mechanism *m, enum part part, int i)
{
    const struct part_kind *const kind = &part_kinds[part];
    return part == PART_PLATE && m->plates == 0
               ? PLATE_PATTERN
               : (const char *)m + kind->name + (size_t)i * kind->size;
}

int part_body(const stance_mechanism *m, enum part part, int i)
{
    const size_t at = part_kinds[part].body + (size_t)i * part_kinds[part].size;
    return part == PART_PLATE ? -1 : *(const int *)(const void *)((const char *)m + at);
}

void part_put(stance_mechanism *m, enum part part, int i, const char *name, int body)
{
    char *const at = (char *)m + (size_t)i * part_kinds[part].size;
    snprintf(at + part_kinds[part].name, STANCE_NAME, "%s", name);
    if (part != PART_PLATE)
        memcpy(at + part_kinds[part].body, &body, sizeof body);
}

int part_numbers(const struct part_key *key)
{
    return key->field.type == FIELD_NUMBERS ? 2 : key->field.type == FIELD_NUMBER ? 1 : 0;
}

int part_place(const stance_mechanism *m, const struct part_key *key, int i)
{
    const struct part_kind *const kind = &part_kinds[key->part];
    if (part_numbers(key) == 0 ||
        (key->part == PART_BODY && !(key->joints >> m->body[i].joint & 1)) ||
        (key->part == PART_POINT && key->pushes && !(key->pushes >> m->point[i].pushed & 1)) ||
        (key->part == PART_PLATE && !(key->grounds >> m->plate[i].kind & 1)) ||
        (key->part == PART_CONTACT && !(m->element[i].sole ? key->of_sole : key->of_point)))
        return -1;
    return (int)((kind->numbers + (size_t)i * kind->numbers_size + key->field.offset) /
                 sizeof(double));
}

int part_robot(const stance_mechanism *m, int place)
{
    for (int i = 0; place >= 0 && i < m->numbers; i++)
        if (m->number[i] == place)
            return i;
    return -1;
}

const char *part_unit(const stance_mechanism *m, const struct part_key *key, int i)
{
    const int body = key->part == PART_ACTUATOR ? m->actuator[i].body : i;
    return key->slide_unit && m->body[body].joint == STANCE_SLIDE ? key->slide_unit
                                                                  : key->field.unit;
}

/* ---- rows ------------------------------------------------------------------------------------ */

bool schema_any_plate(const struct schema *schema)
{
    return schema->documents && schema->scene && schema->scene->mechanism->plates == 0;
}

static bool add_map(struct schema *schema, const struct scenario_field *row, const char *name,
                    const char *text)
{
    struct scenario_field own = *row;
    own.fallback_text = NULL;
    return schema_group(schema_add(schema, &own, "%s", name), FIELD_MAP, "%s", text);
}

/* The row of a key of part i, and where it is a list that of its items. */
static bool add_key(struct schema *schema, const struct scenario_field *row, bool model,
                    const struct part_key *key, int i)
{
    const stance_mechanism *const m = schema->scene->mechanism;
    const bool plate = key->part == PART_PLATE,
               any = plate ? schema_any_plate(schema) : schema->pattern;
    const int number = any ? -1 : part_robot(m, part_place(m, key, i)), count = part_numbers(key);
    const char *const name = part_name(m, key->part, i);
    const struct scenario_field *const own = &key->field;
    for (int item = 0; item < (count == 2 ? 2 : 1); item++) {
        struct scenario_field *const field =
            schema_add(schema, row, "%s.%.31s.%.24s%s", part_kinds[key->part].key, name, own->path,
                       item ? "[]" : "");
        if (!field)
            return false;
        const bool varied = (number >= 0 || (any && count > 0)) && (count == 1 || item);
        const struct scenario_field general = *field;
        *field = *own;
        memcpy(field->path, general.path, sizeof field->path);
        field->use = general.use;
        field->by_scene = !(plate && any);
        field->required = own->required && !model && (plate || !m->carried);
        field->sweep = varied;
        field->design = general.design && key->part != PART_POINT; /* no law knows those */
        field->offset =
            varied && number >= 0 ? general.offset + (size_t)number * sizeof(double) : NO_OFFSET;
        snprintf(field->unit, sizeof field->unit, "%s", part_unit(m, key, i));
        snprintf(field->text, sizeof field->text, "%s%.31s: %.100s", model ? "model of " : "", name,
                 own->text);
        if (model) {
            field->fallback = NAN;
            field->fallback_text = "as the robot";
        }
        if (item) {
            field->type = FIELD_NUMBER;
            field->fallback = NAN;
            field->fallback_text = NULL;
        }
        if (key->names_body && schema->pattern) {
            field->type = FIELD_TEXT;
        } else if (key->names_body) {
            field->words = schema->bodies;
            field->word_count = (size_t)m->bodies;
        }
    }
    return true;
}

/* The rows of part i. */
static bool add_part(struct schema *schema, const struct scenario_field *row, bool model,
                     enum part part, int i)
{
    const stance_mechanism *const m = schema->scene->mechanism;
    const struct part_kind *const kind = &part_kinds[part];
    char name[64], text[64];
    snprintf(name, sizeof name, "%s.%.31s", kind->key, part_name(m, part, i));
    snprintf(text, sizeof text, "the %s %.31s", kind->one, part_name(m, part, i));
    bool good = add_map(schema, row, name, text);
    for (size_t k = 0; good && k < part_key_count; k++)
        if (part_keys[k].part == part &&
            (!model || part_robot(m, part_place(m, &part_keys[k], i)) >= 0 ||
             (schema->pattern && part_numbers(&part_keys[k]) > 0)))
            good = add_key(schema, row, model, &part_keys[k], i);
    return good;
}

bool schema_add_mechanism(struct schema *schema, const struct scenario_field *row)
{
    const stance_mechanism *const m = schema->scene->mechanism;
    const bool model = row->fallback_text != NULL;
    bool good = true;
    if (model && m->carried) /* no design knows points */
        return true;
    for (int b = 0; b < m->bodies; b++)
        schema->bodies[b] = m->body[b].name;
    for (int part = m->carried ? PART_POINT : 0;
         good && part < (m->carried ? PART_ACTUATOR : ROBOT_PARTS); part++) {
        good = add_map(schema, row, part_kinds[part].key, part_kinds[part].text);
        for (int i = 0; good && i < part_count(m, (enum part)part); i++)
            good = add_part(schema, row, model, (enum part)part, i);
    }
    return good;
}

bool schema_add_plates(struct schema *schema, const struct scenario_field *row)
{
    struct scenario_field below = *row;
    struct scenario_field *const map = schema_add(schema, row, NULL);
    if (!map)
        return false;
    map->offset = NO_OFFSET;
    map->sweep = false;
    map->by_scene = !schema->documents;
    bool good = true;
    below.more = NULL;
    below.by_scene = map->by_scene;
    snprintf(below.path, sizeof below.path, "%s.*", part_kinds[PART_PLATE].in);
    for (int i = 0; good && schema->scene && i < schema->scene->mechanism->plates; i++)
        good = add_part(schema, &below, false, PART_PLATE, i);
    return good && (!schema_any_plate(schema) || add_part(schema, &below, false, PART_PLATE, 0));
}
