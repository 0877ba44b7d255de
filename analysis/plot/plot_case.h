/* plot_case.h - shared by plot_case.c (curves) and plot_strip.c (stick figures). */
#ifndef STANCE_PLOT_PLOT_CASE_H
#define STANCE_PLOT_PLOT_CASE_H

#include "analysis/draw/plot.h"

/* One case with its trajectory. */
struct plot_case {
    const struct plot *plot;
    const struct results_trajectory *t;
    double settle_time, fall_time; /* s, NAN where not reached */
    bool readable;                 /* the next two are known, and fit the trajectory */
    struct scenario scenario;
    struct scenario_values values;              /* of this case */
    double equilibrium[STANCE_MAX_COORDINATES]; /* of the controller; NAN: none, or not known */
};

/* Begins a picture of the case; plot_end ends it. */
bool plot_case_begin(const struct plot_case *c, struct gnuplot *g, const char *script,
                     const char *what, stance_message *message);

/* Contacts with the ground: the first ones of a scene, before the stops of joints. */
int plot_case_grounded(const stance_scene *scene);

/* STEM-strip: stick figures at even intervals. */
bool plot_strip(const struct plot_case *c, stance_message *message);

#endif
