/* critical.h - critical values: how far along one number an outcome is kept.
 *
 * Along an axis of the grid, from its first value on, the number is the largest value such that the
 * outcome is kept there and at all values before. Without a sample it lies for certain between two
 * neighbouring values, the last one kept and the first one lost. Values beyond at which it is kept
 * again are islands, and do not count.
 *
 * Each point of a sample (of starts, of phases of a push) has a number of its own. That of a share
 * of them is the largest value which, with all before it, at least so many keep. For the population
 * that the points are drawn from it is a quantile of their numbers, 1 - share, which order
 * statistics bound whatever the distribution is; between two of them the ends of the interval are
 * interpolated so that the level is met (J. Nyblom, Stat. Probab. Lett. 14, 1992, after T. P.
 * Hettmansperger and S. J. Sheather, ibid. 4, 1986).
 */
#ifndef STANCE_CRITICAL_CRITICAL_H
#define STANCE_CRITICAL_CRITICAL_H

#include "analysis/statistics/statistics.h"
#include "analysis/table/report.h"

/* ---- one line of values ------------------------------------------------------------------- */

/* What became of the points of a sample, or of one case, at values[count] that rise or fall. */
struct critical_line {
    size_t count;
    const double *value;
    uint32_t points; /* of the sample; 1 without one */
    /* [count] Of the points: those that have lost the outcome at or before a value, those that have
     * or may have, as a case failed or is pending, and those that do not have it at that value. */
    uint32_t *gone, *maybe, *out;
};

enum critical_end {
    CRITICAL_LOST,    /* between `kept` and `lost` */
    CRITICAL_KEPT,    /* up to the last value; `lost` is NAN */
    CRITICAL_OUTSIDE, /* lost at the first value already; `kept` is NAN */
    CRITICAL_UNKNOWN, /* none is known to be lost, and not all are known */
    CRITICAL_ENDS
};
extern const char *const critical_end_words[CRITICAL_ENDS];

struct critical_choice {
    double share; /* of the points, above 0, at most 1 */
    double level; /* of the interval */
};

/* Values that are not known, or that lie beyond the line, are NAN. */
struct critical_value {
    enum critical_end end;
    double kept, lost;  /* values between which the number is, of these points */
    size_t after;       /* place of `lost`; count: there is none */
    size_t unknown;     /* values up to there at which failed or pending cases leave it open */
    double low, high;   /* interval; of a single case the bracket, which is exact */
    double least_share; /* of the population that keeps `kept`, where the share is 1: one-sided */
};
struct critical_value critical_find(const struct critical_line *line,
                                    const struct critical_choice *choice);

/* Values beyond that are kept again: the first of them lies within from[], the last within to[],
 * whose outer ends are NAN at the end of the line. */
struct critical_island {
    double from[2], to[2];
};
/* The next one at place *at or later, which moves behind it; false: there is none. */
bool critical_next_island(const struct critical_line *line, const struct critical_choice *choice,
                          size_t *at, struct critical_island *island);

/* ---- a file ------------------------------------------------------------------------------- */

struct critical_row {
    size_t point[SCENARIO_MAX_AXES]; /* of the other axes */
    struct critical_value value;
    enum results_kind to;   /* what most of the points become that are lost at `lost` */
    double unseen;          /* widest gap between values that were simulated, up to `lost` */
    size_t island, islands; /* the first one, how many */
};

struct critical {
    const struct results *r;
    enum results_kind of;
    struct critical_choice choice;
    int along;            /* axis */
    size_t count;         /* of its values that are looked at */
    size_t *order;        /* [count] their points */
    double *value;        /* [count] */
    bool sampled, blocks; /* there is a sample, of points that hang together: no interval */
    uint32_t points;      /* of it, else 1 */
    int by[SCENARIO_MAX_AXES], by_axes; /* the other axes, but for the sample's */
    size_t rows;
    struct critical_row *row; /* [rows], row-major over by[] */
    size_t islands;
    struct critical_island *island;
};

/* Whether sweep.refine refines one axis alone of several. */
bool critical_is_refined(const struct results *r);
/* Along an axis of the grid: `path` NULL: the one that sweep.refine.along names, or the only one;
 * "PATH=FROM..TO": from FROM on, to TO at the most. *usage: it is the request that is at fault. */
bool critical_make(struct critical *critical, const struct results *r, const char *path,
                   enum results_kind of, const struct critical_choice *choice, bool *usage,
                   stance_message *message);
void critical_free(struct critical *critical);

enum { CRITICAL_SHOWN = 60 };                /* rows that people see */
extern const struct say_key critical_keys[]; /* of its JSON */
/* `within`: what the outcome was narrowed to, "" for nothing. Returns an exit code. */
int critical_print(const struct critical *critical, const char *within, enum table_form form);

#endif
