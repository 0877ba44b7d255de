/* test_contact - contact problems of random robots, by contact_modes.h: operator and velocities
 * are made here from the robot's masses and lengths. */
#define STANCE_LANES 1
#define STANCE_SCENE biped
#define STANCE_ISA inside
#define STANCE_SCENE_LANES "engine/scenes/biped_lanes.h"
#include "engine/methods/implicit.c"
#define DENSE_ROWS 4
#include "contact_modes.h"

/* Two feet on the ground at random, H A^-1 H^T of them. The angles couple to the hip alone. */
static void random_feet(const double *robot, uint64_t *seed, const struct family *f,
                        struct problem *p)
{
    const double l = robot[0], lt = robot[1], m = robot[2], mt = robot[3], mh = robot[4];
    const double theta = uniform(seed, -M_PI, M_PI);
    double phi[2] = {uniform(seed, -1.3, 1.3), 0};
    phi[1] = uniform(seed, 0, 1) < 0.5 ? -phi[0] : uniform(seed, -1.3, 1.3);
    const double k[3] = {-mt * lt, m * l, m * l}, inertia[3] = {mt * lt * lt, m * l * l, m * l * l};
    const double angle[3] = {theta, phi[0], phi[1]};
    double hip[2][2] = {{mt + mh + 2 * m, 0}, {0, mt + mh + 2 * m}}, w[5];
    for (int i = 0; i < 3; i++) { /* the Schur complement of the angles */
        const double n[2] = {k[i] * cos(angle[i]), k[i] * sin(angle[i])};
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                hip[a][b] -= n[a] * n[b] / inertia[i];
    }
    const double det = hip[0][0] * hip[1][1] - hip[0][1] * hip[1][0];
    for (int i = 0; i < 5; i++)
        w[i] = uniform(seed, -3, 3);
    /* Rows: foot c normal, tangential; x of the hip first. */
    double H[4][5] = {{0}}, R[4][5];
    for (int c = 0; c < 2; c++) {
        H[2 * c][1] = 1, H[2 * c][3 + c] = l * sin(phi[c]);
        H[2 * c + 1][0] = 1, H[2 * c + 1][3 + c] = l * cos(phi[c]);
    }
    for (int j = 0; j < 4; j++) { /* R = A^-1 H^T */
        double g[2] = {H[j][0], H[j][1]};
        for (int i = 0; i < 3; i++) {
            g[0] -= k[i] * cos(angle[i]) * H[j][2 + i] / inertia[i];
            g[1] -= k[i] * sin(angle[i]) * H[j][2 + i] / inertia[i];
        }
        R[j][0] = (hip[1][1] * g[0] - hip[0][1] * g[1]) / det;
        R[j][1] = (hip[0][0] * g[1] - hip[1][0] * g[0]) / det;
        for (int i = 0; i < 3; i++)
            R[j][2 + i] =
                (H[j][2 + i] - k[i] * (cos(angle[i]) * R[j][0] + sin(angle[i]) * R[j][1])) /
                inertia[i];
    }
    memset(p, 0, sizeof *p);
    p->elements = uniform(seed, 0, 1) < 0.25 ? 1 : f->points;
    p->rows = 2 * p->elements;
    for (int i = 0; i < p->rows; i++) {
        p->contact[i] = i / 2;
        for (int a = 0; a < 5; a++)
            p->v[i] += H[i][a] * w[a];
        for (int j = 0; j < p->rows; j++)
            for (int a = 0; a < 5; a++)
                p->D[i][j] += H[i][a] * R[j][a];
    }
    p->friction = uniform(seed, 0, 1) < 0.1 ? 0 : uniform(seed, 0, 2);
    const double e = f->rebounds ? uniform(seed, 0, 1) : 0;
    for (int c = 0; c < p->elements; c++) {
        p->element[c] = (struct element){.tangential = 2 * c + 1, .ends = 1, .normal = {2 * c}};
        p->e[2 * c] = e * fmin(p->v[2 * c], 0);
    }
}

static void default_one(uint64_t *seed, const struct family *f, struct problem *p)
{
    random_feet((const double[]){0.535, 0.535, 1.8, 1.8, 5.4}, seed, f, p);
}
static void random_one(uint64_t *seed, const struct family *f, struct problem *p)
{
    double robot[5];
    for (int i = 0; i < 5; i++)
        robot[i] = i < 2 ? uniform(seed, 0.2, 1) : uniform(seed, 0.3, i == 2 ? 5 : 20);
    random_feet(robot, seed, f, p);
}

#define ROBOTS(name, robot, rebounds)                                                              \
    TEST(name)                                                                                     \
    {                                                                                              \
        family(&(struct family){#name, robot, 2, 0, 0, 0, rebounds, 90000, 0.001});                \
    }
ROBOTS(default_robot, default_one, false)
ROBOTS(default_robot_rebounds, default_one, true)
ROBOTS(random_robots, random_one, false)
ROBOTS(random_robots_rebound, random_one, true)
