/* law.h - a scenario's law of the user's own, from its text to what the scenario's cases run by;
 * and whether this user has trusted it.
 *
 * A scenario may come from anywhere, and its law may do what any program of this user may. So it is
 * compiled and called only once the user has said so, with --trust, or by a line in the file
 * `trusted` of $XDG_CONFIG_HOME/stance (~/.config/stance): the SHA-256 of its source, and whatever
 * follows. --trust adds that line.
 */
#ifndef STANCE_PLAN_LAW_H
#define STANCE_PLAN_LAW_H

#include "runner/scenario/scenario.h"

enum law_state {
    LAW_NONE,      /* the scenario names none */
    LAW_READY,     /* its cases run by it */
    LAW_UNTRUSTED, /* the message asks for --trust; its cases would command nothing */
    LAW_BROKEN,    /* the message says why, with its place */
};

/* Makes the law of a scenario ready, if that is trusted; or whether it is or not, `trust`: from now
 * on, or because another rank has asked. */
enum law_trust { LAW_ASK, LAW_TRUST, LAW_ASKED };
enum law_state law_take(struct scenario *s, enum law_trust trust, stance_message *message);
/* "controller.file: law.c is C code that you have not run yet ..." */
void law_ask(const struct scenario *s, const char *hash, stance_message *message);
/* Whether the law of a scenario is trusted, and its hash, hash[65]. */
bool law_is_trusted(const struct scenario *s, char *hash);

/* A row of commands that simulate. */
#define OPTION_TRUST(type, member)                                                                 \
    "--trust", OPTION_TO(type, member),                                                            \
        .text = "run the C code that the scenario names or holds (controller.file), now and from " \
                "now on"

#endif
