/* search_file.c - see search_file.h. */
#include "search_file.h"
#include "build_info.h"
#include "file_checksums.h"
#include "results.h"
#include "store_private.h"

#include "runner/base/message.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define VERSION 1
enum { MOST_OVER = 3 };

/* Dimensions, then variables over them. */
static const struct entry {
    const char *name, *unit, *text;
    size_t
        offset; /* of the pointer in struct search_file; 0: of numbered points, which need none */
    enum store_kind kind;
    int over[MOST_OVER]; /* a dimension: itself */
} table[] = {
#define NUMBERS 0
#define WORDS(field) offsetof(struct search_file, field)
#define DIMENSION(NAME, name, words, text)                                                         \
    {name,                                                                                         \
     words ? NULL : "1",                                                                           \
     text,                                                                                         \
     words,                                                                                        \
     words ? KIND_text : KIND_double,                                                              \
     {SEARCH_##NAME, SEARCH_NO, SEARCH_NO}},
    SEARCH_DIMENSIONS(DIMENSION)
#define ENTRY(name, type, a, b, c, unit, text)                                                     \
    {#name,       unit,                                                                            \
     text,        offsetof(struct search_file, name),                                              \
     KIND_##type, {SEARCH_##a, SEARCH_##b, SEARCH_##c}},
        SEARCH_VARIABLES(ENTRY)};
enum { ENTRIES = sizeof table / sizeof *table };
static const struct entry *const variables = table + SEARCH_DIMENSION_COUNT,
                                 *const end = table + ENTRIES, *const other = table + SEARCH_OTHER;

/* Attributes: texts, and numbers with the type of the file and of memory. */
static const struct {
    const char *name;
    size_t offset;
    enum store_kind kind;
    bool whole; /* a text of lines, taken as it is */
} attributes[] = {
#define MEMBER(member) offsetof(struct search_file, member)
    {"title", MEMBER(title), KIND_text, false},
    {"git_revision", MEMBER(revision), KIND_text, false},
    {"date", MEMBER(date), KIND_text, false},
    {"scenario", MEMBER(scenario), KIND_text, true},
    {"first_scenario", MEMBER(first_scenario), KIND_text, true},
    {"note", MEMBER(note), KIND_text, false},
    {"chosen", MEMBER(chosen), KIND_int64_t, false},
    {"most_generations", MEMBER(most_generations), KIND_int64_t, false},
    {"most_cases", MEMBER(most_cases), KIND_double, false},
    {"finished", MEMBER(finished), KIND_int32_t, false},
    {"linear_limit", MEMBER(linear_limit), KIND_double, false},
    {"wall_time", MEMBER(seconds), KIND_double, false},
#undef MEMBER
};
enum { ATTRIBUTES = sizeof attributes / sizeof *attributes };

/* What a row of these tables is of a file. */
static void *member_of(const struct search_file *f, size_t offset)
{
    return (char *)(uintptr_t)f + offset;
}

static void **place_of(const struct search_file *f, const struct entry *e)
{
    return member_of(f, e->offset);
}

static size_t elements_of(const struct search_file *f, const struct entry *e)
{
    size_t n = 1;
    for (int d = 0; d < MOST_OVER && e->over[d] != SEARCH_NO; d++)
        n *= f->length[e->over[d]];
    return n;
}

/* ---- room ----------------------------------------------------------------------------------- */

bool search_file_room(struct search_file *f)
{
    bool good = true;
    for (const struct entry *e = table; e < end && good; e++)
        if (e->offset && !*place_of(f, e))
            good = (*place_of(f, e) = calloc(elements_of(f, e) + 1, hdf_size(e->kind))) != NULL;
    return good;
}

void search_file_copy(struct search_file *f, const struct search_file *from,
                      enum search_dimension first)
{
    for (const struct entry *e = variables; e < end; e++)
        if (e->over[0] == (int)first)
            memcpy(*place_of(f, e), *place_of(from, e), elements_of(from, e) * hdf_size(e->kind));
    f->length[first] = from->length[first];
}

void search_file_free(struct search_file *f)
{
    for (const struct entry *e = table; e < end; e++)
        if (e->kind == KIND_text && e != other)
            hdf_free_words(*place_of(f, e), elements_of(f, e));
        else if (e >= variables)
            free(*place_of(f, e));
    for (int i = 0; i < ATTRIBUTES; i++)
        if (attributes[i].kind == KIND_text)
            free(*(char **)member_of(f, attributes[i].offset));
    *f = (struct search_file){0};
}

/* ---- writing -------------------------------------------------------------------------------- */

static void put_entries(struct maker *m, const struct search_file *f)
{
    struct dimension over[SEARCH_DIMENSION_COUNT];
    for (const struct entry *e = table; e < end; e++) {
        struct dataset dataset = {e->name, e->kind, false, e->unit, e->text, .value = make_place};
        dataset.values = e->offset ? *place_of(f, e) : NULL;
        if (e < variables)
            dataset.length = elements_of(f, e);
        for (int d = 0; e >= variables && d < MOST_OVER && e->over[d] != SEARCH_NO; d++)
            dataset.over[d] = &over[e->over[d]];
        if (elements_of(f, e) > 0)
            make(m, &dataset, e < variables ? &over[e - table] : NULL);
    }
}

static void put_attributes_of(struct maker *m, const struct search_file *f)
{
    const int32_t version = VERSION;
    struct attribute list[ATTRIBUTES + 2] = {{"Conventions", KIND_text, "CF-1.8"},
                                             {"search_version", KIND_int32_t, &version}};
    for (int i = 0; i < ATTRIBUTES; i++) {
        const void *value = member_of(f, attributes[i].offset);
        if (attributes[i].kind == KIND_text)
            value = *(char *const *)value ? *(char *const *)value : "";
        list[i + 2] = (struct attribute){attributes[i].name, attributes[i].kind, value};
    }
    put_attributes(m, m->file, list, ATTRIBUTES + 2);
}

bool search_file_write(const struct search_file *f, const char *file, stance_message *message)
{
    char part[PATH_MAX];
    struct maker m;
    if (snprintf(part, sizeof part, "%s.part", file) >= (int)sizeof part)
        return store_system_failed(message, file, "write", ENAMETOOLONG);
    hdf_remember();
    unlink(part); /* of a write that was killed */
    make_file(&m, part);
    if (m.failed)
        return store_failed(message, file, "write");
    put_entries(&m, f);
    m.failed = m.failed || !file_checksums_put(m.file);
    put_attributes_of(&m, f);
    bool good = !m.failed || store_failed(message, file, "write");
    if (H5Fclose(m.file) < 0 && good)
        good = store_failed(message, file, "write");
    good = good && store_take_place(part, file, message);
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

/* A dimension that is not there has length 0; what files of before have not is nothing. */
static bool read_entry(hid_t file, struct search_file *f, const struct entry *e)
{
    hsize_t length[H5S_MAX_RANK];
    if (e >= variables && elements_of(f, e) == 0)
        return true;
    if ((e < variables || e >= end - SEARCH_ADDED) && !hdf_exists(file, e->name)) {
        double *const number = *place_of(f, e);
        for (size_t i = 0; e->kind == KIND_double && i < elements_of(f, e); i++)
            number[i] = NAN;
        return true;
    }
    const hid_t dataset = H5Dopen2(file, e->name, H5P_DEFAULT);
    const int rank = hdf_shape(dataset, length);
    if (e < variables && rank == 1)
        f->length[e - table] = (size_t)length[0];
    const size_t elements = elements_of(f, e);
    bool good = rank > 0 && rank <= MOST_OVER && hdf_elements(dataset) == elements;
    for (int d = 0; d < MOST_OVER && good; d++)
        good = d < rank ? e->over[d] != SEARCH_NO && length[d] == f->length[e->over[d]]
                        : e->over[d] == SEARCH_NO;
    if (good && e >= variables) {
        good = hdf_read(dataset, e->kind, *place_of(f, e));
    } else if (good && e->offset && e != other) {
        char **const words = *place_of(f, e) = hdf_words(dataset, 0, elements);
        for (size_t i = 0; words && i < elements; i++)
            results_clean(words[i]);
        good = words != NULL;
    }
    hdf_close(dataset);
    return good;
}

static bool read_attribute(hid_t file, struct search_file *f, int i)
{
    void *const value = member_of(f, attributes[i].offset);
    if (attributes[i].kind != KIND_text)
        return hdf_number(file, attributes[i].name, hdf_type(attributes[i].kind), value);
    char *const text = *(char **)value = hdf_text(file, attributes[i].name);
    if (text && !attributes[i].whole)
        results_clean(text);
    return text != NULL;
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

static bool read_all(hid_t file, struct search_file *f)
{
    bool good = true;
    for (const struct entry *e = table; e < variables && good; e++)
        good = read_entry(file, f, e);
    for (int i = 0; i < ATTRIBUTES && good; i++)
        good = read_attribute(file, f, i);
    good = good && search_file_room(f);
    for (const struct entry *e = variables; e < end && good; e++)
        good = read_entry(file, f, e);
    return good && places_exist(f);
}

bool search_file_read(struct search_file *f, const char *file, stance_message *message)
{
    *f = (struct search_file){.chosen = -1};
    const hid_t id = hdf_open_to_read(file, message);
    if (id < 0)
        return false;
    bool good = hdf_whole(id, "search_version", 0) == VERSION ||
                complain(message, "%.150s: not the file of a search by stance optimise", file);
    good = good && file_checksums_verify(id, file, true, message) &&
           (read_all(id, f) || complain(message, "%.150s: damaged, or not all of it there", file));
    H5Fclose(id);
    if (!good)
        search_file_free(f);
    return good;
}
