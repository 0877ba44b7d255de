/* plot_case.h - shared by plot_case.c (curves) and plot_strip.c (stick figures). */
#ifndef STANCE_PLOT_PLOT_CASE_H
#define STANCE_PLOT_PLOT_CASE_H

#include "analysis/draw/plot.h"

/* One case with its trajectory. */
struct plot_case {
    const struct plot *plot;
    const struct results_trajectory *t;
    const struct plot_case *other; /* drawn in the same frames; NULL: none */
    struct results_trajectory trajectory;
    double settle_time, fall_time; /* s, NAN where not reached */
    bool readable;                 /* the next two are known, and fit the trajectory */
    struct scenario scenario;
    struct scenario_values values;              /* of this case */
    double equilibrium[STANCE_MAX_COORDINATES]; /* of the controller; NAN: none, or not known */
};

/* Loads the case at a place among the recorded ones; freed with plot_case_free. */
bool plot_case_load(struct plot_case *c, const struct plot *plot, size_t place, uint64_t index);
void plot_case_free(struct plot_case *c);
/* STEM-coordinates, -forces, -torques, -gaps and -strip. */
bool plot_case(const struct plot_case *c);
/* STEM-animation of the stick figures, as GIF. */
bool plot_animation(const struct plot_case *c);

/* Begins a picture of the case; gnuplot_end ends it. */
bool plot_case_begin(const struct plot_case *c, struct gnuplot *g, const char *name,
                     const char *script, const char *what);

/* Contacts with the ground: the first ones of a scene, before the stops of joints. */
int plot_case_grounded(const stance_scene *scene);

/* A stick figure at one instant. */
struct figure {
    double time;
    int points;
    bool outline; /* of discs, or of what has no joints: corners are no joints, sides the body's */
    double point[STANCE_MAX_POINTS][2];
    double contact[STANCE_MAX_CONTACTS][2];
    double centre; /* m, what stands in the middle of its place */
    double base;   /* m, height of the ground below it */
};
/* Row of a trajectory at a time: the last one from its end on. */
size_t figure_row(const struct results_trajectory *t, double time);
void figure_make(struct figure *figure, const struct plot_case *c, size_t row);
/* The ground's fall along x: a slope's tangent. */
double figure_fall(const struct plot_case *c);
/* Tells the script of the contacts: contacts, contact_name[]. Returns how many. */
int figure_names(struct gnuplot *g, const stance_scene *scene);
/* Rows x, z, colour of its segments, each a line of its own, or of its joints and contacts; the
 * colour is a contact's number, the number of contacts: the body's. */
enum figure_part { FIGURE_SEGMENTS, FIGURE_POINTS };
void figure_put(struct gnuplot *g, const struct figure *figure, int contacts, enum figure_part part,
                double dx, double dz);

/* STEM-strip: stick figures at even intervals. */
bool plot_strip(const struct plot_case *c);

#endif
