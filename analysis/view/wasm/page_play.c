/* page_play.c - one case with its trajectory, and what a stick figure needs of it: points of the
 * figure and of contacts, where actuators act, the energy.
 *
 * Where joint k turns: the figure moves with it as v = E (p - c), E the quarter turn (x, z) ->
 * (-z, x), so that c = p + E v of any point that moves, the fastest one here; v from a difference
 * over a small angle.
 */
#include "page.h"

#include "runner/base/message.h"
#include "runner/plan/ground_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    TIME,
    POSITION,
    VELOCITY,
    TORQUE,
    FORCE,
    GAP,
    FIGURE,
    CONTACT,
    ACTUATOR,
    ENERGY,
    NUMBERS,
};

static struct {
    stance_case input;
    stance_result result;
    int rows, points;
    double every;
    double *number[NUMBERS];
} played;

/* How far the ground is told beyond where the figure has been: so many times its size. */
#define AROUND 20
enum { LINE_POINTS = 2000 };

/* Into place[4]: of what turns its centre and nothing, of what slides a point and its direction. */
static void put_actuator(const stance_scene *scene, int k, const double *position,
                         const double point[][2], int points, double *place)
{
    const bool turns = strcmp(scene->coordinate[k].unit, "rad") == 0;
    const double step = 1e-6;
    double moved[STANCE_MAX_COORDINATES], ahead[STANCE_MAX_POINTS][2], v[2] = {0, 0};
    int fastest = 0;
    memcpy(moved, position, (size_t)scene->coordinates * sizeof *moved);
    moved[k] += step;
    scene->figure(scene, played.input.robot, moved, ahead);
    for (int p = 0; p < points; p++) {
        const double own[2] = {(ahead[p][0] - point[p][0]) / step,
                               (ahead[p][1] - point[p][1]) / step};
        if (hypot(own[0], own[1]) > hypot(v[0], v[1])) {
            fastest = p;
            memcpy(v, own, sizeof v);
        }
    }
    place[0] = point[fastest][0] - (turns ? v[1] : 0);
    place[1] = point[fastest][1] + (turns ? v[0] : 0);
    place[2] = turns ? NAN : v[0];
    place[3] = turns ? NAN : v[1];
}

static void put_row(const stance_scene *scene, int row)
{
    const int n = scene->coordinates, contacts = scene->contacts;
    const double *const position = &played.number[POSITION][row * n],
                        *const velocity = &played.number[VELOCITY][row * n];
    double point[STANCE_MAX_POINTS][2], speed[2];
    const int points = scene->figure(scene, played.input.robot, position, point);
    played.number[TIME][row] = row * played.every;
    memcpy(&played.number[FIGURE][row * 2 * played.points], point,
           (size_t)(2 * played.points) * sizeof **point);
    for (int c = 0; c < contacts; c++)
        scene->contact_point(scene, played.input.robot, position, velocity, c,
                             &played.number[CONTACT][(row * contacts + c) * 2], speed);
    for (int a = 0; a < scene->actuators; a++)
        put_actuator(scene, scene->actuated[a], position, point, points,
                     &played.number[ACTUATOR][(row * scene->actuators + a) * 4]);
    played.number[ENERGY][row] = scene->energy(scene, played.input.robot, position, velocity);
}

/* Rows up to the end of the case: the first one that was not reached holds NAN. */
static bool make_rows(const stance_scene *scene, const stance_kernel *kernel, int rows)
{
    const int n = scene->coordinates, m = scene->actuators, contacts = scene->contacts;
    double point[STANCE_MAX_POINTS][2];
    played.points = scene->figure(scene, played.input.robot, played.input.position, point);
    const int numbers[NUMBERS] = {
        1, n, n, m, 2 * contacts, contacts, 2 * played.points, 2 * contacts, 4 * m, 1};
    for (int k = 0; k < NUMBERS; k++) {
        free(played.number[k]);
        played.number[k] =
            malloc((size_t)rows * (size_t)(numbers[k] > 0 ? numbers[k] : 1) * sizeof(double));
        if (!played.number[k])
            return no_memory(&page.message);
    }
    for (int i = 0; i < rows; i++)
        played.number[POSITION][i * n] = NAN;
    stance_trajectory trajectory = {
        .interval = played.every,
        .rows = rows,
        .position = played.number[POSITION],
        .velocity = played.number[VELOCITY],
        .torque = played.number[TORQUE],
        .force = played.number[FORCE],
        .gap = played.number[GAP],
    };
    played.input.trajectory = &trajectory;
    kernel->run(&played.input, &played.result, 1);
    page_simulated(&played.result);
    played.input.trajectory = NULL;
    played.rows = 0;
    while (played.rows < rows && !isnan(played.number[POSITION][played.rows * n]))
        put_row(scene, played.rows++);
    return true;
}

EXPORTED(int, play, double index, double every, int most_rows)
{
    const stance_scene *const scene = page.view.scene;
    const stance_kernel *kernel;
    played.rows = 0;
    page_fail(&played.result);
    if (!page_case(index, &played.input, &kernel)) {
        if (!page.message.text[0])
            complain(&page.message, "case %.0f has no start, or no controller, that exists", index);
        return 0;
    }
    if (most_rows < 2)
        most_rows = 2;
    if (!(every > 0)) { /* each step, or each so many of them */
        kernel->run(&played.input, &played.result, 1);
        const double steps = fmax(1, (double)played.result.steps);
        every = played.input.step * ceil(steps / (most_rows - 1));
    }
    played.every = every;
    const double length = played.input.step * (double)played.input.steps;
    const double rows = fmin(most_rows, floor(length / every + 1e-6) + 1);
    return make_rows(scene, kernel, (int)rows) ? played.rows : 0;
}

EXPORTED(const double *, play_numbers, int which)
{
    return which >= 0 && which < NUMBERS ? played.number[which] : NULL;
}

/* Where the figure has been, along x, and what its size is. */
static double reach(double x[2])
{
    const double *const figure = played.number[FIGURE];
    double low = INFINITY, high = -INFINITY, size = 0;
    x[0] = INFINITY, x[1] = -INFINITY;
    for (int i = 0; i < 2 * played.points * played.rows; i += 2) {
        x[0] = fmin(x[0], figure[i]), x[1] = fmax(x[1], figure[i]);
        if (i >= 2 * played.points)
            continue;
        low = fmin(low, figure[i + 1]), high = fmax(high, figure[i + 1]);
        size = fmax(x[1] - x[0], high - low);
    }
    return size;
}

/* Plates: a line from each time on at which some are laid. */
static void tell_ground(struct text *text)
{
    static double point[LINE_POINTS][2];
    const stance_case *const c = &played.input;
    double *const *const n = played.number;
    const double slope = c->body.slope[2];
    double x[2], since = -INFINITY;
    struct ground_pieces pieces;
    if (c->body.plates == 0 || played.rows == 0)
        return;
    const struct ground_motion motion = {(size_t)played.rows, n[TIME],  n[POSITION],
                                         n[VELOCITY],         n[FORCE], n[GAP]};
    ground_pieces_find(c, &motion, &pieces);
    const double around = AROUND * reach(x);
    while (since < INFINITY) {
        const size_t points = ground_line(c, &pieces, since, (x[0] - around) / slope,
                                          (x[1] + around) / slope, point, LINE_POINTS);
        double next = INFINITY;
        text_json(text, "~{'since':#,'points':[", since);
        for (size_t k = 0; k < points; k++)
            text_json(text, "~#,#", point[k][0], point[k][1]);
        text_json(text, "]}");
        for (int i = 0; i < c->body.plates; i++)
            next = pieces.laid[i] > since ? fmin(next, pieces.laid[i]) : next;
        since = next;
    }
}

EXPORTED(const char *, play_text, void)
{
    static struct text text;
    double answer[STANCE_ANSWER_COUNT];
    page_answers(&played.result, answer);
    text_begin(&text);
    text_json(&text,
              "{'rows':#,'interval':#,'step':#,'figure':#,'contacts':#,'kind':#,'checksum':#,"
              "'slope':#,'answers':[",
              (double)played.rows, played.every, played.input.step, (double)played.points,
              (double)page.view.scene->contacts, (double)page_kind(&played.result),
              (double)page_checksum(&played.result), played.input.robot[STANCE_ROBOT_SLOPE]);
    for (int a = 0; a < STANCE_ANSWER_COUNT; a++)
        text_json(&text, "~#", answer[a]);
    text_json(&text, "],'ground':[");
    tell_ground(&text);
    text_json(&text, "]}");
    return text_done(&text);
}
