/* file_checksums.h - checksums over what a results file holds besides its rows: the axes, the
 * groups `design` and `history`, the names and instants of the trajectories, the scenario's text.
 *
 * Each such variable has an attribute `checksum`: CRC-32C over its name (without the group) and its
 * elements in their order; numbers as eight little-endian bytes (int64 or double), the name and
 * words with a zero after each. The attribute `scenario_sha256` is of the scenario's text.
 */
#ifndef STANCE_STORE_FILE_CHECKSUMS_H
#define STANCE_STORE_FILE_CHECKSUMS_H

#include "engine/stance.h"

#include <stdbool.h>
#include <stdint.h>

#define CHECKSUM_ATTRIBUTE "checksum"

/* Gives every such variable its attribute. `file`: HDF5 identifier of a file open for writing, all
 * of whose variables exist. */
bool file_checksums_put(int64_t file);

/* Verifies them, and the scenario's text by its own. False, with the one-line reason in *message,
 * which begins with `name`: something is damaged or cannot be read. `strict`: a variable without
 * checksum is damaged, and everything in the file must open. */
bool file_checksums_verify(int64_t file, const char *name, bool strict, stance_message *message);

#endif
