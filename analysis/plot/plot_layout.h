/* plot_layout.h - which two axes a map is over, and which points of the others have a panel or an
 * outline of their own. */
#ifndef STANCE_PLOT_PLOT_LAYOUT_H
#define STANCE_PLOT_PLOT_LAYOUT_H

#include "analysis/draw/plot.h"

/* How the titles of panels name their axes. */
enum plot_naming {
    PLOT_NAMES,      /* "proportional.x = 25" */
    PLOT_LAST_WORDS, /* "x = 25" */
    PLOT_VALUES_ALONE,
    PLOT_NUMBERS, /* values without their units */
};

/* Which axes are drawn, and which of the points of the others. */
struct plot_layout {
    const struct results *r;
    int x, y; /* axes of the map */
    struct plot_axis across, up;
    int others, other[SCENARIO_MAX_AXES]; /* axes of the panels, of two values or more */
    size_t shown[SCENARIO_MAX_AXES];      /* how many of their points */
    int panels;
};

/* The last two axes of numbers, and at most `most` panels; a file of two axes or more. */
void plot_layout_make(struct plot_layout *layout, const struct results *r, int most);
/* The case of a panel at points i and j of the axes of the map. */
uint64_t plot_layout_index(const struct plot_layout *layout, int panel, size_t i, size_t j);
/* Index of the m-th shown point of the k-th axis of the panels. */
size_t plot_layout_shown(const struct plot_layout *layout, int k, size_t m);
/* Per cent of a panel's cases that are done; NAN: none is. */
double plot_layout_share(const struct plot_layout *layout, int panel, enum results_kind of);
/* Two axes of panels are a table, rows of the first and columns of the second. */
bool plot_layout_is_table(const struct plot_layout *layout);
/* A note for each axis of which not all values are drawn: nobody is to take what is there for all.
 */
void plot_layout_note(const struct plot_layout *layout, struct gnuplot *g);

/* A map of numbers, one for each of the plot's cases, NAN: none. False: see plot.h. */
struct plot_number {
    const char *picture, *said, *unit, *none; /* none: the legend of cells without one */
    enum results_kind of; /* whose starts are seen to be cut, RESULTS_KIND_COUNT: of none */
    const char *name;     /* NULL: as the picture */
};
bool plot_number_map(const struct plot *plot, const struct plot_number *number,
                     const double *values);

/* Place of zero on an axis of offsets; false when it is not on the map. */
bool plot_zero_place(const struct plot_axis *along, double *place);
/* A path as the titles of panels have it. */
const char *plot_short_name(const char *path, enum plot_naming naming);
/* "friction = 0.25", or what the look has for the path and the value. */
void plot_value_title(struct gnuplot *g, const struct results_axis *axis, size_t i,
                      enum plot_naming naming, char *text, size_t size);
/* "friction = 0.25, noise = 0.1" */
void plot_panel_title(struct gnuplot *g, const struct plot_layout *layout, int panel,
                      enum plot_naming naming, char *text, size_t size);

/* ---- plot_allowed.c: what linear theory allows any controller (runner/plan/allowed.h) in a map of
 * two starts: the outline of its section by the map's plane ---- */

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
