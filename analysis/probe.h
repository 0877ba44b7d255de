/* probe.h - finds out whether HDF5 survives a file. */
#ifndef STANCE_ANALYSIS_PROBE_H
#define STANCE_ANALYSIS_PROBE_H

#include "../engine/stance.h"

/* False, with one line in *message, when reading the file's structure kills the reader: a child
 * process calls attempt(context), which is to read as the caller will, and then walks through all
 * of it. True says nothing else: the file may still be missing, foreign or damaged in ways that
 * HDF5 reports. */
bool probe_file(const char *file, void (*attempt)(void *context), void *context,
                stance_message *message);

#endif
