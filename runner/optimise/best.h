/* best.h - scenarios that a search makes of one: its first candidate, and its best. */
#ifndef STANCE_OPTIMISE_BEST_H
#define STANCE_OPTIMISE_BEST_H

#include "runner/store/search_file.h"

#include "runner/scenario/scenario.h"

/* The text of the scenario with the gains of its design written out, where the search varies them;
 * freed by the caller. NULL: *message says why, such as that no design exists. */
char *best_first(const struct scenario *s, stance_message *message);

/* The scenario with the chosen candidate's numbers and without its section optimise, an ordinary
 * one; freed by the caller. NULL: no memory, or a damaged text. */
char *best_text(const struct search_file *f);
/* Writes it. */
bool best_write(const struct search_file *f, const char *file, stance_message *message);

#endif
