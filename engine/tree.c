/* tree.c - tables and numbers of a mechanism, for kernels: see tree.h and scenes/tree_lanes.h.
 *
 * Lumping: body b of mass m, inertia J about its centre c (in the frame of the angle i that carries
 * it) adds m c to k_i and J + m |c|^2 to I_i; all that hangs on a joint at d in frame j, of mass
 * m', adds m' d to k_j and m' |d|^2 to I_j. A geared rotor's inertia is added to both diagonals.
 * What a joint of frame f moves that slides has its first moment about the origin of f for k, and
 * its mass for I; it adds first and second moment to those of the frame.
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
 *
 * With joints that slide points move by E T (d_f y_l + d_l y_f) in second order, besides the - R e
 * d_f y_f of angles. A slide l of mass m_l (its own body m_s, J_s, whose centre is b off the line
 * through its parent's along the axis) resists with a_l, a frame with the J of what slides in it,
 * too; e and I_j are as long as limits let them be (SLIDES_TO where there are none), and
 *
 *   a_l = 1 / (1 / m_s + 1 / m_P + b^2 / (J_s + J_P)),         I' >= m_l,        r >= 1,
 *   sqrt(I'_j / a_j) becomes max( sqrt(I'_j / a_j) + sum_l sqrt(m_l / a_l), sqrt(m_l / a_j) ).
 */
#include "tree.h"
#include "refuse.h"

#include <math.h>
#include <string.h>

#define SLIDES_TO 10.0 /* m */

/* The same on every machine, as the C library's hypot is not. */
static double length(const double v[2])
{
    int scale = 0;
    (void)frexp(fmax(fabs(v[0]), fabs(v[1])), &scale);
    const double x = ldexp(v[0], -scale), y = ldexp(v[1], -scale);
    return ldexp(sqrt(x * x + y * y), scale);
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* A mechanism with its numbers; which angle carries each body, and where in its frame the body's
 * own is while nothing slides; and its lumps. */
struct frames {
    const stance_mechanism *m;
    const stance_mechanism_numbers *v;
    int of[STANCE_MAX_BODIES];    /* -1: the base */
    int joint[STANCE_MAX_BODIES]; /* the same, or the joint that slides in that frame and carries it
                                   */
    double at[STANCE_MAX_BODIES][2];
    /* By how much the body's own frame is turned against it, and sine and cosine of that. Joints
     * count from the frame, so that nothing but what stands in the body's own is turned. */
    double turned[STANCE_MAX_BODIES], sine[STANCE_MAX_BODIES], cosine[STANCE_MAX_BODIES];
    int body[STANCE_MAX_ANGLES]; /* that turns, or slides */
    int angles;
    double mass, base; /* of all; of what slides along the rail without turning */
    double own_mass[STANCE_MAX_ANGLES], own_centre[STANCE_MAX_ANGLES][2],
        own_inertia[STANCE_MAX_ANGLES]; /* of a joint's bodies together, about their centre */
    double moment[STANCE_MAX_ANGLES][2], inertia[STANCE_MAX_ANGLES], hinge[STANCE_MAX_ANGLES][2];
};

/* R(a) v, `out` may be v: a vector of the base's, upright, into the ground's axes. */
static void lay(double sine, double cosine, const double v[2], double out[2])
{
    const double x = v[0], z = v[1];
    out[0] = cosine * x - sine * z;
    out[1] = sine * x + cosine * z;
}
/* A vector of a body's own frame, in the one that carries it. */
static void frames_turn(const struct frames *f, int b, const double own[2], double out[2])
{
    lay(f->sine[b], f->cosine[b], own, out);
}

static void frames_make(const stance_mechanism *m, const stance_mechanism_numbers *v,
                        struct frames *f)
{
    *f = (struct frames){.m = m, .v = v};
    for (int b = 0; b < f->m->bodies; b++) {
        const int parent = f->m->body[b].parent;
        const stance_joint joint = f->m->body[b].joint;
        const bool turns = joint == STANCE_FREE || joint == STANCE_HINGE;
        const bool keeps = !turns && parent >= 0; /* the angle of its parent */
        double at[2] = {0, 0};
        if (keeps)
            frames_turn(f, parent, f->v->body[b].at, at);
        for (int k = 0; k < 2; k++)
            f->at[b][k] = keeps ? f->at[parent][k] + at[k] : 0;
        f->turned[b] = f->v->body[b].angle + (parent >= 0 ? f->turned[parent] : 0);
        stance_sincos(f->turned[b], &f->sine[b], &f->cosine[b]);
        f->of[b] = turns ? f->angles : keeps ? f->of[parent] : -1;
        f->joint[b] = keeps ? f->joint[parent] : -1;
        if (turns || (keeps && joint == STANCE_SLIDE)) {
            f->joint[b] = f->angles;
            if (f->angles < STANCE_MAX_ANGLES)
                f->body[f->angles] = b;
            f->angles++;
        }
    }
}

static bool slides(const struct frames *f, int joint)
{
    return f->m->body[f->body[joint]].joint == STANCE_SLIDE;
}

/* Where a point of body b is in its frame, or (no angle carries it) in the base's. */
static void frames_place(const struct frames *f, int b, const double local[2], double place[2])
{
    frames_turn(f, b, local, place);
    for (int k = 0; k < 2; k++) {
        place[k] = f->at[b][k] + place[k];
        if (f->of[b] < 0)
            place[k] += f->v->body[0].at[k]; /* the rail's origin */
    }
}

/* The joint of an angle in the frame above, or (no angle is above) in the base's; the direction of
 * one that slides. */
static void frames_joint(const struct frames *f, int angle, double joint[2])
{
    const int b = f->body[angle], parent = f->m->body[b].parent;
    const bool free = f->m->body[0].joint == STANCE_FREE;
    if (slides(f, angle)) {
        const double *const axis = f->v->body[b].axis, size = length(axis);
        const double unit[2] = {axis[0] / size, axis[1] / size};
        frames_turn(f, parent, unit, joint);
        return;
    }
    if (parent >= 0)
        frames_place(f, parent, f->v->body[b].at, joint);
    for (int k = 0; k < 2 && parent < 0; k++)
        joint[k] = free ? 0 : f->v->body[b].at[k];
}

/* ---- lumps ----------------------------------------------------------------------------------- */

/* The frame that a joint is in, and the joint that it hangs from. */
static int above(const struct frames *f, int joint)
{
    const int parent = f->m->body[f->body[joint]].parent;
    return parent < 0 ? -1 : f->of[parent];
}
static int before(const struct frames *f, int joint)
{
    const int parent = f->m->body[f->body[joint]].parent;
    return parent < 0 ? -1 : f->joint[parent];
}

static double squared(const double v[2])
{
    return v[0] * v[0] + v[1] * v[1];
}

static void lumps_make(struct frames *f)
{
    double beyond[STANCE_MAX_ANGLES] = {0};
    for (int b = 0; b < f->m->bodies; b++) {
        const stance_body_numbers *const body = &f->v->body[b];
        const int i = f->joint[b];
        f->mass += body->mass;
        if (i < 0) {
            f->base += body->mass;
            continue;
        }
        double c[2];
        frames_turn(f, b, body->centre, c);
        for (int k = 0; k < 2; k++)
            c[k] = f->at[b][k] + c[k];
        f->own_mass[i] += body->mass;
        f->own_inertia[i] += body->inertia + body->mass * squared(c); /* about the joint, so far */
        for (int k = 0; k < 2; k++)
            f->moment[i][k] += body->mass * c[k];
    }
    for (int i = 0; i < f->angles; i++) {
        beyond[i] = f->own_mass[i];
        f->inertia[i] = f->own_inertia[i];
        for (int k = 0; k < 2; k++)
            f->own_centre[i][k] = f->own_mass[i] > 0 ? f->moment[i][k] / f->own_mass[i] : 0;
        frames_joint(f, i, f->hinge[i]);
    }
    /* The parallel axes' theorem, without the rounding of a difference that is zero. */
    for (int i = 0; i < f->angles; i++) {
        f->own_inertia[i] = 0;
        for (int b = 0; b < f->m->bodies; b++) {
            if (f->joint[b] != i)
                continue;
            double d[2];
            frames_turn(f, b, f->v->body[b].centre, d);
            for (int k = 0; k < 2; k++)
                d[k] = f->at[b][k] + d[k] - f->own_centre[i][k];
            f->own_inertia[i] += f->v->body[b].inertia + f->v->body[b].mass * squared(d);
        }
    }
    for (int i = f->angles - 1; i >= 0; i--) {
        const int j = before(f, i);
        const bool slid = slides(f, i);
        const double second = f->inertia[i];
        if (slid)
            f->inertia[i] = beyond[i];
        if (j < 0)
            continue;
        beyond[j] += beyond[i];
        for (int k = 0; k < 2; k++)
            f->moment[j][k] += slid ? f->moment[i][k] : beyond[i] * f->hinge[i][k];
        f->inertia[j] += slid ? second : beyond[i] * squared(f->hinge[i]);
    }
    for (int b = 0; b < f->m->bodies; b++) {
        const int i = f->of[b];
        if (f->m->body[b].joint == STANCE_FIXED || f->m->body[b].joint == STANCE_SLIDE)
            continue;
        const int j = above(f, i);
        f->inertia[i] += f->v->body[b].armature;
        if (j >= 0)
            f->inertia[j] += f->v->body[b].armature;
    }
}

/* How far a joint that slides may go, m. */
static double goes(const struct frames *f, int joint)
{
    const double *const limits = f->v->body[f->body[joint]].limits;
    const double far = fmax(fabs(limits[0]), fabs(limits[1]));
    return !slides(f, joint) ? 0 : far < SLIDES_TO ? far : SLIDES_TO;
}

/* What a joint that slides resists with. */
static double slide_resists(const struct frames *f, int i)
{
    const int j = before(f, i);
    const double held = j < 0 ? f->base : f->own_mass[j], moves = f->own_mass[i];
    if (!(moves > 0 && held > 0))
        return 0;
    double yields = 1 / moves + 1 / held;
    if (above(f, i) >= 0) {
        const double *const t = f->hinge[i];
        const double d[2] = {f->own_centre[i][0] - f->own_centre[j][0],
                             f->own_centre[i][1] - f->own_centre[j][1]};
        const double off = d[0] * t[1] - d[1] * t[0];
        yields += off == 0 ? 0 : off * off / (f->own_inertia[i] + f->own_inertia[j]);
    }
    return 1 / yields;
}

/* Longest second moment of a frame, and what slides in it: the inertia of their own, and
 * sum sqrt(mass / what it resists with). */
struct slid {
    double inertia, own, drawn, mass, least;
};
static struct slid slid_in(const struct frames *f, int frame)
{
    struct slid s = {.inertia = f->inertia[frame], .least = INFINITY};
    double stretch = 0; /* sum of mass and way, less than the true square's */
    for (int i = frame + 1; i < f->angles; i++) {
        if (!slides(f, i) || above(f, i) != frame)
            continue;
        const double far = goes(f, i), resists = slide_resists(f, i);
        s.inertia += 2 * far * length(f->moment[i]);
        s.inertia += far * (f->inertia[i] * far + 2 * stretch);
        stretch += f->inertia[i] * far;
        s.own += f->own_inertia[i];
        s.drawn += sqrt(f->inertia[i] / fmax(resists, 1e-6 * f->mass));
        s.mass = fmax(s.mass, f->inertia[i]);
        s.least = fmin(s.least, resists);
    }
    return s;
}

/* The coefficients of theta^2 in K1, of 1 in K1, of theta^2 in K2. */
static void lumps_curvature(const struct frames *f, double arm, double out[3])
{
    const bool free = f->m->body[0].joint == STANCE_FREE,
               rail = f->m->body[0].joint == STANCE_SLIDE;
    double hub = rail ? f->base : 0, least = INFINITY, least_angle = INFINITY;
    double most = f->mass, others = 0, share = 0;
    for (int i = 0; i < f->angles; i++) {
        if (slides(f, i)) {
            if (above(f, i) < 0) /* in no frame */
                least_angle = fmin(least_angle, slide_resists(f, i));
            continue;
        }
        const int j = before(f, i);
        const struct slid slid = slid_in(f, i);
        const double mass = f->own_mass[i], inertia = f->own_inertia[i];
        const double c2 = squared(f->own_centre[i]);
        double held = j < 0 ? (free ? 0 : rail ? f->base : INFINITY) : 0;
        if (j >= 0 && f->own_mass[j] > 0) {
            const double d[2] = {f->hinge[i][0] - f->own_centre[j][0],
                                 f->hinge[i][1] - f->own_centre[j][1]};
            const bool pinned = before(f, j) < 0 && !free && !slides(f, j);
            const double yields = (pinned ? 0 : 1 / f->own_mass[j]) +
                                  (squared(d) > 0 ? squared(d) / f->own_inertia[j] : 0);
            held = 1 / yields;
        }
        const bool at_base = free && (j < 0 || (before(f, j) < 0 && squared(f->hinge[i]) == 0));
        if (at_base && inertia + mass * c2 > 0)
            hub += mass * inertia / (inertia + mass * c2);
        const double with = isinf(held) ? mass : mass + held > 0 ? mass * held / (mass + held) : 0;
        const double resists = inertia + c2 * with + slid.own;
        least_angle = fmin(least_angle, fmin(resists, slid.least));
        most = fmax(most, slid.inertia);
        others = fmax(others, fmax(slid.inertia - inertia, slid.mass));
        share = fmax(share, (slid.inertia - inertia) / resists);
        if (slid.mass > 0) {
            const double drawn = sqrt((slid.inertia - inertia) / resists) + slid.drawn;
            share = fmax(share, fmax(drawn * drawn, slid.mass / resists));
            arm = arm > 0 ? fmax(arm, 1) : 0;
        }
    }
    int turning = 0;
    for (int i = 0; i < f->angles; i++)
        turning += !slides(f, i);
    if (turning == 0) { /* then nothing bends */
        out[0] = out[1] = out[2] = 0;
        return;
    }
    least = f->m->body[0].joint == STANCE_HINGE ? least_angle : fmin(hub, least_angle);
    /* Where nothing resists in some posture there is no bound; then one for what nearly nothing
     * resists. */
    least = fmax(least, 1e-6 * most);
    least_angle = fmax(least_angle, 1e-6 * most);
    share = fmin(share, 1e6);
    out[0] = (2 * sqrt(others) + sqrt(share) * sqrt(most)) / sqrt(least);
    out[1] = sqrt(f->mass) * arm / sqrt(least);
    out[2] = f->mass * arm / sqrt(least_angle) / sqrt(least);
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* Numbers that differ from zero wherever a case's may. */
static void typical(const stance_mechanism *m, stance_mechanism_numbers *v)
{
    double any[STANCE_MAX_ROBOT];
    for (int i = 0; i < STANCE_MAX_ROBOT; i++)
        any[i] = 0.5 + 0.7548776662466927 * i;
    *v = m->value;
    if (m->carried)
        m->carried->set(any, v);
    for (int i = 0; i < m->numbers; i++)
        if (m->varies[i])
            ((double *)v)[m->number[i]] = any[i];
}

/* The arms from the root to the point `own` in the frame of what `joint` carries; returns the first
 * frame, or STANCE_TREE_OWN where there is none. */
static int path_make(const struct frames *f, const stance_tree *tree, int joint,
                     const double own[2], int *path)
{
    int next = STANCE_TREE_OWN;
    bool longer = false; /* by what slides */
    for (int j = 0; j < STANCE_MAX_ANGLES; j++)
        path[j] = -1;
    for (int j = joint; j >= 0; j = before(f, j)) {
        if (tree->slide[j]) {
            path[j] = 0;
            longer = true;
            continue;
        }
        if (longer || squared(next == STANCE_TREE_OWN ? own : f->hinge[next]) != 0)
            path[j] = next;
        next = j;
        longer = false;
    }
    return tree->base < 2 ? next : -1;
}

static stance_error refuse(stance_message *message, const char *what, int limit)
{
    return stance_refuse(message, STANCE_BAD_ARGUMENT, "a mechanism has at most %d %s", limit,
                         what);
}

static void tables_couple(const struct frames *f, stance_tree *tree)
{
    const int n = tree->angles;
    for (int i = 0; i < n; i++) {
        int from = i;
        bool longer = tree->slide[i]; /* the arm, by what slides */
        for (int j = before(f, i); j >= 0; j = before(f, j)) {
            tree->through[i][j] = from;
            longer |= tree->slide[j];
            tree->coupled[i][j] = longer || squared(f->hinge[from]) != 0;
            tree->near[i][j] = tree->coupled[i][j];
            if (!tree->slide[j])
                from = j, longer = false;
        }
        if (tree->above[i] >= 0 && f->m->value.body[f->body[i]].armature != 0)
            tree->near[i][tree->above[i]] = 1;
    }
    for (int k = 0; k < tree->springs + tree->rotors; k++) {
        const int i = k < tree->springs ? tree->spring[k] : tree->rotor[k - tree->springs];
        if (i >= 0 && tree->above[i] >= 0)
            tree->near[i][tree->above[i]] = 1;
    }
    for (int i = n - 1; i >= 0; i--) /* what eliminating i fills in */
        for (int j = 0; j < i; j++)
            for (int k = 0; k < j; k++)
                if (tree->near[i][j] && tree->near[i][k])
                    tree->near[j][k] = 1;
}

/* Adds a contact at a point of its frame; false: there is no room. */
static bool add_contact(const struct frames *f, stance_tree *tree, int kind, int body,
                        const double own[2], int other, int grip)
{
    const bool stop = kind >= STANCE_TREE_LOW;
    const int c = tree->contacts, joint = stop ? -1 : f->joint[body], frame = f->of[body];
    if (c == STANCE_MAX_CONTACTS)
        return false;
    tree->kind[c] = kind;
    tree->body[c] = stop ? f->joint[body] : frame;
    tree->straight_end[c] = own[0] == 0;
    tree->other[c] = other;
    tree->grip[c] = grip;
    tree->top[c] = path_make(f, tree, joint, own, tree->path[c]);
    if (stop)
        tree->top[c] = -1;
    if (frame >= 0 && (kind == STANCE_TREE_DISC || (kind == STANCE_TREE_SOLE && squared(own) == 0)))
        tree->path[c][frame] = STANCE_TREE_OWN; /* friction has an arm, whatever the centre's */
    for (int j = 0; j < STANCE_MAX_ANGLES; j++)
        tree->carries[j] |= tree->path[c][j] >= 0;
    tree->contacts++;
    return true;
}

static bool tables_contacts(const struct frames *f, stance_tree *tree)
{
    static const double none[2] = {0, 0};
    const stance_mechanism *const m = f->m;
    stance_contact_place at;
    bool fits = true, rough = false;
    for (; tree->plates < m->plates; tree->plates++)
        rough |= m->plate[tree->plates].rough;
    for (int c = 0; fits && stance_mechanism_contact(m, c, &at); c++) {
        if (at.element < 0) {
            const int kind = at.end ? STANCE_TREE_HIGH : STANCE_TREE_LOW;
            fits = add_contact(f, tree, kind, at.body, none, -1, -1);
            continue;
        }
        const stance_element_numbers *const of = &f->v->element[at.element];
        const bool sole = m->element[at.element].sole;
        const int kind = of->radius != 0 ? STANCE_TREE_DISC
                         : sole          ? STANCE_TREE_SOLE
                                         : STANCE_TREE_POINT;
        double end[2];
        frames_place(f, at.body, at.end ? of->to : of->at, end);
        fits = add_contact(f, tree, kind, at.body, end,
                           !sole    ? -1
                           : at.end ? c - 1
                                    : c + 1,
                           m->plates ? c : c - at.end);
        if (fits)
            tree->rough[c] = rough || m->element[at.element].rough;
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
            if (tree->above[body] >= 0 && !tree->slide[body])
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
        return refuse(message, "bodies that turn or slide", STANCE_MAX_ANGLES);
    lumps_make(&f);
    tree->base = m->body[0].joint == STANCE_FREE ? 2 : m->body[0].joint == STANCE_SLIDE;
    tree->angles = f.angles;
    for (int i = 0; i < f.angles; i++) {
        tree->above[i] = above(&f, i);
        tree->slide[i] = slides(&f, i);
        if (tree->slide[i])
            tree->sliding[tree->slides++] = i;
        tree->straight[i] = f.moment[i][0] == 0;
        tree->straight_joint[i] = f.hinge[i][0] == 0;
        for (int j = 0; j < STANCE_MAX_ANGLES; j++)
            tree->through[i][j] = -1;
    }
    for (int b = 0; b < m->bodies; b++) {
        const stance_body_numbers *const body = &v.body[b];
        if (m->body[b].joint == STANCE_FIXED)
            continue;
        if (body->stiffness != 0 || body->damping != 0)
            tree->spring[tree->springs++] = f.joint[b];
        if (body->armature != 0)
            tree->rotor[tree->rotors++] = f.joint[b];
        if (m->body[b].bounded)
            tree->turning[tree->turns++] = f.of[b];
    }
    for (int i = 0; i < m->actuators; i++)
        tree->actuator[tree->actuators++] = f.joint[m->actuator[i].body];
    if (!tables_contacts(&f, tree))
        return refuse(message, "contacts (a sole has two, a limit of a joint is one)",
                      STANCE_MAX_CONTACTS);
    for (int p = 0; p < m->points; p++) {
        const int joint = f.joint[m->point[p].body], k = tree->pushes;
        double own[2];
        frames_place(&f, m->point[p].body, v.point[p].at, own);
        if (m->point[p].falls) {
            tree->point_top[tree->points] =
                path_make(&f, tree, joint, own, tree->point_path[tree->points]);
            tree->points++;
        }
        if (m->point[p].pushed == STANCE_NO_PUSH)
            continue;
        if (k == STANCE_MAX_PUSHES)
            return refuse(message, "points that are pushed", STANCE_MAX_PUSHES);
        tree->push_impulse[k] = m->point[p].pushed == STANCE_IMPULSE;
        tree->push_swings[k] = m->point[p].swings;
        path_make(&f, tree, joint, own, tree->push_path[k]);
        tree->pushes++;
    }
    tables_couple(&f, tree);
    tables_loads(tree);
    for (int i = 0; i < tree->angles; i++) { /* of what slides rotors are no part of the inertia */
        tree->alone[i] = !tree->slide[i];
        for (int k = i + 1; k < tree->angles; k++)
            if (tree->near[k][i] || (tree->slide[k] && tree->above[k] == i))
                tree->alone[i] = 0;
    }
    return STANCE_OK;
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* Longest of the arms between a contact and the frames on its way. */
static double longest_arm(const stance_tree *tree, const struct frames *f, int c,
                          const double end[2])
{
    double longest = 0;
    for (int j = 0; j < tree->angles; j++) {
        const int next = tree->path[c][j];
        if (next < 0 || tree->slide[j])
            continue;
        double more = 0;
        for (int i = j; i < tree->angles; i++)
            if (tree->above[i] == j && tree->path[c][i] >= 0)
                more += goes(f, i);
        longest = fmax(longest, more + length(next == STANCE_TREE_OWN ? end : f->hinge[next]));
    }
    return longest;
}

/* Is a joint's coordinate an angle against the upright? */
static bool is_upright(const stance_tree *tree, int joint)
{
    return joint >= 0 && tree->above[joint] < 0 && !tree->slide[joint];
}

/* Numbers of contacts; returns the longest arm. */
static double number_contacts(const stance_tree *tree, const struct frames *f,
                              stance_tree_numbers *number)
{
    const double *const slope = number->slope;
    stance_contact_place at;
    double arm = 0;
    for (int c = 0; stance_mechanism_contact(f->m, c, &at); c++) {
        double *const end = number->end[c];
        if (at.element < 0) {
            end[0] =
                f->v->body[at.body].limits[at.end] + is_upright(tree, f->joint[at.body]) * slope[0];
            continue;
        }
        const stance_element_numbers *const of = &f->v->element[at.element];
        frames_place(f, at.body, at.end ? of->to : of->at, end);
        if (f->of[at.body] < 0)
            lay(slope[1], slope[2], end, end);
        end[2] = of->radius;
        number->rough[c] = f->m->element[at.element].rough ? of->friction_factor : 1;
        arm = fmax(arm, longest_arm(tree, f, c, end) + end[2]);
    }
    return arm;
}

void stance_tree_numbers_make(const stance_tree *tree, const stance_mechanism *m,
                              const double *robot, stance_tree_numbers *number)
{
    stance_mechanism_numbers v;
    struct frames f;
    const double g = robot[STANCE_ROBOT_GRAVITY], slope = robot[STANCE_ROBOT_SLOPE];
    double sine, cosine;
    *number = (stance_tree_numbers){0};
    stance_mechanism_expand(m, robot, &v);
    frames_make(m, &v, &f);
    lumps_make(&f);
    stance_sincos(slope, &sine, &cosine);
    number->slope[0] = slope, number->slope[1] = sine, number->slope[2] = cosine;
    number->gravity[0] = -(g * sine), number->gravity[1] = g * cosine;
    number->mass = f.mass;
    if (tree->base == 1) {
        const double *const axis = v.body[0].axis, size = length(axis);
        number->rail[0] = (cosine * axis[0] - sine * axis[1]) / size;
        number->rail[1] = (sine * axis[0] + cosine * axis[1]) / size;
        number->mass += v.body[0].armature;
    }
    for (int k = 0; k < 2; k++)
        number->lift[k] = number->gravity[k] * (f.mass / number->mass);
    frames_turn(&f, 0, v.reference, number->reference);
    for (int i = 0; i < tree->angles; i++) {
        const bool turned = tree->above[i] < 0 && tree->base < 2; /* into the ground's axes */
        const double *const joint = f.hinge[i];
        number->inertia[i] = f.inertia[i];
        number->inverse[i] = 1 / f.inertia[i];
        memcpy(number->moment[i], f.moment[i], sizeof f.moment[i]);
        memcpy(number->joint[i], joint, sizeof f.hinge[i]);
        if (turned)
            lay(sine, cosine, joint, number->joint[i]);
    }
    for (int b = 0, spring = 0, rotor = 0, turn = 0; b < m->bodies; b++) {
        const stance_body_numbers *const body = &v.body[b];
        const int i = f.joint[b];
        if (m->body[b].joint == STANCE_FIXED)
            continue;
        if (rotor < tree->rotors && tree->rotor[rotor] == i)
            number->rotor[rotor++] = body->armature;
        if (spring < tree->springs && tree->spring[spring] == i) {
            number->spring[spring][0] = body->stiffness;
            number->spring[spring][1] = body->damping;
            number->spring[spring++][2] = body->rest + (is_upright(tree, i) ? slope : 0);
        }
        if (m->body[b].bounded) {
            number->turn[turn][0] = body->turn;
            number->turn[turn++][1] = f.turned[b];
        }
    }
    memcpy(number->limit, v.limit, sizeof number->limit);
    memcpy(number->plate, v.plate, sizeof number->plate);
    for (; number->plates < m->plates; number->plates++)
        number->plate_kind[number->plates] = m->plate[number->plates].kind;
    for (int p = 0, fall = 0, k = 0; p < m->points; p++) {
        const stance_point_numbers *const point = &v.point[p];
        double at[2];
        frames_place(&f, m->point[p].body, point->at, at);
        if (m->point[p].falls) {
            memcpy(number->point[fall], at, sizeof at);
            if (f.of[m->point[p].body] < 0)
                lay(sine, cosine, at, number->point[fall]);
            number->lowest[fall++] = point->lowest;
        }
        if (m->point[p].pushed == STANCE_NO_PUSH)
            continue;
        memcpy(number->push[k], at, sizeof at);
        memcpy(&number->push[k][2], point->force, sizeof point->force);
        number->push[k][4] = point->from;
        number->push[k][5] = m->point[p].pushed == STANCE_IMPULSE ? point->from : point->to;
        number->push[k++][6] = point->frequency;
    }
    lumps_curvature(&f, number_contacts(tree, &f, number), number->curvature);
}
