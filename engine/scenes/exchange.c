/* exchange.c - which parts of a mechanism take each other's place when the other leg stands. */
#include "engine/scenes/mechanism_pose.h"

#include <string.h>

static bool driven(const stance_mechanism *m, int body)
{
    bool is = false;
    for (int a = 0; a < m->actuators; a++)
        is |= m->actuator[a].body == body;
    return is;
}

/* The next element of a body from e on; m->elements: none. */
static int next_element(const stance_mechanism *m, int body, int e)
{
    while (e < m->elements && m->element[e].body != body)
        e++;
    return e;
}

static int next_child(const stance_mechanism *m, int parent, int b)
{
    while (b < m->bodies && m->body[b].parent != parent)
        b++;
    return b;
}

struct pairs {
    int body[STANCE_MAX_BODIES];
    int elements; /* how many pairs of contacts */
};

/* Pairs the elements of two bodies in their order; false: they differ. */
static bool pair_elements(const stance_mechanism *m, int a, int b, struct pairs *pairs)
{
    int e = next_element(m, a, 0), f = next_element(m, b, 0);
    pairs->body[a] = b, pairs->body[b] = a;
    for (; e < m->elements && f < m->elements;
         e = next_element(m, a, e + 1), f = next_element(m, b, f + 1)) {
        if (m->element[e].sole != m->element[f].sole)
            return false;
        pairs->elements++;
    }
    return e == m->elements && f == m->elements;
}

/* Pairs the subtrees of two bodies, body by body; false: they differ. */
static bool pair(const stance_mechanism *m, int a, int b, struct pairs *pairs)
{
    if (m->body[a].joint != m->body[b].joint || driven(m, a) != driven(m, b))
        return false;
    for (int side = 0; side < 2; side++)
        if (stance_mechanism_stops(m, a, side) != stance_mechanism_stops(m, b, side))
            return false;
    if (!pair_elements(m, a, b, pairs))
        return false;
    int i = next_child(m, a, a + 1), j = next_child(m, b, b + 1);
    for (; i < m->bodies && j < m->bodies; i = next_child(m, a, i + 1), j = next_child(m, b, j + 1))
        if (!pair(m, i, j, pairs))
            return false;
    return i == m->bodies && j == m->bodies;
}

/* Contacts of the first legs and of the others. */
static void write_legs(const stance_mechanism *m, const struct pairs *pairs, const bool *first,
                       stance_exchange *exchange)
{
    stance_contact_place at;
    for (int c = 0; stance_mechanism_contact(m, c, &at) && at.element >= 0; c++)
        if (pairs->body[at.body] != at.body)
            exchange->leg[!first[at.body]] |= 1u << c;
}

/* Legs that hang from one body: coordinates and torques take each other's place. */
static void write_pairs(const stance_mechanism *m, const stance_scene *scene,
                        const struct pairs *pairs, stance_exchange *exchange)
{
    int to[STANCE_MAX_COORDINATES];
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        to[i] = i;
    for (int b = 1; b < m->bodies; b++)
        if (m->body[b].joint != STANCE_FIXED)
            to[stance_mechanism_coordinate(m, b)] = stance_mechanism_coordinate(m, pairs->body[b]);
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        exchange->coordinate[i][i] = 0, exchange->coordinate[i][to[i]] = 1;
    for (int i = 0; i < m->actuators; i++)
        for (int k = 0; k < m->actuators; k++)
            if (scene->actuated[k] == to[scene->actuated[i]])
                exchange->actuator[i] = k;
}

/* A leg that is the root, with the other one on it: the angle of the one is the sum, that between
 * them turns its sign. False: they are no such two. */
static bool write_root(const stance_mechanism *m, const stance_scene *scene,
                       stance_exchange *exchange)
{
    struct pairs pairs = {{0}, 0};
    bool first[STANCE_MAX_BODIES] = {false};
    int leg = -1;
    if (m->body[0].joint != STANCE_FREE)
        return false;
    for (int b = 0; b < m->bodies; b++) {
        pairs.body[b] = b;
        const bool stands = next_element(m, b, 0) < m->elements;
        if (b == 0 || (m->body[b].joint == STANCE_FIXED && !stands))
            continue;
        if (leg >= 0 || m->body[b].joint != STANCE_HINGE || m->body[b].parent != 0)
            return false;
        leg = b;
    }
    if (leg < 0)
        return false;
    if (!pair_elements(m, 0, leg, &pairs) || pairs.elements == 0)
        return false;
    first[0] = true;
    write_legs(m, &pairs, first, exchange);
    const int own = stance_mechanism_coordinate(m, 0), other = stance_mechanism_coordinate(m, leg);
    exchange->coordinate[own][other] = 1;
    exchange->coordinate[other][other] = -1;
    for (int i = 0; i < m->actuators; i++)
        exchange->sign[i] = scene->actuated[i] == other ? -1 : 1;
    return true;
}

static void mark(const stance_mechanism *m, int b, bool *first)
{
    first[b] = true;
    for (int i = next_child(m, b, b + 1); i < m->bodies; i = next_child(m, b, i + 1))
        mark(m, i, first);
}

void stance_exchange_make(const stance_mechanism *m, const stance_scene *scene,
                          stance_exchange *exchange)
{
    bool first[STANCE_MAX_BODIES] = {false};
    struct pairs pairs = {{0}, 0};
    int legs = 0;
    bool several = false;
    memset(exchange, 0, sizeof *exchange);
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        exchange->coordinate[i][i] = 1;
    for (int i = 0; i < STANCE_MAX_ACTUATORS; i++)
        exchange->actuator[i] = i, exchange->sign[i] = 1;
    for (int b = 0; b < STANCE_MAX_BODIES; b++)
        pairs.body[b] = b;
    for (int a = 1; a < m->bodies; a++) {
        int alike = 0;
        struct pairs found = pairs;
        for (int b = 1; b < m->bodies; b++) {
            struct pairs with = pairs;
            if (b == a || m->body[b].parent != m->body[a].parent ||
                m->body[a].joint == STANCE_FIXED || !pair(m, a, b, &with))
                continue;
            alike++;
            found = with;
        }
        if (alike == 0 || pairs.body[a] != a)
            continue;
        several |= alike > 1;
        legs += found.elements > pairs.elements;
        if (found.elements > pairs.elements)
            mark(m, a, first);
        pairs = found;
    }
    exchange->any = legs == 1 && !several;
    if (exchange->any) {
        write_legs(m, &pairs, first, exchange);
        write_pairs(m, scene, &pairs, exchange);
    } else if (legs == 0) {
        exchange->any = write_root(m, scene, exchange);
    }
}
