/* asked.h - what commands that look at one scenario have in common: options, reading it. */
#ifndef STANCE_PLAN_ASKED_H
#define STANCE_PLAN_ASKED_H

#include "runner/base/command.h"
#include "runner/scenario/scenario.h"

struct asked {
    const char *file;
    struct option_texts sets;
    bool trust;
};
extern const struct option asked_options[];   /* SCENARIO, --set */
extern const struct option asked_simulates[]; /* the same of commands that simulate: --trust */
/* The names of methods, NULL from the last on. */
const char *asked_method(size_t k);

/* Reads a scenario and works on it; returns an exit code. A law of the user's own is ready where it
 * is trusted; commands that simulate ask for asked_law. */
int asked_work(const struct asked *asked, int (*work)(const struct scenario *s, void *request),
               void *request);
/* The same from the command line on, of a request that begins with what is asked. */
int asked_run(const struct command *command, int argc, char **argv,
              int (*work)(const struct scenario *s, void *request), void *request);
/* A changed text of a scenario that has been asked for, with its law ready where that one's is;
 * NULL: it has been said why. */
struct scenario *asked_again(const char *file, const char *text, const char *const *sets,
                             size_t count);
/* false: cases of the scenario cannot be simulated, as its law is not trusted: it has been said. */
bool asked_law(const struct scenario *s);
/* Works on a scenario's first case; whether it exists is known when its design has been computed.
 */
int asked_first(const struct command *command, const struct scenario *s,
                int (*work)(const struct scenario *s, const stance_case *c, void *request),
                void *request);

#endif
