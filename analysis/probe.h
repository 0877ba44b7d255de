/* probe.h - finds out whether HDF5 survives a file. */
#ifndef STANCE_ANALYSIS_PROBE_H
#define STANCE_ANALYSIS_PROBE_H

#include "../engine/stance.h"

/* False, with one line in *message, when reading the file's structure kills the reader. True says
 * nothing else: the file may still be missing, foreign or damaged in ways that HDF5 reports. */
bool probe_file(const char *file, stance_message *message);

#endif
