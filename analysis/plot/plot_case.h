/* plot_case.h - shared by plot_case.c (curves), plot_strip.c (stick figures) and plot_walk.c (steps
 * and phases). */
#ifndef STANCE_PLOT_PLOT_CASE_H
#define STANCE_PLOT_PLOT_CASE_H

#include "analysis/draw/plot.h"
#include "runner/plan/ground_line.h"

/* One case with its trajectory. */
struct plot_case {
    const struct plot *plot;
    const struct results_trajectory *t;
    const struct plot_case *other; /* drawn in the same frames; NULL: none */
    struct results_trajectory trajectory;
    double settle_time, fall_time;   /* s, NAN where not reached */
    const struct scenario *scenario; /* fits the trajectory; NULL: not known, nor is what follows */
    struct scenario_values values;   /* of this case */
    double equilibrium[STANCE_MAX_COORDINATES]; /* of the controller; NAN: none, or not known */
    stance_case *floor;                         /* whose numbers the ground has; NULL: it is even */
    struct ground_pieces pieces;                /* of it */
    double reach;                               /* m, of the robot: half its size */
};

/* Loads the case at a place among the recorded ones; freed with plot_case_free. */
bool plot_case_load(struct plot_case *c, const struct plot *plot, size_t place, uint64_t index);
void plot_case_free(struct plot_case *c);
/* STEM-coordinates, -forces, -torques, -gaps and -strip; of one that steps -phase, too. */
bool plot_case(const struct plot_case *c);
/* STEM-animation of the stick figures, as GIF. */
bool plot_animation(const struct plot_case *c);

/* Begins a picture of the case; gnuplot_end ends it. */
bool plot_case_begin(const struct plot_case *c, struct gnuplot *g, const char *name,
                     const char *what);

/* A page of panels, all of columns of what it shows against time: begun where all cases are seen,
 * or between the first and the last of its marks, which are lines in each panel. */
enum shown { SHOWN_POSITIONS, SHOWN_FORCES, SHOWN_TORQUES, SHOWN_GAPS };
struct case_page {
    struct gnuplot g;
    const struct plot_case *c;
    struct plot_range time;
    enum shown shown;
    const double *mark; /* s */
    size_t marks;
};
bool plot_page_begin(struct case_page *page, const char *name, const char *what);
/* Panels of normal and tangential forces, the latter with the edges of the friction cones; of
 * torques; with their legends. */
void plot_page_forces(struct case_page *page, double height);
void plot_page_torques(struct case_page *page, double height);

/* Contacts with the ground: the first ones of a scene, before the stops of joints. */
int plot_case_grounded(const stance_scene *scene);

/* A stick figure at one instant. */
struct figure {
    double time;
    int points;
    bool open;    /* discs are drawn near their feet alone */
    bool outline; /* of discs, or of what has no joints: corners are no joints, sides the body's */
    double point[STANCE_MAX_POINTS][2];
    int foot[STANCE_MAX_POINTS];   /* the contact that a point is of; -1: none */
    bool upper[STANCE_MAX_POINTS]; /* on the side of a disc's rim away from its foot */
    double contact[STANCE_MAX_CONTACTS][2];
    double centre; /* m, what stands in the middle of its place */
    double base;   /* m, height of the ground below it */
};
/* Row of a trajectory at a time: the last one from its end on. */
size_t figure_row(const struct results_trajectory *t, double time);
void figure_make(struct figure *figure, const struct plot_case *c, size_t row);
/* Widens ranges of x and z to its points, as seen from a place. */
void figure_widen(struct plot_range range[2], const struct figure *figure, double x, double z);
/* The ground's fall along x: a slope's tangent. */
double figure_fall(const struct plot_case *c);
/* Rows x, z, 0, time of the ground at a time from x = low to high, m, moved by dx, dz, and a gap; g
 * NULL: none. Returns the lowest z. */
enum { PLOT_GROUND = 2000 };
double plot_ground(struct gnuplot *g, const struct plot_case *c, double time, struct plot_range x,
                   double dx, double dz);
/* Height z of the ground at x, m; of plates the mean about it. */
double plot_ground_base(const struct plot_case *c, double time, double x);
/* Once the rest of a case is known. */
void plot_ground_learn(struct plot_case *c);
/* Tells the script of the colours of what figure_put puts. Returns how many contacts there are. */
#define FIGURE_COLOUR "figure_colour($3)"
int figure_colours(struct gnuplot *g, const stance_scene *scene);
/* The entries of contacts, the body, perhaps the second case. */
void figure_legend(struct gnuplot *g, const struct plot_case *c);
/* Rows x, z, colour, time of its segments, each a line of its own, or of its joints and contacts;
 * the colour is a contact's number, the number of contacts: the body's. */
enum figure_part { FIGURE_SEGMENTS, FIGURE_POINTS };
void figure_put(struct gnuplot *g, const struct figure *figure, int contacts, enum figure_part part,
                double dx, double dz);

/* STEM-strip: stick figures at even intervals; of a walk its last two steps. */
bool plot_strip(const struct plot_case *c);
/* Footfalls of a case: the last ones of another foot than the one before, as the engine counts
 * them, in s, a start with both feet on the ground and an end at a footfall included; returns how
 * many. */
enum { WALK_FOOTFALLS = 1000 };
size_t walk_footfalls(const struct plot_case *c, double time[WALK_FOOTFALLS]);
/* A contact that was free and has been hit since the row before, -1: none; when. */
int walk_hit(const struct results_trajectory *t, size_t row);
double walk_landed(const struct results_trajectory *t, size_t row, size_t contact);
/* When the case ended. */
double walk_end(const struct plot_case *c);
/* Draws it, in *drawn whether there was one to draw: two steps of legs that take turns. */
bool plot_steps(const struct plot_case *c, bool *drawn);
/* STEM-phase, of legs that take turns: each angle against its rate. */
bool plot_phase(const struct plot_case *c);

/* NAME-model of the scenario in `file` with --set `sets`, into this directory unless the look says
 * otherwise: its first case, where it begins. Returns an exit code; says why on standard error. */
int plot_model(const struct command *command, const char *file, const struct option_texts *sets,
               struct look *look);

#endif
