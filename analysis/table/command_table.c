/* command_table.c - `stance table FILE`: every case as a row of CSV, a block of rows at a time. */
#include "report.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"
#include "runner/base/words.h"
#include "runner/store/results.h"
#include "runner/store/store.h"

#include <stdlib.h>
#include <string.h>

extern const struct command command_table; /* below */

enum { ROWS = 4096, MOST_COLUMNS = STANCE_ANSWER_COUNT + 8, MOST_PATHS = 256 };

static const char *const answers[] = {
    "status",
#define ANSWER_NAME(name, ...) #name,
    STANCE_ANSWERS(ANSWER_NAME)
#undef ANSWER_NAME
        "final_state",
};
enum { ANSWERS = sizeof answers / sizeof answers[0] };

/* A further path of an axis of the grid. */
struct parameter {
    char name[96];
    int axis; /* over whose points */
    double *value;
};

struct listing {
    const struct results *r;
    struct table rows;
    size_t columns, parameters;
    struct results_column column[MOST_COLUMNS];
    double *block[MOST_COLUMNS]; /* [ROWS][width] */
    struct parameter parameter[MOST_PATHS];
    const char *of; /* outcome, NULL: all cases */
    bool *inferred; /* [cases] of a refined map: not simulated; NULL: none */
};

/* ---- what there is ------------------------------------------------------------------------ */

/* The answers that are stored, or those that are asked for. */
static bool open_columns(struct listing *t, const char *const *names, size_t count,
                         stance_message *message)
{
    for (size_t k = 0; k < count; k++) {
        struct results_column *column = &t->column[t->columns];
        if (!results_column_open(t->r, names[k], column, message))
            return false;
        if (column->id < 0)
            continue;
        t->block[t->columns++] = malloc(ROWS * column->width * sizeof(double));
        if (!t->block[t->columns - 1])
            return no_memory(message);
    }
    return true;
}

/* Adds a path that varies together with the first one of an axis; of words, whose values are not
 * read, none. */
static bool add_parameter(struct listing *t, const char *path, int axis)
{
    const size_t count = t->r->axis[axis].count;
    struct parameter *parameter = &t->parameter[t->parameters];
    double *value = malloc(count * sizeof *value);
    if (value && results_numbers(t->r, path, value, count) == count) {
        snprintf(parameter->name, sizeof parameter->name, "%s", path);
        parameter->axis = axis;
        parameter->value = value;
        t->parameters++;
        return true;
    }
    free(value);
    return value != NULL;
}

/* The further paths of the grid's axes, from the file's scenario. */
static bool find_parameters(struct listing *t, stance_message *message)
{
    const struct results *r = t->r;
    const struct scenario *const s = r->single ? NULL : r->read;
    bool good = true;
    for (int a = 0; s && a < s->axes && a < r->axes; a++)
        for (int k = 1; good && !s->axis[a].sample && k < s->axis[a].paths; k++)
            good = t->parameters == MOST_PATHS || add_parameter(t, s->axis[a].path[k], a);
    return good || no_memory(message);
}

/* ---- rows --------------------------------------------------------------------------------- */

static void add_columns(struct listing *t)
{
    char states[SCENARIO_MAX_STATES][SCENARIO_NAME], name[SCENARIO_NAME + 8];
    const size_t words = results_words(t->r, "state", states, SCENARIO_MAX_STATES);
    TABLE_COLUMNS(&t->rows, {.name = "case"});
    for (int a = 0; !t->r->single && a < t->r->axes; a++)
        TABLE_COLUMNS(&t->rows, {.name = t->r->axis[a].name});
    for (size_t k = 0; k < t->parameters; k++)
        TABLE_COLUMNS(&t->rows, {.name = t->parameter[k].name});
    for (int k = 0; k < t->r->varied; k++)
        TABLE_COLUMNS(&t->rows, {.name = t->r->vary[k].of.name});
    for (size_t k = 0; k < t->columns; k++) {
        const struct results_column *column = &t->column[k];
        for (size_t i = 0; i < column->width; i++) {
            if (i < words)
                snprintf(name, sizeof name, "final_%.*s", SCENARIO_NAME - 1, states[i]);
            else
                snprintf(name, sizeof name, "final_%zu", i);
            TABLE_COLUMNS(&t->rows, {.name = column->width == 1 ? column->name : name});
        }
    }
}

/* The word that a flag stands for, or its number, or "none" of an absent limit. */
static void put_flag(struct table *rows, const char *words, double value)
{
    char word[64];
    for (double k = 0; k < value && words; k++) {
        words = strchr(words, ' ');
        words = words ? words + 1 : NULL;
    }
    snprintf(word, sizeof word, "%.*s", words ? (int)strcspn(words, " ") : 0, words ? words : "");
    TABLE_VALUES(rows, words ? as_text(word) : isinf(value) ? as_text("none") : as_number(value));
}

static void put_point(struct listing *t, uint64_t index)
{
    const struct results *r = t->r;
    size_t point[SCENARIO_MAX_AXES];
    results_point(r, index, point);
    TABLE_VALUES(&t->rows, as_whole(r->single ? r->index : index));
    for (int a = 0; !r->single && a < r->axes; a++)
        TABLE_VALUES(&t->rows, as_place(&r->axis[a], point[a]));
    for (size_t k = 0; k < t->parameters; k++)
        TABLE_VALUES(&t->rows, as_number(t->parameter[k].value[point[t->parameter[k].axis]]));
    for (int k = 0; k < r->varied; k++) {
        const struct results_varied *v = &r->vary[k];
        TABLE_VALUES(&t->rows, as_varied(v, v->of.value[point[r->sample]]));
    }
}

static void put_case(struct listing *t, uint64_t first, size_t row)
{
    const uint64_t index = first + row;
    const uint8_t kind = t->r->kind[index];
    if (t->of && strcmp(t->of, results_kind_names[kind]) != 0)
        return;
    put_point(t, index);
    for (size_t k = 0; k < t->columns; k++) {
        const struct results_column *column = &t->column[k];
        /* What stands in the row of a pending case means nothing, and in files of earlier versions
         * counts of an inferred one say 0 where there is no answer. */
        const bool says = kind == RESULTS_PENDING
                              ? strcmp(column->name, "status") == 0
                              : column->words || !t->inferred || !t->inferred[index];
        for (size_t i = 0; i < column->width; i++) {
            const double value = t->block[k][row * column->width + i];
            if (!says)
                TABLE_VALUES(&t->rows, as_nothing(NULL));
            else if (column->words)
                put_flag(&t->rows, column->words, value);
            else
                TABLE_VALUES(&t->rows, as_number(value));
        }
    }
}

static bool put_rows(struct listing *t, stance_message *message)
{
    for (uint64_t first = 0, rows; first < t->r->cases; first += rows) {
        rows = t->r->cases - first < ROWS ? t->r->cases - first : ROWS;
        for (size_t k = 0; k < t->columns; k++)
            if (!results_column_read(t->r, &t->column[k], first, rows, t->block[k], message))
                return false;
        for (size_t row = 0; row < rows; row++)
            put_case(t, first, row);
        if (!table_write_csv(&t->rows, stdout) && !ferror(stdout)) /* that the program's end says */
            return no_memory(message);
        if (ferror(stdout))
            return true;
        table_clear(&t->rows);
    }
    return true;
}

/* ---- the command -------------------------------------------------------------------------- */

struct request {
    struct report report;
    struct option_texts answers;
    enum results_kind of; /* RESULTS_KIND_COUNT: all */
};

static int work(struct report *report, const struct results *r, stance_message *message)
{
    const struct request *request = (const struct request *)report;
    struct listing *t = calloc(1, sizeof *t);
    uint64_t ignored;
    if (!t)
        return EXIT_IO;
    t->r = r;
    t->of = request->of < RESULTS_KIND_COUNT ? results_kind_names[request->of] : NULL;
    const bool good =
        find_parameters(t, message) && statistics_inferred(r, &ignored, &t->inferred, message) &&
        open_columns(t, request->answers.count ? request->answers.text : answers,
                     request->answers.count ? request->answers.count : ANSWERS, message);
    if (good)
        add_columns(t);
    const bool written = good && put_rows(t, message);
    table_free(&t->rows);
    for (size_t k = 0; k < t->columns; k++) {
        results_column_close(&t->column[k]);
        free(t->block[k]);
    }
    for (size_t k = 0; k < t->parameters; k++)
        free(t->parameter[k].value);
    free(t->inferred);
    free(t);
    return written ? EXIT_DONE : EXIT_IO;
}

static int run(int argc, char **argv)
{
    struct request request = {.report = {.command = &command_table, .work = work},
                              .of = RESULTS_KIND_COUNT};
    const int code = command_begin(&command_table, argc, argv, &request);
    return code == COMMAND_GOES_ON ? report_run(&request.report) : code;
}

static const char *answer_name(size_t k)
{
    return k < ANSWERS ? answers[k] : NULL;
}

static const struct option options[] = {
    {REPORT_FILE},
    {"--answer", "NAME", OPTION_TO(struct request, answers), .word = answer_name,
     .most = MOST_COLUMNS, .text = "these answers alone, in this order; may be repeated"},
    {"--of", "OUTCOME", OPTION_TO(struct request, of), .word = results_kind_word,
     .text =
         "only cases that were stabilised, walk, rested, fell, are undecided, failed or pending"},
    {0},
};

const struct command command_table = {
    "table",
    "every case as a row of CSV",
    run,
    options,
    "Prints, as comma-separated values (RFC 4180) with a head, for each case: its number, the "
    "values of the axes, of what varies with them (further paths of an axis, sampled parameters), "
    "and its answers as the file has them: status, outcome, evidence and failure as words, "
    "numbers as short as gives the same double again, nothing for NAN, nothing but the status for "
    "cases that are pending, nothing but words for those that a refined map has inferred. Units "
    "are those of `stance describe`: SI and radians. Files of any length are read a few thousand "
    "cases at a time.\n",
    NULL,
};
