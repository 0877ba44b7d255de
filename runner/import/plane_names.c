/* plane_names.c - names of the file as names of a scenario: letters, digits and _, each once. */
#include "plane_tree.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { ROOM = 60 }; /* letters; what numbers and rates add has room, too */

/* A letter, then letters, digits or _. */
static void clean(const char *name, char out[STANCE_NAME])
{
    int n = 0;
    if (!isalpha((unsigned char)name[0]))
        out[n++] = 'n';
    for (; *name && n < ROOM; name++)
        out[n++] = isalnum((unsigned char)*name) ? *name : '_';
    out[n] = 0;
}

static bool is_word(const char *name)
{
    static const char *const words[] = {"on",   "off", "yes", "no", "y",  "n",     "true",  "false",
                                        "null", "x",   "z",   "vx", "vz", "scale", "branch"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcasecmp(words[i], name) == 0)
            return true;
    return false;
}

/* Is b what the scenario makes of a: a rate, an end of a sole, a stop? */
static bool follows(const char *a, const char *b)
{
    static const char *const ends[] = {"_heel", "_toe", "_low", "_high"};
    const size_t length = strlen(a);
    if (b[0] == 'v' && strcmp(b + 1, a) == 0)
        return true;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (strncmp(a, b, length) == 0 && strcmp(b + length, ends[i]) == 0)
            return true;
    return false;
}

static bool clashes(const char *a, const char *b)
{
    return strcmp(a, b) == 0 || follows(a, b) || follows(b, a);
}

static bool is_taken(const stance_mechanism *m, const char *name, int bodies, int elements)
{
    for (int k = 0; k < bodies; k++)
        if (clashes(m->body[k].name, name))
            return true;
    for (int e = 0; e < elements; e++)
        if (clashes(m->element[e].name, name))
            return true;
    return is_word(name);
}

static bool is_actuator(const stance_mechanism *m, const char *name, int actuators)
{
    for (int a = 0; a < actuators; a++)
        if (strcmp(m->actuator[a].name, name) == 0)
            return true;
    return false;
}

/* What a name becomes is told of names that somebody gave. */
static void tell(struct plane_tree *t, const char *what, const char *from, const char *to)
{
    if (strcmp(from, to) != 0)
        spatial_note(t->model, "%s %.80s is called %s", what, from, to);
}

/* As it is, with _ behind, else numbered: the first that is free. */
static void settle(const struct plane_tree *t, bool actuator, int before, const char *given,
                   char to[STANCE_NAME])
{
    const stance_mechanism *const m = &t->robot->mechanism;
    char name[STANCE_NAME];
    clean(given, name);
    snprintf(to, STANCE_NAME, "%s", name);
    for (int i = 1; i < 1000; i++) {
        if (actuator
                ? !is_word(to) && !is_actuator(m, to, before)
                : !is_taken(m, to, before < 0 ? m->bodies : before, before < 0 ? m->elements : 0))
            return;
        if (i == 1 && before >= 0)
            snprintf(to, STANCE_NAME, "%.58s_", name);
        else
            snprintf(to, STANCE_NAME, "%.58s_%d", name, i);
    }
}

void plane_name_bodies(struct plane_tree *t)
{
    stance_mechanism *const m = &t->robot->mechanism;
    for (int k = 0; k < t->links; k++) {
        const struct plane_link *const link = &t->link[k];
        const char *const body = t->model->body[link->body].name, *const joint =
                                                                      t->model->joint[link->joint]
                                                                          .name;
        const char *const given = link->between ? joint : body[0] ? body : joint;
        settle(t, false, k, given[0] ? given : "link", m->body[k].name);
        if (given[0])
            tell(t, link->between ? "joint" : "body", given, m->body[k].name);
    }
}

void plane_name_contact(struct plane_tree *t, int element, const char *geom)
{
    stance_mechanism *const m = &t->robot->mechanism;
    const char *const body = m->body[m->element[element].body].name;
    settle(t, false, -1, geom[0] ? geom : body, m->element[element].name);
    /* A number behind the name of a body, which comes first, tells itself. */
    if (strncmp(geom, m->element[element].name, strlen(geom)) != 0)
        tell(t, "shape", geom, m->element[element].name);
}

void plane_name_actuator(struct plane_tree *t, int actuator, const char *joint, const char *own)
{
    stance_mechanism *const m = &t->robot->mechanism;
    const char *const given = joint[0] ? joint : own;
    settle(t, true, actuator, given[0] ? given : m->body[m->actuator[actuator].body].name,
           m->actuator[actuator].name);
    if (own[0] && strcmp(own, m->actuator[actuator].name) != 0)
        spatial_note(t->model, "motors are called as their joints are");
    if (given != own && given[0])
        tell(t, "the motor of joint", given, m->actuator[actuator].name);
}
