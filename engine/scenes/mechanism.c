/* mechanism.c - the scene of a described mechanism: names, units, ranges, and what belongs to what.
 */
#include "engine/refuse.h"
#include "engine/rest.h"
#include "engine/scenes/mechanism_pose.h"
#include "engine/tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FAR 1e6   /* m */
#define TURNS 1e3 /* rad */

enum { LABEL = 2 * STANCE_NAME, TEXT = 128 };

/* What stance_scene_free gives back at once. */
struct described {
    stance_scene scene;
    stance_mechanism m;
    stance_tree tree;
    stance_quantity robot[STANCE_MAX_ROBOT], coordinate[STANCE_MAX_COORDINATES];
    char robot_name[STANCE_MAX_ROBOT][LABEL], robot_text[STANCE_MAX_ROBOT][TEXT];
    char coordinate_text[STANCE_MAX_COORDINATES][TEXT];
    char contact[STANCE_MAX_CONTACTS][LABEL];
    const char *contact_name[STANCE_MAX_CONTACTS], *actuator_name[STANCE_MAX_ACTUATORS];
    const char *cause[STANCE_MAX_NAMED + STANCE_MAX_BODIES];
    int posture[STANCE_MAX_POSTURE], actuated[STANCE_MAX_ACTUATORS], grip[STANCE_MAX_CONTACTS];
};

bool stance_mechanism_stops(const stance_mechanism *m, int b, int side)
{
    return (m->body[b].joint == STANCE_HINGE || m->body[b].joint == STANCE_SLIDE) &&
           isfinite(m->value.body[b].limits[side]);
}

bool stance_mechanism_contact(const stance_mechanism *m, int c, stance_contact_place *place)
{
    for (int e = 0; e < m->elements; e++) {
        const int ends = m->element[e].sole ? 2 : 1;
        *place = (stance_contact_place){e, m->element[e].body, c};
        if (c < ends)
            return true;
        c -= ends;
    }
    for (int b = 0; b < m->bodies; b++)
        for (int side = 0; side < 2; side++) {
            *place = (stance_contact_place){-1, b, side};
            if (stance_mechanism_stops(m, b, side) && c-- == 0)
                return true;
        }
    return false;
}

int stance_mechanism_coordinate(const stance_mechanism *m, int b)
{
    int i = m->body[0].joint == STANCE_FREE ? 2 : 0;
    for (int k = 0; k < b; k++)
        i += m->body[k].joint != STANCE_FIXED;
    return i;
}

/* ---- numbers: one table ---------------------------------------------------------------------- */

struct number_kind {
    const char *key, *unit, *slide_unit, *text;
    size_t offset;
    int count;
    double low, high;
};

#define BODY(field) offsetof(stance_body_numbers, field)
static const struct number_kind body_numbers[] = {
    {"mass", "kg", "kg", "mass of", BODY(mass), 1, 0, 1e9},
    {"inertia", "kg m^2", "kg m^2", "moment of inertia about the centre of mass of", BODY(inertia),
     1, 0, 1e9},
    {"centre", "m", "m", "centre of mass, in the frame, of", BODY(centre), 2, -FAR, FAR},
    {"at", "m", "m", "joint, in the parent's frame, of", BODY(at), 2, -FAR, FAR},
    {"axis", "1", "1", "direction of the slide of", BODY(axis), 2, -FAR, FAR},
    {"angle", "rad", "rad", "angle against the parent at coordinate 0 of", BODY(angle), 1, -TURNS,
     TURNS},
    {"stiffness", "N m/rad", "N/m", "spring at the joint of", BODY(stiffness), 1, 0, 1e12},
    {"damping", "N m s/rad", "N s/m", "damper at the joint of", BODY(damping), 1, 0, 1e12},
    {"rest", "rad", "m", "where the spring pulls nothing, at the joint of", BODY(rest), 1, -FAR,
     FAR},
    {"armature", "kg m^2", "kg", "inertia of a geared rotor at the joint of", BODY(armature), 1, 0,
     1e9},
    {"limits", "rad", "m", "stops of the joint of", BODY(limits), 2, -INFINITY, INFINITY},
    {"turn", "rad", "rad", "angle from upright that means a fall, of", BODY(turn), 1, 0, INFINITY},
};
#undef BODY
#define ELEMENT(field) offsetof(stance_element_numbers, field)
static const struct number_kind element_numbers[] = {
    {"at", "m", "m", "position, in its body's frame, of", ELEMENT(at), 2, -FAR, FAR},
    {"to", "m", "m", "second end, in its body's frame, of", ELEMENT(to), 2, -FAR, FAR},
    {"radius", "m", "m", "radius of", ELEMENT(radius), 1, 0, FAR},
};
#undef ELEMENT
#define POINT(field) offsetof(stance_point_numbers, field)
static const struct number_kind point_numbers[] = {
    {"at", "m", "m", "position, in its body's frame, of", POINT(at), 2, -FAR, FAR},
    {"lowest", "m", "m", "height above the ground that means a fall, of", POINT(lowest), 1,
     -INFINITY, FAR},
    {"force", "N", "N s", "push, along the ground and normal to it, on", POINT(force), 2, -1e9,
     1e9},
    {"from", "s", "s", "beginning of the push on", POINT(from), 1, 0, 1e9},
    {"to", "s", "s", "end of the push on", POINT(to), 1, 0, INFINITY},
    {"frequency", "Hz", "Hz", "frequency of the push on", POINT(frequency), 1, 0, FAR},
};
#undef POINT
#define PLATE(field) offsetof(stance_plate_numbers, field)
static const struct number_kind plate_numbers[] = {
    {"from", "m", "m", "where it begins, of", PLATE(from), 1, -FAR, FAR},
    {"footfall", "1", "1", "footfall before which it is laid, of", PLATE(footfall), 1, 0, 1e9},
    {"height", "m", "m", "height of", PLATE(height), 1, -FAR, FAR},
    {"width", "m", "m", "width of each of", PLATE(width), 1, 1e-6, FAR},
    {"count", "1", "1", "number of", PLATE(count), 1, 1, INFINITY},
    {"seed", "1", "1", "which ground, of", PLATE(seed), 1, -1, 1e15},
    {"friction_factor", "1", "1", "friction by the ground's, of", PLATE(friction_factor), 1, 0.01,
     100},
};
#undef PLATE
static const struct number_kind reference_numbers[] = {
    {"reference", "m", "m", "point that x and z are of, in the frame of", 0, 2, -FAR, FAR}};
static const struct number_kind limit_numbers[] = {
    {"limit", "N m", "N", "largest torque of", 0, 1, 1e-9, INFINITY}};

/* The arrays of stance_mechanism_numbers, in their order. */
enum number_part { BODIES, CONTACTS, POINTS, PLATES, REFERENCE, LIMITS, PARTS };
#define PART(list, field, kinds)                                                                   \
    {                                                                                              \
        list, offsetof(stance_mechanism_numbers, field),                                           \
            sizeof((stance_mechanism_numbers *)0)->field[0], kinds, sizeof kinds / sizeof kinds[0] \
    }
static const struct {
    const char *list;
    size_t offset, size; /* of one */
    const struct number_kind *kind;
    size_t kinds;
} parts[PARTS] = {
    [BODIES] = PART("bodies", body, body_numbers),
    [CONTACTS] = PART("contacts", element, element_numbers),
    [POINTS] = PART("points", point, point_numbers),
    [PLATES] = PART("plates", plate, plate_numbers),
    [REFERENCE] = {"bodies", offsetof(stance_mechanism_numbers, reference), sizeof(double[2]),
                   reference_numbers, 1},
    [LIMITS] = PART("actuators", limit, limit_numbers),
};
#undef PART

static const char *name_in(const stance_mechanism *m, enum number_part part, size_t k)
{
    switch (part) {
    case CONTACTS:
        return m->element[k].name;
    case POINTS:
        return m->point[k].name;
    case PLATES:
        return m->plate[k].name;
    case LIMITS:
        return m->actuator[k].name;
    default:
        return m->body[k].name;
    }
}

/* Is it a force's or a displacement's, where others are torques and angles? */
static bool slides_in(const stance_mechanism *m, enum number_part part, size_t k)
{
    const size_t body = part == LIMITS ? (size_t)m->actuator[k].body : k;
    return (part == BODIES || part == LIMITS) && m->body[body].joint == STANCE_SLIDE;
}

static void describe_number(struct described *d, int i)
{
    const stance_mechanism *const m = &d->m;
    if (m->number[i] < 0) {
        d->robot[i] = m->carried->parameter[i];
        return;
    }
    const size_t at = (size_t)m->number[i] * sizeof(double);
    enum number_part part = LIMITS;
    while (parts[part].offset > at)
        part--;
    const size_t k = (at - parts[part].offset) / parts[part].size,
                 within = (at - parts[part].offset) % parts[part].size;
    const struct number_kind *kind = &parts[part].kind[parts[part].kinds - 1];
    while (kind->offset > within)
        kind--;
    const bool from = kind == &element_numbers[0] && m->element[k].sole;
    const bool impulse =
        kind == &point_numbers[2] && m->point[k].pushed == STANCE_IMPULSE; /* of N s */
    char index[8] = "";
    if (kind->count > 1)
        snprintf(index, sizeof index, "[%d]", within > kind->offset);
    const char *const name = name_in(m, part, k);
    snprintf(d->robot_name[i], LABEL, "%s.%s.%s%s", parts[part].list, name,
             from      ? "from"
             : impulse ? "impulse"
                       : kind->key,
             index);
    snprintf(d->robot_text[i], TEXT, "%s %s", kind->text, name);
    d->robot[i] =
        (stance_quantity){.name = d->robot_name[i],
                          .unit = slides_in(m, part, k) || impulse ? kind->slide_unit : kind->unit,
                          .text = d->robot_text[i],
                          .low = kind->low,
                          .high = kind->high};
    memcpy(&d->robot[i].fallback, (const char *)&m->value + at, sizeof(double));
}

/* ---- coordinates, contacts, actuators -------------------------------------------------------- */

static void add_coordinate(struct described *d, const char *name, bool turns, const char *text,
                           const char *of, const char *against)
{
    const int i = d->scene.coordinates++;
    if (d->m.carried) {
        d->coordinate[i] = d->m.carried->coordinate[i];
        return;
    }
    snprintf(d->coordinate_text[i], TEXT, "%s %s%s", text, of, against);
    d->coordinate[i] = (stance_quantity){.name = name,
                                         .unit = turns ? "rad" : "m",
                                         .text = d->coordinate_text[i],
                                         .low = turns ? -TURNS : -FAR,
                                         .high = turns ? TURNS : FAR};
}

/* What the coordinate of a body's joint is called. */
static const char *own_name(const stance_mechanism *m, int b)
{
    return m->body[b].coordinate[0] ? m->body[b].coordinate : m->body[b].name;
}

static void add_coordinates(struct described *d)
{
    const stance_mechanism *const m = &d->m;
    const char *const root = m->body[0].name;
    if (m->body[0].joint == STANCE_FREE) {
        add_coordinate(d, "x", false, "horizontal position of", root, ", forward");
        add_coordinate(d, "z", false, "height of", root, " above the origin");
    }
    const int first = d->scene.coordinates;
    if (m->body[0].joint == STANCE_SLIDE)
        add_coordinate(d, own_name(m, 0), false, "displacement of", root, " along its axis");
    else
        add_coordinate(d, own_name(m, 0), true, "angle of", root,
                       " against the upright, counter-clockwise");
    for (int b = 1; b < m->bodies; b++) {
        const bool turns = m->body[b].joint == STANCE_HINGE;
        char against[STANCE_NAME + 40];
        if (m->body[b].joint == STANCE_FIXED)
            continue;
        snprintf(against, sizeof against, " against %s%s", m->body[m->body[b].parent].name,
                 turns ? ", counter-clockwise" : "");
        add_coordinate(d, own_name(m, b), turns, turns ? "angle of" : "displacement of",
                       m->body[b].name, against);
    }
    for (int i = first; i < d->scene.coordinates; i++)
        d->posture[d->scene.postures++] = i;
}

static void add_contacts(struct described *d)
{
    static const char *const ends[2][2] = {{"_heel", "_toe"}, {"_low", "_high"}};
    const stance_mechanism *const m = &d->m;
    stance_contact_place at;
    for (int c = 0; stance_mechanism_contact(m, c, &at); c++) {
        const bool stop = at.element < 0;
        snprintf(d->contact[c], LABEL, "%s%s",
                 stop ? m->body[at.body].name : m->element[at.element].name,
                 stop || m->element[at.element].sole ? ends[stop][at.end] : "");
        d->contact_name[c] = d->contact[c];
        d->grip[c] = stop ? -1 : c - at.end;
        d->scene.contacts++;
    }
}

/* Points, then bodies, as the tables of the tree have them. */
static void add_causes(struct described *d)
{
    const stance_mechanism *const m = &d->m;
    for (int p = 0; p < m->points; p++)
        if (m->point[p].falls)
            d->cause[d->scene.causes++] = m->point[p].name;
    for (int b = 0; b < m->bodies; b++)
        if (m->body[b].bounded && m->body[b].joint != STANCE_FIXED)
            d->cause[d->scene.causes++] = m->body[b].name;
}

stance_error stance_mechanism_scene(const stance_mechanism *m, stance_scene **scene,
                                    stance_message *message)
{
    stance_contact_place place;
    int contacts = 0;
    while (stance_mechanism_contact(m, contacts, &place))
        contacts++;
    if (contacts > STANCE_MAX_CONTACTS)
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "%d contacts, counting both ends of soles and stops: at most %d fit",
                             contacts, STANCE_MAX_CONTACTS);
    if (m->numbers > STANCE_ROBOT_FALL_HEIGHT)
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "%d numbers that may vary: at most %d fit", m->numbers,
                             STANCE_ROBOT_FALL_HEIGHT);
    struct described *const d = calloc(1, sizeof *d);
    if (!d)
        return STANCE_NO_MEMORY;
    d->m = *m;
    d->scene = (stance_scene){
        .name = m->carried ? m->carried->name : "mechanism",
        .text = m->carried ? m->carried->text
                           : "planar tree of rigid bodies, as the scenario describes it",
        .workload = m->carried ? m->carried->workload : NULL,
        .mechanism = &d->m,
        .actuators = m->actuators,
        .robot_count = m->numbers,
        .robot = d->robot,
        .coordinate = d->coordinate,
        .contact_name = d->contact_name,
        .grip = d->grip,
        .cause = d->cause,
        .actuator_name = d->actuator_name,
        .posture = d->posture,
        .actuated = d->actuated,
        .gaps = stance_mechanism_gaps,
        .contact_point = stance_mechanism_contact_point,
        .stand = stance_mechanism_stand,
        .figure = stance_mechanism_figure,
        .fallen = stance_mechanism_fallen,
        .energy = stance_mechanism_energy,
        .inertia = stance_mechanism_inertia,
        .equilibrium = stance_mechanism_equilibrium,
        .linearise = stance_mechanism_linearise,
        .contact_force = stance_mechanism_contact_force,
        .rest = stance_rest_holds,
    };
    d->scene.tree = &d->tree;
    const stance_error error = stance_tree_make(&d->m, &d->tree, message);
    if (error != STANCE_OK) {
        free(d);
        return error;
    }
    for (int i = 0; i < m->numbers; i++)
        describe_number(d, i);
    add_coordinates(d);
    add_contacts(d);
    add_causes(d);
    for (int a = 0; a < m->actuators; a++) {
        d->actuator_name[a] = d->m.actuator[a].name;
        d->actuated[a] = stance_mechanism_coordinate(m, m->actuator[a].body);
    }
    stance_exchange_make(&d->m, &d->scene, &d->scene.exchange);
    *scene = &d->scene;
    return STANCE_OK;
}

void stance_mechanism_defaults(stance_mechanism_numbers *numbers)
{
    for (int b = 0; b < STANCE_MAX_BODIES; b++) {
        numbers->body[b].axis[0] = 1;
        numbers->body[b].limits[0] = -INFINITY;
        numbers->body[b].limits[1] = INFINITY;
        numbers->body[b].turn = INFINITY;
    }
    for (int i = 0; i < STANCE_MAX_NAMED; i++)
        numbers->point[i].lowest = -INFINITY;
    for (int i = 0; i < STANCE_MAX_PLATES; i++) {
        numbers->plate[i].count = INFINITY;
        numbers->plate[i].seed = -1;
        numbers->plate[i].friction_factor = 1;
    }
    for (int i = 0; i < STANCE_MAX_ACTUATORS; i++)
        numbers->limit[i] = INFINITY;
}

void stance_scene_free(stance_scene *scene)
{
    free(scene); /* the first member of a struct described */
}
