/* results.c - reads results files with HDF5's serial driver; trusts nothing that it finds. */
#include "file_checksums.h"
#include "results_private.h"
#include "store.h"

#include "runner/base/checksum.h"
#include "runner/base/message.h"
#include "runner/base/sandbox.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { FORMAT_VERSION = 1 };

const char *const results_kind_names[RESULTS_KIND_COUNT] = {
#define OUTCOME_NAME(NAME, name, number, text) [RESULTS_##NAME] = #name,
    STANCE_OUTCOMES(OUTCOME_NAME)
#define KIND_NAME(name, text) [RESULTS_##name] = text,
        RESULTS_OTHER_KINDS(KIND_NAME)};

const char *results_outcome_word(size_t k)
{
    return k < RESULTS_OUTCOMES ? results_kind_names[k] : NULL;
}

const char *results_kind_word(size_t k)
{
    return k < RESULTS_KIND_COUNT ? results_kind_names[k] : NULL;
}

/* ---- errors ------------------------------------------------------------------------------- */

bool results_failed(const struct results *r, const char *what, stance_message *message)
{
    char what_failed[60];
    snprintf(what_failed, sizeof what_failed, "read %.40s", what);
    return store_failed(message, r->file, what_failed);
}

bool results_damaged(const struct results *r, const char *what, stance_message *message)
{
    return complain(message, "%.100s: damaged: %.100s", r->file, what);
}

bool results_no_memory(const struct results *r, stance_message *message)
{
    return complain(message, "%.100s: not enough memory", r->file);
}

/* ---- attributes --------------------------------------------------------------------------- */

void results_copy_attribute(hid_t object, const char *name, char *buffer, size_t size)
{
    char *text = hdf_text(object, name);
    snprintf(buffer, size, "%s", text ? text : "");
    results_clean(buffer);
    free(text);
}

/* ---- datasets ----------------------------------------------------------------------------- */

size_t results_elements(const struct results *r, int rank, const hsize_t *length)
{
    hsize_t size = 0, product = 1;
    if (H5Fget_filesize((hid_t)r->id, &size) < 0)
        return 0;
    for (int d = 0; d < rank; d++) {
        if (length[d] == 0 || product > size / length[d])
            return 0;
        product *= length[d];
    }
    return (size_t)product;
}

struct results_variable results_variable(const struct results *r, const char *path)
{
    struct results_variable v = {.id = -1};
    if (!hdf_exists(r->id, path))
        return v;
    v.id = H5Dopen2(r->id, path, H5P_DEFAULT);
    v.rank = hdf_shape(v.id, v.length);
    if (v.rank < 0) {
        hdf_close(v.id);
        v.id = -1;
        return v;
    }
    const hid_t type = H5Dget_type(v.id);
    v.class = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    if (v.class != H5T_STRING && H5Tget_size(type) > sizeof(double))
        v.class = H5T_NO_CLASS;
    hdf_close(type);
    v.number = v.class == H5T_INTEGER || v.class == H5T_FLOAT;
    v.elements = results_elements(r, v.rank, v.length);
    return v;
}

size_t results_numbers(const struct results *r, const char *path, double *values, size_t room)
{
    const struct results_variable v = results_variable(r, path);
    const bool good = v.id >= 0 && v.elements > 0 && v.elements <= room && v.number &&
                      hdf_read(v.id, KIND_double, values);
    hdf_close(v.id);
    return good ? v.elements : 0;
}

/* Words of a dataset, fit to be shown. */
static char **read_words(hid_t dataset, size_t n)
{
    char **words = hdf_words(dataset, 0, n);
    for (size_t i = 0; words && i < n; i++)
        results_clean(words[i]);
    return words;
}

size_t results_words(const struct results *r, const char *path, char word[][SCENARIO_NAME],
                     size_t room)
{
    const struct results_variable v = results_variable(r, path);
    const size_t n = v.rank == 1 ? v.elements : 0;
    char **words = n && n <= room ? read_words(v.id, n) : NULL;
    hdf_close(v.id);
    for (size_t i = 0; words && i < n; i++)
        snprintf(word[i], SCENARIO_NAME, "%s", words[i]);
    hdf_free_words(words, n);
    return words ? n : 0;
}

/* ---- the axes ----------------------------------------------------------------------------- */

/* Makes of numbers among which there is an absent limit, which is infinite, words: they have no
 * distances. */
static bool list_values(struct results_axis *axis)
{
    char **word = calloc(axis->count, sizeof *word), text[128];
    bool good = word != NULL;
    for (size_t i = 0; good && i < axis->count; i++) {
        results_value_text(axis, i, false, text, sizeof text);
        word[i] = strdup(text);
        good = word[i] != NULL;
    }
    for (size_t i = 0; good && i < axis->count; i++)
        axis->value[i] = (double)i;
    if (good)
        axis->word = word;
    else
        hdf_free_words(word, word ? axis->count : 0);
    return good;
}

static bool read_axis_values(const struct results *r, const struct results_variable *v,
                             struct results_axis *axis, stance_message *message)
{
    axis->value = malloc(axis->count * sizeof *axis->value);
    if (!axis->value)
        return results_no_memory(r, message);
    if (v->class == H5T_STRING) {
        axis->word = read_words(v->id, axis->count);
        for (size_t i = 0; i < axis->count; i++)
            axis->value[i] = (double)i;
        return axis->word || results_failed(r, axis->name, message);
    }
    if (!v->number || !hdf_read(v->id, KIND_double, axis->value))
        return results_failed(r, axis->name, message);
    bool finite = true;
    for (size_t i = 0; i < axis->count; i++) {
        if (isnan(axis->value[i]))
            return results_damaged(r, "an axis has values that are no numbers", message);
        finite = finite && isfinite(axis->value[i]);
    }
    return finite || list_values(axis) || results_no_memory(r, message);
}

void results_describe(hid_t dataset, const char *name, struct results_axis *axis)
{
    snprintf(axis->name, sizeof axis->name, "%s", name);
    results_clean(axis->name);
    results_copy_attribute(dataset, "units", axis->unit, sizeof axis->unit);
    results_copy_attribute(dataset, "long_name", axis->text, sizeof axis->text);
    if (strcmp(axis->unit, "1") == 0)
        axis->unit[0] = '\0';
}

static bool read_axis(struct results *r, const char *name, stance_message *message)
{
    struct results_axis *axis = &r->axis[r->axes];
    const struct results_variable v = results_variable(r, name);
    if (v.id < 0)
        return results_failed(r, name, message);
    r->axes++;
    axis->count = v.rank == 1 ? v.elements : 0;
    axis->offset = strncmp(name, "initial.offset.", strlen("initial.offset.")) == 0;
    results_describe(v.id, name, axis);
    bool good = axis->count > 0 ? read_axis_values(r, &v, axis, message)
                                : results_damaged(r, "an axis has no values", message);
    hdf_close(v.id);
    return good;
}

static bool read_axes(struct results *r, stance_message *message)
{
    char *names = hdf_text((hid_t)r->id, "axes"), *rest = NULL;
    bool good = names != NULL;

    for (char *name = names ? strtok_r(names, ",", &rest) : NULL; good && name;
         name = strtok_r(NULL, ",", &rest)) {
        good = r->axes < SCENARIO_MAX_AXES ? read_axis(r, name, message)
                                           : results_damaged(r, "too many axes", message);
    }
    free(names);
    if (!names || (good && r->axes == 0))
        return results_damaged(r, "it does not name its axes", message);
    if (!good)
        return false;
    if (!results_read_sample(r, message))
        return false;
    r->single = r->axes == 1 && strcmp(r->axis[0].name, "case") == 0 && r->axis[0].count == 1;
    if (r->single && r->axis[0].value[0] > 0 && r->axis[0].value[0] < 0x1p53)
        r->index = (uint64_t)r->axis[0].value[0];
    return true;
}

/* ---- variables over the cases -------------------------------------------------------------- */

bool results_column_open(const struct results *r, const char *name, struct results_column *column,
                         stance_message *message)
{
    *column = (struct results_column){.id = -1};
    snprintf(column->name, sizeof column->name, "%s", name);
    const struct results_variable v = results_variable(r, name);
    if (v.id < 0)
        return !hdf_exists((hid_t)r->id, name) || results_failed(r, name, message);
    bool good = (v.rank == r->axes || v.rank == r->axes + 1) && v.number;
    for (int a = 0; good && a < r->axes; a++)
        good = v.length[a] == r->axis[a].count;
    column->width = good && v.rank > r->axes ? (size_t)v.length[v.rank - 1] : 1;
    column->id = v.id;
    column->words = hdf_text(v.id, "flag_meanings");
    if (column->words)
        results_clean(column->words);
    if (good && column->width <= SCENARIO_MAX_STATES)
        return true;
    results_column_close(column);
    return results_damaged(r, "a variable is not as its axes say", message);
}

void results_column_close(struct results_column *column)
{
    if (column->id >= 0)
        hdf_close((hid_t)column->id);
    free(column->words);
    column->id = -1;
    column->words = NULL;
}

bool results_column_read(const struct results *r, const struct results_column *column,
                         uint64_t first, size_t rows, double *values, stance_message *message)
{
    const size_t n = rows * column->width;
    if (!hdf_move((hid_t)column->id, hdf_type(KIND_double), first * column->width, n, HDF_READ,
                  values))
        return results_failed(r, column->name, message);
    for (size_t i = 0; i < n; i++) /* counts that there are none of */
        values[i] = values[i] == (double)STANCE_NO_COUNT ? NAN : values[i];
    return true;
}

/* A variable of one number a case, and room for all of `size` bytes each; NULL where it is not
 * stored (column->id < 0), or for the reason in the message (not *good). */
static void *open_single(const struct results *r, const char *name, struct results_column *column,
                         size_t size, bool *good, stance_message *message)
{
    void *room = NULL;
    *good = results_column_open(r, name, column, message);
    if (!*good || column->id < 0)
        return NULL;
    if (column->width != 1)
        *good = results_damaged(r, "a variable is not as its axes say", message);
    else if (!(room = malloc(r->cases * size)))
        *good = results_no_memory(r, message);
    return room;
}

bool results_answer(const struct results *r, const char *name, double **values,
                    stance_message *message)
{
    struct results_column column;
    bool good;
    *values = open_single(r, name, &column, sizeof **values, &good, message);
    if (column.id < 0)
        return good;
    good = good && results_column_read(r, &column, 0, r->cases, *values, message);
    results_column_close(&column);
    for (uint64_t i = 0; good && i < r->cases; i++)
        if (r->kind[i] == RESULTS_PENDING || r->kind[i] == RESULTS_FAILED)
            (*values)[i] = NAN;
    if (!good) {
        free(*values);
        *values = NULL;
    }
    return good;
}

/* ---- status, outcome, failure ------------------------------------------------------------- */

/* A code per case; NULL where the variable is not stored. Files number the failures as their
 * program did: into our numbers, by the names they bring. */
static bool read_codes(const struct results *r, const char *name, bool failures, uint8_t **codes,
                       stance_message *message)
{
    uint8_t now[UINT8_MAX + 1] = {0};
    struct results_column column;
    bool good;
    *codes = open_single(r, name, &column, sizeof **codes, &good, message);
    if (column.id < 0)
        return good;
    good = good &&
           (hdf_read((hid_t)column.id, KIND_uint8_t, *codes) || results_failed(r, name, message));
    char *rest = failures ? column.words : NULL;
    for (size_t k = 0; rest && k < sizeof now; k++) {
        const char *const word = strsep(&rest, " ");
        for (size_t f = 0; f < STANCE_FAILURE_COUNT; f++)
            now[k] = strcmp(word, stance_failure_name[f]) == 0 ? (uint8_t)f : now[k];
    }
    for (uint64_t i = 0; good && failures && column.words && i < r->cases; i++)
        (*codes)[i] = now[(*codes)[i]];
    results_column_close(&column);
    return good;
}

/* The kind of a case from its status and outcome; RESULTS_KIND_COUNT when there is no such. */
static uint8_t kind_of(uint8_t status, const uint8_t *outcome)
{
    static const uint8_t kinds[] = {
#define OUTCOME_KIND(NAME, name, number, text) [number] = RESULTS_##NAME,
        [STANCE_NONE] = RESULTS_DONE, STANCE_OUTCOMES(OUTCOME_KIND)};
    switch (status) {
    case STANCE_PENDING:
        return RESULTS_PENDING;
    case STANCE_FAILED:
        return RESULTS_FAILED;
    case STANCE_DONE:
        return !outcome                  ? RESULTS_DONE
               : *outcome < sizeof kinds ? kinds[*outcome]
                                         : RESULTS_KIND_COUNT;
    default:
        return RESULTS_KIND_COUNT;
    }
}

static bool read_kinds(struct results *r, stance_message *message)
{
    hsize_t length[SCENARIO_MAX_AXES];
    uint8_t *outcome = NULL;
    for (int a = 0; a < r->axes; a++)
        length[a] = r->axis[a].count;
    r->cases = results_elements(r, r->axes, length);
    if (r->cases == 0)
        return results_damaged(r, "it is shorter than its axes say", message);
    bool good = read_codes(r, "status", false, &r->kind, message) &&
                read_codes(r, "outcome", false, &outcome, message) &&
                read_codes(r, "failure", true, &r->failure, message) &&
                (r->kind || results_damaged(r, "it has no variable 'status'", message));
    good = good && (store_distrust(r->id, r->kind, r->cases, &r->damage) ||
                    results_failed(r, "the answers", message));
    for (uint64_t i = 0; good && i < r->cases; i++) {
        r->kind[i] = kind_of(r->kind[i], outcome ? &outcome[i] : NULL);
        good = r->kind[i] < RESULTS_KIND_COUNT ||
               results_damaged(r, "a case has a status or an outcome that does not exist", message);
    }
    free(outcome);
    return good;
}

bool ancestry_read(const struct results *r, struct ancestry *ancestry, stance_message *message)
{
    double *number = NULL;
    *ancestry = (struct ancestry){0};
    const size_t before = results_words(r, "history/date", ancestry->date, STORE_MOST_ANCESTORS);
    ancestry->scenarios = before + 1;
    snprintf(ancestry->date[before], sizeof ancestry->date[before], "%.31s", r->date);
    if (before > 0 && !results_answer(r, "scenario_number", &number, message))
        return false;
    for (uint64_t i = 0; number && i < r->cases; i++)
        if (number[i] >= 0 && number[i] <= (double)before) /* NAN: not done */
            ancestry->done[(size_t)number[i]]++;
    free(number);
    return true;
}

bool results_timing(const struct results *r, double *longest, double *total, double *cases,
                    size_t *ranks)
{
    enum { MOST_RANKS = 1 << 17 };
    double *values = malloc(MOST_RANKS * sizeof *values);
    *longest = *total = *cases = 0;
    *ranks = values ? results_numbers(r, "timing/wall_time", values, MOST_RANKS) : 0;
    for (size_t i = 0; i < *ranks; i++) {
        *total += values[i];
        *longest = fmax(*longest, values[i]);
    }
    size_t n = *ranks ? results_numbers(r, "timing/cases", values, MOST_RANKS) : 0;
    for (size_t i = 0; i < n; i++)
        *cases += values[i];
    free(values);
    return n > 0 && isfinite(*total) && *longest > 0 && *cases > 0;
}

/* ---- opening ------------------------------------------------------------------------------ */

static bool read_provenance(struct results *r, stance_message *message)
{
    hid_t id = (hid_t)r->id;
    int version = hdf_whole(id, "format_version", -1);
    r->scenario = hdf_text(id, "scenario");
    if (version < 0 || H5Aexists(id, "axes") <= 0 || !r->scenario)
        return hdf_is_no(id, r->file, "a results file of stance", message);
    if (version != FORMAT_VERSION) {
        return complain(message, "%.100s: has format version %d; this program reads version %d",
                        r->file, version, FORMAT_VERSION);
    }
    results_copy_attribute(id, "title", r->title, sizeof r->title);
    results_copy_attribute(id, "program_version", r->version, sizeof r->version);
    results_copy_attribute(id, "git_revision", r->revision, sizeof r->revision);
    results_copy_attribute(id, "date", r->date, sizeof r->date);
    results_copy_attribute(id, "hosts", r->hosts, sizeof r->hosts);
    r->ranks = hdf_whole(id, "ranks", 0);
    char shard[SHARD_TEXT];
    results_copy_attribute(id, "shard", shard, sizeof shard);
    if (!shard_parse(&r->shard, shard))
        r->shard.count = 0;
    return true;
}

static bool read_all(struct results *r, stance_message *message)
{
    r->id = hdf_open_to_read(r->file, message);
    if (r->id < 0 || !read_provenance(r, message))
        return false;
    /* What the file says of itself is as its checksums say, where it has any. */
    return file_checksums_verify(r->id, r->file, false, message) && read_axes(r, message);
}

void results_stem(const char *file, char name[RESULTS_NAME])
{
    const char *const slash = strrchr(file, '/');
    snprintf(name, RESULTS_NAME, "%s", slash ? slash + 1 : file);
    char *const dot = strrchr(name, '.');
    if (dot && dot != name && strcmp(dot, ".h5") == 0)
        *dot = '\0';
}

bool results_open(struct results *r, const char *file, stance_message *message)
{
    *r = (struct results){.id = -1, .sample = -1};
    if (strlen(file) >= sizeof r->file)
        return complain(message, "%.60s...: %s", file, strerror(ENAMETOOLONG));
    snprintf(r->file, sizeof r->file, "%s", file);
    results_stem(file, r->name);
    sandbox_limit(true);
    bool good = read_all(r, message);
    sandbox_limit(false);
    good = good && read_kinds(r, message);
    if (!good) {
        results_close(r);
        return false;
    }
    results_warn(r);
    r->read = calloc(1, sizeof *r->read);
    if (r->read && !results_scenario(r, r->read)) {
        free(r->read);
        r->read = NULL;
    }
    return true;
}

void results_close(struct results *r)
{
    for (int a = 0; a < r->axes; a++) {
        hdf_free_words(r->axis[a].word, r->axis[a].count);
        free(r->axis[a].value);
    }
    results_free_sample(r);
    scenario_drop(r->read);
    free(r->scenario);
    free(r->kind);
    free(r->failure);
    if (r->id >= 0)
        H5Fclose((hid_t)r->id);
    *r = (struct results){.id = -1};
}
