/* urdf.h - elements of a URDF, their attributes and numbers with their places. A node may be NULL,
 * which has nothing.
 */
#ifndef RUNNER_IMPORT_URDF_H
#define RUNNER_IMPORT_URDF_H

#include "spatial.h"

#include <libxml/tree.h>

/* A file while it is read. */
struct urdf {
    struct spatial_model *model;
    spatial_message *message;
    const xmlNode *root;
    struct urdf_link *link;
    struct urdf_joint *joint;
    int links, joints, root_link;
    int turned; /* angles taken as right angles */
};

/* ... by the place of `at`. Is false. */
#define urdf_refuse(u, at, ...) spatial_refuse((u)->model, (u)->message, urdf_line(at), __VA_ARGS__)
int urdf_line(const xmlNode *node);
/* An element's name without a prefix: gazebo's, drake's. */
const char *urdf_name(const xmlNode *node);
bool urdf_is(const xmlNode *node, const char *name);
/* The first child element of a name, or with NULL of any, that comes after `after` (NULL: the
 * first); NULL: there is none. */
const xmlNode *urdf_child(const xmlNode *node, const char *name, const xmlNode *after);
#define EACH_IN(child, node, name)                                                                 \
    for (const xmlNode *child = urdf_child(node, name, NULL); child;                               \
         child = urdf_child(node, name, child))
/* An attribute's text; NULL: there is none. */
const char *urdf_text(const xmlNode *node, const char *key);
/* The text of an attribute that must be there, and say something. False: refused. */
bool urdf_need(const struct urdf *u, const xmlNode *node, const char *key, const char **text);
/* What an element says as an attribute, or between its tags, cut; false: nothing. */
bool urdf_value(const xmlNode *node, const char *key, char text[SPATIAL_NAME]);

/* Numbers of an attribute; value[count] stays as it is where it is missing. False: refused. */
enum { URDF_NEEDED = 1, URDF_POSITIVE = 2 };
bool urdf_numbers(const struct urdf *u, const xmlNode *node, const char *key, int count,
                  double *value, int must);
/* The number that an element says as `value="..."` or between its tags; stays without a node. */
bool urdf_number(const struct urdf *u, const xmlNode *node, double *value);
/* <origin> of an element: none is no offset. */
bool urdf_origin(struct urdf *u, const xmlNode *of, double at[3], double rotation[3][3]);

#endif
