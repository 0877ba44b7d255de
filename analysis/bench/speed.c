/* speed.c - reads the table of the speed benchmarks. */
#include "speed.h"
#include "bench.h"

#include "runner/base/message.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_BYTES = 1 << 24 };

/* All of a file, which is a text; freed by the caller. */
static char *read_text(const char *path, stance_message *message)
{
    struct stat is;
    char *text = NULL;
    size_t room = 0;
    const char *wrong = stat(path, &is) != 0      ? strerror(errno)
                        : S_ISDIR(is.st_mode)     ? strerror(EISDIR)
                        : !S_ISREG(is.st_mode)    ? "not a file"
                        : is.st_size > MOST_BYTES ? "larger than 16 MiB, the most a table of "
                                                    "benchmarks may take"
                                                  : NULL;
    FILE *const file = wrong ? NULL : fopen(path, "rb");
    if (!wrong && !file)
        wrong = strerror(errno);
    else if (file && getdelim(&text, &room, '\0', file) < 0)
        wrong = "cannot be read, or empty";
    if (file)
        fclose(file);
    if (!wrong)
        return text;
    complain(message, "%.150s: %s", path, wrong);
    free(text);
    return NULL;
}

/* Cuts a line at its commas; false when there are not BENCH_COLUMN_COUNT fields. */
static bool cut(char *line, char *field[BENCH_COLUMN_COUNT])
{
    field[0] = line;
    for (int n = 1; n < BENCH_COLUMN_COUNT; n++) {
        char *comma = strchr(field[n - 1], ',');
        if (!comma)
            return false;
        *comma = '\0';
        field[n] = comma + 1;
    }
    return !strchr(field[BENCH_COLUMN_COUNT - 1], ',');
}

bool speed_read(const char *path, struct speed_table *table, stance_message *message)
{
    char *field[BENCH_COLUMN_COUNT], *rest = NULL;
    size_t lines = 1, number = 1;

    *table = (struct speed_table){0};
    table->text = read_text(path, message);
    if (!table->text)
        return false;
    for (const char *c = table->text; *c; c++)
        lines += *c == '\n';
    table->row = calloc(lines, sizeof *table->row);
    char *line = strtok_r(table->text, "\n", &rest);
    bool good = table->row && line && cut(line, field);
    for (int i = 0; i < BENCH_COLUMN_COUNT && good; i++)
        good = strcmp(field[i], bench_column_names[i]) == 0;
    while (good && (line = strtok_r(NULL, "\n", &rest)) != NULL) {
        number++;
        good = cut(line, field);
        if (good) {
            struct speed_row *const row = &table->row[table->rows++];
            memcpy(row->field, field, sizeof field);
            row->lanes = (int)strtol(field[BENCH_LANES], NULL, 10);
            row->ranks = (int)strtol(field[BENCH_RANKS], NULL, 10);
            row->cases = (int)strtol(field[BENCH_CASES], NULL, 10);
            row->median = strtod(field[BENCH_MEDIAN], NULL);
            row->lowest = strtod(field[BENCH_LOWEST], NULL);
            row->highest = strtod(field[BENCH_HIGHEST], NULL);
        }
    }
    if (!good || table->rows == 0) {
        complain(message, "%.150s:%zu: not a line of a table of benchmarks", path, number);
        speed_free(table);
        return false;
    }
    return true;
}

void speed_free(struct speed_table *table)
{
    free(table->row);
    free(table->text);
    *table = (struct speed_table){0};
}

const struct speed_row *speed_find(const struct speed_table *table, const char *subject,
                                   const char *scene, const char *regime, const char *method,
                                   const char *isa, const char *quantity)
{
    const char *const wanted[BENCH_COLUMN_COUNT] = {
        [BENCH_SUBJECT] = subject, [BENCH_SCENE] = scene, [BENCH_REGIME] = regime,
        [BENCH_METHOD] = method,   [BENCH_ISA] = isa,     [BENCH_QUANTITY] = quantity};
    const struct speed_row *found = NULL;
    for (size_t k = 0; k < table->rows; k++) {
        bool same = !found || table->row[k].lanes >= found->lanes;
        for (int c = 0; c < BENCH_COLUMN_COUNT; c++)
            same = same && (!wanted[c] || strcmp(wanted[c], table->row[k].field[c]) == 0);
        if (same)
            found = &table->row[k];
    }
    return found;
}
