/* write.c - the scenario's text: comments, then keys in the order in which they are explained. */
#include "write.h"

#include "runner/base/message.h"
#include "runner/base/words.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 99, TEXT = 2000 };

/* Puts words, with `between` between them (0: one word), into lines, of which all but the first
 * begin with `next`; what would end a line, or is no text, is shown. */
static void fill(FILE *out, const char *first, const char *next, char between, const char *text)
{
    const size_t size = strlen(text);
    size_t column = strlen(first), length;
    fputs(first, out);
    for (size_t i = 0; i < size; i += length ? length : 1) {
        uint32_t letter;
        length = utf8_letter(text + i, size - i, &letter);
        const char *const end = strchr(text + i + 1, between);
        if (text[i] == between && column + (end ? (size_t)(end - text) - i : size - i) > WIDTH)
            column = (size_t)fprintf(out, "\n%s", next) - 1;
        else if (text[i] == between || length == 0 || letter < ' ' ||
                 (letter >= 0x7f && letter < 0xa0))
            column += fputc(text[i] == between ? ' ' : '?', out) != EOF;
        else
            column += fwrite(text + i, 1, length, out);
    }
}

static void head(FILE *out, const struct spatial_model *model, const struct plane_robot *robot)
{
    char text[2 * SPATIAL_NAME + 80];
    snprintf(text, sizeof text, "From %s (%s), by stance import.", model->file, model->format);
    fill(out, "# ", "# ", ' ', text);
    fputs(
        "\n#\n# A body's frame begins at the joint to its parent; angles are counter-clockwise, x "
        "forward, z up.\n",
        out);
    if (model->notes > 0)
        fputs("# What is otherwise than in the file:\n", out);
    for (int n = 0; n < model->notes; n++) {
        fill(out, "# - ", "#   ", ' ', model->note[n].text);
        fputc('\n', out);
    }
    if (robot->mechanism.actuators > 0 && !robot->hold)
        fputs("# No law drives the motors: `stance describe controller` lists them.\n", out);
}

/* ---- values --------------------------------------------------------------------------------- */

/* The shortest that reads back; one of 12 digits may be off by `rounding`. Readers of YAML 1.1 take
 * 2e-06 for a word, 2.0e-06 for a number. */
static const char *rounded(char text[32], double value, double rounding)
{
    snprintf(text, 32, "none");
    if (isinf(value))
        return text;
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, value + 0.0);
        const double off = fabs(strtod(text, NULL) - value);
        if (strchr(text, 'e') && fabs(value) >= 1e-4 && fabs(value) < 1e9)
            continue; /* 200, not 2e+02 */
        if (off == 0 || (digits <= 12 && off <= rounding))
            break;
    }
    char *const power = strchr(text, 'e');
    if (power && !strchr(text, '.')) {
        memmove(power + 2, power, strlen(power) + 1);
        power[0] = '.';
        power[1] = '0';
    }
    return text;
}

/* A mapping in braces, on several lines where it is long: its items have a mark between them where
 * a line may end. */
enum { MARK = 1 };
struct mapping {
    char text[TEXT];
};

__attribute__((format(printf, 2, 3))) static void item(struct mapping *m, const char *format, ...)
{
    va_list arguments;
    if (m->text[0])
        add_text(m->text, TEXT, ",%c", MARK);
    va_start(arguments, format);
    vsnprintf(m->text + strlen(m->text), TEXT - strlen(m->text), format, arguments);
    va_end(arguments);
}

static void put(FILE *out, int indent, const char *key, const struct mapping *m)
{
    char first[100];
    snprintf(first, sizeof first, "%*s%s: {", indent, "", key);
    const int column = (int)strlen(first);
    char next[100];
    snprintf(next, sizeof next, "%*s", column, "");
    fill(out, first, next, MARK, m->text);
    fputs("}\n", out);
}

/* Masses, stiffnesses: sums of a few. Not where it is what stands there unsaid. */
static void number(struct mapping *m, const char *key, double value, double unsaid)
{
    char text[32];
    if (value != unsaid)
        item(m, "%s: %s", key, rounded(text, value, 8 * DBL_EPSILON * fabs(value)));
}

/* m, rad: differences of places of some metres. */
static const char *place(char text[32], double value)
{
    return rounded(text, value, 8 * DBL_EPSILON * fmax(1, fabs(value)));
}

static void one(struct mapping *m, const char *key, double value)
{
    char text[32];
    if (value != 0)
        item(m, "%s: %s", key, place(text, value));
}

static void two(struct mapping *m, const char *key, const double value[2], double unsaid)
{
    char first[32], second[32];
    if (fabs(value[0]) != unsaid || fabs(value[1]) != unsaid)
        item(m, "%s: [%s, %s]", key, place(first, value[0]), place(second, value[1]));
}

/* ---- parts ---------------------------------------------------------------------------------- */

static void body(FILE *out, const stance_mechanism *m, int k)
{
    static const char *const joints[] = {"free", "hinge", "slide", "fixed"};
    const stance_body_numbers *const n = &m->value.body[k];
    struct mapping b = {""};
    item(&b, "joint: %s", joints[m->body[k].joint]);
    if (m->body[k].parent >= 0)
        item(&b, "parent: %s", m->body[m->body[k].parent].name);
    two(&b, "at", n->at, 0);
    if (m->body[k].joint == STANCE_SLIDE)
        two(&b, "axis", n->axis, NAN);
    one(&b, "angle", n->angle);
    number(&b, "mass", n->mass, 0);
    number(&b, "inertia", n->inertia, n->mass > 0 ? -1 : 0); /* of a point mass, too */
    two(&b, "centre", n->centre, 0);
    number(&b, "stiffness", n->stiffness, 0);
    number(&b, "rest", n->rest, 0);
    number(&b, "damping", n->damping, 0);
    number(&b, "armature", n->armature, 0);
    two(&b, "limits", n->limits, INFINITY);
    put(out, 4, m->body[k].name, &b);
}

static void contact(FILE *out, const stance_mechanism *m, int e)
{
    const stance_element_numbers *const n = &m->value.element[e];
    struct mapping b = {""};
    item(&b, "body: %s", m->body[m->element[e].body].name);
    two(&b, m->element[e].sole ? "from" : "at", n->at, NAN);
    if (m->element[e].sole)
        two(&b, "to", n->to, NAN);
    number(&b, "radius", n->radius, 0);
    number(&b, "friction_factor", n->friction_factor, 1);
    put(out, 4, m->element[e].name, &b);
}

static void parts(FILE *out, const stance_mechanism *m)
{
    fputs("robot:\n  bodies:\n", out);
    for (int k = 0; k < m->bodies; k++)
        body(out, m, k);
    if (m->elements > 0)
        fputs("  contacts:\n", out);
    for (int e = 0; e < m->elements; e++)
        contact(out, m, e);
    if (m->actuators > 0)
        fputs("  actuators:\n", out);
    for (int a = 0; a < m->actuators; a++) {
        struct mapping b = {""};
        item(&b, "body: %s", m->body[m->actuator[a].body].name);
        number(&b, "limit", m->value.limit[a], INFINITY);
        put(out, 4, m->actuator[a].name, &b);
    }
    fputc('\n', out);
}

/* The world, and coordinates that are not 0. */
static void surroundings(FILE *out, const struct plane_robot *robot)
{
    const double *start = robot->start;
    struct mapping ground = {""}, state = {""}, law = {"kind: hold"};
    number(&ground, "friction", robot->friction, NAN);
    one(&ground, "slope", robot->slope);
    number(&ground, "gravity", robot->gravity, STANCE_GRAVITY);
    put(out, 0, "ground", &ground);
    for (int k = 0; k < robot->mechanism.bodies; k++) {
        if (robot->mechanism.body[k].joint == STANCE_FREE) {
            one(&state, "x", *start++);
            one(&state, "z", *start++);
        }
        one(&state, robot->mechanism.body[k].name, *start++);
    }
    fputs("\ninitial:\n", out);
    put(out, 2, "state", &state);
    fputc('\n', out);
    if (robot->hold) {
        number(&law, "kp", robot->kp, NAN);
        number(&law, "kd", robot->kd, NAN);
        put(out, 0, "controller", &law);
        fputc('\n', out);
    }
}

void import_write(FILE *out, const struct spatial_model *model, const struct plane_robot *robot)
{
    char title[2 * SPATIAL_NAME] = "";
    struct mapping method = {""};
    head(out, model, robot);
    /* In single quotes, of which one is two. */
    for (const char *c = model->title[0] ? model->title : model->file; *c; c++)
        add_text(title, sizeof title, *c == '\'' ? "''" : "%c", *c);
    fill(out, "stance: 1\ntitle: '", "", '\0', title);
    fputs("'\nscene: mechanism\n\n", out);
    parts(out, &robot->mechanism);
    surroundings(out, robot);
    number(&method, "step", robot->step, NAN);
    put(out, 0, "method", &method);
    fputs("stop: {time: 5}\n", out);
}
