/* plane_contacts.c - shapes of the file as what may touch the ground: discs, capsules, soles. */
#include "plane_tree.h"
#include "space.h"

#include <stdlib.h>

enum { CORNERS = 8 };

/* What a shape becomes. */
struct candidate {
    int link;
    const char *name; /* of the geom */
    bool sole;        /* flat, or with a radius a capsule: two ends */
    bool taken;
    double complex at, to;   /* of the link's frame */
    double radius, friction; /* NAN: not given */
};

struct candidates {
    int count;
    struct candidate *list;
};

/* Where a place of a link's frame is when the robot begins. */
static double complex as_it_begins(const struct plane_tree *t, int k, double complex place)
{
    static const double origin[3] = {0};
    const struct plane_link *const link = &t->link[k];
    const double turn =
        space_turned(t->start[link->body].rotation) - space_turned(t->pose[link->body].rotation);
    const double complex arm =
        link->at + cexp(I * link->turn) * place - plane_place(t, t->pose, link->body, origin);
    return plane_place(t, t->start, link->body, origin) + cexp(I * turn) * arm;
}

/* ---- from shapes ---------------------------------------------------------------------------- */

/* A place of a geom's frame in its link's. */
static double complex corner(const struct plane_tree *t, const struct spatial_geom *geom, double x,
                             double y, double z)
{
    double inner[3];
    space_place(geom->at, geom->rotation, (const double[]){x, y, z}, inner);
    return plane_in_link(t, geom->body, inner);
}

/* The lower side of a box as a sole; of one without extent a point. As the robot begins: of all
 * pairs of corners with none below their line the one that slopes least, of such the longest. */
static void of_box(struct plane_tree *t, const struct spatial_geom *geom, const double half[3],
                   struct candidate *c)
{
    double complex at[CORNERS], world[CORNERS];
    double level = 0, longest = 0, size = 0;
    for (int i = 0; i < CORNERS; i++) {
        at[i] = corner(t, geom, i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1],
                       i & 4 ? half[2] : -half[2]);
        world[i] = as_it_begins(t, c->link, at[i]);
        size = fmax(size, cabs(world[i] - world[0]));
    }
    c->at = c->to = at[0];
    for (int i = 0; i < CORNERS; i++)
        for (int j = 0; j < CORNERS; j++) {
            const double complex side = world[j] - world[i];
            const double length = cabs(side), way = creal(side) / length;
            bool under = creal(side) > 0 && length > 1e-9 * size;
            for (int k = 0; under && k < CORNERS; k++)
                under = cimag(conj(side) * (world[k] - world[i])) > -1e-9 * size * length;
            if (under && (way > level + 1e-9 || (way > level - 1e-9 && length > longest))) {
                level = way;
                longest = length;
                c->at = at[i];
                c->to = at[j];
            }
        }
    c->sole = longest > 0;
    if (c->sole)
        spatial_note(t->model, "of boxes and cylinders the lower side touches, as a sole");
}

static bool of_geom(struct plane_tree *t, const struct spatial_geom *geom, struct candidate *c)
{
    const double radius = geom->size[0], half = geom->size[1];
    double axis[3];
    space_column(geom->rotation, 2, axis);
    const bool across = fabs(space_dot(t->pose[geom->body].rotation[2], axis)) >= 1 - 1e-6;
    c->at = corner(t, geom, 0, 0, 0);
    c->radius = radius;
    switch (geom->shape) {
    case SPATIAL_SPHERE:
        return true;
    case SPATIAL_CAPSULE:
        c->at = corner(t, geom, 0, 0, -half);
        c->to = corner(t, geom, 0, 0, half);
        c->sole = cabs(c->to - c->at) > 1e-6 * (half + radius);
        return true;
    case SPATIAL_CYLINDER:
        if (across)
            return true;
        c->radius = 0;
        of_box(t, geom, (const double[]){radius, radius, half}, c);
        return true;
    case SPATIAL_BOX:
        c->radius = 0;
        of_box(t, geom, geom->size, c);
        return true;
    default:
        return false;
    }
}

/* LINK=X,Z,X,Z in the axes of the link's frame that lie in the plane. */
static bool add_sole(struct plane_tree *t, const char *text, struct candidates *c)
{
    const size_t length = strcspn(text, "=");
    double given[4];
    int body = t->model->bodies, read = 0;
    if (sscanf(text + length, "=%lf ,%lf ,%lf ,%lf%n", &given[0], &given[1], &given[2], &given[3],
               &read) < 4 ||
        text[length + (size_t)read] || !isfinite(given[0] + given[1] + given[2] + given[3]))
        return plane_refuse(t, 0, "--sole %.60s: write LINK=X,Z,X,Z, m in the link's frame", text);
    while (--body >= 0 && (strlen(t->model->body[body].name) != length ||
                           strncmp(t->model->body[body].name, text, length) != 0))
        ;
    if (body < 0 || t->link_of[body] < 0)
        return plane_refuse(t, 0, "--sole %.60s: %s", text,
                            body < 0 ? "there is no link of this name" : "it does not move");
    if (given[0] == given[2] && given[1] == given[3])
        return plane_refuse(t, 0, "--sole %.60s: its two ends are one place", text);
    /* Which of its axes are across the plane: z (then x and y are in it), x, else y. */
    const double *const across = t->pose[body].rotation[2];
    const int first = fabs(across[0]) > 0.7 ? 1 : 0, second = fabs(across[2]) > 0.7 ? 1 : 2;
    double at[2][3] = {{0}};
    for (int k = 0; k < 2; k++) {
        at[k][first] = given[2 * k];
        at[k][second] = given[2 * k + 1];
    }
    c->list[c->count++] = (struct candidate){.link = t->link_of[body],
                                             .name = "",
                                             .sole = true,
                                             .at = plane_in_link(t, body, at[0]),
                                             .to = plane_in_link(t, body, at[1]),
                                             .friction = NAN};
    return true;
}

/* ---- all of them ---------------------------------------------------------------------------- */

/* A mesh at the end of a chain is a foot, unless a simple shape is that. */
static bool refuse_shape(struct plane_tree *t, const struct spatial_geom *geom)
{
    const char *const body = t->model->body[geom->body].name;
    const int link = t->link_of[geom->body];
    char text[PLANE_TEXT];
    bool foot = t->link[link].children == 0;
    for (int g = 0; g < t->model->geoms; g++) {
        const struct spatial_geom *const other = &t->model->geom[g];
        foot = foot && (other->body < 0 || t->link_of[other->body] != link || !other->meets_floor ||
                        other->shape == SPATIAL_OTHER || other->shape == SPATIAL_PLANE);
    }
    if (foot)
        return plane_refuse(t, geom->line,
                            "%s may touch the ground: give it a sole, "
                            "--sole %s=X,Z,X,Z, or a simple shape",
                            plane_geom_text(t, geom, text), body);
    spatial_note_of(t->model, "touch nothing here", plane_geom_text(t, geom, text));
    return true;
}

/* A shape that may touch, but for what moves along a rail, which cannot leave the ground. */
static bool add_geom(struct plane_tree *t, const struct spatial_geom *geom, int soles,
                     struct candidates *c)
{
    const int link = t->link_of[geom->body];
    char text[PLANE_TEXT];
    struct candidate *const next = &c->list[c->count];
    if (link == 0 && t->link[0].kind == STANCE_SLIDE) {
        spatial_note(t->model, "%.60s touches no ground: its rail holds it",
                     t->model->body[geom->body].name);
        return true;
    }
    for (int k = 0; k < soles; k++)
        if (c->list[k].link == link) {
            spatial_note_of(t->model, "left out, as --sole stands for them",
                            plane_geom_text(t, geom, text));
            return true;
        }
    *next = (struct candidate){
        .link = link,
        .name = geom->name,
        .friction = fmax(geom->friction, t->floor_friction), /* of a number and none the number */
    };
    if (!of_geom(t, geom, next))
        return refuse_shape(t, geom);
    c->count++;
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
        if (geom->body >= 0 && t->link_of[geom->body] >= 0 && geom->meets_floor &&
            geom->shape != SPATIAL_PLANE && !add_geom(t, geom, soles, c))
            return false;
    }
    return true;
}

/* As many as there is room for, those of the ends of chains first; the others are told. */
static void choose(struct plane_tree *t, struct candidates *c)
{
    int room = STANCE_MAX_CONTACTS, elements = STANCE_MAX_ELEMENTS;
    for (int k = 0; k < 2 * t->links; k++)
        room -= stance_mechanism_stops(&t->robot->mechanism, k / 2, k % 2);
    for (int n = 0; n < 2 * c->count; n++) {
        struct candidate *const one = &c->list[n % c->count];
        const int takes = one->sole ? 2 : 1;
        if ((t->link[one->link].children == 0) != (n < c->count))
            continue;
        one->taken = takes <= room && elements > 0;
        room -= one->taken ? takes : 0;
        elements -= one->taken;
        if (!one->taken)
            spatial_note_of(t->model, "contacts more than there is room for are left out",
                            one->name[0] ? one->name : t->robot->mechanism.body[one->link].name);
    }
}

/* What most of them have, of as many the first; but not 0, where another has any, as factors are of
 * something. */
static void take_friction(struct plane_tree *t, const struct candidates *c)
{
    double friction = NAN;
    int most = 0;
    for (int k = 0; k < c->count; k++) {
        int same = 0;
        for (int i = 0; i < c->count; i++)
            same += c->list[i].taken && c->list[i].friction == c->list[k].friction;
        if (c->list[k].taken && same > most) {
            most = same;
            friction = c->list[k].friction;
        }
    }
    for (int k = 0; k < c->count && friction == 0; k++)
        if (c->list[k].taken && c->list[k].friction > 0)
            friction = c->list[k].friction;
    if (friction > 10)
        spatial_note(t->model, "friction is 10 at most, not %g", friction);
    else if (isnan(friction) && c->count > 0)
        spatial_note(t->model, "no friction is given: 0.8");
    t->robot->friction = isnan(friction) ? 0.8 : fmin(friction, 10);
}

static void take(struct plane_tree *t, const struct candidate *c)
{
    stance_mechanism *const m = &t->robot->mechanism;
    const int e = m->elements;
    const double ground = t->robot->friction,
                 factor = isnan(c->friction) || ground == 0 ? 1 : c->friction / ground;
    const double complex way =
        c->to - c->at; /* the end that is further back, or lower, is the heel */
    const bool turned =
        c->sole && !(creal(way) > 1e-12 || (creal(way) > -1e-12 && cimag(way) >= 0));
    stance_element_numbers *const number = &m->value.element[e];
    m->element[e].body = c->link;
    m->element[e].sole = c->sole;
    plane_put(turned ? c->to : c->at, number->at);
    plane_put(turned ? c->at : c->to, number->to);
    number->radius = c->radius;
    number->friction_factor = fmin(fmax(factor, 0.01), 100);
    m->element[e].rough = number->friction_factor != 1;
    plane_name_contact(t, e, c->name);
    m->elements++;
    if (factor < 0.01 || factor > 100)
        spatial_note(t->model, "contact %s has %g of the ground's friction, not %g of it",
                     m->element[e].name, number->friction_factor, factor);
}

/* Out of the ground, straight up. */
static void raise_start(struct plane_tree *t, const struct candidates *c)
{
    double lowest = 0;
    for (int k = 0; k < c->count; k++)
        for (int end = 0; c->list[k].taken && end < (c->list[k].sole ? 2 : 1); end++) {
            const double complex at =
                as_it_begins(t, c->list[k].link, end ? c->list[k].to : c->list[k].at);
            lowest = fmin(lowest, cimag(cexp(I * t->robot->slope) * at) - c->list[k].radius);
        }
    if (lowest > -1e-12)
        return;
    if (!t->robot->map.free_root) {
        spatial_note(t->model, "it begins %.6g m inside the ground", -lowest);
        return;
    }
    t->robot->start[1] -= lowest / cos(t->robot->slope);
    spatial_note(t->model, "it began %.6g m inside the ground: raised by as much", -lowest);
}

/* Is there ground to touch? Where the file has none it is level, at its height 0, for what falls.
 */
static bool has_ground(struct plane_tree *t)
{
    const bool falls = t->robot->map.free_root && t->robot->gravity > 0;
    bool touches = t->wishes->soles > 0;
    for (int k = 0; k < t->links; k++)
        touches = touches || t->link[k].touches;
    if (!touches && !t->along_floor && (falls || t->has_floor))
        spatial_note(t->model, "no shape may touch the ground; --sole LINK=X,Z,X,Z gives one");
    if (!touches || t->along_floor || t->has_floor)
        return touches && t->has_floor;
    spatial_note(t->model, "the file has no floor: %s",
                 falls ? "level ground at its height 0" : "nothing touches the ground");
    return falls;
}

bool plane_contacts(struct plane_tree *t)
{
    struct candidates c = {0};
    t->robot->friction = 0.8;
    for (int g = 0; g < t->model->geoms; g++)
        if (t->model->geom[g].meets_robot)
            spatial_note(t->model, "the robot's bodies do not touch each other here");
    if (!has_ground(t)) {
        if (t->wishes->soles > 0)
            spatial_note(t->model, "there is no ground here: --sole is left out");
        return true;
    }
    c.list = spatial_room((size_t)t->model->geoms + t->wishes->soles, sizeof *c.list);
    const bool good = gather(t, &c);
    if (good) {
        choose(t, &c);
        take_friction(t, &c);
        for (int k = 0; k < c.count; k++)
            if (c.list[k].taken)
                take(t, &c.list[k]);
        raise_start(t, &c);
    }
    free(c.list);
    return good;
}
