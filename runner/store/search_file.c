/* search_file.c - see search_file.h. */
#include "search_file.h"
#include "build_info.h"
#include "file_checksums.h"
#include "store_make.h"

#include "runner/base/message.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define VERSION 1
enum { MOST_OVER = 3 };

struct entry {
    const char *name, *unit, *text;
    size_t size, offset; /* of an element; of the pointer in struct search_file */
    enum store_kind kind;
    int over[MOST_OVER];
};

static const struct entry table[] = {
#define ENTRY(name, type, a, b, c, unit, text)                                                     \
    {#name,                                                                                        \
     unit,                                                                                         \
     text,                                                                                         \
     sizeof(type),                                                                                 \
     offsetof(struct search_file, name),                                                           \
     KIND_##type,                                                                                  \
     {SEARCH_##a, SEARCH_##b, SEARCH_##c}},
    SEARCH_VARIABLES(ENTRY) SEARCH_ADDED(ENTRY)
#undef ENTRY
};
#define ONE(...) +1
enum { ENTRIES = sizeof table / sizeof *table, ENTRIES_AT_FIRST = 0 SEARCH_VARIABLES(ONE) };
#undef ONE

/* Offset of a dimension's words; 0: its points are numbered. */
static const struct {
    const char *name;
    size_t words;
} dimensions[SEARCH_DIMENSION_COUNT] = {
#define NUMBERS 0
#define WORDS(field) offsetof(struct search_file, field)
#define DIMENSION(NAME, name, words) {name, words},
    SEARCH_DIMENSIONS(DIMENSION)
#undef DIMENSION
};

static char ***words_of(const struct search_file *f, int d)
{
    return (char ***)(void *)((char *)(uintptr_t)f + dimensions[d].words);
}

/* Attributes: texts, and numbers with the type of the file and of memory. */
static const struct {
    const char *name;
    size_t offset;
    enum store_kind kind;
    bool text;
} attributes[] = {
#define TEXT(name, member)                                                                         \
    {                                                                                              \
        name, offsetof(struct search_file, member), KIND_uint8_t, true                             \
    }
#define NUMBER(name, type, member)                                                                 \
    {                                                                                              \
        name, offsetof(struct search_file, member), KIND_##type, false                             \
    }
    TEXT("git_revision", revision),
    TEXT("date", date),
    TEXT("scenario", scenario),
    TEXT("first_scenario", first_scenario),
    TEXT("note", note),
    NUMBER("chosen", int64_t, chosen),
    NUMBER("most_generations", int64_t, most_generations),
    NUMBER("most_cases", double, most_cases),
    NUMBER("finished", int32_t, finished),
    NUMBER("linear_limit", double, linear_limit),
    NUMBER("wall_time", double, seconds),
};
enum { ATTRIBUTES = sizeof attributes / sizeof *attributes };

static void *attribute_of(const struct search_file *f, int i)
{
    return (char *)(uintptr_t)f + attributes[i].offset;
}

/* ---- room ----------------------------------------------------------------------------------- */

static void **place_of(struct search_file *f, const struct entry *e)
{
    return (void **)(void *)((char *)f + e->offset);
}

static size_t elements_of(const struct search_file *f, const struct entry *e)
{
    size_t n = 1;
    for (int d = 0; d < MOST_OVER && e->over[d] != SEARCH_NO; d++)
        n *= f->length[e->over[d]];
    return n;
}

bool search_file_room(struct search_file *f)
{
    bool good = true;
    for (int i = 0; i < ENTRIES && good; i++) {
        *place_of(f, &table[i]) = calloc(elements_of(f, &table[i]) + 1, table[i].size);
        good = *place_of(f, &table[i]) != NULL;
    }
    for (int d = 0; d < SEARCH_DIMENSION_COUNT && good; d++)
        if (dimensions[d].words && !*words_of(f, d))
            good = (*words_of(f, d) = calloc(f->length[d] + 1, sizeof(char *))) != NULL;
    return good;
}

void search_file_copy(struct search_file *f, const struct search_file *from,
                      enum search_dimension first)
{
    for (int i = 0; i < ENTRIES; i++)
        if (table[i].over[0] == (int)first)
            memcpy(*place_of(f, &table[i]),
                   *place_of((struct search_file *)(uintptr_t)from, &table[i]),
                   elements_of(from, &table[i]) * table[i].size);
}

void search_file_free(struct search_file *f)
{
    for (int d = 0; d < SEARCH_DIMENSION_COUNT; d++)
        if (dimensions[d].words && d != SEARCH_OTHER)
            hdf_free_words(*words_of(f, d), f->length[d]);
    for (int i = 0; i < ENTRIES; i++)
        free(*place_of(f, &table[i]));
    free(f->title);
    for (int i = 0; i < ATTRIBUTES; i++)
        if (attributes[i].text)
            free(*(char **)attribute_of(f, i));
    *f = (struct search_file){0};
}

/* ---- writing -------------------------------------------------------------------------------- */

static bool put_dimension(hid_t file, const struct search_file *f, int d, int *count,
                          struct dimension *dimension)
{
    static const char *const text[SEARCH_DIMENSION_COUNT] = {
        [SEARCH_CANDIDATE] = "number of the candidate",
        [SEARCH_GENERATION] = "number of the generation",
        [SEARCH_CONFIRMED] = "number of the candidate that was tried from fresh starts",
        [SEARCH_START] = "number of the fresh start"};
    const struct variable variable = {dimensions[d].name, KIND_double, "1", text[d], .flags = NULL};
    if (dimensions[d].words)
        return make_words(count, file, dimensions[d].name, (const char *const *)*words_of(f, d),
                          f->length[d], dimension);
    return make_numbers(count, file, &variable, f->length[d], NULL, NULL, dimension);
}

static bool put_variables(hid_t file, const struct search_file *f)
{
    struct dimension over[SEARCH_DIMENSION_COUNT];
    int count = 0;
    bool good = true;
    for (int d = 0; d < SEARCH_DIMENSION_COUNT && good; d++)
        good = f->length[d] == 0 || put_dimension(file, f, d, &count, &over[d]);
    for (int i = 0; i < ENTRIES && good; i++) {
        const struct entry *const e = &table[i];
        const struct dimension *list[MOST_OVER];
        int rank = 0;
        if (elements_of(f, e) == 0)
            continue;
        while (rank < MOST_OVER && e->over[rank] != SEARCH_NO) {
            list[rank] = &over[e->over[rank]];
            rank++;
        }
        const struct variable variable = {e->name, e->kind, e->unit, e->text, .flags = NULL};
        good = put_variable(file, &variable, list, rank, *place_of((struct search_file *)f, e));
    }
    return good;
}

static bool put_attributes(hid_t file, const struct search_file *f)
{
    bool good = put_text(file, "Conventions", "CF-1.8") && put_text(file, "title", f->title) &&
                put_int(file, "search_version", VERSION);
    for (int i = 0; good && i < ATTRIBUTES; i++) {
        void *const value = attribute_of(f, i);
        char *const text = attributes[i].text ? *(char **)value : NULL;
        good = attributes[i].text ? put_text(file, attributes[i].name, text ? text : "")
                                  : put_number(file, attributes[i].name, attributes[i].kind, value);
    }
    return good;
}

/* So that the name never stands for less than what has come to the disk. */
static bool sync_file(const char *file)
{
    const int descriptor = open(file, O_RDWR | O_CLOEXEC);
    const bool good = descriptor >= 0 && fsync(descriptor) == 0;
    return (descriptor < 0 || close(descriptor) == 0) && good;
}

bool search_file_write(const struct search_file *f, const char *file, stance_message *message)
{
    char part[PATH_MAX];
    if (snprintf(part, sizeof part, "%s.part", file) >= (int)sizeof part)
        return store_system_failed(message, file, "write", ENAMETOOLONG);
    hdf_remember();
    unlink(part); /* of a write that was killed */
    const hid_t id = store_create_hdf(part);
    if (id < 0)
        return store_failed(message, file, "write");
    bool good = put_variables(id, f) && file_checksums_put(id) && put_attributes(id, f);
    good = good || store_failed(message, file, "write");
    if (H5Fclose(id) < 0 && good)
        good = store_failed(message, file, "write");
    good = good && ((sync_file(part) && rename(part, file) == 0) ||
                    store_system_failed(message, file, "write", errno));
    if (!good)
        unlink(part);
    return good;
}

/* ---- reading -------------------------------------------------------------------------------- */

bool search_file_is(const char *file)
{
    stance_message ignored;
    const hid_t id = hdf_open_to_read(file, &ignored);
    const bool is = id >= 0 && hdf_whole(id, "search_version", 0) > 0;
    if (id >= 0)
        H5Fclose(id);
    return is;
}

/* The length of a dimension; 0: it is not there. */
static bool read_length(hid_t file, struct search_file *f, int d)
{
    hsize_t length[H5S_MAX_RANK];
    if (!hdf_exists(file, dimensions[d].name))
        return true;
    const hid_t dataset = H5Dopen2(file, dimensions[d].name, H5P_DEFAULT);
    const bool good =
        dataset >= 0 && hdf_shape(dataset, length) == 1 && hdf_elements(dataset) == length[0];
    f->length[d] = good ? (size_t)length[0] : 0;
    if (good && dimensions[d].words && d != SEARCH_OTHER)
        *words_of(f, d) = hdf_words(dataset, 0, f->length[d]);
    const bool has_words = !dimensions[d].words || *words_of(f, d);
    hdf_close(dataset);
    return good && has_words;
}

static bool read_variable(hid_t file, struct search_file *f, const struct entry *e)
{
    hsize_t length[H5S_MAX_RANK];
    if (elements_of(f, e) == 0)
        return true;
    if (e >= table + ENTRIES_AT_FIRST && !hdf_exists(file, e->name)) { /* an older file lacks it */
        double *const number = *place_of(f, e);
        for (size_t i = 0; e->kind == KIND_double && i < elements_of(f, e); i++)
            number[i] = NAN;
        return true;
    }
    const hid_t dataset = H5Dopen2(file, e->name, H5P_DEFAULT);
    int rank = 0;
    while (rank < MOST_OVER && e->over[rank] != SEARCH_NO)
        rank++;
    bool good = dataset >= 0 && hdf_shape(dataset, length) == rank &&
                hdf_elements(dataset) == elements_of(f, e);
    for (int d = 0; d < rank && good; d++)
        good = length[d] == f->length[e->over[d]];
    good = good && hdf_read(dataset, e->kind, *place_of(f, e));
    hdf_close(dataset);
    return good;
}

static bool read_attributes(hid_t file, struct search_file *f)
{
    bool good = (f->title = hdf_text(file, "title")) != NULL;
    for (int i = 0; good && i < ATTRIBUTES; i++) {
        void *const value = attribute_of(f, i);
        good = attributes[i].text
                   ? (*(char **)value = hdf_text(file, attributes[i].name)) != NULL
                   : hdf_number(file, attributes[i].name, hdf_type(attributes[i].kind), value);
    }
    return good;
}

/* Numbers that others use as places. */
static bool places_exist(const struct search_file *f)
{
    const int64_t candidates = (int64_t)f->length[SEARCH_CANDIDATE];
    const int64_t generations = (int64_t)f->length[SEARCH_GENERATION];
    bool good = candidates > 0 && generations > 0 && f->length[SEARCH_PARAMETER] > 0 &&
                f->length[SEARCH_OTHER] == f->length[SEARCH_PARAMETER] &&
                f->length[SEARCH_CIRCUMSTANCE] > 0 && f->length[SEARCH_KIND] > 0 &&
                f->chosen < (int64_t)f->length[SEARCH_CONFIRMED];
    for (int64_t c = 0; good && c < candidates; c++)
        good = f->of_generation[c] >= 0 && f->of_generation[c] < generations;
    for (int64_t g = 0; good && g < generations; g++)
        good = f->best[g] >= 0 && f->best[g] < candidates && f->starts[g] > 0 &&
               f->candidates[g] > (g ? f->candidates[g - 1] : 0) && f->candidates[g] <= candidates;
    for (size_t k = 0; good && k < f->length[SEARCH_CONFIRMED]; k++)
        good = f->confirmed_candidate[k] < candidates && f->confirmed_generation[k] < generations;
    return good && f->candidates[generations - 1] == candidates;
}

bool search_file_read(struct search_file *f, const char *file, stance_message *message)
{
    *f = (struct search_file){.chosen = -1};
    const hid_t id = hdf_open_to_read(file, message);
    if (id < 0)
        return false;
    bool good = hdf_whole(id, "search_version", 0) == VERSION ||
                complain(message, "%.150s: not the file of a search by stance optimise", file);
    good = good && file_checksums_verify(id, file, NULL, NULL, true, message);
    if (good) {
        for (int d = 0; d < SEARCH_DIMENSION_COUNT && good; d++)
            good = read_length(id, f, d);
        good = good && read_attributes(id, f) && search_file_room(f);
        for (int i = 0; i < ENTRIES && good; i++)
            good = read_variable(id, f, &table[i]);
        good = (good && places_exist(f)) ||
               complain(message, "%.150s: damaged, or not all of it there", file);
    }
    H5Fclose(id);
    if (!good)
        search_file_free(f);
    return good;
}
