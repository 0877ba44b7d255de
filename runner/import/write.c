/* write.c - the scenario's text: comments, then keys in the order in which they are explained. */
#include "write.h"

#include "runner/base/words.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 100, TEXT = 200 };

/* ---- comments ----------------------------------------------------------------------------------
 */

/* Text of `size` bytes; what would end a line, or is no text, is shown. */
static void put_text(FILE *out, const char *text, size_t size)
{
    for (size_t i = 0; i < size;) {
        uint32_t letter;
        const size_t length = utf8_letter(text + i, size - i, &letter);
        if (length == 0 || letter < ' ' || (letter >= 0x7f && letter < 0xa0)) {
            fputc('?', out);
            i += length ? length : 1;
            continue;
        }
        if (fwrite(text + i, 1, length, out) != length)
            return;
        i += length;
    }
}

/* Words filled into lines; all but the first begin with `next`. */
static void fill(FILE *out, const char *first, const char *next, const char *text)
{
    size_t column = strlen(first);
    bool begun = false;
    fputs(first, out);
    while (*text) {
        size_t length = strcspn(text, " ");
        if (begun && column + 1 + length > WIDTH) {
            fprintf(out, "\n%s", next);
            column = strlen(next);
        } else if (begun) {
            fputc(' ', out);
            column++;
        }
        put_text(out, text, length);
        column += length;
        begun = true;
        text += length;
        text += strspn(text, " ");
    }
    fputc('\n', out);
}

static void head(FILE *out, const struct spatial_model *model, const struct plane_robot *robot)
{
    char text[2 * SPATIAL_NAME + 80];
    snprintf(text, sizeof text, "From %s (%s), by stance import.", model->file, model->format);
    fill(out, "# ", "# ", text);
    fputs("#\n# A body's frame begins at the joint to its parent; angles are counter-clockwise, x "
          "forward, z up.\n",
          out);
    if (model->notes > 0)
        fputs("# What is otherwise than in the file:\n", out);
    for (int n = 0; n < model->notes; n++)
        fill(out, "# - ", "#   ", model->note[n].text);
    if (robot->mechanism.actuators > 0 && !robot->hold)
        fputs("# No law drives the motors: `stance describe controller` lists them.\n", out);
}

/* ---- values ------------------------------------------------------------------------------------
 */

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

/* Masses, stiffnesses: sums of a few. */
static const char *number(char text[32], double value)
{
    return rounded(text, value, 8 * DBL_EPSILON * fabs(value));
}

/* m, rad: differences of places of some metres. */
static const char *place(char text[32], double value)
{
    return rounded(text, value, 8 * DBL_EPSILON * fmax(1, fabs(value)));
}

/* A mapping in braces, on several lines where it is long: what is begun with open ends with shut.
 */
struct braces {
    FILE *out;
    int indent, column;
    bool any;
};

static struct braces open_braces(FILE *out, int indent, const char *key)
{
    const struct braces b = {.out = out,
                             .indent = indent + (int)strlen(key) + 3,
                             .column = indent + (int)strlen(key) + 3};
    fprintf(out, "%*s%s: {", indent, "", key);
    return b;
}

__attribute__((format(printf, 2, 3))) static void item(struct braces *b, const char *format, ...)
{
    char text[TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const int length = (int)strlen(text);
    if (b->any)
        fputc(',', b->out);
    if (b->any && b->column + length + 3 > WIDTH) {
        fprintf(b->out, "\n%*s", b->indent, "");
        b->column = b->indent;
    } else if (b->any) {
        fputc(' ', b->out);
    }
    fputs(text, b->out);
    b->column += length + 2;
    b->any = true;
}

static void shut(struct braces *b)
{
    fputs("}\n", b->out);
}

static void one(struct braces *b, const char *key, double value)
{
    char text[32];
    item(b, "%s: %s", key, number(text, value));
}

static void at(struct braces *b, const char *key, double value)
{
    char text[32];
    item(b, "%s: %s", key, place(text, value));
}

/* What is the default is left out. */
static void unless(struct braces *b, const char *key, double value, double fallback)
{
    if (value != fallback)
        one(b, key, value);
}

static void two(struct braces *b, const char *key, const double value[2])
{
    char first[32], second[32];
    item(b, "%s: [%s, %s]", key, place(first, value[0]), place(second, value[1]));
}

static void two_unless_zero(struct braces *b, const char *key, const double value[2])
{
    if (value[0] != 0 || value[1] != 0)
        two(b, key, value);
}

/* ---- parts -------------------------------------------------------------------------------------
 */

static void body(FILE *out, const stance_mechanism *m, int k)
{
    static const char *const joints[] = {"free", "hinge", "slide", "fixed"};
    const stance_body_numbers *const n = &m->value.body[k];
    struct braces b = open_braces(out, 4, m->body[k].name);
    item(&b, "joint: %s", joints[m->body[k].joint]);
    if (m->body[k].parent >= 0)
        item(&b, "parent: %s", m->body[m->body[k].parent].name);
    two_unless_zero(&b, "at", n->at);
    if (m->body[k].joint == STANCE_SLIDE)
        two(&b, "axis", n->axis);
    if (n->angle != 0)
        at(&b, "angle", n->angle);
    unless(&b, "mass", n->mass, 0);
    unless(&b, "inertia", n->inertia, n->mass > 0 ? -1 : 0); /* of a point mass, too */
    two_unless_zero(&b, "centre", n->centre);
    unless(&b, "stiffness", n->stiffness, 0);
    unless(&b, "rest", n->rest, 0);
    unless(&b, "damping", n->damping, 0);
    unless(&b, "armature", n->armature, 0);
    if (isfinite(n->limits[0]) || isfinite(n->limits[1]))
        two(&b, "limits", n->limits);
    shut(&b);
}

static void contact(FILE *out, const stance_mechanism *m, int e)
{
    const stance_element_numbers *const n = &m->value.element[e];
    struct braces b = open_braces(out, 4, m->element[e].name);
    item(&b, "body: %s", m->body[m->element[e].body].name);
    two(&b, m->element[e].sole ? "from" : "at", n->at);
    if (m->element[e].sole)
        two(&b, "to", n->to);
    unless(&b, "radius", n->radius, 0);
    if (m->element[e].rough)
        one(&b, "friction_factor", n->friction_factor);
    shut(&b);
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
        struct braces b = open_braces(out, 4, m->actuator[a].name);
        item(&b, "body: %s", m->body[m->actuator[a].body].name);
        unless(&b, "limit", m->value.limit[a], INFINITY);
        shut(&b);
    }
}

static void ground(FILE *out, const struct plane_robot *robot)
{
    struct braces b = open_braces(out, 0, "ground");
    one(&b, "friction", robot->friction);
    if (robot->slope != 0)
        at(&b, "slope", robot->slope);
    unless(&b, "gravity", robot->gravity, STANCE_GRAVITY);
    shut(&b);
}

/* Coordinates that are not 0. */
static void initial(FILE *out, const struct plane_robot *robot)
{
    static const char *const free_names[] = {"x", "z"};
    const double *start = robot->start;
    fputs("initial:\n", out);
    struct braces b = open_braces(out, 2, "state");
    for (int k = 0; k < robot->mechanism.bodies; k++) {
        const bool free = robot->mechanism.body[k].joint == STANCE_FREE;
        for (int i = free ? 0 : 2; i < 3; i++, start++)
            if (*start != 0)
                at(&b, i < 2 ? free_names[i] : robot->mechanism.body[k].name, *start);
    }
    shut(&b);
}

/* In single quotes, of which one is two. */
static void title(FILE *out, const char *text)
{
    fputs("title: '", out);
    while (*text) {
        const size_t length = strcspn(text, "'");
        put_text(out, text, length);
        text += length;
        if (*text) {
            fputs("''", out);
            text++;
        }
    }
    fputs("'\n", out);
}

void import_write(FILE *out, const struct spatial_model *model, const struct plane_robot *robot)
{
    char text[32];
    head(out, model, robot);
    fputs("stance: 1\n", out);
    title(out, model->title[0] ? model->title : model->file);
    fputs("scene: mechanism\n\n", out);
    parts(out, &robot->mechanism);
    fputc('\n', out);
    ground(out, robot);
    fputc('\n', out);
    initial(out, robot);
    fputc('\n', out);
    if (robot->hold) {
        struct braces b = open_braces(out, 0, "controller");
        item(&b, "kind: hold");
        one(&b, "kp", robot->kp);
        one(&b, "kd", robot->kd);
        shut(&b);
        fputc('\n', out);
    }
    fprintf(out, "method: {step: %s}\nstop: {time: 5}\n", number(text, robot->step));
}
