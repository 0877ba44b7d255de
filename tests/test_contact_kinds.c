/* test_contact_kinds - contact problems with up to six points, soles and joint stops on random
 * trees: by contact_modes.h. */
#define STANCE_LANES 1
#include "engine/core/lanes/lanes.h"

/* Six points, two soles of two ends each, two stops; each problem has some of them. As many are
 * lists: contact.h. */
#define TREE_CONTACTS 12
enum {
    SCENE_COORDINATES = 8,
    SCENE_CONTACTS = 12,
    SCENE_ACTUATORS = 0,
    SCENE_POSTURE = 0,
    SCENE_ANGLES = 6,
    POINTS = 6,
    SOLES = 2,
    STOPS = 2,
};
static const int scene_grip[SCENE_CONTACTS] = {0, 1, 2, 3, 4, 5, 6, 6, 8, 8, -1, -1};
static const int scene_other[SCENE_CONTACTS] = {-1, -1, -1, -1, -1, -1, 7, 6, 9, 8, -1, -1};
#include "engine/core/contact/solve.h"
#define DENSE_ROWS 18
#include "contact_modes.h"

enum { M = 12 };

/* Rows H of contacts of a tree whose first coordinates are the base's x and z, and D = H A^-1 H^T.
 */
static void random_problem(uint64_t *seed, const struct family *f, struct problem *p)
{
    double H[ROWS][M], foot[3][3][M], W[M][M], w[M];
    const int bodies = f->feet ? f->feet : f->points;
    memset(p, 0, sizeof *p);
    for (int k = 0; k < 3; k++) /* height, pitch, advance of a foot */
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < M; i++)
                foot[k][j][i] = i == 0 ? j == 2 : i == 1 ? j == 0 : uniform(seed, -1, 1);
    for (int k = 0; k < f->points + f->soles + f->stops; k++) {
        struct element *const e = &p->element[p->elements++];
        const bool sole = k >= f->points && k < f->points + f->soles;
        const bool stop = k >= f->points + f->soles;
        const int first = stop   ? POINTS + 2 * SOLES + k - f->points - f->soles
                          : sole ? POINTS + 2 * (k - f->points)
                                 : k;
        const double(*const own)[M] = foot[(k < f->points ? k % bodies : k) % 3];
        e->tangential = -1;
        if (!stop) {
            p->contact[p->rows] = first;
            e->tangential = p->rows++;
            for (int i = 0; i < M; i++)
                H[e->tangential][i] = f->feet || sole ? own[2][i]
                                      : i < 2         ? i == 0
                                                      : uniform(seed, -1, 1);
        }
        e->ends = sole ? 2 : 1;
        for (int end = 0; end < e->ends; end++) {
            const double at = sole ? 0.5 - end : uniform(seed, -0.5, 0.5);
            p->contact[p->rows] = first + end;
            e->normal[end] = p->rows++;
            for (int i = 0; i < M; i++)
                H[e->normal[end]][i] = stop              ? (i < 2 ? 0 : uniform(seed, -1, 1))
                                       : f->feet || sole ? own[0][i] + at * (i < 2 ? 0 : own[1][i])
                                       : i < 2           ? i == 1
                                                         : uniform(seed, -1, 1);
        }
    }
    for (int i = 0; i < M; i++) {
        w[i] = uniform(seed, -1, 1);
        for (int j = 0; j < M; j++)
            W[i][j] = uniform(seed, -1, 1);
    }
    for (int i = 0; i < p->rows; i++)
        for (int j = 0; j < p->rows; j++) {
            for (int a = 0; a < M; a++) {
                double left = 0, right = 0;
                for (int b = 0; b < M; b++)
                    left += H[i][b] * W[b][a], right += H[j][b] * W[b][a];
                p->D[i][j] += left * right + 0.1 * H[i][a] * H[j][a];
            }
        }
    p->friction = uniform(seed, 0, 1) < 0.1 ? 0 : uniform(seed, 0, 2);
    const double e = f->rebounds ? uniform(seed, 0, 1) : 0;
    for (int i = 0; i < p->rows; i++)
        for (int a = 0; a < M; a++)
            p->v[i] += H[i][a] * w[a];
    for (int k = 0; k < p->elements; k++)
        for (int end = 0; end < p->element[k].ends; end++) {
            const int n = p->element[k].normal[end];
            p->e[n] = e * fmin(p->v[n], 0);
        }
}

#define FAMILY(name, ...)                                                                          \
    TEST(name)                                                                                     \
    {                                                                                              \
        family(&(struct family){#name, random_problem, __VA_ARGS__});                              \
    }
FAMILY(one_point, 1, 0, 0, 0, false, 20000, 0.0005)
FAMILY(two_points, 2, 0, 0, 0, false, 10000, 0.001)
FAMILY(three_points_rebound, 3, 0, 0, 0, true, 4000, 0.001)
FAMILY(four_points, 4, 0, 0, 0, false, 2000, 0.001)
FAMILY(five_points, 5, 0, 0, 0, false, 400, 0)
FAMILY(six_points, 6, 0, 0, 0, false, 60, 0)
FAMILY(stops, 0, 0, 2, 0, true, 2000, 0)
FAMILY(points_and_stops, 2, 0, 2, 0, false, 4000, 0.001)
FAMILY(one_sole, 0, 1, 0, 0, false, 10000, 0.0005)
FAMILY(two_soles, 0, 2, 0, 0, false, 4000, 0.0005)
FAMILY(two_soles_rebound, 0, 2, 0, 0, true, 4000, 0.0005)
FAMILY(sole_point_stop, 1, 1, 1, 0, true, 4000, 0.0005)
FAMILY(one_foot_of_two_points, 2, 0, 0, 1, false, 10000, 0)
FAMILY(two_feet_of_two_points, 4, 0, 0, 2, false, 2000, 0)
FAMILY(two_feet_of_three_points, 6, 0, 0, 2, false, 60, 0)
