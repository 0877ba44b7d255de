/* plot_model.h - the picture of a scenario's robot. */
#ifndef STANCE_PLOT_PLOT_MODEL_H
#define STANCE_PLOT_PLOT_MODEL_H

#include "analysis/draw/look.h"

/* NAME-model of the scenario in `file` with --set `sets`, into this directory unless the look says
 * otherwise: its first case, where it begins. Returns an exit code; says why on standard error. */
int plot_model(const struct command *command, const char *file, const struct option_texts *sets,
               struct look *look);

#endif
