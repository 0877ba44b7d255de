/* along.h - a gait followed along a number of its scenario. */
#ifndef STANCE_GAIT_ALONG_H
#define STANCE_GAIT_ALONG_H

#include "return_map.h"

#include "analysis/draw/look.h"
#include "analysis/table/table.h"

/* What is asked for: the gait at `count` values of a path, evenly from the first to the last, and
 * between them where a multiplier passes -1 (flip: steps begin to alternate) or 1 (fold: the gait
 * ends). */
struct along {
    const char *path;
    double from, to;
    size_t count;
    int steps, settle; /* as of return_map_begin */
    bool settled;      /* it is asked what each gait comes to, slightly off it */
    struct look *look; /* a picture is asked for; NULL: a table */
};

/* Times of so many steps, after so many footfalls. */
enum { ALONG_TIMES = 16, ALONG_WALKED = 200 };

/* A gait on the way. */
struct along_gait {
    double value, period, length;
    int n;
    double re[RETURN_MAP_MOST], im[RETURN_MAP_MOST], error;
    bool stable;
    const char *place;        /* "flip", "fold", "jump"; NULL: one of the values asked for */
    int settled;              /* how many step times follow; 0: it falls, or it is not asked */
    double time[ALONG_TIMES]; /* s */
};

/* Draws them. Returns an exit code; says why on standard error. */
int along_draw(const struct scenario *s, const struct along *along, const struct along_gait *gait,
               size_t count);

/* Reads "PATH=FROM..TO"; the path is in *text from then on. False: it is none. */
bool along_read(char *text, struct along *along);

/* The scenario's text without what makes cases of it, to be freed by the caller; NULL: no memory.
 */
char *along_plain(const struct scenario *s);

/* What begins a scenario at a point of the section, its second foot about so high (m) over the
 * ground: "initial={state: ...}", to be freed by the caller; NULL: no memory. */
char *along_initial(const struct return_map *map, const double *z, double height);

/* The scenario of a plain text with a number changed, of which a map is to be made: with a map of
 * before it begins near its point z, the second foot off the ground, as that may be another one
 * now. NULL: it has been said why. */
struct scenario *along_at(const char *file, const char *plain, const char *path, double value,
                          const struct return_map *map, const double *z);

/* Says in a message, if there is one, of which value it is. */
void along_blame(const char *path, double value, stance_message *message);

/* Follows it, from the values of `s` but for the path's, and says so; returns an exit code. */
int along_say(const struct scenario *s, const struct along *along, enum table_form form);

#endif
