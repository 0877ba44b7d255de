/* tree.c - tables and numbers of a mechanism, for kernels: see tree.h and scenes/tree_lanes.h.
 *
 * Lumping: body b of mass m, inertia J about its centre c (in the frame of the angle i that carries
 * it) adds m c to k_i and J + m |c|^2 to I_i; all that hangs on a joint at d in frame j, of mass
 * m', adds m' d to k_j and m' |d|^2 to I_j. A geared rotor's inertia is added to both diagonals.
 *
 * Curvature (for Newton's stop rule, scene_curvature): a correction d of the velocities leaves an
 * error with |e_i| <= K h |d|_1 (|d|_1 + shift), K = max(K1, K2),
 *
 *   K1 sqrt(a) = theta^2 ( 2 sqrt I' + max_j sqrt(I'_j / a_j) sqrt max(M, I_j) ) + sqrt M r
 *   K2 sqrt(a) = theta^2 M r / sqrt(min a_j) sqrt(a)
 *
 * with a_p, a_j what a coordinate resists with in the worst posture (from below), a their least,
 * I'_j = I_j less the own inertia, I' the largest, r the longest arm to a contact. For a body of
 * mass m, inertia J, centre c off its joint, m_e the mass that its joint resists with,
 *
 *   a_p = sum over bodies at the base of m J / (J + m c^2),      a_j = J + c^2 m m_e / (m + m_e),
 *   1 / m_e = 1 / m_P + r_P^2 / J_P  of the parent, infinite where it is pinned.
 */
#include "tree.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- frames ---------------------------------------------------------------------------------- */

/* Which angle carries each body, and where in its frame the body's own is. */
struct frames {
    int of[STANCE_MAX_BODIES]; /* -1: the base */
    double at[STANCE_MAX_BODIES][2];
    int body[STANCE_MAX_ANGLES]; /* that turns */
    int angles;
};

static void frames_make(const stance_mechanism *m, const stance_mechanism_numbers *v,
                        struct frames *f)
{
    f->angles = 0;
    for (int b = 0; b < m->bodies; b++) {
        const int parent = m->body[b].parent;
        const stance_joint joint = m->body[b].joint;
        const double *const at = v->body[b].at;
        for (int k = 0; k < 2; k++)
            f->at[b][k] = joint == STANCE_FIXED ? f->at[parent][k] + at[k] : 0;
        if (joint == STANCE_FIXED) {
            f->of[b] = f->of[parent];
        } else if (joint == STANCE_SLIDE) {
            f->of[b] = -1;
        } else {
            f->of[b] = f->angles;
            if (f->angles < STANCE_MAX_ANGLES)
                f->body[f->angles] = b;
            f->angles++;
        }
    }
}

/* The joint of an angle in the frame above, or (no angle is above) in the base's. */
static void frames_joint(const stance_mechanism *m, const stance_mechanism_numbers *v,
                         const struct frames *f, int angle, double joint[2])
{
    const int b = f->body[angle], parent = m->body[b].parent;
    const bool free = m->body[0].joint == STANCE_FREE;
    for (int k = 0; k < 2; k++) {
        joint[k] = parent < 0 ? (free ? 0 : v->body[b].at[k]) : f->at[parent][k] + v->body[b].at[k];
        if (parent >= 0 && f->of[parent] < 0)
            joint[k] += v->body[0].at[k]; /* of the rail's origin */
    }
}

/* ---- lumps ----------------------------------------------------------------------------------- */

struct lumps {
    double mass, base; /* of all; of what slides without turning */
    double own_mass[STANCE_MAX_ANGLES], own_centre[STANCE_MAX_ANGLES][2],
        own_inertia[STANCE_MAX_ANGLES]; /* of a frame's bodies together, about their centre */
    double moment[STANCE_MAX_ANGLES][2], inertia[STANCE_MAX_ANGLES], joint[STANCE_MAX_ANGLES][2];
};

static int above(const stance_mechanism *m, const struct frames *f, int angle)
{
    const int parent = m->body[f->body[angle]].parent;
    return parent < 0 ? -1 : f->of[parent];
}

static double squared(const double v[2])
{
    return v[0] * v[0] + v[1] * v[1];
}

static void lumps_make(const stance_mechanism *m, const stance_mechanism_numbers *v,
                       const struct frames *f, struct lumps *l)
{
    double beyond[STANCE_MAX_ANGLES] = {0};
    memset(l, 0, sizeof *l);
    for (int b = 0; b < m->bodies; b++) {
        const stance_body_numbers *const body = &v->body[b];
        const int i = f->of[b];
        l->mass += body->mass;
        if (i < 0) {
            l->base += body->mass;
            continue;
        }
        const double c[2] = {f->at[b][0] + body->centre[0], f->at[b][1] + body->centre[1]};
        l->own_mass[i] += body->mass;
        l->own_inertia[i] += body->inertia + body->mass * squared(c); /* about the joint, so far */
        for (int k = 0; k < 2; k++)
            l->moment[i][k] += body->mass * c[k];
    }
    for (int i = 0; i < f->angles; i++) {
        beyond[i] = l->own_mass[i];
        l->inertia[i] = l->own_inertia[i];
        for (int k = 0; k < 2; k++)
            l->own_centre[i][k] = l->own_mass[i] > 0 ? l->moment[i][k] / l->own_mass[i] : 0;
        frames_joint(m, v, f, i, l->joint[i]);
    }
    /* The parallel axes' theorem, without the rounding of a difference that is zero. */
    for (int i = 0; i < f->angles; i++) {
        l->own_inertia[i] = 0;
        for (int b = 0; b < m->bodies; b++) {
            if (f->of[b] != i)
                continue;
            const double d[2] = {f->at[b][0] + v->body[b].centre[0] - l->own_centre[i][0],
                                 f->at[b][1] + v->body[b].centre[1] - l->own_centre[i][1]};
            l->own_inertia[i] += v->body[b].inertia + v->body[b].mass * squared(d);
        }
    }
    for (int i = f->angles - 1; i >= 0; i--) {
        const int j = above(m, f, i);
        if (j < 0)
            continue;
        beyond[j] += beyond[i];
        for (int k = 0; k < 2; k++)
            l->moment[j][k] += beyond[i] * l->joint[i][k];
        l->inertia[j] += beyond[i] * squared(l->joint[i]);
    }
    for (int b = 0; b < m->bodies; b++) {
        const int i = f->of[b];
        if (m->body[b].joint == STANCE_FIXED || i < 0)
            continue;
        const int j = above(m, f, i);
        l->inertia[i] += v->body[b].armature;
        if (j >= 0)
            l->inertia[j] += v->body[b].armature;
    }
}

/* The coefficients of theta^2 in K1, of 1 in K1, of theta^2 in K2. */
static void lumps_curvature(const stance_mechanism *m, const struct frames *f,
                            const struct lumps *l, double arm, double out[3])
{
    const bool free = m->body[0].joint == STANCE_FREE, rail = m->body[0].joint == STANCE_SLIDE;
    double hub = rail ? l->base : 0, least = INFINITY, least_angle = INFINITY;
    double most = l->mass, others = 0, share = 0;
    for (int i = 0; i < f->angles; i++) {
        const int j = above(m, f, i);
        const double mass = l->own_mass[i], inertia = l->own_inertia[i];
        const double c2 = squared(l->own_centre[i]);
        double held = j < 0 ? (free ? 0 : rail ? l->base : INFINITY) : 0;
        if (j >= 0 && l->own_mass[j] > 0) {
            const double d[2] = {l->joint[i][0] - l->own_centre[j][0],
                                 l->joint[i][1] - l->own_centre[j][1]};
            const bool pinned = above(m, f, j) < 0 && !free;
            const double yields = (pinned ? 0 : 1 / l->own_mass[j]) +
                                  (squared(d) > 0 ? squared(d) / l->own_inertia[j] : 0);
            held = 1 / yields;
        }
        const bool at_base = free && (j < 0 || (above(m, f, j) < 0 && squared(l->joint[i]) == 0));
        if (at_base && inertia + mass * c2 > 0)
            hub += mass * inertia / (inertia + mass * c2);
        const double with = isinf(held) ? mass : mass + held > 0 ? mass * held / (mass + held) : 0;
        const double resists = inertia + c2 * with;
        least_angle = fmin(least_angle, resists);
        most = fmax(most, l->inertia[i]);
        others = fmax(others, l->inertia[i] - inertia);
        share = fmax(share, (l->inertia[i] - inertia) / resists);
    }
    least = m->body[0].joint == STANCE_HINGE ? least_angle : fmin(hub, least_angle);
    /* Where nothing resists in some posture there is no bound; then one for what nearly nothing
     * resists. */
    least = fmax(least, 1e-6 * most);
    least_angle = fmax(least_angle, 1e-6 * most);
    share = fmin(share, 1e6);
    out[0] = (2 * sqrt(others) + sqrt(share) * sqrt(most)) / sqrt(least);
    out[1] = sqrt(l->mass) * arm / sqrt(least);
    out[2] = l->mass * arm / sqrt(least_angle) / sqrt(least);
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* Numbers that differ from zero wherever a case's may. */
static void typical(const stance_mechanism *m, stance_mechanism_numbers *v)
{
    *v = m->value;
    for (int i = 0; i < m->numbers; i++)
        if (m->varies[i])
            ((double *)v)[m->number[i]] = 0.5 + 0.7548776662466927 * i;
}

/* The arms from the root to the point `own` in the frame of `body`; returns the first frame. */
static int path_make(const stance_tree *tree, const struct lumps *l, int body, const double own[2],
                     int *path)
{
    int next = STANCE_TREE_OWN, top = -1;
    for (int j = 0; j < STANCE_MAX_ANGLES; j++)
        path[j] = -1;
    for (int j = body; j >= 0; j = tree->above[j]) {
        if (squared(next == STANCE_TREE_OWN ? own : l->joint[next]) != 0)
            path[j] = next;
        top = next = j;
    }
    return tree->base < 2 ? top : -1;
}

static stance_error refuse(stance_message *message, const char *what, int limit)
{
    if (message)
        snprintf(message->text, sizeof message->text, "a mechanism has at most %d %s", limit, what);
    return STANCE_BAD_ARGUMENT;
}

static void tables_couple(const stance_mechanism *m, const struct frames *f, const struct lumps *l,
                          stance_tree *tree)
{
    const int n = tree->angles;
    for (int i = 0; i < n; i++) {
        int from = i;
        for (int j = tree->above[i]; j >= 0; from = j, j = tree->above[j]) {
            tree->through[i][j] = from;
            tree->coupled[i][j] = squared(l->joint[from]) != 0;
            tree->near[i][j] = tree->coupled[i][j];
        }
        if (tree->above[i] >= 0 && m->value.body[f->body[i]].armature != 0)
            tree->near[i][tree->above[i]] = 1;
    }
    for (int k = 0; k < tree->springs; k++)
        if (tree->spring[k] >= 0 && tree->above[tree->spring[k]] >= 0)
            tree->near[tree->spring[k]][tree->above[tree->spring[k]]] = 1;
    for (int k = 0; k < tree->rotors; k++)
        if (tree->rotor[k] >= 0 && tree->above[tree->rotor[k]] >= 0)
            tree->near[tree->rotor[k]][tree->above[tree->rotor[k]]] = 1;
    for (int i = n - 1; i >= 0; i--) /* what eliminating i fills in */
        for (int j = 0; j < i; j++)
            for (int k = 0; k < j; k++)
                if (tree->near[i][j] && tree->near[i][k])
                    tree->near[j][k] = 1;
}

/* Adds a contact at a point of its frame; false: there is no room. */
static bool add_contact(stance_tree *tree, const struct lumps *l, int kind, int body,
                        const double own[2], int other, int grip)
{
    const int c = tree->contacts;
    if (c == STANCE_MAX_CONTACTS)
        return false;
    tree->kind[c] = kind;
    tree->body[c] = body;
    tree->straight_end[c] = own[0] == 0;
    tree->other[c] = other;
    tree->grip[c] = grip;
    tree->top[c] = path_make(tree, l, kind >= STANCE_TREE_LOW ? -1 : body, own, tree->path[c]);
    if (kind == STANCE_TREE_DISC || (kind == STANCE_TREE_SOLE && squared(own) == 0))
        tree->path[c][body] = STANCE_TREE_OWN; /* friction has an arm, whatever the centre's */
    for (int j = 0; j < STANCE_MAX_ANGLES; j++)
        tree->carries[j] |= tree->path[c][j] >= 0;
    tree->contacts++;
    return true;
}

static bool tables_contacts(const stance_mechanism *m, const stance_mechanism_numbers *v,
                            const struct frames *f, const struct lumps *l, stance_tree *tree)
{
    static const double none[2] = {0, 0};
    bool fits = true;
    for (int e = 0; e < m->elements; e++) {
        const int b = m->element[e].body, c = tree->contacts, body = f->of[b];
        const stance_element_numbers *const at = &v->element[e];
        double end[2][2];
        for (int k = 0; k < 2; k++)
            end[0][k] = f->at[b][k] + at->at[k], end[1][k] = f->at[b][k] + at->to[k];
        const int kind = m->element[e].sole ? STANCE_TREE_SOLE
                         : at->radius != 0  ? STANCE_TREE_DISC
                                            : STANCE_TREE_POINT;
        fits = fits && add_contact(tree, l, kind, body, end[0], m->element[e].sole ? c + 1 : -1, c);
        if (m->element[e].sole)
            fits = fits && add_contact(tree, l, kind, body, end[1], c, c);
    }
    for (int b = 0; b < m->bodies; b++) {
        for (int side = 0; side < 2; side++)
            if (stance_mechanism_stops(m, b, side))
                fits = fits && add_contact(tree, l, side ? STANCE_TREE_HIGH : STANCE_TREE_LOW,
                                           f->of[b], none, -1, -1);
    }
    return fits;
}

/* Where the elimination of a contact's load has to do anything. */
static void tables_loads(stance_tree *tree)
{
    for (int c = 0; c < tree->contacts; c++) {
        int *const loads = tree->loads[c];
        const int body = tree->body[c];
        for (int j = 0; j < STANCE_MAX_ANGLES; j++)
            loads[j] = tree->path[c][j] >= 0 ? 0 : -1;
        if (tree->kind[c] >= STANCE_TREE_LOW && body >= 0) {
            loads[body] = 0;
            if (tree->above[body] >= 0)
                loads[tree->above[body]] = 0;
        }
        for (int i = tree->angles - 1; i >= 0; i--)
            for (int j = 0; j < i && loads[i] >= 0; j++)
                if (tree->near[i][j])
                    loads[j] = 0;
    }
}

stance_error stance_tree_make(const stance_mechanism *m, stance_tree *tree, stance_message *message)
{
    stance_mechanism_numbers v;
    struct frames f;
    struct lumps l;
    memset(tree, 0, sizeof *tree);
    for (int c = 0; c < STANCE_MAX_CONTACTS; c++) { /* of none: a stop that never closes */
        tree->kind[c] = STANCE_TREE_LOW;
        tree->body[c] = tree->other[c] = tree->grip[c] = tree->top[c] = -1;
        for (int j = 0; j < STANCE_MAX_ANGLES; j++)
            tree->path[c][j] = tree->loads[c][j] = -1;
    }
    typical(m, &v);
    frames_make(m, &v, &f);
    if (f.angles > STANCE_MAX_ANGLES)
        return refuse(message, "bodies that turn", STANCE_MAX_ANGLES);
    lumps_make(m, &v, &f, &l);
    tree->base = m->body[0].joint == STANCE_FREE ? 2 : m->body[0].joint == STANCE_SLIDE;
    tree->angles = f.angles;
    for (int i = 0; i < f.angles; i++) {
        tree->above[i] = above(m, &f, i);
        tree->straight[i] = l.moment[i][0] == 0;
        tree->straight_joint[i] = l.joint[i][0] == 0;
        for (int j = 0; j < STANCE_MAX_ANGLES; j++)
            tree->through[i][j] = -1;
    }
    for (int b = 0; b < m->bodies; b++) {
        const stance_body_numbers *const body = &v.body[b];
        if (m->body[b].joint == STANCE_FIXED)
            continue;
        if (body->stiffness != 0 || body->damping != 0)
            tree->spring[tree->springs++] = f.of[b];
        if (body->armature != 0)
            tree->rotor[tree->rotors++] = f.of[b];
        if (m->body[b].bounded)
            tree->turning[tree->turns++] = f.of[b];
    }
    for (int i = 0; i < m->actuators; i++)
        tree->actuator[tree->actuators++] = f.of[m->actuator[i].body];
    if (!tables_contacts(m, &v, &f, &l, tree))
        return refuse(message, "contacts (a sole has two, a limit of a joint is one)",
                      STANCE_MAX_CONTACTS);
    for (int p = 0; p < m->points; p++) {
        const int b = m->point[p].body;
        const double own[2] = {f.at[b][0] + v.point[p].at[0], f.at[b][1] + v.point[p].at[1]};
        if (!m->point[p].falls)
            continue;
        tree->point_top[tree->points] =
            path_make(tree, &l, f.of[b], own, tree->point_path[tree->points]);
        tree->points++;
    }
    for (int p = 0; p < m->points; p++) {
        const int b = m->point[p].body;
        const double own[2] = {f.at[b][0] + v.point[p].at[0], f.at[b][1] + v.point[p].at[1]};
        if (m->point[p].pushed == STANCE_NO_PUSH)
            continue;
        if (tree->pushes == STANCE_MAX_PUSHES)
            return refuse(message, "points that are pushed", STANCE_MAX_PUSHES);
        tree->push_impulse[tree->pushes] = m->point[p].pushed == STANCE_IMPULSE;
        path_make(tree, &l, f.of[b], own, tree->push_path[tree->pushes++]);
    }
    tables_couple(m, &f, &l, tree);
    tables_loads(tree);
    return STANCE_OK;
}

/* ---- tables as text -------------------------------------------------------------------------- */

static void write(char **end, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void write(char **end, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    *end += vsprintf(*end, format, arguments); // NOLINT: room is counted, see STANCE_TREE_TEXT
    va_end(arguments);
}

static void write_row(char **end, const int *row, int n)
{
    for (int i = 0; i < n; i++)
        write(end, "%s%d", i ? ", " : "{", row[i]);
    write(end, n ? "}" : "{0}");
}

static void write_list(char **end, const char *name, const int *list, int n)
{
    write(end, "static const int %s[] = ", name);
    write_row(end, list, n);
    write(end, ";\n");
}

static void write_table(char **end, const char *name, int rows, int columns,
                        const int table[][STANCE_MAX_ANGLES])
{
    write(end, "static const int %s[][%d] = {", name, TREE_SLOTS(columns));
    for (int i = 0; i < TREE_SLOTS(rows); i++) {
        write(end, i ? ", " : "");
        write_row(end, table[i], columns);
    }
    write(end, "};\n");
}

void stance_tree_text(const stance_tree *t, bool servos, char text[STANCE_TREE_TEXT])
{
    char *end = text;
    const struct {
        const char *name;
        int value;
    } count[] = {{"BASE", t->base},         {"ANGLES", t->angles},
                 {"CONTACTS", t->contacts}, {"ACTUATORS", t->actuators},
                 {"SPRINGS", t->springs},   {"ROTORS", t->rotors},
                 {"POINTS", t->points},     {"TURNS", t->turns},
                 {"PUSHES", t->pushes},     {"SERVOS", servos && t->actuators > 0}};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++)
        write(&end, "#define TREE_%s %d\n", count[i].name, count[i].value);
    write_list(&end, "tree_above", t->above, t->angles);
    write_list(&end, "tree_straight", t->straight, t->angles);
    write_list(&end, "tree_straight_joint", t->straight_joint, t->angles);
    write_list(&end, "tree_straight_end", t->straight_end, t->contacts);
    write_list(&end, "tree_carries", t->carries, t->angles);
    write_list(&end, "tree_kind", t->kind, t->contacts);
    write_list(&end, "tree_body", t->body, t->contacts);
    write_list(&end, "tree_other", t->other, t->contacts);
    write_list(&end, "scene_grip", t->grip, t->contacts);
    write_list(&end, "tree_top", t->top, t->contacts);
    write_list(&end, "tree_point_top", t->point_top, t->points);
    write_list(&end, "tree_actuator", t->actuator, t->actuators);
    write_list(&end, "tree_spring", t->spring, t->springs);
    write_list(&end, "tree_rotor", t->rotor, t->rotors);
    write_list(&end, "tree_push_impulse", t->push_impulse, t->pushes);
    write_list(&end, "tree_turning", t->turning, t->turns);
    write_table(&end, "tree_coupled", t->angles, t->angles, t->coupled);
    write_table(&end, "tree_near", t->angles, t->angles, t->near);
    write_table(&end, "tree_through", t->angles, t->angles, t->through);
    write_table(&end, "tree_path", t->contacts, t->angles, t->path);
    write_table(&end, "tree_loads", t->contacts, t->angles, t->loads);
    write_table(&end, "tree_push_path", t->pushes, t->angles, t->push_path);
    write_table(&end, "tree_point_path", t->points, t->angles, t->point_path);
    write(&end, "#include \"engine/scenes/tree_lanes.h\"\n");
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* Longest of the arms between a contact and the frames on its way. */
static double longest_arm(const stance_tree *tree, const struct lumps *l, int c,
                          const double end[2])
{
    double longest = 0;
    for (int j = 0; j < tree->angles; j++) {
        const int next = tree->path[c][j];
        if (next >= 0)
            longest = fmax(longest, hypot(next == STANCE_TREE_OWN ? end[0] : l->joint[next][0],
                                          next == STANCE_TREE_OWN ? end[1] : l->joint[next][1]));
    }
    return longest;
}

/* Numbers of contacts, in the order of tables_contacts; returns the longest arm. */
static double number_contacts(const stance_tree *tree, const stance_mechanism *m,
                              const stance_mechanism_numbers *v, const struct frames *f,
                              const struct lumps *l, double slope, double (*end)[3])
{
    double arm = 0;
    int c = 0;
    for (int e = 0; e < m->elements; e++) {
        const stance_element_numbers *const at = &v->element[e];
        const double *const frame = f->at[m->element[e].body];
        for (int side = 0; side < 1 + m->element[e].sole; side++, c++) {
            for (int k = 0; k < 2; k++)
                end[c][k] = frame[k] + (side ? at->to[k] : at->at[k]);
            end[c][2] = m->element[e].sole ? 0 : at->radius;
            arm = fmax(arm, longest_arm(tree, l, c, end[c]) + end[c][2]);
        }
    }
    for (int b = 0; b < m->bodies; b++) {
        const bool upright = f->of[b] >= 0 && tree->above[f->of[b]] < 0;
        for (int side = 0; side < 2; side++)
            if (stance_mechanism_stops(m, b, side))
                end[c++][0] = v->body[b].limits[side] + (upright ? slope : 0);
    }
    return arm;
}

void stance_tree_numbers_make(const stance_tree *tree, const stance_mechanism *m,
                              const double *robot, stance_tree_numbers *number)
{
    stance_mechanism_numbers v;
    struct frames f;
    struct lumps l;
    const double g = robot[STANCE_ROBOT_GRAVITY], slope = robot[STANCE_ROBOT_SLOPE];
    double sine, cosine;
    *number = (stance_tree_numbers){0};
    stance_mechanism_expand(m, robot, &v);
    frames_make(m, &v, &f);
    lumps_make(m, &v, &f, &l);
    stance_sincos(slope, &sine, &cosine);
    number->slope[0] = slope, number->slope[1] = sine, number->slope[2] = cosine;
    number->gravity[0] = -(g * sine), number->gravity[1] = g * cosine;
    number->mass = l.mass;
    if (tree->base == 1) {
        const double *const axis = v.body[0].axis, size = hypot(axis[0], axis[1]);
        number->rail[0] = (cosine * axis[0] - sine * axis[1]) / size;
        number->rail[1] = (sine * axis[0] + cosine * axis[1]) / size;
        number->mass += v.body[0].armature;
    }
    for (int k = 0; k < 2; k++) {
        number->lift[k] = number->gravity[k] * (l.mass / number->mass);
        number->reference[k] = v.reference[k];
    }
    for (int i = 0; i < tree->angles; i++) {
        const bool turned = tree->above[i] < 0 && tree->base < 2; /* into the ground's axes */
        const double *const joint = l.joint[i];
        number->inertia[i] = l.inertia[i];
        memcpy(number->moment[i], l.moment[i], sizeof l.moment[i]);
        number->joint[i][0] = turned ? cosine * joint[0] - sine * joint[1] : joint[0];
        number->joint[i][1] = turned ? sine * joint[0] + cosine * joint[1] : joint[1];
    }
    for (int b = 0, spring = 0, rotor = 0, turn = 0; b < m->bodies; b++) {
        const stance_body_numbers *const body = &v.body[b];
        const int i = f.of[b];
        if (m->body[b].joint == STANCE_FIXED)
            continue;
        if (rotor < tree->rotors && tree->rotor[rotor] == i)
            number->rotor[rotor++] = body->armature;
        if (spring < tree->springs && tree->spring[spring] == i) {
            number->spring[spring][0] = body->stiffness;
            number->spring[spring][1] = body->damping;
            number->spring[spring++][2] = body->rest + (i >= 0 && tree->above[i] < 0 ? slope : 0);
        }
        if (m->body[b].bounded)
            number->turn[turn++] = body->turn;
    }
    memcpy(number->limit, v.limit, sizeof number->limit);
    for (int p = 0, k = 0; p < m->points; p++) {
        if (!m->point[p].falls)
            continue;
        for (int axis = 0; axis < 2; axis++)
            number->point[k][axis] = f.at[m->point[p].body][axis] + v.point[p].at[axis];
        number->lowest[k++] = v.point[p].lowest;
    }
    for (int p = 0, k = 0; p < m->points; p++) {
        const stance_point_numbers *const point = &v.point[p];
        if (m->point[p].pushed == STANCE_NO_PUSH)
            continue;
        for (int axis = 0; axis < 2; axis++) {
            number->push[k][axis] = f.at[m->point[p].body][axis] + point->at[axis];
            number->push[k][2 + axis] = point->force[axis];
        }
        number->push[k][4] = point->from;
        number->push[k++][5] = m->point[p].pushed == STANCE_IMPULSE ? point->from : point->to;
    }
    const double arm = number_contacts(tree, m, &v, &f, &l, slope, number->end);
    lumps_curvature(m, &f, &l, arm, number->curvature);
}
