/* space.h - vectors and rotations in space; R[row][column] takes a vector of the inner frame to the
 * outer one. */
#ifndef RUNNER_IMPORT_SPACE_H
#define RUNNER_IMPORT_SPACE_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

static inline double space_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double space_length(const double a[3])
{
    return sqrt(space_dot(a, a));
}

static inline void space_cross(const double a[3], const double b[3], double out[3])
{
    const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                         a[0] * b[1] - a[1] * b[0]};
    memcpy(out, c, sizeof c);
}

/* Of any length but 0. */
static inline void space_unit(const double a[3], double out[3])
{
    const double length = space_length(a);
    for (int i = 0; i < 3; i++)
        out[i] = a[i] / length;
}

/* R v; out may be v. */
static inline void space_turn(const double R[3][3], const double v[3], double out[3])
{
    const double c[3] = {space_dot(R[0], v), space_dot(R[1], v), space_dot(R[2], v)};
    memcpy(out, c, sizeof c);
}

/* from + R v. */
static inline void space_place(const double from[3], const double R[3][3], const double v[3],
                               double out[3])
{
    double turned[3];
    space_turn(R, v, turned);
    for (int i = 0; i < 3; i++)
        out[i] = from[i] + turned[i];
}

/* A B; out may be either. */
static inline void space_product(const double A[3][3], const double B[3][3], double out[3][3])
{
    double C[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            C[i][j] = A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j];
    memcpy(out, C, sizeof C);
}

/* R I R'. */
static inline void space_turn_moments(const double R[3][3], const double moment[3][3],
                                      double out[3][3])
{
    for (int i = 0; i < 9; i++) {
        double by[3];
        space_turn(moment, R[i % 3], by);
        out[i / 3][i % 3] = space_dot(R[i / 3], by);
    }
}

/* About a unit vector (Rodrigues). */
static inline void space_rotation(const double axis[3], double angle, double R[3][3])
{
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[i][j] = (1 - c) * axis[i] * axis[j] + (i == j ? c : 0);
    R[0][1] -= s * axis[2], R[0][2] += s * axis[1], R[1][0] += s * axis[2];
    R[1][2] -= s * axis[0], R[2][0] -= s * axis[1], R[2][1] += s * axis[0];
}

/* Of a unit quaternion w, x, y, z. */
static inline void space_of_quaternion(const double q[4], double R[3][3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double C[3][3] = {
        {w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    memcpy(R, C, sizeof C);
}

/* How a frame is turned in the plane of the first two axes: by its x axis, where that is in the
 * plane, else its z. */
static inline double space_turned(const double R[3][3])
{
    const bool ahead = hypot(R[0][0], R[1][0]) > 0.7;
    const double angle = ahead ? atan2(R[1][0], R[0][0]) : atan2(-R[0][2], R[1][2]);
    return fabs(angle) < 1e-14 ? 0 : angle;
}

static inline void space_column(const double R[3][3], int column, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = R[i][column];
}

#endif
