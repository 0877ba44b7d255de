/* schema_laws.h - the rows of the scenario format that the laws bring: of every parameter in
 * stance_laws() one, or one for each coordinate or actuator of the scene. */
#ifndef STANCE_SCENARIO_SCHEMA_LAWS_H
#define STANCE_SCENARIO_SCHEMA_LAWS_H

#include "schema.h"

/* The words of a field that may be unlimited. */
extern const char *const schema_none[1];

/* A further field made from a row; `prefix` and `name` take the place of the '*' in its path. NULL:
 * no room. */
struct scenario_field *schema_add(struct schema *schema, const struct scenario_field *row,
                                  const char *prefix, const char *name);

/* The rows of all laws, made from `row`, whose path ends in '*'. False: no room. */
bool schema_add_laws(struct schema *schema, const struct scenario_field *row);
/* What each law is, a sentence for each. */
const char *schema_describe_laws(struct schema *schema);

#endif
