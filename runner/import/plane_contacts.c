/* plane_contacts.c - shapes of the file as what may touch the ground: discs, capsules, soles. */
#include "plane_tree.h"
#include "space.h"

#include <stdlib.h>

enum { CORNERS = 8 };

/* What a shape becomes. */
struct candidate {
    int link, line;
    const char *name; /* of the geom */
    bool sole;        /* flat, or with a radius a capsule: two ends */
    bool taken;
    stance_element_numbers number;
    double friction; /* NAN: not given */
};

struct candidates {
    int count;
    struct candidate *list;
};

static bool is_end(const struct plane_tree *t, const struct candidate *c)
{
    return t->link[c->link].children == 0;
}

/* ---- from shapes -------------------------------------------------------------------------------
 */

/* A place of a geom's frame in its link's. */
static void corner(const struct plane_tree *t, const struct spatial_geom *geom, const double at[3],
                   double out[2])
{
    double inner[3];
    space_place(geom->at, geom->rotation, at, inner);
    plane_in_link(t, geom->body, inner, out);
    for (int i = 0; i < 2; i++)
        out[i] = fabs(out[i]) < 1e-14 ? 0 : out[i];
}

/* How a link is turned in the world as the robot begins. */
static double start_turn(const struct plane_tree *t, int k)
{
    int coordinate = t->robot->map.free_root ? 2 : 0;
    double turn = 0;
    bool above[STANCE_MAX_COORDINATES + 1] = {false};
    for (int i = k; i >= 0; i = t->link[i].parent)
        above[i] = true;
    for (int i = 0; i < t->links; i++, coordinate++)
        if (above[i])
            turn += t->robot->mechanism.value.body[i].angle +
                    (t->link[i].kind == STANCE_SLIDE ? 0 : t->robot->start[coordinate]);
    return turn;
}

/* From which to which corner the lowest side goes of a shape that is turned so: of all pairs with
 * no corner below their line, that whose middle is lowest. */
static void lowest_side(const double at[CORNERS][2], double turn, int side[2])
{
    double world[CORNERS][2], least = INFINITY, size = 0;
    for (int i = 0; i < CORNERS; i++) {
        plane_turn(turn, at[i], world[i]);
        size = fmax(size, hypot(world[i][0] - world[0][0], world[i][1] - world[0][1]));
    }
    side[0] = side[1] = 0;
    for (int i = 0; i < CORNERS; i++)
        for (int j = 0; j < CORNERS; j++) {
            const double x = world[j][0] - world[i][0], z = world[j][1] - world[i][1],
                         length = hypot(x, z), middle = world[i][1] + world[j][1];
            bool under = x > 0 && length > 1e-9 * size;
            for (int k = 0; under && k < CORNERS; k++)
                under = x * (world[k][1] - world[i][1]) - z * (world[k][0] - world[i][0]) >
                        -1e-9 * size * length;
            /* Of sides that lie in one line the longest. */
            if (under && (middle < least - 1e-9 * size ||
                          (middle < least + 1e-9 * size &&
                           length > hypot(world[side[1]][0] - world[side[0]][0],
                                          world[side[1]][1] - world[side[0]][1])))) {
                least = middle;
                side[0] = i;
                side[1] = j;
            }
        }
}

/* The lower side of a box as a sole; of one without extent a point. */
static void of_box(struct plane_tree *t, const struct spatial_geom *geom, const double half[3],
                   struct candidate *c)
{
    double at[CORNERS][2];
    int side[2];
    for (int i = 0; i < CORNERS; i++)
        corner(t, geom,
               (const double[]){(i & 1 ? 1 : -1) * half[0], (i & 2 ? 1 : -1) * half[1],
                                (i & 4 ? 1 : -1) * half[2]},
               at[i]);
    lowest_side(at, start_turn(t, c->link), side);
    c->sole = side[0] != side[1];
    memcpy(c->number.at, at[side[0]], sizeof c->number.at);
    memcpy(c->number.to, at[side[1]], sizeof c->number.to);
    if (c->sole)
        spatial_note(t->model, "of boxes and cylinders the lower side touches, as a sole");
}

static bool of_geom(struct plane_tree *t, const struct spatial_geom *geom, struct candidate *c)
{
    const double radius = geom->size[0], half = geom->size[1];
    double axis[3], normal;
    switch (geom->shape) {
    case SPATIAL_SPHERE:
        c->number.radius = radius;
        corner(t, geom, (const double[3]){0}, c->number.at);
        return true;
    case SPATIAL_CAPSULE:
        c->number.radius = radius;
        corner(t, geom, (const double[]){0, 0, -half}, c->number.at);
        corner(t, geom, (const double[]){0, 0, half}, c->number.to);
        c->sole = hypot(c->number.to[0] - c->number.at[0], c->number.to[1] - c->number.at[1]) >
                  1e-6 * (half + radius);
        return true;
    case SPATIAL_CYLINDER:
        space_column(geom->rotation, 2, axis);
        space_turn(t->pose[geom->body].rotation, axis, axis);
        normal = space_dot(axis, t->robot->map.normal);
        if (fabs(normal) < 1 - 1e-6) {
            of_box(t, geom, (const double[]){radius, radius, half}, c);
            return true;
        }
        c->number.radius = radius;
        corner(t, geom, (const double[3]){0}, c->number.at);
        return true;
    case SPATIAL_BOX:
        of_box(t, geom, geom->size, c);
        return true;
    default:
        return false;
    }
}

/* ---- soles that are asked for ------------------------------------------------------------------
 */

/* LINK=X,Z,X,Z in the axes of the link's frame that lie in the plane. */
static bool parse_sole(const struct plane_tree *t, const char *text, int *body, double at[4])
{
    const char *const equals = strchr(text, '=');
    char *end = NULL;
    const char *next = equals ? equals + 1 : text;
    int count = 0;
    *body = -1;
    for (int b = 0; equals && b < t->model->bodies; b++)
        if (strlen(t->model->body[b].name) == (size_t)(equals - text) &&
            strncmp(t->model->body[b].name, text, (size_t)(equals - text)) == 0)
            *body = b;
    while (equals && count < 4) {
        at[count] = strtod(next, &end);
        if (end == next || !isfinite(at[count]))
            break;
        count++;
        next = end + strspn(end, ", ");
    }
    if (count < 4 || *next)
        return plane_refuse(t, 0, "--sole %.60s: write LINK=X,Z,X,Z, m in the link's frame", text);
    if (*body < 0 || t->link_of[*body] < 0)
        return plane_refuse(t, 0, "--sole %.60s: %s", text,
                            *body < 0 ? "there is no link of this name" : "it does not move");
    return true;
}

static bool add_sole(struct plane_tree *t, const char *text, struct candidates *c)
{
    double given[4] = {0};
    int body;
    if (!parse_sole(t, text, &body, given))
        return false;
    /* Which axes of the frame lie in the plane. */
    double up[3];
    space_column(t->pose[body].rotation, 2, up);
    const bool flat = fabs(space_dot(up, t->robot->map.normal)) > 0.7; /* its x and y */
    space_column(t->pose[body].rotation, 0, up);
    const bool across = fabs(space_dot(up, t->robot->map.normal)) > 0.7; /* its y and z */
    struct candidate *const sole = &c->list[c->count++];
    *sole = (struct candidate){.link = t->link_of[body], .name = "", .sole = true, .friction = NAN};
    for (int k = 0; k < 2; k++) {
        double at[3] = {0};
        at[across ? 1 : 0] = given[2 * k];
        at[flat ? 1 : 2] = given[2 * k + 1];
        plane_in_link(t, body, at, k ? sole->number.to : sole->number.at);
    }
    return true;
}

static bool has_sole(const struct candidates *c, int soles, int link)
{
    for (int k = 0; k < soles; k++)
        if (c->list[k].link == link)
            return true;
    return false;
}

/* ---- all of them -------------------------------------------------------------------------------
 */

static double friction_of(const struct plane_tree *t, const struct spatial_geom *geom)
{
    return fmax(geom->friction, t->floor_friction); /* of a number and none the number */
}

static bool is_simple(const struct spatial_geom *geom)
{
    return geom->meets_floor && geom->shape != SPATIAL_OTHER && geom->shape != SPATIAL_PLANE;
}

/* A mesh at the end of a chain is a foot, unless a simple shape is that. */
static bool refuse_shape(struct plane_tree *t, const struct spatial_geom *geom)
{
    const struct spatial_body *const body = &t->model->body[geom->body];
    const int link = t->link_of[geom->body];
    bool foot = t->link[link].children == 0;
    for (int g = 0; g < t->model->geoms; g++) {
        const struct spatial_geom *const other = &t->model->geom[g];
        foot = foot && !(other->body >= 0 && t->link_of[other->body] == link && is_simple(other));
    }
    if (foot)
        return plane_refuse(t, geom->line,
                            "%s %.50s of %.50s may touch the ground: give it a sole, "
                            "--sole %.50s=X,Z,X,Z, or a simple shape",
                            geom->of, geom->name, body->name, body->name);
    spatial_note(t->model, "%s %.50s of %.50s touches nothing here", geom->of, geom->name,
                 body->name);
    return true;
}

/* What moves along a rail cannot leave the ground. */
static bool on_rail(struct plane_tree *t, const struct spatial_geom *geom)
{
    const int link = t->link_of[geom->body];
    if (link != 0 || t->link[link].kind != STANCE_SLIDE)
        return false;
    spatial_note(t->model, "%.60s touches no ground: its rail holds it",
                 t->model->body[geom->body].name);
    return true;
}

static bool gather(struct plane_tree *t, struct candidates *c)
{
    for (size_t s = 0; s < t->wishes->soles; s++)
        if (!add_sole(t, t->wishes->sole[s], c))
            return false;
    const int soles = c->count;
    for (int g = 0; g < t->model->geoms; g++) {
        const struct spatial_geom *const geom = &t->model->geom[g];
        if (geom->body < 0 || t->link_of[geom->body] < 0 || !geom->meets_floor ||
            geom->shape == SPATIAL_PLANE || on_rail(t, geom))
            continue;
        struct candidate *const next = &c->list[c->count];
        *next = (struct candidate){.link = t->link_of[geom->body],
                                   .line = geom->line,
                                   .name = geom->name,
                                   .friction = friction_of(t, geom)};
        if (has_sole(c, soles, next->link))
            spatial_note(t->model, "%s %.60s is left out: --sole stands for it", geom->of,
                         geom->name);
        else if (of_geom(t, geom, next))
            c->count++;
        else if (!refuse_shape(t, geom))
            return false;
    }
    return true;
}

static int stops(const struct plane_tree *t)
{
    int count = 0;
    for (int k = 0; k < t->links; k++)
        for (int side = 0; side < 2; side++)
            count += stance_mechanism_stops(&t->robot->mechanism, k, side);
    return count;
}

/* As many as there is room for, those of the ends of chains first; the others are told. */
static void choose(struct plane_tree *t, struct candidates *c)
{
    char dropped[120] = "";
    int room = STANCE_MAX_CONTACTS - stops(t), elements = STANCE_MAX_ELEMENTS, left = 0;
    for (int ends = 1; ends >= 0; ends--)
        for (int k = 0; k < c->count; k++) {
            struct candidate *const one = &c->list[k];
            const int takes = one->sole ? 2 : 1;
            if (is_end(t, one) != (ends == 1))
                continue;
            one->taken = takes <= room && elements > 0;
            if (one->taken) {
                room -= takes;
                elements--;
            } else {
                add_text(dropped, sizeof dropped, "%s%.30s", left++ ? ", " : "",
                         one->name[0] ? one->name : t->robot->mechanism.body[one->link].name);
            }
        }
    if (left > 0)
        spatial_note(t->model, "%d contacts more than there is room for are left out: %s", left,
                     dropped);
}

/* What most of them have, of as many the first; NAN: none has any. */
static double common_friction(const struct candidates *c)
{
    double best = NAN;
    int most = 0;
    for (int k = 0; k < c->count; k++) {
        int same = 0;
        for (int i = 0; i < c->count; i++)
            same += c->list[i].taken && c->list[i].friction == c->list[k].friction;
        if (c->list[k].taken && same > most) {
            most = same;
            best = c->list[k].friction;
        }
    }
    return best;
}

/* The end that is further back, or lower, is the heel. */
static void sort_ends(struct candidate *c)
{
    const stance_element_numbers n = c->number;
    const double ahead = n.to[0] - n.at[0], up = n.to[1] - n.at[1];
    if (!c->sole || ahead > 1e-12 || (ahead > -1e-12 && up >= 0))
        return;
    memcpy(c->number.at, n.to, sizeof n.to);
    memcpy(c->number.to, n.at, sizeof n.at);
}

static void take(struct plane_tree *t, const struct candidate *c)
{
    stance_mechanism *const m = &t->robot->mechanism;
    const int e = m->elements;
    const double ground = t->robot->friction,
                 factor = isnan(c->friction) || ground == 0 ? 1 : c->friction / ground;
    m->element[e].body = c->link;
    m->element[e].sole = c->sole;
    m->value.element[e] = c->number;
    m->value.element[e].friction_factor = fmin(fmax(factor, 0.01), 100);
    m->element[e].rough = m->value.element[e].friction_factor != 1;
    plane_name_contact(t, e, c->name);
    m->elements++;
    if (factor < 0.01 || factor > 100)
        spatial_note(t->model, "contact %s has %g of the ground's friction, not %g of it",
                     m->element[e].name, m->value.element[e].friction_factor, factor);
}

static void take_friction(struct plane_tree *t, const struct candidates *c)
{
    double friction = common_friction(c);
    for (int k = 0; k < c->count && friction == 0; k++) /* factors are of something */
        if (c->list[k].taken && c->list[k].friction > 0)
            friction = c->list[k].friction;
    if (isnan(friction)) {
        friction = 0.8;
        if (c->count > 0)
            spatial_note(t->model, "no friction is given: 0.8");
    } else if (friction > 10) {
        spatial_note(t->model, "friction is 10 at most, not %g", friction);
        friction = 10;
    }
    t->robot->friction = friction;
}

static void note_robot(struct plane_tree *t)
{
    for (int g = 0; g < t->model->geoms; g++)
        if (t->model->geom[g].meets_robot)
            spatial_note(t->model, "the robot's bodies do not touch each other here");
}

static bool any_touches(const struct plane_tree *t)
{
    for (int k = 0; k < t->links; k++)
        if (t->link[k].touches)
            return true;
    return t->wishes->soles > 0;
}

/* Is there ground to touch? Where the file has none it is level, at its height 0, for what falls.
 */
static bool has_ground(struct plane_tree *t)
{
    const bool falls = t->robot->map.free_root && t->robot->gravity > 0;
    if (!any_touches(t) || t->along_floor)
        return false;
    if (t->has_floor)
        return true;
    if (falls)
        spatial_note(t->model, "the file has no floor: level ground at its height 0");
    else
        spatial_note(t->model, "the file has no floor: nothing touches the ground");
    return falls;
}

bool plane_contacts(struct plane_tree *t)
{
    struct candidates c = {0};
    bool good = true;
    t->robot->friction = 0.8;
    note_robot(t);
    if (!has_ground(t))
        return true;
    c.list = calloc((size_t)t->model->geoms + t->wishes->soles + 1, sizeof *c.list);
    if (!c.list)
        return no_memory(t->message);
    good = gather(t, &c);
    if (good) {
        choose(t, &c);
        take_friction(t, &c);
        for (int k = 0; k < c.count; k++)
            if (c.list[k].taken) {
                sort_ends(&c.list[k]);
                take(t, &c.list[k]);
            }
    }
    free(c.list);
    return good;
}
