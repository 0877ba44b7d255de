/* adopt.h - a results file whose rows another file takes over: a larger design (run/old.c), one
 * that goes on with another scenario (changed_scenario.c), or that of several parts (merge.h). All
 * are one operation: rows that are cases of the new file, and their designs, go to their places in
 * it; what it lacks then stays pending.
 */
#ifndef STANCE_STORE_ADOPT_H
#define STANCE_STORE_ADOPT_H

#include "store.h"

#include "runner/plan/plan.h"
#include "runner/scenario/tree.h"

/* All 0 but for the file and its origin until more is read. */
struct adopted {
    const char *file;
    struct store_origin origin;
    struct scenario *scenario; /* that of its text, its axes as the file has them; NULL: not read */
    struct plan plan;          /* with the file's designs, once it is open */
    struct store *store;       /* open for reading; NULL: not */
    /* Along which axis the new file has other points; all 0: along none. */
    size_t points, all; /* of the old file and of the new one */
    size_t *position;   /* [points] of the old ones among the new ones; NULL: they are the first */
    uint64_t inner;     /* cases in one point */
};

/* What became of rows that were to be taken over; the numbers add up over calls. */
struct adopted_rows {
    bool may_stop; /* asked: where the new plan says to stop; else that is its sign of life alone */
    uint64_t copied;
    uint64_t same;        /* were there already */
    uint64_t damaged;     /* are not as their checksums say, and were left out */
    uint64_t conflicting; /* differ from what was there; left as they were */
    uint64_t conflict;    /* where the first of these is, in the file that is written */
    bool stopped;         /* the new plan said to stop: not all was looked at, which failed */
};

/* The scenario of a text under the name of a file, by scenario_new; the first error is the message.
 */
struct scenario *adopt_text(const char *file, const char *text, stance_message *message);
/* False: *message says why, and nothing more is read. */
bool adopt_scenario(struct adopted *adopted, stance_message *message);
/* Once it has a scenario: rows and designs. */
bool adopt_open(struct adopted *adopted, stance_message *message);
/* All but the origin and the points. */
void adopt_close(struct adopted *adopted);

/* The row of the new file in which a row of the old one stands, or a case. */
uint64_t adopt_row(const struct adopted *adopted, uint64_t row);
/* Once it is open: its designs into those of the new plan. Those that are taken[] already (NULL:
 * none is) stay. Returns how far they differ from its own, relative to their largest number;
 * INFINITY: one exists in one of them only. */
double adopt_designs(const struct adopted *adopted, struct plan *plan, bool *taken);
/* Once it is open: copies rows that are not pending, with their trajectories, to their places in a
 * file whose cases have the same answers, each once it has been verified; but none that lacks a
 * trajectory which the new file has. Where only that file has numbers of scenarios, the rows are of
 * the first one, 0. */
bool adopt_rows(const struct adopted *adopted, struct store *to, struct adopted_rows *rows,
                stance_message *message);
/* The largest distance of so many numbers, `stride` apart, relative to the largest of them. */
double adopt_distance(const double *x, const double *y, size_t count, size_t stride);

/* The text of a file's scenario as a tree. */
bool adopt_tree(struct tree *tree, const char *file, const char *text, stance_message *message);
/* Tells of each path below `path` at which two scenarios differ; NULL: one has nothing there. */
struct adopted_differences {
    void (*tell)(void *context, const char *path, const struct tree_node *before,
                 const struct tree_node *after);
    void *context;
};
void adopt_differ(const struct tree_node *before, const struct tree_node *after, const char *path,
                  const struct adopted_differences *differences);

/* On rank 0, with the lock: makes a file, in the place of one that there may be. It is made beside
 * it and takes its name when it is filled: a kill at any moment leaves one or the other. */
struct adopted_filling {
    bool (*fill)(void *context, struct store *store, stance_message *message);
    void *context;
    const struct store_origin *before; /* see store_create */
    int ranks;
    const char *hosts;
};
bool adopt_make(const char *file, const struct plan *plan, const struct adopted_filling *filling,
                stance_message *message);
/* Removes what an attempt which was killed has left beside a file. */
void adopt_clear(const char *file);

/* changed_scenario.c: a results file that goes on with another scenario than it was begun with.
 *
 * `run --resume --force-scenario`: what is done stays, what is pending is computed as the new
 * scenario says. The file never changes its structure: a new one is made, with the same axes,
 * designs and answers, the old scenarios in group `history` and one more variable over the cases,
 * `scenario_number`, which adopts the rows. What would not fit together is refused, with the reason
 * in *message: other axes, answers, records or designs, and any other case of a map that is
 * refined, which infers cases from each other.
 *
 * Whether a scenario, whose axes are still its own and not the file's, has the axes and the sample
 * of the file's, which is read; and of a file that is open, whether its plan may follow. */
bool changed_scenario_check_sweep(struct adopted *old, const struct scenario *scenario,
                                  stance_message *message);
bool changed_scenario_may_follow(const struct adopted *old, const struct plan *after,
                                 stance_message *message);

#endif
