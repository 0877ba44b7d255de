/* outputs.c - as many outputs as there are actuators are held at zero, each a row over the
 * coordinates less a polynomial of a phase, so that what a robot does follows where it is instead
 * of the clock: virtual constraints (Grizzle, Abba and Plestan, IEEE Trans. Autom. Control 46
 * (2001) 51). What that takes stands in core/law/law.h and core/mode/decoupling.h.
 *
 * The polynomials are given by Bernstein's coefficients, h(s) = sum b_i C(n, i) s^i (1 - s)^(n - i)
 * = sum_j s^j C(n, j) sum_i (-1)^(j - i) C(j, i) b_i. */
#include "engine/refuse.h"
#include "engine/rows.h"

#include <math.h>
#include <string.h>

enum { OF, CLOCK, FROM, TO, FIRST }; /* of the phase; then by output */
enum { ROW, ALONG, KP, KD, TORQUES, OUTPUT_PARAMETERS };
enum { PARAMETERS = FIRST + OUTPUT_PARAMETERS * STANCE_MAX_ACTUATORS };
#define LARGE 1e9

#define OUTPUT(i)                                                                                  \
    {{"outputs.y" #i ".of", "1", "of output y" #i ": how much of %s", 0, -LARGE, LARGE},           \
     .per = STANCE_PER_COORDINATE,                                                                 \
     .output = i,                                                                                  \
     .told = false,                                                                                \
     .all = "the row of y" #i ": how much of each coordinate"},                                    \
        {{"outputs.y" #i ".along", "rad", "what the row of y" #i " follows: a coefficient", NAN,   \
          -LARGE, LARGE},                                                                          \
         .per = STANCE_PER_TERM,                                                                   \
         .output = i,                                                                              \
         .told = true,                                                                             \
         .all = "what its row follows along the phase: Bernstein coefficients; one: a constant"},  \
        {{"outputs.y" #i ".proportional", "1/s^2", "proportional gain on y" #i, 100, 0, LARGE},    \
         .output = i,                                                                              \
         .told = true},                                                                            \
        {{"outputs.y" #i ".derivative", "1/s", "derivative gain on y" #i, 20, 0, LARGE},           \
         .output = i,                                                                              \
         .told = true},                                                                            \
    {                                                                                              \
        {"outputs.y" #i ".torques",                                                                \
         "kg m^2",                                                                                 \
         "torque of %s by the acceleration asked of y" #i,                                         \
         0,                                                                                        \
         -LARGE,                                                                                   \
         LARGE},                                                                                   \
            .per = STANCE_PER_ACTUATOR, .output = i,                                               \
            .all = "torques by the acceleration that is asked of y" #i ", in place of a model",    \
            .more = "Of all outputs or of none: then torques are found with the reactions, as "    \
                    "decoupling does."                                                             \
    }

static const stance_parameter parameters[PARAMETERS] = {
    [OF] = {{"phase.of", "1", "of the phase: how much of %s", 0, -LARGE, LARGE},
            .per = STANCE_PER_COORDINATE,
            .all = "the row of the phase: how much of each coordinate",
            .more = "While the first leg stands; while the other one does, coordinates of the legs "
                    "take each other's place here and in the outputs."},
    [CLOCK] = {{"phase.clock", "1", "coefficient of the phase's polynomial of time", NAN, -LARGE,
                LARGE},
               .per = STANCE_PER_TERM,
               .told = true,
               .all = "in place of `of`: coefficients of the powers of the time since the last "
                      "footfall, s",
               .more = "What a robot is to do when, whatever it does: a gait that its own phase "
                       "holds together may fall so."},
    [FROM] = {{"phase.from", "rad", "phase at which the polynomials begin", 0, -LARGE, LARGE},
              .told = true},
    [TO] = {{"phase.to", "rad", "phase at which they end", 1, -LARGE, LARGE}, .told = true},
    OUTPUT(1),
    OUTPUT(2),
    OUTPUT(3),
    OUTPUT(4),
    OUTPUT(5),
    OUTPUT(6),
    OUTPUT(7),
    OUTPUT(8),
};
_Static_assert(STANCE_MAX_ACTUATORS == 8, "a row for each output");

static const char *const groups[][2] = {
    {"phase", "what the outputs follow"},
    {"outputs", "what is held at zero: y1, y2 ..., one for each actuator"},
    {"outputs.*", "a row over the coordinates less a polynomial of the phase"},
    {NULL, NULL},
};

/* Coefficients of powers from n of Bernstein's. */
static void powers_of(const double *b, int n, double *power)
{
    double outer = 1; /* C(n - 1, j) */
    for (int j = 0; j < n; j++) {
        double inner = 1, sum = 0; /* C(j, i) */
        for (int i = 0; i <= j; i++) {
            sum += ((j - i) % 2 ? -1 : 1) * inner * b[i];
            inner = inner * (j - i) / (i + 1);
        }
        power[j] = outer * sum;
        outer = outer * (n - 1 - j) / (j + 1);
    }
}

static bool is_zero(const double *v, int n)
{
    bool zero = true;
    for (int i = 0; i < n; i++)
        zero = zero && v[i] == 0;
    return zero;
}

static stance_error refuse(stance_message *message, const char *what)
{
    return stance_refuse(message, STANCE_BAD_ARGUMENT, "controller.%s", what);
}

static stance_error set(const stance_scene *scene, const double *value, const double *begin,
                        stance_linear_law *linear, stance_case *c, stance_message *message)
{
    stance_outputs *const of = &c->outputs;
    const stance_exchange *const exchange = &scene->exchange;
    const int n = scene->coordinates, m = scene->actuators;
    double rows[STANCE_MAX_ACTUATORS + 1][STANCE_ROWS_STRIDE] = {{0}}, sum = 0;
    int weighted = 0, bends = 0;
    bool clocked = false;
    (void)begin, (void)linear;
    memset(of, 0, sizeof *of);
    for (int k = 0; k < STANCE_MAX_COEFFICIENTS; k++) {
        const double term = value[CLOCK * STANCE_LAW_ROOM + k];
        clocked = clocked || !isnan(term);
        sum += of->clock[k] = isnan(term) ? 0 : term;
    }
    of->from = value[FROM * STANCE_LAW_ROOM], of->to = value[TO * STANCE_LAW_ROOM];
    sum += of->from + of->to;
    if (!(fabs(of->to - of->from) > 1e-9))
        return refuse(message, "phase: from and to are the same");
    for (int k = 0; k < n; k++) {
        sum += rows[m][k] = of->phase[0][k] = value[OF * STANCE_LAW_ROOM + k];
        for (int j = 0; j < n; j++)
            of->phase[1][j] += of->phase[0][k] * exchange->coordinate[k][j];
    }
    for (int i = 0; i < m; i++) {
        const double *const own = &value[(FIRST + OUTPUT_PARAMETERS * i) * STANCE_LAW_ROOM];
        const double *const along = &own[ALONG * STANCE_LAW_ROOM];
        const double *const torques = &own[TORQUES * STANCE_LAW_ROOM];
        stance_output *const output = &of->output[0][i], *const other = &of->output[1][i];
        int terms = 0;
        while (terms < STANCE_MAX_COEFFICIENTS && !isnan(along[terms]))
            sum += along[terms++];
        if (terms == 0)
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "controller.outputs.y%d: along is missing: what its row follows",
                                 i + 1);
        if (is_zero(&own[ROW * STANCE_LAW_ROOM], n))
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "controller.outputs.y%d: of is missing: what it is a row of",
                                 i + 1);
        powers_of(along, terms, output->along);
        bends += terms > 1;
        output->kp = own[KP * STANCE_LAW_ROOM], output->kd = own[KD * STANCE_LAW_ROOM];
        sum += output->kp + output->kd;
        weighted += !is_zero(torques, m);
        *other = *output;
        memset(other->row, 0, sizeof other->row);
        for (int k = 0; k < n; k++) {
            sum += rows[i][k] = output->row[k] = own[ROW * STANCE_LAW_ROOM + k];
            for (int j = 0; j < n; j++)
                other->row[j] += output->row[k] * exchange->coordinate[k][j];
        }
        for (int k = 0; k < m; k++) {
            sum += output->torques[k] = torques[k];
            other->torques[exchange->actuator[k]] = exchange->sign[k] * output->torques[k];
        }
        c->servo[i] = (stance_servo){
            .kp = output->kp, .kd = output->kd, .duration = INFINITY, .integral_limit = INFINITY};
    }
    if (!isfinite(sum))
        return refuse(message, "outputs: a number is not finite");
    if (weighted != 0 && weighted != m)
        return refuse(message, "outputs: torques of some outputs and not of all");
    const bool phased = !is_zero(of->phase[0], n);
    if (phased && clocked)
        return refuse(message, "phase: give one of of and clock");
    if (bends && !phased && !clocked)
        return refuse(message, "phase.of is missing: what the outputs follow");
    const int count = bends && phased ? m + 1 : m; /* of rows that may not follow from each other */
    if (weighted == 0 && stance_rows_turn(count, n, n, rows) < count)
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "controller.outputs: the rows%s depend on each other: no torques can "
                             "hold them all",
                             bends ? " and the phase" : "");
    of->constant = weighted > 0;
    c->decouples = c->follows = true;
    return STANCE_OK;
}

const stance_law stance_law_outputs = {
    .name = "outputs",
    .text = "as many outputs as actuators, each a row over the coordinates less a polynomial of a "
            "phase, are held at zero; legs take each other's place at a footfall",
    .servos = true,
    .parameters = PARAMETERS,
    .parameter = parameters,
    .group = groups,
    .set = set,
};
