/* plane_names.c - names of the file as names of a scenario: letters, digits and _, each once. */
#include "plane_tree.h"

#include <ctype.h>
#include <strings.h>

enum { ROOM = 60 }; /* letters; what numbers and rates add has room, too */

static bool is_word(const char *name)
{
    static const char *const words[] = {"on",   "off", "yes", "no", "y",  "n",     "true",  "false",
                                        "null", "x",   "z",   "vx", "vz", "scale", "branch"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcasecmp(words[i], name) == 0)
            return true;
    return false;
}

/* Is b the same as a, or what the scenario makes of it: a rate, an end of a sole, a stop? */
static bool follows(const char *a, const char *b)
{
    static const char *const ends[] = {"", "_heel", "_toe", "_low", "_high"};
    const size_t length = strlen(a);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (strncmp(a, b, length) == 0 && strcmp(b + length, ends[i]) == 0)
            return true;
    return b[0] == 'v' && strcmp(b + 1, a) == 0;
}

static bool is_taken(const char *a, const char *b)
{
    return follows(a, b) || follows(b, a);
}

/* Of so many bodies, contacts and motors that have names no other one has this, or one that would
 * be mistaken for it. Motors are known by other paths. */
static bool is_free(const stance_mechanism *m, const char *name, int bodies, int elements,
                    int actuators)
{
    bool free = !is_word(name);
    for (int k = 0; k < bodies; k++)
        free = free && !is_taken(m->body[k].name, name);
    for (int e = 0; e < elements; e++)
        free = free && !is_taken(m->element[e].name, name);
    for (int a = 0; a < actuators; a++)
        free = free && strcmp(m->actuator[a].name, name) != 0;
    return free;
}

/* As it is, with `behind` (if any) behind it, else numbered: the first that is free. */
static void settle(const stance_mechanism *m, const char *given, const char *behind, int bodies,
                   int elements, int actuators, char to[STANCE_NAME])
{
    char name[STANCE_NAME] = "n";
    int n = !isalpha((unsigned char)given[0]);
    for (; *given && n < ROOM; given++)
        name[n++] = isalnum((unsigned char)*given) ? *given : '_';
    name[n] = 0;
    snprintf(to, STANCE_NAME, "%s", name);
    for (int i = 1; i < 1000 && !is_free(m, to, bodies, elements, actuators); i++)
        if (i == 1 && behind)
            snprintf(to, STANCE_NAME, "%.58s%s", name, behind);
        else
            snprintf(to, STANCE_NAME, "%.58s_%d", name, i);
}

/* What a name becomes is told of names that somebody gave. */
static void tell(struct plane_tree *t, const char *what, const char *from, const char *to)
{
    if (from[0] && strcmp(from, to) != 0)
        spatial_note(t->model, "%s %.80s is called %s", what, from, to);
}

const char *plane_geom_text(const struct plane_tree *t, const struct spatial_geom *geom,
                            char text[PLANE_TEXT])
{
    const char *const body = geom->body < 0 ? "" : t->model->body[geom->body].name;
    const bool own = strcmp(geom->name, body) != 0 && geom->name[0];
    snprintf(text, PLANE_TEXT, "%s%s%s%s%s", geom->of, own ? " " : "", own ? geom->name : "",
             body[0] ? " of " : "", body);
    return text;
}

void plane_name_bodies(struct plane_tree *t)
{
    stance_mechanism *const m = &t->robot->mechanism;
    for (int k = 0; k < t->links; k++) {
        const struct plane_link *const link = &t->link[k];
        const char *const body = t->model->body[link->body].name;
        const char *const given =
            link->between || !body[0] ? t->model->joint[link->joint].name : body;
        settle(m, given[0] ? given : "link", "_", k, 0, 0, m->body[k].name);
        tell(t, link->between ? "joint" : "body", given, m->body[k].name);
    }
}

void plane_name_contact(struct plane_tree *t, int element, const char *geom)
{
    stance_mechanism *const m = &t->robot->mechanism;
    const char *const body = m->body[m->element[element].body].name;
    char *const name = m->element[element].name;
    settle(m, geom[0] ? geom : body, NULL, m->bodies, element, 0, name);
    /* A number behind the name of a body, which comes first, tells itself. */
    if (strncmp(geom, name, strlen(geom)) != 0)
        tell(t, "shape", geom, name);
}

void plane_name_actuator(struct plane_tree *t, int actuator, const char *joint, const char *own)
{
    stance_mechanism *const m = &t->robot->mechanism;
    const char *const given = joint[0] ? joint : own;
    char *const name = m->actuator[actuator].name;
    settle(m, given[0] ? given : m->body[m->actuator[actuator].body].name, "_", 0, 0, actuator,
           name);
    if (own[0] && strcmp(own, name) != 0)
        spatial_note(t->model, "motors are called as their joints are");
    tell(t, "the motor of joint", joint, name);
}
