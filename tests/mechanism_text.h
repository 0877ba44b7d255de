/* mechanism_text.h - mechanisms for tests as text, a line for each part, words apart by spaces:
 *
 *   body NAME free|hinge|slide|fixed PARENT mass inertia centre at [KEY number(s)] ...
 *                                       keys: axis angle stiffness damping rest armature limits
 *                                       turn
 *   point|disc|sole NAME BODY at        a disc's radius; a sole's second end [radius]
 *   named NAME BODY at [lowest]
 *   force fx fz from to [frequency]     on the point named last
 *   impulse px pz at                    on the point named last
 *   reference at                        what a free root's x and z are of
 *   actuator NAME BODY limit
 *
 * PARENT of the root: -. A line that begins otherwise ends the mechanism.
 */
#ifndef STANCE_TESTS_MECHANISM_TEXT_H
#define STANCE_TESTS_MECHANISM_TEXT_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"

#include "engine/mechanism.h"

struct words {
    char *line, *save;
};
static inline const char *next_word(struct words *w)
{
    char *word = strtok_r(w->line, " \n", &w->save);
    w->line = NULL;
    return word ? word : "";
}
static inline double next_number(struct words *w)
{
    return strtod(next_word(w), NULL);
}
static inline void next_pair(struct words *w, double pair[2])
{
    pair[0] = next_number(w);
    pair[1] = next_number(w);
}
static inline void next_name(struct words *w, char name[STANCE_NAME])
{
    snprintf(name, STANCE_NAME, "%s", next_word(w));
}
static inline int next_body(struct words *w, const stance_mechanism *m)
{
    const char *name = next_word(w);
    int b = m->bodies - 1;
    while (b >= 0 && strcmp(m->body[b].name, name) != 0)
        b--;
    return b;
}

static inline void body_line(struct words *w, stance_mechanism *m)
{
    static const char *const joints[] = {"free", "hinge", "slide", "fixed"};
    stance_body_numbers *const n = &m->value.body[m->bodies];
    char name[STANCE_NAME];
    next_name(w, name);
    const char *joint = next_word(w);
    int k = 0;
    while (k < STANCE_FIXED && strcmp(joints[k], joint) != 0)
        k++;
    m->body[m->bodies].joint = (stance_joint)k;
    m->body[m->bodies].parent = next_body(w, m);
    memcpy(m->body[m->bodies].name, name, sizeof name);
    n->mass = next_number(w);
    n->inertia = next_number(w);
    next_pair(w, n->centre);
    next_pair(w, n->at);
    n->axis[0] = 1;
    n->limits[0] = -INFINITY, n->limits[1] = n->turn = INFINITY;
    for (const char *key = next_word(w); *key; key = next_word(w))
        if (strcmp(key, "axis") == 0)
            next_pair(w, n->axis);
        else if (strcmp(key, "stiffness") == 0)
            n->stiffness = next_number(w);
        else if (strcmp(key, "damping") == 0)
            n->damping = next_number(w);
        else if (strcmp(key, "rest") == 0)
            n->rest = next_number(w);
        else if (strcmp(key, "armature") == 0)
            n->armature = next_number(w);
        else if (strcmp(key, "limits") == 0)
            next_pair(w, n->limits);
        else if (strcmp(key, "angle") == 0)
            n->angle = next_number(w);
        else if (strcmp(key, "turn") == 0)
            n->turn = next_number(w), m->body[m->bodies].bounded = true;
        else
            abort();
    m->bodies++;
}

/* One line into *m; false: it is none of a mechanism. */
static inline bool mechanism_line(char *line, stance_mechanism *m)
{
    struct words w = {line, NULL};
    const char *kind = next_word(&w);
    if (strcmp(kind, "body") == 0) {
        body_line(&w, m);
    } else if (strcmp(kind, "named") == 0) {
        next_name(&w, m->point[m->points].name);
        m->point[m->points].body = next_body(&w, m);
        next_pair(&w, m->value.point[m->points].at);
        const char *lowest = next_word(&w);
        m->point[m->points].falls = *lowest != 0;
        m->value.point[m->points++].lowest = *lowest ? strtod(lowest, NULL) : -INFINITY;
    } else if (strcmp(kind, "force") == 0 || strcmp(kind, "impulse") == 0) {
        stance_point_numbers *const n = &m->value.point[m->points - 1];
        m->point[m->points - 1].pushed = *kind == 'f' ? STANCE_FORCE : STANCE_IMPULSE;
        next_pair(&w, n->force);
        n->from = next_number(&w);
        n->to = *kind == 'f' ? next_number(&w) : n->from;
        const char *const frequency = next_word(&w);
        m->point[m->points - 1].swings = *frequency != 0;
        n->frequency = *frequency ? strtod(frequency, NULL) : 0;
    } else if (strcmp(kind, "reference") == 0) {
        next_pair(&w, m->value.reference);
    } else if (strcmp(kind, "actuator") == 0) {
        next_name(&w, m->actuator[m->actuators].name);
        m->actuator[m->actuators].body = next_body(&w, m);
        m->value.limit[m->actuators++] = next_number(&w);
    } else if (strcmp(kind, "point") == 0 || strcmp(kind, "disc") == 0 ||
               strcmp(kind, "sole") == 0) {
        stance_element_numbers *const n = &m->value.element[m->elements];
        next_name(&w, m->element[m->elements].name);
        m->element[m->elements].body = next_body(&w, m);
        m->element[m->elements++].sole = *kind == 's';
        next_pair(&w, n->at);
        if (*kind == 's')
            next_pair(&w, n->to);
        const char *const radius = next_word(&w);
        n->radius = *radius ? strtod(radius, NULL) : 0;
    } else {
        return false;
    }
    return true;
}

/* All numbers that a mechanism has into robot[], as long as there is room. */
static inline void mechanism_all_vary(stance_mechanism *m)
{
#define PART(field, count)                                                                         \
    {                                                                                              \
        offsetof(stance_mechanism_numbers, field), (size_t)(count) * sizeof m->value.field[0]      \
    }
    const struct {
        size_t first, size; /* bytes */
    } part[] = {PART(body, m->bodies), PART(element, m->elements), PART(point, m->points),
                PART(reference, 2), PART(limit, m->actuators)};
#undef PART
    m->numbers = 0;
    for (size_t p = 0; p < sizeof part / sizeof part[0]; p++)
        for (size_t i = 0; i < part[p].size && m->numbers < STANCE_ROBOT_FALL_HEIGHT;
             i += sizeof(double))
            m->number[m->numbers++] = (int)((part[p].first + i) / sizeof(double));
}

/* The scene of a text of several lines, without numbers that vary. */
static inline stance_scene *mechanism_scene(const char *text)
{
    static stance_mechanism m;
    char copy[4096], *save = NULL;
    stance_scene *scene;
    memset(&m, 0, sizeof m);
    snprintf(copy, sizeof copy, "%s", text);
    for (char *line = strtok_r(copy, "\n", &save); line; line = strtok_r(NULL, "\n", &save))
        if (!mechanism_line(line, &m))
            abort();
    mechanism_all_vary(&m);
    if (stance_mechanism_scene(&m, &scene, NULL) != STANCE_OK)
        abort();
    return scene;
}

#endif
