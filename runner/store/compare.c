/* compare.c - walks through two results files and compares variables and attributes. */
#include "compare.h"

#include "file_checksums.h"
#include "results_private.h"
#include "store_private.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 1 << 18 }; /* elements read at a time */

/* ---- lists of names ----------------------------------------------------------------------- */

struct names {
    char **name;
    size_t count;
    bool failed;
};

static void names_add(struct names *names, const char *name)
{
    char **larger = realloc(names->name, (names->count + 1) * sizeof *larger);
    if (larger)
        names->name = larger;
    char *own = larger ? strdup(name) : NULL;
    names->failed = names->failed || !own;
    if (own)
        names->name[names->count++] = own;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Sorts, and drops what is there twice. */
static void names_unite(struct names *names)
{
    size_t kept = 0;
    if (names->count > 0)
        qsort(names->name, names->count, sizeof *names->name, by_name);
    for (size_t i = 0; i < names->count; i++)
        if (kept > 0 && strcmp(names->name[i], names->name[kept - 1]) == 0)
            free(names->name[i]);
        else
            names->name[kept++] = names->name[i];
    names->count = kept;
}

static void names_free(struct names *names)
{
    for (size_t i = 0; i < names->count; i++)
        free(names->name[i]);
    free(names->name);
}

static herr_t add_link(hid_t group, const char *name, const H5L_info_t *info, void *names)
{
    (void)group, (void)info;
    if (strcmp(name, "timing") != 0 && strncmp(name, "timing/", 7) != 0)
        names_add(names, name);
    return 0;
}

static bool is_listed(const char *name, const char *const *list)
{
    for (; *list; list++)
        if (strcmp(name, *list) == 0)
            return true;
    return false;
}

static herr_t add_attribute(hid_t object, const char *name, const H5A_info_t *info, void *names)
{
    /* What ties dimensions together holds addresses within the file; checksums say what the values
     * say. */
    static const char *const structure[] = {"DIMENSION_LIST", "REFERENCE_LIST", CHECKSUM_ATTRIBUTE,
                                            NULL};
    (void)object, (void)info;
    if (!is_listed(name, structure))
        names_add(names, name);
    return 0;
}

/* ---- differences -------------------------------------------------------------------------- */

/* A new entry, or NULL without memory; valid until the next. */
static struct compare_difference *add_difference(struct comparison *comparison, const char *name,
                                                 const char *reason)
{
    struct compare_difference *difference =
        realloc(comparison->difference, (comparison->count + 1) * sizeof *difference);
    if (!difference)
        return NULL;
    comparison->difference = difference;
    difference += comparison->count++;
    *difference = (struct compare_difference){.differing = 0};
    snprintf(difference->name, sizeof difference->name, "%s", name);
    results_clean(difference->name);
    snprintf(difference->reason, sizeof difference->reason, "%s", reason);
    comparison->beyond += strcmp(reason, "values") != 0;
    return difference;
}

static bool unreadable(const struct results *r, const char *name, stance_message *message)
{
    return complain(message, "%.100s: damaged: cannot read %.80s", r->file, name);
}

void compare_free(struct comparison *comparison)
{
    free(comparison->difference);
    *comparison = (struct comparison){0};
}

/* ---- elements in memory, in the widest type of their kind ---------------------------------- */

/* Elements of a variable or an attribute in memory. */
enum value_kind { VALUE_REAL, VALUE_INTEGER, VALUE_NATURAL, VALUE_TEXT, VALUE_OTHER };

struct values {
    enum value_kind kind;
    size_t count;
    union {
        double *real;
        int64_t *integer;
        uint64_t *natural;
        char **text;
        void *any;
    } data;
};

static enum value_kind value_kind_of(hid_t type)
{
    switch (H5Tget_class(type)) {
    case H5T_FLOAT:
        return H5Tget_size(type) <= sizeof(double) ? VALUE_REAL : VALUE_OTHER;
    case H5T_INTEGER:
        return H5Tget_size(type) > sizeof(int64_t) ? VALUE_OTHER
               : H5Tget_sign(type) == H5T_SGN_NONE ? VALUE_NATURAL
                                                   : VALUE_INTEGER;
    case H5T_STRING:
        return VALUE_TEXT;
    default:
        return VALUE_OTHER;
    }
}

static uint64_t bits_of(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static void values_free(struct values *values)
{
    if (values->kind == VALUE_TEXT)
        hdf_free_words(values->data.text, values->count);
    else
        free(values->data.any);
    values->data.any = NULL;
}

/* Reads elements [at, at + count) of a dataset, or the `count` ones of an attribute. Those of
 * VALUE_OTHER are left. False: nothing is left allocated. */
static bool values_read(hid_t object, hsize_t at, hid_t type, size_t count, struct values *values)
{
    *values = (struct values){.kind = value_kind_of(type), .count = count};
    if (values->kind == VALUE_OTHER)
        return true;
    if (values->kind == VALUE_TEXT) {
        values->data.text = hdf_words(object, at, count);
        return values->data.text != NULL;
    }
    const hid_t native = values->kind == VALUE_REAL      ? H5T_NATIVE_DOUBLE
                         : values->kind == VALUE_INTEGER ? H5T_NATIVE_INT64
                                                         : H5T_NATIVE_UINT64;
    values->data.any = malloc(count * sizeof(double) + 1);
    const bool good =
        values->data.any && hdf_move(object, native, at, count, HDF_READ, values->data.any);
    if (!good)
        values_free(values);
    return good;
}

/* To the bit, but for NANs. Both are of the same kind. */
static bool values_same(const struct values *a, const struct values *b, size_t i)
{
    switch (a->kind) {
    case VALUE_REAL: /* of NANs alone the bits do not matter; 0 and -0 differ */
        return bits_of(a->data.real[i]) == bits_of(b->data.real[i]) ||
               (isnan(a->data.real[i]) && isnan(b->data.real[i]));
    case VALUE_TEXT:
        return strcmp(a->data.text[i], b->data.text[i]) == 0;
    case VALUE_INTEGER:
    case VALUE_NATURAL:
        return a->data.natural[i] == b->data.natural[i];
    default:
        return true;
    }
}

/* The beginning of a text in quotation marks, in whole letters; damaged bytes are no letters. */
static void values_quote(const char *before, const char *letters, char text[COMPARE_TEXT])
{
    enum { SHOWN = 60 };
    int shown = 0;
    while (letters[shown]) {
        int length = results_letter(letters + shown);
        length = length > 0 ? length : 1;
        if (shown + length > SHOWN)
            break;
        shown += length;
    }
    snprintf(text, COMPARE_TEXT, "%s'%.*s'", before, shown, letters);
    results_clean(text);
}

/* An element for people. */
static void values_text(const struct values *values, size_t i, char text[COMPARE_TEXT])
{
    switch (values->kind) {
    case VALUE_REAL:
        snprintf(text, COMPARE_TEXT, "%.17g", values->data.real[i]);
        break;
    case VALUE_INTEGER:
        snprintf(text, COMPARE_TEXT, "%lld", (long long)values->data.integer[i]);
        break;
    case VALUE_NATURAL:
        snprintf(text, COMPARE_TEXT, "%llu", (unsigned long long)values->data.natural[i]);
        break;
    default:
        values_quote("", values->data.text[i], text);
    }
}

/* ---- variables ---------------------------------------------------------------------------- */

/* A variable, or an attribute, that both files have. */
struct compared {
    const char *name;
    const struct results *const *r; /* [2] */
    hid_t object[2], type[2];
    int rank;
    hsize_t length[H5S_MAX_RANK];
    size_t elements;
    size_t width;                              /* elements per case; 0: it is not over the cases */
    const struct compare_tolerance *tolerance; /* NULL: bit for bit */
    const uint64_t *list;                      /* cases of a trajectory; NULL: rows are the cases */
};

static bool is_pending(const struct results *r, uint64_t index)
{
    uint64_t row = r->single ? 0 : index;
    return row < r->cases && r->kind[row] == RESULTS_PENDING;
}

/* Whether element i counts: rows of cases that either file lacks do not, `status` tells of them. */
static bool counts(const struct compared *v, size_t i)
{
    if (v->width == 0 || strcmp(v->name, "status") == 0)
        return true;
    uint64_t index = v->list ? v->list[i / v->width] : i / v->width;
    return !is_pending(v->r[0], index) && !is_pending(v->r[1], index);
}

/* Two texts: shows them from a little before the first letter that differs. */
static void show_texts(struct compare_place *place, const char *a, const char *b)
{
    size_t same = 0;
    while (a[same] && a[same] == b[same])
        same++;
    size_t from = same > 20 ? same - 20 : 0;
    while (from > 0 && ((unsigned char)a[from] & 0xc0) == 0x80) /* within a letter */
        from--;
    values_quote(from ? "..." : "", a + from, place->value[0]);
    values_quote(from ? "..." : "", b + from, place->value[1]);
}

static struct compare_place place_of(const struct compared *v, size_t i, size_t within,
                                     const struct values values[2])
{
    struct compare_place place = {.component = v->width ? i % v->width : 0};
    const uint64_t row = v->width ? i / v->width : i;
    place.index = v->list ? v->list[row] : v->width && v->r[0]->single ? v->r[0]->index : row;
    if (values[0].kind == VALUE_TEXT) {
        show_texts(&place, values[0].data.text[within], values[1].data.text[within]);
    } else {
        values_text(&values[0], within, place.value[0]);
        values_text(&values[1], within, place.value[1]);
    }
    return place;
}

/* |a - b|; INFINITY where one of them is no number. */
static double distance_of(const struct values values[2], size_t k)
{
    double number[2];
    for (int f = 0; f < 2; f++) {
        number[f] = values[f].kind == VALUE_REAL      ? values[f].data.real[k]
                    : values[f].kind == VALUE_INTEGER ? (double)values[f].data.integer[k]
                                                      : NAN;
    }
    const double distance = fabs(number[0] - number[1]);
    return isnan(distance) ? INFINITY : distance;
}

static bool is_close(const struct compare_tolerance *tolerance, const struct values values[2],
                     size_t k, double distance)
{
    if (!isfinite(distance))
        return false;
    const double size = values[0].kind == VALUE_REAL
                            ? fmax(fabs(values[0].data.real[k]), fabs(values[1].data.real[k]))
                            : fmax(fabs((double)values[0].data.integer[k]),
                                   fabs((double)values[1].data.integer[k]));
    return distance <= tolerance->absolute + tolerance->relative * size;
}

/* Compares elements [first, first + n) that have been read. *last is the row noted last. */
static bool compare_block(struct comparison *comparison, const struct compared *v, size_t first,
                          const struct values values[2], struct compare_difference **difference,
                          size_t *last)
{
    for (size_t k = 0; k < values[0].count; k++) {
        const size_t i = first + k, row = v->width ? i / v->width : i;
        const bool noted = *difference && (*difference)->differing > 0 && *last == row;
        if (values_same(&values[0], &values[1], k) || !counts(v, i) || (noted && !v->tolerance))
            continue;
        if (!*difference) { /* the first difference */
            if (!(*difference = add_difference(comparison, v->name, "values")))
                return false;
            (*difference)->cases = v->width > 0;
            (*difference)->several = v->width > 1;
            (*difference)->of = v->width ? v->elements / v->width : v->elements;
        }
        if (v->tolerance) {
            const double distance = distance_of(values, k);
            if (distance > (*difference)->largest) {
                (*difference)->largest = distance;
                (*difference)->largest_place = place_of(v, i, k, values);
            }
            if (noted || is_close(v->tolerance, values, k, distance))
                continue;
        }
        *last = row;
        comparison->beyond += (*difference)->differing++ == 0;
        if ((*difference)->shown < COMPARE_SHOWN)
            (*difference)->place[(*difference)->shown++] = place_of(v, i, k, values);
    }
    return true;
}

static bool compare_values(struct comparison *comparison, const struct compared *v,
                           stance_message *message)
{
    size_t last = 0;
    struct compare_difference *difference = NULL;
    bool good = true;

    for (size_t at = 0; at < v->elements && good; at += BLOCK) {
        const size_t n = v->elements - at < BLOCK ? v->elements - at : BLOCK;
        struct values values[2] = {{.kind = VALUE_OTHER}, {.kind = VALUE_OTHER}};
        for (int f = 0; f < 2 && good; f++) {
            good = values_read(v->object[f], at, v->type[f], n, &values[f]) ||
                   unreadable(v->r[f], v->name, message);
        }
        good = good &&
               (compare_block(comparison, v, at, values, &difference, &last) || no_memory(message));
        values_free(&values[0]);
        values_free(&values[1]);
    }
    return good;
}

/* How the elements belong to cases. `list` is what trajectories are over. */
static void find_rows(struct compared *v, const uint64_t *list, size_t list_count)
{
    uint64_t rows = 0;
    if (store_is_column(v->name)) {
        rows = v->r[0]->cases;
    } else if (store_is_track(v->name) && v->rank > 0 && v->length[0] == list_count) {
        rows = list_count;
        v->list = list;
    }
    v->width = rows && v->elements % rows == 0 ? (size_t)(v->elements / rows) : 0;
    v->list = v->width ? v->list : NULL;
}

/* What holds for a variable: its own tolerance, or that of all; NULL: none. */
static const struct compare_tolerance *tolerance_of(const struct comparison *comparison,
                                                    const struct compared *v)
{
    const struct compare_tolerances *all = comparison->tolerances;
    const enum value_kind kind = value_kind_of(v->type[0]);
    const struct compare_tolerance *found = NULL;
    if (!all || !(kind == VALUE_REAL || (kind == VALUE_INTEGER && store_is_column(v->name))))
        return NULL;
    for (size_t i = 0; i < all->count; i++) {
        const struct compare_tolerance *tolerance = &all->tolerance[i];
        if (tolerance->name && strcmp(tolerance->name, v->name) == 0)
            return tolerance;
        found = tolerance->name ? found : tolerance;
    }
    return found;
}

static bool open_variable(struct compared *v, const hid_t object[2], const char **differs)
{
    hsize_t length[2][H5S_MAX_RANK];
    int rank[2];
    for (int f = 0; f < 2; f++) {
        v->object[f] = object[f];
        v->type[f] = hdf_type_of(object[f]);
        rank[f] = hdf_shape(object[f], length[f]);
        if (v->type[f] < 0 || rank[f] < 0)
            return false;
    }
    v->rank = rank[0];
    memcpy(v->length, length[0], sizeof v->length);
    v->elements = results_elements(v->r[0], rank[0], length[0]);
    const bool attribute = H5Iget_type(object[0]) == H5I_ATTR;
    const enum value_kind kind = value_kind_of(v->type[0]), other = value_kind_of(v->type[1]);
    const bool texts = kind == VALUE_TEXT && other == VALUE_TEXT;
    if (attribute && kind == other && v->elements == results_elements(v->r[1], rank[1], length[1]))
        return v->elements < BLOCK; /* they are read at once */
    if (!attribute && (rank[0] != rank[1] ||
                       memcmp(length[0], length[1], (size_t)rank[0] * sizeof length[0][0]) != 0))
        *differs = "shapes";
    else if (!attribute && kind == VALUE_OTHER)
        *differs = "types that stance does not write";
    else if (attribute || (!texts && H5Tequal(v->type[0], v->type[1]) <= 0))
        *differs = "types";
    return true;
}

static bool compare_variable(struct comparison *comparison, const struct results *const r[2],
                             const hid_t object[2], const char *name, const uint64_t *list,
                             size_t list_count, stance_message *message)
{
    struct compared v = {.name = name, .r = r, .type = {-1, -1}};
    const char *differs = NULL;
    bool good = open_variable(&v, object, &differs) || unreadable(r[0], name, message);
    if (good && differs) {
        good = add_difference(comparison, name, differs) || no_memory(message);
    } else if (good) {
        good = v.elements > 0 || unreadable(r[0], name, message);
        if (good) {
            find_rows(&v, list, list_count);
            v.tolerance = tolerance_of(comparison, &v);
            good = compare_values(comparison, &v, message);
        }
    }
    hdf_close(v.type[0], v.type[1]);
    return good;
}

/* ---- attributes --------------------------------------------------------------------------- */

static bool compare_attribute(struct comparison *comparison, const struct results *const r[2],
                              const hid_t object[2], const char *owner, const char *attribute_name,
                              stance_message *message)
{
    const hid_t attribute[2] = {H5Aopen(object[0], attribute_name, H5P_DEFAULT),
                                H5Aopen(object[1], attribute_name, H5P_DEFAULT)};
    char name[192];
    snprintf(name, sizeof name, "attribute %.80s%s%.80s", owner, owner[0] ? ":" : "",
             attribute_name);
    const bool good = compare_variable(comparison, r, attribute, name, NULL, 0, message);
    hdf_close(attribute[0], attribute[1]);
    return good;
}

/* All attributes of an object that both files have; `owner` "" is the file itself. */
static bool compare_attributes(struct comparison *comparison, const struct results *const r[2],
                               const hid_t object[2], const char *owner, stance_message *message)
{
    static const char *const provenance[] = {
        "program_version", "git_revision", "compiler", "library_versions",
        "instruction_set", "ranks",        "hosts",    "date",
        "merged_from",     "merge_note",   "shard",    NULL};
    struct names names = {0};
    bool good = true;
    char name[192];

    for (int f = 0; f < 2 && good; f++) {
        good =
            H5Aiterate2(object[f], H5_INDEX_NAME, H5_ITER_INC, NULL, add_attribute, &names) >= 0 ||
            unreadable(r[f], "attributes", message);
    }
    good = good && (!names.failed || no_memory(message));
    names_unite(&names);
    for (size_t i = 0; good && i < names.count; i++) {
        if (!owner[0] && is_listed(names.name[i], provenance))
            continue;
        bool has[2] = {H5Aexists(object[0], names.name[i]) > 0,
                       H5Aexists(object[1], names.name[i]) > 0};
        if (has[0] && has[1]) {
            good = compare_attribute(comparison, r, object, owner, names.name[i], message);
        } else {
            snprintf(name, sizeof name, "attribute %.80s%s%.80s", owner, owner[0] ? ":" : "",
                     names.name[i]);
            good = add_difference(comparison, name,
                                  has[0] ? "only in the first file" : "only in the second file") ||
                   no_memory(message);
        }
    }
    names_free(&names);
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

static bool compare_object(struct comparison *comparison, const struct results *const r[2],
                           const char *name, const uint64_t *list, size_t list_count,
                           stance_message *message)
{
    bool has[2] = {H5Lexists((hid_t)r[0]->id, name, H5P_DEFAULT) > 0,
                   H5Lexists((hid_t)r[1]->id, name, H5P_DEFAULT) > 0};
    hid_t object[2] = {-1, -1};
    if (!has[0] || !has[1]) {
        return add_difference(comparison, name,
                              has[0] ? "only in the first file" : "only in the second file") ||
               no_memory(message);
    }
    bool good = true;
    for (int f = 0; f < 2 && good; f++) {
        object[f] = H5Oopen((hid_t)r[f]->id, name, H5P_DEFAULT);
        good = object[f] >= 0 || unreadable(r[f], name, message);
    }
    if (good && H5Iget_type(object[0]) != H5Iget_type(object[1])) {
        good = add_difference(comparison, name, "types") || no_memory(message);
    } else if (good) {
        good =
            (comparison->tolerances || compare_attributes(comparison, r, object, name, message)) &&
            (H5Iget_type(object[0]) != H5I_DATASET ||
             compare_variable(comparison, r, object, name, list, list_count, message));
    }
    hdf_close(object[0], object[1]);
    return good;
}

/* The group that an object is in is missing in one of the files, which is said once. */
static bool lacks_group(const struct results *const r[2], const char *name)
{
    const char *slash = strrchr(name, '/');
    char group[192];
    snprintf(group, sizeof group, "%.*s", slash ? (int)(slash - name) : 0, name);
    return slash && !(hdf_exists((hid_t)r[0]->id, group) && hdf_exists((hid_t)r[1]->id, group));
}

bool compare_has(const struct results *r, const char *name)
{
    return name[0] && hdf_exists((hid_t)r->id, name);
}

bool compare_results(struct comparison *comparison, const struct results *first,
                     const struct results *second, const struct compare_tolerances *tolerances,
                     stance_message *message)
{
    static const char *const checksums[] = {"checksum", "trajectory/checksum", NULL};
    const struct results *const r[] = {first, second};
    const hid_t roots[] = {(hid_t)first->id, (hid_t)second->id};
    struct names names = {0};
    uint64_t *list = NULL;
    size_t list_count = 0;

    *comparison = (struct comparison){.tolerances = tolerances};
    bool good = results_recorded(first, &list, &list_count, message);
    for (int f = 0; f < 2 && good; f++)
        good = H5Lvisit(roots[f], H5_INDEX_NAME, H5_ITER_INC, add_link, &names) >= 0 ||
               unreadable(r[f], "its variables", message);
    good = good && (!names.failed || no_memory(message));
    names_unite(&names);
    good = good && (tolerances || compare_attributes(comparison, r, roots, "", message));
    for (size_t i = 0; good && i < names.count; i++) {
        good = lacks_group(r, names.name[i]) ||
               (tolerances && is_listed(names.name[i], checksums)) ||
               compare_object(comparison, r, names.name[i], list, list_count, message);
    }
    names_free(&names);
    free(list);
    if (!good)
        compare_free(comparison);
    return good;
}
