/* sources.h - what a kernel is compiled from on demand: the engine's headers and methods, embedded
 * in the program, so that no source tree is needed where it runs.
 */
#ifndef STANCE_OBJECTS_SOURCES_H
#define STANCE_OBJECTS_SOURCES_H

#include <stdbool.h>
#include <stddef.h>

/* All of them, one after the other: path, zero, text, zero ..., and an empty path. */
const char *sources(size_t *size);

/* Is this path ("engine/methods/implicit.c") among them? */
bool sources_have(const char *path);

/* Writes them below an open, empty directory. false, with errno: they do not fit there. */
bool sources_write(int directory);

/* Writes a new file of the caller's alone. false, with errno. */
bool sources_write_file(int directory, const char *path, const void *bytes, size_t size);

#endif
