/* urdf_xml.c - attributes and numbers of a URDF, each refused by its file and line.
 *
 * Files write right angles as they come (1.57, 3.1416, -1.5707963): a body turned by such an angle
 * is out of the plane by what was cut. An angle that is a multiple of pi/2 as far as its digits
 * tell, of which two at least stand behind the point, is taken as that.
 */
#include "urdf.h"

#include "runner/base/problem.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

void urdf_complain(const struct urdf *u, const xmlNode *at, const char *format, ...)
{
    char *const text = u->message->text;
    const size_t size = sizeof u->message->text;
    va_list arguments;
    complain(u->message, "%s:%d: ", u->path, urdf_line(at));
    va_start(arguments, format);
    vsnprintf(text + strlen(text), size - strlen(text), format, arguments);
    va_end(arguments);
}

int urdf_line(const xmlNode *node)
{
    return node ? (int)xmlGetLineNo(node) : 0;
}

const char *urdf_name(const xmlNode *node)
{
    const char *const name = (const char *)node->name, *const colon = strchr(name, ':');
    return colon ? colon + 1 : name;
}

const xmlNode *urdf_child(const xmlNode *node, const char *name, const xmlNode *after)
{
    const xmlNode *child = after ? after->next : node->children;
    while (child &&
           (child->type != XML_ELEMENT_NODE || (name && strcmp(urdf_name(child), name) != 0)))
        child = child->next;
    return child;
}

const char *urdf_text(const xmlNode *node, const char *key)
{
    const xmlAttr *a = node->properties;
    while (a && strcmp((const char *)a->name, key) != 0)
        a = a->next;
    if (!a)
        return NULL;
    return a->children && a->children->content ? (const char *)a->children->content : "";
}

bool urdf_need(const struct urdf *u, const xmlNode *node, const char *key, const char **text)
{
    *text = urdf_text(node, key);
    return (*text && **text) ||
           urdf_refuse(u, node, "<%s> has no %s=\"...\"", (const char *)node->name, key);
}

/* Blanks of XML, and of those who write it. */
static const char *past_blanks(const char *at)
{
    return at + strspn(at, " \t\r\n");
}

bool urdf_value(const xmlNode *node, char text[SPATIAL_NAME])
{
    const char *from = urdf_text(node, "value");
    const xmlNode *child = node->children;
    while (child && child->type != XML_TEXT_NODE)
        child = child->next;
    if (!from)
        from = child ? (const char *)child->content : "";
    snprintf(text, SPATIAL_NAME, "%s", past_blanks(from));
    for (size_t end = strlen(text); end > 0 && strchr(" \t\r\n", text[end - 1]); end--)
        text[end - 1] = '\0';
    return text[0] != '\0';
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* The next number of a text, and how many digits stand behind its point; false: it is none. */
static bool next_number(const char **at, double *value, int *digits)
{
    char *end;
    *at = past_blanks(*at);
    *value = strtod(*at, &end);
    if (end == *at || (*end && !strchr(" \t\r\n", *end)) || !isfinite(*value))
        return false;
    const char *const point = memchr(*at, '.', (size_t)(end - *at));
    *digits = point ? (int)strspn(point + 1, "0123456789") : 0;
    *at = end;
    return true;
}

static bool no_number(const struct urdf *u, const xmlNode *node, const char *key, const char *text,
                      int count)
{
    char buffer[SHOWN_SIZE];
    const char *const why =
        strstr(text, "${") || strstr(text, "$(") ? "is for xacro: expand the file with it first"
        : strchr(text, ',') ? "blanks, not commas, stand between numbers, and points in them"
        : count == 1        ? "is not one number"
                            : "is not three numbers";
    return urdf_refuse(u, node, "<%s %s=\"%s\">: %s", (const char *)node->name, key,
                       shown(buffer, text), why);
}

static bool read_numbers(struct urdf *u, const xmlNode *node, const char *key, const char *text,
                         int count, double *value, int *digits)
{
    const char *at = text;
    for (int i = 0; i < count; i++)
        if (!next_number(&at, &value[i], &digits[i]))
            return no_number(u, node, key, text, count);
    return !*past_blanks(at) || no_number(u, node, key, text, count);
}

bool urdf_numbers(struct urdf *u, const xmlNode *node, const char *key, int count, double *value)
{
    int digits[3];
    const char *const text = urdf_text(node, key);
    return !text || read_numbers(u, node, key, text, count, value, digits);
}

bool urdf_number(struct urdf *u, const xmlNode *node, double *value)
{
    char text[SPATIAL_NAME];
    int digits[1];
    urdf_value(node, text);
    return read_numbers(u, node, "value", text, 1, value, digits);
}

/* ---- places ---------------------------------------------------------------------------------- */

static double right_angle(struct urdf *u, double angle, int digits)
{
    const double turn = round(angle / M_PI_2) * M_PI_2, off = fabs(angle - turn);
    const double unit = pow(10, -digits);
    const bool cut = fabs(angle) < fabs(turn) && off < unit;
    if (turn == 0 || off == 0 || digits < 2 || (off > unit / 2 && !cut))
        return angle;
    u->turned++;
    return turn;
}

/* Of right angles without rounding, which else is seen in every number that follows. */
static void sine_cosine(double angle, double *sine, double *cosine)
{
    static const double of[] = {0, 1, 0, -1};
    const double quarters = round(angle / M_PI_2);
    const bool right = angle == quarters * M_PI_2 && fabs(quarters) < 100;
    const unsigned k = right ? (unsigned)(int)quarters : 0;
    *sine = right ? of[k % 4] : sin(angle);
    *cosine = right ? of[(k + 1) % 4] : cos(angle);
}

/* Rz(yaw) Ry(pitch) Rx(roll). */
static void rotation_of(const double rpy[3], double r[3][3])
{
    double s[3], c[3];
    for (int i = 0; i < 3; i++)
        sine_cosine(rpy[i], &s[i], &c[i]);
    const double of[3][3] = {
        {c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]},
        {s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]},
        {-s[1], c[1] * s[0], c[1] * c[0]}};
    for (int i = 0; i < 9; i++)
        r[i / 3][i % 3] = of[i / 3][i % 3] + 0.0; /* no -0 */
}

bool urdf_origin(struct urdf *u, const xmlNode *of, double at[3], double rotation[3][3])
{
    const xmlNode *const origin = urdf_child(of, "origin", NULL);
    const char *const turned = origin ? urdf_text(origin, "rpy") : NULL;
    double rpy[3] = {0};
    int digits[3] = {0};
    at[0] = at[1] = at[2] = 0;
    if ((origin && !urdf_numbers(u, origin, "xyz", 3, at)) ||
        (turned && !read_numbers(u, origin, "rpy", turned, 3, rpy, digits)))
        return false;
    for (int i = 0; i < 3; i++)
        rpy[i] = right_angle(u, rpy[i], digits[i]);
    rotation_of(rpy, rotation);
    return true;
}
