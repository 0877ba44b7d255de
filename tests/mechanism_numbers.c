/* mechanism_numbers.c - what the engine says of a mechanism, as text for an independent program.
 *
 * Standard input: a mechanism (mechanism_text.h), then lines
 *
 *   world GRAVITY SLOPE
 *   state q ... v ...         energy, inertia, and each contact's gap, point and speed there
 *   push q ... v ... torque ...  accelerations and contacts by the kernels' algebra, in one lane
 *   rest SUPPORTS BRANCH p ...   the equilibrium (nan: not given), its linearisation and forces
 *   step THETA h q ... w0 ... w ... r ...  the inverse of a step's matrix, row by row for a unit of
 *                             each generalised force; r: (normal, tangential) of each contact
 *   end                       another mechanism follows
 *
 * Standard output: for each of these a line "begin WORD" and lines "NAME number ...".
 */
#include "mechanism_algebra.h"
/* After it, which says how many lanes there are. */
#include "mechanism_text.h"

static void row(const char *name, const double *value, int count)
{
    printf("%s", name);
    for (int i = 0; i < count; i++)
        printf(" %.17g", value[i]);
    putchar('\n');
}

static void say_state(const stance_scene *s, const double *robot, struct words *w)
{
    const int n = s->coordinates;
    double q[STANCE_MAX_COORDINATES] = {0}, v[STANCE_MAX_COORDINATES] = {0},
           gap[STANCE_MAX_CONTACTS], A[STANCE_MAX_COORDINATES * STANCE_MAX_COORDINATES];
    for (int i = 0; i < 2 * n; i++)
        *(i < n ? &q[i] : &v[i - n]) = next_number(w);
    const double energy = s->energy(s, robot, q, v);
    printf("begin state\n");
    row("energy", &energy, 1);
    s->inertia(s, robot, q, A);
    row("inertia", A, n * n);
    s->gaps(s, robot, q, gap);
    row("gap", gap, s->contacts);
    for (int c = 0; c < s->contacts; c++) {
        double point[2], speed[2];
        s->contact_point(s, robot, q, v, c, point, speed);
        row("point", point, 2);
        row("speed", speed, 2);
    }
}

/* Accelerations of the coordinates; of each contact (normal, tangential); and what a unit of each
 * of these forces adds to the latter. */
static void say_push(const stance_scene *s, const double *robot, struct words *w)
{
    const int n = s->coordinates;
    double q[SCENE_COORDINATES] = {0}, v[SCENE_COORDINATES] = {0}, torque[SCENE_ACTUATORS] = {0},
           x[SCENE_COORDINATES], y[SCENE_COORDINATES];
    struct algebra at;
    for (int i = 0; i < 2 * n; i++)
        *(i < n ? &q[i] : &v[i - n]) = next_number(w);
    for (int i = 0; i < s->actuators; i++)
        torque[i] = next_number(w);
    algebra_at(s, robot, q, v, &at);
    algebra_accelerate(&at, torque, x, y);
    printf("begin push\n");
    row("acceleration", y, n);
    for (int c = 0; c < s->contacts; c++) {
        double u[2], a[2], response[2][SCENE_COORDINATES];
        scene_contact_velocity(&at.body, &at.trig, c, x, u);
        scene_contact_curvature(&at.body, &at.trig, c, at.rate, a);
        u[0] += a[0], u[1] += a[1];
        row("contact", u, 2);
        scene_contact_response(&at.body, &at.matrix, false, &at.trig, c, response);
        for (int direction = 0; direction < (s->grip[c] == c ? 2 : 1); direction++) {
            for (int k = 0; k < s->contacts; k++) {
                scene_contact_velocity(&at.body, &at.trig, k, response[direction], u);
                row("answer", u, 2);
            }
        }
    }
}

/* Generalised forces of the user's coordinates as loads of the tree's. */
static void load_of(const stance_tree_numbers *number, int k, double *load)
{
    const double *const slope = number->slope;
    memset(load, 0, sizeof(double[SCENE_COORDINATES]));
    if (tree_free && k < 2)
        load[k] = slope[2], load[1 - k] = k ? -slope[1] : slope[1];
    else
        tree_drive(k - tree_base_size, 1, load);
}

static void say_step(const stance_scene *s, const double *robot, struct words *w)
{
    const int n = s->coordinates;
    double q[SCENE_COORDINATES] = {0}, rate[2][SCENE_COORDINATES] = {{0}}, at[SCENE_COORDINATES],
           before[SCENE_COORDINATES], after[SCENE_COORDINATES], v[SCENE_COORDINATES],
           change[SCENE_COORDINATES], r[SCENE_CONTACTS][2] = {{0}}, load[SCENE_COORDINATES],
           x[SCENE_COORDINATES], y[SCENE_COORDINATES];
    const double none[SCENE_ACTUATORS][SCENE_POSTURE] = {{0}};
    stance_tree_numbers number;
    scene_body body;
    scene_trig trig;
    scene_matrix matrix;
    const double theta = next_number(w), h = next_number(w), lever = h * (theta * theta);
    for (int i = 0; i < 3 * n; i++)
        *(i < n ? &q[i] : &rate[i / n - 1][i % n]) = next_number(w);
    for (int c = 0; c < s->contacts; c++)
        for (int axis = 0; axis < 2; axis++)
            r[c][axis] = next_number(w);
    tree_now = s->tree;
    stance_tree_numbers_make(s->tree, s->mechanism, robot, &number);
    memset(&body, 0, sizeof body);
    memset(&matrix, 0, sizeof matrix);
    scene_load_body(&body, 0, &number);
    scene_enter(&number, q, rate[0], at, before);
    scene_enter(&number, q, rate[1], at, after);
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        v[k] = (1 - theta) * before[k] + theta * after[k];
        at[k] += h * theta * v[k];
        change[k] = after[k] - before[k];
    }
    scene_trigonometry(at, &trig);
    scene_factor(&body, &(scene_guess){h, 0, at, &trig, v, change},
                 &(scene_slopes){theta, lever, lever, &trig, (const double(*)[2])r, none}, false,
                 &matrix);
    printf("begin step\ninverse");
    for (int k = 0; k < n; k++) {
        load_of(&number, k, load);
        scene_solve(&matrix, false, load, x);
        scene_coordinate_rates(&body, &trig, x, y);
        for (int i = 0; i < n; i++)
            printf(" %.17g", y[i]);
    }
    putchar('\n');
}

static void say_rest(const stance_scene *s, const double *robot, struct words *w)
{
    double A[4 * STANCE_MAX_POSTURE * STANCE_MAX_POSTURE],
        B[2 * STANCE_MAX_POSTURE * STANCE_MAX_ACTUATORS], force[2 * STANCE_MAX_CONTACTS],
        by_state[4 * STANCE_MAX_CONTACTS * STANCE_MAX_POSTURE],
        by_torque[2 * STANCE_MAX_CONTACTS * STANCE_MAX_ACTUATORS];
    stance_equilibrium_choice choice = {.supports = (uint32_t)next_number(w)};
    stance_equilibrium e;
    stance_message message;
    choice.branch = (int)next_number(w);
    for (int k = 0; k < s->postures; k++)
        choice.posture[k] = next_number(w);
    printf("begin rest\n");
    if (s->equilibrium(s, robot, &choice, &e, &message) != STANCE_OK) {
        printf("refused %s\n", message.text);
        return;
    }
    const int p = e.freedoms, m = s->actuators;
    int supports = 0;
    for (int c = 0; c < s->contacts; c++)
        supports += choice.supports >> c & 1;
    printf("remark %s\nundetermined %d\nfreedom", message.text, e.undetermined);
    for (int k = 0; k < p; k++)
        printf(" %d", e.freedom[k]);
    putchar('\n');
    row("position", e.position, s->coordinates);
    row("torque", e.torque, m);
    row("force", e.force[0], 2 * s->contacts);
    row("friction", &e.friction, 1);
    row("condition", &e.condition, 1);
    if (s->linearise(s, robot, &e, A, B) != STANCE_OK ||
        s->contact_force(s, robot, &e, force, by_state, by_torque) != STANCE_OK)
        abort();
    row("A", A, 4 * p * p);
    row("B", B, 2 * p * m);
    row("carried", force, 2 * supports);
    row("by_state", by_state, 4 * supports * p);
    row("by_torque", by_torque, 2 * supports * m);
}

int main(void)
{
    static stance_mechanism m;
    stance_scene *scene = NULL;
    double gravity = STANCE_GRAVITY, slope = 0, robot[STANCE_MAX_ROBOT];
    char line[4096];
    while (fgets(line, sizeof line, stdin)) {
        char copy[sizeof line];
        memcpy(copy, line, sizeof line);
        if (mechanism_line(copy, &m))
            continue;
        struct words w = {line, NULL};
        const char *word = next_word(&w);
        if (!scene && stance_mechanism_scene(&m, &scene, NULL) != STANCE_OK)
            return 1;
        stance_robot_fallback(scene, robot);
        robot[STANCE_ROBOT_GRAVITY] = gravity;
        robot[STANCE_ROBOT_SLOPE] = slope;
        if (strcmp(word, "world") == 0) {
            gravity = next_number(&w);
            slope = next_number(&w);
        } else if (strcmp(word, "state") == 0) {
            say_state(scene, robot, &w);
        } else if (strcmp(word, "push") == 0) {
            say_push(scene, robot, &w);
        } else if (strcmp(word, "rest") == 0) {
            say_rest(scene, robot, &w);
        } else if (strcmp(word, "step") == 0) {
            say_step(scene, robot, &w);
        } else if (strcmp(word, "end") == 0) {
            stance_scene_free(scene);
            scene = NULL;
            memset(&m, 0, sizeof m);
        } else {
            return 1;
        }
    }
    stance_scene_free(scene);
    return 0;
}
