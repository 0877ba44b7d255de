/* plot_allowed.h - what linear theory allows any controller (runner/plan/allowed.h) in a map of
 * two starts: the outline of its section by the map's plane. */
#ifndef STANCE_PLOT_PLOT_ALLOWED_H
#define STANCE_PLOT_PLOT_ALLOWED_H

#include "plot_layout.h"

/* Dashes of style.gp: of the one line of a picture, and of those that are thin beside several. */
enum { PLOT_ALLOWED_ONE = 11, PLOT_ALLOWED_EACH };

struct plot_allowed_point {
    double place[2], angle; /* of the ray from inside */
    bool edge;              /* the picture ends before the set does */
};

/* Of a panel: around the section, counter-clockwise; points 0: there is none. */
struct plot_allowed_panel {
    struct plot_allowed_point *point;
    size_t points;
    double share; /* of the panel's starts; NAN: not known */
    bool glued;   /* see allowed.h */
};

struct plot_allowed {
    int panels; /* 0: the picture shows none */
    struct plot_allowed_panel *panel;
};

/* Of the panels of a layout, over its axes as a picture has them, in the picture's memory; where
 * the plot asks for it. Says on standard error where there is none, and why. False: no memory, or
 * no scenario, which the picture then lacks. */
bool plot_allowed_make(struct plot_allowed *allowed, struct gnuplot *g,
                       const struct plot_layout *layout, const struct plot_axis along[2]);

bool plot_allowed_same(const struct plot_allowed_panel *a, const struct plot_allowed_panel *b);
/* A series of lines, as gnuplot has their style; none of it stands on the picture's edges. */
void plot_allowed_write(const struct plot_allowed_panel *panel, struct gnuplot *g,
                        const char *style);
/* Where any of `count` panels has one, an entry of the legend, with the share where all have the
 * same. */
void plot_allowed_legend(const struct plot_allowed_panel *panel, int count, int dash,
                         struct gnuplot *g);

#endif
