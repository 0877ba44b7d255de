/* load.h - a compiled object becomes a kernel of this process. */
#ifndef STANCE_OBJECTS_LOAD_H
#define STANCE_OBJECTS_LOAD_H

#include "image.h"
#include "objects.h"

/* Loads an image from memory: a library, to be closed before the descriptor (-1: none). */
bool load_library(const struct image *image, void **library, int *descriptor,
                  stance_message *message);

/* The same of a kernel. object->kernel says scene, method and instruction set; the rest of it
 * is filled in. */
bool load_object(const struct image *image, struct object *object, stance_message *message);

/* Whether an object computes what the reference does, in every bit, in as many checks as take so
 * long, spread over all. true where there is nothing to compare with. */
bool load_check(const struct object *object, const stance_kernel *reference,
                const struct objects_request *request, double seconds, stance_message *message);

#endif
