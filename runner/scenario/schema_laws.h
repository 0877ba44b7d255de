/* schema_laws.h - the rows of the scenario format that the laws bring: of every parameter in
 * stance_laws() one, or one for each coordinate or actuator of the scene. */
#ifndef STANCE_SCENARIO_SCHEMA_LAWS_H
#define STANCE_SCENARIO_SCHEMA_LAWS_H

#include "schema.h"

/* The words of a field that may be unlimited. */
extern const char *const schema_none[1];

/* A further field made from a row; `name`, as printf has it, takes the place of the '*' in its
 * path. NULL: no room. */
struct scenario_field *schema_add(struct schema *schema, const struct scenario_field *row,
                                  const char *name, ...) __attribute__((format(printf, 3, 4)));
/* Makes a field that of a mapping or a list, whose items have fields of their own. False: NULL. */
bool schema_group(struct scenario_field *field, enum field_type type, const char *text, ...)
    __attribute__((format(printf, 3, 4)));
/* Writes a text in which %s may stand for another. */
void schema_fill(char *text, size_t size, const char *format, const char *other);

/* The rows of all laws, made from `row`, whose path ends in '*'. False: no room. */
bool schema_add_laws(struct schema *schema, const struct scenario_field *row);
/* What each law is, a sentence for each. */
const char *schema_describe_laws(struct schema *schema);

#endif
