/* compare.c - walks through two results files and compares variables and attributes. */
#include "compare_values.h"

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

static bool list_objects(const struct results *r, struct names *names)
{
    return H5Lvisit((hid_t)r->id, H5_INDEX_NAME, H5_ITER_INC, add_link, names) >= 0;
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

/* ---- variables ---------------------------------------------------------------------------- */

/* A variable that both files have. */
struct variable {
    const char *name;
    const struct results *const *r; /* [2] */
    hid_t dataset[2], type[2];
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
static bool counts(const struct variable *v, size_t i)
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

static struct compare_place place_of(const struct variable *v, size_t i, size_t within,
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

/* The entry of a variable, made when its first difference is met. */
static struct compare_difference *entry_of(struct comparison *comparison, const struct variable *v,
                                           struct compare_difference **difference)
{
    if (!*difference && (*difference = add_difference(comparison, v->name, "values"))) {
        (*difference)->cases = v->width > 0;
        (*difference)->several = v->width > 1;
        (*difference)->of = v->width ? v->elements / v->width : v->elements;
    }
    return *difference;
}

/* Compares elements [first, first + n) that have been read. *last is the row noted last. */
static bool compare_block(struct comparison *comparison, const struct variable *v, size_t first,
                          const struct values values[2], struct compare_difference **difference,
                          size_t *last)
{
    for (size_t k = 0; k < values[0].count; k++) {
        const size_t i = first + k, row = v->width ? i / v->width : i;
        const bool noted = *difference && (*difference)->differing > 0 && *last == row;
        if (values_same(&values[0], &values[1], k) || !counts(v, i) || (noted && !v->tolerance))
            continue;
        if (!entry_of(comparison, v, difference))
            return false;
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

static bool compare_values(struct comparison *comparison, const struct variable *v,
                           stance_message *message)
{
    size_t last = 0;
    struct compare_difference *difference = NULL;
    bool good = true;

    for (size_t at = 0; at < v->elements && good; at += BLOCK) {
        const size_t n = v->elements - at < BLOCK ? v->elements - at : BLOCK;
        struct values values[2] = {{.kind = VALUE_OTHER}, {.kind = VALUE_OTHER}};
        for (int f = 0; f < 2 && good; f++) {
            good = values_read(v->dataset[f], at, v->type[f], n, &values[f]) ||
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
static void find_rows(struct variable *v, const uint64_t *list, size_t list_count)
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
                                                    const struct variable *v)
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

static bool open_variable(struct variable *v, const hid_t object[2], const char **differs)
{
    hsize_t length[2][H5S_MAX_RANK];
    int rank[2];
    for (int f = 0; f < 2; f++) {
        v->dataset[f] = object[f];
        v->type[f] = H5Dget_type(object[f]);
        rank[f] = hdf_shape(object[f], length[f]);
        if (v->type[f] < 0 || rank[f] < 0)
            return false;
    }
    v->rank = rank[0];
    memcpy(v->length, length[0], sizeof v->length);
    bool text = value_kind_of(v->type[0]) == VALUE_TEXT && value_kind_of(v->type[1]) == VALUE_TEXT;
    if (rank[0] != rank[1] ||
        memcmp(length[0], length[1], (size_t)rank[0] * sizeof length[0][0]) != 0)
        *differs = "shapes";
    else if (value_kind_of(v->type[0]) == VALUE_OTHER)
        *differs = "types that stance does not write";
    else if (!text && H5Tequal(v->type[0], v->type[1]) <= 0)
        *differs = "types";
    return true;
}

static bool compare_variable(struct comparison *comparison, const struct results *const r[2],
                             const hid_t object[2], const char *name, const uint64_t *list,
                             size_t list_count, stance_message *message)
{
    struct variable v = {.name = name, .r = r, .type = {-1, -1}};
    const char *differs = NULL;
    bool good = open_variable(&v, object, &differs) || unreadable(r[0], name, message);
    if (good && differs) {
        good = add_difference(comparison, name, differs) || no_memory(message);
    } else if (good) {
        v.elements = results_elements(r[0], v.rank, v.length);
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

static bool open_attribute(hid_t object, const char *name, hid_t *attribute, hid_t *type,
                           size_t *count)
{
    *attribute = H5Aopen(object, name, H5P_DEFAULT);
    *type = H5Aget_type(*attribute);
    hid_t space = H5Aget_space(*attribute);
    hssize_t points = H5Sget_simple_extent_npoints(space);
    *count = points > 0 && points < BLOCK ? (size_t)points : 0;
    hdf_close(space);
    return *attribute >= 0 && *type >= 0 && points >= 0 && points < BLOCK;
}

static bool compare_attribute(struct comparison *comparison, const struct results *const r[2],
                              const hid_t object[2], const char *owner, const char *attribute_name,
                              stance_message *message)
{
    hid_t attribute[2] = {-1, -1}, type[2] = {-1, -1};
    struct values values[2] = {{.kind = VALUE_OTHER}, {.kind = VALUE_OTHER}};
    size_t count[2] = {0}, last = 0;
    char name[192];
    struct variable v = {.name = name, .r = r};
    struct compare_difference *difference = NULL;
    bool good = true;

    snprintf(name, sizeof name, "attribute %.80s%s%.80s", owner, owner[0] ? ":" : "",
             attribute_name);
    for (int f = 0; f < 2 && good; f++) {
        good = (open_attribute(object[f], attribute_name, &attribute[f], &type[f], &count[f]) &&
                values_read(attribute[f], 0, type[f], count[f], &values[f])) ||
               unreadable(r[f], name, message);
    }
    v.elements = count[0];
    good = good && ((count[0] != count[1] || values[0].kind != values[1].kind
                         ? add_difference(comparison, name, "types") != NULL
                         : compare_block(comparison, &v, 0, values, &difference, &last)) ||
                    no_memory(message));
    for (int f = 0; f < 2; f++)
        values_free(&values[f]);
    hdf_close(type[0], type[1], attribute[0], attribute[1]);
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
        good = list_objects(r[f], &names) || unreadable(r[f], "its variables", message);
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
