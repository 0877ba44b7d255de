/* truth.h - what is known from outside: published numbers and closed forms, and what each method
 * makes of them.
 *
 * A list (scenarios/truth/truths.yaml) has a row for each truth: a scenario, what is read off its
 * first case, the number that is known and its error bar. Cases are computed in memory.
 */
#ifndef STANCE_BENCH_TRUTH_H
#define STANCE_BENCH_TRUTH_H

#include "analysis/draw/look.h"

#include "runner/plan/plan.h"
#include "runner/scenario/tree.h"

enum { TRUTH_SETS = 12, TRUTH_TRACE = 12, TRUTH_PATH = 1024 };

/* How a number is got from what is read. */
enum truth_kind {
    TRUTH_AS_READ,   /* as it is at the end */
    TRUTH_AS_TRACE,  /* sum over coordinates and rates of d(at the end)/d(at the beginning) */
    TRUTH_AS_BORDER, /* where along `border` what is read crosses `level` */
};

struct truth_row {
    const char *name, *source;
    const char *read; /* a coordinate, a rate, an answer, or `energy`; of a trace NULL */
    const char *trace[TRUTH_TRACE], *set[TRUTH_SETS];
    const char *border; /* a path; NULL: none */
    size_t traces, sets;
    double between[2], level;
    double value, bar;
    char scenario[TRUTH_PATH];
    enum truth_kind kind;
    struct mark mark; /* where the row stands */
};

struct truth_list {
    char file[TRUTH_PATH];
    struct truth_row *row; /* [rows] */
    size_t rows;
    struct tree tree; /* has the texts */
};

/* Reads a list; scenarios are beside it. False: errors on standard error, with their lines. */
bool truth_list_read(struct truth_list *list, const char *file);
void truth_list_free(struct truth_list *list);

/* What a method makes of a truth. */
struct truth_reached {
    const stance_method *method;
    double step;        /* s: that of the scenario, or a little less */
    double value;       /* NAN: none */
    const char *why;    /* there is none; NULL: there is one */
    double evaluations; /* of the case, per simulated second */
    double cost;        /* microseconds of one core per simulated second; NAN: none */
};

/* Computes it in steps `finer` times as short as the scenario's; measures the cost for about
 * `budget` seconds. False: the row does not fit its scenario, *message says how, or
 * it was said on standard error. */
bool truth_reach(struct truth_reached *reached, const struct truth_row *row,
                 const stance_method *method, double finer, double budget, stance_message *message);

/* DIRECTORY/truth.svg and .png: errors of rows[list->rows * methods], by row. */
bool truth_plot(const struct truth_list *list, const struct truth_reached *reached, size_t methods,
                struct look *look, const char *directory, stance_message *message);

#endif
