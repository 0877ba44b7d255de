/* urdf_xml.c - attributes and numbers of a URDF, each refused by its file and line.
 *
 * Files write right angles as they come (1.57, 3.1416, -1.5707963): a body turned by such an angle
 * is out of the plane by what was cut. An angle that is a multiple of pi/2 as far as its digits
 * tell, of which two at least stand behind the point, is taken as that.
 */
#include "space.h"
#include "urdf.h"

#include "runner/base/problem.h"

#include <stdlib.h>

#define BLANKS " \t\r\n"

int urdf_line(const xmlNode *node)
{
    return node ? (int)xmlGetLineNo(node) : 0;
}

const char *urdf_name(const xmlNode *node)
{
    const char *const name = (const char *)node->name, *const colon = strchr(name, ':');
    return colon ? colon + 1 : name;
}

bool urdf_is(const xmlNode *node, const char *name)
{
    return strcmp(urdf_name(node), name) == 0;
}

const xmlNode *urdf_child(const xmlNode *node, const char *name, const xmlNode *after)
{
    const xmlNode *child = after ? after->next : node ? node->children : NULL;
    while (child && (child->type != XML_ELEMENT_NODE || (name && !urdf_is(child, name))))
        child = child->next;
    return child;
}

const char *urdf_text(const xmlNode *node, const char *key)
{
    const xmlAttr *a = node ? node->properties : NULL;
    while (a && strcmp((const char *)a->name, key) != 0)
        a = a->next;
    return !a                                    ? NULL
           : a->children && a->children->content ? (const char *)a->children->content
                                                 : "";
}

bool urdf_need(const struct urdf *u, const xmlNode *node, const char *key, const char **text)
{
    *text = urdf_text(node, key);
    return (*text && **text) ||
           urdf_refuse(u, node, "<%s> has no %s=\"...\"", (const char *)node->name, key);
}

bool urdf_value(const xmlNode *node, const char *key, char text[SPATIAL_NAME])
{
    const char *from = urdf_text(node, key);
    const xmlNode *child = node ? node->children : NULL;
    while (child && child->type != XML_TEXT_NODE)
        child = child->next;
    if (!from)
        from = child ? (const char *)child->content : "";
    spatial_name(text, from + strspn(from, BLANKS));
    for (size_t end = strlen(text); end > 0 && strchr(BLANKS, text[end - 1]); end--)
        text[end - 1] = '\0';
    return text[0] != '\0';
}

/* ---- numbers -------------------------------------------------------------------------------- */

/* Numbers between blanks, and how many digits stand behind the point of each. */
static bool read_numbers(const struct urdf *u, const xmlNode *node, const char *key,
                         const char *text, int count, double *value, int *digits)
{
    const char *at = text;
    char *end, buffer[SHOWN_SIZE];
    int read = 0;
    for (; read < count; read++, at = end) {
        value[read] = strtod(at += strspn(at, BLANKS), &end);
        if (end == at || (*end && !strchr(BLANKS, *end)) || !isfinite(value[read]))
            break;
        const char *const point = memchr(at, '.', (size_t)(end - at));
        digits[read] = point ? (int)strspn(point + 1, "0123456789") : 0;
    }
    if (read == count && !at[strspn(at, BLANKS)])
        return true;
    const char *const why =
        strstr(text, "${") || strstr(text, "$(") ? "is for xacro: expand the file with it first"
        : strchr(text, ',') ? "blanks, not commas, stand between numbers, and points in them"
        : count == 1        ? "is not one number"
                            : "is not three numbers";
    return urdf_refuse(u, node, "<%s %s=\"%s\">: %s", (const char *)node->name, key,
                       shown(buffer, text), why);
}

bool urdf_numbers(const struct urdf *u, const xmlNode *node, const char *key, int count,
                  double *value, int must)
{
    int digits[3];
    const char *text = urdf_text(node, key);
    if ((must & URDF_NEEDED) && !urdf_need(u, node, key, &text))
        return false;
    if (text && !read_numbers(u, node, key, text, count, value, digits))
        return false;
    for (int i = 0; (must & URDF_POSITIVE) && i < count; i++)
        if (value[i] < 0)
            return urdf_refuse(u, node, "<%s %s=\"%s\">: less than nothing", urdf_name(node), key,
                               text);
    return true;
}

bool urdf_number(const struct urdf *u, const xmlNode *node, double *value)
{
    char text[SPATIAL_NAME];
    int digits;
    urdf_value(node, "value", text);
    return !node || read_numbers(u, node, "value", text, 1, value, &digits);
}

/* ---- places --------------------------------------------------------------------------------- */

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

bool urdf_origin(struct urdf *u, const xmlNode *of, double at[3], double rotation[3][3])
{
    const xmlNode *const origin = urdf_child(of, "origin", NULL);
    const char *const turned = urdf_text(origin, "rpy");
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double rpy[3] = {0}, turn[3][3];
    int digits[3] = {0};
    at[0] = at[1] = at[2] = 0;
    memcpy(rotation, axes, sizeof axes);
    if (!urdf_numbers(u, origin, "xyz", 3, at, 0) ||
        (turned && !read_numbers(u, origin, "rpy", turned, 3, rpy, digits)))
        return false;
    for (int i = 0; i < 3; i++) { /* Rz(yaw) Ry(pitch) Rx(roll) */
        space_rotation(axes[i], right_angle(u, rpy[i], digits[i]), turn);
        space_product(turn, rotation, rotation);
    }
    for (int i = 0; i < 9; i++) /* what right angles have left of a zero */
        if (fabs(rotation[i / 3][i % 3]) < 1e-15)
            rotation[i / 3][i % 3] = 0;
    return true;
}
