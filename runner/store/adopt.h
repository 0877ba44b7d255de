/* adopt.h - a results file whose rows another file takes over: a larger design (run_extend.c), one
 * that goes on with another scenario (changed_scenario.h), or that of several parts (merge.h).
 */
#ifndef STANCE_STORE_ADOPT_H
#define STANCE_STORE_ADOPT_H

#include "store.h"

#include "runner/plan/plan.h"

/* All 0 but for the file and its origin until more is read. */
struct adopted {
    const char *file;
    struct store_origin origin;
    struct scenario *scenario; /* that of its text, its axes as the file has them; NULL: not read */
    struct plan plan;          /* with the file's designs, once it is open */
    struct store *store;       /* open for reading; NULL: not */
};

/* The scenario of a text under the name of a file, by scenario_new; the first error is the message.
 */
struct scenario *adopt_text(const char *file, const char *text, stance_message *message);
/* False: *message says why, and nothing more is read. */
bool adopt_scenario(struct adopted *adopted, stance_message *message);
/* Once it has a scenario: rows and designs. */
bool adopt_open(struct adopted *adopted, stance_message *message);
/* All but the origin. */
void adopt_close(struct adopted *adopted);

#endif
