#!/usr/bin/python3
"""Adds one law, one outcome, one answer, one method and one picture to a copy of the tree.

    adding.py COPY

Each as the page of its room says (engine/README.md, analysis/README.md). Prints a line "KIND PLACES
FILE ..." for each: the files that it touched.
"""
import os
import re
import sys

COPY = sys.argv[1]


def read(name):
    with open(os.path.join(COPY, name), encoding="utf-8") as file:
        return file.read()


def write(name, text):
    with open(os.path.join(COPY, name), "w", encoding="utf-8") as file:
        file.write(text)


def put(name, pattern, text):
    """Puts text behind the one place that matches; a new file where there is no pattern."""
    if pattern is None:
        assert not os.path.exists(os.path.join(COPY, name)), name
        write(name, text)
        return
    old = read(name)
    found = list(re.finditer(pattern, old, re.M))
    assert len(found) == 1, f"{name}: {len(found)} places match {pattern}"
    end = found[0].end()
    write(name, old[:end] + text + old[end:])


LAW = """/* damped.c - a brake in each joint: torque = -damping rate. */
#include "engine/stance.h"

#include <math.h>

static const stance_parameter parameters[] = {
    {{"damping", "N m s/rad", "damping of every joint", NAN, 0, 1e9}, .required = true},
};

static stance_error set(const stance_scene *scene, const double *value, const double *begin,
                        stance_linear_law *linear, stance_case *c, stance_message *message)
{
    (void)begin, (void)c, (void)message;
    for (int i = 0; i < scene->actuators; i++)
        for (int k = 0; k < scene->postures; k++)
            if (scene->posture[k] == scene->actuated[i])
                linear->gain[i][scene->postures + k] = value[0];
    return STANCE_OK;
}

const stance_law stance_law_damped = {
    .name = "damped", .text = "a brake in each joint", .parameters = 1, .parameter = parameters,
    .set = set};
"""

PICTURE = """/* plot_ends.c - how many of the cases had ended by each time. */
#include "analysis/draw/plot.h"

#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bool plot_ends(const struct plot *plot)
{
    const struct results *r = plot->r;
    double *end = NULL;
    struct gnuplot g;
    if (!gnuplot_begin(&g, plot, "ends"))
        return false;
    gnuplot_say(&g, "How many have ended by each time");
    if (gnuplot_needs(&g, results_answer(r, "end_time", &end, plot->message)) && end &&
        gnuplot_keep(&g, end)) {
        qsort(end, r->cases, sizeof *end, by_value);
        gnuplot_axis(&g, 'x', PLOT_LINEAR, (struct plot_range){0, end[r->cases - 1]}, "end_time", "s");
        gnuplot_panel(&g, 300, "");
        gnuplot_axis(&g, 'y', PLOT_LINEAR, (struct plot_range){0, (double)r->cases}, "cases", "");
        gnuplot_series(&g, "using 1:2 with steps lc rgb hue[1]");
        for (uint64_t i = 0; i < r->cases; i++)
            GNUPLOT_ROW(&g, end[i], (double)(i + 1));
    }
    return gnuplot_end(&g);
}
"""

ADDITIONS = {
    "picture": [
        ("analysis/plot/plot_ends.c", None, PICTURE),
        ("analysis/draw/plot.h", r"^#define PLOT_PICTURES\(X\) .*\\$",
         "\n    X(ends, \"  any sweep           NAME-ends: how many cases have ended by each time\\n\") \\"),
    ],
    "law": [
        ("engine/laws/damped.c", None, LAW),
        ("engine/stance.h", r"^    X\(none\)", " X(damped)"),
    ],
    "outcome": [
        ("engine/stance.h", r"^    X\(UNDECIDED, undecided,.*$",
         " \\\n    X(FLEW, flew, 6, \"left the ground for good\")"),
        ("engine/core/loop/judge.h", r"^    v\.fell = .*$",
         "\n    v.flew = live & mask_less(lanes_of(2.9), b->now.gap[0]);"),
        ("analysis/draw/style.gp", r"^colour_fell = .*$", "\ncolour_flew = 0x123456"),
    ],
    "answer": [
        ("engine/stance.h", r"^    X\(peak_torque, .*\\$",
         "\n    X(highest, double, MAX, own, \"m\", \"largest height\") \\"),
        ("engine/core/loop/judge.h", r"^    account_told\(b, all, ok, TOLD_each, report\);$",
         "\n    account_largest(all, ok, b->now.gap[0] + 0.1, &b->answer.highest);"),
    ],
    "method": [
        ("engine/methods/middle.c", None, None),
        ("Makefile", r"^METHODS = implicit\b", " middle"),
    ],
}


def main():
    for kind, edits in ADDITIONS.items():
        for name, pattern, text in edits:
            if kind == "method" and pattern is None:
                text = read("engine/methods/midpoint.c").replace("midpoint", "middle")
            put(name, pattern, text)
        places = sorted({name for name, _, _ in edits})
        print(kind, len(places), *places)


main()
