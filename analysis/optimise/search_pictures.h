/* search_pictures.h - the pictures of `stance plot` of the file of a search, and of several. */
#ifndef STANCE_ANALYSIS_SEARCH_PICTURES_H
#define STANCE_ANALYSIS_SEARCH_PICTURES_H

#include "search_study.h"

#include "analysis/draw/gnuplot.h"

/* X(name, help): plot_search_NAME draws STEM-NAME, nothing of a search that does not call
 * for it. */
#define SEARCH_PICTURES(X)                                                                         \
    X(convergence,                                                                                 \
      "  a search            NAME-convergence: the objective of every candidate, the best so\n"    \
      "  (stance optimise)   far, what fresh starts said of the first and the chosen one, and\n"   \
      "                      what linear theory allows any controller; under it the mean of\n"     \
      "                      the distribution, and its width\n")                                   \
    X(starts,                                                                                      \
      "  ... that is         NAME-starts: the share of fresh starts that the first and the\n"      \
      "  finished            chosen one recover, and that linear theory allows, along each\n"      \
      "                      coordinate of the starts\n")
#define SEARCH_PICTURE(name, help)                                                                 \
    bool plot_search_##name(const struct search_study *study, const struct plot *plot);
SEARCH_PICTURES(SEARCH_PICTURE)
#undef SEARCH_PICTURE

/* Their curves: the first candidate, the chosen one, what linear theory allows. */
enum search_curve { SEARCH_FIRST, SEARCH_CHOSEN, SEARCH_ALLOWED, SEARCH_CURVES };
extern const struct search_style {
    const char *colour, *name;
    int dash, point;
} search_styles[SEARCH_CURVES];
struct search_curve_row {
    double x, share; /* per cent */
    struct interval interval;
};
/* A curve of the last panel, with the intervals of its shares and points of a size. */
void search_curve_put(struct gnuplot *g, enum search_curve curve,
                      const struct search_curve_row *row, size_t rows, double size);
/* Their legend, a text behind each name; NULL: that curve is not drawn. glued: what is allowed is
 * so for contacts as if glued. */
void search_curves_write(struct gnuplot *g, const char *const more[SEARCH_CURVES], bool glued);

struct search_front;
bool plot_search_front(const struct search_front *front, const struct plot *plot);
/* Its lines of help. */
#define SEARCH_FRONT_HELP                                                                          \
    "  several searches    NAME-front of the first: shares of fresh starts against the number\n"   \
    "                      that differs in their scenarios (stance summary has its table)\n"

/* Draws what a file calls for, or of several searches their front; an exit code. */
int search_draw(struct look *look, const char *const *file, size_t files);

#endif
