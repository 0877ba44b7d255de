/* speed.h - the table of the speed benchmarks (see analysis/bench/bench.h), read back and drawn. */
#ifndef STANCE_BENCH_SPEED_H
#define STANCE_BENCH_SPEED_H

#include "bench.h"

#include "analysis/draw/gnuplot.h"
#include "engine/stance.h"

/* A line: its texts, which point into the table's, and what of them are numbers. */
struct speed_row {
    char *field[BENCH_COLUMN_COUNT];
    int lanes, ranks, cases; /* 0: does not apply */
    double median, lowest, highest;
};

struct speed_table {
    size_t rows;
    struct speed_row *row;
    char *text;
};

/* Reads a CSV file with the columns of bench_csv_head. False, with a message: it cannot be read or
 * is no such table. */
bool speed_read(const char *path, struct speed_table *table, stance_message *message);
void speed_free(struct speed_table *table);

/* The row with these words (NULL: whatever), or NULL: of several that of most lanes, the last. */
const struct speed_row *speed_find(const struct speed_table *table, const char *subject,
                                   const char *scene, const char *regime, const char *method,
                                   const char *isa, const char *quantity);

/* STEM: bars, and the wall time of a map. */
bool speed_plot(const struct speed_table *table, const struct plot *plot);

#endif
