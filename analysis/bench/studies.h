/* studies.h - what the commands over directories of scenarios share: options, running, reporting.
 *
 * A study is an ordinary scenario whose results one command evaluates and charts. Those that ship
 * are found below the working directory or beside the program.
 */
#ifndef STANCE_BENCH_STUDIES_H
#define STANCE_BENCH_STUDIES_H

#include "analysis/draw/gnuplot.h"
#include "analysis/table/table.h"
#include "runner/base/command.h"
#include "runner/plan/plan.h"

/* Evaluates one results file. With `object` NULL prints text and draws; else gives the same as
 * JSON. false: one line in the plot's message. */
typedef bool (*study_function)(const struct plot *plot, json_t **object);

/* What all of one kind share. */
struct study_kind {
    const char *name; /* of their directory below scenarios and results */
    /* Whether a scenario is of this kind: asked before it is run. false: one line in *message. */
    bool (*fits)(const struct scenario *s, stance_message *message);
    study_function evaluate;
};

/* Its options. */
struct studies {
    struct option_texts scenarios;
    struct look look;
    bool json, reuse;
};
extern const struct option studies_options[];

/* The whole of `stance bench KIND [SCENARIO]... [-o DIR] [--reuse] [--json]`, with the
 * options of pictures but for --picture: runs the scenarios given, by default all of
 * scenarios/KIND, into DIR (default results/KIND) and evaluates each.
 * Returns an exit code; numerical failures of cases are what such studies are about, no error. */
int studies_run(const struct command *command, const struct study_kind *kind, int argc,
                char **argv);

/* A plan with its designs; freed by the caller. False: one line in *message. */
bool study_plan(struct plan *plan, const struct scenario *s, stance_message *message);

/* The tolerance that a method uses; NAN: it does not control its error. */
double study_tolerance(const stance_method *method, const struct scenario_values *values);

#endif
